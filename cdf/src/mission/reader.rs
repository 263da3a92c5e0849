//! What all parts of the reading share: the places to look names up, the problems found, and loose fields made firm.

use std::{cell::OnceCell, collections::BTreeSet};

use serde_json::Value;

use super::{
    problem::{Pointer, Problem, Severity},
    raw::{Fields, Loose, Scalar},
};
use crate::{catalog::Catalog, layout::Layout, nearest::did_you_mean};

/// One reading of one file.
pub(super) struct Reader<'a> {
    /// The file, for messages.
    pub file: &'a str,
    /// The objects there are.
    pub catalog: &'a Catalog,
    /// The mission's layout, once it is known.
    pub layout: Option<&'a Layout>,
    /// Keeps that layout, if it is one of a world pack.
    pub kept: &'a OnceCell<Layout>,
    /// The instances that the mission lists, in the order of the file.
    pub listed: Vec<String>,
    /// Whether its list of objects is none, so that nothing is known to be missing.
    pub unlisted_all: bool,
    /// The instances that it seems to mean by names that are unknown.
    pub misspelt: Vec<String>,
    /// Names of conditions that could not be read: what is wrong with them is said once.
    pub unreadable: Vec<String>,
    /// The conditions for objects to be there, by their index among the objects: they may name what comes later.
    pub object_conditions: Vec<(usize, Pointer, Value)>,
    /// Names of conditions that something of the mission names.
    pub named_conditions: BTreeSet<String>,
    /// Where in the file what was read stands.
    pub places: Places,
    /// What is wrong so far.
    pub problems: Vec<Problem>,
}

/// Where in a file the parts of its mission stand, in their order in the mission.
#[derive(Default)]
pub(super) struct Places {
    pub objects: Vec<Pointer>,
    pub goals: Vec<GoalPlaces>,
    pub conditions: Vec<Pointer>,
}

/// Where a goal stands, and each of its states.
pub(super) struct GoalPlaces {
    pub goal: Pointer,
    pub states: Vec<Pointer>,
}

impl<'a> Reader<'a> {
    pub fn new(file: &'a str, catalog: &'a Catalog, kept: &'a OnceCell<Layout>) -> Self {
        Self {
            file,
            catalog,
            layout: None,
            kept,
            listed: Vec::new(),
            unlisted_all: false,
            misspelt: Vec::new(),
            unreadable: Vec::new(),
            object_conditions: Vec::new(),
            named_conditions: BTreeSet::new(),
            places: Places::default(),
            problems: Vec::new(),
        }
    }

    /// Notes a problem that keeps the mission from being played.
    pub fn error(&mut self, at: &Pointer, message: impl Into<String>, remedy: Option<String>) {
        self.push(Severity::Error, at, message.into(), remedy);
    }

    /// Notes a problem that does not.
    pub fn warn(&mut self, at: &Pointer, message: impl Into<String>, remedy: Option<String>) {
        self.push(Severity::Warning, at, message.into(), remedy);
    }

