//! How fast the robot was, by condition.

use std::collections::BTreeMap;

use cohabit_tables::{Cell, Table};

use super::{Known, rows};

/// Latencies of the table of turns, and what they are from somebody's words to.
const LATENCIES: [(&str, &str); 6] = [
    ("answered_ms", "first answer or question"),
    ("understood_ms", "plan"),
    ("moved_ms", "first motion"),
    ("shown_ms", "motion on the page"),
    ("heard_ms", "words, from the end of speech"),
    ("sounded_ms", "first sound of an answer"),
];

pub(super) fn section(known: &Known<'_>) -> String {
    if known.records.is_synthetic {
        return "Not measured: in a dry run the robot answers in simulated time.".to_owned();
    }
    let Some(turns) = known.table("turns").filter(|turns| !turns.rows.is_empty()) else {
        return "Nothing was said in any session yet, so latencies are **missing**.".to_owned();
    };
    let conditions = conditions(turns);
    let mut lines = Vec::new();
    for (column, what) in LATENCIES {
        let mut groups = BTreeMap::<&str, Vec<f64>>::new();
        for (condition, cell) in conditions.iter().zip(turns.column(column)) {
            if let Cell::Real(ms) = cell {
                groups.entry("all").or_default().push(*ms);
                if !condition.is_empty() {
                    groups.entry(condition).or_default().push(*ms);
                }
            }
        }
        lines.extend(groups.into_iter().map(|(condition, mut values)| {
            values.sort_by(f64::total_cmp);
            let ms = |share: f64| format!("{:.0} ms", quantile(&values, share));
            vec![what.to_owned(), condition.to_owned(), values.len().to_string(), ms(0.5), ms(0.95)]
        }));
    }
    format!(
        "Wall time from somebody's words, over turns in which it came about (from the sessions' logs):\n\n{}",
        rows(&["to", "condition", "turns", "median", "95th percentile"], lines)
    )
}

/// The condition of each row.
pub(super) fn conditions(turns: &Table) -> Vec<String> {
    let factors: Vec<(usize, &str)> = turns
        .fields
        .iter()
        .enumerate()
        .filter_map(|(column, field)| Some((column, field.name.strip_prefix("factor_")?)))
        .collect();
    let of_row = |row: &Vec<Cell>| {
        let level = |(column, factor): &(usize, &str)| match &row[*column] {
            Cell::Text(level) => Some(format!("{factor}={level}")),
            _ => None,
        };
        factors.iter().filter_map(level).collect::<Vec<_>>().join(" ")
    };
    turns.rows.iter().map(of_row).collect()
}

/// A quantile of values in order, between the two next to it (type 7 of Hyndman and Fan 1996).
pub(super) fn quantile(values: &[f64], share: f64) -> f64 {
    let at = share * (values.len() - 1) as f64;
    let (below, above) = (values[at.floor() as usize], values[at.ceil() as usize]);
    below + (above - below) * at.fract()
}
