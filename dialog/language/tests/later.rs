//! What is done or answered once a plan has ended: what is left of the mission, a question about the outcome, what has yet to be found.

use crate::support::{Talk, text};
use cohabit_cdf::{RoomId, Status};
use cohabit_language::{Asking, KnownGoal, KnownPerson, Understanding};

/// Says something and carries out all that comes of it; a goal is met once the plan for it has ended. What was done and said, in order.
fn carried_out(talk: &mut Talk, utterance: &str) -> Vec<String> {
    let mut next = Some(talk.language.understand(utterance, &talk.scene, &mut talk.context));
    let mut all = Vec::new();
    while let Some(understanding) = next {
        all.push(text(&understanding, &talk.scene));
        let Understanding::Plan { steps, .. } = understanding else { break };
        talk.carry_out(&steps);
        if let Some(goal) = talk.scene.goals.iter_mut().find(|goal| !goal.met) {
            goal.met = true;
        }
        next = talk.language.carry_on(&talk.scene, &mut talk.context);
    }
    all
}

fn with_goals(mission: &str, goals: &[&str]) -> Talk {
    let mut talk = Talk::new(&[]);
    mission.clone_into(&mut talk.scene.mission);
    talk.scene.goals = goals.iter().map(|text| KnownGoal { text: (*text).to_owned(), met: false }).collect();
    talk
}

const CEREAL: [&str; 3] =
    ["Mend the bowl in the time machine", "Pour cereal into the bowl", "Pour milk over the cereal"];

#[test]
fn a_wish_that_names_the_mission_has_all_its_goals_done() {
    for wish in ["do the whole mission", "sort it out"] {
        let mut talk = with_goals("Make a bowl of cereal with milk", &CEREAL);
        let done = carried_out(&mut talk, wish);
        assert_eq!(done.len(), 3, "{wish}: {done:?}");
        assert!(done[0].contains("put YesterdayMachine_01_1"), "{wish}: {done:?}");
        assert!(done[1].ends_with("pour Bowl_01_1") && done[1].contains("Cereal_Box_01_1"), "{wish}: {done:?}");
        assert!(done[2].ends_with("pour Bowl_01_1") && done[2].contains("MilkCarton_01_1"), "{wish}: {done:?}");
        assert!(!talk.context.awaits_more(), "{wish}");
    }
}

#[test]
fn what_is_going_to_be_done_is_said_first() {
    let mut talk = with_goals("Make a bowl of cereal with milk", &CEREAL);
    let understanding = talk.language.understand("do the mission", &talk.scene, &mut talk.context);
    for goal in CEREAL {
        assert!(understanding.reply().contains(goal), "{}", understanding.reply());
    }
}

#[test]
fn what_was_to_come_later_is_left_after_a_failure_a_stop_and_another_request() {
    let start = || {
        let mut talk = with_goals("Make a bowl of cereal with milk", &CEREAL);
        let first = talk.language.understand("do the mission", &talk.scene, &mut talk.context);
        let Understanding::Plan { steps, .. } = first else { panic!("{first:?}") };
        assert!(talk.context.awaits_more());
        (talk, steps)
    };
    let (mut talk, steps) = start();
    talk.context.note_outcome(&steps[0], Status::TargetOutOfRange);
    assert!(!talk.context.awaits_more());
    let (mut talk, _) = start();
    let _ = talk.language.understand("stop", &talk.scene, &mut talk.context);
    assert!(!talk.context.awaits_more());
    let (mut talk, _) = start();
    let _ = talk.language.understand("pick up the knife", &talk.scene, &mut talk.context);
    assert!(!talk.context.awaits_more());
    let (mut talk, _) = start();
    let _ = talk.language.understand("what are you holding?", &talk.scene, &mut talk.context);
    assert!(talk.context.awaits_more(), "a question in between changes nothing");
}

#[test]
fn what_has_nothing_to_do_with_a_failure_is_done_all_the_same() {
    let failing = |said: &str| {
        let mut talk = Talk::new(&[]);
        let understood = talk.language.understand(said, &talk.scene, &mut talk.context);
        let Understanding::Plan { steps, .. } = understood else { panic!("{understood:?}") };
        talk.context.note_outcome(&steps[0], Status::ActionExecutionError);
        let then = talk.context.awaits_more().then(|| talk.language.carry_on(&talk.scene, &mut talk.context)).flatten();
        (then, talk)
    };
    let (then, mut talk) = failing("turn on the microwave and put the banana on the counter");
    let then = then.expect("the banana is no matter of the microwave");
    assert_eq!(text(&then, &talk.scene), "take Banana_01_1, put KitchenCounterTop_02_1");
    assert!(then.reply().starts_with("I do the rest all the same. OK, picking up the banana"), "{}", then.reply());
    assert_eq!(talk.say("yes"), "toggle Microwave_01_1", "what failed can be tried again");
    let (then, talk) = failing("put the banana in the microwave and turn on the sink");
    assert_eq!(then.map(|then| text(&then, &talk.scene)).as_deref(), Some("toggle KitchenCounterSink_01_1"));
    assert!(failing("put the banana in the microwave and close it").0.is_none());
}

