//! A small benchmark, played, interrupted, verified and tampered with.

#![allow(clippy::unwrap_used)]

use std::{
    fs,
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
};

use cohabit_benchmark::{
    AgentCard, Benchmark, Check, Difference, Entry, Header, Making, Mission, Recording, RunError, Split, Submission,
    grids, page, random, run, verify,
};
use cohabit_cdf::Catalog;
use cohabit_tests::Scratch;
use serde_json::{Value, json};

/// Ten missions of two types, of which some are played.
const SMALL: &str = r#"
version = 7
seed = 3
count = 10
share = 0.2
caps = { actions = 6, failed = 3 }
[[missions.type]]
name = "pickup"
vars = [{ name = "it", affords = ["PICKUPABLE"] }]
goals = ["it isPickedUp=true"]
[[missions.type]]
name = "toggleDevice"
vars = [{ name = "device", kind = "device", affords = ["TOGGLEABLE"], without = ["PICKUPABLE"] }]
goals = ["device isToggledOn=true"]
"#;

fn small() -> Benchmark {
    Benchmark::parse("small.toml", SMALL, &Arc::new(Catalog::builtin()), Making::by(2)).unwrap()
}

fn header(benchmark: &Benchmark) -> Header {
    let agent = AgentCard { name: "random".to_owned(), ..AgentCard::default() };
    Header::new(benchmark, &Split::PLAYED, agent, "here")
}

/// Plays a small benchmark at random; gives the file of the submission, and how many missions were played.
fn played(benchmark: &Benchmark, out: &Path, workers: usize) -> Result<usize, RunError> {
    let count = AtomicUsize::new(0);
    let play = |mission: &Mission| -> Result<Recording, String> {
        count.fetch_add(1, Ordering::Relaxed);
        random(benchmark, mission, 5)
    };
    run(benchmark, header(benchmark), out, workers, &play, &|| {})?;
    Ok(count.into_inner())
}

/// A submission of the small benchmark.
fn submission(scratch: &Scratch) -> (Benchmark, PathBuf) {
    let (benchmark, out) = (small(), PathBuf::from(scratch.path("random.jsonl")));
    let missions = benchmark.of(&Split::PLAYED).count();
    assert!(missions >= 3, "the small benchmark has {missions} missions to play");
    assert_eq!(played(&benchmark, &out, 2).unwrap(), missions);
    (benchmark, out)
}

fn differences(benchmark: &Benchmark, text: &str) -> Vec<Difference> {
    verify(benchmark, &Submission::parse(text).unwrap(), 2, &|| {})
}

#[test]
fn the_same_file_makes_the_same_missions_with_any_number_of_workers() {
    let (one, other) =
        (small(), Benchmark::parse("s.toml", SMALL, &Arc::new(Catalog::builtin()), Making::by(1)).unwrap());
    assert_eq!((&one.digest, &one.missions), (&other.digest, &other.missions));
    let named = |digest: &str| SMALL.replace("version = 7", &format!("version = 7\ndigest = \"{digest}\""));
    let parse = |text: &str| Benchmark::parse("s.toml", text, &Arc::new(Catalog::builtin()), Making::by(2));
    assert!(parse(&named(&one.digest)).is_ok());
    let error = parse(&named("abc")).unwrap_err().to_string();
    assert!(error.contains(&one.digest) && error.contains("abc"), "{error}");
    for mission in &one.missions {
        assert!(!mission.instructions.is_empty(), "{}", mission.id);
        assert!(mission.instructions.iter().all(|said| !said.text.is_empty() && !said.answer.is_empty()));
    }
}

#[test]
fn missions_that_were_made_are_kept_and_taken_only_if_they_are_those_of_the_file() {
    let scratch = Scratch::new("benchmark-kept");
    let folder = PathBuf::from(scratch.path("kept"));
    let made = AtomicUsize::new(0);
    let told = |done: usize, all: usize| {
        assert!(done <= all && all == 10, "{done} of {all}");
        made.fetch_add(1, Ordering::Relaxed);
    };
    let parse = |text: &str, build: &str| {
        made.store(0, Ordering::Relaxed);
        let making = Making { workers: 2, kept_in: Some(&folder), build, made: &told };
        let benchmark = Benchmark::parse("s.toml", text, &Arc::new(Catalog::builtin()), making).unwrap();
        (benchmark, made.load(Ordering::Relaxed))
    };
    let (first, count) = parse(SMALL, "one");
    assert_eq!(count, 10);
    let (again, count) = parse(SMALL, "one");
    assert_eq!((count, &again.digest, &again.missions), (0, &first.digest, &first.missions));
    // Another build may make others, unless the file names their digest.
    assert_eq!(parse(SMALL, "two").1, 10);
    let named = SMALL.replace("version = 7", &format!("version = 7\ndigest = \"{}\"", first.digest));
    assert_eq!((parse(&named, "one").1, parse(&named, "two").1), (10, 0));
    // What is damaged is made again, and then is right.
    for entry in fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        let text = fs::read_to_string(&path).unwrap();
        fs::write(&path, text.replacen("pickup", "pickap", 2)).unwrap();
    }
    assert_eq!(parse(&named, "one").1, 10);
    assert_eq!((parse(&named, "one").1, parse(SMALL, "one").0.missions), (0, first.missions));
}

