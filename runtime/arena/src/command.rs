//! Commands as clients write them, read from JSON. Never knows what is in the world.

use cohabit_cdf::{RoomId, Rooms, Status, Verb};
use cohabit_render::Lens;
use serde_json::Value;

use crate::axes::Place;

/// One command of a batch. Objects are still the ids that the client wrote.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// `MoveForward`, `MoveBackward`.
    Move {
        /// Negative is backwards, m.
        distance_m: f32,
    },
    /// `Rotate`.
    Rotate {
        /// Positive is to the right, degrees.
        right_deg: f32,
    },
    /// `LookUp`, `LookDown`.
    Look {
        /// Negative is down, degrees.
        up_deg: f32,
    },
    /// `LookAround`: four pictures.
    LookAround {
        /// What each takes in.
        lens: Lens,
        /// Whether the robot turns around for it.
        turns: bool,
    },
    /// `GoTo`.
    GoTo(Destination),
    /// `PickUp`.
    PickUp {
        /// What.
        object: String,
    },
    /// `Place`.
    Place {
        /// On or into what.
        receptacle: String,
    },
    /// `Interact`.
    Interact {
        /// What to do.
        verb: Verb,
        /// With what: the robot, what it holds, or the sink that fills it.
        source: String,
        /// To what.
        destination: String,
    },
    /// `Highlight`.
    Highlight {
        /// What.
        object: String,
        /// Whether the robot turns to it.
        turns: bool,
        /// And back again.
        turns_back: bool,
    },
    /// `CameraChange`.
    CameraChange(Perspective),
}

/// Where to go.
#[derive(Clone, Debug, PartialEq)]
pub enum Destination {
    /// To an object.
    Object(String),
    /// Into a room.
    Room(RoomId),
    /// To a viewpoint.
    Viewpoint(RoomId, u8),
    /// To a place.
    Place(Place),
    /// To what a pixel of the robot's view shows: columns from the left, rows from the top.
    Pixel([f32; 2]),
}

/// Whose view the pictures show.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum Perspective {
    /// The robot's own.
    #[default]
    First,
    /// That of somebody behind it.
    Third,
}

/// Why a value is no command.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{at}: {problem}")]
pub struct CommandError {
    /// What clients call it.
    pub status: Status,
    /// Where in the message, a JSON pointer.
    pub at: String,
    /// What is wrong and what would be right.
    pub problem: String,
}

/// A side of the pictures, pixels.
pub const SIDE_PX: u32 = 300;
/// The field of view of a look around, if nothing is said, degrees.
const AROUND_DEG: f32 = 100.0;

