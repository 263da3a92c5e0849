//! One object: what it is, where it is, and the states it is in.

use cohabit_cdf::{BodyId, ClassId, Color, Fluid, ObjectClass, ObjectId, RoomId, StateFlags, mission::Era};
use glam::{Quat, Vec3};
use serde::{Deserialize, Serialize};

use crate::{geometry::Pose, run::Run};

/// What holds an object where it is.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) enum Support {
    /// Its own place in the world.
    Fixed,
    /// A receptacle.
    On {
        /// Which.
        parent: ObjectId,
        /// The anchor it takes, if it stands at one.
        anchor: Option<u16>,
        /// Its pose in the frame of the parent.
        local: Pose,
    },
    /// A hand.
    Held(BodyId),
    /// Nothing: it falls, or slides.
    Loose,
    /// It left the world.
    Gone,
}

impl Support {
    /// The receptacle that it is in or on.
    pub fn parent(&self) -> Option<ObjectId> {
        match self {
            Self::On { parent, .. } => Some(*parent),
            _ => None,
        }
    }
}

/// One object.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct Object {
    /// The id that missions and people's tools use.
    pub instance: String,
    /// Other ids it answers to: the layout's own, when a mission renamed it.
    pub aliases: Vec<String>,
    pub class: ClassId,
    pub room: RoomId,
    pub support: Support,
    pub pose: Pose,
    pub scale: [f32; 3],
    pub flags: StateFlags,
    pub fluid: Fluid,
    pub color: Color,
    /// How far it is open, 0 to 1.
    pub opened: f32,
    /// How far it is up to speed, 0 to 1.
    pub running: f32,
    /// What is written on it.
    pub text: String,
    /// What it switches, or aims at.
    pub works: Option<ObjectId>,
    /// The circuit that feeds it; `None` is no circuit at all.
    pub circuit: Option<i32>,
    /// The circuit that it switches.
    pub feeds: Option<i32>,
    /// The class that the time machine makes of it, if the mission says so.
    pub yesterday: Option<ClassId>,
    /// What it was before a machine made a carrot of it: gone, until the time machine brings it back.
    pub was: Option<ObjectId>,
    /// What the printer makes of it.
    pub prints: Option<ClassId>,
    /// The work it is doing for a moment.
    pub run: Option<Run>,
    /// Whether the mission asked for it, or a machine made it since.
    pub requested: bool,
    /// Whether anybody ever did something to it.
    pub touched: bool,
}

impl Object {
    /// A plain new object.
    pub fn new(instance: String, class: ClassId, room: RoomId, pose: Pose) -> Self {
        Self {
            instance,
            aliases: Vec::new(),
            class,
            room,
            support: Support::Fixed,
            pose,
            scale: [1.0; 3],
            flags: StateFlags::default(),
            fluid: Fluid::None,
            color: Color::Original,
            opened: 0.0,
            running: 0.0,
            text: String::new(),
            works: None,
            circuit: None,
            feeds: None,
            yesterday: None,
            was: None,
            prints: None,
            run: None,
            requested: false,
            touched: false,
        }
    }

    /// Whether it is in the world.
    pub fn exists(&self) -> bool {
        self.support != Support::Gone
    }

    /// The receptacle it is in or on.
    pub fn parent(&self) -> Option<ObjectId> {
        self.support.parent()
    }

    /// What it weighs, kg: what is embiggened weighs as much more as it is larger.
    pub fn mass_kg(&self, class: &ObjectClass) -> f32 {
        class.mass_kg * self.scale.iter().product::<f32>()
    }

    /// Who holds it.
    pub fn held_by(&self) -> Option<BodyId> {
        match self.support {
            Support::Held(body) => Some(body),
            _ => None,
        }
    }

    /// Whether it answers to `instance`.
    pub fn is_called(&self, instance: &str) -> bool {
        self.instance == instance || self.aliases.iter().any(|alias| alias == instance)
    }
}

/// What everybody outside may know of an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObjectView<'a> {
    /// Its index in the world.
    pub id: ObjectId,
    /// Its id in missions.
    pub instance: &'a str,
    /// Its class.
    pub class: ClassId,
    /// The room it is in.
    pub room: RoomId,
    /// Its origin, m.
    pub position_m: Vec3,
    /// World from object.
    pub rotation: Quat,
    /// Scale of its model along x, y, z.
    pub scale: [f32; 3],
    /// Its states.
    pub flags: StateFlags,
    /// What it is filled with.
    pub fluid: Fluid,
    /// Its colour.
    pub color: Color,
    /// How far it is open, 0 to 1.
    pub opened: f32,
    /// How far it is up to speed, 0 to 1.
    pub running: f32,
    /// The receptacle it is in or on.
    pub parent: Option<ObjectId>,
    /// Who holds it.
    pub held_by: Option<BodyId>,
    /// Whether it cannot be seen: inside something closed, or gone.
    pub hidden: bool,
    /// What is written on it.
    pub text: &'a str,
    /// What it switches, or aims at.
    pub works: Option<ObjectId>,
    /// Where it leads, if it is an open portal.
    pub leads_to: Option<Era>,
    /// Whether it is there for the mission's sake, or was made since; not only part of the furnishings.
    pub in_mission: bool,
}
