//! The live view: the newest frame for people, as JPEG.

use std::{sync::Arc, time::Duration};

use cohabit_bus::{
    CameraId, Sample, Topic, Transport, Wake,
    message::{FrameView, Plane},
};
use jpeg_encoder::{ColorType, Encoder, EncodingError};

use crate::{DialogError, hub::Hub, talk::Talk};

const CAMERA: CameraId = CameraId::Spectator(0);
/// JPEG quality, of 100.
const QUALITY: u8 = 82;

/// Relays frames to the pages of `hub` until `over`. Subscribes, and so has frames rendered, only while a page is open
/// or none was had yet.
pub fn relay(bus: &dyn Transport, hub: &Hub, talk: &Talk, over: &dyn Fn() -> bool) -> Result<(), DialogError> {
    let mut listener = bus.listener(Wake::Frames(CAMERA))?;
    let mut had_one = false;
    while !over() {
        if hub.viewers() == 0 && had_one {
            std::thread::sleep(Duration::from_millis(20));
            continue;
        }
        let mut frames = bus.subscriber(Topic::Frames(CAMERA))?;
        while !over() && (hub.viewers() > 0 || !had_one) {
            listener.wait(Duration::from_millis(50))?;
            let Some(sample) = frames.latest()? else { continue };
            show(&sample, hub, talk)?;
            had_one = true;
        }
    }
    Ok(())
}

fn show(sample: &Sample, hub: &Hub, talk: &Talk) -> Result<(), DialogError> {
    let frame = FrameView::new(sample.payload())?;
    let Some(color) = frame.plane(Plane::Color) else { return Ok(()) };
    match encode(sample.envelope().tick, frame.header.width, frame.header.height, color) {
        Ok(bytes) => hub.show_frame(Arc::new(bytes)),
        Err(error) => tracing::warn!("a frame could not be encoded: {error}"),
    }
    talk.note_frame(frame.header.command, sample.envelope().sent_nanos)
}

fn encode(tick: u64, width: u32, height: u32, rgba: &[u8]) -> Result<Vec<u8>, EncodingError> {
    let mut bytes = vec![1, 0, 0, 0, 0, 0, 0, 0];
    bytes.extend(tick.to_le_bytes());
    let side = |pixels: u32| u16::try_from(pixels).unwrap_or(u16::MAX);
    Encoder::new(&mut bytes, QUALITY).encode(rgba, side(width), side(height), ColorType::Rgba)?;
    Ok(bytes)
}
