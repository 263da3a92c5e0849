//! What a mission file can ask of a world, feature by feature.

#![allow(clippy::unwrap_used)]

mod support;
mod wishes;

use std::sync::Arc;

use cohabit_cdf::{
    Catalog, Color, Expression, Fluid, Goal, GoalState, InstancePattern, Mission, ObjectRequest, Occasion, Predicate,
    Relation, RoomId, StateCondition, StateFlag,
    mission::{CameraMovement, CameraView, DinoFood, Era, Message, MessageTime, NoteRequest, Portal, RobotRequest},
};
use cohabit_world::{BodyId, BodyKind, CameraTarget, Ending, Event, Status};
use support::{Player, build, plain_mission};
use wishes::{OK, check, fluid, inside, is, mission, play, player, request};

fn pattern(instance: &str) -> InstancePattern {
    InstancePattern(instance.to_owned())
}

fn flag(instance: &str, flag: StateFlag, value: bool) -> GoalState {
    GoalState { instance: pattern(instance), predicate: Predicate::Flag(flag, value) }
}

fn goal(id: i64, states: Vec<GoalState>, relation: Relation) -> Goal {
    Goal {
        id,
        description: format!("goal {id}"),
        states,
        relation,
        preconditions: Vec::new(),
        hidden: false,
        unlocked_by: None,
        can_reset: true,
    }
}

/// A mission with one condition as its only goal.
fn with_condition(wishes: &[&str], expression: Expression) -> Mission {
    let condition = StateCondition { name: "Asked".to_owned(), context: "TableRound_02_1".to_owned(), expression };
    let state =
        GoalState { instance: pattern("TableRound_02_1"), predicate: Predicate::Condition("Asked".to_owned(), true) };
    Mission {
        conditions: vec![condition],
        goals: vec![goal(0, vec![state], Relation::And)],
        ..mission(RoomId::BREAK_ROOM, wishes)
    }
}

fn with_goal(wishes: &[&str], states: Vec<GoalState>, relation: Relation) -> Mission {
    Mission { goals: vec![goal(0, states, relation)], ..mission(RoomId::BREAK_ROOM, wishes) }
}

fn met(player: &Player) -> bool {
    player.world.goals()[0].met
}

fn messages(player: &Player) -> Vec<&str> {
    player
        .events
        .iter()
        .filter_map(|event| if let Event::Message { text } = event { Some(text.as_str()) } else { None })
        .collect()
}

const TABLE: &str = "TableRound_02_1 emptied";

#[test]
fn objects_start_as_they_are_asked_for() {
    let wishes = [
        TABLE,
        "Bowl_01_1 in TableRound_02_1 +Broken colored Blue",
        "CoffeeMug_Boss_1 in TableRound_02_1 +Hot filled Coffee",
        "Apple_1 in TableRound_02_1 +Eaten",
        "FoodPlate_01_1 in TableRound_02_1 +Dirty",
        "CoffeeMug_Yellow_1 in TableRound_02_1 empty",
        "KitchenCounterSink_01_1 +Toggled",
        "FridgeLower_02_1 +Locked",
        "V_Monitor_Laser_10000 +Infected",
        "ForkLift_1 +Toggled",
        "TAMPrototypeHead_01_1 +Neutral +Happy",
    ];
    let player = player(RoomId::BREAK_ROOM, &wishes);
    for (instance, flag) in [
        ("Bowl_01_1", StateFlag::Broken),
        ("CoffeeMug_Boss_1", StateFlag::Hot),
        ("Apple_1", StateFlag::Eaten),
        ("FoodPlate_01_1", StateFlag::Dirty),
        ("KitchenCounterSink_01_1", StateFlag::Toggled),
        ("FridgeLower_02_1", StateFlag::Locked),
        ("V_Monitor_Laser_10000", StateFlag::Infected),
        ("ForkLift_1", StateFlag::Toggled),
        ("TAMPrototypeHead_01_1", StateFlag::Happy),
    ] {
        assert!(is(&player, instance, flag), "{instance}: {flag:?}");
    }
    assert!(!is(&player, "TAMPrototypeHead_01_1", StateFlag::Neutral), "a face shows one mood");
    assert_eq!(fluid(&player, "CoffeeMug_Boss_1"), Fluid::Coffee);
    assert_eq!(fluid(&player, "KitchenCounterSink_01_1"), Fluid::Water);
    assert_eq!(player.world.object(player.id("Bowl_01_1")).unwrap().color, Color::Blue);
}