    /// Notes that no `kind` has this name, and which of `known` may be meant.
    pub fn unknown<'k>(
        &mut self,
        at: &Pointer,
        kind: &str,
        name: &str,
        known: impl IntoIterator<Item = &'k str> + Clone,
    ) {
        let remedy = did_you_mean(name, known.clone()).or_else(|| one_of(known));
        self.error(at, format!("unknown {kind} `{name}`"), remedy);
    }

    fn push(&mut self, severity: Severity, at: &Pointer, message: String, remedy: Option<String>) {
        let one_line = |text: String| text.replace(|c: char| c.is_control(), " ");
        self.problems.push(Problem {
            severity,
            file: self.file.to_owned(),
            position: None,
            pointer: at.clone(),
            message: one_line(message),
            remedy: remedy.map(one_line),
        });
    }

    /// Warns of the fields of `record` that the format does not know.
    pub fn extras<T: Fields>(&mut self, at: &Pointer, record: &T) {
        for key in record.extra().keys() {
            let remedy = did_you_mean(key, T::NAMES.iter().copied());
            self.warn(&at.key(key), format!("unknown field `{key}` is ignored"), remedy);
        }
    }

    /// The field's value; an unexpected shape is a problem.
    pub fn field<'r, T>(&mut self, at: &Pointer, field: &'r Loose<T>, expected: &str) -> Option<&'r T> {
        if let Some(found) = field.misfit() {
            let other = if found.is_array() && expected.starts_with("a list") { " with other items" } else { "" };
            self.error(at, format!("expected {expected}, found {}{other}", shape(found)), None);
        }
        field.known()
    }

    /// The items of a list that have the expected shape, each with its place; the others are problems.
    pub fn items<'r, T>(
        &mut self,
        at: &Pointer,
        list: &'r Loose<Vec<Loose<T>>>,
        expected: &str,
    ) -> Vec<(Pointer, &'r T)> {
        let items = self.field(at, list, "a list").map_or(&[][..], Vec::as_slice);
        let mut firm = Vec::with_capacity(items.len());
        for (index, item) in items.iter().enumerate() {
            let at = at.item(index);
            if let Some(item) = self.field(&at, item, expected) {
                firm.push((at, item));
            }
        }
        firm
    }

    /// The text of a field; none if it is absent or blank.
    pub fn text(&mut self, at: &Pointer, field: &Loose<Scalar>) -> Option<String> {
        self.field(at, field, "a text").map(Scalar::text).filter(|text| !text.is_empty())
    }

    /// The truth of a field; `otherwise` if it is absent, blank or wrong.
    pub fn truth(&mut self, at: &Pointer, field: &Loose<Scalar>, otherwise: bool) -> bool {
        let Some(scalar) = self.field(at, field, "true or false") else { return otherwise };
        if scalar.text().is_empty() {
            return otherwise;
        }
        self.truth_of(at, scalar).unwrap_or(otherwise)
    }

    /// The truth of a scalar; none and a problem if it has none.
    pub fn truth_of(&mut self, at: &Pointer, scalar: &Scalar) -> Option<bool> {
        let truth = scalar.truth();
        if truth.is_none() {
            self.error(at, format!("expected true or false, found `{}`", scalar.text()), None);
        }
        truth
    }

    /// The scalar in `value`; none and a problem if it is a list, an object or null.
    pub fn scalar_of(&mut self, at: &Pointer, value: &Value) -> Option<Scalar> {
        let scalar = Scalar::of(value);
        if scalar.is_none() {
            self.error(at, format!("expected a value, found {}", shape(value)), None);
        }
        scalar
    }

    /// The whole number of a field, if it is there.
    pub fn integer(&mut self, at: &Pointer, field: &Loose<Scalar>) -> Option<i64> {
        let scalar = self.field(at, field, "a whole number")?;
        if scalar.text().is_empty() {
            return None;
        }
        self.integer_of(at, scalar)
    }

    /// The whole number of a scalar; none and a problem if it is none.
    pub fn integer_of(&mut self, at: &Pointer, scalar: &Scalar) -> Option<i64> {
        let integer = scalar.integer();
        if integer.is_none() {
            self.error(at, format!("expected a whole number, found `{}`", scalar.text()), None);
        }
        integer
    }

    /// The first text of a list, with its place: of `["Lab1"]`, also of `"Lab1"`. Further ones are warned of.
    pub fn first_text(&mut self, at: &Pointer, list: &Loose<Vec<Scalar>>) -> Option<(Pointer, String)> {
        if let Loose::Else(Value::String(text)) = list {
            return Some((at.clone(), text.trim().to_owned())).filter(|(_, text)| !text.is_empty());
        }
        let texts = self.field(at, list, "a list of texts")?;
        if texts.len() > 1 {
            self.warn(&at.item(1), "only the first is used", None);
        }
        texts.first().map(|text| (at.item(0), text.text())).filter(|(_, text)| !text.is_empty())
    }
}

/// What shape a value has, in words.
pub(super) fn shape(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "true or false",
        Value::Number(_) => "a number",
        Value::String(_) => "a text",
        Value::Array(_) => "a list",
        Value::Object(_) => "an object",
    }
}

/// A remedy that lists what is known, if that is short enough to be read.
pub(super) fn one_of<'k>(known: impl IntoIterator<Item = &'k str>) -> Option<String> {
    const MOST: usize = 12;
    let known: Vec<_> = known.into_iter().take(MOST + 1).map(|name| format!("`{name}`")).collect();
    match known.as_slice() {
        [] => None,
        [only] => Some(format!("there is only {only}")),
        names if names.len() > MOST => None,
        names => Some(format!("it is one of {}", names.join(", "))),
    }
}
