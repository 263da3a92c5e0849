//! Participants keep their places and conditions, whatever dies.

use std::{fs, path::Path, sync::Arc};

use super::*;
use crate::{
    check::{Program, StudyFile},
    folder::Folder,
    progress::{Doing, Phase},
    registry::Who,
    scratch::Scratch,
    session::{PageAddress, Playing},
    web::newcomers_event,
};

struct Anything;

impl Program for Anything {
    fn check_arguments(&self, _: &[String]) -> Result<(), String> {
        Ok(())
    }

    fn check_mission(&self, _: &str) -> Result<(), String> {
        Ok(())
    }
}

const STUDY: &str = r#"
title = "A study"
contact = "us"
seed = 5
participants = 3
assignment = "latin_square"
missions = ["one", "two"]
information = { file = "sheet.md", version = "1" }
consent = { file = "sheet.md", version = "2", required = ["Yes.", "Indeed."] }
factor = [{ name = "ask", kind = "within", level = [
    { name = "never", settings = { ask = "never" } }, { name = "always", settings = { ask = "always" } },
] }]
block = [{ kind = "missions", minutes = 5 }]
"#;

/// Sessions that are what a test says.
#[derive(Clone, Default)]
struct Stage(Arc<Mutex<Vec<(Wanted, Look)>>>);

struct Act {
    stage: Stage,
    number: usize,
}

impl Stage {
    fn set(&self, number: usize, look: Look) {
        self.0.lock().unwrap()[number].1 = look;
    }

    fn names(&self) -> Vec<String> {
        self.0.lock().unwrap().iter().map(|(wanted, _)| wanted.name.clone()).collect()
    }

    fn before(&self, number: usize) -> Vec<String> {
        let name = |path: &std::path::PathBuf| path.file_name().unwrap().to_string_lossy().into_owned();
        self.0.lock().unwrap()[number].0.before.iter().map(name).collect()
    }

    fn arguments(&self, number: usize) -> Vec<String> {
        self.0.lock().unwrap()[number].0.arguments.clone()
    }
}

impl Player for Stage {
    fn start(&mut self, wanted: &Wanted) -> Result<Box<dyn Playing>, String> {
        fs::write(&wanted.log, "log").unwrap();
        let mut all = self.0.lock().unwrap();
        all.push((wanted.clone(), Look::Open(PageAddress { port: 1, token: "t".to_owned() })));
        Ok(Box::new(Act { stage: self.clone(), number: all.len() - 1 }))
    }
}

impl Playing for Act {
    fn look(&mut self) -> Look {
        self.stage.0.lock().unwrap()[self.number].1.clone()
    }

    fn end(&mut self) {
        self.stage.set(self.number, Look::Gone("as asked".to_owned()));
    }
}

struct Case {
    scratch: Scratch,
    stage: Stage,
    registry: Option<Registry>,
}

impl Case {
    fn new(name: &str) -> Self {
        let scratch = Scratch::new(&format!("keeper-{name}"));
        let _ = scratch.write("sheet.md", "Read this.");
        let _ = scratch.write("study.toml", STUDY);
        let mut case = Self { scratch, stage: Stage::default(), registry: None };
        case.start_again();
        case
    }

    /// Drops all that is in memory.
    fn start_again(&mut self) {
        self.registry = None;
        let file = StudyFile::read(&self.scratch.path("study.toml")).unwrap();
        let study = file.check(&Anything).unwrap();
        let folder = Folder::begin(&self.scratch.path("data"), &study.files).unwrap();
        self.registry = Some(Registry::new(study, folder).unwrap());
    }

    fn registry(&mut self) -> &mut Registry {
        self.registry.as_mut().unwrap()
    }

    /// Somebody who signs up and agrees; their place.
    fn enrol(&mut self) -> u32 {
        let registry = self.registry();
        let token = registry.sign_up().unwrap();
        let Some(Who::Newcomer(index)) = registry.who(&token) else { panic!("a newcomer") };
        registry.enrol(index, "2", 2).unwrap();
        let Some(Who::Participant(place)) = registry.who(&token) else { panic!("a participant") };
        place
    }

    fn apply(&mut self, place: u32, event: &Event) {
        self.registry().apply(place, event).unwrap();
    }

    /// Looks after all, with everybody's page open, at most so many sessions at a time.
    fn look_after(&mut self, most: usize) {
        let mut stage = self.stage.clone();
        let registry = self.registry();
        for participant in registry.participants.values_mut() {
            participant.seen = Some(Instant::now());
            participant.retry_at = None;
        }
        registry.look_after(&mut stage, most);
    }

    fn phase(&mut self, place: u32) -> Phase {
        self.registry().participants[&place].progress.phase().clone()
    }
}

/// The names of all files below a folder.
fn files(path: &Path) -> Vec<String> {
    let entries = fs::read_dir(path).unwrap().flatten();
    let below = |path: std::path::PathBuf| match path.is_dir() {
        true => files(&path),
        false => vec![path.file_name().unwrap().to_string_lossy().into_owned()],
    };
    let mut all: Vec<String> = entries.flat_map(|entry| below(entry.path())).collect();
    all.sort();
    all
}

