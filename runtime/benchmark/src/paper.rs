//! What the paper on Alexa Arena reports, as data.

use std::collections::BTreeMap;

use serde::Deserialize;

/// The figures of the paper.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Paper {
    /// Where they are from.
    pub source: String,
    /// Why they cannot be compared with what is played here.
    pub caution: String,
    /// Of its vision model.
    pub vision: Vec<PaperVision>,
    /// Of its agents.
    #[serde(rename = "method")]
    pub methods: Vec<PaperMethod>,
}

/// The figures of its vision model for things of a size.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct PaperVision {
    /// The size.
    pub category: String,
    /// From and up to which area, px², of an image of 300x300.
    pub area_px2: [u32; 2],
    /// COCO's mean average precision, %.
    pub map: f64,
    /// The mean of precision over its thresholds of score and overlap, %.
    pub t_map: f64,
}

/// The figures of one of its agents, on its validation split.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct PaperMethod {
    /// The agent.
    pub name: String,
    /// Whether it had question-answer pairs.
    pub questions: bool,
    /// Mission success rate, %.
    pub msr: f64,
    /// Number of robot actions.
    pub nra: f64,
    /// Mission success rate by type of mission, %.
    pub types: BTreeMap<String, f64>,
}

impl Paper {
    /// The figures.
    ///
    /// # Panics
    /// Never: the tests read the same text.
    #[must_use]
    pub fn builtin() -> Self {
        toml::from_str(include_str!("../data/paper.toml")).expect("invariant: the figures of the paper are right")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_figures_are_whole() {
        let paper = Paper::builtin();
        assert_eq!((paper.vision.len(), paper.methods.len()), (4, 4));
        for method in &paper.methods {
            assert_eq!(method.types.len(), 12, "{}", method.name);
            let least = method.types.values().copied().fold(f64::INFINITY, f64::min);
            let most = method.types.values().copied().fold(0.0, f64::max);
            assert!((least..=most).contains(&method.msr), "{}", method.name);
        }
    }
}
