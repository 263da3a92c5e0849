//! Sound: what a microphone took, or what a robot says aloud.

use bytemuck::{Pod, Zeroable};

use super::{Malformed, NONE, layout};

/// What stands before the samples.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct AudioHeader {
    /// Samples a second.
    pub rate_hz: u32,
    /// Samples that follow: 16-bit, one channel.
    pub samples: u32,
    /// The body that speaks, or [`NONE`] where somebody speaks at a page.
    pub body: u32,
    /// The page at which somebody speaks, by its number; 0 where a body does.
    pub visitor: u32,
    /// The dialog turn that is said aloud; 0 is none.
    pub turn: u64,
    /// Who sends it counts what is said, from 1: the pieces of one saying have the same number.
    pub saying: u64,
    /// 1 in the last piece of a saying, which may have no samples.
    pub is_last: u32,
    /// Zero.
    pub reserved: u32,
}

/// One piece of sound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AudioView<'a> {
    /// Whose it is, and at which rate.
    pub header: &'a AudioHeader,
    /// The samples.
    pub samples: &'a [i16],
}

impl AudioHeader {
    /// The most samples of one piece: a tenth of a second where there are 48,000 in one.
    pub const MOST_SAMPLES: usize = 4_800;

    /// Of what somebody says at a page.
    #[must_use]
    pub fn of_visitor(rate_hz: u32, visitor: u32, saying: u64) -> Self {
        Self { rate_hz, body: NONE, visitor, saying, ..Self::zeroed() }
    }

    /// Of what a body says in a turn.
    #[must_use]
    pub fn of_body(rate_hz: u32, body: u32, turn: u64, saying: u64) -> Self {
        Self { rate_hz, body, turn, saying, ..Self::zeroed() }
    }

    /// The same, as the last piece.
    #[must_use]
    pub const fn last(self) -> Self {
        Self { is_last: 1, ..self }
    }
}

impl<'a> AudioView<'a> {
    /// Bytes of the payload of so many samples.
    #[must_use]
    pub const fn bytes(samples: usize) -> usize {
        let samples = if samples < AudioHeader::MOST_SAMPLES { samples } else { AudioHeader::MOST_SAMPLES };
        layout::space::<AudioHeader>(1) + layout::space::<i16>(samples)
    }

    /// Writes a payload of the first [`AudioHeader::MOST_SAMPLES`] samples.
    ///
    /// # Panics
    /// When `payload` is shorter than [`Self::bytes`].
    pub fn write(header: AudioHeader, samples: &[i16], payload: &mut [u8]) {
        let samples = &samples[..samples.len().min(AudioHeader::MOST_SAMPLES)];
        let mut writer = layout::Writer::new(payload);
        writer.put(&[AudioHeader { samples: u32::try_from(samples.len()).unwrap_or(0), ..header }]);
        writer.put(samples);
    }

    /// Views a payload in place.
    ///
    /// # Errors
    /// [`Malformed`].
    pub fn new(payload: &'a [u8]) -> Result<Self, Malformed> {
        let mut reader = layout::Reader::new(payload);
        let header: &AudioHeader = reader.one()?;
        Ok(Self { header, samples: reader.take(header.samples)? })
    }
}
