//! Errors of the robot that a study plans, and a wizard injects.

use std::{fmt, str::FromStr};

use serde::{Deserialize, Serialize};

use super::{LONGEST_SAYING, NotOfWizard};

/// The longest name of a planned error, in characters.
const LONGEST_NAME: usize = 60;

/// An error that the robot makes when the wizard says so.
#[derive(Clone, Debug, Deserialize, Eq, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct PlannedError {
    /// What it is called in tables and at the seat.
    pub name: String,
    /// What the robot says; of an error in a step, what it would have said, if empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub say: String,
    /// What it does: a plain request; nothing, if empty.
    #[serde(default, rename = "do", skip_serializing_if = "String::is_empty")]
    pub order: String,
    /// The step of the proposed plan, from 1, in the place of which it does that; in place of all, if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub step: Option<u8>,
}

impl PlannedError {
    /// The same, if it can be.
    ///
    /// # Errors
    /// [`NotOfWizard`], if it has no name, or the robot would neither say nor do anything.
    pub fn checked(self) -> Result<Self, NotOfWizard> {
        let is_line = |text: &str, longest: usize| text.chars().count() <= longest && !text.contains('\n');
        if self.name.trim().is_empty() || !is_line(&self.name, LONGEST_NAME) {
            return Err(NotOfWizard::ErrorName(self.name));
        }
        let is_something = !(self.say.is_empty() && self.order.is_empty());
        if !is_something || !is_line(&self.say, LONGEST_SAYING) || !is_line(&self.order, LONGEST_SAYING) {
            return Err(NotOfWizard::ErrorText(self.name));
        }
        let is_counted = match self.step {
            Some(0) => false,
            Some(_) => !self.order.is_empty(),
            None => true,
        };
        if !is_counted {
            return Err(NotOfWizard::ErrorStep(self.name));
        }
        Ok(self)
    }
}

impl fmt::Display for PlannedError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&serde_json::to_string(self).map_err(|_| fmt::Error)?)
    }
}

impl FromStr for PlannedError {
    type Err = NotOfWizard;

    fn from_str(text: &str) -> Result<Self, NotOfWizard> {
        let read: Self = serde_json::from_str(text).map_err(|error| NotOfWizard::PlannedError(error.to_string()))?;
        read.checked()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn planned_errors_read_as_they_are_written() {
        for text in
            [r#"{"name":"wrong object","do":"pick up the apple","step":1}"#, r#"{"name":"forgets","say":"I forgot."}"#]
        {
            assert_eq!(text.parse::<PlannedError>().unwrap().to_string(), text);
        }
        for (wrong, part) in [
            ("wrong object", "is no planned error"),
            (r#"{"name":" ","say":"Oh."}"#, "a name"),
            (r#"{"name":"nothing"}"#, "say or do"),
            (r#"{"name":"a","say":"Oh.","step":1}"#, "counts from 1"),
            (r#"{"name":"a","do":"stop","step":0}"#, "counts from 1"),
            (r#"{"name":"a","says":"Oh."}"#, "unknown field"),
        ] {
            let error = wrong.parse::<PlannedError>().unwrap_err().to_string();
            assert!(error.contains(part), "{wrong}: {error}");
        }
    }
}
