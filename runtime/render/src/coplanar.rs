//! Finds surfaces that lie in the same plane and would fight for pixels: exact sight lines through everything placed,
//! in double precision, with no renderer involved, so that one rounding or another neither hides nor makes a find.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;

use glam::Vec3;

use crate::camera::{Camera, View};
use crate::placed::Transform;
use crate::plan::RoomSurface;
use crate::scene::Scene;
use crate::veil::Veil;

mod tests;

/// Surfaces that look the same way, seen by the cosine between them, may fight.
const PARALLEL: f64 = 0.9995;
/// Nothing nearer is looked at, m.
const NEAREST_M: f64 = 0.1;

/// A place or a direction in double precision.
pub(super) type Place = [f64; 3];

fn exact(vector: Vec3) -> Place {
    vector.to_array().map(f64::from)
}

fn minus(a: Place, b: Place) -> Place {
    [0, 1, 2].map(|i| a[i] - b[i])
}

fn dot(a: Place, b: Place) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A triangle in the world, and whose it is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    corners: [Place; 3],
    outward: Place,
    pub owner: Owner,
}

/// Where a triangle comes from.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub(super) struct Owner {
    pub id: u32,
    /// The model, or nothing for the floor plan.
    pub model: Option<usize>,
    /// What its surface looks like, as an index that its mesh knows.
    pub surface: u16,
    /// Of the mesh.
    pub triangle: u32,
}

/// Two surfaces that lie closer to each other than they should where they are seen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fight {
    pub owners: [Owner; 2],
    /// How many sight lines met both.
    pub count: u32,
    /// The least distance between them, m.
    pub gap_m: f64,
    /// Where.
    pub place: Place,
    /// Which way they look.
    pub outward: Place,
}

/// All triangles of a scene at one level of detail.
pub(super) fn faces(scene: &Scene, level: usize, ceiling: bool) -> Vec<Face> {
    let mut all = Vec::new();
    for part in &scene.plan.parts {
        if ceiling || !matches!(part.surface, RoomSurface::Ceiling | RoomSurface::Lamp) {
            let piece = &scene.plan.mesh.pieces[part.piece as usize];
            push(&mut all, &scene.plan.mesh, piece, &Transform::IDENTITY, (part.id, None));
        }
    }
    for placed in scene.placed() {
        let mesh = &scene.meshes.model(placed.model).levels[level];
        for (piece, transform) in &placed.pieces {
            let transform = &placed.transforms[usize::from(*transform)];
            push(&mut all, mesh, &mesh.pieces[usize::from(*piece)], transform, (placed.id, Some(placed.model)));
        }
    }
    all
}

fn push(
    all: &mut Vec<Face>,
    mesh: &crate::mesh::Mesh,
    piece: &crate::mesh::Piece,
    transform: &Transform,
    (id, model): (u32, Option<usize>),
) {
    if piece.veil == Some(Veil::Airy) {
        // Hides nothing, and is never told from what is behind it.
        return;
    }
    for triangle in piece.triangles.clone() {
        let place = |corner: u32| -> Vec3 { transform.rotation * mesh.positions[corner as usize] + transform.offset };
        let corners = mesh.triangles[triangle as usize].map(|corner| exact(place(corner)));
        let (a, b) = (minus(corners[1], corners[0]), minus(corners[2], corners[0]));
        let across = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        let length = dot(across, across).sqrt();
        if length > 1e-12 {
            let surface = mesh.surface_of[triangle as usize];
            let outward = across.map(|value| value / length);
            all.push(Face { corners, outward, owner: Owner { id, model, surface, triangle } });
        }
    }
}

/// A triangle on the screen.
struct Flat {
    face: usize,
    at: [[f64; 2]; 3],
    rect: [usize; 4],
}

