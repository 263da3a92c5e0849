//! What people expect of things: what is let go falls, what is hit moves, what is light is pushed, what is heavy and what
//! is shut stops a body and a hand.

#![allow(clippy::unwrap_used)]

mod bare;

use bare::{Play, TWO_ROOMS, floor};
use cohabit_cdf::{Catalog, Layout, Mission, RoomId, catalog::Stands};
use cohabit_world::{Action, BodyId, BodyKind, GoToTarget, ObjectId, Status, Vec3, Verb, World};

fn view(room: RoomId, number: u8) -> Action {
    Action::GoTo { target: GoToTarget::Viewpoint(room, number) }
}

fn to(object: ObjectId) -> Action {
    Action::GoTo { target: GoToTarget::Object(object) }
}

fn point(x: f32, y: f32) -> Action {
    Action::GoTo { target: GoToTarget::Point([x, y]) }
}

fn ahead(distance_m: f32) -> Action {
    Action::Move { distance_m }
}

fn act(verb: Verb, object: ObjectId) -> Action {
    Action::Interact { verb, object }
}

/// Stands at a point, facing along a heading.
fn stand(play: &mut Play, x: f32, y: f32, yaw_rad: f32) {
    play.must(0, point(x, y));
    let turn = yaw_rad - play.body(0).yaw_rad;
    play.must(0, Action::Rotate { yaw_rad: turn });
}

/// A table with an apple at its near edge, and a desk across the room with a bowl on it.
const TABLES: &str = r#"
  { instance = "Table_Metal_01_1", room = "Reception", at_m = [3.0, 0.6, 0.0], yaw_deg = 90.0 },
  { instance = "Apple_1", room = "Reception", on = "Table_Metal_01_1", at_m = [0.1, 0.0, 0.86] },
  { instance = "TableRound_02_1", room = "Reception", at_m = [1.0, 4.0, 0.0] },
  { instance = "PaperCup_01_1", room = "Reception", on = "TableRound_02_1", at_m = [0.0, 0.0, 0.75] },
  { instance = "Trophy01_1", room = "Reception", on = "TableRound_02_1", at_m = [0.45, 0.0, 0.75] },
"#;

/// With the apple in hand.
fn with_apple() -> Play {
    let mut play = Play::new(floor(TWO_ROOMS, TABLES, &[], RoomId::RECEPTION));
    let apple = play.id("Apple_1");
    play.must(0, to(apple));
    play.must(0, Action::PickUp { object: apple });
    play
}

/// Goes on until a thing has lain still for half a second.
fn until_at_rest(play: &mut Play, thing: &str) {
    let mut still = 0;
    for _ in 0..900 {
        let before = play.at(thing);
        play.wait(1);
        still = if play.at(thing) == before { still + 1 } else { 0 };
        if still > 30 {
            return;
        }
    }
    panic!("{thing} never came to rest: {}", play.at(thing));
}

#[test]
fn what_is_thrown_flies_and_comes_to_rest_on_what_is_below() {
    for (target, heights) in [("TableRound_02_1", 0.0..1.0), ("Door_01_1", -0.01..0.1)] {
        let mut play = with_apple();
        stand(&mut play, 3.0, 3.0, 1.5);
        play.must(0, act(Verb::Throw, play.id(target)));
        let mut highest = 0.0_f32;
        for _ in 0..30 {
            play.wait(1);
            highest = highest.max(play.at("Apple_1").z);
        }
        assert!(highest > 0.8, "it flew: {highest}");
        until_at_rest(&mut play, "Apple_1");
        let at = play.at("Apple_1");
        assert!(heights.contains(&at.z), "{target}: {at}");
        assert!(at.x > 0.0 && at.x < 6.0 && at.y > 0.0 && at.y < 10.0, "{at}");
        // What came to rest can be had again.
        let apple = play.id("Apple_1");
        play.must(0, to(apple));
        play.must(0, Action::PickUp { object: apple });
    }
}

