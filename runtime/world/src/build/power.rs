//! Power as the mission wants it at the start: which circuits are fed, and what hangs on them.

use cohabit_cdf::{Fluid, ObjectId, ObjectRequest, Property, StateFlag};

use super::Builder;
use crate::{effect::Effect, power, rules::powered, state::ids};

const LEVER: &str = "FuseBox_01_Lever";
const CORDS: [&str; 2] = ["Broken_Cord_01", "CableFrayed_01"];

impl Builder<'_> {
    /// Feeds the circuits as fuse boxes, levers and generators are said to, and powers what hangs on them.
    pub(super) fn set_circuits(&mut self) {
        let said: Vec<(i32, bool)> = self.requests().filter_map(|(id, request)| self.switched(id, request)).collect();
        for (circuit, fed) in said {
            // One that cuts it is enough.
            let before = self.state.circuits.get(&circuit).copied().unwrap_or(true);
            self.state.circuits.insert(circuit, before && fed);
        }
        let own: Vec<ObjectId> = self
            .requests()
            .filter(|(_, request)| request.flags.iter().any(|(flag, _)| *flag == StateFlag::Powered))
            .map(|(id, _)| id)
            .collect();
        for id in ids(self.state.objects.len()) {
            self.set_power(id, own.contains(&id));
        }
    }

    /// The objects that the mission asks for, with what it asks.
    fn requests(&self) -> impl Iterator<Item = (ObjectId, &ObjectRequest)> {
        self.requested.iter().map(|(index, id)| (*id, &self.mission.objects[*index]))
    }

    /// The circuit that a request feeds or cuts, if it says anything of that.
    fn switched(&self, id: ObjectId, request: &ObjectRequest) -> Option<(i32, bool)> {
        let object = self.state.at(id);
        let said = |wanted: StateFlag| {
            let last = request.flags.iter().rev().find(|(flag, _)| *flag == wanted);
            last.map(|(_, value)| *value)
        };
        if self.catalog.class(object.class).id == LEVER {
            let circuit = object.parent().and_then(|fuse_box| self.state.at(fuse_box).feeds)?;
            return Some((circuit, said(StateFlag::Toggled)?));
        }
        let circuit = object.feeds?;
        let words = [said(StateFlag::Powered), said(StateFlag::Toggled), request.generates_power];
        words.into_iter().flatten().reduce(|one, two| one && two).map(|fed| (circuit, fed))
    }

    /// Powers one object by its circuit, unless the mission says how it is, and lets what is live throw sparks.
    fn set_power(&mut self, id: ObjectId, said: bool) {
        let class = self.catalog.class(self.state.at(id).class);
        let fed = power::is_fed(&self.state, self.state.at(id).circuit);
        let switch = self.state.at(id).feeds.or_else(|| {
            let fuse_box = self.state.at(id).parent().filter(|_| class.id == LEVER)?;
            self.state.at(fuse_box).feeds
        });
        let on = switch.map(|circuit| power::is_fed(&self.state, Some(circuit)));
        let object = self.state.at_mut(id);
        if class.has(Property::Powerable) && !said {
            object.flags.set(StateFlag::Powered, fed);
        }
        if let Some(on) = on {
            object.flags.set(StateFlag::Toggled, on);
        }
        if CORDS.contains(&class.id.as_str()) && object.flags.has(StateFlag::Toggled) && fed {
            object.flags.set(StateFlag::Sparking, true);
        }
        if self.catalog.table().is_basin(&class.id) && object.flags.has(StateFlag::Toggled) {
            object.fluid = Fluid::Water;
        }
    }

    /// What has power has done what it does as that comes, unless the mission says how it is: computers have read their disks.
    pub(super) fn read_disks(&mut self) {
        let said: Vec<ObjectId> = self
            .requests()
            .filter(|(_, request)| request.flags.iter().any(|(flag, _)| *flag == StateFlag::Infected))
            .map(|(id, _)| id)
            .collect();
        let facts = self.facts();
        let others = facts.state.existing().map(|(id, _)| id).filter(|id| !said.contains(id));
        let effects: Vec<Effect> = others.flat_map(|id| powered(&facts, id)).collect();
        self.changes().apply(effects);
    }
}
