//! The meshes of all models of a catalogue, built once and shared by every scene.
//!
//! Shapes are built at once, so that what is wrong with a model is known before anything runs. What only makes them
//! look good, occlusion and patterns, costs ten times as much: it is worked out for what is seen, when it is first seen.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use cohabit_cdf::catalog::Stands;
use cohabit_cdf::model::{Model, When};
use cohabit_cdf::{Catalog, ClassId, Property, RoomId};
use glam::Vec3;

use crate::color;
use crate::kit::Detail;
use crate::mesh::{Aabb, Mesh};
use crate::model_error::ModelError;
use crate::model_mesh;
use crate::occlusion::Occluder;
use crate::pattern::Pictures;
use crate::people;
use crate::rig::{self, Driver, Rig};
use crate::signs::SIGNS;
use crate::veil::Veil;

/// Looks that no catalogue needs to have: of bodies, and of signs.
const OWN: [(&str, &str); 2] =
    [("bodies.toml", include_str!("bodies.toml")), ("signs.toml", include_str!("signs.toml"))];

/// One model at all levels of detail. The pieces are the same at each.
#[derive(Debug)]
pub(crate) struct ModelMesh {
    /// By [`Detail`].
    pub levels: Vec<Mesh>,
    /// Its joints; pieces refer to them by index.
    pub joints: Vec<Rig>,
    /// Around what is drawn while nothing has happened to it, closed and at rest.
    pub bounds: Aabb,
    /// Around all that may ever be drawn.
    pub reach: Aabb,
    /// The states that some piece of it shows: see [`Self::shows`].
    shown: u64,
    /// Whether a floor lies at z = 0.
    standing: bool,
    /// By [`Detail`], how much of the surrounding light reaches each corner; baked on first use.
    ambient: [OnceLock<Vec<f32>>; Detail::ALL.len()],
}

impl ModelMesh {
    /// Whether some of it is drawn in this state alone, or moves in it.
    pub(crate) fn shows(&self, when: When) -> bool {
        self.shown & (1 << when as u64) != 0
    }

    /// How much of the surrounding light, 0 to 1, reaches each corner of a level.
    pub(crate) fn ambient(&self, level: usize) -> &[f32] {
        self.ambient[level].get_or_init(|| self.occluder().bake(&self.levels[level], self.standing))
    }

    /// Bakes every level that is not baked yet.
    fn bake(&self) {
        if self.is_baked() {
            return;
        }
        let occluder = self.occluder();
        for (mesh, ambient) in self.levels.iter().zip(&self.ambient) {
            ambient.get_or_init(|| occluder.bake(mesh, self.standing));
        }
    }

    /// Whether every level is baked.
    pub(crate) fn is_baked(&self) -> bool {
        self.ambient.iter().all(|known| known.get().is_some())
    }

    fn occluder(&self) -> Occluder {
        Occluder::new(&self.levels[0], reach_or_point(self.bounds))
    }
}

/// How one class of object uses a model.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ClassLook {
    pub model: usize,
    pub tint: Vec3,
    pub needs_power: bool,
}

/// The meshes of all models of a [`Catalog`], of the robot, of people, and of signs of states.
#[derive(Debug)]
pub struct MeshLibrary {
    models: Vec<ModelMesh>,
    classes: Vec<ClassLook>,
    bodies: Bodies,
    /// By index: ids of surfaces have that.
    rooms: Vec<RoomId>,
}

/// Where in the library the looks lie that belong to no class.
#[derive(Clone, Debug)]
pub(crate) struct Bodies {
    pub robot: usize,
    /// By outfit.
    pub people: Vec<usize>,
    pub note: usize,
    /// A stream of what is poured.
    pub stream: usize,
    /// For each of [`SIGNS`], its frames.
    pub signs: Vec<Vec<usize>>,
}

