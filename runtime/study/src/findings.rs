//! What is wrong in a study's file, gathered with its place in the text; and the walk that holds the file against its shape.

use std::ops::Range;

use cohabit_cdf::mission::{Pointer, Problem, Problems, Severity};
use toml::{
    Spanned,
    de::{DeTable, DeValue},
};

use crate::shape::{Key, Kind};

/// Problems of one file.
pub(crate) struct Findings<'a> {
    file: &'a str,
    text: &'a str,
    problems: Vec<Problem>,
}

impl<'a> Findings<'a> {
    /// None yet.
    pub(crate) fn new(file: &'a str, text: &'a str) -> Self {
        Self { file, text, problems: Vec::new() }
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

    /// Whether there is none.
    pub(crate) fn is_empty(&self) -> bool {
        self.problems.is_empty()
    }

    /// All of them, in the order of the text.
    pub(crate) fn into_problems(mut self) -> Problems {
        self.problems.sort_by_key(|problem| problem.position);
        self.problems.dedup();
        Problems(self.problems)
    }

    /// Holds a table against its keys.
    pub(crate) fn check_table(&mut self, table: &DeTable<'_>, span: &Range<usize>, keys: &[Key], at: &Pointer) {
        for (name, value) in table {
            let place = at.key(name.get_ref());
            match keys.iter().find(|key| key.name == name.get_ref()) {
                Some(key) => self.check_value(value, key, &place),
                None => {
                    let known: Vec<&str> = keys.iter().map(|key| key.name).collect();
                    let message = format!("there is no key `{}` here", name.get_ref());
                    self.add(name.span(), &place, message, format!("the keys are {}", known.join(", ")));
                }
            }
        }
        for key in keys.iter().filter(|key| key.required && !table.keys().any(|name| name.get_ref() == key.name)) {
            let remedy = format!("add {}: {}", key.kind.wanted(), key.meaning);
            self.add(span.clone(), at, format!("`{}` is missing", key.name), remedy);
        }
    }

    fn check_value(&mut self, value: &Spanned<DeValue<'_>>, key: &Key, at: &Pointer) {
        match (key.kind, value.get_ref()) {
            (Kind::Table(keys), DeValue::Table(table)) => self.check_table(table, &value.span(), keys, at),
            (Kind::Tables(keys), DeValue::Array(list)) if !list.is_empty() => {
                for (index, item) in list.iter().enumerate() {
                    match item.get_ref() {
                        DeValue::Table(table) => self.check_table(table, &item.span(), keys, &at.item(index)),
                        _ => self.is_other(item, key, &at.item(index)),
                    }
                }
            }
            (Kind::Settings, DeValue::Table(table)) => {
                for (name, setting) in table.iter().filter(|(_, setting)| !is_setting(setting.get_ref())) {
                    let remedy = "write a text, a number, true or false, or a list of these";
                    self.add(setting.span(), &at.key(name.get_ref()), "this is no value of a flag", remedy);
                }
            }
            (Kind::Texts, DeValue::Array(list)) => {
                let texts = |item: &&Spanned<DeValue<'_>>| !item.get_ref().as_str().is_some_and(is_text);
                list.iter().filter(texts).for_each(|item| self.is_other(item, key, at));
            }
            (kind, value) if is_of(kind, value) => {}
            _ => self.is_other(value, key, at),
        }
    }

    fn is_other(&mut self, value: &Spanned<DeValue<'_>>, key: &Key, at: &Pointer) {
        let message = format!("`{}` cannot be this {}", key.name, value.get_ref().type_str());
        self.add(value.span(), at, message, format!("write {}", key.kind.wanted()));
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
        Kind::Minutes => {
            let text = value.as_integer().map(|number| number.as_str());
            let text = text.or_else(|| value.as_float().map(|number| number.as_str()));
            text.and_then(|text| text.parse().ok()).is_some_and(|minutes: f64| minutes > 0.0 && minutes.is_finite())
        }
        Kind::OneOf(words) => value.as_str().is_some_and(|word| words.contains(&word)),
        _ => false,
    }
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
