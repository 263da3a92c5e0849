//! What was measured of this machine, kept for the next command of the same program.

use std::{
    fs, io,
    path::PathBuf,
    time::{SystemTime, UNIX_EPOCH},
};

use cohabit_host::Capacity;
use serde_json::{Value, json};

use super::processes::cores;
use crate::{build, sessions, terminal::shown};

/// An estimate counts for so long, s: what else keeps a machine busy changes from day to day.
const ESTIMATES_COUNT_S: u64 = 24 * 60 * 60;

fn path() -> PathBuf {
    sessions::data_folder().join("capacity.json")
}

fn now_s() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_secs()
}

/// What was noted, if it counts yet.
pub fn known() -> Option<Capacity> {
    let document = serde_json::from_slice(&fs::read(path()).ok()?).ok()?;
    counting(&document, &build::id()?, cores(), now_s())
}

/// What a document says, if it is of this build on as many cores, and not too old.
fn counting(document: &Value, build: &str, cores: usize, now_s: u64) -> Option<Capacity> {
    let capacity: Capacity = serde_json::from_value(document["capacity"].clone()).ok()?;
    let age_s = now_s.saturating_sub(document["at_s"].as_u64()?);
    let is_of_this = document["build"] == build && capacity.cores == cores;
    (is_of_this && (!capacity.is_estimate || age_s < ESTIMATES_COUNT_S)).then_some(capacity)
}

/// Notes what was measured. That it cannot be kept costs the next command some seconds, and no more.
pub fn note(capacity: &Capacity) {
    let Some(build) = build::id() else { return };
    let document = json!({ "build": build, "at_s": now_s(), "capacity": capacity });
    if let Err(error) = write(&document) {
        eprintln!("cohabit: {}: {error}", shown(path().display()));
    }
}

fn write(document: &Value) -> io::Result<()> {
    let path = path();
    path.parent().map_or(Ok(()), fs::create_dir_all)?;
    // Another command that reads it meanwhile reads all of it.
    let new = path.with_extension(format!("{}.new", std::process::id()));
    fs::write(&new, format!("{document:#}\n"))?;
    fs::rename(&new, &path)
}

#[cfg(test)]
mod tests {
    use cohabit_host::Step;

    use super::*;

    #[test]
    fn what_was_measured_counts_for_the_same_program_and_cores() {
        let whole = Capacity { cores: 2, steps: vec![Step { sessions: 1, ..Step::default() }], ..Capacity::default() };
        let estimate = Capacity { is_estimate: true, ..whole.clone() };
        let counted = |capacity: &Capacity, build: &str, cores: usize, now_s: u64| {
            let document = json!({ "build": "ab", "at_s": 1000, "capacity": capacity });
            counting(&document, build, cores, now_s)
        };
        let late = 1000 + ESTIMATES_COUNT_S;
        assert_eq!(counted(&whole, "ab", 2, late), Some(whole.clone()));
        assert_eq!(counted(&estimate, "ab", 2, late - 1), Some(estimate.clone()));
        assert_eq!(counted(&estimate, "ab", 2, late), None);
        assert_eq!((counted(&whole, "cd", 2, 1000), counted(&whole, "ab", 4, 1000)), (None, None));
        assert_eq!(counting(&json!({}), "ab", 2, 1000), None);
    }
}
