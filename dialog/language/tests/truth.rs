//! What the robot says of itself and of things holds, and it does nothing that was not asked for: questions are answered,
//! conditions are looked at, and verbs that it does not know are asked about.

use crate::support::Talk;

/// What must come of an utterance; `…` ends a prefix.
fn check(marks: &[&str], said: &str, expected: &str) {
    let found = Talk::new(marks).say(said);
    let is_right = expected.strip_suffix('…').map_or(found == expected, |start| found.starts_with(start));
    assert!(is_right, "{said} {marks:?}\n    wanted {expected}\n    found  {found}");
}

#[test]
fn questions_are_answered_and_not_carried_out() {
    const OPEN: &[&str] = &["FridgeLower_02_1 open"];
    check(OPEN, "did you close the fridge?", "= No, the fridge is open.");
    check(&[], "did you close the fridge", "= No, but the fridge is closed.");
    check(&[], "did you go to the main office?", "= No, not that I remember: I am in the break room.");
    check(&[], "did you touch the trophy?", "= I did nothing with the trophy that I remember.");
    let mut talk = Talk::new(&[]);
    talk.say_and_do("open the fridge");
    assert_eq!(talk.say("did you open the fridge?"), "= Yes, I did: the fridge is open.");
    assert_eq!(talk.say("did you close the fridge?"), "= No, the fridge is open.");
    check(OPEN, "thanks! did you close the fridge?", "= No, …");
    check(OPEN, "have you already closed the fridge?", "= No, the fridge is open.");
    check(&[], "did you turn on the microwave?", "= No, the microwave is off.");
    check(&[], "have you put the milk away?", "= …");
    check(&[], "is the fridge open?", "= No, the fridge is not open.");
    check(&[], "will the bowl fit in the microwave?", "= …");
    check(&[], "should I open the fridge?", "? I understand: opening the fridge. Shall I?");
    check(&[], "does the microwave heat the milk?", "= …");
}

#[test]
fn whether_something_was_left_so_is_whether_it_is_so() {
    const LEFT: &[&str] = &["FridgeLower_02_1 open", "Microwave_01_1 on"];
    check(LEFT, "did you leave the microwave on?", "= Yes, the microwave is on.");
    check(&[], "did you leave the microwave on?", "= No, the microwave is not on.");
    check(LEFT, "have you left the fridge open?", "= Yes, the fridge is open.");
    check(LEFT, "did I leave the fridge open?", "= Yes, the fridge is open.");
    check(&[], "did somebody leave the fridge open?", "= No, the fridge is not open.");
    // Where it was put is no state.
    check(&[], "did you leave the bowl on the counter?", "= No, …");
}

#[test]
fn requests_in_the_form_of_questions_are_carried_out() {
    let opens = "open FridgeLower_02_1";
    check(&[], "can you open the fridge?", opens);
    check(&[], "could you open the fridge please", opens);
    check(&[], "would you mind opening the fridge?", opens);
    check(&[], "why don't you open the fridge?", opens);
    check(&[], "will you open the fridge", opens);
}

#[test]
fn what_does_not_hold_is_not_carried_out() {
    const OPEN: &[&str] = &["FridgeLower_02_1 open"];
    let closes = "close FridgeLower_02_1";
    check(OPEN, "if the fridge is open, close it", closes);
    check(OPEN, "close the fridge if it is open", closes);
    check(OPEN, "if the fridge is open close it", closes);
    check(&[], "if the fridge is open, close it", "= The fridge is not open. So I leave that.");
    check(&[], "close the fridge if it's open", "= The fridge is not open. So I leave that.");
    check(&[], "if the fridge is open, close it. otherwise leave it alone", "= The fridge is not open. …");
    check(&[], "if the fridge is open, close it, otherwise open the microwave", "open Microwave_01_1");
    check(OPEN, "if the fridge is open, close it, otherwise open the microwave", closes);
    check(&[], "turn off the microwave if it is on", "= The microwave is not on. So I leave that.");
    check(&["Microwave_01_1 on"], "turn off the microwave if it is on", "toggle Microwave_01_1");
    check(OPEN, "unless the fridge is open, open the microwave", "= The fridge is open. So I leave that.");
    check(&[], "unless the fridge is open, open the microwave", "open Microwave_01_1");
    check(&[], "open the microwave unless the fridge is open", "open Microwave_01_1");
    check(OPEN, "if the fridge is not open, open the microwave", "= The fridge is open. So I leave that.");
    check(&["held Bowl_01_1"], "if you are holding the bowl, put it on the counter", "put KitchenCounterTop_02_1");
    check(&[], "if you are holding the bowl, put it on the counter", "= …");
}

