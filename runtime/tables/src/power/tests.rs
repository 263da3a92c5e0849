//! Power against what is known in closed form.

use super::*;

const PAIRED: Design = Design { varies: Varies::Within, levels: 2, sessions: 1 };

fn effect(differences: &[f64]) -> Effect {
    Effect { differences: differences.to_vec(), participant_sd: 1.0, residual_sd: std::f64::consts::FRAC_1_SQRT_2 }
}

/// The simulated power is within four standard errors of what is known.
fn check_power(design: &Design, effect: &Effect, participants: usize, known: f64) {
    let found = power(design, effect, participants, 800, 7).unwrap();
    let error = (known * (1.0 - known) / 800.0).sqrt();
    assert!((found.power - known).abs() < 4.0 * error, "{found:?} is not {known}");
}

#[test]
fn power_is_that_of_the_t_test() {
    // By the noncentral t and F distributions of scipy. Differences within participants have the standard deviation 1.
    check_power(&PAIRED, &effect(&[0.5]), 34, 0.8078);
    check_power(&PAIRED, &effect(&[0.0]), 20, 0.05);
    let between = Design { varies: Varies::Between, levels: 2, sessions: 1 };
    let apart = Effect { differences: vec![0.5], participant_sd: 0.6, residual_sd: 0.8 };
    check_power(&between, &apart, 128, 0.8015);
    let three = Design { varies: Varies::Within, levels: 3, sessions: 1 };
    let some = Effect { differences: vec![0.0, 0.8], participant_sd: 1.5, residual_sd: 1.0 };
    check_power(&three, &some, 24, THREE);
}

const THREE: f64 = 0.7979;

#[test]
fn results_depend_on_the_seed_alone() {
    let run = |seed| power(&PAIRED, &effect(&[0.5]), 12, 100, seed).unwrap();
    assert_eq!(run(1), run(1));
    assert!((1..5).any(|seed| run(seed) != run(0)));
}

#[test]
fn the_sample_is_large_enough_and_no_larger() {
    let found = sample_size(&PAIRED, &effect(&[0.8]), 0.8, 200, 300, 3).unwrap();
    // By the noncentral t distribution 15 pairs.
    assert!((12..=18).contains(&found.participants) && found.power >= 0.8, "{found:?}");
    let fewer = power(&PAIRED, &effect(&[0.8]), found.participants - 1, 300, 3).unwrap();
    assert!(fewer.power < 0.8, "{fewer:?}");
    let between = Design { varies: Varies::Between, levels: 3, sessions: 2 };
    let found = sample_size(&between, &effect(&[0.0, 3.0]), 0.9, 60, 50, 3).unwrap();
    assert_eq!(found.participants % 3, 0, "{found:?}");
}

#[test]
fn what_cannot_be_simulated_says_why() {
    let plan = |design: Design, effect: &Effect, participants, simulations| {
        power(&design, effect, participants, simulations, 1).unwrap_err().to_string()
    };
    let half = effect(&[0.5]);
    for (text, part) in [
        (plan(Design { levels: 1, ..PAIRED }, &half, 9, 9), "2 levels or more"),
        (plan(Design { levels: 3, ..PAIRED }, &half, 9, 9), "3 levels need 2 differences"),
        (plan(PAIRED, &effect(&[f64::NAN]), 9, 9), "a finite number"),
        (plan(PAIRED, &Effect { residual_sd: 0.0, ..half.clone() }, 9, 9), "above 0"),
        (plan(PAIRED, &Effect { participant_sd: -1.0, ..half.clone() }, 9, 9), "0 or more"),
        (plan(PAIRED, &half, 1, 9), "it needs 2"),
        (plan(PAIRED, &half, 9, 0), "no simulation"),
    ] {
        assert!(text.contains(part), "no `{part}` in {text}");
    }
    let unreached = sample_size(&PAIRED, &effect(&[0.01]), 0.8, 8, 20, 1).unwrap_err();
    assert!(matches!(unreached, PowerError::Unreached { most: 8, .. }), "{unreached:?}");
    let too_few = sample_size(&PAIRED, &half, 0.8, 1, 20, 1).unwrap_err();
    assert_eq!(too_few, PowerError::TooFew { participants: 1, least: 2 });
}
