//! Processes killed at any moment: nothing is lost but they, and nothing is left of them.
//!
//! Two hundred rounds with counts, two sessions at a time:
//! `cargo test -p cohabit --test system -- --ignored --nocapture faults::many_rounds`
//! (`COHABIT_ROUNDS` and `COHABIT_SEED` say how many others, and which).

mod round;
mod witness;

use std::{
    env,
    sync::atomic::{AtomicUsize, Ordering},
    thread,
    time::{SystemTime, UNIX_EPOCH},
};

use round::{Counts, Dice, Plan};

/// The seed that was asked for, or the clock's; printed, so that what failed can be tried again.
fn seed() -> u64 {
    let asked = env::var("COHABIT_SEED").ok().and_then(|text| text.parse().ok());
    let seed = asked.unwrap_or_else(|| SystemTime::now().duration_since(UNIX_EPOCH).unwrap().subsec_nanos().into());
    eprintln!("COHABIT_SEED={seed}");
    seed
}

/// Plays so many rounds, so many sessions at a time.
fn play(seed: u64, rounds: usize, at_once: usize) -> Counts {
    let next = AtomicUsize::new(0);
    thread::scope(|scope| {
        let worker = || {
            let mut counts = Counts::default();
            loop {
                let number = next.fetch_add(1, Ordering::Relaxed);
                if number >= rounds {
                    return counts;
                }
                let plan = Plan::draw(number, &mut Dice::new(seed, number));
                counts.note(number, &plan, plan.play());
            }
        };
        let workers: Vec<_> = (0..at_once).map(|_| scope.spawn(worker)).collect();
        workers.into_iter().map(|worker| worker.join().unwrap()).fold(Counts::default(), Counts::and)
    })
}

#[test]
fn a_process_killed_at_any_moment_costs_nothing_but_itself() {
    let counts = play(seed(), 10, 1);
    assert!(counts.failures.is_empty(), "{counts}");
    eprintln!("{counts}");
}

#[test]
#[ignore = "takes a quarter of an hour"]
fn many_rounds() {
    let rounds = env::var("COHABIT_ROUNDS").ok().and_then(|text| text.parse().ok()).unwrap_or(200);
    let counts = play(seed(), rounds, 2);
    eprintln!("{counts}");
    assert!(counts.failures.is_empty());
}
