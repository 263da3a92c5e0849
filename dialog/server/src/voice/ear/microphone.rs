//! What a page hears, on the bus, for whoever records it or listens there.

use cohabit_bus::{
    Publisher, Topic, Transport,
    message::{AudioHeader, AudioView},
};
use cohabit_speech::RATE;

/// Passes on the sound of a page; without a place on the bus, it is silent.
pub struct Microphone {
    bus: Option<Box<dyn Publisher>>,
    visitor: u32,
    /// Counts what somebody began to say.
    sayings: u64,
}

impl Microphone {
    /// Of the page with this number.
    pub fn new(bus: &dyn Transport, visitor: u32) -> Self {
        let publisher = bus.publisher(Topic::Microphone);
        let bus = publisher.inspect_err(|error| tracing::warn!("microphones are not heard on the bus: {error}")).ok();
        Self { bus, visitor, sayings: 0 }
    }

    /// What comes next is something new that somebody says.
    pub fn begin_saying(&mut self) {
        self.sayings += 1;
    }

    /// Passes samples on.
    pub fn publish(&mut self, samples: &[i16]) {
        let Some(bus) = &mut self.bus else { return };
        let header = AudioHeader::of_visitor(RATE, self.visitor, self.sayings);
        for piece in samples.chunks(AudioHeader::MOST_SAMPLES) {
            let write = &mut |bytes: &mut [u8]| AudioView::write(header, piece, bytes);
            if let Err(error) = bus.send(0, AudioView::bytes(piece.len()), write) {
                tracing::warn!("{error}");
            }
        }
    }
}
