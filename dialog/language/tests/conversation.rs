//! Conversations: questions and their answers, pronouns, failures and their remedies.

use crate::support::{Talk, step_text};
use cohabit_cdf::{ObjectId, RoomId, Status};
use cohabit_language::{KnownObject, Understanding};

/// Lines of `> utterance` and what must come of it; `# step status` reports an outcome; `…` ends a prefix.
fn check(marks: &[&str], script: &str) {
    let mut talk = Talk::new(marks);
    let mut lines = script.lines().map(str::trim).filter(|line| !line.is_empty());
    while let Some(line) = lines.next() {
        let utterance = line.strip_prefix("> ").unwrap_or_else(|| panic!("no `>` in {line:?}"));
        let expected = lines.next().unwrap();
        let found = talk.say(utterance);
        let is_right = expected.strip_suffix('…').map_or(found == expected, |start| found.starts_with(start));
        assert!(is_right, "{utterance}\n    wanted {expected}\n    found  {found}\nin {script}");
    }
}

#[test]
fn a_question_is_answered_and_the_request_goes_on() {
    let question = "? Which one do you mean: the red mug on the round table or the yellow mug on the round table?";
    for (answer, mug) in [
        ("the red one", "Boss"),
        ("red", "Boss"),
        ("the yellow mug", "Yellow"),
        ("yellow please", "Yellow"),
        ("I mean the yellow one", "Yellow"),
        ("i'm referring to the yellow mug", "Yellow"),
        ("the left one", "Boss"),
        ("the one on the right", "Yellow"),
        ("the second", "Yellow"),
        ("the first one", "Boss"),
        ("the second one please", "Yellow"),
        ("the last one", "Yellow"),
        ("any", "Boss"),
        ("whichever", "Boss"),
        ("pick up the yellow one", "Yellow"),
        ("no, the yellow one", "Yellow"),
    ] {
        let script = format!(
            "> pick up the mug and put it on the counter\n{question}\n> {answer}\ntake CoffeeMug_{mug}_1, put KitchenCounterTop_02_1"
        );
        check(&[], &script);
    }
}

#[test]
fn an_answer_may_be_no_or_another_request_or_nonsense() {
    check(&[], "> pick up the mug\n? Which…\n> never mind\n= All right, I leave it.\n> yes\n= OK. What…");
    check(&[], "> pick up the mug\n? Which…\n> pick up the banana\ntake Banana_01_1");
    check(&[], "> pick up the mug\n? Which…\n> where is the milk?\n= The milk is in the fridge.");
    check(&[], "> pick up the mug\n? Which…\n> the purple one\n? Which…\n> the red one\ntake CoffeeMug_Boss_1");
    check(&[], "> pick up the mug\n? Which…\n> stop\nstop!");
}

#[test]
fn the_one_on_the_floor_is_the_one_that_is_on_nothing() {
    let fallen = || {
        let mut talk = Talk::new(&[]);
        let mug = talk.scene.objects.iter_mut().find(|one| one.instance == "CoffeeMug_Yellow_1").unwrap();
        (mug.parent, mug.position_m[2]) = (None, 0.0);
        talk
    };
    assert_eq!(fallen().say("pick up the mug on the floor"), "take CoffeeMug_Yellow_1");
    for answer in ["on the floor", "the one on the floor"] {
        let mut talk = fallen();
        assert!(talk.say("pick up the mug").starts_with("? Which one"));
        assert_eq!(talk.say(answer), "take CoffeeMug_Yellow_1", "{answer}");
    }
    let mut talk = Talk::new(&["held Bowl_01_1"]);
    assert!(talk.say("put it on the floor").starts_with("? I cannot put things on the floor"));
    assert_eq!(talk.say("yes"), "put TableRound_02_1");
}

#[test]
fn what_is_meant_instead_of_what_cannot_be_done_is_done() {
    for meant in [
        "No, not the whole laser. I mean only the tip, the small silver cone.",
        "not the laser, I meant the laser tip",
        "no no, just the tip",
    ] {
        check(&[], &format!("> pick up the laser\n! I cannot pick up the laser…\n> {meant}\ntake Laser_Tip_1"));
    }
}

