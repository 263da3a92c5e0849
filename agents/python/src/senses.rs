//! What a body senses besides pictures: itself, and the objects that fill its slots.

use cohabit_bus::message::Thing;
use cohabit_cdf::{ObjectId, StateFlag, StateFlags};
use cohabit_world::Vec3;
use pyo3::prelude::*;

use crate::{
    around::{Around, Posture, Sight},
    choice::Choice,
    error::bad_argument,
    frame::Frame,
    memory::Memory,
};

/// Which objects fill a body's slots.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Filling {
    /// Those in its camera's picture, the largest first.
    Seen,
    /// Those in its room that are not hidden, the nearest first.
    Near,
    /// All there are, by their numbers.
    All,
}

impl Filling {
    /// The filling of that name.
    ///
    /// # Errors
    /// A `ValueError` that lists the names.
    pub fn named(name: &str) -> PyResult<Self> {
        match name {
            "seen" => Ok(Self::Seen),
            "near" => Ok(Self::Near),
            "all" => Ok(Self::All),
            _ => Err(bad_argument(format!("there are no slots `{name}`: seen, near or all"))),
        }
    }
}

/// What a body senses, before it is Python's.
pub struct Sensed {
    pub body: Posture,
    /// The class of what it holds, from 1; 0 is nothing.
    pub held_class: i64,
    /// The id of each slot's object in the id plane; 0 is an empty slot.
    pub ids: Vec<u32>,
    /// Its class, from 1.
    pub classes: Vec<i64>,
    /// Where it is, seen from the body.
    pub positions_m: Vec<[f32; 3]>,
    /// Its states.
    pub flags: Vec<[i8; StateFlag::ALL.len()]>,
    /// Whether its class affords each choice, `[choices, slots]`; of one that leads to a room, whether there is that room.
    pub afforded: Vec<i8>,
}

/// What a body senses besides pictures. Arrays of `slots` rows are filled up with zeros.
#[pyclass(frozen, get_all, module = "cohabit._native")]
pub struct Senses {
    /// `[3]` `f4`: where it stands, m.
    position: Py<PyAny>,
    /// Its heading, rad.
    yaw_rad: f32,
    /// The pitch of its head, rad.
    head_pitch_rad: f32,
    /// Its room's index.
    room: u32,
    /// The class of what it holds, from 1; 0 is nothing.
    held_class: i64,
    /// Whether it carries out a command.
    busy: bool,
    /// `[slots]` `u4`: the id of each object in the id plane; 0 is an empty slot.
    ids: Py<PyAny>,
    /// `[slots]` `i8`: its class, from 1.
    classes: Py<PyAny>,
    /// `[slots, 3]` `f4`: where it is, seen from the body: ahead, to the left, up, m.
    positions: Py<PyAny>,
    /// `[slots, 28]` `i1`: its states, in the order of `FLAGS`.
    flags: Py<PyAny>,
    /// `[choices, slots]` `i1`: whether its class affords each choice; all alike for choices without an object, zeros where they lead to a
    /// room that the floor plan does not have.
    afforded: Py<PyAny>,
}

/// The objects that fill a body's slots, at most `slots`.
fn fill(around: &impl Around, body: &Posture, filling: Filling, slots: usize, frame: Option<&Frame>) -> Vec<Sight> {
    let mut objects = match filling {
        Filling::Seen => frame.map_or_else(Vec::new, |frame| seen(around, frame)),
        Filling::Near => near(around, body),
        Filling::All => around.sights().take(slots).collect(),
    };
    objects.truncate(slots);
    objects
}

fn seen(around: &impl Around, frame: &Frame) -> Vec<Sight> {
    let mut pixels: Vec<(u32, u32)> = Vec::new();
    for record in frame.records() {
        let Thing::Object(ObjectId(object)) = Thing::of_id(record.id) else { continue };
        match pixels.iter_mut().find(|(_, other)| *other == object) {
            Some((count, _)) => *count += record.pixels,
            None => pixels.push((record.pixels, object)),
        }
    }
    pixels.sort_by_key(|(count, object)| (std::cmp::Reverse(*count), *object));
    pixels.into_iter().filter_map(|(_, object)| around.sight(object)).collect()
}

fn near(around: &impl Around, body: &Posture) -> Vec<Sight> {
    let at = Vec3::from_array(body.position_m);
    let far = |object: &Sight| (Vec3::from_array(object.position_m) - at).length_squared();
    let mut objects: Vec<(f32, Sight)> = around.sights_in(body.room).map(|object| (far(&object), object)).collect();
    objects.sort_by(|(one, first), (other, second)| one.total_cmp(other).then(first.object.cmp(&second.object)));
    objects.into_iter().map(|(_, object)| object).collect()
}

