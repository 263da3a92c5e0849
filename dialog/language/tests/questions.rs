//! Questions about what the robot sees, did and knows, also several at once and about what was spoken of before.

use crate::support::Talk;
use cohabit_language::Understanding;

/// Says these one after the other, does what is to be done, and gives the reply to the last.
fn replied(marks: &[&str], said: &[&str]) -> String {
    let mut talk = Talk::new(marks);
    let mut reply = String::new();
    for utterance in said {
        let understanding = talk.language.understand(utterance, &talk.scene, &mut talk.context);
        reply = understanding.reply().to_owned();
        if let Understanding::Plan { steps, .. } = &understanding {
            talk.carry_out(steps);
        }
    }
    reply
}

#[track_caller]
fn check(said: &[&str], expected: &str) {
    let found = replied(&[], said);
    let is_right = expected.strip_suffix('…').map_or(found == expected, |start| found.starts_with(start));
    assert!(is_right, "{said:?}\n    wanted {expected}\n    found  {found}");
}

#[test]
fn each_of_several_questions_is_answered() {
    check(&["where are we, and what are you holding?"], "I am in the break room. My hand is empty.");
    check(&["Hi! Where are we, and what are you holding?"], "I am in the break room. My hand is empty.");
    check(
        &["is the fridge open, is the microwave on and where is the milk?"],
        "No, the fridge is not open. No, the microwave is not on. The milk is in the fridge.",
    );
    check(
        &["how many mugs are there? what colors are they?"],
        "I know of 2 mugs. The mug is red and the mug is yellow.",
    );
    check(&["is the fridge open?"], "No, the fridge is not open.");
    check(&["what is in the quantum lab?"], "In the quantum lab there are …");
}

#[test]
fn they_are_those_of_the_answer_before() {
    check(&["how many mugs are there?", "what colors are they?"], "The mug is red and the mug is yellow.");
    check(&["how many mugs are there?", "and what are their colors?"], "The mug is red and the mug is yellow.");
}

#[test]
fn what_a_list_leaves_out_can_be_asked_for() {
    let list = replied(&[], &["what do you see?"]);
    assert!(list.ends_with(" and more: ask me what else."), "{list}");
    for rest in ["what are the others?", "and what are the other ones?", "what else?"] {
        let more = replied(&[], &["what do you see?", rest]);
        assert!(more.starts_with("I see") && more != list, "{rest}: {more}");
    }
}

#[test]
fn what_is_in_a_room_is_told_by_what_is_of_use_and_what_can_be_taken() {
    for asked in ["What's in this room?", "what have we got here?", "what do you see?"] {
        let told = replied(&[], &[asked]);
        assert!(told.contains("cabinet") && told.contains("banana"), "{asked} {told}");
        assert!(told.ends_with(" and more: ask me what else."), "{asked} {told}");
    }
    // All is told in the end, each thing once, and buttons after all else.
    let mut talk = Talk::new(&["at Lab2 20 10"]);
    let first = talk.say("what do you see?");
    assert!(first.contains("gravity pad") && first.contains("floppy disk") && !first.contains("button"), "{first}");
    let rest = talk.say("what else?");
    assert!(rest.contains("button") && !rest.contains("gravity pad"), "{rest}");
    assert_eq!(talk.say("what else?"), "= I see nothing else.");
}

#[test]
fn what_was_done_is_told() {
    const DONE: [&str; 3] = ["pick up the banana", "put it on the counter", "go to the main office"];
    let after = |said: &'static str| [DONE.as_slice(), &[said]].concat();
    let all = "So far I picked up the ";
    check(&after("what have you done so far?"), &format!("{all}…"));
    for asked in ["Can you tell me everything you did today?", "what did you do so far?", "sum up what you did"] {
        let told = replied(&[], &after(asked));
        let places: Vec<Option<usize>> =
            ["picked up the banana", "put the banana on", "went to the main office"].map(|deed| told.find(deed)).into();
        assert!(places.iter().all(Option::is_some) && places.is_sorted(), "{asked} {told}");
    }
    check(
        &after("what did you do just now?"),
        "I went to the main office. Before that I picked up the banana and put…",
    );
    check(
        &after("why did you put the banana on the counter?"),
        "I put the banana on the counter top, since you asked me to put it…",
    );
    check(&after("why did you turn left?"), "Because you asked me to go to the main office…");
    let with_it = replied(&[], &after("what did you do with the banana?"));
    assert!(with_it.contains("picked up") && with_it.contains("put the"), "{with_it}");
}

