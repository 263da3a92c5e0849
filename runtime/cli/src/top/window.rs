//! The last ten seconds of a session.

use std::collections::{BTreeMap, VecDeque};

use cohabit_bus::{
    Envelope,
    message::{PulseMessage, TickHeader},
    monotonic_nanos, process_of,
};

use super::process::Usage;

/// How far back it reaches, ns.
pub const REACH_NANOS: u64 = 10_000_000_000;
/// A peer that was not heard of for so long is shown no more, ns.
const GONE_NANOS: u64 = 10_000_000_000;

/// What was heard lately.
#[derive(Default)]
pub struct Window {
    /// Each with when it was sent.
    pub ticks: VecDeque<(u64, TickHeader)>,
    newest_tick: u64,
    pub peers: BTreeMap<u64, Peer>,
}

/// A peer, by its last heartbeat.
pub struct Peer {
    /// The run of its pulses.
    run: u64,
    pub process: u32,
    pub pulse: PulseMessage,
    pub beat_nanos: u64,
    pub usage: Usage,
}

impl Peer {
    pub fn new(envelope: &Envelope, pulse: PulseMessage) -> Self {
        let process = process_of(envelope.run);
        Self { run: envelope.run, process, pulse, beat_nanos: envelope.sent_nanos, usage: Usage::default() }
    }
}

impl Window {
    pub fn note_tick(&mut self, envelope: &Envelope, header: &TickHeader) {
        self.newest_tick = self.newest_tick.max(envelope.tick);
        self.ticks.push_back((envelope.sent_nanos, *header));
    }

    pub fn note_pulse(&mut self, peer: Peer) {
        let usage = self.peers.remove(&peer.run).map(|before| before.usage).unwrap_or_default();
        self.peers.insert(peer.run, Peer { usage, ..peer });
    }

    pub const fn newest_tick(&self) -> u64 {
        self.newest_tick
    }

    /// Forgets what is too long ago, and looks at what the processes use.
    pub fn forget(&mut self) {
        let now = monotonic_nanos();
        self.ticks.retain(|(sent, _)| now.saturating_sub(*sent) < REACH_NANOS);
        self.peers.retain(|_, peer| now.saturating_sub(peer.beat_nanos) < GONE_NANOS);
        for peer in self.peers.values_mut() {
            peer.usage.look(peer.process, now);
        }
    }
}
