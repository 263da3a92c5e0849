//! What the robot knows of its world: the only facts language is grounded on.

pub(crate) mod afforded;
pub(crate) mod contents;
pub(crate) mod describe;
pub(crate) mod floor;
pub(crate) mod habits;
pub(crate) mod imagine;
pub(crate) mod memory;
pub(crate) mod process;
pub(crate) mod sight;
pub(crate) mod surroundings;
pub(crate) mod symbols;
mod uses;
pub(crate) mod vending;

use cohabit_cdf::{
    Catalog, ClassId, Color, Fluid, Layout, ObjectId, RoomId,
    layout::Placement,
    state::{StateFlag, StateFlags},
};
use serde::{Deserialize, Serialize};

use crate::known::floor::Floor;

/// What stands on nothing and lower than this lies on the floor, m.
pub(crate) const ON_FLOOR_M: f32 = 0.3;

/// The robot, the objects it knows of, and the goals.
#[derive(Clone, Debug, PartialEq)]
pub struct Known {
    /// The robot itself.
    pub robot: KnownRobot,
    /// Every object it knows of.
    pub objects: Vec<KnownObject>,
    /// What people are asked to get done, in a line; empty, where nobody told.
    pub mission: String,
    /// The goals that people may read, in their order.
    pub goals: Vec<KnownGoal>,
    /// The rooms of the floor plan; empty, where nobody told.
    pub rooms: Vec<RoomId>,
    /// The floor, as far as what it does not know may be looked for; `None` for who knows everything.
    pub floor: Option<Floor>,
    /// Who speaks to it, if they are there themselves.
    pub person: Option<KnownPerson>,
}

/// A person who speaks to the robot, as the body that they walk about in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnownPerson {
    /// Where they stand, m, in the world.
    pub position_m: [f32; 3],
    /// Where they look, in the world.
    pub yaw_rad: f32,
    /// Their room.
    pub room: RoomId,
}

/// Where the robot is and what it holds.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownRobot {
    /// Where it stands, m, in the world.
    pub position_m: [f32; 3],
    /// Where it looks, in the world.
    pub yaw_rad: f32,
    /// Its room.
    pub room: RoomId,
    /// What is in its hand.
    pub held: Option<ObjectId>,
}

/// One object.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct KnownObject {
    /// Which.
    pub id: ObjectId,
    /// Its instance id, such as `Bowl_01_1`.
    pub instance: String,
    /// Its class.
    pub class: ClassId,
    /// The room it is in.
    pub room: RoomId,
    /// Its origin, m, in the world.
    pub position_m: [f32; 3],
    /// The way its front faces, in the world.
    pub yaw_rad: f32,
    /// Its states.
    pub flags: StateFlags,
    /// What it is filled with.
    pub fluid: Fluid,
    /// The colour a mission or a machine gave it.
    pub color: Color,
    /// What it stands on or lies in.
    pub parent: Option<ObjectId>,
    /// What is written on it.
    pub text: String,
    /// Whether the robot sees it now.
    pub visible: bool,
    /// Whether nobody can see it: it is behind a closed door.
    pub is_hidden: bool,
    /// The device that this monitor, button or lever works.
    pub works: Option<ObjectId>,
    /// Whether it is there for the sake of the mission, and not only part of the furnishings: people speak of it rather.
    pub in_mission: bool,
}

/// One goal of the mission.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownGoal {
    /// What people read.
    pub text: String,
    /// Whether it is met.
    pub met: bool,
}

impl Known {
    /// These things and this robot, of which nothing else was told.
    #[must_use]
    pub const fn new(robot: KnownRobot, objects: Vec<KnownObject>) -> Self {
        Self { robot, objects, mission: String::new(), goals: Vec::new(), rooms: Vec::new(), floor: None, person: None }
    }

    /// Whether there is this room; where nobody told, there may be any.
    pub(crate) fn may_have_room(&self, room: RoomId) -> bool {
        self.rooms.is_empty() || self.rooms.contains(&room)
    }

