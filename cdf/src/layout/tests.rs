//! Every plan of the project is whole: checked against the catalogue and against what missions name.
#![allow(clippy::unwrap_used)]

use super::*;
use crate::{Catalog, WorldData, WorldPack};

#[test]
fn builtin_plans_have_no_faults() {
    let catalog = Catalog::builtin();
    for id in Layout::builtin_ids() {
        let plan = Layout::builtin(&id).unwrap();
        let faults: Vec<String> = plan.faults(&catalog).iter().map(ToString::to_string).collect();
        assert!(faults.is_empty(), "{id}:\n{}", faults.join("\n"));
    }
}

#[test]
fn plans_of_homes_have_no_faults() {
    let homes = WorldData::layered(vec![WorldPack::builtin("homes").unwrap()]).unwrap();
    for id in homes.packs()[0].plans() {
        let plan = Layout::find(id, homes.catalog()).unwrap();
        let faults: Vec<String> = plan.faults(homes.catalog()).iter().map(ToString::to_string).collect();
        assert!(faults.is_empty(), "{id}:\n{}", faults.join("\n"));
    }
}

#[test]
fn builtin_plans_have_room_to_walk() {
    let catalog = Catalog::builtin();
    for id in Layout::builtin_ids() {
        let plan = Layout::builtin(&id).unwrap();
        let area = FreeFloor::new(&plan, &catalog, 0.25).area_m2();
        assert!(area >= 190.0, "{id}: {area} m²");
        assert!(plan.placements.len() >= 150, "{id}: {} objects", plan.placements.len());
    }
}

/// What missions take for granted in every plan.
#[test]
fn builtin_plans_have_what_missions_name() {
    const NAMED: &[(RoomId, &[&str])] = &[
        (
            RoomId::BREAK_ROOM,
            &[
                "Microwave_01_10000",
                "FridgeLower_02_10000",
                "FridgeUpper_02_10000",
                "KitchenCounterSink_01_10000",
                "TableRound_02_1",
                "KitchenCounterTop_02_1",
                "YesterdayMachine_01_1",
                "CoffeeUnMaker_01_1",
                "CoffeeMaker_01_1",
                "Toaster_02",
                "VendingMachine_01",
            ],
        ),
        (
            RoomId::MAIN_OFFICE,
            &[
                "AP_Prop_Desk_Green_10000",
                "AP_Prop_Desk_Red_10000",
                "AP_Prop_Desk_Blue_10000",
                "AP_Prop_Desk_Yellow_10000",
                "Computer_Monitor_01_1",
                "Computer_Monitor_01_2",
                "Computer_Monitor_01_3",
                "Computer_Monitor_01_4",
                "Computer_Monitor_01_5",
            ],
        ),
        (RoomId::SMALL_OFFICE, &["ManagerDesk_10000", "ManagerDesk_10001"]),
        (
            RoomId::LAB1,
            &[
                "Desk_01_10006",
                "Desk_01_10007",
                "Printer_3D_10000",
                "AP_Prop_Shelf_Wall_04_10000",
                "AP_Prop_Shelf_Wall_Laser_10000",
                "V_Monitor_FreezeRay_10000",
                "V_Monitor_Laser_10000",
                "Laser_1",
                "FreezeRay_1",
                "RoboticArm_01_1",
            ],
        ),
        (
            RoomId::LAB2,
            &[
                "Desk_01_10008",
                "EAC_Machine_1",
                "ColorChangerStation_1",
                "ColorChanger_Button_Red_10000",
                "ColorChanger_Button_Green_10000",
                "ColorChanger_Button_Blue_10000",
                "GravityPad_1",
                "V_Monitor_Gravity_10000",
                "V_Monitor_Embiggenator_10000",
                "Embiggenator_10000",
                "PortalGenerator_10000",
                "V_Monitor_Portal_10000",
                "TAMPrototypeHead_01_1",
            ],
        ),
        (RoomId::WAREHOUSE, &["KitchenCabinet_02_10000", "ForkLift_1", "Shelves_Tall_01_10000", "PackingBox_10000"]),
        (RoomId::RECEPTION, &["ReceptionDesk_1", "Security_Button_10000"]),
    ];
    for id in Layout::builtin_ids() {
        let plan = Layout::builtin(&id).unwrap();
        for (room, instances) in NAMED {
            for instance in *instances {
                assert_eq!(plan.placement(instance).map(|found| found.room), Some(*room), "{id}: {instance}");
            }
        }
        let numbered =
            [("Door_01", 7), ("LightSwitch_01", 8), ("Broken_Cord_01", 3), ("FuseBox_01", 2), ("FuseBox_02", 1)];
        for (class, count) in numbered {
            for number in 1..=count {
                assert!(plan.placement(&format!("{class}_{number}")).is_some(), "{id}: {class}_{number}");
            }
        }
        let switched: Vec<RoomId> =
            (1..=8).map(|number| plan.placement(&format!("LightSwitch_01_{number}")).unwrap().room).collect();
        assert!(RoomId::BUILTIN.iter().all(|room| switched.contains(room)), "{id}: a room without a light switch");
        for room in &plan.rooms {
            let feeds = |placement: &&Placement| {
                let circuit = plan.room(placement.room).map(|room| room.circuit);
                placement.instance.starts_with("FuseBox_0") && placement.on.is_none() && circuit == Some(room.circuit)
            };
            assert_eq!(plan.placements.iter().filter(feeds).count(), 1, "{id}: fuse boxes of {:?}", room.id);
        }
        let at_reception = plan.openings.iter().filter(|opening| opening.between.contains(&RoomId::RECEPTION));
        assert_eq!(at_reception.filter(|opening| opening.door.is_some()).count(), 2, "{id}: doors at reception");
    }
}

