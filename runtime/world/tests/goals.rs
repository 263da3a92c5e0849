//! Goals, judged tick by tick.

#![allow(clippy::unwrap_used)]

mod support;

use std::sync::Arc;

use cohabit_cdf::{
    Catalog, Expression, Goal, GoalState, InstancePattern, Mission, ObjectRequest, Predicate, Relation, RoomId,
    StateCondition, StateFlag,
    mission::{Message, MessageTime},
};
use cohabit_world::Event;
use support::{Player, build, plain_mission};

fn goal(id: i64, instance: &str, predicate: Predicate) -> Goal {
    Goal {
        id,
        description: format!("goal {id}"),
        states: vec![GoalState { instance: InstancePattern(instance.to_owned()), predicate }],
        relation: Relation::Or,
        preconditions: Vec::new(),
        hidden: false,
        unlocked_by: None,
        can_reset: false,
    }
}

fn held(value: bool) -> Predicate {
    Predicate::Flag(StateFlag::PickedUp, value)
}

fn player(goals: Vec<Goal>, conditions: Vec<StateCondition>) -> Player {
    let on_table = |instance: &str| ObjectRequest {
        instance: instance.to_owned(),
        inside: Some("TableRound_02_1".to_owned()),
        ..ObjectRequest::default()
    };
    let mission = Mission {
        objects: vec![on_table("Apple_1"), on_table("Bowl_01_1")],
        goals,
        conditions,
        messages: vec![
            Message { when: MessageTime::Beginning, text: "hello".to_owned() },
            Message { when: MessageTime::GoalMet(0), text: "well done".to_owned() },
        ],
        ..plain_mission(RoomId::BREAK_ROOM)
    };
    Player::new(build(&Arc::new(Catalog::builtin()), mission, 2))
}

fn met(player: &Player) -> Vec<bool> {
    player.world.goals().iter().map(|goal| goal.met).collect()
}

const TAKE_AND_PUT_BACK: [&str; 3] = ["goto Apple_1", "pickup Apple_1", "place TableRound_02_1"];

#[test]
fn a_met_goal_stays_met_unless_it_can_reset() {
    let resets = Goal { can_reset: true, ..goal(1, "Apple_1", held(true)) };
    let mut player = player(vec![goal(0, "Apple_*", held(true)), resets, goal(2, "Bowl_01_1", held(true))], Vec::new());
    player.must(&TAKE_AND_PUT_BACK[..2]);
    assert_eq!(met(&player), [true, true, false]);
    player.must(&TAKE_AND_PUT_BACK[2..]);
    assert_eq!(met(&player), [true, false, false]);
    let told: Vec<&Event> =
        player.events.iter().filter(|event| matches!(event, Event::Message { .. } | Event::GoalReset { .. })).collect();
    let message = |text: &str| Event::Message { text: text.to_owned() };
    assert_eq!(told, [&message("hello"), &message("well done"), &Event::GoalReset { id: 1 }]);
}

#[test]
fn a_goal_waits_for_those_before_it() {
    let late = Goal { preconditions: vec![0], ..goal(1, "Bowl_01_1", held(false)) };
    let mut player = player(vec![goal(0, "Apple_1", held(true)), late], Vec::new());
    player.run("wait 5");
    assert_eq!(met(&player), [false, false]);
    player.must(&TAKE_AND_PUT_BACK[..2]);
    assert_eq!(met(&player), [true, true]);
    assert!(player.world.score() > 1150);
}

#[test]
fn a_hidden_goal_shows_once_its_key_was_examined() {
    let hidden = Goal { hidden: true, unlocked_by: Some("Bowl_01_1".to_owned()), ..goal(0, "Apple_1", held(true)) };
    let mut player = player(vec![hidden], Vec::new());
    player.run("wait 5");
    assert!(player.world.goals()[0].hidden);
    player.must(&["goto Bowl_01_1", "examine Bowl_01_1"]);
    assert!(!player.world.goals()[0].hidden);
    assert!(player.events.contains(&Event::GoalShown { id: 0 }));
}

#[test]
fn a_hidden_goal_shows_once_its_key_was_taken() {
    let hidden = Goal { hidden: true, unlocked_by: Some("Bowl_01_1".to_owned()), ..goal(0, "Apple_1", held(true)) };
    let mut player = player(vec![hidden], Vec::new());
    player.must(&["goto Bowl_01_1"]);
    assert!(player.world.goals()[0].hidden, "to be near it is not enough");
    player.must(&["pickup Bowl_01_1"]);
    assert!(!player.world.goals()[0].hidden);
}

#[test]
fn conditions_combine() {
    let target = || InstancePattern("TableRound_02_1".to_owned());
    let contains = |what: &str| Expression::Contains { target: target(), contains: InstancePattern(what.to_owned()) };
    let near = Expression::InRange { target: target(), distance_m: 1.6 };
    let seen = Expression::CanBeSeen { target: InstancePattern("Apple_1".to_owned()), distance_m: 3.0 };
    let condition =
        |name: &str, expression| StateCondition { name: name.to_owned(), context: "Apple_1".to_owned(), expression };
    let named = |id, name: &str| goal(id, "Apple_1", Predicate::Condition(name.to_owned(), true));
    let conditions = vec![
        condition("Both", Expression::And(vec![contains("Apple_1"), contains("Bowl_01_*")])),
        condition("Gone", Expression::Not(Box::new(contains("Apple_1")))),
        condition("Near", near),
        condition("Seen", seen),
        condition(
            "Taken",
            Expression::Or(vec![
                Expression::IsFull { target: target(), value: true },
                Expression::Flag {
                    target: InstancePattern("Apple_1".to_owned()),
                    flag: StateFlag::PickedUp,
                    value: true,
                },
            ]),
        ),
    ];
    let goals = ["Both", "Gone", "Near", "Seen", "Taken"].iter().zip(0..).map(|(name, id)| named(id, name)).collect();
    let mut player = player(goals, conditions);
    player.run("wait 1");
    assert_eq!(met(&player)[..2], [true, false]);
    player.must(&TAKE_AND_PUT_BACK[..1]);
    assert_eq!(met(&player), [true, false, true, true, false]);
    player.must(&TAKE_AND_PUT_BACK[1..2]);
    assert_eq!(met(&player), [true; 5]);
}

#[test]
fn what_a_goal_does_not_say_its_mission_does() {
    let words = |goal_text: &str, description: &str| {
        let goal = Goal { description: description.to_owned(), ..goal(0, "Apple_1", held(true)) };
        let mission =
            Mission { goal_text: goal_text.to_owned(), goals: vec![goal], ..plain_mission(RoomId::BREAK_ROOM) };
        build(&Arc::new(Catalog::builtin()), mission, 2).goals()[0].description.clone()
    };
    assert_eq!(words("Warm the soup", "Take the bowl"), "Take the bowl");
    assert_eq!(words("Warm the soup", ""), "Warm the soup");
    // Generated missions ask for nothing but their name.
    assert_eq!(words("plain", ""), "");
}
