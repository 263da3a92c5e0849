//! What the robot does, and asks, of readings none of which is likely enough.
use crate::support::{Talk, catalog};
use cohabit_language::{Language, Understanding};

/// What a rewriter would write, each with its probability; the words themselves mean nothing.
const WRITTEN: &[(&str, &[(&str, f32)])] = &[
    (
        "sing that bowl a merry tune tonight",
        &[("open the microwave", 0.5), ("open the microwave; put the bowl in the microwave", 0.45)],
    ),
    (
        "sing that dinner plate a merry tune tonight",
        &[("pick up the plate", 0.5), ("open the microwave; pick up the plate", 0.45)],
    ),
    (
        "sing the banana gently onto the green desk tonight",
        &[
            ("put the banana on the green desk", 0.35),
            ("put the banana on the red desk", 0.3),
            ("put the banana on the toaster", 0.2),
        ],
    ),
    ("sing that plate a merry tune tonight", &[("pick up the plate", 0.1), ("turn on the toaster", 0.1)]),
    ("the plate, sing it a merry tune, I said", &[("pick up the plate", 0.15), ("turn on the toaster", 0.05)]),
    ("sing me a merry tune of fridges tonight", &[("is the fridge open?; turn on the microwave", 0.2)]),
    (
        "sing me one more merry tune tonight",
        &[("pour the cereal box into the bowl", 0.2), ("put the cereal box on the green desk", 0.1)],
    ),
    ("sing our bowl a happier tune tonight", &[("pour the milk into the bowl", 0.25)]),
    ("sing our plate a happier tune tonight", &[("break the plate", 0.25)]),
    ("sing that fridge one merry tune tonight", &[("open the fridge; social", 0.5), ("open the fridge", 0.4)]),
    ("sing this plate one merry tune tonight", &[("serenade the plate", 0.5), ("pick up the plate", 0.4)]),
    ("sing your gubbins one merry tune tonight", &[("pick up the gubbins", 0.5), ("pick up the plate", 0.4)]),
    ("sing those fridges one merry tune tonight", &[("open the fridge", 0.9)]),
    (
        "sing those far fridges one merry tune tonight",
        &[("open the fridge", 0.5), ("go to the break room; open the fridge", 0.45)],
    ),
    ("sing to that bowl about blue skies", &[("pick up the red bowl", 0.9)]),
    (
        "sing to see if the fridge is locked, and if it is not, open it",
        &[("if the fridge is locked, open the fridge", 0.6), ("if the fridge is not locked, open the fridge", 0.3)],
    ),
    (
        "sing that plate of ours a merry tune tonight",
        &[
            ("pick up the plate; put the plate in the fridge", 0.1),
            ("pick up the plate; put the plate in the freezer", 0.1),
        ],
    ),
    (
        "sing that plate a long merry tune tonight",
        &[
            ("pick up the plate; open the microwave; turn on the toaster", 0.2),
            ("open the fridge; pick up the plate; turn on the toaster; turn on the coffee maker", 0.2),
        ],
    ),
    ("sing my plate a merry tune tonight", &[("pick up the plate", 0.19)]),
    ("oh, I meant sing my plate a merry tune tonight", &[("pick up the plate", 0.19)]),
    ("what is that machine by the wall, the big one? it looks scary", &[("pick up the plate", 0.9)]),
    ("sing me the trophy and the plate tonight", &[("go to the plate", 0.9)]),
    (
        "sing that bowl a merry tune back where it was",
        &[("put the bowl on the counter", 0.6), ("put the bowl on the green desk", 0.35)],
    ),
    ("sing my dinner plate a merry tune tonight", &[("go to the plate", 0.5), ("pick up the plate", 0.45)]),
    ("sing two apples onto that counter tonight", &[("pick up the apple; put the apple on the counter", 0.95)]),
    ("make the bowl cold now please", &[("pick up the bowl", 0.95)]),
    ("what is on the round table?", &[("pick up the bowl", 0.95)]),
];