#[test]
fn a_question_after_a_request_is_answered_when_that_is_done() {
    for (said, answer) in [
        ("open the fridge and tell me what's inside", "= In the fridge there is some milk."),
        ("take the banana, what are you holding?", "= I am holding the banana."),
        ("go to the quantum lab and tell me where you are", "= I am in the quantum lab."),
    ] {
        let done = carried_out(&mut Talk::new(&[]), said);
        assert_eq!(done.last().map(String::as_str), Some(answer), "{said}: {done:?}");
        assert_eq!(done.len(), 2, "{said}: {done:?}");
    }
}

#[test]
fn two_questions_get_two_answers() {
    for (said, answer) in [
        ("is the fridge open and is the microwave on?", "= No, the fridge is not open. No, the microwave is not on."),
        (
            "where is the milk and where is the cereal?",
            "= The milk is in the fridge. The cereal box is on the counter top.",
        ),
    ] {
        assert_eq!(carried_out(&mut Talk::new(&[]), said), [answer], "{said}");
    }
}

#[test]
fn a_question_with_words_before_it_is_not_carried_out() {
    for said in ["nah man the plate, is the plate clean", "the fridge, is it open", "why not?"] {
        let done = carried_out(&mut Talk::new(&[]), said);
        assert!(done.len() == 1 && done[0].starts_with(['=', '?']), "{said}: {done:?}");
    }
}

#[test]
fn nothing_is_poured_away_that_nobody_said_to() {
    let mut talk = Talk::new(&[]);
    assert!(talk.say("pour the milk").starts_with("? "));
    assert!(talk.say("into the bowl").ends_with("pour Bowl_01_1"));
    let mut talk = Talk::new(&[]);
    let _ = talk.say("grab the bowl");
    for said in ["pour some milk", "pour the milk over it"] {
        assert!(talk.say(said).ends_with("pour Bowl_01_1"), "{said}");
    }
    for said in ["pour out the milk", "dump the milk"] {
        assert!(Talk::new(&[]).say(said).ends_with("pour KitchenCounterSink_01_1"), "{said}");
    }
}

#[test]
fn several_things_are_thrown_into_the_same_place() {
    let done = Talk::new(&[]).say("throw all the fruit in the bin");
    assert_eq!(done.matches("put TrashCan_01_1").count(), 3, "{done}");
}

#[test]
fn a_proposal_is_answered_in_many_words() {
    for answer in ["aye go on then", "yes please love", "yeah go for it", "yes do", "ok sounds good to me"] {
        let Talk { language, scene, mut context } = Talk::new(&[]);
        let language = language.clone().asking(Asking::Always);
        let asked = language.understand("open the fridge", &scene, &mut context);
        assert!(matches!(asked, Understanding::Question { .. }), "{asked:?}");
        let done = language.understand(answer, &scene, &mut context);
        assert_eq!(text(&done, &scene), "open FridgeLower_02_1", "{answer}");
    }
}

#[test]
fn what_was_asked_about_is_done_when_it_is_chosen_in_the_same_words() {
    let mut proposals = 0;
    for said in include_str!("utterances/newcomers.txt").lines().filter_map(|line| line.split_once(" -> ")).take(150) {
        let Talk { language, scene, context } = Talk::new(&[]);
        let mut asked = context.clone();
        let question = language.understand(said.0, &scene, &mut asked);
        let Understanding::Question { text: question, candidates, options, .. } = question else { continue };
        let is_proposal = question.contains("I am not sure what you mean") || question.contains("I understand: ");
        if !is_proposal || !candidates.is_empty() {
            continue;
        }
        for option in options.into_iter().filter(|option| option != "no") {
            let done = language.understand(&option, &scene, &mut asked.clone());
            assert!(matches!(done, Understanding::Plan { .. }), "{}: {option}: {done:?}", said.0);
            proposals += 1;
        }
    }
    assert!(proposals > 1, "only {proposals} proposals were made");
}

