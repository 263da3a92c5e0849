//! The keys by which mission files name the flags of objects.

use crate::{catalog::Property, state::StateFlag};

/// Every flag, its key, and the property that an object needs to have it.
const FLAGS: [(StateFlag, &str, Option<Property>); 28] = [
    (StateFlag::PickedUp, "isPickedUp", Some(Property::Pickupable)),
    (StateFlag::Opened, "isOpen", Some(Property::Openable)),
    (StateFlag::Broken, "isBroken", None),
    (StateFlag::Toggled, "isToggledOn", Some(Property::Toggleable)),
    (StateFlag::Powered, "isPowered", Some(Property::Powerable)),
    (StateFlag::Overloaded, "isOverloaded", Some(Property::Powerable)),
    (StateFlag::Sparking, "isSparking", None),
    (StateFlag::Dirty, "isDirty", Some(Property::Dirtyable)),
    (StateFlag::Eaten, "isEaten", Some(Property::Eatable)),
    (StateFlag::Hot, "isHot", Some(Property::Heatable)),
    (StateFlag::Cold, "isCold", Some(Property::Chillable)),
    (StateFlag::Cooked, "isCooked", Some(Property::Cookable)),
    (StateFlag::Cut, "isCut", Some(Property::Cuttable)),
    (StateFlag::Infected, "isInfected", Some(Property::Infectable)),
    (StateFlag::Scanned, "isScanned", None),
    (StateFlag::Examined, "isExamined", None),
    (StateFlag::Used, "isUsed", None),
    (StateFlag::Embiggenated, "isEmbiggenated", None),
    (StateFlag::Locked, "isLocked", None),
    (StateFlag::Cereal, "ContainsCereal", None),
    (StateFlag::Neutral, "isNeutral", None),
    (StateFlag::Happy, "isHappy", None),
    (StateFlag::Sad, "isSad", None),
    (StateFlag::Angry, "isAngry", None),
    (StateFlag::Scared, "isScared", None),
    (StateFlag::Wet, "isWet", None),
    (StateFlag::Creased, "isCreased", None),
    (StateFlag::Folded, "isFolded", None),
];

/// The key that goals use for `flag`, such as `isToggledOn`.
#[must_use]
pub fn flag_key(flag: StateFlag) -> &'static str {
    FLAGS.iter().find(|(known, ..)| *known == flag).map_or("", |(_, key, _)| *key)
}

/// The flag that `key` names, in any case; initial states write `Infected` for `isInfected`.
#[must_use]
pub fn flag_of_key(key: &str) -> Option<StateFlag> {
    let key = if key.eq_ignore_ascii_case("Infected") { "isInfected" } else { key };
    FLAGS.iter().find(|(_, known, _)| known.eq_ignore_ascii_case(key)).map(|(flag, ..)| *flag)
}

/// The property without which no object gets `flag`.
pub(crate) fn property_of(flag: StateFlag) -> Option<Property> {
    FLAGS.iter().find(|(known, ..)| *known == flag).and_then(|(.., property)| *property)
}

/// The keys of all flags.
pub(crate) fn flag_keys() -> impl Iterator<Item = &'static str> {
    FLAGS.iter().map(|(_, key, _)| *key)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_flag_has_one_key() {
        for flag in StateFlag::ALL {
            assert_eq!(flag_of_key(flag_key(flag)), Some(flag));
        }
        assert_eq!(flag_of_key("Infected"), Some(StateFlag::Infected));
        assert_eq!(flag_of_key("isopen"), Some(StateFlag::Opened));
        assert_eq!(flag_of_key(""), None);
    }
}
