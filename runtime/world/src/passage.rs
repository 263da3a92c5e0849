//! What stops a body on its way: other bodies, doors on the move, heavy things, walls. Never changes anything.

use cohabit_cdf::{BodyId, GoToTarget, ObjectId, StateFlag};
use glam::Vec2;

use crate::{
    approach::Sweep,
    body::{Body, Step},
    facts::Facts,
    navigation::{Navigation, WALK_UNDER_M},
    push::{Push, push},
    swing::LEAF_M,
    world::World,
};

/// What a body would run into.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Obstruction {
    /// Somebody.
    Body(BodyId),
    /// The door or drawer of this object, or the space it needs.
    Leaf(ObjectId),
    /// Something that cannot be pushed away.
    Thing(ObjectId),
    /// A wall, or an object that stands fast.
    Fixture(Option<ObjectId>),
}

impl World {
    /// What a body would run into at a point; on a planned way only what moves is in question.
    pub(crate) fn obstruction(&self, id: BodyId, to: Vec2, planned: bool) -> Option<Obstruction> {
        let from = self.state.bodies[id.0 as usize].position;
        self.body_at(id, from, to)
            .or_else(|| self.leaf_at(id, from, to, planned))
            .or_else(|| match push(&self.facts(), &self.navigation, id, from, to) {
                Push::Stuck(thing) => Some(Obstruction::Thing(thing)),
                Push::Moves(_) => None,
            })
            .or_else(|| {
                let radius = self.state.bodies[id.0 as usize].figure().radius_m;
                let barrier = (!planned).then(|| self.navigation.barrier(from, to, radius)).flatten();
                barrier.map(Obstruction::Fixture)
            })
    }

    /// Two that stand too close already may still part.
    fn body_at(&self, id: BodyId, from: Vec2, to: Vec2) -> Option<Obstruction> {
        let radius = self.state.bodies[id.0 as usize].figure().radius_m;
        let met = self.others(id).find(|(_, other)| {
            let distance = other.position.distance(to);
            distance < radius + other.figure().radius_m && distance < other.position.distance(from)
        });
        met.map(|(other, _)| Obstruction::Body(other))
    }

    fn leaf_at(&self, id: BodyId, from: Vec2, to: Vec2, planned: bool) -> Option<Obstruction> {
        let radius = self.state.bodies[id.0 as usize].figure().radius_m;
        let facts = self.facts();
        let near = self
            .navigation
            .swinging()
            .iter()
            .filter(|door| (facts.object(**door).pose.position.truncate() - to).abs().max_element() < LEAF_M);
        near.copied()
            .find(|door| {
                let touched = facts.leaves(*door).any(|leaf| {
                    let distance = leaf.print.distance(to);
                    distance < radius && distance < leaf.print.distance(from)
                });
                let between_rooms = facts.is_room_door(*door);
                // A way leads through the open doors of furniture only where it must: then they swing aside.
                (touched && (between_rooms || !planned))
                    || (between_rooms
                        && is_swinging(&facts, *door)
                        && enters(&Sweep::of(&facts, *door, WALK_UNDER_M), from, to, radius))
            })
            .map(Obstruction::Leaf)
    }

    /// Swings the doors and drawers of furniture that a body has walked into out of its way, as far as they go.
    pub(crate) fn push_leaves(&mut self, id: BodyId) {
        const STEP: f32 = 1.0 / 64.0;
        let (at, radius) =
            (self.state.bodies[id.0 as usize].position, self.state.bodies[id.0 as usize].figure().radius_m);
        let facts = self.facts();
        let near = self.navigation.swinging().iter().copied().filter(|door| {
            let from = facts.object(*door).pose.position.truncate() - at;
            from.abs().max_element() < LEAF_M && !facts.is_room_door(*door)
        });
        let pushed: Vec<(ObjectId, f32)> = near
            .filter_map(|door| {
                let touches = |opened: f32| facts.leaves_at(door, opened).any(|leaf| leaf.print.distance(at) < radius);
                let opened = facts.object(door).opened;
                let aside = (1..64_u8).map(|step| opened - f32::from(step) * STEP).take_while(|opened| *opened > 0.0);
                let aside = touches(opened).then(|| aside.into_iter().find(|opened| !touches(*opened))).flatten()?;
                Some((door, aside))
            })
            .collect();
        for (door, opened) in pushed {
            self.state.at_mut(door).opened = opened;
        }
    }