/// Follows the sight lines through all pixels of a camera; what lies within `gap_m` behind what is seen, looks the same
/// way and is not the same triangle fights with it.
pub(super) fn fights(faces: &[Face], camera: &Camera, gap_m: f64) -> Vec<Fight> {
    let view = View::new(camera);
    let flats: Vec<Flat> = (0..faces.len()).filter_map(|face| flatten(faces, face, &view)).collect();
    let (width, height) = (camera.width as usize, camera.height as usize);
    let mut nearest = vec![(f64::INFINITY, usize::MAX); width * height];
    let meet = |flat: &Flat, visit: &mut dyn FnMut(usize, f64, f64)| {
        let face = &faces[flat.face];
        let height_m = dot(face.outward, minus(face.corners[0], exact(view.eye)));
        for y in flat.rect[1]..=flat.rect[3] {
            for x in flat.rect[0]..=flat.rect[2] {
                let (px, py) = (x as f64 + 0.5, y as f64 + 0.5);
                if covers(&flat.at, px, py) {
                    let ray = exact(view.ray(px as f32, py as f32));
                    let facing = dot(face.outward, ray);
                    visit(y * width + x, height_m / facing, facing.abs());
                }
            }
        }
    };
    for flat in &flats {
        meet(flat, &mut |pixel, depth, _| {
            if depth < nearest[pixel].0 {
                nearest[pixel] = (depth, flat.face);
            }
        });
    }
    let mut found: BTreeMap<[Owner; 2], Fight> = BTreeMap::new();
    for flat in &flats {
        meet(flat, &mut |pixel, depth, facing| {
            let (before, winner) = nearest[pixel];
            let gap = (depth - before) * facing;
            if winner == flat.face || gap > gap_m || dot(faces[winner].outward, faces[flat.face].outward) < PARALLEL {
                return;
            }
            let (x, y) = (pixel % width, pixel / width);
            let place = exact(view.eye + view.ray(x as f32 + 0.5, y as f32 + 0.5) * before as f32);
            let mut owners = [faces[winner].owner, faces[flat.face].owner];
            owners.sort();
            let known = found.entry(owners).or_insert(Fight {
                owners,
                count: 0,
                gap_m: gap,
                place,
                outward: faces[winner].outward,
            });
            known.count += 1;
            known.gap_m = known.gap_m.min(gap);
        });
    }
    found.into_values().collect()
}

fn flatten(faces: &[Face], index: usize, view: &View) -> Option<Flat> {
    let face = &faces[index];
    let eye = exact(view.eye);
    if dot(face.outward, minus(face.corners[0], eye)) >= 0.0 {
        return None;
    }
    let axes = [view.right, view.down, view.forward].map(exact);
    let seen = face.corners.map(|corner| axes.map(|axis| dot(axis, minus(corner, eye))));
    if seen.iter().any(|corner| corner[2] < NEAREST_M) {
        return None;
    }
    let at = seen
        .map(|[x, y, z]| [0, 1].map(|axis| [x, y][axis] / z * f64::from(view.focal) + f64::from(view.center[axis])));
    let bound = |axis: usize| {
        let (low, high) = at.iter().fold((f64::MAX, f64::MIN), |(low, high), p| (low.min(p[axis]), high.max(p[axis])));
        let (from, to) = ((low - 0.5).ceil().max(0.0), (high - 0.5).floor().min(f64::from(view.size[axis]) - 1.0));
        (from <= to).then_some((from as usize, to as usize))
    };
    let ((left, right), (top, bottom)) = (bound(0)?, bound(1)?);
    Some(Flat { face: index, at, rect: [left, top, right, bottom] })
}

/// Whether a place lies inside, a hair away from all sides: neighbours never meet the same sight line.
fn covers(at: &[[f64; 2]; 3], x: f64, y: f64) -> bool {
    (0..3).all(|i| {
        let ([ax, ay], [bx, by]) = (at[i], at[(i + 1) % 3]);
        let (dx, dy) = (bx - ax, by - ay);
        // Counter-clockwise from outside is clockwise where y runs down.
        (dy * (x - ax) - dx * (y - ay)) > 1e-7 * dx.hypot(dy).max(1.0)
    })
}