#[test]
fn who_asks_for_a_reason_has_nothing_done() {
    for said in [
        "Wonderful! Why does the laser need a tip?",
        "Why is the milk in the fridge?",
        "who put the bowl on the table?",
        "And when would the banana go into the microwave?",
    ] {
        let done = Talk::new(&[]).say(said);
        assert!(done.starts_with(['=', '!', '?']), "{said}: {done}");
    }
}

/// Wakes a robot that waits, at this time; what it says or does then.
fn woken(talk: &mut Talk, now_s: f64) -> Option<String> {
    // What was written down and read again waits for the same.
    talk.context = serde_json::from_str(&serde_json::to_string(&talk.context).unwrap()).unwrap();
    let understanding = talk.language.wake(now_s, &talk.scene, &mut talk.context)?;
    if let cohabit_language::Understanding::Plan { steps, .. } = &understanding {
        talk.carry_out(steps);
    }
    Some(crate::support::text(&understanding, &talk.scene))
}

#[test]
fn a_time_is_waited_for() {
    for said in [
        "wait 10 seconds, then open the fridge",
        "wait for ten seconds and open the fridge",
        "in 10 seconds, open the fridge",
        "open the fridge in ten seconds",
        "wait 10 seconds; open the fridge",
    ] {
        let mut talk = Talk::new(&[]);
        assert_eq!(talk.say(said), "= I wait for 10 seconds. Then I go on.", "{said}");
        assert!(talk.context.awaits());
        assert_eq!(woken(&mut talk, 100.0), None, "{said}: the wait begins");
        assert_eq!(woken(&mut talk, 109.0), None, "{said}");
        assert_eq!(woken(&mut talk, 110.0).as_deref(), Some("open FridgeLower_02_1"), "{said}");
        assert!(!talk.context.awaits());
        assert_eq!(woken(&mut talk, 200.0), None, "{said}: once");
    }
    let mut talk = Talk::new(&[]);
    assert_eq!(talk.say("wait 2 minutes"), "= I wait for 2 minutes.");
    woken(&mut talk, 0.0);
    assert_eq!(woken(&mut talk, 120.0).as_deref(), Some("= 2 minutes are over."));
    assert_eq!(talk.say("did you wait?"), "= Yes, I waited for 2 minutes.");
    assert_eq!(Talk::new(&[]).say("did you wait?"), "= No, I have waited for nothing.");
}

#[test]
fn whether_it_has_done_what_it_was_told_is_told() {
    let mut talk = Talk::new(&[]);
    assert_eq!(talk.say("are you done?"), "= I have done nothing yet.");
    talk.say("open the microwave");
    assert_eq!(talk.say("are you done?"), "= Not yet: I am opening the microwave.");
    talk.say("stop");
    assert_eq!(talk.say("did you do it?"), "= No, I was told to stop before I had done it.");
    talk.say_and_do("open the fridge");
    for asked in ["are you done?", "did you do that?", "have you finished?", "did it work?"] {
        assert_eq!(talk.say(asked), "= Yes: I opened the fridge.", "{asked}");
    }
    let failing = talk.language.understand("open the microwave", &talk.scene, &mut talk.context);
    let Understanding::Plan { steps, .. } = failing else { panic!("{failing:?}") };
    talk.context.note_outcome(&steps[0], Status::TargetOutOfRange);
    assert_eq!(talk.say("did it work?"), "= No, I did not finish opening the microwave: it is too far away.");
}

#[test]
fn what_it_waits_for_is_what_it_does() {
    let mut talk = Talk::new(&[]);
    talk.say("in 10 seconds, open the fridge");
    assert_eq!(talk.say("what are you doing?"), "= I am waiting for 10 seconds.");
    talk.say("stop");
    assert_eq!(talk.say("what are you doing?"), "= I am waiting for you to tell me what to do.");
    talk.say("when the fridge is open, go to the main office");
    assert_eq!(talk.say("what are you doing?"), "= I am waiting until the fridge is open.");
}

#[test]
fn one_wait_does_not_end_another() {
    let mut talk = Talk::new(&[]);
    talk.say("in ten minutes open the fridge");
    talk.say("in five minutes go to the main office");
    assert_eq!(woken(&mut talk, 0.0), None);
    assert_eq!(woken(&mut talk, 300.0).as_deref(), Some("go MainOffice"));
    talk.say("stop");
    assert!(!talk.context.awaits(), "a stop ends all of it");
    talk.say("in ten minutes open the fridge");
    talk.say("in five minutes turn left");
    assert_eq!(woken(&mut talk, 400.0), None);
    assert_eq!(woken(&mut talk, 700.0).as_deref(), Some("turn 90"));
    assert!(talk.context.awaits());
}

