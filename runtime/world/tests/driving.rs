//! Bodies that people drive: they go on without a stutter while told to, halt when told no more, slide along what they
//! run into, and never go through anything.

#![allow(clippy::unwrap_used)]

mod bare;
mod support;

use std::{cell::RefCell, sync::Arc};

use bare::{Play, TWO_ROOMS, floor};
use cohabit_cdf::{Catalog, RoomId};
use cohabit_world::{Action, BodyId, BodyKind, Input, Outcome, Status, Verb, World};
use proptest::prelude::*;
use support::{sound::check_bodies, stage::kitchen, walls::Walls};

/// Ticks between two messages of somebody who holds a key down.
const RENEWED_TICKS: u32 = 7;
/// A person's pace, m/s.
const WALK_M_S: f32 = 1.3;

fn drive(forward_m_s: f32, turn_rad_s: f32) -> Action {
    Action::Drive { forward_m_s, turn_rad_s, pitch_rad_s: 0.0 }
}

/// A person at a viewpoint of the reception, heading as wanted, with a robot in the hallway.
fn person(number: u8, yaw_deg: f32, wishes: &[&str]) -> Play {
    let mut play = Play::new(floor(TWO_ROOMS, "", wishes, RoomId::HALLWAY));
    play.join(BodyKind::Person, RoomId::RECEPTION);
    let target = cohabit_world::GoToTarget::Viewpoint(RoomId::RECEPTION, number);
    play.must(1, Action::GoTo { target });
    let turn = yaw_deg.to_radians() - play.body(1).yaw_rad;
    play.must(1, Action::Rotate { yaw_rad: turn });
    play
}

/// Holds a key down for so many ticks; the outcomes, and what `watch` says of every tick.
fn hold(play: &mut Play, action: Action, ticks: u32, mut watch: impl FnMut(&World)) -> Vec<Outcome> {
    let mut outcomes = Vec::new();
    for tick in 0..ticks {
        // Below all that `Play` counts, which waits for its own commands alone.
        let input = Input { command: 0, body: BodyId(1), action };
        let report = play.world.step(if tick % RENEWED_TICKS == 0 { std::slice::from_ref(&input) } else { &[] });
        outcomes.extend(report.outcomes);
        watch(&play.world);
    }
    outcomes
}

#[test]
fn a_key_held_down_goes_on_without_a_stutter() {
    let mut play = person(1, 0.0, &[]);
    let mut paces = Vec::new();
    let outcomes = hold(&mut play, drive(9.0, 0.0), 140, |world| paces.push(world.body(BodyId(1)).unwrap().speed_m_s));
    assert!(paces.windows(2).all(|pair| pair[1] >= pair[0]), "{paces:?}");
    assert_eq!(paces.last(), Some(&WALK_M_S), "no faster than a person walks");
    assert_eq!(outcomes.len(), 19, "one for each that was renewed");
    assert!(outcomes.iter().all(|outcome| outcome.status == Status::ActionSuccessful), "{outcomes:?}");
}

#[test]
fn who_is_told_no_more_halts() {
    let mut play = person(1, 0.0, &[]);
    let from = play.body(1).position_m;
    let outcome = play.must(1, drive(1.3, 0.4));
    let body = play.body(1);
    assert!(outcome.detail.contains("driven"), "{outcome:?}");
    assert!((body.speed_m_s, body.busy) == (0.0, false) && body.position_m.distance(from) < 0.7, "{body:?}");
    assert!((0.1..0.4).contains(&body.yaw_rad), "turned for half a second: {}", body.yaw_rad);
}

#[test]
fn letting_go_of_the_keys_brakes() {
    let mut play = person(1, 0.0, &[]);
    hold(&mut play, drive(1.3, 0.0), 70, |_| {});
    let from = play.body(1).position_m;
    play.must(1, drive(0.0, 0.0));
    let way = play.body(1).position_m.distance(from);
    assert!((0.1..0.25).contains(&way), "{way} m to a halt");
}

#[test]
fn a_body_slides_along_a_wall() {
    // North-east, into the wall between the rooms, east of the door.
    let mut play = person(3, 0.0, &["Door_01_1 -Opened"]);
    hold(&mut play, drive(1.3, 0.0), 60, |_| {});
    hold(&mut play, drive(0.0, 1.3), 35, |_| {});
    let from = play.body(1).position_m;
    hold(&mut play, drive(1.3, 0.0), 100, |_| {});
    let to = play.body(1).position_m;
    assert!(to.x - from.x > 0.5 && to.y < 5.0 - 0.22, "from {from} to {to}");
}

