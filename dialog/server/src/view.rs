//! One camera's picture as pages get it, and who wants it.

use std::{
    collections::VecDeque,
    f32::consts::FRAC_PI_2,
    sync::{
        Arc, Condvar, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
    time::Duration,
};

use cohabit_bus::{CameraId, message::Thing};
use cohabit_cdf::ObjectId;
use tokio::sync::watch;

/// A frame as pages get it: JPEG behind a header of one kind byte (1), the view's index, six zero bytes, and the tick,
/// little-endian.
pub type Frame = Arc<Vec<u8>>;

/// Frames whose ids are kept, so that a click on one that was just replaced still finds what was there.
const FRAMES_KEPT: usize = 4;

/// Which thing is where in a frame: each thing's id, and the pixel after its last in a row of equal ones.
pub struct Ids {
    tick: u64,
    size: [u32; 2],
    runs: Vec<(u32, u32)>,
    eye: Option<Eye>,
}

/// Where a picture was taken from, in the world.
#[derive(Clone, Copy, Debug)]
pub struct Eye {
    /// Where, m; the floor is at 0.
    pub position_m: [f32; 3],
    /// Where it looks, rad.
    pub yaw_rad: f32,
    /// How far up it looks, rad.
    pub pitch_rad: f32,
    /// Between the upper and the lower edge, rad.
    pub fov_y_rad: f32,
    /// Pictures one above the other, each of which looks 90 degrees more to the right: 1, or 4 of a panorama.
    pub pictures: u32,
}

/// A floor that is seen flatter than this is too far away to be clicked: metres down per metre ahead.
const FLATTEST: f32 = 0.05;

impl Eye {
    /// The point on the floor at a place (0 to 1 from the left and from the top) of a picture of that size, m.
    fn floor_m(&self, size: [u32; 2], place: [f32; 2]) -> Option<[f32; 2]> {
        let pictures = self.pictures.max(1) as f32;
        let picture = (place[1] * pictures).floor().clamp(0.0, pictures - 1.0);
        let (down_it, yaw_rad) = (place[1] * pictures - picture, self.yaw_rad - picture * FRAC_PI_2);
        let half = (self.fov_y_rad / 2.0).tan();
        let aspect = size[0] as f32 * pictures / size[1].max(1) as f32;
        let (right, up) = ((2.0 * place[0] - 1.0) * half * aspect, (1.0 - 2.0 * down_it) * half);
        let ((sin_yaw, cos_yaw), (sin_pitch, cos_pitch)) = (yaw_rad.sin_cos(), self.pitch_rad.sin_cos());
        let (ahead, down) = (cos_pitch - up * sin_pitch, -(sin_pitch + up * cos_pitch));
        if down < FLATTEST {
            return None;
        }
        let [x_m, y_m, height_m] = self.position_m;
        let far = height_m / down;
        let [dx, dy] = [ahead * cos_yaw + right * sin_yaw, ahead * sin_yaw - right * cos_yaw];
        Some([x_m + far * dx, y_m + far * dy])
    }
}

impl Ids {
    /// The ids of a frame, row-major.
    pub fn new(tick: u64, size: [u32; 2], ids: &[u32]) -> Self {
        let mut end = 0;
        let runs = ids.chunk_by(|one, next| one == next).map(|run| {
            end += run.len() as u32;
            (run[0], end)
        });
        Self { tick, size, runs: runs.collect(), eye: None }
    }

    /// The same of a frame that was taken from there.
    pub fn seen_from(self, eye: Eye) -> Self {
        Self { eye: Some(eye), ..self }
    }

    /// Where each of these objects is, if it is seen: the middle of its pixels from the left, the first from the top.
    fn places(&self, objects: &[ObjectId]) -> Vec<Option<[f32; 2]>> {
        let mut sums = vec![(0_u64, 0_u64, u32::MAX); objects.len()];
        let mut start = 0;
        for (id, end) in &self.runs {
            if let Some(at) = objects.iter().position(|object| Thing::of_id(*id) == Thing::Object(*object)) {
                let (pixels, columns, top) = &mut sums[at];
                // A run goes on in the next row; its middle is then taken for that of the whole width.
                let [first, last] = [start, end - 1].map(|pixel| u64::from(pixel % self.size[0]));
                let middle = if first <= last { (first + last) / 2 } else { u64::from(self.size[0] / 2) };
                let count = u64::from(end - start);
                (*pixels, *columns, *top) =
                    (*pixels + count, *columns + count * middle, (*top).min(start / self.size[0]));
            }
            start = *end;
        }
        let [width, height] = self.size.map(|side| side.max(1) as f32);
        let place = |(pixels, columns, top): (u64, u64, u32)| {
            (pixels > 0).then(|| [(columns / pixels) as f32 / width, top as f32 / height])
        };
        sums.into_iter().map(place).collect()
    }

    /// The id at a place: 0 to 1 from the left and from the top.
    fn at(&self, place: [f32; 2]) -> Option<u32> {
        let [x, y] = [0, 1].map(|axis| ((place[axis] * self.size[axis] as f32) as u32).min(self.size[axis] - 1));
        let pixel = y * self.size[0] + x;
        let run = self.runs.partition_point(|(_, end)| *end <= pixel);
        self.runs.get(run).map(|(id, _)| *id)
    }
}

/// A camera that pages can look through.
pub struct View {
    /// Which.
    pub camera: CameraId,
    frame: watch::Sender<Option<Frame>>,
    ids: Mutex<VecDeque<Ids>>,
    viewers: AtomicUsize,
    gate: Mutex<()>,
    wanted: Condvar,
}

/// Counts a page as a viewer while it lives.
pub struct Viewing(Arc<View>);

impl Drop for Viewing {
    fn drop(&mut self) {
        self.0.viewers.fetch_sub(1, Ordering::Relaxed);
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl View {
    /// A view of which nothing was seen yet.
    pub fn new(camera: CameraId) -> Self {
        Self {
            camera,
            frame: watch::Sender::new(None),
            ids: Mutex::default(),
            viewers: AtomicUsize::new(0),
            gate: Mutex::default(),
            wanted: Condvar::new(),
        }
    }

    /// Somebody looks: the newest frame if it is no older than they are, and those to come.
    pub fn join(self: &Arc<Self>) -> (watch::Receiver<Option<Frame>>, Viewing) {
        let frames = self.frame.subscribe();
        if self.viewers.fetch_add(1, Ordering::Relaxed) == 0 {
            drop(lock(&self.gate));
            self.wanted.notify_all();
        }
        (frames, Viewing(Arc::clone(self)))
    }

    /// Whether anybody looks.
    pub fn is_wanted(&self) -> bool {
        self.viewers.load(Ordering::Relaxed) > 0
    }

    /// Sleeps until somebody looks, at most so long.
    pub fn wait_until_wanted(&self, most: Duration) {
        let gate = lock(&self.gate);
        let _ = self.wanted.wait_timeout_while(gate, most, |()| !self.is_wanted());
    }

    /// Shows a frame, whose ids are kept for a while.
    pub fn show(&self, frame: Frame, ids: Option<Ids>) {
        if let Some(ids) = ids {
            let mut kept = lock(&self.ids);
            kept.truncate(FRAMES_KEPT - 1);
            kept.push_front(ids);
        }
        self.frame.send_replace(Some(frame));
    }

    /// The newest frame.
    pub fn newest(&self) -> Option<Frame> {
        self.frame.borrow().clone()
    }

    /// Nobody has looked for a while: what was seen is no longer so.
    pub fn forget(&self) {
        lock(&self.ids).clear();
        self.frame.send_replace(None);
    }

    /// The id at a place (0 to 1 from the left and from the top) of the frame of a tick, or of the one nearest to it.
    pub fn id_at(&self, tick: u64, place: [f32; 2]) -> Option<u32> {
        lock(&self.ids).iter().min_by_key(|ids| ids.tick.abs_diff(tick))?.at(place)
    }

    /// Where on the floor that place is, m, whatever stands before it.
    pub fn floor_at(&self, tick: u64, place: [f32; 2]) -> Option<[f32; 2]> {
        let kept = lock(&self.ids);
        let ids = kept.iter().min_by_key(|ids| ids.tick.abs_diff(tick))?;
        ids.eye?.floor_m(ids.size, place)
    }
}

/// How far around the middle of a picture something may be that is aimed at, as a part of its width, and how many places
/// around it are looked at.
const AIM_RINGS: [f32; 3] = [0.008, 0.018, 0.03];
const AIM_SPOKES: [[f32; 2]; 8] =
    [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0], [0.7, 0.7], [-0.7, 0.7], [-0.7, -0.7], [0.7, -0.7]];

impl View {
    /// Where each of these objects is in the newest frame, if it is seen there.
    pub fn places(&self, objects: &[ObjectId]) -> Vec<Option<[f32; 2]>> {
        lock(&self.ids).front().map_or_else(|| vec![None; objects.len()], |ids| ids.places(objects))
    }

    /// What is in and around the middle of the newest frame, each thing once, the nearest first.
    pub fn ids_in_the_middle(&self) -> Vec<u32> {
        let kept = lock(&self.ids);
        let Some(newest) = kept.front() else { return Vec::new() };
        let aspect = newest.size[0] as f32 / newest.size[1].max(1) as f32;
        let around =
            AIM_RINGS.iter().flat_map(|ring| AIM_SPOKES.map(|[x, y]| [0.5 + x * ring, 0.5 + y * ring * aspect]));
        let mut found = Vec::new();
        for id in std::iter::once([0.5, 0.5]).chain(around).filter_map(|place| newest.at(place)) {
            if !found.contains(&id) {
                found.push(id);
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_click_finds_what_its_own_frame_showed() {
        let view = View::new(CameraId::Spectator(0));
        assert_eq!(view.id_at(1, [0.5, 0.5]), None);
        for tick in 1..=6 {
            let ids = [7, 7, tick as u32, 9, 9, 9];
            view.show(Frame::default(), Some(Ids::new(tick, [3, 2], &ids)));
        }
        let at = |tick, x, y| view.id_at(tick, [x, y]);
        assert_eq!([at(6, 0.9, 0.1), at(5, 0.9, 0.1), at(99, 0.9, 0.1)], [Some(6), Some(5), Some(6)]);
        assert_eq!([at(6, 0.0, 0.0), at(6, 0.6, 0.4), at(6, 1.0, 1.0)], [Some(7), Some(7), Some(9)]);
        assert_eq!(at(1, 0.9, 0.1), Some(3), "the oldest that is kept");
        view.forget();
        assert_eq!(at(6, 0.9, 0.1), None);
    }

    #[test]
    fn the_floor_is_found_where_the_eye_sees_it() {
        let view = View::new(CameraId::Eyes(0));
        let quarter = std::f32::consts::FRAC_PI_4;
        let (position_m, yaw_rad) = ([1.0, 2.0, 1.0], 2.0 * quarter);
        let eye = Eye { position_m, yaw_rad, pitch_rad: -quarter, fov_y_rad: quarter, pictures: 1 };
        view.show(Frame::default(), Some(Ids::new(1, [4, 3], &[1; 12]).seen_from(eye)));
        let [x, y] = view.floor_at(1, [0.5, 0.5]).unwrap();
        assert!((x - 1.0).abs() < 1e-5 && (y - 3.0).abs() < 1e-5, "a metre ahead, which is along y: {x} {y}");
        let [x, _] = view.floor_at(1, [0.9, 0.5]).unwrap();
        assert!(x > 1.0, "what is right of the middle is right of the eye");
        let [_, y] = view.floor_at(1, [0.5, 0.9]).unwrap();
        assert!(y < 3.0, "what is lower is nearer");
        let level = Eye { pitch_rad: 0.0, ..eye };
        view.show(Frame::default(), Some(Ids::new(2, [4, 3], &[1; 12]).seen_from(level)));
        assert_eq!(view.floor_at(2, [0.5, 0.5]), None);
    }

    #[test]
    fn things_are_found_where_they_are_seen() {
        let view = View::new(CameraId::Spectator(0));
        assert_eq!(view.places(&[ObjectId(6)]), [None]);
        let ids = [1, 1, 1, 1, 1, 7, 7, 1, 1, 7, 7, 1];
        view.show(Frame::default(), Some(Ids::new(1, [4, 3], &ids)));
        assert_eq!(view.places(&[ObjectId(6), ObjectId(7)]), [Some([0.25, 1.0 / 3.0]), None]);
    }

    #[test]
    fn the_middle_is_seen_from_the_inside_out() {
        let view = View::new(CameraId::Eyes(1));
        assert!(view.ids_in_the_middle().is_empty());
        // A thing of one pixel right of the middle, another one far off.
        let mut ids = vec![1_u32; 200 * 100];
        ids[50 * 200 + 100] = 3;
        ids[50 * 200 + 102] = 2;
        ids[50 * 200 + 160] = 4;
        view.show(Frame::default(), Some(Ids::new(1, [200, 100], &ids)));
        assert_eq!(view.ids_in_the_middle()[0], 3);
        assert!(!view.ids_in_the_middle().contains(&4));
    }

    #[test]
    fn a_view_is_wanted_while_somebody_looks() {
        let view = Arc::new(View::new(CameraId::Overhead(0)));
        let (_frames, viewing) = view.join();
        assert!(view.is_wanted());
        drop(viewing);
        assert!(!view.is_wanted());
    }
}
