//! Several bodies in one world: they pass each other, make way, wait, and say who is in the way; nobody walks through
//! anybody, through a wall, or through a door on its hinges.

#![allow(clippy::unwrap_used)]

mod bare;

use bare::{Play, TWO_ROOMS, corridor, floor};
use cohabit_cdf::RoomId;
use cohabit_world::{Action, BodyId, BodyKind, GoToTarget, Status, Verb, World};

fn view(room: RoomId, number: u8) -> Action {
    Action::GoTo { target: GoToTarget::Viewpoint(room, number) }
}

fn ahead(distance_m: f32) -> Action {
    Action::Move { distance_m }
}

/// Nobody comes closer to anybody than both are wide, but for a millimetre.
fn keep_apart(world: &World) {
    let bodies: Vec<_> = world.bodies().collect();
    for (index, one) in bodies.iter().enumerate() {
        for two in &bodies[..index] {
            let distance = one.position_m.distance(two.position_m);
            let least = one.radius_m + two.radius_m;
            assert!(distance > least - 1e-3, "tick {}: {distance} m apart, not {least}", world.tick());
        }
    }
}

#[test]
fn two_meet_in_a_corridor_and_both_arrive() {
    // Wide enough to pass; so narrow that one has to step back into a room; in both orders; people too.
    for width_m in [2.4, 1.4, 1.3, 1.0] {
        for first in [0, 1] {
            for kind in [BodyKind::Robot, BodyKind::Person] {
                let mut play = Play::new(floor(&corridor(width_m), "", &[], RoomId::RECEPTION));
                play.join(kind, RoomId::WAREHOUSE);
                let there = (0, view(RoomId::WAREHOUSE, 1));
                let back = (1, view(RoomId::RECEPTION, 1));
                let orders = if first == 0 { [there, back] } else { [back, there] };
                let outcomes = play.run_watched(&orders, keep_apart);
                for outcome in outcomes {
                    assert!(outcome.status.is_success(), "{width_m} {first} {kind:?}: {outcome:?}");
                }
                assert!(play.body(0).position_m.x > 14.0 && play.body(1).position_m.x < 4.0, "{width_m} {first}");
            }
        }
    }
}

#[test]
fn two_that_pass_do_not_stop_where_there_is_room() {
    let mut alone = Play::new(floor(&corridor(2.4), "", &[], RoomId::RECEPTION));
    alone.must(0, view(RoomId::WAREHOUSE, 1));
    let mut play = Play::new(floor(&corridor(2.4), "", &[], RoomId::RECEPTION));
    play.join(BodyKind::Robot, RoomId::WAREHOUSE);
    play.run_watched(&[(0, view(RoomId::WAREHOUSE, 1)), (1, view(RoomId::RECEPTION, 1))], keep_apart);
    let (alone, both) = (alone.world.tick(), play.world.tick());
    assert!(both < alone + 90, "{both} ticks with somebody coming, {alone} alone");
}

#[test]
fn a_robot_goes_around_a_person_who_stands() {
    for width_m in [2.4, 1.8] {
        let mut play = Play::new(floor(&corridor(width_m), "", &[], RoomId::RECEPTION));
        play.join(BodyKind::Person, RoomId::HALLWAY);
        let stood = play.body(1).position_m;
        let outcomes = play.run_watched(&[(0, view(RoomId::WAREHOUSE, 1))], keep_apart);
        assert!(outcomes[0].status.is_success(), "{width_m}: {outcomes:?}");
        assert_eq!(play.body(1).position_m, stood);
    }
}

#[test]
fn who_stands_in_the_way_is_named() {
    let mut play = Play::new(floor(&corridor(1.0), "", &[], RoomId::RECEPTION));
    play.join(BodyKind::Person, RoomId::HALLWAY);
    let outcomes = play.run_watched(&[(0, view(RoomId::WAREHOUSE, 1))], keep_apart);
    let named = (Status::TargetInaccessible, "the person is in my way");
    assert_eq!((outcomes[0].status, outcomes[0].detail.as_str()), named);
    // The same for a plain step forward.
    let outcomes = play.run_watched(&[(0, ahead(3.0))], keep_apart);
    assert_eq!((outcomes[0].status, outcomes[0].detail.as_str()), named);
    // Of several people it is said which, counted as people.
    play.join(BodyKind::Person, RoomId::RECEPTION);
    let outcomes = play.run_watched(&[(0, ahead(3.0))], keep_apart);
    assert_eq!(outcomes[0].detail, "person 1 is in my way");
}

