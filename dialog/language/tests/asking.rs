//! When the robot asks, what it asks, and what it makes of the answers.

use crate::support::{
    Talk,
    cases::{before, cases},
};
use cohabit_language::{Asking, Clarification, Context, Understanding};

/// Lines `> utterance` and `@ instance pointed at`, each followed by what is understood; `…` ends a prefix.
fn check(asking: Asking, marks: &[&str], script: &str) {
    let mut talk = Talk::asking(marks, asking);
    let mut lines = script.lines().map(str::trim).filter(|line| !line.is_empty());
    while let Some(line) = lines.next() {
        let expected = lines.next().unwrap();
        let found = match line.split_once(' ') {
            Some(("@", instance)) => talk.choose(instance),
            Some((_, utterance)) => talk.say(utterance),
            None => panic!("{line}"),
        };
        let is_right = expected.strip_suffix('…').map_or(found == expected, |start| found.starts_with(start));
        assert!(is_right, "{line}\n    wanted {expected}\n    found  {found}\nin {script}");
    }
}

/// The kind of question that an utterance is answered with, and the answers that it offers.
fn asked(marks: &[&str], utterance: &str) -> (Clarification, Vec<String>) {
    let talk = Talk::new(marks);
    match talk.language.understand(utterance, &talk.scene, &mut Context::default()) {
        Understanding::Question { kind, options, .. } => (kind, options),
        other => panic!("no question: {other:?}"),
    }
}

#[test]
fn each_kind_of_question_has_its_occasion() {
    let check = |marks: &[&str], utterance: &str, kind: Clarification| {
        assert_eq!(asked(marks, utterance).0, kind, "{utterance}");
    };
    check(&[], "pick up the mug", Clarification::Reference);
    check(&[], "go to the lab", Clarification::Reference);
    check(&["without Hammer_1"], "pick up the hammer", Clarification::Location);
    check(&[], "pick up the flurbl", Clarification::Appearance);
    check(&[], "turn", Clarification::Direction);
    check(&[], "pick up the banana and pick up the knife", Clarification::Confirmation);
    check(&[], "the microwave", Clarification::Request);
    let mugs = ["the red mug on the round table", "the yellow mug on the round table"];
    assert_eq!(asked(&[], "pick up the mug").1, mugs);
    assert_eq!(asked(&[], "turn").1, ["left", "right", "around"]);
}

#[test]
fn never_takes_the_best_guess_or_refuses() {
    let check = |marks: &[&str], script: &str| check(Asking::Never, marks, script);
    check(&[], "> pick up the mug\ntake CoffeeMug_…");
    check(&[], "> pick up the blue apple\ntake Apple_…");
    check(&["held Bowl_01_1"], "> pick up the banana\nput TableRound_02_1, take Banana_01_1");
    check(&["without Hammer_1"], "> pick up the hammer\n! I have not seen a hammer…");
    check(&[], "> go to the lab\ngo Lab1");
    check(&[], "> turn\nturn -90");
}

#[test]
fn always_asks_before_it_commits_itself() {
    let check = |script: &str| check(Asking::Always, &[], script);
    check("> go to the kitchen\n? I understand: going to the break room. Shall I?\n> yes\ngo BreakRoom");
    check("> go to the kitchen\n? I understand…\n> no\n= All right, I leave it.");
    check("> go to the kitchen\n? I understand…\n> go to the main office\n? I understand: going to the main office…");
    check("> pick up the mug\n? Which…\n> the red one\ntake CoffeeMug_Boss_1");
    check("> look up\nlook 30");
}

#[test]
fn answers_come_in_any_form() {
    let check = |script: &str| check(Asking::Unsure, &[], &format!("> pick up the mug\n? Which…\n{script}"));
    check("> the other one\ntake CoffeeMug_Yellow_1");
    check("> no the other one\ntake CoffeeMug_Yellow_1");
    check("> I don't know\ntake CoffeeMug_Boss_1");
    check("> no idea\ntake CoffeeMug_Boss_1");
    check("> neither\n? I have not seen a mug. Where is it…\n> never mind\n= All right, I leave it.");
    check("> it is on the left\ntake CoffeeMug_Boss_1");
    check("> over there to the right\ntake CoffeeMug_Yellow_1");
    check("@ CoffeeMug_Yellow_1\ntake CoffeeMug_Yellow_1");
    check("> yes\n? Which…\n> the yellow one\ntake CoffeeMug_Yellow_1");
    check("> where is the milk?\n= The milk…");
}

