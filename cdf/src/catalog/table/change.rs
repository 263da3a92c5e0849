//! What changes: the closed list of all that an action, a device or a work can do, as the table writes it.

use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::{
    condition::{Condition, Term, read_word},
    form::{self, Form},
};
use crate::state::{Color, Fluid, StateFlag};

/// How much larger `resize` makes small things.
pub const GROWTH: f32 = 1.8;
/// What `restore` undoes of what stays of its kind.
pub const UNDONE: [StateFlag; 4] = [StateFlag::Broken, StateFlag::Eaten, StateFlag::Cooked, StateFlag::Cut];

/// What a sound is made by.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub enum SoundKind {
    /// A door, lid or drawer opens.
    Open,
    /// It closes.
    Close,
    /// A switch or button.
    Click,
    /// A machine starts.
    Machine,
    /// Something breaks.
    Break,
    /// A fluid runs.
    Pour,
    /// An alarm.
    Alarm,
    /// A laser or freeze ray fires.
    Ray,
    /// A discharge.
    Spark,
}

impl SoundKind {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::Open,
        Self::Close,
        Self::Click,
        Self::Machine,
        Self::Break,
        Self::Pour,
        Self::Alarm,
        Self::Ray,
        Self::Spark,
    ];
}

/// One change.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum Change {
    /// `set it Opened`, `clear it Opened`.
    Set(Term, StateFlag, bool),
    /// `copy Toggled it held`: the second takes the flag of the first.
    Copy(StateFlag, Term, Term),
    /// `fill it Water`, `empty it`.
    Fill(Term, Fluid),
    /// `pour held it`: what is in the first goes into the second, if that is empty.
    Pour(Term, Term),
    /// `drain thing Coffee`: this fluid leaves it, and all that is in it.
    Drain(Term, Fluid),
    /// `paint thing Red`.
    Paint(Term, Color),
    /// `approach it`: the body goes there.
    Approach(Term),
    /// `take it`: it goes into the hand.
    Take(Term),
    /// `put held it`: the first goes to a free place of the second.
    Put(Term, Term),
    /// `throw held`: it leaves the hand, and lands somewhere.
    Throw(Term),
    /// `send held it`: the first goes through the portal, and comes back at its foot as the portal leaves it.
    Send(Term, Term),
    /// `flip it`: on if off, off if on; others take the same state: `flip it and machine`.
    Flip(Term, Option<Term>),
    /// `run it`: on for a moment, then off; the device's work is done meanwhile. Others are on as long.
    Run(Term, Option<Term>),
    /// `feed holder it`: the circuit of the first is fed if the second was off, cut if it was on.
    Feed(Term, Term),
    /// `swing doors`: the doors that the button works close if all are open, else open.
    SwingDoors,
    /// `turn machine`: the portal leads to its next time.
    Turn(Term),
    /// `settle it`: what it does to its contents while it is shut and has power.
    Settle(Term),
    /// `slice it`: what the recipe names comes off, beside it.
    Slice(Term),
    /// `restore thing`: it is what it was yesterday.
    Restore(Term),
    /// `become thing Carrot_01`: it, and all in it, is one thing of that class now.
    Become(Term, String),
    /// `print thing`: the product of its cartridge comes out.
    Print(Term),
    /// `spawn thing CoffeeBeans_01`: a thing of that class appears in it, if a place is free.
    Spawn(Term, String),
    /// `remove thing`.
    Remove(Term),
    /// `resize thing`: small things grow, large ones shrink.
    Resize(Term),
    /// `vend thing 1`: what is in that slot falls into the tray.
    Vend(Term, u16),
    /// `scan it`: whoever listens hears that it was scanned.
    Scan(Term),
    /// `read it`: what is written on it is told.
    Read(Term),
    /// `sound Pour it`: this can be heard from there.
    Sound(SoundKind, Term),
}

impl Change {
    /// Whether a press of a device can bring it about at once.
    #[must_use]
    pub const fn is_of_a_press(&self) -> bool {
        matches!(
            self,
            Self::Set(..)
                | Self::Fill(..)
                | Self::Paint(..)
                | Self::Flip(..)
                | Self::Run(..)
                | Self::Feed(..)
                | Self::Turn(_)
                | Self::SwingDoors
                | Self::Sound(..)
        )
    }

    /// Whether the work of a machine can bring it about: nobody is at hand, nothing is pressed, and no other work follows from it,
    /// which might be the same one.
    #[must_use]
    pub const fn is_of_a_work(&self) -> bool {
        !matches!(
            self,
            Self::Approach(_)
                | Self::Take(_)
                | Self::Put(..)
                | Self::Throw(_)
                | Self::Send(..)
                | Self::Run(..)
                | Self::Feed(..)
                | Self::Settle(_)
                | Self::Scan(_)
                | Self::Read(_)
        )
    }
}

/// Changes that follow where all conditions hold.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Effect {
    /// All must hold, before anything changes.
    pub when: Vec<Condition>,
    /// What follows.
    pub changes: Vec<Change>,
}

impl FromStr for Change {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let words: Vec<&str> = text.split_whitespace().collect();
        form::read(FORMS, &words).ok_or_else(|| format!("`{text}`: there is no such change"))
    }
}

