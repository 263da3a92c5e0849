//! Participants keep their places and conditions, whatever dies.

mod pairs;

use std::{collections::BTreeMap, fs, path::Path, sync::Arc};

use cohabit_dialog::Given;

use super::*;
use crate::{
    check::StudyFile,
    folder::Folder,
    progress::{Doing, Phase},
    registry::Who,
    scratch::{Anything, Scratch},
    session::{PageAddress, Playing},
    web::{Sent, newcomers_event, participants_event},
};

const STUDY: &str = r#"
title = "A study"
contact = "us"
seed = 5
participants = 3
assignment = "latin_square"
missions = ["one", "two"]
information = { file = "sheet.md", version = "1" }
consent = { file = "sheet.md", version = "2", required = ["Yes.", "Indeed."], optional = [{ text = "Hear me.", audio = true }] }
factor = [{ name = "ask", kind = "within", level = [
    { name = "never", settings = { ask = "never" } }, { name = "always", settings = { ask = "always", clock = true } },
] }]
block = [{ kind = "missions", minutes = 5, settings = { record-audio = true } }, { kind = "questionnaire", questionnaires = ["tlx"] }]
"#;

/// Sessions that are what a test says.
#[derive(Clone, Default)]
struct Stage(
    Arc<Mutex<Vec<(Wanted, Look)>>>,
    Arc<Mutex<Vec<Happening>>>,
    Arc<Mutex<Vec<Activity>>>,
    Arc<Mutex<Option<bool>>>,
);

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
        let seats = (0..wanted.seats).map(|seat| format!("seat {seat}")).collect();
        let page = PageAddress { port: 1, token: "t".to_owned(), wizard: None, seats };
        all.push((wanted.clone(), Look::Open(page)));
        Ok(Box::new(Act { stage: self.clone(), number: all.len() - 1 }))
    }
}

impl Playing for Act {
    fn look(&mut self) -> Look {
        self.stage.0.lock().unwrap()[self.number].1.clone()
    }

    fn happened(&mut self) -> Vec<Happening> {
        std::mem::take(&mut *self.stage.1.lock().unwrap())
    }

    fn tried(&mut self, _: usize) -> Vec<Activity> {
        std::mem::take(&mut *self.stage.2.lock().unwrap())
    }

    fn lacks_wizard(&self) -> bool {
        let look = &self.stage.0.lock().unwrap()[self.number].1;
        matches!(look, Look::Open(page) if page.wizard.is_some())
    }

    fn hold(&mut self, stands_still: bool) {
        *self.stage.3.lock().unwrap() = Some(stands_still);
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
        Self::of(name, STUDY)
    }