fn written(said: &str, _: &[(bool, String)], _: &str) -> Vec<(String, f32)> {
    let found = WRITTEN.iter().find(|(utterance, _)| *utterance == said).map_or(&[][..], |(_, written)| written);
    found.iter().map(|(text, probability)| ((*text).to_owned(), *probability)).collect()
}

fn talk() -> Talk {
    talk_in(&[])
}

fn talk_in(marks: &[&str]) -> Talk {
    let language = Box::leak(Box::new(Language::new(catalog()).with_rewriter(written)));
    Talk { language, ..Talk::new(marks) }
}

#[test]
fn what_all_readings_begin_with_is_done() {
    let mut talk = talk();
    let understanding = talk.language.understand("sing that bowl a merry tune tonight", &talk.scene, &mut talk.context);
    let Understanding::Plan { steps, reply } = understanding else { panic!("{understanding:?}") };
    assert_eq!(steps.len(), 1, "{reply}");
    assert!(reply.starts_with("OK, opening the microwave. Shall I also pick up the bowl and then put"), "{reply}");
}

#[test]
fn what_goes_back_goes_to_where_it_was_taken_from_and_to_no_place_that_nobody_spoke_of() {
    let mut talk = talk();
    talk.say_and_do("pick up the bowl");
    let done = talk.say("sing that bowl a merry tune back where it was");
    assert!(done == "put TableRound_02_1" || done.contains("putting the bowl on the round table. Shall I?"), "{done}");
}

#[test]
fn who_takes_a_thing_goes_to_it_first() {
    let mut talk = talk();
    let understanding =
        talk.language.understand("sing my dinner plate a merry tune tonight", &talk.scene, &mut talk.context);
    let Understanding::Plan { steps, reply } = understanding else { panic!("{understanding:?}") };
    assert!(reply.starts_with("OK, going to the plate. Shall I also pick up the plate?"), "{reply}");
    talk.carry_out(&steps);
    assert_eq!(talk.say("yes please"), "take FoodPlate_01_1");
}

#[test]
fn as_many_are_meant_as_were_said() {
    let told = talk().say("sing two apples onto that counter tonight");
    let (taken, asked) = (told.matches("take Apple").count(), told.matches("picking up").count());
    assert!(taken == 2 || asked == 2, "{told}");
}

#[test]
fn who_asked_for_things_is_not_served_with_a_walk_to_one_of_them() {
    let told = talk().say("sing me the trophy and the plate tonight");
    assert!(!told.starts_with("go "), "{told}");
}

#[test]
fn what_is_offered_besides_is_done_or_left_as_somebody_answers() {
    for answer in ["yes", "yes please", "that too", "Yes, the bowl too please.", "the bowl too", "both"] {
        let mut talk = talk();
        let _ = talk.say_and_do("sing that bowl a merry tune tonight");
        let done = talk.say(answer);
        assert!(done.starts_with("take Bowl_01_1, put Microwave_01"), "{answer}: {done}");
    }
    for answer in ["no", "leave it", "no thanks"] {
        let mut talk = talk();
        let _ = talk.say_and_do("sing that bowl a merry tune tonight");
        assert!(talk.say(answer).starts_with("= "), "{answer}");
        assert!(!talk.context.awaits_more(), "{answer}");
    }
}

#[test]
fn what_is_offered_besides_waits_for_the_end_of_the_plan() {
    let mut talk = talk();
    let said = talk.language.understand("sing that bowl a merry tune tonight", &talk.scene, &mut talk.context);
    let Understanding::Plan { steps, .. } = said else { panic!("{said:?}") };
    let agreed = talk.say("yes please");
    assert!(agreed.starts_with("= OK, picking up the bowl"), "the plan under way goes on: {agreed}");
    talk.carry_out(&steps);
    let then = talk.language.carry_on(&talk.scene, &mut talk.context);
    assert!(matches!(&then, Some(Understanding::Plan { steps, .. }) if steps.len() == 2), "{then:?}");
}

