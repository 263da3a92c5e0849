//! What is seen to move without being a state of the world: steps, wheels, and what is being poured.
//!
//! Worked out from what the world does, tick by tick; nothing of it ever gets back there.

use cohabit_cdf::{BodyId, Fluid, ObjectId};
use cohabit_world::{DT_NANOS, Event, Report, SoundKind, World};
use glam::Vec3;
use serde::{Deserialize, Serialize};

/// How long something is poured, ticks: a second.
const POUR_TICKS: u64 = 60;
/// Shares of that until what pours is over what it pours into, from when on it flows, and until when.
const LIFTED: f32 = 0.25;
const FLOWS: [f32; 2] = [0.22, 0.8];
/// How quickly a measured pace follows: the share of a new value a tick.
const FOLLOW: f32 = 0.2;
/// Way after which a count begins anew, m: far less than where a float's steps can be seen.
const ROUND_M: f32 = 4096.0;

/// How far and how fast a body has truly gone along its heading.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Serialize)]
pub(crate) struct Gait {
    /// Forwards less backwards, m.
    pub way_m: f32,
    /// Of late, m/s; negative is backwards.
    pub pace_m_s: f32,
    last_m: Option<Vec3>,
}

impl Gait {
    /// Takes in where a body stands one tick later, and its heading.
    fn advance(&mut self, position_m: Vec3, yaw_rad: f32) {
        let ahead = Vec3::new(libm::cosf(yaw_rad), libm::sinf(yaw_rad), 0.0);
        let moved_m = self.last_m.map_or(0.0, |last| (position_m - last).dot(ahead));
        self.last_m = Some(position_m);
        // Nobody is as fast as that: it was put there.
        let moved_m = if moved_m.abs() < 0.2 { moved_m } else { 0.0 };
        self.way_m = (self.way_m + moved_m) % ROUND_M;
        let measured = moved_m / (DT_NANOS as f32 * 1e-9);
        self.pace_m_s += (measured - self.pace_m_s) * FOLLOW;
        if self.pace_m_s.abs() < 0.01 {
            self.pace_m_s = 0.0;
        }
    }
}

/// Something that is being poured, or filled under a tap.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct Pour {
    /// Who holds it.
    pub body: BodyId,
    /// What it is poured from; nothing if from a tap.
    pub from: Option<ObjectId>,
    /// What it flows into.
    pub into: ObjectId,
    /// What flows; [`Fluid::None`] for what is no fluid.
    pub fluid: Fluid,
    since: u64,
}

impl Pour {
    fn share(&self, tick: u64) -> f32 {
        (tick.saturating_sub(self.since) as f32 / POUR_TICKS as f32).clamp(0.0, 1.0)
    }

    /// How far what is poured from is lifted and tilted, 0 to 1.
    pub(crate) fn tilt(&self, tick: u64) -> f32 {
        let share = self.share(tick);
        let near_end = (share / LIFTED).min((1.0 - share) / LIFTED).min(1.0);
        near_end * near_end * (3.0 - 2.0 * near_end)
    }

    /// Whether something flows.
    pub(crate) fn flows(&self, tick: u64) -> bool {
        let share = self.share(tick);
        self.fluid != Fluid::None && (FLOWS[0]..FLOWS[1]).contains(&share)
    }
}

/// All of one world.
#[derive(Debug, Default, Deserialize, Serialize)]
pub(crate) struct Motion {
    gaits: Vec<Gait>,
    /// What each body held after the last tick, and what that was filled with.
    held: Vec<Option<(ObjectId, Fluid)>>,
    pours: Vec<Pour>,
}

impl Motion {
    /// Takes in what a tick has done.
    pub(crate) fn note(&mut self, world: &World, report: &Report) {
        let tick = world.tick();
        self.pours.retain(|pour| tick < pour.since + POUR_TICKS && world.exists(pour.into));
        for event in &report.events {
            if let Event::Sound { kind: SoundKind::Pour, object } = event {
                self.pours.extend(self.pour(world, *object));
            }
        }
        self.gaits.resize(world.bodies().len(), Gait::default());
        self.held.clear();
        for (gait, body) in self.gaits.iter_mut().zip(world.bodies()) {
            gait.advance(body.position_m, body.yaw_rad);
            let held = body.held.and_then(|held| world.object(held));
            self.held.push(held.map(|held| (held.id, held.fluid)));
        }
    }

    /// What is poured into `into`, which is heard to be filled; nothing for a tap that is only opened.
    fn pour(&self, world: &World, into: ObjectId) -> Option<Pour> {
        let target = world.object(into)?;
        let since = world.tick();
        if let Some(body) = target.held_by {
            return Some(Pour { body, from: None, into, fluid: Fluid::Water, since });
        }
        let near = |place: Vec3| (place - target.position_m).length_squared();
        let holders = world.bodies().filter(|body| body.held.is_some());
        let body = holders.min_by(|one, two| near(one.position_m).total_cmp(&near(two.position_m)))?;
        let from = body.held?;
        let before = self.held.get(body.id.0 as usize).copied().flatten();
        let before = before.filter(|(held, _)| *held == from).map_or(Fluid::None, |(_, fluid)| fluid);
        let after = world.object(from)?.fluid;
        let filled = target.fluid != Fluid::None;
        let fluid = match (before != after, filled) {
            (true, _) => before,
            // Beans, and what else fills without having been a fluid.
            (false, true) if target.running == 0.0 => target.fluid,
            (false, false) => Fluid::None,
            _ => return None,
        };
        Some(Pour { body: body.id, from: Some(from), into, fluid, since })
    }

    /// How a body has moved.
    pub(crate) fn gait(&self, body: BodyId) -> Gait {
        self.gaits.get(body.0 as usize).copied().unwrap_or_default()
    }

    /// What is being poured now.
    pub(crate) fn pours(&self) -> &[Pour] {
        &self.pours
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gait_follows_what_was_gone_and_not_where_one_was_put() {
        let mut gait = Gait::default();
        for step in 0..60 {
            gait.advance(Vec3::new(0.0, 0.02 * step as f32, 0.0), core::f32::consts::FRAC_PI_2);
        }
        assert!((gait.way_m - 1.18).abs() < 1e-3, "{gait:?}");
        assert!((gait.pace_m_s - 1.2).abs() < 0.05, "{gait:?}");
        gait.advance(Vec3::new(9.0, 9.0, 0.0), core::f32::consts::FRAC_PI_2);
        assert!((gait.way_m - 1.18).abs() < 1e-3, "{gait:?}");
        for _ in 0..60 {
            gait.advance(Vec3::new(9.0, 9.0, 0.0), 0.0);
        }
        assert_eq!(gait.pace_m_s, 0.0);
        gait.advance(Vec3::new(8.9, 9.0, 0.0), 0.0);
        assert!(gait.way_m < 1.1 && gait.pace_m_s < 0.0, "{gait:?}");
    }

    #[test]
    fn what_is_poured_is_lifted_flows_and_is_put_back() {
        let pour = Pour { body: BodyId(0), from: None, into: ObjectId(1), fluid: Fluid::Milk, since: 100 };
        assert_eq!((pour.tilt(100), pour.tilt(130), pour.tilt(160)), (0.0, 1.0, 0.0));
        let flowing = (100..=160).filter(|tick| pour.flows(*tick)).count();
        assert!((30..40).contains(&flowing) && !pour.flows(100) && !pour.flows(160), "{flowing}");
        assert!(!Pour { fluid: Fluid::None, ..pour }.flows(130));
    }
}
