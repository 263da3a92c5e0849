//! Falling, flying and sliding: only what nothing holds is in the solver, and leaves it again once it lies still.
//!
//! While nothing flies the solver is empty: what stands around is put in, as it stands then, when the first thing is let
//! go. So a tick without flights costs nothing, and the solver's state never depends on flights that are over.

use cohabit_cdf::{Catalog, ObjectId, Property, catalog::Stands};
use glam::{Quat, Vec2, Vec3};
use rapier3d::prelude::*;

use crate::{
    entity::{Object, Support},
    facts::Facts,
    floor::Floor,
    geometry::Pose as ObjectPose,
    kinematics::DT_S,
    navigation::blocks_the_way,
    solver::{Flight, Physics, Standing},
    state::State,
};

/// Ticks of stillness after which a thing is taken to lie.
const STILL_TICKS: u32 = 20;
/// Ticks after which a thing that will not come to rest is stopped: ten seconds.
const LONGEST_TICKS: u32 = 600;
const STILL_M_S: f32 = 0.03;
const STILL_RAD_S: f32 = 0.3;
/// How near a thing that flies may come to one at rest before that is woken, m.
const WAKE_M: f32 = 0.03;
/// What was woken and moved less than this was not hit, m.
const UNMOVED_M: f32 = 0.005;

impl Physics {
    /// Puts in the floor, the walls and all that stands around, in the order of ids.
    fn furnish(&mut self, facts: &Facts<'_>) {
        let [west, south, east, north] = facts.floor.bounds;
        let middle = Vec3::new((west + east) / 2.0, (south + north) / 2.0, -0.5);
        let level = Quat::IDENTITY;
        self.insert_box(middle, Vec3::new(east - west, north - south, 1.0) / 2.0, level);
        for wall in &facts.floor.walls {
            let height = facts.floor.wall_height_m;
            self.insert_box(wall.center.extend(height / 2.0), wall.half.extend(height / 2.0), level);
        }
        for (id, _) in facts.state.existing() {
            if stands(facts, id) {
                self.insert_furniture(facts, id);
            }
        }
        self.furnished = true;
    }

    /// Takes up what furniture did since it was put in: doors swing, boxes are pushed about, things leave.
    fn follow_furniture(&mut self, facts: &Facts<'_>) {
        let moved = |id: ObjectId, standing: &Standing| {
            let object = facts.object(id);
            !stands(facts, id) || object.pose != standing.pose || object.opened != standing.opened
        };
        let changed: Vec<ObjectId> =
            self.furniture.iter().filter(|(id, standing)| moved(**id, standing)).map(|(id, _)| *id).collect();
        for id in changed {
            let Some(old) = self.furniture.remove(&id) else { continue };
            for handle in old.colliders {
                let PhysicsWorld { colliders, islands, bodies, soft_bodies, .. } = &mut self.world;
                colliders.remove(handle, islands, bodies, soft_bodies, true);
            }
            if stands(facts, id) {
                self.insert_furniture(facts, id);
            }
        }
    }

    /// Open furniture is its boards, everything else its whole box; doors and drawers come beside it.
    fn insert_furniture(&mut self, facts: &Facts<'_>, id: ObjectId) {
        const BOARD_M: f32 = 0.04;
        let (class, object) = (facts.class(id), facts.object(id));
        let (pose, scale) = (object.pose, Vec3::from(object.scale));
        let mut colliders = Vec::new();
        let is_only_a_leaf = facts.is_room_door(id);
        match &class.receptacle {
            _ if is_only_a_leaf => {}
            Some(kind) if !kind.enclosed => {
                for surface in &kind.surfaces {
                    let center = (Vec3::from(surface.center_m) - Vec3::Z * (BOARD_M / 2.0)) * scale;
                    let half = Vec2::from(surface.size_m).extend(BOARD_M) / 2.0 * scale;
                    colliders.push(self.insert_box(pose.point(center), half, pose.rotation));
                }
            }
            _ => {
                let half = Vec3::from(class.size_m) / 2.0 * scale;
                colliders.push(self.insert_box(pose.point(Vec3::Z * half.z), half, pose.rotation));
            }
        }
        if object.opened > 0.0 || is_only_a_leaf {
            for leaf in facts.leaves(id) {
                let half = leaf.print.half.extend((leaf.high_m - leaf.low_m) / 2.0).max(Vec3::splat(0.005));
                let center = leaf.print.center.extend((leaf.high_m + leaf.low_m) / 2.0);
                let turned = crate::geometry::turn(crate::geometry::heading(leaf.print.axis));
                colliders.push(self.insert_box(center, half, turned));
            }
        }
        self.furniture.insert(id, Standing { colliders, pose, opened: object.opened });
    }

