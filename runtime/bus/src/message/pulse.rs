//! The heartbeat of a peer.

use bytemuck::{Pod, Zeroable};

use crate::text::Text;

/// How a peer is. Its process is told by its envelope's `run`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct PulseMessage {
    /// What it is: `sim`, `agent`, `dialog`, `record`, or as it likes.
    pub peer: Text<30>,
    /// The body that it commands or speaks for, or `NONE`.
    pub body: u32,
    /// Zero.
    pub reserved: u32,
    /// The newest tick that it has taken in; 0 if it takes in none.
    pub tick: u64,
    /// Samples that came and went unread because it was slow, over all its topics.
    pub lost: u64,
}
