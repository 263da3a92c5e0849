//! A way to understand an utterance.

use cohabit_cdf::{Action, GoToTarget, Verb};

use crate::{
    context::{Context, Pending, search::Search},
    read::clause::Clause,
    say::reply,
    understanding::{Clarification, Step, Understanding},
    words::{intent::Intent, prose},
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
        // Where one looks for a thing may differ by what was said of where it is.
        let is_same = match (&self.understanding, &other.understanding) {
            (Understanding::Plan { .. }, Understanding::Plan { .. }) if self.looks() && other.looks() => true,
            (Understanding::Plan { steps: one, .. }, Understanding::Plan { steps: other, .. }) => {
                let (own, others) = (outcome(one), outcome(other));
                deeds(one).eq(deeds(other)) || !own.is_empty() && own == others && !self.context.later.is_empty()
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
        is_same && seeks_same && self.does_the_same_later(other)
    }

    /// Whether both do the same afterwards; what they then answer may differ, as a question that was meant otherwise does no harm.
    fn does_the_same_later(&self, other: &Self) -> bool {
        let deeds = |way: &Self| -> Vec<String> {
            way.context.later.iter().filter(|text| !text.ends_with('?')).cloned().collect()
        };
        self.context.later.is_empty() == other.context.later.is_empty() && deeds(self) == deeds(other)
    }

    /// Whether it begins by looking for something.
    fn looks(&self) -> bool {
        self.context.search.as_ref().is_some_and(Search::is_under_way)
    }

    /// Whether something is to be done, told or known first, rather than that it was not understood or cannot be done.
    pub(crate) const fn is_understood(&self) -> bool {
        !matches!(
            self.understanding,
            Understanding::Refusal { .. }
                | Understanding::Question { kind: Clarification::Request | Clarification::Appearance, .. }
        )
    }

    /// Whether the robot has just asked whether to do this.
    pub(crate) fn is_asked_about(&self, context: &Context) -> bool {
        let (Some(Pending::Guess { guesses }), Some(steps)) = (&context.pending, self.steps()) else { return false };
        guesses.iter().any(|guess| match (&guess.search, &self.context.search) {
            (Some(one), Some(other)) => one.comes_to(other),
            (None, None) => deeds(&guess.steps).eq(deeds(steps)),
            _ => false,
        })
    }

    /// Whether it does what another one does, or a part of that.
    pub(crate) fn leads_to(&self, goal: &Self) -> bool {
        let (Some(own), Some(others)) = (self.steps(), goal.steps()) else { return false };
        match (&self.context.search, &goal.context.search) {
            (Some(one), Some(other)) => return one.comes_to(other),
            (None, None) => {}
            _ => return false,
        }
        let wanted: Vec<&Action> = deeds(others).collect();
        let own: Vec<&Action> = deeds(own).collect();
        let is_whole = wanted.last().is_some_and(|last| own.contains(last));
        is_whole || !own.is_empty() && own.iter().all(|action| wanted.contains(action))
    }

    /// Whether it does the same again.
    pub(crate) fn repeats(&self, before: &[Step]) -> bool {
        self.steps().is_some_and(|steps| !steps.is_empty() && deeds(steps).eq(deeds(before)))
    }

    /// What it does and another one does not that begins in the same way, in words; nothing, where it does not go on from that one.
    pub(crate) fn beyond(&self, other: &Self) -> Option<String> {
        let (steps, begun) = (self.steps()?, other.steps()?);
        if self.looks() || other.context.search.is_some() {
            return None;
        }
        let begins = deeds(begun).count();
        if !deeds(steps).take(begins).eq(deeds(begun)) {
            return None;
        }
        let last = deeds(steps).skip(begins).count();
        let more = (last > 0).then(|| reply::plan_in_words(&steps[steps.len() - last..]));
        let sought = self.context.search.as_ref().map(|_| reply::request_in_words(&self.context.request));
        let later = self.context.later.strip_prefix(other.context.later.as_slice())?;
        let after = sought.iter().chain(later).map(|text| prose::doing(text));
        let rest: Vec<String> = more.into_iter().chain(after).collect();
        (!rest.is_empty()).then(|| prose::list(&rest, "and then"))
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

    /// Whether nothing is other after it than where the robot is, and what it knows.
    pub(crate) fn only_looks(&self) -> bool {
        let looks = |step: &Step| match step.action {
            Action::Interact { verb, .. } => matches!(verb, Verb::Examine | Verb::Scan),
            Action::PickUp { .. } | Action::Place { .. } => false,
            _ => true,
        };
        let is_asked = |clause: &&Clause| {
            matches!(
                clause.intent,
                Intent::Examine
                    | Intent::Find
                    | Intent::GoTo
                    | Intent::LookAround
                    | Intent::LookUnder
                    | Intent::Mention
                    | Intent::Travel
            )
        };
        let is_sought = self.context.search.as_ref().is_none_or(|search| search.deeds().iter().all(is_asked));
        let only_asks = self.context.later.iter().all(|text| text.ends_with('?'));
        is_sought && only_asks && self.steps().is_some_and(|steps| steps.iter().all(looks))
    }

    /// Whether what it changes in the end is not simply put back.
    pub(crate) fn is_lasting(&self) -> bool {
        let is_lasting = |clause: &&Clause| {
            !matches!(
                clause.intent,
                Intent::Bring
                    | Intent::Close
                    | Intent::Drop
                    | Intent::Examine
                    | Intent::Find
                    | Intent::GoTo
                    | Intent::Look
                    | Intent::LookIn
                    | Intent::LookUnder
                    | Intent::LookAround
                    | Intent::Mention
                    | Intent::Open
                    | Intent::PickUp
                    | Intent::Place
                    | Intent::Scan
                    | Intent::Travel
                    | Intent::Turn
            )
        };
        let is_sought = self.context.search.as_ref().is_some_and(|search| search.deeds().iter().any(is_lasting));
        is_sought || self.steps().is_some_and(|steps| steps.iter().any(Step::is_lasting))
    }
}

/// What is done but for doors, and for what is in the hand at the end: what follows takes what it needs.
fn outcome(steps: &[Step]) -> Vec<&Action> {
    let is_door = |action: &&Action| matches!(action, Action::Interact { verb: Verb::Open | Verb::Close, .. });
    let mut done: Vec<&Action> = deeds(steps).filter(|action| !is_door(action)).collect();
    if matches!(done.last(), Some(Action::PickUp { .. })) {
        done.pop();
    }
    done
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
    rest.map_or_else(|| text.to_owned(), prose::sentence)
}
