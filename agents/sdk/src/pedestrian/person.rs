//! What one pedestrian decides: where to go next by its schedule, and how to get there.

use std::collections::BTreeMap;

use cohabit_bus::message::BodyRecord;
use cohabit_cdf::{Action, GoToTarget};
use glam::Vec2;
use rand_chacha::{
    ChaCha8Rng,
    rand_core::{Rng, SeedableRng},
};

use super::{
    Floor,
    forces::{RELAXATION_S, Walker, nearest_on, velocity},
    schedule::{Diary, Entry, Errand, Place},
};
use crate::agent::TICKS_PER_SECOND;

/// A pedestrian decides so often, in ticks and in seconds.
pub(super) const LOOK_TICKS: u64 = 6;
const LOOK_S: f32 = LOOK_TICKS as f32 / TICKS_PER_SECOND as f32;
/// Desired speeds are normally distributed, m/s (Moussaïd et al.: 1.29 ± 0.19); a body walks no faster than the most.
const PACE_M_S: f32 = 1.29;
const PACE_DEVIATION_M_S: f32 = 0.19;
const SLOWEST_M_S: f32 = 0.7;
const MOST_M_S: f32 = 1.3;
/// A body turns no faster, and turns towards where it goes within so long.
const TURN_RAD_S: f32 = 3.1;
const TURN_S: f32 = 0.3;
/// Slower than this is to stand.
const STANDS_M_S: f32 = 0.05;
/// A point of the way is reached within this, and so is its end, m.
const REACHED_M: f32 = 0.35;
/// Who meets somebody stands so far away, m: within personal space, out of intimate space.
const MEETING_M: f32 = 1.2;
const FACES_RAD: f32 = 0.15;
/// The way is looked for anew after so long, and after so long again where there is none.
const REPLAN_TICKS: u64 = 2 * TICKS_PER_SECOND;
/// Who finds no way so often does the next thing.
const MOST_FAILURES: u32 = 5;
/// Who comes no further than this in that time is stuck.
const STUCK_TICKS: u64 = 5 * TICKS_PER_SECOND;
const STUCK_M: f32 = 0.3;
/// Who is stuck waits so long before trying again, and after so many times without getting nearer does the next thing.
const WAIT_TICKS: u64 = 3 * TICKS_PER_SECOND;
const MOST_STUCK: u32 = 6;
/// A way that is shorter than any before by this is progress, m.
const PROGRESS_M: f32 = 0.5;
/// Who stands no further away, m, is in the way of somebody who is stuck.
const IN_THE_WAY_M: f32 = 1.5;
/// A shut door this near to oneself and to the way is gone through by the body's own walking, which opens it.
const DOOR_NEAR_M: f32 = 1.4;
const DOOR_ON_WAY_M: f32 = 0.4;
const DOOR_BEYOND_M: f32 = 1.0;
/// A command to walk is under way after so long, if it was taken up.
const TAKEN_UP_TICKS: u64 = 2 * LOOK_TICKS;

/// What a pedestrian knows of the present.
pub(super) struct Around<'a> {
    pub tick: u64,
    pub own: Walker,
    pub yaw_rad: f32,
    /// Whether its latest command is under way.
    pub is_busy: bool,
    /// All bodies, itself too, by number.
    pub bodies: &'a BTreeMap<u32, Walker>,
    /// What else the world says of them.
    pub records: &'a [BodyRecord],
    /// Where doors are shut, m.
    pub shut: &'a [Vec2],
    pub floor: &'a Floor,
}

/// A pedestrian.
pub(super) struct Person {
    body: u32,
    diary: Diary,
    rng: ChaCha8Rng,
    pace_m_s: f32,
    /// When the present errand began, and where it leads, once that is known.
    began: Option<u64>,
    goal: Option<Vec2>,
    way: Vec<Vec2>,
    planned: Option<u64>,
    failures: u32,
    /// Where it was, some time ago.
    mark: Option<(u64, Vec2)>,
    /// How often it was stuck since it last got nearer, how long the way then was, m, and until when it waits.
    stuck: u32,
    left_m: f32,
    waits_until: u64,
    /// Since when its body walks by itself.
    led: Option<u64>,
    drives: bool,
}