#[test]
fn a_robot_that_has_nothing_to_do_makes_way() {
    let mut play = Play::new(floor(&corridor(1.0), "", &[], RoomId::RECEPTION));
    play.join(BodyKind::Robot, RoomId::HALLWAY);
    let stood = play.body(1).position_m;
    let outcomes = play.run_watched(&[(0, view(RoomId::WAREHOUSE, 1))], keep_apart);
    // Nobody asked it to, so nobody is told of it.
    assert_eq!(outcomes.len(), 1, "{outcomes:?}");
    assert!(outcomes[0].status.is_success(), "{outcomes:?}");
    assert_ne!(play.body(1).position_m, stood);
}

#[test]
fn who_walks_ahead_is_followed() {
    let mut play = Play::new(floor(&corridor(1.0), "", &[], RoomId::RECEPTION));
    play.join(BodyKind::Person, RoomId::HALLWAY);
    let outcomes = play.run_watched(&[(0, view(RoomId::WAREHOUSE, 1)), (1, view(RoomId::WAREHOUSE, 2))], keep_apart);
    assert!(outcomes.iter().all(|outcome| outcome.status.is_success()), "{outcomes:?}");
}

#[test]
fn six_cross_one_floor() {
    let mut play = Play::new(floor(TWO_ROOMS, "", &[], RoomId::RECEPTION));
    for (kind, room) in [
        (BodyKind::Person, RoomId::RECEPTION),
        (BodyKind::Robot, RoomId::RECEPTION),
        (BodyKind::Robot, RoomId::HALLWAY),
        (BodyKind::Person, RoomId::HALLWAY),
        (BodyKind::Robot, RoomId::HALLWAY),
    ] {
        play.join(kind, room);
    }
    let orders: Vec<(u32, Action)> = (0..6_u32)
        .map(|body| {
            let y = if body < 3 { 8.5 } else { 1.5 };
            (body, Action::GoTo { target: GoToTarget::Point([(body % 3) as f32 * 2.0 + 1.0, y]) })
        })
        .collect();
    let mut track = Vec::new();
    let outcomes = play.run_watched(&orders, |world| {
        keep_apart(world);
        if world.tick() % 30 == 0 {
            let at: Vec<String> =
                world.bodies().map(|body| format!("{:.2},{:.2}", body.position_m.x, body.position_m.y)).collect();
            track.push(format!("{}: {}", world.tick(), at.join("  ")));
        }
    });
    println!("{}", track.join("\n"));
    let through = play.world.bodies().filter(|body| (body.position_m.y > 5.0) == (body.id.0 < 3)).count();
    assert_eq!(through, 6, "{outcomes:#?}");
}

#[test]
fn each_has_its_own_figure_hand_and_outcomes() {
    let apples = r#"
  { instance = "Table_Metal_01_1", room = "Reception", at_m = [3.0, 1.0, 0.0], yaw_deg = 90.0 },
  { instance = "Apple_1", room = "Reception", on = "Table_Metal_01_1", anchor = true },
  { instance = "Apple_2", room = "Reception", on = "Table_Metal_01_1", anchor = true },
"#;
    let mut play = Play::new(floor(TWO_ROOMS, apples, &[], RoomId::RECEPTION));
    play.join(BodyKind::Person, RoomId::RECEPTION);
    assert!(play.body(1).eye.z > play.body(0).eye.z + 0.2 && play.body(1).height_m > play.body(0).height_m);
    let fetch: Vec<(u32, Action)> = [(0, "Apple_1"), (1, "Apple_2")]
        .map(|(body, apple)| (body, Action::GoTo { target: GoToTarget::Object(play.id(apple)) }))
        .to_vec();
    let outcomes = play.run_watched(&fetch, keep_apart);
    assert!(outcomes.iter().all(|outcome| outcome.status.is_success()), "{outcomes:?}");
    let (one, two) = (play.id("Apple_1"), play.id("Apple_2"));
    let outcomes = play.run_all(&[(0, Action::PickUp { object: one }), (1, Action::PickUp { object: two })]);
    assert_eq!(outcomes.iter().map(|outcome| outcome.body.0).collect::<Vec<_>>(), [0, 1]);
    assert_eq!((play.body(0).held, play.body(1).held), (Some(one), Some(two)));
    assert!(play.at("Apple_2").z > play.at("Apple_1").z + 0.1, "each hand has its own height");
    // What somebody else holds is not to be had.
    play.run(0, Action::Place { receptacle: play.id("Table_Metal_01_1") });
    play.refused(0, Action::PickUp { object: two }, Status::TargetInaccessible);
}

#[test]
fn a_closed_door_stops_who_just_walks_on_and_opens_for_who_goes_through() {
    let mut play = Play::new(floor(TWO_ROOMS, "", &["Door_01_1 -Opened"], RoomId::RECEPTION));
    play.must(0, view(RoomId::RECEPTION, 3));
    let detail = play.refused(0, ahead(1.5), Status::TargetInaccessible);
    assert!(detail.contains("door"), "{detail}");
    assert!(play.body(0).position_m.y < 4.75, "{}", play.body(0).position_m);
    play.must(0, view(RoomId::HALLWAY, 1));
    assert!(play.world.object(play.id("Door_01_1")).unwrap().opened > 0.9);
}

