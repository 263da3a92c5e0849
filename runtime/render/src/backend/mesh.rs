//! Meshes as a GPU wants them: one surface a corner, ready to be indexed.

use core::ops::Range;
use std::collections::HashMap;

use glam::Vec3;

use crate::mesh::{Mesh, Paint};
use crate::pattern::{Gloss, Pattern};
use crate::veil::{self, Veil, VeilLook};

/// A corner of triangles that have the same surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// In the mesh's frame, m.
    pub position: Vec3,
    /// In the mesh's frame.
    pub normal: Vec3,
    /// How much of the surrounding light reaches it.
    pub ambient: f32,
    /// Which of the mesh's surfaces.
    pub surface: u32,
}

/// What a surface's colour follows from.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Light {
    /// Lit by the lamps.
    Lit,
    /// Shines by itself, always.
    Glow,
    /// Shines by itself while its room is lit.
    Lamp,
    /// Shows what is outside.
    Sky,
}

/// The look of some triangles.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Its colour.
    pub paint: Paint,
    /// What its colour follows from.
    pub light: Light,
    /// How light plays on it.
    pub gloss: Gloss,
    /// Which of the patterns' pictures modulates its colour: see [`super::picture`].
    pub picture: Option<usize>,
    /// The direction in which the picture's first coordinate grows in the mesh's frame, and its value at the origin, m.
    pub u: (Vec3, f32),
    /// The same for the second coordinate.
    pub v: (Vec3, f32),
    /// How it looks if it is see-through.
    pub veil: Option<VeilLook>,
    /// How much of what is behind it hides where it is looked at squarely, if it is see-through.
    pub opacity: f32,
}

/// Triangles that are drawn, and move, together.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct MeshPiece {
    /// Where its indices lie.
    pub indices: Range<u32>,
    /// How it is seen through, if it is.
    pub veil: Option<Veil>,
}

/// A mesh of which each piece is a range of indices.
#[derive(Clone, Debug, Default)]
pub struct MeshData {
    /// All corners.
    pub vertices: Vec<Vertex>,
    /// Three corners a triangle, counter-clockwise seen from outside.
    pub indices: Vec<u32>,
    /// All pieces.
    pub pieces: Vec<MeshPiece>,
    /// All surfaces.
    pub surfaces: Vec<Surface>,
}

impl MeshData {
    pub(super) fn new(mesh: &Mesh, ambient: &[f32]) -> Self {
        let mut data = Self { surfaces: mesh.surfaces.iter().map(surface).collect(), ..Self::default() };
        data.indices.reserve(mesh.triangles.len() * 3);
        let mut known: HashMap<(u32, u16), u32> = HashMap::with_capacity(mesh.positions.len());
        for piece in &mesh.pieces {
            let first = data.indices.len() as u32;
            for triangle in piece.triangles.start as usize..piece.triangles.end as usize {
                let own = mesh.surface_of[triangle];
                for corner in mesh.triangles[triangle] {
                    let vertices = &mut data.vertices;
                    let index = *known.entry((corner, own)).or_insert_with(|| {
                        let at = corner as usize;
                        vertices.push(Vertex {
                            position: mesh.positions[at],
                            normal: mesh.normals[at],
                            ambient: ambient[at],
                            surface: u32::from(own),
                        });
                        vertices.len() as u32 - 1
                    });
                    data.indices.push(index);
                }
            }
            data.pieces.push(MeshPiece { indices: first..data.indices.len() as u32, veil: piece.veil });
        }
        data
    }
}

fn surface(own: &crate::mesh::Surface) -> Surface {
    let light = match own.pattern {
        Pattern::Glow => Light::Glow,
        Pattern::Lamp => Light::Lamp,
        Pattern::Sky => Light::Sky,
        _ => Light::Lit,
    };
    Surface {
        paint: own.paint,
        light,
        gloss: own.pattern.gloss(),
        picture: own.pattern.picture_index(),
        u: own.u,
        v: own.v,
        veil: veil::look(own.pattern),
        opacity: own.opacity,
    }
}