#[test]
fn some_objects_stay_away() {
    let count = |wishes: &[&str], class: &str| {
        let player = player(RoomId::BREAK_ROOM, wishes);
        let found = player.world.catalog().find(class).unwrap();
        player.world.objects().filter(|view| view.class == found && player.world.exists(view.id)).count()
    };
    assert!(count(&[], "CoffeeMug_Boss") > 0, "the floor plan has some of its own");
    assert_eq!(count(&["CoffeeMug_Boss_1 blacklisted"], "CoffeeMug_Boss"), 0);
    // Also under the id that the plan has for it.
    assert_eq!(count(&["CoffeeMug_Boss_10000 blacklisted"], "CoffeeMug_Boss"), 0);
    assert_eq!(count(&["CoffeeMug_Boss_1 unique in TableRound_02_1"], "CoffeeMug_Boss"), 1);
    assert_eq!(count(&["CoffeeMug_Boss_1 removed", "CoffeeMug_Boss_2 unique in TableRound_02_1"], "CoffeeMug_Boss"), 1);
    let emptied = player(RoomId::BREAK_ROOM, &["FridgeLower_02_1 emptied"]);
    let empty = player(RoomId::BREAK_ROOM, &["FridgeLower_02_1 empty"]);
    for player in [emptied, empty] {
        assert!(player.world.objects().all(|view| view.parent != Some(player.id("FridgeLower_02_1"))));
    }
}

#[test]
fn what_the_plan_has_elsewhere_is_brought_to_the_room_that_is_said() {
    let wishes = ["Apple_10000 at Lab1", "Apple_10001 at BreakRoom", "Microwave_01_10000 at Lab1"];
    let player = player(RoomId::BREAK_ROOM, &wishes);
    let room = |instance: &str| player.world.object(player.id(instance)).unwrap().room;
    assert_eq!(room("Apple_10000"), RoomId::LAB1);
    assert_eq!(inside(&player, "Apple_10001").as_deref(), Some("FridgeLower_02_10000"), "it is in that room already");
    assert_eq!(room("Microwave_01_10000"), RoomId::BREAK_ROOM, "what nobody carries stays");
}

#[test]
fn chance_follows_the_missions_own_seed() {
    let place = |seed: Option<u64>, session: u64| {
        let mission =
            Mission { seed, ..mission(RoomId::BREAK_ROOM, &["Apple_1", "Bowl_01_1", "Hammer_1", "Donut_01_1"]) };
        let world = build(&Arc::new(Catalog::builtin()), mission, session);
        ["Apple_1", "Bowl_01_1", "Hammer_1", "Donut_01_1"].map(|name| {
            let view = world.object(world.find(name).unwrap()).unwrap();
            (view.room, view.position_m.to_array().map(f32::to_bits))
        })
    };
    assert_eq!(place(Some(7), 1), place(Some(7), 2), "a seed in the file makes it repeatable");
    assert_ne!(place(Some(7), 1), place(Some(8), 1));
    assert_eq!(place(None, 1), place(None, 1));
    assert_ne!(place(None, 1), place(None, 2), "without one, each session differs");
}

#[test]
fn a_machine_of_the_plan_answers_to_a_small_number_wherever_it_is_named() {
    let contains =
        GoalState { instance: pattern("Microwave_01_1"), predicate: Predicate::Contains(pattern("Bowl_01_1")) };
    let made = |printer: &str| flag(&format!("{printer}_Spawned_Hammer_*"), StateFlag::PickedUp, false);
    let goals = vec![contains, made("Printer_3D_1"), made("Printer_3D_10000")];
    let wishes = ["Bowl_01_1 in Microwave_01_1", "Printer_Cartridge_Hammer_1 in Printer_3D_10000"];
    let mut player = play(with_goal(&wishes, goals, Relation::And));
    assert_eq!(player.id("Microwave_01_1"), player.id("Microwave_01_10000"));
    assert_eq!(player.id("Printer_3D_1"), player.id("Printer_3D_10000"));
    player.must(&["goto Printer_3D_10000", "toggle Printer_3D_10000", "wait 20"]);
    for made in ["Printer_3D_1_Spawned_Hammer_1", "Printer_3D_10000_Spawned_Hammer_1"] {
        assert_eq!(inside(&player, made).as_deref(), Some("Printer_3D_1"));
    }
    assert_eq!(inside(&player, "Bowl_01_1").as_deref(), Some("Microwave_01_1"));
    assert!(met(&player), "what it makes is named after it, by both its names");
}