#[test]
fn what_is_offered_besides_is_asked_once_more_when_the_plan_has_ended() {
    let mut talk = talk();
    let _ = talk.say_and_do("sing that bowl a merry tune tonight");
    let asked = talk.language.carry_on(&talk.scene, &mut talk.context);
    let Some(Understanding::Question { text, options, .. }) = asked else { panic!("{asked:?}") };
    assert!(text.starts_with("Shall I also pick up the bowl"), "{text}");
    assert_eq!(options, ["yes", "no"]);
    assert_eq!(talk.language.carry_on(&talk.scene, &mut talk.context), None, "once is enough");
}

#[test]
fn what_readings_do_beside_is_offered_wherever_they_do_it() {
    let mut talk = talk();
    let understanding =
        talk.language.understand("sing that dinner plate a merry tune tonight", &talk.scene, &mut talk.context);
    assert!(understanding.reply().ends_with("Shall I also open the microwave?"), "{}", understanding.reply());
}

#[test]
fn what_is_said_again_is_not_asked_about_again() {
    let mut talk = talk();
    let asked = talk.say("sing that plate a merry tune tonight");
    assert!(asked.starts_with("? ") && asked.contains("plate") && asked.contains("toaster"), "{asked}");
    let done = talk.say("the plate, sing it a merry tune, I said");
    assert!(done.starts_with("take FoodPlate_01"), "{done}");
}

#[test]
fn what_all_plans_begin_with_is_said_once() {
    let mut talk = talk();
    let asked = talk.say("sing that plate of ours a merry tune tonight");
    assert!(asked.starts_with("? I understand: picking up the plate. I am not sure what comes then: "), "{asked}");
    assert_eq!(asked.matches("picking up").count(), 1, "{asked}");
    let done = talk.say("the freezer one");
    assert!(done.starts_with("take FoodPlate_01") && done.contains("put FridgeUpper_02"), "{done}");
}

#[test]
fn who_corrects_the_robot_is_not_asked_about_the_only_plan() {
    let mut talk = talk();
    talk.say_and_do("open the fridge");
    assert_eq!(talk.say("oh, I meant sing my plate a merry tune tonight"), "take FoodPlate_01_1");
    let asked = self::talk().say("sing my plate a merry tune tonight");
    assert!(asked.starts_with("? "), "{asked}");
}

#[test]
fn an_answer_may_come_after_a_remark_and_who_asks_back_chooses_nothing() {
    let mut talk = talk();
    talk.say("sing that plate a merry tune tonight");
    assert!(talk.say("Ooh what a mouthful. The second one, love.").contains("toggle Toaster"));
    talk.say("sing that plate a merry tune tonight");
    let echo = talk.say("The plate? Open the fridge.");
    assert!(!echo.contains("take FoodPlate_01"), "{echo}");
}

#[test]
fn a_question_of_their_own_chooses_none_of_what_the_robot_asked_about() {
    for asked in [
        "Tell me, what is the toaster?",
        "By the way, what is in the toaster, the silver one?",
        "what is that machine by the wall, the big one? it looks scary",
    ] {
        let mut talk = talk();
        talk.say("sing that plate a merry tune tonight");
        let told = talk.say(asked);
        assert!(!told.contains("toggle") && !told.starts_with("take"), "{asked}: {told}");
    }
    for answer in ["How about the toaster?", "Is it far? The second one, please.", "hmm, the toaster?"] {
        let mut talk = talk();
        talk.say("sing that plate a merry tune tonight");
        let done = talk.say(answer);
        assert!(done.contains("toggle Toaster_02"), "{answer}: {done}");
    }
}

