//! A dry run is a study as it would be with people, the same each time, and never mixed with theirs.

use std::{collections::BTreeMap, fs, path::Path};

use super::*;
use crate::{
    check::StudyFile,
    pair::{pair_label, partner_of},
    plan::{Step, place_of},
    probe::Happening,
    progress::Ending,
    records::Records,
    scratch::{Anything, Scratch},
};

const STUDY: &str = r#"
title = "A study"
contact = "us"
seed = 5
participants = 4
assignment = "latin_square"
missions = ["one", "two"]
information = { file = "sheet.md", version = "1" }
consent = { file = "sheet.md", version = "2", required = ["Yes."], optional = ["Tell me.", "Keep it."] }
factor = [
    { name = "ask", kind = "within", level = [{ name = "never", settings = { ask = "never" } }, { name = "always", settings = { ask = "always" } }] },
    { name = "group", kind = "between", level = [{ name = "a", settings = { knows = "seen" } }, { name = "b", settings = { knows = "everything" } }] },
]
probe = [{ questionnaire = "one.toml", at = "goal_met" }, { questionnaire = "two.toml", at = "minutes", minutes = 0.5 }]
block = [
    { kind = "practice", mission = "three" },
    { kind = "tutorial", mission = "four", minutes = 9 },
    { kind = "missions", minutes = 2, skip_after_minutes = 1, after_mission = ["tlx"] },
    { kind = "break" },
    { kind = "questionnaire", questionnaires = ["sus"] },
]
"#;
const ITEM: &str = "title = \"T\"\nscale = { least = 1, most = 5 }\n[[item]]\nask = \"How?\"\n";

/// Sessions whose ends follow from their seeds.
struct Stage;

impl SimulatedPlayer for Stage {
    fn play(&self, wanted: &SimulatedMission) -> Result<SimulatedSession, String> {
        let played_s = 20.0 + (wanted.seeds[1] % 100) as f64;
        let cut_s = wanted.ends_by_s.map_or(played_s, |end| end.min(played_s));
        fs::write(&wanted.log, format!("{} {cut_s}", wanted.mission)).map_err(|error| error.to_string())?;
        let ending =
            (!wanted.gives_up && !wanted.seeds[1].is_multiple_of(3) && cut_s >= played_s).then_some(Ending::Complete);
        Ok(SimulatedSession { played_s: cut_s, ending, happened: vec![(10.0, Happening::GoalMet)] })
    }
}

fn run(scratch: &Scratch, data: &str, seed: u64, threads: usize) -> (Simulated, Records) {
    let leaving = Leaving { declines: 0.1, withdraws: 0.1, stops: 0.1, ..Leaving::default() };
    let people = People { leaving, ..People::default() };
    let run = DryRun { participants: 31, seed, people, program: "1".to_owned() };
    run_study(STUDY, scratch, data, &run, threads)
}

fn run_study(study: &str, scratch: &Scratch, data: &str, run: &DryRun, threads: usize) -> (Simulated, Records) {
    for (name, text) in [("sheet.md", "Read."), ("study.toml", study), ("one.toml", ITEM), ("two.toml", ITEM)] {
        let _ = scratch.write(name, text);
    }
    let files = BTreeMap::from([("study.toml".to_owned(), study.to_owned())]);
    let study = StudyFile::read(&scratch.path("study.toml")).unwrap().check(&Anything).unwrap();
    let folder = Folder::begin_synthetic(&scratch.path(data), &files, run).unwrap();
    let simulated = simulate(study.clone(), folder, run, &Stage, threads, &|| {}).unwrap();
    (simulated, Records::read(study, &scratch.path(data)).unwrap())
}

/// All tables as text.
fn tables_in(folder: &Path) -> Vec<String> {
    let mut paths: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "csv"));
    paths.sort();
    paths.iter().map(|path| fs::read_to_string(path).unwrap()).collect()
}

#[test]
fn the_same_seed_makes_the_same_tables_and_all_of_them_are_marked() {
    let scratch = Scratch::new("simulate");
    let export = |data: &str, seed, threads| {
        let (simulated, records) = run(&scratch, data, seed, threads);
        let out = scratch.path(&format!("{data}-tables"));
        fs::create_dir_all(&out).unwrap();
        tables::export(&records, Vec::new(), true, &out).unwrap();
        (simulated, tables_in(&out), tables_in(&scratch.path(data)))
    };
    let one = export("one", 1, 1);
    assert_eq!(one, export("again", 1, 3));
    assert_ne!(one.1, export("other", 2, 1).1);
    let Simulated { consented, finished, withdrawn, excluded, stopped, missions } = one.0;
    assert_eq!(finished + withdrawn + excluded + stopped, consented);
    assert!(consented < 31 && finished > 15 && withdrawn > 0 && stopped > 0 && missions > 60, "{:?}", one.0);
    for table in one.1.iter().chain(&one.2).filter(|table| !table.starts_with("table,name")) {
        let (head, rows) = table.split_once('\n').unwrap();
        assert!(head.ends_with(",synthetic"), "{head}");
        assert!(rows.lines().all(|row| row.ends_with(",true")), "{rows}");
    }
}

#[test]
fn every_file_of_a_dry_run_says_so() {
    let scratch = Scratch::new("simulate-marks");
    let _ = run(&scratch, "data", 1, 2);
    let data = scratch.path("data");
    let all = |part: &str| fs::read_dir(data.join(part)).unwrap().map(|entry| entry.unwrap().path());
    let of_people: Vec<_> = ["journals", "consent"].into_iter().flat_map(all).collect();
    let others = ["private/links.json", "withdrawn.jsonl", "synthetic.json"].map(|name| data.join(name));
    assert!(of_people.len() > 40);
    for path in of_people.iter().chain(&others) {
        let text = fs::read_to_string(path).unwrap();
        assert!(text.contains("synthetic\":true") || text.contains("synthetic\": true"), "{}: {text}", path.display());
    }
}

