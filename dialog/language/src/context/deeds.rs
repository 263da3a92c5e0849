//! What the robot did, as it remembers it: for questions about that.

use cohabit_cdf::{Action, GoToTarget, ObjectId, RoomId, Verb};
use serde::{Deserialize, Serialize};

use crate::{
    understanding::Step,
    words::{intent::Intent, prose},
};

/// How many deeds are remembered: those of a long session.
const MEMORY: usize = 120;
/// How many deeds an answer tells, and one about all that was done.
const TOLD: usize = 5;
const ALL_TOLD: usize = 8;
/// The same where only what mattered of all of them is told.
const MATTERING_TOLD: usize = 14;
/// How many of earlier requests are told behind those for the last one.
const EARLIER: usize = 4;

/// A step that succeeded.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct Deed {
    pub(crate) step: Step,
    /// Why: `you asked me to open the fridge`.
    pub(crate) reason: String,
    /// The goals of the mission that were met by then, and not before.
    #[serde(default)]
    pub(crate) goals: Vec<String>,
    /// Whether what it was done for was never finished: nothing that follows tells of it.
    #[serde(default)]
    pub(crate) is_cut_short: bool,
}

/// All that it remembers to have done, the latest last.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
#[serde(transparent)]
pub(crate) struct Deeds(Vec<Deed>);

/// How what steps say is told once it is done.
const PAST: [(&str, &str); 30] = [
    ("breaking", "broke"),
    ("bringing", "brought"),
    ("closing", "closed"),
    ("coming", "came"),
    ("cutting", "cut"),
    ("examining", "examined"),
    ("filling", "filled"),
    ("folding", "folded"),
    ("following", "followed"),
    ("going", "went"),
    ("ironing", "ironed"),
    ("looking", "looked"),
    ("moving", "moved"),
    ("opening", "opened"),
    ("picking", "picked"),
    ("pointing", "pointed"),
    ("pouring", "poured"),
    ("pressing", "pressed"),
    ("putting", "put"),
    ("reading", "read"),
    ("scanning", "scanned"),
    ("stopping", "stopped"),
    ("switching", "switched"),
    ("taking", "took"),
    ("throwing", "threw"),
    ("turning", "turned"),
    ("unfolding", "unfolded"),
    ("washing", "washed"),
    ("watering", "watered"),
    ("cleaning", "cleaned"),
];

/// What steps say by which things are taken in the hand.
const TAKING: [&str; 2] = ["picking up ", "taking "];

impl Deed {
    /// What was done: `opened the fridge`.
    pub(crate) fn in_words(&self) -> String {
        past(&self.step.says)
    }
}

impl Deeds {
    pub(crate) fn add(&mut self, step: &Step, reason: &str) {
        // How often it set out after whom it follows is not worth remembering.
        let is_next_leg = |last: &Deed| {
            let is_to_point = matches!(step.action, Action::GoTo { target: GoToTarget::Point(_) });
            is_to_point && last.step.says == step.says && last.reason == reason
        };
        if !step.commits() || step.says.is_empty() || self.0.last().is_some_and(is_next_leg) {
            return;
        }
        self.0.push(Deed { step: step.clone(), reason: reason.to_owned(), goals: Vec::new(), is_cut_short: false });
        let surplus = self.0.len().saturating_sub(MEMORY);
        self.0.drain(..surplus);
    }

    /// What was done last for this reason comes to nothing: a step after it failed, or it was stopped.
    pub(crate) fn cut_short(&mut self, reason: &str) {
        let of_reason = self.0.iter_mut().rev().take_while(|deed| deed.reason == reason);
        of_reason.for_each(|deed| deed.is_cut_short = true);
    }

