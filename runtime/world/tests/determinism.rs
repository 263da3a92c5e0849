//! The same inputs give the same world, bit for bit: a second time, in another process, and after a snapshot.

#![allow(clippy::unwrap_used)]

mod support;

use std::{process::Command, sync::Arc};

use cohabit_cdf::{Catalog, RoomId, mission::builtin};
use cohabit_world::{Action, BodyId, GoToTarget, Input, SnapshotError, Status, World};
use proptest::prelude::*;
use support::{build, plain_mission, play::lives, script::Line, stage::kitchen, world};

fn cereal() -> World {
    let (name, text) = builtin().iter().find(|(name, _)| name.contains("make_cereal")).unwrap();
    world(name, text, 3)
}

/// Steps both by the same inputs, and finds no difference.
fn step_both(one: &mut World, two: &mut World, inputs: &[Input]) {
    let report = one.step(inputs);
    assert_eq!(report, two.step(inputs), "tick {}", one.tick());
    assert_eq!(one.digest(), two.digest(), "tick {}", one.tick());
}

#[test]
fn a_second_life_and_a_restored_one_agree_tick_for_tick() {
    let catalog = Arc::new(Catalog::builtin());
    for (number, mut life) in lives().enumerate() {
        let [mut second, mut restored] = [(); 2].map(|()| support::play::life(&catalog, number).unwrap().world);
        // Some in the middle of a walk, some in the middle of a flight.
        let cut = 150 + 67 * number as u64;
        for _ in 0..cut {
            let inputs = life.step();
            second.step(&inputs);
            assert_eq!(life.world.digest(), second.digest(), "{}: tick {}", life.name, life.world.tick());
        }
        restored.restore(&life.world.snapshot()).unwrap();
        for _ in 0..600 {
            let inputs = life.step();
            step_both(&mut second, &mut restored, &inputs);
            assert_eq!(life.world.digest(), second.digest(), "{}: tick {}", life.name, life.world.tick());
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    /// Also a world that was restored before, and has been elsewhere since.
    #[test]
    fn a_restored_world_forgets_where_it_was(
        bytes in prop::collection::vec(any::<u8>(), 6..90),
        elsewhere in prop::collection::vec(any::<u8>(), 6..40),
        cut in 0_u64..400,
    ) {
        let catalog = Arc::new(Catalog::builtin());
        let mut first = kitchen(&catalog, "OfficeLayout1B_mirror");
        let mut other = kitchen(&catalog, "OfficeLayout1B_mirror");
        tell(&mut other, &Line::script(&elsewhere), |world, inputs| {
            world.step(inputs);
        });
        let mut restored = false;
        tell(&mut first, &Line::script(&bytes), |world, inputs| {
            if world.tick() == cut {
                other.restore(&world.snapshot()).unwrap();
                restored = true;
            }
            if restored {
                step_both(world, &mut other, inputs);
            } else {
                world.step(inputs);
            }
        });
    }
}

/// Tells a world a script; `step` must step it.
fn tell(world: &mut World, script: &[Line], mut step: impl FnMut(&mut World, &[Input])) {
    for (command, line) in (1..).zip(script) {
        let mut inputs = vec![line.input(world, command)];
        for _ in 0..line.wait().0.clamp(1, 60) {
            step(world, &inputs);
            inputs.clear();
        }
    }
}

/// What is set for the process that [`two_processes_agree_tick_for_tick`] starts.
const CHILD: &str = "COHABIT_PRINT_DIGESTS";

#[test]
fn two_processes_agree_tick_for_tick() {
    let print = |digests: &mut dyn FnMut(String)| {
        for mut life in lives() {
            for _ in 0..200 {
                life.step();
                let digest = blake3::Hash::from_bytes(life.world.digest());
                digests(format!("{} {} {}", life.name, life.world.tick(), digest.to_hex()));
            }
        }
    };
    if std::env::var_os(CHILD).is_some() {
        print(&mut |line| println!("digest: {line}"));
        return;
    }
    let child = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "two_processes_agree_tick_for_tick", "--nocapture"])
        .env(CHILD, "1")
        .output()
        .unwrap();
    assert!(child.status.success(), "{}", String::from_utf8_lossy(&child.stderr));
    let text = String::from_utf8(child.stdout).unwrap();
    let mut theirs = text.lines().filter_map(|line| line.split_once("digest: ")).map(|(_, line)| line);
    let mut count = 0;
    print(&mut |line| {
        assert_eq!(theirs.next(), Some(line.as_str()));
        count += 1;
    });
    assert!(theirs.next().is_none() && count > 2_000, "{count} ticks");
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
    let other = build(&catalog, plain_mission(RoomId::LAB1), 1).snapshot();
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
    let walk = Input { command: 1, body: BodyId(0), action: Action::GoTo { target: GoToTarget::Room(RoomId::LAB2) } };
    assert!(world.step(&[walk]).outcomes.is_empty());
    let turn = Input { command: 2, body: BodyId(0), action: Action::Rotate { yaw_rad: 0.5 } };
    let outcomes = world.step(&[turn]).outcomes;
    assert_eq!((outcomes[0].command, outcomes[0].status), (1, Status::Interrupted));
}
