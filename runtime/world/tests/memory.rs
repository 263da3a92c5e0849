//! What one world takes of memory, everything it was built from included.

#![allow(clippy::unwrap_used)]

mod support;

#[path = "support/heap.rs"]
mod heap;

use std::sync::Arc;

use cohabit_cdf::{Catalog, Layout};
use support::{play::Life, stage::kitchen};

#[global_allocator]
static HEAP: heap::Counted = heap::Counted;

const MOST_BYTES: usize = 60_000_000;
const TICKS: u64 = 10_000;

#[test]
fn a_world_takes_no_more_than_sixty_megabytes() {
    let largest = Layout::builtin_ids();
    let placements = |id: &String| Layout::builtin(id).unwrap().placements.len();
    let largest = largest.iter().max_by_key(|id| placements(id)).unwrap();
    let before = heap::live_bytes();
    heap::forget_most();
    let catalog = Arc::new(Catalog::builtin());
    let catalog_bytes = heap::live_bytes() - before;
    let mut life = Life::new(largest, kitchen(&catalog, largest), 1);
    let built_bytes = heap::live_bytes() - before;
    for _ in 0..TICKS {
        life.step();
    }
    let bytes = heap::live_bytes() - before;
    println!(
        "{largest}: {:.1} MB after {TICKS} ticks, {:.1} MB as built, of which the catalogue {:.1} MB; {:.1} MB at most",
        bytes as f64 / 1e6,
        built_bytes as f64 / 1e6,
        catalog_bytes as f64 / 1e6,
        (heap::most_bytes() - before) as f64 / 1e6,
    );
    assert!(bytes <= MOST_BYTES, "{bytes} bytes");
    drop((life, catalog));
    let left = heap::live_bytes() - before;
    assert!(left < 1_000_000, "{left} bytes are left behind");
}