    /// The last deed has met what goals are met now and were not before.
    pub(crate) fn credit<'g>(&mut self, met: impl Iterator<Item = &'g str>) {
        let is_new = |goal: &&str| !self.0.iter().any(|deed| deed.goals.iter().any(|known| known == goal));
        let new: Vec<String> = met.filter(is_new).map(str::to_owned).collect();
        if let Some(last) = self.0.last_mut() {
            last.goals.extend(new);
        }
    }

    /// What it did for the last request, in words, and before: `I opened the fridge and picked up the milk. Before that I closed the door`;
    /// nothing, where it did nothing yet.
    pub(crate) fn told(&self) -> Option<String> {
        let told = self.told_of_last()?;
        let before = self.listed(main_deeds(self.by_request().0), EARLIER);
        Some(if before.is_empty() { told } else { format!("{told}. Before that I {before}") })
    }

    /// The same without what it did before.
    pub(crate) fn told_of_last(&self) -> Option<String> {
        let (_, of_last) = self.by_request();
        (!of_last.is_empty()).then(|| format!("I {}", self.listed(of_last.iter(), TOLD)))
    }

    /// What it did for earlier requests, and for the last one.
    fn by_request(&self) -> (&[Deed], &[Deed]) {
        let is_of_last = |deed: &&Deed| self.0.last().is_some_and(|last| deed.reason == last.reason);
        let same = self.0.iter().rev().take_while(is_of_last).count();
        self.0.split_at(self.0.len() - same)
    }

    /// Why it did something of that kind last, to this thing or with it where one is named: what it was needed for, if that is known, what
    /// was asked for, and what goals that met; nothing, where no deed could tell.
    pub(crate) fn why(&self, intent: Option<Intent>, id: Option<ObjectId>, need: Option<&str>) -> Option<String> {
        let deed = self.asked_about(intent, id)?;
        let asked = format!("{}{}", deed.reason, self.goals_of(&deed.reason));
        let why = match need {
            Some(need) => format!("{need}. {}", prose::sentence(&asked).trim_end_matches('.')),
            None => asked,
        };
        Some(format!("I {}, since {why}", deed.in_words()))
    }

    /// The deed of that kind that was done last, to this thing or with it where one is named; or else the last that was done about that
    /// thing.
    pub(crate) fn asked_about(&self, intent: Option<Intent>, id: Option<ObjectId>) -> Option<&Deed> {
        let is_about = |deed: &&Deed| id.is_none_or(|id| self.is_about(deed, id));
        let is_of_kind = |deed: &&Deed| intent.is_some_and(|intent| is_of(&deed.step.action, intent));
        let of_kind = self.0.iter().rfind(|deed| is_of_kind(deed) && is_about(deed));
        of_kind.or_else(|| self.0.iter().rfind(|deed| id.is_some() && is_about(deed)))
    }

    /// What was done after a deed for the same request.
    pub(crate) fn followed_by(&self, deed: &Deed) -> impl Iterator<Item = &Deed> {
        let at = self.0.iter().position(|other| std::ptr::eq(other, deed)).unwrap_or(self.0.len());
        self.0.iter().skip(at + 1).take_while(move |next| next.reason == deed.reason)
    }

    /// The goals of the mission that its deeds have met, the first first.
    pub(crate) fn goals(&self) -> impl Iterator<Item = &str> {
        self.0.iter().flat_map(|deed| &deed.goals).map(String::as_str)
    }

    pub(crate) const fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// What goals deeds of this reason met, as a sentence to follow another one; empty, where they met none.
    pub(crate) fn goals_of(&self, reason: &str) -> String {
        let of_reason = self.0.iter().rev().skip_while(|deed| deed.reason != reason);
        let goals = of_reason.take_while(|deed| deed.reason == reason).flat_map(|deed| &deed.goals);
        let mut goals: Vec<&str> = goals.map(|goal| goal.trim_end_matches('.')).collect();
        goals.reverse();
        if goals.is_empty() { String::new() } else { format!(". The mission wanted it: {}", goals.join("; ")) }
    }

    /// All that it did, in words and in the order in which it was done; of much, where things went and what was changed for good, or else
    /// the last that was changed for each request, and all that was done for those that were never finished.
    pub(crate) fn all_told(&self) -> Option<String> {
        if self.0.len() <= ALL_TOLD {
            let told = self.listed(self.0.iter(), ALL_TOLD);
            return (!told.is_empty()).then(|| format!("So far I {told}"));
        }
        let mut told: Vec<&Deed> = self.0.iter().filter(|deed| self.matters(deed)).collect();
        if told.is_empty() || told.len() > MATTERING_TOLD {
            let main: Vec<&Deed> = main_deeds(&self.0).collect();
            let is_main = |deed: &&Deed| main.iter().any(|one| std::ptr::eq(*one, *deed));
            let left = self.0.iter().filter(|deed| is_main(deed) || deed.is_cut_short && self.matters(deed));
            told = left.collect();
        }
        let start = if told.len() > MATTERING_TOLD { "Of late" } else { "So far" };
        Some(format!("{start} I {}", self.listed(told.into_iter(), MATTERING_TOLD)))
    }

    /// Whether a deed left something otherwise than it was: what is taken to be put down, and what is opened or switched to be closed or
    /// switched back for the same request, does not.
    fn matters(&self, deed: &Deed) -> bool {
        let at = self.0.iter().position(|other| std::ptr::eq(other, deed)).unwrap_or_default();
        let of_request = |other: &&Deed| other.reason == deed.reason;
        let after = &self.0[(at + 1).min(self.0.len())..];
        let undoes = |other: &Deed| is_undone_by(&deed.step.action, &other.step.action);
        match deed.step.action {
            // What it was taken for was not done, so nothing else tells that it was taken.
            Action::PickUp { .. } if deed.is_cut_short => true,
            Action::PickUp { .. } => {
                held_after(&self.0) == self.done_to(deed) && after.iter().all(|one| !is_taking(one))
            }
            Action::Interact { verb: Verb::Open | Verb::Close | Verb::Toggle, .. } => {
                let mut before = self.0[..at].iter().rev().take_while(of_request);
                !after.iter().take_while(of_request).any(undoes) && !before.any(undoes)
            }
            Action::Interact { verb: Verb::Examine | Verb::Scan, .. } => false,
            // Where it went is told where that was asked for, and not on the way to something else.
            Action::GoTo { target: GoToTarget::Room(_) } => after.first().is_none_or(|next| next.reason != deed.reason),
            _ => deed.step.changes(),
        }
    }

    /// What deeds came to, the last few, in words.
    fn listed<'d>(&self, deeds: impl Iterator<Item = &'d Deed>, most: usize) -> String {
        let mut deeds: Vec<&Deed> = deeds.collect();
        deeds.dedup_by(|one, other| one.step.says == other.step.says);
        deeds.drain(..deeds.len().saturating_sub(most));
        let mut handled = None;
        let said: Vec<String> = deeds.into_iter().map(|deed| self.told_after(deed, &mut handled)).collect();
        prose::list(&said, "and")
    }

    /// What was done, in words that name what was in the hand, unless the deed told before it that was done by hand was done to that:
    /// `washed it in the sink`, after `picked up the plate`.
    fn told_after(&self, deed: &Deed, handled: &mut Option<ObjectId>) -> String {
        let told = deed.in_words();
        let in_hand = match deed.step.action {
            Action::PickUp { .. }
            | Action::Place { .. }
            | Action::PlaceBeside { .. }
            | Action::Interact { verb: Verb::Pour | Verb::Throw | Verb::Fill | Verb::Clean, .. } => self.done_to(deed),
            _ => return told,
        };
        let is_known = in_hand.is_some() && *handled == in_hand;
        *handled = in_hand;
        if is_known {
            return told;
        }
        let name = in_hand.and_then(|id| self.name_of(id)).unwrap_or("what I held");
        told.replacen(" it ", &format!(" {name} "), 1)
    }

    /// What a thing was called when it was taken in the hand last.
    fn name_of(&self, id: ObjectId) -> Option<&str> {
        let taken = self.0.iter().rfind(|deed| deed.step.action == Action::PickUp { object: id })?;
        TAKING.iter().find_map(|taking| taken.step.says.strip_prefix(*taking))
    }

    /// The last deed that changed this thing, or took it or put it away.
    pub(crate) fn to(&self, id: ObjectId) -> Option<&Deed> {
        self.0.iter().rev().find(|deed| deed.step.object() == Some(id))
    }

    /// What it did with this thing for the last request that was about it, in words, with what came in between: what a machine does to it
    /// is told so. Nothing, where it did nothing with it.
    pub(crate) fn told_of(&self, id: ObjectId) -> Option<String> {
        let is_of_it = |deed: &Deed| deed.step.object() == Some(id) || self.is_done_to(deed, id);
        let last = self.0.iter().rposition(is_of_it)?;
        let reason = &self.0[last].reason;
        let begun = self.0[..last].iter().rposition(|deed| deed.reason != *reason).map_or(0, |before| before + 1);
        let first = (begun..last).find(|at| is_of_it(&self.0[*at])).unwrap_or(last);
        // What was in the hand by then was taken for an earlier request.
        let takes_it = |deed: &Deed| deed.step.action == Action::PickUp { object: id };
        let is_held = self.held_before(&self.0[first]) == Some(id);
        let taken = self.0[..first].iter().rposition(takes_it).filter(|_| is_held);
        Some(format!("I {}", self.listed(self.0[taken.unwrap_or(first)..=last].iter(), TOLD)))
    }

    /// Whether a deed was done to this thing, or with it in the hand.
    fn is_about(&self, deed: &Deed, id: ObjectId) -> bool {
        deed.step.object() == Some(id) || deed.step.changes() && self.held_before(deed) == Some(id)
    }

    fn held_before(&self, deed: &Deed) -> Option<ObjectId> {
        let before = self.0.iter().position(|other| std::ptr::eq(other, deed)).map_or(&[][..], |at| &self.0[..at]);
        held_after(before)
    }

    /// The thing itself that a deed was done to: what is put, poured, thrown, filled or washed is in the hand.
    fn done_to(&self, deed: &Deed) -> Option<ObjectId> {
        match deed.step.action {
            // What is ironed or watered is not in the hand: the iron or the can is.
            _ if deed.step.by_hand().is_some() => deed.step.object(),
            Action::Place { .. }
            | Action::PlaceBeside { .. }
            | Action::Interact { verb: Verb::Pour | Verb::Throw | Verb::Fill | Verb::Clean, .. } => {
                self.held_before(deed)
            }
            _ => deed.step.object(),
        }
    }

    fn is_done_to(&self, deed: &Deed, id: ObjectId) -> bool {
        self.done_to(deed) == Some(id)
    }

    /// The things that it did something to, the latest first.
    pub(crate) fn things(&self) -> impl Iterator<Item = ObjectId> {
        self.0.iter().rev().filter_map(|deed| deed.step.object())
    }

    /// What it did something of that kind to last: `it`, where that is asked about.
    pub(crate) fn last_done_to(&self, intent: Intent) -> Option<ObjectId> {
        self.done_to(self.0.iter().rfind(|deed| is_of_step(&deed.step, intent))?)
    }

    /// Whether it switched a machine on or off after it last had this thing in its hand, and looked into the machine.
    pub(crate) fn has_switched_since(&self, machine: ObjectId, thing: ObjectId) -> bool {
        let interacts = |deed: &Deed, verb| deed.step.action == Action::Interact { verb, object: machine };
        let switched = self.0.iter().rposition(|deed| interacts(deed, Verb::Toggle));
        let knew = |deed: &Deed| interacts(deed, Verb::Open) || self.is_done_to(deed, thing);
        let known = self.0.iter().rposition(knew);
        switched.is_some_and(|at| known.is_none_or(|before| before < at))
    }

    /// Whether it put this thing there.
    pub(crate) fn did_put(&self, id: ObjectId, place: ObjectId) -> bool {
        let puts = |deed: &Deed| deed.step.action.receptacle() == Some(place) && self.is_done_to(deed, id);
        self.0.iter().any(puts)
    }

    /// Whether it had a machine do that to this thing, which is no single deed, as it was asked to.
    pub(crate) fn had_done(&self, intent: Intent, id: ObjectId) -> bool {
        let is_by_machine = matches!(
            intent,
            Intent::Heat
                | Intent::Cool
                | Intent::Toast
                | Intent::Repair
                | Intent::Clean
                | Intent::Color
                | Intent::Carrot
                | Intent::Resize
                | Intent::Shrink
                | Intent::Dry
        );
        let word = format!(" {} ", intent.verb());
        is_by_machine && self.0.iter().any(|deed| deed.reason.contains(&word) && self.is_about(deed, id))
    }

    /// Whether it did something of that kind to this thing or with it.
    pub(crate) fn did(&self, intent: Intent, id: ObjectId) -> bool {
        // Who did anything to a thing went there, and touched it.
        let did = |deed: &Deed| match intent {
            Intent::GoTo => deed.step.object() == Some(id),
            _ => is_of_step(&deed.step, intent) && self.is_done_to(deed, id),
        };
        self.0.iter().any(did)
    }

    /// Whether it went to this room.
    pub(crate) fn went_to(&self, room: RoomId) -> bool {
        let went = |deed: &Deed| match deed.step.action {
            Action::GoTo { target: GoToTarget::Room(to) | GoToTarget::Viewpoint(to, _) } => to == room,
            _ => false,
        };
        self.0.iter().any(went)
    }
}

