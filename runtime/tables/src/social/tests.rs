//! Measures against what is worked out by hand.

use cohabit_record::{Stop, Travel};

use super::*;
use crate::played::seconds;

const ROBOT_RADIUS_M: f64 = 0.25;
const PERSON_RADIUS_M: f64 = 0.22;
const RADII_M: f64 = ROBOT_RADIUS_M + PERSON_RADIUS_M;
/// Lengths of time are whole ticks.
const TICK_S: f64 = 1.0 / 60.0;

fn stops(ticks: u64, at_m: impl Fn(f64) -> [f64; 2]) -> Vec<Stop> {
    let at = |tick: u64| Stop { tick, at_m: at_m(seconds(tick)), yaw_rad: 0.0 };
    (0..=ticks).map(at).collect()
}

fn trail(kind: BodyKind, stops: Vec<Stop>) -> Trail {
    match kind {
        BodyKind::Robot => Trail { body: 0, kind, radius_m: ROBOT_RADIUS_M, stops },
        BodyKind::Person => Trail { body: 1, kind, radius_m: PERSON_RADIUS_M, stops },
    }
}

/// A robot on that path, and a person who stands there.
fn pair(ticks: u64, robot_m: impl Fn(f64) -> [f64; 2], person_m: [f64; 2]) -> (Trail, Trail) {
    (trail(BodyKind::Robot, stops(ticks, robot_m)), trail(BodyKind::Person, stops(ticks, |_| person_m)))
}

fn assert_near(found: f64, expected: f64, within: f64) {
    assert!((found - expected).abs() <= within, "{found}, not {expected}");
}

/// How long somebody at 1 m/s on a line is within so much of a point that lies so far off the line.
fn chord_s(within_m: f64, off_m: f64) -> f64 {
    2.0 * (within_m * within_m - off_m * off_m).sqrt()
}

#[test]
fn a_straight_pass_at_a_metre() {
    let off_m = 1.0 + RADII_M;
    let (robot, person) = pair(600, |time_s| [time_s - 5.0, 0.0], [0.0, off_m]);
    let near = Near::new(&robot, &person);
    assert_near(near.min_distance_m.unwrap(), 1.0, 1e-4);
    assert_eq!((near.intimate_s, near.contacts), (0.0, 0));
    assert_near(near.personal_s, chord_s(1.2 + RADII_M, off_m), 2.0 * TICK_S);
    assert_near(near.social_s, chord_s(3.6 + RADII_M, off_m), 2.0 * TICK_S);
    assert_near(near.speed_m_s.unwrap(), 1.0, 1e-6);
    let walk = Walk::new(&robot, &[]);
    assert_near(walk.path_m, 10.0, 1e-4);
    assert_near(walk.irregularity_rad_m.unwrap(), 0.0, 1e-9);
    assert_eq!((walk.travels, walk.time_to_goal_s, walk.efficiency, walk.shortest), (0, None, None, None));
}

/// Two metres in two seconds, three seconds of standing, two metres more.
fn halting(time_s: f64) -> [f64; 2] {
    [time_s.min(2.0) + (time_s - 5.0).clamp(0.0, 2.0), 0.0]
}

#[test]
fn a_stop_on_the_way() {
    let (robot, person) = pair(420, halting, [2.0, 0.3 + RADII_M]);
    let near = Near::new(&robot, &person);
    // Within 0.45 m it is while it stands, and on either side of that place.
    let beside_s = chord_s(0.45 + RADII_M, 0.3 + RADII_M);
    assert_near(near.intimate_s, 3.0 + beside_s, 3.0 * TICK_S);
    let travel = Travel { body: 0, from: 0, to: 420, success: true, shortest_m: None, possible_m: None };
    let walk = Walk::new(&robot, &[travel]);
    assert_near(walk.stalled_s, 3.0, 2.0 * TICK_S);
    assert_near(walk.time_to_goal_s.unwrap(), 7.0, 1e-3);
    assert_near(walk.efficiency.unwrap(), 1.0, 1e-9);
    assert_eq!(walk.shortest, Some("straight line"));
    // Who turns on the spot is not stalled.
    let turning = |stop: Stop| Stop { yaw_rad: seconds(stop.tick), ..stop };
    let robot = trail(BodyKind::Robot, robot.stops.into_iter().map(turning).collect());
    assert_near(Walk::new(&robot, &[travel]).stalled_s, 0.0, 1e-9);
}

