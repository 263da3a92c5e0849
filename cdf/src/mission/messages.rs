//! What people are told and shown during a mission, and how it is read.

use serde::Serialize;
use serde_json::Value;

use super::{
    camera::CameraMovement,
    goals::Named,
    problem::Pointer,
    raw::{Entry, Interactions, Loose, Scalar, Stages},
    reader::Reader,
};
use crate::goal::{Goal, Occasion};

/// Something people are told during the mission.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Message {
    /// When.
    pub when: MessageTime,
    /// What.
    pub text: String,
}

/// When a message is shown, or the camera moves.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum MessageTime {
    /// As the mission begins.
    Beginning,
    /// As this goal is met.
    GoalMet(i64),
    /// As the mission ends.
    Ending,
    /// As this begins to hold of objects, each time.
    Occasion(Occasion),
}

/// Keys under which a message's text is found, the best first.
const TEXT_KEYS: [&str; 6] = ["message", "text", "messages", "content", "dialog", "description"];

/// Keys under which a message's goal is found.
const GOAL_KEYS: [&str; 4] = ["goal_id", "goalId", "goal", "task_id"];

/// One item of a stage: where it stands, what it says, and when it is due.
type Due<'r> = (Pointer, &'r Value, MessageTime);

impl Reader<'_> {
    /// Reads `game_interactions`.
    pub fn interactions(
        &mut self,
        at: &Pointer,
        field: &Loose<Interactions>,
        goals: &[Goal],
        named: &Named<'_>,
    ) -> (Vec<Message>, Vec<CameraMovement>) {
        let Some(interactions) = self.field(at, field, "an object") else { return (Vec::new(), Vec::new()) };
        self.extras(at, interactions);
        let mut movements = Vec::new();
        for (at, item, when) in self.stages(&at.key("camera_movements"), &interactions.camera_movements, goals, named) {
            movements.extend(self.camera_movement(&at, item, when));
        }
        let mut messages = Vec::new();
        for (at, item, when) in self.stages(&at.key("game_messages"), &interactions.game_messages, goals, named) {
            messages.extend(self.message(&at, item, when));
        }
        (messages, movements)
    }

    /// The items of all stages, with when they are due.
    fn stages<'r>(
        &mut self,
        at: &Pointer,
        field: &'r Loose<Stages>,
        goals: &[Goal],
        named: &Named<'_>,
    ) -> Vec<Due<'r>> {
        let Some(stages) = self.field(at, field, "an object") else { return Vec::new() };
        self.extras(at, stages);
        let beginning = self.stage(&at.key("task_beginning"), &stages.task_beginning);
        let mut due: Vec<_> = beginning.into_iter().map(|(at, item)| (at, item, MessageTime::Beginning)).collect();
        for (index, (at, item)) in self.stage(&at.key("task_procedure"), &stages.task_procedure).into_iter().enumerate()
        {
            // What names no goal belongs to the goal of its own number in the list.
            let named = item.as_object().and_then(goal_of);
            match named.or_else(|| goals.get(index).map(|goal| goal.id)) {
                Some(id) if goals.iter().any(|goal| goal.id == id) => due.push((at, item, MessageTime::GoalMet(id))),
                Some(id) => self.error(&at, format!("there is no goal {id}"), None),
                None => self.warn(&at, "it belongs to no goal, and is not shown", None),
            }
        }
        let ending = self.stage(&at.key("task_ending"), &stages.task_ending);
        due.extend(ending.into_iter().map(|(at, item)| (at, item, MessageTime::Ending)));
        for (at, item) in self.stage(&at.key("object_conditions"), &stages.object_conditions) {
            if let Some(entry) = item.as_object() {
                let occasion = self.occasion(&at, entry, None, named);
                due.extend(occasion.map(|occasion| (at, item, MessageTime::Occasion(occasion))));
            } else {
                self.error(&at, "it is not said of which object's state", None);
            }
        }
        due
    }

    fn stage<'r>(&mut self, at: &Pointer, list: &'r Loose<Vec<Value>>) -> Vec<(Pointer, &'r Value)> {
        let items = self.field(at, list, "a list").map_or(&[][..], Vec::as_slice);
        items.iter().enumerate().map(|(index, item)| (at.item(index), item)).collect()
    }

    fn message(&mut self, at: &Pointer, item: &Value, when: MessageTime) -> Option<Message> {
        let text = text_of(item);
        if text.is_none() {
            self.warn(at, "no text is found in the message", Some("write {\"message\": \"...\"}".to_owned()));
        }
        text.map(|text| Message { when, text })
    }
}

/// The text of a message: a text, or the text under the best key of an object, or the texts of a list in lines.
pub(super) fn text_of(item: &Value) -> Option<String> {
    match item {
        Value::String(text) => Some(text.trim().to_owned()).filter(|text| !text.is_empty()),
        Value::Array(items) => {
            let lines: Vec<_> = items.iter().filter_map(text_of).collect();
            (!lines.is_empty()).then(|| lines.join("\n"))
        }
        Value::Object(fields) => TEXT_KEYS.iter().find_map(|key| {
            let mut found = fields.iter().filter(|(field, _)| field.to_lowercase().ends_with(key));
            found.find_map(|(_, value)| text_of(value))
        }),
        _ => None,
    }
}

fn goal_of(fields: &Entry) -> Option<i64> {
    GOAL_KEYS.iter().find_map(|key| Scalar::of(fields.get(*key)?)?.integer())
}