    /// What the rooms that there are are called, in the order of the catalogue.
    pub(crate) fn room_names<'c>(&self, catalog: &'c Catalog) -> impl Iterator<Item = &'c str> {
        let there = catalog.rooms().all().iter().filter(|room| self.may_have_room(room.id));
        there.map(|room| room.name.as_str())
    }

    /// The object with this id.
    #[must_use]
    pub fn object(&self, id: ObjectId) -> Option<&KnownObject> {
        self.place(id).map(|at| &self.objects[at])
    }

    pub(crate) fn object_mut(&mut self, id: ObjectId) -> Option<&mut KnownObject> {
        self.place(id).map(|at| &mut self.objects[at])
    }

    /// Where an object is in the list: at its id, if all are known; else found by halves, if they are in the order of their ids.
    pub(crate) fn place(&self, id: ObjectId) -> Option<usize> {
        let is_it = |object: &KnownObject| object.id == id;
        let at_id = Some(id.0 as usize).filter(|at| self.objects.get(*at).is_some_and(is_it));
        let in_order = || self.objects.binary_search_by_key(&id, |object| object.id).ok();
        at_id.or_else(in_order).or_else(|| self.objects.iter().position(is_it))
    }

    /// What stands on or lies in `id`, itself not included.
    pub(crate) fn contents(&self, id: ObjectId) -> impl Iterator<Item = &KnownObject> {
        self.objects.iter().filter(move |object| object.parent == Some(id))
    }

    /// What an object stands on or lies in, then what that stands on, and so on outwards.
    pub(crate) fn ancestors(&self, id: ObjectId) -> impl Iterator<Item = &KnownObject> {
        let mut next = self.object(id).and_then(|object| object.parent);
        // A loop of parents would be the world's mistake; it must not hang the conversation.
        let mut left = 8;
        std::iter::from_fn(move || {
            let object = self.object(next?)?;
            next = object.parent;
            left -= 1;
            (left >= 0).then_some(object)
        })
    }

    /// Whether a thing lies or stands on the floor: on nothing else, and in nobody's hand.
    pub(crate) fn is_on_floor(&self, object: &KnownObject) -> bool {
        object.parent.is_none() && self.robot.held != Some(object.id) && object.position_m[2] <= ON_FLOOR_M
    }

    /// The horizontal distance from the robot, m.
    #[must_use]
    pub fn distance_m(&self, object: &KnownObject) -> f32 {
        floor::distance_m(self.robot.position_m, object.position_m)
    }

    /// The direction of an object that is in the robot's room and not in its hand: positive to its left, within a half
    /// turn, rad.
    #[must_use]
    pub fn bearing_in_room_rad(&self, id: ObjectId) -> Option<f32> {
        let object = self.object(id).filter(|object| object.room == self.robot.room && self.robot.held != Some(id))?;
        Some(self.bearing_rad(object))
    }

    /// The direction of an object as the robot sees it: positive to its left, within a half turn.
    pub(crate) fn bearing_rad(&self, object: &KnownObject) -> f32 {
        let dx = object.position_m[0] - self.robot.position_m[0];
        let dy = object.position_m[1] - self.robot.position_m[1];
        within_half_turn(dy.atan2(dx) - self.robot.yaw_rad)
    }
}

/// The same angle within a half turn either way, rad.
#[must_use]
pub fn within_half_turn(angle_rad: f32) -> f32 {
    let turn = std::f32::consts::TAU;
    let wrapped = angle_rad.rem_euclid(turn);
    if wrapped > turn / 2.0 { wrapped - turn } else { wrapped }
}

impl KnownObject {
    /// A thing in no state, on nothing and out of sight.
    #[must_use]
    pub fn new(id: ObjectId, instance: String, class: ClassId, room: RoomId, position_m: [f32; 3]) -> Self {
        Self {
            id,
            instance,
            class,
            room,
            position_m,
            yaw_rad: 0.0,
            flags: StateFlags::default(),
            fluid: Fluid::None,
            color: Color::Original,
            parent: None,
            text: String::new(),
            visible: false,
            is_hidden: false,
            works: None,
            in_mission: false,
        }
    }

    /// All that a floor plan has as it is built, as it is known to who has seen it once and sees none of it now; the number of each is
    /// its place in the plan.
    #[must_use]
    pub fn furniture(catalog: &Catalog, layout: &Layout) -> Vec<Self> {
        let number = |instance: &str| {
            let at = layout.placements.iter().position(|placement| placement.instance == instance)?;
            Some(ObjectId(at as u32))
        };
        let known = |placement: &Placement| {
            let class = catalog.class_of_instance(&placement.instance)?;
            Some(Self {
                id: number(&placement.instance)?,
                instance: placement.instance.clone(),
                class,
                room: placement.room,
                position_m: layout.origin_in_world_m(placement),
                yaw_rad: 0.0,
                flags: catalog.class(class).states_as_built(),
                fluid: catalog.class(class).fluid_as_built(),
                color: Color::Original,
                parent: placement.on.as_deref().and_then(number),
                text: String::new(),
                visible: false,
                is_hidden: false,
                works: placement.works.as_deref().and_then(number),
                in_mission: false,
            })
        };
        layout.placements.iter().filter_map(known).collect()
    }

    pub(crate) fn has(&self, flag: StateFlag) -> bool {
        self.flags.has(flag)
    }
}