#[test]
fn why_is_answered_of_what_was_asked_about() {
    check(&["open the fridge", "why is the milk in the fridge?"], "I do not know why.");
    check(&["open the fridge", "why is the sky blue?"], "I do not know why.");
    check(&["open the fridge", "why?"], "Because you asked me to open the fridge…");
    // What failed since does not explain what was done before.
    let mut talk = Talk::new(&[]);
    talk.say_and_do("open the fridge");
    let failing = talk.language.understand("open the microwave", &talk.scene, &mut talk.context);
    let Understanding::Plan { steps, .. } = failing else { panic!("{failing:?}") };
    talk.context.note_outcome(&steps[0], cohabit_cdf::Status::TargetOutOfRange);
    let told = talk.say("why did you open the fridge?");
    assert!(told.starts_with("= I opened the fridge, since you asked me to open the fridge"), "{told}");
    assert_eq!(talk.say("why?"), "= I did not finish opening the microwave: it is too far away.");
}

#[test]
fn why_a_step_was_done_is_what_it_was_needed_for_and_then_what_was_asked_for() {
    const MENDS: &str = "repair the bowl in the time machine";
    check(
        &[MENDS, "why did you close the time machine?"],
        "I closed the time machine, since it has to be closed before it runs…",
    );
    let opened = replied(&[], &[MENDS, "why did you open the time machine?"]);
    assert!(opened.contains("since it had to be open for "), "{opened}");
    check(
        &["turn on the freeze ray", "why did you turn on the blue computer?"],
        "I turned on the blue computer, since the freeze ray has no switch of its own…",
    );
    check(
        &["put the banana on the counter", "why did you pick up the banana?"],
        "I picked up the banana, since I needed it in my hand for putting the banana on the counter top. You asked…",
    );
}

#[test]
fn where_a_thing_was_is_told_though_it_was_moved() {
    let found = ["pick up the hammer", "where was it when you found it?"];
    check(&found, "I took the hammer from the blue desk…");
    check(
        &["pick up the hammer", "take the hammer back to where you found it"],
        "OK, putting the hammer on the blue desk…",
    );
}

#[test]
fn what_it_said_is_said_again() {
    const MILK: &str = "I said: \"The milk is in the fridge.\"";
    check(&["what did you say?"], "I have not said anything yet.");
    for said in ["what did you say?", "say that again please", "can you repeat that?"] {
        check(&["where is the milk?", said], MILK);
        check(&["where is the milk?", said, said], MILK);
    }
    // What was asked since is repeated, and not what was done before.
    check(&["pick up the banana", "where is the milk?", "repeat that please"], MILK);
    assert_eq!(replied(&[], &["turn left", "repeat that"]), replied(&[], &["turn left"]));
}

#[test]
fn what_is_asked_by_itself_is_answered_whatever_is_said_around_it() {
    for asked in ["Ooh, so this is the robotics lab! What else is in here?", "What a mess. What can you see?"] {
        let mut talk = Talk::new(&["at Lab1 10 8"]);
        talk.say_and_do("pick up the laser tip and put it on the blue shelf");
        let told = talk.say(asked);
        assert!(told.starts_with("= I see "), "{asked} {told}");
    }
    let asked = "So what have you done for me so far this morning? You are so clever.";
    check(&["pick up the banana", asked], "So far I picked up the banana.");
}

#[test]
fn goals_are_told_of_what_it_did_and_not_of_what_was_so_before() {
    let mut talk = Talk::new(&[]);
    talk.say_and_do("pick up the banana");
    talk.scene.goals[1].met = true;
    let told = talk.say("what have you done so far?");
    assert_eq!(told, "= So far I picked up the banana. That did what the mission wants: Pour milk into the bowl.");
}

