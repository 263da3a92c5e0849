//! The topics of a session: what is said where, and how much of it is kept.

use std::fmt;

use crate::{
    camera::CameraId,
    message::{AudioHeader, AudioView},
};

/// A topic: one kind of message, from anybody to everybody who subscribes.
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub enum Topic {
    /// The mission that the simulator plays; kept for late joiners.
    Mission,
    /// The present state of the world, once a tick; the latest is kept for late joiners.
    State,
    /// What the simulator took in at each tick and the digest of what came of it: what a log needs to replay.
    Ticks,
    /// The whole simulated state, now and then, for who is to go on from it.
    Snapshots,
    /// Outcomes of commands and what else happened.
    Events,
    /// What bodies are told to do, by whom, and who is waited for.
    Commands,
    /// How the world's time is to go by.
    Control,
    /// In lock-step, whose turn it is: the last message of a tick.
    Steps,
    /// The heartbeats of all peers.
    Pulses,
    /// What people and robots say, and plans.
    Dialog,
    /// What people answer to questionnaires.
    Answers,
    /// What people say aloud at the pages, as it comes from their microphones.
    Microphone,
    /// What robots say aloud.
    Speech,
    /// One camera's frames; the latest is kept for late joiners.
    Frames(CameraId),
}

/// What a process can sleep on: groups of topics.
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub enum Wake {
    /// [`Topic::Commands`] and [`Topic::Control`].
    Commands,
    /// [`Topic::Pulses`].
    Pulses,
    /// [`Topic::Dialog`], [`Topic::Events`], [`Topic::Steps`] and [`Topic::Answers`].
    Talk,
    /// [`Topic::Microphone`] and [`Topic::Speech`].
    Audio,
    /// [`Topic::State`], [`Topic::Mission`], [`Topic::Ticks`] and [`Topic::Snapshots`].
    State,
    /// [`Topic::Frames`] of one camera.
    Frames(CameraId),
}

impl Topic {
    /// All but those of cameras, which every session has.
    pub const OF_ALL_SESSIONS: [Self; 13] = [
        Self::Mission,
        Self::State,
        Self::Ticks,
        Self::Snapshots,
        Self::Events,
        Self::Commands,
        Self::Control,
        Self::Steps,
        Self::Pulses,
        Self::Dialog,
        Self::Answers,
        Self::Microphone,
        Self::Speech,
    ];

    /// Samples kept for a subscriber that does not keep up; older ones are lost to it.
    pub(crate) const fn depth(self) -> usize {
        match self {
            Self::Mission => 1,
            Self::State | Self::Steps => 4,
            Self::Ticks => 2048,
            Self::Frames(_) | Self::Snapshots => 2,
            Self::Pulses => 8,
            Self::Answers => 128,
            // Of sound, some seconds.
            Self::Control | Self::Microphone | Self::Speech => 64,
            Self::Events | Self::Commands | Self::Dialog => 512,
        }
    }

    /// Samples kept for a subscriber that joins late.
    pub(crate) const fn history(self) -> usize {
        match self {
            Self::Mission | Self::State | Self::Frames(_) | Self::Pulses => 1,
            // That which a session began with, and the latest.
            Self::Snapshots => 2,
            Self::Dialog | Self::Events => 512,
            Self::Answers => 128,
            Self::Ticks => 2048,
            Self::Commands | Self::Control | Self::Steps | Self::Microphone | Self::Speech => 0,
        }
    }

    /// The most that may subscribe at once. A connection's memory grows with it, times [`Self::depth`].
    pub(crate) const fn most_subscribers(self) -> usize {
        match self {
            Self::Answers => 4,
            // Recorders and viewers; who listens.
            Self::Ticks | Self::Snapshots | Self::Microphone | Self::Speech => 8,
            _ => 32,
        }
    }

