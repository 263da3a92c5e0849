//! What is wrong in a study's file, gathered with its place in the text; and the walk that holds the file against its shape.

use std::{mem, ops::Range};

use cohabit_cdf::mission::{Pointer, Problem, Problems, Severity};
use toml::{
    Spanned,
    de::{DeTable, DeValue},
};

use crate::shape::{Key, Kind, LONGEST_SECONDS};

/// Problems of one file.
pub(crate) struct Findings<'a> {
    file: &'a str,
    text: &'a str,
    problems: Vec<Problem>,
    /// What cannot be looked at further: values that are none, and keys that are missing.
    unread: Vec<Pointer>,
    /// Whether the text could not be read to its end: then what is not there may be missing or not.
    is_partial: bool,
}

impl<'a> Findings<'a> {
    /// None yet.
    pub(crate) fn new(file: &'a str, text: &'a str) -> Self {
        Self { file, text, problems: Vec::new(), unread: Vec::new(), is_partial: false }
    }

    /// Notes what is wrong at `span`, in bytes of the text, and what to do about it.
    pub(crate) fn add(
        &mut self,
        span: Range<usize>,
        at: &Pointer,
        message: impl Into<String>,
        remedy: impl Into<String>,
    ) {
        self.problems.push(Problem {
            severity: Severity::Error,
            file: self.file.to_owned(),
            position: Some(position(self.text, span.start)),
            pointer: at.clone(),
            message: message.into(),
            remedy: Some(remedy.into()),
        });
    }

    /// Notes what is wrong with the way in which the text is written.
    pub(crate) fn add_syntax(&mut self, span: Range<usize>, message: &str) {
        self.is_partial = true;
        self.add(span, &Pointer::default(), message, "see https://toml.io for how it is written");
    }

    /// Whether there is none.
    pub(crate) fn is_empty(&self) -> bool {
        self.problems.is_empty()
    }

    /// Whether what stands at a place, or should, could not be read, so that nothing follows from what is left.
    pub(crate) fn is_unread(&self, at: &Pointer) -> bool {
        self.unread.contains(at)
    }

    /// All of them, in the order of the text.
    pub(crate) fn into_problems(mut self) -> Problems {
        self.problems.sort_by_key(|problem| problem.position);
        self.problems.dedup();
        Problems(self.problems)
    }

    /// Holds a table against its keys, and takes out of it what is none of their values.
    pub(crate) fn check_table(&mut self, table: &mut DeTable<'_>, span: &Range<usize>, keys: &[Key], at: &Pointer) {
        for key in keys.iter().filter(|key| !table.contains_key(key.name)) {
            self.is_missing(key, span, at);
        }
        let entries = mem::take(table).into_iter().filter_map(|(name, mut value)| {
            let place = at.key(name.get_ref());
            let Some(key) = keys.iter().find(|key| key.name == name.get_ref()) else {
                let known: Vec<&str> = keys.iter().map(|key| key.name).collect();
                let message = format!("there is no key `{}` here", name.get_ref());
                self.add(name.span(), &place, message, format!("the keys are {}", known.join(", ")));
                return None;
            };
            let is_right = self.check_value(&mut value, key, &place);
            if !is_right {
                self.unread.push(place);
            }
            is_right.then_some((name, value))
        });
        *table = entries.collect();
    }

    fn is_missing(&mut self, key: &Key, span: &Range<usize>, at: &Pointer) {
        if key.required || self.is_partial {
            self.unread.push(at.key(key.name));
        }
        if key.required && !(self.is_partial && self.mentions(key.name)) {
            let remedy = format!("add {}: {}", key.kind.wanted(), key.meaning);
            self.add(span.clone(), at, format!("`{}` is missing", key.name), remedy);
        }
    }

    /// Whether the text has such a key anywhere, be it where it cannot be read.
    fn mentions(&self, key: &str) -> bool {
        let is_word = |letter: char| letter.is_alphanumeric() || letter == '_' || letter == '-';
        let is_key = |at: usize| {
            let (before, after) = (&self.text[..at], self.text[at + key.len()..].trim_start_matches([' ', '"']));
            !before.ends_with(is_word) && after.starts_with(['=', ']', '.'])
        };
        self.text.match_indices(key).any(|(at, _)| is_key(at))
    }

