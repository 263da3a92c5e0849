//! Reads what must hold of objects for a message, a camera movement or an object to appear.
//!
//! The format names states in several ways; all are taken: `{"expression": {..}}`, an expression itself, the name of a
//! condition, `{"object_states": [{"Bowl_01_1": "isHot=true"}]}`, `{"Bowl_01_1": "isHot=true"}`, and
//! `{"object": "Bowl_01_1", "state": "isHot", "value": "true"}`.

use serde_json::Value;

use super::{
    ObjectRequest,
    expression::is_kind,
    goals::Named,
    problem::Pointer,
    raw::{Entry, Loose, Scalar},
    reader::Reader,
    robot::is_blank,
};
use crate::goal::{GoalState, InstancePattern, Occasion, Predicate, Relation};

/// Keys under which an expression, or the name of a condition, is found.
const CONDITION_KEYS: [&str; 5] = ["expression", "condition", "stateName", "stateCondition", "trigger"];

/// Keys under which states as goals name them are found.
const STATES_KEYS: [&str; 3] = ["object_states", "objectStates", "states"];

/// Keys under which the object is found whose state is meant.
const OBJECT_KEYS: [&str; 7] = ["object", "instance", "instanceId", "objectID", "objectName", "context", "name"];

/// Keys under which its state is found.
const STATE_KEYS: [&str; 4] = ["state", "objectState", "object_state", "key"];

