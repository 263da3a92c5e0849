//! What classes of things afford, whatever state they are in.

use super::{ActionKind, ActionTable, Change, ClassPattern, Condition, Effect, Need, Term, Test, takes};
use crate::{catalog::ObjectClass, state::StateFlag};

impl ActionTable {
    /// What has to be in a machine of that class before it can be worked; of each part any of its classes will do.
    pub fn parts_needed(&self, machine: &str) -> impl Iterator<Item = &ClassPattern> {
        let by_others = self.devices().iter().filter(move |device| device.works.iter().any(|class| class == machine));
        let worked = by_others.map(|device| (device, Term::Machine)).chain([(self.device(machine), Term::It)]);
        let needs = worked
            .flat_map(|(device, term)| device.needs.iter().flat_map(|need| &need.any).map(move |one| (one, term)));
        needs.filter_map(|(condition, term)| match &condition.test {
            Test::HoldsA(part) | Test::HoldsWhole(part) if condition.term == term && !condition.negated => Some(part),
            _ => None,
        })
    }

    /// Whether an action on a thing of a class can be allowed in any state to a body that holds a thing of another class, or
    /// nothing: what the classes alone rule out is not afforded.
    #[must_use]
    pub fn affords(&self, action: ActionKind, it: &ObjectClass, held: Option<&ObjectClass>) -> bool {
        let classes = Classes { it, held, answers_always: self.device(&it.id).answers_always };
        let device_needs = if action == ActionKind::Toggle { &self.device(&it.id).needs[..] } else { &[] };
        let mut rules = self.rules().iter().filter(|rule| rule.action == action);
        rules.any(|rule| {
            let may_count = rule.when.iter().all(|condition| classes.holds(condition) != Some(false));
            may_count && rule.needs.iter().chain(device_needs).all(|need| classes.may_meet(need))
        })
    }

    /// Whether some rule, press or work may make a state of a thing of a class true, as far as classes decide that.
    #[must_use]
    pub fn may_set(&self, flag: StateFlag, class: &ObjectClass) -> bool {
        let rules = self.rules().iter().map(|rule| (&rule.when[..], &rule.effects));
        let presses = self.devices().iter().map(|device| &device.press);
        let works = self.works().iter().flat_map(|work| [&work.effects, &work.then]);
        let all = rules.chain(presses.chain(works).map(|effects| (&[][..], effects)));
        all.flat_map(|(when, effects)| effects.iter().map(move |effect| (when, effect)))
            .any(|(when, effect)| effect.may_set(flag, class, when))
    }
}

impl Effect {
    /// Whether it may make a state of a thing of a class true, where it follows only if these conditions hold, too.
    fn may_set(&self, flag: StateFlag, class: &ObjectClass, when: &[Condition]) -> bool {
        let may_be = |term: Term| {
            let own = self.when.iter().chain(when).filter(|condition| condition.term == term);
            own.into_iter().all(|condition| match &condition.test {
                Test::Affords(property) => class.has(*property) != condition.negated,
                Test::IsA(pattern) => pattern.matches(&class.id) != condition.negated,
                _ => true,
            })
        };
        let sets = |change: &Change| matches!(change, Change::Set(term, set, true) if *set == flag && may_be(*term));
        self.changes.iter().any(sets)
    }
}

/// The classes of those that an action is about.
struct Classes<'a> {
    it: &'a ObjectClass,
    held: Option<&'a ObjectClass>,
    answers_always: bool,
}

impl Classes<'_> {
    fn may_meet(&self, need: &Need) -> bool {
        need.any.iter().any(|condition| self.holds(condition) != Some(false))
    }

    /// Whether a condition holds, if classes alone decide that.
    fn holds(&self, condition: &Condition) -> Option<bool> {
        let class = match condition.term {
            Term::It => Some(self.it),
            Term::Held => self.held,
            _ => return None,
        };
        let found = match (&condition.test, class) {
            (Test::Never, _) => false,
            (Test::Exists, _) if condition.term == Term::Held => self.held.is_some(),
            // Nothing is true of what is not held.
            (_, None) => false,
            (Test::Affords(property), Some(class)) => class.has(*property),
            (Test::IsA(pattern), Some(class)) => pattern.matches(&class.id),
            (Test::Keyed, Some(class)) => class.receptacle.as_ref().is_some_and(|kind| !kind.keys.is_empty()),
            (Test::AnswersAlways, Some(_)) => self.answers_always,
            (Test::TakesHeld, Some(class)) => self.held.is_some_and(|held| takes(class, &held.id)),
            (Test::HasRoomForHeld | Test::LetsHeldPass, Some(_)) if self.held.is_none() => false,
            _ => return None,
        };
        Some(found != condition.negated)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalog::Catalog;

    #[test]
    fn classes_rule_out_what_they_do_not_afford() {
        use ActionKind::{Break, Clean, Open, PickUp, Place, Pour, Toggle};
        let catalog = Catalog::builtin();
        let class = |id: &str| catalog.class(catalog.find(id).unwrap());
        for (action, it, held, expected) in [
            (PickUp, "Bowl_01", None, true),
            (PickUp, "Bowl_01", Some("Hammer"), false),
            (PickUp, "Desk_01", None, false),
            (Place, "Desk_01", Some("Bowl_01"), true),
            (Place, "Desk_01", None, false),
            (Place, "Toaster_02", Some("Bowl_01"), false),
            (Place, "Toaster_02", Some("BreadSlice_01"), true),
            (Open, "Door_01", None, true),
            (Open, "Bowl_01", None, false),
            (Toggle, "Microwave_01", None, true),
            (Toggle, "GravityPad", None, false),
            (Break, "Bowl_01", Some("Hammer"), true),
            (Break, "Bowl_01", None, false),
            (Break, "BreadLoaf", Some("Knife_01"), true),
            (Pour, "Bowl_01", Some("Cereal_Box_01"), true),
            (Pour, "Bowl_01", Some("Hammer"), false),
            (Clean, "KitchenCounterSink_01", Some("FoodPlate_01"), true),
        ] {
            let found = catalog.table().affords(action, class(it), held.map(class));
            assert_eq!(found, expected, "{action:?} {it} with {held:?}");
        }
    }
}
