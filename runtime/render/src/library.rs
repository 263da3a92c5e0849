//! The meshes of all models of a catalogue, built once and shared by every scene.

use cohabit_cdf::catalog::Stands;
use cohabit_cdf::model::{Drive, Model};
use cohabit_cdf::{Catalog, ClassId, Property};
use glam::Vec3;

use crate::color;
use crate::kit::{Detail, ShapeError};
use crate::mesh::{Aabb, Mesh};
use crate::model_mesh;
use crate::occlusion::Occluder;

/// Looks that no catalogue needs to have.
const BODIES: &str = include_str!("bodies.toml");

/// Why a model has no mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ModelError {
    /// A part's shape has no surface.
    #[error("model `{model}`, part {part}: {source}")]
    Shape {
        /// The model.
        model: String,
        /// The part, from 1.
        part: usize,
        /// What is wrong.
        source: ShapeError,
    },
    /// A colour is not one.
    #[error("model `{model}`, part {part}: `{color}` is no colour; write `#rrggbb`, `tint` or `fluid`")]
    Color {
        /// The model.
        model: String,
        /// The part, from 1.
        part: usize,
        /// What stands there.
        color: String,
    },
    /// A class's tint is not a colour.
    #[error("object `{class}`: its tint `{color}` is no colour; write `#rrggbb`")]
    Tint {
        /// The class.
        class: String,
        /// What stands there.
        color: String,
    },
    /// A part names a joint that its model lacks.
    #[error("model `{model}`, part {part}: there is no joint `{joint}`")]
    NoJoint {
        /// The model.
        model: String,
        /// The part, from 1.
        part: usize,
        /// The joint it names.
        joint: String,
    },
    /// A model has more than a mesh can hold.
    #[error("model `{model}` has {count} {what}; {most} at most")]
    TooMany {
        /// The model.
        model: String,
        /// Parts, joints, or copies of a part.
        what: &'static str,
        /// How many.
        count: usize,
        /// How many are allowed.
        most: usize,
    },
}

/// What moves a joint.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Driver {
    /// How far the object is open.
    Opened,
    /// How far it runs.
    Running,
    /// The pitch of the robot's head.
    Head,
    /// How far a body reaches forward.
    Arm,
}

/// A joint, ready to move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rig {
    pub driver: Driver,
    pub at: Vec3,
    pub axis: Vec3,
    pub turn_rad: f32,
    pub slide_m: f32,
}

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
}

/// How one class of object uses a model.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ClassLook {
    pub model: usize,
    pub tint: Vec3,
    pub needs_power: bool,
    pub own_dirt: bool,
}

/// The meshes of all models of a [`Catalog`], of the robot, of people, and of signs of states.
#[derive(Debug)]
pub struct MeshLibrary {
    models: Vec<ModelMesh>,
    classes: Vec<ClassLook>,
    bodies: Bodies,
}

/// Where in the library the looks lie that belong to no class.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bodies {
    pub robot: usize,
    pub human: usize,
    pub note: usize,
    pub steam: usize,
    pub sparks: usize,
}

impl MeshLibrary {
    /// Builds every mesh at every level of detail.
    ///
    /// # Errors
    /// [`ModelError`] names the model and the part that cannot be built.
    pub fn build(catalog: &Catalog) -> Result<Self, ModelError> {
        let own = Catalog::parse(&[], &[("bodies.toml", BODIES)]).expect("invariant: the tests parse the same text");
        let mut stands = vec![false; catalog.models().len()];
        for index in 0..catalog.classes().len() {
            let id = ClassId(index as u16);
            stands[catalog.model_index(id)] |= catalog.class(id).stands != Stands::OnWall;
        }
        let mut models = Vec::with_capacity(catalog.models().len() + own.models().len());
        for mesh in all_meshes(catalog.models(), &stands) {
            models.push(mesh?);
        }
        let mut body = |id: &str| -> Result<usize, ModelError> {
            if let Some(index) = catalog.models().iter().position(|model| model.id == id) {
                return Ok(index);
            }
            let model = own.models().iter().find(|model| model.id == id);
            models
                .push(mesh_of(model.expect("invariant: bodies.toml has every body"), id == "robot" || id == "human")?);
            Ok(models.len() - 1)
        };
        let bodies = Bodies {
            robot: body("robot")?,
            human: body("human")?,
            note: body("note")?,
            steam: body("steam")?,
            sparks: body("sparks")?,
        };
        let classes = class_looks(catalog, &models)?;
        Ok(Self { models, classes, bodies })
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

    pub(crate) fn model(&self, index: usize) -> &ModelMesh {
        &self.models[index]
    }

    pub(crate) fn class(&self, class: ClassId) -> Option<ClassLook> {
        self.classes.get(usize::from(class.0)).copied()
    }

    pub(crate) fn bodies(&self) -> Bodies {
        self.bodies
    }
}

/// The mesh of every model, in order; shared out to all cores, because baking takes most of a second.
fn all_meshes(models: &[Model], stands: &[bool]) -> Vec<Result<ModelMesh, ModelError>> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from).min(8);
    let jobs: Vec<(&Model, bool)> = models.iter().zip(stands.iter().copied()).collect();
    let worker = |first: usize| -> Vec<_> {
        jobs.iter().skip(first).step_by(threads).map(|(model, standing)| mesh_of(model, *standing)).collect()
    };
    let mut shares: Vec<std::vec::IntoIter<_>> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|first| scope.spawn(move || worker(first))).collect();
        let joined = workers.into_iter().map(|worker| worker.join().expect("invariant: building a mesh never panics"));
        joined.map(Vec::into_iter).collect()
    });
    (0..jobs.len()).filter_map(|index| shares[index % threads].next()).collect()
}

