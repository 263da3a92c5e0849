//! The design matrix of a linear model: an intercept, treatment-coded factors, numeric covariates and interactions.
//!
//! Knows nothing of outcomes, participants or estimation.

use std::collections::BTreeMap;

/// What each condition is in one session.
pub(crate) type Conditions = BTreeMap<String, String>;

/// Joins the conditions of an interaction: `ask:agent`.
pub(crate) const INTERACTION: char = ':';

/// A column of the design matrix.
#[derive(Clone, Debug)]
pub(crate) struct Column {
    /// The condition or interaction it codes, by its place in the list; `None` of the intercept.
    pub condition: Option<usize>,
    /// What it stands for: `ask unsure, not never`.
    pub name: String,
    /// Its value in each observation.
    pub values: Vec<f64>,
}

/// The columns of full rank, and what had to be left out for that.
#[derive(Clone, Debug)]
pub(crate) struct Design {
    /// Linearly independent columns, the intercept first.
    pub columns: Vec<Column>,
    /// The names of columns that are linear combinations of those before them.
    pub left_out: Vec<String>,
}

/// A column counts as a combination of those before it if no more than this share of its length is left beside them.
const RANK_TOLERANCE: f64 = 1e-8;

impl Design {
    /// The design of observations under these conditions. A condition that is a number with more than two values is one
    /// column of them; each other one has a column for every level but the commonest, its reference (treatment coding).
    /// An interaction `a:b` has the products of the columns of `a` and `b`.
    pub fn new(conditions: &[String], observed: &[&Conditions]) -> Self {
        let ones =
            Column { condition: None, name: "(at the references)".to_owned(), values: vec![1.0; observed.len()] };
        let coded = conditions.iter().enumerate().flat_map(|(place, name)| {
            let columns = match parts(name, observed) {
                Some(parts) => parts.iter().map(|part| code(part, observed)).reduce(products).unwrap_or_default(),
                None => code(name, observed),
            };
            columns.into_iter().map(move |(name, values)| Column { condition: Some(place), name, values })
        });
        independent(std::iter::once(ones).chain(coded).collect())
    }

    /// The places of the columns that code this condition.
    pub fn columns_of(&self, condition: usize) -> Vec<usize> {
        let own = |(_, column): &(usize, &Column)| column.condition == Some(condition);
        self.columns.iter().enumerate().filter(own).map(|(place, _)| place).collect()
    }
}

/// A column's name and values.
type Coded = (String, Vec<f64>);

/// The conditions that interact, if the name is that of an interaction.
pub(crate) fn parts<'a>(name: &'a str, observed: &[&Conditions]) -> Option<Vec<&'a str>> {
    let is_condition = observed.iter().any(|own| own.contains_key(name));
    (!is_condition && name.contains(INTERACTION)).then(|| name.split(INTERACTION).collect())
}

/// What a session's condition is; a dash where it is not noted.
pub(crate) fn level<'a>(conditions: &'a Conditions, name: &str) -> &'a str {
    conditions.get(name).map_or("–", String::as_str)
}

/// The levels of a condition and the number of observations of each.
pub(crate) fn levels<'a>(condition: &str, observed: &[&'a Conditions]) -> BTreeMap<&'a str, usize> {
    let mut counts = BTreeMap::new();
    for own in observed {
        *counts.entry(level(own, condition)).or_default() += 1;
    }
    counts
}

/// The commonest level, of several the first in the alphabet.
pub(crate) fn reference<'a>(levels: &BTreeMap<&'a str, usize>) -> &'a str {
    let most = levels.values().copied().max().unwrap_or(0);
    levels.iter().find(|(_, count)| **count == most).map_or("", |(level, _)| level)
}

/// The values of a condition that counts as a number.
pub(crate) fn numbers(condition: &str, observed: &[&Conditions]) -> Option<Vec<f64>> {
    let finite = |own: &&Conditions| level(own, condition).parse().ok().filter(|number: &f64| number.is_finite());
    let numbers: Option<Vec<f64>> = observed.iter().map(finite).collect();
    numbers.filter(|_| levels(condition, observed).len() > 2)
}

