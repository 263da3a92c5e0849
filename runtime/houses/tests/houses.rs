//! Houses in the format of ProcTHOR, written for this project, become floor plans in which nothing is wrong.
#![allow(clippy::unwrap_used)]

use std::sync::LazyLock;

use cohabit_cdf::{
    Layout, PackFile, RoomId, WorldData, WorldPack,
    layout::{OpeningKind, Placement},
};
use cohabit_houses::{
    ImportedPlan, Importer, Reason,
    pack::{HousePack, check_prefix, plan_id},
};

const FLAT: &str = include_str!("data/flat.json");
const BEDROOMS: &str = include_str!("data/bedrooms.json");

static IMPORTER: LazyLock<Importer> = LazyLock::new(Importer::default);

fn plan(text: &str) -> (ImportedPlan, Layout) {
    let plan = IMPORTER.plan("Thor0000", text).unwrap();
    let layout = Layout::parse("Thor0000", &[("Thor0000.toml", &plan.text)]).unwrap();
    let faults: Vec<String> = layout.faults(IMPORTER.world().catalog()).iter().map(ToString::to_string).collect();
    assert!(faults.is_empty(), "{faults:?}");
    (plan, layout)
}

fn room(id: &str) -> RoomId {
    RoomId::new(id).unwrap()
}

/// What is of a class, or of one of several classes that begin so.
fn of<'a>(layout: &'a Layout, class: &str) -> &'a Placement {
    let found = layout.placements.iter().find(|placement| placement.instance.starts_with(class));
    found.unwrap_or_else(|| panic!("there is no {class} in {:#?}", layout.placements))
}

fn count(plan: &ImportedPlan, kind: &str, reason: Reason) -> usize {
    plan.report.left_out.iter().filter(|one| one.kind == kind && one.reason == reason).map(|one| one.count).sum()
}

#[test]
fn a_flat_has_its_rooms_in_the_positive_quadrant() {
    let (plan, layout) = plan(FLAT);
    let ids: Vec<&str> = layout.rooms.iter().map(|room| room.id.id()).collect();
    assert_eq!(ids, ["LivingRoom", "Kitchen", "Bedroom", "Bathroom"]);
    let [west, south, east, north] = layout.bounds_m();
    assert_eq!([west, south], [0.0, 0.0]);
    assert!((east - 7.95).abs() <= 0.051 && (north - 8.96).abs() <= 0.051, "{east} {north}");
    assert_eq!(layout.room(room("LivingRoom")).unwrap().rects_m.len(), 2);
    assert_eq!(plan.start, room("Bedroom"), "the agent begins in the bedroom");
    let material = |id: &str| format!("{:?}", layout.room(room(id)).unwrap().floor.material);
    assert_eq!(["LivingRoom", "Kitchen", "Bedroom"].map(material), ["Wood", "Tile", "Carpet"]);
}

#[test]
fn doors_frames_and_open_walls_join_rooms() {
    let (plan, layout) = plan(FLAT);
    let between = |kind: OpeningKind, one: &str, other: &str| {
        let rooms = [room(one), room(other)];
        let joins = |between: [RoomId; 2]| rooms.iter().all(|room| between.contains(room));
        layout.openings.iter().find(|opening| opening.kind == kind && joins(opening.between)).cloned()
    };
    let door = between(OpeningKind::Door, "LivingRoom", "Bedroom").unwrap();
    // 1.6 m along a wall that begins in the west.
    assert_eq!((door.at_m, door.width_m), ([1.6, 5.0], 1.0));
    assert!(between(OpeningKind::Door, "Bedroom", "Bathroom").is_some());
    let open = between(OpeningKind::Passage, "LivingRoom", "Kitchen").unwrap();
    assert!(open.width_m >= 2.0, "{open:?}");
    let windows = layout.openings.iter().filter(|opening| opening.kind == OpeningKind::Window).count();
    assert_eq!((windows, plan.report.windows, plan.report.doors), (2, 2, 4));
    assert_eq!(of(&layout, "SM_Bld_Door_02").room, room("LivingRoom"));
}

#[test]
fn a_bed_keeps_its_head_at_the_wall() {
    let (_, layout) = plan(FLAT);
    let bed = of(&layout, "Bed_Double");
    // Turned by 180 degrees, its foot is in the south, and its head at the northern wall.
    assert_eq!((bed.room, bed.yaw_deg), (room("Bedroom"), -90.0));
    let north_m = layout.bounds_m()[3];
    assert!((north_m - bed.at_m[1] - (2.05 / 2.0 + 0.06 + 0.02)).abs() < 0.01, "{bed:?}");
    assert!((bed.at_m[0] - 2.5).abs() < 0.25, "{bed:?}");
    // A sofa at the western wall looks east, a fridge at the eastern one west.
    assert_eq!((of(&layout, "Sofa_").yaw_deg, of(&layout, "Fridge_Freezer").yaw_deg), (0.0, 180.0));
    assert_eq!(of(&layout, "Picture_").yaw_deg, 0.0);
}

