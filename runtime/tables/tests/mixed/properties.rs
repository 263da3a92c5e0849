//! What holds of every design.

use std::collections::BTreeMap;

use cohabit_tables::{Fit, Observation};
use proptest::prelude::*;

const LEVELS: [&str; 3] = ["always", "never", "unsure"];

/// Sessions of participants, who each have some: (participant, level, value).
fn sessions() -> impl Strategy<Value = Vec<(usize, usize, f64)>> {
    let own = prop::collection::vec((0..LEVELS.len(), -10.0..10.0), 2..6);
    let everybody = prop::collection::vec((-10.0..10.0, own), 4..9);
    everybody.prop_map(|everybody| {
        let of = |(number, (intercept, own)): (usize, (f64, Vec<(usize, f64)>))| {
            own.into_iter().map(move |(level, value)| (number, level, intercept + value))
        };
        everybody.into_iter().enumerate().flat_map(of).collect()
    })
}

/// The fit of these sessions, whose participants bear these names.
fn fit(sessions: &[(usize, usize, f64)], name: impl Fn(usize) -> String, model: Model) -> Fit {
    let conditions = LEVELS.map(|level| BTreeMap::from([("ask".to_owned(), level.to_owned())]));
    let names: Vec<String> = sessions.iter().map(|(number, ..)| name(*number)).collect();
    let observed: Vec<Observation<'_>> = sessions
        .iter()
        .zip(&names)
        .map(|((_, level, value), participant)| Observation {
            value: *value,
            participant,
            conditions: &conditions[*level],
        })
        .collect();
    model("y", "", &["ask".to_owned()], &observed)
}

type Model = fn(&str, &'static str, &[String], &[Observation<'_>]) -> Fit;

fn plain(number: usize) -> String {
    format!("P{number:02}")
}

fn mixed(sessions: &[(usize, usize, f64)]) -> Fit {
    fit(sessions, plain, Fit::mixed)
}

fn close(found: f64, wanted: f64) -> Result<(), TestCaseError> {
    prop_assert!((found - wanted).abs() <= 1e-6 * wanted.abs().max(1.0), "{found} is not {wanted}");
    Ok(())
}

/// Both fits agree, where the values of the first are mapped as `y → factor y + shift` to be those of the second.
fn agree(first: &Fit, second: &Fit, factor: f64, shift: f64) -> Result<(), TestCaseError> {
    prop_assert_eq!(&first.reason, &second.reason);
    prop_assert_eq!(first.terms.len(), second.terms.len());
    for (place, (one, other)) in first.terms.iter().zip(&second.terms).enumerate() {
        close(other.estimate, factor * one.estimate + if place == 0 { shift } else { 0.0 })?;
        close(other.standard_error, factor.abs() * one.standard_error)?;
        close(other.freedom, one.freedom)?;
    }
    if let (Some(one), Some(other)) = (&first.random_intercept, &second.random_intercept) {
        close(other.standard_deviation, factor.abs() * one.standard_deviation)?;
        close(other.residual_standard_deviation, factor.abs() * one.residual_standard_deviation)?;
        close(other.intraclass_correlation, one.intraclass_correlation)?;
    }
    for (one, other) in first.tests.iter().zip(&second.tests) {
        close(other.f, one.f)?;
    }
    Ok(())
}

proptest! {
    #[test]
    fn a_shift_of_the_outcome_shifts_the_intercept_alone(sessions in sessions(), shift in -100.0..100.0) {
        let shifted: Vec<_> = sessions.iter().map(|(number, level, value)| (*number, *level, value + shift)).collect();
        agree(&mixed(&sessions), &mixed(&shifted), 1.0, shift)?;
    }

    #[test]
    fn a_scale_of_the_outcome_scales_all_but_tests(sessions in sessions(), factor in prop_oneof![-50.0..-0.1, 0.1..50.0]) {
        let scaled: Vec<_> = sessions.iter().map(|(number, level, value)| (*number, *level, value * factor)).collect();
        agree(&mixed(&sessions), &mixed(&scaled), factor, 0.0)?;
    }

    #[test]
    fn names_and_order_of_participants_do_not_matter(sessions in sessions(), turn in 0_usize..30) {
        let renamed = fit(&sessions, |number| format!("Q{:02}", 99 - number), Fit::mixed);
        agree(&mixed(&sessions), &renamed, 1.0, 0.0)?;
        let mut turned = sessions.clone();
        turned.rotate_left(turn % sessions.len());
        agree(&mixed(&sessions), &mixed(&turned), 1.0, 0.0)?;
    }

    #[test]
    fn without_variance_of_participants_it_is_least_squares(sessions in sessions()) {
        // Participants take turns, so that they are as alike as can be.
        let mut sorted = sessions;
        sorted.sort_by(|one, other| one.2.total_cmp(&other.2));
        let alike: Vec<_> = sorted.iter().enumerate().map(|(place, (_, level, value))| (place % 3, *level, *value)).collect();
        let found = mixed(&alike);
        let random = found.random_intercept.as_ref();
        prop_assume!(random.is_some_and(|random| random.standard_deviation == 0.0));
        let plain = fit(&alike, plain, Fit::least_squares);
        prop_assert_eq!(found.terms.len(), plain.terms.len());
        for (one, other) in found.terms.iter().zip(&plain.terms) {
            close(one.estimate, other.estimate)?;
            close(one.standard_error, other.standard_error)?;
            close(one.freedom, other.freedom)?;
            close(one.p, other.p)?;
        }
    }

    #[test]
    fn nothing_is_not_a_number(sessions in sessions()) {
        let found = mixed(&sessions);
        prop_assert!(found.reason.is_some() == found.terms.is_empty());
        for term in &found.terms {
            let [low, high] = term.interval_95;
            prop_assert!([term.estimate, term.standard_error, term.freedom, low, high].iter().all(|value| value.is_finite()));
            prop_assert!(term.standard_error > 0.0 && low < high && (0.0..=1.0).contains(&term.p) && term.freedom >= 1.0);
        }
        for test in &found.tests {
            prop_assert!(test.f >= 0.0 && (0.0..=1.0).contains(&test.p), "{test:?}");
        }
    }
}
