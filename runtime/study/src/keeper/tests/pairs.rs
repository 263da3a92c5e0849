//! Two participants play together, wait for each other, and part.

use super::*;

const PAIRS: &str = r#"
title = "A study"
contact = "us"
seed = 5
participants = 4
participants_per_session = 2
assignment = "latin_square"
missions = ["one", "two"]
information = { file = "sheet.md", version = "1" }
consent = { file = "sheet.md", version = "2", required = ["Yes.", "Indeed."], optional = [{ text = "Hear me.", audio = true }] }
pair = { partner_absent = "wait", partner_minutes = 2, skip = "both" }
factor = [{ name = "ask", kind = "within", level = [
    { name = "never", settings = { ask = "never" } }, { name = "always", settings = { ask = "always" } },
] }]
block = [{ kind = "missions", minutes = 5, skip_after_minutes = 1 }, { kind = "questionnaire", questionnaires = ["tlx"] }]
"#;

impl Case {
    /// A pair, both of whom wait for their first mission.
    fn pair(name: &str, study: &str) -> (Self, [u32; 2]) {
        let mut case = Self::of(name, study);
        let places = [case.enrol(), case.enrol()];
        places.iter().for_each(|place| case.apply(*place, &Event::GoesOn));
        (case, places)
    }

    /// The same, who play it.
    fn playing_pair(name: &str, study: &str) -> (Self, [u32; 2]) {
        let (mut case, places) = Self::pair(name, study);
        case.look_after(1);
        case.look_after(1);
        (case, places)
    }

    fn page(&mut self, place: u32) -> serde_json::Value {
        self.registry().page(Who::Participant(place))
    }

    fn send(&mut self, place: u32, event: Event) -> Result<(), StudyFault> {
        let step = self.registry().participants[&place].progress.step_now().map(|(step, ..)| step + 1);
        participants_event(self.registry(), place, &Sent { step, event })
    }

    /// Somebody has waited for their partner for three minutes.
    fn wait_long(&mut self, place: u32) {
        let since = Instant::now().checked_sub(Duration::from_secs(180)).unwrap();
        self.registry().participants.get_mut(&place).unwrap().waits_since = Some(since);
    }
}

#[test]
fn a_session_is_started_once_for_both_when_both_are_ready() {
    let mut case = Case::of("pair-start", PAIRS);
    let (first, second) = (case.enrol(), case.enrol());
    case.apply(second, &Event::GoesOn);
    case.look_after(1);
    assert_eq!(case.page(second)["page"], "partner");
    case.apply(first, &Event::GoesOn);
    case.look_after(1);
    case.look_after(1);
    assert_eq!(case.stage.names(), ["pair01-01-1"]);
    let wanted = case.stage.0.lock().unwrap()[0].0.clone();
    assert_eq!((wanted.participant.as_str(), wanted.seats), ("pair01", 2));
    let tokens = [first, second].map(|place| case.page(place)["session"]["token"].clone());
    assert_eq!(tokens, ["seat 0", "seat 1"], "each has a page of their own");
    assert_eq!(case.registry().overview(1)["sessions"]["running"], 1);
    let rows = case.registry().overview(1)["participants"].clone();
    assert_eq!((&rows[0]["now"], &rows[0]["order"]), (&rows[1]["now"], &rows[1]["order"]));
    // Only one session at a time: the next pair waits.
    let others = [case.enrol(), case.enrol()];
    others.iter().for_each(|place| case.apply(*place, &Event::GoesOn));
    case.look_after(1);
    assert_eq!((case.stage.names().len(), &case.page(others[1])["ahead"]), (1, &serde_json::json!(0)));
}

#[test]
fn nobody_is_heard_unless_both_agree() {
    for (ticked, is_heard) in [(&[0, 1, 2][..], true), (&[0, 1], false)] {
        let mut case = Case::of("pair-audio", PAIRS);
        let places = [case.enrol_with(&[0, 1, 2]), case.enrol_with(ticked)];
        places.iter().for_each(|place| case.apply(*place, &Event::GoesOn));
        case.look_after(1);
        case.look_after(1);
        assert_eq!(!case.stage.arguments(0).contains(&"--hide=microphone".to_owned()), is_heard);
        assert!(places.iter().all(|place| case.page(*place)["session"]["has_microphone"] == is_heard));
    }
}

