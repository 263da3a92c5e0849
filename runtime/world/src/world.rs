//! The world: one state, stepped by a fixed tick, and what may be seen of it from outside.

use std::sync::{Arc, OnceLock};

use cohabit_cdf::{
    BodyId, BodyKind, Catalog, Layout, Mission, ObjectId, Property, RoomId, StateFlag, catalog::Stands,
    mission::MessageTime,
};
use glam::{Vec2, Vec3};

use crate::{
    apply::{Changes, settle},
    body::{Body, BodyView},
    build::{self, BuildError},
    difference,
    digest::{digest, digest_as_one},
    entity::{Object, ObjectView, Support},
    facts::Facts,
    floor::Floor,
    geometry::Pose,
    goals::{self, GoalChange, GoalStatus},
    motion::DT_S,
    navigation::Navigation,
    physics, power,
    report::{Ending, Event, Input, Report, SoundKind},
    score::score,
    snapshot::{self, SnapshotError},
    state::{State, ids},
    story,
    works::{self, portal},
};

/// Length of a tick, ns: 60 ticks a second.
pub const DT_NANOS: u64 = 16_666_667;
/// Doors, lids and drawers take 0.8 s; machines as long to come up to speed.
const OPEN_PER_S: f32 = 1.0 / 0.8;

/// What a step is made of, in order.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Phase {
    /// Commands are taken up.
    Rule,
    /// Bodies go on with what they do.
    Move,
    /// Machines work, doors and drawers move.
    Work,
    /// What flies and slides does so.
    Physics,
    /// Goals are judged, the story goes on.
    Judge,
}

/// A simulated office.
pub struct World {
    catalog: Arc<Catalog>,
    pub(crate) layout: Arc<Layout>,
    mission: Arc<Mission>,
    pub(crate) floor: Floor,
    pub(crate) state: State,
    pub(crate) navigation: Navigation,
    /// Whether the state is still the one that goals and occasions were last judged on.
    is_judged: bool,
    /// What a snapshot is of; worked out when the first one is wanted.
    identity: OnceLock<[u8; 32]>,
}

impl World {
    /// Furnishes the floor plan and changes it as the mission asks; one robot stands in the mission's start room.
    ///
    /// All that is left to chance follows from the mission's own seed, or from `seed` if it has none.
    ///
    /// # Errors
    /// [`BuildError`] names the object that cannot be had or has no place.
    pub fn new(
        catalog: Arc<Catalog>,
        layout: Arc<Layout>,
        mission: Arc<Mission>,
        seed: u64,
    ) -> Result<Self, BuildError> {
        let (floor, state, mut navigation) = build::build(&catalog, &layout, &mission, seed)?;
        navigation.renew(&Facts { catalog: &catalog, floor: &floor, state: &state });
        Ok(Self { catalog, layout, mission, floor, state, navigation, is_judged: false, identity: OnceLock::new() })
    }

    /// Adds a body of a kind at a free viewpoint of a room.
    ///
    /// # Errors
    /// [`BuildError::NoFreeSpot`] if the room has no place left to stand.
    pub fn add_body(&mut self, kind: BodyKind, room: RoomId) -> Result<BodyId, BuildError> {
        self.refresh_navigation();
        let (position, yaw_rad) = build::start(&self.facts(), &self.navigation, &self.layout, room)
            .ok_or_else(|| BuildError::NoFreeSpot { object: "the robot".to_owned(), room })?;
        let id = BodyId(u32::try_from(self.state.bodies.len()).expect("invariant: few bodies"));
        self.state.bodies.push(Body::new(kind, position, yaw_rad, room));
        self.is_judged = false;
        Ok(id)
    }

    /// Goes on by one tick: takes the commands up, moves everything, works the machines, judges the goals.
    pub fn step(&mut self, inputs: &[Input]) -> Report {
        self.step_telling(inputs, &mut |_| ())
    }