#[test]
fn every_key_of_a_goal_is_judged() {
    let predicate = |instance: &str, predicate| GoalState { instance: pattern(instance), predicate };
    let holds = |what| predicate("TableRound_02_1", Predicate::Contains(pattern(what)));
    // A class and `_*` is that class alone, not those whose ids begin with its own.
    let (table, virus) = (holds("Apple_*"), holds("Floppy_Virus_*"));
    for (wishes, state, expected) in [
        (&[TABLE, "Apple_1 in TableRound_02_1"][..], table.clone(), true),
        (&[TABLE], table, false),
        (&[TABLE, "Floppy_Virus_1 in TableRound_02_1"], virus.clone(), true),
        (&[TABLE, "Floppy_Virus_Broken_1 in TableRound_02_1"], virus, false),
        (&["Bowl_01_1 filled Milk"], predicate("Bowl_01_1", Predicate::Filled(Fluid::Milk)), true),
        (&["Bowl_01_1 filled Water"], predicate("Bowl_01_1", Predicate::Filled(Fluid::Milk)), false),
        (&["Bowl_01_1 filled Water"], predicate("Bowl_01_1", Predicate::FilledWithAny), true),
        (&["Bowl_01_1"], predicate("Bowl_01_1", Predicate::FilledWithAny), false),
        (&["Bowl_01_1"], predicate("Bowl_01_1", Predicate::Empty(true)), true),
        (&["Bowl_01_1 filled Water"], predicate("Bowl_01_1", Predicate::Empty(true)), false),
        (&["Bowl_01_1 +Cereal"], predicate("Bowl_01_1", Predicate::ContainsCereal(true)), true),
        (&["Bowl_01_1 colored Red"], predicate("Bowl_01_1", Predicate::Color(Color::Red)), true),
        (&["Bowl_01_1 colored Red"], predicate("Bowl_01_1", Predicate::Color(Color::Green)), false),
        (&["Bowl_01_1"], flag("Bowl_01_1", StateFlag::Opened, false), true),
        (&["Bowl_01_1 +Broken"], flag("Bowl_01_*", StateFlag::Broken, true), true),
        (&["Apple_1 +Eaten"], flag("Apple_1", StateFlag::Eaten, true), true),
        (&["V_Monitor_Laser_10000 +Infected"], flag("V_Monitor_Laser_10000", StateFlag::Infected, true), true),
        (&["Microwave_01_1"], flag("Microwave_01_1", StateFlag::Powered, true), true),
        (&["TAMPrototypeHead_01_1 +Sad"], flag("TAMPrototypeHead_01_1", StateFlag::Sad, true), true),
        (&["TAMPrototypeHead_01_1 +Sad"], flag("TAMPrototypeHead_01_1", StateFlag::Happy, true), false),
        (&[], flag("Bowl_01_777", StateFlag::Broken, false), false),
    ] {
        let mut player = play(with_goal(wishes, vec![state.clone()], Relation::And));
        player.run("wait 1");
        assert_eq!(met(&player), expected, "{wishes:?} {state}");
    }
}

#[test]
fn and_needs_all_and_or_any() {
    let states = || vec![flag("Bowl_01_1", StateFlag::Broken, true), flag("Bowl_01_2", StateFlag::Broken, true)];
    for (relation, expected) in [(Relation::And, false), (Relation::Or, true)] {
        let mut player = play(with_goal(&["Bowl_01_1 +Broken", "Bowl_01_2"], states(), relation));
        player.run("wait 1");
        assert_eq!(met(&player), expected, "{relation:?}");
    }
}

#[test]
fn every_kind_of_expression_is_judged() {
    let plate =
        ["TableRound_02_1 emptied", "FoodPlate_01_1 in TableRound_02_1", "Apple_1 in FoodPlate_01_1 colored Red"];
    let flag = |instance: &str, flag, value| Expression::Flag { target: pattern(instance), flag, value };
    let contains = |target: &str, what: &str| Expression::Contains { target: pattern(target), contains: pattern(what) };
    let full = |target: &str, value| Expression::IsFull { target: pattern(target), value };
    for (expression, expected) in [
        (contains("TableRound_02_1", "Apple_1"), true),
        (contains("FoodPlate_01_1", "FoodPlate_01_1"), false),
        (Expression::Not(Box::new(contains("TableRound_02_1", "Bowl_01_*"))), true),
        (Expression::And(vec![contains("TableRound_02_1", "Apple_1"), full("FoodPlate_01_1", true)]), true),
        (Expression::Or(vec![contains("TableRound_02_1", "Bowl_01_1"), full("TableRound_02_1", true)]), false),
        (full("FoodPlate_01_1", true), true),
        (full("TableRound_02_1", false), true),
        (full("Apple_1", false), true),
        (flag("Apple_1", StateFlag::Opened, false), true),
        (flag("FridgeLower_02_1", StateFlag::Powered, true), true),
        (Expression::IsReceptacle { target: pattern("FoodPlate_01_1"), value: true }, true),
        (Expression::IsReceptacle { target: pattern("Apple_1"), value: true }, false),
        (Expression::HasColor { target: pattern("Apple_1"), color: Color::Red }, true),
        (Expression::FilledWith { target: pattern("Apple_1"), fluid: Fluid::Water }, false),
        (Expression::FilledWithAny { target: pattern("Apple_1") }, false),
        (Expression::DinoFed { target: pattern("PortalGenerator_10000"), value: true }, false),
        (Expression::DinoFed { target: pattern("PortalGenerator_10000"), value: false }, true),
        (Expression::InRange { target: pattern("PrinterThatIsNot_1"), distance_m: 1000.0 }, false),
    ] {
        let mut player = play(with_condition(&plate, expression.clone()));
        player.run("wait 1");
        assert_eq!(met(&player), expected, "{expression}");
    }
}

