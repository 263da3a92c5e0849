//! What may be seen of a world from outside.

use std::sync::Arc;

use cohabit_cdf::{BodyId, Catalog, GoToTarget, Layout, Mission, ObjectId, RoomId};
use glam::Vec2;

use super::World;
use crate::{
    body::{BodyView, Step},
    entity::{Object, ObjectView},
    facts::Facts,
    goals::{self, GoalStatus},
    power,
    report::Ending,
    score::score,
    works::portal,
};

/// What may be seen from outside.
impl World {
    /// Ticks since the beginning.
    #[must_use]
    pub fn tick(&self) -> u64 {
        self.state.tick
    }

    /// All objects there ever were, in the order of their ids; those that left are hidden.
    pub fn objects(&self) -> impl ExactSizeIterator<Item = ObjectView<'_>> {
        self.state.objects.iter().enumerate().map(|(index, object)| {
            let id = ObjectId(u32::try_from(index).expect("invariant: fewer than 2^32 objects"));
            view(&self.facts(), id, object)
        })
    }

    /// The objects that are in a room now, in the order of their ids.
    pub fn objects_in(&self, room: RoomId) -> impl Iterator<Item = ObjectView<'_>> {
        let in_room = self.state.existing().filter(move |(_, object)| object.room == room);
        in_room.map(|(id, object)| view(&self.facts(), id, object))
    }

    /// One object.
    #[must_use]
    pub fn object(&self, id: ObjectId) -> Option<ObjectView<'_>> {
        self.state.object(id).map(|object| view(&self.facts(), id, object))
    }

    /// The object in the world that answers to an instance id.
    #[must_use]
    pub fn find(&self, instance: &str) -> Option<ObjectId> {
        self.state.find(instance)
    }

    /// Whether the object is in the world; one that left, or never was, is not.
    #[must_use]
    pub fn exists(&self, id: ObjectId) -> bool {
        self.state.object(id).is_some_and(Object::exists)
    }

    /// All bodies, in the order of their ids.
    pub fn bodies(&self) -> impl ExactSizeIterator<Item = BodyView> + '_ {
        self.state
            .bodies
            .iter()
            .enumerate()
            .map(|(index, body)| BodyView::of(BodyId(u32::try_from(index).expect("invariant: few bodies")), body))
    }

    /// One body.
    #[must_use]
    pub fn body(&self, id: BodyId) -> Option<BodyView> {
        self.state.body(id).map(|body| BodyView::of(id, body))
    }

    /// The mission's goals, in its order.
    #[must_use]
    pub fn goals(&self) -> Vec<GoalStatus> {
        goals::statuses(&self.mission, &self.state)
    }

    /// Whether each goal is met, in the mission's order.
    pub fn goals_met(&self) -> impl ExactSizeIterator<Item = bool> + '_ {
        self.state.goals.iter().map(|goal| goal.met)
    }

    /// The score so far: 1000, less one a second down to 100, and 100 for each goal met.
    #[must_use]
    pub fn score(&self) -> u32 {
        let ticks = self.state.ended.map_or(self.state.tick, |(tick, _)| tick);
        score(ticks, self.state.goals.iter().filter(|goal| goal.met).count())
    }

    /// How the mission ended, if it did.
    #[must_use]
    pub fn finished(&self) -> Option<Ending> {
        self.state.ended.map(|(_, ending)| ending)
    }

    /// Whether the lights of a room are on.
    #[must_use]
    pub fn room_lit(&self, room: RoomId) -> bool {
        let circuit = self.layout.rooms.iter().find(|plan| plan.id == room).map(|plan| i32::from(plan.circuit));
        power::is_lit(&self.facts(), room, circuit)
    }

    /// The rooms of the floor plan, each with whether its lights are on.
    pub fn lights(&self) -> impl Iterator<Item = (RoomId, bool)> + '_ {
        let lit =
            |room: &cohabit_cdf::layout::Room| power::is_lit(&self.facts(), room.id, Some(i32::from(room.circuit)));
        self.layout.rooms.iter().map(move |room| (room.id, lit(room)))
    }

    /// The part of the floor that the middle of a robot can be on, m².
    #[must_use]
    pub fn navigable_area_m2(&self) -> f64 {
        self.navigation.area_m2
    }

    /// Whether the middle of a robot may be at a point of the floor: inside a room, clear of walls and of what stands
    /// there.
    #[must_use]
    pub fn is_walkable(&self, point_m: Vec2) -> bool {
        self.navigation.is_walkable(point_m)
    }

    /// The shortest way over the walkable floor as it was when the latest tick began: its points, m, without the one where it
    /// starts, and its length, m. Both ends may be a little off that floor; `None` if there is no way, such as through a
    /// locked door.
    #[must_use]
    pub fn path(&self, from_m: Vec2, to_m: Vec2) -> Option<(Vec<Vec2>, f32)> {
        self.navigation.path(from_m, to_m)
    }

    /// Length of the way that a body would take to a target now, were it alone, m; `None` if there is no way, or no such target.
    #[must_use]
    pub fn way_m(&self, body: BodyId, target: GoToTarget) -> Option<f32> {
        if let GoToTarget::Object(object) = target {
            self.state.object(object)?;
        }
        let body = self.state.bodies.get(body.0 as usize)?;
        let (steps, _) = self.plan_walk(body, target, &self.navigation).ok()?;
        let Some(Step::Walk { path, .. }) = steps.last() else { return Some(0.0) };
        let ends = std::iter::once(&body.position).chain(path);
        Some(ends.zip(path).map(|(from, to)| from.distance(*to)).sum())
    }

    /// The outlines of all that bodies cannot walk through, m: corners counter-clockwise, convex. Closed doors that are not
    /// locked are not among them: they open by themselves.
    #[must_use]
    pub fn obstacles(&self) -> Vec<[Vec2; 4]> {
        self.navigation.outlines().collect()
    }

    /// The catalogue it was built from.
    #[must_use]
    pub fn catalog(&self) -> &Arc<Catalog> {
        &self.catalog
    }

    /// The floor plan it was built from.
    #[must_use]
    pub fn layout(&self) -> &Arc<Layout> {
        &self.layout
    }

    /// The mission it was built from.
    #[must_use]
    pub fn mission(&self) -> &Arc<Mission> {
        &self.mission
    }
}

fn view<'a>(facts: &Facts<'a>, id: ObjectId, object: &'a Object) -> ObjectView<'a> {
    ObjectView {
        id,
        instance: &object.instance,
        class: object.class,
        room: object.room,
        position_m: object.pose.position,
        rotation: object.pose.rotation,
        scale: object.scale,
        flags: object.flags,
        fluid: object.fluid,
        color: object.color,
        opened: object.opened,
        running: object.running,
        parent: object.parent(),
        held_by: object.held_by(),
        hidden: !object.exists() || facts.shut_around(id).is_some_and(|shut| facts.object(shut).opened <= 0.0),
        text: &object.text,
        works: object.works,
        leads_to: portal::open_gate(facts, id).map(|gate| gate.way().era),
        in_mission: object.requested,
    }
}