#[test]
fn another_may_do() {
    check(&[], "> pick up the blue apple\n? I do not know of a blue apple. Do you mean…\n> the red one\ntake Apple_1");
    check(
        &["without CoffeeMug_Yellow_1"],
        "> pick up the blue mug\n? I do not know of a blue mug. Do you mean the red mug on the round table?\n> yes\ntake CoffeeMug_Boss_1",
    );
    check(
        &["without Hammer_1"],
        "> pick up the hammer\n? I have not seen a hammer. Where is it, or shall I look around?\n> yes please\nlook around",
    );
    check(&["without Hammer_1"], "> find the hammer\nlook around");
}

#[test]
fn what_is_held_may_be_put_down() {
    check(&["held Bowl_01_1"], "> pick up the banana\nput TableRound_02_1, take Banana_01_1");
    check(&[], "> pick up the banana and pick up the knife\n? I will be…\n> no\n= All right, I leave it.");
}

#[test]
fn there_are_two_labs() {
    let question = "? Which lab do you mean: the robotics lab or the quantum lab?";
    check(&[], &format!("> go to the lab\n{question}\n> the quantum one\ngo Lab2"));
    check(&[], &format!("> take the laser tip to the lab please\n{question}\n> lab 1\ntake Laser_Tip_1, go Lab1"));
    check(&["at Lab2 20 8"], "> go to the lab\ngo Lab2");
    check(&[], &format!("> go to the lab\n{question}\n> go to the kitchen\ngo BreakRoom"));
    check(&[], &format!("> go to the lab\n{question}\n> no\n= All right, I leave it."));
}

#[test]
fn pronouns_reach_back() {
    check(
        &[],
        "> go to the fridge\ngo FridgeLower_02_1\n> open it\nopen FridgeLower_02_1\n> what is in it?\n= In the fridge there is some milk.",
    );
    check(
        &[],
        "> where is the hammer?\n= The hammer is on the blue desk in the main office.\n> pick it up\ntake Hammer_1",
    );
    check(
        &[],
        "> the microwave\n? What shall I do with the microwave on the counter top?\n> open it\nopen Microwave_01_1",
    );
    check(
        &["held Bowl_01_1"],
        "> go to the time machine\ngo YesterdayMachine_01_1\n> put it in there\nopen YesterdayMachine_01_1, put YesterdayMachine_01_1",
    );
    check(&[], "> pick up the red apple\ntake Apple_1\n> do it again\ntake Apple_1");
    check(&[], "> find the yellow mug\ngo CoffeeMug_Yellow_1\n> pick up the mug\ntake CoffeeMug_Yellow_1");
    check(&[], "> show me the red mug\nshow CoffeeMug_Boss_1\n> pick up the other mug\ntake CoffeeMug_Yellow_1");
}

/// Says something, lets the first step end so, and gives back the report with what `answer` then means.
fn fail(talk: &mut Talk, utterance: &str, status: Status, detail: &str, answer: &str) -> (String, String) {
    let Understanding::Plan { steps, .. } = talk.language.understand(utterance, &talk.scene, &mut talk.context) else {
        panic!("no plan for {utterance}");
    };
    talk.context.note_outcome(&steps[0], status);
    let report = talk.language.report(&steps[0], status, detail, &talk.scene);
    (report, talk.say(answer))
}

#[test]
fn who_meant_another_one_of_the_kind_says_which() {
    let shown = "> show me the red mug\nshow CoffeeMug_Boss_1";
    for said in [
        "the other one",
        "no, the other one",
        "no, not that one",
        "that is the wrong one",
        "not that one, the yellow one",
        "no, the one on the right",
        "the yellow one",
    ] {
        check(&[], &format!("{shown}\n> {said}\nshow CoffeeMug_Yellow_1"));
    }
    // All of the request is meant again.
    let mut talk = Talk::new(&[]);
    talk.say_and_do("put the red mug on the counter");
    assert_eq!(talk.say("no, the other one"), "take CoffeeMug_Yellow_1, put KitchenCounterTop_02_1");
}