    /// What lies at rest and something that flies is about to touch, in the order of ids.
    fn soon_hit(&self, facts: &Facts<'_>) -> Vec<ObjectId> {
        const SLOW_M_S: f32 = 0.3;
        let flying: Vec<(Vec3, Vec3)> = self
            .loose
            .iter()
            .filter_map(|(id, flight)| {
                let body = &self.world.bodies[flight.handle];
                let (middle, reach) = ball(facts, *id);
                let by = body.linvel() * DT_S;
                (body.linvel().length() > SLOW_M_S).then(|| {
                    let (low, high) = (middle.min(middle + by), middle.max(middle + by));
                    (low - reach - WAKE_M, high + reach + WAKE_M)
                })
            })
            .collect();
        if flying.is_empty() {
            return Vec::new();
        }
        facts
            .state
            .existing()
            .map(|(id, _)| id)
            .filter(|id| {
                let (middle, reach) = ball(facts, *id);
                flying.iter().any(|(low, high)| middle.cmpge(*low - reach).all() && middle.cmple(*high + reach).all())
                    && !self.loose.contains_key(id)
                    && is_light(facts, *id)
            })
            .collect()
    }
}

/// Whether an object stands around and is solid: what is carried about is not, until it flies.
fn stands(facts: &Facts<'_>, id: ObjectId) -> bool {
    matches!(facts.object(id).support, Support::Fixed | Support::On { .. }) && !facts.has(id, Property::Pickupable)
}

/// Whether something that lies about openly would fly off when it is hit.
fn is_light(facts: &Facts<'_>, id: ObjectId) -> bool {
    const LIGHT_KG: f32 = 5.0;
    let class = facts.class(id);
    let works = [Property::Openable, Property::Toggleable, Property::Powerable];
    let lies_about = class.has(Property::Pickupable)
        || (class.stands == Stands::OnSurface && !works.iter().any(|property| class.has(*property)));
    let in_the_open = facts.state.ancestors(id).all(|around| {
        facts.class(around).receptacle.as_ref().is_none_or(|kind| !kind.enclosed && kind.keys.is_empty())
    });
    matches!(facts.object(id).support, Support::Fixed | Support::On { .. })
        && lies_about
        && facts.object(id).mass_kg(class) <= LIGHT_KG
        && in_the_open
        && !blocks_the_way(facts, id)
}

/// What came to rest on top of a thing, held by nothing else.
pub(crate) fn lying_on(facts: &Facts<'_>, id: ObjectId) -> Vec<ObjectId> {
    /// Room between two things that touch, m.
    const TOUCH_M: f32 = 0.05;
    let (print, base) = (facts.footprint(id), facts.object(id).pose.position.z);
    let lies_on = |(other, object): &(ObjectId, &Object)| {
        let height = object.pose.position.z - base;
        *other != id
            && object.support == Support::Fixed
            && facts.has(*other, Property::Pickupable)
            && height > 0.0
            && height < facts.size(id).max_element() + TOUCH_M
            && object.pose.position.z > TOUCH_M
            && facts.footprint(*other).overlaps(&print)
    };
    facts.state.existing().filter(lies_on).map(|(other, _)| other).collect()
}

