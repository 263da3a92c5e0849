//! A summary as people read it.

use std::fmt;

use super::{Effect, Group, Measure, Summary};
use crate::{
    columns::{Align, columns},
    effect::EffectSize,
    fit::{Fit, RandomIntercept, Term},
};

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (sessions, unit) = (self.sessions, self.unit);
        match self.participants {
            None => writeln!(
                f,
                "{sessions} sessions; means, and in brackets their 95 % intervals (of success Wilson's, else Student's)"
            )?,
            Some(count) => writeln!(
                f,
                "{sessions} sessions of {count} {unit}s; means of {unit}s' means, and in brackets their 95 % intervals\n\
                 (of success Wilson's where each has one session, else Student's)"
            )?,
        }
        write_groups(f, &self.groups)?;
        self.notes.iter().try_for_each(|note| writeln!(f, "{}", of_unit(note, unit)))?;
        if self.fits.is_empty() {
            return writeln!(
                f,
                "no setting differs between these sessions: there is nothing to fit (--by names conditions)"
            );
        }
        let model = if self.participants.is_some() {
            format!("linear mixed model (REML) with a random intercept per {unit}")
        } else {
            "least squares".to_owned()
        };
        writeln!(f, "\n{model}, each outcome on {}", self.conditions.join(" and "))?;
        self.fits.iter().try_for_each(|fit| write_fit(f, fit, unit))?;
        write_effects(f, &self.effects, unit)
    }
}

fn write_groups(f: &mut fmt::Formatter<'_>, groups: &[Group]) -> fmt::Result {
    let shown: Vec<&Measure> =
        groups.iter().take(1).flat_map(|all| &all.measures).filter(|measure| measure.mean.is_some()).collect();
    let mut rows = vec![vec![String::new(), "sessions".to_owned()]];
    rows[0].extend(shown.iter().map(|measure| with_unit(&measure.outcome, measure.unit)));
    for group in groups {
        let own = shown.iter().map(|wanted| {
            let measure = group.measures.iter().find(|measure| measure.outcome == wanted.outcome);
            measure.map_or_else(String::new, Measure::cell)
        });
        rows.push([group.label(), group.sessions.to_string()].into_iter().chain(own).collect());
    }
    f.write_str(&columns(&rows, Align::Right))
}

fn with_unit(name: &str, unit: &str) -> String {
    if unit.is_empty() { name.to_owned() } else { format!("{name} ({unit})") }
}

impl Group {
    fn label(&self) -> String {
        let pairs: Vec<String> = self.conditions.iter().map(|(name, value)| format!("{name} {value}")).collect();
        if pairs.is_empty() { "all".to_owned() } else { pairs.join(", ") }
    }
}

impl Measure {
    fn cell(&self) -> String {
        match (self.mean, self.interval_95) {
            (None, _) => "–".to_owned(),
            (Some(mean), None) => number(mean),
            (Some(mean), Some([low, high])) => format!("{} ({} – {})", number(mean), number(low), number(high)),
        }
    }
}

/// With as many digits as tell something, and no sign where these are all 0.
fn number(value: f64) -> String {
    let text = match value.abs() {
        size if size >= 100.0 => format!("{value:.0}"),
        size if size >= 10.0 => format!("{value:.1}"),
        _ => format!("{value:.2}"),
    };
    if text == "-0.00" { "0.00".to_owned() } else { text }
}