#[test]
fn the_same_is_not_asked_twice_in_a_row() {
    let check = |marks: &[&str], script: &str| check(Asking::Unsure, marks, script);
    let asked = "> pick up the hammer\n? I have not seen a hammer. Where is it, or shall I look around?";
    check(&["without Hammer_1"], &format!("{asked}\n> pick up the hammer\nlook around"));
    check(&["without Hammer_1"], &format!("{asked}\n> where is the milk?\n= The milk…\n{asked}"));
    let mut talk = Talk::asking(&[], Asking::Unsure);
    let first = talk.say("pick up the mug");
    let second = talk.say("yes");
    assert_eq!(second, format!("{first} Name one of them, or say its number."));
    assert_eq!(talk.say("the second one"), "take CoffeeMug_Yellow_1");
}

#[test]
fn which_way_and_what_it_looks_like_are_answered() {
    let check = |marks: &[&str], script: &str| check(Asking::Unsure, marks, script);
    check(&[], "> turn\n? Which direction should I turn to?\n> to the left\nturn 90");
    check(&[], "> turn\n? Which…\n> over there on your right\nturn -90");
    check(&[], "> turn\n? Which…\n> around\nturn -180");
    check(
        &[],
        "> pick up the flurbl\n? I do not know what \"flurbl\" is…\n> it is a yellow mug\ntake CoffeeMug_Yellow_1",
    );
    check(
        &[],
        "@ Microwave_01_1\n? What shall I do with the microwave on the counter top?\n> open it\nopen Microwave_01_1",
    );
}

#[test]
fn all_of_a_kind_are_carried_one_by_one() {
    let check = |marks: &[&str], script: &str| check(Asking::Unsure, marks, script);
    check(
        &[],
        "> put all the mugs on the counter
        take CoffeeMug_Boss_1, put KitchenCounterTop_02_1, take CoffeeMug_Yellow_1, put KitchenCounterTop_02_1",
    );
    check(
        &[],
        "> pick up all the mugs\n? I can only carry one thing at a time. Shall I begin with the red mug?\n> yes\ntake CoffeeMug_Boss_1",
    );
    check(&[], "> pick everything up\n? I can only carry one thing at a time…");
}

#[test]
fn the_oracle_of_the_paper_is_understood() {
    let check = |marks: &[&str], script: &str| check(Asking::Unsure, marks, script);
    check(
        &[],
        "> pick up the mug\n? Which…\n> The mug is round and yellow. It is made of ceramic.\ntake CoffeeMug_Yellow_1",
    );
    check(&[], "> pick up the mug\n? Which…\n> The red mug on the table in the break room.\ntake CoffeeMug_Boss_1");
    check(
        &["held Bowl_01_1", "at MainOffice 11 2"],
        "> put it on the desk\n? Which…\n> The desk is rectangular and red. It is made of plastic.\nput AP_Prop_Desk_Red_1",
    );
    check(
        &["without CoffeeMug_Yellow_1", "CoffeeMug_Boss_1 in AP_Prop_Desk_Green_1"],
        "> pick up the blue mug\n? …\n> The mug is to your left on the green desk in the main office. It is closest to viewpoint 3.\ntake CoffeeMug_Boss_1",
    );
}

/// Whatever people say, a question that comes of it takes each answer that it offers: none is lost, and none leads to the same question.
#[test]
fn what_a_question_offers_is_an_answer_to_it() {
    let sets = [include_str!("utterances/manners.txt"), include_str!("utterances/first_contact.txt")];
    let mut offered = 0;
    for case in sets.into_iter().flat_map(cases).step_by(3) {
        let mut talk = before(&case);
        let said = case.said.last().unwrap();
        let asked = talk.language.understand(said, &talk.scene, &mut talk.context);
        let Understanding::Question { text, options, .. } = asked else { continue };
        for option in options {
            offered += 1;
            match talk.language.understand(&option, &talk.scene, &mut talk.context.clone()) {
                Understanding::Question { text: again, .. } => assert_ne!(again, text, "{said}: {option}"),
                Understanding::Refusal { is_lost, text, .. } => assert!(!is_lost, "{said}: {option}: {text}"),
                _ => {}
            }
        }
    }
    assert!(offered > 20, "{offered}");
}