#[test]
fn sight_needs_nearness_the_right_way_and_nothing_in_between() {
    let seen = |wishes: &[&str], distance_m: f32| {
        with_condition(wishes, Expression::CanBeSeen { target: pattern("Apple_1"), distance_m })
    };
    let on_table = [TABLE, "Apple_1 in TableRound_02_1"];
    let mut player = play(seen(&on_table, 3.0));
    player.must(&["goto Apple_1"]);
    assert!(met(&player));
    player.play(cohabit_world::Action::Rotate { yaw_rad: std::f32::consts::PI });
    assert!(!met(&player), "nobody sees what is behind them");
    // Far away, in another room, in a closed fridge.
    let mut player = play(seen(&on_table, 0.3));
    player.must(&["goto Apple_1"]);
    assert!(!met(&player));
    let mut player = play(seen(&on_table, 100.0));
    player.must(&["room Warehouse"]);
    assert!(!met(&player));
    let fridge = ["FridgeLower_02_1 emptied", "Apple_1 in FridgeLower_02_1"];
    let mut player = play(seen(&fridge, 3.0));
    player.must(&["goto FridgeLower_02_1"]);
    assert!(!met(&player));
    player.must(&["open FridgeLower_02_1"]);
    assert!(met(&player), "an open fridge shows what is in it");
    // Behind something as tall as a body.
    let mut player = play(seen(&["Apple_1 in KitchenCounterSink_01_1", "YesterdayMachine_01_1"], 100.0));
    player.must(&["goto Apple_1"]);
    assert!(met(&player));
}

#[test]
fn range_counts_from_the_body() {
    let near = |distance_m| {
        with_condition(
            &[TABLE, "Apple_1 in TableRound_02_1"],
            Expression::InRange { target: pattern("Apple_1"), distance_m },
        )
    };
    let mut player = play(near(1.6));
    player.must(&["room Warehouse"]);
    assert!(!met(&player));
    player.must(&["goto Apple_1"]);
    assert!(met(&player));
}

#[test]
fn a_state_that_lasts_a_moment_counts() {
    let on = flag("Microwave_01_1", StateFlag::Toggled, true);
    let lasting = Mission {
        goals: vec![
            Goal { can_reset: false, ..goal(0, vec![on.clone()], Relation::And) },
            goal(1, vec![on], Relation::And),
        ],
        ..mission(RoomId::BREAK_ROOM, &["Microwave_01_1"])
    };
    let mut player = play(lasting);
    player.must(&["goto Microwave_01_1", "toggle Microwave_01_1"]);
    assert!(player.world.goals().iter().all(|goal| goal.met));
    assert_eq!(player.world.finished(), Some(Ending::AllGoalsMet));
    player.must(&["wait 200"]);
    let met: Vec<bool> = player.world.goals().iter().map(|goal| goal.met).collect();
    assert_eq!(met, [true, false], "what was met stays so, unless it can reset");
}

#[test]
fn messages_and_camera_movements_come_when_they_are_due() {
    let held = Occasion::States(vec![flag("Apple_1", StateFlag::PickedUp, true)], Relation::And);
    let times = [
        (MessageTime::Beginning, "begin"),
        (MessageTime::GoalMet(0), "goal"),
        (MessageTime::Ending, "end"),
        (MessageTime::Occasion(held), "held"),
    ];
    let views = [
        CameraView::Object(pattern("Apple_1")),
        CameraView::Room(RoomId::LAB1),
        CameraView::Viewpoint(RoomId::LAB2, 3),
        CameraView::Point([1.0, 2.0, 0.5]),
    ];
    let movements = times.iter().zip(views);
    let told = Mission {
        messages: times.iter().map(|(when, text)| Message { when: when.clone(), text: (*text).to_owned() }).collect(),
        camera_movements: movements
            .map(|((when, text), view)| CameraMovement {
                when: when.clone(),
                view,
                duration_s: 2.0,
                text: Some((*text).to_owned()),
            })
            .collect(),
        goals: vec![Goal {
            can_reset: false,
            ..goal(0, vec![flag("Apple_1", StateFlag::PickedUp, true)], Relation::And)
        }],
        ..mission(RoomId::BREAK_ROOM, &[TABLE, "Apple_1 in TableRound_02_1"])
    };
    let mut player = play(told);
    player.must(&["wait 1"]);
    assert_eq!(messages(&player), ["begin"]);
    player.must(&["goto Apple_1", "pickup Apple_1"]);
    assert_eq!(messages(&player), ["begin", "held", "goal", "end"]);
    player.must(&["place TableRound_02_1", "pickup Apple_1"]);
    assert_eq!(messages(&player), ["begin", "held", "goal", "end", "held"], "each time that it comes to hold");
    let shown: Vec<CameraTarget> = player
        .events
        .iter()
        .filter_map(|event| if let Event::CameraMovement { target, .. } = event { Some(*target) } else { None })
        .collect();
    let point = CameraTarget::Point([1.0, 2.0, 0.5]);
    let (room, view) = (CameraTarget::Room(RoomId::LAB1), CameraTarget::Viewpoint(RoomId::LAB2, 3));
    assert_eq!(shown, [CameraTarget::Object(player.id("Apple_1")), point, room, view, point]);
}

