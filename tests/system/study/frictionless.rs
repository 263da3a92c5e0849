//! Exported tables are what their `datapackage.json` says, as the reader of its standard finds.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use cohabit_tests::{output, python_with, run};
use serde_json::Value;

use super::{STUDY, study};
use crate::COHABIT;

const HERE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/system/study/frictionless");
const FOLDER: &str = concat!(env!("CARGO_TARGET_TMPDIR"), "/frictionless-python");

/// What Frictionless says of the data package in a folder.
fn validated(python: &PathBuf, tables: &str) -> Value {
    let mut command = Command::new(python);
    command.arg(Path::new(HERE).join("validate.py")).arg("datapackage.json").current_dir(tables);
    serde_json::from_slice(&output(&mut command).unwrap().stdout).unwrap()
}

#[test]
#[cfg_attr(not(python), ignore = "needs Python 3.10 or later with venv")]
fn exported_tables_are_a_valid_data_package() {
    let scratch = study("study-frictionless");
    let with_words = "[[block]]\nkind = \"questionnaire\"\nquestionnaires = [\"short.toml\", \"tlx\"]\n\n[[block]]\nkind = \"debriefing\"";
    let _ = scratch.write("study.toml", &STUDY.replacen("[[block]]\nkind = \"debriefing\"", with_words, 1));
    let people = scratch.write("people.toml", "[leaving]\nstops = 0\nwithdraws = 0\n");
    let [file, data, tables] = ["study.toml", "dry-run", "tables"].map(|name| scratch.path(name));
    for arguments in [
        &["study", "simulate", &file, "--participants", "2", "--people", &people, "--folder", &data][..],
        &["study", "export", "--folder", &data, "--out", &tables],
    ] {
        let done = run(COHABIT, arguments).unwrap();
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    }
    let python = python_with(&Path::new(HERE).join("requirements.txt"), Path::new(FOLDER)).unwrap();
    let report = validated(&python, &tables);
    assert_eq!(report["valid"], true, "{report}");
    for table in ["participants", "missions", "answers", "scores", "probes", "sessions", "turns", "codebook"] {
        let lines = fs::read_to_string(format!("{tables}/{table}.csv")).unwrap();
        assert!(
            report["rows"][table].as_u64().is_some_and(|rows| rows > 0) || lines.lines().count() == 1,
            "{table}: {report}"
        );
    }
    // What is no number where one is said to be is found.
    let path = format!("{tables}/participants.csv");
    let broken = fs::read_to_string(&path).unwrap().replacen("P01,1,", "P01,one,", 1);
    fs::write(&path, broken).unwrap();
    let report = validated(&python, &tables);
    assert!(report["valid"] == false && report["errors"].to_string().contains("type-error"), "{report}");
}
