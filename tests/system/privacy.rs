//! What a session makes belongs to its user alone, and no other session touches it.

use std::{
    fs,
    os::unix::fs::{DirBuilderExt as _, MetadataExt as _, PermissionsExt as _},
    path::{Path, PathBuf},
};

use cohabit_tests::{Page, Play, Scratch};
use rustix::process::{Signal, geteuid};
use serde_json::json;

use crate::COHABIT;

/// A folder in which sessions may have their runtime folder and their data.
fn private(scratch: &Scratch, name: &str) -> String {
    let path = scratch.path(name);
    fs::DirBuilder::new().mode(0o700).create(&path).unwrap();
    path
}

/// The files of shared memory with the session in their names.
fn memory(session: &str) -> Vec<PathBuf> {
    let all = fs::read_dir("/dev/shm").unwrap().flatten();
    let part = format!("_{session}_");
    let mut own: Vec<_> =
        all.filter(|file| file.file_name().to_string_lossy().contains(&part)).map(|file| file.path()).collect();
    own.sort();
    own
}

/// All that is in a folder, at any depth.
fn contents(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for path in fs::read_dir(folder).unwrap().flatten().map(|entry| entry.path()) {
        if path.is_dir() {
            found.extend(contents(&path));
        }
        found.push(path);
    }
    found
}

#[test]
fn all_files_of_a_session_are_closed_to_other_users() {
    let scratch = Scratch::new("privacy");
    let (runtime, data) = (private(&scratch, "runtime"), private(&scratch, "data"));
    let environment = [("XDG_RUNTIME_DIR", runtime.as_str()), ("XDG_DATA_HOME", data.as_str())];
    let play = Play::start_in(COHABIT, &["--body", "person", "--record-frames", "overhead/0"], &environment).unwrap();
    let mut page = Page::open(play.authority()).unwrap();
    page.do_and_wait("turn left").unwrap();
    let (memory, data) = (memory(&play.session), contents(data.as_ref()));
    assert!(memory.iter().any(|path| path.to_string_lossy().ends_with("global_mgmt")), "{memory:?}");
    assert!(data.iter().any(|path| path.extension().is_some_and(|ending| ending == "mcap")), "{data:?}");
    for path in memory.into_iter().chain(contents(runtime.as_ref())).chain(data) {
        // What comes and goes meanwhile was looked at often enough.
        let Ok(found) = fs::symlink_metadata(&path) else { continue };
        let mode = found.permissions().mode();
        assert_eq!((mode & 0o077, found.uid()), (0, geteuid().as_raw()), "{}: {mode:o}", path.display());
    }
    drop(page);
    play.end().unwrap();
}

#[test]
fn a_session_in_another_runtime_folder_leaves_a_live_one_alone() {
    let scratch = Scratch::new("neighbours");
    let folders = ["one", "two", "three"].map(|name| private(&scratch, name));
    let start = |index: usize| Play::start_in(COHABIT, &[], &[("XDG_RUNTIME_DIR", &folders[index])]).unwrap();
    let play = start(0);
    // Queues between two processes come and go.
    let lasting = || {
        let is_queue = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "connection");
        memory(&play.session).into_iter().filter(|path| !is_queue(path)).collect::<Vec<_>>()
    };
    let before = lasting();
    assert!(before.len() > 10, "{before:?}");
    start(1).end().unwrap();
    let after = lasting();
    let gone: Vec<_> = before.iter().filter(|path| !after.contains(path)).collect();
    assert!(gone.is_empty(), "{gone:?}");
    // Who is started again finds the shared memory.
    play.send("dialog", Signal::KILL).unwrap();
    let mut page = Page::once_served(|| Page::open(play.authority())).unwrap();
    page.do_and_wait("turn left").unwrap();
    drop(page);
    // Once its supervisor is dead, it is cleaned up from anywhere.
    play.kill().unwrap();
    start(2).end().unwrap();
    assert_eq!(memory(&play.session), [] as [PathBuf; 0]);
}

#[test]
fn what_is_planted_in_the_runtime_folder_is_not_written_to() {
    let scratch = Scratch::new("planted");
    let victim = scratch.write("victim", "mine");
    let runtime = private(&scratch, "runtime");
    let sessions = Path::new(&runtime).join(format!("cohabit-{}", geteuid().as_raw()));
    fs::create_dir(&sessions).unwrap();
    fs::set_permissions(&sessions, fs::Permissions::from_mode(0o777)).unwrap();
    fs::create_dir(sessions.join("planted")).unwrap();
    std::os::unix::fs::symlink(&victim, sessions.join("planted/version")).unwrap();
    let output = std::process::Command::new(COHABIT)
        .args(["play", "--session", "planted", "--port", "0"])
        .env("XDG_RUNTIME_DIR", &runtime)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(4) && said.contains("chmod 700"), "{said}");
    assert_eq!(fs::read_to_string(&victim).unwrap(), "mine");
}

#[test]
fn what_is_typed_and_not_said_is_kept_nowhere_and_told_to_nobody() {
    let scratch = Scratch::new("drafts");
    let (runtime, data) = (private(&scratch, "runtime"), private(&scratch, "data"));
    let environment = [("XDG_RUNTIME_DIR", runtime.as_str()), ("XDG_DATA_HOME", data.as_str())];
    let play = Play::start_in(COHABIT, &[], &environment).unwrap();
    let [mut page, mut other] = [1, 2].map(|key| Page::open_as(play.authority(), key).unwrap());
    page.send(&json!({ "type": "typing", "text": "tell nobody of the zanzibar affair" })).unwrap();
    page.do_and_wait("turn left").unwrap();
    other.do_and_wait("turn right").unwrap();
    let lines = page.chat.iter().chain(&other.chat);
    let told: Vec<_> = lines.filter(|(_, text)| text.contains("zanzibar")).collect();
    assert!(told.is_empty(), "{told:?}");
    drop((page, other));
    play.end().unwrap();
    let files = [runtime, data].into_iter().flat_map(|folder| contents(folder.as_ref()));
    let files: Vec<_> = files.filter_map(|path| Some((fs::read(&path).ok()?, path))).collect();
    let keeping = |word: &str| {
        let has = |bytes: &[u8]| bytes.windows(word.len()).any(|part| part == word.as_bytes());
        files.iter().filter(|(bytes, _)| has(bytes)).map(|(_, path)| path).collect::<Vec<_>>()
    };
    assert!(!keeping("turn left").is_empty(), "what is said is in the log");
    assert!(keeping("zanzibar").is_empty(), "{:?}", keeping("zanzibar"));
}