    /// Whether the doors and drawers of an object, opened so far, would come closer to a body than they may.
    pub(crate) fn hits_body(&self, id: ObjectId, opened: f32) -> bool {
        let facts = self.facts();
        facts.leaves_at(id, opened).zip(facts.leaves(id)).any(|(next, now)| {
            self.state.bodies.iter().any(|body| {
                let (distance, figure) = (next.print.distance(body.position), body.figure());
                next.low_m < figure.height_m
                    && distance < figure.radius_m
                    && distance < now.print.distance(body.position)
            })
        })
    }

    /// All bodies but one.
    pub(crate) fn others(&self, id: BodyId) -> impl Iterator<Item = (BodyId, &Body)> {
        (0_u32..).map(BodyId).zip(&self.state.bodies).filter(move |(other, _)| *other != id)
    }

    /// What people call an obstruction: `person 2 is in my way`.
    pub(crate) fn complaint(&self, obstruction: Option<Obstruction>) -> String {
        let facts = self.facts();
        match obstruction {
            Some(Obstruction::Body(other)) => format!("{} is in my way", self.body_name(other)),
            Some(Obstruction::Leaf(door)) if facts.is_room_door(door) => {
                format!("{} is in my way", facts.name(door))
            }
            Some(Obstruction::Leaf(door)) => format!("the open door of {} is in my way", facts.name(door)),
            Some(Obstruction::Thing(thing)) => format!("{} is in my way, and I cannot push it on", facts.name(thing)),
            Some(Obstruction::Fixture(Some(object))) => format!("{} is in my way", facts.name(object)),
            Some(Obstruction::Fixture(None)) => "a wall is in my way".to_owned(),
            None => "something is in my way".to_owned(),
        }
    }

    /// `the person`, where there is one; `person 2` of several, counted by kind, as they came. The number of a body is another one.
    fn body_name(&self, id: BodyId) -> String {
        let kind = self.state.bodies[id.0 as usize].kind;
        let count = |bodies: &[Body]| bodies.iter().filter(|body| body.kind == kind).count();
        match count(&self.state.bodies) {
            1 => format!("the {}", kind.name()),
            _ => format!("{} {}", kind.name(), count(&self.state.bodies[..=id.0 as usize])),
        }
    }

    /// The locked door without which there would be a way.
    pub(crate) fn locked_out(&self, body: &Body, target: GoToTarget) -> Option<ObjectId> {
        let unlocked = Navigation::but_for_locks(&self.facts())?;
        let (steps, _) = self.plan_walk(body, target, &unlocked).ok()?;
        let Some(Step::Walk { path, .. }) = steps.last() else { return None };
        let way: Vec<Vec2> = std::iter::once(body.position).chain(path.iter().copied()).collect();
        self.floor
            .gaps
            .iter()
            .filter(|gap| way.windows(2).any(|stretch| gap.print.cut_by(stretch[0], stretch[1])))
            .filter_map(|gap| gap.door_object)
            .find(|door| self.facts().is(*door, StateFlag::Locked))
    }
}

/// Whether a door is on its way.
pub(crate) fn is_swinging(facts: &Facts<'_>, door: ObjectId) -> bool {
    facts.object(door).opened != f32::from(u8::from(facts.is(door, StateFlag::Opened)))
}

/// Whether a body steps into what is swept.
fn enters(sweep: &Sweep, from: Vec2, to: Vec2, radius: f32) -> bool {
    sweep.distance(to) < radius && sweep.distance(from) >= radius
}