    /// The same, and tells when each phase of it is over: the world has no clock to time them by.
    pub fn step_telling(&mut self, inputs: &[Input], over: &mut dyn FnMut(Phase)) -> Report {
        let mut report = Report::default();
        if self.state.tick == 0 {
            self.say(&MessageTime::Beginning, &mut report.events);
        }
        self.refresh_navigation();
        for input in inputs {
            self.begin(input, &mut report.outcomes, &mut report.events);
        }
        over(Phase::Rule);
        for index in 0..self.state.bodies.len() {
            let id = BodyId(u32::try_from(index).expect("invariant: few bodies"));
            report.outcomes.extend(self.advance_task(id, &mut report.events));
            self.carry_held(id);
        }
        over(Phase::Move);
        self.strike_from_below(&mut report.events);
        self.run_machines(&mut report.events);
        let animated = self.animate();
        over(Phase::Work);
        self.step_physics(&mut report.events);
        over(Phase::Physics);
        // What is judged follows from the state alone: where nothing changed, nothing new comes of it.
        let acted = !inputs.is_empty()
            || self.state.bodies.iter().any(|body| body.busy() || body.arm > 0.0)
            || !report.outcomes.is_empty();
        let changed = animated || acted || self.state.physics.is_active() || !report.events.is_empty();
        if changed || !self.is_judged {
            self.cross_times(&mut report.events);
            self.judge(&mut report.events);
            self.is_judged = !changed && report.events.is_empty();
        }
        over(Phase::Judge);
        self.state.tick += 1;
        report
    }

