//! Reads what people are told during a mission.

use serde_json::Value;

use super::{
    Message, MessageTime,
    problem::Pointer,
    raw::{Entry, Interactions, Loose, Scalar, Stages},
    reader::Reader,
};
use crate::goal::Goal;

/// Keys under which a message's text is found, the best first.
const TEXT_KEYS: [&str; 6] = ["message", "text", "messages", "content", "dialog", "description"];

/// Keys under which a message's goal is found.
const GOAL_KEYS: [&str; 4] = ["goal_id", "goalId", "goal", "task_id"];

impl Reader<'_> {
    /// Reads `game_interactions`.
    pub fn messages(&mut self, at: &Pointer, field: &Loose<Interactions>, goals: &[Goal]) -> Vec<Message> {
        let Some(interactions) = self.field(at, field, "an object") else { return Vec::new() };
        self.extras(at, interactions);
        let movements_at = at.key("camera_movements");
        if let Some(movements) = self.field(&movements_at, &interactions.camera_movements, "an object")
            && !is_quiet(movements)
        {
            self.warn(&movements_at, "camera movements are not played", None);
        }
        let at = at.key("game_messages");
        let Some(stages) = self.field(&at, &interactions.game_messages, "an object") else { return Vec::new() };
        self.extras(&at, stages);
        self.stages(&at, stages, goals)
    }

    fn stages(&mut self, at: &Pointer, stages: &Stages, goals: &[Goal]) -> Vec<Message> {
        let mut messages = Vec::new();
        for (at, item) in self.stage(&at.key("task_beginning"), &stages.task_beginning) {
            messages.extend(self.message(&at, item, MessageTime::Beginning));
        }
        for (index, (at, item)) in self.stage(&at.key("task_procedure"), &stages.task_procedure).into_iter().enumerate()
        {
            // A message that names no goal belongs to the goal of its own number in the list.
            let named = item.as_object().and_then(goal_of);
            match named.or_else(|| goals.get(index).map(|goal| goal.id)) {
                Some(id) if goals.iter().any(|goal| goal.id == id) => {
                    messages.extend(self.message(&at, item, MessageTime::GoalMet(id)));
                }
                Some(id) => self.error(&at, format!("there is no goal {id}"), None),
                None => self.warn(&at, "the message belongs to no goal, and is not shown", None),
            }
        }
        for (at, item) in self.stage(&at.key("task_ending"), &stages.task_ending) {
            messages.extend(self.message(&at, item, MessageTime::Ending));
        }
        let objects_at = at.key("object_conditions");
        if !self.stage(&objects_at, &stages.object_conditions).is_empty() {
            self.warn(&objects_at, "messages on object conditions are not shown", None);
        }
        messages
    }

    fn stage<'r>(&mut self, at: &Pointer, list: &'r Loose<Vec<Value>>) -> Vec<(Pointer, &'r Value)> {
        let items = self.field(at, list, "a list of messages").map_or(&[][..], Vec::as_slice);
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

fn is_quiet(stages: &Stages) -> bool {
    [&stages.task_beginning, &stages.task_procedure, &stages.task_ending, &stages.object_conditions]
        .into_iter()
        .all(|stage| stage.known().is_none_or(Vec::is_empty))
}

/// The text of a message: a text, or the text under the best key of an object, or the texts of a list in lines.
fn text_of(item: &Value) -> Option<String> {
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
