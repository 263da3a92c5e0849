//! Any bytes as a house of ProcTHOR: it is refused in words, or becomes a floor plan that is read.

#![no_main]

use std::sync::LazyLock;

use cohabit_cdf::Layout;
use cohabit_houses::{HouseError, Importer};
use libfuzzer_sys::fuzz_target;

static IMPORTER: LazyLock<Importer> = LazyLock::new(Importer::default);

fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    match IMPORTER.plan("Fuzzed", text) {
        Ok(plan) => assert!(Layout::parse("Fuzzed", &[("Fuzzed.toml", &plan.text)]).is_ok()),
        // What is made of a house is sound, or it is not made.
        Err(HouseError::Faults { faults }) => panic!("{faults:?}"),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
