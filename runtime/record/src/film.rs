//! Frames in a log, where they are asked for: what a camera saw, as JPEG, in the form that Foxglove shows.

use base64::{Engine as _, engine::general_purpose::STANDARD};
use cohabit_bus::{
    BusError, CameraId, Inbox, Sample, Topic, Transport,
    message::{FrameView, Plane},
};
use jpeg_encoder::{ColorType, Encoder};
use serde::Serialize;

/// JPEG quality, of 100.
const QUALITY: u8 = 82;

/// One frame. Its schema is Foxglove's `CompressedImage`, with the tick besides.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct FrameEntry {
    /// When.
    tick: u64,
    /// Wall time of its recording.
    timestamp: Timestamp,
    /// The camera.
    frame_id: String,
    /// Always `jpeg`.
    format: &'static str,
    /// The picture, in base64.
    data: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct Timestamp {
    sec: u64,
    nsec: u64,
}

impl FrameEntry {
    /// The name by which other tools know the schema.
    pub const SCHEMA_NAME: &'static str = "foxglove.CompressedImage";
    pub const SCHEMA: &'static str = r#"{"title":"foxglove.CompressedImage","type":"object","properties":{"timestamp":{"type":"object","title":"time","properties":{"sec":{"type":"integer"},"nsec":{"type":"integer"}}},"frame_id":{"type":"string"},"data":{"type":"string","contentEncoding":"base64"},"format":{"type":"string"},"tick":{"type":"integer"}}}"#;

    /// How the topics of cameras begin; the camera follows.
    pub const TOPICS: &'static str = "/frames/";

    /// Its channel's topic.
    pub fn topic(&self) -> String {
        format!("{}{}", Self::TOPICS, self.frame_id)
    }
}

/// The frames of one camera as they come.
pub(crate) struct Film {
    camera: CameraId,
    frames: Inbox,
}

impl Film {
    /// Has the camera's frames rendered from now on.
    pub fn new(bus: &dyn Transport, camera: CameraId) -> Result<Self, BusError> {
        Ok(Self { camera, frames: Inbox::new(bus, Topic::Frames(camera))? })
    }

    /// The next frame, if one is there.
    pub fn next(&mut self, wall_nanos: u64) -> Result<Option<FrameEntry>, BusError> {
        while let Some((sample, ())) = self.frames.next(|sample| FrameView::new(sample.payload()).map(drop))? {
            let entry = self.entry(&sample, wall_nanos);
            if entry.is_some() {
                return Ok(entry);
            }
        }
        Ok(None)
    }

    /// None where the camera has no colours, or they cannot be encoded, which is said.
    fn entry(&self, sample: &Sample, wall_nanos: u64) -> Option<FrameEntry> {
        let frame = FrameView::new(sample.payload()).ok()?;
        // The pictures of a panorama stand one above the other.
        let [width, height] = [frame.header.width, frame.header.height * frame.header.views];
        let (width, height) = (u16::try_from(width).ok()?, u16::try_from(height).ok()?);
        let mut jpeg = Vec::new();
        let encoded =
            Encoder::new(&mut jpeg, QUALITY).encode(frame.plane(Plane::Color)?, width, height, ColorType::Rgba);
        if let Err(error) = encoded {
            tracing::warn!("a frame of {} could not be encoded: {error}", self.camera);
            return None;
        }
        Some(FrameEntry {
            tick: sample.envelope().tick,
            timestamp: Timestamp { sec: wall_nanos / 1_000_000_000, nsec: wall_nanos % 1_000_000_000 },
            frame_id: self.camera.to_string(),
            format: "jpeg",
            data: STANDARD.encode(jpeg),
        })
    }
}
