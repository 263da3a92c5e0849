//! Editors in the page: floor plans of world packs and missions are made, checked, looked at and played, by mouse or by keyboard alone.
//!
//! A [`Document`] is a kind of file: pure, its edits change a text and nothing else, and what the page shows follows from the text. A
//! [`Desk`] has one file with its history and what of it is on the disk; a [`Studio`] draws it; [`EditService`] serves the page of it to
//! whoever has its token. Sessions are a [`Player`]'s to start.
//!
//! - Each edit is checked by what `cohabit check` says of the file; what is wrong is shown at its place, with its remedy.
//! - Of plans, only entries that are changed are written anew: comments, order and layout of all else stay. Missions have no comments; what
//!   the forms do not have stays.
//! - A mission is tried by the planner, and its plan carried out in a world.
//! - Nothing is on the disk before it is saved, and what another program has written there is not lost without a word.
//!
//! This crate never knows sessions and processes, nor who plays in them.

mod desk;
mod document;
mod entries;
mod history;
mod mission;
mod picture;
mod plan;
mod texts;
mod web;

pub use desk::{Desk, Sent, Wish};
pub use document::{Document, Drawn, Tried};
pub use mission::{GoalForm, MissionDocument, MissionEdit, ObjectForm, Words};
pub use picture::{Eye, Studio};
pub use plan::{Item, PlanDocument, PlanEdit, Surface};
pub use web::{EditService, Player};
