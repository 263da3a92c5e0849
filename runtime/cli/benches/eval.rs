//! How fast missions load and play: `cargo bench -p cohabit --bench eval [-- FILE]`.
//!
//! FILE is what `cohabit eval` takes; the built-in missions if absent. Prints the machine, the version, and medians with
//! the 95th percentile.

use std::{
    path::{Path, PathBuf},
    process::Command,
    sync::Arc,
    time::Instant,
};

use cohabit_cdf::Catalog;
use cohabit_engine::SessionPlan;
use cohabit_eval::{Report, Task, read_tasks};
use cohabit_tests::machine;

fn main() {
    let file = std::env::args().skip(1).find(|argument| !argument.starts_with("--")).map(PathBuf::from);
    let builtin = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cdf/missions");
    let file = file.unwrap_or_else(builtin);
    let tasks = match read_tasks(&file, None) {
        Ok(tasks) => tasks,
        Err(error) => return eprintln!("{error}"),
    };
    println!("cohabit {}, {}", env!("CARGO_PKG_VERSION"), machine());
    println!("{}: {} missions", file.display(), tasks.len());
    load(&tasks);
    play(&file);
}

/// Text of a mission to a world at its first tick; and back to that first tick from any later one.
fn load(tasks: &[Task]) {
    let catalog = Arc::new(Catalog::builtin());
    let (mut loads, mut resets) = (Vec::new(), Vec::new());
    for task in tasks.iter().cycle().take(tasks.len().max(100)) {
        let began = Instant::now();
        let plan = SessionPlan::new(&task.id, &task.cdf, Arc::clone(&catalog), 1);
        let Some(mut world) = plan.ok().and_then(|plan| plan.build().ok()) else {
            println!("{} is not playable", task.id);
            continue;
        };
        loads.push(began.elapsed().as_secs_f64() * 1e3);
        let first = world.snapshot();
        (0..60).for_each(|_| drop(world.step(&[])));
        let began = Instant::now();
        world.restore(&first).expect("its own snapshot");
        resets.push(began.elapsed().as_secs_f64() * 1e3);
    }
    print("load (text of a mission to its first tick)", &mut loads);
    print("reset (to the first tick)", &mut resets);
}

fn print(what: &str, times_ms: &mut [f64]) {
    times_ms.sort_by(f64::total_cmp);
    let at = |share: f64| times_ms.get((times_ms.len() as f64 * share) as usize).copied().unwrap_or(f64::NAN);
    println!("{what}: median {:.2} ms, 95th percentile {:.2} ms", at(0.5), at(0.95));
}

/// All of them by `cohabit eval`, on all cores.
fn play(file: &Path) {
    let report = std::env::temp_dir().join(format!("cohabit-bench-{}.json", std::process::id()));
    let began = Instant::now();
    let status =
        Command::new(env!("CARGO_BIN_EXE_cohabit")).arg("eval").arg(file).arg("--report").arg(&report).status();
    let wall_s = began.elapsed().as_secs_f64();
    let read = std::fs::read(&report).ok().and_then(|bytes| serde_json::from_slice::<Report>(&bytes).ok());
    let _ = std::fs::remove_file(&report);
    let Some(report) = read else { return eprintln!("`cohabit eval` failed: {status:?}") };
    let ticks: u64 = report.missions.iter().map(|task| task.ticks).sum();
    println!(
        "eval: {} of {} solved in {wall_s:.2} s wall, {} ticks, {:.2} µs a tick and core, {:.0} times real time",
        report.total.solved,
        report.total.missions,
        ticks,
        wall_s * report.workers as f64 / ticks.max(1) as f64 * 1e6,
        ticks as f64 * cohabit_engine::replay::TICK_S / wall_s
    );
}