#[test]
fn each_occasion_is_compared_with_what_it_was_itself() {
    let message = |thing: &str| {
        let held = Occasion::States(vec![flag(thing, StateFlag::PickedUp, true)], Relation::And);
        Message { when: MessageTime::Occasion(held), text: thing.to_owned() }
    };
    let mut player = play(Mission {
        messages: vec![message("Apple_1"), message("Bowl_01_1")],
        ..mission(RoomId::BREAK_ROOM, &[TABLE, "Apple_1 in TableRound_02_1", "Bowl_01_1 in TableRound_02_1"])
    });
    player.must(&["goto Bowl_01_1", "pickup Bowl_01_1", "wait 10"]);
    assert_eq!(messages(&player), ["Bowl_01_1"], "once, although the occasion before it never came");
    player.must(&["place TableRound_02_1", "goto Apple_1", "pickup Apple_1", "wait 10"]);
    assert_eq!(messages(&player), ["Bowl_01_1", "Apple_1"]);
    player.must(&["place TableRound_02_1", "goto Bowl_01_1", "pickup Bowl_01_1", "wait 10"]);
    assert_eq!(messages(&player), ["Bowl_01_1", "Apple_1", "Bowl_01_1"], "each time that it comes to hold");
}

#[test]
fn a_camera_turns_to_the_only_machine_of_the_plan_under_a_small_number() {
    let movement = CameraMovement {
        when: MessageTime::Beginning,
        view: CameraView::Object(pattern("Microwave_01_1")),
        duration_s: 2.0,
        text: None,
    };
    let mut player = play(Mission { camera_movements: vec![movement], ..mission(RoomId::BREAK_ROOM, &[]) });
    player.must(&["wait 1"]);
    let microwave = CameraTarget::Object(player.id("Microwave_01_10000"));
    let turns = |event: &Event| matches!(event, Event::CameraMovement { target, .. } if *target == microwave);
    assert!(player.events.iter().any(turns), "{:?}", player.events);
}

#[test]
fn what_is_in_something_that_is_away_waits_for_its_own_time_too() {
    let taken = |thing: &str| Occasion::States(vec![flag(thing, StateFlag::PickedUp, true)], Relation::And);
    let late = |wish: &str, after: &str| ObjectRequest { condition: Some(taken(after)), ..request(wish) };
    let plate = || late("FoodPlate_01_1 in TableRound_02_1", "Bowl_01_1");
    let apple = || late("Apple_1 in FoodPlate_01_1", "CoffeeMug_Boss_1");
    for waiting in [[plate(), apple()], [apple(), plate()]] {
        let others = ["Bowl_01_1 in TableRound_02_1", "CoffeeMug_Boss_1 in TableRound_02_1"];
        let mut mission = mission(RoomId::BREAK_ROOM, &[&[TABLE][..], &others[..]].concat());
        mission.objects.extend(waiting);
        let mut player = play(mission);
        player.must(&["goto Bowl_01_1", "pickup Bowl_01_1", "wait 2"]);
        assert!(player.world.find("FoodPlate_01_1").is_some() && player.world.find("Apple_1").is_none());
        player.must(&["place TableRound_02_1", "goto CoffeeMug_Boss_1", "pickup CoffeeMug_Boss_1", "wait 2"]);
        assert_eq!(inside(&player, "Apple_1").as_deref(), Some("FoodPlate_01_1"));
    }
}

#[test]
fn a_note_unlocks_a_hidden_goal() {
    let note = NoteRequest {
        instance: "StickyNote_3".to_owned(),
        text: "Hungry?".to_owned(),
        room: RoomId::BREAK_ROOM,
        place: 1,
    };
    let hidden = Goal {
        hidden: true,
        unlocked_by: Some("StickyNote_3".to_owned()),
        ..goal(0, vec![flag("Apple_1", StateFlag::PickedUp, true)], Relation::And)
    };
    let secret = Mission {
        notes: vec![note],
        goals: vec![hidden],
        ..mission(RoomId::BREAK_ROOM, &["Apple_1 in TableRound_02_1"])
    };
    let mut player = play(secret);
    player.must(&["wait 2"]);
    assert!(player.world.goals()[0].hidden);
    player.must(&["goto StickyNote_3", "examine StickyNote_3"]);
    assert!(!player.world.goals()[0].hidden);
    assert!(player.events.contains(&Event::GoalShown { id: 0 }));
    let read = Event::NoteRead { object: player.id("StickyNote_3"), text: "Hungry?".to_owned() };
    assert!(player.events.contains(&read));
}

