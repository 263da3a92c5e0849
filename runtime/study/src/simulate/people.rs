//! How simulated people are: who leaves, how they speak, and what they answer under which condition.

use std::{fs, path::Path};

use serde::{Deserialize, Serialize};

use crate::design::Study;

/// How simulated people are. Shares are from 0 to 1. What a file leaves out is as here.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct People {
    /// Who leaves before the end.
    pub leaving: Leaving,
    /// How they speak.
    pub speaking: Speaking,
    /// What they answer.
    pub answering: Answering,
    /// What conditions do to their answers.
    #[serde(rename = "effect")]
    pub effects: Vec<Shift>,
}

/// Who leaves before the end.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Leaving {
    /// The share that does not consent; of these nothing is kept, and nobody comes in their place.
    pub declines: f64,
    /// The share that withdraws, at some step: their data are removed.
    pub withdraws: f64,
    /// The share that stops at some step, and does not come back.
    pub stops: f64,
    /// The share that the experimenter excludes at some step.
    pub excluded: f64,
    /// The share of missions that are given up halfway, and skipped, where that is allowed, or left until their time is up.
    pub gives_up: f64,
}

/// How they speak.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Speaking {
    /// The share of things that are named by their noun alone, though there are others of that name.
    pub vagueness: f64,
    /// The share of words that are mistyped.
    pub typos: f64,
    /// The share of descriptions that are wrong in one point.
    pub mistakes: f64,
    /// The share of goals that people ask for in their own words; others they ask for as the mission has them.
    pub own_words: f64,
    /// How long people think about a line and write it on average, s: it is part of the time that a mission takes.
    pub line_s: f64,
}

/// What they answer on scales. What a questionnaire measures is a part of the scale's length, from 0 to 1: the mean, and a
/// part of the participant's own, and what the conditions do, and a residual.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Answering {
    /// The mean.
    pub mean: f64,
    /// The standard deviation of participants, for each questionnaire.
    pub participant_sd: f64,
    /// The standard deviation of residuals, item by item.
    pub residual_sd: f64,
    /// The share of questions without an answer, of those that may be left out.
    pub omits: f64,
    /// The share of attention checks that are answered wrongly.
    pub careless: f64,
}

/// What a condition does to answers.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Shift {
    /// The factor.
    pub factor: String,
    /// Its level.
    pub level: String,
    /// The questionnaire; all, if absent.
    #[serde(default)]
    pub questionnaire: Option<String>,
    /// How much more of what the questionnaire measures, from -1 to 1 of the scale's length.
    pub shift: f64,
}

impl Default for Leaving {
    fn default() -> Self {
        Self { declines: 0.0, withdraws: 0.03, stops: 0.03, excluded: 0.0, gives_up: 0.1 }
    }
}

impl Default for Speaking {
    fn default() -> Self {
        Self { vagueness: 0.5, typos: 0.03, mistakes: 0.03, own_words: 0.5, line_s: 15.0 }
    }
}

impl Default for Answering {
    fn default() -> Self {
        Self { mean: 0.6, participant_sd: 0.12, residual_sd: 0.15, omits: 0.5, careless: 0.03 }
    }
}

/// Why people cannot be simulated.
#[derive(Debug, thiserror::Error)]
#[error("{file}: {reason}")]
pub struct PeopleError {
    file: String,
    reason: String,
}

impl People {
    /// Reads a file, for a study.
    ///
    /// # Errors
    /// [`PeopleError`], with what is wrong and what would be right.
    pub fn read(path: &Path, study: &Study) -> Result<Self, PeopleError> {
        let failed = |reason: String| PeopleError { file: path.display().to_string(), reason };
        let text = fs::read_to_string(path).map_err(|error| failed(error.to_string()))?;
        let people: Self = toml::from_str(&text).map_err(|error| failed(error.to_string().trim_end().to_owned()))?;
        people.check(study).map_err(failed)?;
        Ok(people)
    }

