//! What a helper does when: a table, of which the first rule that applies wins.

use cohabit_cdf::{Property, StateFlag, Verb};

use crate::affordance::{Condition, Handling};

/// One rule.
pub(super) struct Rule {
    pub when: When,
    pub then: Then,
    /// What it says about it; `{}` is the thing.
    pub says: &'static str,
}

/// When a rule applies.
pub(super) enum When {
    /// A person is so near, or so much in the way, that it must not move on.
    PersonInTheWay,
    /// It holds something.
    HandFull,
    /// It knows a thing that is so.
    Knows(Wanted),
    /// At all times.
    Always,
}

/// Which things a rule is about.
pub(super) struct Wanted {
    pub condition: Condition,
    pub lies: Lies,
    pub classes: Classes,
}

/// Where a thing lies.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Lies {
    Anywhere,
    /// On the floor, where nothing of its kind stands.
    OnTheFloor,
}

/// Which classes are meant.
pub(super) enum Classes {
    AllBut(&'static [&'static str]),
    Only(&'static [&'static str]),
}

impl Classes {
    /// Whether a class is.
    pub fn hold(&self, class: &str) -> bool {
        match self {
            Self::AllBut(classes) => !classes.contains(&class),
            Self::Only(classes) => classes.contains(&class),
        }
    }
}

/// What is to be done.
#[derive(Clone, Copy)]
pub(super) enum Then {
    /// Stand still.
    Wait,
    /// Put what is held on a table.
    PutDown,
    /// Handle the thing.
    Handle(Handling),
    /// See how things are elsewhere.
    Roam,
}

/// What stands open as it should: the doors of rooms, and what is opened once and for all.
const MAY_BE_OPEN: &[&str] = &["Door_01", "CandyBar_01", "MilkCarton_01"];
/// What stays on until somebody switches it off, and is not needed when nobody is there. Lights and circuits are.
const STAYS_ON: &[&str] = &[
    "KitchenCounterSink_01",
    "RoboticArm_01",
    "TeslaCoil",
    "TAMPrototypeHead_01",
    "V_Monitor_Gravity",
    "V_Monitor_Portal",
    "ForkLift",
    "Radio_01",
];
/// Where things that lay on the floor are put.
pub(super) const TABLES: &[&str] = &[
    "AP_Prop_Desk_Blue",
    "AP_Prop_Desk_Green",
    "AP_Prop_Desk_Red",
    "AP_Prop_Desk_Yellow",
    "Desk_01",
    "ManagerDesk",
    "ReceptionDesk",
    "SM_Prop_Table_02",
    "TableRound_02",
    "TableRoundSmall_02",
    "Table_Metal_01",
    "KitchenCounter01",
    "CounterBase_03",
    "KitchenCounterTop_02",
];

/// The rules, the first one first.
pub(super) const RULES: &[Rule] = {
    use StateFlag::{Opened, Sparking, Toggled};
    &[
        Rule { when: When::PersonInTheWay, then: Then::Wait, says: "After you." },
        Rule { when: When::HandFull, then: Then::PutDown, says: "I put this on the {}." },
        Rule {
            when: When::Knows(Wanted {
                condition: Condition { property: Property::Openable, has: &[Opened], lacks: &[Sparking] },
                lies: Lies::Anywhere,
                classes: Classes::AllBut(MAY_BE_OPEN),
            }),
            then: Then::Handle(Handling::Do(Verb::Close)),
            says: "I close the {}.",
        },
        Rule {
            when: When::Knows(Wanted {
                condition: Condition { property: Property::Toggleable, has: &[Toggled], lacks: &[Sparking] },
                lies: Lies::Anywhere,
                classes: Classes::Only(STAYS_ON),
            }),
            then: Then::Handle(Handling::Do(Verb::Toggle)),
            says: "I switch the {} off.",
        },
        Rule {
            when: When::Knows(Wanted {
                condition: Condition { property: Property::Pickupable, has: &[], lacks: &[Sparking] },
                lies: Lies::OnTheFloor,
                classes: Classes::AllBut(&[]),
            }),
            then: Then::Handle(Handling::PickUp),
            says: "The {} does not belong on the floor.",
        },
        Rule { when: When::Always, then: Then::Roam, says: "" },
    ]
};

#[cfg(test)]
mod tests {
    use cohabit_cdf::Catalog;

    use super::*;

    #[test]
    fn every_class_that_is_named_is_in_the_catalogue_and_affords_what_is_done_to_it() {
        let catalog = Catalog::builtin();
        for (classes, property) in
            [(MAY_BE_OPEN, Property::Openable), (STAYS_ON, Property::Toggleable), (TABLES, Property::Receptacle)]
        {
            for class in classes {
                let id = catalog.find(class).unwrap_or_else(|| panic!("{class}"));
                assert!(catalog.class(id).has(property), "{class}");
            }
        }
    }

    #[test]
    fn the_last_rule_always_applies() {
        assert!(matches!(RULES.last(), Some(Rule { when: When::Always, .. })));
    }
}