    pub(crate) fn facts(&self) -> Facts<'_> {
        Facts { catalog: &self.catalog, floor: &self.floor, state: &self.state }
    }

    pub(crate) fn changes<'a>(&'a mut self, events: &'a mut Vec<Event>) -> Changes<'a> {
        Changes { catalog: &self.catalog, floor: &self.floor, state: &mut self.state, events }
    }

    fn refresh_navigation(&mut self) {
        if self.navigation.version != self.state.floor_version {
            self.navigation.renew(&Facts { catalog: &self.catalog, floor: &self.floor, state: &self.state });
        }
    }

    fn carry_held(&mut self, id: BodyId) {
        if let Some(held) = self.state.bodies[id.0 as usize].held {
            settle(&self.catalog, &self.floor, &mut self.state, held);
        }
    }

    /// Who walks onto something live on the floor is killed by it.
    fn strike_from_below(&mut self, events: &mut Vec<Event>) {
        /// A foot's breadth, m.
        const FOOT_M: f32 = 0.1;
        let facts = self.facts();
        let struck: Vec<(BodyId, ObjectId)> = power::live_on_floor(&facts)
            .into_iter()
            .flat_map(|id| {
                let print = facts.footprint(id);
                let bodies = (0_u32..).map(BodyId).zip(&facts.state.bodies);
                bodies
                    .filter(move |(_, body)| body.alive && print.distance(body.position) < FOOT_M)
                    .map(move |(body, _)| (body, id))
            })
            .collect();
        for (body, object) in struck {
            let effects =
                vec![crate::effect::Effect::sound(SoundKind::Spark, object), crate::effect::Effect::Kill(body)];
            self.changes(events).apply(effects);
        }
    }

    /// Machines that are on for a moment do their work, and go off again.
    fn run_machines(&mut self, events: &mut Vec<Event>) {
        let tick = self.state.tick;
        let running: Vec<ObjectId> =
            self.state.existing().filter(|(_, object)| object.run.is_some()).map(|(id, _)| id).collect();
        for id in running {
            let Some(run) = self.state.at(id).run else { continue };
            let facts = self.facts();
            let dead = power::lacks_power(&facts, id)
                || run.drives.is_some_and(|driven| power::lacks_power(&facts, driven))
                || !facts.is(id, StateFlag::Toggled);
            let [effect, end] = works::ticks(self.catalog.table().device(&facts.class(id).id));
            if !dead && tick == run.since + effect {
                let effects = works::effects(&facts, id, run.work, run.site);
                self.changes(events).apply(effects);
            }
            if dead || tick >= run.since + end {
                self.state.at_mut(id).run = None;
                let off = std::iter::once(id).chain(run.drives);
                let effects = off.map(|id| crate::effect::Effect::Set(id, StateFlag::Toggled, false)).collect();
                self.changes(events).apply(effects);
            }
        }
    }

    /// Moving parts follow their states; what the gravity pad lifts goes with it. Whether anything moved.
    fn animate(&mut self) -> bool {
        let by = OPEN_PER_S * DT_S;
        let (mut lifting, mut swinging) = (Vec::new(), Vec::new());
        for id in ids(self.state.objects.len()) {
            let object = self.state.at_mut(id);
            let target = |flag| f32::from(u8::from(object.flags.has(flag)));
            let (opened, running) = (target(StateFlag::Opened), target(StateFlag::Toggled));
            if opened != object.opened {
                swinging.push((id, (object.opened + (opened - object.opened).clamp(-by, by)).clamp(0.0, 1.0)));
            }
            let was = object.running;
            object.running = (was + (running - was).clamp(-by, by)).clamp(0.0, 1.0);
            if was != object.running {
                lifting.push(id);
            }
        }
        let moved = !swinging.is_empty() || !lifting.is_empty();
        for (id, opened) in swinging {
            // A door or drawer stops at a body, and goes on once that is gone.
            if !self.hits_body(id, opened) {
                self.state.at_mut(id).opened = opened;
            }
        }
        for id in lifting {
            for child in self.state.children(id).collect::<Vec<_>>() {
                settle(&self.catalog, &self.floor, &mut self.state, child);
            }
        }
        moved
    }

    /// What flies or slides does so; what comes to rest belongs to what it lies on.
    fn step_physics(&mut self, events: &mut Vec<Event>) {
        let flown = physics::step(&self.catalog, &self.floor, &mut self.state);
        events.extend(flown.knocked.into_iter().map(|object| Event::ObjectChanged { object }));
        for id in flown.landed {
            let facts = self.facts();
            let pose = facts.object(id).pose;
            let below = receptacle_below(&facts, id, pose.position);
            let mut changes = self.changes(events);
            match below {
                Some((parent, local)) => changes.attach(id, parent, None, local),
                None => {
                    let inside = changes.floor.room_at(pose.position.truncate()).is_some();
                    let [west, south, east, north] = changes.floor.bounds;
                    // What leaves the building comes to lie at its edge.
                    let x = pose.position.x.clamp(west + 0.3, east - 0.3);
                    let y = pose.position.y.clamp(south + 0.3, north - 0.3);
                    let at = if inside && pose.position.z > -0.2 { pose.position } else { Vec3::new(x, y, 0.0) };
                    let rotation = pose.rotation;
                    changes.put_down(id, at);
                    changes.state.at_mut(id).pose.rotation = rotation;
                    changes.settle(id);
                }
            }
            changes.events.push(Event::ObjectChanged { object: id });
        }
        let loose: Vec<ObjectId> =
            self.state.existing().filter(|(_, object)| object.support == Support::Loose).map(|(id, _)| id).collect();
        for id in loose {
            settle(&self.catalog, &self.floor, &mut self.state, id);
        }
    }

    fn judge(&mut self, events: &mut Vec<Event>) {
        let mission = Arc::clone(&self.mission);
        for change in goals::judge(&self.facts(), &mission) {
            match change {
                GoalChange::Met(index) => {
                    let id = mission.goals[index].id;
                    self.state.goals[index].met = true;
                    events.push(Event::GoalMet { id });
                    self.say(&MessageTime::GoalMet(id), events);
                }
                GoalChange::Reset(index) => {
                    self.state.goals[index].met = false;
                    events.push(Event::GoalReset { id: mission.goals[index].id });
                }
                GoalChange::Shown(index) => {
                    self.state.goals[index].shown = true;
                    events.push(Event::GoalShown { id: mission.goals[index].id });
                }
            }
        }
        let all_met = !self.state.goals.is_empty() && self.state.goals.iter().all(|goal| goal.met);
        if all_met && self.state.ended.is_none() {
            self.state.ended = Some((self.state.tick, Ending::AllGoalsMet));
            events.push(Event::MissionEnded { ending: Ending::AllGoalsMet });
            self.say(&MessageTime::Ending, events);
        }
    }

    fn say(&self, when: &MessageTime, events: &mut Vec<Event>) {
        events.extend(story::due(&self.facts(), &self.mission, when));
    }

    /// What flies into portals goes through, dinosaurs eat, what was away comes, and what waits for that is told.
    fn cross_times(&mut self, events: &mut Vec<Event>) {
        if !self.state.portals.is_empty() && self.state.physics.moving().next().is_some() {
            let effects = portal::swallowed(&self.facts());
            self.changes(events).apply(effects);
        }
        let hungry = self.state.dinosaurs.keys().any(|dino| !self.state.portals.contains_key(dino));
        if hungry {
            let effects = portal::meals(&self.facts());
            self.changes(events).apply(effects);
        }
        if !self.state.away.is_empty() {
            let effects = story::arrivals(&self.facts(), &self.mission);
            self.changes(events).apply(effects);
        }
        let (due, now) = story::on_occasions(&self.facts(), &self.mission);
        events.extend(due);
        self.state.occasions = now;
    }
}

