//! How the world's time goes by.

use std::ops::RangeInclusive;

use bytemuck::{Pod, Zeroable};

use super::Malformed;

/// What is asked of the simulator's clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Control {
    /// The world stands still, until something else is asked for.
    Pause,
    /// It goes on.
    Resume,
    /// It goes on for so many ticks, as fast as it would, and stands still again.
    Step(u32),
    /// It goes on so many times as fast as real time, in real time; no matter in lock-step.
    Speed(f32),
    /// A recorded session goes to this tick; a live one does not.
    Seek(u32),
}

impl Control {
    /// How many times as fast as real time a world may go.
    pub const SPEEDS: RangeInclusive<f32> = 0.05..=20.0;
}

/// A [`Control`] as it is sent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ControlMessage {
    /// 1 pauses, 2 resumes, 3 steps, 4 sets the speed, 5 goes elsewhere in a recorded session.
    kind: u32,
    /// Ticks of a step; the tick to go to.
    ticks: u32,
    /// How many times as fast as real time.
    speed: f32,
    /// Zero.
    reserved: u32,
}

impl From<Control> for ControlMessage {
    fn from(control: Control) -> Self {
        match control {
            Control::Pause => Self { kind: 1, ..Self::default() },
            Control::Resume => Self { kind: 2, ..Self::default() },
            Control::Step(ticks) => Self { kind: 3, ticks, ..Self::default() },
            Control::Speed(speed) => Self { kind: 4, speed, ..Self::default() },
            Control::Seek(ticks) => Self { kind: 5, ticks, ..Self::default() },
        }
    }
}

impl TryFrom<ControlMessage> for Control {
    type Error = Malformed;

    fn try_from(message: ControlMessage) -> Result<Self, Malformed> {
        match message.kind {
            1 => Ok(Self::Pause),
            2 => Ok(Self::Resume),
            3 => Ok(Self::Step(message.ticks)),
            4 if Self::SPEEDS.contains(&message.speed) => Ok(Self::Speed(message.speed)),
            5 => Ok(Self::Seek(message.ticks)),
            4 => Err(Malformed("a speed out of bounds")),
            _ => Err(Malformed("no such control")),
        }
    }
}
