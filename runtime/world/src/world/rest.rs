//! Where things come to be that fly, slide or are carried.

use cohabit_cdf::{BodyId, ObjectId, Property, catalog::Stands};
use glam::Vec3;

use super::World;
use crate::{apply::Changes, entity::Support, facts::Facts, geometry::Pose, physics, report::Event};

impl World {
    /// What a body holds goes with it.
    pub(super) fn carry_held(&mut self, id: BodyId) {
        if let Some(held) = self.state.bodies[id.0 as usize].held {
            self.settle(held);
        }
    }

    /// What flies or slides does so; what comes to rest belongs to what it lies on.
    pub(super) fn step_physics(&mut self, events: &mut Vec<Event>) {
        let flown = physics::step(&self.catalog, &self.floor, &mut self.state);
        events.extend(flown.knocked.into_iter().map(|object| Event::ObjectChanged { object }));
        for id in flown.landed {
            let facts = self.facts();
            let pose = facts.object(id).pose;
            let below = receptacle_below(&facts, id, pose.position);
            let mut changes = self.changes(events);
            match below {
                Some((parent, local)) => changes.load(|own| own.attach(id, parent, None, local)),
                None => lie_on_floor(&mut changes, id, pose),
            }
            changes.events.push(Event::ObjectChanged { object: id });
        }
        let loose: Vec<ObjectId> =
            self.state.existing().filter(|(_, object)| object.support == Support::Loose).map(|(id, _)| id).collect();
        for id in loose {
            self.settle(id);
        }
    }
}

/// Has a thing that came to rest there lie on the floor; what leaves the building comes to lie at its edge.
fn lie_on_floor(changes: &mut Changes<'_>, id: ObjectId, Pose { position, rotation }: Pose) {
    let inside = changes.floor.room_at(position.truncate()).is_some();
    let [west, south, east, north] = changes.floor.bounds;
    let x = position.x.clamp(west + 0.3, east - 0.3);
    let y = position.y.clamp(south + 0.3, north - 0.3);
    let at = if inside && position.z > -0.2 { position } else { Vec3::new(x, y, 0.0) };
    changes.put_down(id, at);
    changes.state.at_mut(id).pose.rotation = rotation;
    changes.settle(id);
}

/// The receptacle on whose surface a thing came to rest, and its pose in the frame of that.
fn receptacle_below(facts: &Facts<'_>, thing: ObjectId, at: Vec3) -> Option<(ObjectId, Pose)> {
    /// How far off a surface a thing at rest may seem, m: half of it, if it lies on its side.
    const NEAR_M: f32 = 0.15;
    let rotation = facts.object(thing).pose.rotation;
    facts.state.existing().map(|(id, _)| id).find_map(|id| {
        let object = facts.object(id);
        let kind = facts.class(id).receptacle.as_ref()?;
        let open = id != thing && !kind.enclosed && facts.class(id).stands == Stands::OnFloor;
        if !open || facts.has(id, Property::Pickupable) {
            return None;
        }
        let inverse = object.pose.rotation.inverse();
        let local = inverse * (at - object.pose.position);
        let scale = Vec3::from(object.scale);
        let on_surface = kind.surfaces.iter().any(|surface| {
            let from = local - Vec3::from(surface.center_m) * scale;
            from.x.abs() <= surface.size_m[0] / 2.0 * scale.x
                && from.y.abs() <= surface.size_m[1] / 2.0 * scale.y
                && (-0.03..=NEAR_M).contains(&from.z)
        });
        on_surface.then_some((id, Pose { position: local, rotation: inverse * rotation }))
    })
}