#[test]
fn rays_face_their_shelves() {
    for id in Layout::builtin_ids() {
        let plan = Layout::builtin(&id).unwrap();
        for ray in ["Laser_1", "FreezeRay_1"] {
            let ray = plan.placement(ray).unwrap();
            let shelf = plan.placement(ray.works.as_ref().unwrap()).unwrap();
            let bearing = libm::atan2f(shelf.at_m[1] - ray.at_m[1], shelf.at_m[0] - ray.at_m[0]).to_degrees();
            let turn = (bearing - ray.yaw_deg).rem_euclid(360.0);
            assert!(turn.min(360.0 - turn) < 1.0, "{id}: {} looks {turn}° past its shelf", ray.instance);
        }
    }
}

/// The pack that `cohabit new world` writes has a plan of two rooms: what is said of it when something of it is changed.
#[test]
fn what_is_missing_in_a_plan_is_named_with_what_to_write() {
    let catalog = Catalog::builtin();
    let file = crate::world_pack::template("my-lab").into_iter().find(|(path, _)| *path == "layouts/Workshop.toml");
    let text = file.unwrap().1.replace("Degreaser_01_1", "Microwave_01_1");
    let check = |text: &str, expected: &[&str]| {
        let faults = Layout::parse("Workshop", &[("Workshop.toml", text)]).unwrap().faults(&catalog);
        let said: Vec<String> = faults.iter().map(|fault| format!("{fault}: {}", fault.remedy())).collect();
        assert_eq!(said.len(), expected.len(), "{said:?}");
        for (said, expected) in said.iter().zip(expected) {
            assert!(said.contains(expected), "`{expected}` is not in {said}");
        }
    };
    let without = |parts: &[&str]| {
        let lines = text.lines().filter(|line| parts.iter().all(|part| !line.contains(part)));
        lines.collect::<Vec<_>>().join("\n")
    };
    check(&text, &[]);
    check(
        &without(&["{ kind = \"door\""]),
        &["Workshop cannot be reached: no door or passage leads into it: add to `opening`: { kind = \"door\", \
           door = \"Door_01_1\", between = [\"Workshop\", \"Hallway\"], at_m = [3.00, 5.00], width_m = 1.0, \
           wall_runs = \"x\" }"],
    );
    check(
        &without(&["\"Workshop\", number = 3", "\"Workshop\", number = 5"]),
        &["Workshop has no viewpoint 3, 5: each room has viewpoints 1 to 8; add to `viewpoint`: \
           { room = \"Workshop\", number = 3, at_m = ["],
    );
    let moved = |to: &str| text.replace("number = 8, at_m = [3.05, 0.85]", &format!("number = 8, at_m = [{to}]"));
    for (to, expected) in [
        ("3.05, 9.0", "viewpoint 8 of Workshop, at [3.05, 9.0], is not in that room: move it"),
        ("3.05, 0.2", "is too near to a wall: move it 0.31 m"),
        ("0.5, 2.5", "is in or too near to `Desk_01_1`"),
    ] {
        check(&moved(to), &[expected]);
    }
    check(&without(&["[1.95, 7.928, 1.4]"]), &["Hallway has 3 places for notes, and needs 4: add to `note_place`"]);
    check(&text.replace("[0.072, 6.55, 1.4]", "[1.0, 6.55, 1.4]"), &["[1.0, 6.55, 1.4] is on no wall of Hallway"]);
    let misspelt = text.replace("\"Desk_01_1\"", "\"Dsk_01_1\"");
    check(&misspelt, &["`Dsk_01_1` is of no class in the catalogue: did you mean"]);
    let works =
        text.replace("{ instance = \"LightSwitch_01_1\",", "{ instance = \"LightSwitch_01_1\", works = \"Dsk_01_1\",");
    check(&works, &["`LightSwitch_01_1` names `Dsk_01_1`, which is not in its room: did you mean `Desk_01_1`?"]);
}

