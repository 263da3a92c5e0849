//! What may come of a session: columns of the table of sessions, as numbers.

use crate::{
    played::Played,
    sessions,
    social::{SESSION_MEASURES, SessionMeasure},
    table::{Cell, Kind},
};

/// Fields of the table of sessions that are outcomes, and what summaries call them.
const FIELDS: [(&str, &str); 9] = [
    ("success", "success"),
    ("actions", "actions"),
    ("failed_actions", "failed actions"),
    ("questions", "questions"),
    ("answered_ms", "answered"),
    ("understood_ms", "understood"),
    ("moved_ms", "moved"),
    ("framed_ms", "framed"),
    ("shown_ms", "shown"),
];

/// How fields of questionnaires begin.
const SCORE: &str = "score_";

/// An outcome of some sessions.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Outcome {
    /// What summaries call it.
    pub name: String,
    /// Its field in the table of sessions.
    pub field: String,
    /// Its unit; empty where it has none.
    pub unit: &'static str,
    /// What it means.
    pub meaning: String,
    /// Whether it is true or false in each session.
    pub is_share: bool,
    /// Its value in each session.
    pub values: Vec<Option<f64>>,
}

impl Outcome {
    /// All outcomes of these sessions: a questionnaire's score each, then, where it is known how bodies moved, how the robot
    /// moved around people.
    pub fn all(played: &[Played]) -> Vec<Self> {
        let table = sessions::table(played);
        let named = |field: &str| {
            let listed = FIELDS.iter().find(|(own, _)| *own == field).map(|(_, name)| (*name).to_owned());
            listed.or_else(|| Some(format!("{} score", field.strip_prefix(SCORE)?)))
        };
        let outcome = |field: &crate::table::Field| {
            Some(Self {
                name: named(&field.name)?,
                field: field.name.to_string(),
                unit: field.unit,
                meaning: field.meaning.to_string(),
                is_share: field.kind == Kind::Flag,
                values: table.column(&field.name).map(number).collect(),
            })
        };
        let moved = played.iter().any(|one| one.movement.is_some());
        let social = SESSION_MEASURES.iter().filter(|_| moved).map(|measure| Self::social(measure, played));
        table.fields.iter().filter_map(outcome).chain(social).collect()
    }

    fn social(measure: &SessionMeasure, played: &[Played]) -> Self {
        Self {
            name: measure.name.to_owned(),
            field: measure.field.to_owned(),
            unit: measure.unit,
            meaning: measure.meaning.to_owned(),
            is_share: false,
            values: played.iter().map(|one| one.movement.as_ref().and_then(measure.value)).collect(),
        }
    }
}

fn number(cell: &Cell) -> Option<f64> {
    match cell {
        Cell::Nothing | Cell::Text(_) => None,
        Cell::Whole(number) => Some(*number as f64),
        Cell::Real(number) => Some(*number),
        Cell::Flag(flag) => Some(f64::from(u8::from(*flag))),
    }
}