impl Person {
    /// Somebody who does that, in that body; what is left to chance follows from `seed`.
    pub fn new(body: u32, entries: &[Entry], seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed.wrapping_add(u64::from(body)));
        let pace_m_s = (PACE_M_S + PACE_DEVIATION_M_S * normal(&mut rng)).clamp(SLOWEST_M_S, MOST_M_S);
        Self {
            body,
            diary: Diary::new(entries),
            rng,
            pace_m_s,
            began: None,
            goal: None,
            way: Vec::new(),
            planned: None,
            failures: 0,
            mark: None,
            stuck: 0,
            left_m: f32::INFINITY,
            waits_until: 0,
            led: None,
            drives: false,
        }
    }

    pub const fn body(&self) -> u32 {
        self.body
    }

    /// Another commanded the body, or does: what it was about to do is planned anew.
    pub fn forget(&mut self) {
        (self.led, self.drives, self.mark) = (None, false, None);
        self.plan_anew();
    }

    /// What to do now, if it is anything new.
    pub fn act(&mut self, around: &Around<'_>) -> Option<Action> {
        if let Some(since) = self.led {
            if around.is_busy || around.tick < since + TAKEN_UP_TICKS {
                return None;
            }
            self.forget();
        }
        if around.tick < self.waits_until {
            return self.halt();
        }
        let Some(errand) = self.diary.now(around.tick) else { return self.halt() };
        let began = *self.began.get_or_insert(around.tick);
        match errand {
            Errand::Stay(ticks) => {
                if around.tick >= began + ticks {
                    self.finish(around.tick);
                }
                self.halt()
            }
            Errand::GoTo(place) => match self.goal(place, around.floor) {
                Some(goal) => self.walk(goal, REACHED_M, around),
                None => self.fail(around.tick),
            },
            Errand::Meet(other) => match around.bodies.get(&other).map(|other| other.at_m) {
                Some(at_m) if at_m.distance(around.own.at_m) < MEETING_M => self.face(at_m, around),
                Some(at_m) => self.walk(at_m, 0.0, around),
                None => self.fail(around.tick),
            },
        }
    }

    /// Where the present errand leads; of a room's viewpoints any one.
    fn goal(&mut self, place: Place, floor: &Floor) -> Option<Vec2> {
        if self.goal.is_none() {
            self.goal = match place {
                Place::Point(point) => Some(Vec2::from_array(point)),
                Place::Viewpoint(room, number) => {
                    let mut known = floor.viewpoints.iter();
                    known.find(|known| (known.0, known.1) == (room, number)).map(|(_, _, at_m)| *at_m)
                }
                Place::Room(room) => {
                    let known: Vec<Vec2> =
                        floor.viewpoints.iter().filter(|(own, ..)| *own == room).map(|(_, _, at_m)| *at_m).collect();
                    let chosen = self.rng.next_u64() % (known.len() as u64).max(1);
                    usize::try_from(chosen).ok().and_then(|at| known.get(at)).copied()
                }
            };
        }
        self.goal
    }

    /// Walks on to a point, until it is that near.
    fn walk(&mut self, goal: Vec2, near_m: f32, around: &Around<'_>) -> Option<Action> {
        let (tick, at_m) = (around.tick, around.own.at_m);
        if at_m.distance(goal) < near_m {
            self.finish(tick);
            return self.halt();
        }
        if self.planned.is_none_or(|planned| tick >= planned + REPLAN_TICKS) {
            let Some(way) = (around.floor.path)(at_m, goal) else { return self.fail(tick) };
            let left_m = length(at_m, &way);
            if left_m < self.left_m - PROGRESS_M {
                (self.left_m, self.stuck) = (left_m, 0);
            }
            (self.way, self.failures, self.planned) = (way, 0, Some(tick));
        }
        let passed = self.way.iter().take_while(|point| point.distance(at_m) < REACHED_M).count();
        let passed = passed.min(self.way.len().saturating_sub(1));
        self.way.drain(..passed);
        let Some(aim) = self.way.first().copied() else { return self.halt() };
        if self.way.len() == 1 && aim.distance(at_m) < REACHED_M {
            // The end of the way may lie beside a goal that nobody can stand on.
            if near_m > 0.0 {
                self.finish(tick);
            } else if self.is_stuck(tick, at_m) {
                return self.get_past(aim, goal, around);
            }
            return self.halt();
        }
        if let Some(beyond) = self.beyond_door(around) {
            // Somebody may stand in it.
            return self.get_past(beyond, beyond, around);
        }
        if self.is_stuck(tick, at_m) {
            return self.get_past(aim, goal, around);
        }
        self.drives = true;
        let wanted_m_s = (aim - at_m).normalize_or_zero() * self.pace_m_s.min(at_m.distance(goal) / RELAXATION_S);
        let others: Vec<Walker> =
            around.bodies.iter().filter(|(body, _)| **body != self.body).map(|(_, other)| *other).collect();
        let next = velocity(&around.own, wanted_m_s, MOST_M_S, &others, &around.floor.obstacles, LOOK_S);
        Some(drive(next, around.yaw_rad))
    }

    /// Turns to somebody, which is all that a meeting is.
    fn face(&mut self, at_m: Vec2, around: &Around<'_>) -> Option<Action> {
        let off_rad = off_heading(at_m - around.own.at_m, around.yaw_rad);
        if off_rad.abs() < FACES_RAD {
            self.finish(around.tick);
            return self.halt();
        }
        self.drives = true;
        Some(turn(0.0, off_rad))
    }

    /// Has its body walk there by itself: it opens doors, pushes what can be pushed, and makes way.
    fn lead(&mut self, to: Vec2, tick: u64) -> Option<Action> {
        (self.led, self.drives) = (Some(tick), false);
        Some(Action::GoTo { target: GoToTarget::Point(to.to_array()) })
    }

    /// The point behind a shut door that is next on the way, if one is.
    fn beyond_door(&self, around: &Around<'_>) -> Option<Vec2> {
        let at_m = around.own.at_m;
        let mut near = around.shut.iter().filter(|door| door.distance(at_m) < DOOR_NEAR_M);
        let way: Vec<Vec2> = std::iter::once(at_m).chain(self.way.iter().copied()).collect();
        near.find_map(|door| beyond(&way, *door))
    }

    /// What somebody does who is stuck, or before a shut door: has its body go on by itself, which opens doors and goes around who
    /// stands there; then waits, and tries again; at last does the next thing.
    fn get_past(&mut self, aim: Vec2, goal: Vec2, around: &Around<'_>) -> Option<Action> {
        self.stuck += 1;
        if self.stuck >= MOST_STUCK {
            let obstacle = self.obstacle(around);
            tracing::warn!("person {} does not get past {obstacle}, and does the next thing", self.body);
            self.finish(around.tick);
            return self.halt();
        }
        if self.stuck % 2 == 1 {
            // Somebody may stand where the next stretch ends.
            return self.lead(if self.stuck == 1 { aim } else { goal }, around.tick);
        }
        tracing::info!("person {} waits: {} is in the way", self.body, self.obstacle(around));
        (self.waits_until, self.mark) = (around.tick + WAIT_TICKS, None);
        self.plan_anew();
        self.halt()
    }

    /// What people call what is in its way: the nearest body, if one is near.
    fn obstacle(&self, around: &Around<'_>) -> String {
        let others = around.bodies.iter().filter(|(body, _)| **body != self.body);
        let apart_m = others.map(|(body, other)| (body, other.at_m.distance(around.own.at_m)));
        let nearest = apart_m.filter(|(_, apart_m)| *apart_m < IN_THE_WAY_M);
        let Some((body, _)) = nearest.min_by(|(_, one), (_, other)| one.total_cmp(other)) else {
            return "what stands there".to_owned();
        };
        let record = around.records.iter().find(|record| record.body == *body);
        let kind = record.and_then(BodyRecord::kind).unwrap_or_default();
        format!("the {} of body {body}", kind.name())
    }

    /// Whether it has hardly moved for long, while it meant to.
    fn is_stuck(&mut self, tick: u64, at_m: Vec2) -> bool {
        let (since, was_m) = *self.mark.get_or_insert((tick, at_m));
        if tick < since + STUCK_TICKS {
            return false;
        }
        self.mark = Some((tick, at_m));
        was_m.distance(at_m) < STUCK_M
    }

    /// There is no way, or nowhere to go: it tries again, or gives up.
    fn fail(&mut self, tick: u64) -> Option<Action> {
        if self.planned.is_some_and(|planned| tick < planned + REPLAN_TICKS) {
            return self.halt();
        }
        // Elsewhere in the same room there may be a way.
        (self.planned, self.goal) = (Some(tick), None);
        self.way.clear();
        self.failures += 1;
        if self.failures >= MOST_FAILURES {
            tracing::warn!("person {} finds no way to where they are to go, and does the next thing", self.body);
            self.finish(tick);
        }
        self.halt()
    }

    fn finish(&mut self, tick: u64) {
        self.diary.done(tick);
        (self.began, self.goal, self.failures, self.mark) = (None, None, 0, None);
        (self.stuck, self.left_m) = (0, f32::INFINITY);
        self.plan_anew();
    }

    fn plan_anew(&mut self) {
        self.planned = None;
        self.way.clear();
    }

    fn halt(&mut self) -> Option<Action> {
        std::mem::take(&mut self.drives).then(|| turn(0.0, 0.0))
    }
}