#[test]
fn no_two_notes_share_a_place() {
    let note = |number: usize, place: usize| NoteRequest {
        instance: format!("StickyNote_{number}"),
        text: "Hungry?".to_owned(),
        room: RoomId::BREAK_ROOM,
        place,
    };
    // The break room has six places, counted from 0.
    let notes = vec![note(1, 0), note(2, 0), note(3, 6), note(4, 5)];
    let player = play(Mission { notes, ..mission(RoomId::BREAK_ROOM, &[]) });
    let at: Vec<_> = (1..=4)
        .map(|number| player.world.object(player.id(&format!("StickyNote_{number}"))).unwrap().position_m)
        .collect();
    for (index, one) in at.iter().enumerate() {
        assert!(at[..index].iter().all(|other| other.distance(*one) > 0.5), "{at:?}");
    }
    assert!((at[2].x - 3.85).abs() < 0.01, "beyond the last place is the last: {}", at[2]);
}

#[test]
fn anything_done_to_its_key_unlocks_a_hidden_goal() {
    for lines in
        [["goto FridgeLower_02_1", "open FridgeLower_02_1"], ["goto FridgeLower_02_1", "scan FridgeLower_02_1"]]
    {
        let hidden = Goal {
            hidden: true,
            unlocked_by: Some("FridgeLower_02_1".to_owned()),
            ..goal(0, vec![flag("Bowl_01_1", StateFlag::PickedUp, true)], Relation::And)
        };
        let mut player = play(Mission { goals: vec![hidden], ..mission(RoomId::BREAK_ROOM, &["Bowl_01_1"]) });
        player.must(&["wait 2", lines[0]]);
        assert!(player.world.goals()[0].hidden);
        player.must(&[lines[1]]);
        assert!(!player.world.goals()[0].hidden);
    }
}

#[test]
fn circuits_are_fed_and_cut_as_asked() {
    let powered =
        |wishes: &[&str], instance: &str| is(&player(RoomId::BREAK_ROOM, wishes), instance, StateFlag::Powered);
    assert!(powered(&[], "Microwave_01_10000"));
    assert!(powered(&["Microwave_01_1 circuit 9"], "Microwave_01_1"), "a circuit that nobody switches is fed");
    assert!(!powered(&["Microwave_01_1 circuit -1"], "Microwave_01_1"));
    assert!(!powered(&["Microwave_01_1 circuit 9", "FuseBox_01_1 feeds 9 power false"], "Microwave_01_1"));
    assert!(!powered(&["Microwave_01_1 circuit 9", "FuseBox_01_1 feeds 9 -Toggled"], "Microwave_01_1"));
    assert!(powered(&["Microwave_01_1 circuit 9", "FuseBox_01_1 feeds 9 power true"], "Microwave_01_1"));
    // The lever of that box feeds that circuit.
    let wishes = ["Microwave_01_1 circuit 9", "FuseBox_01_1 feeds 9 power false +Opened"];
    let mut player = player(RoomId::WAREHOUSE, &wishes);
    assert!(
        !is(&player, "FuseBox_01_1", StateFlag::Toggled) && !is(&player, "FuseBox_01_Lever_10000", StateFlag::Toggled)
    );
    player.must(&["goto FuseBox_01_Lever_10000", "toggle FuseBox_01_Lever_10000"]);
    assert!(is(&player, "Microwave_01_1", StateFlag::Powered));
}

#[test]
fn what_is_live_kills_who_touches_it_and_who_steps_on_it() {
    let player =
        check(&["Microwave_01_1 +Sparking"], &["goto Microwave_01_1", "open Microwave_01_1"], Status::KilledByHazard);
    assert_eq!(player.world.finished(), Some(Ending::KilledByHazard));
    assert!(player.events.contains(&Event::MissionEnded { ending: Ending::KilledByHazard }));
    assert!(!player.world.body(BodyId(0)).unwrap().alive);
    // Looking at it does no harm.
    check(&["Microwave_01_1 +Sparking"], &["goto Microwave_01_1", "scan Microwave_01_1", "examine Microwave_01_1"], OK);
}

#[test]
fn robots_start_as_asked() {
    let robot = RobotRequest {
        room: Some(RoomId::LAB2),
        yaw_deg: Some(90.0),
        holds: Some("Apple_1".to_owned()),
        flags: vec![(StateFlag::Scared, true)],
        ..RobotRequest::default()
    };
    let second = RobotRequest { room: Some(RoomId::LAB1), viewpoint: Some(2), ..RobotRequest::default() };
    let happy = vec![flag("TAM_1", StateFlag::Scared, true)];
    let staffed = Mission {
        robots: vec![robot, second],
        ..with_goal(&[TABLE, "Apple_1 in TableRound_02_1"], happy, Relation::And)
    };
    let mut player = play(staffed);
    let bodies: Vec<_> = player.world.bodies().collect();
    assert_eq!(bodies.len(), 2);
    assert_eq!((bodies[0].room, bodies[1].room), (RoomId::LAB2, RoomId::LAB1));
    assert!((bodies[0].yaw_rad - std::f32::consts::FRAC_PI_2).abs() < 1e-4);
    assert_eq!(bodies[0].held, Some(player.id("Apple_1")));
    assert!(bodies[0].flags.has(StateFlag::Scared));
    player.run("wait 1");
    assert!(met(&player), "goals know robots by their names");
}