#[test]
fn both_go_on_after_a_dead_session_and_a_dead_server() {
    let (mut case, places) = Case::playing_pair("pair-dead", PAIRS);
    case.apply(places[0], &Event::Played { seconds: 12.5 });
    case.stage.set(0, Look::Gone("signal 9".to_owned()));
    case.look_after(1);
    case.look_after(1);
    case.look_after(1);
    assert_eq!(case.stage.names(), ["pair01-01-1", "pair01-01-2"]);
    let plans = places.map(|place| case.registry().participants[&place].progress.plan().clone());
    case.start_again();
    for place in places {
        assert_eq!(case.phase(place), Phase::At(0, Doing::Queued { again: true }));
    }
    // The one whose page is not there yet is waited for.
    let mut stage = case.stage.clone();
    case.registry().participants.get_mut(&places[0]).unwrap().seen = Some(Instant::now());
    case.registry().look_after(&mut stage, 1);
    assert_eq!((case.stage.names().len(), &case.page(places[0])["page"]), (2, &"partner".into()));
    case.look_after(1);
    assert_eq!(case.stage.names()[2], "pair01-01-3");
    assert_eq!(case.stage.arguments(2), case.stage.arguments(0));
    assert_eq!(case.stage.before(2), ["pair01-01-2.mcap", "pair01-01-1.mcap"]);
    let progress = places.map(|place| case.registry().participants[&place].progress.clone());
    assert_eq!(progress.each_ref().map(Progress::plan), plans.each_ref());
    // Each has a time of their own.
    assert_eq!(progress.each_ref().map(Progress::played_s), [12.5, 0.0]);
}

#[test]
fn time_is_up_for_each_by_themselves_and_the_next_mission_waits_for_both() {
    let (mut case, [first, second]) = Case::playing_pair("pair-time", PAIRS);
    case.apply(first, &Event::Played { seconds: 300.0 });
    case.look_after(1);
    assert_eq!(case.phase(first), Phase::At(1, Doing::Ready));
    assert_eq!(case.page(second)["page"], "mission", "the other one plays on");
    case.apply(first, &Event::GoesOn);
    case.look_after(1);
    assert_eq!(case.page(first)["page"], "partner");
    // A session that dies is started again for who has not done yet.
    case.stage.set(0, Look::Gone("signal 9".to_owned()));
    (0..3).for_each(|_| case.look_after(1));
    assert_eq!(case.stage.names(), ["pair01-01-1", "P02-01-2"]);
    assert_eq!(case.stage.before(1), ["pair01-01-1.mcap"]);
    case.apply(second, &Event::Over { ending: Ending::Complete });
    case.apply(second, &Event::GoesOn);
    (0..3).for_each(|_| case.look_after(1));
    assert_eq!(case.stage.names()[2], "pair01-02-1");
    let registry = case.registry();
    let all: Vec<_> = [first, second].map(|place| registry.participants[&place].progress.clone()).to_vec();
    let rows = tables::all(&records(registry, &all), Vec::new(), true);
    let missions = rows.iter().find(|table| table.name == "missions").unwrap();
    let column = |name: &str| missions.column(name).cloned().collect::<Vec<_>>();
    let words = |text: &str| cohabit_tables::Cell::Text(text.to_owned());
    assert_eq!(column("pair"), [words("pair01"), words("pair01")]);
    assert_eq!(column("seat"), [cohabit_tables::Cell::Whole(1), cohabit_tables::Cell::Whole(2)]);
    assert_eq!(column("sessions"), [words("pair01-01-1"), words("pair01-01-1 P02-01-2")]);
    assert_eq!(column("ending"), [words("time_up"), words("complete")]);
}

