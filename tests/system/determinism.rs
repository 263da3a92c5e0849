//! The same missions with the same seed, in two runs of the program: every tick the same; and a log that was changed is
//! found out.

use std::{collections::BTreeMap, path::Path};

use cohabit_record::{Log, LogWriter};
use cohabit_tests::{Scratch, run};

use crate::COHABIT;

/// Plays the built-in missions by so many worker processes; their logs, by file name.
fn logs(folder: &Scratch, workers: &str) -> BTreeMap<String, Log> {
    let missions = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cdf/missions");
    let into = folder.path(workers);
    let arguments = ["eval", missions.to_str().unwrap(), "--workers", workers, "--seed", "9", "--record", &into];
    let output = run(COHABIT, &arguments).unwrap();
    assert!(output.status.success(), "{output:?}");
    let files = std::fs::read_dir(&into).unwrap().map(|entry| entry.unwrap().path());
    let name = |path: &Path| path.file_name().unwrap().to_str().unwrap().to_owned();
    files.map(|path| (name(&path), Log::open(&path).unwrap())).collect()
}

#[test]
fn two_runs_agree_tick_for_tick() {
    let folder = Scratch::new("determinism-runs");
    let (one, two) = (logs(&folder, "1"), logs(&folder, "2"));
    assert!(one.len() >= 4 && one.keys().eq(two.keys()), "{:?} {:?}", one.keys(), two.keys());
    for (name, log) in &one {
        let other = &two[name];
        assert_eq!(log.ticks.len(), other.ticks.len(), "{name}");
        for (tick, same) in log.ticks.iter().zip(&other.ticks) {
            assert_eq!((tick.tick, &tick.digest), (same.tick, &same.digest), "{name}");
            assert_eq!(tick.inputs, same.inputs, "{name}: tick {}", tick.tick);
        }
    }
}

#[test]
fn a_changed_log_is_found_out_at_the_tick() {
    let folder = Scratch::new("determinism-changed");
    let (_, log) = logs(&folder, "1").pop_first().unwrap();
    // A command that was never given changes what follows; a digest that was never had differs by itself.
    let given = log.ticks.iter().position(|tick| !tick.inputs.is_empty()).unwrap();
    let last = log.ticks.len() - 1;
    for (what, place) in [("command", given), ("digest", last)] {
        let mut ticks = log.ticks.clone();
        match what {
            "command" => ticks[place].inputs.clear(),
            _ => ticks[place].digest = "0".repeat(64),
        }
        let path = folder.path(&format!("{what}.mcap"));
        let mut writer = LogWriter::create(Path::new(&path), &log.session, 1).unwrap();
        for tick in &ticks {
            writer.tick(tick).unwrap();
        }
        writer.finish().unwrap();
        let replayed = run(COHABIT, &["replay", &path]).unwrap();
        let text = String::from_utf8_lossy(&replayed.stderr).into_owned();
        let expected = format!("tick {} differs", ticks[place].tick);
        assert!(!replayed.status.success() && text.contains(&expected), "{what}: {expected}: {text}");
    }
}
