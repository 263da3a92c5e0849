//! Pushing: a body that runs into something light on the floor shoves it along; something heavy stops it.
//!
//! The contact is quasi-static: what is pushed gives way along the contact's normal, turns as far as it is hit beside
//! its middle, and lies still again as soon as nobody pushes. Never knows why a body moves.

use cohabit_cdf::{BodyId, ObjectId, Property};
use glam::Vec2;

use crate::{
    entity::Support,
    facts::Facts,
    geometry::{Footprint, Pose, turn},
    navigation::Navigation,
    pushable::is_pushable,
    report::Event,
    world::World,
};

/// No pushed thing reaches further from its middle than this, m.
const REACH_M: f32 = 1.2;

/// What a body does to the things around it by moving.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Push {
    /// These go to these poses; none, if it touches nothing.
    Moves(Vec<(ObjectId, Pose)>),
    /// This cannot give way.
    Stuck(ObjectId),
}

/// What a body moves out of its way by going from one point to another.
pub(crate) fn push(facts: &Facts<'_>, navigation: &Navigation, body: BodyId, from: Vec2, to: Vec2) -> Push {
    let radius = facts.state.bodies[body.0 as usize].figure().radius_m;
    let mut moves = Vec::new();
    for (id, object) in facts.state.existing() {
        let near = object.support == Support::Fixed
            && (object.pose.position.truncate() - to).abs().max_element() < REACH_M + radius;
        if !near || !is_pushable(facts, id) {
            continue;
        }
        let print = facts.footprint(id);
        let depth = radius - print.distance(to);
        if depth <= 0.0 || print.distance(to) >= print.distance(from) {
            continue;
        }
        match give_way(facts, navigation, body, id, &print, to, depth) {
            Some(pose) => moves.push((id, pose)),
            // Small things that cannot give way are stepped over.
            None if facts.has(id, Property::Pickupable) => {}
            None => return Push::Stuck(id),
        }
    }
    Push::Moves(moves)
}

/// Where an object goes that a body at `to` would reach into by `depth` m, if there is room for it.
fn give_way(
    facts: &Facts<'_>,
    navigation: &Navigation,
    body: BodyId,
    id: ObjectId,
    print: &Footprint,
    to: Vec2,
    depth: f32,
) -> Option<Pose> {
    /// Directions in which it may slip, beside the straight one: rad.
    const SLIPS_RAD: [f32; 4] = [0.6, -0.6, 1.2, -1.2];
    let contact = print.closest(to);
    let straight = (contact - to).try_normalize().or_else(|| (print.center - to).try_normalize())?;
    let mut tries = vec![turned(print, contact, straight, depth), (straight * depth, 0.0)];
    tries.extend(SLIPS_RAD.map(|slip| {
        let way = crate::geometry::direction(slip).rotate(straight);
        (way * (depth / way.dot(straight)), 0.0)
    }));
    let pose = facts.object(id).pose;
    tries.into_iter().find_map(|(by, yaw_rad)| {
        let axis = crate::geometry::direction(yaw_rad).rotate(print.axis);
        let moved = Footprint { center: print.center + by, axis, ..*print };
        let rotation = (turn(yaw_rad) * pose.rotation).normalize();
        has_room(facts, navigation, body, id, print, &moved)
            .then(|| Pose { position: pose.position + by.extend(0.0), rotation })
    })
}

/// How a thing that slides on the floor answers a push without friction at the contact: its shift, and its turn.
///
/// Source: Lynch & Mason, "Stable pushing" (1996), with an ellipsoidal limit surface.
fn turned(print: &Footprint, contact: Vec2, normal: Vec2, depth: f32) -> (Vec2, f32) {
    let arm = (contact - print.center).perp_dot(normal);
    // The radius of gyration stands for the ratio of torque to force that friction with the floor resists with.
    let gyration = (print.half.length_squared() / 3.0).max(1e-6);
    let shift = depth / (1.0 + arm * arm / gyration);
    (normal * shift, (shift * arm / gyration).clamp(-0.2, 0.2))
}

/// Whether an object that is pushed from one place to another meets nothing more than it met before.
fn has_room(
    facts: &Facts<'_>,
    navigation: &Navigation,
    pusher: BodyId,
    id: ObjectId,
    was: &Footprint,
    is: &Footprint,
) -> bool {
    let [west, south, east, north] = facts.floor.bounds;
    let inside =
        is.corners().iter().all(|corner| corner.x > west && corner.x < east && corner.y > south && corner.y < north);
    let bodies = facts.state.bodies.iter().enumerate().filter(|(index, _)| *index != pusher.0 as usize);
    let crowded = bodies.into_iter().any(|(_, body)| {
        let distance = is.distance(body.position);
        distance < body.figure().radius_m && distance < was.distance(body.position)
    });
    let among = |other: ObjectId| {
        let print = facts.footprint(other);
        print.penetration(is) > print.penetration(was) + 1e-4
    };
    let small = facts.has(id, Property::Pickupable);
    inside
        && !crowded
        && !navigation.is_wedged(was, is)
        && !facts.state.existing().any(|(other, object)| {
            other != id
                && object.support == Support::Fixed
                && object.pose.position.truncate().distance(is.center) < 2.0 * REACH_M
                && (small || !facts.has(other, Property::Pickupable))
                && is_pushable(facts, other)
                && among(other)
        })
        && !navigation
            .swinging()
            .iter()
            .any(|door| facts.leaves(*door).any(|leaf| leaf.print.penetration(is) > leaf.print.penetration(was) + 1e-4))
}

impl World {
    /// Moves what a body has run into by going on from a point.
    pub(crate) fn push_along(
        &mut self,
        body: BodyId,
        from: Vec2,
        pushing: &mut Vec<ObjectId>,
        events: &mut Vec<Event>,
    ) {
        let to = self.state.bodies[body.0 as usize].position;
        let Push::Moves(moves) = push(&self.facts(), &self.navigation, body, from, to) else { return };
        for (id, pose) in moves {
            if crate::navigation::blocks_the_way(&self.facts(), id) && !pushing.contains(&id) {
                pushing.push(id);
                self.state.floor_version += 1;
            }
            self.state.at_mut(id).pose = pose;
            let mut changes = self.changes(events);
            changes.settle(id);
            changes.events.push(Event::ObjectChanged { object: id });
        }
    }

    /// What a body pushed stands again, in the way of others.
    pub(crate) fn let_stand(&mut self, pushing: &[ObjectId]) {
        self.state.floor_version += u64::from(!pushing.is_empty());
    }
}
