//! The power of a planned study, by simulation: how often the model would find an effect of a given size.
//!
//! Each simulated study draws participants' intercepts and residuals from normal distributions, fits the model that the
//! analysis fits ([`MixedModel`]), and counts as a find if the joint test of the condition has p below 5 %. Where each
//! participant has one session, this is the F test of least squares. Simulation `i` has a stream of random numbers of its own,
//! so results depend on the seed alone, not on the number of threads; and the first participants of a larger study are
//! those of a smaller one, so that power hardly wavers as the search of [`sample_size`] adds participants.
//!
//! ```
//! use cohabit_tables::power::{Design, Effect, Varies, power};
//!
//! // Three ask policies within participants, each met once; scores of 0 to 100.
//! let design = Design { varies: Varies::Within, levels: 3, sessions: 1 };
//! let effect = Effect { differences: vec![0.0, 8.0], participant_sd: 12.0, residual_sd: 10.0 };
//! let found = power(&design, &effect, 20, 200, 1)?;
//! assert!(found.power > 0.5 && found.standard_error < 0.04);
//! # Ok::<(), cohabit_tables::power::PowerError>(())
//! ```

mod simulate;

use std::{
    num::NonZero,
    sync::atomic::{AtomicU32, Ordering},
    thread,
};

use serde::Serialize;

use crate::{interval::wilson_95, mixed::MixedModel};
use simulate::Study;

/// A design with one condition.
#[derive(Clone, Copy, Debug, Eq, PartialEq, Serialize)]
pub struct Design {
    /// Whether each participant meets all levels, or one.
    pub varies: Varies,
    /// Levels of the condition, 2 or more.
    pub levels: usize,
    /// Sessions of each participant at each level that they meet, 1 or more.
    pub sessions: usize,
}

/// Where a condition varies.
#[derive(Clone, Copy, Debug, Eq, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Varies {
    /// Each participant meets all levels.
    Within,
    /// Each participant meets one level; levels are taken in turn.
    Between,
}

/// What is to be found, in the outcome's unit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Effect {
    /// How far the mean at each level but the first, its reference, is from the mean there.
    pub differences: Vec<f64>,
    /// Standard deviation of participants' intercepts, `σ_b`: 0 or more.
    pub participant_sd: f64,
    /// Standard deviation of residuals, σ: above 0.
    pub residual_sd: f64,
}

/// How often an effect is found.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Power {
    /// Participants of each simulated study.
    pub participants: usize,
    /// Simulated studies.
    pub simulations: u32,
    /// The share of them with p below 5 %.
    pub power: f64,
    /// Its Monte-Carlo standard error, √(power (1 − power) / simulations).
    pub standard_error: f64,
    /// Its 95 % interval, by Wilson's score: more than nothing also where the share is 0 or 1.
    pub interval_95: [f64; 2],
}

/// Why power cannot be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PowerError {
    /// There is nothing to compare.
    #[error(
        "a design needs 2 levels or more and 1 session or more at each: it has {levels} levels and {sessions} sessions"
    )]
    Design {
        /// Levels.
        levels: usize,
        /// Sessions at each.
        sessions: usize,
    },
    /// Levels and differences do not match.
    #[error("{levels} levels need {} differences from the first level: there are {differences}", levels - 1)]
    Differences {
        /// Levels.
        levels: usize,
        /// Differences given.
        differences: usize,
    },
    /// A number is no number, or of the wrong sign.
    #[error("{name} is {value}: it must be {allowed}")]
    Number {
        /// Which one.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it may be.
        allowed: &'static str,
    },
    /// No study is to be simulated.
    #[error("no simulation is asked for: 1000 give a standard error of 1.6 % or less")]
    NoSimulations,
    /// The model needs more participants.
    #[error("{participants} participants are too few for this design: it needs {least}")]
    TooFew {
        /// Participants asked for.
        participants: usize,
        /// The least number that the model can be fitted to.
        least: usize,
    },
    /// The search ended.
    #[error(
        "with {most} participants the power is {power:.2}, below the {wanted} wanted: allow more participants, or look for a larger effect"
    )]
    Unreached {
        /// The most participants that were allowed.
        most: usize,
        /// The power with them.
        power: f64,
        /// What was wanted.
        wanted: f64,
    },
}

/// The level of significance.
const ALPHA: f64 = 0.05;

impl Design {
    /// The least number of participants that the model can be fitted to: one more than levels where they vary between
    /// participants, else two.
    #[must_use]
    pub const fn least_participants(&self) -> usize {
        match self.varies {
            Varies::Within => 2,
            Varies::Between => self.levels + 1,
        }
    }