fn class_looks(catalog: &Catalog, models: &[ModelMesh]) -> Result<Vec<ClassLook>, ModelError> {
    let mut looks = Vec::with_capacity(catalog.classes().len());
    for (index, class) in catalog.classes().iter().enumerate() {
        let text = class.tint.as_deref().unwrap_or("#b8b4aa");
        let tint = color::parse_hex(text)
            .ok_or_else(|| ModelError::Tint { class: class.id.clone(), color: text.to_owned() })?;
        let model = catalog.model_index(ClassId(index as u16));
        let own_dirt =
            models[model].levels[0].pieces.iter().any(|piece| piece.when == Some(cohabit_cdf::model::When::Dirty));
        looks.push(ClassLook { model, tint, needs_power: class.has(Property::Powerable), own_dirt });
    }
    Ok(looks)
}

fn mesh_of(model: &Model, standing: bool) -> Result<ModelMesh, ModelError> {
    let joints = rigs(model);
    let mut levels = Vec::with_capacity(Detail::ALL.len());
    for detail in Detail::ALL {
        levels.push(model_mesh::build(model, detail)?);
    }
    let fine = &levels[0];
    let (mut bounds, mut reach) = (Aabb::EMPTY, Aabb::EMPTY);
    for piece in &fine.pieces {
        let own = fine.piece_bounds(piece);
        if piece.corners.is_empty() {
            continue;
        }
        if piece.is_usual() {
            bounds = bounds.union(own);
        }
        reach = reach.union(own);
        if let Some(joint) = piece.joint {
            reach = reach.union(swept(own, &joints[usize::from(joint)]));
        }
    }
    let occluder = Occluder::new(fine, reach_or_point(bounds));
    for level in &mut levels {
        occluder.bake(level, standing);
    }
    Ok(ModelMesh { levels, joints, bounds, reach: reach_or_point(reach) })
}

fn reach_or_point(bounds: Aabb) -> Aabb {
    if bounds.min.x <= bounds.max.x { bounds } else { Aabb { min: Vec3::ZERO, max: Vec3::ZERO } }
}

/// The box around a moving box on its whole way.
fn swept(own: Aabb, rig: &Rig) -> Aabb {
    let values: &[f32] = if rig.driver == Driver::Head { &[-1.2, -0.6, 0.6, 1.2] } else { &[0.25, 0.5, 0.75, 1.0] };
    let mut all = own;
    for value in values {
        let (rotation, offset) = rig.moved(*value);
        for corner in own.corners() {
            all = all.with(rotation * corner + offset);
        }
    }
    all
}

impl Rig {
    /// The rotation and offset of what it moves, in the object's frame. A head takes its pitch in radians, upwards.
    pub(crate) fn moved(&self, value: f32) -> (glam::Mat3, Vec3) {
        let (angle, slide) = match self.driver {
            // Turning about the left axis by a positive angle would lower the face.
            Driver::Head => (if self.axis.y < 0.0 { value } else { -value }, 0.0),
            _ => (self.turn_rad * value, self.slide_m * value),
        };
        let rotation = axis_rotation(self.axis, angle);
        (rotation, self.at - rotation * self.at + self.axis * slide)
    }
}

/// Rodrigues' formula, with the same bits on every machine.
fn axis_rotation(axis: Vec3, angle: f32) -> glam::Mat3 {
    let (sin, cos) = libm::sincosf(angle);
    let (s, t) = (axis * sin, 1.0 - cos);
    glam::Mat3::from_cols(
        Vec3::new(cos + axis.x * axis.x * t, axis.x * axis.y * t + s.z, axis.x * axis.z * t - s.y),
        Vec3::new(axis.x * axis.y * t - s.z, cos + axis.y * axis.y * t, axis.y * axis.z * t + s.x),
        Vec3::new(axis.x * axis.z * t + s.y, axis.y * axis.z * t - s.x, cos + axis.z * axis.z * t),
    )
}

fn rigs(model: &Model) -> Vec<Rig> {
    let body = model.id == "robot" || model.id == "human";
    let driver = |id: &str, drive: Drive| match drive {
        _ if body && id.starts_with("head") => Driver::Head,
        _ if body && id.starts_with("arm") => Driver::Arm,
        Drive::Open => Driver::Opened,
        Drive::On => Driver::Running,
    };
    let rig = |joint: &cohabit_cdf::model::Joint| Rig {
        driver: driver(&joint.id, joint.driven_by),
        at: Vec3::from_array(joint.at),
        axis: Vec3::from_array(joint.axis).normalize_or(Vec3::Z),
        turn_rad: joint.turn_deg.to_radians(),
        slide_m: joint.slide_m,
    };
    model.joints.iter().map(rig).collect()
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

    #[test]
    fn a_head_looks_up_and_an_arm_reaches_forward() {
        let rig = |driver, turn_rad| Rig { driver, at: Vec3::ZERO, axis: Vec3::Y, turn_rad, slide_m: 0.0 };
        let (turn, _) = rig(Driver::Head, 0.0).moved(0.3);
        assert!((turn * Vec3::X).z > 0.2);
        let (turn, _) = rig(Driver::Arm, -1.2).moved(1.0);
        assert!((turn * Vec3::NEG_Z).x > 0.9);
    }
}
