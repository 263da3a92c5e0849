//! What is waited for, and what is done then.

use serde::{Deserialize, Serialize};

use crate::words::token;

/// What is waited for.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) enum Until {
    /// So many seconds.
    Seconds(f32),
    /// That this is so: `the mug is full`.
    So(Vec<String>),
}

/// What is done after a wait.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct Awaited {
    pub(crate) until: Until,
    /// As somebody would say it.
    pub(crate) then: Vec<String>,
    /// When the wait began, s; nothing before [`crate::Language::wake`] was called.
    pub(crate) since_s: Option<f64>,
}

impl Until {
    pub(crate) fn seconds(&self) -> f32 {
        if let Self::Seconds(seconds) = self { *seconds } else { 0.0 }
    }

    pub(crate) fn in_words(&self) -> String {
        match self {
            Self::So(claim) => token::sentence(claim),
            Self::Seconds(seconds) if *seconds >= 120.0 && seconds % 60.0 == 0.0 => {
                format!("{} minutes", seconds / 60.0)
            }
            Self::Seconds(seconds) => format!("{seconds} seconds"),
        }
    }
}