/// The middle of an object, and how far it reaches from there, m.
fn ball(facts: &Facts<'_>, id: ObjectId) -> (Vec3, f32) {
    let half = facts.size(id) / 2.0;
    (facts.object(id).pose.point(Vec3::Z * half.z), half.length())
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
        .density(this.mass_kg(class).max(0.01) / volume)
        .friction(0.7)
        .restitution(0.2);
    let physics = &mut state.physics;
    let handle = physics.world.bodies.insert(body);
    physics.world.colliders.insert_with_parent(collider, handle, &mut physics.world.bodies);
    physics.loose.insert(object, Flight { handle, ticks: 0, still: 0, rests: false });
}

/// Takes an object out of the solver, if it is in it.
pub(crate) fn drop_body(state: &mut State, object: ObjectId) {
    if let Some(flight) = state.physics.loose.remove(&object) {
        state.physics.remove(flight.handle);
    }
    if state.physics.loose.is_empty() && state.physics.furnished {
        state.physics = Physics::empty();
    }
}

/// What a tick came to for things that fly.
#[derive(Debug, Default)]
pub(crate) struct Flown {
    /// They came to rest somewhere, and belong there now.
    pub landed: Vec<ObjectId>,
    /// They lay at rest, and were knocked loose.
    pub knocked: Vec<ObjectId>,
}

/// Moves all that is loose by one tick.
pub(crate) fn step(catalog: &Catalog, floor: &Floor, state: &mut State) -> Flown {
    if state.physics.loose.is_empty() {
        return Flown::default();
    }
    // The facts are read while the solver is changed, which is no part of them.
    let mut physics = std::mem::replace(&mut state.physics, Physics::empty());
    let facts = Facts { catalog, floor, state };
    if physics.furnished {
        physics.follow_furniture(&facts);
    } else {
        physics.furnish(&facts);
    }
    let woken = physics.soon_hit(&facts);
    state.physics = physics;
    for id in woken {
        // It stays where it belongs until it has really moved.
        add_body(catalog, state, id, Vec3::ZERO);
        if let Some(flight) = state.physics.loose.get_mut(&id) {
            flight.rests = true;
        }
    }
    follow_bodies(state);
    state.physics.world.step();
    let (flown, missed) = read_flights(state);
    for id in missed {
        drop_body(state, id);
    }
    flown
}

/// Reads the poses of all that is loose; returns what has come to rest or was knocked loose, and what nothing hit.
fn read_flights(state: &mut State) -> (Flown, Vec<ObjectId>) {
    let (mut flown, mut missed) = (Flown::default(), Vec::new());
    let physics = &mut state.physics;
    for (id, flight) in &mut physics.loose {
        let body = &physics.world.bodies[flight.handle];
        let object = &mut state.objects[id.0 as usize];
        let still = body.linvel().length() < STILL_M_S && body.angvel().length() < STILL_RAD_S;
        flight.ticks += 1;
        flight.still = if still { flight.still + 1 } else { 0 };
        let position = body.translation();
        let lost = position.z < -0.5 || !position.is_finite();
        let ends = flight.still >= STILL_TICKS || flight.ticks >= LONGEST_TICKS || lost;
        if flight.rests {
            if lost || position.distance(object.pose.position) < UNMOVED_M {
                missed.extend(ends.then_some(*id));
                continue;
            }
            flight.rests = false;
            object.support = Support::Loose;
            flown.knocked.push(*id);
        }
        flown.landed.extend(ends.then_some(*id));
        if !lost {
            object.pose = ObjectPose { position, rotation: *body.rotation() };
        }
    }
    (flown, missed)
}

