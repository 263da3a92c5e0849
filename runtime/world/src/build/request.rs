//! What a mission asks for: which of the plan's things it means, what must be made, where it goes, how it starts.

use cohabit_cdf::{
    ClassId, Fluid, ObjectId, ObjectRequest, Property, RoomId, StateFlag,
    catalog::{Stands, table::GROWTH},
};
use glam::Vec3;

use super::{BuildError, Builder, mentions::mentions, plan::UPRIGHT};
use crate::{
    anchors::{Anchor, fitting_anchors, free_anchors},
    entity::Support,
    geometry::{Pose, turn, wrap},
    rules::keyed_anchors,
    works,
};

const NOTE: &str = "StickyNote";

impl Builder<'_> {
    /// Brings about all that the mission asks for, in the order of its file.
    pub(super) fn fulfil(&mut self) -> Result<(), BuildError> {
        let mission = self.mission;
        self.recognise()?;
        self.recognise_mentions();
        for index in 0..mission.objects.len() {
            self.clear_contents(index);
        }
        for index in 0..mission.objects.len() {
            self.provide(index, &mut Vec::new())?;
        }
        self.stick_notes()?;
        for (index, request) in mission.objects.iter().enumerate() {
            if let Some(id) = self.requested.get(&index).copied() {
                self.set_state(id, request);
            }
        }
        for index in 0..mission.objects.len() {
            self.thin_out(index);
        }
        self.set_circuits();
        self.read_disks();
        Ok(())
    }

    /// Finds the plan's things that the mission means: by their own ids first, then by kind and room.
    fn recognise(&mut self) -> Result<(), BuildError> {
        for (index, request) in self.mission.objects.iter().enumerate() {
            if let Some(id) = self.state.find(&request.instance) {
                self.claim(index, id);
            }
        }
        for (index, request) in self.mission.objects.iter().enumerate() {
            let class = self.class_of(&request.instance)?;
            let stays = !self.catalog.class(class).has(Property::Pickupable) && self.catalog.class(class).id != NOTE;
            if self.requested.contains_key(&index) || !stays || request.blacklisted {
                continue;
            }
            let all: Vec<ObjectId> =
                self.state.existing().filter(|(_, object)| object.class == class).map(|(id, _)| id).collect();
            let alone = all.len() == 1;
            let free = all.into_iter().filter(|id| !self.state.at(*id).requested);
            let fitting =
                free.into_iter().find(|id| alone || request.room.is_none_or(|room| self.state.at(*id).room == room));
            if let Some(id) = fitting {
                let object = self.state.at_mut(id);
                let before = std::mem::replace(&mut object.instance, request.instance.clone());
                object.aliases.push(before);
                self.claim(index, id);
            }
        }
        Ok(())
    }

    /// What is named without being asked for, `Microwave_01_1` in a goal, is the plan's own if that has just one.
    fn recognise_mentions(&mut self) {
        for name in mentions(self.mission) {
            let Some(class) = self.catalog.class_of_instance(&name) else { continue };
            let asked = self.mission.objects.iter().any(|request| request.instance == name);
            if asked || self.catalog.class(class).has(Property::Pickupable) || self.state.find(&name).is_some() {
                continue;
            }
            let mut all = self.state.existing().filter(|(_, object)| object.class == class).map(|(id, _)| id);
            if let (Some(id), None) = (all.next(), all.next()) {
                drop(all);
                let object = self.state.at_mut(id);
                let before = std::mem::replace(&mut object.instance, name);
                object.aliases.push(before);
            }
        }
    }

    fn claim(&mut self, index: usize, id: ObjectId) {
        self.state.at_mut(id).requested = true;
        self.requested.insert(index, id);
    }

    fn class_of(&self, instance: &str) -> Result<ClassId, BuildError> {
        let unknown = || BuildError::UnknownClass { object: instance.to_owned() };
        self.catalog.class_of_instance(instance).ok_or_else(unknown)
    }

    /// Takes out what the plan put into a receptacle that must start without it.
    fn clear_contents(&mut self, index: usize) {
        let request = &self.mission.objects[index];
        let Some(id) = self.requested.get(&index).copied() else { return };
        if !(request.remove_initial_contents || request.empty) {
            return;
        }
        for content in self.facts().contents(id) {
            // A machine that stands on a counter is not what it contains.
            let loose = self.facts().has(content, Property::Pickupable);
            if loose && !self.state.at(content).requested {
                self.changes().remove(content);
            }
        }
    }

    /// Makes the object of a request, unless it is there, and brings it to its place; what it goes into comes first.
    fn provide(&mut self, index: usize, within: &mut Vec<usize>) -> Result<(), BuildError> {
        let mission = self.mission;
        let request = &mission.objects[index];
        let known = self.requested.get(&index).copied();
        let stays = known.is_some_and(|id| request.inside.is_none() && !self.is_elsewhere(id, request));
        if request.blacklisted || request.removed || stays {
            return Ok(());
        }
        if known.is_some_and(|id| self.state.at(id).requested && self.is_provided(id, request)) {
            return Ok(());
        }
        if let Some(inside) = &request.inside {
            if within.contains(&index) {
                let (object, receptacle) = (request.instance.clone(), inside.clone());
                return Err(BuildError::Circular { object, receptacle });
            }
            if let Some(outer) = mission.objects.iter().position(|other| other.instance == *inside) {
                within.push(index);
                self.provide(outer, within)?;
                within.pop();
            }
        }
        let id = match known {
            Some(id) => id,
            None => {
                let room = request.room.unwrap_or(mission.start_room);
                let id = self.create(&request.instance, room, Pose::level(Vec3::ZERO, 0.0))?;
                // It is nowhere until it is brought somewhere, and in nobody's way.
                self.state.at_mut(id).support = Support::Gone;
                self.claim(index, id);
                id
            }
        };
        self.bring(id, request)?;
        // What needs power has that of the room that it came to.
        if known.is_none() && self.facts().has(id, Property::Powerable) {
            let room = self.state.at(id).room;
            self.state.at_mut(id).circuit = self.circuit_of(room);
        }
        Ok(())
    }

    /// Whether an object already is where its request wants it.
    fn is_provided(&self, id: ObjectId, request: &ObjectRequest) -> bool {
        request.inside.as_ref().is_some_and(|inside| {
            self.state.at(id).parent().is_some_and(|parent| self.state.at(parent).is_called(inside))
        })
    }

    /// Whether something that can be carried is in another room than its request says.
    fn is_elsewhere(&self, id: ObjectId, request: &ObjectRequest) -> bool {
        let carried = self.facts().has(id, Property::Pickupable);
        carried && request.room.is_some_and(|room| self.state.at(id).room != room)
    }

    /// Brings an object to where its request wants it.
    fn bring(&mut self, id: ObjectId, request: &ObjectRequest) -> Result<(), BuildError> {
        if let Some(inside) = &request.inside {
            let receptacle = self.state.find(inside).ok_or_else(|| BuildError::NoSuchReceptacle {
                object: request.instance.clone(),
                receptacle: inside.clone(),
            })?;
            if receptacle == id || self.state.ancestors(receptacle).any(|outer| outer == id) {
                let (object, receptacle) = (request.instance.clone(), inside.clone());
                return Err(BuildError::Circular { object, receptacle });
            }
            return self.put_into(id, receptacle);
        }
        let class = self.facts().class(id);
        if class.id == NOTE {
            return self.stick(id, request.room.unwrap_or(self.mission.start_room), None);
        }
        let room = request.room.map(|room| self.check_room(&request.instance, room)).transpose()?;
        match class.stands {
            Stands::OnSurface => self.put_somewhere(id, room),
            Stands::OnFloor => self.stand_somewhere(id, room.unwrap_or(self.mission.start_room)),
            Stands::OnWall => self.hang_somewhere(id, room.unwrap_or(self.mission.start_room)),
        }
    }

    /// Puts an object to a free anchor of a receptacle, one of the plan's own things making room if need be.
    fn put_into(&mut self, id: ObjectId, receptacle: ObjectId) -> Result<(), BuildError> {
        let facts = self.facts();
        let keyed = keyed_anchors(&facts, receptacle, &facts.class(id).id).filter(|anchors| !anchors.is_empty());
        let own = keyed.is_some();
        let slot = |anchor: &Anchor| works::is_slot(&facts, receptacle, anchor.index);
        let fitting = keyed.unwrap_or_else(|| fitting_anchors(&facts, receptacle, facts.size(id)));
        let mut any = if fitting.is_empty() { free_anchors(&facts, receptacle) } else { fitting };
        // Goods stand in the slots of a vending machine, in the order of its buttons.
        let vends = any.iter().any(slot);
        if vends {
            any.retain(slot);
            any.sort_by_key(|anchor| anchor.index);
        }
        if any.is_empty() {
            let spare = facts
                .state
                .children(receptacle)
                .find(|child| facts.has(*child, Property::Pickupable) && !facts.object(*child).requested);
            let Some(spare) = spare else {
                return Err(BuildError::NoFreePlace {
                    object: self.state.at(id).instance.clone(),
                    receptacle: self.state.at(receptacle).instance.clone(),
                });
            };
            self.changes().remove(spare);
            return self.put_into(id, receptacle);
        }
        // Roomy places come first: half of them is choice enough.
        let choice = if own || vends { 0 } else { self.pick(any.len().div_ceil(2)) };
        let anchor = any[choice];
        let facts = self.facts();
        let yaw_rad = if facts.has(id, Property::Pickupable) && !own { (self.fraction() - 0.5) * 0.8 } else { 0.0 };
        let scale = self.state.at(receptacle).scale;
        let local = Pose { rotation: UPRIGHT * turn(yaw_rad), ..anchor.local(scale) };
        self.changes().attach(id, receptacle, Some(anchor.index), local);
        Ok(())
    }

    /// Puts an object onto some open furniture of a room, or of any; onto the floor, if none has a place for it.
    fn put_somewhere(&mut self, id: ObjectId, room: Option<RoomId>) -> Result<(), BuildError> {
        let facts = self.facts();
        let size = facts.size(id);
        let open: Vec<ObjectId> = facts
            .state
            .existing()
            .filter(|(_, object)| {
                room.map_or_else(|| !facts.catalog.rooms().is_corridor(object.room), |room| object.room == room)
            })
            .map(|(other, _)| other)
            .filter(|other| *other != id && !facts.has(*other, Property::Pickupable))
            .filter(|other| !facts.has(*other, Property::Toggleable) && !facts.has(*other, Property::Powerable))
            .filter(|other| {
                let receptacle = facts.class(*other).receptacle.as_ref();
                receptacle.is_some_and(|kind| !kind.enclosed && kind.keys.is_empty())
            })
            .filter(|other| !fitting_anchors(&facts, *other, size).is_empty())
            .collect();
        if open.is_empty() {
            return self.stand_somewhere(id, room.unwrap_or(self.mission.start_room));
        }
        let receptacle = open[self.pick(open.len())];
        self.put_into(id, receptacle)
    }

    /// Sticks the mission's notes: each at its place.
    fn stick_notes(&mut self) -> Result<(), BuildError> {
        for note in &self.mission.notes {
            let room = self.check_room(&note.instance, note.room)?;
            let id = match self.state.find(&note.instance) {
                Some(id) => id,
                None => self.create(&note.instance, room, Pose::level(Vec3::ZERO, 0.0))?,
            };
            self.state.at_mut(id).text.clone_from(&note.text);
            self.state.at_mut(id).requested = true;
            self.stick(id, room, Some(note.place))?;
        }
        Ok(())
    }

    /// Sticks a note at a place of a room: the one asked for, or the last if there are fewer; the first that is free, if that is taken.
    fn stick(&mut self, id: ObjectId, room: RoomId, place: Option<usize>) -> Result<(), BuildError> {
        let layout = self.layout;
        let places: Vec<_> = layout.note_places.iter().filter(|place| place.room == room).collect();
        let last = places.len().saturating_sub(1);
        let notes = self.mission.notes.iter().filter(|note| note.room == room);
        let wanted: Vec<usize> = notes.map(|note| note.place.min(last)).collect();
        let is_taken = |index: usize| {
            let at = Vec3::from(places[index].at_m);
            self.state.existing().any(|(other, object)| other != id && object.pose.position.distance(at) < 0.05)
        };
        let free = || (0..places.len()).find(|index| !wanted.contains(index) && !is_taken(*index));
        let asked = place.map(|place| place.min(last)).filter(|_| !places.is_empty());
        let first = (!places.is_empty()).then_some(0);
        // Of two notes at one place nobody would ever see the one behind.
        let chosen = asked.filter(|index| !is_taken(*index)).or_else(free).or(asked).or(first);
        let Some(chosen) = chosen else { return self.hang_somewhere(id, room) };
        let pose = Pose::level(places[chosen].at_m.into(), wrap(places[chosen].yaw_deg.to_radians()));
        let object = self.state.at_mut(id);
        object.support = Support::Fixed;
        object.pose = pose;
        object.room = room;
        Ok(())
    }

    /// Sets the states that a request wants.
    fn set_state(&mut self, id: ObjectId, request: &ObjectRequest) {
        let yesterday = request.yesterday.as_ref().and_then(|class| self.catalog.find(class));
        let prints = request.prints.as_ref().and_then(|class| self.catalog.find(class));
        let object = self.state.at_mut(id);
        object.yesterday = yesterday.or(object.yesterday);
        object.prints = prints.or(object.prints);
        if let Some(circuit) = request.circuit {
            object.circuit = (circuit >= 0).then_some(circuit);
        }
        if let Some(circuit) = request.generates_circuit {
            object.feeds = Some(circuit);
        }
        object.fluid = request.fluid.unwrap_or(object.fluid);
        object.color = request.color.unwrap_or(object.color);
        if let Some(text) = &request.text {
            object.text.clone_from(text);
        }
        if request.empty {
            object.fluid = Fluid::None;
            object.flags.set(StateFlag::Cereal, false);
        }
        for (flag, value) in &request.flags {
            if *value && flag.is_mood() {
                StateFlag::MOODS.into_iter().for_each(|mood| object.flags.set(mood, false));
            }
            object.flags.set(*flag, *value);
        }
        if object.flags.has(StateFlag::Embiggenated) {
            self.changes().scale(id, GROWTH);
        }
    }

    /// Takes out what a request does not want: itself, others of its class, or all of it that the plan has.
    fn thin_out(&mut self, index: usize) {
        let request = &self.mission.objects[index];
        let own = self.requested.get(&index).copied();
        if let Some(id) = own.filter(|_| request.removed || request.blacklisted) {
            self.changes().remove(id);
        }
        if request.removed {
            return;
        }
        let Some(class) = self.catalog.class_of_instance(&request.instance) else { return };
        if !(request.unique || request.blacklisted) {
            return;
        }
        let others: Vec<ObjectId> = self
            .state
            .existing()
            .filter(|(id, object)| object.class == class && Some(*id) != own && !object.requested)
            .map(|(id, _)| id)
            .collect();
        for id in others {
            self.changes().remove(id);
        }
    }
}