#[test]
fn a_closed_door_stops_who_drives_until_a_hand_opens_it() {
    let mut play = person(3, 90.0, &["Door_01_1 -Opened"]);
    let door = play.id("Door_01_1");
    hold(&mut play, drive(1.3, 0.0), 120, |_| {});
    assert!(play.body(1).position_m.y < 4.8, "{}", play.body(1).position_m);
    assert!(play.world.object(door).unwrap().opened == 0.0, "nobody opened it");
    play.must(1, Action::Interact { verb: Verb::Open, object: door });
    play.wait(60);
    hold(&mut play, drive(1.3, 0.0), 120, |_| {});
    assert!(play.body(1).position_m.y > 5.5, "{}", play.body(1).position_m);
}

#[test]
fn a_hand_ends_the_driving_and_driving_ends_a_walk() {
    let mut play = person(1, 0.0, &["Apple_1"]);
    let apple = play.id("Apple_1");
    let tell =
        |play: &mut Play, command, action| play.world.step(&[Input { command, body: BodyId(1), action }]).outcomes;
    tell(&mut play, 900, drive(1.0, 0.0));
    let ended = tell(&mut play, 901, Action::Interact { verb: Verb::Examine, object: apple });
    assert_eq!((ended[0].command, ended[0].status), (900, Status::Interrupted));
    tell(&mut play, 902, Action::GoTo { target: cohabit_world::GoToTarget::Room(RoomId::HALLWAY) });
    let ended = tell(&mut play, 903, drive(1.0, 0.0));
    assert_eq!((ended[0].command, ended[0].status), (902, Status::Interrupted));
    // Nonsense stops what was driven.
    let ended = tell(&mut play, 904, drive(f32::NAN, 0.0));
    assert_eq!((ended[0].command, ended[0].status), (903, Status::Interrupted));
    assert_eq!((ended[1].command, ended[1].status), (904, Status::IncorrectActionFormat));
    assert!(!play.body(1).busy && play.body(1).speed_m_s == 0.0);
}

/// A kitchen with a robot and two people, who are back at the start for every case.
struct Floor {
    world: World,
    walls: Walls,
    start: Vec<u8>,
}

impl Floor {
    fn new(catalog: &Arc<Catalog>, layout: &str) -> Self {
        let mut world = kitchen(catalog, layout);
        for room in [RoomId::MAIN_OFFICE, RoomId::BREAK_ROOM] {
            world.add_body(BodyKind::Person, room).unwrap();
        }
        let (walls, start) = (Walls::new(world.layout()), world.snapshot());
        Self { world, walls, start }
    }

    /// Plays what several hold down, each for some ticks; everybody is where a body may be at every tick.
    fn play(&mut self, held: &[(u8, f32, f32, u32)]) -> Result<(), String> {
        self.world.restore(&self.start).unwrap();
        let bodies = self.world.bodies().len() as u32;
        let mut open = 0;
        for (command, (body, forward, turn, ticks)) in (1..).zip(held) {
            let input = Input { command, body: BodyId(u32::from(*body) % bodies), action: drive(*forward, *turn) };
            open += 1;
            for tick in 0..*ticks {
                let report = self.world.step(if tick == 0 { std::slice::from_ref(&input) } else { &[] });
                open -= report.outcomes.len();
                check_bodies(&self.world, &self.walls)?;
            }
        }
        for _ in 0..120 {
            open -= self.world.step(&[]).outcomes.len();
        }
        if open > 0 { Err(format!("{open} commands without an outcome")) } else { Ok(()) }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn nobody_is_driven_through_anything(
        held in prop::collection::vec((any::<u8>(), -3.0_f32..5.0, -4.0_f32..4.0, 1_u32..40), 1..60),
        plan in 0_usize..2,
    ) {
        thread_local! {
            static FLOORS: RefCell<Vec<Floor>> = RefCell::new({
                let catalog = Arc::new(Catalog::builtin());
                ["OfficeLayout1", "OfficeLayout2_mirror"].map(|layout| Floor::new(&catalog, layout)).into()
            });
        }
        FLOORS.with_borrow_mut(|floors| floors[plan].play(&held)).map_err(TestCaseError::fail)?;
    }
}
