//! What must hold: one test of one thing, as the table writes it (`not it is Opened`).

use std::{collections::BTreeMap, fmt, str::FromStr};

use serde::de::{IntoDeserializer as _, value::Error};

use super::form::{self, Form};
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

/// Classes of the catalogue: one, all whose ids begin so (`Floppy_*`), or those of a kind (`basin`).
#[derive(Clone, Debug, Eq, Hash, PartialEq)]
pub struct ClassPattern(pub Vec<String>);

impl ClassPattern {
    /// Whether the class of that id is meant.
    #[must_use]
    pub fn matches(&self, class: &str) -> bool {
        self.0.iter().any(|one| match one.strip_suffix('*') {
            Some(prefix) => class.starts_with(prefix),
            None => one == class,
        })
    }
}

/// Classes of which the table says the same, by the name of what they are.
pub(super) type Kinds = BTreeMap<String, Vec<String>>;

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

impl Condition {
    /// The same with the classes of a kind where it names one.
    pub(super) fn of_kinds(mut self, kinds: &Kinds) -> Self {
        if let Test::IsA(classes)
        | Test::HoldsA(classes)
        | Test::HoldsWhole(classes)
        | Test::Contains(Content::Class(classes)) = &mut self.test
        {
            let of_kind = |name: &String| kinds.get(name).cloned().unwrap_or_else(|| vec![name.clone()]);
            classes.0 = classes.0.iter().flat_map(of_kind).collect();
        }
        self
    }
}

impl Test {
    /// The classes that it names.
    #[must_use]
    pub const fn pattern(&self) -> Option<&ClassPattern> {
        match self {
            Self::IsA(classes)
            | Self::HoldsA(classes)
            | Self::HoldsWhole(classes)
            | Self::Contains(Content::Class(classes)) => Some(classes),
            _ => None,
        }
    }
}

impl FromStr for Condition {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let words: Vec<&str> = text.split_whitespace().collect();
        let (negated, words) = match words.as_slice() {
            ["not", rest @ ..] => (true, rest),
            rest => (false, rest),
        };
        let [term, of_term @ ..] = words else { return Err("an empty condition".to_owned()) };
        if let Some(test) = form::read(WHOLE, words) {
            return Ok(Self { negated, term: Term::It, test });
        }
        let term = Term::from_name(term).ok_or_else(|| format!("`{text}`: there is no term `{term}`"))?;
        let test = form::read(TESTS, of_term).ok_or_else(|| format!("`{text}`: there is no such condition"))?;
        Ok(Self { negated, term, test })
    }
}

/// Conditions of nothing in particular.
pub(super) const WHOLE: &[Form<Test>] = &[
    ("doors are clear", "Nobody stands in the doors that the button works, if they are to close.", |_| {
        Some(Test::DoorsClear)
    }),
    ("never", "Never.", |_| Some(Test::Never)),
];

/// All that can be asked of a thing, behind its term.
pub(super) const TESTS: &[Form<Test>] = &[
    ("exists", "It is in the world.", |_| Some(Test::Exists)),
    ("is free", "No other body holds it.", |_| Some(Test::Free)),
    ("is put down", "No body holds it.", |_| Some(Test::PutDown)),
    ("is uncovered", "It is not in something that is shut.", |_| Some(Test::Uncovered)),
    ("is within hand", "A hand reaches it.", |_| Some(Test::Within(Range::Hand))),
    ("is within sight", "It is near enough to be looked at.", |_| Some(Test::Within(Range::Sight))),
    ("is within throw", "A throw gets there.", |_| Some(Test::Within(Range::Throw))),
    ("is accessible", "Nothing stands between the body and it.", |_| Some(Test::Accessible)),
    ("is behind glass", "It is in a slot of a vending machine.", |_| Some(Test::BehindGlass)),
    ("is on the way", "There is a way to it.", |_| Some(Test::OnTheWay)),
    ("affords PROPERTY", "Its class affords this.", |words| Some(Test::Affords(read_word(words[0])?))),
    ("is FLAG", "This state of it is true.", |words| Some(Test::Is(read_word(words[0])?))),
    ("is a gate", "It is a portal.", |_| Some(Test::Gate)),
    ("is an open gate", "It is a portal that is open.", |_| Some(Test::OpenGate)),
    ("is a CLASS", "It is of this class, or of this kind.", |words| Some(Test::IsA(pattern(words)))),
    ("is held", "It is what is in the hand.", |_| Some(Test::Held)),
    ("is in held", "It is what is in the hand, or in or on that.", |_| Some(Test::InHeld)),
    ("is filled", "A fluid is in it.", |_| Some(Test::Filled)),
    ("is shut", "Its contents are behind a door that is closed.", |_| Some(Test::Shut)),
    ("is powered", "It needs no power, or has it.", |_| Some(Test::Powered)),
    ("is occupied", "Something is directly in or on it.", |_| Some(Test::Occupied)),
    ("is keyed", "It takes its keys alone.", |_| Some(Test::Keyed)),
    ("is clear", "Nobody stands in its doorway.", |_| Some(Test::Clear)),
    ("holds a whole CLASS", "A thing of this class that is not broken is directly in or on it.", |words| {
        Some(Test::HoldsWhole(pattern(words)))
    }),
    ("holds a CLASS", "A thing of this class is directly in or on it.", |words| Some(Test::HoldsA(pattern(words)))),
    ("holds FLUID", "This fluid is in it.", |words| Some(Test::Holds(Fluid::from_name(words[0])?))),
    ("contains filled", "At any depth it contains something with a fluid in it.", |_| {
        Some(Test::Contains(Content::Filled))
    }),
    ("contains a CLASS", "At any depth it contains a thing of this class.", |words| {
        Some(Test::Contains(Content::Class(pattern(words))))
    }),
    ("contains FLUID", "At any depth it contains something with this fluid in it.", |words| {
        Some(Test::Contains(Content::Fluid(Fluid::from_name(words[0])?)))
    }),
    ("takes held", "Its keys, if it has any, are of the class of what is held, and it does not refuse that.", |_| {
        Some(Test::TakesHeld)
    }),
    ("has room", "A place is free that a hand can put something at.", |_| Some(Test::HasRoom)),
    ("has room for held", "Such a place is free that what is held fits.", |_| Some(Test::HasRoomForHeld)),
    ("has a free place", "Any place is free.", |_| Some(Test::HasFreePlace)),
    ("has a cartridge", "Something is in it that says what it prints.", |_| Some(Test::HasCartridge)),
    ("sells N", "The slot of this number is not empty.", |words| Some(Test::Sells(words[0].parse().ok()?))),
    ("feeds", "It switches a circuit.", |_| Some(Test::Feeds)),
    ("lets held pass", "What is held may go where the portal leads.", |_| Some(Test::LetsHeldPass)),
    ("answers always", "A press of it is answered although its class affords none.", |_| Some(Test::AnswersAlways)),
];

/// The class in a form that names one.
fn pattern(words: &[&str]) -> ClassPattern {
    ClassPattern(vec![words.concat()])
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
        check("thing is a Floppy_*", false, Term::Thing, Test::IsA(ClassPattern(vec!["Floppy_*".to_owned()])));
        let disk = || ClassPattern(vec!["Floppy_Virus".to_owned()]);
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
            assert_eq!(ClassPattern(vec![pattern.to_owned()]).matches(class), expected, "{pattern} {class}");
        }
    }
}
