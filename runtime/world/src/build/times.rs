//! Portals and what is behind them, dinosaurs, and what is not there until its condition holds.

use cohabit_cdf::{Mission, ObjectId, ObjectRequest, StateFlag, mission::Era};

use super::Builder;
use crate::{
    entity::Support,
    mission_state::{Away, Dinosaur, Gate, Until, Way},
    state::ids,
};

const GENERATOR: &str = "PortalGenerator";

impl Builder<'_> {
    /// Gives each portal generator the times that it leads to, and sends away what waits behind them.
    pub(super) fn open_times(&mut self) {
        for id in ids(self.state.objects.len()) {
            if self.state.at(id).exists() && self.catalog.class(self.state.at(id).class).id == GENERATOR {
                self.open_gate(id);
            }
        }
        let requests: Vec<(usize, ObjectId)> = self.requested.iter().map(|(index, id)| (*index, *id)).collect();
        for (index, id) in requests {
            let request = &self.mission.objects[index];
            if let Some(food) = &request.dino_food {
                self.state.dinosaurs.insert(id, Dinosaur { food: Some(food.clone()), fed: false });
            }
            if self.state.portals.contains_key(&id) {
                continue;
            }
            let ways: Vec<String> = request.past_portals.iter().chain(&request.future_portals).cloned().collect();
            if !ways.is_empty() {
                self.state.passes.insert(id, ways);
            }
            let portal = request.current_portal.clone().map(Until::Portal);
            let condition = request.condition.as_ref().map(|_| Until::Condition(index));
            let Some(until) = portal.or(condition) else { continue };
            if let Some(away) = self.state.away.get_mut(&id) {
                // It left with what it is in, and still waits for its own time.
                away.until = until;
            } else if self.state.at(id).exists() {
                self.send_away(id, until);
            }
        }
    }

    fn open_gate(&mut self, id: ObjectId) {
        let request = self.requested.iter().find(|(_, other)| **other == id).map(|(index, _)| *index);
        let request = request.map(|index| &self.mission.objects[index]);
        let ways = ways(self.mission, request);
        let wanted = request.and_then(|request| request.current_portal.as_ref());
        let is_open = |way: &Way| {
            let named = |portal: &&cohabit_cdf::mission::Portal| portal.name == way.name && portal.era == way.era;
            self.mission.portals.iter().find(named).is_some_and(|portal| portal.open)
        };
        let current = ways.iter().position(|way| Some(&way.name) == wanted);
        let current = current.or_else(|| ways.iter().position(is_open)).unwrap_or(0);
        let open = is_open(&ways[current]);
        if ways.iter().any(|way| way.era == Era::Past) {
            self.state.dinosaurs.insert(id, Dinosaur { food: None, fed: false });
        }
        self.state.portals.insert(id, Gate { ways, current });
        if open {
            let monitors = ids(self.state.objects.len()).filter(|other| self.state.at(*other).works == Some(id));
            for switched in monitors.chain([id]).collect::<Vec<_>>() {
                self.state.at_mut(switched).flags.set(StateFlag::Toggled, true);
            }
        }
    }

    /// Takes an object, and all that is in or on it, out of the world for a while.
    fn send_away(&mut self, id: ObjectId, until: Until) {
        for child in self.state.children(id).collect::<Vec<_>>() {
            self.send_away(child, Until::Carrier);
        }
        let object = self.state.at_mut(id);
        let support = std::mem::replace(&mut object.support, Support::Gone);
        let pose = object.pose;
        self.state.away.insert(id, Away { support, pose, until });
    }
}

/// The times that a generator leads to: its own, or all of the mission's, or just the past and the future.
fn ways(mission: &Mission, request: Option<&ObjectRequest>) -> Vec<Way> {
    let of = |era: Era| move |name: &String| Way { name: name.clone(), era };
    let own: Vec<Way> = request.map_or_else(Vec::new, |request| {
        let past = request.past_portals.iter().map(of(Era::Past));
        past.chain(request.future_portals.iter().map(of(Era::Future))).collect()
    });
    if !own.is_empty() {
        return own;
    }
    let declared: Vec<Way> =
        mission.portals.iter().map(|portal| Way { name: portal.name.clone(), era: portal.era }).collect();
    if !declared.is_empty() {
        return declared;
    }
    [("past", Era::Past), ("future", Era::Future)].map(|(name, era)| Way { name: name.to_owned(), era }).to_vec()
}
