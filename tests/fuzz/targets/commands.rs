//! Any bytes as a script of commands: nothing is lost, doubled, untold or left without an outcome, and nothing panics.

#![no_main]

#[path = "../../../runtime/world/tests/support/mod.rs"]
mod support;

use std::{cell::RefCell, sync::Arc};

use cohabit_cdf::Catalog;
use libfuzzer_sys::fuzz_target;
use support::{
    script::Line,
    stage::Scene,
    trial::{Tally, Trial},
};

/// A script has no more lines than this: what takes longer to go wrong is found from another stage.
const LINES: usize = 12;

thread_local! {
    static SCENES: RefCell<Vec<Scene>> = RefCell::new(scenes());
}

fn scenes() -> Vec<Scene> {
    let catalog = Arc::new(Catalog::builtin());
    vec![Scene::kitchen(&catalog, "OfficeLayout1"), Scene::laboratory(&catalog, "OfficeLayout1B")]
}

fuzz_target!(|bytes: &[u8]| {
    let Some(([scene, stage], script)) = bytes.split_first_chunk() else { return };
    let mut script = Line::script(script);
    script.truncate(LINES);
    SCENES.with_borrow_mut(|scenes| {
        let scene = &mut scenes[usize::from(*scene) % 2];
        let stage = usize::from(*stage) % scene.stages.len();
        scene.restore(stage);
        let (mut tally, mut told) = (Tally::default(), Vec::new());
        let trial = Trial::new(&mut scene.world, &scene.walls, &mut tally, &mut told);
        if let Err(fault) = trial.play(&script) {
            let place = &scene.stages[stage].name;
            panic!("in the {}, {place}: {fault}\n{}", scene.name, told.join("\n"));
        }
    });
});
