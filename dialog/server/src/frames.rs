//! The live views: the newest frame of each camera that a page looks through, as JPEG.

use std::{sync::Arc, time::Duration};

use cohabit_bus::{
    Inbox, Sample, Topic, Transport, Wake, give_way,
    message::{FrameView, Plane},
};
use jpeg_encoder::{ColorType, Encoder, EncodingError};

use crate::{
    DialogError,
    view::{Ids, View},
};

/// JPEG quality, of 100.
const QUALITY: u8 = 82;
/// How long a relay that nobody needs sleeps before it looks whether the session is over.
const DOZE: Duration = Duration::from_millis(100);

/// A frame that pages get.
#[derive(Clone, Copy, Debug)]
pub struct Shown {
    /// The latest command that had begun to move its body.
    pub command: u64,
    /// When it was seen.
    pub tick: u64,
    /// When it was sent.
    pub sent_nanos: u64,
}

/// Relays frames to the pages that look through the view with this index until `over`. Subscribes, and so has frames
/// rendered, only while there are any; of the first view at the start too, until one was had. `shown` hears of each.
pub fn relay(
    bus: &dyn Transport,
    (index, view): (u8, &Arc<View>),
    shown: &dyn Fn(Shown) -> Result<(), DialogError>,
    over: &dyn Fn() -> bool,
) -> Result<(), DialogError> {
    give_way();
    let mut had_one = index > 0;
    while !over() {
        if !view.is_wanted() && had_one {
            view.wait_until_wanted(DOZE);
            continue;
        }
        let mut listener = bus.listener(Wake::Frames(view.camera))?;
        let mut frames = Inbox::new(bus, Topic::Frames(view.camera))?;
        while !over() && (view.is_wanted() || !had_one) {
            listener.wait(Duration::from_millis(50))?;
            let mut newest = None;
            while let Some((sample, ())) = frames.next(|sample| FrameView::new(sample.payload()).map(drop))? {
                newest = Some(sample);
            }
            let Some(sample) = newest else { continue };
            shown(show(&sample, (index, view))?)?;
            had_one = true;
        }
        if index > 0 {
            view.forget();
        }
    }
    Ok(())
}

fn show(sample: &Sample, (index, view): (u8, &Arc<View>)) -> Result<Shown, DialogError> {
    let frame = FrameView::new(sample.payload())?;
    let tick = sample.envelope().tick;
    let shown = Shown { command: frame.header.command, tick, sent_nanos: sample.envelope().sent_nanos };
    let Some(color) = frame.plane(Plane::Color) else { return Ok(shown) };
    // The pictures of a panorama stand one above the other.
    let size = [frame.header.width, frame.header.height * frame.header.views];
    match encode(index, tick, size, color) {
        Ok(bytes) => view.show(Arc::new(bytes), frame.ids().map(|ids| Ids::new(tick, size, ids))),
        Err(error) => tracing::warn!("a frame could not be encoded: {error}"),
    }
    Ok(shown)
}

fn encode(index: u8, tick: u64, [width, height]: [u32; 2], rgba: &[u8]) -> Result<Vec<u8>, EncodingError> {
    let mut bytes = vec![1, index, 0, 0, 0, 0, 0, 0];
    bytes.extend(tick.to_le_bytes());
    let side = |pixels: u32| u16::try_from(pixels).unwrap_or(u16::MAX);
    Encoder::new(&mut bytes, QUALITY).encode(rgba, side(width), side(height), ColorType::Rgba)?;
    Ok(bytes)
}