/// What a folder would have of these.
fn records(registry: &Registry, all: &[Progress]) -> crate::records::Records {
    crate::records::Records {
        study: registry.study.clone(),
        progress: all.to_vec(),
        withdrawn: Vec::new(),
        notes: Vec::new(),
        is_synthetic: false,
    }
}

#[test]
fn a_mission_is_skipped_when_both_want_to_or_when_either_does() {
    let skipped = || Event::Over { ending: Ending::Skipped };
    let (mut case, [first, second]) = Case::playing_pair("pair-skip", PAIRS);
    assert!(case.send(first, skipped()).is_err(), "not before its time");
    for place in [first, second] {
        case.apply(place, &Event::Played { seconds: 60.0 });
    }
    case.send(first, skipped()).unwrap();
    let skip = |case: &mut Case, place| case.page(place)["skip"].clone();
    let asked = serde_json::json!({ "by": "both", "is_asked": true, "is_wanted": false });
    assert_eq!(skip(&mut case, first), asked);
    assert_eq!(skip(&mut case, second), serde_json::json!({ "by": "both", "is_asked": false, "is_wanted": true }));
    case.send(second, skipped()).unwrap();
    for place in [first, second] {
        assert_eq!(case.registry().participants[&place].progress.done()[0].ending, Some(Ending::Skipped));
    }
    // What was wanted of one mission is not wanted of the next.
    [first, second].iter().for_each(|place| case.apply(*place, &Event::GoesOn));
    (0..3).for_each(|_| case.look_after(1));
    assert_eq!(skip(&mut case, second)["is_wanted"], false);

    let either = PAIRS.replace("skip = \"both\"", "skip = \"either\"");
    let (mut case, [first, second]) = Case::playing_pair("pair-either", &either);
    case.apply(second, &Event::Played { seconds: 60.0 });
    case.send(second, skipped()).unwrap();
    for place in [first, second] {
        assert_eq!(case.phase(place), Phase::At(1, Doing::Ready));
    }
}

#[test]
fn who_waits_in_vain_may_go_on_alone_or_stop_and_the_experimenter_is_alarmed() {
    let waiting = |name: &str, absent: &str| {
        let mut case = Case::of(name, &PAIRS.replace("\"wait\"", &format!("\"{absent}\"")));
        let (first, second) = (case.enrol(), case.enrol());
        case.apply(first, &Event::GoesOn);
        case.look_after(1);
        assert!(case.send(first, Event::GoesAlone).is_err() && case.send(first, Event::StopsWaiting).is_err());
        assert_eq!(case.registry().overview(1)["participants"][0]["partner_is_late"], false);
        case.wait_long(first);
        let page = case.page(first);
        assert_eq!((&page["is_late"], &page["may"]), (&true.into(), &absent.into()));
        assert_eq!(case.registry().overview(1)["participants"][0]["partner_is_late"], true);
        (case, first, second)
    };
    let (mut case, first, _) = waiting("pair-wait", "wait");
    assert!(case.send(first, Event::GoesAlone).is_err() && case.send(first, Event::StopsWaiting).is_err());

    let (mut case, first, second) = waiting("pair-alone", "alone");
    assert!(case.send(first, Event::StopsWaiting).is_err());
    case.send(first, Event::GoesAlone).unwrap();
    (0..2).for_each(|_| case.look_after(2));
    // The other one does so, too, when they are back.
    case.apply(second, &Event::GoesOn);
    (0..2).for_each(|_| case.look_after(2));
    assert_eq!(case.stage.names(), ["P01-01-1", "P02-01-1"]);
    assert_eq!(case.stage.arguments(0), case.stage.arguments(1), "under the same conditions");
    case.start_again();
    assert!([first, second].iter().all(|place| case.registry().participants[place].progress.is_alone()));

    let (mut case, first, second) = waiting("pair-end", "end");
    case.send(first, Event::StopsWaiting).unwrap();
    case.look_after(1);
    for place in [first, second] {
        assert_eq!((case.phase(place), &case.page(place)["page"]), (Phase::Parted, &"parted".into()));
    }
}