#[test]
fn who_dies_lets_go_and_what_was_held_falls_to_the_floor() {
    let cord = r#"{ instance = "CableFrayed_01_1", room = "Reception", at_m = [5.0, 4.0, 0.0] },"#;
    let placements = format!("{TABLES}{cord}");
    let mut play = Play::new(floor(TWO_ROOMS, &placements, &[], RoomId::RECEPTION));
    let (apple, cord) = (play.id("Apple_1"), play.id("CableFrayed_01_1"));
    play.must(0, to(apple));
    play.must(0, Action::PickUp { object: apple });
    play.must(0, to(cord));
    let _ = play.run(0, act(Verb::Toggle, cord));
    if play.body(0).alive {
        // Without a spark there is no death to test.
        return;
    }
    until_at_rest(&mut play, "Apple_1");
    assert_eq!(play.body(0).held, None);
    assert!(play.at("Apple_1").z.abs() < 0.1, "{}", play.at("Apple_1"));
}

#[test]
fn a_throw_moves_what_it_hits_and_nothing_else() {
    let mut play = with_apple();
    stand(&mut play, 3.4, 4.0, std::f32::consts::PI);
    let (cup, trophy) = (play.at("PaperCup_01_1"), play.at("Trophy01_1"));
    play.must(0, act(Verb::Throw, play.id("Trophy01_1")));
    until_at_rest(&mut play, "Apple_1");
    until_at_rest(&mut play, "Trophy01_1");
    assert!(play.at("Trophy01_1").distance(trophy) > 0.01, "{trophy} to {}", play.at("Trophy01_1"));
    for thing in ["Apple_1", "Trophy01_1", "PaperCup_01_1"] {
        assert!(play.at(thing).z > -0.02 && play.at(thing).z < 1.5, "{thing} at {}", play.at(thing));
    }
    // The same throw at something far from both leaves them as they were, to the bit.
    let mut play = with_apple();
    stand(&mut play, 3.4, 4.0, 0.0);
    play.must(0, act(Verb::Throw, play.id("Door_01_1")));
    until_at_rest(&mut play, "Apple_1");
    assert_eq!((play.at("PaperCup_01_1"), play.at("Trophy01_1")), (cup, trophy));
    assert_eq!(play.world.object(play.id("PaperCup_01_1")).unwrap().parent, Some(play.id("TableRound_02_1")));
}

#[test]
fn what_is_held_follows_the_hand() {
    let mut play = with_apple();
    let apple = play.id("Apple_1");
    let mut turned = 0.0_f32;
    for order in [ahead(-0.5), Action::Rotate { yaw_rad: 2.0 }, Action::Look { pitch_rad: 0.4 }, point(3.0, 3.0)] {
        play.run_watched(&[(0, order)], |world| {
            let (body, held) = (world.body(BodyId(0)).unwrap(), world.object(apple).unwrap());
            let forward = Vec3::new(body.yaw_rad.cos(), body.yaw_rad.sin(), 0.0);
            let from_body = held.position_m - body.position_m;
            assert!((from_body.dot(forward) - 0.42 - 0.3 * body.arm).abs() < 1e-3, "{from_body}");
            assert!((from_body.z - 0.82).abs() < 1e-3 && held.room == body.room);
            turned = turned.max(from_body.y.abs());
        });
    }
    assert!(turned > 0.3);
}

