//! What must hold: one test of one thing, as the table writes it (`not it is Opened`).

use std::{fmt, str::FromStr};

use serde::de::{IntoDeserializer as _, value::Error};

use crate::{
    catalog::Property,
    state::{Fluid, StateFlag},
};

/// Whom a condition or a change is about.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum Term {
    /// What the action is done to.
    It,
    /// What is in the hand.
    Held,
    /// What `it` is in or on.
    Holder,
    /// What `it` works.
    Machine,
    /// A sink at hand.
    Basin,
    /// Each of the things that a work is done to.
    Thing,
}

impl Term {
    /// All of them.
    pub const ALL: [Self; 6] = [Self::It, Self::Held, Self::Holder, Self::Machine, Self::Basin, Self::Thing];

    const NAMES: [(Self, &'static str); 6] = [
        (Self::It, "it"),
        (Self::Held, "held"),
        (Self::Holder, "holder"),
        (Self::Machine, "machine"),
        (Self::Basin, "basin"),
        (Self::Thing, "thing"),
    ];

    /// Its word in the table.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(term, _)| *term == self).map_or("it", |(_, name)| name)
    }

    /// The term of that word.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::NAMES.iter().find(|(_, known)| *known == name).map(|(term, _)| *term)
    }
}

/// How far something may be.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum Range {
    /// A hand reaches it.
    Hand,
    /// It can be looked at closely.
    Sight,
    /// A throw gets there.
    Throw,
}

impl Range {
    /// The distance, m.
    #[must_use]
    pub const fn metres(self) -> f32 {
        match self {
            Self::Hand => 1.6,
            Self::Sight => 3.0,
            Self::Throw => 6.0,
        }
    }
}

/// A class of the catalogue, or all whose ids begin so: `Floppy_*`.
#[derive(Clone, Debug, Eq, Hash, PartialEq)]
pub struct ClassPattern(pub String);

impl ClassPattern {
    /// Whether the class of that id is meant.
    #[must_use]
    pub fn matches(&self, class: &str) -> bool {
        match self.0.strip_suffix('*') {
            Some(prefix) => class.starts_with(prefix),
            None => self.0 == class,
        }
    }
}

/// What may be in something.
#[derive(Clone, Debug, Eq, Hash, PartialEq)]
pub enum Content {
    /// Anything with a fluid in it.
    Filled,
    /// Something with this fluid in it.
    Fluid(Fluid),
    /// Something of this class.
    Class(ClassPattern),
}

/// What can be asked of a thing.
#[derive(Clone, Debug, Eq, Hash, PartialEq)]
pub enum Test {
    /// There is such a thing.
    Exists,
    /// No other body holds it.
    Free,
    /// No body holds it.
    PutDown,
    /// It is not in something shut.
    Uncovered,
    /// It is near enough.
    Within(Range),
    /// Nothing stands between the body and it.
    Accessible,
    /// It is in a slot of a vending machine.
    BehindGlass,
    /// There is a way to it.
    OnTheWay,
    /// Its class affords this.
    Affords(Property),
    /// The flag is set.
    Is(StateFlag),
    /// It is of this class.
    IsA(ClassPattern),
    /// It is what is in the hand.
    Held,
    /// It is what is in the hand, or in or on that.
    InHeld,
    /// A fluid is in it.
    Filled,
    /// This fluid is in it.
    Holds(Fluid),
    /// A thing of this class is directly in or on it.
    HoldsA(ClassPattern),
    /// The same, and that is not broken.
    HoldsWhole(ClassPattern),
    /// At any depth it contains this.
    Contains(Content),
    /// Its contents are behind a door that is closed.
    Shut,
    /// It needs no power, or has it.
    Powered,
    /// Something is directly in it.
    Occupied,
    /// Its keys, if it has any, are of the class of what is held, and it does not refuse that.
    TakesHeld,
    /// It takes its keys alone.
    Keyed,
    /// A place is free that a hand can put something at.
    HasRoom,
    /// Such a place is free that what is held fits.
    HasRoomForHeld,
    /// Any place is free.
    HasFreePlace,
    /// Something is in it that says what it prints.
    HasCartridge,
    /// The slot of this number is not empty.
    Sells(u16),
    /// It switches a circuit.
    Feeds,
    /// It is a portal.
    Gate,
    /// It is a portal that is open.
    OpenGate,
    /// What is held may go where the portal leads.
    LetsHeldPass,
    /// A press of it is answered although its class affords none.
    AnswersAlways,
    /// Nobody stands in its doorway.
    Clear,
    /// The doors that the button works are all clear, if they are to close.
    DoorsClear,
    /// Never.
    Never,
}

/// One test of one thing.
#[derive(Clone, Debug, Eq, Hash, PartialEq)]
pub struct Condition {
    /// Whether it must not hold.
    pub negated: bool,
    /// Of what.
    pub term: Term,
    /// What.
    pub test: Test,
}

