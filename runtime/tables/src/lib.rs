//! Session logs as tables for statistics, and what they say about the conditions that sessions were played under.
//!
//! [`tables`] makes of many [`Played`] sessions one table each of sessions, turns, actions, goals and
//! answers to questionnaires; a [`Table`] knows
//! the unit and meaning of each of its columns, which [`codebook`] gathers. [`Summary`] compares conditions: means and
//! shares with 95 % intervals, and a least-squares fit of each outcome on the conditions. A session is one observation:
//! turns of one session are no more independent of each other than the person who speaks.
//!
//! Nothing here simulates: all is in the logs. This crate never knows rerun, Arrow or files other than CSV.

mod actions;
mod answers;
mod codebook;
mod csv;
mod fit;
mod goals;
mod interval;
mod played;
mod sessions;
mod summary;
mod table;
mod turns;

pub use self::csv::{CsvError, plain_text, write_csv};
pub use codebook::codebook;
pub use fit::{Fit, Term};
pub use interval::{mean_95, wilson_95};
pub use played::{Played, PlayedError};
pub use summary::{Group, Measure, Summary, SummaryError};
pub use table::{Cell, Field, Kind, Table};

/// All tables of these sessions, of one row a session, a turn, an action, a goal, and an answer to a questionnaire.
#[must_use]
pub fn tables(played: &[Played]) -> Vec<Table> {
    vec![
        sessions::table(played),
        turns::table(played),
        actions::table(played),
        goals::table(played),
        answers::table(played),
    ]
}
