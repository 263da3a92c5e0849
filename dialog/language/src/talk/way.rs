//! A way to understand an utterance.

use cohabit_cdf::{Action, GoToTarget, ObjectId, Verb};

use crate::{
    context::{Context, Guess, Pending, search::Search},
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
            (Understanding::Plan { .. }, Understanding::Plan { .. })
                if self.looks() && (other.looks() || other.goes_to_look()) || self.goes_to_look() && other.looks() =>
            {
                true
            }
            (Understanding::Plan { steps: one, .. }, Understanding::Plan { steps: other, .. }) => {
                let (own, others) = (outcome(one), outcome(other));
                // Who does something to a thing goes to its room, whether that was said or not.
                deeds(one).eq(deeds(other))
                    || touched(one).eq(touched(other))
                    || !own.is_empty() && own == others && !self.context.later.is_empty()
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

    /// Whether it goes to a room first, and then looks for something.
    fn goes_to_look(&self) -> bool {
        let waits = self.context.search.as_ref().is_some_and(|search| !search.is_under_way());
        waits && self.steps().is_some_and(|steps| steps.iter().all(|step| goes_to_room(&step.action)))
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
        let wanted: Vec<Action> = deeds(others).collect();
        let own: Vec<Action> = deeds(own).collect();
        let is_whole = wanted.last().is_some_and(|last| own.contains(last));
        is_whole || !own.is_empty() && own.iter().all(|action| wanted.contains(action))
    }

    /// Whether it does the same again.
    pub(crate) fn repeats(&self, before: &[Step]) -> bool {
        self.steps().is_some_and(|steps| {
            !steps.is_empty() && deeds(steps).eq(deeds(before)) && neighbours(steps).eq(neighbours(before))
        })
    }

    /// What is left of it once another one is done, all of which it does, too: to be done behind that.
    pub(crate) fn left_after(&self, other: &Self) -> Option<(Guess, Vec<String>)> {
        let (steps, begun) = (self.steps()?, other.steps()?);
        if self.looks() && other.looks() {
            return self.left_after_search(other);
        }
        if self.looks() || other.context.search.is_some() {
            return None;
        }
        let later = self.context.later.strip_prefix(other.context.later.as_slice())?;
        let left = left_of(steps, begun)?;
        let mut says: Vec<String> = left.iter().map(|step| step.says.clone()).collect();
        says.dedup();
        let request = self.context.search.as_ref().map(|_| &self.context.request).into_iter().flatten();
        let sought = request.map(|clause| reply::request_in_words(std::slice::from_ref(clause)));
        let after = sought.filter(|text| !text.is_empty()).chain(later.iter().cloned());
        says.extend(after.map(|text| prose::doing(&text)));
        let guess = Context { later: later.to_vec(), ..self.context.clone() }.guess(&left);
        (!says.is_empty()).then(|| (guess.called(prose::list(&says, "and then")), says))
    }

    /// The same of one that begins to look for something, as the other one does.
    fn left_after_search(&self, other: &Self) -> Option<(Guess, Vec<String>)> {
        let (own, others) = self.context.search.as_ref().zip(other.context.search.as_ref())?;
        let later = self.context.later.strip_prefix(other.context.later.as_slice())?;
        let left = own.left_after(others)?;
        let says: Vec<String> = reply::doings(&left).chain(later.iter().map(|text| prose::doing(text))).collect();
        let search = (!left.is_empty()).then(|| Search::new(left.clone(), own.consent));
        let guess = Context { search, request: left, later: later.to_vec(), ..self.context.clone() }.guess(&[]);
        (!says.is_empty()).then(|| (guess.called(prose::list(&says, "and then")), says))
    }

    /// Whether it does no more than go to things.
    pub(crate) fn only_goes(&self) -> bool {
        let goes = |step: &Step| matches!(step.action, Action::GoTo { target: GoToTarget::Object(_) });
        let is_all = self.context.search.is_none() && self.context.later.is_empty();
        is_all && self.steps().is_some_and(|steps| !steps.is_empty() && steps.iter().all(goes))
    }

    /// Whether it is a part of another one, or has it as a part of its own.
    pub(crate) fn is_part_or_whole(&self, other: &Self) -> bool {
        let goes_on = |one: &Self, other: &Self| match (&one.context.search, &other.context.search) {
            (Some(own), Some(others)) => {
                one.looks() && other.looks() && own.left_after(others).is_some_and(|left| !left.is_empty())
            }
            _ => one.left_after(other).is_some(),
        };
        goes_on(self, other) || goes_on(other, self)
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
            Action::PickUp { .. } | Action::Place { .. } | Action::PlaceBeside { .. } => false,
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
fn outcome(steps: &[Step]) -> Vec<Action> {
    let is_door = |action: &Action| matches!(action, Action::Interact { verb: Verb::Open | Verb::Close, .. });
    let mut done: Vec<Action> = deeds(steps).filter(|action| !is_door(action)).collect();
    if matches!(done.last(), Some(Action::PickUp { .. })) {
        done.pop();
    }
    done
}

/// The steps that are left once others are done: those behind them, or, where they lie before or between them, what touches nothing else.
fn left_of(steps: &[Step], begun: &[Step]) -> Option<Vec<Step>> {
    let begins = deeds(begun).count();
    if deeds(steps).take(begins).eq(deeds(begun)) {
        let last = deeds(steps).skip(begins).count();
        return Some(steps[steps.len() - last..].to_vec());
    }
    // Who does something to a thing goes to it.
    let only_leads = |step: &&Step| {
        let Action::GoTo { target: GoToTarget::Object(object) } = step.action else { return false };
        steps.iter().any(|other| other.object() == Some(object) && !matches!(other.action, Action::GoTo { .. }))
    };
    if begun.iter().any(|step| only_leads(&step)) {
        let needed: Vec<Step> = begun.iter().filter(|step| !only_leads(step)).cloned().collect();
        return left_of(steps, &needed);
    }
    let mut wanted = deeds(begun).peekable();
    let mut left: Vec<Step> = Vec::new();
    for step in steps {
        let is_begun = wanted.next_if_eq(&step.action.beside_nothing()).is_some();
        if !is_begun && !matches!(step.action, Action::GoTo { .. }) {
            left.push(step.clone());
        }
    }
    let is_apart = |step: &Step| {
        let is_of_itself =
            matches!(step.action, Action::Interact { verb: Verb::Open | Verb::Close | Verb::Toggle, .. });
        is_of_itself && begun.iter().all(|other| other.object() != step.object())
    };
    (wanted.peek().is_none() && !left.is_empty() && left.iter().all(is_apart)).then_some(left)
}

/// What these steps come to: who goes to a thing and then takes it, takes it; and who puts something beside a thing on a table, puts it
/// on the table.
fn deeds(steps: &[Step]) -> impl Iterator<Item = Action> {
    let is_on_the_way = |at: usize| match steps[at].action {
        Action::GoTo { target: GoToTarget::Object(object) } => {
            steps[at + 1..].iter().any(|step| step.object() == Some(object))
        }
        _ => false,
    };
    (0..steps.len()).filter(move |at| !is_on_the_way(*at)).map(move |at| steps[at].action.beside_nothing())
}

/// What these steps put things beside.
fn neighbours(steps: &[Step]) -> impl Iterator<Item = ObjectId> {
    steps.iter().filter_map(|step| step.action.beside())
}

/// The same without rooms that are only gone to on the way to a thing.
fn touched(steps: &[Step]) -> impl Iterator<Item = Action> {
    let is_of_thing =
        |action: &Action| matches!(action, Action::PickUp { .. } | Action::Place { .. } | Action::Interact { .. });
    let own: Vec<Action> = deeds(steps).collect();
    let is_on_the_way = |at: usize| {
        let next = own[at..].iter().find(|action| !goes_to_room(action));
        goes_to_room(&own[at]) && next.is_some_and(is_of_thing)
    };
    let kept: Vec<Action> = (0..own.len()).filter(|at| !is_on_the_way(*at)).map(|at| own[at]).collect();
    kept.into_iter()
}

const fn goes_to_room(action: &Action) -> bool {
    matches!(action, Action::GoTo { target: GoToTarget::Room(_) | GoToTarget::Viewpoint(..) })
}

fn without_yes_or_no(text: &str) -> String {
    let rest = text.strip_prefix("Yes, ").or_else(|| text.strip_prefix("No, "));
    rest.map_or_else(|| text.to_owned(), prose::sentence)
}
