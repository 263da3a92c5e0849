//! Ten thousand scripts made by chance: no sequence of commands creates or loses an object, puts one in two places,
//! leaves a command without an outcome, changes something without an event, moves anybody through walls, or panics.
//!
//! `PROPTEST_CASES=100000` plays more of them, `COHABIT_SCRIPTS_SEED=7` others. What fails is made as short as possible,
//! and printed line by line. The fuzz targets in `tests/fuzz` go on where this ends.

#![allow(clippy::unwrap_used)]

mod support;

use std::{cell::RefCell, sync::Arc};

use cohabit_cdf::Catalog;
use proptest::{
    prelude::*,
    test_runner::{Config, RngAlgorithm, TestCaseError, TestError, TestRng, TestRunner},
};
use support::{
    script::{KINDS, Line, verbs},
    stage::Scene,
    trial::{Tally, Trial},
};

const SCRIPTS: u32 = 10_000;

/// Scripts of a few lines: each ends with everybody stopped in the middle of something.
fn script() -> impl Strategy<Value = Vec<Line>> {
    let kind = prop::sample::select(KINDS);
    // Most lines are for the body that stands by something; now and then one too many is told.
    let body = prop_oneof![8 => Just(0_u8), 3 => Just(1), 1 => Just(2), 1 => any::<u8>()];
    let line = (kind, body, any::<u16>(), any::<u8>(), any::<u8>());
    let line = line.prop_map(|(kind, body, pick, amount, pace)| Line { kind, body, pick, amount, pace });
    prop::collection::vec(line, 1..5)
}

fn rng() -> TestRng {
    let number = std::env::var("COHABIT_SCRIPTS_SEED").map_or(1, |text| text.parse::<u64>().unwrap());
    let mut seed = [0; 32];
    seed[..8].copy_from_slice(&number.to_le_bytes());
    TestRng::from_seed(RngAlgorithm::ChaCha, &seed)
}

/// All that the scripts share; a script begins by going back to a stage, so that nothing of it is left to the next.
struct Theatre {
    scenes: Vec<Scene>,
    tally: Tally,
    told: Vec<String>,
}

impl Theatre {
    fn new() -> Self {
        let catalog = Arc::new(Catalog::builtin());
        let kitchens = ["OfficeLayout1", "OfficeLayout2_mirror"].map(|layout| Scene::kitchen(&catalog, layout));
        let laboratories = ["OfficeLayout1B", "OfficeLayout3_mirror"].map(|layout| Scene::laboratory(&catalog, layout));
        Self { scenes: kitchens.into_iter().chain(laboratories).collect(), tally: Tally::default(), told: Vec::new() }
    }

    fn play(&mut self, stage: u16, script: &[Line]) -> Result<(), String> {
        let scenes = self.scenes.len();
        let scene = &mut self.scenes[usize::from(stage) % scenes];
        let stage = usize::from(stage) / scenes % scene.stages.len();
        scene.restore(stage);
        let place = format!("in the {}, {}", scene.name, scene.stages[stage].name);
        let trial = Trial::new(&mut scene.world, &scene.walls, &mut self.tally, &mut self.told);
        trial.play(script).map_err(|fault| format!("{place}: {fault}"))
    }
}

#[test]
fn ten_thousand_scripts_lose_nothing_and_answer_everything() {
    let theatre = RefCell::new(Theatre::new());
    let stages: usize = theatre.borrow().scenes.iter().map(|scene| scene.stages.len()).sum();
    let cases = std::env::var("PROPTEST_CASES").map_or(SCRIPTS, |text| text.parse().unwrap());
    let config = Config { cases, failure_persistence: None, max_shrink_iters: 3_000, ..Config::default() };
    let result = TestRunner::new_with_rng(config, rng()).run(&(any::<u16>(), script()), |(stage, script)| {
        theatre.borrow_mut().play(stage, &script).map_err(TestCaseError::fail)
    });
    if let Err(error) = result {
        let TestError::Fail(reason, (stage, script)) = error else { panic!("{error}") };
        let again =
            std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| theatre.borrow_mut().play(stage, &script)));
        panic!("{reason}\n(again: {again:?})\n{}\n{script:#?}", theatre.borrow().told.join("\n"));
    }
    let tally = &theatre.borrow().tally;
    println!("{cases} scripts from {stages} stages, {} ticks", tally.ticks);
    for (verb, (given, succeeded)) in &tally.verbs {
        println!("{verb:16} {given:6} given, {succeeded:6} succeeded");
    }
    println!("{:#?}\n{:#?}", tally.statuses, tally.events);
    // What is not given often enough to succeed, or never makes or takes anything, tests nothing.
    let never = verbs().into_iter().filter(|verb| tally.verbs.get(verb).is_none_or(|(_, succeeded)| *succeeded == 0));
    let never: Vec<String> = never.collect();
    assert!(never.is_empty() || cases < SCRIPTS, "of all scripts, none ever succeeded in: {never:?}");
    for event in ["Spawned", "Removed", "MissionEnded", "Scanned", "Sound"] {
        assert!(tally.events.contains_key(event) || cases < SCRIPTS, "of all scripts, none ever led to: {event}");
    }
}
