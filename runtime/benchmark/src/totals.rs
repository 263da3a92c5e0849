//! The figures of a submission: how many missions are solved, and with how many actions.

use std::collections::BTreeMap;

use cohabit_tables::wilson_95;
use serde::{Deserialize, Serialize};

use crate::{benchmark::Benchmark, episode::Episode, mission::Split};

/// The figures of several episodes.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Tally {
    /// Missions.
    pub missions: usize,
    /// Those whose every goal was met within the caps.
    pub solved: usize,
    /// Mission success rate: their share, from 0 to 1.
    pub msr: f64,
    /// Its 95 % interval (Wilson).
    pub interval_95: [f64; 2],
    /// Number of robot actions: commands a mission.
    pub nra: f64,
    /// Commands a mission that failed.
    pub failed: f64,
    /// Goals met.
    pub goals_met: usize,
    /// Goals in all.
    pub goals: usize,
}

/// The figures of a split.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct SplitTotals {
    /// Of all its missions.
    pub all: Tally,
    /// By what of them is held out from training.
    pub parts: BTreeMap<String, Tally>,
    /// By type of mission.
    pub types: BTreeMap<String, Tally>,
}

/// The figures of a submission, by split.
pub type Totals = BTreeMap<Split, SplitTotals>;

impl Tally {
    /// The figures of these.
    #[must_use]
    pub fn of(episodes: &[&Episode]) -> Self {
        let missions = episodes.len();
        let sum = |count: fn(&Episode) -> usize| episodes.iter().map(|episode| count(episode)).sum::<usize>();
        let mean = |sum: usize| if missions == 0 { 0.0 } else { sum as f64 / missions as f64 };
        let solved = sum(|episode| usize::from(episode.success));
        Self {
            missions,
            solved,
            msr: mean(solved),
            interval_95: wilson_95(solved, missions),
            nra: mean(sum(|episode| episode.actions as usize)),
            failed: mean(sum(|episode| episode.failed_actions as usize)),
            goals_met: sum(|episode| episode.goals_met),
            goals: sum(|episode| episode.goals),
        }
    }
}

/// The figures of these episodes; those of missions that the benchmark has not are left out.
#[must_use]
pub fn totals(benchmark: &Benchmark, episodes: &[Episode]) -> Totals {
    let missions: BTreeMap<&str, _> = benchmark.missions.iter().map(|mission| (mission.id.as_str(), mission)).collect();
    let mut all = BTreeMap::<Split, Groups<'_>>::new();
    for episode in episodes {
        if let Some(mission) = missions.get(episode.mission.as_str()) {
            let groups = all.entry(mission.split).or_default();
            groups.all.push(episode);
            groups.parts.entry(mission.part.name()).or_default().push(episode);
            groups.types.entry(&mission.kind).or_default().push(episode);
        }
    }
    all.into_iter().map(|(split, groups)| (split, groups.totals())).collect()
}

/// The episodes of a split.
#[derive(Default)]
struct Groups<'a> {
    all: Vec<&'a Episode>,
    parts: BTreeMap<&'a str, Vec<&'a Episode>>,
    types: BTreeMap<&'a str, Vec<&'a Episode>>,
}

impl Groups<'_> {
    fn totals(&self) -> SplitTotals {
        let each = |groups: &BTreeMap<&str, Vec<&Episode>>| {
            groups.iter().map(|(name, episodes)| ((*name).to_owned(), Tally::of(episodes))).collect()
        };
        SplitTotals { all: Tally::of(&self.all), parts: each(&self.parts), types: each(&self.types) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::episode::EpisodeEnd;

    fn episode(success: bool, actions: u32) -> Episode {
        Episode {
            mission: "one".to_owned(),
            success,
            goals_met: usize::from(success),
            goals: 1,
            actions,
            failed_actions: 1,
            end: EpisodeEnd::Stopped,
            ticks: 9,
            digest: String::new(),
            taken: Vec::new(),
        }
    }

    #[test]
    fn figures_are_those_of_the_episodes() {
        let episodes = [episode(true, 10), episode(false, 20), episode(false, 30), episode(false, 0)];
        let tally = Tally::of(&episodes.iter().collect::<Vec<_>>());
        assert_eq!((tally.missions, tally.solved, tally.msr), (4, 1, 0.25));
        assert_eq!((tally.nra, tally.failed), (15.0, 1.0));
        assert_eq!((tally.goals_met, tally.goals), (1, 4));
        let [low, high] = tally.interval_95;
        assert!(low < 0.25 && 0.25 < high && low > 0.0 && high < 1.0, "{tally:?}");
    }

    #[test]
    fn nothing_has_no_figures() {
        let tally = Tally::of(&[]);
        assert_eq!((tally.msr, tally.nra, tally.interval_95), (0.0, 0.0, [0.0, 1.0]));
    }
}
