//! Pedestrians with bodies that do at once as they are told, on bare floors.

use cohabit_cdf::{BodyKind, Catalog, RoomId};

use super::*;
use crate::pedestrian::Schedule;

fn floor() -> Floor {
    Floor {
        obstacles: Vec::new(),
        viewpoints: vec![(RoomId::LAB1, 1, Vec2::new(0.0, 4.0)), (RoomId::LAB1, 2, Vec2::new(4.0, 4.0))],
        doors: Vec::new(),
        path: Box::new(|_: Vec2, to: Vec2| (to.x < 100.0).then(|| vec![to])),
    }
}

fn person(schedule: &str, seed: u64) -> Person {
    let schedule = Schedule::parse("a.toml", schedule, &Catalog::builtin()).unwrap();
    Person::new(1, schedule.entries(1), seed)
}

/// What a body does for so many looks, with somebody else who stands there: places after each look, and commands to walk.
fn play(person: &mut Person, looks: u64, other_m: Vec2, shut: &[Vec2]) -> (Vec<Vec2>, Vec<Action>) {
    let floor = floor();
    let still = |at_m| Walker { at_m, velocity_m_s: Vec2::ZERO, radius_m: 0.22 };
    let (mut own, mut yaw_rad, mut places, mut walks) = (still(Vec2::ZERO), 0.0_f32, Vec::new(), Vec::new());
    for look in 0..looks {
        let bodies = BTreeMap::from([(1, own), (2, still(other_m))]);
        let tick = look * LOOK_TICKS;
        let around = Around { tick, own, yaw_rad, is_busy: false, bodies: &bodies, records: &[], shut, floor: &floor };
        match person.act(&around) {
            Some(Action::Drive { forward_m_s, turn_rad_s, .. }) => {
                yaw_rad += turn_rad_s * LOOK_S;
                let velocity_m_s = Vec2::new(libm::cosf(yaw_rad), libm::sinf(yaw_rad)) * forward_m_s;
                own = Walker { at_m: own.at_m + velocity_m_s * LOOK_S, velocity_m_s, ..own };
            }
            Some(walk) => walks.push(walk),
            None => own.velocity_m_s = Vec2::ZERO,
        }
        places.push(own.at_m);
    }
    (places, walks)
}

const AWAY: Vec2 = Vec2::new(50.0, 50.0);

#[test]
fn a_schedule_is_walked() {
    let text = "[[entry]]\nperson = 1\ngo_to = \"3.0 0.0\"\n[[entry]]\nperson = 1\nstay_s = 5\n\
                [[entry]]\nperson = 1\ngo_to = \"3.0 3.0\"";
    let (places, walks) = play(&mut person(text, 1), 300, AWAY, &[]);
    assert!(walks.is_empty(), "{walks:?}");
    let near = |point: Vec2| places.iter().filter(|place| place.distance(point) < 0.5).count();
    assert!(near(Vec2::new(3.0, 0.0)) >= 50, "it stays there for five seconds: {places:?}");
    assert!(places[299].distance(Vec2::new(3.0, 3.0)) < 0.6, "{}", places[299]);
}

#[test]
fn the_same_seed_gives_the_same_path_and_another_seed_another_one() {
    let text = "[[entry]]\nperson = 1\ngo_to = \"Lab1\"\nrepeat = true";
    let path = |seed| play(&mut person(text, seed), 400, AWAY, &[]).0;
    assert_eq!(path(7), path(7));
    assert!((8..20).any(|seed| path(7) != path(seed)));
}

#[test]
fn who_is_met_is_walked_up_to_and_faced() {
    let text = "[[entry]]\nperson = 1\nmeet = 2";
    let other = Vec2::new(-4.0, 0.0);
    let (places, _) = play(&mut person(text, 3), 300, other, &[]);
    let last = places[299].distance(other);
    assert!(last < MEETING_M + 0.1 && last > 0.44, "{last}");
}

#[test]
fn a_shut_door_is_left_to_the_body() {
    let text = "[[entry]]\nperson = 1\ngo_to = \"6.0 0.0\"";
    let (_, walks) = play(&mut person(text, 1), 100, AWAY, &[Vec2::new(3.0, 0.1)]);
    let Some(Action::GoTo { target: GoToTarget::Point([x, y]) }) = walks.first() else { panic!("{walks:?}") };
    assert!((*x - 4.0).abs() < 0.2 && y.abs() < 0.2, "{x} {y}");
}

#[test]
fn who_finds_no_way_does_the_next_thing() {
    let text = "[[entry]]\nperson = 1\ngo_to = \"200.0 0.0\"\n[[entry]]\nperson = 1\ngo_to = \"2.0 0.0\"";
    let (places, _) = play(&mut person(text, 1), 300, AWAY, &[]);
    assert!(places[299].distance(Vec2::new(2.0, 0.0)) < 0.6, "{}", places[299]);
}

#[test]
fn who_is_stuck_goes_around_waits_and_at_last_does_the_next_thing() {
    let text = "[[entry]]\nperson = 1\ngo_to = \"6.0 0.0\"\n[[entry]]\nperson = 1\ngo_to = \"0.0 6.0\"";
    let (mut person, floor) = (person(text, 1), floor());
    let still = |at_m| Walker { at_m, velocity_m_s: Vec2::ZERO, radius_m: 0.22 };
    let own = still(Vec2::ZERO);
    let bodies = BTreeMap::from([(1, own), (2, still(Vec2::new(0.6, 0.0)))]);
    let records = [(1, BodyKind::Person), (2, BodyKind::Robot)].map(|(body, kind)| BodyRecord {
        body,
        kind: kind as u32,
        ..BodyRecord::default()
    });
    let (mut walks, mut named) = (Vec::new(), String::new());
    for look in 0..600 {
        let (tick, yaw_rad) = (look * LOOK_TICKS, 0.0);
        let around =
            Around { tick, own, yaw_rad, is_busy: false, bodies: &bodies, records: &records, shut: &[], floor: &floor };
        named = person.obstacle(&around);
        if let Some(Action::GoTo { target: GoToTarget::Point(point) }) = person.act(&around) {
            walks.push(point);
        }
    }
    assert_eq!(named, "the robot of body 2");
    assert_eq!(walks[..4], [[6.0, 0.0], [6.0, 0.0], [6.0, 0.0], [0.0, 6.0]], "{walks:?}");
}

#[test]
fn behind_a_door_is_where_the_way_goes_on() {
    let way = [Vec2::ZERO, Vec2::new(2.0, 0.0), Vec2::new(2.0, 0.4)];
    assert!(beyond(&way, Vec2::new(0.5, 0.3)).unwrap().distance(Vec2::new(1.5, 0.0)) < 1e-5);
    assert_eq!(beyond(&way, Vec2::new(1.9, 0.0)), Some(Vec2::new(2.0, 0.4)));
    assert_eq!(beyond(&way, Vec2::new(0.5, 1.0)), None);
}