/// A plan and its mirror image aside, no two plans are built alike or look alike.
#[test]
fn builtin_plans_differ_in_shape_and_finish() {
    let plans: Vec<Layout> = Layout::builtin_ids()
        .into_iter()
        .filter(|id| !id.ends_with(mirror::SUFFIX))
        .map(|id| Layout::builtin(&id).unwrap())
        .collect();
    assert_eq!(plans.len(), 5);
    for (index, plan) in plans.iter().enumerate() {
        for other in &plans[..index] {
            for room in &plan.rooms {
                let twin = other.room(room.id).unwrap();
                let both = format!("{} and {}: {:?}", plan.id, other.id, room.id);
                assert_ne!(sides_m(room), sides_m(twin), "{both} have the same outline");
                assert_ne!((&room.floor, &room.wall), (&twin.floor, &twin.wall), "{both} have the same finish");
            }
        }
    }
}

/// Lengths of a room's rectangles, m, wherever they lie.
fn sides_m(room: &Room) -> Vec<[f32; 2]> {
    room.rects_m.iter().map(|rect| [rect[2] - rect[0], rect[3] - rect[1]]).collect()
}

#[test]
fn viewpoints_are_apart_and_show_their_room() {
    /// No two viewpoints of a room are nearer, m.
    const APART_M: f32 = 0.5;
    /// Half of what is seen to the left and right, degrees.
    const HALF_VIEW_DEG: f32 = 35.0;
    /// Nearest and farthest that things count as shown, m.
    const SHOWN_M: std::ops::Range<f32> = 0.8..9.0;
    /// Things shown at least.
    const SHOWN: usize = 4;
    for id in Layout::builtin_ids() {
        let plan = Layout::builtin(&id).unwrap();
        for room in RoomId::BUILTIN {
            let views: Vec<&Viewpoint> = plan.viewpoints.iter().filter(|view| view.room == room).collect();
            assert_eq!(views.len(), 8, "{id}: {room:?}");
            for (index, view) in views.iter().enumerate() {
                let apart = |other: &&Viewpoint| distance_m(view.at_m, other.at_m) >= APART_M;
                assert!(views[..index].iter().all(apart), "{id}: {room:?} {} is near another", view.number);
                let shows = |placement: &&Placement| {
                    let [x, y, _] = plan.origin_in_world_m(placement);
                    let bearing_deg = libm::atan2f(y - view.at_m[1], x - view.at_m[0]).to_degrees();
                    let turn_deg = (bearing_deg - view.yaw_deg + 180.0).rem_euclid(360.0) - 180.0;
                    let is_near = SHOWN_M.contains(&distance_m(view.at_m, [x, y]));
                    placement.room == room && is_near && turn_deg.abs() < HALF_VIEW_DEG
                };
                let shown = plan.placements.iter().filter(shows).count();
                assert!(shown >= SHOWN, "{id}: {room:?} {} shows {shown} things", view.number);
            }
        }
    }
}

fn distance_m(from_m: [f32; 2], to_m: [f32; 2]) -> f32 {
    libm::hypotf(from_m[0] - to_m[0], from_m[1] - to_m[1])
}
