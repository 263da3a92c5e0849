//! A mission in the making: what stands where, what is wanted, and when it is done.

use cohabit_cdf::{Catalog, Color, Layout, ObjectClass, Property, RoomId, catalog::Stands, layout::Placement};
use serde_json::{Map, Value, json};

use crate::{chance::Chance, generate::ROOMS, meaning::Meaning};

/// The share of missions in which there is another thing of the same class.
const DOUBLES: f64 = 0.6;
/// The doors of every floor plan.
const DOORS: u32 = 7;

/// A thing that the mission is about, and its room.
#[derive(Clone, Debug)]
pub(super) struct Wanted {
    pub(super) instance: String,
    pub(super) room: RoomId,
}

/// What was decided so far.
pub(super) struct Draft<'a> {
    pub(super) chance: &'a mut Chance,
    catalog: &'a Catalog,
    layout: &'a Layout,
    start: RoomId,
    /// The room where the person last sent the robot.
    at: RoomId,
    objects: Vec<Value>,
    goals: Vec<Value>,
    conditions: Vec<Value>,
    plan: Vec<Meaning>,
    /// Where things were put: the room, and what the furniture is called and looks like.
    taken: Vec<(RoomId, Looks)>,
}

/// A name and a colour.
type Looks = (String, String);

impl<'a> Draft<'a> {
    pub(super) fn new(catalog: &'a Catalog, layout: &'a Layout, chance: &'a mut Chance) -> Self {
        let start = ROOMS[chance.below(ROOMS.len())];
        let (objects, goals, conditions, plan, taken) = Default::default();
        Self { chance, catalog, layout, start, at: start, objects, goals, conditions, plan, taken }
    }