#[test]
fn a_failure_is_explained_and_yes_mends_it() {
    let mut talk = Talk::new(&["FridgeLower_02_1 open"]);
    let Understanding::Plan { steps, reply } =
        talk.language.understand("take the milk and put it on the table", &talk.scene, &mut talk.context)
    else {
        panic!("no plan");
    };
    assert_eq!(reply, "OK, picking up the milk and then putting the milk on the round table.");
    // Somebody closes the fridge before the robot is there.
    let fridge = talk.scene.objects.iter_mut().find(|object| object.instance == "FridgeLower_02_1").unwrap();
    fridge.flags.set(cohabit_cdf::StateFlag::Opened, false);
    talk.context.note_outcome(&steps[0], Status::ReceptacleIsClosed);
    let report = talk.language.report(&steps[0], Status::ReceptacleIsClosed, "the fridge is closed", &talk.scene);
    assert_eq!(report, "The fridge is closed. Shall I open it?");
    assert_eq!(talk.say("yes"), "open FridgeLower_02_1, take MilkCarton_01_1, put TableRound_02_1");

    let mut talk = Talk::new(&[]);
    // An offer takes the place of what the world says would help.
    let detail = "the microwave has no power: the lever in the fuse box switches it on";
    let (report, mended) = fail(&mut talk, "turn on the microwave", Status::ObjectUnpowered, detail, "yes");
    assert_eq!(report, "The microwave has no power. Shall I try the lever in the fuse box in the robotics lab?");
    assert_eq!(mended, "toggle FuseBox_01_Lever_1, toggle Microwave_01_1");

    // What the table of actions and devices says that it lacks is put right first, where the robot can.
    let mut talk = Talk::new(&[]);
    let detail = "the laser lacks its laser tip: the laser tip has to be put in first";
    let (report, mended) = fail(&mut talk, "turn on the red computer", Status::ActionExecutionError, detail, "yes");
    assert_eq!(report, "The laser lacks its laser tip. Shall I put the laser tip in first?");
    assert_eq!(mended, "take Laser_Tip_1, put Laser_1, toggle V_Monitor_Laser_1");

    let mut talk = Talk::new(&["CoffeeMug_Boss_1 in CoffeeMaker_01_1"]);
    let detail = "the coffee maker has neither water nor beans: I have to fill it first";
    let (report, mended) = fail(&mut talk, "turn on the coffee maker", Status::ActionExecutionError, detail, "yes");
    assert!(report.starts_with("The coffee maker has neither water nor beans. Shall I fill the "), "{report}");
    let filled = "toggle KitchenCounterSink_01_1, fill KitchenCounterSink_01_1, toggle KitchenCounterSink_01_1";
    assert_eq!(mended, format!("take CoffeeMug_Boss_1, {filled}, put CoffeeMaker_01_1, toggle CoffeeMaker_01_1"));

    let mut talk = Talk::new(&[]);
    let detail = "a chair is in the way: it has to be moved first";
    let (report, answer) = fail(&mut talk, "open the fridge", Status::TargetInaccessible, detail, "no");
    assert_eq!(report, "A chair is in the way. It has to be moved first.");
    assert_eq!(answer, "= All right.");
}