/// Each command's name, in the order in which a list of them reads best, and how it is read.
type Read = fn(&Fields<'_>) -> Result<Command, CommandError>;
const COMMANDS: [(&str, Read); 12] = [
    ("MoveForward", |fields| Ok(Command::Move { distance_m: fields.magnitude("moveForwardCommand")? })),
    ("MoveBackward", |fields| Ok(Command::Move { distance_m: -fields.magnitude("moveBackwardCommand")? })),
    ("Rotate", |fields| Ok(Command::Rotate { right_deg: fields.magnitude("rotateCommand")? })),
    ("LookUp", |fields| Ok(Command::Look { up_deg: fields.magnitude("panAndLookCommand")? })),
    ("LookDown", |fields| Ok(Command::Look { up_deg: -fields.magnitude("panAndLookCommand")? })),
    ("LookAround", look_around),
    ("GoTo", |fields| fields.inside("goToCommand").and_then(|fields| destination(&fields)).map(Command::GoTo)),
    ("PickUp", |fields| {
        let object = fields.inside("pickUpOrPlaceCommand")?.object("destinationObjectID")?;
        Ok(Command::PickUp { object })
    }),
    ("Place", |fields| {
        let receptacle = fields.inside("pickUpOrPlaceCommand")?.object("destinationObjectID")?;
        Ok(Command::Place { receptacle })
    }),
    ("Interact", interact),
    ("Highlight", highlight),
    ("CameraChange", camera_change),
];

/// What clients call the things that can be done to an object.
pub const VERBS: [(&str, Verb); 10] = [
    ("OPEN", Verb::Open),
    ("CLOSE", Verb::Close),
    ("BREAK", Verb::Break),
    ("SCAN", Verb::Scan),
    ("POUR", Verb::Pour),
    ("TOGGLE", Verb::Toggle),
    ("THROW", Verb::Throw),
    ("FILL", Verb::Fill),
    ("CLEAN", Verb::Clean),
    ("EXAMINE", Verb::Examine),
];

impl Command {
    /// Reads the command at `index` of a batch, in a world with these rooms. Fields that it does not use are not looked at.
    ///
    /// # Errors
    /// [`CommandError`].
    pub fn read(index: usize, value: &Value, rooms: &Rooms) -> Result<Self, CommandError> {
        let fields = Fields { at: format!("/{index}"), value, rooms };
        let name = fields.text("commandType")?;
        match COMMANDS.iter().find(|(known, _)| *known == name) {
            Some((_, read)) => read(&fields),
            None => {
                let known = COMMANDS.map(|(known, _)| known).join(", ");
                let problem = format!("there is no command `{name}`: {known}");
                Err(fields.wrong(Status::InvalidCommand, "commandType", problem))
            }
        }
    }
}

fn look_around(fields: &Fields<'_>) -> Result<Command, CommandError> {
    const GROUP: &str = "lookAroundCommand";
    let fields = if fields.has(GROUP) { &fields.inside(GROUP)? } else { fields };
    let fov_deg = if fields.has("fieldOfView") { fields.number("fieldOfView")? } else { AROUND_DEG };
    let lens = Lens::new(SIDE_PX, SIDE_PX, fov_deg)
        .map_err(|error| fields.wrong(Status::IncorrectActionFormat, "fieldOfView", error.to_string()))?;
    Ok(Command::LookAround { lens, turns: fields.flag("shouldRotate")? })
}

fn destination(fields: &Fields<'_>) -> Result<Destination, CommandError> {
    const KINDS: [&str; 5] = ["instanceIdOfObject", "officeRoom", "goToPoint", "position", "raycast"];
    // Builders of requests write all of them, those unused as null or empty.
    let given: Vec<&str> = KINDS.into_iter().filter(|kind| fields.has(kind)).collect();
    let [kind] = given[..] else {
        let problem = format!("one of {} says where to go: there are {}", KINDS.join(", "), given.len());
        return Err(fields.wrong(Status::IncorrectActionFormat, "", problem));
    };
    match kind {
        "instanceIdOfObject" => fields.object(kind).map(Destination::Object),
        "officeRoom" => {
            let room = fields.text(kind)?;
            fields.rooms.find(room).map(Destination::Room).ok_or_else(|| {
                let known = fields.rooms.listed();
                fields.wrong(Status::InvalidCommand, kind, format!("there is no room `{room}`: {known}"))
            })
        }
        "goToPoint" => {
            let point = fields.text(kind)?;
            viewpoint(point, fields.rooms).ok_or_else(|| {
                let problem = format!("`{point}` is no viewpoint: a room and a number, such as `Lab1_3`");
                fields.wrong(Status::InvalidCommand, kind, problem)
            })
        }
        "position" => {
            let place = fields.inside(kind)?;
            let (x, y, z) = (place.number("x")?, 0.0, place.number("z")?);
            Ok(Destination::Place(Place { x, y, z }))
        }
        _ => fields.pixel(kind).map(Destination::Pixel),
    }
}

fn viewpoint(point: &str, rooms: &Rooms) -> Option<Destination> {
    let (room, number) = point.rsplit_once('_')?;
    Some(Destination::Viewpoint(rooms.find(room)?, number.parse().ok()?))
}

fn interact(fields: &Fields<'_>) -> Result<Command, CommandError> {
    let fields = fields.inside("interactCommand")?;
    let name = fields.text("verb")?;
    let verb = VERBS.iter().find(|(known, _)| known.eq_ignore_ascii_case(name)).map(|(_, verb)| *verb);
    let verb = verb.ok_or_else(|| {
        let known = VERBS.map(|(known, _)| known).join(", ");
        fields.wrong(Status::InvalidCommand, "verb", format!("there is no verb `{name}`: {known}"))
    })?;
    let source = if fields.has("sourceObjectID") { fields.text("sourceObjectID")?.to_owned() } else { String::new() };
    Ok(Command::Interact { verb, source, destination: fields.object("destinationObjectID")? })
}

fn highlight(fields: &Fields<'_>) -> Result<Command, CommandError> {
    let fields = fields.inside("highlightCommand")?;
    let (turns, turns_back) = (fields.flag("shouldRotateToObject")?, fields.flag("shouldRotateBack")?);
    Ok(Command::Highlight { object: fields.object("instanceID")?, turns, turns_back })
}

fn camera_change(fields: &Fields<'_>) -> Result<Command, CommandError> {
    let fields = fields.inside("camChangeCommand")?;
    match fields.text("mode")? {
        "Camera_TAM" => Ok(Command::CameraChange(Perspective::First)),
        "Camera_Regular" => Ok(Command::CameraChange(Perspective::Third)),
        other => {
            let problem = format!("there is no camera `{other}`: Camera_TAM, Camera_Regular");
            Err(fields.wrong(Status::InvalidCommand, "mode", problem))
        }
    }
}

/// The fields of an object, where that is in the message, and the rooms that it may name.
struct Fields<'a> {
    at: String,
    value: &'a Value,
    rooms: &'a Rooms,
}

