//! Checks of what reads well piece by piece, but does not go together.

use std::collections::{BTreeMap, BTreeSet};

use super::{
    Mission, ObjectRequest,
    names::made,
    possible::{Possibility, takes_things},
    problem::Pointer,
    reader::{GoalPlaces, Places, Reader, one_of},
};
use crate::{
    catalog::{ClassId, ObjectClass, Property},
    room::RoomId,
};

/// The beginning of the ids of what makes a printer print.
const CARTRIDGE: &str = "Printer_Cartridge";

impl Reader<'_> {
    /// Checks a mission that was read.
    pub fn audit(&mut self, mission: &Mission) {
        let Places { objects, goals, conditions } = std::mem::take(&mut self.places);
        self.audit_objects(&mission.objects, &objects);
        self.audit_goals(mission, &goals);
        self.audit_conditions(mission, &conditions);
    }

    /// Checks objects against each other and the layout.
    fn audit_objects(&mut self, objects: &[ObjectRequest], places: &[Pointer]) {
        for (object, at) in objects.iter().zip(places) {
            self.audit_kind(object, at);
            self.audit_moods(object, at);
            self.audit_place(object, at, objects);
        }
        self.audit_crowds(objects, places);
        self.audit_circuits(objects, places);
    }

    /// Fields that only some kinds of objects have.
    fn audit_kind(&mut self, object: &ObjectRequest, at: &Pointer) {
        let Some(class) = self.class_id(&object.instance) else { return };
        let class = self.catalog.class(class);
        let (id, name) = (class.id.clone(), class.name.clone());
        if object.prints.is_some() && !id.starts_with(CARTRIDGE) {
            let remedy = Some(format!("say it of a `{CARTRIDGE}`"));
            self.warn(&at.key("printingObject"), format!("a {name} prints nothing"), remedy);
        }
    }

    fn audit_moods(&mut self, object: &ObjectRequest, at: &Pointer) {
        let shown = object.flags.iter().filter(|(flag, value)| flag.is_mood() && *value).count();
        if shown > 1 {
            self.warn(
                &at.key("state"),
                format!("`{}` shows one mood at a time; the last counts", object.instance),
                None,
            );
        }
    }

    /// Where an object is to be: a receptacle that is there, takes it, and stands in the room that is said.
    fn audit_place(&mut self, object: &ObjectRequest, at: &Pointer, objects: &[ObjectRequest]) {
        if let Some(room) = object.room {
            self.room_in_layout(&at.key("roomLocation").item(0), room);
        }
        let Some(inside) = &object.inside else { return self.audit_room(object, at) };
        let at = at.key("location").item(0).key(inside);
        let outer = objects.iter().find(|other| other.instance == *inside);
        if let Some(outer) = outer.filter(|outer| outer.removed || outer.blacklisted) {
            let key = if outer.removed { "Removed" } else { "Blacklist" };
            let remedy = Some(format!("take its `{key}` out"));
            return self.error(&at, format!("`{inside}` is not there: it is taken out of the world"), remedy);
        }
        let outer_room = outer.and_then(|outer| outer.room).or_else(|| self.placed_room(inside));
        if let (Some(room), Some(outer_room)) = (object.room, outer_room)
            && room != outer_room
        {
            let [outer_name, name] = [outer_room, room].map(|room| room.name_in(self.catalog));
            let message = format!("`{inside}` is in the {outer_name}, not in the {name}");
            self.warn(&at, message, Some("the receptacle counts".to_owned()));
        }
        if let (Some(class), Some(receptacle)) = (self.class_id(&object.instance), self.class_id(inside)) {
            let (class, receptacle) = (self.catalog.class(class), self.catalog.class(receptacle));
            if let Some((message, remedy)) = misfit(class, receptacle, inside) {
                self.warn(&at, message, remedy);
            }
        }
    }

    /// What the layout has in another room than is said, and nobody carries there: it stays.
    fn audit_room(&mut self, object: &ObjectRequest, at: &Pointer) {
        let (Some(room), Some(placed)) = (object.room, self.placed_room(&object.instance)) else { return };
        let class = self.class_id(&object.instance).map(|class| self.catalog.class(class));
        let carried = class.is_some_and(|class| class.has(Property::Pickupable));
        if room != placed && !carried && !object.removed && !object.blacklisted {
            let [placed, room] = [placed, room].map(|room| room.name_in(self.catalog));
            let message = format!("`{}` is in the {placed}, not in the {room}", object.instance);
            self.warn(&at.key("roomLocation").item(0), message, Some("the layout counts".to_owned()));
        }
    }

    /// The room where the layout has the instance.
    fn placed_room(&self, instance: &str) -> Option<RoomId> {
        self.layout?.placement(instance).map(|placement| placement.room)
    }

    /// A room that the layout lacks.
    pub fn room_in_layout(&mut self, at: &Pointer, room: RoomId) {
        let Some(layout) = self.layout else { return };
        if layout.room(room).is_none() {
            let remedy = one_of(layout.rooms.iter().map(|room| room.id.id()));
            self.error(at, format!("layout `{}` has no room `{}`", layout.id, room.id()), remedy);
        }
    }

    /// More objects in a receptacle than it has anchors.
    fn audit_crowds(&mut self, objects: &[ObjectRequest], places: &[Pointer]) {
        let mut crowds: BTreeMap<&str, u32> = BTreeMap::new();
        for (object, at) in objects.iter().zip(places).filter(|(object, _)| !object.removed && !object.blacklisted) {
            let Some(inside) = object.inside.as_deref() else { continue };
            let Some(class) = self.class_id(inside) else { continue };
            let Some(receptacle) = &self.catalog.class(class).receptacle else { continue };
            let anchors: u32 = receptacle.surfaces.iter().map(|surface| surface.anchors[0] * surface.anchors[1]).sum();
            let crowd = crowds.entry(inside).or_default();
            *crowd += 1;
            if *crowd > anchors {
                let at = at.key("location").item(0).key(inside);
                let message = format!("`{inside}` has {anchors} places: there is none left for `{}`", object.instance);
                self.error(&at, message, Some("put it elsewhere".to_owned()));
            }
        }
    }

    /// Circuits that nothing feeds.
    fn audit_circuits(&mut self, objects: &[ObjectRequest], places: &[Pointer]) {
        let Some(layout) = self.layout else { return };
        let fed: BTreeSet<i32> = layout.rooms.iter().map(|room| i32::from(room.circuit)).collect();
        let fed: BTreeSet<i32> = fed.into_iter().chain(objects.iter().filter_map(|of| of.generates_circuit)).collect();
        for (object, at) in objects.iter().zip(places) {
            let Some(circuit) = object.circuit.filter(|circuit| *circuit >= 0 && !fed.contains(circuit)) else {
                continue;
            };
            let known: Vec<_> = fed.iter().map(ToString::to_string).collect();
            let remedy = one_of(known.iter().map(String::as_str));
            let message = format!("nothing feeds circuit {circuit}: `{}` has no power", object.instance);
            self.warn(&at.key("state"), message, remedy);
        }
    }

    /// Goals that cannot be met.
    fn audit_goals(&mut self, mission: &Mission, places: &[GoalPlaces]) {
        for (goal, places) in mission.goals.iter().zip(places) {
            let possibility =
                Possibility { catalog: self.catalog, conditions: &mission.conditions, objects: &mission.objects };
            let states: Vec<_> = goal.states.iter().collect();
            let reasons: Vec<_> = states.iter().map(|state| possibility.never_state(state)).collect();
            let never = possibility.never_all(&states, goal.relation);
            let alone = reasons.iter().flatten().next().is_some();
            // Of several ways to one end some may be closed.
            for (reason, at) in reasons.into_iter().zip(&places.states) {
                let Some(reason) = reason else { continue };
                if never.is_some() {
                    self.error(at, format!("goal {} cannot be met: {reason}", goal.id), None);
                } else {
                    self.warn(at, reason, None);
                }
            }
            if let Some(reason) = never.filter(|_| !alone) {
                let at = places.goal.key("object_states");
                self.error(&at, format!("goal {} cannot be met: {reason}", goal.id), None);
            }
        }
    }

    /// Warns of conditions that nothing names.
    fn audit_conditions(&mut self, mission: &Mission, places: &[Pointer]) {
        let named = std::mem::take(&mut self.named_conditions);
        for (condition, at) in mission.conditions.iter().zip(places) {
            if !mission.goals.is_empty() && !named.contains(&condition.name) {
                let message = format!("nothing names the condition `{}`", condition.name);
                self.warn(&at.key("stateName"), message, None);
            }
        }
    }

    fn class_id(&self, instance: &str) -> Option<ClassId> {
        self.catalog.class_of_instance(made(instance))
    }
}

/// What is odd about putting something there, and what would be right.
fn misfit(class: &ObjectClass, receptacle: &ObjectClass, inside: &str) -> Option<(String, Option<String>)> {
    if !takes_things(receptacle) {
        return None;
    }
    let kind = receptacle.receptacle.as_ref()?;
    if !kind.keys.is_empty() && !kind.keys.contains(&class.id) {
        let mut keys: Vec<_> = kind.keys.iter().map(String::as_str).collect();
        keys.dedup();
        return Some((format!("`{inside}` does not take a {}", class.name), one_of(keys)));
    }
    if kind.refuses.contains(&class.id) {
        return Some((format!("`{inside}` does not take a {}", class.name), None));
    }
    let room_above = kind.surfaces.iter().map(|surface| surface.clearance_m).fold(0.0, f32::max);
    (kind.enclosed && class.size_m[2] > room_above + 1e-3).then(|| {
        let message = format!("a {} of {} m is too tall for `{inside}`", class.name, class.size_m[2]);
        (message, Some(format!("there are {room_above} m")))
    })
}
