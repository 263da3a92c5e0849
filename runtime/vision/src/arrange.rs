//! What there is in an image's world: a room to look at, things in it, states of its furniture, and lights.

use std::collections::BTreeSet;

use cohabit_cdf::{
    Catalog, ClassId, Layout, Mission, ObjectClass, ObjectRequest, RoomId, StateFlag, layout::Placement,
};
use cohabit_generate::{Chance, is_container, is_thing};

use crate::states;

/// Fewest and most things that are placed.
const THINGS: [usize; 2] = [6, 18];
/// The number of the first thing placed of a class: floor plans have small ones, and those from 10000 up.
const FIRST_NUMBER: usize = 101;
/// The share of things that are in an open container, if there is one.
const STOWED: f64 = 0.15;
/// The share of images with something that their floor plan does not have: every class is to be seen somewhere.
const ABSENT: f64 = 0.2;
/// The share of rooms whose lights are off.
const DARK: f64 = 0.2;
const LIGHT_SWITCH: &str = "LightSwitch_01";

/// What an image's world is built from.
#[derive(Debug)]
pub(crate) struct Arrangement {
    /// The room that is looked at.
    pub room: RoomId,
    /// What is where, and how it is.
    pub mission: Mission,
    /// The seed of where things stand.
    pub seed: u64,
}

impl Arrangement {
    /// Draws all of it.
    pub fn draw(catalog: &Catalog, layout: &Layout, chance: &mut Chance) -> Self {
        let room = chance.pick(&layout.rooms).map_or(RoomId::BREAK_ROOM, |room| room.id);
        let seed = chance.number();
        let mut arranger = Arranger { catalog, layout, room, chance };
        let mut objects = arranger.switched_off();
        let furniture = arranger.furniture();
        let things = arranger.things(&open_containers(catalog, &furniture));
        objects.extend(furniture);
        objects.extend(things);
        objects.extend(arranger.absent());
        let mission = Mission { layout: layout.id.clone(), start_room: room, objects, ..Mission::default() };
        Self { room, mission, seed }
    }
}

struct Arranger<'a> {
    catalog: &'a Catalog,
    layout: &'a Layout,
    room: RoomId,
    chance: &'a mut Chance,
}

impl Arranger<'_> {
    fn class_of(&self, placement: &Placement) -> Option<&ObjectClass> {
        self.catalog.class_of_instance(&placement.instance).map(|class| self.catalog.class(class))
    }

    /// The light switches of rooms that are to be dark.
    fn switched_off(&mut self) -> Vec<ObjectRequest> {
        let dark = self.layout.rooms.iter().map(|room| room.id).filter(|_| self.chance.is(DARK));
        let dark: Vec<RoomId> = dark.collect();
        let is_switch = |placement: &&Placement| {
            dark.contains(&placement.room) && self.class_of(placement).is_some_and(|class| class.id == LIGHT_SWITCH)
        };
        let switches = self.layout.placements.iter().filter(is_switch);
        let off = |switch: &Placement| ObjectRequest {
            instance: switch.instance.clone(),
            flags: vec![(StateFlag::Toggled, false)],
            ..ObjectRequest::default()
        };
        switches.map(off).collect()
    }

    /// The states of what the room has by itself.
    fn furniture(&mut self) -> Vec<ObjectRequest> {
        let (layout, room) = (self.layout, self.room);
        let mut requests = Vec::new();
        for placement in layout.placements.iter().filter(|placement| placement.room == room) {
            let Some(class) = self.catalog.class_of_instance(&placement.instance) else { continue };
            let class = self.catalog.class(class);
            if is_wiring(class) {
                continue;
            }
            let request = self.request(class, placement.instance.clone());
            if !request.flags.is_empty() || request.fluid.is_some() {
                requests.push(request);
            }
        }
        requests
    }

    /// Things to carry: most wherever there is a place for them in the room, some in containers that are open.
    fn things(&mut self, containers: &[String]) -> Vec<ObjectRequest> {
        let classes: Vec<&ObjectClass> = self.catalog.classes().iter().filter(|class| is_thing(class)).collect();
        let [fewest, most] = THINGS;
        let count = fewest + self.chance.below(most - fewest + 1);
        let mut requests = Vec::new();
        for number in 0..count {
            let Some(class) = self.chance.pick(&classes) else { break };
            let is_stowed = self.chance.is(STOWED);
            let inside = if is_stowed { self.chance.pick(containers).cloned() } else { None };
            let request = self.request(class, format!("{}_{}", class.id, FIRST_NUMBER + number));
            let color = states::color(self.chance);
            requests.push(ObjectRequest { room: Some(self.room), inside, color, ..request });
        }
        requests
    }

    /// Perhaps something of a class that the floor plan does not have and nobody carries about.
    fn absent(&mut self) -> Option<ObjectRequest> {
        if !self.chance.is(ABSENT) {
            return None;
        }
        let doors = self.layout.openings.iter().filter_map(|opening| opening.door.as_ref());
        let instances = self.layout.placements.iter().map(|placement| &placement.instance).chain(doors);
        let present: BTreeSet<ClassId> =
            instances.filter_map(|instance| self.catalog.class_of_instance(instance)).collect();
        let is_absent = |(index, class): &(u16, &ObjectClass)| {
            !is_thing(class) && !class.name.is_empty() && !is_wiring(class) && !present.contains(&ClassId(*index))
        };
        let absent = (0_u16..).zip(self.catalog.classes()).filter(is_absent);
        let absent: Vec<&ObjectClass> = absent.map(|(_, class)| class).collect();
        let class = self.chance.pick(&absent)?;
        let request = self.request(class, format!("{}_{FIRST_NUMBER}", class.id));
        Some(ObjectRequest { room: Some(self.room), ..request })
    }

    /// Something in the states that chance has it in.
    fn request(&mut self, class: &ObjectClass, instance: String) -> ObjectRequest {
        let flags = states::flags(class, self.chance);
        let fluid = states::fluid(class, self.chance);
        ObjectRequest { instance, flags, fluid, ..ObjectRequest::default() }
    }
}

/// What switches lamps and circuits: those are drawn by room.
fn is_wiring(class: &ObjectClass) -> bool {
    class.id == LIGHT_SWITCH || class.id.starts_with("FuseBox_")
}

/// The containers among these that are open.
fn open_containers(catalog: &Catalog, requests: &[ObjectRequest]) -> Vec<String> {
    let is_open = |request: &&ObjectRequest| {
        let class = catalog.class_of_instance(&request.instance).map(|class| catalog.class(class));
        request.flags.contains(&(StateFlag::Opened, true)) && class.is_some_and(is_container)
    };
    requests.iter().filter(is_open).map(|request| request.instance.clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_asked_for_twice_and_all_of_it_has_a_class() {
        let catalog = Catalog::builtin();
        for (stream, id) in (0..).zip(Layout::builtin_ids()) {
            let layout = Layout::builtin(&id).unwrap();
            let arrangement = Arrangement::draw(&catalog, &layout, &mut Chance::new(3, stream));
            let mut instances = BTreeSet::new();
            for request in &arrangement.mission.objects {
                assert!(catalog.class_of_instance(&request.instance).is_some(), "{}", request.instance);
                assert!(instances.insert(&request.instance), "{}", request.instance);
            }
            assert!(instances.len() >= THINGS[0], "{id}");
        }
    }
}
