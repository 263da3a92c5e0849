//! Summaries of sessions that are made up.

use super::{Summary, compared::Compared, outcomes::Outcome};
use crate::{design::Conditions, effect::Measure};

/// Questions and success of nine participants with a wizard or without, under three ask policies each.
const QUESTIONS: [[u32; 3]; 9] =
    [[9, 4, 6], [7, 2, 5], [12, 7, 7], [8, 5, 4], [10, 3, 8], [6, 3, 3], [11, 8, 9], [9, 5, 7], [7, 1, 4]];
const SUCCESS: [[u32; 3]; 9] =
    [[1, 0, 1], [1, 0, 1], [1, 1, 1], [0, 0, 1], [1, 0, 1], [1, 1, 1], [1, 0, 0], [1, 0, 1], [1, 1, 1]];
const ASK: [&str; 3] = ["always", "never", "unsure"];

fn outcome(name: &str, is_share: bool, values: impl Iterator<Item = f64>) -> Outcome {
    let (name, field, meaning) = (name.to_owned(), name.to_owned(), String::new());
    Outcome { name, field, unit: "", meaning, is_share, values: values.map(Some).collect() }
}

/// All these sessions, which bear their participant's name or not.
fn compared(by: &[&str], is_named: impl Fn(usize) -> bool) -> Compared {
    let sessions = || (0..QUESTIONS.len()).flat_map(|who| (0..ASK.len()).map(move |ask| (who, ask)));
    let conditions = |(who, ask): (usize, usize)| {
        let (wizard, participant) = (if who % 2 == 0 { "no" } else { "yes" }, who.to_string());
        let own = [("ask", ASK[ask]), ("wizard", wizard), ("participant", &participant)];
        Conditions::from(own.map(|(name, level)| (name.to_owned(), level.to_owned())))
    };
    let names: Vec<String> = sessions().map(|(who, ask)| format!("s{who}{ask}")).collect();
    let participants =
        sessions().zip(&names).map(|((who, _), name)| (is_named(who).then(|| format!("P{who:02}")), name.as_str()));
    let values = |table: &'static [[u32; 3]; 9]| sessions().map(|(who, ask)| f64::from(table[who][ask]));
    let outcomes = vec![outcome("success", true, values(&SUCCESS)), outcome("questions", false, values(&QUESTIONS))];
    let by: Vec<String> = by.iter().map(|name| (*name).to_owned()).collect();
    Compared::of(sessions().map(conditions).collect(), participants.collect(), outcomes, &by).unwrap()
}

fn check_text(summary: &Summary, parts: &[&str]) {
    let text = summary.to_string();
    for part in parts {
        assert!(text.contains(part), "`{part}` is not in\n{text}");
    }
    assert!(text.lines().all(|line| line == line.trim_end()), "blanks at the end of lines of\n{text}");
}

#[test]
fn sessions_of_participants_are_repeated_measures() {
    let summary = Summary::of(&compared(&["ask", "wizard"], |_| true));
    assert_eq!((summary.sessions, summary.participants), (27, Some(9)));
    let random = summary.fits[1].random_intercept.as_ref().unwrap();
    assert_eq!((&random.within, &random.between), (&vec!["ask".to_owned()], &vec!["wizard".to_owned()]));
    check_text(
        &summary,
        &[
            "27 sessions of 9 participants; means of participants' means",
            "all                           27  0.70 (0.50 – 0.90)  6.30 (4.82 – 7.77)",
            "linear mixed model (REML) with a random intercept per participant, each outcome on ask and wizard",
            "  ask never, not always   -4.56  (-5.61 – -3.50)  t(16.0) = -9.19  p < 0.001",
            "  wizard yes, not no      -1.73   (-4.59 – 1.13)   t(7.0) = -1.43  p = 0.195",
            "  ask: F(2, 16.0) = 43.2, p < 0.001",
            "  9 participants: standard deviation 1.70 between them, 1.05 within; intraclass correlation 0.72",
            "  varies within participants: ask; between participants: wizard",
            "  d_av: within participants, by the mean variance of both levels; compares with g",
            "n = 9         d_z -3.20 (-4.86 – -1.52)  d_av -2.13 (-3.23 – -1.01)",
            "n = 4 + 5            g -0.85 (-2.34 – 0.47)",
        ],
    );
}

