//! What every agent does.

use cohabit_bus::message::{BodyRecord, DialogMessage, PlanStep, StateView};
use cohabit_cdf::{Action, Status};

use crate::eyes::Sight;

/// Simulated time passes in ticks, so many a second.
pub const TICKS_PER_SECOND: u64 = 60;

/// A mind for one body.
pub trait Agent {
    /// What it takes in besides what it is told.
    fn senses(&self) -> Senses {
        Senses::default()
    }

    /// Takes in what happened, and appends what it does about it.
    fn hear(&mut self, heard: &Heard<'_>, deeds: &mut Vec<Deed>);
}

/// What an agent takes in of the world. What nobody takes in is not made.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Senses {
    /// What its own camera shows, and what there is to know of the things in view.
    pub sight: bool,
    /// The whole state of the world.
    pub state: bool,
}

/// What an agent learns.
#[derive(Clone, Copy, Debug)]
pub enum Heard<'a> {
    /// It is asked to do these steps; a plan asked for before is over.
    Plan {
        /// The dialog turn they belong to.
        turn: u64,
        /// What to do, in order.
        steps: &'a [PlanStep],
    },
    /// What came of the latest [`Deed::Act`].
    Outcome {
        /// How it went.
        status: Status,
        /// The world's sentence about it.
        detail: &'a str,
    },
    /// Whether it commands its body now: others may take it over, and hand it back.
    Commands(bool),
    /// How the world is now. In lock-step, once a turn; in real time, as often as there is something new to sense.
    Now(&'a Now<'a>),
}

/// The present, as far as an agent senses it.
#[derive(Clone, Copy, Debug)]
pub struct Now<'a> {
    /// The tick.
    pub tick: u64,
    /// Its own body, if it senses anything.
    pub own: Option<&'a BodyRecord>,
    /// What it sees.
    pub sight: Option<&'a Sight<'a>>,
    /// All there is.
    pub state: Option<StateView<'a>>,
}

/// What an agent does.
#[derive(Clone, Debug, PartialEq)]
pub enum Deed {
    /// Commands its body; the command before, if still under way, is interrupted and its outcome not heard.
    Act {
        /// The dialog turn it belongs to; 0 is none.
        turn: u64,
        /// What to do.
        action: Action,
    },
    /// Tells the others.
    Tell(Box<DialogMessage>),
    /// It need not be told how the world is for so many ticks, or before an outcome of its body.
    Rest(u64),
}
