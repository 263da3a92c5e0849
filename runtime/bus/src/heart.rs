//! The heartbeat of a peer.

use crate::{
    envelope::monotonic_nanos,
    error::BusError,
    message::PulseMessage,
    text::Text,
    topic::Topic,
    transport::{Publisher, Transport},
};

/// Between two beats, ns.
const EVERY_NANOS: u64 = 500_000_000;

/// Beats about twice a second, as long as its peer has it do so: a peer that hangs falls silent.
pub struct Heart {
    pulses: Box<dyn Publisher>,
    pulse: PulseMessage,
    next_nanos: u64,
}

impl Heart {
    /// The heart of a peer of that kind, which commands or speaks for that body, or for [`NONE`](crate::message::NONE).
    ///
    /// # Errors
    /// [`BusError::Open`].
    pub fn new(bus: &dyn Transport, peer: &str, body: u32) -> Result<Self, BusError> {
        let pulse = PulseMessage { peer: Text::new(peer), body, ..PulseMessage::default() };
        Ok(Self { pulses: bus.publisher(Topic::Pulses)?, pulse, next_nanos: 0 })
    }

    /// Calls its peer so from now on, and tells that with its next beat, which is due at once.
    pub fn rename(&mut self, peer: &str) {
        self.pulse.peer = Text::new(peer);
        self.next_nanos = 0;
    }

    /// Beats, if it is time: its peer has taken in that tick, and lost so many samples.
    ///
    /// # Errors
    /// [`BusError::Send`].
    pub fn beat(&mut self, tick: u64, lost: u64) -> Result<(), BusError> {
        let now = monotonic_nanos();
        if now < self.next_nanos {
            return Ok(());
        }
        self.next_nanos = now + EVERY_NANOS;
        let pulse = PulseMessage { tick, lost, ..self.pulse };
        self.pulses.send_record(tick, &pulse).map(drop)
    }
}