#[test]
fn what_was_asked_beside_an_order_is_answered_though_the_order_is_asked_about() {
    let asked = talk().say("sing me a merry tune of fridges tonight");
    assert!(
        asked.starts_with("? No, the fridge is not open.") && asked.contains("turning on the microwave"),
        "{asked}"
    );
}

#[test]
fn a_yes_before_something_else_chooses_none_of_several() {
    let asked = || {
        let mut talk = talk();
        talk.say("sing that plate a merry tune tonight");
        talk
    };
    for other in ["Fine, I should eat something healthy anyway. Open the fridge.", "All right, open the fridge then."] {
        let done = asked().say(other);
        assert!(!done.contains("take FoodPlate_01") && !done.contains("toggle"), "{other}: {done}");
    }
    for answer in ["Yes, the second one.", "Fine, the toaster."] {
        let done = asked().say(answer);
        assert!(done.contains("toggle Toaster_02"), "{answer}: {done}");
    }
    // To what is asked about alone it agrees.
    let mut talk = talk();
    talk.say("sing my plate a merry tune tonight");
    let done = talk.say("Fine. Then open the fridge.");
    assert!(done.starts_with("take FoodPlate_01"), "{done}");
}

#[test]
fn what_meets_a_goal_of_the_mission_is_likelier_meant() {
    let done = talk().say("sing our bowl a happier tune tonight");
    assert!(done.contains("pour"), "{done}");
    let asked = talk().say("sing our plate a happier tune tonight");
    assert!(asked.starts_with("? "), "{asked}");
}

#[test]
fn where_the_place_was_named_no_other_one_is_asked_about() {
    let done = talk().say("sing the banana gently onto the green desk tonight");
    assert!(done.starts_with("take Banana_01_1") && done.contains("AP_Prop_Desk_Green_1"), "{done}");
}

#[test]
fn what_is_so_already_is_hardly_meant() {
    let asked = talk_in(&["Bowl_01_1 cereal"]).say("sing me one more merry tune tonight");
    assert!(asked.starts_with("? ") && asked.contains("putting the cereal box on the green desk"), "{asked}");
}

#[test]
fn talk_beside_a_request_is_no_part_of_it() {
    assert_eq!(talk().say("sing that fridge one merry tune tonight"), "open FridgeLower_02_1");
}

#[test]
fn where_the_likeliest_is_no_request_that_the_robot_knows_others_are_asked_about() {
    let asked = talk().say("sing this plate one merry tune tonight");
    assert!(asked.starts_with("? ") && asked.contains("picking up the plate"), "{asked}");
    let asked = talk().say("sing your gubbins one merry tune tonight");
    assert!(!asked.contains("picking up the plate"), "what nobody knows is not taken for something else: {asked}");
}

#[test]
fn who_is_sure_of_another_deed_overrules_the_grammar_but_not_its_answers() {
    assert_eq!(talk().say("make the bowl cold now please"), "take Bowl_01_1");
    let answer = talk().say("what is on the round table?");
    assert!(answer.starts_with("= "), "{answer}");
}

#[test]
fn to_go_where_a_thing_is_first_is_no_other_plan() {
    let done = talk_in(&["at MainOffice 10 0"]).say("sing those far fridges one merry tune tonight");
    assert!(done.ends_with("open FridgeLower_02_1") && !done.starts_with("? "), "{done}");
}

#[test]
fn what_was_only_understood_is_not_called_asked_for() {
    let mut talk = talk();
    let _ = talk.say_and_do("sing those fridges one merry tune tonight");
    let why = talk.say("why did you open the fridge?");
    assert!(why.contains("since I understood that I should open the fridge"), "{why}");
}

#[test]
fn of_what_was_perhaps_not_meant_it_is_sorry_and_offers_to_undo_it() {
    let mut talk = talk();
    talk.scene.goals.clear();
    let _ = talk.say_and_do("sing those fridges one merry tune tonight");
    let why = talk.say("why did you open the fridge?");
    assert!(why.ends_with("I am sorry if that is not what you meant. Shall I undo it?"), "{why}");
    assert_eq!(talk.say("yes"), "close FridgeLower_02_1");
}

