//! What the GPU is told to draw for some cameras.

use core::ops::Range;

use bytemuck::{Pod, Zeroable};
use cohabit_render::backend::{self, Seen, Sight, Thing};

use crate::geometry::Geometry;

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
}

impl Work {
    pub(crate) fn clear(&mut self) {
        self.cameras.clear();
        self.draws.clear();
        self.arguments.clear();
        self.solid.clear();
    }

    /// Adds what a camera sees, the nearest first. Every mesh was uploaded.
    pub(crate) fn add(
        &mut self,
        geometry: &Geometry,
        plan: usize,
        things: &[Thing],
        pieces: &[backend::Piece],
        camera: Camera,
        seen: &[Seen],
    ) {
        let (number, first) = (self.cameras.len() as u32, self.draws.len() as u32);
        self.cameras.push(camera);
        for seen in seen {
            let thing = &things[seen.thing as usize];
            let slot = match thing.model {
                None => Some(geometry.plan(plan)),
                Some(model) => geometry.model(model, seen.level),
            };
            let Some(slot) = slot else { continue };
            for piece in thing.first..thing.first + thing.count {
                let [first_index, index_count] = slot.pieces[pieces[piece as usize].piece as usize];
                let first_instance = self.draws.len() as u32;
                self.draws.push(Draw { piece, camera: number });
                let base_vertex = slot.base_vertex;
                self.arguments.push(Arguments {
                    index_count,
                    instance_count: 1,
                    first_index,
                    base_vertex,
                    first_instance,
                });
            }
        }
        self.solid.push(first..self.draws.len() as u32);
    }
}
