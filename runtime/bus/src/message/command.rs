//! A command to a body.

use bytemuck::{Pod, Zeroable};

use super::ActionRecord;

/// One action for one body. It gets exactly one [`EventKind::Outcome`](super::EventKind::Outcome) with the same number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct CommandMessage {
    /// Unlike any other in the session: the sender's random upper half, its count below.
    pub command: u64,
    /// The dialog turn it belongs to; 0 is none.
    pub turn: u64,
    /// Which body.
    pub body: u32,
    /// Zero.
    pub reserved: u32,
    /// What to do.
    pub action: ActionRecord,
}
