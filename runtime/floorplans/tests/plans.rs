//! Floor plans of all kinds and sizes are sound, by the catalogue's own check and by geometry of their own.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;

use cohabit_cdf::{
    Catalog, Layout, PackFile, RoomId, WorldData, WorldPack,
    layout::{OpeningKind, Placement},
    mission,
};
use cohabit_floorplans::{FloorPlan, FloorPlans, Kind, PlanError, pack};

/// Plans that are looked at, of each kind and number of rooms.
const PLANS: u64 = 9;
/// The most rooms of a plan, without a hallway.
const MOST: usize = 12;

fn plans(kind: Kind, rooms: usize, seed: u64) -> FloorPlans {
    FloorPlans::new(kind, rooms, seed).unwrap()
}

/// The world of plans of a kind: what is built in, and the pack that they need.
fn base(kind: Kind) -> Vec<WorldPack> {
    kind.pack().map(|name| WorldPack::builtin(name).unwrap()).into_iter().collect()
}

fn layout(plan: &FloorPlan) -> Layout {
    Layout::parse(&plan.id, &[(&format!("{}.toml", plan.id), &plan.text)]).unwrap()
}

/// A turned rectangle seen from above, and the heights between which it is filled.
struct Solid {
    corners: [[f32; 2]; 4],
    heights: [f32; 2],
}

impl Solid {
    fn of(layout: &Layout, placement: &Placement, catalog: &Catalog) -> Self {
        let class = catalog.class(catalog.class_of_instance(&placement.instance).unwrap());
        let [x, y, z] = layout.origin_in_world_m(placement);
        let (sin, cos) = placement.yaw_deg.to_radians().sin_cos();
        let [depth, width] = [class.size_m[0] / 2.0, class.size_m[1] / 2.0];
        let corner = |[along, across]: [f32; 2]| {
            let [along, across] = [along * depth, across * width];
            [x + along * cos - across * sin, y + along * sin + across * cos]
        };
        let corners = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]].map(corner);
        Self { corners, heights: [z, z + class.size_m[2]] }
    }

    /// Whether a line along one of its sides has all of another one beyond it.
    fn parts_from(&self, other: &Self) -> bool {
        (0..4).any(|index| {
            let [from, to] = [self.corners[index], self.corners[(index + 1) % 4]];
            let normal = [to[1] - from[1], from[0] - to[0]];
            let length = normal[0].hypot(normal[1]);
            let beyond = |corner: &[f32; 2]| {
                ((corner[0] - from[0]) * normal[0] + (corner[1] - from[1]) * normal[1]) / length > -0.002
            };
            other.corners.iter().all(beyond)
        })
    }

    fn overlaps(&self, other: &Self) -> bool {
        let is_level = self.heights[0] + 0.002 < other.heights[1] && other.heights[0] + 0.002 < self.heights[1];
        is_level && !self.parts_from(other) && !other.parts_from(self)
    }
}

/// Whether one of them holds the other, or works it.
fn belong(one: &Placement, other: &Placement) -> bool {
    let is_of =
        |a: &Placement, b: &Placement| a.on.as_ref() == Some(&b.instance) || a.works.as_ref() == Some(&b.instance);
    is_of(one, other) || is_of(other, one)
}

fn check_space(layout: &Layout, catalog: &Catalog) {
    // What is put at an anchor is where the world finds a free one.
    let is_placed = |placement: &&Placement| !placement.anchor && !layout.is_door(placement);
    let placed: Vec<(&Placement, Solid)> = (layout.placements.iter().filter(is_placed))
        .map(|placement| (placement, Solid::of(layout, placement, catalog)))
        .collect();
    for (index, (placement, solid)) in placed.iter().enumerate() {
        for (other, other_solid) in &placed[..index] {
            let is_wrong = !belong(placement, other) && solid.overlaps(other_solid);
            assert!(!is_wrong, "{}: `{}` overlaps `{}`", layout.id, placement.instance, other.instance);
        }
    }
}

