//! What a thing invites to: conditions on its class and its state, and what can be done then.

use cohabit_cdf::{Action, ObjectClass, ObjectId, Property, StateFlag, StateFlags, Verb};

/// What holds of a thing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Condition {
    /// Its class affords this.
    pub property: Property,
    /// States that it all has.
    pub has: &'static [StateFlag],
    /// States of which it has none.
    pub lacks: &'static [StateFlag],
}

impl Condition {
    /// Whether it holds.
    pub fn holds(&self, class: &ObjectClass, flags: StateFlags) -> bool {
        class.has(self.property)
            && self.has.iter().all(|flag| flags.has(*flag))
            && !self.lacks.iter().any(|flag| flags.has(*flag))
    }
}

/// What a hand does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Handling {
    PickUp,
    Place,
    Do(Verb),
}

impl Handling {
    /// As an action on a thing.
    pub const fn on(self, object: ObjectId) -> Action {
        match self {
            Self::PickUp => Action::PickUp { object },
            Self::Place => Action::Place { receptacle: object },
            Self::Do(verb) => Action::Interact { verb, object },
        }
    }
}

/// Something that can be done to things, with an empty hand or with one that holds something, or with either.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Affordance {
    pub of: Condition,
    /// Whether something must be in the hand; no matter, if absent.
    pub hand_full: Option<bool>,
    pub handling: Handling,
}

const fn affordance(
    property: Property,
    has: &'static [StateFlag],
    lacks: &'static [StateFlag],
    hand_full: Option<bool>,
    handling: Handling,
) -> Affordance {
    Affordance { of: Condition { property, has, lacks }, hand_full, handling }
}

/// What can be done to things. Nobody touches what sparks: that is deadly.
pub(crate) const AFFORDANCES: &[Affordance] = {
    use Handling::{Do, PickUp, Place};
    use StateFlag::{Broken, Dirty, Locked, Opened, PickedUp, Sparking};
    &[
        affordance(Property::Pickupable, &[], &[Sparking, PickedUp], Some(false), PickUp),
        affordance(Property::Receptacle, &[], &[Sparking], Some(true), Place),
        affordance(Property::Openable, &[], &[Sparking, Opened, Locked], None, Do(Verb::Open)),
        affordance(Property::Openable, &[Opened], &[Sparking], None, Do(Verb::Close)),
        affordance(Property::Toggleable, &[], &[Sparking], None, Do(Verb::Toggle)),
        affordance(Property::Fillable, &[], &[Sparking], Some(true), Do(Verb::Pour)),
        affordance(Property::Breakable, &[], &[Sparking, Broken], Some(true), Do(Verb::Break)),
        affordance(Property::Dirtyable, &[Dirty], &[Sparking], Some(true), Do(Verb::Clean)),
        affordance(Property::Decor, &[], &[Sparking], None, Do(Verb::Examine)),
    ]
};

/// Classes that are live, or set a room free of power: whoever tidies or plays leaves them alone.
pub(crate) const DANGEROUS: &[&str] =
    &["Broken_Cord_01", "CableFrayed_01", "FuseBox_01", "FuseBox_02", "FuseBox_01_Lever"];

#[cfg(test)]
mod tests {
    use cohabit_cdf::Catalog;

    use super::*;

    #[test]
    fn dangerous_classes_are_in_the_catalogue() {
        let catalog = Catalog::builtin();
        for class in DANGEROUS {
            assert!(catalog.find(class).is_some(), "{class}");
        }
    }

    #[test]
    fn a_condition_asks_for_class_and_state() {
        let catalog = Catalog::builtin();
        let fridge = catalog.class(catalog.find("FridgeLower_02").unwrap());
        let close = AFFORDANCES.iter().find(|one| one.handling == Handling::Do(Verb::Close)).unwrap();
        let mut flags = StateFlags::default();
        assert!(!close.of.holds(fridge, flags));
        flags.set(StateFlag::Opened, true);
        assert!(close.of.holds(fridge, flags));
        flags.set(StateFlag::Sparking, true);
        assert!(!close.of.holds(fridge, flags));
    }
}
