//! What the grammar does not read, the rewriter may: reasons around requests, verbs that nobody listed, wishes, stops.
use crate::support::Talk;
use cohabit_language::Understanding;

#[test]
fn a_request_is_found_among_other_words() {
    let mut talk = Talk::new(&[]);
    let said = "my hands are full at the moment, love, so would you ever fetch us the banana";
    assert_eq!(talk.say(said), "take Banana_01_1");
}

#[test]
fn a_verb_that_is_in_no_list_is_understood_by_what_it_means() {
    let mut talk = Talk::new(&[]);
    assert_eq!(talk.say("be a dear and nip over and fetch me that banana"), "take Banana_01_1");
}

#[test]
fn a_stop_in_any_words_ends_what_is_under_way() {
    for said in ["call it quits", "abandon that"] {
        let mut talk = Talk::new(&[]);
        assert_eq!(talk.say("go to the main office"), "go MainOffice");
        let understanding = talk.language.understand(said, &talk.scene, &mut talk.context);
        assert!(matches!(understanding, Understanding::Stop { .. }), "{said}: {understanding:?}");
    }
}

#[test]
fn who_wants_something_made_that_no_cartridge_is_for_hears_of_none() {
    for said in ["make us some cereal", "could you make me a bowl of milk"] {
        let said = Talk::new(&[]).say(said);
        assert!(!said.contains("cartridge"), "{said}");
    }
}

#[test]
fn nothing_is_guessed_of_words_that_mean_nothing() {
    for said in ["qwertz uiop", "the quick brown fox", "blah blah blah"] {
        let mut talk = Talk::new(&[]);
        let understanding = talk.language.understand(said, &talk.scene, &mut talk.context);
        assert!(!matches!(understanding, Understanding::Plan { .. }), "{said}: {understanding:?}");
    }
}

#[test]
fn an_order_among_small_talk_is_carried_out() {
    for said in [
        "Oh that is grand, my mother would have loved one of those. Now put the banana in the fridge.",
        "Braw! Put the banana in the fridge. What a day.",
    ] {
        let mut talk = Talk::new(&[]);
        assert_eq!(talk.say(said), "take Banana_01_1, open FridgeLower_02_1, put FridgeLower_02_1", "{said}");
    }
}

#[test]
fn a_question_and_an_order_both_count() {
    let mut talk = Talk::new(&["Microwave_01_1 open"]);
    let understanding =
        talk.language.understand("is the bowl broken? close the microwave door", &talk.scene, &mut talk.context);
    let Understanding::Plan { steps, reply } = understanding else { panic!("{understanding:?}") };
    assert_eq!(steps.len(), 1, "{steps:?}");
    assert!(reply.contains("the bowl is broken") && reply.contains("closing the microwave"), "{reply}");
}

#[test]
fn how_sure_it_is_is_told_apart() {
    let mut talk = Talk::new(&[]);
    assert_eq!(talk.say("pick up the banana"), "take Banana_01_1");
    assert!(talk.context.sureness() > 0.85, "{}", talk.context.sureness());
    let _ = talk.say("qwertz uiop");
    assert!(talk.context.sureness() < 0.85, "{}", talk.context.sureness());
}

#[test]
fn a_thing_that_nobody_spoke_of_is_the_one_that_was_named() {
    fn rewrites(said: &str, _: &[(bool, String)], _: &str) -> Vec<(String, f32)> {
        let text = if said.contains("trophy") { "put the carrot on the counter top" } else { "is the coffee hot?" };
        vec![(text.to_owned(), 0.95)]
    }
    let mut talk = Talk::new(&[]);
    talk.language = Box::leak(Box::new(talk.language.clone().with_rewriter(rewrites)));
    let found =
        talk.say("would you be a dear and have that trophy over on the counter of ours for me, there is a good lad");
    assert_eq!(found, "take Trophy01_1, put KitchenCounterTop_02_1");
    talk.say_and_do("pick up the bowl");
    let found = talk.say("there we are now, would you say that it has got itself good and warm by this time?");
    assert_eq!(found, "= No, the bowl is not hot.");
}