#[test]
fn what_is_in_a_thing_is_told_where_it_is_asked_whether_it_is_empty() {
    let coffee = ["CoffeeMug_Boss_1 coffee"];
    let told = |said: &str| replied(&coffee, &[said]);
    assert_eq!(told("is the red mug empty?"), "No, there is coffee in the red mug.");
    assert_eq!(told("is the red mug full?"), "Yes, there is coffee in the red mug.");
    assert_eq!(told("is the yellow mug empty?"), "Yes, the yellow mug is empty.");
}

#[test]
fn what_else_it_did_is_no_question_about_goals() {
    check(&["pick up the banana", "put it on the counter", "what else did you do?"], "So far I picked up the …");
    check(&["what else did you do?"], "I have done nothing yet.");
}

#[test]
fn what_works_a_machine_is_told() {
    check(&["which computer controls the freeze ray?"], "The blue computer…");
    check(&["which computer is for the laser?"], "The red computer…");
    check(&["is the blue computer the one for the freeze ray?"], "Yes: the blue computer switches the freeze ray…");
    check(&["is the blue computer for the laser?"], "No, as far as I know: …");
    check(&["turn on the computer that controls the freeze ray"], "OK, turning on the blue computer.");
    // What works nothing may be for anything.
    check(&["where is the tip for the laser?"], "The laser tip is …");
}

#[test]
fn what_is_before_a_machine_is_what_it_aims_at() {
    let scene = ["Banana_01_1 in AP_Prop_Shelf_Wall_Laser_1"];
    for asked in ["what is in front of the laser?", "what does the laser point at?", "where is the laser pointing?"] {
        let told = replied(&scene, &[asked]);
        assert!(told.starts_with("The laser aims at the ") && told.contains("banana"), "{asked} {told}");
    }
    let told = replied(&[], &["what is in front of you?"]);
    assert!(told.starts_with("I see "), "{told}");
}

#[test]
fn the_lab_that_is_asked_about_is_the_one_in_which_something_was_done_last() {
    check(&["is the light in the lab still on?"], "Which lab do you mean…");
    let asked = ["turn off the light switch in the quantum lab", "is the light in the lab still on?"];
    let told = replied(&["LightSwitch_01_2 on"], &asked);
    assert!(told.starts_with("No, the light switch"), "{told}");
}

#[test]
fn what_a_machine_does_is_told_with_what_works_it() {
    let freezes = "The freeze ray fires a beam that freezes what stands on the blue shelf before it. \
                   It has no switch of its own: the blue computer works it.";
    for asked in ["what does the freeze ray do?", "how is the freeze ray switched on?", "what turns the freeze ray on?"]
    {
        check(&[asked], freezes);
    }
    let told = replied(&[], &["what is the freeze ray doing?"]);
    assert!(told.starts_with("I do not know that. What I know: ") && told.contains("fires a beam"), "{told}");
    check(&["what is the freeze ray for?", "how do people switch it on?"], "By turning on the blue computer…");
}

#[test]
fn what_a_kind_of_thing_is_is_known_before_one_was_seen() {
    for asked in ["What's a freeze ray, and where do they keep it?", "what is a freeze ray and where is it?"] {
        let told = replied(&["without FreezeRay_1"], &[asked]);
        let kind = "A freeze ray fires a beam that freezes what stands on the blue shelf before it. I have not seen";
        assert!(told.starts_with(kind), "{asked} {told}");
    }
}

#[test]
fn why_something_is_done_so_orders_nothing() {
    for asked in [
        "Hooray! Why do you need to use a computer for it, couldn't you just press a button on the laser itself?",
        "why did you need the blue computer, could you not press a button?",
        "Oh well, why not? There is a toaster right next to it.",
    ] {
        let mut talk = Talk::new(&[]);
        talk.say_and_do("turn on the freeze ray");
        let understanding = talk.language.understand(asked, &talk.scene, &mut talk.context);
        assert!(matches!(understanding, Understanding::Answer { .. }), "{asked} {understanding:?}");
    }
}

