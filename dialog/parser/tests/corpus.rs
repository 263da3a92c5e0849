//! The corpus of labelled dialogs is whole, and its notation is one that the parser reads.
#![allow(clippy::unwrap_used)]

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::Path,
};

use cohabit_parser::{
    corpus::{Dialog, Line},
    request::{Act, Command, Form, Request},
};
use proptest::prelude::*;

/// The text of each speaker, by file name.
fn speakers() -> BTreeMap<String, String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus");
    let files = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path());
    let texts = files.filter(|path| path.extension().is_some_and(|extension| extension == "txt"));
    texts
        .map(|path| (path.file_stem().unwrap().to_string_lossy().into_owned(), fs::read_to_string(&path).unwrap()))
        .collect()
}

fn dialogs() -> Vec<(String, Dialog)> {
    let read = |(speaker, text): (String, String)| {
        let dialogs = Dialog::parse_all(&text).unwrap_or_else(|error| panic!("corpus/{speaker}.txt: {error}"));
        dialogs.into_iter().map(move |dialog| (speaker.clone(), dialog))
    };
    speakers().into_iter().flat_map(read).collect()
}

fn labels(dialogs: &[(String, Dialog)]) -> impl Iterator<Item = &Request> {
    let lines = dialogs.iter().flat_map(|(_, dialog)| &dialog.lines);
    lines.filter_map(|line| if let Line::Person { requests, .. } = line { Some(requests) } else { None }).flatten()
}

#[test]
fn every_file_is_read_and_every_label_is_written_as_it_was_read() {
    for (speaker, text) in speakers() {
        Dialog::parse_all(&text).unwrap_or_else(|error| panic!("corpus/{speaker}.txt: {error}"));
        for line in text.lines().filter_map(|line| line.strip_prefix("= ")) {
            for label in line.trim().split("; ") {
                assert_eq!(Request::parse(label).unwrap().to_string(), label, "corpus/{speaker}.txt");
            }
        }
    }
}

#[test]
fn almost_every_form_occurs() {
    let dialogs = dialogs();
    let used: BTreeSet<Form> = labels(&dialogs)
        .filter_map(|request| match &request.act {
            Act::Do(Command::Known { form, .. }) => Some(*form),
            _ => None,
        })
        .collect();
    let unused: Vec<&str> = Form::all().filter(|form| !used.contains(form)).map(Form::text).collect();
    assert!(unused.len() * 20 <= Form::all().count(), "forms without an utterance: {unused:?}");
}

#[test]
fn the_readme_counts_what_is_there() {
    let dialogs = dialogs();
    let people: BTreeSet<&String> = dialogs.iter().map(|(speaker, _)| speaker).collect();
    let lines = || dialogs.iter().flat_map(|(_, dialog)| &dialog.lines);
    let utterances =
        lines().filter(|line| matches!(line, Line::Person { requests, .. } if !requests.is_empty())).count();
    let readme = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus/README.md")).unwrap();
    let counts = format!("{} speakers, {} dialogs, {utterances} labelled utterances", people.len(), dialogs.len());
    assert!(readme.contains(&counts), "corpus/README.md must say: {counts}");
}

proptest! {
    #[test]
    fn any_text_is_read_or_refused(text in "\\PC{0,80}") {
        let _ = Request::parse_all(&text);
        let _ = Dialog::parse_all(&text);
    }

    #[test]
    fn what_is_read_is_written_again(words in prop::collection::vec("[a-z]{1,6}", 1..5), form in 0..Form::all().count()) {
        let form = Form::all().nth(form).unwrap().text();
        let text = form.replace('X', &words.join(" ")).replace('Y', &words[0]).replace('#', "3");
        let request = Request::parse(&text).unwrap();
        prop_assert_eq!(request.to_string(), text);
    }
}
