//! Annotations by people: they watch segments of a data set of demonstrations, write the instruction for each, ask questions about
//! it, and answer those of others.
//!
//! A [`Board`] says who is asked what: pure, without clocks and files. A [`Desk`] has a data set with its board and its journal;
//! [`AnnotateService`] serves it to browsers. [`agreement`] says how alike people's texts are, and [`export()`] writes them into the
//! episodes of the data set.
//!
//! - Nobody is asked the same twice, nor to answer their own question, nor to ask about their own instruction.
//! - An annotation is on the disk before its page hears that it is saved. A line that was cut off was never said to be saved.
//! - Who has taken a task keeps it as long as their page gives a sign of them; then it goes to somebody else.
//! - A correction is a line of its own: what was written first stays in the journal.
//!
//! In: a folder of `cohabit demonstrate`. Out, in the same folder:
//!
//! | in it | what it is |
//! |---|---|
//! | `annotations/journal.jsonl` | a line for each annotation, by pseudonym |
//! | `annotations/links.json` | the tokens of the annotators' pages, for this user alone |
//! | `annotations/agreement.csv` | how alike the annotations are |
//! | `episodes/NNNNNN/episode.json` | with `human`, once they are exported |
//!
//! This crate never knows the world, nor how demonstrations are made.

pub mod agreement;
mod assign;
mod desk;
mod error;
mod export;
mod film;
mod journal;
mod links;
mod task;
mod web;

pub use assign::{Board, Claim, Settings};
pub use desk::{Desk, Refused};
pub use error::AnnotateError;
pub use export::{Exported, export};
pub use film::{Cut, Films};
pub use journal::Journal;
pub use links::{Links, pseudonyms};
pub use task::{Annotation, Kind, Reading, Reason, Segment, Task, Unit, What};
pub use web::AnnotateService;

use std::path::{Path, PathBuf};

/// Where annotations are in a data set.
fn folder(dataset: &Path) -> PathBuf {
    dataset.join("annotations")
}

/// Where the journal of a data set is.
#[must_use]
pub fn journal_path(dataset: &Path) -> PathBuf {
    folder(dataset).join("journal.jsonl")
}

/// Where the tokens of a data set's annotators are.
#[must_use]
pub fn links_path(dataset: &Path) -> PathBuf {
    folder(dataset).join("links.json")
}

/// Where the agreement of a data set's annotations is written.
#[must_use]
pub fn agreement_path(dataset: &Path) -> PathBuf {
    folder(dataset).join("agreement.csv")
}
