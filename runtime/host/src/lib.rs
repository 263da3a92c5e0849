//! Many sessions on one machine: how many it carries, which of those that are wanted are played, and a page that shows them all.
//!
//! A [`Capacity`] is what was measured with one, two and more sessions at a time, and says how many fit. [`admit`] says whether one
//! more may begin while others are played: pure, by what was measured of them and of the machine. A [`Board`] has a place for each
//! session; [`keep`] starts, watches and ends them, and [`HostService`] serves the page. A [`Guest`] is a client that takes what a
//! page takes, for measurements.
//!
//! - One session begins at a time; the next is admitted once it is known what that one takes.
//! - Where a session misses more ticks than may be, nobody is ended, and nobody is admitted.
//! - Who waits longest is admitted first. Who was stopped and is wanted again waits behind those who wait already.
//! - Whoever opens the page starts and ends sessions, so its link has a token, and so have those of the sessions.
//!
//! This crate never knows how sessions are played, nor how a machine is measured: it asks a [`Starter`] and a [`Gauge`].

mod admission;
mod board;
mod capacity;
mod guest;
mod keeper;
mod web;

pub use admission::{Load, Needs, Running, Wait, admit};
pub use board::{Board, Command, Door, Figures};
pub use capacity::{Capacity, LEAST_PICTURES, MOST_MISSED, Step};
pub use guest::Guest;
pub use keeper::{Gauge, Hosted, Look, Starter, keep};
pub use web::HostService;