#[test]
fn who_only_wants_to_know_something_is_offered_no_deed() {
    for said in [
        "what did the laser hit when you fired it?",
        "why does the bowl need the time machine?",
        "where would you put the apple?",
        "who broke the bowl?",
        "how heavy is the hammer?",
    ] {
        let mut talk = Talk::new(&[]);
        let understanding = talk.language.understand(said, &talk.scene, &mut talk.context);
        let is_told = matches!(understanding, Understanding::Answer { .. } | Understanding::Refusal { .. });
        assert!(is_told, "{said}: {understanding:?}");
    }
    check(&["how do I open the fridge?"], "By opening the fridge…");
    check(&["how does one open the fridge?"], "By opening the fridge…");
}

#[test]
fn what_is_to_be_told_is_told_after_what_is_to_be_done() {
    check(&["can you tell me where you are and what you are holding?"], "I am in the break room. My hand is empty.");
    check(&["can you show me where the bowl is?"], "The bowl is on the round table.");
    check(&["tell me which computer is for the laser"], "The red computer…");
    check(&["which mugs do you see here?"], "The red mug on the round table and the yellow mug on the round table.");
    check(
        &["go to the robotics lab", "what mugs can you see there?"],
        "None that I have seen here. I can look around.",
    );
    check(&["pick up the hammer", "tell me what you have in your hand"], "I am holding the hammer.");
}

#[test]
fn a_question_does_not_agree_to_what_was_proposed() {
    let mut talk = Talk::new(&[]);
    let asked = talk.language.understand("the milk goes with the bowl, you know", &talk.scene, &mut talk.context);
    for said in ["can you tell me what you have done so far?", "what is on the table?", "who broke the bowl?"] {
        let mut then = talk.context.clone();
        let found = talk.language.understand(said, &talk.scene, &mut then);
        assert!(!matches!(found, Understanding::Plan { .. }), "{asked:?}, {said}: {found:?}");
    }
}

#[test]
fn what_can_be_done_with_a_thing_is_told_by_what_is_done_to_its_kind() {
    let plate = "I know of no special use for the plate: I can carry it, wash it and put things on it.";
    check(&["what can I do with the plate?"], plate);
    check(&["what can be done with the plate?"], plate);
    check(&["what is the plate good for?"], plate);
}

#[test]
fn what_it_could_pick_up_is_told_of_the_room_that_is_meant() {
    for asked in ["what can you pick up in here?", "so what can you carry?", "what can I ask you to pick up?"] {
        let told = replied(&[], &[asked]);
        assert!(told.starts_with("Here I can pick up ") && told.contains("banana"), "{asked} {told}");
        assert!(!told.contains("fridge") && !told.contains("trophy"), "{asked} {told}");
    }
    check(
        &["what can you pick up in the main office?"],
        "In the main office I can pick up a hammer, a record and a trophy.",
    );
    check(&["what can you pick up from the red desk?"], "On the red desk I can pick up a record.");
}

#[test]
fn another_one_is_none_that_is_in_question() {
    let bowl = ["held Bowl_01_1"];
    let told = |said: &[&str]| replied(&bowl, said);
    assert_eq!(told(&["is there another bowl?"]), "No, I know of no other bowl: the bowl is in my hand.");
    assert_eq!(told(&["are there any other bowls?"]), "No, I know of no other bowl: the bowl is in my hand.");
    let mug = replied(&["held CoffeeMug_Boss_1"], &["is there another mug?"]);
    assert!(mug.starts_with("Yes, the yellow mug is on the round table"), "{mug}");
    let trophy = replied(&[], &["where is the trophy?", "is there another trophy?"]);
    assert!(trophy.starts_with("No, I know of no other trophy: the trophy is "), "{trophy}");
    check(&["is there another trophy?"], "Yes, the trophy is …");
}

