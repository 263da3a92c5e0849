//! A scene as a back end reads it.

use std::sync::Arc;

use glam::{Mat3, Vec3};

use super::{MeshData, Shadows};
use crate::camera::{Camera, View};
use crate::library::MeshLibrary;
use crate::placed::{Placed, Transform};
use crate::plan::Plan;
use crate::portals::Visible;
use crate::scene::Scene;
use crate::seen;
use crate::weather::Weather;

/// Which floor plan a scene has; keeps it alive, so that no other is ever equal to it.
#[derive(Clone, Debug)]
pub struct PlanKey(Arc<Plan>);

impl PartialEq for PlanKey {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

/// Something that is seen or not seen as a whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thing {
    /// The model whose mesh is drawn; the plan's mesh if absent.
    pub model: Option<u32>,
    /// Its first piece among all pieces.
    pub first: u32,
    /// How many pieces follow one another.
    pub count: u32,
}

/// One piece of a mesh in its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Which of the mesh's pieces.
    pub piece: u32,
    /// What stands in the id plane.
    pub id: u32,
    /// From the mesh's frame to the world.
    pub rotation: Mat3,
    /// Where the mesh's origin lies in the world, m.
    pub offset: Vec3,
    /// The inverse of `rotation`.
    pub inverse: Mat3,
    /// What [`super::Paint::Tint`] stands for.
    pub tint: Vec3,
    /// What [`super::Paint::Fluid`] stands for.
    pub fluid: Vec3,
    /// Dirt lies over it.
    pub dirty: bool,
    /// Frost lies over it.
    pub cold: bool,
    /// Slime lies over it.
    pub infected: bool,
    /// The light in its room, as a factor.
    pub light: Vec3,
    /// Whether the lamps of its room are on.
    pub lit: bool,
    /// Its room, as the shadows know it.
    pub room: u32,
}

/// A thing that a camera may see.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Seen {
    /// Which of [`Stage::things`].
    pub thing: u32,
    /// The level of detail of its model; 0 for the plan.
    pub level: u32,
}

/// A camera, worked out: a point in the camera's frame at depth 1 lies at `center + focal * (x, y)` in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight {
    /// Where it stands, m.
    pub eye: Vec3,
    /// The camera's x in the world.
    pub right: Vec3,
    /// The camera's y in the world.
    pub down: Vec3,
    /// The camera's z in the world.
    pub forward: Vec3,
    /// Pixels a unit of slope.
    pub focal: f32,
    /// The optical axis, in pixels.
    pub center: [f32; 2],
}

/// A scene as a back end reads it.
#[derive(Clone, Copy, Debug)]
pub struct Stage<'a> {
    scene: &'a Scene,
}

impl<'a> Stage<'a> {
    /// Reads this scene.
    #[must_use]
    pub fn new(scene: &'a Scene) -> Self {
        Self { scene }
    }

    /// The meshes of all models.
    #[must_use]
    pub fn library(self) -> &'a Arc<MeshLibrary> {
        &self.scene.meshes
    }

    /// The floor plan.
    #[must_use]
    pub fn plan(self) -> PlanKey {
        PlanKey(Arc::clone(&self.scene.plan))
    }

    /// The floor plan's mesh.
    #[must_use]
    pub fn plan_mesh(self) -> MeshData {
        MeshData::new(&self.scene.plan.mesh, &self.scene.plan.ambient)
    }

    /// A model's mesh at a level of detail; its surrounding light is worked out if nobody asked for it before.
    ///
    /// # Panics
    /// If no [`Thing`] has this model, or nothing [`Seen`] this level.
    #[must_use]
    pub fn model_mesh(self, model: u32, level: u32) -> MeshData {
        let model = self.scene.meshes.model(model as usize);
        let level = level as usize;
        MeshData::new(&model.levels[level], model.ambient(level))
    }

    /// The map of shadows, brought up to date.
    #[must_use]
    pub fn shadows(self) -> Shadows<'a> {
        Shadows { map: self.scene.clean_shadows() }
    }

    /// All that stands in the scene, and the pieces it consists of.
    #[must_use]
    pub fn things(self) -> (Vec<Thing>, Vec<Piece>) {
        let scene = self.scene;
        let (mut things, mut pieces) = (Vec::with_capacity(1024), Vec::with_capacity(2048));
        for part in &scene.plan.parts {
            things.push(Thing { model: None, first: pieces.len() as u32, count: 1 });
            pieces.push(Piece {
                piece: part.piece,
                id: part.id,
                tint: Vec3::ONE,
                fluid: Vec3::ONE,
                ..plain(scene, Transform::IDENTITY, Weather::default(), part.room)
            });
        }
        for placed in scene.placed() {
            let (first, count) = (pieces.len() as u32, placed.pieces.len() as u32);
            things.push(Thing { model: Some(placed.model as u32), first, count });
            pieces.extend(placed.pieces.iter().map(|own| piece(scene, placed, *own)));
        }
        (things, pieces)
    }

    /// How a camera looks, and what it may see, the nearest first.
    #[must_use]
    pub fn seen(self, camera: &Camera) -> (Sight, Vec<Seen>) {
        let view = View::new(camera);
        let visible = Visible::new(&self.scene.plan, &view, camera);
        let all = seen::collect(self.scene, camera, &view, &visible);
        let seen = all.iter().map(|seen| {
            let level = match seen.thing {
                seen::Thing::Part(_) => 0,
                seen::Thing::Placed(_, level) => level as u32,
            };
            Seen { thing: seen.number as u32, level }
        });
        let View { eye, right, down, forward, focal, center, .. } = view;
        (Sight { eye, right, down, forward, focal, center }, seen.collect())
    }

    /// Whether anything is highlighted.
    #[must_use]
    pub fn has_highlights(self) -> bool {
        !self.scene.highlights.is_empty()
    }
}

fn piece(scene: &Scene, placed: &Placed, (piece, transform): (u16, u16)) -> Piece {
    Piece {
        piece: u32::from(piece),
        id: placed.id,
        tint: placed.tint,
        fluid: placed.fluid,
        ..plain(scene, placed.transforms[usize::from(transform)], placed.weather, placed.room)
    }
}

fn plain(scene: &Scene, transform: Transform, weather: Weather, room: u8) -> Piece {
    let Weather { dirty, cold, infected } = weather;
    Piece {
        piece: 0,
        id: 0,
        rotation: transform.rotation,
        offset: transform.offset,
        inverse: transform.inverse,
        tint: Vec3::ONE,
        fluid: Vec3::ONE,
        dirty,
        cold,
        infected,
        light: scene.light(room),
        lit: scene.is_lit(room),
        room: scene.plan.shadow_room(room).into(),
    }
}
