//! `cohabit study plan`: how many participants a study needs, by simulation.

use std::path::PathBuf;

use cohabit_study::{
    Cycle,
    design::{Block, Factor, FactorKind, Study},
};
use cohabit_tables::power::{Design, Effect, Power, Varies, power, sample_size};

use super::read;
use crate::{failure::bad_input, terminal::shown};

#[derive(clap::Args)]
pub struct Plan {
    /// The study's file (TOML), whose design is taken
    file: PathBuf,
    /// The factor whose effect is to be found; it may be left out of a study with one
    #[arg(long, value_name = "NAME")]
    factor: Option<String>,
    /// How far the mean of the outcome at each level but the first is from the mean there, in the outcome's unit, with commas
    /// between
    #[arg(long, value_name = "DIFFERENCES", value_delimiter = ',', allow_hyphen_values = true, required = true)]
    differences: Vec<f64>,
    /// How much participants differ, or in a study of pairs, how much pairs do: the standard deviation of their means, in the outcome's
    /// unit
    #[arg(long, value_name = "SD")]
    participant_sd: f64,
    /// How much the sessions of one participant, or pair, differ under the same condition: the standard deviation of residuals
    #[arg(long, value_name = "SD")]
    residual_sd: f64,
    /// The power that is wanted
    #[arg(long, default_value_t = 0.8, conflicts_with = "participants")]
    power: f64,
    /// Say what power so many participants, or pairs, have instead
    #[arg(long, value_name = "COUNT")]
    participants: Option<usize>,
    /// The most participants, or pairs, that can be had
    #[arg(long, value_name = "COUNT", default_value_t = 500)]
    most: usize,
    /// How many studies are simulated for each number of participants
    #[arg(long, value_name = "COUNT", default_value_t = 1000)]
    simulations: u32,
    /// The seed of the simulations
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

impl Plan {
    /// Tells it.
    pub fn run(&self) -> anyhow::Result<()> {
        let (_, study) = read(&self.file)?;
        let factor = self.factor(&study).map_err(bad_input)?;
        let design = design(&study, factor).map_err(|why| bad_input(format!("{}: {why}", self.file.display())))?;
        let Self { participant_sd, residual_sd, simulations, seed, .. } = *self;
        let effect = Effect { differences: self.differences.clone(), participant_sd, residual_sd };
        let found = match self.participants {
            Some(count) => power(&design, &effect, count, simulations, seed),
            None => sample_size(&design, &effect, self.power, self.most, simulations, seed),
        };
        tell(&study, factor, &design, &found.map_err(bad_input)?);
        Ok(())
    }

    fn factor<'a>(&self, study: &'a Study) -> Result<&'a Factor, String> {
        let known: Vec<&str> = study.factors.iter().map(|factor| factor.name.as_str()).collect();
        let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
        match (&self.factor, study.factors.as_slice()) {
            (Some(name), all) => {
                let found = all.iter().find(|factor| factor.name == *name);
                found.ok_or_else(|| format!("`--factor {name}`: the study's factors are {known}"))
            }
            (None, [one]) => Ok(one),
            (None, _) => Err(format!("say by `--factor` which one's effect is to be found: the study's are {known}")),
        }
    }
}

/// The design of one factor, the others being averaged over.
fn design(study: &Study, factor: &Factor) -> Result<Design, String> {
    let single = |block: &Block| match block {
        Block::Mission { is_practice: false, .. } => 1,
        Block::Missions(_) => study.missions.len(),
        _ => 0,
    };
    let sessions: usize = study.blocks.iter().map(single).sum();
    let (varies, sessions) = match factor.kind {
        FactorKind::Within => (Varies::Within, study.missions.len() / factor.levels.len()),
        FactorKind::Between | FactorKind::Own => (Varies::Between, sessions),
    };
    if sessions == 0 {
        return Err("no mission is played under the levels of this factor; add a block of missions".to_owned());
    }
    Ok(Design { varies, levels: factor.levels.len(), sessions })
}

fn tell(study: &Study, factor: &Factor, design: &Design, found: &Power) {
    let how = match design.varies {
        Varies::Within => "each meets all",
        Varies::Between => "each meets one",
    };
    let [low, high] = found.interval_95;
    // What both of a pair meet is the pair's.
    let is_own = factor.kind == FactorKind::Own;
    let (unit, size) = if is_own { ("participant", 1) } else { (study.unit(), study.session_size()) };
    println!(
        "{} {unit}s have a power of {:.3} (95 % interval {low:.3} to {high:.3}, {} simulated studies) to find the effect of `{}`: \
         {} levels, of which {how}, with {} {} at each",
        found.participants,
        found.power,
        found.simulations,
        shown(&factor.name),
        design.levels,
        design.sessions,
        if design.sessions == 1 { "session" } else { "sessions" }
    );
    println!("The study plans {}", study.participants / size);
    let participants = u32::try_from(found.participants).unwrap_or(u32::MAX).saturating_mul(size);
    if let (None, Some(note)) = (&study.minimisation, Cycle::of(study).note(participants)) {
        println!("note: {note}");
    }
}

#[cfg(test)]
mod tests {
    use cohabit_study::{design::Level, settings::Settings};

    use super::*;

    #[test]
    fn a_design_is_that_of_the_study() {
        let level = |name: &str| Level { name: name.to_owned(), settings: Settings::new() };
        let factor = |kind| Factor { name: "f".to_owned(), kind, levels: ["a", "b"].map(level).to_vec() };
        let mut study = Study { missions: vec![String::new(); 4], ..Study::default() };
        assert!(design(&study, &factor(FactorKind::Between)).is_err());
        study.blocks = vec![Block::Missions(cohabit_study::design::Missions::default())];
        let of = |kind| design(&study, &factor(kind));
        assert_eq!(of(FactorKind::Within), Ok(Design { varies: Varies::Within, levels: 2, sessions: 2 }));
        assert_eq!(of(FactorKind::Between), Ok(Design { varies: Varies::Between, levels: 2, sessions: 4 }));
    }
}
