//! A mission in the making: what stands where, what is wanted of it, as a mission file.

use std::collections::{BTreeMap, BTreeSet};

use cohabit_cdf::{Catalog, Color, Layout, ObjectClass, Property, RoomId, catalog::Stands, layout::Placement};
use serde::Serialize;
use serde_json::{Map, Value, json};

use crate::{
    chance::Chance,
    spec::{BlockerKind, MissionType, Pools, VarKind, VarSpec},
    things::{is_container, is_debris, is_thing},
};

/// The doors that all floor plans of the built-in offices have, by their numbers.
const DOORS: u32 = 7;
/// What switches a circuit.
const LEVER: &str = "FuseBox_01_Lever";

/// Something that stands in the way of a mission's goals.
#[derive(Clone, Debug, Eq, PartialEq, Serialize)]
pub struct Blocker {
    /// How.
    pub kind: BlockerKind,
    /// What: the container that is shut or locked, or the lever that is down.
    pub instance: String,
}

/// A mission that was drawn.
pub(crate) struct Drawn {
    /// The mission file.
    pub cdf: Value,
    /// What stands in the way, if anything does.
    pub blocker: Option<Blocker>,
    /// The classes of the things that were drawn for its goals.
    pub things: Vec<String>,
    /// The classes of things that its goals name themselves.
    pub named: Vec<String>,
}

/// What was decided so far.
pub(crate) struct Draft<'a> {
    chance: &'a mut Chance,
    catalog: &'a Catalog,
    layout: &'a Layout,
    pools: &'a Pools,
    vars: BTreeMap<String, String>,
    objects: Vec<Value>,
    conditions: Vec<Value>,
    numbers: BTreeMap<String, u32>,
    things: BTreeSet<String>,
    named: BTreeSet<String>,
    blocker: Option<Blocker>,
}

impl<'a> Draft<'a> {
    pub fn new(catalog: &'a Catalog, layout: &'a Layout, pools: &'a Pools, chance: &'a mut Chance) -> Self {
        let (vars, objects, conditions, numbers, things, named) = Default::default();
        Self { chance, catalog, layout, pools, vars, objects, conditions, numbers, things, named, blocker: None }
    }

    /// A mission file of a type, perhaps with something in the way; none where chance has chosen what does not go together. What
    /// is to be locked shows only in the plan of a mission without locks: see [`with_lock`].
    pub fn draw(mut self, kind: &MissionType, blocker: Option<BlockerKind>) -> Option<Drawn> {
        for var in &kind.vars {
            let shut = blocker == Some(BlockerKind::Closed) && self.blocker.is_none();
            let instance = self.var(var, shut)?;
            self.vars.insert(var.name.clone(), instance);
        }
        if blocker == Some(BlockerKind::Unpowered) {
            self.cut_power()?;
        }
        for _ in 0..self.chance.below(self.pools.distractors + 1) {
            let class = self.carried(&[Property::Pickupable], &[])?;
            self.put(&class, &[], &[])?;
        }
        let goals = kind.goals.iter().enumerate().map(|(number, goal)| self.goal(number, goal, kind.then));
        let goals: Vec<Value> = goals.collect::<Option<_>>()?;
        // Where people leave and look for things: not in the way of every door.
        let known = self.catalog.rooms();
        let is_lived_in = |room: &RoomId| !known.is_corridor(*room) && self.layout.room(*room).is_some();
        let rooms: Vec<RoomId> = known.ids().filter(is_lived_in).collect();
        if rooms.is_empty() {
            return None;
        }
        let start = rooms[self.chance.below(rooms.len())];
        let mut robots = Vec::new();
        if kind.robots > 1 {
            robots.push(robot(1, start));
            for number in 2..=kind.robots {
                robots.push(robot(number, rooms[self.chance.below(rooms.len())]));
            }
        }
        let blocker = self.blocker.take();
        let [things, named] = [&mut self.things, &mut self.named].map(|set| std::mem::take(set).into_iter().collect());
        let cdf = self.finish(&kind.name, start, &robots, goals);
        Some(Drawn { cdf, blocker, things, named })
    }

    /// What a var stands for; a thing is put into something shut, if asked.
    fn var(&mut self, var: &VarSpec, shut: bool) -> Option<String> {
        match var.kind {
            VarKind::Surface => self.surface(),
            VarKind::Device => self.device(|class| {
                (var.class.is_empty() || var.class.contains(&class.id))
                    && var.affords.iter().all(|one| class.has(*one))
                    && !var.without.iter().any(|one| class.has(*one))
                    && !class.name.is_empty()
            }),
            VarKind::Thing => {
                let class = self.class_of(var)?;
                let instance = if shut && var.inside.is_empty() {
                    let container = self.shut_container()?;
                    self.put_at(&class, &var.state, &container, "in")
                } else {
                    self.put(&class, &var.state, &var.inside)?
                };
                self.things.insert(class.clone());
                if self.chance.is(self.pools.doubles) {
                    self.put(&class, &var.state, &[])?;
                }
                Some(instance)
            }
        }
    }

