//! What is left of the mission, as requests: most of what people ask for brings one of these about, or leads to it.

use crate::{
    alternatives::Alternative,
    clause::Clause,
    context::Context,
    conversation::Conversation,
    intent::Intent,
    phrase::Phrase,
    search::{may_mean_the_same, named},
    understanding::{Step, Understanding},
};

/// A goal that is not met, as the grammar reads its text.
pub(crate) struct OpenGoal {
    steps: Vec<Step>,
    requests: Vec<Requested>,
}

/// What is to be done, and with what: pronouns stand for what was named before them.
struct Requested {
    intent: Intent,
    named: Vec<Phrase>,
}

/// How much likelier people ask for what meets an open goal than for anything else, and for what leads to one, nats.
pub(crate) const MEETS: f32 = 1.2;
const SERVES: f32 = 0.6;

/// What the open goals say for this.
pub(crate) fn prior(goals: &[OpenGoal], steps: &[Step], request: &[Clause]) -> f32 {
    if goals.iter().any(|goal| goal.is_met_by(steps, request)) {
        MEETS
    } else if goals.iter().any(|goal| goal.is_served_by(steps, request)) {
        SERVES
    } else {
        0.0
    }
}

impl Conversation<'_> {
    /// The goals that are not met and that the grammar can read.
    pub(crate) fn goals_to_meet(&self) -> Vec<OpenGoal> {
        self.open_goals().filter_map(|goal| OpenGoal::of(&self.read(goal, &Context::default()))).collect()
    }
}

impl OpenGoal {
    fn of(one: &Alternative) -> Option<Self> {
        let Understanding::Plan { steps, .. } = &one.understanding else { return None };
        Some(Self { steps: steps.clone(), requests: requested(&one.context.request) })
    }

    /// Whether this brings the goal about: it does what is done for it last, or asks for the same.
    fn is_met_by(&self, steps: &[Step], request: &[Clause]) -> bool {
        let does = |wanted: &Step| steps.iter().any(|step| step.action == wanted.action);
        let asks = |wanted: &Requested| requested(request).iter().any(|one| one.is_alike(wanted));
        last_deed(&self.steps).is_some_and(does) || self.requests.last().is_some_and(asks)
    }

    /// Whether this does some of what the goal needs.
    fn is_served_by(&self, steps: &[Step], request: &[Clause]) -> bool {
        let is_needed = |step: &Step| self.steps.iter().any(|needed| needed.action == step.action);
        let is_asked =
            |one: &Requested| self.requests.iter().any(|wanted| one.is_alike(wanted) || one.fetches_for(wanted));
        last_deed(steps).is_some_and(is_needed) || requested(request).last().is_some_and(is_asked)
    }
}

impl Requested {
    /// Whether it gets, or goes to, what the other one needs.
    fn fetches_for(&self, other: &Self) -> bool {
        let fetches = matches!(self.intent, Intent::PickUp | Intent::Find | Intent::GoTo);
        let needs =
            |one: &Phrase| other.named.iter().any(|needed| !needed.is_bare_pronoun() && may_mean_the_same(one, needed));
        fetches && matches!(self.named.as_slice(), [one] if !one.is_bare_pronoun() && needs(one))
    }

    fn is_alike(&self, other: &Self) -> bool {
        self.intent == other.intent
            && self.named.len() == other.named.len()
            && !self.named.is_empty()
            && self
                .named
                .iter()
                .zip(&other.named)
                .all(|(one, other)| !one.is_bare_pronoun() && !other.is_bare_pronoun() && may_mean_the_same(one, other))
    }
}

/// The last step that does something with a thing.
fn last_deed(steps: &[Step]) -> Option<&Step> {
    steps.iter().rev().find(|step| step.commits())
}

fn requested(clauses: &[Clause]) -> Vec<Requested> {
    let mut spoken_of: Option<Phrase> = None;
    let mut all = Vec::with_capacity(clauses.len());
    for clause in clauses {
        let named: Vec<Phrase> = named(clause)
            .into_iter()
            .map(|phrase| match &spoken_of {
                Some(before) if phrase.is_bare_pronoun() => before.clone(),
                _ => phrase.clone(),
            })
            .collect();
        spoken_of = named.first().cloned().or(spoken_of);
        if !matches!(clause.intent, Intent::Mention) {
            all.push(Requested { intent: clause.intent, named });
        }
    }
    all
}