#[test]
fn what_cannot_be_told_is_asked_about() {
    check(
        &[],
        "if the moon is purple, open the fridge",
        "? I cannot tell whether the moon is purple. Shall I do it all the same?",
    );
    check(
        &[],
        "if the bowl is heavy, put it on the counter",
        "? I cannot tell whether the bowl is heavy. Shall I do it all the same?",
    );
    let mut talk = Talk::new(&[]);
    talk.say("if the moon is purple, open the fridge");
    assert_eq!(talk.say("yes"), "open FridgeLower_02_1");
    check(&[], "if it's not too much trouble, open the fridge", "open FridgeLower_02_1");
    check(&[], "if you can, open the fridge", "open FridgeLower_02_1");
}

#[test]
fn unknown_verbs_are_asked_about() {
    for verb in ["brayk", "smesh", "frobnicate"] {
        let found = Talk::new(&[]).say(&format!("{verb} the bowl"));
        assert!(found.contains(&format!("\"{verb}\"")), "{verb}: {found}");
    }
    // Verbs in no list: what they mean to most people, a question, or that they are not known; nothing is changed for good.
    for verb in ["haul", "hoist", "heave", "lug", "whisk"] {
        let found = Talk::new(&[]).say(&format!("{verb} the bowl"));
        let is_safe = found == "take Bowl_01_1" || found.starts_with(['?', '!']);
        assert!(is_safe, "{verb}: {found}");
    }
    check(&[], "opne the fridge", "open FridgeLower_02_1");
}

#[test]
fn what_is_said_of_the_hand_is_so() {
    let said = "put the bowl down on the counter so that your hands are free";
    check(&["held Bowl_01_1"], said, "put KitchenCounterTop_02_1");
    check(&["held Bowl_01_1"], "put the bowl on the counter and drop it", "put KitchenCounterTop_02_1");
    check(&[], "drop it", "! I am not holding anything.");
    check(&["held Bowl_01_1"], "what are you holding?", "= I am holding the bowl.");
    let asked = Talk::new(&[]).say("pick up the banana and pick up the knife");
    assert!(!asked.contains("I am holding"), "{asked}");
}

#[test]
fn a_screen_that_stays_lit_is_spoken_of_as_such() {
    let found = Talk::new(&["at Lab1 10 8"]).say("turn off the red computer");
    assert_eq!(found, "= The red computer is off: it runs for a moment only, and its screen stays lit.");
    check(&[], "turn off the microwave", "= The microwave is already off.");
}

#[test]
fn who_names_the_tool_means_to_break_it() {
    let said = "break the plate with the hammer";
    let found = Talk::new(&[]).say(said);
    assert!(found.starts_with("take Hammer_1, break FoodPlate_01_1"), "{found}");
}

#[test]
fn a_stop_is_done_before_what_else_is_said() {
    use cohabit_language::Understanding;
    let check = |said: &str, expected: &str| {
        let mut talk = Talk::new(&[]);
        talk.say("go to the main office");
        let understanding = talk.language.understand(said, &talk.scene, &mut talk.context);
        let Understanding::Stop { then, .. } = understanding else { panic!("{said}: {understanding:?}") };
        let then = then.map(|then| crate::support::text(&then, &talk.scene)).unwrap_or_default();
        assert!(expected.strip_suffix('…').map_or(then == expected, |start| then.starts_with(start)), "{said}: {then}");
    };
    check("stop", "");
    check("stop, there is a cat in front of you", "");
    check("whoa whoa whoa you'll have the lamp over", "");
    check("Arre stop stop, go to the break room", "go BreakRoom");
    check("I said stop, leave it", "");
    check("stop! what are you holding?", "= My hand is empty.");
    check("stop and open the fridge", "open FridgeLower_02_1");
    check("never mind", "");
}