    fn class_of(&mut self, var: &VarSpec) -> Option<String> {
        if let Some(of) = &var.key_of {
            let device = self.catalog.class_of_instance(self.vars.get(of)?)?;
            let keys = &self.catalog.class(device).receptacle.as_ref()?.keys;
            return self.chance.pick(keys).cloned();
        }
        if var.class.is_empty() {
            self.carried(&var.affords, &var.without)
        } else {
            self.chance.pick(&var.class).cloned()
        }
    }

    /// A class of things to carry.
    fn carried(&mut self, affords: &[Property], without: &[Property]) -> Option<String> {
        let is_fit = |class: &&ObjectClass| {
            is_thing(class)
                && !is_debris(class)
                && affords.iter().all(|one| class.has(*one))
                && !without.iter().any(|one| class.has(*one))
        };
        let fit: Vec<&str> = self.catalog.classes().iter().filter(is_fit).map(|class| class.id.as_str()).collect();
        self.chance.pick(&fit).map(|class| (*class).to_owned())
    }

    /// Puts a thing somewhere.
    fn put(&mut self, class: &str, state: &[String], inside: &[String]) -> Option<String> {
        let (place, how) = if inside.is_empty() {
            (self.surface()?, "on")
        } else {
            (self.device(|class| inside.contains(&class.id))?, "in")
        };
        Some(self.put_at(class, state, &place, how))
    }

    /// Puts a thing on or into a receptacle.
    fn put_at(&mut self, class: &str, state: &[String], place: &str, how: &str) -> String {
        let number = self.numbers.entry(class.to_owned()).or_default();
        *number += 1;
        let instance = format!("{class}_{number}");
        let mut states: Vec<Value> =
            state.iter().filter_map(|state| state.split_once('=')).map(|(key, value)| json!({ key: value })).collect();
        if *number == 1 {
            // What the floor plan has of it would be meant as well.
            states.push(json!({ "Unique": "true" }));
        }
        self.objects.push(json!({ "name": instance, "state": states, "location": [{ place: how }] }));
        instance
    }

    /// A container of the floor plan with a door that is shut.
    fn shut_container(&mut self) -> Option<String> {
        let instance = self.device(is_container)?;
        self.objects.push(json!({ "name": instance, "state": [{ "isOpen": "false" }] }));
        self.blocker = Some(Blocker { kind: BlockerKind::Closed, instance: instance.clone() });
        Some(instance)
    }

    /// Puts down the lever of a fuse box.
    fn cut_power(&mut self) -> Option<()> {
        let is_lever = |placement: &&Placement| {
            let class = self.catalog.class_of_instance(&placement.instance).map(|class| self.catalog.class(class));
            class.is_some_and(|class| class.id == LEVER)
        };
        let levers: Vec<String> =
            self.layout.placements.iter().filter(is_lever).map(|placement| placement.instance.clone()).collect();
        let instance = self.chance.pick(&levers)?.clone();
        self.objects.push(json!({ "name": instance, "state": [{ "isToggledOn": "false" }] }));
        self.blocker = Some(Blocker { kind: BlockerKind::Unpowered, instance });
        Some(())
    }

    /// Something of the floor plan that can be told from all else in its room.
    fn device(&mut self, is_fit: impl Fn(&ObjectClass) -> bool) -> Option<String> {
        let class_of = |placement: &Placement| {
            self.catalog.class_of_instance(&placement.instance).map(|class| self.catalog.class(class))
        };
        let looks = |placement: &Placement| class_of(placement).map(|class| (&class.name, &class.color));
        let all = &self.layout.placements;
        let is_alone = |placement: &&Placement| {
            let like = |other: &&Placement| other.room == placement.room && looks(other) == looks(placement);
            all.iter().filter(like).count() == 1
        };
        let fit: Vec<String> = all
            .iter()
            .filter(|placement| !self.catalog.rooms().is_corridor(placement.room))
            .filter(|placement| class_of(placement).is_some_and(&is_fit))
            .filter(is_alone)
            .map(|placement| placement.instance.clone())
            .collect();
        self.chance.pick(&fit).cloned()
    }

