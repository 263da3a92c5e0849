//! Fits `dialog/language/data/stop_likeness.toml`: by their direction, which utterances tell the robot to stop.
//!
//! ```text
//! cargo run --release --manifest-path dialog/language/fit/Cargo.toml --bin stop
//! ```
//!
//! It learns from `dialog/parser/corpus`, all speakers but those held out, and from the lists of `dialog/language/tests/stops` but those
//! held out and the newest, which it is judged on with these speakers.

#[path = "../logit.rs"]
mod logit;

use std::{fmt::Write as _, fs, path::Path};

use cohabit_parser::{
    Meaning,
    corpus::{Dialog, Line},
    request::{Act, Command, Request},
};

use crate::logit::Choice;

const HELD_OUT: [&str; 5] = ["camille", "gloria", "hiro", "nneka", "stefan"];
const STOPS: [&str; 1] = ["stops"];
/// Lists of both, each line with its mark.
const MARKED: [&str; 2] = ["first_contact", "speakers"];
const STOPS_HELD_OUT: [&str; 2] = ["held_out", "held_out_again"];
/// From which probability on an utterance is counted as a stop.
const COUNTED: f64 = 0.2;

/// An utterance's direction, a constant, and whether it tells the robot to stop.
struct Sample {
    features: Vec<f64>,
    is_stop: bool,
}

impl Sample {
    fn new(said: &str, is_stop: bool) -> Self {
        let direction = Meaning::builtin().of(said);
        let numbers = direction.numbers().iter().map(|number| f64::from(*number));
        let length = numbers.clone().map(|number| number * number).sum::<f64>().sqrt().max(1.0);
        Self { features: numbers.map(|number| number / length).chain([1.0]).collect(), is_stop }
    }

    fn choice(&self) -> Choice {
        let alternatives = vec![self.features.clone(), vec![0.0; self.features.len()]];
        Choice { weight: 1.0, alternatives, chosen: usize::from(!self.is_stop) }
    }
}

fn main() {
    let folder = |path: &str| Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    let (mut fitted, mut held_out) = (Vec::new(), Vec::new());
    let mut files: Vec<_> = fs::read_dir(folder("../../parser/corpus")).expect("the corpus").flatten().collect();
    files.sort_by_key(fs::DirEntry::path);
    for path in files.iter().map(fs::DirEntry::path).filter(|path| path.extension().is_some_and(|kind| kind == "txt")) {
        let speaker = path.file_stem().unwrap_or_default().to_string_lossy();
        let samples = if HELD_OUT.contains(&&*speaker) { &mut held_out } else { &mut fitted };
        samples.extend(of_speaker(&fs::read_to_string(&path).expect("a file of the corpus")));
    }
    let list = |name: &str| {
        let text = fs::read_to_string(folder("../tests/stops").join(format!("{name}.txt"))).expect("a list of stops");
        let said = text.lines().filter(|line| !line.starts_with('#') && !line.trim().is_empty());
        said.map(|line| line.split(" -> ").next().unwrap_or(line).to_owned()).collect::<Vec<_>>()
    };
    fitted.extend(STOPS.iter().flat_map(|name| list(name)).map(|said| Sample::new(&said, true)));
    fitted.extend(list("others").iter().map(|said| Sample::new(said, false)));
    fitted.extend(MARKED.iter().flat_map(|name| list(name)).filter_map(|line| {
        let (mark, said) = line.split_once(": ")?;
        Some(Sample::new(said, mark == "S"))
    }));
    held_out.extend(STOPS_HELD_OUT.iter().flat_map(|name| list(name)).map(|said| Sample::new(&said, true)));
    let choices: Vec<Choice> = fitted.iter().map(Sample::choice).collect();
    let weights = logit::fit(&choices, fitted[0].features.len());
    let counted = |is_stop: bool| {
        let same = || held_out.iter().filter(move |sample| sample.is_stop == is_stop);
        let heard = same().filter(|sample| logit::probabilities(&weights, &sample.choice().alternatives)[0] >= COUNTED);
        (heard.count(), same().count())
    };
    let (stops, others) = (counted(true), counted(false));
    println!("held out: {} of {} stops, {} of {} others", stops.0, stops.1, others.0, others.1);
    let (constant, direction) = weights.split_last().expect("weights");
    let mut text = format!(
        "# How much each number of an utterance's direction speaks for a stop, in nats. Written by\n#\n\
         #     cargo run --release --manifest-path dialog/language/fit/Cargo.toml --bin stop\n#\n\
         # Fitted, with a ridge of 1, to {} utterances. Of what was held out it takes {} of {} stops for such, from {COUNTED} on, and {} of\n\
         # {} others.\n\nconstant = {constant:.4}\ndirection = [",
        fitted.len(),
        stops.0,
        stops.1,
        others.0,
        others.1
    );
    for line in direction.chunks(16) {
        let numbers: Vec<String> = line.iter().map(|number| format!("{number:.4}")).collect();
        let _ = write!(text, "\n  {},", numbers.join(", "));
    }
    fs::write(folder("../data/stop_likeness.toml"), text + "\n]\n").expect("the weights can be written");
}

fn of_speaker(text: &str) -> Vec<Sample> {
    let dialogs = Dialog::parse_all(text).expect("a file of the corpus can be read");
    let lines = dialogs.into_iter().flat_map(|dialog| dialog.lines);
    let said = lines.filter_map(|line| match line {
        Line::Person { text, requests } if !requests.is_empty() => {
            let is_stop = requests.iter().any(stops);
            Some(Sample::new(&text, is_stop))
        }
        _ => None,
    });
    said.collect()
}

fn stops(request: &Request) -> bool {
    let is_stop = matches!(&request.act, Act::Do(Command::Known { form, .. }) if form.text() == "stop");
    is_stop && request.conditions.is_empty()
}
