//! Recorded sessions step by step, and what comes of other steps.

#![allow(clippy::unwrap_used)]

use std::{
    fs,
    path::{Path, PathBuf},
    sync::Arc,
};

use cohabit_cdf::{Action, Catalog, mission};
use cohabit_engine::{Replayer, replay::replay};
use cohabit_eval::{
    Line, Settings, Task, play, solve,
    steps::{Instead, RerunError, Step, Told, listed, rerun, steps},
};
use cohabit_language::{Asking, Knows, Language};
use cohabit_record::Log;
use cohabit_tables::Played;

/// A folder that is empty, for the logs of a test.
fn folder(test: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("cohabit-steps-{test}-{}", std::process::id()));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn catalog() -> Arc<Catalog> {
    Arc::new(Catalog::builtin())
}

/// Has this said in a mission, one after the other; gives the log.
fn record(folder: &Path, said: &[&str]) -> PathBuf {
    let (_, cdf) = mission::builtin().iter().find(|(file, _)| file.starts_with("make_cereal")).unwrap();
    let line = |text: &&str| Line::Utterance { text: (*text).to_owned(), answers: Vec::new() };
    let script = said.iter().map(line).collect();
    let task = Task { id: "first".to_owned(), family: None, cdf: (*cdf).to_owned(), preparation: Vec::new(), script };
    let (knows, asking) = (Knows::Everything, Asking::Never);
    let settings = Settings { knows, asking, record: Some(folder.to_owned()), ..Settings::default() };
    play(&task, &settings, &Language::new(catalog())).unwrap().log.unwrap()
}

fn open(log: &Path) -> Played {
    Played::open(log, &catalog()).unwrap()
}

fn told(log: &Path) -> Told {
    let played = open(log);
    let mut replayer = Replayer::new(played.log(), catalog()).unwrap();
    let language = Language::new(catalog());
    steps(&played, &mut replayer, &language, &mut |_, _| Ok::<(), ()>(())).unwrap()
}

/// Goes on otherwise; gives the new log, which replays.
fn changed(log: &Path, step: usize, instead: &str) -> PathBuf {
    let out = log.with_file_name("second.mcap");
    rerun(&open(log), &Language::new(catalog()), step, &Instead::read(instead), &out).unwrap();
    let new = Log::open(&out).unwrap();
    assert_eq!((new.problems(), replay(&new, catalog()).unwrap().difference), (Vec::new(), None));
    assert_eq!(new.session.settings["changed_from"], "first");
    out
}

/// What was said and done, when, and how it ended.
fn deeds(steps: &[Step]) -> Vec<(u64, String)> {
    let of = |step: &Step| {
        let said = step.said.iter().map(|said| format!("{} {:?} {:?}", said.text, said.replies, said.ended));
        let did = step.did.iter().map(|did| {
            let outcome = did.outcome.as_ref().map(|outcome| (outcome.status, outcome.tick));
            format!("{:?} {outcome:?}", did.action)
        });
        (step.tick, said.chain(did).collect())
    };
    steps.iter().map(of).collect()
}

