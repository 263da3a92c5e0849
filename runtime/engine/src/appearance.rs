//! What is seen of a world without being a state of it: what is pointed out, what the mission shows, how bodies move.
//!
//! Worked out from what goes into a tick and what comes of it; nothing of it ever gets back into the world.

use cohabit_cdf::{Action, ObjectId};
use cohabit_world::{CameraTarget, DT_NANOS, Event, Input, Report, World};
use serde::{Deserialize, Serialize};

use crate::motion::Motion;

/// How long an object that is pointed out stays outlined.
pub const HIGHLIGHT_TICKS: u64 = 240;

/// All of one world, as it is after a tick.
#[derive(Debug, Default, Deserialize, Serialize)]
pub struct Appearance {
    latest_started: u64,
    highlighted: Vec<(ObjectId, u64)>,
    /// What the mission shows, one after the other, each until a tick.
    shown: Vec<(CameraTarget, u64)>,
    motion: Motion,
}

impl Appearance {
    /// Takes in what a tick was given, and what came of it.
    pub fn note(&mut self, world: &World, inputs: &[Input], report: &Report) {
        self.note_started(inputs);
        self.note_shown(world.tick(), report);
        self.motion.note(world, report);
    }

    /// What is driven is told anew all the time, and would hide all else.
    fn note_started(&mut self, inputs: &[Input]) {
        let is_drive = |input: &&Input| matches!(input.action, Action::Drive { .. });
        if let Some(input) = inputs.iter().rfind(|input| !is_drive(input)) {
            self.latest_started = input.command;
        }
    }

    fn note_shown(&mut self, now: u64, report: &Report) {
        self.highlighted.retain(|(_, until)| *until > now);
        self.shown.retain(|(_, until)| *until > now);
        for event in &report.events {
            match event {
                Event::Highlighted { object, .. } => {
                    self.highlighted.retain(|(other, _)| other != object);
                    self.highlighted.push((*object, now + HIGHLIGHT_TICKS));
                }
                Event::CameraMovement { target, duration_s, .. } => {
                    let ticks = (f64::from(*duration_s) / (DT_NANOS as f64 * 1e-9)) as u64;
                    let from = self.shown.last().map_or(now, |(_, until)| *until);
                    self.shown.push((*target, from + ticks));
                }
                _ => {}
            }
        }
    }

    /// The latest command that has begun to move its body; 0 if none has.
    #[must_use]
    pub const fn latest_started(&self) -> u64 {
        self.latest_started
    }

    /// The objects that are outlined now.
    pub fn highlighted(&self) -> impl Iterator<Item = ObjectId> + '_ {
        self.highlighted.iter().map(|(object, _)| *object)
    }

    /// What the mission shows at this tick to the people who watch.
    #[must_use]
    pub fn shown(&self, tick: u64) -> Option<CameraTarget> {
        self.shown.iter().find(|(_, until)| *until > tick).map(|(target, _)| *target)
    }

    /// What is seen to move besides.
    pub(crate) const fn motion(&self) -> &Motion {
        &self.motion
    }
}

/// All that can be seen at one moment.
#[derive(Clone, Copy)]
pub struct Visible<'a> {
    /// The world.
    pub world: &'a World,
    /// What is no state of it.
    pub appearance: &'a Appearance,
}
