//! How a mission wants its robots to start (`simbot_init`), and how it is read.
//!
//! The files at hand leave the list empty; what is read here is every shape in which the format writes the same things
//! elsewhere.

use serde::Serialize;
use serde_json::Value;

use super::{
    problem::Pointer,
    raw::{Entry, Loose},
    reader::Reader,
};
use crate::{
    flag_key::{flag_keys, flag_of_key},
    nearest::did_you_mean,
    room::RoomId,
    state::StateFlag,
};

/// What one item of `simbot_init` asks for.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RobotRequest {
    /// Its name, such as `TAM_1`, if said.
    pub name: Option<String>,
    /// The room where it starts, if said.
    pub room: Option<RoomId>,
    /// The number of the room's viewpoint where it starts, if said.
    pub viewpoint: Option<u8>,
    /// Where it starts, m in the world, if said.
    pub at_m: Option<[f32; 2]>,
    /// The way it faces, degrees counter-clockwise from east, if said.
    pub yaw_deg: Option<f32>,
    /// What it holds, if said.
    pub holds: Option<String>,
    /// States it starts with, such as its face.
    pub flags: Vec<(StateFlag, bool)>,
}

/// The names of what is understood, with those that mean the same.
const FIELDS: [(&str, Field); 22] = [
    ("name", Field::Name),
    ("id", Field::Name),
    ("objectID", Field::Name),
    ("roomLocation", Field::Room),
    ("officeRoom", Field::Room),
    ("room", Field::Room),
    ("goToPoint", Field::Viewpoint),
    ("viewpoint", Field::Viewpoint),
    ("position", Field::Position),
    ("location", Field::Position),
    ("at", Field::Position),
    ("rotation", Field::Yaw),
    ("yaw", Field::Yaw),
    ("heading", Field::Yaw),
    ("rightHandHeldObject", Field::Holds),
    ("heldObject", Field::Holds),
    ("holds", Field::Holds),
    ("holding", Field::Holds),
    ("inventory", Field::Holds),
    ("state", Field::State),
    ("states", Field::State),
    ("mood", Field::Mood),
];

#[derive(Clone, Copy)]
enum Field {
    Name,
    Room,
    Viewpoint,
    Position,
    Yaw,
    Holds,
    State,
    Mood,
}