#[test]
fn nothing_is_written_down_before_consent() {
    let mut case = Case::new("consent");
    let data = case.scratch.path("data");
    let before = files(&data);
    let registry = case.registry();
    let token = registry.sign_up().unwrap();
    let Some(Who::Newcomer(index)) = registry.who(&token) else { panic!("a newcomer") };
    // Who does not agree reads that nothing of theirs was recorded, and may come back to the form.
    for (event, page) in [(Event::Read, "consent"), (Event::Declined, "declined"), (Event::Read, "consent")] {
        newcomers_event(registry, index, &event).unwrap();
        assert_eq!(registry.page(Who::Newcomer(index))["page"], page);
        assert_eq!(registry.page(Who::Newcomer(index))["contact"], "us");
    }
    assert!(registry.enrol(index, "1", 2).is_err(), "another version of the form");
    assert!(registry.enrol(index, "2", 1).is_err(), "a box that is not ticked");
    assert_eq!(files(&data), before);
    registry.enrol(index, "2", 2).unwrap();
    let new: Vec<_> = files(&data).into_iter().filter(|name| !before.contains(name)).collect();
    assert_eq!(new, ["P01.json", "P01.jsonl"]);
}

#[test]
fn sessions_are_as_many_as_may_be_and_others_wait() {
    let mut case = Case::new("queue");
    let (first, second) = (case.enrol(), case.enrol());
    case.apply(second, &Event::GoesOn);
    case.apply(first, &Event::GoesOn);
    case.look_after(1);
    assert_eq!(case.stage.names(), ["P02-01-1"]);
    assert_eq!(case.registry().page(Who::Participant(first))["ahead"], 0);
    case.apply(second, &Event::Over { ending: Ending::Stopped });
    case.look_after(1);
    assert_eq!(case.stage.names(), ["P02-01-1", "P01-01-1"]);
    // A place more than planned is none.
    case.enrol();
    assert!(case.registry().sign_up().is_err());
}

#[test]
fn who_is_away_gets_no_session() {
    let mut case = Case::new("away");
    let place = case.enrol();
    case.apply(place, &Event::GoesOn);
    let mut stage = case.stage.clone();
    case.registry().participants.get_mut(&place).unwrap().seen = None;
    case.registry().look_after(&mut stage, 1);
    assert!(case.stage.names().is_empty());
}

#[test]
fn a_dead_session_and_a_dead_server_leave_everybody_where_they_were() {
    let mut case = Case::new("dead");
    let place = case.enrol();
    case.apply(place, &Event::GoesOn);
    case.look_after(1);
    let plan = case.registry().participants[&place].progress.plan().clone();
    case.apply(place, &Event::Played { seconds: 12.5 });
    case.stage.set(0, Look::Gone("signal 9".to_owned()));
    case.look_after(1);
    case.look_after(1);
    assert_eq!(case.stage.names(), ["P01-01-1", "P01-01-2"]);
    case.start_again();
    assert_eq!(case.phase(place), Phase::At(0, Doing::Queued { again: true }));
    case.look_after(1);
    assert_eq!(case.stage.names()[2], "P01-01-3");
    assert_eq!(case.stage.arguments(2), case.stage.arguments(0));
    // It goes on where the last one was.
    assert_eq!(case.stage.before(2), ["P01-01-2.mcap", "P01-01-1.mcap"]);
    let progress = &case.registry().participants[&place].progress;
    assert_eq!((progress.plan(), progress.played_s()), (&plan, 12.5));
}

#[test]
fn time_is_up_when_it_was_played() {
    let mut case = Case::new("time");
    let place = case.enrol();
    case.apply(place, &Event::GoesOn);
    case.look_after(1);
    case.look_after(1);
    case.apply(place, &Event::Played { seconds: 299.9 });
    assert!(case.registry().page(Who::Participant(place))["left_s"].as_f64().unwrap() <= 0.2);
    case.registry().participants.get_mut(&place).unwrap().live.as_mut().unwrap().unsaved_s = 0.2;
    case.look_after(1);
    assert_eq!(case.phase(place), Phase::At(1, Doing::Ready));
    let done = &case.registry().participants[&place].progress.done()[0];
    assert_eq!((done.ending, done.played_s >= 300.0), (Some(Ending::TimeUp), true));
}

#[test]
fn who_withdraws_while_playing_leaves_nothing_once_the_session_has_ended() {
    let mut case = Case::new("withdraw");
    let (place, other) = (case.enrol(), case.enrol());
    for place in [place, other] {
        case.apply(place, &Event::GoesOn);
    }
    case.look_after(2);
    let token = case.registry().links.participants[&place].clone();
    case.apply(place, &Event::Withdrew);
    assert_eq!(case.registry().page(Who::Participant(place))["page"], "withdrawn");
    case.look_after(2);
    let left: Vec<_> = files(&case.scratch.path("data")).into_iter().filter(|name| name.starts_with("P01")).collect();
    assert_eq!(left, [] as [String; 0]);
    assert_eq!(case.registry().who(&token), Some(Who::Withdrawn));
    assert_eq!(case.registry().reserve(None).unwrap(), 3, "a place is given once");
    case.start_again();
    assert_eq!(case.registry().who(&token), None);
    assert_eq!(case.phase(other), Phase::At(0, Doing::Queued { again: true }));
}

#[test]
fn a_participants_page_learns_nothing_about_conditions() {
    let mut case = Case::new("blind");
    let place = case.enrol();
    let mut pages = vec![case.registry().page(Who::Participant(place))];
    case.apply(place, &Event::GoesOn);
    pages.push(case.registry().page(Who::Participant(place)));
    case.look_after(1);
    case.look_after(1);
    pages.push(case.registry().page(Who::Participant(place)));
    let shown: Vec<_> = pages.iter().map(|page| page["page"].as_str().unwrap()).collect();
    assert_eq!(shown, ["ready", "waiting", "mission"]);
    for page in pages {
        let text = page.to_string();
        assert!(!text.contains("never") && !text.contains("always") && !text.contains("ask"), "{text}");
    }
    let row = case.registry().overview(1).to_string();
    assert!(row.contains("ask=never") && row.contains("ask=always"), "the experimenter's learns all: {row}");
}