fn write_fit(f: &mut fmt::Formatter<'_>, fit: &Fit, unit: &str) -> fmt::Result {
    let explained = fit.r_squared.map_or_else(String::new, |share| format!(", R² {share:.2}"));
    writeln!(f, "\n{}: {} sessions{explained}", with_unit(&fit.outcome, fit.unit), fit.sessions)?;
    if let Some(reason) = &fit.reason {
        writeln!(f, "  not fitted: {}", of_unit(reason, unit))?;
        return write_notes(f, fit, unit);
    }
    let row = |term: &Term| {
        let [low, high] = term.interval_95.map(number);
        let test = term.t.filter(|_| fit.random_intercept.is_some());
        let t = test.map_or_else(String::new, |t| format!("t({:.1}) = {}", term.freedom, number(t)));
        vec![format!("  {}", term.name), number(term.estimate), format!("({low} – {high})"), t, p(term.p)]
    };
    let mut rows: Vec<Vec<String>> = fit.terms.iter().map(row).collect();
    if rows.iter().all(|row| row[3].is_empty()) {
        rows.iter_mut().for_each(|row| drop(row.remove(3)));
    }
    f.write_str(&columns(&rows, Align::Right))?;
    // The test of a single term is that of the term.
    for test in fit.tests.iter().filter(|test| test.freedom[0] > 1.0) {
        let [numerator, denominator] = test.freedom;
        writeln!(f, "  {}: F({numerator}, {denominator:.1}) = {}, {}", test.condition, number(test.f), p(test.p))?;
    }
    if let Some(random) = &fit.random_intercept {
        write_random_intercept(f, random, unit)?;
    }
    write_notes(f, fit, unit)
}

fn write_random_intercept(f: &mut fmt::Formatter<'_>, random: &RandomIntercept, unit: &str) -> fmt::Result {
    writeln!(
        f,
        "  {} {unit}s: standard deviation {} between them, {} within; intraclass correlation {:.2}",
        random.participants,
        number(random.standard_deviation),
        number(random.residual_standard_deviation),
        random.intraclass_correlation
    )?;
    let vary = [("within", &random.within), ("between", &random.between)];
    let vary: Vec<String> = vary
        .into_iter()
        .filter(|(_, names)| !names.is_empty())
        .map(|(how, names)| format!("{how} {unit}s: {}", names.join(", ")))
        .collect();
    writeln!(f, "  varies {}", vary.join("; "))
}

fn write_notes(f: &mut fmt::Formatter<'_>, fit: &Fit, unit: &str) -> fmt::Result {
    fit.notes.iter().try_for_each(|note| writeln!(f, "  {}", of_unit(note, unit)))?;
    if fit.left_out.is_empty() {
        return Ok(());
    }
    writeln!(f, "  not to be told apart from these: {}", fit.left_out.join("; "))
}

fn write_effects(f: &mut fmt::Formatter<'_>, effects: &[Effect], unit: &str) -> fmt::Result {
    if effects.is_empty() {
        return Ok(());
    }
    writeln!(f, "\neffect sizes, and in brackets their 95 % intervals")?;
    let used =
        |symbol: &str| effects.iter().flat_map(|effect| &effect.sizes).any(|size| size.measure.symbol() == symbol);
    for (symbol, meaning) in LEGEND.into_iter().filter(|(symbol, _)| used(symbol)) {
        writeln!(f, "  {symbol}: {}", of_unit(meaning, unit))?;
    }
    let row = |effect: &Effect| {
        let size = |size: &EffectSize| {
            let [low, high] = size.interval_95.map(number);
            format!("{} {} ({low} – {high})", size.measure.symbol(), number(size.value))
        };
        let mut sizes = effect.sizes.iter().map(size);
        let count = match effect.participants {
            [pairs, _] if effect.within => format!("n = {pairs}"),
            [level, reference] => format!("n = {level} + {reference}"),
        };
        let compared = format!("{} {}, not {}", effect.condition, effect.level, effect.reference);
        let [first, second] = [sizes.next(), sizes.next()].map(Option::unwrap_or_default);
        vec![format!("  {}", effect.outcome), compared, count, first, second]
    };
    f.write_str(&columns(&effects.iter().map(row).collect::<Vec<_>>(), Align::Right))
}

/// What the symbols of effect sizes mean.
const LEGEND: [(&str, &str); 4] = [
    ("g", "Hedges' g, between participants"),
    ("d_z", "within participants, by the standard deviation of their differences"),
    ("d_av", "within participants, by the mean variance of both levels; compares with g"),
    ("difference", "of shares, by Newcombe's intervals; Student's where a share is of several sessions"),
];

/// What is said of participants, said of those whose sessions are compared.
fn of_unit(text: &str, unit: &str) -> String {
    text.replace("participant", unit)
}

fn p(p: f64) -> String {
    if p < 0.001 { "p < 0.001".to_owned() } else { format!("p = {p:.3}") }
}
