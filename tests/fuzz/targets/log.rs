//! Any bytes as a session log: raw, or a sound log changed at some places and cut.

#![no_main]

use std::{path::Path, sync::LazyLock};

use cohabit_cdf::Action;
use cohabit_record::{
    Log, LogWriter,
    entry::{InputEntry, SessionEntry, TickEntry},
};
use libfuzzer_sys::fuzz_target;
use serde_json::json;

static SOUND: LazyLock<Vec<u8>> = LazyLock::new(sound);

/// A short log as the recorder writes it.
fn sound() -> Vec<u8> {
    let path = std::env::temp_dir().join(format!("cohabit-fuzz-{}.mcap", std::process::id()));
    let session = json!({
        "format": SessionEntry::FORMAT,
        "program": "fuzz",
        "session": "s",
        "mission_file": "m.json",
        "mission_text": "{}",
        "seed": 7,
    });
    let session: SessionEntry = serde_json::from_value(session).expect("the entry's own fields");
    let mut writer = LogWriter::create(&path, &session, 1).expect("a temporary file");
    for tick in 1..6 {
        let inputs = vec![InputEntry { command: tick, turn: 1, body: 0, action: Action::LookAround }];
        let entry = TickEntry { tick, digest: format!("{tick:064x}"), wall_nanos: tick, inputs };
        writer.tick(&entry).expect("a temporary file");
    }
    writer.finish().expect("a temporary file");
    let bytes = std::fs::read(&path).expect("a temporary file");
    std::fs::remove_file(&path).expect("a temporary file");
    bytes
}

/// The sound log with changes of three bytes each: two say where, one what; the first says where it is cut.
fn changed(changes: &[[u8; 3]]) -> Vec<u8> {
    let mut bytes = SOUND.clone();
    let place = |[low, high, _]: [u8; 3]| usize::from(u16::from_le_bytes([low, high])) % SOUND.len();
    for change in changes.iter().skip(1) {
        bytes[place(*change)] ^= change[2];
    }
    if let Some(cut) = changes.first().filter(|cut| cut[2] > 127) {
        bytes.truncate(place(*cut));
    }
    bytes
}

fuzz_target!(|bytes: &[u8]| {
    let path = Path::new("fuzzed.mcap");
    let Some((mode, rest)) = bytes.split_first() else { return };
    let parsed = if mode % 2 == 0 { Log::parse(path, rest) } else { Log::parse(path, &changed(rest.as_chunks().0)) };
    match parsed {
        Ok(log) => drop(format!("{log:?}")),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
