//! Objects and robots as clients are told of them.

use cohabit_cdf::{BodyId, Fluid, ObjectClass, Property, RoomId, StateFlag};
use cohabit_engine::{body_instance_id, object_instance_id};
use cohabit_render::instance_color;
use cohabit_world::{BodyView, ObjectView, Quat, World};
use serde::Serialize;

use crate::axes::{Place, Rotation};

/// The class that robots have for clients; their ids are that and a number from 1.
pub const ROBOT: &str = "TAM";

/// An object, or a robot.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct ObjectRecord {
    #[serde(rename = "objectID")]
    pub object_id: String,
    object_type: String,
    position: Place,
    rotation: Rotation,
    current_room: RoomId,
    supported_verbs: Vec<&'static str>,
    pub supported_states: Vec<&'static str>,
    pub current_states: Vec<&'static str>,
    /// Empty where it is in or on nothing.
    parent_receptacle: String,
    instance_segmentation_color: Rgba,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct Rgba {
    r: u8,
    g: u8,
    b: u8,
    a: u8,
}

impl Rgba {
    fn of_instance(id: u32) -> Self {
        let [r, g, b] = instance_color(id);
        Self { r, g, b, a: 255 }
    }
}

/// What can be done to everything.
const VERBS_OF_ALL: [&str; 2] = ["EXAMINE", "SCAN"];
/// And what to things with a property.
const VERBS: [(Property, &[&str]); 7] = [
    (Property::Openable, &["OPEN", "CLOSE"]),
    (Property::Breakable, &["BREAK"]),
    (Property::Cuttable, &["BREAK"]),
    (Property::Toggleable, &["TOGGLE"]),
    (Property::Dirtyable, &["CLEAN"]),
    (Property::Fillable, &["FILL", "POUR"]),
    (Property::Pickupable, &["THROW"]),
];

/// The states that everything can be in.
const STATES_OF_ALL: [&str; 4] = ["EXAMINED", "SCANNED", "USED", "SPARKING"];
/// And those of things with a property.
const STATES: [(Property, &[&str]); 13] = [
    (Property::Pickupable, &["PICKED_UP", "EMBIGGENATED"]),
    (Property::Openable, &["OPENED", "LOCKED"]),
    (Property::Breakable, &["BROKEN"]),
    (Property::Toggleable, &["TOGGLED"]),
    (Property::Powerable, &["POWERED", "OVERLOADED"]),
    (Property::Dirtyable, &["DIRTY"]),
    (Property::Eatable, &["EATEN"]),
    (Property::Heatable, &["HOT"]),
    (Property::Chillable, &["COLD"]),
    (Property::Fillable, &["FILLED"]),
    (Property::Cookable, &["COOKED"]),
    (Property::Cuttable, &["CUT"]),
    (Property::Infectable, &["INFECTED"]),
];

/// What clients call a state.
const fn name(flag: StateFlag) -> &'static str {
    match flag {
        StateFlag::PickedUp => "PICKED_UP",
        StateFlag::Opened => "OPENED",
        StateFlag::Broken => "BROKEN",
        StateFlag::Toggled => "TOGGLED",
        StateFlag::Powered => "POWERED",
        StateFlag::Overloaded => "OVERLOADED",
        StateFlag::Sparking => "SPARKING",
        StateFlag::Dirty => "DIRTY",
        StateFlag::Eaten => "EATEN",
        StateFlag::Hot => "HOT",
        StateFlag::Cold => "COLD",
        StateFlag::Cooked => "COOKED",
        StateFlag::Cut => "CUT",
        StateFlag::Infected => "INFECTED",
        StateFlag::Scanned => "SCANNED",
        StateFlag::Examined => "EXAMINED",
        StateFlag::Used => "USED",
        StateFlag::Embiggenated => "EMBIGGENATED",
        StateFlag::Locked => "LOCKED",
        StateFlag::Cereal => "FILLED",
        StateFlag::Neutral => "NEUTRAL",
        StateFlag::Happy => "HAPPY",
        StateFlag::Sad => "SAD",
        StateFlag::Angry => "ANGRY",
        StateFlag::Scared => "SCARED",
        StateFlag::Wet => "WET",
        StateFlag::Creased => "CREASED",
        StateFlag::Folded => "FOLDED",
    }
}

/// All that is in a world: its robots, then its objects, each in the order of their ids.
pub fn records(world: &World) -> Vec<ObjectRecord> {
    let robots = world.bodies().map(|body| robot_record(&body));
    let objects = world.objects().filter(|object| world.exists(object.id));
    robots.chain(objects.map(|object| object_record(world, &object))).collect()
}

/// The id of a robot.
pub fn robot_id(body: BodyId) -> String {
    format!("{ROBOT}_{}", body.0 + 1)
}

fn robot_record(body: &BodyView) -> ObjectRecord {
    ObjectRecord {
        object_id: robot_id(body.id),
        object_type: ROBOT.to_owned(),
        position: Place::of(body.position_m),
        rotation: Rotation::of(Quat::from_rotation_z(body.yaw_rad)),
        current_room: body.room,
        supported_verbs: Vec::new(),
        supported_states: StateFlag::MOODS.map(name).to_vec(),
        current_states: body.flags.iter().map(name).collect(),
        parent_receptacle: String::new(),
        instance_segmentation_color: Rgba::of_instance(body_instance_id(body.id)),
    }
}

fn object_record(world: &World, object: &ObjectView<'_>) -> ObjectRecord {
    let class = world.catalog().class(object.class);
    let parent = object.parent.and_then(|parent| world.object(parent));
    let current_states = current_states(object);
    // A mission may put a thing into a state that its class does not have by itself.
    let supported_states = once_each(of_class(class, &STATES_OF_ALL, &STATES).chain(current_states.iter().copied()));
    ObjectRecord {
        object_id: object.instance.to_owned(),
        object_type: class.id.clone(),
        position: Place::of(object.position_m),
        rotation: Rotation::of(object.rotation),
        current_room: object.room,
        supported_verbs: once_each(of_class(class, &VERBS_OF_ALL, &VERBS)),
        supported_states,
        current_states,
        parent_receptacle: parent.map_or_else(String::new, |parent| parent.instance.to_owned()),
        instance_segmentation_color: Rgba::of_instance(object_instance_id(object.id)),
    }
}

/// Cereal and milk are both what fills a bowl.
fn current_states(object: &ObjectView<'_>) -> Vec<&'static str> {
    let filled = (object.fluid != Fluid::None).then_some("FILLED");
    once_each(object.flags.iter().map(name).chain(filled))
}

/// What all have, and what follows from the properties of a class.
fn of_class(
    class: &ObjectClass,
    all: &'static [&str],
    by_property: &'static [(Property, &[&str])],
) -> impl Iterator<Item = &'static str> {
    let more = by_property.iter().filter(|(property, _)| class.has(*property)).flat_map(|(_, names)| *names);
    all.iter().chain(more).copied()
}

fn once_each(names: impl Iterator<Item = &'static str>) -> Vec<&'static str> {
    let mut kept = Vec::new();
    for name in names {
        if !kept.contains(&name) {
            kept.push(name);
        }
    }
    kept
}
