//! A methods sheet says what is known, and names what is not.

use cohabit_tables::{Cell, Field, Kind};

use super::{latencies::quantile, participants::day, *};
use crate::{
    design::{Block, Choice, Factor, FactorKind, Level, Limits, Study},
    instrument::Instrument,
    plan::{Plan, PlannedMission, Step},
    progress::{Ending, Event, Progress},
    settings::{Setting, Settings},
};

/// Two participants under two conditions, one of whom has done their mission.
fn records(is_synthetic: bool) -> Records {
    let level = |name: &str| Level {
        name: name.to_owned(),
        settings: Settings::from([("ask".to_owned(), Setting::Value(name.to_owned()))]),
    };
    let levels = vec![level("never"), level("always")];
    let factors = vec![Factor { name: "ask".to_owned(), kind: FactorKind::Between, levels }];
    let (sus, instrument) = Instrument::find("sus").expect("it ships");
    let study = Study {
        title: "Asking".to_owned(),
        participants: 4,
        block_size: 2,
        factors,
        questionnaires: vec![sus],
        instruments: BTreeMap::from([("sus".to_owned(), instrument)]),
        ..Study::default()
    };
    let mission = PlannedMission {
        block: 0,
        mission: "cold_soda".to_owned(),
        is_practice: false,
        exercises: Vec::new(),
        within: Vec::new(),
        settings: Settings::new(),
        limits: Limits::default(),
    };
    let person = |place: u32, level: &str, events: &[Event]| {
        let between = vec![Choice { factor: "ask".to_owned(), level: level.to_owned() }];
        let plan =
            Plan { place, is_synthetic, between, steps: vec![Step::Mission(mission.clone())], ..Plan::default() };
        let mut progress = Progress::new(plan);
        let agreed = Event::Consented { version: "1".to_owned(), ticked: Vec::new(), audio: false };
        for event in [Event::Read, agreed].iter().chain(events) {
            progress.step(event, 1_795_651_200_000).expect("a possible event");
        }
        progress
    };
    let done = [Event::GoesOn, Event::Started, Event::Over { ending: Ending::Complete }];
    let progress = vec![person(1, "never", &done), person(2, "always", &[])];
    Records { study, progress, withdrawn: vec!["P03".to_owned()], notes: Vec::new(), is_synthetic }
}

fn turns() -> Table {
    let field = |name: &'static str, kind| Field { name: name.into(), kind, unit: "", meaning: "".into() };
    let row = |level: &str, ms: f64| vec![Cell::Text(level.to_owned()), Cell::Real(ms)];
    Table {
        name: "turns",
        meaning: "",
        fields: vec![field("factor_ask", Kind::Text), field("answered_ms", Kind::Real)],
        rows: vec![row("never", 100.0), row("never", 200.0), row("always", 400.0)],
    }
}

#[test]
fn a_sheet_says_what_is_known_and_what_is_missing() {
    let apparatus = Apparatus {
        programs: BTreeSet::from(["0.1.0 (build ab)".to_owned()]),
        missions: BTreeMap::from([("cold_soda.json".to_owned(), BTreeSet::from(["12ab".to_owned()]))]),
        ..Apparatus::default()
    };
    let text = report(&records(false), &apparatus, &[turns()]);
    for part in [
        "# Methods: Asking\n",
        "3 participants consented, of 4 planned: 1 finished, 1 did not come to the end, 0 were excluded, and 1 withdrew",
        "The first consented on 2026-11-26",
        "- `ask` varied between participants: `never` (--ask=never) and `always` (--ask=always)",
        "in random order within blocks of 2 participants",
        "| ask=never | 1 | 1 | 1 | 0 |",
        "played with Cohabit 0.1.0 (build ab)",
        "| `cold_soda.json` | `12ab` |",
        "| first answer or question | all | 3 | 200 ms | 380 ms |",
        "| first answer or question | ask=never | 2 | 150 ms | 195 ms |",
        "- `sus`: 10 items, 2, 4, 6, 8 and 10 reversed. Scores: `sus`",
        "Brooke, J. (1996)",
        "## Wizard\n\nNo wizard took part.",
        "| wizard | training | does not apply | no wizard took part |",
        "| participants | demographics | missing | **add it** |",
        "of 22 items 6 are missing",
    ] {
        assert!(text.contains(part), "no `{part}` in {text}");
    }
    assert!(!text.to_lowercase().contains("synthetic"), "{text}");
}

/// The same study, in which a wizard takes part at one level.
fn with_wizard() -> Records {
    let mut records = records(false);
    let on = |settings: &mut Settings| {
        settings.insert("wizard".to_owned(), Setting::Value("yes".to_owned()));
        settings.insert("response-delay-ms".to_owned(), Setting::Value("1500".to_owned()));
    };
    on(&mut records.study.factors[0].levels[1].settings);
    let (limits, text) = (Limits::default(), String::new());
    let mission = "cold_soda".to_owned();
    let (exercises, settings) = (Vec::new(), Settings::new());
    let block = Block::Mission { mission, is_practice: false, exercises, settings, limits, text };
    records.study.blocks = vec![block];
    records.study.wizard.timeout_s = Some(8.0);
    records.study.wizard.phrases = vec!["h=Hello!".parse().expect("a phrase")];
    records
}

