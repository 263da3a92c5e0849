//! Whole missions, solved by lists of actions; and long lives of worlds, whose digests are recorded.
//!
//! `golden.txt` holds the digests of every life, so that every build profile and every machine is held to the same
//! numbers. A change that means to change what happens writes them anew:
//! `BLESS=1 cargo test -p cohabit-world --test golden`.

#![allow(clippy::unwrap_used)]

mod support;

use std::path::PathBuf;

use cohabit_world::{Ending, Event};
use support::{Player, play::lives, world};

/// The text of a mission of the reference data.
fn reference(name: &str) -> String {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/arena/cdf").join(name);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn solve(file: &str, text: &str, actions: &[&str]) -> Player {
    let mut player = Player::new(world(file, text, 7));
    player.must(actions);
    player.run("wait 150");
    assert!(player.all_met(), "{file}: {:#?}", player.world.goals());
    assert_eq!(player.world.finished(), Some(Ending::AllGoalsMet));
    assert!(player.events.contains(&Event::MissionEnded { ending: Ending::AllGoalsMet }));
    player
}

#[test]
#[cfg_attr(not(reference_data), ignore = "needs the reference data in ../shared/arena")]
fn cereal() {
    let text = reference("mission_01.json");
    solve(
        "mission_01.json",
        &text,
        &[
            "goto Bowl_01_1",
            "pickup Bowl_01_1",
            "goto YesterdayMachine_01_1",
            "open YesterdayMachine_01_1",
            "place YesterdayMachine_01_1",
            "close YesterdayMachine_01_1",
            "toggle YesterdayMachine_01_1",
            "wait 130",
            "open YesterdayMachine_01_1",
            "pickup Bowl_01_1",
            "goto TableRound_02_1",
            "place TableRound_02_1",
            "goto Cereal_Box_01_1",
            "pickup Cereal_Box_01_1",
            "goto Bowl_01_1",
            "pour Bowl_01_1",
            "place TableRound_02_1",
            "goto FridgeLower_02_1",
            "open FridgeLower_02_1",
            "goto MilkCarton_01_1",
            "pickup MilkCarton_01_1",
            "goto Bowl_01_1",
            "pour Bowl_01_1",
        ],
    );
}

#[test]
#[cfg_attr(not(reference_data), ignore = "needs the reference data in ../shared/arena")]
fn laser() {
    let text = reference("mission_07.json");
    solve(
        "mission_07.json",
        &text,
        &[
            "goto Laser_ControlPanel_1",
            "pickup Laser_ControlPanel_1",
            "goto Laser_1",
            "place Laser_1",
            "goto V_Monitor_Laser_10000",
            "toggle V_Monitor_Laser_10000",
        ],
    );
}

#[test]
#[cfg_attr(not(reference_data), ignore = "needs the reference data in ../shared/arena")]
fn freeze_ray() {
    let text = reference("mission_08.json");
    solve(
        "mission_08.json",
        &text,
        &[
            "goto CanSodaNew_01_1",
            "pickup CanSodaNew_01_1",
            "goto AP_Prop_Shelf_Wall_04_1",
            "place AP_Prop_Shelf_Wall_04_1",
            "goto V_Monitor_FreezeRay_10000",
            "toggle V_Monitor_FreezeRay_10000",
        ],
    );
}

#[test]
fn the_built_in_cereal() {
    let (name, text) = cohabit_cdf::mission::builtin().iter().find(|(name, _)| name.contains("make_cereal")).unwrap();
    solve(
        name,
        text,
        &[
            "goto Bowl_01_1",
            "pickup Bowl_01_1",
            "goto YesterdayMachine_01_1",
            "open YesterdayMachine_01_1",
            "place YesterdayMachine_01_1",
            "close YesterdayMachine_01_1",
            "toggle YesterdayMachine_01_1",
            "wait 130",
            "open YesterdayMachine_01_1",
            "pickup Bowl_01_1",
            "goto TableRound_02_1",
            "place TableRound_02_1",
            "goto Cereal_Box_01_1",
            "pickup Cereal_Box_01_1",
            "goto Bowl_01_1",
            "pour Bowl_01_1",
            "place TableRound_02_1",
            "goto FridgeLower_02_10000",
            "open FridgeLower_02_10000",
            "goto MilkCarton_01_1",
            "pickup MilkCarton_01_1",
            "goto Bowl_01_1",
            "pour Bowl_01_1",
        ],
    );
}

#[test]
fn the_built_in_others() {
    let builtin =
        |wanted: &str| cohabit_cdf::mission::builtin().iter().find(|(name, _)| name.contains(wanted)).unwrap();
    let (name, text) = builtin("cold_soda");
    solve(
        name,
        text,
        &[
            "goto CanSodaNew_01_1",
            "pickup CanSodaNew_01_1",
            "goto AP_Prop_Shelf_Wall_04_10000",
            "place AP_Prop_Shelf_Wall_04_10000",
            "goto V_Monitor_FreezeRay_10000",
            "toggle V_Monitor_FreezeRay_10000",
        ],
    );
    let (name, text) = builtin("laser_lab");
    solve(
        name,
        text,
        &[
            "goto Laser_ControlPanel_1",
            "pickup Laser_ControlPanel_1",
            "goto Laser_1",
            "place Laser_1",
            "goto Laser_Tip_1",
            "pickup Laser_Tip_1",
            "goto Laser_1",
            "place Laser_1",
            "goto V_Monitor_Laser_10000",
            "toggle V_Monitor_Laser_10000",
        ],
    );
    let (name, text) = builtin("warm_coffee");
    solve(
        name,
        text,
        &[
            "goto CoffeeMug_Boss_1",
            "pickup CoffeeMug_Boss_1",
            "goto Microwave_01_10000",
            "open Microwave_01_10000",
            "place Microwave_01_10000",
            "close Microwave_01_10000",
            "toggle Microwave_01_10000",
            "wait 130",
            "open Microwave_01_10000",
            "pickup CoffeeMug_Boss_1",
            "goto ManagerDesk_10000",
            "place ManagerDesk_10000",
        ],
    );
}

/// Ticks that each life lasts, and after how many its digests are written down.
const LIFE_TICKS: u64 = 3_000;
const EVERY_TICKS: u64 = 500;

/// One line for each stretch of each life: the hash of the digests of all its ticks so far.
fn digests() -> String {
    let mut lines = String::new();
    for mut life in lives() {
        let mut all = blake3::Hasher::new();
        for tick in 1..=LIFE_TICKS {
            life.step();
            all.update(&life.world.digest());
            if tick % EVERY_TICKS == 0 {
                lines += &format!("{} {tick} {}\n", life.name, &all.finalize().to_hex()[..32]);
            }
        }
        println!("{}: {} commands came to a good end", life.name, life.succeeded);
    }
    lines
}

#[test]
fn lives_come_out_as_recorded() {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/golden.txt");
    let found = digests();
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(&path, &found).unwrap();
    }
    let recorded = std::fs::read_to_string(&path).unwrap();
    let differs = found.lines().zip(recorded.lines()).find(|(found, recorded)| found != recorded);
    assert!(
        differs.is_none() && found.lines().count() == recorded.lines().count(),
        "found and recorded differ first at {differs:?}; if that is meant, \
         run `BLESS=1 cargo test -p cohabit-world --test golden`"
    );
}