fn code(condition: &str, observed: &[&Conditions]) -> Vec<Coded> {
    if let Some(numbers) = numbers(condition, observed) {
        return vec![(format!("{condition}, per 1"), numbers)];
    }
    let levels = levels(condition, observed);
    let reference = reference(&levels);
    let others = levels.keys().filter(|level| **level != reference);
    others
        .map(|other| {
            let is_other = |own: &&Conditions| f64::from(u8::from(level(own, condition) == *other));
            (format!("{condition} {other}, not {reference}"), observed.iter().map(is_other).collect())
        })
        .collect()
}

fn products(left: Vec<Coded>, right: Vec<Coded>) -> Vec<Coded> {
    let product = |(a, b): (&Coded, &Coded)| {
        let values = a.1.iter().zip(&b.1).map(|(a, b)| a * b).collect();
        (format!("{} × {}", a.0, b.0), values)
    };
    left.iter().flat_map(|a| right.iter().map(move |b| product((a, b)))).collect()
}

/// Keeps the columns that are no combinations of those before them (modified Gram–Schmidt).
fn independent(columns: Vec<Column>) -> Design {
    let (mut kept, mut left_out, mut basis) = (Vec::new(), Vec::new(), Vec::<Vec<f64>>::new());
    for column in columns {
        let mut rest = column.values.clone();
        for direction in &basis {
            let along: f64 = rest.iter().zip(direction).map(|(a, b)| a * b).sum();
            rest.iter_mut().zip(direction).for_each(|(value, direction)| *value -= along * direction);
        }
        let (whole, new) = (norm(&column.values), norm(&rest));
        if new > RANK_TOLERANCE * whole {
            basis.push(rest.into_iter().map(|value| value / new).collect());
            kept.push(column);
        } else {
            left_out.push(column.name);
        }
    }
    Design { columns: kept, left_out }
}

/// The Euclidean norm.
pub(crate) fn norm(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum::<f64>().sqrt()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn check(conditions: &[&str], observed: &[&[(&str, &str)]], columns: &[&str], left_out: &[&str]) -> Design {
        let own: Vec<Conditions> = observed
            .iter()
            .map(|pairs| pairs.iter().map(|(name, level)| ((*name).to_owned(), (*level).to_owned())).collect())
            .collect();
        let names: Vec<String> = conditions.iter().map(|name| (*name).to_owned()).collect();
        let design = Design::new(&names, &own.iter().collect::<Vec<_>>());
        assert_eq!(design.columns.iter().skip(1).map(|column| column.name.as_str()).collect::<Vec<_>>(), columns);
        assert_eq!(design.left_out, left_out);
        design
    }

    #[test]
    fn the_commonest_level_is_the_reference_and_numbers_are_slopes() {
        let ask = [[("ask", "b")], [("ask", "a")], [("ask", "b")]];
        check(&["ask"], &ask.each_ref().map(|own| &own[..]), &["ask a, not b"], &[]);
        let delay = [[("delay", "0")], [("delay", "0.5")], [("delay", "2")]];
        let design = check(&["delay"], &delay.each_ref().map(|own| &own[..]), &["delay, per 1"], &[]);
        assert_eq!(design.columns[1].values, [0.0, 0.5, 2.0]);
    }

    #[test]
    fn interactions_are_products_and_empty_cells_are_left_out() {
        let cells = [("a", "c"), ("a", "d"), ("b", "c"), ("b", "d")].map(|(one, two)| [("one", one), ("two", two)]);
        let all = cells.each_ref().map(|own| &own[..]);
        let names = ["one b, not a", "two d, not c", "one b, not a × two d, not c"];
        let design = check(&["one", "two", "one:two"], &all, &names, &[]);
        assert_eq!(design.columns[3].values, [0.0, 0.0, 0.0, 1.0]);
        assert_eq!(design.columns_of(2), [3]);
        check(&["one", "two", "one:two"], &all[..3], &names[..2], &names[2..]);
    }
}