    fn check(&self, study: &Study) -> Result<(), String> {
        let Self { leaving, speaking, answering, effects } = self;
        let shares = [
            ("leaving.declines", leaving.declines),
            ("leaving.withdraws", leaving.withdraws),
            ("leaving.stops", leaving.stops),
            ("leaving.excluded", leaving.excluded),
            ("leaving.gives_up", leaving.gives_up),
            ("speaking.vagueness", speaking.vagueness),
            ("speaking.typos", speaking.typos),
            ("speaking.mistakes", speaking.mistakes),
            ("speaking.own_words", speaking.own_words),
            ("answering.mean", answering.mean),
            ("answering.participant_sd", answering.participant_sd),
            ("answering.residual_sd", answering.residual_sd),
            ("answering.omits", answering.omits),
            ("answering.careless", answering.careless),
        ];
        let is_share = |value: f64| (0.0..=1.0).contains(&value);
        if let Some((name, value)) = shares.into_iter().find(|(_, value)| !is_share(*value)) {
            return Err(format!("{name} is {value}: write a share from 0 to 1"));
        }
        let gone = leaving.withdraws + leaving.stops + leaving.excluded;
        if gone > 1.0 {
            return Err(format!("withdraws, stops and excluded are {gone} together: at most 1, since one leaves once"));
        }
        if !(speaking.line_s.is_finite() && speaking.line_s >= 0.0) {
            return Err(format!("speaking.line_s is {}: write seconds, 0 or more", speaking.line_s));
        }
        effects.iter().try_for_each(|effect| effect.check(study))
    }
}

impl Shift {
    fn check(&self, study: &Study) -> Result<(), String> {
        let Self { factor, level, questionnaire, shift } = self;
        if !(-1.0..=1.0).contains(shift) {
            return Err(format!("an effect of {shift}: write a part of the scale's length, from -1 to 1"));
        }
        let found = study.factors.iter().find(|one| one.name == *factor);
        let Some(found) = found else {
            let known: Vec<&str> = study.factors.iter().map(|one| one.name.as_str()).collect();
            return Err(format!("an effect of the factor `{factor}`: the study's are {}", listed(&known)));
        };
        if !found.levels.iter().any(|one| one.name == *level) {
            let known: Vec<&str> = found.levels.iter().map(|one| one.name.as_str()).collect();
            return Err(format!("an effect of the level `{level}` of `{factor}`: its levels are {}", listed(&known)));
        }
        match questionnaire {
            Some(name) if study.questionnaire(name).is_none() => {
                let known: Vec<&str> = study.questionnaires.iter().map(|one| one.name.as_str()).collect();
                Err(format!("an effect on the questionnaire `{name}`: the study's are {}", listed(&known)))
            }
            _ => Ok(()),
        }
    }
}

fn listed(names: &[&str]) -> String {
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::{
        design::{Factor, FactorKind, Level},
        scratch::Scratch,
        settings::Settings,
    };

    #[test]
    fn what_is_wrong_with_people_is_said() {
        let level = |name: &str| Level { name: name.to_owned(), settings: Settings::new() };
        let factor = Factor { name: "ask".to_owned(), kind: FactorKind::Within, levels: vec![level("never")] };
        let study = Study { factors: vec![factor], ..Study::default() };
        let scratch = Scratch::new("people");
        let read = |text: &str| People::read(&scratch.write("people.toml", text), &study);
        assert_eq!(read("").unwrap(), People::default());
        let shift = "[[effect]]\nfactor = \"ask\"\nlevel = \"never\"\nshift = -0.2\n";
        assert_eq!(read(shift).unwrap().effects[0].shift, -0.2);
        for (text, part) in [
            ("[leaving]\nstop = 1\n", "unknown field `stop`"),
            ("[leaving]\nstops = 2\n", "leaving.stops is 2: write a share"),
            ("[leaving]\nstops = 0.7\nexcluded = 0.7\n", "at most 1"),
            ("[speaking]\nline_s = -1\n", "0 or more"),
            ("[[effect]]\nfactor = \"x\"\nlevel = \"never\"\nshift = 0.1\n", "the study's are ask"),
            ("[[effect]]\nfactor = \"ask\"\nlevel = \"x\"\nshift = 0.1\n", "its levels are never"),
            (&format!("{shift}questionnaire = \"sus\"\n"), "the study's are none"),
            ("[[effect]]\nfactor = \"ask\"\nlevel = \"never\"\nshift = 3\n", "from -1 to 1"),
        ] {
            let said = read(text).unwrap_err().to_string();
            assert!(said.contains(part) && said.contains("people.toml"), "no `{part}` in {said}");
        }
    }
}
