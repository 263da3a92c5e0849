//! What a failed command prints, and its exit code.

use std::{fmt, path::Path, process::ExitCode};

use cohabit_bus::BusError;

use crate::terminal::shown_lines;

/// Exit code of [`BadInput`].
pub const BAD_INPUT: u8 = 2;
/// Exit code of [`IncompleteLog`].
pub const INCOMPLETE_LOG: u8 = 3;
/// Exit code of [`Environment`].
pub const ENVIRONMENT: u8 = 4;

/// An argument is wrong, or a file that it names: exit code 2. The same command fails again.
#[derive(Debug)]
pub struct BadInput(pub String);

/// A log was written, but not all of its session is in it: exit code 3.
#[derive(Debug)]
pub struct IncompleteLog(pub String);

/// The machine does not give what is needed now, such as a port or memory: exit code 4. The same command may succeed
/// later.
#[derive(Debug)]
pub struct Environment(pub String);

impl fmt::Display for BadInput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl fmt::Display for IncompleteLog {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl fmt::Display for Environment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for BadInput {}
impl std::error::Error for IncompleteLog {}
impl std::error::Error for Environment {}

/// A failure that other arguments mend.
pub fn bad_input(message: impl fmt::Display) -> anyhow::Error {
    BadInput(message.to_string()).into()
}

/// A failure that the same arguments need not have again.
pub fn environment(message: impl fmt::Display) -> anyhow::Error {
    Environment(message.to_string()).into()
}

/// Refuses a file for which there is no folder, before work is done for it.
pub fn check_folder_of(file: &Path) -> anyhow::Result<()> {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty());
    match folder.filter(|folder| !folder.is_dir()) {
        Some(folder) => Err(bad_input(format!("{}: there is no such folder: make it first", folder.display()))),
        None => Ok(()),
    }
}

/// Why a session could not be joined: its name is an argument, all else is not.
pub fn joining(error: BusError) -> anyhow::Error {
    match error {
        BusError::NoSession { .. } => bad_input(error),
        other => environment(other),
    }
}

/// Prints an error; gives the exit code it stands for: 1 if it is of none of the classes above.
pub fn report(error: &anyhow::Error) -> ExitCode {
    let text = format!("{error:#}");
    if !text.is_empty() {
        eprintln!("cohabit: {}", shown_lines(text));
    }
    ExitCode::from(exit_code(error))
}

fn exit_code(error: &anyhow::Error) -> u8 {
    if error.is::<BadInput>() {
        BAD_INPUT
    } else if error.is::<IncompleteLog>() {
        INCOMPLETE_LOG
    } else if error.is::<Environment>() {
        ENVIRONMENT
    } else {
        1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exit_codes_follow_from_classes() {
        let session = || "s".to_owned();
        for (error, code) in [
            (bad_input("x"), 2),
            (environment("x"), 4),
            (IncompleteLog("x".to_owned()).into(), 3),
            (anyhow::anyhow!("x"), 1),
            (joining(BusError::NoSession { session: session() }), 2),
            (joining(BusError::OtherVersion { session: session(), spoken: 1, own: 2 }), 4),
            (joining(BusError::Join { session: session(), reason: "x".to_owned() }), 4),
        ] {
            assert_eq!(exit_code(&error), code, "{error}");
        }
    }
}
