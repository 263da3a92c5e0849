//! A study from plan to data: participants, their conditions, their consent, and their sessions.
//!
//! [`StudyFile::check`] reads `study.toml`, and says all that is wrong in it. [`assign()`] says what the participant at a
//! place does: a pure function of study and place. [`Progress`] is where one participant is: a pure state machine, whose
//! events a [`Journal`] holds. [`Registry`] has all participants of a study that runs; [`StudyService`] serves their pages,
//! and [`keep`] their sessions. [`Folder`] is where all of it is written down. [`simulate()`] plays a whole study with simulated
//! people; [`report()`] writes its methods sheet; an [`Instrument`] scores a questionnaire's answers.
//!
//! - Nothing of a person is written down before they agree; their consent is kept apart from their data.
//! - An event is on the disk before anything follows from it. Whoever is killed, and whenever: the participant goes on
//!   where they were, under the conditions that were written down when they enrolled.
//! - A condition that depends on what somebody answers first is assigned once they have, and written down then.
//! - What programs played is marked so in every file, and is never in one folder with what people did.
//! - A participant's page learns nothing about conditions, nor whether a wizard takes part; who has the wizard's link is led to the seats of
//!   sessions, and to nothing else.
//! - Nobody is heard by a microphone who did not tick a box of the consent form that is about that: the session takes no sound,
//!   and keeps none.
//! - Score and clock are shown to participants only where a setting says so; figures for developers never are.
//! - A practice is played under no condition, and exported tables leave it out.
//! - A tutorial goes on until each of its exercises was tried, or its time is up; what was tried, its session tells.
//! - A probe is asked once in a mission, which goes on meanwhile or stands still, and no other one before it is answered.
//! - What is filled in of a questionnaire is kept as it is typed, and is no answer before it is sent.
//! - Two participants of a pair have the same conditions, and play each mission in one session, at a page each; what they answer is each
//!   one's own. Nobody is waited for without end, and who withdraws takes the pair's sessions along.
//! - A mission runs as a session of its own, whose page the participant's page shows within it. How sessions are played
//!   this crate does not know: it asks a [`Player`].
//!
//! The smallest study that ships, from its file to its tables:
//!
//! ```text
//! cohabit study check runtime/study/studies/clarification.toml
//! cohabit study simulate runtime/study/studies/clarification.toml --folder dry-run
//! cohabit study run runtime/study/studies/clarification.toml --folder data
//! cohabit study export --folder data --out tables
//! ```
//!
//! In: `study.toml`, whose keys are a table (`shape.rs`; `cohabit study check --schema` prints it), with the Markdown files
//! and questionnaires that it names. Out: the study's [`Folder`].
//!
//! This crate never knows the world's rules, the bus of a session, or how processes are started.

mod assign;
mod chance;
mod check;
mod company;
mod cycle;
pub mod design;
mod experimenter;
mod findings;
mod folder;
mod instrument;
mod journal;
mod keeper;
mod links;
mod markdown;
mod minimise;
mod pages;
pub mod pair;
mod parameters;
mod plan;
mod probe;
mod progress;
mod records;
mod registry;
mod report;
mod schema;
#[cfg(test)]
mod scratch;
mod session;
pub mod settings;
mod shape;
mod shared;
mod simulate;
pub mod square;
mod tables;
mod tutorial;
mod web;
mod windows;
mod wizard;
mod written;

pub use assign::assign;
pub use check::{Program, StudyError, StudyFile};
pub use cycle::Cycle;
pub use design::Study;
pub use folder::{Consent, Folder, FolderError, Note, Withdrawal};
pub use instrument::{Instrument, Score, Scoring};
pub use journal::{Journal, JournalError};
pub use keeper::keep;
pub use plan::{Plan, PlannedMission, Step, pseudonym};
pub use probe::{Happening, Moment, Probe, Probed};
pub use progress::{Doing, Done, Effect, Ending, Event, Phase, Progress, Refused};
pub use records::Records;
pub use registry::{Registry, StudyFault};
pub use report::{Apparatus, day, report};
pub use schema::schema;
pub use session::{Health, Look, PageAddress, Player, Playing, Wanted};
pub use simulate::{
    Answering, DryRun, Leaving, People, PeopleError, Shift, SimulateError, Simulated, SimulatedMission,
    SimulatedPlayer, SimulatedSession, Speaking, simulate,
};
pub use tables::{DataPackageError, TablesError, all as all_tables, export, is_of_excluded, is_practice};
pub use tutorial::{Activity, Exercise, Tried};
pub use web::{Doors, StudyService, address};
pub use wizard::Wizard;
