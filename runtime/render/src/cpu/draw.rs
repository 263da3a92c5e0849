//! What has to be drawn for one picture: pieces of meshes, each with its place and its light.

use glam::{Mat3, Vec3};

use crate::camera::{Camera, View};
use crate::library::ModelMesh;
use crate::mesh::{Mesh, Piece};
use crate::plan::RoomSurface;
use crate::portals::Visible;
use crate::scene::{Scene, Transform, Weather};

/// Radius in pixels above which an instance is drawn finely, and above which it is not drawn coarsely.
const LEVEL_PX: [f32; 2] = [130.0, 36.0];
/// Less than this radius in pixels is nothing to see.
const LEAST_PX: f32 = 0.35;
/// What is left of the light where the lamps are off.
const UNLIT: Vec3 = Vec3::new(0.13, 0.15, 0.20);

/// How much of the surrounding light reaches the corners of a mesh.
#[derive(Clone, Copy, Debug)]
pub(super) enum Ambient<'a> {
    /// Known from the start.
    Known(&'a [f32]),
    /// Of a model's level; worked out when it is first asked for.
    Of(&'a ModelMesh, usize),
}

impl<'a> Ambient<'a> {
    #[inline]
    pub(super) fn corners(self) -> &'a [f32] {
        match self {
            Self::Known(corners) => corners,
            Self::Of(model, level) => model.ambient(level),
        }
    }
}

/// One piece of a mesh in its place.
#[derive(Debug)]
pub(super) struct Draw<'a> {
    pub mesh: &'a Mesh,
    pub ambient: Ambient<'a>,
    pub piece: &'a Piece,
    pub transform: Transform,
    pub id: u32,
    pub tint: Vec3,
    pub fluid: Vec3,
    pub weather: Weather,
    /// The light in its room, as a factor.
    pub light: Vec3,
    pub lit: bool,
    pub room: u16,
    /// From the mesh's frame to the camera's.
    pub to_camera: (Mat3, Vec3),
    /// The eye in the mesh's frame.
    pub eye: Vec3,
    /// How far from the eye it begins, to draw near things first.
    near_m: f32,
}

impl Draw<'_> {
    /// How much work it is to set up.
    pub(super) fn cost(&self) -> usize {
        self.piece.triangles.len() + 8
    }
}

/// Everything that may be seen, the nearest first; and apart from it what is see-through, the farthest first.
pub(super) fn collect<'a>(
    scene: &'a Scene,
    camera: &Camera,
    view: &View,
    visible: &Visible,
) -> (Vec<Draw<'a>>, Vec<Draw<'a>>) {
    let (mut draws, mut veils) = (Vec::with_capacity(1024), Vec::new());
    let light = |room: usize| if scene.lit[room] { Vec3::ONE } else { UNLIT };
    for part in &scene.plan.parts {
        if !camera.ceiling && matches!(part.surface, RoomSurface::Ceiling | RoomSurface::Lamp) {
            continue;
        }
        let (center, radius) = (part.bounds.center(), part.bounds.size().length() * 0.5);
        let Some(rect) = view.sphere_rect(center, radius) else { continue };
        if !visible.sees(part.rooms, rect) {
            continue;
        }
        let room = part.room as usize;
        draws.push(Draw {
            mesh: &scene.plan.mesh,
            ambient: Ambient::Known(&scene.plan.ambient),
            piece: &scene.plan.mesh.pieces[part.piece as usize],
            transform: Transform::IDENTITY,
            id: part.id,
            tint: Vec3::ONE,
            fluid: Vec3::ONE,
            weather: Weather::default(),
            light: light(room),
            lit: scene.lit[room],
            room: room as u16,
            to_camera: to_camera(view, &Transform::IDENTITY),
            eye: view.eye,
            near_m: nearest(view, part.bounds.min, part.bounds.max),
        });
    }
    for placed in scene.placed().filter(|placed| camera.hide != Some(placed.id)) {
        let Some(rect) = view.sphere_rect(placed.center, placed.radius) else { continue };
        if !visible.sees(placed.rooms, rect) {
            continue;
        }
        let depth = view.in_camera(placed.center).z.max(0.05);
        let pixels = placed.radius * view.focal / depth;
        if pixels < LEAST_PX {
            continue;
        }
        let level = LEVEL_PX.iter().filter(|limit| pixels < **limit).count();
        let model = scene.meshes.model(placed.model);
        let mesh = &model.levels[level];
        let room = placed.room as usize;
        let near_m = nearest(view, placed.bounds.min, placed.bounds.max);
        for (piece, transform) in &placed.pieces {
            let transform = placed.transforms[usize::from(*transform)];
            let piece = &mesh.pieces[usize::from(*piece)];
            let list = if piece.veil.is_some() { &mut veils } else { &mut draws };
            list.push(Draw {
                mesh,
                ambient: Ambient::Of(model, level),
                piece,
                transform,
                id: placed.id,
                tint: placed.tint,
                fluid: placed.fluid,
                weather: placed.weather,
                light: light(room),
                lit: scene.lit[room],
                room: room as u16,
                to_camera: to_camera(view, &transform),
                eye: transform.inverse * (view.eye - transform.offset),
                near_m,
            });
        }
    }
    // Stable: what is equally near stays in the order of the scene.
    draws.sort_by(|a, b| a.near_m.total_cmp(&b.near_m));
    veils.sort_by(|a, b| b.near_m.total_cmp(&a.near_m));
    (draws, veils)
}

fn to_camera(view: &View, transform: &Transform) -> (Mat3, Vec3) {
    let turn = Mat3::from_cols(view.right, view.down, view.forward).transpose();
    (turn * transform.rotation, turn * (transform.offset - view.eye))
}

fn nearest(view: &View, min: Vec3, max: Vec3) -> f32 {
    (view.eye.clamp(min, max) - view.eye).length()
}