#[test]
fn what_is_in_a_vessel_is_known() {
    const COFFEE: &[&str] = &["CoffeeMug_Boss_1 coffee", "without CoffeeMug_Yellow_1"];
    check(COFFEE, "is there coffee in the mug?", "= Yes, there is coffee in the mug.");
    check(COFFEE, "is there any coffee left in the mug?", "= Yes, there is coffee in the mug…");
    check(COFFEE, "does the mug still have coffee in it?", "= Yes, there is coffee in the mug.");
    check(COFFEE, "is there milk in the mug?", "= No, there is no milk in the mug: there is coffee in it.");
    check(COFFEE, "is the mug full of coffee?", "= Yes, there is coffee in the mug.");
    check(COFFEE, "what is in the mug?", "= There is coffee in the mug.");
    check(COFFEE, "how much coffee is in the mug?", "= There is coffee in the mug.");
    check(COFFEE, "if there is coffee in the mug, open the fridge", "open FridgeLower_02_1");
    check(
        COFFEE,
        "if there is no coffee in the mug, open the fridge",
        "= There is coffee in the mug. So I leave that.",
    );
    check(&["Bowl_01_1 cereal"], "is there cereal in the bowl?", "= Yes, there is cereal in the bowl.");
    check(&[], "is there cereal in the bowl?", "= No, there is no cereal in the bowl: it is empty.");
    check(&[], "is the milk in the fridge?", "= Yes, the milk is in the fridge.");
    check(&[], "is the fridge empty?", "= No, the fridge is not empty.");
    check(&["CoffeeMug_Boss_1 coffee"], "pick up the mug with coffee", "take CoffeeMug_Boss_1");
    check(&["CoffeeMug_Boss_1 coffee"], "which mug has coffee in it?", "= The red mug on the round table.");
}

#[test]
fn what_is_said_of_all_is_so_of_all() {
    const ONE: &[&str] = &["CoffeeMug_Boss_1 coffee"];
    check(&[], "are both mugs empty?", "= Yes, they are all empty.");
    check(ONE, "are both mugs empty?", "= No, the red mug on the round table is not empty.");
    check(ONE, "how many mugs are empty?", "= I know of one: the yellow mug on the round table.");
    check(&[], "is anything broken?", "= Yes: the bowl on the round table.");
    check(&["Bowl_01_1 in FridgeLower_02_1"], "is the bowl red?", "= No, the bowl is white.");
    check(&[], "is the yellow mug green?", "= No, the mug is yellow.");
    check(&[], "does the bowl work?", "= No, there is something wrong with the bowl: it is broken.");
    check(&[], "does the microwave work?", "= Yes, I see nothing wrong with the microwave.");
    check(&[], "are you in the break room?", "= Yes, I am in the break room.");
    check(&[], "are you in the main office?", "= No, I am in the break room.");
}

#[test]
fn what_there_is_in_no_such_state_is_not_said_to_be_there() {
    let dirty = "I know of no clean plate: the plate is on the round table.";
    check(&[], "is there a clean plate?", &format!("= No, {dirty}"));
    check(&[], "is there a dirty plate?", "= Yes, the plate is on the round table.");
    check(&[], "where is the clean plate?", &format!("= {dirty}"));
    check(&[], "if there is a clean plate, open the fridge", &format!("= {dirty} So I leave that."));
    check(&[], "if there is a dirty plate, open the fridge", "open FridgeLower_02_1");
}

#[test]
fn what_is_asked_for_in_a_state_is_in_it_wherever_that_is_said() {
    const ON: &[&str] = &["Microwave_01_1 on"];
    check(&[], "is there a microwave on?", "= No, I know of no microwave that is on.");
    check(ON, "is there a microwave still on?", "= Yes: the microwave on the counter top.");
    check(ON, "is the microwave on in the break room?", "= Yes, the microwave is on.");
    check(
        &[],
        "if the microwave is on in the break room, open the fridge",
        "= The microwave is not on. So I leave that.",
    );
    check(ON, "if the microwave is on in the break room, open the fridge", "open FridgeLower_02_1");
    check(&[], "is the banana on the table in here?", "= Yes, the banana is on the round table.");
}

#[test]
fn nobody_is_nobody() {
    check(&[], "if nobody is here, open the fridge", "open FridgeLower_02_1");
    check(&[], "if there is somebody here, open the fridge", "= I see nobody here. So I leave that.");
}

