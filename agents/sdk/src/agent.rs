//! What every agent does.

use cohabit_bus::message::{DialogMessage, PlanStep};
use cohabit_cdf::{Action, Status};

/// A mind for one body.
pub trait Agent {
    /// Takes in what happened, and appends what it does about it.
    fn hear(&mut self, heard: &Heard<'_>, deeds: &mut Vec<Deed>);
}

/// What an agent learns.
#[derive(Clone, Copy, Debug, PartialEq)]
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
}