#[test]
fn the_benchmark_of_the_project_names_the_digest_of_its_missions() {
    let benchmark = Benchmark::builtin(&Arc::new(Catalog::builtin()), Making::by(2)).unwrap();
    for split in Split::PLAYED {
        let missions = benchmark.of(&[split]).count();
        assert!(missions >= 100, "{}: {missions}", split.name());
    }
    let text = include_str!("../data/benchmark-1.toml");
    let line = format!("digest = \"{}\"", benchmark.digest);
    assert!(text.lines().any(|own| own == line), "benchmark-1.toml lacks the line: {line}");
}

#[test]
fn a_submission_holds_and_is_the_same_with_any_number_of_workers() {
    let scratch = Scratch::new("benchmark-holds");
    let (benchmark, out) = submission(&scratch);
    let text = fs::read_to_string(&out).unwrap();
    assert_eq!(differences(&benchmark, &text), Vec::<Difference>::new());
    let alone = PathBuf::from(scratch.path("alone.jsonl"));
    played(&benchmark, &alone, 1).unwrap();
    assert_eq!(fs::read_to_string(&alone).unwrap(), text);
    // One that is whole is not played again, and one of another run is not overwritten.
    assert_eq!(played(&benchmark, &out, 2).unwrap(), 0);
    let other = Header { agent: AgentCard::default(), ..header(&benchmark) };
    let refused = run(&benchmark, other, &out, 1, &|mission| random(&benchmark, mission, 5), &|| {});
    assert!(matches!(refused, Err(RunError::Exists { .. })), "{refused:?}");
}

#[test]
fn a_run_that_was_cut_in_the_middle_of_a_line_goes_on() {
    let scratch = Scratch::new("benchmark-cut");
    let (benchmark, out) = submission(&scratch);
    let text = fs::read_to_string(&out).unwrap();
    let mut lines: Vec<&str> = text.lines().collect();
    let mut begun: Value = serde_json::from_str(lines[0]).unwrap();
    begun["totals"] = Value::Null;
    begun["machine"] = json!("another one");
    let begun = begun.to_string();
    lines[0] = &begun;
    let (missions, part) = (lines.len() - 1, PathBuf::from(scratch.path("cut.jsonl.part")));
    let cut = PathBuf::from(scratch.path("cut.jsonl"));
    let half = &lines[2][..lines[2].len() / 2];
    fs::write(&part, format!("{}\n{}\n{half}", lines[0], lines[1])).unwrap();
    assert_eq!(played(&benchmark, &cut, 2).unwrap(), missions - 1);
    assert!(!part.exists());
    let whole = fs::read_to_string(&cut).unwrap();
    assert!(whole.lines().skip(1).eq(text.lines().skip(1)), "{whole}");
    assert_eq!(differences(&benchmark, &whole), Vec::<Difference>::new());
    // What is whole and yet no episode is not passed over, nor is another run's.
    let again = PathBuf::from(scratch.path("again.jsonl"));
    let part = scratch.path("again.jsonl.part");
    fs::write(&part, format!("{}\n{half}\n", lines[0])).unwrap();
    let refused = played(&benchmark, &again, 1);
    assert!(matches!(refused, Err(RunError::Damaged { line: 2, .. })), "{refused:?}");
    fs::write(&part, format!("{}\n", lines[0].replace("\"random\"", "\"somebody\""))).unwrap();
    let refused = played(&benchmark, &again, 1);
    assert!(matches!(refused, Err(RunError::OtherRun { .. })), "{refused:?}");
}

/// A submission with one of its lines changed.
fn changed(text: &str, line: usize, change: impl FnOnce(&mut Value)) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let mut value: Value = serde_json::from_str(&lines[line]).unwrap();
    change(&mut value);
    lines[line] = value.to_string();
    lines.join("\n") + "\n"
}

