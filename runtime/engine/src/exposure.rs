//! Frames of the same moment, rendered together straight into the samples that are sent.

use bytemuck::cast_slice_mut;
use cohabit_bus::{
    BusError, Publisher,
    message::{FrameLayout, FrameParts, Plane, SeenRecord},
    monotonic_nanos,
};
use cohabit_render::{Camera, Classes, Planes, Renderer, Scene, SeenTable, Shot};

use crate::scene::Moment;

/// A frame that is to be made.
pub struct Take<'a> {
    /// Who sends it.
    pub publisher: &'a mut dyn Publisher,
    /// Where its parts lie.
    pub layout: FrameLayout,
    /// One a picture, all of one size.
    pub cameras: Vec<Camera>,
    /// The body that it belongs to, or [`NONE`](cohabit_bus::message::NONE).
    pub body: u32,
}

/// A frame that has its memory.
struct Exposure<'a> {
    cameras: &'a [Camera],
    body: u32,
    parts: FrameParts<'a>,
}

/// What makes frames.
pub struct Darkroom<'a> {
    /// Draws.
    pub renderer: &'a mut dyn Renderer,
    /// What there is to draw.
    pub scene: &'a Scene,
    /// What its ids stand for.
    pub classes: &'a Classes,
    /// Finds what is seen.
    pub table: &'a mut SeenTable,
    /// When it is.
    pub moment: &'a Moment,
}

impl Darkroom<'_> {
    /// Makes and sends all frames.
    ///
    /// # Errors
    /// [`BusError::Send`].
    pub fn expose(&mut self, takes: &mut [Take<'_>]) -> Result<(), BusError> {
        self.open(takes, Vec::new())
    }

    /// Takes memory for one frame after the other; when all have it, develops them.
    fn open(&mut self, takes: &mut [Take<'_>], opened: Vec<Exposure<'_>>) -> Result<(), BusError> {
        let Some((Take { publisher, layout, cameras, body }, rest)) = takes.split_first_mut() else {
            self.develop(opened);
            return Ok(());
        };
        let (mut opened, mut others) = (Some(opened), Ok(()));
        publisher.send(self.moment.tick, layout.bytes(), &mut |payload| {
            let mut opened = opened.take().unwrap_or_default();
            opened.push(Exposure { cameras, body: *body, parts: layout.split_mut(payload) });
            others = self.open(rest, opened);
        })?;
        others
    }

    fn develop(&mut self, mut exposures: Vec<Exposure<'_>>) {
        let began = monotonic_nanos();
        let mut shots: Vec<Shot<'_>> = exposures.iter_mut().flat_map(Exposure::shots).collect();
        self.renderer.render_all(self.scene, &mut shots);
        drop(shots);
        let render_nanos = monotonic_nanos() - began;
        for exposure in &mut exposures {
            exposure.note_seen(self.table, self.classes);
            let Some(camera) = exposure.cameras.first() else { continue };
            let header = &mut *exposure.parts.header;
            header.body = exposure.body;
            header.position_m = camera.position_m;
            header.yaw_rad = camera.yaw_rad;
            header.pitch_rad = camera.pitch_rad;
            header.fov_y_rad = camera.fov_y_rad;
            header.render_nanos = render_nanos;
            header.command = self.moment.command;
            header.seen_nanos = self.moment.seen_nanos;
        }
    }
}

impl Exposure<'_> {
    /// A picture for each camera, each with its part of the planes.
    fn shots(&mut self) -> Vec<Shot<'_>> {
        let bytes = self.cameras.first().map_or(1, Camera::pixels) * Plane::BYTES;
        let mut parts = self.parts.planes.each_mut().map(|plane| plane.as_deref_mut().map(|all| all.chunks_mut(bytes)));
        let shots = self.cameras.iter().map(|camera| {
            let [color, depth, normals, ids] = parts.each_mut().map(|chunks| chunks.as_mut().and_then(Iterator::next));
            let planes = Planes {
                color,
                depth_m: depth.map(cast_slice_mut),
                normals: normals.map(cast_slice_mut),
                ids: ids.map(cast_slice_mut),
            };
            Shot { camera: *camera, planes }
        });
        shots.collect()
    }

    /// Fills the table of what is seen, where there are ids.
    fn note_seen(&mut self, table: &mut SeenTable, classes: &Classes) {
        let FrameParts { header, planes: [.., Some(ids)], seen: records } = &mut self.parts else { return };
        let (width, pixels) = (header.width as usize, header.width as usize * header.height as usize);
        let ids: &[u32] = bytemuck::cast_slice(ids);
        let mut free = records.iter_mut();
        for (view, ids) in (0..).zip(ids.chunks(pixels)) {
            let seen = table.look(ids, width, classes);
            // The records come second: none is taken that is not filled.
            for (seen, record) in seen.iter().zip(free.by_ref()) {
                let [left, top, right, bottom] = seen.bounds.map(|place| u16::try_from(place).unwrap_or(u16::MAX));
                let (id, pixels, class) = (seen.id, seen.pixels, seen.class.index());
                *record = SeenRecord { id, pixels, class, view, left, top, right, bottom, reserved: 0 };
                header.seen += 1;
            }
        }
    }
}
