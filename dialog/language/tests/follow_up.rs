//! What is said next: answers to the robot's question, corrections, the same again with something else.

use crate::support::Talk;

const KITCHEN: [&str; 3] =
    ["plan OfficeLayout2 BreakRoom", "add Knife_01 on KitchenCounterTop_02", "add SandwichHalf_01 in FridgeLower_02"];

/// Questions of the robot's: in which scene, after what, and what a yes does first, where it may be answered with one.
const QUESTIONS: [(&[&str], &[&str], Option<&str>); 2] =
    [(&KITCHEN, &["pick up the banana and pick up the knife"], Some("take ")), (&KITCHEN, &["bring me a bowl"], None)];

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
            let question = before.iter().map(|said| talk.say_and_do(said)).last().unwrap();
            assert!(question.starts_with("? "), "{before:?}: {question}");
            talk
        };
        for said in YES {
            let (Some(first), mut talk) = (done, asked()) else { continue };
            let found = talk.say_and_do(said);
            assert!(found.starts_with(first), "{before:?}, {said}: {found}");
        }
        for said in NO {
            let found = asked().say_and_do(said);
            assert!(found.starts_with("= "), "{before:?}, {said}: {found}");
        }
    }
}

#[test]
fn the_other_one_is_another_than_was_taken() {
    let mut talk = Talk::new(&["plan OfficeLayout2 Lab1", "add Screwdriver on Desk_01"]);
    let shelf = "take Screwdriver, put AP_Prop_Shelf_Wall_Laser";
    assert_eq!(talk.say_and_do("put the screwdriver on the red shelf"), shelf);
    let found = talk.say_and_do("No, the other one.");
    assert!(found != shelf && (found.contains("put ") || found.starts_with("? ")), "{found}");
}

#[test]
fn what_is_named_next_goes_with_the_last_request() {
    let mut talk = Talk::new(&KITCHEN);
    assert!(talk.say_and_do("put the knife away").contains("Knife_01"));
    let found = talk.say_and_do("in the drawer, I mean");
    assert!(found.contains("put ") && (found.contains("Drawer") || found.contains("drawer")), "{found}");
}

#[test]
fn both_are_taken_one_after_the_other() {
    let scene = ["plan OfficeLayout2 BreakRoom", "add Bowl_01 on TableRound_02", "add Bowl_01 on KitchenCounterTop_02"];
    let mut talk = Talk::new(&scene);
    let asked = talk.say_and_do("put the bowl in the sink");
    assert!(asked.starts_with("? "), "{asked}");
    let found = talk.say_and_do("both");
    assert!(found.matches("put KitchenCounterSink").count() >= 2, "{found}");
}

#[test]
fn the_pieces_of_one_worktop_are_one_place() {
    let mut talk = Talk::new(&KITCHEN);
    talk.say_and_do("pick up the knife");
    let found = talk.say_and_do("put it on the counter");
    assert!(found.starts_with("put KitchenCounter"), "{found}");
}

#[test]
fn it_tells_where_it_took_something_from() {
    let mut talk = Talk::new(&KITCHEN);
    talk.say_and_do("pick up the knife");
    let found = talk.say_and_do("where did you get it?");
    assert!(found.contains("I took the knife from"), "{found}");
}

#[test]
fn nothing_is_poured_into_what_cannot_be_filled() {
    let found = Talk::new(&KITCHEN).say_and_do("pour the milk into the fridge");
    assert_eq!(found, "! I cannot pour the milk into the fridge.");
}

#[test]
fn a_question_after_a_statement_is_answered() {
    let mut talk = Talk::new(&["plan OfficeLayout2 Lab1", "add Laser_Tip on Desk_01"]);
    let found = talk.say_and_do("There's a tip that goes in the laser as well, do you see it anywhere around the lab?");
    assert!(found.starts_with("= ") || found.starts_with("? "), "{found}");
}
