//! What a helper does when: a table, of which the first rule that applies wins.

use cohabit_cdf::{ActionKind, ActionTable, ObjectClass, Property, StateFlag, StateFlags, catalog::Stands};

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

/// What holds of a thing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Condition {
    /// Its class affords this.
    pub property: Property,
    /// The state that it is in, if any is asked for. What sparks is left alone: to touch it is deadly.
    pub is: Option<StateFlag>,
}

impl Condition {
    /// Whether it holds. What is built open, such as curtains, does not stand open by mistake.
    pub fn holds(&self, class: &ObjectClass, flags: StateFlags) -> bool {
        let is_so = self.is.is_none_or(|flag| flags.has(flag));
        let is_built_so = self.is == Some(StateFlag::Opened) && class.as_built.contains(&StateFlag::Opened);
        class.has(self.property) && is_so && !is_built_so && !flags.has(StateFlag::Sparking)
    }
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
    /// What stays on until somebody switches it off, and is not needed when nobody is there; lights and circuits are.
    StayOn,
}

impl Classes {
    /// Whether a class is, by the table of devices.
    pub fn hold(&self, class: &str, table: &ActionTable) -> bool {
        match self {
            Self::AllBut(classes) => !classes.contains(&class),
            Self::StayOn => {
                let device = table.device(class);
                device.stays_on() && !device.stays_without_power && !device.dangerous
            }
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
    Handle(ActionKind),
    /// See how things are elsewhere.
    Roam,
}

/// What stands open as it should: the doors of rooms, and what is opened once and for all.
const MAY_BE_OPEN: &[&str] = &["Door_01", "CandyBar_01", "MilkCarton_01"];
/// What people call the things that others are put on, in any world.
const TABLES: [&str; 3] = ["table", "desk", "counter"];

/// Whether things that lay on the floor are put on one: it stands there, is called so, and is no cupboard.
pub(super) fn is_table(class: &ObjectClass) -> bool {
    let is_called_so = |name: &String| TABLES.iter().any(|table| name.eq_ignore_ascii_case(table));
    let is_open = class.has(Property::Receptacle) && !class.has(Property::Openable) && !class.has(Property::Pickupable);
    is_open && class.stands == Stands::OnFloor && (is_called_so(&class.name) || class.words.iter().any(is_called_so))
}

/// The rules, the first one first.
pub(super) const RULES: &[Rule] = {
    use StateFlag::{Opened, Toggled};
    &[
        Rule { when: When::PersonInTheWay, then: Then::Wait, says: "After you." },
        Rule { when: When::HandFull, then: Then::PutDown, says: "I put this on the {}." },
        Rule {
            when: When::Knows(Wanted {
                condition: Condition { property: Property::Openable, is: Some(Opened) },
                lies: Lies::Anywhere,
                classes: Classes::AllBut(MAY_BE_OPEN),
            }),
            then: Then::Handle(ActionKind::Close),
            says: "I close the {}.",
        },
        Rule {
            when: When::Knows(Wanted {
                condition: Condition { property: Property::Toggleable, is: Some(Toggled) },
                lies: Lies::Anywhere,
                classes: Classes::StayOn,
            }),
            then: Then::Handle(ActionKind::Toggle),
            says: "I switch the {} off.",
        },
        Rule {
            when: When::Knows(Wanted {
                condition: Condition { property: Property::Pickupable, is: None },
                lies: Lies::OnTheFloor,
                classes: Classes::AllBut(&[]),
            }),
            then: Then::Handle(ActionKind::PickUp),
            says: "The {} does not belong on the floor.",
        },
        Rule { when: When::Always, then: Then::Roam, says: "" },
    ]
};

#[cfg(test)]
mod tests {
    use cohabit_cdf::{Catalog, WorldData, WorldPack};

    use super::*;

    #[test]
    fn every_class_that_is_named_is_in_the_catalogue_and_affords_what_is_done_to_it() {
        let catalog = Catalog::builtin();
        for class in MAY_BE_OPEN {
            let id = catalog.find(class).unwrap_or_else(|| panic!("{class}"));
            assert!(catalog.class(id).has(Property::Openable), "{class}");
        }
    }

    #[test]
    fn there_are_tables_in_offices_and_in_homes() {
        let pack = WorldPack::builtin("homes").unwrap();
        let homes = WorldData::layered(vec![pack]).unwrap();
        for (class, expected) in [
            ("Desk_01", true),
            ("ManagerDesk", true),
            ("TableRound_02", true),
            ("TableRoundSmall_02", true),
            ("KitchenCounterTop_02", true),
            ("Coffee_Table", true),
            ("Dining_Table", true),
            ("Garden_Table", true),
            ("KitchenCounterDrawer_02", false),
            ("Toy_Box", false),
            ("Bowl_01", false),
        ] {
            let Some(id) = homes.catalog().find(class) else { panic!("{class}") };
            assert_eq!(is_table(homes.catalog().class(id)), expected, "{class}");
        }
    }

    #[test]
    fn what_is_built_open_does_not_stand_open_by_mistake() {
        let homes = WorldData::layered(vec![WorldPack::builtin("homes").unwrap()]).unwrap();
        let open = Condition { property: Property::Openable, is: Some(StateFlag::Opened) };
        for (class, expected) in [("Curtains", false), ("Wardrobe", true)] {
            let class = homes.catalog().class(homes.catalog().find(class).unwrap());
            assert_eq!(open.holds(class, StateFlags::default().with(StateFlag::Opened)), expected, "{}", class.id);
        }
    }

    #[test]
    fn what_stays_on_follows_from_the_table() {
        let catalog = Catalog::builtin();
        for (class, expected) in [
            ("KitchenCounterSink_01", true),
            ("Radio_01", true),
            ("V_Monitor_Gravity", true),
            ("LightSwitch_01", false),
            ("Microwave_01", false),
            ("CableFrayed_01", false),
            ("FuseBox_01_Lever", false),
        ] {
            assert_eq!(Classes::StayOn.hold(class, catalog.table()), expected, "{class}");
        }
    }

    #[test]
    fn the_last_rule_always_applies() {
        assert!(matches!(RULES.last(), Some(Rule { when: When::Always, .. })));
    }
}
