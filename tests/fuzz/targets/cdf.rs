//! Any bytes as a mission file: it is read or has a problem, and one that is read can be built, or says why not.

#![no_main]

use std::sync::{Arc, LazyLock};

use cohabit_cdf::{Catalog, Layout, mission::read_mission};
use cohabit_world::World;
use libfuzzer_sys::fuzz_target;

static CATALOG: LazyLock<Arc<Catalog>> = LazyLock::new(|| Arc::new(Catalog::builtin()));

/// Enough for messages, goals and what runs from the start.
const TICKS: u32 = 5;

fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let mission = match read_mission("fuzzed.json", text, &CATALOG) {
        Ok(checked) => checked.mission,
        Err(problems) => {
            assert!(!problems.0.is_empty(), "refused without a word");
            for problem in &problems.0 {
                assert!(!problem.to_string().is_empty());
            }
            return;
        }
    };
    let Ok(layout) = Layout::builtin(&mission.layout) else { return };
    match World::new(Arc::clone(&CATALOG), Arc::new(layout), Arc::new(mission), 1) {
        Ok(mut world) => {
            for _ in 0..TICKS {
                world.step(&[]);
            }
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