/// All rooms are reached from the first one, by doors of a metre and wider passages.
fn check_ways(layout: &Layout) {
    let mut reached = BTreeSet::from([layout.rooms[0].id]);
    for _ in &layout.rooms {
        for opening in layout.openings.iter().filter(|opening| opening.kind != OpeningKind::Window) {
            assert!(opening.width_m >= 1.0, "{}: a door of {} m", layout.id, opening.width_m);
            if opening.between.iter().any(|room| reached.contains(room)) {
                reached.extend(opening.between);
            }
        }
    }
    assert_eq!(reached.len(), layout.rooms.len(), "{}: not all rooms are joined", layout.id);
}

/// Each room has a light switch and furniture, each circuit a fuse box, and no room reaches into another one.
fn check_rooms(layout: &Layout) {
    let of_class = |class: &str, room: RoomId| {
        let is_of = |placement: &&Placement| placement.instance.starts_with(class) && placement.room == room;
        layout.placements.iter().filter(is_of).filter(|placement| placement.on.is_none()).count()
    };
    for room in &layout.rooms {
        assert_eq!(of_class("LightSwitch_01", room.id), 1, "{}: {}", layout.id, room.id);
        let things = layout.placements.iter().filter(|placement| placement.room == room.id).count();
        let least = if room.id == RoomId::HALLWAY { 1 } else { 5 };
        assert!(things >= least, "{}: {} has {things} things", layout.id, room.id);
        let on_circuit = layout.rooms.iter().filter(|other| other.circuit == room.circuit);
        assert_eq!(on_circuit.map(|other| of_class("FuseBox_01", other.id)).sum::<usize>(), 1, "{}", layout.id);
        for other in layout.rooms.iter().filter(|other| other.id != room.id) {
            for (one, two) in room.rects_m.iter().flat_map(|one| other.rects_m.iter().map(move |two| (one, two))) {
                let is_shared = one[0] < two[2] && two[0] < one[2] && one[1] < two[3] && two[1] < one[3];
                assert!(!is_shared, "{}: {} and {} share floor", layout.id, room.id, other.id);
            }
        }
    }
}

#[test]
fn plans_of_all_kinds_and_sizes_are_sound() {
    for kind in Kind::ALL {
        let world = WorldData::layered(base(kind)).unwrap();
        let catalog = world.catalog();
        let mut discarded = 0;
        for rooms in 1..=MOST {
            let plans = plans(kind, rooms, 3);
            for number in 0..PLANS {
                let plan = plans.plan(number).unwrap();
                let layout = layout(&plan);
                let faults: Vec<String> = layout.faults(catalog).iter().map(ToString::to_string).collect();
                assert!(faults.is_empty(), "{}: {faults:?}", plan.id);
                assert_eq!(layout.rooms.len() - usize::from(rooms >= 4), rooms, "{}", plan.id);
                check_space(&layout, catalog);
                check_ways(&layout);
                check_rooms(&layout);
                discarded += plan.discarded;
            }
        }
        assert!(discarded < MOST * PLANS as usize * 3, "{kind}: {discarded} drafts were discarded");
    }
}

#[test]
fn a_plan_follows_from_its_seed_and_number_alone() {
    let seven = plans(Kind::Home, 6, 7);
    let (second, first) = (seven.plan(1).unwrap(), seven.plan(0).unwrap());
    let again = plans(Kind::Home, 6, 7);
    assert_eq!((again.plan(0).unwrap(), again.plan(1).unwrap()), (first.clone(), second.clone()));
    let after_placements = |plan: &FloorPlan| plan.text.split_once("room = [").unwrap().1.to_owned();
    assert_ne!(after_placements(&first), after_placements(&second));
    let eight = plans(Kind::Home, 6, 8).plan(0).unwrap();
    assert_ne!(after_placements(&first), after_placements(&eight));
    assert_ne!(first.id, eight.id);
}

