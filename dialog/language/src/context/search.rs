//! A request that waits until what it names is found, and where that was looked for.

use cohabit_cdf::{Action, Catalog, ClassId, GoToTarget, ObjectId, RoomId, Status, Verb};
use serde::{Deserialize, Serialize};

use crate::{
    read::{clause::Clause, phrase::Phrase, slot},
    understanding::Step,
    words::intent::Intent,
};

/// How much likelier things are where they are spoken of than elsewhere.
const HERE: f32 = 4.0;

/// How much likelier things are where somebody thinks that they are.
const HINTED: f32 = 100.0;

/// A request that waits until what it names is found.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(crate) struct Search {
    pub(crate) clauses: Vec<Clause>,
    pub(crate) consent: Consent,
    /// What is looked for; nothing yet, while the beginning of the request is done first.
    pub(crate) target: Option<Target>,
    /// Where it looked all around, m.
    pub(crate) looked_m: Vec<[f32; 2]>,
    pub(crate) tried: Vec<Spot>,
    pub(crate) unreachable: Vec<RoomId>,
    /// What it opened in vain.
    pub(crate) to_close: Option<ObjectId>,
    pub(crate) legs: u16,
    /// Whether somebody told it to look, where it asked.
    #[serde(default)]
    pub(crate) is_told: bool,
    /// The rooms that it said it looks in.
    #[serde(default)]
    pub(crate) announced: Vec<RoomId>,
}

/// What is looked for.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct Target {
    /// In words, such as `a red mug`.
    pub(crate) said: String,
    pub(crate) classes: Vec<ClassId>,
    /// The rooms where it may be.
    pub(crate) rooms: Vec<RoomId>,
    /// How likely it is in each room, by its index.
    pub(crate) likely: Vec<f32>,
    /// What it was said to be in or on.
    pub(crate) at: Option<ObjectId>,
    /// The rooms where somebody thinks that it is.
    #[serde(default)]
    pub(crate) hinted: Vec<RoomId>,
    /// Whether one is known already, and a look around is all that is wanted.
    pub(crate) is_hasty: bool,
    /// Where the robot was when it was asked for.
    pub(crate) from: RoomId,
}

/// Somewhere to look from, or into.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) enum Spot {
    Here([f32; 2]),
    /// All around with a lowered head, for what lies low.
    Low([f32; 2]),
    Viewpoint(RoomId, u8),
    Thing(ObjectId),
}

impl Search {
    /// Whether it is to do the same with the same in the end, wherever it begins to look: a pronoun may stand for what the other one names.
    pub(crate) fn comes_to(&self, other: &Self) -> bool {
        let (own, others) = (self.ends(), other.ends());
        own.len() == others.len() && own.iter().zip(&others).all(|(one, other)| are_alike(one, other))
    }

    /// What is left of it once another one is over, which it goes on from, or which only finds what it does something with; nothing,
    /// where it is something else.
    pub(crate) fn left_after(&self, other: &Self) -> Option<Vec<Clause>> {
        let asked = |search: &Self| -> Vec<Clause> {
            search.clauses.iter().filter(|clause| clause.intent != Intent::Mention).cloned().collect()
        };
        let (own, others) = (asked(self), asked(other));
        if own.len() >= others.len() && own.iter().zip(&others).all(|(one, other)| are_alike(one, other)) {
            return Some(own[others.len()..].to_vec());
        }
        let is_about = |phrase: &&Phrase| own.iter().flat_map(slot::named).any(|own| may_mean_the_same(own, phrase));
        let leads = |clause: &Clause| only_goes(clause) && slot::named(clause).iter().all(is_about);
        let does_more = !own.iter().all(only_goes) && !others.is_empty();
        (does_more && others.iter().all(leads)).then(|| self.deeds().into_iter().cloned().collect())
    }

    /// What it is for, without what only brings the robot there and what is only spoken of, if there is more to it.
    pub(crate) fn deeds(&self) -> Vec<&Clause> {
        let is_deed = |clause: &&Clause| !only_goes(clause) && clause.intent != Intent::Mention;
        let deeds: Vec<&Clause> = self.clauses.iter().filter(is_deed).collect();
        if deeds.is_empty() { self.clauses.iter().collect() } else { deeds }
    }

    /// The same without what is picked up only to be put somewhere next.
    fn ends(&self) -> Vec<&Clause> {
        let deeds = self.deeds();
        let is_put_next = |at: usize| {
            let (one, next) = (deeds[at], deeds.get(at + 1));
            one.intent == Intent::PickUp
                && next.is_some_and(|next| {
                    matches!(next.intent, Intent::Place | Intent::Bring)
                        && slot::named(one)
                            .first()
                            .zip(slot::named(next).first())
                            .is_some_and(|(one, next)| may_mean_the_same(one, next))
                })
        };
        (0..deeds.len()).filter(|at| !is_put_next(*at)).map(|at| deeds[at]).collect()
    }