/// What may be seen from outside.
impl World {
    /// Ticks since the beginning.
    #[must_use]
    pub fn tick(&self) -> u64 {
        self.state.tick
    }

    /// A number for each part of the simulated state, in the order of [`DIGEST_PARTS`](crate::DIGEST_PARTS), of
    /// [`DIGEST_PART_BYTES`](crate::DIGEST_PART_BYTES) each.
    #[must_use]
    pub fn digest(&self) -> [u8; 32] {
        digest(&self.state)
    }

    /// One number for all of it, as logs of format 1 have it.
    #[must_use]
    pub fn digest_as_one(&self) -> [u8; 32] {
        digest_as_one(&self.state)
    }

    /// What differs between this world and another one of the same mission: objects and bodies by name, each with what
    /// of it differs; nothing, if nothing does.
    #[must_use]
    pub fn differences(&self, other: &Self) -> Vec<String> {
        difference::between(&self.state, &other.state)
    }

    /// All simulated state as bytes.
    #[must_use]
    pub fn snapshot(&self) -> Vec<u8> {
        snapshot::write(self.identity(), &self.state)
    }

    /// Takes up a snapshot of a world of the same catalogue, floor plan and mission, and goes on from it bit for bit.
    ///
    /// # Errors
    /// [`SnapshotError`] says why the bytes are not one; the world is then as it was.
    pub fn restore(&mut self, bytes: &[u8]) -> Result<(), SnapshotError> {
        self.state = snapshot::read(self.identity(), &self.mission.name, bytes)?;
        self.navigation.renew(&Facts { catalog: &self.catalog, floor: &self.floor, state: &self.state });
        self.is_judged = false;
        Ok(())
    }

    /// All objects there ever were, in the order of their ids; those that left are hidden.
    pub fn objects(&self) -> impl ExactSizeIterator<Item = ObjectView<'_>> {
        self.state.objects.iter().enumerate().map(|(index, object)| {
            let id = ObjectId(u32::try_from(index).expect("invariant: fewer than 2^32 objects"));
            view(&self.facts(), id, object)
        })
    }

    fn identity(&self) -> &[u8; 32] {
        self.identity.get_or_init(|| identity(&self.catalog, &self.layout, &self.mission))
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
        leads_to: works::portal::open_gate(facts, id).map(|gate| gate.way().era),
        in_mission: object.requested,
    }
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

/// Stands for the catalogue, the floor plan and the mission that a snapshot needs.
fn identity(catalog: &Catalog, layout: &Layout, mission: &Mission) -> [u8; 32] {
    let mut hasher = blake3::Hasher::new();
    for class in catalog.classes() {
        hasher.update(format!("{class:?}").as_bytes());
    }
    hasher.update(format!("{layout:?}").as_bytes());
    hasher.update(format!("{mission:?}").as_bytes());
    *hasher.finalize().as_bytes()
}