#[test]
fn what_a_plan_that_failed_left_on_or_open_is_put_right_and_what_was_asked_for_stays() {
    let planned = |talk: &mut Talk, said: &str| {
        let understanding = talk.language.understand(said, &talk.scene, &mut talk.context);
        let Understanding::Plan { steps, .. } = understanding else { panic!("{understanding:?}") };
        steps
    };
    let mut talk = Talk::new(&[]);
    let steps = planned(&mut talk, "wash the plate");
    talk.carry_out(&steps[..2]);
    talk.context.note_outcome(&steps[2], Status::TargetInaccessible);
    let right = talk.language.put_right(&talk.scene, &talk.context).unwrap();
    assert_eq!(right.reply(), "I am turning off the sink again.");
    let Understanding::Plan { steps: off, .. } = right else { panic!("{right:?}") };
    talk.carry_out(&off);
    assert_eq!(talk.language.put_right(&talk.scene, &talk.context), None, "it is off");
    let washes = "toggle KitchenCounterSink_01_1, clean KitchenCounterSink_01_1, toggle KitchenCounterSink_01_1";
    assert_eq!(talk.say("do it again"), washes);

    let mut talk = Talk::new(&[]);
    let steps = planned(&mut talk, "open the fridge and take the milk");
    talk.carry_out(&steps[..1]);
    talk.context.note_outcome(&steps[1], Status::TargetInaccessible);
    assert_eq!(talk.language.put_right(&talk.scene, &talk.context), None);
}

#[test]
fn success_is_told() {
    let check = |utterance: &str, expected: &str| {
        let mut talk = Talk::new(&["held Bowl_01_1"]);
        let Understanding::Plan { steps, .. } = talk.language.understand(utterance, &talk.scene, &mut talk.context)
        else {
            panic!("no plan for {utterance}");
        };
        let last = steps.last().unwrap();
        let report = talk.language.report(last, Status::ActionSuccessful, "", &talk.scene);
        assert_eq!(report, expected, "{}", step_text(last, &talk.scene));
    };
    check("open the fridge", "The fridge is open.");
    check("put the bowl next to the plate", "Done, it is next to the plate now.");
    check("turn on the time machine", "I have turned on the time machine.");
    check("turn around", "I am done turning around.");
    check("go to the lab 1", "I am in the robotics lab.");
    check("read the note", "It says: \"The bowl must be mended first.\"");
    check("show me the hammer", "This is the hammer on the blue desk in the main office.");
}

#[test]
fn what_found_no_room_next_to_a_thing_is_said_to_stand_elsewhere() {
    let mut talk = Talk::new(&["held Bowl_01_1"]);
    let understood = talk.language.understand("put it next to the plate", &talk.scene, &mut talk.context);
    assert!(understood.reply().contains("next to the plate"), "{}", understood.reply());
    let Understanding::Plan { steps, .. } = understood else { panic!("no plan") };
    let report = talk.language.report(&steps[0], Status::AlternateNavigationUsed, "", &talk.scene);
    assert!(report.starts_with("There was no room next to the plate, so it is on "), "{report}");
}

#[test]
fn things_are_put_back_and_steps_taken_back() {
    let mut talk = Talk::new(&[]);
    let take = talk.language.understand("take the milk", &talk.scene, &mut talk.context);
    assert_eq!(crate::support::text(&take, &talk.scene), "open FridgeLower_02_1, take MilkCarton_01_1");
    let milk = talk.scene.objects.iter().position(|object| object.instance == "MilkCarton_01_1").unwrap();
    let (id, fridge) = (talk.scene.objects[milk].id, talk.scene.objects[milk].parent.unwrap());
    talk.scene.robot.held = Some(id);
    talk.scene.objects[milk].parent = None;
    for object in talk.scene.objects.iter_mut().filter(|object| object.id == fridge) {
        object.flags.set(cohabit_cdf::StateFlag::Opened, true);
    }
    if let Understanding::Plan { steps, .. } = &take {
        steps.iter().for_each(|step| talk.context.note_outcome(step, Status::ActionSuccessful));
    }
    let mut before = talk.context.clone();
    assert_eq!(talk.say("put it back"), "put FridgeLower_02_1");
    std::mem::swap(&mut talk.context, &mut before);
    assert_eq!(talk.say("undo"), "put FridgeLower_02_1, close FridgeLower_02_1");
    // What it was heated in was on the way.
    let heated = ["heat the red mug in the microwave", "put it back where you found it first"];
    crate::support::means(&[], &heated, "put TableRound_02_1");
    check(&[], "> undo\n= There is nothing to undo yet.");
    check(&["held Bowl_01_1"], "> put it back\n! I do not remember where the bowl was…");
    check(
        &[],
        "> come back\n! I have not been anywhere…\n> go to the main office\ngo MainOffice\n> come back\ngo [0.0, 0.0]",
    );
}

