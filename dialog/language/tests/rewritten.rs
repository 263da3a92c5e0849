//! What people say in long messages, understood with the rewriter.
use crate::support::{Talk, means, text};
use cohabit_language::Understanding;
use proptest::prelude::*;

const BREAK_ROOM: &[&str] = &[
    "plan OfficeLayout2 BreakRoom",
    "add CoffeeMug_Boss on KitchenCounterTop_02",
    "CoffeeMug_Boss coffee",
    "add Donut_01 on TableRound_02",
];

#[test]
fn remarks_and_reasons_are_passed_over() {
    means(
        BREAK_ROOM,
        &[
            "Oh dear, somebody has left a donut lying about on that little table, which my dentist would not like at all, so \
           be a love and throw it away for me before I am tempted",
        ],
        "take Donut_01, put TrashCan_01",
    );
    means(
        BREAK_ROOM,
        &["would you ever go over to the fridge there and get the milk out of it for me, there's a good lad"],
        "open FridgeLower_02, take MilkCarton_01",
    );
}

#[test]
fn what_has_another_colour_than_was_said_is_not_meant() {
    let fruit = ["plan OfficeLayout2 BreakRoom", "add Apple on TableRound_02", "add Banana_01 on TableRound_02"];
    for said in [
        "Ah, ok. Then go to the break room and put the yellow fruit in the white upper part of fridge, where is the ice",
        "There lies a yellow fruit on the table. Put it in the cold box, please.",
    ] {
        let found = Talk::new(&fruit).say(said).to_lowercase();
        assert!(!found.contains("apple"), "{said}: {found}");
    }
}

#[test]
fn what_was_done_before_is_referred_to() {
    means(
        BREAK_ROOM,
        &["pick up the boss's mug", "Grand. Now would you pop that in the microwave for me, and leave it in there"],
        "open Microwave_01, put Microwave_01",
    );
    means(
        BREAK_ROOM,
        &["open the fridge", "Lovely. And now shut it again, it's freezing in here"],
        "close FridgeLower_02",
    );
}

#[test]
fn a_question_beside_talk_is_answered() {
    let mut talk = Talk::new(BREAK_ROOM);
    let found = talk
        .say("Good morning to you! My daughter says I drink too much coffee. What is in the boss's mug, do you know?");
    assert!(found.starts_with("= ") && found.contains("mug"), "{found}");
}

#[test]
fn who_only_talks_has_nothing_done() {
    for said in [
        "well that was a long day, my feet are killing me and the bus was late again",
        "you did that beautifully, I could not have done it better myself",
    ] {
        let mut talk = Talk::new(BREAK_ROOM);
        let found = talk.say(said);
        assert!(found.starts_with("= ") || found.starts_with("? ") || found.starts_with("! "), "{said}: {found}");
    }
}

#[test]
fn an_unknown_verb_is_no_deed() {
    for said in ["blorp the zargle", "zorch the donut", "please snorfle the boss's mug"] {
        let mut talk = Talk::new(BREAK_ROOM);
        let found = talk.say(said);
        assert!(found.starts_with("? ") || found.starts_with("! "), "{said}: {found}");
    }
}

#[test]
fn next_to_nothing_is_done_about_what_is_no_request() {
    let set =
        include_str!("utterances/off_domain.txt").lines().filter(|line| !line.starts_with('#') && !line.is_empty());
    let done = set.filter_map(|said| {
        let mut talk = Talk::new(&[]);
        let understanding = talk.language.understand(said, &talk.scene, &mut talk.context);
        let is_done = matches!(understanding, Understanding::Plan { .. } | Understanding::Stop { .. });
        is_done.then(|| format!("{said}: {}", text(&understanding, &talk.scene)))
    });
    let done: Vec<String> = done.collect();
    println!("{done:#?}");
    // It looks where somebody wants the horizon scanned.
    assert!(done.len() <= 4, "{done:#?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    #[test]
    fn any_text_has_an_outcome(said in "[a-zA-Z' ,.?!;é\u{1F600}]{0,200}") {
        let mut talk = Talk::new(BREAK_ROOM);
        let once = talk.language.understand(&said, &talk.scene, &mut talk.context.clone());
        prop_assert_eq!(&once, &talk.language.understand(&said, &talk.scene, &mut talk.context));
    }
}