#[test]
fn what_happens_is_what_the_study_asks_for() {
    let scratch = Scratch::new("simulate-plan");
    let (_, records) = run(&scratch, "data", 1, 2);
    let mut endings = BTreeMap::<&str, usize>::new();
    for progress in &records.progress {
        for done in progress.done() {
            if let Some(ending) = done.ending {
                *endings.entry(ending.name()).or_default() += 1;
                let is_practice = progress.plan().is_practice(done.step);
                assert!(is_practice == done.probed.is_empty(), "probes are asked, but not in practice: {done:?}");
                let step = &progress.plan().steps[done.step];
                let is_tutorial = matches!(step, Step::Mission(mission) if mission.is_tutorial());
                let is_whole = is_tutorial && done.ending == Some(Ending::Complete);
                assert_eq!(is_whole, done.tried.len() == 4, "{done:?}");
                assert!(is_practice || done.played_s <= 120.0, "{done:?}");
            }
        }
        let times: Vec<u64> = progress.done().iter().map(|done| done.ended_ms).collect();
        assert!(times.is_sorted());
    }
    assert!(["complete", "skipped"].iter().all(|ending| endings.contains_key(ending)), "{endings:?}");
}

#[test]
fn a_dry_run_is_never_mixed_with_people() {
    let scratch = Scratch::new("simulate-folder");
    let files = BTreeMap::from([("study.toml".to_owned(), "a study".to_owned())]);
    let people = scratch.path("people");
    drop(Folder::begin(&people, &files).unwrap());
    let error = Folder::begin_synthetic(&people, &files, &0).unwrap_err().to_string();
    assert!(error.contains("is not empty") && error.contains("name a folder"), "{error}");
    let (dry, note) = (scratch.path("dry"), BTreeMap::from([("seed", 1)]));
    drop(Folder::begin_synthetic(&dry, &files, &note).unwrap());
    for refused in [Folder::begin(&dry, &files), Folder::begin_synthetic(&dry, &files, &note)] {
        let error = refused.unwrap_err().to_string();
        assert!(error.contains("holds a dry run") && error.contains("choose another folder"), "{error}");
    }
}

/// The study in pairs, where this follows when somebody waits in vain.
fn in_pairs(partner_absent: &str) -> String {
    let pair = format!("pair = {{ partner_absent = \"{partner_absent}\", skip = \"either\" }}");
    STUDY.replace("participants = 4", &format!("participants = 4\nparticipants_per_session = 2\n{pair}"))
}

#[test]
fn pairs_are_played_by_two_people_together() {
    let scratch = Scratch::new("simulate-pairs");
    let leaving = Leaving { declines: 0.1, withdraws: 0.1, stops: 0.1, ..Leaving::default() };
    let people = People { leaving, ..People::default() };
    let run = DryRun { participants: 31, seed: 1, people, program: "1".to_owned() };
    let (simulated, records) = run_study(&in_pairs("alone"), &scratch, "one", &run, 1);
    let _ = run_study(&in_pairs("alone"), &scratch, "again", &run, 3);
    assert_eq!(tables_in(&scratch.path("one")), tables_in(&scratch.path("again")));
    assert!(simulated.finished > 10 && simulated.withdrawn > 0, "{simulated:?}");
    let at = |place: u32| records.progress.iter().find(|one| one.plan().place == place);
    let mut together = 0;
    for progress in &records.progress {
        let Some(partner) = at(partner_of(progress.plan().place)) else { continue };
        assert_eq!(progress.plan().steps, partner.plan().steps);
        for done in progress.done().iter().filter(|done| done.together > 0) {
            // What both played is the same session, and ended alike.
            let theirs = partner.done().iter().find(|other| other.step == done.step);
            assert!(theirs.is_some_and(|other| (other.together, other.attempts) == (1, 1)), "{done:?} {theirs:?}");
            together += 1;
        }
    }
    assert!(together > 40, "{together}");
    let logs = fs::read_dir(scratch.path("one/logs")).unwrap().flatten().map(|entry| entry.file_name());
    let logs: Vec<String> = logs.map(|name| name.to_string_lossy().into_owned()).collect();
    assert!(logs.iter().any(|log| log.starts_with("pair")), "{logs:?}");
    for place in records.withdrawn.iter().filter_map(|name| place_of(name)) {
        let pair = format!("{}-", pair_label(pair_of(place)));
        assert!(!logs.iter().any(|log| log.starts_with(&pair)), "{pair}: {logs:?}");
    }
}

#[test]
fn who_has_no_partner_waits_and_goes_alone_or_stops_as_the_study_says() {
    for (partner_absent, progress, alone) in [("alone", "finished", 4), ("end", "parted", 0), ("wait", "waiting", 0)] {
        let scratch = Scratch::new(&format!("simulate-alone-{partner_absent}"));
        let leaving = Leaving { withdraws: 0.0, stops: 0.0, ..Leaving::default() };
        let people = People { leaving, ..People::default() };
        let run = DryRun { participants: 3, seed: 1, people, program: "1".to_owned() };
        let (_, records) = run_study(&in_pairs(partner_absent), &scratch, "data", &run, 1);
        let last = &records.progress[2];
        assert_eq!((records.progress.len(), tables::progress_name(last)), (3, progress));
        let missions = last.done().iter().filter(|done| done.ending.is_some() && done.together == 0).count();
        assert_eq!(missions, alone, "{last:?}");
        assert!(records.progress[..2].iter().all(|one| one.phase() == &Phase::Finished));
    }
}