impl FromStr for Condition {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let words: Vec<&str> = text.split_whitespace().collect();
        let (negated, words) = match words.as_slice() {
            ["not", rest @ ..] => (true, rest),
            rest => (false, rest),
        };
        let of = |term, test| Ok(Self { negated, term, test });
        match words {
            ["never"] => of(Term::It, Test::Never),
            ["doors", "are", "clear"] => of(Term::It, Test::DoorsClear),
            [term, test @ ..] => {
                let known = Term::from_name(term).ok_or_else(|| format!("`{text}`: there is no term `{term}`"))?;
                of(known, read_test(test).ok_or_else(|| format!("`{text}`: there is no such condition"))?)
            }
            [] => Err("an empty condition".to_owned()),
        }
    }
}

fn read_test(words: &[&str]) -> Option<Test> {
    Some(match words {
        ["exists"] => Test::Exists,
        ["is", "free"] => Test::Free,
        ["is", "put", "down"] => Test::PutDown,
        ["is", "uncovered"] => Test::Uncovered,
        ["is", "within", "hand"] => Test::Within(Range::Hand),
        ["is", "within", "sight"] => Test::Within(Range::Sight),
        ["is", "within", "throw"] => Test::Within(Range::Throw),
        ["is", "accessible"] => Test::Accessible,
        ["is", "behind", "glass"] => Test::BehindGlass,
        ["is", "on", "the", "way"] => Test::OnTheWay,
        ["is", "held"] => Test::Held,
        ["is", "in", "held"] => Test::InHeld,
        ["is", "filled"] => Test::Filled,
        ["is", "shut"] => Test::Shut,
        ["is", "powered"] => Test::Powered,
        ["is", "occupied"] => Test::Occupied,
        ["is", "keyed"] => Test::Keyed,
        ["is", "clear"] => Test::Clear,
        ["is", "a", "gate"] => Test::Gate,
        ["is", "an", "open", "gate"] => Test::OpenGate,
        ["is", "a", class] => Test::IsA(ClassPattern((*class).to_owned())),
        ["is", flag] => Test::Is(read_word(flag)?),
        ["affords", property] => Test::Affords(read_word(property)?),
        ["holds", "a", "whole", class] => Test::HoldsWhole(ClassPattern((*class).to_owned())),
        ["holds", "a", class] => Test::HoldsA(ClassPattern((*class).to_owned())),
        ["holds", fluid] => Test::Holds(Fluid::from_name(fluid)?),
        ["contains", "filled"] => Test::Contains(Content::Filled),
        ["contains", "a", class] => Test::Contains(Content::Class(ClassPattern((*class).to_owned()))),
        ["contains", fluid] => Test::Contains(Content::Fluid(Fluid::from_name(fluid)?)),
        ["takes", "held"] => Test::TakesHeld,
        ["has", "room"] => Test::HasRoom,
        ["has", "room", "for", "held"] => Test::HasRoomForHeld,
        ["has", "a", "free", "place"] => Test::HasFreePlace,
        ["has", "a", "cartridge"] => Test::HasCartridge,
        ["sells", slot] => Test::Sells(slot.parse().ok()?),
        ["feeds"] => Test::Feeds,
        ["lets", "held", "pass"] => Test::LetsHeldPass,
        ["answers", "always"] => Test::AnswersAlways,
        _ => return None,
    })
}

/// A value by its name in data files.
pub(super) fn read_word<'de, T: serde::Deserialize<'de>>(word: &'de str) -> Option<T> {
    let name: serde::de::value::StrDeserializer<'de, Error> = word.into_deserializer();
    T::deserialize(name).ok()
}

impl fmt::Display for Condition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let not = if self.negated { "not " } else { "" };
        write!(f, "{not}{} {:?}", self.term.name(), self.test)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conditions_are_read() {
        let check = |text: &str, negated, term, test| {
            assert_eq!(text.parse(), Ok(Condition { negated, term, test }), "{text}");
        };
        check("it is Opened", false, Term::It, Test::Is(StateFlag::Opened));
        check("not held affords FILLABLE", true, Term::Held, Test::Affords(Property::Fillable));
        check("thing is a Floppy_*", false, Term::Thing, Test::IsA(ClassPattern("Floppy_*".to_owned())));
        let disk = || ClassPattern("Floppy_Virus".to_owned());
        check("thing holds a whole Floppy_Virus", false, Term::Thing, Test::HoldsWhole(disk()));
        check("it contains Coffee", false, Term::It, Test::Contains(Content::Fluid(Fluid::Coffee)));
        check("never", false, Term::It, Test::Never);
    }

    #[test]
    fn what_is_no_condition_is_named() {
        for text in ["", "her is Opened", "it is Sleepy", "it affords JOY", "it"] {
            assert!(text.parse::<Condition>().is_err(), "{text}");
        }
    }

    #[test]
    fn patterns_mean_one_class_or_many() {
        for (pattern, class, expected) in
            [("Hammer", "Hammer", true), ("Hammer", "Hammer_2", false), ("Floppy_*", "Floppy_Virus", true)]
        {
            assert_eq!(ClassPattern(pattern.to_owned()).matches(class), expected, "{pattern} {class}");
        }
    }
}