#[test]
fn a_locked_door_is_no_way() {
    let mut play = Play::new(floor(TWO_ROOMS, "", &["Door_01_1 -Opened +Locked"], RoomId::RECEPTION));
    let detail = play.refused(0, view(RoomId::HALLWAY, 1), Status::UnsupportedNavigation);
    assert!(detail.contains("locked"), "{detail}");
}

#[test]
fn a_door_stops_at_who_stands_in_its_swing() {
    // One stands in the swing, another one asks for the door.
    let mut play = Play::new(floor(TWO_ROOMS, "", &["Door_01_1 -Opened"], RoomId::RECEPTION));
    play.join(BodyKind::Person, RoomId::HALLWAY);
    play.must(1, view(RoomId::HALLWAY, 3));
    play.must(0, view(RoomId::RECEPTION, 3));
    let door = play.id("Door_01_1");
    play.must(0, Action::Interact { verb: Verb::Open, object: door });
    play.wait(120);
    let opened = play.world.object(door).unwrap().opened;
    assert!(opened > 0.0 && opened < 0.9, "the leaf went through the person: {opened}");
    play.must(1, view(RoomId::HALLWAY, 2));
    play.wait(60);
    assert!(play.world.object(door).unwrap().opened > 0.99, "the leaf goes on once the person is gone");
}

#[test]
fn who_stands_in_the_swing_steps_out_of_it_to_go_through() {
    let mut play = Play::new(floor(TWO_ROOMS, "", &["Door_01_1 -Opened"], RoomId::HALLWAY));
    play.must(0, view(RoomId::HALLWAY, 3));
    play.must(0, view(RoomId::RECEPTION, 1));
}

#[test]
fn a_door_is_worked_from_the_room_where_the_body_is() {
    for (room, y_m) in [(RoomId::RECEPTION, 0.0..5.0), (RoomId::HALLWAY, 5.0..10.0)] {
        for (state, verb) in [("Door_01_1 +Opened", Verb::Close), ("Door_01_1 -Opened", Verb::Open)] {
            let mut play = Play::new(floor(TWO_ROOMS, "", &[state], room));
            play.must(0, view(room, 1));
            let door = play.id("Door_01_1");
            play.must(0, Action::GoTo { target: GoToTarget::Object(door) });
            play.must(0, Action::Interact { verb, object: door });
            let at = play.body(0).position_m;
            assert!(y_m.contains(&at.y), "{verb:?} from the {room:?}: at {at}");
        }
    }
}

#[test]
fn an_open_door_leaf_is_walked_around() {
    let mut play = Play::new(floor(TWO_ROOMS, "", &["Door_01_1 +Opened"], RoomId::HALLWAY));
    // The leaf stands along x = 3.5 from y = 5 to y = 6.
    for _ in 0..2 {
        let west = Action::GoTo { target: GoToTarget::Point([2.8, 5.6]) };
        let east = Action::GoTo { target: GoToTarget::Point([4.2, 5.6]) };
        play.must(0, west);
        play.run_watched(&[(0, east)], |world| {
            let at = world.body(BodyId(0)).unwrap().position_m;
            let leaf = (at.x - 3.55).abs() < 0.2 && at.y < 5.95;
            assert!(!leaf, "walked through the leaf at {at}");
        });
    }
    play.must(0, Action::GoTo { target: GoToTarget::Point([2.8, 5.6]) });
    play.must(0, Action::Rotate { yaw_rad: -play.body(0).yaw_rad });
    let detail = play.refused(0, ahead(1.0), Status::TargetInaccessible);
    assert!(detail.contains("door"), "{detail}");
}

#[test]
fn meetings_are_the_same_every_time_and_from_a_snapshot() {
    let build = || {
        let mut play = Play::new(floor(&corridor(1.3), "", &[], RoomId::RECEPTION));
        play.join(BodyKind::Person, RoomId::WAREHOUSE);
        play
    };
    let (mut one, mut two, mut three) = (build(), build(), build());
    let orders = [(0, view(RoomId::WAREHOUSE, 1)), (1, view(RoomId::RECEPTION, 1))];
    one.tell_all(&orders);
    two.tell_all(&orders);
    for tick in 0..900 {
        if tick % 100 == 50 {
            three.world.restore(&one.world.snapshot()).unwrap();
        }
        one.wait(1);
        two.wait(1);
        assert_eq!(one.world.digest(), two.world.digest(), "tick {tick}");
        if tick >= 50 {
            three.wait(1);
            assert_eq!(one.world.digest(), three.world.digest(), "restored, tick {tick}");
        }
    }
}