    /// The class of something.
    pub(super) fn class(&self, of: &Wanted) -> Option<&'a ObjectClass> {
        self.catalog.class_of_instance(&of.instance).map(|class| self.catalog.class(class))
    }

    /// A thing to carry that affords `property`, in that state.
    pub(super) fn thing(&mut self, property: Property, state: &[(&str, &str)]) -> Option<Wanted> {
        let is_fit = |class: &&ObjectClass| {
            class.has(Property::Pickupable) && class.has(property) && !class.name.is_empty() && !is_debris(class)
        };
        let fit: Vec<&str> = self.catalog.classes().iter().filter(is_fit).map(|class| class.id.as_str()).collect();
        let class = *self.chance.pick(&fit)?;
        self.put(class, state)
    }

    /// A thing of one of these classes.
    pub(super) fn one_of(&mut self, classes: &[&str]) -> Option<Wanted> {
        let class = *self.chance.pick(classes)?;
        self.put(class, &[])
    }

    /// A thing of that class, in that state, somewhere; perhaps another one elsewhere, in the same state.
    pub(super) fn put(&mut self, class: &str, state: &[(&str, &str)]) -> Option<Wanted> {
        let wanted = self.put_down(class, 1, state)?;
        if self.chance.is(DOUBLES) {
            self.put_down(class, 2, state)?;
        } else if let Some(Value::Array(states)) = self.objects.last_mut().and_then(|object| object.get_mut("state")) {
            // What the floor plan has of it would be meant as well.
            states.push(json!({ "Unique": "true" }));
        }
        Some(wanted)
    }

    fn put_down(&mut self, class: &str, number: u32, state: &[(&str, &str)]) -> Option<Wanted> {
        let (place, room) = self.surface()?;
        let looks = self.looks(&place)?;
        if self.taken.contains(&(room, looks.clone())) {
            // Nobody could say which of the two is meant.
            return None;
        }
        self.taken.push((room, looks));
        let instance = format!("{class}_{number}");
        let states: Vec<Value> = state.iter().map(|(key, value)| json!({ *key: value })).collect();
        self.objects.push(json!({
            "name": instance, "state": states, "location": [{ place: "on" }], "roomLocation": [room.id()],
        }));
        Some(Wanted { instance, room })
    }

    fn looks(&self, instance: &str) -> Option<Looks> {
        let class = self.catalog.class(self.catalog.class_of_instance(instance)?);
        Some((class.name.clone(), class.color.clone()))
    }

    /// Something of the floor plan that can be told from all else in its room.
    pub(super) fn device(&mut self, is_fit: impl Fn(&ObjectClass) -> bool) -> Option<Wanted> {
        let is_like = |one: &Placement, other: &Placement| {
            one.room == other.room && self.looks(&one.instance) == self.looks(&other.instance)
        };
        let all = &self.layout.placements;
        let fit: Vec<Wanted> = (all.iter())
            .filter(|placement| ROOMS.contains(&placement.room))
            .filter(|placement| all.iter().filter(|other| is_like(placement, other)).count() == 1)
            .filter(|placement| {
                self.catalog
                    .class_of_instance(&placement.instance)
                    .is_some_and(|class| is_fit(self.catalog.class(class)))
            })
            .map(|placement| Wanted { instance: placement.instance.clone(), room: placement.room })
            .collect();
        self.chance.pick(&fit).cloned()
    }

    /// Furniture with room on it, and its room.
    fn surface(&mut self) -> Option<(String, RoomId)> {
        let is_fit = |class: &ObjectClass| {
            let is_open = class.receptacle.as_ref().is_some_and(|place| !place.enclosed && place.keys.is_empty());
            let is_machine =
                [Property::Powerable, Property::Toggleable, Property::Usable].iter().any(|one| class.has(*one));
            is_open && !is_machine && class.stands == Stands::OnFloor && class.id != "TrashCan_01"
        };
        let found = self.device(is_fit)?;
        Some((found.instance, found.room))
    }

    pub(super) fn want(&mut self, meaning: Meaning) {
        self.plan.push(meaning);
    }

    /// Has the robot sent to its room, where it is not there.
    pub(super) fn go(&mut self, to: &Wanted) {
        if self.at != to.room {
            self.at = to.room;
            self.want(Meaning::GoTo { room: to.room });
        }
    }

    pub(super) fn take(&mut self, object: &Wanted) {
        self.go(object);
        self.want(Meaning::PickUp { object: object.instance.clone() });
    }

    /// Has it taken to be treated, and then delivered.
    pub(super) fn treat(&mut self, object: &Wanted, meaning: Meaning, goal: &str) -> Option<()> {
        self.take(object);
        self.want(meaning);
        self.goal(&object.instance, goal);
        self.deliver(object)
    }

    /// Has it brought to some furniture.
    pub(super) fn deliver(&mut self, object: &Wanted) -> Option<()> {
        let (instance, room) = self.surface()?;
        let place = Wanted { instance, room };
        // Where the robot is after machines it went to by itself is not said: people say where to go.
        self.at = RoomId::Hallway;
        self.go(&place);
        self.want(Meaning::Place { object: object.instance.clone(), receptacle: place.instance.clone() });
        self.goal(&place.instance, &format!("Contains={}", object.instance));
        Some(())
    }

    pub(super) fn goal(&mut self, instance: &str, state: &str) {
        self.goals.push(json!({
            "goal_id": self.goals.len(),
            "description": "",
            "object_states": [{ instance: state }],
            "object_states_relation": "and",
            "preconditions": [],
            "visibility": { "isHidden": false, "activationInteractable": "ALWAYS UNLOCKED", "stickyNoteIndex": 0 },
            "canReset": false,
        }));
    }

    pub(super) fn color_goal(&mut self, instance: &str, color: Color) {
        self.conditions.push(json!({
            "stateName": "HasItsColor",
            "context": instance,
            "expression": { "ColorMetaDataChange": { "target": instance, "colorvalue": color.name(), "message": "" } },
        }));
        self.goal(instance, "HasItsColor=true");
    }

    /// The mission's text, and the expert's plan.
    pub(super) fn finish(self, name: &str) -> (Value, Vec<Meaning>) {
        let doors =
            (1..=DOORS).map(|number| json!({ "name": format!("Door_01_{number}"), "state": [{ "isOpen": "true" }] }));
        let objects: Vec<Value> = self.objects.into_iter().chain(doors).map(whole).collect();
        let messages =
            json!({ "task_beginning": [], "task_procedure": [], "task_ending": [], "object_conditions": [] });
        let cdf = json!({
            "task_description": "",
            "goal_text": name,
            "game_id": "3",
            "scene": {
                "floor_plan": "1",
                "scene_id": name,
                "simbot_init": [],
                "roomLocation": [self.start.id()],
                "required_objects": objects,
                "sticky_notes": [],
                "blacklisted_layouts": null,
                "layoutOverride": self.layout.id,
                "completelyRandomVisual": false,
            },
            "task_goals": self.goals,
            "stateconditions": self.conditions,
            "game_interactions": { "camera_movements": messages, "game_messages": messages },
        });
        (cdf, self.plan)
    }
}

/// An object's request with the fields that were left out.
fn whole(object: Value) -> Value {
    let mut whole = json!({ "name": "", "state": [], "location": [], "roomLocation": [], "colors": [] });
    if let (Value::Object(all), Value::Object(some)) = (&mut whole, object) {
        all.extend::<Map<String, Value>>(some);
    }
    whole
}

/// What is left of another thing is called like it: nobody sends for it.
fn is_debris(class: &ObjectClass) -> bool {
    ["Broken", "Crushed", "Toast_", "Slice", "Lid"].iter().any(|part| class.id.contains(part))
}