/// How long a way is, m.
fn length(from: Vec2, way: &[Vec2]) -> f32 {
    std::iter::once(&from).chain(way).zip(way).map(|(one, next)| one.distance(*next)).sum()
}

/// Behind a door that a way leads through, on the way.
fn beyond(way: &[Vec2], door: Vec2) -> Option<Vec2> {
    let (at, mut from) = way
        .windows(2)
        .enumerate()
        .map(|(at, pair)| (at, nearest_on(pair[0], pair[1], door)))
        .find(|(_, point)| point.distance(door) < DOOR_ON_WAY_M)?;
    let mut left_m = DOOR_BEYOND_M;
    for next in &way[at + 1..] {
        let stretch_m = from.distance(*next);
        if stretch_m >= left_m {
            return Some(from.lerp(*next, left_m / stretch_m));
        }
        left_m -= stretch_m;
        from = *next;
    }
    Some(from)
}

/// The controls of a body that is to move so, and faces there.
fn drive(velocity_m_s: Vec2, yaw_rad: f32) -> Action {
    let speed_m_s = velocity_m_s.length();
    if speed_m_s < STANDS_M_S {
        return turn(0.0, 0.0);
    }
    let off_rad = off_heading(velocity_m_s, yaw_rad);
    turn(speed_m_s * libm::cosf(off_rad).max(0.0), off_rad)
}

fn turn(forward_m_s: f32, off_rad: f32) -> Action {
    let turn_rad_s = (off_rad / TURN_S).clamp(-TURN_RAD_S, TURN_RAD_S);
    Action::Drive { forward_m_s, turn_rad_s, pitch_rad_s: 0.0 }
}

/// How far a direction is to the left of a heading, in `[-π, π]`.
fn off_heading(direction: Vec2, yaw_rad: f32) -> f32 {
    let ahead = Vec2::new(libm::cosf(yaw_rad), libm::sinf(yaw_rad));
    libm::atan2f(ahead.perp_dot(direction), ahead.dot(direction))
}

/// Of mean 0 and deviation 1, near enough: the sum of twelve that are uniform.
fn normal(rng: &mut ChaCha8Rng) -> f32 {
    const PARTS: u64 = 1 << 16;
    let sum: u64 = (0..12).map(|_| rng.next_u64() % PARTS).sum();
    sum as f32 / PARTS as f32 - 6.0
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