/// Whether a step is what such a request comes to; to switch is one action, whichever way.
fn is_of_step(step: &Step, intent: Intent) -> bool {
    let other_way = match intent {
        Intent::TurnOn => "turning off",
        Intent::TurnOff => "turning on",
        _ => return step.by_hand().map_or_else(|| is_of(&step.action, intent), |by_hand| by_hand == intent),
    };
    is_of(&step.action, intent) && !step.says.starts_with(other_way)
}

/// `opening the fridge` → `opened the fridge`.
fn past(says: &str) -> String {
    let (first, rest) = says.split_once(' ').unwrap_or((says, ""));
    let done = PAST.iter().find(|(doing, _)| *doing == first).map_or(first, |(_, done)| done);
    format!("{done} {rest}").trim_end().to_owned()
}

/// What it changed last for each request, or else did last.
fn main_deeds(deeds: &[Deed]) -> impl Iterator<Item = &Deed> {
    let of_requests = deeds.chunk_by(|one, next| one.reason == next.reason);
    of_requests.filter_map(|deeds| deeds.iter().rfind(|deed| deed.step.is_lasting()).or(deeds.last()))
}

/// Whether an action is what such a request comes to.
fn is_of(action: &Action, intent: Intent) -> bool {
    let verb = match action {
        Action::PickUp { .. } => return matches!(intent, Intent::PickUp | Intent::Bring),
        Action::Place { .. } | Action::PlaceBeside { .. } => {
            return matches!(intent, Intent::Place | Intent::Drop | Intent::Bring);
        }
        Action::GoTo { .. } => return matches!(intent, Intent::GoTo | Intent::Travel | Intent::Find),
        Action::Rotate { .. } => return intent == Intent::Turn,
        Action::Interact { verb, .. } => verb,
        _ => return false,
    };
    match intent {
        Intent::Open => *verb == Verb::Open,
        Intent::Close => *verb == Verb::Close,
        Intent::Break | Intent::Cut => *verb == Verb::Break,
        Intent::Scan => *verb == Verb::Scan,
        Intent::Pour => *verb == Verb::Pour,
        Intent::Throw => *verb == Verb::Throw,
        Intent::Fill => *verb == Verb::Fill,
        Intent::Clean => *verb == Verb::Clean,
        Intent::Examine | Intent::LookIn | Intent::LookUnder => *verb == Verb::Examine,
        Intent::Toggle | Intent::TurnOn | Intent::TurnOff | Intent::Use => *verb == Verb::Toggle,
        _ => false,
    }
}

const fn is_taking(deed: &Deed) -> bool {
    matches!(deed.step.action, Action::PickUp { .. })
}

/// Whether one of two actions takes back the other: a thing is opened and closed, or switched twice.
fn is_undone_by(one: &Action, other: &Action) -> bool {
    let (Action::Interact { verb: done, object }, Action::Interact { verb: undone, object: same }) = (one, other)
    else {
        return false;
    };
    let is_pair =
        matches!((done, undone), (Verb::Open, Verb::Close) | (Verb::Close, Verb::Open) | (Verb::Toggle, Verb::Toggle));
    is_pair && object == same
}

/// What is in the hand after deeds.
fn held_after(deeds: &[Deed]) -> Option<ObjectId> {
    let held = |deed: &Deed| match deed.step.action {
        Action::PickUp { object } => Some(Some(object)),
        Action::Place { .. } | Action::PlaceBeside { .. } => Some(None),
        _ => None,
    };
    deeds.iter().rev().find_map(held).flatten()
}

#[cfg(test)]
mod tests;