#[test]
fn a_sheet_counts_what_a_wizard_did_otherwise() {
    let field = |name: &'static str, kind| Field { name: name.into(), kind, unit: "", meaning: "".into() };
    let row = |outcome: &str, intervention: bool, ms: Option<f64>| {
        vec![
            Cell::Text("always".to_owned()),
            Cell::Text(outcome.to_owned()),
            Cell::Flag(intervention),
            Cell::Flag(outcome == "timed_out"),
            ms.map_or(Cell::Nothing, Cell::Real),
        ]
    };
    let decisions = Table {
        name: "decisions",
        meaning: "",
        fields: vec![
            field("factor_ask", Kind::Text),
            field("outcome", Kind::Text),
            field("intervention", Kind::Flag),
            field("late", Kind::Flag),
            field("decided_ms", Kind::Real),
        ],
        rows: vec![
            row("accepted", false, Some(1000.0)),
            row("edited", true, Some(5000.0)),
            row("replaced", true, Some(3000.0)),
            row("timed_out", false, None),
        ],
    };
    let text = report(&with_wizard(), &Apparatus::default(), &[decisions]);
    for part in [
        "A decision may take 8 s; after that the robot does what it proposed.",
        "canned phrases `h` \"Hello!\"",
        "sooner than 1500 ms after it was said with a wizard, and 0 ms without",
        "Of 4 decisions, 2 were interventions (50.0 %)",
        "| ask=always | 4 | 1 | 1 | 1 | 0 | 1 | 0 | 0 | 0 | 2 | 1 | 3000 ms |",
        "| wizard | training | missing | **add it** |",
        "| wizard | what they controlled, and how | present |",
        "of 22 items 10 are missing",
    ] {
        assert!(text.contains(part), "no `{part}` in {text}");
    }
    let before = report(&with_wizard(), &Apparatus::default(), &[]);
    assert!(before.contains("interventions are **missing**"), "{before}");
}

#[test]
fn a_sheet_says_why_somebody_was_excluded() {
    let mut records = records(false);
    let excluded = Event::Excluded { reason: "phoned meanwhile".to_owned() };
    records.progress[1].step(&excluded, 1_795_651_200_000).expect("a possible event");
    let text = report(&records, &Apparatus::default(), &[]);
    assert!(text.contains("1 was excluded") && text.contains(" Excluded: P02 (phoned meanwhile)."), "{text}");
}

#[test]
fn a_sheet_says_whether_missions_stood_still_for_a_question() {
    let mut records = records(false);
    let probe = |questionnaire: &str, pauses: bool| crate::probe::Probe {
        questionnaire: questionnaire.to_owned(),
        at: crate::probe::Moment::Played(60.0),
        pauses,
    };
    records.study.probes = vec![probe("mood", false), probe("trust", true)];
    let text = report(&records, &Apparatus::default(), &[]);
    for part in
        ["which went on meanwhile, they were asked `mood`", "which stood still meanwhile, they were asked `trust`"]
    {
        assert!(text.contains(part), "no `{part}` in {text}");
    }
}

#[test]
fn a_sheet_says_until_when_data_are_kept() {
    let mut records = records(false);
    let text = report(&records, &Apparatus::default(), &[]);
    assert!(text.contains("add `keep_until` to the study's file"), "{text}");
    records.study.keep_until = Some("2031-12-31".to_owned());
    let text = report(&records, &Apparatus::default(), &[]);
    assert!(text.contains("Their data are kept until 2031-12-31."), "{text}");
}

#[test]
fn a_sheet_of_a_dry_run_says_so_first() {
    let text = report(&records(true), &Apparatus::default(), &[turns()]);
    assert!(text.starts_with("> **Synthetic data.**"), "{text}");
    assert!(text.contains("Not measured: in a dry run") && text.contains("3 simulated participants"), "{text}");
}

#[test]
fn quantiles_and_days_are_those_of_others() {
    // By numpy.quantile, and by `date -u -d @…`.
    let values = [1.0, 2.0, 4.0, 8.0, 16.0];
    assert!((quantile(&values, 0.95) - 14.4).abs() < 1e-9 && (quantile(&values, 0.5) - 4.0).abs() < 1e-9);
    assert!((quantile(&[3.0], 0.95) - 3.0).abs() < 1e-9);
    for (at_s, expected) in [(0, "1970-01-01"), (951_782_400, "2000-02-29"), (1_795_651_199, "2026-11-25")] {
        assert_eq!(day(at_s * 1000), expected);
    }
}

#[test]
fn a_sheet_counts_pairs_and_says_what_is_theirs() {
    let mut records = records(false);
    records.study.pairing = Some(crate::pair::Pairing {
        wait_s: 120.0,
        partner_absent: crate::pair::PartnerAbsent::Alone,
        skip: crate::pair::SkippedBy::Both,
    });
    let text = report(&records, &Apparatus::default(), &[]);
    for part in [
        "They took part in 2 pairs: 0 finished together, in 0 somebody went on without their partner, and of 1 the second participant",
        "`ask` varied between pairs of participants",
        "within blocks of 2 pairs",
        "Who had waited for 2 min could go on alone. A mission was skipped when both agreed.",
        "a random intercept for each pair",
        "(1 | pair/participant)",
    ] {
        assert!(text.contains(part), "no `{part}` in {text}");
    }
}