#[test]
fn what_cannot_be_made_is_refused_in_words() {
    let refused = |kind: Kind, rooms: usize| FloorPlans::new(kind, rooms, 1).unwrap_err().to_string();
    for rooms in [0, 13, 200] {
        let text = refused(Kind::Office, rooms);
        assert!(text.contains(&format!("of {rooms} rooms")) && text.contains("from 1 to 12"), "{text}");
    }
    assert!("castle".parse::<Kind>().unwrap_err().to_string().contains("write `office` or `home`"));
    assert_eq!(pack::check("flats", 0), Err(PlanError::Count { count: 0, most: pack::MOST_PLANS }));
    assert!(pack::check("My Flats", 1).unwrap_err().to_string().contains("begin with a small letter"));
    assert_eq!(pack::check("homes", 1), Err(PlanError::Taken { name: "homes".to_owned() }));
    assert_eq!(pack::check("flats", pack::MOST_PLANS), Ok(()));
}

fn read(name: &str, kind: Kind, rooms: usize, count: u64) -> WorldPack {
    let plans = plans(kind, rooms, 5);
    let made: Vec<FloorPlan> = (0..count).map(|number| plans.plan(number).unwrap()).collect();
    let files = pack::files(name, &plans, &made).into_iter();
    let files = files.map(|(path, text)| PackFile { path, bytes: text.into_bytes() }).collect();
    WorldPack::parse(name, files).unwrap()
}

/// Packs of plans make a world with the pack that they need, and their missions are about these plans.
fn check_packs(kind: Kind, packs: Vec<WorldPack>) {
    let names: Vec<String> = packs.iter().flat_map(WorldPack::plans).map(str::to_owned).collect();
    let missions: Vec<(String, String)> =
        packs.iter().flat_map(WorldPack::missions).map(|(file, text)| (file.to_owned(), text.to_owned())).collect();
    assert_eq!(missions.len(), packs.len());
    let world = WorldData::layered(base(kind).into_iter().chain(packs).collect()).unwrap();
    for name in &names {
        assert!(Layout::find(name, world.catalog()).is_ok(), "{name}");
    }
    for (file, text) in &missions {
        let sources = mission::sources(file, text);
        let checked = sources[0].read(world.catalog()).unwrap();
        assert!(names.contains(&checked.mission.layout), "{file}");
        let warnings: Vec<String> = checked.warnings.iter().map(ToString::to_string).collect();
        assert!(warnings.len() == 1 && warnings[0].contains("no goals"), "{warnings:?}");
    }
}

#[test]
fn plans_make_a_world_pack_with_a_mission() {
    let offices = read("offices", Kind::Office, 12, 2);
    assert_eq!(offices.plans().collect::<Vec<_>>(), ["Office12_5_000", "Office12_5_001"]);
    check_packs(Kind::Office, vec![offices]);
}

#[test]
fn packs_of_homes_are_loaded_together_behind_the_pack_that_they_need() {
    let [large, small] = [read("houses", Kind::Home, 12, 2), read("flats", Kind::Home, 5, 1)];
    assert_eq!(large.plans().collect::<Vec<_>>(), ["Home12_5_000", "Home12_5_001"]);
    assert!(large.description().contains("--world homes --world houses"), "{}", large.description());
    let alone = WorldData::layered(vec![small.clone()]).unwrap_err().to_string();
    assert!(alone.contains("there is no such room"), "{alone}");
    check_packs(Kind::Home, vec![large, small]);
}

/// How many of some classes a room has.
fn count(layout: &Layout, room: &str, classes: &[&str], catalog: &Catalog) -> usize {
    let own = layout.placements.iter().filter(|placement| placement.room.id() == room);
    let class = |placement: &Placement| &catalog.class(catalog.class_of_instance(&placement.instance).unwrap()).id;
    own.filter(|placement| classes.contains(&class(placement).as_str())).count()
}

