//! A summary as people read it.

use std::fmt;

use super::{Group, Measure, Summary};
use crate::fit::Fit;

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{} sessions; means, and in brackets their 95 % intervals (of success Wilson's, else Student's)",
            self.sessions
        )?;
        let labels: Vec<String> = self.groups.iter().map(Group::label).collect();
        let shown: Vec<&Measure> = self.groups[0].measures.iter().filter(|measure| measure.mean.is_some()).collect();
        let mut rows = vec![vec![String::new(), "sessions".to_owned()]];
        rows[0].extend(shown.iter().map(|measure| with_unit(&measure.outcome, measure.unit)));
        for (group, label) in self.groups.iter().zip(labels) {
            let own = shown.iter().map(|wanted| {
                let measure = group.measures.iter().find(|measure| measure.outcome == wanted.outcome);
                measure.map_or_else(String::new, Measure::cell)
            });
            rows.push([label, group.sessions.to_string()].into_iter().chain(own).collect());
        }
        write_rows(f, &rows)?;
        if self.fits.is_empty() {
            return writeln!(
                f,
                "no setting differs between these sessions: there is nothing to fit (--by names conditions)"
            );
        }
        writeln!(f, "\nleast squares, each outcome on {}", self.conditions.join(" and "))?;
        self.fits.iter().try_for_each(|fit| write_fit(f, fit))
    }
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

/// With as many digits as tell something.
fn number(value: f64) -> String {
    match value.abs() {
        size if size >= 100.0 => format!("{value:.0}"),
        size if size >= 10.0 => format!("{value:.1}"),
        _ => format!("{value:.2}"),
    }
}

fn write_fit(f: &mut fmt::Formatter<'_>, fit: &Fit) -> fmt::Result {
    let explained = fit.r_squared.map_or_else(String::new, |share| format!(", R² {share:.2}"));
    writeln!(f, "\n{}: {} sessions{explained}", with_unit(&fit.outcome, fit.unit), fit.sessions)?;
    if let Some(reason) = &fit.reason {
        return writeln!(f, "  not fitted: {reason}");
    }
    let row = |term: &crate::fit::Term| {
        let [low, high] = term.interval_95.map(number);
        vec![format!("  {}", term.name), number(term.estimate), format!("({low} – {high})"), p(term.p)]
    };
    write_rows(f, &fit.terms.iter().map(row).collect::<Vec<_>>())?;
    if fit.left_out.is_empty() {
        return Ok(());
    }
    writeln!(f, "  not to be told apart from these: {}", fit.left_out.join("; "))
}

fn p(p: f64) -> String {
    if p < 0.001 { "p < 0.001".to_owned() } else { format!("p = {p:.3}") }
}

/// Columns as wide as their widest cell: the first to the left, the others to the right.
fn write_rows(f: &mut fmt::Formatter<'_>, rows: &[Vec<String>]) -> fmt::Result {
    let columns = rows.first().map_or(0, Vec::len);
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    for row in rows {
        write!(f, "{:<width$}", row[0], width = widths[0])?;
        for (cell, width) in row.iter().zip(&widths).skip(1) {
            write!(f, "  {cell:>width$}")?;
        }
        writeln!(f)?;
    }
    Ok(())
}
