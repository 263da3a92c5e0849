//! Sound in a log, where people agreed to that: what they and the robots say aloud, in the form that Foxglove plays.

use base64::{Engine as _, engine::general_purpose::STANDARD};
use cohabit_bus::{BusError, Inbox, Topic, Transport, message::AudioView};
use serde::Serialize;

/// One piece of sound. Its schema is Foxglove's `RawAudio`, with the tick and who speaks besides.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct AudioEntry {
    /// The newest tick.
    tick: u64,
    /// Wall time of its recording.
    timestamp: Timestamp,
    /// The samples, 16-bit little-endian, in base64.
    data: String,
    /// Always `pcm-s16`.
    format: &'static str,
    sample_rate: u32,
    /// Always 1.
    number_of_channels: u32,
    /// The page at which somebody speaks; 0 is none.
    visitor: u32,
    /// The body that speaks, if one does.
    #[serde(skip_serializing_if = "Option::is_none")]
    body: Option<u32>,
    /// The turn that is said aloud; 0 is none.
    turn: u64,
    /// Counts what is said by whom.
    saying: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct Timestamp {
    sec: u64,
    nsec: u64,
}

impl AudioEntry {
    /// The name by which other tools know the schema.
    pub const SCHEMA_NAME: &'static str = "foxglove.RawAudio";
    pub const SCHEMA: &'static str = r#"{"title":"foxglove.RawAudio","type":"object","properties":{"timestamp":{"type":"object","title":"time","properties":{"sec":{"type":"integer"},"nsec":{"type":"integer"}}},"data":{"type":"string","contentEncoding":"base64"},"format":{"type":"string"},"sample_rate":{"type":"integer"},"number_of_channels":{"type":"integer"},"tick":{"type":"integer"},"visitor":{"type":"integer"},"body":{"type":"integer"},"turn":{"type":"integer"},"saying":{"type":"integer"}}}"#;

    /// The channels, and the topics that they are of.
    pub const CHANNELS: [(&'static str, Topic); 2] =
        [("/audio/microphone", Topic::Microphone), ("/audio/speech", Topic::Speech)];
}

/// All that is said aloud, as it comes.
pub(crate) struct Tape {
    tracks: Vec<(&'static str, Inbox)>,
}

impl Tape {
    /// Listens from now on.
    pub fn new(bus: &dyn Transport) -> Result<Self, BusError> {
        let track = |(channel, topic)| Ok((channel, Inbox::new(bus, topic)?));
        Ok(Self { tracks: AudioEntry::CHANNELS.into_iter().map(track).collect::<Result<_, BusError>>()? })
    }

    /// The next piece and its channel, if one is there.
    pub fn next(&mut self, tick: u64, wall_nanos: u64) -> Result<Option<(&'static str, AudioEntry)>, BusError> {
        for (channel, pieces) in &mut self.tracks {
            while let Some((sample, ())) = pieces.next(|sample| AudioView::new(sample.payload()).map(drop))? {
                // The last piece of a saying may be empty.
                let Some(AudioView { header, samples }) =
                    AudioView::new(sample.payload()).ok().filter(|view| !view.samples.is_empty())
                else {
                    continue;
                };
                let bytes: Vec<u8> = samples.iter().flat_map(|sample| sample.to_le_bytes()).collect();
                let entry = AudioEntry {
                    tick,
                    timestamp: Timestamp { sec: wall_nanos / 1_000_000_000, nsec: wall_nanos % 1_000_000_000 },
                    data: STANDARD.encode(bytes),
                    format: "pcm-s16",
                    sample_rate: header.rate_hz,
                    number_of_channels: 1,
                    visitor: header.visitor,
                    body: (header.visitor == 0).then_some(header.body),
                    turn: header.turn,
                    saying: header.saying,
                };
                return Ok(Some((*channel, entry)));
            }
        }
        Ok(None)
    }
}