#[test]
fn small_talk_and_what_to_do_are_answered() {
    for (said, reply) in [
        ("what can I do?", "= The mission's next goal: Pour milk into the bowl. Tell me where to go…"),
        ("what am i supposed to do here", "= The mission's next goal: Pour milk into the bowl…"),
        ("how are you", "= I am fine…"),
        ("who are you?", "= I am the robot…"),
        ("can you hear me", "= Yes, I hear you…"),
        ("bye", "= Goodbye!…"),
        ("SORRY", "= No problem!…"),
        ("you are stupid", "= I am sorry…"),
        ("follow me", "= I cannot see where you are…"),
        ("wher are you", "= I am in the break room."),
        ("how do I heat the mug?", "= Tell me \"heat the mug\", and I will try."),
        ("why?", "= Nothing went wrong that I know of…"),
        ("what is on the table?", "= On the round table there are a banana…"),
    ] {
        check(&[], &format!("> {said}\n{reply}"));
    }
    check(
        &[],
        "> bring me the milk\nopen FridgeLower_02_1, take MilkCarton_01_1\n> why did you do that?\n= Because you asked me to pick up the milk: my plan was opening…\n> why did you open the fridge?\n= Because you asked me to pick up the milk, and opening the fridge was needed for picking up the milk.",
    );
    check(&[], "> pick up the mug\n? Which…\n> undo\n= There is nothing to undo yet.");
    check(&[], "> where is the microwave?\n= The microwave is on the counter top.\n> go there\ngo Microwave_01_1");
}

#[test]
fn what_was_stopped_goes_on_when_that_is_said() {
    let both = "take Banana_01_1, put KitchenCounterTop_02_1";
    for said in ["go on", "Continue", "carry on please", "ok, keep going"] {
        let mut talk = Talk::new(&[]);
        assert_eq!(talk.say("pick up the banana and put it on the counter"), both);
        assert_eq!(talk.say(said), "= I am still at it.");
        talk.say("stop");
        talk.say("where is the milk?");
        assert_eq!(talk.say(said), both, "{said}");
    }
    // What was done by then is not done again, and what was begun since is gone on with instead.
    let mut talk = Talk::new(&[]);
    let plan = talk.language.understand("pick up the banana and put it on the counter", &talk.scene, &mut talk.context);
    let Understanding::Plan { steps, .. } = plan else { panic!("{plan:?}") };
    talk.carry_out(&steps[..1]);
    talk.say("stop");
    assert_eq!(talk.say_and_do("go on"), "put KitchenCounterTop_02_1");
    check(&[], "> continue\n= There is nothing that I could go on with…");
    check(
        &[],
        "> open the fridge\nopen FridgeLower_02_1\n> stop\nstop!\n> turn left\nturn 90\n> stop\nstop!\n> go on\nturn 90",
    );
}

#[test]
fn what_is_named_next_stands_in_place_of_what_was_named_before() {
    check(
        &[],
        "> what is on the red desk?\n= On the red desk there is a record.\n> and the blue desk?\n= On the blue desk there is a hammer.",
    );
}

#[test]
fn what_is_filled_with_a_thing_has_it_poured_in() {
    check(&[], "> fill the bowl with cereal\ntake Cereal_Box_01_1, pour Bowl_01_1");
}

#[test]
fn it_says_how_a_room_is_found() {
    check(&[], "> do you know where the robotics lab is?\n= I know the way to the robotics lab…");
    check(&[], "> where is the main office?\n= I know the way to the main office…");
    check(&[], "> where is the break room?\n= This is the break room.");
}

#[test]
fn why_it_stopped_is_a_question() {
    let mut talk = Talk::new(&[]);
    let understanding = talk.language.understand("why did you stop?", &talk.scene, &mut talk.context);
    assert!(matches!(understanding, Understanding::Answer { .. }), "{understanding:?}");
}

