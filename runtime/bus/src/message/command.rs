//! What is said to the simulator about bodies: commands, who commands, and who is waited for.

use bytemuck::{Pod, Zeroable};
use cohabit_cdf::Action;

use super::{ActionRecord, Malformed};
use crate::text::Text;

/// What a [`CommandMessage`] is. Whoever sent it is told by its envelope's `run`.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
#[repr(u32)]
pub enum CommandKind {
    /// The body is to do `action`. Only its commander's are carried out.
    Act = 1,
    /// The sender wants to command the body, which nobody else does.
    Claim = 2,
    /// The sender wants to command the body, whoever does now.
    TakeOver = 3,
    /// The sender commands the body no more: it goes back to whom it was taken from.
    Release = 4,
    /// In lock-step: the world is to wait for the sender, for `argument` ns a turn at most; 0 is for ever.
    Attend = 5,
    /// In lock-step: the world is to wait for the sender no more.
    Leave = 6,
    /// In lock-step: the sender's turn is over; the next is after `argument` ticks, or at an outcome of its body.
    Ready = 7,
}

impl CommandKind {
    const ALL: [Self; 7] =
        [Self::Act, Self::Claim, Self::TakeOver, Self::Release, Self::Attend, Self::Leave, Self::Ready];
}

/// Something for one body. What acts, claims or takes over gets exactly one
/// [`EventKind::Outcome`](super::EventKind::Outcome) with the same number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct CommandMessage {
    /// Unlike any other in the session: the sender's random upper half, its count below; 0 where no outcome is due.
    pub command: u64,
    /// The dialog turn it belongs to; 0 is none.
    pub turn: u64,
    /// Which body; `NONE` for who is waited for without one, such as a recorder.
    pub body: u32,
    /// `CommandKind`.
    kind: u32,
    /// As its kind says.
    pub argument: u64,
    /// What to do; of a claim or take-over, instead, a `Text<30>`: what kind of peer the sender is.
    pub action: ActionRecord,
}

impl CommandMessage {
    /// A message of that kind for a body, all else zero.
    #[must_use]
    pub fn new(kind: CommandKind, body: u32) -> Self {
        Self { body, kind: kind as u32, ..Self::default() }
    }

    /// A body is to do something.
    #[must_use]
    pub fn act(command: u64, turn: u64, body: u32, action: Action) -> Self {
        Self { command, turn, action: action.into(), ..Self::new(CommandKind::Act, body) }
    }

    /// A peer of that kind wants to command a body; whoever does now, if it takes it over.
    #[must_use]
    pub fn claim(command: u64, body: u32, peer: &str, take_over: bool) -> Self {
        let kind = if take_over { CommandKind::TakeOver } else { CommandKind::Claim };
        Self { command, action: bytemuck::cast(Text::<30>::new(peer)), ..Self::new(kind, body) }
    }

    /// The same with that argument.
    #[must_use]
    pub const fn with(mut self, argument: u64) -> Self {
        self.argument = argument;
        self
    }

    /// What it is.
    ///
    /// # Errors
    /// [`Malformed`], if it is nothing.
    pub fn kind(&self) -> Result<CommandKind, Malformed> {
        let kind = CommandKind::ALL.into_iter().find(|kind| *kind as u32 == self.kind);
        kind.ok_or(Malformed("no such kind of command"))
    }

    /// What kind of peer the sender of a claim or take-over is.
    #[must_use]
    pub fn peer(&self) -> Text<30> {
        bytemuck::cast(self.action)
    }
}