/// The fields of an episode that differ, by its own name and in order.
fn fields(differences: &[Difference]) -> Vec<&str> {
    let field = |difference: &Difference| match difference {
        Difference::Field { field, .. } => Some(*field),
        _ => None,
    };
    differences.iter().filter_map(field).collect()
}

#[test]
fn what_was_tampered_with_is_named() {
    let scratch = Scratch::new("benchmark-tampered");
    let (benchmark, out) = submission(&scratch);
    let text = fs::read_to_string(&out).unwrap();
    let first: Value = serde_json::from_str(text.lines().nth(1).unwrap()).unwrap();
    let mission = first["mission"].as_str().unwrap();
    let check = |text: &str| differences(&benchmark, text);

    let found = check(&changed(&text, 1, |episode| episode["success"] = json!(!first["success"].as_bool().unwrap())));
    assert_eq!(fields(&found), ["success"], "{found:?}");
    assert!(found[0].to_string().starts_with(mission), "{}", found[0]);

    let found = check(&changed(&text, 1, |episode| episode["actions"] = json!(0)));
    assert_eq!(fields(&found), ["actions"], "{found:?}");

    let found = check(&changed(&text, 1, |episode| episode["digest"] = json!("00")));
    assert_eq!(fields(&found), ["digest"], "{found:?}");

    let found = check(&changed(&text, 1, |episode| {
        episode["taken"][0]["inputs"][0]["action"] = json!({ "Rotate": { "yaw_rad": 1.0 } });
    }));
    assert!(fields(&found).contains(&"taken"), "{found:?}");

    let found = check(&changed(&text, 0, |header| header["totals"]["validation"]["all"]["msr"] = json!(1.5)));
    assert!(matches!(found.as_slice(), [Difference::Totals { place, .. }] if place == "validation"), "{found:?}");
    // A type that is called like a part stands for no part.
    let found = check(&changed(&text, 0, |header| {
        let totals = &mut header["totals"]["validation"];
        let (name, honest) = totals["parts"].as_object().unwrap().iter().next().unwrap();
        let (name, honest) = (name.clone(), honest.clone());
        totals["parts"][&name]["msr"] = json!(0.99);
        totals["types"][&name] = honest;
    }));
    assert!(!found.is_empty());

    let lines: Vec<&str> = text.lines().collect();
    let without: Vec<&str> = lines.iter().copied().filter(|line| *line != lines[1]).collect();
    let found = check(&without.join("\n"));
    assert!(found.contains(&Difference::Missing { mission: mission.to_owned() }), "{found:?}");

    let found = check(&format!("{text}{}\n", lines[1]));
    let number = lines.len() + 1;
    assert_eq!(found, [Difference::Doubled { mission: mission.to_owned(), number }]);

    let found = check(&changed(&text, 1, |episode| episode["mission"] = json!("unheard-of")));
    assert!(found.contains(&Difference::Unknown { mission: "unheard-of".to_owned(), number: 2 }), "{found:?}");

    let found = check(&text.replacen(lines[1], "{", 1));
    assert!(matches!(&found[0], Difference::Line { number: 2, .. }), "{found:?}");

    let found = check(&changed(&text, 0, |header| header["missions"] = json!("00")));
    assert!(matches!(found.as_slice(), [Difference::Benchmark { field: "digest", .. }]), "{found:?}");
}

#[test]
fn submissions_are_laid_beside_the_paper() {
    let scratch = Scratch::new("benchmark-table");
    let (_, out) = submission(&scratch);
    let header = Submission::read(&out).unwrap().header;
    let grids = grids(&[Entry { file: "random.jsonl".to_owned(), header, check: Check::Verified }]);
    assert_eq!(grids[0].rows.len(), 1);
    assert_eq!(grids[0].rows[0].last().unwrap(), "yes");
    let page = page(&grids);
    assert!(page.contains("toggleDevice") && page.contains("34.20") && page.contains("cannot be compared"), "{page}");
    assert!(!page.contains("<script"), "{page}");
}

#[test]
fn a_table_says_that_submissions_are_of_several_benchmarks() {
    let header = header(&small());
    let entry = |file: &str, missions: &str| {
        let header = Header { missions: missions.to_owned(), ..header.clone() };
        Entry { file: file.to_owned(), header, check: Check::NotVerified }
    };
    let note = |entries: &[Entry]| grids(entries)[0].note.clone();
    assert!(!note(&[entry("a", "1"), entry("b", "1")]).contains("benchmarks"));
    let told = note(&[entry("a", "1"), entry("b", "1"), entry("c", "2")]);
    assert!(told.contains("of 2 benchmarks") && told.contains("a, b; c"), "{told}");
}