#[test]
fn a_room_takes_more_bodies_than_it_has_viewpoints() {
    let mut world = player(RoomId::MAIN_OFFICE, &[]).world;
    for _ in 0..19 {
        world.add_body(BodyKind::Robot, RoomId::MAIN_OFFICE).unwrap();
    }
    let places: Vec<_> = world.bodies().map(|body| body.position_m).collect();
    let apart = |index: usize| places[..index].iter().all(|other| other.distance(places[index]) > 0.5);
    assert!((0..places.len()).all(apart), "{places:?}");
}

/// A mission with a portal to the past and one to the future, and a generator at hand.
fn portals(wishes: &[&str], open: bool) -> Mission {
    let portal = |name: &str, era, open| Portal { name: name.to_owned(), era, open };
    Mission {
        portals: vec![portal("past", Era::Past, open), portal("future", Era::Future, false)],
        ..mission(RoomId::LAB2, wishes)
    }
}

const MONITOR: &str = "V_Monitor_Portal_10000";
const GENERATOR: &str = "PortalGenerator_10000";

fn line(verb: &str, what: &str) -> String {
    format!("{verb} {what}")
}

/// Takes a thing from the break room's table to the generator.
fn bring(player: &mut Player, thing: &str) {
    player.must(&[&line("goto", thing), &line("pickup", thing), &line("goto", GENERATOR)]);
}

#[test]
fn a_portal_opens_to_the_past_then_to_the_future() {
    let wishes = [TABLE, "Bowl_01_1 in TableRound_02_1 +Broken", "FoodPlate_01_1 in TableRound_02_1"];
    let mut player = play(portals(&wishes, false));
    bring(&mut player, "Bowl_01_1");
    let outcome = player.run(&line("place", GENERATOR));
    assert_eq!(outcome.status, Status::ReceptacleIsClosed, "{}", outcome.detail);
    player.must(&[&line("goto", MONITOR)]);
    let opened = player.run(&line("toggle", MONITOR));
    assert!(opened.detail.contains("past"), "{}", opened.detail);
    assert!(is(&player, GENERATOR, StateFlag::Toggled));
    player.must(&[&line("goto", GENERATOR), &line("place", GENERATOR)]);
    assert!(!is(&player, "Bowl_01_1", StateFlag::Broken), "it was whole in the past");
    let bowl = player.world.object(player.id("Bowl_01_1")).unwrap();
    assert!(bowl.held_by.is_none() && bowl.position_m.z < 0.05, "it lies at the foot of the generator");
    player.must(&["goto Bowl_01_1", "pickup Bowl_01_1", "goto TableRound_02_1", "place TableRound_02_1"]);
    player.must(&[&line("goto", MONITOR), &line("toggle", MONITOR)]);
    assert!(!is(&player, GENERATOR, StateFlag::Toggled));
    assert!(player.run(&line("toggle", MONITOR)).detail.contains("future"));
    bring(&mut player, "FoodPlate_01_1");
    player.must(&[&line("place", GENERATOR)]);
    assert!(is(&player, "FoodPlate_01_1", StateFlag::Dirty), "the future is dusty");
}

#[test]
fn what_is_thrown_into_a_portal_goes_through() {
    let mut player = play(portals(&[TABLE, "Bowl_01_1 in TableRound_02_1 +Broken"], true));
    assert!(is(&player, GENERATOR, StateFlag::Toggled) && is(&player, MONITOR, StateFlag::Toggled));
    bring(&mut player, "Bowl_01_1");
    player.must(&[&line("throw", GENERATOR), "wait 120"]);
    assert!(!is(&player, "Bowl_01_1", StateFlag::Broken));
}

#[test]
fn things_go_through_their_own_portals_alone() {
    let mut player = play(portals(&[TABLE, "Bowl_01_1 in TableRound_02_1 future future"], true));
    bring(&mut player, "Bowl_01_1");
    assert_eq!(player.run(&line("place", GENERATOR)).status, Status::UnsupportedAction);
}

#[test]
fn what_waits_behind_a_portal_comes_as_it_opens() {
    let wishes = [TABLE, "FoodPlate_01_1 portal past", "Apple_1 in FoodPlate_01_1"];
    let mut player = play(portals(&wishes, false));
    player.must(&["wait 5"]);
    assert!(player.world.find("FoodPlate_01_1").is_none() && player.world.find("Apple_1").is_none());
    player.must(&[&line("goto", MONITOR), &line("toggle", MONITOR), "wait 5"]);
    assert_eq!(inside(&player, "Apple_1").as_deref(), Some("FoodPlate_01_1"));
    player.must(&["goto FoodPlate_01_1", "pickup FoodPlate_01_1"]);
}