#[test]
fn what_is_to_be_so_is_waited_for() {
    for said in [
        "when the fridge is open, go to the main office",
        "once the fridge is open go to the main office",
        "go to the main office as soon as the fridge is open",
        "wait until the fridge is open, then go to the main office",
    ] {
        let mut talk = Talk::new(&[]);
        assert_eq!(talk.say(said), "= I wait until the fridge is open. Then I go on.", "{said}");
        assert_eq!(woken(&mut talk, 0.0), None, "{said}");
        talk.scene = Talk::new(&["FridgeLower_02_1 open"]).scene;
        assert_eq!(woken(&mut talk, 1.0).as_deref(), Some("go MainOffice"), "{said}");
        assert_eq!(Talk::new(&["FridgeLower_02_1 open"]).say(said), "go MainOffice", "{said}: it is so already");
    }
    let mut talk = Talk::new(&[]);
    talk.say("when the fridge is open, go to the main office");
    woken(&mut talk, 0.0);
    let given_up = woken(&mut talk, 601.0).unwrap();
    assert_eq!(
        given_up,
        "= I have waited for 10 minutes, and it is not so yet that the fridge is open. I do not wait any longer."
    );
    assert!(!talk.context.awaits());
    assert_eq!(talk.say("did you wait?"), "= Yes, I waited for 10 minutes.");
}

#[test]
fn what_is_not_seen_is_not_waited_for() {
    const SHUT_IN: &[&str] = &["Bowl_01_1 in FridgeLower_02_1"];
    let mut talk = Talk::new(SHUT_IN);
    talk.scene.objects.iter_mut().filter(|object| object.instance == "Bowl_01_1").for_each(|object| {
        (object.visible, object.is_hidden) = (false, true);
    });
    assert_eq!(talk.say("when the bowl is hot, take it out"), "open FridgeLower_02_1, take Bowl_01_1");
}

#[test]
fn what_follows_a_wait_waits_too() {
    let mut talk = Talk::new(&[]);
    let first = talk.say_and_do("open the fridge, wait 5 seconds, then close it");
    assert_eq!(first, "open FridgeLower_02_1");
    let then = talk.language.carry_on(&talk.scene, &mut talk.context).unwrap();
    assert_eq!(then.reply(), "I wait for 5 seconds. Then I go on.");
    woken(&mut talk, 0.0);
    assert_eq!(woken(&mut talk, 5.0).as_deref(), Some("close FridgeLower_02_1"));
}

#[test]
fn a_stop_ends_a_wait() {
    for said in ["stop", "never mind", "forget it"] {
        let mut talk = Talk::new(&[]);
        talk.say("wait 10 seconds, then open the fridge");
        talk.say(said);
        assert!(!talk.context.awaits(), "{said}");
    }
    let mut talk = Talk::new(&[]);
    talk.say_and_do("go to the main office");
    assert_eq!(talk.say("wait"), "stop!", "a wait without a time");
    // A question between leaves it.
    let mut talk = Talk::new(&[]);
    talk.say("wait 10 seconds, then open the fridge");
    talk.say("where is the milk?");
    assert!(talk.context.awaits());
}

#[test]
fn when_somebody_has_time_is_no_time() {
    let check = |said: &str, expected: &str| assert_eq!(Talk::new(&[]).say(said), expected, "{said}");
    check("when you get a minute, open the fridge", "open FridgeLower_02_1");
    check("when you are done, open the fridge", "open FridgeLower_02_1");
}