#[test]
fn what_something_stands_in_is_not_full_for_that() {
    check(&[], "is the fridge empty?", "= No, the fridge is not empty.");
    check(&[], "is the fridge full?", "= I cannot tell whether the fridge is full: in the fridge there is some milk.");
    check(
        &[],
        "if the fridge is full, close the microwave",
        "? I cannot tell whether the fridge is full. Shall I do it all the same?",
    );
    check(&["CoffeeMug_Boss_1 coffee"], "is the red mug full?", "= Yes, there is coffee in the red mug.");
}

#[test]
fn a_noun_that_nobody_taught_is_asked_about() {
    check(&[], "pick up the sponge in the sink", "? I do not know what \"sponge\" is. What does it look like?");
    check(&[], "look under the table", "examine TableRound_02_1");
}

#[test]
fn whether_a_thing_is_what_is_named_is_told() {
    check(&[], "is the yellow thing on the round table the banana?", "= Yes, …");
    check(&[], "is the red thing on the round table the hammer?", "= No, …");
}

#[test]
fn why_something_was_not_done_is_that_nobody_asked_for_it() {
    let mut talk = Talk::new(&[]);
    talk.say_and_do("open the microwave");
    assert_eq!(talk.say("why did you not close the microwave?"), "= You did not ask me to close the microwave.");
    let told = talk.say("why did you open the microwave?");
    assert!(told.starts_with("= I opened the microwave, since you"), "{told}");
}

const LAB: [&str; 2] = ["plan OfficeLayout1 Lab1", "add CanSodaNew_01 on Desk_01"];

#[test]
fn what_a_machine_lacks_is_told() {
    let mut talk = Talk::new(&LAB);
    assert_eq!(talk.say("is the laser assembled?"), "= Yes, I see nothing wrong with the laser.");
    assert_eq!(talk.say("is the laser complete now?"), "= Yes, the laser is complete: nothing is missing in it.");
    talk.scene.objects.retain(|object| !matches!(object.instance.as_str(), "Laser_Tip" | "Laser_ControlPanel"));
    let lacks = "t lacks its laser tip and it lacks its control panel.";
    let complete = talk.say("is the laser complete now?");
    assert_eq!(complete, "= No, the laser is not complete: it lacks its laser tip and its control panel.");
    for said in [
        "what is missing from the laser?",
        "what is wrong with the laser?",
        "are any parts missing on the laser?",
        "is anything still missing in the laser?",
    ] {
        assert_eq!(talk.say(said), format!("= I{lacks}"), "{said}");
    }
    assert_eq!(talk.say("is the laser assembled?"), format!("= No, there is something wrong with the laser: i{lacks}"));
}

#[test]
fn what_is_not_where_it_was_thought_to_be_is_not_looked_for() {
    let mut talk = Talk::new(&LAB);
    talk.scene.objects.retain(|object| object.instance != "Laser_Tip");
    assert_eq!(talk.say("is there a laser tip in the laser?"), "= No, I do not see a laser tip in the laser.");
}

#[test]
fn what_cereal_is_poured_out_of_is_full_of_it() {
    let kitchen = ["plan OfficeLayout1 BreakRoom", "add Cereal_Box_01 on KitchenCounterTop_02"];
    check(&kitchen, "what is in the cereal box?", "= There is cereal in the cereal box.");
    check(&kitchen, "is the cereal box empty?", "= No, the cereal box is not empty.");
}

#[test]
fn a_can_is_no_modal_verb() {
    let mut talk = Talk::new(&LAB);
    assert_eq!(talk.say_and_do("bring the can to the main office"), "take CanSodaNew_01, go MainOffice");
}

#[test]
fn a_question_beside_thanks_is_answered() {
    let kitchen = ["plan OfficeLayout1 BreakRoom", "add Apple on TableRound_02"];
    let found = Talk::new(&kitchen).say("You were a star, thanks a million! Where did you say the apple was?");
    assert!(found.contains("round table"), "{found}");
}

#[test]
fn what_nobody_knows_is_asked_about_and_not_guessed() {
    let mut talk = Talk::new(&["plan OfficeLayout1 BreakRoom", "add CanSodaNew_01 on TableRound_02"]);
    talk.say_and_do("pick up the soda can");
    assert_eq!(talk.say("pick up the unicorn"), "? I do not know what \"unicorn\" is. What does it look like?");
}
