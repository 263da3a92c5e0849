//! A session in real time under load: `cargo bench -p cohabit --bench soak [-- SECONDS]`, ten minutes if nothing is said.
//!
//! Four agents, a recorder, two pages that watch. Prints the machine, the version, how late ticks began, how many were
//! missed, and what memory the processes held in the course of it.

use std::time::Duration;

use cohabit_tests::{Soaked, machine, soak};

const MIB: f64 = 1_048_576.0;

fn main() {
    let seconds = std::env::args().skip(1).find_map(|argument| argument.parse().ok()).unwrap_or(600);
    println!("cohabit {}, {}", env!("CARGO_PKG_VERSION"), machine());
    println!("{seconds} s with four agents, a recorder and two pages");
    match soak(env!("CARGO_BIN_EXE_cohabit"), Duration::from_secs(seconds)) {
        Ok(soaked) => print(&soaked, seconds as f64),
        Err(error) => println!("it failed: {error:#}"),
    }
}

fn late(what: &str, [p50, p90, p99, p999, max]: [f64; 5]) {
    println!("{what}, ms: p50 {p50:.3}, p90 {p90:.3}, p99 {p99:.3}, p99.9 {p999:.3}, max {max:.3}");
}

fn print(soaked: &Soaked, seconds: f64) {
    let ticks = soaked.late_nanos.len();
    let share = |missed: usize, of: &[u64]| 100.0 * missed as f64 / of.len().max(1) as f64;
    let (own, control) = (soaked.missed, soaked.control_missed());
    let own_share = share(own, &soaked.late_nanos);
    println!("ticks: {ticks} seen, {} not seen; {own} missed ({own_share:.3} %)", soaked.lost);
    let shares = [0.5, 0.9, 0.99, 0.999, 1.0];
    late("ticks begun late by", shares.map(|share| soaked.late_ms(share)));
    late("a thread beside it that only wakes", shares.map(|share| soaked.control_ms(share)));
    println!(
        "that thread missed {control} ({:.3} %); the machine's host gave {:.2} % of the processors' time to others",
        share(control, &soaked.control_nanos),
        100.0 * soaked.stolen
    );
    for (role, looks) in &soaked.resident {
        let at = |share: f64| looks[((looks.len() - 1) as f64 * share) as usize];
        let [tenth, quarter, half, three, end] = [0.1, 0.25, 0.5, 0.75, 1.0].map(at);
        let mib = |bytes: u64| format!("{:.1}", bytes as f64 / MIB);
        let own = [tenth, quarter, half, three, end].map(|look| mib(look.own)).join(", ");
        let (first, last) = (mib(tenth.shared), mib(end.shared));
        println!(
            "{role:>7} resident, MiB, at 10, 25, 50, 75, 100 % of the time: {own}; shared, first and last: {first}, {last}"
        );
    }
    let frames = soaked.frames.map(|frames| frames as f64 / seconds);
    println!("frames/s at the pages: {:.1}, {:.1}; {} turns spoken", frames[0], frames[1], soaked.turns);
    print!("{}", soaked.replayed);
}
