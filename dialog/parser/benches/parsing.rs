//! `cargo bench -p cohabit-parser`: how long an utterance takes to parse, and how many of the held-out speakers' are parsed right.

use std::{path::Path, time::Instant};

use cohabit_parser::{
    Parser, Said,
    corpus::{Dialog, Line},
    request::{Act, Command, Request},
};

/// Nothing is fitted to these speakers.
const HELD_OUT: [&str; 5] = ["camille", "gloria", "hiro", "nneka", "stefan"];
/// Utterances before it that are given with one.
const LINES: usize = 4;

fn main() {
    let named: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect();
    let speakers: Vec<&str> =
        if named.is_empty() { HELD_OUT.to_vec() } else { named.iter().map(String::as_str).collect() };
    let parser = Parser::builtin();
    let (mut seconds, mut rows, mut heard) = (Vec::new(), Vec::new(), [[0; 2]; 2]);
    for speaker in speakers {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("corpus/{speaker}.txt"));
        let text = match std::fs::read_to_string(&file) {
            Ok(text) => text,
            Err(error) => return println!("{}: {error}", file.display()),
        };
        let dialogs = match Dialog::parse_all(&text) {
            Ok(dialogs) => dialogs,
            Err(error) => return println!("{}: {error}", file.display()),
        };
        for dialog in dialogs {
            for (at, line) in dialog.lines.iter().enumerate() {
                let Line::Person { text, requests } = line else { continue };
                if requests.is_empty() {
                    continue;
                }
                let before: Vec<Said<'_>> = dialog.lines[at.saturating_sub(LINES)..at].iter().map(said).collect();
                let begun = Instant::now();
                let readings = parser.parse(text, &before);
                seconds.push(begun.elapsed().as_secs_f64());
                let best = readings.first();
                let found = best.map(|reading| plain(&reading.requests)).unwrap_or_default();
                rows.push((best.map_or(0.0, |reading| reading.probability), found == plain(requests)));
                let chance: f32 =
                    readings.iter().filter(|reading| stops(&reading.requests)).map(|reading| reading.probability).sum();
                let count = &mut heard[usize::from(!stops(requests))];
                *count = [count[0] + usize::from(chance >= 0.5), count[1] + 1];
            }
        }
    }
    seconds.sort_by(f64::total_cmp);
    rows.sort_by(|a, b| b.0.total_cmp(&a.0));
    let at = |share: f64| 1e3 * seconds[((seconds.len() - 1) as f64 * share) as usize];
    println!("{} {}, one thread", std::env::consts::ARCH, env!("CARGO_PKG_VERSION"));
    println!("{} utterances; parsed in {:.1} ms (median), {:.1} ms (99 %)", rows.len(), at(0.5), at(0.99));
    let [[stopped, of_stops], [disturbed, of_others]] = heard;
    println!("{stopped} of {of_stops} stops are read as stops, and {disturbed} of {of_others} other utterances");
    for share in [0.25, 0.5, 0.75, 1.0] {
        let surest = &rows[..(rows.len() as f64 * share) as usize];
        let exact = surest.iter().filter(|(_, is_exact)| *is_exact).count();
        let least = surest.last().map_or(0.0, |(probability, _)| *probability);
        println!("surest {:3.0} % (probability {least:.2} and more): {exact} of {} exact", 100.0 * share, surest.len());
    }
}

fn said(line: &Line) -> Said<'_> {
    match line {
        Line::Robot(text) => Said { by_robot: true, text },
        Line::Person { text, .. } => Said { by_robot: false, text },
    }
}

/// Whether one of the requests is to stop at once.
fn stops(requests: &[Request]) -> bool {
    let is_stop =
        |request: &Request| matches!(&request.act, Act::Do(Command::Known { form, .. }) if form.text() == "stop");
    requests.iter().any(|request| is_stop(request) && request.conditions.is_empty())
}

/// Requests as text, without articles, marks and case.
fn plain(requests: &[Request]) -> String {
    let texts: Vec<String> = requests.iter().map(Request::to_string).collect();
    let text = texts.join("; ").to_lowercase();
    let words = text.split(|c: char| !c.is_alphanumeric() && c != ';').filter(|word| !word.is_empty());
    words.filter(|word| !matches!(*word, "the" | "a" | "an")).collect::<Vec<_>>().join(" ")
}
