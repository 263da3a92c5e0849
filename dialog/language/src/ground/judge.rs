//! Whether to ask: what a mistake is expected to cost, against what a question costs.

use std::collections::BTreeMap;

use cohabit_cdf::{Catalog, ClassId};
use serde::Deserialize;

use crate::{ground::confidence::Weights, understanding::Asking, words::intent::Intent};

/// What decides between acting and asking during one turn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Judge<'a> {
    pub(crate) weights: &'a Weights,
    pub(crate) costs: &'a Costs,
    pub(crate) asking: Asking,
    /// How many words of the utterance were misspelt.
    pub(crate) repairs: usize,
}

/// What questions and mistakes cost, in units of one question.
#[derive(Clone, Debug)]
pub(crate) struct Costs {
    question: f32,
    other: f32,
    cannot_be_undone: f32,
    mistake: BTreeMap<Intent, f32>,
    /// Machines that are dear to switch by mistake.
    switching: BTreeMap<ClassId, f32>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CostFile {
    question: f32,
    other: f32,
    cannot_be_undone: f32,
    mistake: BTreeMap<Intent, f32>,
    switching: Vec<Switching>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Switching {
    cost: f32,
    classes: Vec<String>,
}

impl Costs {
    /// Those in `data/costs.toml`.
    pub(crate) fn new(catalog: &Catalog) -> Self {
        let file: CostFile = toml::from_str(include_str!("../../data/costs.toml"))
            .expect("invariant: the built-in costs parse, which a test holds");
        let of_class = |entry: &Switching| {
            let cost = entry.cost;
            let known = entry.classes.iter().filter_map(|id| catalog.find(id));
            known.map(move |class| (class, cost)).collect::<Vec<_>>()
        };
        Self {
            question: file.question,
            other: file.other,
            cannot_be_undone: file.cannot_be_undone,
            mistake: file.mistake,
            switching: file.switching.iter().flat_map(of_class).collect(),
        }
    }

    /// The cost of doing this to the wrong object.
    fn mistake(&self, intent: Intent, class: ClassId) -> f32 {
        let cost = self.mistake.get(&intent).copied().unwrap_or(self.other);
        let switches = matches!(intent, Intent::Toggle | Intent::TurnOn | Intent::Use);
        let machine = self.switching.get(&class).copied().filter(|_| switches);
        machine.map_or(cost, |machine| machine.max(cost))
    }
}

impl Judge<'_> {
    /// The chance of another candidate from which on `always` asks.
    const SLIGHT: f32 = 0.02;

    /// Whether to ask before doing this to an object of that class that is probably the one meant, and whose likeliest
    /// rival has the probability `rival`.
    pub(crate) fn asks(&self, intent: Intent, class: ClassId, probability: f32, rival: f32) -> bool {
        match self.asking {
            Asking::Never => false,
            Asking::Unsure => (1.0 - probability) * self.costs.mistake(intent, class) > self.costs.question,
            Asking::Always => rival > Self::SLIGHT,
        }
    }

    /// Whether it cannot be undone.
    pub(crate) fn is_for_good(&self, intent: Intent, class: ClassId) -> bool {
        self.costs.mistake(intent, class) >= self.costs.cannot_be_undone
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_undone_is_asked_about_sooner() {
        let catalog = Catalog::builtin();
        let (weights, costs) = (Weights::builtin(), Costs::new(&catalog));
        let judge = |asking| Judge { weights: &weights, costs: &costs, asking, repairs: 0 };
        let mug = catalog.find("CoffeeMug_Boss").unwrap_or_default();
        let asks = |asking, intent, probability| judge(asking).asks(intent, mug, probability, 1.0 - probability);
        assert!(!asks(Asking::Unsure, Intent::GoTo, 0.5));
        assert!(asks(Asking::Unsure, Intent::PickUp, 0.5));
        assert!(!asks(Asking::Unsure, Intent::PickUp, 0.7));
        assert!(asks(Asking::Unsure, Intent::Break, 0.9) && !asks(Asking::Unsure, Intent::PickUp, 0.9));
        assert!(!asks(Asking::Unsure, Intent::Break, 0.97));
        assert!(!asks(Asking::Never, Intent::Break, 0.3));
        assert!(asks(Asking::Always, Intent::GoTo, 0.9));
        assert!(
            judge(Asking::Unsure).is_for_good(Intent::Break, mug)
                && !judge(Asking::Unsure).is_for_good(Intent::PickUp, mug)
        );
        let machine = catalog.find("EAC_Machine").unwrap_or_default();
        assert!(judge(Asking::Unsure).is_for_good(Intent::TurnOn, machine));
    }
}