#[test]
fn a_door_that_is_shut_behind_one_is_not_the_one_at_ones_back() {
    let mut talk = Talk::new(&["Door_01_1 open"]);
    let door = talk.scene.objects.iter().find(|one| one.instance == "Door_01_1").unwrap();
    let mut other = door.clone();
    other.id = ObjectId(u32::try_from(talk.scene.objects.len()).unwrap());
    (other.instance, other.position_m) = ("Door_01_2".to_owned(), [-6.0, 2.0, 0.0]);
    other.flags.set(cohabit_cdf::StateFlag::Opened, false);
    talk.scene.objects.push(other);
    assert_eq!(talk.say("close the door behind you"), "close Door_01_1");
}

#[test]
fn who_agrees_in_other_words_has_said_yes() {
    check(
        &[],
        "> pick up the banana and pick up the knife\n? I will be holding the banana. Shall I put it down first?\n\
         > aye, that's the very thing I want\ntake Banana_01_1, put…",
    );
}

#[test]
fn remarks_after_an_answer_leave_it_an_answer() {
    let milk = "> pick up the milk and take it to the lab\n? Which lab…";
    check(
        &["plan OfficeLayout1 BreakRoom"],
        &format!(
            "{milk}\n> Well the robot one, like I said. Quantum, heh, I wouldn't know what to do in there.\n\
             open FridgeLower_02, take MilkCarton_01, go Lab1"
        ),
    );
    check(
        &[],
        "> pick up the mug\n? Which…\n> the yellow one, if you would, my hands are full\ntake CoffeeMug_Yellow_1",
    );
}

#[test]
fn a_pronoun_stands_for_what_the_same_sentence_names() {
    check(
        &["plan OfficeLayout1 BreakRoom", "add CoffeeMug_Boss on TableRound_02", "CoffeeMug_Boss broken"],
        "> hey! I wanted coffee but I think the boss's mug is broken, can you get it fixed?\ntake CoffeeMug_Boss, open YesterdayMachine_01…",
    );
}

#[test]
fn what_only_wants_to_be_known_is_not_done() {
    let answered = |said: &str| {
        let mut talk = Talk::new(&["plan OfficeLayout1 BreakRoom"]);
        let found = talk.say(said);
        assert!(found.starts_with("= ") || found.starts_with("? "), "{said}: {found}");
    };
    for said in [
        "Do you know how to go from here to the robotics lab?",
        "Can you see the round table from where you are standing?",
        "Are the lights in here ever switched off?",
        "Which cabinet did you open first?",
        "Is somebody going near the freezer to open it at night?",
    ] {
        answered(said);
    }
    check(&["plan OfficeLayout1 BreakRoom"], "> is it possible to open the fridge?\nopen FridgeLower_02");
}

#[test]
fn unknown_words_of_a_remark_say_nothing_of_a_request() {
    let reply = |said: &str| {
        let mut talk = Talk::new(&[]);
        talk.language.understand(said, &talk.scene, &mut talk.context).reply().to_owned()
    };
    let beside = reply("pick up the banana for me please, our wolpertinger would laugh at that");
    assert_eq!(beside, "OK, picking up the banana.");
    let within = reply("wolpertinger the banana for me please");
    assert!(within.contains("wolpertinger"), "{within}");
}

#[test]
fn remarks_in_unknown_words_do_not_lose_a_request() {
    check(
        &["plan OfficeLayout1 BreakRoom", "add CoffeeMug_Boss on TableRound_02"],
        "> Put the boss mug on the counter top, no need to be dillydallying\ntake CoffeeMug_Boss, put KitchenCounterTop_02",
    );
}

#[test]
fn what_is_said_not_to_be_meant_is_not_meant() {
    let mut talk = Talk::new(&["plan OfficeLayout1 BreakRoom", "add CoffeeMug_Boss on TableRound_02"]);
    let found = talk.say("No sir, no bread. The boss's mug, on the round table. Go pick that up.").to_lowercase();
    assert!(found.contains("boss") && !found.contains("bread"), "{found}");
}

