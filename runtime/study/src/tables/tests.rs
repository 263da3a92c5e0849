//! What stands in a study's own tables.

use super::*;
use crate::{
    design::Limits,
    plan::PlannedMission,
    progress::{Ending, Event},
    settings::Settings,
};

#[test]
fn notes_are_about_somebody_or_about_the_study() {
    let note = |participant: Option<&str>, text: &str| Note {
        at_ms: 5,
        participant: participant.map(str::to_owned),
        text: text.to_owned(),
    };
    let table = notes(&[note(Some("P12"), "looks bored"), note(None, "the lab is cold")]);
    let words = |text: &str| Cell::Text(text.to_owned());
    assert_eq!(
        table.rows,
        [
            vec![Cell::Whole(5), words("P12"), Cell::Whole(12), words("looks bored")],
            vec![Cell::Whole(5), Cell::Nothing, Cell::Nothing, words("the lab is cold")],
        ]
    );
    assert!(table.rows.iter().all(|row| row.len() == table.fields.len()));
}

#[test]
fn who_is_excluded_is_told_with_the_reason_and_so_are_their_sessions() {
    let mut progress = Progress::new(Plan { place: 7, ..Plan::default() });
    let agreed = Event::Consented { version: "1".to_owned(), ticked: Vec::new(), audio: false };
    let excluded = Event::Excluded { reason: "phoned meanwhile".to_owned() };
    for event in [Event::Read, agreed, excluded] {
        progress.step(&event, 0).expect("a possible event");
    }
    let all = [progress];
    assert!(is_of_excluded(&all, "P07-01-1") && is_of_excluded(&all, "pair04-01-1"));
    assert!(!is_of_excluded(&all, "P08-01-1") && !is_of_excluded(&all, "play-3"));
    let table = participants(&Study::default(), &all, &["P09".to_owned()]);
    let column = |name: &str| table.column(name).cloned().collect::<Vec<_>>();
    let words = |text: &str| Cell::Text(text.to_owned());
    assert_eq!(column("progress"), [words("excluded"), words("withdrawn")]);
    assert_eq!(column("excluded_because"), [words("phoned meanwhile"), Cell::Nothing]);
}

#[test]
fn practice_is_marked_and_left_out() {
    let mission = |name: &str, is_practice: bool| {
        Step::Mission(PlannedMission {
            block: 0,
            mission: name.to_owned(),
            is_practice,
            exercises: Vec::new(),
            within: Vec::new(),
            settings: Settings::new(),
            limits: Limits::default(),
        })
    };
    let steps = vec![mission("laser_lab", true), mission("cold_soda", false)];
    let mut progress = Progress::new(Plan { place: 7, steps, ..Plan::default() });
    let agreed = Event::Consented { version: "1".to_owned(), ticked: Vec::new(), audio: false };
    let over = Event::Over { ending: Ending::Complete };
    let played = [Event::GoesOn, Event::Started, over];
    let events = [Event::Read, agreed].into_iter().chain(played.clone()).chain(played);
    events.for_each(|event| drop(progress.step(&event, 0).expect("a possible event")));
    let all = [progress];
    assert!(is_practice(&all, "P07-01-2") && !is_practice(&all, "P07-02-1"));
    assert!(!is_practice(&all, "P08-01-1") && !is_practice(&all, "play-3"));
    assert_eq!(missions_of(all[0].plan()), "laser_lab (practice), cold_soda");
    let of = |with_practice| {
        let table = missions::table(&Study::default(), &all, with_practice);
        let column = table.fields.iter().position(|field| field.name == "practice").expect("a column");
        table.rows.iter().map(|row| row[column].clone()).collect::<Vec<_>>()
    };
    assert_eq!(of(false), [Cell::Flag(false)]);
    assert_eq!(of(true), [Cell::Flag(true), Cell::Flag(false)]);
}