#[test]
fn steps_tell_what_was_understood_done_and_met() {
    let folder = folder("told");
    let log = record(&folder, &["pick up the bowl", "look around"]);
    let Told { steps, problem } = told(&log);
    assert_eq!(problem, None);
    assert!(steps.iter().map(|step| step.step).eq(1..=steps.len()), "{steps:#?}");
    let said: Vec<_> = steps.iter().filter_map(|step| step.said.as_ref()).collect();
    assert_eq!(said.iter().map(|said| said.text.as_str()).collect::<Vec<_>>(), ["pick up the bowl", "look around"]);
    for said in &said {
        let understood = said.understood.as_ref().unwrap();
        assert!(understood.as_recorded, "{said:#?}");
        assert_eq!((understood.readings[0].by, &understood.readings[0].text), ("grammar", &said.text));
    }
    let understood = said[0].understood.as_ref().unwrap();
    assert!(understood.meaning.contains("bowl") && understood.sureness > 0.5, "{understood:#?}");
    let meant = &understood.referents[0];
    assert!(meant.name.contains("bowl") && (0.0..=1.0).contains(&meant.probability), "{understood:#?}");
    let picks = |step: &&Step| step.did.as_ref().is_some_and(|did| matches!(did.action, Action::PickUp { .. }));
    let pick = steps.iter().find(picks).unwrap();
    let did = pick.did.as_ref().unwrap();
    let target = did.target.as_ref().unwrap();
    assert_eq!((pick.turn, target.object, did.outcome.as_ref().unwrap().success), (steps[0].turn, meant.object, true));
    let line = serde_json::to_value(pick).unwrap();
    assert!(line["did"]["target"]["instance"].is_string() && line.get("said").is_none(), "{line:#}");
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn steps_of_who_is_told_nothing_have_goals() {
    let folder = folder("goals");
    let (_, cdf) = mission::builtin().iter().find(|(file, _)| file.starts_with("cold_soda")).unwrap();
    let (preparation, script) = (Vec::new(), Vec::new());
    let task = Task { id: "first".to_owned(), family: None, cdf: (*cdf).to_owned(), preparation, script };
    let settings = Settings { record: Some(folder.clone()), ..Settings::expert(1) };
    let log = solve(&task, &settings, &catalog()).unwrap().log.unwrap();
    let Told { steps, problem } = told(&log);
    assert_eq!(problem, None);
    assert!(steps.iter().all(|step| step.said.is_none() && step.turn.is_none()), "{steps:#?}");
    let met = steps.iter().flat_map(|step| &step.goals_met).count();
    assert!(met > 0, "{steps:#?}");
    // A robot that does not do what people say repeats what it did.
    let last = steps.len();
    let again = changed(&log, last, &serde_json::to_string(&steps[last - 1].did.as_ref().unwrap().action).unwrap());
    assert_eq!(deeds(&listed(&open(&again))), deeds(&listed(&open(&log))));
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn the_same_words_lead_to_the_same() {
    let folder = folder("same");
    let log = record(&folder, &["pick up the bowl", "put the bowl on the table"]);
    let again = changed(&log, 1, "pick up the bowl");
    assert_eq!(deeds(&listed(&open(&again))), deeds(&listed(&open(&log))));
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn other_words_lead_to_other_deeds_and_what_follows_is_said_again() {
    let folder = folder("words");
    let log = record(&folder, &["pick up the bowl", "look around"]);
    let steps = told(&changed(&log, 1, "pick up the cereal box")).steps;
    let said: Vec<_> = steps.iter().filter_map(|step| step.said.as_ref()).map(|said| said.text.as_str()).collect();
    assert_eq!(said, ["pick up the cereal box", "look around"]);
    let targets = steps.iter().filter_map(|step| step.did.as_ref()?.target.as_ref());
    let instances: Vec<_> = targets.map(|target| target.instance.to_lowercase()).collect();
    assert!(!instances.is_empty() && instances.iter().all(|name| name.contains("cereal")), "{instances:?}");
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn another_command_takes_the_place_of_one_and_the_robot_goes_on_from_it() {
    let folder = folder("command");
    let log = record(&folder, &["pick up the bowl"]);
    let first = told(&log).steps;
    let at = first.iter().position(|step| step.did.is_some()).unwrap();
    let steps = told(&changed(&log, at + 1, "LookAround")).steps;
    assert_eq!(deeds(&steps[1..at]), deeds(&first[1..at]));
    let [before, after] = [&first, &steps].map(|steps| steps[at].did.as_ref().unwrap());
    assert_eq!((after.command, after.action), (before.command, Action::LookAround));
    assert!(steps.len() > at + 1, "the robot goes on: {steps:#?}");
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn what_cannot_take_a_steps_place_is_refused() {
    let folder = folder("refused");
    let log = record(&folder, &["pick up the bowl"]);
    let played = open(&log);
    let out = folder.join("second.mcap");
    for (step, instead, part) in [
        (0, "stop", "there is none"),
        (99, "stop", "there is none"),
        (1, "{\"GoTo\": {}}", "words take its place"),
        (2, "stop", "as JSON"),
        (2, "{\"Fly\": {}}", "is no action"),
        (2, "{\"type\": \"Pickup\", \"pickup\": {\"object\": {\"id\": \"Unicorn_1\"}}}", "Unicorn_1"),
    ] {
        let refused = rerun(&played, &Language::new(catalog()), step, &Instead::read(instead), &out).unwrap_err();
        assert!(matches!(&refused, RerunError::Refused { reason, .. } if reason.contains(part)), "{refused}");
        assert!(!out.exists(), "{refused}");
    }
    fs::remove_dir_all(folder).unwrap();
}