    /// Studies are balanced by steps of this many participants.
    const fn step(&self) -> usize {
        match self.varies {
            Varies::Within => 1,
            Varies::Between => self.levels,
        }
    }
}

/// The power of a design with so many participants, from so many simulated studies.
///
/// # Errors
/// [`PowerError`], but for [`PowerError::Unreached`].
pub fn power(
    design: &Design,
    effect: &Effect,
    participants: usize,
    simulations: u32,
    seed: u64,
) -> Result<Power, PowerError> {
    check(design, effect, simulations)?;
    let least = design.least_participants();
    if participants < least {
        return Err(PowerError::TooFew { participants, least });
    }
    let study = Study::new(design, effect, participants);
    let found = count(simulations, |simulation| is_found(&study, seed, simulation));
    let power = f64::from(found) / f64::from(simulations);
    Ok(Power {
        participants,
        simulations,
        power,
        standard_error: (power * (1.0 - power) / f64::from(simulations)).sqrt(),
        interval_95: wilson_95(found as usize, simulations as usize),
    })
}

/// The least number of participants, in balanced studies, whose power is `wanted` (0 to 1) or more, found by doubling and then
/// by halving what is left; at most `most`. All numbers are tried on the same random numbers; the result has the error of a
/// simulation all the same, so it is sure to about the participants that change the power by its standard error.
///
/// # Errors
/// [`PowerError`].
pub fn sample_size(
    design: &Design,
    effect: &Effect,
    wanted: f64,
    most: usize,
    simulations: u32,
    seed: u64,
) -> Result<Power, PowerError> {
    check(design, effect, simulations)?;
    if !(wanted > 0.0 && wanted < 1.0) {
        return Err(PowerError::Number { name: "the power", value: wanted, allowed: "above 0 and below 1" });
    }
    let step = design.step();
    let (least, most) = (design.least_participants().div_ceil(step), most / step);
    if most < least {
        return Err(PowerError::TooFew { participants: most * step, least: least * step });
    }
    let at = |steps: usize| power(design, effect, steps * step, simulations, seed);
    let mut enough = at(least)?;
    let (mut low, mut high) = (least, least);
    while enough.power < wanted {
        if high >= most {
            return Err(PowerError::Unreached { most: high * step, power: enough.power, wanted });
        }
        low = high;
        high = (high * 2).min(most);
        enough = at(high)?;
    }
    while high - low > 1 {
        let middle = usize::midpoint(low, high);
        let tried = at(middle)?;
        if tried.power < wanted {
            low = middle;
        } else {
            (high, enough) = (middle, tried);
        }
    }
    Ok(enough)
}

fn check(design: &Design, effect: &Effect, simulations: u32) -> Result<(), PowerError> {
    let Design { levels, sessions, .. } = *design;
    if levels < 2 || sessions < 1 {
        return Err(PowerError::Design { levels, sessions });
    }
    if effect.differences.len() != levels - 1 {
        return Err(PowerError::Differences { levels, differences: effect.differences.len() });
    }
    if let Some(value) = effect.differences.iter().copied().find(|value| !value.is_finite()) {
        return Err(PowerError::Number { name: "a difference", value, allowed: "a finite number" });
    }
    let (value, name) = (effect.participant_sd, "the standard deviation of participants");
    if !(value.is_finite() && value >= 0.0) {
        return Err(PowerError::Number { name, value, allowed: "0 or more" });
    }
    let (value, name) = (effect.residual_sd, "the standard deviation of residuals");
    if !(value.is_finite() && value > 0.0) {
        return Err(PowerError::Number { name, value, allowed: "above 0" });
    }
    if simulations == 0 { Err(PowerError::NoSimulations) } else { Ok(()) }
}

/// Whether the effect is found in a simulated study; a study that cannot be fitted finds nothing.
fn is_found(study: &Study, seed: u64, simulation: u32) -> bool {
    let outcomes = study.outcomes(seed, simulation);
    let fitted = MixedModel::fit(&study.columns, &outcomes, &study.participants);
    let test = fitted.ok().and_then(|model| model.test(&study.tested()));
    test.is_some_and(|test| test.p < ALPHA)
}

/// How many of these numbers it is true of, on all cores.
fn count(numbers: u32, is_true: impl Fn(u32) -> bool + Sync) -> u32 {
    let (next, count) = (AtomicU32::new(0), AtomicU32::new(0));
    let work = || {
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            if number >= numbers {
                return;
            }
            count.fetch_add(u32::from(is_true(number)), Ordering::Relaxed);
        }
    };
    thread::scope(|scope| {
        let threads = thread::available_parallelism().map_or(1, NonZero::get);
        (0..threads).for_each(|_| drop(scope.spawn(work)));
    });
    count.into_inner()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
