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

fn print(soaked: &Soaked, seconds: f64) {
    soaked.lateness.print();
    for (role, looks) in &soaked.resident {
        let at = |share: f64| looks[((looks.len() - 1) as f64 * share) as usize];
        let [tenth, quarter, half, three, end] = [0.1, 0.25, 0.5, 0.75, 1.0].map(at);
        let mib = |bytes: u64| format!("{:.1}", bytes as f64 / MIB);
        let own = [tenth, quarter, half, three, end].map(|look| mib(look.own)).join(", ");
        let (first, last) = (mib(tenth.files + tenth.shared), mib(end.files + end.shared));
        println!(
            "{role:>7} resident, MiB, at 10, 25, 50, 75, 100 % of the time: {own}; shared, first and last: {first}, {last}"
        );
    }
    let frames = soaked.frames.map(|frames| frames as f64 / seconds);
    println!("frames/s at the pages: {:.1}, {:.1}; {} turns spoken", frames[0], frames[1], soaked.turns);
    print!("{}", soaked.replayed);
}
