//! Missions and choices by chance, the same for the same seed.

use std::sync::Arc;

use cohabit_cdf::{
    Catalog, Color, Fluid, Layout, Mission, ObjectClass, ObjectRequest, Property, RoomId, StateFlag, catalog::Stands,
};
use cohabit_world::World;

/// Things that a mission asks for.
const THINGS: usize = 30;
/// Devices of the floor plan that it puts into other states.
const DEVICES: usize = 10;

/// SplitMix64.
pub struct Chance(pub u64);

impl Chance {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    }

    pub fn below(&mut self, count: usize) -> usize {
        (self.next() % count.max(1) as u64) as usize
    }

    pub fn one_in(&mut self, many: usize) -> bool {
        self.below(many) == 0
    }

    pub fn pick<T: Copy>(&mut self, from: &[T]) -> Option<T> {
        if from.is_empty() { None } else { Some(from[self.below(from.len())]) }
    }
}

/// A world of a floor plan drawn at random, with things and devices in states drawn at random.
pub fn world(catalog: &Arc<Catalog>, chance: &mut Chance) -> Option<World> {
    let layout = Layout::builtin(&Layout::builtin_ids()[chance.below(Layout::builtin_ids().len())]).unwrap();
    let rooms: Vec<RoomId> = layout.rooms.iter().map(|room| room.id).filter(|room| *room != RoomId::HALLWAY).collect();
    let start_room = rooms[chance.below(rooms.len())];
    let classes = catalog.classes();
    let tools: Vec<usize> = named(classes, |class| is_of_use(catalog, class));
    let carried: Vec<usize> = named(classes, |class| class.has(Property::Pickupable));
    let mut objects: Vec<ObjectRequest> = Vec::new();
    for number in 1..=THINGS {
        let pool = if chance.one_in(2) { &tools } else { &carried };
        let class = &classes[chance.pick(pool).unwrap()];
        // Most of them lie where the body begins: it would walk more than it acts.
        let room = if chance.one_in(3) { rooms[chance.below(rooms.len())] } else { start_room };
        let mut request = request(class, number, chance);
        request.room = Some(room);
        request.yesterday = chance.one_in(8).then(|| classes[chance.pick(&carried).unwrap()].id.clone());
        request.prints = (class.id.starts_with("Printer_") && chance.one_in(2))
            .then(|| classes[chance.pick(&carried).unwrap()].id.clone());
        objects.push(request);
    }
    let placed: Vec<usize> = (0..layout.placements.len()).collect();
    for _ in 0..DEVICES {
        let placement = &layout.placements[chance.pick(&placed)?];
        let Some(id) = catalog.class_of_instance(&placement.instance) else { continue };
        let class = catalog.class(id);
        let known = objects.iter().any(|object| object.instance == placement.instance);
        if !known
            && (class.has(Property::Powerable) || class.has(Property::Openable) || class.has(Property::Toggleable))
        {
            let mut wanted = request(class, 0, chance);
            wanted.instance.clone_from(&placement.instance);
            objects.push(wanted);
        }
    }
    let mission = Mission {
        name: "chance".to_owned(),
        layout: layout.id.clone(),
        seed: Some(chance.below(1000) as u64),
        start_room,
        objects,
        ..Mission::default()
    };
    World::new(Arc::clone(catalog), Arc::new(layout), Arc::new(mission), 3).ok()
}

fn named(classes: &[ObjectClass], fits: impl Fn(&ObjectClass) -> bool) -> Vec<usize> {
    (0..classes.len()).filter(|index| fits(&classes[*index])).collect()
}

/// Tools, keys and what works are made of: things that only chance would hardly bring together.
fn is_of_use(catalog: &Catalog, class: &ObjectClass) -> bool {
    let is_key = |holder: &ObjectClass| holder.receptacle.as_ref().is_some_and(|kind| kind.keys.contains(&class.id));
    let fillable = class.has(Property::Fillable) && class.has(Property::Pickupable);
    ["Hammer", "Knife_01", "Cereal_Box_01", "CoffeeBeans_01", "CableFrayed_01", "FoodPlate_01"]
        .contains(&class.id.as_str())
        || fillable
        || catalog.table().slice(&class.id).is_some()
        || (class.stands == Stands::OnSurface && catalog.classes().iter().any(is_key))
}

/// A thing in states that its class may be in.
pub fn request(class: &ObjectClass, number: usize, chance: &mut Chance) -> ObjectRequest {
    const STATES: [(Property, StateFlag, usize); 13] = [
        (Property::Breakable, StateFlag::Broken, 5),
        (Property::Dirtyable, StateFlag::Dirty, 2),
        (Property::Heatable, StateFlag::Hot, 5),
        (Property::Chillable, StateFlag::Cold, 5),
        (Property::Eatable, StateFlag::Eaten, 4),
        (Property::Cookable, StateFlag::Cooked, 3),
        (Property::Cuttable, StateFlag::Cut, 4),
        (Property::Infectable, StateFlag::Infected, 3),
        (Property::Toggleable, StateFlag::Toggled, 4),
        (Property::Openable, StateFlag::Opened, 2),
        (Property::Openable, StateFlag::Locked, 12),
        (Property::Powerable, StateFlag::Overloaded, 10),
        (Property::Powerable, StateFlag::Sparking, 60),
    ];
    let mut flags: Vec<(StateFlag, bool)> = STATES
        .into_iter()
        .filter(|(property, _, many)| class.has(*property) && chance.one_in(*many))
        .map(|(_, flag, _)| (flag, true))
        .collect();
    if class.has(Property::Powerable) && chance.one_in(8) {
        flags.push((StateFlag::Powered, false));
    }
    let fluid = (class.has(Property::Fillable) && chance.one_in(2)).then(|| Fluid::ALL[chance.below(4)]);
    let color = chance.one_in(6).then(|| Color::ALL[chance.below(4)]);
    ObjectRequest { instance: format!("{}_{number}", class.id), flags, fluid, color, ..ObjectRequest::default() }
}
