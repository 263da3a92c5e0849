//! A methods sheet says what is known, and names what is not.

use cohabit_tables::{Cell, Field, Kind};

use super::{latencies::quantile, participants::day, *};
use crate::{
    design::{Choice, Factor, FactorKind, Level, Limits, Study},
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
        "| wizard | training | does not apply | no wizard took part |",
        "| participants | demographics | missing | **add it** |",
        "of 22 items 6 are missing",
    ] {
        assert!(text.contains(part), "no `{part}` in {text}");
    }
    assert!(!text.to_lowercase().contains("synthetic"), "{text}");
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
