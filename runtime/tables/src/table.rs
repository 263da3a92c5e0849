//! A table whose columns say what they hold.

use std::borrow::Cow;

/// A table.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Its name, and that of its file.
    pub name: &'static str,
    /// What a row is.
    pub meaning: &'static str,
    /// Its columns.
    pub fields: Vec<Field>,
    /// Its rows, each with a cell a column.
    pub rows: Vec<Vec<Cell>>,
}

/// A column.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Its name.
    pub name: Cow<'static, str>,
    /// What kind of values it holds.
    pub kind: Kind,
    /// Their unit; empty where they have none.
    pub unit: &'static str,
    /// What they mean.
    pub meaning: Cow<'static, str>,
}

/// What kind of values a column holds, beside nothing at all.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Kind {
    /// Text.
    Text,
    /// Whole numbers.
    Whole,
    /// Real numbers.
    Real,
    /// Yes or no.
    Flag,
}

/// One value.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// There is none.
    Nothing,
    /// Text.
    Text(String),
    /// A whole number.
    Whole(i64),
    /// A real number.
    Real(f64),
    /// Yes or no.
    Flag(bool),
}

impl Field {
    /// A column of a table that always has it.
    pub(crate) const fn new(name: &'static str, kind: Kind, unit: &'static str, meaning: &'static str) -> Self {
        Self { name: Cow::Borrowed(name), kind, unit, meaning: Cow::Borrowed(meaning) }
    }
}

impl Kind {
    /// As codebooks call it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Text => "text",
            Self::Whole => "whole number",
            Self::Real => "real number",
            Self::Flag => "true or false",
        }
    }
}

impl Table {
    /// The cells of a column; none if there is no such column.
    pub fn column<'a>(&'a self, name: &str) -> impl Iterator<Item = &'a Cell> + 'a {
        let at = self.fields.iter().position(|field| field.name == name);
        self.rows.iter().filter_map(move |row| row.get(at?))
    }
}

impl Cell {
    /// Text, unless there is none.
    pub(crate) fn text(text: impl Into<String>) -> Self {
        let text = text.into();
        if text.is_empty() { Self::Nothing } else { Self::Text(text) }
    }

    /// A count or number.
    pub(crate) fn whole(number: impl TryInto<i64>) -> Self {
        number.try_into().map_or(Self::Nothing, Self::Whole)
    }

    /// What is perhaps there.
    pub(crate) fn maybe<T>(value: Option<T>, cell: impl FnOnce(T) -> Self) -> Self {
        value.map_or(Self::Nothing, cell)
    }
}