#[test]
fn who_is_there_and_whether_it_is_safe_is_known() {
    check(&["who is there?"], "I see nobody here.");
    check(&["is there anybody here?"], "I see nobody here.");
    let talk = |said: &str| Talk::new(&[]).say(said);
    assert_eq!(talk("if there is no person here, open the fridge"), "open FridgeLower_02_1");
    check(&["is there anybody in the main office?"], "I cannot see into the main office from here: I am in the break…");
    check(&["who is in the main office?"], "I cannot see into the main office from here…");
    check(&["is there anybody in the break room?"], "I see nobody here.");
    let told = talk("if nobody is in the main office, open the fridge");
    assert!(told.starts_with("? I cannot tell whether "), "{told}");
    let told = talk("if there is somebody in the main office, open the fridge");
    assert!(told.starts_with("? I cannot tell whether "), "{told}");
    assert_eq!(talk("if it is safe here, open the fridge"), "open FridgeLower_02_1");
    assert!(talk("if it is dangerous here, open the fridge").starts_with("= "));
}

#[test]
fn what_may_be_warmer_than_it_was_is_looked_at_first() {
    let mut talk = Talk::new(&[]);
    let hidden = |talk: &mut Talk, visible: bool| {
        talk.scene.objects.iter_mut().filter(|one| one.instance == "Bowl_01_1").for_each(|one| one.visible = visible);
    };
    hidden(&mut talk, false);
    let looks = talk.language.understand("is the bowl hot?", &talk.scene, &mut talk.context);
    let Understanding::Plan { steps, reply } = looks else { panic!("{looks:?}") };
    assert!(reply.contains("looking at the bowl"), "{reply}");
    talk.carry_out(&steps);
    // That there is nothing to read on it is news to who wanted it to be looked at alone.
    let is_told = |context| talk.language.is_worth_telling(&steps[0], &talk.scene, context);
    assert!(!is_told(&talk.context) && is_told(&cohabit_language::Context::default()));
    hidden(&mut talk, true);
    let answer = talk.language.carry_on(&talk.scene, &mut talk.context).unwrap();
    assert_eq!(answer.reply(), "No, the bowl is not hot.");
}

#[test]
fn what_was_asked_for_is_called_so() {
    let why = replied(&[], &["open the fridge", "why did you open the fridge?"]);
    assert!(why.contains("since you asked me to open the fridge"), "{why}");
}

#[test]
fn what_it_is_asked_to_have_is_what_was_spoken_of() {
    check(&["pick up the banana", "do you have it?"], "Yes, I am holding the banana.");
    check(&["pick up the banana", "where is the hammer?", "do you have it?"], "No, I am holding the banana.");
    check(&["pick up the banana", "where is the hammer?", "are you holding it?"], "No, I am holding the banana.");
}

#[test]
fn what_a_request_takes_in_hand_is_there_for_the_next() {
    let done = Talk::new(&[]).say("fill the yellow mug with water and pick up the yellow mug");
    assert!(done.starts_with("take CoffeeMug_Yellow_1") && !done.contains("put"), "{done}");
}

#[test]
fn only_what_can_be_so_is_told_to_be_so() {
    let told = replied(&[], &["what is clean?"]);
    assert!(!told.contains("table"), "{told}");
    let told = replied(&[], &["is the red button pressed?"]);
    assert!(!told.starts_with("Yes"), "{told}");
}

#[test]
fn it_is_what_was_handled_though_talk_before_the_question_names_what_nobody_has_seen() {
    let mut talk = Talk::new(&[]);
    talk.say_and_do("pick up the banana");
    let grammar = talk.language.clone().without_rewriter();
    let asked = |said: &str| {
        let understanding = grammar.understand(said, &talk.scene, &mut talk.context.clone());
        understanding.reply().to_owned()
    };
    for said in [
        "Ha, iced coffee for the boss! Is it good and froze?",
        "A lovely salad for the boss! Is it nice and cold?",
        "is it properly frozen?",
        "is it all warmed up?",
    ] {
        let told = asked(said);
        assert!(told.starts_with("No, the banana is not "), "{said} {told}");
    }
    let told = asked("The hammer. Is it broken?");
    assert!(told.starts_with("No, the hammer is not broken"), "{told}");
}
