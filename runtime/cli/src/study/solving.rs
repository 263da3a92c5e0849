//! Whether the planner solves the missions of a study.

use std::path::Path;

use cohabit_cdf::WorldData;
use cohabit_eval::{Played, Settings, Task, solve};
use cohabit_study::Study;

use crate::{failure::bad_input, mission_file::MissionFile, terminal::shown};

/// The seed of what missions leave to chance: each session has its own.
const SEED: u64 = 1;
const TICKS_PER_SECOND: u64 = 60;

/// Has the planner play each mission of a study from its goals alone, and says what came of it. Files lie in `folder`.
///
/// # Errors
/// It does not solve all of them.
pub fn solve_all(study: &Study, folder: &Path, world: &WorldData) -> anyhow::Result<()> {
    let mut unsolved = Vec::new();
    for name in missions(study) {
        let played = played(name, folder, world)?;
        let (name, actions, took_s) = (shown(name), played.actions, played.wall_s);
        if played.success {
            let session_s = played.ticks / TICKS_PER_SECOND;
            println!("{name}: solved by the planner: {actions} actions, {session_s} s; that took {took_s:.1} s");
        } else {
            println!("{name}: not solved by the planner: {}; that took {took_s:.1} s", shown(why(&played)));
            unsolved.push(name.to_string());
        }
    }
    if unsolved.is_empty() {
        return Ok(());
    }
    Err(bad_input(format!("the planner does not solve {}; what it lacks stands above", unsolved.join(", "))))
}

/// The missions of all blocks, each once, in the order in which they come up.
fn missions(study: &Study) -> Vec<&str> {
    let mut all: Vec<&str> = Vec::new();
    for name in study.blocks.iter().flat_map(|block| study.missions_of(block)) {
        if !all.contains(&name.as_str()) {
            all.push(name);
        }
    }
    all
}

fn played(name: &str, folder: &Path, world: &WorldData) -> anyhow::Result<Played> {
    let beside = folder.join(name);
    let path = if beside.is_file() { beside.to_string_lossy().into_owned() } else { name.to_owned() };
    let cdf = MissionFile::find_in(Some(&path), world)?.text;
    let task = Task { id: name.to_owned(), family: None, cdf, preparation: Vec::new(), script: Vec::new() };
    Ok(solve(&task, &Settings::expert(SEED), world.catalog())?)
}

/// Why a mission was not solved.
fn why(played: &Played) -> String {
    let open = || format!("open: {}", played.open_goals.join("; "));
    played.ended_early.clone().unwrap_or_else(open)
}