#[test]
fn what_lies_on_furniture_lies_on_what_stands_for_it() {
    let (_, layout) = plan(FLAT);
    for (thing, holder) in [
        ("Television", "TV_Stand"),
        ("Remote_Control", "TV_Stand"),
        ("Bowl_01", "Dining_Table"),
        ("Laptop", "Writing_Desk"),
        ("Novel", "Writing_Desk"),
        ("Alarm_Clock", "Nightstand"),
        ("Toaster_02", "Counter_Long"),
        // It was in a mug on the counter.
        ("Spoon_01", "Counter_Long"),
        ("Pillow", "Bed_Double"),
    ] {
        let on = of(&layout, thing).on.clone().unwrap_or_default();
        assert!(on.starts_with(holder), "{thing} is on `{on}`");
    }
    let laptop = of(&layout, "Laptop");
    assert_eq!(laptop.yaw_deg, 180.0);
}

#[test]
fn what_has_no_class_is_named_with_its_count() {
    let (plan, _) = plan(FLAT);
    for kind in ["AlienProbe", "Safe"] {
        assert_eq!(count(&plan, kind, Reason::NoClass), 1, "{:?}", plan.report.left_out);
    }
    let left_out: usize = plan.report.left_out.iter().map(|one| one.count).sum();
    // All objects of the file are accounted for.
    assert_eq!(plan.report.placed + left_out, FLAT.matches("\"kinematic\"").count());
    assert!(plan.report.moved <= plan.report.placed);
    assert_eq!(plan.report.notes, Vec::<String>::new());
    let text = serde_json::to_string(&plan.report).unwrap();
    assert!(text.contains("{\"type\":\"AlienProbe\",\"reason\":\"no_class\",\"count\":1}"), "{text}");
}

#[test]
fn bedrooms_are_numbered_and_one_without_a_door_is_left_out() {
    let (plan, layout) = plan(BEDROOMS);
    let ids: Vec<&str> = layout.rooms.iter().map(|room| room.id.id()).collect();
    assert_eq!(ids, ["LivingRoom", "Bedroom", "GuestRoom", "Bedroom2"]);
    assert_eq!(plan.rooms.iter().map(|room| room.name.as_str()).collect::<Vec<_>>(), ["second bedroom"]);
    assert!(plan.report.notes.iter().any(|note| note.starts_with("/rooms/4: no door leads into")), "{:?}", plan.report);
    assert_eq!(count(&plan, "Bed", Reason::OutsideRooms), 1);
}

#[test]
fn what_fits_nowhere_is_left_out_and_no_room_is_shut_off() {
    let (plan, layout) = plan(BEDROOMS);
    let reasons = [Reason::NoSpace, Reason::InTheWay, Reason::OutsideRooms];
    let left_out: usize = reasons.into_iter().map(|reason| count(&plan, "ShelvingUnit", reason)).sum();
    let is_shelf =
        |placement: &&Placement| ["Bookcase", "Storage_Shelf"].iter().any(|c| placement.instance.starts_with(c));
    let placed = layout.placements.iter().filter(is_shelf).count();
    assert!(left_out > 0 && placed > 0, "{:?}", plan.report);
    assert_eq!(placed + left_out, 9);
}

#[test]
fn the_same_house_makes_the_same_plan() {
    assert_eq!(plan(FLAT).0.text, plan(FLAT).0.text);
}

#[test]
fn houses_make_a_pack_that_goes_with_the_pack_homes() {
    let mut pack = HousePack::new("thor", IMPORTER.world()).unwrap();
    for (number, text) in [FLAT, BEDROOMS].into_iter().enumerate() {
        pack.add(&IMPORTER.plan(&plan_id("Thor", number), text).unwrap()).unwrap();
    }
    assert_eq!(pack.count(), 2);
    let files = pack.files().into_iter().map(|(path, text)| PackFile { path, bytes: text.into_bytes() }).collect();
    let homes = WorldPack::builtin("homes").unwrap();
    let world = WorldData::layered(vec![homes, WorldPack::parse("thor", files).unwrap()]).unwrap();
    for id in ["Thor0000", "Thor0001", "Thor0001_mirror"] {
        assert!(Layout::find(id, world.catalog()).unwrap().faults(world.catalog()).is_empty(), "{id}");
    }
    assert_eq!(world.catalog().rooms().find("second bedroom"), RoomId::new("Bedroom2"));
    let (file, text) = world.packs()[1].missions().next().unwrap();
    assert!(cohabit_cdf::mission::read_mission(file, text, world.catalog()).is_ok());
}

#[test]
fn names_that_cannot_be_are_refused() {
    assert!(
        HousePack::new("My Houses", IMPORTER.world()).unwrap_err().to_string().contains("begin with a small letter")
    );
    assert!(check_prefix("Thor").is_ok());
    for prefix in ["", "a/b", "Thor Thor", &"x".repeat(25)] {
        assert!(check_prefix(prefix).is_err(), "{prefix}");
    }
}
