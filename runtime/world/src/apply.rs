//! The only place where a world changes because somebody did something: effects in, state and events out.

use cohabit_cdf::{BodyId, Catalog, ClassId, ObjectId, Property, StateFlag};
use glam::{Quat, Vec3};

use crate::{
    anchors::anchors,
    effect::{Effect, Spot},
    entity::{Object, Support},
    facts::Facts,
    floor::Floor,
    geometry::Pose,
    navigation::blocks_the_way,
    physics, power,
    pushable::is_pushable,
    report::{Ending, Event, SoundKind},
    rules::on_power,
    state::State,
    works::numbered,
};

/// A world's changing part, with what is constant about it, and where its events go.
pub(crate) struct Changes<'a> {
    pub catalog: &'a Catalog,
    pub floor: &'a Floor,
    pub state: &'a mut State,
    pub events: &'a mut Vec<Event>,
}

impl Changes<'_> {
    /// What can be read now.
    pub fn facts(&self) -> Facts<'_> {
        Facts { catalog: self.catalog, floor: self.floor, state: self.state }
    }

    /// Applies all effects in order.
    pub fn apply(&mut self, effects: Vec<Effect>) {
        for effect in effects {
            self.apply_one(effect);
        }
    }

    fn apply_one(&mut self, effect: Effect) {
        match effect {
            Effect::Set(object, flag, value) => self.set(object, flag, value),
            Effect::Fill(object, fluid) => {
                self.state.at_mut(object).fluid = fluid;
                self.changed(object);
            }
            Effect::Paint(object, color) => {
                self.state.at_mut(object).color = color;
                self.changed(object);
            }
            Effect::Hold(object, body) => self.load(|own| own.hold(object, body)),
            Effect::Put { object, spot } => self.load(|own| own.put(object, spot)),
            Effect::LetGo(object, velocity) => self.load(|own| own.let_go(object, velocity)),
            Effect::Spawn { class, instance, spot, by, was } => self.spawn(class, instance, spot, by, was),
            Effect::Return { object, spot } => self.bring_back(object, spot),
            Effect::Remove(object) => self.remove(object),
            Effect::Scale(object, factor) => self.scale(object, factor),
            Effect::Start(object, run) => {
                self.state.at_mut(object).run = Some(run);
                self.set(object, StateFlag::Toggled, true);
                if let Some(driven) = run.drives {
                    self.set(driven, StateFlag::Toggled, true);
                }
            }
            Effect::Feed(circuit, fed) => self.feed(circuit, fed),
            Effect::Turn(generator) => {
                if let Some(gate) = self.state.portals.get_mut(&generator) {
                    gate.turn();
                }
            }
            Effect::Sate(dino) => {
                if let Some(dinosaur) = self.state.dinosaurs.get_mut(&dino) {
                    dinosaur.fed = true;
                }
                self.changed(dino);
            }
            Effect::Touch(object) => self.state.at_mut(object).touched = true,
            Effect::Kill(body) => self.kill(body),
            Effect::Tell(event) => self.events.push(event),
        }
    }

    /// Adds an object to the world; it gets the next id.
    pub fn add(&mut self, object: Object) -> ObjectId {
        let id = ObjectId(u32::try_from(self.state.objects.len()).expect("invariant: fewer than 2^32 objects"));
        self.state.objects.push(object);
        let facts = self.facts();
        let powerable = facts.has(id, Property::Powerable);
        let powered = powerable && power::is_fed(facts.state, facts.object(id).circuit);
        self.state.at_mut(id).flags.set(StateFlag::Powered, powered);
        id
    }

    /// Makes a change by which what stands on the floor may get too heavy to be pushed, or light enough.
    pub fn load(&mut self, change: impl FnOnce(&mut Self)) {
        let before = self.pushable();
        change(self);
        self.state.floor_version += u64::from(self.pushable() != before);
    }

    /// What stands in the way and can be pushed out of it.
    fn pushable(&self) -> Vec<ObjectId> {
        let facts = self.facts();
        let all = facts.state.existing().map(|(id, _)| id);
        all.filter(|id| blocks_the_way(&facts, *id) && is_pushable(&facts, *id)).collect()
    }

    fn spawn(&mut self, class: ClassId, instance: String, spot: Spot, by: Option<ObjectId>, was: Option<ObjectId>) {
        let (room, pose) = match spot {
            Spot::Anchor { parent, .. } => (self.state.at(parent).room, self.state.at(parent).pose),
            Spot::Floor(at) => {
                let room = self.floor.room_at(at.truncate()).or_else(|| by.map(|by| self.state.at(by).room));
                let Some(room) = room.or_else(|| self.floor.nearest_room(at.truncate())) else { return };
                (room, Pose::level(at, 0.0))
            }
        };
        // All that one work makes was named before any of it was there.
        let is_taken = self.state.objects.iter().any(|object| object.is_called(&instance));
        let instance = match instance.rsplit_once('_') {
            Some((stem, _)) if is_taken => numbered(&self.facts(), stem),
            _ => instance,
        };
        let mut object = Object::new(instance, class, room, pose);
        if let Some(machine) = by.map(|by| self.state.at(by)) {
            // It is named after its machine, by every name that this has.
            let names = machine.aliases.iter().map(|alias| object.instance.replacen(&machine.instance, alias, 1));
            object.aliases = names.collect();
        }
        (object.was, object.requested) = (was, true);
        let id = self.add(object);
        self.put(id, spot);
        self.events.push(Event::Spawned { object: id, by });
    }

    /// What left the world, or was not there yet, comes into it as it was.
    fn bring_back(&mut self, object: ObjectId, spot: Spot) {
        self.state.away.remove(&object);
        self.put(object, spot);
        let facts = self.facts();
        let powered =
            facts.has(object, Property::Powerable) && power::is_fed(facts.state, facts.object(object).circuit);
        if facts.has(object, Property::Powerable) {
            self.set(object, StateFlag::Powered, powered);
        }
        self.events.push(Event::Spawned { object, by: None });
        self.state.floor_version += u64::from(blocks_the_way(&self.facts(), object));
    }

    fn put(&mut self, object: ObjectId, spot: Spot) {
        match spot {
            Spot::Anchor { parent, anchor } => self.put_on(object, parent, anchor),
            Spot::Floor(at) => self.put_down(object, at),
        }
    }

    /// Makes an object so many times its size; what stands on it stays at its place on it.
    pub fn scale(&mut self, object: ObjectId, factor: f32) {
        self.state.at_mut(object).scale = self.state.at(object).scale.map(|side| side * factor);
        for child in self.state.children(object).collect::<Vec<_>>() {
            if let Support::On { local, .. } = &mut self.state.at_mut(child).support {
                local.position *= factor;
            }
        }
        self.settle(object);
        self.changed(object);
    }

    fn changed(&mut self, object: ObjectId) {
        let event = Event::ObjectChanged { object };
        // Several changes of one object in a row are one to those who listen.
        if self.events.last() != Some(&event) {
            self.events.push(event);
        }
    }

    fn set(&mut self, object: ObjectId, flag: StateFlag, value: bool) {
        if self.state.at(object).flags.has(flag) == value {
            return;
        }
        if value && flag.is_mood() {
            // A face shows one mood at a time.
            StateFlag::MOODS.into_iter().for_each(|mood| self.state.at_mut(object).flags.set(mood, false));
        }
        self.state.at_mut(object).flags.set(flag, value);
        self.changed(object);
        if matches!(flag, StateFlag::Opened | StateFlag::Locked | StateFlag::Sparking) {
            self.state.floor_version += 1;
        }
    }

    fn hold(&mut self, object: ObjectId, body: BodyId) {
        // A hand holds one thing: what was in it falls, where a rule does not ask for an empty hand.
        if let Some(before) = self.state.bodies[body.0 as usize].held.filter(|before| *before != object) {
            self.let_go(before, Vec3::ZERO);
        }
        self.detach(object);
        self.state.at_mut(object).support = Support::Held(body);
        self.state.bodies[body.0 as usize].held = Some(object);
        self.set(object, StateFlag::PickedUp, true);
        self.settle(object);
        self.changed(object);
    }

    /// Puts an object at an anchor of a receptacle.
    pub fn put_on(&mut self, object: ObjectId, parent: ObjectId, anchor: u16) {
        let facts = self.facts();
        let scale = facts.object(parent).scale;
        let local = anchors(&facts, parent)
            .get(usize::from(anchor))
            .map_or(Pose { position: Vec3::ZERO, rotation: Quat::IDENTITY }, |anchor| anchor.local(scale));
        self.attach(object, parent, Some(anchor), local);
        self.changed(object);
    }

    /// Fixes an object to a receptacle at a pose in its frame.
    pub fn attach(&mut self, object: ObjectId, parent: ObjectId, anchor: Option<u16>, local: Pose) {
        self.detach(object);
        self.state.at_mut(object).support = Support::On { parent, anchor, local };
        self.settle(object);
    }

    /// Takes an object out of whatever holds it.
    fn detach(&mut self, object: ObjectId) {
        if let Some(body) = self.state.at(object).held_by() {
            self.state.bodies[body.0 as usize].held = None;
        }
        self.set(object, StateFlag::PickedUp, false);
        physics::drop_body(self.state, object);
    }

    fn let_go(&mut self, object: ObjectId, velocity: Vec3) {
        self.detach(object);
        self.state.at_mut(object).support = Support::Loose;
        physics::add_body(self.catalog, self.state, object, velocity);
        self.changed(object);
    }

    /// Stands an object on the floor, or wherever `at` is.
    pub fn put_down(&mut self, object: ObjectId, at: Vec3) {
        self.detach(object);
        let yaw_rad = self.state.at(object).pose.yaw_rad();
        self.state.at_mut(object).support = Support::Fixed;
        self.state.at_mut(object).pose = Pose::level(at, yaw_rad);
        self.settle(object);
        self.changed(object);
    }

    /// Takes an object out of the world; what stood on it stays where it was.
    pub fn remove(&mut self, object: ObjectId) {
        let blocked = blocks_the_way(&self.facts(), object);
        let parent = self.state.at(object).support;
        for child in self.state.children(object).collect::<Vec<_>>() {
            match parent {
                Support::On { parent, anchor, local } => self.attach(child, parent, anchor, local),
                _ => {
                    let at = self.state.at(object).pose.position;
                    self.put_down(child, at);
                }
            }
        }
        self.detach(object);
        self.state.at_mut(object).support = Support::Gone;
        self.state.at_mut(object).run = None;
        self.events.push(Event::Removed { object });
        self.state.floor_version += u64::from(blocked);
    }

    fn feed(&mut self, circuit: i32, fed: bool) {
        for id in power::feed(self.catalog, self.state, circuit, fed) {
            self.changed(id);
        }
        self.state.floor_version += 1;
        if fed {
            let facts = self.facts();
            let effects = on_power(&facts, circuit);
            self.apply(effects);
        }
    }

    fn kill(&mut self, body: BodyId) {
        self.state.bodies[body.0 as usize].alive = false;
        if let Some(held) = self.state.bodies[body.0 as usize].held {
            self.let_go(held, Vec3::ZERO);
        }
        if self.state.ended.is_none() {
            self.state.ended = Some((self.state.tick, Ending::KilledByHazard));
            self.events.push(Event::MissionEnded { ending: Ending::KilledByHazard });
        }
    }

    /// Opens or closes a door on behalf of whoever walks up to it.
    pub fn open(&mut self, door: ObjectId) {
        self.set(door, StateFlag::Opened, true);
        self.events.push(Event::Sound { kind: SoundKind::Open, object: door });
    }

    /// Works out where an object is, from what holds it, and so for all that stands on it.
    pub fn settle(&mut self, object: ObjectId) {
        settle(self.catalog, self.floor, self.state, object);
    }
}

/// Works out where an object is, from what holds it, and so for all that stands on it.
pub(crate) fn settle(catalog: &Catalog, floor: &Floor, state: &mut State, object: ObjectId) {
    /// How high the gravity pad lifts what is in its field, m.
    const LIFT_M: f32 = 0.5;
    let (pose, room) = match state.at(object).support {
        Support::On { parent, local, .. } => {
            let parent = state.at(parent);
            let lifts = catalog.class(parent.class).id == "GravityPad";
            let lift = if lifts { LIFT_M * parent.running } else { 0.0 };
            let position = parent.pose.point(local.position) + Vec3::Z * lift;
            (Pose { position, rotation: parent.pose.rotation * local.rotation }, parent.room)
        }
        Support::Held(body) => {
            let body = &state.bodies[body.0 as usize];
            (body.hand(), body.room)
        }
        Support::Fixed | Support::Loose | Support::Gone => {
            let here = state.at(object);
            (here.pose, floor.room_at(here.pose.position.truncate()).unwrap_or(here.room))
        }
    };
    let this = state.at_mut(object);
    this.pose = pose;
    this.room = room;
    for child in state.children(object).collect::<Vec<_>>() {
        settle(catalog, floor, state, child);
    }
}