#[test]
fn who_withdraws_takes_the_sessions_of_the_pair_along_and_the_partners_answers_stay() {
    let (mut case, [first, second]) = Case::playing_pair("pair-withdraw", PAIRS);
    case.apply(first, &Event::Withdrew);
    case.look_after(1);
    assert_eq!(case.page(second)["page"], "parted", "the other one is told");
    (0..3).for_each(|_| case.look_after(1));
    let left = files(&case.scratch.path("data"));
    let of = |begin: &str| left.iter().filter(|name| name.starts_with(begin)).cloned().collect::<Vec<_>>();
    assert!(of("P01").is_empty() && of("pair01").is_empty(), "{left:?}");
    assert_eq!(of("P02"), ["P02.json", "P02.jsonl"]);
    let withdrawn = case.registry().folder.withdrawals().unwrap();
    assert_eq!((withdrawn[0].participant.as_str(), withdrawn[0].pair.as_deref()), ("P01", Some("pair01")));
    // A place is given once, and nobody comes into a pair that somebody has left.
    assert_eq!((case.enrol(), case.enrol()), (3, 4));

    // By hand, while no server runs.
    let (mut case, [first, second]) = Case::playing_pair("pair-withdraw-later", PAIRS);
    case.registry().folder.withdraw("P01", 5).unwrap();
    case.start_again();
    case.look_after(1);
    assert!(!case.registry().participants.contains_key(&first));
    assert_eq!(case.phase(second), Phase::Parted);
}

#[test]
fn the_experimenter_keeps_a_pair_together() {
    let mut case = Case::of("pair-lab", PAIRS);
    let (first, second) = (case.enrol(), case.enrol());
    assert!(case.registry().ended_with(first).is_ok_and(|places| places == [first, second]), "both are at it");
    case.apply(first, &Event::Over { ending: Ending::Stopped });
    let refused = case.registry().ended_with(first).unwrap_err().to_string();
    assert!(refused.contains("P02 is not at this mission yet"), "{refused}");
    assert!(case.registry().ended_with(second).is_ok_and(|places| places == [second]));
    let row = case.registry().overview(1)["participants"][1].clone();
    assert_eq!((&row["pair"], &row["participant"]), (&"pair01, seat 2".into(), &"P02".into()));
    case.apply(second, &Event::Excluded { reason: "did not listen".to_owned() });
    case.look_after(1);
    assert_eq!(case.phase(first), Phase::Parted);
}

#[test]
fn nobody_comes_by_a_link_into_a_pair_that_was_left() {
    let mut case = Case::of("pair-link", PAIRS);
    let first = case.enrol();
    let place = case.registry().reserve(None).unwrap();
    let token = case.registry().links.participants[&place].clone();
    case.apply(first, &Event::Withdrew);
    (0..2).for_each(|_| case.look_after(1));
    let registry = case.registry();
    let Some(Who::Newcomer(index)) = registry.who(&token) else { panic!("a newcomer") };
    let refused = registry.enrol(index, "2", &[0, 1]).unwrap_err().to_string();
    assert!(refused.contains("us") && registry.participants.is_empty(), "{refused}");
}

#[test]
fn a_pair_that_comes_instead_of_another_takes_its_place_in_the_order() {
    let mut case = Case::of("pair-instead", PAIRS);
    let places: Vec<u32> = (0..4).map(|_| case.enrol()).collect();
    assert_eq!(places, [1, 2, 3, 4]);
    case.apply(2, &Event::Withdrew);
    (0..2).for_each(|_| case.look_after(1));
    assert_eq!(case.phase(1), Phase::Parted);
    for (place, order) in [(5, 1), (6, 2)] {
        assert_eq!(case.enrol(), place);
        let plan = case.registry().participants[&place].progress.plan().clone();
        assert_eq!((plan.place, plan.order()), (place, order));
        let instead = crate::assign::assign(&case.registry().study, order);
        assert_eq!((plan.steps, plan.between), (instead.steps, instead.between));
    }
}
