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
    /// By the run of their pulses.
    pub peers: BTreeMap<u64, Peer>,
}

/// A peer, by its last heartbeat.
pub struct Peer {
    pub process: u32,
    pub pulse: PulseMessage,
    pub beat_nanos: u64,
    /// How many ticks it was behind then; nothing, if it takes in none.
    pub behind: Option<u64>,
    pub usage: Usage,
}

impl Window {
    pub fn note_tick(&mut self, envelope: &Envelope, header: &TickHeader) {
        self.newest_tick = self.newest_tick.max(envelope.tick);
        self.ticks.push_back((envelope.sent_nanos, *header));
    }

    pub fn note_pulse(&mut self, envelope: &Envelope, pulse: PulseMessage) {
        let usage = self.peers.remove(&envelope.run).map(|before| before.usage).unwrap_or_default();
        let behind = (pulse.tick > 0).then(|| self.tick_at(envelope.sent_nanos).saturating_sub(pulse.tick));
        let (process, beat_nanos) = (process_of(envelope.run), envelope.sent_nanos);
        self.peers.insert(envelope.run, Peer { process, pulse, beat_nanos, behind, usage });
    }

    /// The newest tick that had been sent at some time.
    fn tick_at(&self, nanos: u64) -> u64 {
        let later = self.ticks.iter().rev().take_while(|(sent, _)| *sent > nanos).count() as u64;
        self.newest_tick.saturating_sub(later)
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
