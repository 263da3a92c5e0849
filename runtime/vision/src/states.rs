//! The states that things start in.

use cohabit_cdf::{Color, Fluid, ObjectClass, Property, StateFlag};
use cohabit_generate::Chance;

/// What a class affords, the state that follows, and the share of its things that are in it.
const STATES: [(Property, StateFlag, f64); 10] = [
    (Property::Openable, StateFlag::Opened, 0.5),
    (Property::Toggleable, StateFlag::Toggled, 0.5),
    (Property::Breakable, StateFlag::Broken, 0.15),
    (Property::Dirtyable, StateFlag::Dirty, 0.25),
    (Property::Heatable, StateFlag::Hot, 0.15),
    (Property::Chillable, StateFlag::Cold, 0.15),
    (Property::Cookable, StateFlag::Cooked, 0.3),
    (Property::Eatable, StateFlag::Eaten, 0.1),
    (Property::Cuttable, StateFlag::Cut, 0.2),
    (Property::Infectable, StateFlag::Infected, 0.05),
];
/// The share of vessels that have something in them, and of things with a colour that is not their own.
const FILLED: f64 = 0.5;
const COLORED: f64 = 0.2;

/// The states of a thing. Open and on are drawn both ways: floor plans have doors that stand open.
pub(crate) fn flags(class: &ObjectClass, chance: &mut Chance) -> Vec<(StateFlag, bool)> {
    let mut flags = Vec::new();
    for (property, flag, share) in STATES.into_iter().filter(|(property, ..)| class.has(*property)) {
        let is_so = chance.is(share);
        let goes_both_ways = matches!(property, Property::Openable | Property::Toggleable);
        // Nothing is hot and cold.
        let is_possible = flag != StateFlag::Cold || !flags.contains(&(StateFlag::Hot, true));
        if (is_so && is_possible) || goes_both_ways {
            flags.push((flag, is_so));
        }
    }
    flags
}

/// What is in a vessel.
pub(crate) fn fluid(class: &ObjectClass, chance: &mut Chance) -> Option<Fluid> {
    if !class.has(Property::Fillable) {
        return None;
    }
    let is_filled = chance.is(FILLED);
    if is_filled { chance.pick(&[Fluid::Water, Fluid::Milk, Fluid::Coffee]).copied() } else { Some(Fluid::None) }
}

/// A colour that a thing was given, if it was.
pub(crate) fn color(chance: &mut Chance) -> Option<Color> {
    let is_colored = chance.is(COLORED);
    is_colored.then(|| chance.pick(&[Color::Red, Color::Green, Color::Blue]).copied()).flatten()
}

#[cfg(test)]
mod tests {
    use cohabit_cdf::Catalog;

    use super::*;

    #[test]
    fn states_are_those_that_the_class_affords_and_go_together() {
        let (catalog, mut chance) = (Catalog::builtin(), Chance::new(1, 0));
        for class in catalog.classes() {
            for _ in 0..20 {
                let flags = flags(class, &mut chance);
                let has = |flag| flags.contains(&(flag, true));
                assert!(!(has(StateFlag::Hot) && has(StateFlag::Cold)), "{}", class.id);
                let is_afforded = |flag| STATES.iter().any(|(own, known, _)| *known == flag && class.has(*own));
                assert!(flags.iter().all(|(flag, _)| is_afforded(*flag)), "{}", class.id);
                assert!(fluid(class, &mut chance).is_some() == class.has(Property::Fillable), "{}", class.id);
            }
        }
    }
}