    /// Open furniture with room on it.
    fn surface(&mut self) -> Option<String> {
        self.device(|class| {
            let is_open = class.receptacle.as_ref().is_some_and(|place| !place.enclosed && place.keys.is_empty());
            let is_machine =
                [Property::Powerable, Property::Toggleable, Property::Usable].iter().any(|one| class.has(*one));
            is_open && !is_machine && class.stands == Stands::OnFloor && class.id != "TrashCan_01"
        })
    }

    fn goal(&mut self, number: usize, goal: &str, then: bool) -> Option<Value> {
        let states: Option<Vec<Value>> = goal.split(" and ").map(|state| self.goal_state(state)).collect();
        let before: Vec<usize> = if then && number > 0 { vec![number - 1] } else { Vec::new() };
        Some(json!({
            "goal_id": number,
            "description": "",
            "object_states": states?,
            "object_states_relation": "and",
            "preconditions": before,
            "visibility": { "isHidden": false, "activationInteractable": "ALWAYS UNLOCKED", "stickyNoteIndex": 0 },
            "canReset": false,
        }))
    }

    fn goal_state(&mut self, state: &str) -> Option<Value> {
        let (of, state) = state.split_once(' ')?;
        let of = of.trim_end_matches(':');
        self.note_named(of);
        let instance = self.vars.get(of).cloned().unwrap_or_else(|| of.to_owned());
        let (key, value) = state.split_once('=')?;
        if key == "color" {
            return self.color(&instance, value);
        }
        let value = self.vars.get(value).cloned().unwrap_or_else(|| value.to_owned());
        Some(json!({ instance: format!("{key}={value}") }))
    }

    /// Notes the class of things that a goal names itself, such as `Carrot_01_*`.
    fn note_named(&mut self, of: &str) {
        let catalog = self.catalog;
        let class = of.strip_suffix("_*").and_then(|class| catalog.find(class)).map(|class| catalog.class(class));
        self.named.extend(class.filter(|class| is_thing(class)).map(|class| class.id.clone()));
    }

    /// That a thing has a colour is a condition of the mission's own.
    fn color(&mut self, instance: &str, value: &str) -> Option<Value> {
        let drawn = *self.chance.pick(&[Color::Red, Color::Green, Color::Blue])?;
        let color = Color::from_name(value).unwrap_or(drawn);
        let name = format!("HasColor{}", self.conditions.len());
        self.conditions.push(json!({
            "stateName": name,
            "context": instance,
            "expression": { "ColorMetaDataChange": { "target": instance, "colorvalue": color.name(), "message": "" } },
        }));
        Some(json!({ instance: format!("{name}=true") }))
    }

    fn finish(self, name: &str, start: RoomId, robots: &[Value], goals: Vec<Value>) -> Value {
        // A door that the floor plan lacks would be made, and stand about in a room.
        let placed = &self.layout.placements;
        let is_there = |door: &String| placed.iter().any(|placement| placement.instance == *door);
        let doors = (1..=DOORS).map(|number| format!("Door_01_{number}")).filter(is_there);
        let doors = doors.map(|door| json!({ "name": door, "state": [{ "isOpen": "true" }] }));
        let objects: Vec<Value> = self.objects.into_iter().chain(doors).map(whole).collect();
        let messages =
            json!({ "task_beginning": [], "task_procedure": [], "task_ending": [], "object_conditions": [] });
        json!({
            "task_description": "",
            "goal_text": name,
            "game_id": "3",
            "scene": {
                "floor_plan": "1",
                "scene_id": name,
                "simbot_init": robots,
                "roomLocation": [start.id()],
                "required_objects": objects,
                "sticky_notes": [],
                "blacklisted_layouts": null,
                "layoutOverride": self.layout.id,
                "completelyRandomVisual": false,
            },
            "task_goals": goals,
            "stateconditions": self.conditions,
            "game_interactions": { "camera_movements": messages, "game_messages": messages },
        })
    }
}

/// A robot that starts in a room, as mission files ask for it.
fn robot(number: usize, room: RoomId) -> Value {
    json!({ "name": format!("TAM_{number}"), "roomLocation": [room.id()] })
}

/// A mission in which a container is locked.
pub(crate) fn with_lock(cdf: &Value, instance: &str) -> Value {
    let mut cdf = cdf.clone();
    if let Some(objects) = cdf["scene"]["required_objects"].as_array_mut() {
        objects.push(whole(json!({ "name": instance, "state": [{ "isLocked": "true" }] })));
    }
    cdf
}

/// An object's request with the fields that were left out.
fn whole(object: Value) -> Value {
    let mut whole = json!({ "name": "", "state": [], "location": [], "roomLocation": [], "colors": [] });
    if let (Value::Object(all), Value::Object(some)) = (&mut whole, object) {
        all.extend::<Map<String, Value>>(some);
    }
    whole
}