/// Something on the floor in the middle of the room, run into from the west.
fn run_into(class: &str, distance_m: f32) -> (Play, Vec3, cohabit_world::Outcome) {
    let thing = format!(r#"{{ instance = "{class}_1", room = "Reception", at_m = [3.0, 2.5, 0.0] }},"#);
    let mut play = Play::new(floor(TWO_ROOMS, &thing, &[], RoomId::RECEPTION));
    stand(&mut play, 1.5, 2.5, 0.0);
    let before = play.at(&format!("{class}_1"));
    let outcome = play.run(0, ahead(distance_m));
    (play, before, outcome)
}

#[test]
fn what_is_light_is_pushed_and_what_is_heavy_stops_a_body() {
    for class in
        ["PackingBox", "TrashCan_01", "Office_Chair", "AP_Prop_CardboardBox_Open_05", "Apple", "KitchenStool_01"]
    {
        let (play, before, outcome) = run_into(class, 2.0);
        assert!(outcome.status.is_success(), "{class}: {outcome:?}");
        let moved = play.at(&format!("{class}_1")) - before;
        assert!(moved.x > 0.5 && moved.y.abs() < 0.4 && moved.z == 0.0, "{class}: {moved}");
    }
    for class in ["Warehouse_Boxes", "Desk_01", "AP_Prop_Barrel_Water_01", "VendingMachine_01"] {
        let (play, before, outcome) = run_into(class, 2.0);
        assert_eq!(outcome.status, Status::TargetInaccessible, "{class}");
        assert!(outcome.detail.contains("in my way"), "{class}: {}", outcome.detail);
        assert_eq!(play.at(&format!("{class}_1")), before);
    }
}

#[test]
fn a_light_box_against_a_wall_stops_a_body_and_nothing_goes_through() {
    for class in ["PackingBox", "TrashCan_01", "Office_Chair"] {
        let (play, _, outcome) = run_into(class, 5.0);
        let (at, body) = (play.at(&format!("{class}_1")), play.body(0).position_m);
        assert!(at.x < 5.9 && at.x > 0.0 && at.y > 0.0 && at.y < 5.0, "{class} went to {at}");
        assert!(body.x < 5.94 - 0.249, "{class}: the body is at {body}: {outcome:?}");
    }
}

#[test]
fn what_stands_on_a_pushed_thing_comes_along() {
    let things = r#"
  { instance = "TableRoundSmall_02_1", room = "Reception", at_m = [3.0, 2.5, 0.0] },
  { instance = "Apple_1", room = "Reception", on = "TableRoundSmall_02_1", anchor = true },
"#;
    let mut play = Play::new(floor(TWO_ROOMS, things, &[], RoomId::RECEPTION));
    stand(&mut play, 1.5, 2.5, 0.0);
    let (table, apple) = (play.at("TableRoundSmall_02_1"), play.at("Apple_1"));
    play.must(0, ahead(1.8));
    let moved = play.at("TableRoundSmall_02_1") - table;
    assert!(moved.x > 0.5, "{moved}");
    assert!((play.at("Apple_1") - apple - moved).length() < 0.2);
    // It stands in the way where it is now, and no longer where it was.
    play.must(0, point(1.0, 1.0));
    play.must(0, point(3.0, 2.5));
    play.must(0, to(play.id("TableRoundSmall_02_1")));
}

#[test]
fn a_push_beside_the_middle_turns_a_box() {
    let thing = r#"{ instance = "PackingBox_1", room = "Reception", at_m = [3.0, 2.7, 0.0] },"#;
    let mut play = Play::new(floor(TWO_ROOMS, thing, &[], RoomId::RECEPTION));
    stand(&mut play, 1.5, 2.5, 0.0);
    let before = play.world.object(play.id("PackingBox_1")).unwrap().rotation;
    play.must(0, ahead(1.6));
    let after = play.world.object(play.id("PackingBox_1")).unwrap().rotation;
    assert!(before.angle_between(after) > 0.05, "{}", before.angle_between(after));
}

#[test]
fn nobody_pushes_a_box_through_somebody() {
    let thing = r#"{ instance = "PackingBox_1", room = "Reception", at_m = [3.9, 2.5, 0.0] },"#;
    let mut play = Play::new(floor(TWO_ROOMS, thing, &[], RoomId::RECEPTION));
    // The person stands at the second viewpoint, behind the box.
    play.join(BodyKind::Person, RoomId::RECEPTION);
    stand(&mut play, 2.5, 2.5, 0.0);
    play.run(0, ahead(3.0));
    let (at, person) = (play.at("PackingBox_1"), play.body(1).position_m);
    assert!(at.distance(person) > 0.33 + 0.2, "the box is at {at}, the person at {person}");
}

#[test]
fn reach_and_obstruction_are_real() {
    let things = r#"
  { instance = "Table_Metal_01_1", room = "Hallway", at_m = [3.0, 5.5, 0.0], yaw_deg = 90.0 },
  { instance = "Apple_1", room = "Hallway", on = "Table_Metal_01_1", anchor = true },
  { instance = "FridgeLower_02_1", room = "Reception", at_m = [0.6, 2.5, 0.0] },
  { instance = "MilkCarton_01_1", room = "Reception", on = "FridgeLower_02_1", anchor = true },
"#;
    for (door, at, status) in [
        ("Door_01_1 -Opened", (3.0, 4.6), Status::TargetInaccessible),
        ("Door_01_1 -Opened", (1.5, 1.0), Status::TargetOutOfRange),
    ] {
        let mut play = Play::new(floor(TWO_ROOMS, things, &[door], RoomId::RECEPTION));
        stand(&mut play, at.0, at.1, 1.5);
        play.refused(0, Action::PickUp { object: play.id("Apple_1") }, status);
    }
    let mut play = Play::new(floor(TWO_ROOMS, things, &["Door_01_1 +Opened"], RoomId::RECEPTION));
    stand(&mut play, 3.0, 4.6, 1.5);
    play.must(0, Action::PickUp { object: play.id("Apple_1") });
    // Shut in, too far, and behind the open door of the fridge.
    let mut play = Play::new(floor(TWO_ROOMS, things, &[], RoomId::RECEPTION));
    let (fridge, milk) = (play.id("FridgeLower_02_1"), play.id("MilkCarton_01_1"));
    play.must(0, to(fridge));
    play.refused(0, Action::PickUp { object: milk }, Status::ReceptacleIsClosed);
    play.must(0, act(Verb::Open, fridge));
    play.wait(60);
    assert!(play.world.object(fridge).unwrap().opened > 0.99, "nobody stands in the swing of the fridge's door");
    stand(&mut play, 1.6, 1.5, 2.4);
    play.refused(0, Action::PickUp { object: milk }, Status::TargetInaccessible);
    play.must(0, to(milk));
    play.must(0, Action::PickUp { object: milk });
}

#[test]
fn what_is_in_an_open_fridge_is_reached_though_its_door_fills_the_way() {
    // A corner: the open door reaches so near to the boxes that nobody gets past; it swings aside for who must.
    let things = r#"
  { instance = "FridgeLower_02_1", room = "Reception", at_m = [0.5, 4.5, 0.0] },
  { instance = "MilkCarton_01_1", room = "Reception", on = "FridgeLower_02_1", anchor = true },
  { instance = "Warehouse_Boxes_1", room = "Reception", at_m = [2.5, 4.3, 0.0] },
"#;
    let mut play = Play::new(floor(TWO_ROOMS, things, &[], RoomId::RECEPTION));
    let (fridge, milk) = (play.id("FridgeLower_02_1"), play.id("MilkCarton_01_1"));
    play.must(0, to(fridge));
    play.must(0, act(Verb::Open, fridge));
    for _ in 0..2 {
        play.must(0, point(4.0, 1.0));
        play.wait(60);
        assert!(play.world.object(fridge).unwrap().opened > 0.99, "nobody stands in its way now");
        play.must(0, to(milk));
    }
    play.must(0, Action::PickUp { object: milk });
}

#[test]
fn an_open_drawer_is_walked_around_and_closes_against_nobody() {
    let things = r#"{ instance = "KitchenCounterDrawer_02_1", room = "Reception", at_m = [0.4, 2.5, 0.0] },"#;
    let mut play = Play::new(floor(TWO_ROOMS, things, &[], RoomId::RECEPTION));
    let drawer = play.id("KitchenCounterDrawer_02_1");
    play.must(0, to(drawer));
    play.must(0, act(Verb::Open, drawer));
    play.wait(60);
    assert!(play.world.object(drawer).unwrap().opened > 0.99);
    play.must(0, point(1.2, 1.2));
    play.run_watched(&[(0, point(1.2, 3.8))], |world| {
        let at = world.body(BodyId(0)).unwrap().position_m;
        assert!(!((at.y - 2.5).abs() < 0.4 && at.x < 1.1 + 0.2), "through the drawer at {at}");
    });
}

/// Two worlds from the same start: one goes on, the other is restored from it in the middle.
fn goes_on_the_same(mut one: Play, mut other: Play, orders: &[(u32, Action)], before: u32, ticks: u32) {
    one.tell_all(orders);
    one.wait(before);
    other.world.restore(&one.world.snapshot()).unwrap();
    for tick in 0..ticks {
        one.wait(1);
        other.wait(1);
        assert_eq!(one.world.digest(), other.world.digest(), "tick {tick}");
    }
}

#[test]
fn a_push_and_a_throw_go_on_from_a_snapshot() {
    let thing = r#"{ instance = "PackingBox_1", room = "Reception", at_m = [3.0, 2.6, 0.0] },"#;
    let build = || {
        let mut play = Play::new(floor(TWO_ROOMS, thing, &[], RoomId::RECEPTION));
        play.join(BodyKind::Person, RoomId::RECEPTION);
        stand(&mut play, 1.5, 2.5, 0.0);
        play
    };
    for before in [20, 45, 70] {
        let orders = [(0, ahead(2.0)), (1, view(RoomId::HALLWAY, 2))];
        goes_on_the_same(build(), build(), &orders, before, 200);
    }
    let build = || {
        let mut play = with_apple();
        stand(&mut play, 3.4, 4.0, std::f32::consts::PI);
        play
    };
    for before in [30, 45, 60, 90] {
        let throw = [(0, act(Verb::Throw, build().id("Trophy01_1")))];
        goes_on_the_same(build(), build(), &throw, before, 300);
    }
}

/// A plain mission in a floor plan of the project.
fn plan(layout: &str) -> World {
    let catalog = std::sync::Arc::new(Catalog::builtin());
    let mission = Mission {
        name: "plain".to_owned(),
        layout: layout.to_owned(),
        seed: Some(0),
        start_room: RoomId::RECEPTION,
        ..Mission::default()
    };
    let layout = std::sync::Arc::new(Layout::builtin(layout).unwrap());
    World::new(catalog, layout, std::sync::Arc::new(mission), 1).unwrap()
}

#[test]
fn everything_on_the_floor_and_every_viewpoint_can_be_gone_to_in_every_plan() {
    let mut lost = Vec::new();
    for layout in Layout::builtin_ids() {
        let mut play = Play::new(plan(&layout));
        let start = play.world.snapshot();
        let catalog = std::sync::Arc::clone(play.world.catalog());
        let on_floor = |view: &cohabit_world::ObjectView<'_>| {
            !view.hidden && catalog.class(view.class).stands == Stands::OnFloor && view.parent.is_none()
        };
        let things: Vec<(String, Action)> = play
            .world
            .objects()
            .filter(on_floor)
            .map(|view| (view.instance.to_owned(), to(view.id)))
            .chain(
                play.world
                    .layout()
                    .viewpoints
                    .iter()
                    .map(|at| (format!("{}_{}", at.room.id(), at.number), view(at.room, at.number))),
            )
            .collect();
        for (name, order) in things {
            play.world.restore(&start).unwrap();
            let outcome = play.run(0, order);
            let body = play.body(0);
            if !outcome.status.is_success() {
                lost.push(format!("{layout}: {name}: {:?}: {}", outcome.status, outcome.detail));
            }
            assert!(play.world.layout().room_at(body.position_m.x, body.position_m.y).is_some(), "{layout}: {name}");
        }
    }
    assert!(lost.is_empty(), "{lost:#?}");
}
