//! What came of many tasks.

use std::collections::BTreeMap;

use cohabit_tables::wilson_95;
use serde::{Deserialize, Serialize};

use crate::play::{Caps, Played};

/// All results, and their sums.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Report {
    /// The version of the program.
    pub program: String,
    /// The file or folder played.
    pub source: String,
    /// The seed where missions leave it to chance.
    pub seed: u64,
    /// When missions were given up.
    pub caps: Option<Caps>,
    /// Processes that played.
    pub workers: usize,
    /// Wall time of all, s.
    pub wall_s: f64,
    /// All together.
    pub total: Tally,
    /// By kind of task.
    pub families: BTreeMap<String, Tally>,
    /// Each one, in the order of the source.
    pub missions: Vec<Played>,
}

/// The sums of several tasks.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct Tally {
    /// Tasks.
    pub missions: usize,
    /// Those whose every goal was met.
    pub solved: usize,
    /// Their share.
    pub success_rate: f64,
    /// Its 95 % interval (Wilson).
    pub interval_95: [f64; 2],
    /// Goals met, and goals in all.
    pub goals_met: usize,
    /// Goals in all.
    pub goals: usize,
    /// Commands a task.
    pub mean_actions: f64,
    /// Commands a task that failed.
    pub mean_failed_actions: f64,
    /// Questions that the robot asked, a task.
    pub mean_questions: f64,
}

impl Tally {
    /// The sums of these.
    #[must_use]
    pub fn of<'a>(played: impl Iterator<Item = &'a Played> + Clone) -> Self {
        let missions = played.clone().count();
        let solved = played.clone().filter(|task| task.success).count();
        let sum = |count: fn(&Played) -> usize| played.clone().map(count).sum::<usize>();
        let mean = |sum: usize| if missions == 0 { 0.0 } else { sum as f64 / missions as f64 };
        Self {
            missions,
            solved,
            success_rate: mean(solved),
            interval_95: wilson_95(solved, missions),
            goals_met: sum(|task| task.goals_met),
            goals: sum(|task| task.goals),
            mean_actions: mean(sum(|task| task.actions as usize)),
            mean_failed_actions: mean(sum(|task| task.failed_actions as usize)),
            mean_questions: mean(sum(|task| task.questions as usize)),
        }
    }
}

impl Report {
    /// Sums up what was played.
    #[must_use]
    pub fn new(
        source: &str,
        seed: u64,
        caps: Option<Caps>,
        workers: usize,
        wall_s: f64,
        missions: Vec<Played>,
    ) -> Self {
        let mut names: Vec<&str> = missions.iter().map(|task| task.family.as_str()).collect();
        names.sort_unstable();
        names.dedup();
        let of_family = |name: &str| Tally::of(missions.iter().filter(|task| task.family == name));
        Self {
            program: env!("CARGO_PKG_VERSION").to_owned(),
            source: source.to_owned(),
            seed,
            caps,
            workers,
            wall_s,
            total: Tally::of(missions.iter()),
            families: names.iter().map(|name| ((*name).to_owned(), of_family(name))).collect(),
            missions,
        }
    }
}