/// What each room of a home has for certain: one of some classes.
const FURNISHED: &[(&str, &[&str])] = &[
    ("LivingRoom", &["Sofa_Three", "Sofa_Two"]),
    ("LivingRoom", &["Television"]),
    ("LivingRoom", &["Coffee_Table"]),
    ("LivingRoom", &["Bookcase"]),
    ("Kitchen", &["Stove"]),
    ("Kitchen", &["Extractor_Hood"]),
    ("Kitchen", &["Fridge_Freezer"]),
    ("Kitchen", &["Kitchen_Sink_Double"]),
    ("Kitchen", &["Dishwasher"]),
    ("Bedroom", &["Bed_Double", "Bed_Single"]),
    ("Bedroom", &["Nightstand"]),
    ("Bedroom", &["Wardrobe"]),
    ("GuestRoom", &["Bed_Double", "Bed_Single"]),
    ("ChildrensRoom", &["Bunk_Bed", "Cot", "Bed_Single"]),
    ("ChildrensRoom", &["Toy_Box"]),
    ("Bathroom", &["Bathtub", "Shower"]),
    ("Bathroom", &["Toilet"]),
    ("Bathroom", &["Washbasin"]),
    ("GuestBathroom", &["Shower"]),
    ("UtilityRoom", &["Washing_Machine"]),
    ("UtilityRoom", &["Tumble_Dryer"]),
    ("UtilityRoom", &["Storage_Shelf"]),
    ("DiningRoom", &["Dining_Table", "TableRound_02"]),
    ("Study", &["Writing_Desk"]),
    ("Library", &["Bookcase"]),
    ("HobbyRoom", &["Workbench_Home"]),
];

#[test]
fn homes_have_what_people_live_with() {
    let world = WorldData::layered(base(Kind::Home)).unwrap();
    let (catalog, plans) = (world.catalog(), plans(Kind::Home, MOST, 11));
    for number in 0..PLANS {
        let layout = layout(&plans.plan(number).unwrap());
        for (room, classes) in FURNISHED {
            assert!(count(&layout, room, classes, catalog) > 0, "{}: {room} has none of {classes:?}", layout.id);
        }
    }
}

#[test]
fn a_television_stands_opposite_a_sofa() {
    let world = WorldData::layered(base(Kind::Home)).unwrap();
    let (catalog, plans) = (world.catalog(), plans(Kind::Home, 1, 11));
    for number in 0..4 * PLANS {
        let layout = layout(&plans.plan(number).unwrap());
        let find = |class: &str| layout.placements.iter().find(|placement| placement.instance.starts_with(class));
        let (sofa, stand) = (find("Sofa_").unwrap(), find("TV_Stand").unwrap());
        let apart = (sofa.yaw_deg - stand.yaw_deg).abs();
        assert_eq!(apart, 180.0, "{}: they do not face each other", layout.id);
        let (sin, cos) = sofa.yaw_deg.to_radians().sin_cos();
        let [x, y] = [0, 1].map(|axis| stand.at_m[axis] - sofa.at_m[axis]);
        let (ahead, aside) = (x * cos + y * sin, y * cos - x * sin);
        assert!(ahead > 1.5 && aside.abs() <= 0.6, "{}: {ahead} m ahead, {aside} m aside", layout.id);
        assert!(count(&layout, "LivingRoom", &["Television"], catalog) == 1, "{}", layout.id);
    }
}

#[test]
fn a_shower_has_walls_at_its_back_and_at_its_left() {
    let plans = plans(Kind::Home, MOST, 11);
    let mut showers = 0;
    for number in 0..PLANS {
        let layout = layout(&plans.plan(number).unwrap());
        for shower in layout.placements.iter().filter(|placement| placement.instance.starts_with("Shower_")) {
            let [x, y, _] = shower.at_m;
            let (sin, cos) = shower.yaw_deg.to_radians().sin_cos();
            // It is 0.9 m wide and deep, and its room ends 0.15 m from it at most.
            for [ahead, left] in [[-0.6, 0.0], [0.0, 0.6]] {
                let at = [x + ahead * cos - left * sin, y + ahead * sin + left * cos];
                assert_ne!(layout.room_at(at[0], at[1]), Some(shower.room), "{}: {}", layout.id, shower.instance);
            }
            showers += 1;
        }
    }
    assert!(showers >= PLANS as usize, "{showers} showers");
}