impl Sensed {
    /// What a body senses once its slots are filled anew; none if it is not there.
    pub fn of(around: &impl Around, body: u32, slots: usize, filling: Filling, frame: Option<&Frame>) -> Option<Self> {
        let body = around.posture(body)?;
        let objects = fill(around, &body, filling, slots, frame);
        let held = body.held.and_then(|held| around.sight(held)).map(|held| held.class);
        let mut sensed = Self {
            body,
            held_class: held.map_or(0, class_number),
            ids: vec![0; slots],
            classes: vec![0; slots],
            positions_m: vec![[0.0; 3]; slots],
            flags: vec![[0; StateFlag::ALL.len()]; slots],
            afforded: vec![0; Choice::all().count() * slots],
        };
        let seen_from = Seer::new(&body);
        for (slot, object) in objects.iter().enumerate() {
            sensed.ids[slot] = cohabit_engine::object_instance_id(ObjectId(object.object));
            sensed.classes[slot] = class_number(object.class);
            sensed.positions_m[slot] = seen_from.place(Vec3::from_array(object.position_m));
            sensed.flags[slot] = StateFlag::ALL.map(|flag| i8::from(StateFlags(object.flags).has(flag)));
        }
        let affordances = around.library().affordances();
        let suits: Vec<u64> = objects.iter().map(|object| affordances.of(object.class, held)).collect();
        for (number, (choice, row)) in Choice::all().zip(sensed.afforded.chunks_mut(slots.max(1))).enumerate() {
            if !choice.takes_slot() {
                row.fill(i8::from(choice.room().is_none_or(|room| around.has_room(room))));
                continue;
            }
            for (suits, afforded) in suits.iter().zip(row) {
                *afforded = i8::from(*suits & (1 << number) != 0);
            }
        }
        Some(sensed)
    }

    /// Which choices suit any of the slots.
    pub fn choices(&self) -> impl Iterator<Item = bool> + '_ {
        self.afforded.chunks(self.ids.len().max(1)).map(|row| row.contains(&1))
    }

    /// Which slots hold something; the first one, if none does: something must be chosen, also by those that need nothing.
    pub fn slots(&self) -> impl Iterator<Item = bool> + '_ {
        let is_empty = self.ids.iter().all(|id| *id == 0);
        self.ids.iter().enumerate().map(move |(slot, id)| *id != 0 || is_empty && slot == 0)
    }

    /// The objects in its slots.
    pub fn objects(&self) -> Vec<ObjectId> {
        self.ids.iter().take_while(|id| **id != 0).map(|id| ObjectId(id - 1)).collect()
    }

    /// The same for Python.
    ///
    /// # Errors
    /// When numpy cannot be imported.
    pub fn into_python(self, py: Python<'_>) -> PyResult<Senses> {
        let slots = self.ids.len();
        let choices = self.afforded.len() / slots.max(1);
        let flags = self.flags.as_flattened();
        Ok(Senses {
            position: Memory::array_of(py, &self.body.position_m, vec![3], "<f4")?.unbind(),
            yaw_rad: self.body.yaw_rad,
            head_pitch_rad: self.body.head_pitch_rad,
            room: self.body.room,
            held_class: self.held_class,
            busy: self.body.busy,
            ids: Memory::array_of(py, &self.ids, vec![slots], "<u4")?.unbind(),
            classes: Memory::array_of(py, &self.classes, vec![slots], "<i8")?.unbind(),
            positions: Memory::array_of(py, &self.positions_m, vec![slots, 3], "<f4")?.unbind(),
            flags: Memory::array_of(py, flags, vec![slots, StateFlag::ALL.len()], "|i1")?.unbind(),
            afforded: Memory::array_of(py, &self.afforded, vec![choices, slots], "|i1")?.unbind(),
        })
    }
}

/// Classes are counted from 1: 0 is none.
fn class_number(class: u16) -> i64 {
    i64::from(class) + 1
}

/// From where a body sees.
struct Seer {
    at_m: Vec3,
    ahead: [f32; 2],
}

impl Seer {
    fn new(body: &Posture) -> Self {
        let (sin, cos) = libm::sincosf(body.yaw_rad);
        Self { at_m: Vec3::from_array(body.position_m), ahead: [cos, sin] }
    }

    /// Ahead, to the left, and up, m.
    fn place(&self, point_m: Vec3) -> [f32; 3] {
        let [cos, sin] = self.ahead;
        let to = point_m - self.at_m;
        [to.x * cos + to.y * sin, to.y * cos - to.x * sin, to.z]
    }
}
