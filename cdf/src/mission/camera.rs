//! Movements of the camera that a mission plays, and how they are read.
//!
//! The files at hand leave their lists empty; read is what says where to look, in the words that the format and its
//! clients use for places.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::{MessageTime, messages::text_of, occasion::member, problem::Pointer, raw::Entry, reader::Reader};
use crate::{goal::InstancePattern, room::RoomId};

/// How long the camera stays where nothing is said, s: long enough to see what is shown.
const STAY_S: f32 = 3.0;

/// A movement of the camera that people watch.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CameraMovement {
    /// When it begins.
    pub when: MessageTime,
    /// What is shown.
    pub view: CameraView,
    /// How long it is shown, s.
    pub duration_s: f32,
    /// What is written below it, if anything.
    pub text: Option<String>,
}

/// What a camera turns to.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub enum CameraView {
    /// An object.
    Object(InstancePattern),
    /// A room.
    Room(RoomId),
    /// What is seen from a viewpoint: its room, and its number from 1.
    Viewpoint(RoomId, u8),
    /// A point, m in the world.
    Point([f32; 3]),
}

/// Keys under which a place or a thing is found that is told by its name.
const NAME_KEYS: [&str; 18] = [
    "target",
    "object",
    "instance",
    "instanceId",
    "instanceIdOfObject",
    "objectID",
    "objectName",
    "lookAt",
    "focus",
    "goToPoint",
    "viewpoint",
    "officeRoom",
    "roomLocation",
    "room",
    "location",
    "cameraName",
    "camera",
    "name",
];

/// Keys under which a point is found.
const POINT_KEYS: [&str; 4] = ["position", "point", "target", "location"];

/// Keys under which a duration is found, with how many of its units make a second.
const DURATION_KEYS: [(&str, f32); 7] = [
    ("duration", 1.0),
    ("durationSeconds", 1.0),
    ("seconds", 1.0),
    ("time", 1.0),
    ("holdTime", 1.0),
    ("durationMs", 1000.0),
    ("milliseconds", 1000.0),
];

impl Reader<'_> {
    /// Reads a movement; none and a warning if it is not said where to look.
    pub fn camera_movement(&mut self, at: &Pointer, item: &Value, when: MessageTime) -> Option<CameraMovement> {
        let nothing = Entry::new();
        let entry = item.as_object().unwrap_or(&nothing);
        let view = match item {
            Value::String(name) => self.view_named(at, name),
            _ => self.view(at, entry),
        };
        let duration_s = self.duration_s(at, entry);
        Some(CameraMovement { when, view: view?, duration_s, text: text_of(item).filter(|_| item.is_object()) })
    }

    fn view(&mut self, at: &Pointer, entry: &Entry) -> Option<CameraView> {
        let point = POINT_KEYS
            .iter()
            .find_map(|key| member(entry, &[key]).filter(|(_, value)| value.is_object() || value.is_array()));
        let name = NAME_KEYS.iter().find_map(|key| {
            let (key, value) = member(entry, &[key])?;
            let first = value.as_array().and_then(|items| items.first()).unwrap_or(value);
            Some((key, first.as_str()?))
        });
        match (name, point) {
            (Some((key, name)), _) => self.view_named(&at.key(key), name),
            (None, Some((key, value))) => self.point(&at.key(key), value).map(CameraView::Point),
            (None, None) => {
                let remedy = Some("write {\"target\": \"Bowl_01_1\"}, or a room or viewpoint".to_owned());
                self.warn(at, "it is not said where the camera looks: nothing is shown", remedy);
                None
            }
        }
    }

    /// A viewpoint, a room or an object by its name.
    fn view_named(&mut self, at: &Pointer, name: &str) -> Option<CameraView> {
        let name = name.trim();
        if let Some(room) = self.catalog.rooms().find(name) {
            return Some(CameraView::Room(room));
        }
        if name.rsplit_once('_').is_some_and(|(room, _)| self.catalog.rooms().find(room).is_some()) {
            return self.viewpoint(at, name).map(|(room, number)| CameraView::Viewpoint(room, number));
        }
        self.reference(at, name);
        Some(CameraView::Object(InstancePattern(name.to_owned())))
    }

    fn duration_s(&mut self, at: &Pointer, entry: &Entry) -> f32 {
        let said = DURATION_KEYS.iter().find_map(|(key, units)| Some((member(entry, &[key])?, units)));
        let Some(((key, value), units)) = said else { return STAY_S };
        let at = at.key(key);
        match self.finite(&at, value) {
            Some(number) if number >= 0.0 => number / units,
            Some(number) => {
                self.error(&at, format!("a duration of {number} is none"), None);
                STAY_S
            }
            None => STAY_S,
        }
    }
}
