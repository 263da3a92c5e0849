//! What the robot did, as it remembers it: for questions about that.

use cohabit_cdf::{Action, GoToTarget, ObjectId, Verb};
use serde::{Deserialize, Serialize};

use crate::{describe, intent::Intent, understanding::Step};

/// How many deeds are remembered.
const MEMORY: usize = 40;
/// How many deeds an answer tells, and one about all that was done.
const TOLD: usize = 5;
const ALL_TOLD: usize = 10;

/// A step that succeeded.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct Deed {
    pub(crate) step: Step,
    /// What was said that asked for it.
    pub(crate) asked: String,
}

/// All that it remembers to have done, the latest last.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
#[serde(transparent)]
pub(crate) struct Deeds(Vec<Deed>);

/// How what steps say is told once it is done.
const PAST: [(&str, &str); 25] = [
    ("breaking", "broke"),
    ("bringing", "brought"),
    ("closing", "closed"),
    ("coming", "came"),
    ("cutting", "cut"),
    ("examining", "examined"),
    ("filling", "filled"),
    ("going", "went"),
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
    ("washing", "washed"),
    ("cleaning", "cleaned"),
];

impl Deed {
    /// What was done: `opened the fridge`.
    pub(crate) fn in_words(&self) -> String {
        past(&self.step.says)
    }
}

impl Deeds {
    pub(crate) fn add(&mut self, step: &Step, asked: &str) {
        if !step.commits() || step.says.is_empty() {
            return;
        }
        self.0.push(Deed { step: step.clone(), asked: asked.to_owned() });
        let surplus = self.0.len().saturating_sub(MEMORY);
        self.0.drain(..surplus);
    }

    /// What it did for the last request, in words: `I opened the fridge and picked up the milk`; nothing, where it did nothing yet.
    pub(crate) fn told(&self) -> Option<String> {
        let last = self.0.last()?;
        let same = self.0.iter().rev().take_while(|deed| deed.asked == last.asked).count();
        let mut said: Vec<String> = self.0[self.0.len() - same..].iter().map(Deed::in_words).collect();
        said.dedup();
        let left_out = said.len().saturating_sub(TOLD);
        said.drain(..left_out);
        Some(format!("I {}", describe::list(&said, "and")))
    }

    /// What it did for all requests, in words: the last that it changed for each, or else the last that it did.
    pub(crate) fn all_told(&self) -> Option<String> {
        let of_requests = self.0.chunk_by(|one, next| one.asked == next.asked);
        let told = of_requests.filter_map(|deeds| deeds.iter().rfind(|deed| deed.step.is_lasting()).or(deeds.last()));
        let mut said: Vec<String> = told.map(Deed::in_words).collect();
        said.dedup();
        let left_out = said.len().saturating_sub(ALL_TOLD);
        said.drain(..left_out);
        let start = if left_out > 0 { "Of late" } else { "So far" };
        (!said.is_empty()).then(|| format!("{start} I {}", describe::list(&said, "and")))
    }

    /// The last deed that changed this thing, or took it or put it away.
    pub(crate) fn to(&self, id: ObjectId) -> Option<&Deed> {
        self.0.iter().rev().find(|deed| deed.step.object() == Some(id))
    }

    /// What it did with this thing for the last request that was about it, in words; nothing, where it did nothing with it.
    pub(crate) fn told_of(&self, id: ObjectId) -> Option<String> {
        let last = self.0.iter().rposition(|deed| deed.step.object() == Some(id))?;
        let put_away = |deed: &&Deed| matches!(deed.step.action, Action::Place { .. });
        let later = &self.0[last + 1..];
        let until =
            later.iter().position(|deed| deed.step.action == Action::PickUp { object: id }).unwrap_or(later.len());
        let put = later[..until].iter().find(put_away).filter(|_| self.is_taken(last, id));
        let first =
            self.0[..last].iter().rposition(|deed| deed.step.object() == Some(id) && deed.asked == self.0[last].asked);
        let of_it = first.into_iter().chain([last]).map(|at| &self.0[at]).chain(put);
        let mut said: Vec<String> = of_it.map(Deed::in_words).collect();
        said.dedup();
        Some(format!("I {}", describe::list(&said, "and")))
    }

    /// Whether this thing was in the hand after that deed.
    fn is_taken(&self, at: usize, id: ObjectId) -> bool {
        let held = self.0[..=at].iter().rev().find_map(|deed| match deed.step.action {
            Action::PickUp { object } => Some(object == id),
            Action::Place { .. } => Some(false),
            _ => None,
        });
        held == Some(true)
    }

    /// Whether it did something of that kind to this thing; nothing, where no deed could tell.
    pub(crate) fn did(&self, intent: Intent, id: ObjectId) -> Option<bool> {
        let interacted = |wanted: Verb| {
            let is_it = |deed: &Deed| matches!(deed.step.action, Action::Interact { verb, object } if verb == wanted && object == id);
            self.0.iter().any(is_it)
        };
        let taken = || self.0.iter().position(|deed| deed.step.action == Action::PickUp { object: id });
        Some(match intent {
            Intent::PickUp | Intent::Bring => taken().is_some(),
            Intent::Place | Intent::Drop => taken()
                .is_some_and(|at| self.0[at..].iter().any(|deed| matches!(deed.step.action, Action::Place { .. }))),
            Intent::GoTo => {
                let gone = Action::GoTo { target: GoToTarget::Object(id) };
                self.0.iter().any(|deed| deed.step.action == gone || deed.step.object() == Some(id))
            }
            Intent::Scan => interacted(Verb::Scan),
            Intent::Examine => interacted(Verb::Examine),
            Intent::Throw => interacted(Verb::Throw),
            Intent::Pour => interacted(Verb::Pour),
            Intent::Toggle | Intent::Use => interacted(Verb::Toggle),
            _ => return None,
        })
    }
}

/// `opening the fridge` → `opened the fridge`.
fn past(says: &str) -> String {
    let (first, rest) = says.split_once(' ').unwrap_or((says, ""));
    let done = PAST.iter().find(|(doing, _)| *doing == first).map_or(first, |(_, done)| done);
    format!("{done} {rest}").trim_end().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(action: Action, says: &str) -> Step {
        Step { action, says: says.to_owned() }
    }

    #[test]
    fn what_was_done_for_the_last_request_is_told() {
        let (fridge, milk) = (ObjectId(1), ObjectId(2));
        let mut deeds = Deeds::default();
        assert_eq!(deeds.told(), None);
        deeds.add(
            &step(Action::Interact { verb: Verb::Open, object: ObjectId(9) }, "opening the door"),
            "open the door",
        );
        deeds.add(&step(Action::Interact { verb: Verb::Open, object: fridge }, "opening the fridge"), "get the milk");
        deeds.add(&step(Action::LookAround, "looking around"), "get the milk");
        deeds.add(&step(Action::PickUp { object: milk }, "picking up the milk"), "get the milk");
        assert_eq!(deeds.told().as_deref(), Some("I opened the fridge and picked up the milk"));
        assert_eq!(deeds.did(Intent::PickUp, milk), Some(true));
        assert_eq!(deeds.did(Intent::Place, milk), Some(false));
        assert_eq!(deeds.to(fridge).map(|deed| deed.asked.as_str()), Some("get the milk"));
    }

    #[test]
    fn only_so_much_is_remembered() {
        let mut deeds = Deeds::default();
        for number in 0..100 {
            deeds.add(&step(Action::PickUp { object: ObjectId(number) }, "picking it up"), "");
        }
        assert_eq!(deeds.0.len(), MEMORY);
    }
}
