//! The short form of `cargo bench -p cohabit --bench soak`: nothing is lost under load.

use std::time::Duration;

use cohabit_tests::soak;

use crate::COHABIT;

#[test]
fn four_agents_a_recorder_and_two_pages_lose_nothing() {
    let soaked = soak(COHABIT, Duration::from_secs(10)).unwrap();
    println!(
        "{} ticks, {} missed; late by p50 {:.3} ms, p99 {:.3} ms",
        soaked.lateness.late_nanos.len(),
        soaked.lateness.missed(),
        soaked.lateness.late_ms(0.5),
        soaked.lateness.late_ms(0.99)
    );
    assert_eq!(soaked.lateness.lost, 0, "ticks were lost");
    assert!(soaked.frames.iter().all(|frames| *frames > 0), "a page saw nothing: {:?}", soaked.frames);
    assert!(soaked.turns > 0, "nothing that was said was done");
    assert!(soaked.replayed.contains("no tick differs"), "{}", soaked.replayed);
}