#[test]
fn who_is_followed_is_gone_after_until_something_else_is_asked_for() {
    let at = |talk: &Talk, ahead_m: f32| {
        let [x, y, z] = talk.scene.robot.position_m;
        Some(KnownPerson { position_m: [x + ahead_m, y, z], yaw_rad: 0.0, room: talk.scene.robot.room })
    };
    let goes =
        |understanding: &Understanding| matches!(understanding, Understanding::Plan { steps, .. } if !steps.is_empty());
    let mut talk = Talk::new(&[]);
    assert!(talk.say("follow me").contains("cannot see where you are"));
    assert!(!talk.context.awaits());
    for ends in ["stop", "turn left"] {
        let mut talk = Talk::new(&[]);
        talk.scene.person = at(&talk, 1.0);
        assert!(talk.say("come with me").contains("I follow you"));
        assert!(talk.language.wake(1.0, &talk.scene, &mut talk.context).is_none(), "they have not gone on");
        talk.scene.person = at(&talk, 4.0);
        let after = talk.language.wake(2.0, &talk.scene, &mut talk.context).expect("they have gone on");
        assert!(goes(&after) && after.reply().is_empty(), "{after:?}");
        let Understanding::Plan { steps, .. } = after else { unreachable!() };
        assert!(talk.language.wake(2.5, &talk.scene, &mut talk.context).is_none(), "it is on its way");
        talk.carry_out(&steps);
        assert!(talk.say("where is the fridge?").starts_with('='), "a question is answered on the way");
        assert!(talk.context.awaits(), "and it goes on following");
        talk.say_and_do(ends);
        talk.scene.person = at(&talk, 8.0);
        assert!(talk.language.wake(9.0, &talk.scene, &mut talk.context).is_none(), "{ends}");
    }
}

#[test]
fn who_follows_says_so_while_they_stand_still() {
    let mut talk = Talk::new(&[]);
    let ([x, y, z], room) = (talk.scene.robot.position_m, talk.scene.robot.room);
    talk.scene.person = Some(KnownPerson { position_m: [x + 1.0, y, z], yaw_rad: 0.0, room });
    assert!(talk.say("follow me").contains("I follow you"));
    assert_eq!(talk.say("what are you doing?"), "= I am following you.");
    assert!(talk.context.awaits(), "and goes on with it");
    talk.say("stop");
    assert_eq!(talk.say("what are you doing?"), "= I am waiting for you to tell me what to do.");
}

#[test]
fn who_stands_still_beyond_a_doorway_is_gone_after_once() {
    let mut talk = Talk::new(&[]);
    talk.say_and_do("open the fridge");
    let [x, y, z] = talk.scene.robot.position_m;
    let person =
        |ahead_m: f32, yaw_rad: f32, room: RoomId| Some(KnownPerson { position_m: [x + ahead_m, y, z], yaw_rad, room });
    talk.scene.person = person(3.0, 0.0, talk.scene.robot.room);
    talk.say_and_do("follow me");
    // They look back at the robot from the next room.
    talk.scene.person = person(1.0, std::f32::consts::PI, RoomId::LAB1);
    let mut legs = 0;
    for second in 0..20 {
        let woken = talk.language.wake(f64::from(second), &talk.scene, &mut talk.context);
        if let Some(Understanding::Plan { steps, .. }) = woken {
            talk.carry_out(&steps);
            legs += 1;
        }
    }
    assert!((1..3).contains(&legs), "{legs}");
    let told = talk.say("what did you do?");
    assert!(told.starts_with("= I followed you. Before that I opened the fridge"), "{told}");
}

#[test]
fn who_is_not_to_follow_stays_and_who_is_to_wait_waits() {
    let mut talk = Talk::new(&[]);
    let ([x, y, z], room) = (talk.scene.robot.position_m, talk.scene.robot.room);
    let person = |ahead_m: f32| Some(KnownPerson { position_m: [x + ahead_m, y, z], yaw_rad: 0.0, room });
    talk.scene.person = person(1.0);
    talk.say("follow me");
    assert_eq!(talk.say("wait 10 seconds"), "= I wait for 10 seconds.");
    talk.scene.person = person(4.0);
    assert_eq!(woken(&mut talk, 0.0), None, "it waits where it is");
    assert_eq!(woken(&mut talk, 10.0).as_deref(), Some("= 10 seconds are over."));
    assert!(woken(&mut talk, 11.0).is_some_and(|then| then.starts_with("go ")), "and goes on following");
    assert_eq!(talk.say("don't follow me any more"), "stop!");
    talk.scene.person = person(8.0);
    assert_eq!(woken(&mut talk, 20.0), None);
}

#[test]
fn who_goes_somewhere_or_asks_for_something_first_is_followed_too() {
    let mut talk = Talk::new(&[]);
    let ([x, y, z], room) = (talk.scene.robot.position_m, talk.scene.robot.room);
    talk.scene.person = Some(KnownPerson { position_m: [x + 1.0, y, z], yaw_rad: 0.0, room });
    let told = talk.say("follow me to the main office");
    assert!(told.contains("I follow you") && talk.context.awaits(), "{told}");
    let language = talk.language.clone().without_rewriter();
    let first = language.understand("pick up the banana and follow me", &talk.scene, &mut talk.context);
    assert_eq!(text(&first, &talk.scene), "take Banana_01_1");
    let Understanding::Plan { steps, .. } = first else { unreachable!() };
    talk.carry_out(&steps);
    let then = language.carry_on(&talk.scene, &mut talk.context).expect("it follows then");
    assert!(then.reply().contains("I follow you") && talk.context.awaits(), "{then:?}");
}

