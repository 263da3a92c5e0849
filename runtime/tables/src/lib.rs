//! Session logs as tables for statistics, and what they say about the conditions that sessions were played under.
//!
//! [`tables`] makes of many [`Played`] sessions one table each of sessions, turns, actions, goals and
//! answers to questionnaires; a [`Table`] knows
//! the unit and meaning of each of its columns, which [`codebook`] gathers. [`Summary`] compares conditions: means and
//! shares with 95 % intervals, a fit of each outcome on the conditions, and effect sizes. Turns of one session are not
//! independent of each other, so a session is one observation; nor are sessions of one participant, so where participants have
//! several, the fit is a linear mixed model with a random intercept for each ([`MixedModel`]). [`plots`] draws outcomes by
//! condition, and [`power`] tells how many participants a planned study needs.
//!
//! How robots and people moved around each other is told where it was worked out before ([`Played::with_movement`]).
//!
//! Nothing here simulates sessions: all is in the logs. This crate never knows rerun, Arrow or files other than CSV and Parquet.

mod actions;
mod answers;
mod chance;
mod codebook;
mod columns;
mod csv;
mod decisions;
mod design;
pub mod effect;
mod fit;
mod goals;
mod interval;
pub mod mixed;
mod parquet;
mod played;
mod plot;
pub mod power;
mod sessions;
mod social;
mod summary;
mod table;
mod turns;

pub use self::{
    csv::{CsvError, plain_text, write_csv},
    parquet::{ParquetFileError, write_parquet},
};
pub use chance::Chance;
pub use codebook::codebook;
pub use columns::{Align, columns};
pub use fit::{ConditionTest, Fit, Observation, RandomIntercept, Term};
pub use interval::{mean_95, wilson_95};
pub use mixed::{MixedError, MixedModel};
pub use played::{Deed, Played, PlayedError, Turn};
pub use plot::{Plot, plots};
pub use summary::{Effect, Group, Measure, Summary, SummaryError};
pub use table::{Cell, Field, Kind, Table};

/// A Python script that reads the tables from its own folder into pandas, for notebooks.
pub const NOTEBOOK: &str = include_str!("notebook.py");

/// All tables of these sessions, of one row a session, a turn, an action, a goal, and an answer to a questionnaire; where a wizard took
/// part, also a decision; where it is known how bodies moved, also a pair of a robot and a person.
#[must_use]
pub fn tables(played: &[Played]) -> Vec<Table> {
    let has_wizard = played.iter().any(Played::has_wizard);
    let whole = [
        sessions::table(played),
        turns::table(played),
        actions::table(played),
        goals::table(played),
        answers::table(played),
    ];
    let has_movement = played.iter().any(|one| one.movement.is_some());
    let decisions = has_wizard.then(|| decisions::table(played));
    let social = has_movement.then(|| social::table(played));
    whole.into_iter().chain(decisions).chain(social).collect()
}