#[test]
fn what_flows_is_poured_and_nothing_else() {
    let scene = ["plan OfficeLayout1 BreakRoom"];
    check(&scene, "> pour the bread into the sink\n! I cannot pour the loaf of bread.");
    check(&scene, "> pour the radio into the sink\n! I cannot pour the radio.\n> why not?\n= I cannot pour the radio.");
}

#[test]
fn what_a_machine_does_not_take_is_refused_with_what_it_takes() {
    let scene = ["plan OfficeLayout1 BreakRoom"];
    let why = "I cannot toast the loaf of bread: the toaster takes only…";
    check(&scene, &format!("> toast the loaf of bread\n! {why}\n> why not?\n= {why}"));
    let mut talk = Talk::new(&scene);
    let told = talk.say("toast the loaf of bread");
    assert!(told.ends_with("Tell me to cut it, and I can toast a slice of it."), "{told}");
}

#[test]
fn what_is_there_to_be_looked_at_is_not_carried() {
    let scene = ["plan OfficeLayout1 BreakRoom", "add SM_Prop_Papers_01 on TableRound_02"];
    let why = "I cannot pick up the papers: they are there to be looked at, and not made to be carried.";
    check(&scene, &format!("> pick up the papers\n! {why}\n> why not?\n= {why}"));
}

#[test]
fn who_asks_what_is_wrong_with_what_was_refused_is_told_why() {
    let why = "= I cannot pour the radio.";
    for asked in ["what is the problem with the radio?", "what do you mean you can't?", "for what reason?"] {
        let scene = ["plan OfficeLayout1 BreakRoom"];
        check(&scene, &format!("> pour the radio into the sink\n! I cannot pour the radio.\n> {asked}\n{why}"));
    }
}

#[test]
fn what_is_in_the_hand_may_be_called_by_the_last_word_of_its_name() {
    let scene = ["plan OfficeLayout1 BreakRoom"];
    let mut talk = Talk::new(&scene);
    talk.scene.robot.held = talk.scene.objects.iter().find(|one| one.instance == "Cereal_Box_01").map(|one| one.id);
    assert_eq!(talk.say("put that box on the counter top"), "put KitchenCounterTop_02");
}

#[test]
fn what_is_filled_with_a_thing_has_that_poured_into_it() {
    let mut talk = Talk::new(&["plan OfficeLayout1 BreakRoom", "add Bowl_01 on TableRound_02"]);
    talk.scene.robot.held = talk.scene.objects.iter().find(|one| one.instance == "Cereal_Box_01").map(|one| one.id);
    assert_eq!(talk.say("fill the bowl on the table with it"), "pour Bowl_01");
}

#[test]
fn nothing_is_repaired_twice() {
    let scene = ["plan OfficeLayout1 BreakRoom", "add Record_01 on TableRound_02", "Record_01 broken"];
    let once = Talk::new(&scene).say("repair the record");
    assert_eq!(Talk::new(&scene).say("repair the record and repair the record"), once);
}

#[test]
fn what_is_full_of_things_or_has_none_is_told_by_that() {
    check(&["Hammer_1 in TableRound_02_1"], "> go to the empty desk\ngo AP_Prop_Desk_Blue_1");
    for (answer, mug) in [("the full one", "Boss"), ("the empty one", "Yellow")] {
        let mut talk = Talk::new(&["CoffeeMug_Boss_1 coffee"]);
        assert!(talk.say("pick up the mug").starts_with("? Which one"));
        assert_eq!(talk.say(answer), format!("take CoffeeMug_{mug}_1"), "{answer}");
    }
}