#[test]
fn it_gets_out_of_the_way_and_gets_things_out_of_it() {
    let mut talk = Talk::new(&[]);
    for said in ["get out of the way", "could you step aside please", "you are in my way"] {
        assert_eq!(talk.say(said), "move -1.00", "{said}");
    }
    let mut kitchen = Talk::new(&["plan House_Family Kitchen", "add Toy_Car on Kitchen_Island"]);
    let done = kitchen.say("move the toy car aside");
    assert!(done.starts_with("take Toy_Car, put "), "{done}");
}

#[test]
fn who_wants_to_be_told_when_something_is_so_is_told() {
    for said in ["tell me when the kettle has boiled", "when the kettle is hot, let me know"] {
        let mut talk = Talk::new(&["plan House_Family Kitchen", "Kettle water"]);
        assert_eq!(talk.say(said), "= I wait until the kettle is hot.", "{said}");
        assert!(woken(&mut talk, 1.0).is_none(), "{said}");
        let kettle = talk.scene.objects.iter_mut().find(|object| object.instance == "Kettle").expect("a kettle");
        kettle.flags.set(cohabit_cdf::StateFlag::Hot, true);
        assert_eq!(woken(&mut talk, 2.0).as_deref(), Some("= The kettle is hot."), "{said}");
    }
}

#[test]
fn what_is_to_run_until_something_is_so_is_turned_on_first() {
    let office = ["CoffeeMug_Boss_1 in Microwave_01_1", "CoffeeMug_Boss_1 coffee", "Microwave_01_1 open"];
    for said in [
        "close the microwave and let it run until the coffee is hot",
        "shut the microwave, then leave it on till the coffee is hot",
        "close the microwave. run it until the coffee is hot",
    ] {
        let done = carried_out(&mut Talk::new(&office), said);
        assert_eq!(done, ["close Microwave_01_1", "toggle Microwave_01_1", "= The coffee is hot."], "{said}");
    }
    // What does not go off by itself is turned off then.
    for said in ["let the sink run for 10 seconds", "keep the sink on for 10 seconds"] {
        let mut talk = Talk::new(&[]);
        let done = carried_out(&mut talk, said);
        let waits = "= I wait for 10 seconds. Then I go on.";
        assert_eq!(done, ["toggle KitchenCounterSink_01_1", waits], "{said}");
        assert_eq!(woken(&mut talk, 0.0), None, "{said}");
        assert_eq!(woken(&mut talk, 10.0).as_deref(), Some("toggle KitchenCounterSink_01_1"), "{said}");
    }
}

#[test]
fn it_is_the_machine_that_is_done() {
    let washes = ["plan House_Family UtilityRoom", "add Shirt in Washing_Machine", "Shirt wet", "Washing_Machine on"];
    let told = "= I wait until it is done.";
    let goes_on = "= I wait until it is done. Then I go on.";
    for (said, waits, then) in [
        ("tell me when it's done", told, "= It is done."),
        ("wait until it is done", told, "= It is done."),
        ("when it's done, take out the shirt", goes_on, "open Washing_Machine, take Shirt"),
    ] {
        let mut talk = Talk::new(&washes);
        assert_eq!(talk.say("is the washing machine on?"), "= Yes, the washing machine is on.");
        assert_eq!(talk.say("is it done?"), "= No, the washing machine is still on.");
        assert_eq!(talk.say(said), waits, "{said}");
        assert!(woken(&mut talk, 1.0).is_none(), "{said}");
        let machine = talk.scene.objects.iter_mut().find(|object| object.instance == "Washing_Machine");
        machine.expect("a washing machine").flags.set(cohabit_cdf::StateFlag::Toggled, false);
        assert_eq!(woken(&mut talk, 2.0).as_deref(), Some(then), "{said}");
    }
    // What was asked for before is over by then.
    assert_eq!(Talk::new(&[]).say("when that is done, open the fridge"), "open FridgeLower_02_1");
    assert_eq!(Talk::new(&[]).say("is it done?"), "= Still to do: Pour milk into the bowl. Done so far: 1.");
}