#[test]
fn what_nobody_said_is_left_out_and_a_not_is_kept() {
    // There is no red bowl, and nobody spoke of one.
    assert_eq!(talk().say("sing to that bowl about blue skies"), "take Bowl_01_1");
    assert_eq!(talk().say("sing to see if the fridge is locked, and if it is not, open it"), "open FridgeLower_02_1");
}

#[test]
fn a_plan_is_chosen_by_its_length_and_done_without_what_is_left_out() {
    let asked = || {
        let mut talk = talk();
        let asked = talk.say("sing that plate a long merry tune tonight");
        assert!(asked.starts_with("? ") && asked.contains("coffee maker") && asked.contains("microwave"), "{asked}");
        (talk, asked)
    };
    for answer in ["the longer one", "the longer one, chief"] {
        let done = asked().0.say(answer);
        assert!(done.contains("toggle CoffeeMaker_01"), "{answer}: {done}");
    }
    for answer in ["the shorter one", "the shorter one, chief"] {
        let done = asked().0.say(answer);
        assert!(done.contains("open Microwave_01") && !done.contains("CoffeeMaker_01"), "{answer}: {done}");
    }
    let (mut talk, text) = asked();
    let which = if text.find("coffee maker") < text.find("microwave") { "first" } else { "second" };
    let done = talk.say(&format!("the {which} one, but without turning on the toaster"));
    assert!(done.contains("toggle CoffeeMaker_01") && !done.contains("Toaster_02"), "{done}");
}

#[test]
fn an_answer_may_say_what_one_alone_of_the_plans_has() {
    for answer in ["the toaster", "I said the toaster", "the toaster one", "the toaster, not the plate"] {
        let mut talk = talk();
        talk.say("sing that plate a merry tune tonight");
        let done = talk.say(answer);
        assert!(done.starts_with("toggle Toaster_02"), "{answer}: {done}");
    }
    let mut talk = talk();
    talk.say("sing that plate a merry tune tonight");
    let done = talk.say("open the fridge by the toaster");
    assert!(!done.contains("toggle"), "{done}");
}

/// What a rewriter writes that has read of offices alone.
fn of_offices(said: &str, _: &[(bool, String)], _: &str) -> Vec<(String, f32)> {
    let written: &[(&str, f32)] = match said {
        "off you pop to the kitchen, there is a dear" => &[("go to the break room", 0.9)],
        "well well what have we here then" => &[("what is in the break room?", 0.9)],
        "in you go and see what the table has" => &[("go to the break room; what is on the dining table?", 0.9)],
        "off with you, somewhere nice" => &[("go to the break room", 0.9)],
        _ => &[],
    };
    written.iter().map(|(text, probability)| ((*text).to_owned(), *probability)).collect()
}

fn at_home(marks: &[&str], said: &str) -> String {
    let mut talk = Talk::new(marks);
    talk.language = Box::leak(Box::new(talk.language.clone().with_rewriter(of_offices)));
    talk.say(said)
}

#[test]
fn a_room_that_there_is_not_is_the_one_that_was_said_or_none() {
    let hall = &["plan House_Family Hallway"];
    assert_eq!(at_home(hall, "off you pop to the kitchen, there is a dear"), "go Kitchen");
    let here = at_home(hall, "well well what have we here then");
    assert!(here.starts_with("= I see") || here.starts_with("= In the hallway"), "{here}");
    let table = at_home(hall, "in you go and see what the table has");
    assert!(table.contains("dining table") && !table.contains("break room"), "{table}");
    let lost = at_home(hall, "off with you, somewhere nice");
    assert!(!lost.contains("break room") && !lost.starts_with("go "), "{lost}");
}
