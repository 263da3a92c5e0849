//! What loading, stepping, digesting and keeping a world cost on this machine, in time and memory.

#[path = "../tests/support/heap.rs"]
mod heap;
#[path = "../tests/support/mod.rs"]
mod support;

use std::{
    error::Error,
    process::Command,
    sync::Arc,
    time::{Duration, Instant},
};

use cohabit_cdf::{Catalog, Layout, RoomId, mission};
use cohabit_world::{Action, BodyId, BodyKind, GoToTarget, Input, World};
use support::play::Life;

#[global_allocator]
static HEAP: heap::Counted = heap::Counted;

/// Times that what happens often is measured.
const TICKS: u32 = 6_000;
/// Times that what happens once is measured.
const TIMES: usize = 40;

fn main() -> Result<(), Box<dyn Error>> {
    machine();
    let (name, text) = mission::builtin().first().ok_or("there is no built-in mission")?;
    let before = heap::live_bytes();
    heap::forget_most();
    let begin = Instant::now();
    let catalog = Arc::new(Catalog::builtin());
    println!("catalogue        {:?}", begin.elapsed());
    let load = || -> Result<World, Box<dyn Error>> {
        let checked = mission::read_mission(name, text, &catalog).map_err(|problems| problems.0[0].to_string())?;
        let layout = Arc::new(Layout::builtin(&checked.mission.layout)?);
        Ok(World::new(Arc::clone(&catalog), layout, Arc::new(checked.mission), 1)?)
    };
    print("load and reset", times(TIMES, || load().map(drop))?);
    let world = load()?;
    let (catalog, layout, mission) = (world.catalog(), world.layout(), world.mission());
    let again = || World::new(Arc::clone(catalog), Arc::clone(layout), Arc::clone(mission), 1);
    print("build", times(TIMES, || again().map(drop))?);
    println!("memory           {:.2} MB, {} objects", megabytes(before), world.objects().len());
    println!("memory at most   {:.2} MB, while loading", (heap::most_bytes() - before) as f64 / 1e6);

    let mut idle = again()?;
    print("step, idle", steps(|_| drop(idle.step(&[]))));
    let mut walker = again()?;
    print("step, walking", steps(|tick| walk(&mut walker, tick)));
    let mut crowd = again()?;
    for room in [RoomId::MAIN_OFFICE, RoomId::BREAK_ROOM] {
        crowd.add_body(BodyKind::Robot, room)?;
    }
    let mut life = Life::new("crowd", crowd, 1);
    print("step, busy", steps(|_| drop(life.step())));
    println!("memory           {:.2} MB with three more worlds", megabytes(before));

    let world = &mut life.world;
    let mut digest = [0; 32];
    print("digest", steps(|_| digest = std::hint::black_box(world.digest())));
    let mut snapshot = Vec::new();
    print("snapshot", steps(|_| snapshot = world.snapshot()));
    print("restore", times(TIMES, || world.restore(&snapshot))?);
    println!("snapshot bytes   {}", snapshot.len());
    Ok(())
}

/// What this was measured on and with.
fn machine() {
    let processor = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model =
        processor.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": ").map(|(_, name)| name));
    let cores = std::thread::available_parallelism().map_or(0, std::num::NonZero::get);
    let compiler = Command::new("rustc").arg("--version").output().map(|output| output.stdout).unwrap_or_default();
    let profile = if cfg!(debug_assertions) { "dev" } else { "release" };
    println!(
        "{} ({}), {cores} cores, {} {}\ncohabit-world {}, {profile} profile, {}",
        model.unwrap_or("unknown processor"),
        std::env::consts::ARCH,
        std::env::consts::OS,
        std::fs::read_to_string("/proc/sys/kernel/osrelease").unwrap_or_default().trim(),
        env!("CARGO_PKG_VERSION"),
        String::from_utf8_lossy(&compiler).trim(),
    );
}

/// Sends the first body to another room every ten seconds.
fn walk(world: &mut World, tick: u32) {
    let room = RoomId::BUILTIN[(tick / 600) as usize % RoomId::BUILTIN.len()];
    let action = Action::GoTo { target: GoToTarget::Room(room) };
    let walk = Input { command: tick.into(), body: BodyId(0), action };
    world.step(if tick.is_multiple_of(600) { std::slice::from_ref(&walk) } else { &[] });
}

fn steps(mut step: impl FnMut(u32)) -> Vec<Duration> {
    let timed = |tick| {
        let begin = Instant::now();
        step(tick);
        begin.elapsed()
    };
    (0..TICKS).map(timed).collect()
}

fn times<E>(count: usize, mut work: impl FnMut() -> Result<(), E>) -> Result<Vec<Duration>, E> {
    let timed = |_| {
        let begin = Instant::now();
        work()?;
        Ok(begin.elapsed())
    };
    (0..count).map(timed).collect()
}

fn print(what: &str, mut times: Vec<Duration>) {
    times.sort();
    let at = |part: usize| times[(times.len() - 1) * part / 100];
    println!("{what:16} p50 {:?}, p99 {:?}, most {:?}", at(50), at(99), at(100));
}

fn megabytes(before: usize) -> f64 {
    (heap::live_bytes() - before) as f64 / 1e6
}
