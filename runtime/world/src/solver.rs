//! The solver of rigid bodies, as a part of the state: what is in it, and who is who. Never knows why anything is.

use std::collections::BTreeMap;

use cohabit_cdf::ObjectId;
use glam::{Quat, Vec3};
use rapier3d::prelude::*;
use serde::{Deserialize, Serialize};

use crate::{geometry::Pose as ObjectPose, kinematics::DT_S};

/// The solver's world, and who is who in it.
#[derive(Serialize, Deserialize)]
pub(crate) struct Physics {
    pub world: PhysicsWorld,
    pub loose: BTreeMap<ObjectId, Flight>,
    pub bodies: Vec<RigidBodyHandle>,
    pub furniture: BTreeMap<ObjectId, Standing>,
    pub furnished: bool,
}

/// A piece of furniture in the solver, and how it stood when it was put in.
#[derive(Clone, Serialize, Deserialize)]
pub(crate) struct Standing {
    pub colliders: Vec<ColliderHandle>,
    pub pose: ObjectPose,
    pub opened: f32,
}

/// A thing in the solver.
#[derive(Clone, Copy, Serialize, Deserialize)]
pub(crate) struct Flight {
    pub handle: RigidBodyHandle,
    pub ticks: u32,
    pub still: u32,
    /// Whether it lies where it belongs, and is here only because something comes near.
    pub rests: bool,
}

impl Physics {
    /// An empty solver.
    pub fn empty() -> Self {
        let mut world = PhysicsWorld { gravity: Vector::new(0.0, 0.0, -9.81), ..PhysicsWorld::default() };
        world.integration_parameters.dt = DT_S;
        Self { world, loose: BTreeMap::new(), bodies: Vec::new(), furniture: BTreeMap::new(), furnished: false }
    }

    /// Puts a box in that never moves by itself.
    pub fn insert_box(&mut self, center: Vec3, half: Vec3, rotation: Quat) -> ColliderHandle {
        let collider =
            ColliderBuilder::cuboid(half.x, half.y, half.z).position(Pose::from_parts(center, rotation)).friction(0.7);
        self.world.colliders.insert(collider)
    }

    /// Takes a body out, with all that belongs to it.
    pub fn remove(&mut self, handle: RigidBodyHandle) {
        let world = &mut self.world;
        world.bodies.remove(
            handle,
            &mut world.islands,
            &mut world.colliders,
            &mut world.impulse_joints,
            &mut world.multibody_joints,
            &mut world.soft_bodies,
            true,
        );
    }

    /// Whether anything flies or slides.
    pub fn is_active(&self) -> bool {
        !self.loose.is_empty()
    }

    /// What flies or slides now, with its velocity: the part of the solver that a digest covers.
    pub fn moving(&self) -> impl Iterator<Item = (ObjectId, [f32; 6])> + '_ {
        self.loose.iter().map(|(id, flight)| {
            let body = &self.world.bodies[flight.handle];
            let (line, turn) = (body.linvel(), body.angvel());
            (*id, [line.x, line.y, line.z, turn.x, turn.y, turn.z])
        })
    }
}