impl Reader<'_> {
    /// Reads the conditions for objects to be there, once all that they may name is known.
    pub fn object_conditions(&mut self, objects: &mut [ObjectRequest], named: &Named<'_>) {
        for (index, at, value) in std::mem::take(&mut self.object_conditions) {
            let Some(object) = objects.get_mut(index) else { continue };
            object.condition = match &value {
                Value::Object(entry) => self.occasion(&at, entry, Some(&object.instance), named),
                other => self.occasion_named(&at, other, Some(&object.instance), named),
            };
        }
    }

    /// Reads the occasion in an object; none and a problem if there is none in it.
    pub fn occasion(
        &mut self,
        at: &Pointer,
        entry: &Entry,
        owner: Option<&str>,
        named: &Named<'_>,
    ) -> Option<Occasion> {
        if let Some((key, value)) = member(entry, &STATES_KEYS) {
            return self.occasion_states(&at.key(key), value, entry, named);
        }
        let instance = member(entry, &OBJECT_KEYS).and_then(|(key, value)| Some((key, value.as_str()?.trim())));
        let owner = instance.map(|(_, name)| name).or(owner);
        if let Some((key, value)) = member(entry, &CONDITION_KEYS) {
            return match value {
                Value::Object(inner) if inner.keys().any(|key| is_kind(key)) => {
                    self.expression(&at.key(key), inner).map(Occasion::Expression)
                }
                Value::Object(inner) => self.occasion(&at.key(key), inner, owner, named),
                other => self.occasion_named(&at.key(key), other, owner, named),
            };
        }
        if entry.iter().any(|(key, value)| is_kind(key) && value.is_object() || value.is_array() && is_kind(key)) {
            let kinds = entry.iter().filter(|(key, _)| is_kind(key));
            let kinds: Entry = kinds.map(|(key, value)| (key.clone(), value.clone())).collect();
            return self.expression(at, &kinds).map(Occasion::Expression);
        }
        if let Some((key, value)) = member(entry, &STATE_KEYS)
            && let Some(owner) = owner
        {
            if let Some((key, _)) = instance {
                self.reference(&at.key(key), owner);
            }
            return self.occasion_state(&at.key(key), value, entry, owner, named);
        }
        let named_by_key = |(key, value): &(&String, &Value)| {
            value.as_str().is_some_and(|text| text.contains('=')) && self.catalog.class_of_instance(key).is_some()
        };
        if let Some((key, value)) = entry.iter().find(named_by_key) {
            let state = self.goal_state(&at.key(key), key, value, named)?;
            return Some(Occasion::States(vec![state], Relation::And));
        }
        let remedy = Some("write {\"object_states\": [{\"Bowl_01_1\": \"isHot=true\"}]}".to_owned());
        self.warn(at, "no state of an object is found: it never comes about", remedy);
        None
    }

    /// The name of a condition, or `key=value` of its owner.
    fn occasion_named(
        &mut self,
        at: &Pointer,
        value: &Value,
        owner: Option<&str>,
        named: &Named<'_>,
    ) -> Option<Occasion> {
        let text = self.scalar_of(at, value)?.text();
        let (key, value) = text.split_once('=').unwrap_or((&text, "true"));
        let value = Scalar::Text(value.trim().to_owned());
        let predicate = self.predicate(at, key.trim(), &value, named)?;
        let context = match &predicate {
            Predicate::Condition(name, _) => {
                named.conditions.iter().find(|condition| condition.name == *name).map(|known| known.context.clone())
            }
            _ => None,
        };
        let Some(instance) = owner.map(str::to_owned).or(context) else {
            self.error(at, format!("`{text}` says of no object whose state it is"), None);
            return None;
        };
        Some(state(&instance, predicate))
    }

    fn occasion_states(&mut self, at: &Pointer, value: &Value, entry: &Entry, named: &Named<'_>) -> Option<Occasion> {
        let items = match value {
            Value::Array(items) => items.iter().enumerate().map(|(index, item)| (at.item(index), item)).collect(),
            single => vec![(at.clone(), single)],
        };
        let mut states = Vec::new();
        for (at, item) in items {
            let Value::Object(fields) = item else {
                self.error(&at, "expected a state such as {\"Bowl_01_1\": \"isHot=true\"}", None);
                continue;
            };
            for (instance, value) in fields {
                states.extend(self.goal_state(&at.key(instance), instance, value, named));
            }
        }
        let relation = member(entry, &["object_states_relation", "relation"]).and_then(|(_, value)| Scalar::of(value));
        let relation = self.relation(at, &relation.map_or(Loose::Absent, Loose::As));
        (!states.is_empty()).then_some(Occasion::States(states, relation))
    }

    /// `"isHot=true"`, `"isHot"` with its value beside it, `{"isHot": "true"}`, or a list of these.
    fn occasion_state(
        &mut self,
        at: &Pointer,
        value: &Value,
        entry: &Entry,
        owner: &str,
        named: &Named<'_>,
    ) -> Option<Occasion> {
        let mut pairs = Vec::new();
        let mut gather = |at: &Pointer, value: &Value| match value {
            Value::Object(fields) => {
                pairs.extend(fields.iter().map(|(key, value)| (at.key(key), key.clone(), Scalar::of(value))));
            }
            Value::String(text) => {
                let beside = member(entry, &["value", "stateValue"]).and_then(|(_, value)| Scalar::of(value));
                let (key, value) = match text.split_once('=') {
                    Some((key, value)) => (key, Scalar::Text(value.trim().to_owned())),
                    None => (text.as_str(), beside.unwrap_or(Scalar::Bool(true))),
                };
                pairs.push((at.clone(), key.trim().to_owned(), Some(value)));
            }
            _ => pairs.push((at.clone(), String::new(), None)),
        };
        match value {
            Value::Array(items) => items.iter().enumerate().for_each(|(index, item)| gather(&at.item(index), item)),
            single => gather(at, single),
        }
        let mut states = Vec::new();
        for (at, key, value) in pairs {
            let Some(value) = value else {
                self.error(&at, "expected a state such as `isHot=true`", None);
                continue;
            };
            let instance = InstancePattern(owner.to_owned());
            states.extend(self.predicate(&at, &key, &value, named).map(|predicate| GoalState { instance, predicate }));
        }
        (!states.is_empty()).then_some(Occasion::States(states, Relation::And))
    }
}

fn state(instance: &str, predicate: Predicate) -> Occasion {
    Occasion::States(vec![GoalState { instance: InstancePattern(instance.to_owned()), predicate }], Relation::And)
}

/// The first of `keys`, in any case, under which something is said.
pub(super) fn member<'e>(entry: &'e Entry, keys: &[&str]) -> Option<(&'e str, &'e Value)> {
    keys.iter().find_map(|key| {
        let mut named = entry.iter().filter(|(known, value)| known.eq_ignore_ascii_case(key) && !is_blank(value));
        named.next().map(|(key, value)| (key.as_str(), value))
    })
}
