//! What the GPU is told to draw for some cameras.

use core::ops::Range;

use bytemuck::{Pod, Zeroable};
use cohabit_render::backend::{self, Seen, Sight, Thing, Veil};

use crate::geometry::{Geometry, Slot, SlotPiece};

/// A camera as the shader reads it.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Camera {
    eye: [f32; 4],
    right: [f32; 4],
    down: [f32; 4],
    forward: [f32; 4],
    tile: [f32; 4],
}

impl Camera {
    pub(crate) fn new(sight: &Sight, at: [u32; 2], size: [u32; 2]) -> Self {
        let pixel_m = 1.0 / sight.focal;
        Self {
            eye: sight.eye.extend(sight.focal).to_array(),
            right: sight.right.extend(sight.center[0]).to_array(),
            down: sight.down.extend(sight.center[1]).to_array(),
            forward: sight.forward.extend(pixel_m * pixel_m).to_array(),
            tile: [at[0] as f32, at[1] as f32, size[0] as f32, size[1] as f32],
        }
    }
}

/// A piece as the shader reads it.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Piece {
    rotation: [[f32; 4]; 3],
    inverse: [[f32; 4]; 3],
    tint: [f32; 4],
    fluid: [f32; 4],
    id: u32,
    flags: u32,
    room: u32,
    unused: u32,
}

impl Piece {
    pub(crate) fn new(own: &backend::Piece) -> Self {
        let columns = |matrix: glam::Mat3, w: glam::Vec3| {
            [matrix.x_axis.extend(w.x), matrix.y_axis.extend(w.y), matrix.z_axis.extend(w.z)].map(|c| c.to_array())
        };
        let flags = [own.dirty, own.cold, own.infected, own.lit];
        Self {
            rotation: columns(own.rotation, own.offset),
            inverse: columns(own.inverse, own.light),
            tint: own.tint.extend(0.0).to_array(),
            fluid: own.fluid.extend(0.0).to_array(),
            id: own.id,
            flags: (0..).zip(flags).map(|(bit, set)| u32::from(set) << bit).sum(),
            room: own.room,
            unused: 0,
        }
    }
}

/// A draw as the shader reads it.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Draw {
    piece: u32,
    camera: u32,
}

/// A draw as the GPU reads it.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Arguments {
    pub index_count: u32,
    pub instance_count: u32,
    pub first_index: u32,
    pub base_vertex: i32,
    pub first_instance: u32,
}

/// All draws for some cameras.
#[derive(Debug, Default)]
pub(crate) struct Work {
    pub cameras: Vec<Camera>,
    pub draws: Vec<Draw>,
    pub arguments: Vec<Arguments>,
    /// For each camera which of the draws are its own.
    pub solid: Vec<Range<u32>>,
    /// What is see-through, in the order of drawing.
    pub veils: Vec<VeilRun>,
}

/// See-through draws of one camera and one kind.
#[derive(Clone, Debug)]
pub(crate) struct VeilRun {
    pub camera: u32,
    pub veil: Veil,
    pub draws: Range<u32>,
}

impl Work {
    pub(crate) fn clear(&mut self) {
        self.cameras.clear();
        self.draws.clear();
        self.arguments.clear();
        self.solid.clear();
        self.veils.clear();
    }

    /// Adds what a camera sees, the nearest first. Every mesh was uploaded.
    pub(crate) fn add(&mut self, office: &Office<'_>, camera: Camera, seen: &[Seen]) {
        let number = self.cameras.len() as u32;
        self.cameras.push(camera);
        let first = self.draws.len() as u32;
        for seen in seen {
            office.each(seen, |piece, slot, own| {
                if own.veil.is_none() {
                    self.draw(number, piece, slot, own);
                }
            });
        }
        self.solid.push(first..self.draws.len() as u32);
        for seen in seen.iter().rev() {
            office.each(seen, |piece, slot, own| {
                if let Some(veil) = own.veil {
                    let at = self.draw(number, piece, slot, own);
                    match self.veils.last_mut().filter(|run| run.camera == number && run.veil == veil) {
                        Some(run) => run.draws.end = at + 1,
                        None => self.veils.push(VeilRun { camera: number, veil, draws: at..at + 1 }),
                    }
                }
            });
        }
    }

    fn draw(&mut self, camera: u32, piece: u32, slot: &Slot, own: SlotPiece) -> u32 {
        let (first_instance, base_vertex) = (self.draws.len() as u32, slot.base_vertex);
        let SlotPiece { first_index, index_count, .. } = own;
        self.draws.push(Draw { piece, camera });
        self.arguments.push(Arguments { index_count, instance_count: 1, first_index, base_vertex, first_instance });
        first_instance
    }
}

/// All that stands in a scene, and where it lies on the GPU.
#[derive(Clone, Copy)]
pub(crate) struct Office<'a> {
    pub geometry: &'a Geometry,
    pub plan: usize,
    pub things: &'a [Thing],
    pub pieces: &'a [backend::Piece],
}

impl Office<'_> {
    /// Calls for each piece of a thing with its number, the mesh and the mesh's piece.
    fn each(&self, seen: &Seen, mut call: impl FnMut(u32, &Slot, SlotPiece)) {
        let thing = &self.things[seen.thing as usize];
        let slot = match thing.model {
            None => Some(self.geometry.plan(self.plan)),
            Some(model) => self.geometry.model(model, seen.level),
        };
        let Some(slot) = slot else { return };
        for piece in thing.first..thing.first + thing.count {
            call(piece, slot, slot.pieces[self.pieces[piece as usize].piece as usize]);
        }
    }
}