#[test]
fn what_comes_through_a_portal_at_once_stands_side_by_side() {
    let things = ["FoodPlate_01_1", "Bowl_01_1", "Apple_1"];
    let wishes = things.map(|thing| format!("{thing} portal past"));
    let mut player = play(portals(&wishes.each_ref().map(String::as_str), false));
    player.must(&["wait 5", &line("goto", MONITOR), &line("toggle", MONITOR), "wait 5"]);
    let at = things.map(|thing| player.world.object(player.id(thing)).unwrap().position_m);
    for [one, other] in [[0, 1], [0, 2], [1, 2]] {
        assert!(at[one].distance(at[other]) > 0.1, "{} and {}: {at:?}", things[one], things[other]);
    }
}

#[test]
fn the_dinosaur_behind_the_past_eats() {
    let fed = |wishes: &[&str], food: Option<&str>, thing: &str| {
        let expression = Expression::DinoFed { target: pattern(GENERATOR), value: true };
        let generator =
            ObjectRequest { dino_food: food.map(|class| DinoFood::Class(class.to_owned())), ..request(GENERATOR) };
        let mut hungry = Mission { portals: portals(&[], true).portals, ..with_condition(wishes, expression) };
        hungry.objects.push(generator);
        let mut player = play(hungry);
        bring(&mut player, thing);
        player.must(&[&line("place", GENERATOR), "wait 2"]);
        (met(&player), player)
    };
    let (was_fed, player) = fed(&[TABLE, "Apple_1 in TableRound_02_1"], None, "Apple_1");
    assert!(was_fed && is(&player, "Apple_1", StateFlag::Eaten));
    let (was_fed, player) = fed(&[TABLE, "Bowl_01_1 in TableRound_02_1"], None, "Bowl_01_1");
    assert!(!was_fed && player.world.find("Bowl_01_1").is_some());
    let (was_fed, _) = fed(&[TABLE, "Apple_1 in TableRound_02_1"], Some("Burger_04"), "Apple_1");
    assert!(!was_fed, "this one eats burgers alone");
    let (was_fed, player) = fed(&[TABLE, "Cake_02_1 in TableRound_02_1"], Some("Cake_02"), "Cake_02_1");
    assert!(was_fed && player.world.find("Cake_02_1").is_none());
}

#[test]
fn a_dinosaur_in_the_office_eats_what_lies_before_it() {
    let expression = Expression::DinoFed { target: pattern("ActionFigure_1"), value: true };
    let wishes = [
        "ReceptionDesk_1 emptied",
        "ActionFigure_1 in ReceptionDesk_1 eats Donut_01",
        TABLE,
        "Donut_01_1 in TableRound_02_1",
    ];
    let mut player = play(with_condition(&wishes, expression));
    player.must(&["goto Donut_01_1", "pickup Donut_01_1", "goto ActionFigure_1"]);
    assert!(!met(&player));
    player.must(&["place ReceptionDesk_1", "wait 2"]);
    assert!(met(&player));
    assert!(is(&player, "Donut_01_1", StateFlag::Eaten));
}

#[test]
fn an_object_with_a_condition_appears_once_that_holds() {
    let mut surprise =
        mission(RoomId::BREAK_ROOM, &[TABLE, "Apple_1 in TableRound_02_1", "Donut_01_1 in TableRound_02_1"]);
    surprise.objects[2].condition =
        Some(Occasion::States(vec![flag("Apple_1", StateFlag::PickedUp, true)], Relation::And));
    let mut player = play(surprise);
    player.must(&["wait 3", "goto Apple_1"]);
    assert!(player.world.find("Donut_01_1").is_none());
    player.must(&["pickup Apple_1", "wait 2"]);
    assert_eq!(inside(&player, "Donut_01_1").as_deref(), Some("TableRound_02_1"));
}

#[test]
fn a_snapshot_keeps_all_of_it() {
    let held = Occasion::States(vec![flag("Apple_1", StateFlag::PickedUp, true)], Relation::And);
    let wishes = [TABLE, "Apple_1 in TableRound_02_1", "FoodPlate_01_1 portal past", "Bowl_01_1 in EAC_Machine_1"];
    let mut rich = portals(&wishes, false);
    rich.messages = vec![Message { when: MessageTime::Occasion(held), text: "held".to_owned() }];
    let mut player = play(rich.clone());
    player.must(&["goto EAC_Machine_1", "toggle EAC_Machine_1", "wait 130", "goto Apple_1", "pickup Apple_1"]);
    let mut copy = play(rich);
    copy.world.restore(&player.world.snapshot()).unwrap();
    for player in [&mut player, &mut copy] {
        player.must(&[&line("goto", MONITOR), &line("toggle", MONITOR), "wait 5"]);
        assert!(player.world.find("FoodPlate_01_1").is_some());
    }
    assert_eq!(player.world.digest(), copy.world.digest());
    assert!(messages(&copy).is_empty(), "what was told is not told again");
}

#[test]
fn a_plain_mission_has_nothing_of_this() {
    let player = Player::new(build(&Arc::new(Catalog::builtin()), plain_mission(RoomId::LAB1), 1));
    assert!(player.world.goals().is_empty() && player.world.finished().is_none());
}