#[test]
fn binary_outcomes_have_differences_of_shares() {
    let summary = Summary::of(&compared(&["ask", "wizard"], |_| true));
    let of = |condition: &str, level: &str| {
        let is_it = |effect: &&super::Effect| {
            (effect.outcome.as_str(), effect.condition.as_str(), effect.level.as_str()) == ("success", condition, level)
        };
        summary.effects.iter().find(is_it).unwrap()
    };
    // One session each at a level of ask, three at a level of wizard.
    let never = of("ask", "never");
    assert!(never.within && never.reference == "always");
    assert_eq!(never.sizes[0].measure, Measure::ShareDifference);
    let wizard = of("wizard", "yes");
    assert!(!wizard.within);
    assert_eq!((wizard.participants, wizard.sizes[0].measure), ([4, 5], Measure::MeanShareDifference));
}

#[test]
fn interactions_are_fitted_when_asked_for() {
    let summary = Summary::of(&compared(&["ask:wizard"], |_| true));
    assert_eq!(summary.conditions, ["ask", "wizard"]);
    let names: Vec<&str> = summary.fits[1].terms.iter().map(|term| term.name.as_str()).collect();
    assert_eq!(
        names[4..],
        ["ask never, not always × wizard yes, not no", "ask unsure, not always × wizard yes, not no"]
    );
    let tested: Vec<&str> = summary.fits[1].tests.iter().map(|test| test.condition.as_str()).collect();
    assert_eq!(tested, ["ask:wizard"]);
}

#[test]
fn without_names_sessions_are_observations_of_their_own() {
    let summary = Summary::of(&compared(&["ask"], |_| false));
    assert!(summary.participants.is_none() && summary.fits.iter().all(|fit| fit.random_intercept.is_none()));
    check_text(
        &summary,
        &["27 sessions; means, and in", "least squares, each outcome on ask", "n = 9 + 9", "g: Hedges' g"],
    );
    // So they are where participants are themselves what is compared.
    assert!(Summary::of(&compared(&["ask", "participant"], |_| true)).participants.is_none());
}

#[test]
fn sessions_without_a_name_among_others_are_told() {
    let summary = Summary::of(&compared(&["ask"], |who| who > 0));
    assert_eq!(summary.participants, Some(11));
    check_text(&summary, &["3 sessions name no participant: each counts as one of its own"]);
}

#[test]
fn shares_that_are_alike_have_an_interval_all_the_same() {
    let mut compared = compared(&["ask"], |_| true);
    compared.outcomes[0].values.fill(Some(0.0));
    let [low, high] = Summary::of(&compared).groups[0].measures[0].interval_95.unwrap();
    // Wilson's of none of nine participants.
    assert!(low == 0.0 && (high - 0.2991).abs() < 1e-4, "{low} {high}");
}

#[test]
fn sessions_of_pairs_are_the_pairs() {
    let pairs = Compared { unit: "pair", ..compared(&["ask", "wizard"], |_| true) };
    let summary = Summary::of(&pairs);
    check_text(
        &summary,
        &[
            "27 sessions of 9 pairs; means of pairs' means",
            "linear mixed model (REML) with a random intercept per pair, each outcome on ask and wizard",
            "  9 pairs: standard deviation 1.70 between them",
            "  varies within pairs: ask; between pairs: wizard",
            "  d_av: within pairs, by the mean variance of both levels",
        ],
    );
    assert!(!summary.to_string().contains("participant"), "{summary}");
}