impl MeshLibrary {
    /// Builds every mesh at every level of detail. What is seen first is baked then: see [`Self::bake_all`].
    ///
    /// # Errors
    /// [`ModelError`] names the model and the part that cannot be built.
    pub fn build(catalog: &Catalog) -> Result<Self, ModelError> {
        let own = Catalog::parse(&[], &OWN).expect("invariant: the tests parse the same text");
        let mut stands = vec![false; catalog.models().len()];
        for index in 0..catalog.classes().len() {
            let id = ClassId(index as u16);
            stands[catalog.model_index(id)] |= catalog.class(id).stands != Stands::OnWall;
        }
        let mut models = Vec::with_capacity(catalog.models().len() + own.models().len());
        for mesh in all_meshes(catalog.models(), &stands) {
            models.push(mesh?);
        }
        let mut add = |model: &Model, body: bool| -> Result<usize, ModelError> {
            models.push(mesh_of(model, body, body)?);
            Ok(models.len() - 1)
        };
        let named = |id: &str| {
            let model = own.models().iter().find(|model| model.id == id);
            model.expect("invariant: the tests look for every body and sign")
        };
        let robot = catalog.models().iter().find(|model| model.id == "robot").unwrap_or_else(|| named("robot"));
        let mut bodies = Bodies {
            robot: add(robot, true)?,
            people: Vec::new(),
            note: add(named("note"), false)?,
            stream: add(named("stream"), false)?,
            signs: Vec::new(),
        };
        for model in people::dressed(own.models()) {
            bodies.people.push(add(&model, true)?);
        }
        for sign in &SIGNS {
            let frames = sign.frames.iter().map(|id| add(named(id), false));
            bodies.signs.push(frames.collect::<Result<_, _>>()?);
        }
        let classes = class_looks(catalog)?;
        Ok(Self { models, classes, bodies, rooms: catalog.rooms().ids().collect() })
    }

    /// Bakes what has not been seen yet, so that no later picture has to wait for it: for a thread of its own, after the
    /// first picture. Ends early once `stop` is set. Changes no picture.
    pub fn bake_all(&self, stop: &AtomicBool) {
        for model in &self.models {
            if stop.load(Ordering::Relaxed) {
                return;
            }
            model.bake();
        }
        Pictures::get().paint_all(stop);
    }

    /// The box around an object of this class, closed and at rest, in its own frame.
    #[must_use]
    pub fn bounds(&self, class: ClassId) -> Aabb {
        self.classes.get(usize::from(class.0)).map_or(Aabb::EMPTY, |look| self.models[look.model].bounds)
    }

    /// How many triangles an object of this class has, at the finest level and in all its states together.
    #[must_use]
    pub fn triangles(&self, class: ClassId) -> usize {
        let look = self.classes.get(usize::from(class.0));
        look.map_or(0, |look| self.models[look.model].levels[0].triangles.len())
    }

    /// The same at each level of detail, the finest first.
    #[must_use]
    pub fn triangles_by_level(&self, class: ClassId) -> Vec<usize> {
        let look = self.classes.get(usize::from(class.0));
        let levels = look.map(|look| &self.models[look.model].levels);
        levels.into_iter().flatten().map(|mesh| mesh.triangles.len()).collect()
    }

    /// How many triangles of an object of this class are drawn at once at each level of detail, the finest first: in
    /// its usual state or in that one other state that takes the most.
    #[must_use]
    pub fn triangles_at_once(&self, class: ClassId) -> Vec<usize> {
        let look = self.classes.get(usize::from(class.0));
        let levels = look.map(|look| &self.models[look.model].levels);
        levels.into_iter().flatten().map(Mesh::triangles_at_once).collect()
    }

    /// The rooms that floor plans may have, by index.
    pub(crate) fn rooms(&self) -> &[RoomId] {
        &self.rooms
    }

    pub(crate) fn model(&self, index: usize) -> &ModelMesh {
        &self.models[index]
    }

    pub(crate) fn class(&self, class: ClassId) -> Option<ClassLook> {
        self.classes.get(usize::from(class.0)).copied()
    }

    pub(crate) fn bodies(&self) -> &Bodies {
        &self.bodies
    }
}

/// The mesh of every model, in order; shared out to all cores, because there are hundreds.
fn all_meshes(models: &[Model], stands: &[bool]) -> Vec<Result<ModelMesh, ModelError>> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from).min(8);
    let jobs: Vec<(&Model, bool)> = models.iter().zip(stands.iter().copied()).collect();
    let worker = |first: usize| -> Vec<_> {
        jobs.iter().skip(first).step_by(threads).map(|(model, standing)| mesh_of(model, *standing, false)).collect()
    };
    let mut shares: Vec<std::vec::IntoIter<_>> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|first| scope.spawn(move || worker(first))).collect();
        let joined = workers.into_iter().map(|worker| worker.join().expect("invariant: building a mesh never panics"));
        joined.map(Vec::into_iter).collect()
    });
    (0..jobs.len()).filter_map(|index| shares[index % threads].next()).collect()
}

