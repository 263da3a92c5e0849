//! How late a session's ticks begin, beside what the machine itself is good for.

use std::{
    fs,
    sync::atomic::{AtomicBool, Ordering},
    thread,
    time::Duration,
};

use anyhow::Context as _;
use cohabit_bus::{Inbox, Session, Shm, Topic, go_first, message::TickView, monotonic_nanos};

/// A tick that begins later than the next one should is missed, ns.
const TICK_NANOS: u64 = 16_666_667;

/// What was seen of a session's ticks for a while.
#[derive(Clone, Debug, Default)]
pub struct Lateness {
    /// How late each tick began, ns, in rising order.
    pub late_nanos: Vec<u64>,
    /// How late a thread beside it woke that does nothing but wake as often as the world ticks, ns, in rising order:
    /// what the machine itself is good for.
    pub control_nanos: Vec<u64>,
    /// Ticks that were sent and not seen.
    pub lost: u64,
    /// The share of the processors' time that the machine's host gave to others meanwhile.
    pub stolen: f64,
}

impl Lateness {
    /// Watches a session, from now until `over`.
    ///
    /// # Errors
    /// When its bus cannot be joined or fails.
    pub fn watch(session: &str, over: &AtomicBool) -> anyhow::Result<Self> {
        let before = Processors::now();
        let mut seen = thread::scope(|scope| {
            let control = scope.spawn(|| wake_and_sleep(over));
            let (late_nanos, lost) = watch_ticks(session, over)?;
            let control_nanos = control.join().ok().context("the thread beside it fell over")?;
            anyhow::Ok(Self { late_nanos, control_nanos, lost, stolen: 0.0 })
        })?;
        seen.late_nanos.sort_unstable();
        seen.control_nanos.sort_unstable();
        seen.stolen = before.stolen_until(Processors::now());
        Ok(seen)
    }

    /// How many ticks began a whole tick too late.
    #[must_use]
    pub fn missed(&self) -> usize {
        missed(&self.late_nanos)
    }

    /// How late the given share of all ticks began at most, ms.
    #[must_use]
    pub fn late_ms(&self, share: f64) -> f64 {
        at(&self.late_nanos, share)
    }

    /// How late the given share of all wake-ups of the thread beside it was at most, ms.
    #[must_use]
    pub fn control_ms(&self, share: f64) -> f64 {
        at(&self.control_nanos, share)
    }

    /// How often that thread woke a whole tick too late.
    #[must_use]
    pub fn control_missed(&self) -> usize {
        missed(&self.control_nanos)
    }

    /// The same for people, in four lines.
    pub fn print(&self) {
        let share = |missed: usize, of: &[u64]| 100.0 * missed as f64 / of.len().max(1) as f64;
        let (own, control) = (self.missed(), self.control_missed());
        let own_share = share(own, &self.late_nanos);
        println!("ticks: {} seen, {} not seen; {own} missed ({own_share:.3} %)", self.late_nanos.len(), self.lost);
        let shares = [0.5, 0.9, 0.99, 0.999, 1.0];
        print_late("ticks begun late by", shares.map(|share| self.late_ms(share)));
        print_late("a thread beside it that only wakes", shares.map(|share| self.control_ms(share)));
        println!(
            "that thread missed {control} ({:.3} %); the machine's host gave {:.2} % of the processors' time to others",
            share(control, &self.control_nanos),
            100.0 * self.stolen
        );
    }
}

fn print_late(what: &str, [p50, p90, p99, p999, max]: [f64; 5]) {
    println!("{what}, ms: p50 {p50:.3}, p90 {p90:.3}, p99 {p99:.3}, p99.9 {p999:.3}, max {max:.3}");
}

/// How many of these are a whole tick.
fn missed(late_nanos: &[u64]) -> usize {
    late_nanos.iter().filter(|late| **late >= TICK_NANOS).count()
}

/// What the given share of `nanos`, which rise, is at most, ms.
fn at(nanos: &[u64], share: f64) -> f64 {
    let last = nanos.len().saturating_sub(1);
    nanos.get((last as f64 * share).round() as usize).map_or(f64::NAN, |nanos| *nanos as f64 * 1e-6)
}

/// How late each tick began from now on, and how many were not seen.
fn watch_ticks(session: &str, over: &AtomicBool) -> anyhow::Result<(Vec<u64>, u64)> {
    let began_nanos = monotonic_nanos();
    let bus = Shm::join(&Session::new(session)?)?;
    let mut ticks = Inbox::new(&bus, Topic::Ticks)?;
    let mut late = Vec::new();
    while !over.load(Ordering::Relaxed) {
        thread::sleep(Duration::from_millis(100));
        while let Some((tick, nanos)) = ticks.next(|sample| Ok(TickView::new(sample.payload())?.header.late_nanos))? {
            // Those before are kept for who joins late.
            if tick.envelope().sent_nanos >= began_nanos {
                late.push(nanos);
            }
        }
    }
    Ok((late, ticks.lost()))
}

/// Wakes as often as the world ticks; gives how late, ns.
fn wake_and_sleep(over: &AtomicBool) -> Vec<u64> {
    go_first();
    let mut late = Vec::new();
    let mut due_nanos = monotonic_nanos();
    while !over.load(Ordering::Relaxed) {
        due_nanos += TICK_NANOS;
        thread::sleep(Duration::from_nanos(due_nanos.saturating_sub(monotonic_nanos())));
        late.push(monotonic_nanos().saturating_sub(due_nanos));
    }
    late
}

/// What the processors' time went to since the machine began.
#[derive(Clone, Copy, Debug, Default)]
struct Processors {
    all: u64,
    stolen: u64,
}

impl Processors {
    /// Zeros where that is not told: see proc_stat(5).
    fn now() -> Self {
        let text = fs::read_to_string("/proc/stat").unwrap_or_default();
        let times = text.lines().next().unwrap_or_default().split_whitespace().skip(1);
        let times: Vec<u64> = times.map_while(|time| time.parse().ok()).take(8).collect();
        Self { all: times.iter().sum(), stolen: times.get(7).copied().unwrap_or(0) }
    }

    fn stolen_until(self, later: Self) -> f64 {
        (later.stolen - self.stolen) as f64 / (later.all - self.all).max(1) as f64
    }
}
