//! Doors, passages and windows.

use cohabit_cdf::{
    layout::{Opening, OpeningKind},
    model::Axis,
};
use toml::{Table, Value};

use super::{Work, geometry};
use crate::entries::{List, number, numbers, string};

/// The ids of doors begin so.
const DOOR: &str = "Door_01";
/// Rounding in plan files, m.
const SLACK_M: f32 = 0.002;
/// The narrowest and the widest opening, m.
const WIDTH_M: std::ops::RangeInclusive<f32> = 0.4..=10.0;

const fn kind_name(kind: OpeningKind) -> &'static str {
    match kind {
        OpeningKind::Door => "door",
        OpeningKind::Passage => "passage",
        OpeningKind::Window => "window",
    }
}

/// How wide a new opening is, m.
const fn usual_width_m(kind: OpeningKind) -> f32 {
    match kind {
        OpeningKind::Door => 1.0,
        OpeningKind::Passage => 1.4,
        OpeningKind::Window => 1.2,
    }
}

fn entry(opening: &Opening) -> Table {
    let between = opening.between.iter().map(|room| string(room.id())).collect();
    let pairs = [
        ("kind", string(kind_name(opening.kind))),
        ("between", Value::Array(between)),
        ("at_m", numbers(&opening.at_m)),
        ("width_m", number(opening.width_m)),
        ("wall_runs", string(if opening.wall_runs == Axis::X { "x" } else { "y" })),
    ];
    let door = opening.door.iter().map(|door| ("door", string(door)));
    pairs.into_iter().chain(door).map(|(key, value)| (key.to_owned(), value)).collect()
}

/// Whether an entry is that of an opening.
fn is_entry(opening: &Opening) -> impl Fn(&Table) -> bool {
    let (door, kind, at_m) = (opening.door.clone(), kind_name(opening.kind), opening.at_m);
    move |entry| {
        let text = |key: &str| entry.get(key).and_then(Value::as_str);
        if let Some(door) = &door {
            return text("door") == Some(door.as_str());
        }
        let at = entry.get("at_m").and_then(Value::as_array);
        let is_there = at.is_some_and(|at| {
            let metres = |value: &Value| value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64));
            at.len() == 2
                && at
                    .iter()
                    .zip(at_m)
                    .all(|(value, at)| metres(value).is_some_and(|value| (value as f32 - at).abs() < SLACK_M))
        });
        text("kind") == Some(kind) && is_there
    }
}

impl Work<'_> {
    pub(super) fn add_opening(&mut self, kind: OpeningKind, at_m: [f32; 2]) -> Result<(), String> {
        let width_m = usual_width_m(kind);
        let gap = geometry::gap_at(self.layout, kind, width_m, at_m)?;
        let layout = self.layout;
        let is_free = |name: &String| {
            layout.placement(name).is_none()
                && layout.openings.iter().all(|opening| opening.door.as_ref() != Some(name))
        };
        let door = (1..).map(|number| format!("{DOOR}_{number}")).find(is_free);
        let door = door.filter(|_| kind == OpeningKind::Door);
        let opening = Opening { kind, door, between: gap.between, at_m: gap.at_m, width_m, wall_runs: gap.runs };
        self.text.add(List::Opening, &Value::Table(entry(&opening)))
    }

    pub(super) fn set_opening(&mut self, index: usize, at_m: [f32; 2], width_m: f32) -> Result<(), String> {
        if !WIDTH_M.contains(&width_m) {
            return Err(format!("an opening is {} to {} m wide", WIDTH_M.start(), WIDTH_M.end()));
        }
        let old = self.opening(index)?.clone();
        let gap = geometry::gap_at(self.layout, old.kind, width_m, at_m)?;
        let new = Opening { between: gap.between, at_m: gap.at_m, wall_runs: gap.runs, width_m, ..old.clone() };
        self.put_opening(&old, &new)
    }

    /// Writes an opening in the place of an old one; a door of the base is put over that one.
    pub(super) fn put_opening(&mut self, old: &Opening, new: &Opening) -> Result<(), String> {
        match self.text.find(List::Opening, is_entry(old))? {
            Some(index) => self.text.set(List::Opening, index, entry(new)),
            None if new.door.is_some() => self.text.add(List::Opening, &Value::Table(entry(new))),
            None => Err(of_base(old)),
        }
    }

    pub(super) fn remove_opening(&mut self, index: usize) -> Result<(), String> {
        let opening = self.opening(index)?.clone();
        self.remove_opening_entry(&opening)
    }

    pub(super) fn remove_opening_entry(&mut self, opening: &Opening) -> Result<(), String> {
        match self.text.find(List::Opening, is_entry(opening))? {
            Some(index) => self.text.remove(List::Opening, index),
            None => Err(of_base(opening)),
        }
    }

    fn opening(&self, index: usize) -> Result<&Opening, String> {
        self.layout.openings.get(index).ok_or_else(|| "there is no such opening".to_owned())
    }
}

fn of_base(opening: &Opening) -> String {
    let kind = kind_name(opening.kind);
    format!("this {kind} is one of the base plan, and can be changed there alone")
}
