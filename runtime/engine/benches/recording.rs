//! What recording costs the world, what a log takes, and how fast it replays:
//! `cargo bench -p cohabit-engine --bench recording [-- SECONDS]`, ten minutes of a session if nothing is said.
//!
//! A robot goes about the office, at as many ticks a second as the machine makes, once unrecorded and once with a recorder
//! that writes to a file.
#![allow(clippy::unwrap_used)]

use std::{
    path::PathBuf,
    sync::Arc,
    time::{Duration, Instant},
};

use cohabit_bus::{Local, Topic, Transport, message::CommandMessage};
use cohabit_cdf::{Action, Catalog, GoToTarget, RoomId, mission};
use cohabit_engine::{Engine, SessionPlan, replay};
use cohabit_record::{Log, Recorder, SessionFacts};

const TICKS_PER_S: u64 = 60;
/// A new errand every ten seconds.
const ERRAND_EVERY: u64 = 600;

fn main() {
    let seconds: u64 = std::env::args().skip(1).find_map(|argument| argument.parse().ok()).unwrap_or(600);
    let catalog = Arc::new(Catalog::builtin());
    let (file, text) = mission::builtin()[0];
    let plan = SessionPlan::new(file, text, Arc::clone(&catalog), 3).unwrap();
    let path = std::env::temp_dir().join(format!("cohabit-bench-recording-{}.mcap", std::process::id()));
    println!("cohabit {}, {seconds} s of {file}", env!("CARGO_PKG_VERSION"));

    let [unrecorded, recorded] = [None, Some(&path)].map(|log| run(&plan, seconds * TICKS_PER_S, log));
    let tick_us = 1e6 / TICKS_PER_S as f64;
    for (what, times) in [("unrecorded", &unrecorded), ("recorded", &recorded)] {
        println!("a tick {what}, us: p50 {:.1}, p99 {:.1}, max {:.1}", at(times, 0.5), at(times, 0.99), at(times, 1.0));
    }
    let cost = at(&recorded, 0.5) - at(&unrecorded, 0.5);
    println!("recording costs {cost:.1} us at p50: {:.2} % of a tick in real time", 100.0 * cost / tick_us);

    let bytes = std::fs::metadata(&path).unwrap().len();
    println!(
        "the log takes {:.1} MB, {:.1} MB an hour",
        bytes as f64 / 1e6,
        bytes as f64 / 1e6 * 3600.0 / seconds as f64
    );
    let began = Instant::now();
    let log = Log::open(&path).unwrap();
    println!("it opens in {:.2} s", began.elapsed().as_secs_f64());
    let began = Instant::now();
    let replayed = replay::replay(&log, catalog).unwrap();
    let wall_s = began.elapsed().as_secs_f64();
    assert_eq!(replayed.difference, None);
    println!("and replays in {wall_s:.2} s, {:.0} times real time", seconds as f64 / wall_s);
    std::fs::remove_file(&path).unwrap();
}

/// How long each tick took, us, in order; `log` is where it is recorded.
fn run(plan: &SessionPlan, ticks: u64, log: Option<&PathBuf>) -> Vec<f64> {
    let bus = Local::new(1);
    let recorder = log.map(|_| Recorder::new(&bus).unwrap());
    let mut commands = bus.publisher(Topic::Commands).unwrap();
    let mut engine = Engine::new(plan, plan.build().unwrap(), &[], &bus).unwrap();
    if log.is_none() {
        engine = engine.without_recorder();
    }
    let mut recording =
        recorder.zip(log).map(|(recorder, path)| recorder.begin(&SessionFacts::named("bench"), path).unwrap());
    commands.send_record(0, &CommandMessage::claim(1, 0, "bench", false)).unwrap();
    let mut times = Vec::new();
    for tick in 0..ticks {
        if tick.is_multiple_of(ERRAND_EVERY) {
            let room = RoomId::BUILTIN[(tick / ERRAND_EVERY) as usize % RoomId::BUILTIN.len()];
            let action = Action::GoTo { target: GoToTarget::Room(room) };
            commands.send_record(0, &CommandMessage::act(2 + tick, 0, 0, action)).unwrap();
        }
        let began = Instant::now();
        engine.tick(tick).unwrap();
        times.push(began.elapsed());
        // What a recorder does is done in a process of its own.
        if let Some(recording) = &mut recording {
            recording.take_down().unwrap();
            recording.flush().unwrap();
        }
    }
    if let Some(recording) = recording {
        recording.finish().unwrap();
    }
    let mut times: Vec<f64> = times.iter().map(Duration::as_secs_f64).map(|seconds| seconds * 1e6).collect();
    times.sort_by(f64::total_cmp);
    times
}

fn at(times: &[f64], share: f64) -> f64 {
    times[((times.len() - 1) as f64 * share) as usize]
}