    pub(crate) fn new(clauses: Vec<Clause>, consent: Consent) -> Self {
        Self {
            clauses,
            consent,
            target: None,
            looked_m: Vec::new(),
            tried: Vec::new(),
            unreachable: Vec::new(),
            to_close: None,
            legs: 0,
            is_told: false,
            announced: Vec::new(),
        }
    }

    /// The same, of which somebody said that it is to look for what it does not know.
    pub(crate) fn told(clauses: Vec<Clause>, consent: Consent) -> Self {
        Self { is_told: true, ..Self::new(clauses, consent) }
    }

    /// Whether it is under way, and not waiting for the beginning of the request to be done.
    pub(crate) const fn is_under_way(&self) -> bool {
        self.target.is_some()
    }

    /// A leg could not be walked.
    pub(crate) fn note_failure(&mut self, step: &Step, status: Status) {
        if status == Status::Interrupted {
            return;
        }
        if let (Action::GoTo { target: GoToTarget::Viewpoint(room, _) }, Status::UnsupportedNavigation) =
            (step.action, status)
        {
            self.unreachable.push(room);
        }
        if let Action::Interact { .. } = step.action {
            self.to_close = None;
        }
    }

    /// Where it was on its way to when something came between is still to be looked at, and what it was about to close to be closed.
    pub(crate) fn take_back(&mut self, step: &Step) {
        if let Some(Spot::Here(_)) = self.tried.pop() {
            self.looked_m.pop();
        }
        self.to_close = match step.action {
            Action::Interact { verb: Verb::Close, object } => Some(object),
            _ => None,
        };
    }

    pub(crate) fn is_for(&self, target: &Target) -> bool {
        self.target.as_ref().is_some_and(|before| !before.is_hasty && before.classes == target.classes)
    }

    pub(crate) fn look_for(&mut self, target: Target) -> bool {
        let is_same = |before: &Target| before.classes == target.classes && before.is_hasty == target.is_hasty;
        let is_new = !self.target.as_ref().is_some_and(is_same);
        if is_new {
            self.looked_m.clear();
            self.tried.clear();
            self.target = Some(target);
        } else if let Some(before) = &mut self.target {
            (before.at, before.hinted) = (target.at, target.hinted);
        }
        is_new
    }
}

/// Whether it brings the robot to something, and no more.
const fn only_goes(clause: &Clause) -> bool {
    matches!(clause.intent, Intent::GoTo | Intent::Find | Intent::Look)
}

/// Whether two clauses ask for the same.
fn are_alike(one: &Clause, other: &Clause) -> bool {
    let (one_named, other_named) = (slot::named(one), slot::named(other));
    one.intent == other.intent
        && one_named.len() == other_named.len()
        && one_named.iter().zip(&other_named).all(|(one, other)| may_mean_the_same(one, other))
}

/// Whether two phrases may mean the same: one is a pronoun, or both name things of one class in the same color.
fn may_mean_the_same(one: &Phrase, other: &Phrase) -> bool {
    let shares_class = || one.namings.iter().any(|naming| other.naming(naming.class).is_some());
    one.text == other.text
        || one.is_bare_pronoun()
        || other.is_bare_pronoun()
        || one.color == other.color && one.room == other.room && shares_class()
}

impl Target {
    pub(crate) fn chance(&self, room: RoomId, catalog: &Catalog) -> f32 {
        let index = catalog.room_index(room).map(usize::from);
        let usually = index.and_then(|index| self.likely.get(index)).copied().unwrap_or_default();
        // Who thinks that it is somewhere knows more than where such things usually are.
        let most = || self.likely.iter().copied().fold(0.0, f32::max);
        let likely = if self.hinted.contains(&room) { most() } else { usually };
        likely * self.favour(room)
    }

    /// How much likelier it is in this room by what was said, and where.
    pub(crate) fn favour(&self, room: RoomId) -> f32 {
        let here = if room == self.from { HERE } else { 1.0 };
        if self.hinted.contains(&room) { here * HINTED } else { here }
    }

    pub(crate) fn likely_in(&mut self, room: RoomId, catalog: &Catalog) -> Option<&mut f32> {
        self.likely.get_mut(usize::from(catalog.room_index(room)?))
    }
}

/// What a person has agreed to in answers to questions about a request.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize)]
pub(crate) struct Consent {
    /// That what is held is put down first.
    pub(crate) may_put_down: bool,
    /// That it is done.
    pub(crate) is_agreed: bool,
}
