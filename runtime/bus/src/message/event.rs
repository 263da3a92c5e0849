//! What happened in the world.

use bytemuck::{Pod, Zeroable};
use cohabit_cdf::Status;

use super::NONE;
use crate::text::Text;

/// What an [`EventMessage`] tells.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
#[repr(u32)]
pub enum EventKind {
    /// A command's outcome: `command`, `body`, `status`, and a sentence.
    Outcome = 1,
    /// A command was taken up and begins to move the body: `command`, `body`.
    Started = 2,
    /// A goal was met: `number`.
    GoalMet = 3,
    /// A goal opened again: `number`.
    GoalReset = 4,
    /// All goals are met.
    MissionComplete = 5,
    /// A hazard ended the mission: a sentence.
    MissionFailed = 6,
    /// The game tells people something: a text.
    Message = 7,
    /// A note was read: `object`, and its text.
    NoteRead = 8,
    /// An object is pointed out: `object`.
    Highlighted = 9,
    /// A state of an object changed: `object`.
    ObjectChanged = 10,
    /// An object came to be: `object`.
    Spawned = 11,
    /// Something can be heard: `object`, and what.
    Sound = 12,
    /// A hidden goal can be seen now: `number`.
    GoalShown = 13,
    /// The mission shows people something: `object` if it is one, for `number` milliseconds, with a text.
    CameraMovement = 14,
    /// Another commands a body: `body`, `number` is its run (0 is nobody), and a sentence.
    Commander = 15,
    /// The world's time goes otherwise: a sentence.
    Clock = 16,
    /// In lock-step, somebody was not waited for any longer: `number` of times in all, and a sentence.
    TimedOut = 17,
    /// A peer sent nonsense and is not heard for a while: a sentence.
    CutOff = 18,
}

impl EventKind {
    /// All kinds.
    pub const ALL: [Self; 18] = [
        Self::Outcome,
        Self::Started,
        Self::GoalMet,
        Self::GoalReset,
        Self::MissionComplete,
        Self::MissionFailed,
        Self::Message,
        Self::NoteRead,
        Self::Highlighted,
        Self::ObjectChanged,
        Self::Spawned,
        Self::Sound,
        Self::GoalShown,
        Self::CameraMovement,
        Self::Commander,
        Self::Clock,
        Self::TimedOut,
        Self::CutOff,
    ];
}

/// One event; fields that its kind does not use are zero or [`NONE`].
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct EventMessage {
    /// `EventKind`.
    kind: u32,
    /// The body concerned.
    pub body: u32,
    /// The command concerned.
    pub command: u64,
    /// The dialog turn the command belongs to; 0 is none.
    pub turn: u64,
    /// A goal's number.
    pub number: i64,
    /// The object concerned.
    pub object: u32,
    /// `Status` of an outcome.
    status: u32,
    /// A sentence for people.
    pub text: Text<502>,
}

impl EventMessage {
    /// An event of that kind, all else empty.
    #[must_use]
    pub fn new(kind: EventKind) -> Self {
        Self {
            kind: kind as u32,
            body: NONE,
            command: 0,
            turn: 0,
            number: 0,
            object: NONE,
            status: 0,
            text: Text::default(),
        }
    }

    /// An outcome.
    #[must_use]
    pub fn outcome(command: u64, turn: u64, body: u32, status: Status, detail: &str) -> Self {
        Self { command, turn, body, status: status as u32, text: Text::new(detail), ..Self::new(EventKind::Outcome) }
    }

    /// The same about an object.
    #[must_use]
    pub const fn about(mut self, object: u32) -> Self {
        self.object = object;
        self
    }

    /// The same with a sentence for people.
    #[must_use]
    pub fn saying(mut self, text: &str) -> Self {
        self.text = Text::new(text);
        self
    }

    /// What it tells; `None` if a peer wrote a kind that does not exist.
    #[must_use]
    pub fn kind(&self) -> Option<EventKind> {
        EventKind::ALL.into_iter().find(|kind| *kind as u32 == self.kind)
    }

    /// The status of an outcome.
    #[must_use]
    pub fn status(&self) -> Option<Status> {
        Status::ALL.get(self.status as usize).copied()
    }
}
