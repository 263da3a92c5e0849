//! What a body senses besides pictures: itself, and the objects that fill its slots.

use cohabit_bus::message::Thing;
use cohabit_cdf::{BodyId, ObjectId, StateFlag};
use cohabit_world::{BodyView, ObjectView, Vec3, World};
use pyo3::prelude::*;

use crate::{choice::Choice, error::bad_argument, frame::Frame, memory::Memory};

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
    body: BodyView,
    held_class: i64,
    objects: Vec<u32>,
    classes: Vec<i64>,
    positions_m: Vec<[f32; 3]>,
    flags: Vec<[i8; StateFlag::ALL.len()]>,
    afforded: Vec<i8>,
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
    /// Whether it still can act.
    alive: bool,
    /// `[slots]` `u4`: the id of each object in the id plane; 0 is an empty slot.
    ids: Py<PyAny>,
    /// `[slots]` `i8`: its class, from 1.
    classes: Py<PyAny>,
    /// `[slots, 3]` `f4`: where it is, seen from the body: ahead, to the left, up, m.
    positions: Py<PyAny>,
    /// `[slots, 25]` `i1`: its states, in the order of `FLAGS`.
    flags: Py<PyAny>,
    /// `[choices, slots]` `i1`: whether its class affords each choice; all ones for choices without an object.
    afforded: Py<PyAny>,
}

/// The objects that fill a body's slots, at most `slots`.
pub fn fill(world: &World, body: BodyId, filling: Filling, slots: usize, frame: Option<&Frame>) -> Vec<ObjectId> {
    let mut objects = match filling {
        Filling::Seen => frame.map_or_else(Vec::new, |frame| seen(world, frame)),
        Filling::Near => near(world, body),
        Filling::All => world.objects().filter(|object| world.exists(object.id)).map(|object| object.id).collect(),
    };
    objects.truncate(slots);
    objects
}

fn seen(world: &World, frame: &Frame) -> Vec<ObjectId> {
    let mut pixels: Vec<(u32, ObjectId)> = Vec::new();
    for record in frame.records() {
        let Thing::Object(object) = Thing::of_id(record.id) else { continue };
        match pixels.iter_mut().find(|(_, other)| *other == object) {
            Some((count, _)) => *count += record.pixels,
            None => pixels.push((record.pixels, object)),
        }
    }
    pixels.sort_by_key(|(count, object)| (std::cmp::Reverse(*count), *object));
    pixels.into_iter().map(|(_, object)| object).filter(|object| world.exists(*object)).collect()
}

fn near(world: &World, body: BodyId) -> Vec<ObjectId> {
    let Some(body) = world.body(body) else { return Vec::new() };
    let in_room = world.objects().filter(|object| object.room == body.room && !object.hidden);
    let mut objects: Vec<(f32, ObjectId)> =
        in_room.map(|object| ((object.position_m - body.position_m).length_squared(), object.id)).collect();
    objects.sort_by(|(one, first), (other, second)| one.total_cmp(other).then(first.cmp(second)));
    objects.into_iter().map(|(_, object)| object).collect()
}

impl Sensed {
    /// What a body senses; none if it is not there.
    pub fn of(world: &World, body: BodyId, slots: usize, filled: &[ObjectId]) -> Option<Self> {
        let body = world.body(body)?;
        let objects: Vec<ObjectView<'_>> = filled.iter().filter_map(|object| world.object(*object)).collect();
        let held = body.held.and_then(|held| world.object(held)).map(|held| held.class);
        let class_number = |class: cohabit_cdf::ClassId| i64::from(class.0) + 1;
        let mut sensed = Self {
            body,
            held_class: held.map_or(0, class_number),
            objects: vec![0; slots],
            classes: vec![0; slots],
            positions_m: vec![[0.0; 3]; slots],
            flags: vec![[0; StateFlag::ALL.len()]; slots],
            afforded: vec![0; Choice::all().count() * slots],
        };
        let seen_from = Seer::new(&body);
        for (slot, object) in objects.iter().enumerate() {
            sensed.objects[slot] = cohabit_engine::object_instance_id(object.id);
            sensed.classes[slot] = class_number(object.class);
            sensed.positions_m[slot] = seen_from.place(object.position_m);
            sensed.flags[slot] = StateFlag::ALL.map(|flag| i8::from(object.flags.has(flag)));
        }
        let catalog = world.catalog();
        let held = held.map(|held| catalog.class(held));
        for (choice, row) in Choice::all().zip(sensed.afforded.chunks_mut(slots.max(1))) {
            if !choice.takes_slot() {
                row.fill(1);
                continue;
            }
            for (object, afforded) in objects.iter().zip(row) {
                *afforded = i8::from(choice.is_afforded(catalog.class(object.class), held));
            }
        }
        Some(sensed)
    }

    /// The same for Python.
    ///
    /// # Errors
    /// When numpy cannot be imported.
    pub fn into_python(self, py: Python<'_>) -> PyResult<Senses> {
        let slots = self.objects.len();
        let choices = self.afforded.len() / slots.max(1);
        let flags = self.flags.as_flattened();
        Ok(Senses {
            position: Memory::array_of(py, &self.body.position_m.to_array(), vec![3], "<f4")?.unbind(),
            yaw_rad: self.body.yaw_rad,
            head_pitch_rad: self.body.head_pitch_rad,
            room: self.body.room as u32,
            held_class: self.held_class,
            busy: self.body.busy,
            alive: self.body.alive,
            ids: Memory::array_of(py, &self.objects, vec![slots], "<u4")?.unbind(),
            classes: Memory::array_of(py, &self.classes, vec![slots], "<i8")?.unbind(),
            positions: Memory::array_of(py, &self.positions_m, vec![slots, 3], "<f4")?.unbind(),
            flags: Memory::array_of(py, flags, vec![slots, StateFlag::ALL.len()], "|i1")?.unbind(),
            afforded: Memory::array_of(py, &self.afforded, vec![choices, slots], "|i1")?.unbind(),
        })
    }
}

/// From where a body sees.
struct Seer {
    at_m: Vec3,
    ahead: [f32; 2],
}

impl Seer {
    fn new(body: &BodyView) -> Self {
        let (sin, cos) = libm::sincosf(body.yaw_rad);
        Self { at_m: body.position_m, ahead: [cos, sin] }
    }

    /// Ahead, to the left, and up, m.
    fn place(&self, point_m: Vec3) -> [f32; 3] {
        let [cos, sin] = self.ahead;
        let to = point_m - self.at_m;
        [to.x * cos + to.y * sin, to.y * cos - to.x * sin, to.z]
    }
}
