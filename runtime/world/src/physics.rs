//! Falling, flying and sliding: only what nothing holds is in the solver, and leaves it again once it lies still.

use std::collections::BTreeMap;

use cohabit_cdf::{Catalog, ObjectId, Property};
use glam::{Vec2, Vec3};
use rapier3d::prelude::*;
use serde::{Deserialize, Serialize};

use crate::{body::RADIUS_M, entity::Support, facts::Facts, geometry::Pose as ObjectPose, motion::DT_S, state::State};

/// Ticks of stillness after which a thing is taken to lie.
const STILL_TICKS: u32 = 20;
/// Ticks after which a thing that will not come to rest is stopped: ten seconds.
const LONGEST_TICKS: u32 = 600;
const STILL_M_S: f32 = 0.03;
const STILL_RAD_S: f32 = 0.3;
/// Height of a body's cylinder, m.
const BODY_HEIGHT_M: f32 = 1.4;

/// The solver's world, and who is who in it.
#[derive(Serialize, Deserialize)]
pub(crate) struct Physics {
    world: PhysicsWorld,
    loose: BTreeMap<ObjectId, Flight>,
    bodies: Vec<RigidBodyHandle>,
}

/// A thing in the solver.
#[derive(Clone, Copy, Serialize, Deserialize)]
struct Flight {
    handle: RigidBodyHandle,
    ticks: u32,
    still: u32,
}

impl Physics {
    /// An empty solver.
    pub fn empty() -> Self {
        let mut world = PhysicsWorld { gravity: Vector::new(0.0, 0.0, -9.81), ..PhysicsWorld::default() };
        world.integration_parameters.dt = DT_S;
        Self { world, loose: BTreeMap::new(), bodies: Vec::new() }
    }

    /// Puts the floor, the walls and all that stands in, in the order of ids.
    pub fn furnish(facts: &Facts<'_>, wall_height_m: f32) -> Self {
        let mut physics = Self::empty();
        let [west, south, east, north] = facts.floor.bounds;
        let middle = Vec3::new((west + east) / 2.0, (south + north) / 2.0, -0.5);
        physics.insert_box(
            middle,
            Vec3::new(east - west, north - south, 1.0) / 2.0,
            ObjectPose::level(Vec3::ZERO, 0.0),
        );
        for wall in &facts.floor.walls {
            let center = wall.center.extend(wall_height_m / 2.0);
            let half = wall.half.extend(wall_height_m / 2.0);
            physics.insert_box(center, half, ObjectPose::level(Vec3::ZERO, 0.0));
        }
        for (id, object) in facts.state.existing() {
            let solid = matches!(object.support, Support::Fixed | Support::On { .. })
                && !facts.has(id, Property::Pickupable)
                && facts.class(id).id != "Door_01";
            if solid {
                physics.insert_furniture(facts, id);
            }
        }
        physics
    }

    /// Open furniture is its boards; everything else its whole box.
    fn insert_furniture(&mut self, facts: &Facts<'_>, id: ObjectId) {
        const BOARD_M: f32 = 0.04;
        let class = facts.class(id);
        let pose = facts.object(id).pose;
        let scale = Vec3::from(facts.object(id).scale);
        match &class.receptacle {
            Some(kind) if !kind.enclosed => {
                for surface in &kind.surfaces {
                    let center = (Vec3::from(surface.center_m) - Vec3::Z * (BOARD_M / 2.0)) * scale;
                    let half = Vec2::from(surface.size_m).extend(BOARD_M) / 2.0 * scale;
                    self.insert_box(pose.point(center), half, pose);
                }
            }
            _ => {
                let half = Vec3::from(class.size_m) / 2.0 * scale;
                self.insert_box(pose.point(Vec3::Z * half.z), half, pose);
            }
        }
    }

