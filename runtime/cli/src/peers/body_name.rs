//! What bodies are called.

use std::{fmt, str::FromStr};

/// The longest name of a body, in characters.
const LONGEST_NAME: usize = 24;

/// What a body is called.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct BodyName {
    /// Which.
    pub body: u32,
    /// Its name.
    pub name: String,
}

impl FromStr for BodyName {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (body, name) =
            text.split_once('=').ok_or_else(|| "write a body and its name, such as `0=Rosie`".to_owned())?;
        let body = body.parse().map_err(|_| format!("`{body}` is no body: bodies count from 0, such as `0={name}`"))?;
        let is_name =
            |name: &str| name.chars().all(|c| c.is_alphanumeric() || c == ' ') && name.contains(char::is_alphabetic);
        let name = name.trim();
        if !is_name(name) || name.chars().count() > LONGEST_NAME {
            return Err(format!(
                "`{name}` is no name: up to {LONGEST_NAME} letters, digits and spaces, such as `Rosie`"
            ));
        }
        Ok(Self { body, name: name.to_owned() })
    }
}

impl fmt::Display for BodyName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.body, self.name)
    }
}
