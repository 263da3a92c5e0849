//! What changes: the closed list of all that an action, a device or a work can do, as the table writes it.

use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::condition::{Condition, Term, read_word};
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

    /// Whether the work of a machine can bring it about: nobody is at hand, and nothing is pressed.
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
        read(&words).ok_or_else(|| format!("`{text}`: there is no such change"))
    }
}

fn read(words: &[&str]) -> Option<Change> {
    let term = Term::from_name;
    Some(match words {
        ["set", of, flag] => Change::Set(term(of)?, read_word(flag)?, true),
        ["clear", of, flag] => Change::Set(term(of)?, read_word(flag)?, false),
        ["copy", flag, from, to] => Change::Copy(read_word(flag)?, term(from)?, term(to)?),
        ["fill", of, fluid] => Change::Fill(term(of)?, Fluid::from_name(fluid)?),
        ["empty", of] => Change::Fill(term(of)?, Fluid::None),
        ["pour", from, to] => Change::Pour(term(from)?, term(to)?),
        ["drain", of, fluid] => Change::Drain(term(of)?, Fluid::from_name(fluid)?),
        ["paint", of, color] => Change::Paint(term(of)?, Color::from_name(color)?),
        ["approach", of] => Change::Approach(term(of)?),
        ["take", of] => Change::Take(term(of)?),
        ["put", of, to] => Change::Put(term(of)?, term(to)?),
        ["throw", of] => Change::Throw(term(of)?),
        ["send", of, by] => Change::Send(term(of)?, term(by)?),
        ["flip", of] => Change::Flip(term(of)?, None),
        ["flip", of, "and", other] => Change::Flip(term(of)?, Some(term(other)?)),
        ["run", of] => Change::Run(term(of)?, None),
        ["run", of, "and", other] => Change::Run(term(of)?, Some(term(other)?)),
        ["feed", of, by] => Change::Feed(term(of)?, term(by)?),
        ["swing", "doors"] => Change::SwingDoors,
        ["turn", of] => Change::Turn(term(of)?),
        ["settle", of] => Change::Settle(term(of)?),
        ["slice", of] => Change::Slice(term(of)?),
        ["restore", of] => Change::Restore(term(of)?),
        ["become", of, class] => Change::Become(term(of)?, (*class).to_owned()),
        ["print", of] => Change::Print(term(of)?),
        ["spawn", of, class] => Change::Spawn(term(of)?, (*class).to_owned()),
        ["remove", of] => Change::Remove(term(of)?),
        ["resize", of] => Change::Resize(term(of)?),
        ["vend", of, slot] => Change::Vend(term(of)?, slot.parse().ok()?),
        ["scan", of] => Change::Scan(term(of)?),
        ["read", of] => Change::Read(term(of)?),
        ["sound", kind, of] => Change::Sound(read_word(kind)?, term(of)?),
        _ => return None,
    })
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
