//! Plans as planners write them: an action a line.

use cohabit_cdf::ActionKind;

use super::sexpr::{Sexpr, SexprError};

/// The actions of the domain that no body does.
const NOBODY_DOES: [&str; 3] = ["meet", "work", "rest"];

/// One action of a plan.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct PlanLine {
    /// Its line in the file, from 1.
    pub line: usize,
    /// The kind of action.
    pub kind: ActionKind,
    /// What it is about, as the domain calls it.
    pub thing: String,
}

/// Why a plan cannot be read.
#[derive(Clone, Debug, thiserror::Error, Eq, PartialEq)]
pub enum PlanFileError {
    /// Brackets do not match.
    #[error(transparent)]
    Brackets(#[from] SexprError),
    /// A line is no action of the domain.
    #[error(
        "line {line}: `{found}` is no action; write (KIND-THING-NUMBER), or (KIND THING), such as (pick_up bowl_01_1)"
    )]
    NoAction {
        /// Where, from 1.
        line: usize,
        /// What stands there.
        found: String,
    },
    /// There is nothing in it.
    #[error("there is no action in it; a plan has an action a line, such as (pick_up bowl_01_1)")]
    Empty,
}

/// Reads a plan that was found for exported files, or that somebody wrote: `(pick_up bowl_01_1)` is understood as well as
/// `(pick_up-bowl_01_1-12)`. Actions that no body does are left out.
///
/// # Errors
/// [`PlanFileError`].
pub fn read_plan(text: &str) -> Result<Vec<PlanLine>, PlanFileError> {
    let mut plan = Vec::new();
    let mut is_empty = true;
    for expression in Sexpr::read(text)? {
        is_empty = false;
        let words: Vec<String> = words(&expression);
        if words.first().is_some_and(|word| NOBODY_DOES.contains(&word.as_str())) {
            continue;
        }
        let (Sexpr::Word(_, line) | Sexpr::List(_, line)) = expression;
        match action(&words) {
            Some((kind, thing)) => plan.push(PlanLine { line, kind, thing }),
            None => return Err(PlanFileError::NoAction { line, found: words.join(" ") }),
        }
    }
    if is_empty { Err(PlanFileError::Empty) } else { Ok(plan) }
}

/// The parts of an action: its words, parted at hyphens.
fn words(expression: &Sexpr) -> Vec<String> {
    let all = if let Sexpr::Word(..) = expression { std::slice::from_ref(expression) } else { expression.list() };
    all.iter().filter_map(Sexpr::word).flat_map(|word| word.split('-')).map(str::to_owned).collect()
}

fn action(words: &[String]) -> Option<(ActionKind, String)> {
    let [kind, thing, ..] = words else { return None };
    let kind = ActionKind::ALL.into_iter().find(|one| one.name() == kind)?;
    Some((kind, thing.clone()))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn plans_are_read_as_planners_and_people_write_them() {
        let text =
            "(pick_up-bowl_01_1-12)\n(meet-0)\n(work-7)\n; cost = 3 (unit cost)\n(Place TableRound_02_1)\n(rest-7)\n";
        let plan = read_plan(text).unwrap();
        let found: Vec<_> = plan.iter().map(|one| (one.line, one.kind, one.thing.as_str())).collect();
        let expected = [(1, ActionKind::PickUp, "bowl_01_1"), (5, ActionKind::Place, "tableround_02_1")];
        assert_eq!(found, expected);
    }

    #[test]
    fn what_is_no_plan_is_named() {
        for (text, expected) in [
            ("(pick_up-bowl_01_1-12)\n(fly moon)", "line 2: `fly moon` is no action"),
            ("(pick_up", "line 1: this bracket is never closed"),
            ("; nothing\n", "there is no action in it"),
            ("(open)", "line 1: `open` is no action"),
            ("(pick_up bowl_01_1)\nopen fridge", "line 2: `open` is no action; write (KIND-THING-NUMBER)"),
        ] {
            let error = read_plan(text).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
    }
}
