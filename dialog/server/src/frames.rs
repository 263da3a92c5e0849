//! The live views: the newest frame of each camera that a page looks through, as JPEG.

use std::{sync::Arc, time::Duration};

use cohabit_bus::{
    Inbox, Pauses, Sample, Topic, Transport, Wake, give_way,
    message::{FrameHeader, FrameView, Malformed, Plane},
};
use jpeg_encoder::{ColorType, Encoder, EncodingError};

use crate::{
    DialogError,
    view::{Eye, Ids, View},
};

/// JPEG quality, of 100.
const QUALITY: u8 = 82;
/// How long a relay that nobody needs sleeps before it looks whether the session is over.
const DOZE: Duration = Duration::from_millis(100);

/// A frame that pages get.
#[derive(Clone, Copy, Debug)]
pub struct Shown {
    /// When it was seen.
    pub tick: u64,
    /// When it was sent.
    pub sent_nanos: u64,
}

/// Relays frames to the pages that look through the view with this index until `over`. Subscribes, and so has frames
/// rendered, only while there are any; of the first view at the start too, until one was had. `shown` hears of each.
/// Whoever sends frames that are none is not heard for a pause.
pub fn relay(
    bus: &dyn Transport,
    (index, view): (u8, &Arc<View>),
    pauses: Pauses,
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
        let mut frames = Inbox::with_pauses(bus, Topic::Frames(view.camera), pauses)?;
        while !over() && (view.is_wanted() || !had_one) {
            listener.wait(Duration::from_millis(50))?;
            let mut newest = None;
            while let Some((sample, ())) = frames.next(|sample| FrameView::new(sample.payload()).map(drop))? {
                newest = Some(sample);
            }
            let Some(sample) = newest else { continue };
            match show(&sample, (index, view)) {
                Ok(frame) => shown(frame)?,
                // Its memory was spoilt after it was looked at.
                Err(error) => tracing::warn!("a frame was passed over: {error}"),
            }
            had_one = true;
        }
        if index > 0 {
            view.forget();
        }
    }
    Ok(())
}

fn show(sample: &Sample, (index, view): (u8, &Arc<View>)) -> Result<Shown, Malformed> {
    let frame = FrameView::new(sample.payload())?;
    let tick = sample.envelope().tick;
    let shown = Shown { tick, sent_nanos: sample.envelope().sent_nanos };
    let Some(color) = frame.plane(Plane::Color) else { return Ok(shown) };
    // The pictures of a panorama stand one above the other.
    let size = [frame.header.width, frame.header.height * frame.header.views];
    let FrameHeader { position_m, yaw_rad, pitch_rad, fov_y_rad, views: pictures, .. } = frame.header;
    let eye = Eye { position_m, yaw_rad, pitch_rad, fov_y_rad, pictures };
    match encode(index, tick, size, color) {
        Ok(bytes) => view.show(Arc::new(bytes), frame.ids().map(|ids| Ids::new(tick, size, ids).seen_from(eye))),
        Err(error) => tracing::warn!("a frame could not be encoded: {error}"),
    }
    Ok(shown)
}

fn encode(index: u8, tick: u64, size: [u32; 2], rgba: &[u8]) -> Result<Vec<u8>, EncodingError> {
    let mut bytes = vec![1, index, 0, 0, 0, 0, 0, 0];
    bytes.extend(tick.to_le_bytes());
    encode_jpeg(&mut bytes, size, rgba)?;
    Ok(bytes)
}

/// Appends a picture of that width and height to `bytes`, as JPEG. `rgba` is `[height, width, 4]`.
///
/// # Errors
/// [`EncodingError`], if a side is 0 or `rgba` is too short.
pub fn encode_jpeg(bytes: &mut Vec<u8>, [width, height]: [u32; 2], rgba: &[u8]) -> Result<(), EncodingError> {
    let side = |pixels: u32| u16::try_from(pixels).unwrap_or(u16::MAX);
    Encoder::new(bytes, QUALITY).encode(rgba, side(width), side(height), ColorType::Rgba)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::{
        f32::consts::{FRAC_PI_2, FRAC_PI_4},
        sync::atomic::{AtomicBool, Ordering},
        thread,
        time::Instant,
    };

    use cohabit_bus::{CameraId, Local, message::FrameLayout};

    use super::*;

    #[test]
    fn the_floor_is_found_in_each_picture_of_a_panorama() {
        let (bus, view) = (Local::new(1), Arc::new(View::new("around".parse().unwrap())));
        let mut frames = bus.subscriber(Topic::Frames(view.camera)).unwrap();
        let mut publisher = bus.publisher(Topic::Frames(view.camera)).unwrap();
        let layout = FrameLayout::new(16, 16, 4, &[Plane::Color, Plane::Ids], 0);
        let write = &mut |bytes: &mut [u8]| {
            bytes.fill(0);
            let header = layout.split_mut(bytes).header;
            (header.position_m, header.pitch_rad, header.fov_y_rad) = ([1.0, 2.0, 1.0], -FRAC_PI_4, FRAC_PI_2);
        };
        publisher.send(1, layout.bytes(), write).unwrap();
        show(&frames.receive().unwrap().unwrap(), (0, &view)).unwrap();
        // East, south, west and north, a metre ahead each.
        for (picture, expected) in (0_u8..).zip([[2.0, 2.0], [1.0, 1.0], [0.0, 2.0], [1.0, 3.0]]) {
            let [x, y] = view.floor_at(1, [0.5, (f32::from(picture) + 0.5) / 4.0]).unwrap();
            assert!((x - expected[0]).abs() < 1e-4 && (y - expected[1]).abs() < 1e-4, "{picture}: {x} {y}");
        }
    }

    /// Ends the relay also when a check fails.
    struct Over<'a>(&'a AtomicBool);

    impl Drop for Over<'_> {
        fn drop(&mut self) {
            self.0.store(true, Ordering::Relaxed);
        }
    }

    #[test]
    fn frames_are_shown_again_after_some_were_spoilt() {
        let (bus, over) = (Local::new(1), AtomicBool::new(false));
        let view = Arc::new(View::new(CameraId::Spectator(0)));
        let pauses = Pauses { first: Duration::from_millis(5), longest: Duration::from_millis(40) };
        let layout = FrameLayout::new(16, 16, 1, &[Plane::Color], 0);
        thread::scope(|scope| {
            let relayed =
                scope.spawn(|| relay(&bus, (0, &view), pauses, &|_| Ok(()), &|| over.load(Ordering::Relaxed)));
            let ending = Over(&over);
            let (_frames, _viewing) = view.join();
            let mut publisher = bus.publisher(Topic::Frames(view.camera)).unwrap();
            let deadline = Instant::now() + Duration::from_secs(60);
            let mut send = |tick: u64, is_spoilt: bool| {
                assert!(Instant::now() < deadline, "nothing is shown any more");
                let write = &mut |bytes: &mut [u8]| {
                    bytes.fill(0);
                    layout.split_mut(bytes);
                    if is_spoilt {
                        bytes.fill(0xff);
                    }
                };
                publisher.send(tick, layout.bytes(), write).unwrap();
                thread::sleep(Duration::from_millis(1));
            };
            let shown = || view.newest().map(|frame| frame[8]);
            for tick in [1, 2, 3] {
                while shown() != Some(tick) {
                    send(u64::from(tick), false);
                }
                (0..100).for_each(|_| send(0, true));
            }
            drop(ending);
            relayed.join().unwrap().unwrap();
        });
    }
}
