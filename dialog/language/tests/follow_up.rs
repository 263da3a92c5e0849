//! What is said next: answers to the robot's question, corrections, the same again with something else.

#![allow(clippy::unwrap_used)]

mod support;

use cohabit_cdf::Status;
use cohabit_language::Understanding;
use support::Talk;

const KITCHEN: [&str; 3] =
    ["plan OfficeLayout2 BreakRoom", "add Knife_01 on KitchenCounterTop_02", "add SandwichHalf_01 in FridgeLower_02"];

/// What is understood, all of which is done at once.
fn does(talk: &mut Talk, said: &str) -> String {
    let understanding = talk.language.understand(said, &talk.scene, &mut talk.context);
    let text = support::text(&understanding, &talk.scene);
    if let Understanding::Plan { steps, .. } = &understanding {
        steps.iter().for_each(|step| talk.context.note_outcome(step, Status::ActionSuccessful));
        talk.scene = talk.language.expected(&talk.scene, steps);
    }
    text
}

/// Questions of the robot's: in which scene, after what, and what a yes does first, where it may be answered with one.
const QUESTIONS: [(&[&str], &[&str], Option<&str>); 2] =
    [(&KITCHEN, &["pick up the knife", "pick up the banana"], Some("put ")), (&KITCHEN, &["bring me a bowl"], None)];

#[test]
fn answers_are_taken_as_answers() {
    const YES: [&str; 7] = [
        "yes",
        "yeah go on",
        "ya ya kindly do the needful",
        "yes please, thank you",
        "of course",
        "yep, do it",
        "arre yes, do what you told now",
    ];
    const NO: [&str; 5] = ["no", "nope", "no thanks", "nah leave it", "no, don't"];
    for (scene, before, done) in QUESTIONS {
        let asked = || {
            let mut talk = Talk::new(scene);
            let question = before.iter().map(|said| does(&mut talk, said)).last().unwrap();
            assert!(question.starts_with("? "), "{before:?}: {question}");
            talk
        };
        for said in YES {
            let (Some(first), mut talk) = (done, asked()) else { continue };
            let found = does(&mut talk, said);
            assert!(found.starts_with(first), "{before:?}, {said}: {found}");
        }
        for said in NO {
            let found = does(&mut asked(), said);
            assert!(found.starts_with("= "), "{before:?}, {said}: {found}");
        }
    }
}

#[test]
fn the_other_one_is_another_than_was_taken() {
    let mut talk = Talk::new(&["plan OfficeLayout2 Lab1", "add Screwdriver on Desk_01"]);
    let shelf = "take Screwdriver, put AP_Prop_Shelf_Wall_Laser";
    assert_eq!(does(&mut talk, "put the screwdriver on the red shelf"), shelf);
    let found = does(&mut talk, "No, the other one.");
    assert!(found != shelf && (found.contains("put ") || found.starts_with("? ")), "{found}");
}

#[test]
fn what_is_named_next_goes_with_the_last_request() {
    let mut talk = Talk::new(&KITCHEN);
    assert!(does(&mut talk, "put the knife away").contains("Knife_01"));
    let found = does(&mut talk, "in the drawer, I mean");
    assert!(found.contains("put ") && (found.contains("Drawer") || found.contains("drawer")), "{found}");
}

#[test]
fn both_are_taken_one_after_the_other() {
    let scene = ["plan OfficeLayout2 BreakRoom", "add Bowl_01 on TableRound_02", "add Bowl_01 on KitchenCounterTop_02"];
    let mut talk = Talk::new(&scene);
    let asked = does(&mut talk, "put the bowl in the sink");
    assert!(asked.starts_with("? "), "{asked}");
    let found = does(&mut talk, "both");
    assert!(found.matches("put KitchenCounterSink").count() >= 2, "{found}");
}

#[test]
fn the_pieces_of_one_worktop_are_one_place() {
    let mut talk = Talk::new(&KITCHEN);
    does(&mut talk, "pick up the knife");
    let found = does(&mut talk, "put it on the counter");
    assert!(found.starts_with("put KitchenCounter"), "{found}");
}

#[test]
fn it_tells_where_it_took_something_from() {
    let mut talk = Talk::new(&KITCHEN);
    does(&mut talk, "pick up the knife");
    let found = does(&mut talk, "where did you get it?");
    assert!(found.contains("I took the knife from"), "{found}");
}

#[test]
fn nothing_is_poured_into_what_cannot_be_filled() {
    let found = does(&mut Talk::new(&KITCHEN), "pour the milk into the fridge");
    assert_eq!(found, "! I cannot pour the milk into the fridge.");
}

#[test]
fn a_question_after_a_statement_is_answered() {
    let mut talk = Talk::new(&["plan OfficeLayout2 Lab1", "add Laser_Tip on Desk_01"]);
    let found = does(&mut talk, "There's a tip that goes in the laser as well, do you see it anywhere around the lab?");
    assert!(found.starts_with("= ") || found.starts_with("? "), "{found}");
}
