//! The same inputs give the same world, bit for bit; nothing is lost, doubled or left without an outcome.

#![allow(clippy::unwrap_used)]

mod support;

use std::sync::Arc;

use cohabit_cdf::{Catalog, RoomId, mission::builtin};
use cohabit_world::{Action, BodyId, GoToTarget, Input, ObjectId, SnapshotError, Status, Verb, World};
use proptest::prelude::*;
use support::{build, plain_mission, world};

fn cereal() -> World {
    let (name, text) = builtin().iter().find(|(name, _)| name.contains("make_cereal")).unwrap();
    world(name, text, 3)
}

/// Any action, over more ids than there are.
fn action(objects: u32) -> impl Strategy<Value = Action> {
    let object = (0..objects + 3).prop_map(ObjectId);
    let verb = prop::sample::select(Verb::ALL.to_vec());
    prop_oneof![
        (-3.0_f32..3.0).prop_map(|distance_m| Action::Move { distance_m }),
        (-7.0_f32..7.0).prop_map(|yaw_rad| Action::Rotate { yaw_rad }),
        any::<f32>().prop_map(|pitch_rad| Action::Look { pitch_rad }),
        Just(Action::LookAround),
        Just(Action::Stop),
        object.clone().prop_map(|object| Action::GoTo { target: GoToTarget::Object(object) }),
        (0_u32..8).prop_map(|room| Action::GoTo { target: GoToTarget::Room(RoomId::from_index(room).unwrap()) }),
        (any::<f32>(), any::<f32>()).prop_map(|(x, y)| Action::GoTo { target: GoToTarget::Point([x, y]) }),
        object.clone().prop_map(|object| Action::PickUp { object }),
        object.clone().prop_map(|receptacle| Action::Place { receptacle }),
        (verb, object.clone()).prop_map(|(verb, object)| Action::Interact { verb, object }),
        object.prop_map(|object| Action::Highlight { object }),
    ]
}

/// What must hold of every world at every tick.
fn check_sound(world: &World) {
    for view in world.objects() {
        assert!(view.position_m.is_finite() && view.rotation.is_finite(), "{}", view.instance);
        if let Some(body) = view.held_by {
            assert_eq!(world.body(body).unwrap().held, Some(view.id), "{}", view.instance);
        }
        if let Some(parent) = view.parent {
            assert!(world.exists(parent), "{} is in something that is gone", view.instance);
        }
    }
    for body in world.bodies() {
        if let Some(held) = body.held {
            assert_eq!(world.object(held).unwrap().held_by, Some(body.id));
        }
    }
    let mut names: Vec<&str> = world.objects().map(|view| view.instance).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), world.objects().len(), "two objects share an id");
}