    /// The most bytes of a payload where messages have a bound. Such a topic's memory need not be able to grow, which
    /// would take 256 bytes for each sample in each connection: many, where many samples are kept.
    pub(crate) const fn most_bytes(self) -> Option<usize> {
        match self {
            Self::Events | Self::Commands => Some(1024),
            Self::Control | Self::Pulses => Some(128),
            Self::Steps => Some(512),
            Self::Answers => Some(9 << 10),
            Self::Dialog => Some(56 << 10),
            Self::Microphone | Self::Speech => Some(AudioView::bytes(AudioHeader::MOST_SAMPLES)),
            Self::Mission | Self::State | Self::Ticks | Self::Snapshots | Self::Frames(_) => None,
        }
    }

    /// A first guess at a sample's size, in bytes; larger ones grow the segment.
    pub(crate) const fn usual_bytes(self) -> usize {
        match self {
            Self::Mission => 64 << 10,
            Self::State | Self::Snapshots => 96 << 10,
            Self::Frames(CameraId::Egocentric(_)) => 300 * 300 * 16 + (16 << 10),
            Self::Frames(_) => 854 * 480 * 8 + (16 << 10),
            Self::Ticks => 512,
            Self::Events
            | Self::Commands
            | Self::Dialog
            | Self::Answers
            | Self::Microphone
            | Self::Speech
            | Self::Control
            | Self::Steps
            | Self::Pulses => match self.most_bytes() {
                Some(bytes) => bytes,
                None => 0,
            },
        }
    }

    /// What its publishers wake.
    #[must_use]
    pub const fn wake(self) -> Wake {
        match self {
            Self::Mission | Self::State | Self::Ticks | Self::Snapshots => Wake::State,
            Self::Events | Self::Dialog | Self::Steps | Self::Answers => Wake::Talk,
            Self::Microphone | Self::Speech => Wake::Audio,
            Self::Commands | Self::Control => Wake::Commands,
            Self::Pulses => Wake::Pulses,
            Self::Frames(camera) => Wake::Frames(camera),
        }
    }
}

impl fmt::Display for Topic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mission => f.write_str("mission"),
            Self::State => f.write_str("state"),
            Self::Ticks => f.write_str("ticks"),
            Self::Snapshots => f.write_str("snapshots"),
            Self::Events => f.write_str("events"),
            Self::Commands => f.write_str("commands"),
            Self::Control => f.write_str("control"),
            Self::Steps => f.write_str("steps"),
            Self::Pulses => f.write_str("pulses"),
            Self::Dialog => f.write_str("dialog"),
            Self::Answers => f.write_str("answers"),
            Self::Microphone => f.write_str("microphone"),
            Self::Speech => f.write_str("speech"),
            Self::Frames(camera) => write!(f, "frames/{camera}"),
        }
    }
}

impl fmt::Display for Wake {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Commands => f.write_str("wake/commands"),
            Self::Pulses => f.write_str("wake/pulses"),
            Self::Talk => f.write_str("wake/talk"),
            Self::Audio => f.write_str("wake/audio"),
            Self::State => f.write_str("wake/state"),
            Self::Frames(camera) => write!(f, "wake/frames/{camera}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::message::{
        AnswerMessage, CommandMessage, ControlMessage, DialogKind, DialogMessage, EventMessage, PlanStep, PulseMessage,
        StepView,
    };

    #[test]
    fn the_largest_messages_fit() {
        let mut dialog = DialogMessage::new(DialogKind::Plan, 0, 0, "");
        dialog.steps = vec![PlanStep::default(); 10_000];
        let largest = [
            (Topic::Events, size_of::<EventMessage>()),
            (Topic::Commands, size_of::<CommandMessage>()),
            (Topic::Control, size_of::<ControlMessage>()),
            (Topic::Pulses, size_of::<PulseMessage>()),
            (Topic::Steps, StepView::bytes(32)),
            (Topic::Dialog, dialog.bytes()),
            (Topic::Answers, size_of::<AnswerMessage>()),
            (Topic::Microphone, AudioView::bytes(1_000_000)),
            (Topic::Speech, AudioView::bytes(1_000_000)),
        ];
        for (topic, bytes) in largest {
            assert!(topic.most_bytes().is_some_and(|most| bytes <= most), "{topic}: {bytes}");
        }
    }
}
