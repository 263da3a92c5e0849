//! How many sessions a machine carries, by what was measured with one, two and more at a time.

use std::fmt;

use serde::{Deserialize, Serialize};

/// The most ticks that may be missed, as a share of all.
pub const MOST_MISSED: f64 = 0.005;
/// The fewest pictures that a page may get, as a share of what it gets while one session is played alone: where ticks go before all
/// else, they are in time long after pages have come to a halt.
pub const LEAST_PICTURES: f64 = 0.5;
/// The share of cores and of memory that an estimate gives to sessions: the rest is for moments that take more, and for others.
const USABLE: f64 = 0.8;

/// What was measured while so many sessions were played at a time, each with one page.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct Step {
    /// How many.
    pub sessions: usize,
    /// For how long, s.
    pub seconds: f64,
    /// Ticks that were due, of all of them.
    pub ticks: u64,
    /// Those that began a whole tick too late, or not at all.
    pub missed: u64,
    /// The share of the session that missed most.
    pub worst_missed: f64,
    /// Cores that all of them kept busy: processor time by time.
    pub cores: f64,
    /// Memory that all of them took, bytes; what several share counts once.
    pub memory_bytes: u64,
    /// Pictures a second of the page that got fewest.
    pub pictures_per_s: f64,
}

impl Step {
    /// The share of ticks that were missed; all of them, if there were none.
    #[must_use]
    pub fn missed_share(&self) -> f64 {
        if self.ticks == 0 { 1.0 } else { self.missed as f64 / self.ticks as f64 }
    }

    /// Cores that each session kept busy.
    #[must_use]
    pub fn cores_each(&self) -> f64 {
        self.cores / self.sessions.max(1) as f64
    }

    /// Memory that each session took, bytes.
    #[must_use]
    pub fn memory_each(&self) -> u64 {
        self.memory_bytes / self.sessions.max(1) as u64
    }
}

/// What was measured of a machine.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct Capacity {
    /// Cores that sessions may use.
    pub cores: usize,
    /// Memory that was free before, bytes.
    pub free_bytes: u64,
    /// Whether one session alone was measured, from which the rest is estimated.
    pub is_estimate: bool,
    /// What was measured, from one session on.
    pub steps: Vec<Step>,
}

impl Capacity {
    /// Whether what was measured with so many sessions is as it should be.
    #[must_use]
    pub fn is_well(&self, step: &Step) -> bool {
        let alone = self.steps.first().map_or(0.0, |first| first.pictures_per_s);
        step.missed_share() <= MOST_MISSED && step.pictures_per_s >= LEAST_PICTURES * alone
    }

    /// How many sessions fit; none, if not even one does.
    #[must_use]
    pub fn fits(&self) -> usize {
        let measured = self.steps.iter().take_while(|step| self.is_well(step)).last();
        match measured {
            Some(step) if self.is_estimate => self.estimated(step).max(step.sessions),
            Some(step) => step.sessions,
            None => 0,
        }
    }

    /// How many of the kind that was measured the machine has cores and memory for.
    fn estimated(&self, step: &Step) -> usize {
        let times = |has: f64, each: f64| (USABLE * has / each.max(f64::MIN_POSITIVE)).floor();
        let by_cores = times(self.cores as f64, step.cores_each());
        let by_memory = times(self.free_bytes as f64, step.memory_each() as f64);
        // More than a machine of today has ports for is no number to count on.
        by_cores.min(by_memory).min(f64::from(u16::MAX)) as usize
    }
}

impl fmt::Display for Step {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { sessions, ticks, missed, worst_missed, pictures_per_s, .. } = self;
        let noun = if *sessions == 1 { "session" } else { "sessions" };
        write!(
            f,
            "{sessions} {noun}: {missed} of {ticks} ticks missed ({:.2} %, {:.2} % at worst), {:.2} cores and {} MB each, \
             {pictures_per_s:.1} pictures/s",
            100.0 * self.missed_share(),
            100.0 * worst_missed,
            self.cores_each(),
            self.memory_each() >> 20
        )
    }
}

impl fmt::Display for Capacity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (fits, cores) = (self.fits(), self.cores);
        let (sessions, fit) = if fits == 1 { ("session", "fits") } else { ("sessions", "fit") };
        let how = if self.is_estimate { ", by what one takes" } else { "" };
        let of = if cores == 1 { "core" } else { "cores" };
        write!(f, "{fits} real-time {sessions} {fit} on {cores} {of}{how}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(sessions: usize, missed: u64, pictures_per_s: f64) -> Step {
        Step {
            sessions,
            seconds: 10.0,
            ticks: 1000,
            missed,
            pictures_per_s,
            cores: 0.4 * sessions as f64,
            ..Step::default()
        }
    }

    fn capacity(steps: &[Step]) -> Capacity {
        Capacity { cores: 2, free_bytes: 8 << 30, is_estimate: false, steps: steps.to_vec() }
    }

    #[test]
    fn as_many_fit_as_miss_no_more_ticks_than_may_be() {
        let three = [step(1, 0, 30.0), step(2, 5, 30.0), step(3, 6, 30.0)];
        assert_eq!(capacity(&three).fits(), 2);
        // What comes after one too many is no measure: that it was better then is chance.
        assert_eq!(capacity(&[&three[..], &[step(4, 0, 30.0)]].concat()).fits(), 2);
        assert_eq!(capacity(&three[..1]).fits(), 1);
        assert_eq!(capacity(&[step(1, 6, 30.0)]).fits(), 0);
        assert_eq!(capacity(&[]).fits(), 0);
    }

    #[test]
    fn pages_that_stand_still_do_not_fit() {
        assert_eq!(capacity(&[step(1, 0, 30.0), step(2, 0, 15.0), step(3, 0, 14.0)]).fits(), 2);
    }

    #[test]
    fn one_session_alone_tells_how_many_there_are_cores_and_memory_for() {
        let one = Step { memory_bytes: 1 << 30, ..step(1, 0, 30.0) };
        let estimate =
            |cores, free_bytes, one: Step| Capacity { cores, free_bytes, is_estimate: true, steps: vec![one] }.fits();
        assert_eq!(estimate(2, 64 << 30, one), 4, "1.6 of 2 cores, at 0.4 each");
        assert_eq!(estimate(16, 64 << 30, one), 32);
        assert_eq!(estimate(16, 4 << 30, one), 3, "3.2 of 4 GiB");
        assert_eq!(estimate(1, 1 << 30, Step { cores: 0.95, ..one }), 1, "what was measured is there");
        assert_eq!(estimate(16, 64 << 30, Step { missed: 500, ..one }), 0);
    }

    #[test]
    fn figures_can_be_read() {
        let one = Step { memory_bytes: 230 << 20, worst_missed: 0.005, ..step(1, 5, 29.96) };
        let line =
            "1 session: 5 of 1000 ticks missed (0.50 %, 0.50 % at worst), 0.40 cores and 230 MB each, 30.0 pictures/s";
        assert_eq!(one.to_string(), line);
        assert_eq!(capacity(&[one]).to_string(), "1 real-time session fits on 2 cores");
        assert_eq!(capacity(&[]).to_string(), "0 real-time sessions fit on 2 cores");
    }

    #[test]
    fn what_was_measured_is_kept_as_it_is() {
        let whole = capacity(&[step(1, 0, 30.0), step(2, 9, 12.5)]);
        let text = serde_json::to_string(&whole).expect("JSON");
        assert_eq!(serde_json::from_str::<Capacity>(&text).expect("the same"), whole);
    }
}