fn ids_in(world: &World) -> usize {
    world.objects().filter(|view| world.exists(view.id)).count()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, max_shrink_iters: 40, ..ProptestConfig::default() })]

    #[test]
    fn any_commands_give_one_outcome_each_and_lose_nothing(
        script in prop::collection::vec((1_usize..160, 0_u32..3, action(420)), 1..40),
    ) {
        let mut world = cereal();
        world.add_body(RoomId::Reception).unwrap();
        let (mut given, mut ended) = (Vec::new(), Vec::new());
        let mut balance = ids_in(&world) as i64;
        for (index, (ticks, body, action)) in script.into_iter().enumerate() {
            let mut inputs = vec![Input { command: index as u64, body: BodyId(body), action }];
            given.push(index as u64);
            for _ in 0..ticks {
                let report = world.step(&inputs);
                inputs.clear();
                ended.extend(report.outcomes.into_iter().map(|outcome| outcome.command));
                for event in &report.events {
                    match event {
                        cohabit_world::Event::Spawned { .. } => balance += 1,
                        cohabit_world::Event::Removed { .. } => balance -= 1,
                        _ => {}
                    }
                }
                prop_assert_eq!(ids_in(&world) as i64, balance);
            }
            check_sound(&world);
        }
        let stops = [0, 1].map(|body| Input { command: 1_000 + u64::from(body), body: BodyId(body), action: Action::Stop });
        ended.extend(world.step(&stops).outcomes.into_iter().map(|outcome| outcome.command));
        given.extend([1_000, 1_001]);
        ended.sort_unstable();
        prop_assert_eq!(ended, given);
    }

    #[test]
    fn a_second_run_and_a_restored_one_agree_digest_for_digest(
        script in prop::collection::vec((1_usize..120, action(420)), 1..14),
        cut in 0_usize..600,
    ) {
        let (mut first, mut second) = (cereal(), cereal());
        prop_assert_eq!(first.digest(), second.digest());
        let mut third: Option<World> = None;
        let mut tick = 0;
        for (index, (ticks, action)) in script.into_iter().enumerate() {
            let mut inputs = vec![Input { command: index as u64, body: BodyId(0), action }];
            for _ in 0..ticks {
                if tick == cut {
                    let mut restored = cereal();
                    restored.restore(&first.snapshot()).unwrap();
                    third = Some(restored);
                }
                let report = first.step(&inputs);
                prop_assert_eq!(&report, &second.step(&inputs));
                prop_assert_eq!(first.digest(), second.digest());
                if let Some(third) = &mut third {
                    prop_assert_eq!(&report, &third.step(&inputs));
                    prop_assert_eq!(first.digest(), third.digest());
                }
                inputs.clear();
                tick += 1;
            }
        }
    }
}

#[test]
fn a_flight_goes_on_from_a_snapshot_as_it_would_have() {
    let mut player = support::Player::new(cereal());
    player.must(&[
        "goto Cereal_Box_01_1",
        "pickup Cereal_Box_01_1",
        "room MainOffice",
        "throw AP_Prop_Desk_Green_10000",
        "wait 10",
    ]);
    let mut restored = cereal();
    restored.restore(&player.world.snapshot()).unwrap();
    let mut moved = false;
    for tick in 0..400 {
        let box_id = player.id("Cereal_Box_01_1");
        let before = player.world.object(box_id).unwrap().position_m;
        player.world.step(&[]);
        restored.step(&[]);
        moved |= before.distance(player.world.object(box_id).unwrap().position_m) > 0.01;
        assert_eq!(player.world.digest(), restored.digest(), "tick {tick}");
    }
    assert!(moved, "the box was not in flight");
    let rest = player.world.object(player.id("Cereal_Box_01_1")).unwrap();
    assert!((-0.1..2.0).contains(&rest.position_m.z), "{}", rest.position_m);
}

#[test]
fn other_bytes_are_refused() {
    let mut world = cereal();
    let before = world.digest();
    let snapshot = world.snapshot();
    let mut damaged = snapshot.clone();
    let middle = damaged.len() / 2;
    damaged[middle] ^= 1;
    let catalog = Arc::new(Catalog::builtin());
    let other = build(&catalog, plain_mission(RoomId::Lab1), 1).snapshot();
    assert_eq!(world.restore(b"nothing"), Err(SnapshotError::NotASnapshot { bytes: 7 }));
    assert_eq!(world.restore(&damaged), Err(SnapshotError::Damaged));
    assert_eq!(world.restore(&snapshot[..100]), Err(SnapshotError::Damaged));
    assert!(matches!(world.restore(&other), Err(SnapshotError::OtherWorld { .. })));
    assert_eq!(world.digest(), before);
    assert_eq!(world.restore(&snapshot), Ok(()));
}

#[test]
fn a_new_command_interrupts_the_old_one() {
    let mut world = cereal();
    let walk = Input { command: 1, body: BodyId(0), action: Action::GoTo { target: GoToTarget::Room(RoomId::Lab2) } };
    assert!(world.step(&[walk]).outcomes.is_empty());
    let turn = Input { command: 2, body: BodyId(0), action: Action::Rotate { yaw_rad: 0.5 } };
    let outcomes = world.step(&[turn]).outcomes;
    assert_eq!((outcomes[0].command, outcomes[0].status), (1, Status::Interrupted));
}
