//! Stops among the utterances of the corpus are heard as stops, and others are not.
use std::{fs, path::Path};

use cohabit_language::{Firmness, find_stop};

/// The speaker, an utterance and its label, of all utterances of the corpus.
fn utterances() -> Vec<[String; 3]> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../rewriter/corpus");
    let files = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path());
    let texts = files.filter(|path| path.extension().is_some_and(|extension| extension == "txt"));
    texts
        .flat_map(|path| {
            let (speaker, text) =
                (path.file_stem().unwrap().to_string_lossy().into_owned(), fs::read_to_string(&path).unwrap());
            let mut said = String::new();
            let labelled = text.lines().filter_map(|line| {
                if let Some(text) = line.strip_prefix("> ") {
                    text.clone_into(&mut said);
                }
                Some([speaker.clone(), said.clone(), line.strip_prefix("= ")?.to_owned()])
            });
            labelled.collect::<Vec<_>>()
        })
        .collect()
}

/// Speakers whose utterances nobody reads during development; only counts are printed of them.
const HELD_OUT: [&str; 5] = ["camille", "gloria", "hiro", "nneka", "stefan"];

/// Whether a label says that the robot shall stop; `None`, where it may well be heard so: to wait, to do something else or nothing, an
/// answer, a complaint.
fn is_stop(label: &str) -> Option<bool> {
    /// Answers that nobody takes for a stop.
    const PLAIN: [&str; 4] = ["answer: yes", "answer: any", "answer: both", "answer: I do not know"];
    let mut requests = label.split("; ");
    if requests.clone().any(|request| request == "stop") {
        return Some(true);
    }
    let is_near = requests.any(|request| {
        let begins = ["stop", "wait", "undo", "go on", "instead: ", "do not ", "answer: ", "social: "];
        begins.iter().any(|begin| request.starts_with(begin)) && !PLAIN.contains(&request)
    });
    (!is_near).then_some(false)
}

/// How many utterances of `speakers` are heard as stops, of all that say stop and of all that do not; and those that are heard wrongly.
fn stops_heard(is_of: impl Fn(&str) -> bool) -> ([(usize, usize); 2], Vec<String>) {
    let (mut counts, mut wrong) = ([(0, 0); 2], Vec::new());
    for [speaker, text, label] in utterances().iter().filter(|[speaker, ..]| is_of(speaker)) {
        let Some(is_stop) = is_stop(label) else { continue };
        let is_heard = find_stop(text).is_some_and(|stop| is_stop || stop.firmness == Firmness::Firm);
        let count = &mut counts[usize::from(!is_stop)];
        *count = (count.0 + usize::from(is_heard), count.1 + 1);
        if is_heard != is_stop {
            wrong.push(format!("{speaker}: {text}"));
        }
    }
    (counts, wrong)
}

#[test]
fn stops_are_heard_as_stops() {
    let (looked_at, wrong) = stops_heard(|speaker| !HELD_OUT.contains(&speaker));
    let (held_out, _) = stops_heard(|speaker| HELD_OUT.contains(&speaker));
    println!("{}", wrong.join("\n"));
    for (name, [(stopped, stops), (disturbed, others)]) in [("looked at", looked_at), ("held out", held_out)] {
        println!(
            "{name}: {stopped} of {stops} stops are heard, and {disturbed} of {others} other utterances are heard as stops"
        );
    }
    // What was measured when the recogniser first met these utterances, as floors.
    let [(stopped, _), (disturbed, _)] = looked_at;
    assert!(stopped >= 154 && disturbed <= 45, "{}", wrong.join("\n"));
    let [(stopped, _), (disturbed, _)] = held_out;
    assert!(stopped >= 12 && disturbed <= 1);
}