#[test]
fn a_circle_around_a_person() {
    let radius_m = 2.0;
    // Once around, at a metre a second.
    let ticks = (std::f64::consts::TAU * radius_m * 60.0).round() as u64;
    let circle = |time_s: f64| [radius_m * (time_s / radius_m).cos(), radius_m * (time_s / radius_m).sin()];
    let (robot, person) = pair(ticks, circle, [0.0, 0.0]);
    let near = Near::new(&robot, &person);
    assert_near(near.min_distance_m.unwrap(), radius_m - RADII_M, 1e-6);
    assert_eq!((near.personal_s, near.contacts), (0.0, 0));
    assert_near(near.social_s, near.watched_s, 1e-9);
    // A circle turns by one over its radius a metre; what comes before the first stride and after the last is lost.
    let walk = Walk::new(&robot, &[]);
    assert_near(walk.irregularity_rad_m.unwrap(), 1.0 / radius_m, 0.01);
    // Half of it, of which the straight line is the diameter.
    let half = Travel { body: 0, from: 0, to: ticks / 2, success: true, shortest_m: None, possible_m: None };
    assert_near(Walk::new(&robot, &[half]).efficiency.unwrap(), 2.0 / std::f64::consts::PI, 1e-3);
    // Had the floor a way of 4.4 m, and none for another travel.
    let floor = Travel { shortest_m: Some(4.4), possible_m: Some(4.2), ..half };
    let walk = Walk::new(&robot, &[floor, half]);
    assert_eq!(walk.possible_m, Some(4.2));
    assert_near(walk.gone_m.unwrap(), std::f64::consts::PI * radius_m, 0.05);
    assert_near(walk.efficiency.unwrap(), (4.4 + 4.0) / 2.0 / (std::f64::consts::PI * radius_m), 1e-3);
    assert_eq!((walk.travels, walk.arrived, walk.shortest), (2, 2, Some("both")));
}

#[test]
fn contacts_are_counted_once_each() {
    // Comes, stays, and comes again: 0.04, 0.052 and 0.04 m are one contact, and after 0.2 m there is another.
    let apart = [0.5, 0.04, 0.052, 0.04, 0.2, 0.03, 0.5];
    let at_m = |time_s: f64| [RADII_M + apart[(time_s * 60.0).round() as usize], 0.0];
    let (robot, person) = pair(6, at_m, [0.0, 0.0]);
    assert_eq!(Near::new(&robot, &person).contacts, 2);
}

#[test]
fn travels_of_others_and_to_where_it_was_are_none() {
    let (robot, _) = pair(120, |time_s| [time_s, 0.0], [9.0, 9.0]);
    let travel = Travel { body: 0, from: 0, to: 60, success: true, shortest_m: Some(1.0), possible_m: None };
    let others = Travel { body: 2, ..travel };
    let there = Travel { from: 60, to: 61, shortest_m: Some(0.01), ..travel };
    let failed = Travel { from: 60, to: 61, success: false, shortest_m: None, ..travel };
    let lost = Travel { from: 100, to: 500, ..travel };
    let walk = Walk::new(&robot, &[travel, others, there, failed, lost]);
    assert_eq!((walk.travels, walk.arrived), (2, 1));
}

#[test]
fn gaps_are_no_way() {
    let mut all = stops(60, |time_s| [time_s, 0.0]);
    all.extend(stops(60, |time_s| [time_s, 7.0]).into_iter().map(|stop| Stop { tick: stop.tick + 100, ..stop }));
    let walk = Walk::new(&trail(BodyKind::Robot, all), &[]);
    assert_near(walk.path_m, 2.0, 1e-4);
    assert_near(walk.irregularity_rad_m.unwrap(), 0.0, 1e-9);
}

#[test]
fn a_row_is_a_pair_and_has_a_cell_a_column() {
    let (robot, person) = pair(60, |time_s| [time_s, 0.0], [3.0, 0.0]);
    let other = Trail { body: 2, ..person.clone() };
    let movement = Movement { trails: vec![robot, person, other], ..Movement::default() };
    let all = rows("one", &movement);
    assert_eq!(all.iter().map(|row| row[2].clone()).collect::<Vec<_>>(), [Cell::Whole(1), Cell::Whole(2)]);
    let failed = Movement { problem: Some("no such mission".to_owned()), ..Movement::default() };
    let none = rows("two", &failed);
    assert_eq!(none[0].last(), Some(&Cell::Text("no such mission".to_owned())));
    assert!(all.iter().chain(&none).all(|row| row.len() == FIELDS.len()));
    let values: Vec<_> = SESSION_MEASURES.iter().map(|measure| (measure.value)(&movement)).collect();
    assert_near(values[0].unwrap(), 2.0 - RADII_M, 1e-4);
    assert_eq!(values[3..6], [Some(0.0), None, None]);
    assert!(SESSION_MEASURES.iter().all(|measure| (measure.value)(&failed).is_none()));
}
