//! Outcomes of a simulated study.

use super::{Design, Effect, Varies};
use crate::chance::Chance;

/// A study of so many participants, whose outcomes are drawn again and again.
#[derive(Clone, Debug)]
pub(super) struct Study {
    /// The columns of the design matrix: an intercept, and each level but the first.
    pub columns: Vec<Vec<f64>>,
    /// Of each session, the number of its participant: these are in order.
    pub participants: Vec<usize>,
    /// Of each session, the mean of its level.
    means: Vec<f64>,
    participant_sd: f64,
    residual_sd: f64,
}

impl Study {
    pub fn new(design: &Design, effect: &Effect, participants: usize) -> Self {
        let met = |participant: usize| match design.varies {
            Varies::Within => 0..design.levels,
            Varies::Between => participant % design.levels..participant % design.levels + 1,
        };
        let of = |participant: usize| {
            met(participant).flat_map(move |level| std::iter::repeat_n((participant, level), design.sessions))
        };
        let sessions: Vec<(usize, usize)> = (0..participants).flat_map(of).collect();
        let is_level = |wanted: usize| {
            sessions.iter().map(|(_, level)| f64::from(u8::from(wanted == 0 || *level == wanted))).collect()
        };
        let mean = |level: usize| if level == 0 { 0.0 } else { effect.differences[level - 1] };
        Self {
            columns: (0..design.levels).map(is_level).collect(),
            means: sessions.iter().map(|(_, level)| mean(*level)).collect(),
            participants: sessions.into_iter().map(|(participant, _)| participant).collect(),
            participant_sd: effect.participant_sd,
            residual_sd: effect.residual_sd,
        }
    }

    /// The columns that the condition is coded in.
    pub fn tested(&self) -> Vec<usize> {
        (1..self.columns.len()).collect()
    }

    /// The outcomes of one simulation, drawn participant by participant.
    pub fn outcomes(&self, seed: u64, simulation: u32) -> Vec<f64> {
        let mut chance = Chance::new(seed, u64::from(simulation));
        let (mut last, mut intercept) = (None, 0.0);
        let one = |(participant, mean): (&usize, &f64)| {
            if last.replace(*participant) != Some(*participant) {
                intercept = self.participant_sd * chance.normal();
            }
            mean + intercept + self.residual_sd * chance.normal()
        };
        self.participants.iter().zip(&self.means).map(one).collect()
    }
}
