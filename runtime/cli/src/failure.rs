//! What a failed command prints, and its exit code.

use std::{fmt, process::ExitCode};

use crate::terminal::shown_lines;

/// Something the caller gave is wrong: exit code 2. All else that fails is 1.
#[derive(Debug)]
pub struct BadInput(pub String);

impl fmt::Display for BadInput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for BadInput {}

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
    ExitCode::from(if error.is::<BadInput>() { 2 } else { 1 })
}