impl Reader<'_> {
    /// Reads `simbot_init`.
    pub fn robots(&mut self, at: &Pointer, list: &Loose<Vec<Loose<Entry>>>) -> Vec<RobotRequest> {
        let items = self.items(at, list, "an object");
        items.into_iter().map(|(at, entry)| self.robot(&at, entry)).collect()
    }

    fn robot(&mut self, at: &Pointer, entry: &Entry) -> RobotRequest {
        let mut robot = RobotRequest::default();
        for (key, value) in entry {
            let at = at.key(key);
            let field = FIELDS.iter().find(|(name, _)| name.eq_ignore_ascii_case(key)).map(|(_, field)| *field);
            match field {
                _ if is_blank(value) => {}
                Some(field) => self.robot_field(&at, field, value, &mut robot),
                None if flag_of_key(key).is_some() => self.robot_state(&at, key, value, &mut robot),
                None => {
                    let remedy = did_you_mean(key, FIELDS.iter().map(|(name, _)| *name));
                    self.warn(&at, format!("unknown field `{key}` is ignored"), remedy);
                }
            }
        }
        robot
    }

    fn robot_field(&mut self, at: &Pointer, field: Field, value: &Value, robot: &mut RobotRequest) {
        match (field, value) {
            (Field::Position, Value::Object(_) | Value::Array(_)) => {
                robot.at_m = self.point(at, value).map(|[x, y, _]| [x, y]);
            }
            (Field::Yaw, Value::Object(fields)) => {
                let about_up = ["z", "yaw", "y"].iter().find_map(|key| Some((*key, fields.get(*key)?)));
                match about_up {
                    Some((key, value)) => robot.yaw_deg = self.finite(&at.key(key), value),
                    None => self.error(at, "expected an angle in degrees", None),
                }
            }
            (Field::Yaw, value) => robot.yaw_deg = self.finite(at, value),
            (Field::State, Value::Array(items)) => {
                for (index, item) in items.iter().enumerate() {
                    self.robot_field(&at.item(index), field, item, robot);
                }
            }
            (Field::State, Value::Object(fields)) => {
                for (key, value) in fields {
                    self.robot_state(&at.key(key), key, value, robot);
                }
            }
            (Field::Room | Field::Holds, Value::Array(items)) => {
                if let Some(first) = items.first() {
                    self.robot_field(&at.item(0), field, first, robot);
                }
            }
            (field, value) => {
                if let Some(scalar) = self.scalar_of(at, value) {
                    self.robot_text(at, field, &scalar.text(), robot);
                }
            }
        }
    }

    fn robot_text(&mut self, at: &Pointer, field: Field, text: &str, robot: &mut RobotRequest) {
        match field {
            Field::Name => robot.name = Some(text.to_owned()),
            Field::Room => robot.room = self.room(at, text).or(robot.room),
            Field::Holds => {
                self.reference(at, text);
                robot.holds = Some(text.to_owned());
            }
            Field::Viewpoint | Field::Position => {
                if let Some((room, number)) = self.viewpoint(at, text) {
                    robot.room = Some(room);
                    robot.viewpoint = Some(number);
                }
            }
            Field::Mood => {
                let key = format!("is{text}");
                match flag_of_key(&key).filter(|flag| flag.is_mood()) {
                    Some(mood) => robot.flags.push((mood, true)),
                    None => self.unknown(at, "mood", text, ["Neutral", "Happy", "Sad", "Angry", "Scared"]),
                }
            }
            Field::Yaw | Field::State => {
                self.error(at, format!("expected another value than `{text}`"), None);
            }
        }
    }

    fn robot_state(&mut self, at: &Pointer, key: &str, value: &Value, robot: &mut RobotRequest) {
        let Some(flag) = flag_of_key(key) else {
            let remedy = did_you_mean(key, flag_keys());
            return self.error(at, format!("unknown state `{key}`"), remedy);
        };
        let Some(scalar) = self.scalar_of(at, value) else { return };
        robot.flags.extend(self.truth_of(at, &scalar).map(|value| (flag, value)));
    }

    /// A viewpoint such as `Lab1_3`; none and a problem if there is none of that name.
    pub fn viewpoint(&mut self, at: &Pointer, name: &str) -> Option<(RoomId, u8)> {
        let named = name.rsplit_once('_').and_then(|(room, number)| {
            let room = self.catalog.rooms().find(room)?;
            Some((room, number.parse::<u8>().ok().filter(|number| (1..=8).contains(number))?))
        });
        if named.is_none() {
            let remedy = Some("write a room and a number from 1 to 8, such as `Lab1_3`".to_owned());
            self.error(at, format!("unknown viewpoint `{name}`"), remedy);
        }
        named
    }

    /// A point `{x, y, z}` or `[x, y, z]`, m; `z` may be absent.
    pub fn point(&mut self, at: &Pointer, value: &Value) -> Option<[f32; 3]> {
        let coordinates = ["x", "y", "z"];
        let mut point = [0.0; 3];
        for (index, key) in coordinates.iter().enumerate() {
            let (at, found) = match value {
                Value::Object(fields) => (at.key(key), fields.get(*key)),
                Value::Array(items) => (at.item(index), items.get(index)),
                _ => (at.clone(), None),
            };
            match found {
                Some(found) => point[index] = self.finite(&at, found)?,
                None if *key == "z" => {}
                None => {
                    self.error(&at, format!("the point has no {key}"), None);
                    return None;
                }
            }
        }
        Some(point)
    }

    /// A number that a place, an angle or a duration can have.
    pub fn finite(&mut self, at: &Pointer, value: &Value) -> Option<f32> {
        let scalar = self.scalar_of(at, value)?;
        let number = scalar.number().filter(|number| number.abs() <= 10_000.0);
        if number.is_none() {
            self.error(at, format!("expected a number, found `{}`", scalar.text()), None);
        }
        #[allow(clippy::cast_possible_truncation, reason = "at most 10000")]
        number.map(|number| number as f32)
    }
}

/// Whether nothing is said.
pub(super) fn is_blank(value: &Value) -> bool {
    match value {
        Value::Null => true,
        Value::String(text) => text.trim().is_empty(),
        Value::Array(items) => items.is_empty(),
        Value::Object(fields) => fields.is_empty(),
        Value::Bool(_) | Value::Number(_) => false,
    }
}
