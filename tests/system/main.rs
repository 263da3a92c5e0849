//! Whole sessions in real processes.
#![allow(clippy::unwrap_used, missing_docs)]

mod accessibility;
mod annotate;
mod arena;
mod bad_input;
mod benchmark;
mod bridge;
mod browser;
mod check;
mod convert;
mod determinism;
mod doctor;
mod driving;
mod edit;
mod eval;
mod export;
mod faults;
mod generate;
mod guide;
mod host;
mod https;
mod interpreter;
mod languages;
mod lock_step;
mod mcap;
mod missions;
mod origins;
mod pddl;
mod privacy;
mod recording;
mod restarts;
mod searching;
mod self_test;
mod sessions;
mod several;
mod soak;
mod steps;
mod study;
mod survey;
mod time;
mod untrusted;
mod vision;
mod voice;
mod wizard;
mod world;

/// The binary under test.
const COHABIT: &str = env!("CARGO_BIN_EXE_cohabit");