    fn insert_box(&mut self, center: Vec3, half: Vec3, turned: ObjectPose) {
        let collider = ColliderBuilder::cuboid(half.x, half.y, half.z)
            .position(Pose::from_parts(center, turned.rotation))
            .friction(0.7);
        self.world.colliders.insert(collider);
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

/// Puts an object into the solver where it is, with this velocity, m/s.
pub(crate) fn add_body(catalog: &Catalog, state: &mut State, object: ObjectId, velocity: Vec3) {
    let this = state.at(object);
    let class = catalog.class(this.class);
    let half = Vec3::from(class.size_m) / 2.0 * Vec3::from(this.scale);
    let half = half.max(Vec3::splat(0.01));
    let body = RigidBodyBuilder::dynamic()
        .pose(Pose::from_parts(this.pose.position, this.pose.rotation))
        .linvel(velocity)
        .angular_damping(1.0)
        .ccd_enabled(true);
    let volume = 8.0 * half.x * half.y * half.z;
    let collider = ColliderBuilder::cuboid(half.x, half.y, half.z)
        .translation(Vec3::Z * half.z)
        .density(class.mass_kg.max(0.01) / volume)
        .friction(0.7)
        .restitution(0.2);
    let physics = &mut state.physics;
    let handle = physics.world.bodies.insert(body);
    physics.world.colliders.insert_with_parent(collider, handle, &mut physics.world.bodies);
    physics.loose.insert(object, Flight { handle, ticks: 0, still: 0 });
}

/// Takes an object out of the solver, if it is in it.
pub(crate) fn drop_body(state: &mut State, object: ObjectId) {
    if let Some(flight) = state.physics.loose.remove(&object) {
        remove(&mut state.physics, flight.handle);
    }
    if state.physics.loose.is_empty() {
        for handle in std::mem::take(&mut state.physics.bodies) {
            remove(&mut state.physics, handle);
        }
    }
}

fn remove(physics: &mut Physics, handle: RigidBodyHandle) {
    let world = &mut physics.world;
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

/// Moves all that is loose by one tick; returns what came to rest.
pub(crate) fn step(state: &mut State) -> Vec<ObjectId> {
    if state.physics.loose.is_empty() {
        return Vec::new();
    }
    follow_bodies(state);
    state.physics.world.step();
    let mut resting = Vec::new();
    let physics = &mut state.physics;
    for (id, flight) in &mut physics.loose {
        let body = &physics.world.bodies[flight.handle];
        let still = body.linvel().length() < STILL_M_S && body.angvel().length() < STILL_RAD_S;
        flight.ticks += 1;
        flight.still = if still { flight.still + 1 } else { 0 };
        let position = body.translation();
        let lost = position.z < -0.5 || !position.is_finite();
        if flight.still >= STILL_TICKS || flight.ticks >= LONGEST_TICKS || lost {
            resting.push(*id);
        }
        if !lost {
            let object = &mut state.objects[id.0 as usize];
            object.pose = ObjectPose { position, rotation: *body.rotation() };
        }
    }
    resting
}

/// The cylinders of the walking bodies push what is loose.
fn follow_bodies(state: &mut State) {
    let physics = &mut state.physics;
    for (index, body) in state.bodies.iter().enumerate() {
        let at = body.position.extend(BODY_HEIGHT_M / 2.0);
        match physics.bodies.get(index) {
            Some(handle) => {
                if let Some(pushed) = physics.world.bodies.get_mut(*handle) {
                    pushed.set_next_kinematic_translation(at);
                }
            }
            None => {
                let handle = physics.world.bodies.insert(RigidBodyBuilder::kinematic_position_based().translation(at));
                // A sphere-ended cylinder lying on z: the solver's capsules stand on y.
                let half = BODY_HEIGHT_M / 2.0 - RADIUS_M;
                let collider = ColliderBuilder::capsule_z(half, RADIUS_M);
                physics.world.colliders.insert_with_parent(collider, handle, &mut physics.world.bodies);
                physics.bodies.push(handle);
            }
        }
    }
}
