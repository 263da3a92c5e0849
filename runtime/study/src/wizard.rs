//! How a wizard takes part in the sessions of a study that have one.

use cohabit_dialog::{OnTimeout, Phrase, PlannedError};

/// How a wizard takes part.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wizard {
    /// How long they may take to decide, s; as long as they like, if absent.
    pub timeout_s: Option<f64>,
    /// What follows then.
    pub on_timeout: OnTimeout,
    /// What the robot says then, if that is what follows and it is not the usual.
    pub moment: Option<String>,
    /// What they can have the robot say by a key.
    pub phrases: Vec<Phrase>,
    /// The errors that they can have the robot make.
    pub errors: Vec<PlannedError>,
}