    fn of(name: &str, study: &str) -> Self {
        let scratch = Scratch::new(&format!("keeper-{name}"));
        let _ = scratch.write("sheet.md", "Read this.");
        let _ = scratch.write("study.toml", study);
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

    /// Somebody who signs up and agrees to what they have to; their place.
    fn enrol(&mut self) -> u32 {
        self.enrol_with(&[0, 1])
    }

    /// The same with these boxes ticked.
    fn enrol_with(&mut self, ticked: &[usize]) -> u32 {
        let registry = self.registry();
        let token = registry.sign_up().unwrap();
        let Some(Who::Newcomer(index)) = registry.who(&token) else { panic!("a newcomer") };
        registry.enrol(index, "2", ticked).unwrap();
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
    assert!(registry.enrol(index, "1", &[0, 1]).is_err(), "another version of the form");
    for ticked in [&[][..], &[1], &[0, 2], &[1, 2, 3]] {
        assert!(registry.enrol(index, "2", ticked).is_err(), "a box that is not ticked");
    }
    assert_eq!(files(&data), before);
    registry.enrol(index, "2", &[1, 0]).unwrap();
    let consent = fs::read_to_string(data.join("consent/P01.json")).unwrap();
    let consent: crate::folder::Consent = serde_json::from_str(&consent).unwrap();
    assert_eq!((consent.agreed.len(), consent.declined), (2, vec!["Hear me.".to_owned()]));
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
fn who_agrees_to_be_heard_is_and_nobody_else() {
    let mut case = Case::new("audio");
    for (ticked, is_heard) in [(&[0, 1, 2][..], true), (&[0, 1], false)] {
        let place = case.enrol_with(ticked);
        case.apply(place, &Event::GoesOn);
        case.look_after(2);
        case.look_after(2);
        let arguments = case.stage.arguments(case.stage.names().len() - 1);
        let has = |flag: &str| arguments.iter().any(|one| one == flag);
        assert_eq!((has("--record-audio"), has("--hide=microphone")), (is_heard, !is_heard), "{arguments:?}");
        let page = case.registry().page(Who::Participant(place));
        assert_eq!(page["session"]["has_microphone"], is_heard);
    }
    // What was agreed to outlasts the server.
    case.start_again();
    assert!(case.registry().participants[&1].progress.agrees_to_audio());
    assert!(!case.registry().participants[&2].progress.agrees_to_audio());
}

#[test]
fn the_wizards_page_is_led_to_the_seat_and_the_participants_page_is_as_ever() {
    let mut case = Case::new("seat");
    let place = case.enrol();
    case.apply(place, &Event::GoesOn);
    case.look_after(1);
    case.look_after(1);
    let page = |case: &mut Case| {
        let mut page = case.registry().page(Who::Participant(place));
        page["left_s"].take();
        page
    };
    let before = page(&mut case);
    let sessions = case.registry().wizard_sessions()["sessions"].clone();
    assert_eq!((&before["page"], &sessions), (&"mission".into(), &serde_json::json!([])));
    let lacks_wizard = |case: &mut Case| case.registry().overview(1)["participants"][0]["lacks_wizard"].clone();
    assert_eq!(lacks_wizard(&mut case), false);
    let led = PageAddress { port: 1, token: "t".to_owned(), wizard: Some("w".to_owned()), seats: Vec::new() };
    case.stage.set(0, Look::Open(led));
    case.look_after(1);
    let seat = &case.registry().wizard_sessions()["sessions"][0];
    assert_eq!((&seat["participant"], &seat["port"], &seat["token"]), (&"P01".into(), &1.into(), &"w".into()));
    assert_eq!(page(&mut case), before);
    assert_eq!(lacks_wizard(&mut case), true, "the experimenter is alarmed");
    assert!(case.registry().overview(1)["wizard"].is_null(), "this study has none");
}

#[test]
fn a_clock_is_shown_where_a_setting_says_so_and_the_score_nowhere_else() {
    let mut case = Case::new("clock");
    let place = case.enrol();
    for step in 0..2 {
        case.apply(place, &Event::GoesOn);
        case.look_after(1);
        case.look_after(1);
        let arguments = case.stage.arguments(step);
        let page = case.registry().page(Who::Participant(place));
        assert_eq!(page["page"], "mission");
        assert_eq!(page["left_s"].is_number(), arguments.contains(&"--ask=always".to_owned()), "{page}");
        assert!(arguments.contains(&"--hide=score".to_owned()), "{arguments:?}");
        assert!(!arguments.iter().any(|one| one.contains("clock")), "{arguments:?}");
        case.apply(place, &Event::Over { ending: Ending::Complete });
    }
}

#[test]
fn what_was_filled_in_is_there_again_and_counts_for_nothing() {
    let mut case = Case::new("draft");
    let place = case.enrol();
    for _ in 0..2 {
        case.apply(place, &Event::GoesOn);
        case.look_after(1);
        case.apply(place, &Event::Over { ending: Ending::Complete });
    }
    let page = |case: &mut Case| case.registry().page(Who::Participant(place));
    assert_eq!(page(&mut case)["draft"], serde_json::json!([]));
    let answers = || vec![Some(Given::Value(5)), None, None, None, None, None];
    let sent = |answers: Vec<Option<Given>>| Sent {
        step: Some(3),
        event: Event::Drafted { questionnaire: "tlx".to_owned(), answers },
    };
    participants_event(case.registry(), place, &sent(answers())).unwrap();
    participants_event(case.registry(), place, &sent(answers())).unwrap();
    participants_event(case.registry(), place, &sent(vec![None])).unwrap();
    let long = [vec![Some(Given::Text("x".repeat(20_000)))], answers()[1..].to_vec()].concat();
    assert!(participants_event(case.registry(), place, &sent(long)).is_err());
    let journal = fs::read_to_string(case.scratch.path("data/journals/P01.jsonl")).unwrap();
    assert_eq!(journal.matches("drafted").count(), 1, "what is sent twice is kept once, and no more than a form holds");
    case.start_again();
    assert_eq!(page(&mut case)["draft"][0], serde_json::json!({ "value": 5 }));
    assert_eq!(case.phase(place), Phase::At(2, Doing::Ready));
    let done = case.registry().participants[&place].progress.done().len();
    assert_eq!(done, 2);
}

#[test]
fn a_probe_comes_when_it_is_due_and_its_answer_is_in_the_tables() {
    let mut case = Case::new("probe");
    let probe = "\n[[probe]]\nquestionnaire = 'trust.toml'\nat = 'goal_met'\n";
    let _ = case.scratch.write("trust.toml", "title = 'T'\n[[item]]\nask = 'Trust?'\nscale = { least = 1, most = 5 }");
    let _ = case.scratch.write("study.toml", &format!("{STUDY}{probe}"));
    case.start_again();
    let place = case.enrol();
    case.apply(place, &Event::GoesOn);
    case.look_after(1);
    case.look_after(1);
    let page = |case: &mut Case| case.registry().page(Who::Participant(place))["probe"].clone();
    assert!(page(&mut case).is_null());
    case.stage.1.lock().unwrap().push(Happening::GoalMet);
    case.look_after(1);
    let shown = page(&mut case);
    assert_eq!((&shown["number"], &shown["item"]["ask"]), (&serde_json::json!(0), &serde_json::json!("Trust?")));
    let sent =
        |value| Sent { step: Some(1), event: Event::ProbeAnswered { probe: 0, answer: Some(Given::Value(value)) } };
    assert!(participants_event(case.registry(), place, &sent(9)).is_err(), "no place of the scale");
    participants_event(case.registry(), place, &sent(4)).unwrap();
    assert!(page(&mut case).is_null());
    case.apply(place, &Event::Over { ending: Ending::Complete });
    let registry = case.registry();
    let all = [registry.participants[&place].progress.clone()];
    let rows = tables::probes::table(&registry.study, &all, false).rows;
    assert!(rows.len() == 1 && rows[0].contains(&cohabit_tables::Cell::Whole(4)), "{rows:?}");
}

#[test]
fn what_is_asked_at_the_goal_that_completes_a_mission_is_answered_before_the_study_goes_on() {
    let mut case = Case::new("probe-last");
    let probe = "\n[[probe]]\nquestionnaire = 'trust.toml'\nat = 'goal_met'\n";
    let _ = case.scratch.write("trust.toml", "title = 'T'\n[[item]]\nask = 'Trust?'\nscale = { least = 1, most = 5 }");
    let _ = case.scratch.write("study.toml", &format!("{STUDY}{probe}"));
    case.start_again();
    let place = case.enrol();
    let ended = |case: &mut Case, ago: Duration| {
        let live = case.registry().participants.get_mut(&place).unwrap().live.as_mut().unwrap();
        live.over = Some((Ending::Complete, Instant::now().checked_sub(ago).unwrap()));
        case.look_after(1);
    };
    for mission in 0..2 {
        case.apply(place, &Event::GoesOn);
        (0..2).for_each(|_| case.look_after(1));
        let met = [Happening::QuestionAsked, Happening::GoalMet];
        case.stage.1.lock().unwrap().extend(met);
        case.stage.set(mission, Look::Over(Ending::Complete));
        case.look_after(1);
        let page = case.registry().page(Who::Participant(place));
        assert_eq!((&page["is_over"], &page["probe"]["number"]), (&true.into(), &0.into()), "{page}");
        ended(&mut case, ENDING_SEEN);
        assert_eq!(case.phase(place), Phase::At(mission, Doing::Playing));
        if mission == 0 {
            let event = Event::ProbeAnswered { probe: 0, answer: Some(Given::Value(4)) };
            participants_event(case.registry(), place, &Sent { step: Some(1), event }).unwrap();
            assert!(case.registry().page(Who::Participant(place))["probe"].is_null());
            case.look_after(1);
        } else {
            // Who does not answer is not kept for ever.
            ended(&mut case, LAST_ANSWER);
        }
        assert_eq!(case.phase(place), Phase::At(mission + 1, Doing::Ready));
    }
    let done = case.registry().participants[&place].progress.done().to_vec();
    let answered = done.iter().map(|one| (one.ending, one.probed[0].answer.is_some())).collect::<Vec<_>>();
    assert_eq!(answered, [(Some(Ending::Complete), true), (Some(Ending::Complete), false)]);
}

#[test]
fn a_mission_stands_still_for_the_experimenter_and_for_a_question_that_wants_it_so() {
    let mut case = Case::new("still");
    let probe = "\n[[probe]]\nquestionnaire = 'trust.toml'\nat = 'goal_met'\npause = true\n";
    let _ = case.scratch.write("trust.toml", "title = 'T'\n[[item]]\nask = 'Trust?'\nscale = { least = 1, most = 5 }");
    let _ = case.scratch.write("study.toml", &format!("{STUDY}{probe}"));
    case.start_again();
    let place = case.enrol();
    assert!(case.registry().pause(place, true).is_err(), "no mission is played");
    case.apply(place, &Event::GoesOn);
    (0..2).for_each(|_| case.look_after(1));
    let held = |case: &mut Case| {
        case.look_after(1);
        *case.stage.3.lock().unwrap()
    };
    let unsaved_s = |case: &mut Case| {
        let live = case.registry().participants.get_mut(&place).unwrap().live.as_mut().unwrap();
        live.looked = Instant::now().checked_sub(Duration::from_millis(50)).unwrap();
        let before = live.unsaved_s;
        case.look_after(1);
        case.registry().participants[&place].live.as_ref().unwrap().unsaved_s - before
    };
    assert_eq!(held(&mut case), Some(false));
    assert!(unsaved_s(&mut case) > 0.0);
    case.registry().pause(place, true).unwrap();
    assert_eq!((held(&mut case), unsaved_s(&mut case)), (Some(true), 0.0));
    assert_eq!(case.registry().page(Who::Participant(place))["is_paused"], true);
    assert_eq!(case.registry().overview(1)["participants"][0]["is_paused"], true);
    case.registry().pause(place, false).unwrap();
    assert_eq!(held(&mut case), Some(false));
    case.stage.1.lock().unwrap().push(Happening::GoalMet);
    case.look_after(1);
    assert_eq!(held(&mut case), Some(true));
    let page = case.registry().page(Who::Participant(place));
    assert_eq!((&page["probe"]["pauses"], &page["is_paused"]), (&true.into(), &false.into()));
    let event = Event::ProbeAnswered { probe: 0, answer: Some(Given::Value(4)) };
    participants_event(case.registry(), place, &Sent { step: Some(1), event }).unwrap();
    assert_eq!(held(&mut case), Some(false));
    // What was paused was one mission, and what was ordered stands in the notes.
    case.registry().pause(place, true).unwrap();
    case.apply(place, &Event::Over { ending: Ending::Stopped });
    case.apply(place, &Event::GoesOn);
    (0..2).for_each(|_| case.look_after(1));
    assert_eq!(held(&mut case), Some(false));
    case.registry().tell_participant(place, "Please go on.".to_owned()).unwrap();
    let message = case.registry().page(Who::Participant(place))["message"].clone();
    assert_eq!(message, serde_json::json!({ "number": 1, "text": "Please go on." }));
    let notes: Vec<_> = case.registry().notes.iter().map(|note| note.text.clone()).collect();
    assert_eq!((notes.len(), notes[3].as_str()), (4, "Message: Please go on."));
    assert!(case.registry().tell_participant(9, "You?".to_owned()).is_err(), "nobody is called so");
}

#[test]
fn a_tutorial_waits_until_all_was_tried_and_goes_on_where_it_was() {
    let mut case = Case::new("tutorial");
    let exercise = |what: &str| format!("{{ what = '{what}', text = 'Try to {what}.' }}");
    let exercises = ["say", "stop"].map(exercise).join(", ");
    let block = format!("block = [{{ kind = 'tutorial', mission = 'three', exercise = [{exercises}] }}, ");
    let _ = case.scratch.write("study.toml", &STUDY.replacen("block = [", &block, 1));
    case.start_again();
    let place = case.enrol();
    let page = |case: &mut Case| case.registry().page(Who::Participant(place));
    case.apply(place, &Event::GoesOn);
    case.look_after(1);
    case.look_after(1);
    assert!(case.stage.0.lock().unwrap()[0].0.is_tutorial);
    let shown = page(&mut case)["exercises"].clone();
    assert_eq!(shown[1], serde_json::json!({ "text": "Try to stop.", "is_tried": false }));
    let goes_on = || Sent { step: Some(1), event: Event::GoesOn };
    assert!(participants_event(case.registry(), place, &goes_on()).is_err(), "nothing was tried");
    case.stage.2.lock().unwrap().extend([Activity::Say, Activity::Say, Activity::Point]);
    case.look_after(1);
    // What was tried outlasts the server.
    case.start_again();
    case.look_after(1);
    case.look_after(1);
    let shown = page(&mut case);
    assert_eq!((&shown["exercises"][0]["is_tried"], &shown["may_go_on"]), (&true.into(), &false.into()));
    case.stage.2.lock().unwrap().push(Activity::Stop);
    case.look_after(1);
    assert_eq!(page(&mut case)["may_go_on"], true);
    participants_event(case.registry(), place, &goes_on()).unwrap();
    assert_eq!(case.phase(place), Phase::At(1, Doing::Ready));
    let registry = case.registry();
    let done = &registry.participants[&place].progress.done()[0];
    assert_eq!((done.ending, done.attempts, done.tried.len()), (Some(Ending::Complete), 2, 2));
    let all = [registry.participants[&place].progress.clone()];
    let rows = tables::exercises::table(&registry.study, &all).rows;
    assert!(rows.len() == 2 && rows[1].contains(&cohabit_tables::Cell::Text("stop".to_owned())), "{rows:?}");
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
fn a_session_that_was_left_makes_room_and_goes_on_when_its_participant_is_back() {
    let mut case = Case::new("left");
    let (first, second) = (case.enrol(), case.enrol());
    case.apply(first, &Event::GoesOn);
    case.apply(second, &Event::GoesOn);
    case.look_after(1);
    assert_eq!(case.stage.names(), ["P01-01-1"]);
    let mut stage = case.stage.clone();
    case.registry().participants.get_mut(&first).unwrap().seen = Instant::now().checked_sub(LEFT_AFTER);
    for _ in 0..3 {
        case.registry().look_after(&mut stage, 1);
    }
    assert_eq!(case.stage.names(), ["P01-01-1", "P02-01-1"]);
    assert_eq!(case.phase(first), Phase::At(0, Doing::Queued { again: true }));
    case.apply(second, &Event::Over { ending: Ending::Stopped });
    case.look_after(1);
    case.look_after(1);
    assert_eq!(case.stage.names()[2], "P01-01-2");
    assert_eq!(case.stage.before(2), ["P01-01-1.mcap"], "it goes on where they were");
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

/// A machine that cannot start sessions.
struct Lacking;

impl Player for Lacking {
    fn start(&mut self, _: &Wanted) -> Result<Box<dyn Playing>, String> {
        Err("no memory is left".to_owned())
    }
}

#[test]
fn sessions_that_cannot_be_started_for_a_while_are_told_and_take_no_mission_along() {
    let mut case = Case::new("lacking");
    let place = case.enrol();
    case.apply(place, &Event::GoesOn);
    case.look_after(1);
    case.look_after(1);
    case.stage.set(0, Look::Gone("signal 9".to_owned()));
    case.look_after(1);
    for _ in 0..3 {
        case.registry().participants.get_mut(&place).unwrap().retry_at = None;
        case.registry().look_after(&mut Lacking, 1);
    }
    let failed = |case: &mut Case| case.registry().overview(1)["participants"][0]["failed"].clone();
    assert_eq!(failed(&mut case), "no memory is left");
    let retry_at = case.registry().participants[&place].retry_at.unwrap();
    assert!(retry_at > Instant::now() + Duration::from_secs(3), "it is not tried every second");
    case.look_after(1);
    case.look_after(1);
    assert_eq!((case.stage.names()[1].as_str(), case.stage.before(1)), ("P01-01-5", vec!["P01-01-1.mcap".to_owned()]));
    assert!(failed(&mut case).is_null());
}

#[test]
fn of_two_pages_of_one_link_the_newer_one_goes_on() {
    let mut case = Case::new("windows");
    let (place, other) = (case.enrol(), case.enrol());
    let elsewhere = |case: &mut Case, page: &str| case.registry().is_elsewhere(place, page);
    assert!(!elsewhere(&mut case, "first") && !elsewhere(&mut case, "first"));
    assert!(!elsewhere(&mut case, "second"), "the newer one");
    assert!(elsewhere(&mut case, "first") && elsewhere(&mut case, "first") && !elsewhere(&mut case, "second"));
    assert!(!case.registry().is_elsewhere(other, "first"), "of another participant");
    // Who is asked by a server that was started again is the one that is open.
    case.start_again();
    assert!(!elsewhere(&mut case, "second"));
    for number in 0..100 {
        assert!(!elsewhere(&mut case, &format!("reload {number}")));
    }
    assert!(case.registry().participants[&place].pages.len() <= 50);
}

#[test]
fn time_is_up_when_it_was_played() {
    let mut case = Case::new("time");
    let place = case.enrol();
    case.apply(place, &Event::GoesOn);
    case.look_after(1);
    case.look_after(1);
    case.apply(place, &Event::Played { seconds: 299.9 });
    assert!(case.registry().participants[&place].progress.left_s().unwrap() <= 0.2);
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
fn who_came_by_a_link_with_a_code_is_led_back_by_it_and_takes_it_along() {
    let back = "return_url = \"https://x.org/?credit={survey_code}\"\ntitle";
    let mut case = Case::of("way-back", &STUDY.replacen("title", back, 1));
    let registry = case.registry();
    let token = registry.sign_up().unwrap();
    let Some(Who::Newcomer(index)) = registry.who(&token) else { panic!("a newcomer") };
    let parameters = [("survey_code", "7 8"), ("name", "Ada")].map(|(name, value)| (name.to_owned(), value.to_owned()));
    registry.tell(index, &BTreeMap::from(parameters));
    let links = case.scratch.path("data/private/links.json");
    let has_code = || fs::read_to_string(&links).unwrap().contains("7 8");
    assert!(!has_code(), "nobody has agreed");
    case.registry().enrol(index, "2", &[0, 1]).unwrap();
    let Some(Who::Participant(place)) = case.registry().who(&token) else { panic!("a participant") };
    case.start_again();
    let completion = case.registry().completion(place);
    assert_eq!(completion, Some(crate::design::Completion::Return("https://x.org/?credit=7%208".to_owned())));
    assert!(has_code() && !fs::read_to_string(&links).unwrap().contains("Ada"));
    let journal = fs::read_to_string(case.scratch.path("data/journals/P01.jsonl")).unwrap();
    assert!(!journal.contains("7 8") && !journal.contains("survey_code"), "{journal}");
    case.apply(place, &Event::Withdrew);
    case.look_after(1);
    case.registry().reserve(None).unwrap();
    assert!(!has_code(), "nothing of theirs is left");
}

#[test]
fn who_comes_instead_of_somebody_takes_their_place_in_the_order() {
    let mut case = Case::new("instead");
    let levels = |case: &mut Case, place: u32| {
        let plan = case.registry().participants[&place].progress.plan().clone();
        (plan.order(), (0..2).map(|step| plan.choices(step)).collect::<Vec<_>>())
    };
    let places = [case.enrol(), case.enrol(), case.enrol()];
    let first = levels(&mut case, places[0]);
    assert_eq!((places, first.0), ([1, 2, 3], 1));
    let excluded = Event::Excluded { reason: "did not listen".to_owned() };
    case.apply(1, &excluded);
    case.apply(2, &Event::Withdrew);
    case.look_after(1);
    let second = {
        let plan = crate::assign::assign(&case.registry().study, 2);
        (2, (0..2).map(|step| plan.choices(step)).collect::<Vec<_>>())
    };
    // Also after the server was started anew.
    case.start_again();
    let (fourth, fifth) = (case.enrol(), case.enrol());
    assert_eq!((fourth, levels(&mut case, fourth)), (4, first.clone()));
    assert_eq!((fifth, levels(&mut case, fifth)), (5, second));
    assert_eq!(case.registry().participants[&3].progress.plan().stands_for, None);
    // Who comes instead may leave, too; and a link beyond the plan, where nobody has left, has an order of its own.
    case.apply(fourth, &excluded);
    let sixth = case.enrol();
    assert_eq!((sixth, levels(&mut case, sixth)), (6, first));
    let registry = case.registry();
    let seventh = registry.reserve(None).unwrap();
    assert_eq!((seventh, registry.order(seventh)), (7, 7));
}

#[test]
fn who_is_excluded_is_debriefed_and_may_still_withdraw() {
    let mut case = Case::new("excluded");
    case.registry().study.debriefing = Some("The robot was not alone.".to_owned());
    let place = case.enrol();
    case.apply(place, &Event::Excluded { reason: "did not listen".to_owned() });
    let page = case.registry().page(Who::Participant(place));
    assert!(page["page"] == "excluded" && page["html"].to_string().contains("The robot was not alone."), "{page}");
    participants_event(case.registry(), place, &Sent { step: None, event: Event::Withdrew }).unwrap();
    assert_eq!(case.phase(place), Phase::Withdrawn);
}

#[test]
fn who_withdraws_as_the_study_ends_leaves_nothing_and_is_exported_by_nobody() {
    let mut case = Case::new("withdraw-at-the-end");
    let place = case.enrol();
    case.apply(place, &Event::GoesOn);
    case.look_after(1);
    case.apply(place, &Event::Withdrew);
    let (study, data) = (case.registry().study.clone(), case.scratch.path("data"));
    let refused = crate::records::Records::read(study.clone(), &data).unwrap_err().to_string();
    assert!(refused.contains("P01 has withdrawn") && refused.contains("cohabit study withdraw P01"), "{refused}");
    let (registry, stop) = (Mutex::new(case.registry.take().unwrap()), AtomicBool::new(true));
    keep(&registry, &mut case.stage, 1, &stop);
    let left: Vec<_> = files(&data).into_iter().filter(|name| name.starts_with("P01")).collect();
    assert_eq!(left, [] as [String; 0]);
    assert_eq!(crate::records::Records::read(study, &data).unwrap().withdrawn, ["P01"]);
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

const MINIMISED: &str = r#"
title = "A study"
contact = "us"
seed = 5
participants = 40
missions = ["one"]
information = { file = "sheet.md", version = "1" }
consent = { file = "sheet.md", version = "2", required = ["Yes.", "Indeed."] }
minimisation = { certainty = 1, covariate = [
    { name = "load", questionnaire = "tlx", item = 1, cuts = [50] }, { name = "site", parameter = "at", levels = ["lab"] },
] }
factor = [{ name = "ask", kind = "between", level = [
    { name = "never", settings = { ask = "never" } }, { name = "always", settings = { ask = "always" } },
] }]
block = [{ kind = "questionnaire", questionnaires = ["tlx"] }, { kind = "missions" }]
"#;

#[test]
fn a_condition_that_could_not_be_written_down_is_assigned_once_it_can_be() {
    let mut case = Case::of("assigned-late", MINIMISED);
    let place = case.enrol();
    let answers = [20, 5, 5, 5, 5, 5].map(|value| Some(Given::Value(value))).to_vec();
    // As if the disk had been full just after the answers.
    let answered = Event::Answered { questionnaire: "tlx".to_owned(), answers };
    case.registry().participants.get_mut(&place).unwrap().progress.step(&answered, 5).unwrap();
    assert_eq!(case.phase(place), Phase::Assigning);
    case.look_after(1);
    assert_eq!(case.phase(place), Phase::At(1, Doing::Ready));
}

#[test]
fn a_condition_that_depends_on_answers_is_assigned_when_these_are_there_and_outlasts_a_crash() {
    let mut case = Case::of("minimised", MINIMISED);
    let mut counts = BTreeMap::<(String, String), [usize; 2]>::new();
    for number in 0..20_u32 {
        let registry = case.registry();
        let token = registry.sign_up().unwrap();
        let Some(Who::Newcomer(index)) = registry.who(&token) else { panic!("a newcomer") };
        let parameters = BTreeMap::from([("at".to_owned(), "lab".to_owned()), ("name".to_owned(), "Ada".to_owned())]);
        registry.tell(index, &if number % 3 == 0 { parameters } else { BTreeMap::new() });
        registry.enrol(index, "2", &[0, 1]).unwrap();
        let Some(Who::Participant(place)) = registry.who(&token) else { panic!("a participant") };
        let plan = registry.participants[&place].progress.plan();
        assert!(plan.awaits_assignment && plan.between.is_empty() && plan.steps.len() == 1, "{plan:?}");
        if number == 7 {
            case.start_again();
        }
        let load = if number % 2 == 0 { 20 } else { 80 };
        let answers = [load, 5, 5, 5, 5, 5].map(|value| Some(Given::Value(value))).to_vec();
        case.apply(place, &Event::Answered { questionnaire: "tlx".to_owned(), answers });
        let progress = case.registry().participants[&place].progress.clone();
        assert_eq!(progress.phase(), &Phase::At(1, Doing::Ready), "{progress:?}");
        let plan = progress.plan();
        assert!(!format!("{plan:?}").contains("Ada"), "nothing else of a link is kept");
        let arm = usize::from(plan.between[0].level == "always");
        for (name, level) in &plan.covariates {
            counts.entry((name.clone(), level.clone())).or_default()[arm] += 1;
        }
    }
    assert_eq!(counts.len(), 4, "{counts:?}");
    assert!(counts.values().all(|[one, other]| one.abs_diff(*other) <= 2), "{counts:?}");
    // Who was cut off between the answer and the condition gets it when the study goes on.
    let before: Vec<_> = case.registry().participants.values().map(|one| one.progress.plan().between.clone()).collect();
    let path = case.registry().folder.journal_path(20);
    let whole = fs::read_to_string(&path).unwrap();
    let cut =
        whole.lines().filter(|line| !line.contains("\"assigned\"")).map(|line| format!("{line}\n")).collect::<String>();
    assert!(cut.len() < whole.len());
    fs::write(&path, cut).unwrap();
    case.start_again();
    let after: Vec<_> = case.registry().participants.values().map(|one| one.progress.plan().between.clone()).collect();
    assert_eq!(before, after);
}
