//! What has to be drawn for one picture: pieces of meshes, each with its place and its light.

use glam::{Mat3, Vec3};

use crate::camera::{Camera, View};
use crate::library::ModelMesh;
use crate::mesh::{Mesh, Piece};
use crate::placed::{Placed, Transform};
use crate::plan::PlanPart;
use crate::portals::Visible;
use crate::scene::Scene;
use crate::seen::{self, Thing};
use crate::weather::Weather;

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
    /// Its room, as the shadows know it.
    pub room: u16,
    /// From the mesh's frame to the camera's.
    pub to_camera: (Mat3, Vec3),
    /// The eye in the mesh's frame.
    pub eye: Vec3,
}

/// Everything that may be seen, the nearest first; and apart from it what is see-through, the farthest first.
pub(super) fn collect<'a>(
    scene: &'a Scene,
    camera: &Camera,
    view: &View,
    visible: &Visible,
) -> (Vec<Draw<'a>>, Vec<Draw<'a>>) {
    let all = seen::collect(scene, camera, view, visible);
    let mut draws = Vec::with_capacity(all.len() * 2);
    for seen in &all {
        match seen.thing {
            Thing::Part(part) => draws.push(of_part(scene, part, view)),
            Thing::Placed(placed, level) => {
                draws.extend(of_placed(scene, placed, level, view, false));
            }
        }
    }
    let mut veils = Vec::new();
    for seen in all.iter().rev() {
        if let Thing::Placed(placed, level) = seen.thing {
            veils.extend(of_placed(scene, placed, level, view, true));
        }
    }
    (draws, veils)
}

/// The pieces that are see-through, or those that are not.
fn of_placed<'a>(
    scene: &'a Scene,
    placed: &'a Placed,
    level: usize,
    view: &View,
    veils: bool,
) -> impl Iterator<Item = Draw<'a>> {
    let model = scene.meshes.model(placed.model);
    let mesh = &model.levels[level];
    let room = placed.room;
    let pieces = placed.pieces.iter().map(|(piece, transform)| (&mesh.pieces[usize::from(*piece)], transform));
    pieces.filter(move |(piece, _)| piece.veil.is_some() == veils).map(move |(piece, transform)| {
        let transform = placed.transforms[usize::from(*transform)];
        Draw {
            mesh,
            ambient: Ambient::Of(model, level),
            piece,
            transform,
            id: placed.id,
            tint: placed.tint,
            fluid: placed.fluid,
            weather: placed.weather,
            light: scene.light(room),
            lit: scene.is_lit(room),
            room: placed.shadow_room.into(),
            to_camera: to_camera(view, &transform),
            eye: transform.inverse * (view.eye - transform.offset),
        }
    })
}

fn of_part<'a>(scene: &'a Scene, part: &PlanPart, view: &View) -> Draw<'a> {
    let room = part.room;
    Draw {
        mesh: &scene.plan.mesh,
        ambient: Ambient::Known(&scene.plan.ambient),
        piece: &scene.plan.mesh.pieces[part.piece as usize],
        transform: Transform::IDENTITY,
        id: part.id,
        tint: Vec3::ONE,
        fluid: Vec3::ONE,
        weather: Weather::default(),
        light: scene.light(room),
        lit: scene.is_lit(room),
        room: scene.plan.shadow_room(room).into(),
        to_camera: to_camera(view, &Transform::IDENTITY),
        eye: view.eye,
    }
}

fn to_camera(view: &View, transform: &Transform) -> (Mat3, Vec3) {
    let turn = Mat3::from_cols(view.right, view.down, view.forward).transpose();
    (turn * transform.rotation, turn * (transform.offset - view.eye))
}