/// The cylinders of the walking bodies push what is loose.
fn follow_bodies(state: &mut State) {
    let physics = &mut state.physics;
    for (index, body) in state.bodies.iter().enumerate() {
        let figure = body.figure();
        let at = body.position.extend(figure.height_m / 2.0);
        match physics.bodies.get(index) {
            Some(handle) => {
                if let Some(pushed) = physics.world.bodies.get_mut(*handle) {
                    pushed.set_next_kinematic_translation(at);
                }
            }
            None => {
                let handle = physics.world.bodies.insert(RigidBodyBuilder::kinematic_position_based().translation(at));
                // The solver's cylinders stand on y.
                const UPRIGHT: Quat =
                    Quat::from_xyzw(std::f32::consts::FRAC_1_SQRT_2, 0.0, 0.0, std::f32::consts::FRAC_1_SQRT_2);
                let collider = ColliderBuilder::cylinder(figure.height_m / 2.0, figure.radius_m)
                    .position(Pose::from_parts(Vec3::ZERO, UPRIGHT));
                physics.world.colliders.insert_with_parent(collider, handle, &mut physics.world.bodies);
                physics.bodies.push(handle);
            }
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::sync::Arc;

    use cohabit_cdf::{Action, BodyId, BodyKind, Layout, Mission, ObjectRequest, RoomId};

    use super::*;
    use crate::{Input, World};

    /// A world with these things somewhere in the reception.
    fn world(things: &[&str]) -> World {
        let request = |thing: &&str| ObjectRequest {
            instance: (*thing).to_owned(),
            room: Some(RoomId::RECEPTION),
            ..ObjectRequest::default()
        };
        let mission = Mission {
            layout: "OfficeLayout1".to_owned(),
            start_room: RoomId::RECEPTION,
            objects: things.iter().map(request).collect(),
            ..Mission::default()
        };
        let layout = Layout::builtin("OfficeLayout1").unwrap();
        World::new(Arc::new(Catalog::builtin()), Arc::new(layout), Arc::new(mission), 1).unwrap()
    }

    /// Stands a thing free at a place.
    fn put(world: &mut World, thing: &str, at: Vec3) -> ObjectId {
        let id = world.find(thing).unwrap();
        world.state.at_mut(id).support = Support::Fixed;
        world.state.at_mut(id).pose = ObjectPose::level(at, 0.0);
        id
    }

    #[test]
    fn what_lay_on_a_thing_that_is_taken_away_falls() {
        let mut world = world(&["Trophy01_1", "Apple_1"]);
        let at = world.state.bodies[0].position + world.state.bodies[0].velocity() + Vec2::new(0.6, 0.0);
        let trophy = put(&mut world, "Trophy01_1", at.extend(0.0));
        let apple = put(&mut world, "Apple_1", at.extend(0.22));
        world.step(&[Input { command: 1, body: BodyId(0), action: Action::PickUp { object: trophy } }]);
        for _ in 0..300 {
            world.step(&[]);
        }
        assert_eq!(world.state.bodies[0].held, Some(trophy));
        let fallen = world.state.at(apple).pose.position;
        assert!(fallen.z < 0.1 && fallen.z > -0.02, "{fallen}");
    }

    #[test]
    fn what_is_dropped_from_a_hand_falls_to_the_floor_and_lies() {
        let mut world = world(&["Apple_1"]);
        world.add_body(BodyKind::Person, RoomId::MAIN_OFFICE).unwrap();
        let mut events = Vec::new();
        let apple = world.find("Apple_1").unwrap();
        world.changes(&mut events).apply(vec![crate::effect::Effect::Hold(apple, BodyId(1))]);
        let held = world.state.at(apple).pose.position;
        world.changes(&mut events).apply(vec![crate::effect::Effect::LetGo(apple, Vec3::ZERO)]);
        let ticks = (1..400).find(|_| {
            world.step(&[]);
            !world.state.physics.is_active()
        });
        let at = world.state.at(apple).pose.position;
        assert!(ticks.is_some() && held.z > 0.9 && at.z < 0.1, "{held} to {at} after {ticks:?}");
        assert!(at.truncate().distance(held.truncate()) < 0.5, "{held} to {at}");
        assert_eq!(world.state.at(apple).support, Support::Fixed);
    }
}