impl<'a> Fields<'a> {
    fn wrong(&self, status: Status, field: &str, problem: impl Into<String>) -> CommandError {
        let at = if field.is_empty() { self.at.clone() } else { format!("{}/{field}", self.at) };
        CommandError { status, at, problem: problem.into() }
    }

    fn malformed(&self, field: &str, expected: &str) -> CommandError {
        let found = match self.value.get(field) {
            None if !self.value.is_object() => {
                let problem = format!("expected a JSON object, found {}", kind(self.value));
                return self.wrong(Status::IncorrectActionFormat, "", problem);
            }
            None => "nothing",
            Some(value) => kind(value),
        };
        self.wrong(Status::IncorrectActionFormat, field, format!("expected {expected}, found {found}"))
    }

    /// Whether a field is there and says something.
    fn has(&self, field: &str) -> bool {
        let says_nothing = |value: &Value| value.is_null() || value.as_str().is_some_and(str::is_empty);
        self.value.get(field).is_some_and(|value| !says_nothing(value))
    }

    fn inside(&self, field: &str) -> Result<Fields<'a>, CommandError> {
        let value = self.value.get(field).filter(|value| value.is_object());
        let value = value.ok_or_else(|| self.malformed(field, "an object"))?;
        Ok(Fields { at: format!("{}/{field}", self.at), value, rooms: self.rooms })
    }

    fn text(&self, field: &str) -> Result<&'a str, CommandError> {
        self.value.get(field).and_then(Value::as_str).ok_or_else(|| self.malformed(field, "a text"))
    }

    /// An object's id. That there is none, as of a mask that lies on no object, is not the command's form but its sense.
    fn object(&self, field: &str) -> Result<String, CommandError> {
        if self.value.is_object() && !self.has(field) {
            let problem = "no object is named: the mask may lie on none";
            return Err(self.wrong(Status::InvalidObjectClass, field, problem));
        }
        self.text(field).map(str::to_owned)
    }

    /// A number, also one that is written as text.
    fn number(&self, field: &str) -> Result<f32, CommandError> {
        let value = self.value.get(field);
        let number = value.and_then(|value| value.as_f64().or_else(|| value.as_str()?.trim().parse().ok()));
        let number = number.map(|number| number as f32).filter(|number| number.is_finite());
        number.ok_or_else(|| self.malformed(field, "a number"))
    }

    fn flag(&self, field: &str) -> Result<bool, CommandError> {
        if !self.has(field) {
            return Ok(false);
        }
        let value = &self.value[field];
        let written = value.as_str().and_then(|text| text.to_ascii_lowercase().parse().ok());
        value.as_bool().or(written).ok_or_else(|| self.malformed(field, "true or false"))
    }

    /// How far or how much, here or in the group of fields of that name.
    fn magnitude(&self, group: &str) -> Result<f32, CommandError> {
        let grouped = self.has(group) && !self.has("magnitude");
        if grouped { self.inside(group)?.number("magnitude") } else { self.number("magnitude") }
    }

    /// A place in a picture, as `{x, y}` or `[x, y]`.
    fn pixel(&self, field: &str) -> Result<[f32; 2], CommandError> {
        let inner = Fields { at: format!("{}/{field}", self.at), value: &self.value[field], rooms: self.rooms };
        let pixel = match inner.value {
            Value::Array(pair) => match &pair[..] {
                [x, y] => x.as_f64().zip(y.as_f64()).map(|(x, y)| [x as f32, y as f32]),
                _ => None,
            },
            _ => Some([inner.number("x")?, inner.number("y")?]),
        };
        let inside = |pixel: &[f32; 2]| pixel.iter().all(|side| (0.0..SIDE_PX as f32).contains(side));
        pixel.filter(inside).ok_or_else(|| {
            let problem = format!("expected x and y in a picture of {SIDE_PX}x{SIDE_PX} pixels, from its upper left");
            self.wrong(Status::IncorrectActionFormat, field, problem)
        })
    }
}

