//! What a failed command prints, and its exit code.

use std::{fmt, process::ExitCode};

use crate::terminal::shown_lines;

/// Something the caller gave is wrong: exit code 2. What has a code of its own is [`IncompleteLog`]; all else that fails is 1.
#[derive(Debug)]
pub struct BadInput(pub String);

impl fmt::Display for BadInput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for BadInput {}

/// A log was written, but not all of its session is in it: exit code 3.
#[derive(Debug)]
pub struct IncompleteLog(pub String);

/// The exit code for [`IncompleteLog`].
pub const INCOMPLETE_LOG: u8 = 3;

impl fmt::Display for IncompleteLog {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for IncompleteLog {}

/// A failure that the caller can mend.
pub fn bad_input(message: impl fmt::Display) -> anyhow::Error {
    BadInput(message.to_string()).into()
}

/// Prints an error; gives the exit code it stands for.
pub fn report(error: &anyhow::Error) -> ExitCode {
    let text = format!("{error:#}");
    if !text.is_empty() {
        eprintln!("cohabit: {}", shown_lines(text));
    }
    let is_incomplete = error.is::<IncompleteLog>();
    ExitCode::from(if error.is::<BadInput>() {
        2
    } else if is_incomplete {
        INCOMPLETE_LOG
    } else {
        1
    })
}