    /// Whether a value is one of a key; all that is wrong in it is noted.
    fn check_value(&mut self, value: &mut Spanned<DeValue<'_>>, key: &Key, at: &Pointer) -> bool {
        let span = value.span();
        match (key.kind, value.get_mut()) {
            (Kind::Table(keys), DeValue::Table(table)) => self.check_table(table, &span, keys, at),
            (Kind::Tables(_), DeValue::Array(list)) if list.is_empty() => {
                self.is_other(span, "empty list", key, at);
                return false;
            }
            (Kind::Tables(_) | Kind::Boxes(_) | Kind::Texts, DeValue::Array(list)) => {
                return self.check_items(list, key, at);
            }
            (Kind::Settings, DeValue::Table(table)) => self.check_settings(table, at),
            (kind, value) if is_of(kind, value) => {}
            (_, other) => {
                let kind = other.type_str();
                self.is_other(span, kind, key, at);
                return false;
            }
        }
        true
    }

    /// Whether all items of a list are what its key says: texts, tables, or both.
    fn check_items(&mut self, list: &mut [Spanned<DeValue<'_>>], key: &Key, at: &Pointer) -> bool {
        let mut are_right = true;
        for (index, item) in list.iter_mut().enumerate() {
            let (span, place) = (item.span(), at.item(index));
            match (key.kind, item.get_mut()) {
                (Kind::Tables(keys) | Kind::Boxes(keys), DeValue::Table(table)) => {
                    self.check_table(table, &span, keys, &place);
                }
                (Kind::Boxes(_) | Kind::Texts, DeValue::String(text)) if is_text(text) => {}
                (_, other) => {
                    let kind = other.type_str();
                    self.is_other(span, kind, key, &place);
                    are_right = false;
                }
            }
        }
        are_right
    }

    fn check_settings(&mut self, table: &mut DeTable<'_>, at: &Pointer) {
        let entries = mem::take(table).into_iter().filter(|(name, setting)| {
            let is_right = is_setting(setting.get_ref());
            if !is_right {
                let remedy = "write a text, a number, true or false, or a list of these";
                self.add(setting.span(), &at.key(name.get_ref()), "this is no value of a flag", remedy);
            }
            is_right
        });
        *table = entries.collect();
    }

    fn is_other(&mut self, span: Range<usize>, kind: &str, key: &Key, at: &Pointer) {
        let message = format!("`{}` cannot be this {kind}", key.name);
        self.add(span, at, message, format!("write {}", key.kind.wanted()));
    }
}

fn is_text(text: &str) -> bool {
    !text.trim().is_empty()
}

fn is_of(kind: Kind, value: &DeValue<'_>) -> bool {
    match kind {
        Kind::Text => value.as_str().is_some_and(is_text),
        Kind::Whole(most) => {
            let whole = value.as_integer().and_then(|number| u64::from_str_radix(number.as_str(), number.radix()).ok());
            whole.is_some_and(|number| number <= most)
        }
        Kind::Minutes => number(value).is_some_and(|minutes| minutes > 0.0),
        Kind::Seconds => number(value).is_some_and(|seconds| seconds > 0.0 && seconds <= LONGEST_SECONDS),
        Kind::Share => number(value).is_some_and(|share| (0.0..=1.0).contains(&share)),
        Kind::Numbers => value.as_array().is_some_and(|list| list.iter().all(|item| is_whole(item.get_ref()))),
        Kind::OneOf(words) => value.as_str().is_some_and(|word| words.contains(&word)),
        Kind::Switch => value.is_bool(),
        _ => false,
    }
}

/// A finite number, whole or not.
fn number(value: &DeValue<'_>) -> Option<f64> {
    let text = value.as_integer().map(|number| number.as_str());
    let text = text.or_else(|| value.as_float().map(|number| number.as_str()))?;
    text.parse().ok().filter(|number: &f64| number.is_finite())
}

fn is_whole(value: &DeValue<'_>) -> bool {
    let whole = value.as_integer().map(|number| i32::from_str_radix(number.as_str(), number.radix()));
    whole.is_some_and(|whole| whole.is_ok())
}

fn is_setting(value: &DeValue<'_>) -> bool {
    match value {
        DeValue::Array(list) => list.iter().all(|item| !item.get_ref().is_array() && is_setting(item.get_ref())),
        DeValue::String(_) | DeValue::Integer(_) | DeValue::Float(_) | DeValue::Boolean(_) => true,
        DeValue::Datetime(_) | DeValue::Table(_) => false,
    }
}

/// Line and column of a byte of a text, from 1, the column in characters.
fn position(text: &str, at: usize) -> (usize, usize) {
    let before = text.get(..at).unwrap_or(text);
    let line = before.rsplit_once('\n').map_or(before, |(_, line)| line);
    (before.matches('\n').count() + 1, line.chars().count() + 1)
}