/// What a value is, for people.
pub const fn kind(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "true or false",
        Value::Number(_) => "a number",
        Value::String(_) => "a text",
        Value::Array(_) => "an array",
        Value::Object(_) => "an object",
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::sync::LazyLock;

    use proptest::prelude::*;
    use serde_json::json;

    use super::*;

    static ROOMS: LazyLock<Rooms> = LazyLock::new(Rooms::builtin);

    fn check(value: Value, expected: Command) {
        assert_eq!(Command::read(0, &value, &ROOMS), Ok(expected), "{value}");
    }

    #[test]
    fn every_command_is_read() {
        let object = || "Bowl_01_1".to_owned();
        check(json!({"commandType": "MoveForward", "magnitude": 1.5}), Command::Move { distance_m: 1.5 });
        check(json!({"commandType": "MoveBackward", "magnitude": 1}), Command::Move { distance_m: -1.0 });
        check(
            json!({"commandType": "Rotate", "magnitude": -45.0, "rotationSpeed": 1.0}),
            Command::Rotate { right_deg: -45.0 },
        );
        check(json!({"commandType": "LookUp", "panAndLookCommand": {"magnitude": 30}}), Command::Look { up_deg: 30.0 });
        check(
            json!({"commandType": "LookDown", "panAndLookCommand": {"magnitude": "30"}}),
            Command::Look { up_deg: -30.0 },
        );
        let lens = |fov| Lens::new(300, 300, fov).unwrap();
        check(
            json!({"commandType": "LookAround", "lookAroundCommand": {"fieldOfView": 90, "shouldRotate": true}}),
            Command::LookAround { lens: lens(90.0), turns: true },
        );
        check(json!({"commandType": "LookAround"}), Command::LookAround { lens: lens(100.0), turns: false });
        let go = |target: Value| json!({"commandType": "GoTo", "goToCommand": target});
        check(go(json!({"instanceIdOfObject": "Bowl_01_1"})), Command::GoTo(Destination::Object(object())));
        check(
            go(json!({"officeRoom": "Lab1", "instanceIdOfObject": ""})),
            Command::GoTo(Destination::Room(RoomId::LAB1)),
        );
        check(
            go(json!({"goToPoint": "Lab2_8", "officeRoom": null})),
            Command::GoTo(Destination::Viewpoint(RoomId::LAB2, 8)),
        );
        let place = Place { x: 1.0, y: 0.0, z: 3.0 };
        check(go(json!({"position": {"x": 1, "y": 2, "z": 3}})), Command::GoTo(Destination::Place(place)));
        check(go(json!({"raycast": {"x": 3, "y": 299}})), Command::GoTo(Destination::Pixel([3.0, 299.0])));
        check(go(json!({"raycast": [3, 4]})), Command::GoTo(Destination::Pixel([3.0, 4.0])));
        let hand = json!({"destinationObjectID": "Bowl_01_1"});
        check(json!({"commandType": "PickUp", "pickUpOrPlaceCommand": hand}), Command::PickUp { object: object() });
        check(json!({"commandType": "Place", "pickUpOrPlaceCommand": hand}), Command::Place { receptacle: object() });
        for (name, verb) in VERBS {
            check(
                json!({"commandType": "Interact", "interactCommand": {"sourceObjectID": "TAM_1",
                    "destinationObjectID": "Bowl_01_1", "verb": name}}),
                Command::Interact { verb, source: "TAM_1".to_owned(), destination: object() },
            );
        }
        check(
            json!({"commandType": "Highlight", "highlightCommand": {"instanceID": "Bowl_01_1",
                "shouldRotateToObject": true, "shouldRotateBack": "False"}}),
            Command::Highlight { object: object(), turns: true, turns_back: false },
        );
        check(
            json!({"commandType": "CameraChange", "camChangeCommand": {"mode": "Camera_Regular"}}),
            Command::CameraChange(Perspective::Third),
        );
    }

    #[test]
    fn what_is_wrong_is_named_with_its_place() {
        let check = |value: Value, status: Status, parts: &[&str]| {
            let error = Command::read(2, &value, &ROOMS).unwrap_err();
            let text = error.to_string();
            assert_eq!(error.status, status, "{text}");
            assert!(parts.iter().all(|part| text.contains(part)), "{text}");
        };
        use Status::{IncorrectActionFormat as Form, InvalidCommand as Sense, InvalidObjectClass as Object};
        check(json!(3), Form, &["/2: expected a JSON object, found a number"]);
        check(json!({}), Form, &["/2/commandType: expected a text, found nothing"]);
        check(json!({"commandType": "Jump"}), Sense, &["/2/commandType", "`Jump`", "MoveForward, "]);
        check(json!({"commandType": "Rotate", "magnitude": "far"}), Form, &["/2/magnitude: expected a number"]);
        check(json!({"commandType": "Rotate", "magnitude": 1e60}), Form, &["/2/magnitude"]);
        check(json!({"commandType": "LookUp", "panAndLookCommand": {}}), Form, &["/2/panAndLookCommand/magnitude"]);
        check(
            json!({"commandType": "LookAround", "lookAroundCommand": {"fieldOfView": 200}}),
            Form,
            &["/2/lookAroundCommand/fieldOfView", "1 to 150"],
        );
        check(json!({"commandType": "GoTo"}), Form, &["/2/goToCommand: expected an object, found nothing"]);
        check(json!({"commandType": "GoTo", "goToCommand": {}}), Form, &["/2/goToCommand: one of", "there are 0"]);
        check(
            json!({"commandType": "GoTo", "goToCommand": {"officeRoom": "Lab1", "goToPoint": "Lab1_1"}}),
            Form,
            &["there are 2"],
        );
        check(json!({"commandType": "GoTo", "goToCommand": {"officeRoom": "Moon"}}), Sense, &["`Moon`: BreakRoom"]);
        check(json!({"commandType": "GoTo", "goToCommand": {"goToPoint": "Lab1"}}), Sense, &["`Lab1_3`"]);
        check(json!({"commandType": "GoTo", "goToCommand": {"raycast": [1, 300]}}), Form, &["raycast", "300x300"]);
        check(json!({"commandType": "PickUp", "pickUpOrPlaceCommand": {}}), Object, &["destinationObjectID", "mask"]);
        check(
            json!({"commandType": "Interact", "interactCommand": {"verb": "EAT", "destinationObjectID": "x"}}),
            Sense,
            &["/2/interactCommand/verb", "`EAT`: OPEN"],
        );
        check(json!({"commandType": "CameraChange", "camChangeCommand": {"mode": "X"}}), Sense, &["Camera_TAM"]);
    }

    /// Values that look like commands, and others.
    fn values() -> impl Strategy<Value = Value> {
        const KEYS: [&str; 12] = [
            "commandType",
            "magnitude",
            "goToCommand",
            "officeRoom",
            "raycast",
            "position",
            "interactCommand",
            "verb",
            "destinationObjectID",
            "lookAroundCommand",
            "fieldOfView",
            "x",
        ];
        let leaf = prop_oneof![
            Just(Value::Null),
            any::<bool>().prop_map(Value::from),
            any::<f64>().prop_map(Value::from),
            prop::sample::select(COMMANDS.map(|(name, _)| name).to_vec()).prop_map(Value::from),
            ".{0,8}".prop_map(Value::from),
        ];
        leaf.prop_recursive(3, 24, 6, |inner| {
            prop_oneof![
                prop::collection::vec(inner.clone(), 0..4).prop_map(Value::from),
                prop::collection::hash_map(prop::sample::select(KEYS.to_vec()), inner, 0..6).prop_map(|fields| {
                    Value::Object(fields.into_iter().map(|(key, value)| (key.to_owned(), value)).collect())
                }),
            ]
        })
    }

    proptest! {
        #[test]
        fn no_value_upsets_it(value in values()) {
            if let Err(error) = Command::read(7, &value, &ROOMS) {
                prop_assert!(error.at.starts_with("/7") && !error.problem.is_empty());
            }
        }
    }
}
