//! A folder has one study, one holder, and nothing of who has withdrawn.

use super::*;
use crate::{plan::Plan, progress::Event, scratch::Scratch};

fn study(text: &str) -> BTreeMap<String, String> {
    [("study.toml", text), ("sheets/information.md", "Read.")].map(|(name, text)| (name.into(), text.into())).into()
}

fn with_participants(scratch: &Scratch) -> Folder {
    let folder = Folder::begin(&scratch.path("data"), &study("a study")).unwrap();
    let mut links = folder.links().unwrap();
    for place in [1, 12] {
        let plan = Plan { place, ..Plan::default() };
        let agreed = Event::Consented { version: "1".into(), ticked: Vec::new(), audio: false };
        Journal::begin(&folder.journal_path(place), &plan, &agreed, 0).unwrap();
        let participant = pseudonym(place);
        let none = Vec::new;
        let version = "1".into();
        let consent = Consent { participant: participant.clone(), at_ms: 0, version, agreed: none(), declined: none() };
        folder.keep_consent(place, &consent).unwrap();
        fs::write(folder.log_path(&format!("{participant}-00-1")), "log").unwrap();
        folder.note(&Note { at_ms: 1, participant: Some(participant), text: "hesitates".into() }).unwrap();
        links.participants.insert(place, format!("token {place}"));
    }
    folder.note(&Note { at_ms: 2, participant: None, text: "it rains".into() }).unwrap();
    links.save(&folder.links_path()).unwrap();
    folder
}

/// All that files in a folder hold, and their names.
fn contents(path: &Path) -> String {
    let mut all = String::new();
    for entry in fs::read_dir(path).unwrap().flatten() {
        all += &format!("{}\n", entry.path().display());
        all += &if entry.path().is_dir() { contents(&entry.path()) } else { fs::read_to_string(entry.path()).unwrap() };
    }
    all
}

#[test]
fn who_withdraws_leaves_nothing_but_that() {
    let scratch = Scratch::new("withdraw");
    let folder = with_participants(&scratch);
    folder.withdraw("P12", 77).unwrap();
    let left = contents(folder.path());
    let of_them: Vec<_> = left.lines().filter(|line| line.contains("P12") || line.contains("token 12")).collect();
    assert_eq!(of_them, ["{\"participant\":\"P12\",\"at_ms\":77}"], "{left}");
    assert!(left.contains("P01-00-1.mcap") && left.contains("it rains") && left.contains("token 1"));
    let error = folder.withdraw("P12", 78).unwrap_err().to_string();
    assert!(error.contains("nothing of `P12`: those in it are P01"), "{error}");
    assert_eq!(folder.withdrawals().unwrap().len(), 1);
}

#[test]
fn who_withdraws_from_a_pair_takes_its_sessions_along_and_none_of_the_partners_answers() {
    let scratch = Scratch::new("withdraw-pair");
    let folder = with_participants(&scratch);
    for session in ["pair06-02-1", "P11-03-1", "pair01-02-1"] {
        fs::write(folder.log_path(session), "log").unwrap();
    }
    folder.withdraw("P12", 77).unwrap();
    let mut left = names(&folder.path().join("logs")).unwrap();
    left.sort();
    assert_eq!(left, ["P01-00-1.mcap", "P11-03-1.mcap", "pair01-02-1.mcap"]);
    let expected = Withdrawal { participant: "P12".to_owned(), at_ms: 77, pair: Some("pair06".to_owned()) };
    assert_eq!(folder.withdrawals().unwrap(), [expected]);
}

#[test]
fn what_a_crash_left_of_a_line_takes_no_other_along() {
    let scratch = Scratch::new("torn-line");
    let folder = with_participants(&scratch);
    let notes = folder.path().join("notes.jsonl");
    let mut torn = fs::read(&notes).unwrap();
    torn.extend_from_slice(b"{\"at_ms\":3,\"text\":\"gr\xc3");
    fs::write(&notes, torn).unwrap();
    assert_eq!(folder.notes().unwrap().len(), 3);
    folder.note(&Note { at_ms: 4, participant: None, text: "it stops".into() }).unwrap();
    let texts: Vec<String> = folder.notes().unwrap().into_iter().map(|note| note.text).collect();
    assert_eq!(texts, ["hesitates", "hesitates", "it rains", "it stops"]);
}

#[test]
fn files_that_no_study_put_there_are_never_replaced() {
    let scratch = Scratch::new("own-folder");
    let own = scratch.path("data").join("study");
    fs::create_dir_all(&own).unwrap();
    fs::write(own.join("draft.md"), "mine").unwrap();
    for path in [scratch.path("data"), own.clone()] {
        fs::set_permissions(path, fs::Permissions::from_mode(0o700)).unwrap();
    }
    let refused = Folder::begin(&scratch.path("data"), &study("a study")).unwrap_err();
    assert!(matches!(refused, FolderError::Foreign { .. }), "{refused}");
    assert_eq!(fs::read_to_string(own.join("draft.md")).unwrap(), "mine");
}

#[test]
fn a_folder_has_one_study_and_one_holder() {
    let scratch = Scratch::new("folder");
    let path = scratch.path("data");
    let folder = with_participants(&scratch);
    assert!(matches!(Folder::open(&path), Err(FolderError::Busy { .. })));
    drop(folder);
    assert!(matches!(Folder::begin(&path, &study("another")), Err(FolderError::OtherStudy { .. })));
    let folder = Folder::begin(&path, &study("a study")).unwrap();
    assert_eq!(folder.places().unwrap(), [1, 12]);
    drop(folder);
    fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
    assert!(matches!(Folder::begin(&path, &study("a study")), Err(FolderError::Open { .. })));
    assert!(matches!(Folder::open(&scratch.path("none")), Err(FolderError::NoStudy { .. })));
}