/// All changes.
pub(super) const FORMS: &[Form<Change>] = &[
    ("set TERM FLAG", "This state of it becomes true.", |words| {
        Some(Change::Set(term(words[0])?, read_word(words[1])?, true))
    }),
    ("clear TERM FLAG", "This state of it becomes false.", |words| {
        Some(Change::Set(term(words[0])?, read_word(words[1])?, false))
    }),
    ("copy FLAG TERM TERM", "The second takes this state of the first.", |words| {
        Some(Change::Copy(read_word(words[0])?, term(words[1])?, term(words[2])?))
    }),
    ("fill TERM FLUID", "This fluid is in it.", |words| {
        Some(Change::Fill(term(words[0])?, Fluid::from_name(words[1])?))
    }),
    ("empty TERM", "No fluid is in it any more.", |words| Some(Change::Fill(term(words[0])?, Fluid::None))),
    ("pour TERM TERM", "What is in the first goes into the second, if that is empty.", |words| {
        Some(Change::Pour(term(words[0])?, term(words[1])?))
    }),
    ("drain TERM FLUID", "This fluid leaves it, and all that is in it.", |words| {
        Some(Change::Drain(term(words[0])?, Fluid::from_name(words[1])?))
    }),
    ("paint TERM COLOR", "It takes this colour.", |words| {
        Some(Change::Paint(term(words[0])?, Color::from_name(words[1])?))
    }),
    ("approach TERM", "The body goes there.", |words| Some(Change::Approach(term(words[0])?))),
    ("take TERM", "It goes into the hand.", |words| Some(Change::Take(term(words[0])?))),
    ("put TERM TERM", "The first goes to a free place of the second.", |words| {
        Some(Change::Put(term(words[0])?, term(words[1])?))
    }),
    ("throw TERM", "It leaves the hand, and lands somewhere.", |words| Some(Change::Throw(term(words[0])?))),
    ("send TERM TERM", "The first goes through the portal, which is the second, and comes back.", |words| {
        Some(Change::Send(term(words[0])?, term(words[1])?))
    }),
    ("flip TERM", "It is on if it was off, and off if it was on.", |words| Some(Change::Flip(term(words[0])?, None))),
    ("flip TERM and TERM", "The same; the second takes the same state.", |words| {
        Some(Change::Flip(term(words[0])?, Some(term(words[1])?)))
    }),
    ("run TERM", "It is on for a moment; the device's work is done meanwhile.", |words| {
        Some(Change::Run(term(words[0])?, None))
    }),
    ("run TERM and TERM", "The same; the second is on as long.", |words| {
        Some(Change::Run(term(words[0])?, Some(term(words[1])?)))
    }),
    ("feed TERM TERM", "The circuit of the first is fed if the second was off, and cut if it was on.", |words| {
        Some(Change::Feed(term(words[0])?, term(words[1])?))
    }),
    ("swing doors", "The doors that the button works close if all are open; else they open.", |_| {
        Some(Change::SwingDoors)
    }),
    ("turn TERM", "The portal leads to its next time.", |words| Some(Change::Turn(term(words[0])?))),
    ("settle TERM", "It does to its contents what it does while it is shut and has power.", |words| {
        Some(Change::Settle(term(words[0])?))
    }),
    ("slice TERM", "What the recipe names comes off, beside it.", |words| Some(Change::Slice(term(words[0])?))),
    ("restore TERM", "It is what it was yesterday.", |words| Some(Change::Restore(term(words[0])?))),
    ("become TERM CLASS", "It, and all in it, is one thing of that class.", |words| {
        Some(Change::Become(term(words[0])?, words[1].to_owned()))
    }),
    ("print TERM", "The product of its cartridge comes out.", |words| Some(Change::Print(term(words[0])?))),
    ("spawn TERM CLASS", "A thing of that class appears in it, if a place is free.", |words| {
        Some(Change::Spawn(term(words[0])?, words[1].to_owned()))
    }),
    ("remove TERM", "It is gone.", |words| Some(Change::Remove(term(words[0])?))),
    ("resize TERM", "Small things grow, large ones shrink.", |words| Some(Change::Resize(term(words[0])?))),
    ("vend TERM N", "What is in that slot falls into the tray.", |words| {
        Some(Change::Vend(term(words[0])?, words[1].parse().ok()?))
    }),
    ("scan TERM", "Whoever listens hears that it was scanned.", |words| Some(Change::Scan(term(words[0])?))),
    ("read TERM", "What is written on it is told.", |words| Some(Change::Read(term(words[0])?))),
    ("sound SOUND TERM", "This can be heard from there.", |words| {
        Some(Change::Sound(read_word(words[0])?, term(words[1])?))
    }),
];

fn term(word: &str) -> Option<Term> {
    Term::from_name(word)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_are_read() {
        let check = |text: &str, expected| assert_eq!(text.parse(), Ok(expected), "{text}");
        check("clear held Dirty", Change::Set(Term::Held, StateFlag::Dirty, false));
        check("flip it and machine", Change::Flip(Term::It, Some(Term::Machine)));
        check("vend thing 2", Change::Vend(Term::Thing, 2));
        check("sound Pour it", Change::Sound(SoundKind::Pour, Term::It));
        for text in ["heat it", "sound Bang it", "set it"] {
            assert!(text.parse::<Change>().is_err(), "{text}");
        }
    }
}