#[test]
fn the_upper_one_is_the_one_that_is_higher() {
    let stacked = || {
        let mut talk = Talk::new(&[]);
        let mug = talk.scene.objects.iter_mut().find(|one| one.instance == "CoffeeMug_Yellow_1").unwrap();
        mug.position_m[2] += 0.5;
        talk
    };
    for (answer, mug) in [("the upper one", "Yellow"), ("the lower one", "Boss")] {
        let mut talk = stacked();
        assert!(talk.say("pick up the mug").starts_with("? Which one"));
        assert_eq!(talk.say(answer), format!("take CoffeeMug_{mug}_1"), "{answer}");
    }
}

#[test]
fn a_word_that_is_common_is_no_slip_of_another() {
    let mut talk = Talk::new(&["plan OfficeLayout1 BreakRoom"]);
    let found = talk.say("where are the corn flakes?");
    assert!(found.contains("cereal") && !found.contains("cord"), "{found}");
}

#[test]
fn what_is_to_be_done_names_no_thing() {
    let mut talk = Talk::new(&["plan OfficeLayout1 BreakRoom", "add CoffeeMug_Boss on TableRound_02"]);
    let said = "Hello love, could you pick up the boss mug and pop it in the microwave for me, please?";
    let understanding = talk.language.understand(said, &talk.scene, &mut talk.context);
    assert!(matches!(understanding, Understanding::Plan { .. }) && !understanding.reply().contains("pop"));
}

/// The main office, whose robot has taken the trophy from the table there, with more tables of these classes beside it.
fn with_tables(classes: &[&str]) -> Talk {
    let mut talk = Talk::new(&["plan OfficeLayout1 MainOffice", "add Trophy01 on Desk_01"]);
    let trophy = talk.scene.objects.last().unwrap().clone();
    let origin = talk.scene.objects.iter().find(|one| Some(one.id) == trophy.parent).unwrap().clone();
    assert_eq!(origin.room, RoomId::MAIN_OFFICE);
    for (number, class) in (9000..).zip(classes) {
        let [x, y, z] = origin.position_m;
        talk.scene.objects.push(KnownObject {
            id: ObjectId(number),
            instance: (*class).to_owned(),
            class: talk.language.catalog().find(class).unwrap(),
            position_m: [x - 2.0, y, z],
            visible: true,
            ..origin.clone()
        });
    }
    assert_eq!(talk.say_and_do("pick up the trophy"), "take Trophy01");
    talk
}

#[test]
fn a_table_is_no_desk_where_there_are_both() {
    let scene = ["plan OfficeLayout1 MainOffice", "add Trophy01 on AP_Prop_Desk_Green"];
    check(&scene, "> pick up the trophy and put it on the table\ntake Trophy01, put Desk_01");
}

#[test]
fn where_a_thing_is_taken_from_is_the_last_place_that_it_is_put() {
    assert_eq!(with_tables(&["TableRound_02"]).say("put it on the table"), "put TableRound_02");
    assert_eq!(with_tables(&["TableRound_02"]).say("put it back"), "put Desk_01");
    // Where there is no other, it is meant.
    assert_eq!(with_tables(&[]).say("put it on the table"), "put Desk_01");
}

#[test]
fn of_several_places_that_fit_it_is_asked_which() {
    let asked = with_tables(&["TableRound_02", "Table_Metal_01"]).say("put it on the table");
    assert!(asked.starts_with("? Which"), "{asked}");
}

#[test]
fn what_is_taken_back_in_the_same_breath_is_not_asked_for() {
    for said in [
        "Open the fridge, no, leave it.",
        "Turn on the microwave. Actually, scrap that.",
        "could you open the fridge? no, no need",
        "pick up the banana, please, hmm, never mind",
    ] {
        assert_eq!(Talk::new(&[]).say(said), "= All right, I leave it as it is.", "{said}");
    }
    let marks = &["LightSwitch_01_1 on"];
    let told = Talk::new(marks).say("any light on in here? if so off, no, leave it. thanks, bye");
    assert!(!told.contains("toggle") && !told.contains("turning off"), "{told}");
    let told = Talk::new(&[]).say("Turn on the microwave. Open the fridge, no, leave it.");
    assert_eq!(told, "toggle Microwave_01_1");
}
