//! A way to understand an utterance.

use cohabit_cdf::{Action, GoToTarget};

use crate::{
    clause::Clause,
    context::Context,
    describe,
    intent::Intent,
    understanding::{Clarification, Step, Understanding},
};

/// A way to understand an utterance.
#[derive(Clone, Debug)]
pub(crate) struct Way {
    /// What it would mean.
    pub(crate) understanding: Understanding,
    /// How likely it is the one that is meant, from 0 to 1.
    pub(crate) probability: f32,
    /// The conversation after it.
    pub(crate) context: Context,
}

impl Way {
    /// Whether it comes to the same as another one.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        let is_same = match (&self.understanding, &other.understanding) {
            (Understanding::Plan { steps: one, .. }, Understanding::Plan { steps: other, .. }) => {
                deeds(one).eq(deeds(other))
            }
            (
                Understanding::Answer { text: one, highlight, .. },
                Understanding::Answer { text, highlight: other, .. },
            ) => highlight == other && without_yes_or_no(one) == without_yes_or_no(text),
            (one, other) => one == other,
        };
        let seeks_same = match (&self.context.search, &other.context.search) {
            (Some(one), Some(other)) => one.comes_to(other),
            (one, other) => one.is_none() == other.is_none(),
        };
        is_same && seeks_same && self.context.later == other.context.later
    }

    /// Whether something is to be done, told or known first, rather than that it was not understood or cannot be done.
    pub(crate) const fn is_understood(&self) -> bool {
        !matches!(
            self.understanding,
            Understanding::Refusal { .. }
                | Understanding::Question { kind: Clarification::Request | Clarification::Appearance, .. }
        )
    }

    /// Whether it does the same again.
    pub(crate) fn repeats(&self, before: &[Step]) -> bool {
        self.steps().is_some_and(|steps| !steps.is_empty() && deeds(steps).eq(deeds(before)))
    }

    pub(crate) const fn stops(&self) -> bool {
        matches!(self.understanding, Understanding::Stop { .. })
    }

    /// The steps that it would take.
    pub(crate) fn steps(&self) -> Option<&[Step]> {
        match &self.understanding {
            Understanding::Plan { steps, .. } => Some(steps),
            _ => None,
        }
    }

    /// Whether what it changes in the end is not simply put back.
    pub(crate) fn is_lasting(&self) -> bool {
        let is_lasting = |clause: &&Clause| {
            !matches!(
                clause.intent,
                Intent::Bring
                    | Intent::Close
                    | Intent::Drop
                    | Intent::Find
                    | Intent::GoTo
                    | Intent::Look
                    | Intent::Mention
                    | Intent::Open
                    | Intent::PickUp
                    | Intent::Place
                    | Intent::Travel
                    | Intent::Turn
            )
        };
        let is_sought = self.context.search.as_ref().is_some_and(|search| search.deeds().iter().any(is_lasting));
        is_sought || self.steps().is_some_and(|steps| steps.iter().any(Step::is_lasting))
    }
}

/// What these steps come to: who goes to a thing and then takes it, takes it.
fn deeds(steps: &[Step]) -> impl Iterator<Item = &Action> {
    let is_on_the_way = |at: usize| match steps[at].action {
        Action::GoTo { target: GoToTarget::Object(object) } => {
            steps[at + 1..].iter().any(|step| step.object() == Some(object))
        }
        _ => false,
    };
    (0..steps.len()).filter(move |at| !is_on_the_way(*at)).map(|at| &steps[at].action)
}

fn without_yes_or_no(text: &str) -> String {
    let rest = text.strip_prefix("Yes, ").or_else(|| text.strip_prefix("No, "));
    rest.map_or_else(|| text.to_owned(), describe::sentence)
}