fn class_looks(catalog: &Catalog) -> Result<Vec<ClassLook>, ModelError> {
    let mut looks = Vec::with_capacity(catalog.classes().len());
    for (index, class) in catalog.classes().iter().enumerate() {
        let text = class.tint.as_deref().unwrap_or("#b8b4aa");
        let tint = color::parse_hex(text)
            .ok_or_else(|| ModelError::Tint { class: class.id.clone(), color: text.to_owned() })?;
        let model = catalog.model_index(ClassId(index as u16));
        looks.push(ClassLook { model, tint, needs_power: class.has(Property::Powerable) });
    }
    Ok(looks)
}

/// The mesh of a model; a `body` is moved by its pose.
fn mesh_of(model: &Model, standing: bool, body: bool) -> Result<ModelMesh, ModelError> {
    let joints = rig::rigs(model, body).map_err(|index| {
        let joint = &model.joints[index];
        let parent = joint.parent.clone().unwrap_or_default();
        ModelError::NoParent { model: model.id.clone(), joint: joint.id.clone(), parent }
    })?;
    let mut levels = Vec::with_capacity(Detail::ALL.len());
    for detail in Detail::ALL {
        levels.push(model_mesh::build(model, &model_mesh::precision(model, detail)?)?);
    }
    let fine = &levels[0];
    let (mut bounds, mut reach) = (Aabb::EMPTY, Aabb::EMPTY);
    for piece in &fine.pieces {
        let own = piece.bounds;
        if piece.corners.is_empty() {
            continue;
        }
        if piece.is_usual() && piece.veil != Some(Veil::Airy) {
            bounds = bounds.union(own);
        }
        reach = reach.union(own);
        if let Some(joint) = piece.joint {
            reach = reach.union(rig::swept(own, &joints, joint));
        }
    }
    let ambient = [const { OnceLock::new() }; Detail::ALL.len()];
    let mut shown = fine.pieces.iter().filter_map(|piece| piece.when).fold(0, |all, when| all | 1 << when as u64);
    if shown & 1 << When::Off as u64 != 0 || joints.iter().any(|rig| rig.driver == Driver::Running) {
        shown |= 1 << When::On as u64;
    }
    Ok(ModelMesh { levels, joints, bounds, reach: reach_or_point(reach), shown, standing, ambient })
}

fn reach_or_point(bounds: Aabb) -> Aabb {
    if bounds.min.x <= bounds.max.x { bounds } else { Aabb { min: Vec3::ZERO, max: Vec3::ZERO } }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    /// The model error of one part.
    fn check(part: &str, expected: &str) {
        let text = format!("[[model]]\nid = \"m\"\n[[model.part]]\n{part}\n");
        let catalog = Catalog::parse(&[], &[("m.toml", &text)]).unwrap();
        let error = MeshLibrary::build(&catalog).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }

    #[test]
    fn errors_name_model_and_part() {
        check("shape = \"sphere\"\nradii = [1.0, 0.0, 1.0]", "model `m`, part 1: `radii` is 0");
        check("shape = \"box\"\nsize = [1.0, 1.0, 1.0]\ncolor = \"red\"", "`red` is no colour");
        check("shape = \"box\"\nsize = [1.0, 1.0, 1.0]\njoint = \"door\"", "there is no joint `door`");
        check(
            "shape = \"box\"\nsize = [1.0, 1.0, 1.0]\nrepeat = { count = 9999, step = [1.0, 0.0, 0.0] }",
            "9999 copies",
        );
        check(
            "shape = \"mesh\"\npoints = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]\ntriangles = [[0, 1, 7]]",
            "model `m`, part 1: `triangles[0]` names point 7 of 3; points are counted from 0",
        );
    }

    #[test]
    fn the_built_in_catalogue_has_meshes_that_fill_their_size() {
        let catalog = Catalog::builtin();
        let meshes = MeshLibrary::build(&catalog).unwrap();
        for (index, class) in catalog.classes().iter().enumerate() {
            let id = ClassId(index as u16);
            assert!(meshes.triangles(id) > 0, "`{}` has no triangles", class.id);
            let size = meshes.bounds(id).size();
            assert!(size.min_element() > 0.0 && size.max_element() < 12.0, "`{}` is {size} m large", class.id);
        }
    }
}
