//! Session logs of which some may be damaged.

use std::{path::PathBuf, sync::Arc};

use cohabit_cdf::Catalog;
use cohabit_tables::{Played, PlayedError};

use crate::{failure::bad_input, movement::with_movement};

/// The sessions of those of several logs that can be read, and what is wrong with the others: a log that lost its end, or all of it, when
/// a machine went down keeps nobody from the rest.
pub struct ReadLogs {
    /// The sessions, with how bodies moved in them.
    pub played: Vec<Played>,
    unread: Vec<(PathBuf, PlayedError)>,
}

impl ReadLogs {
    /// Reads logs. Where none of them can be read, that is an error at once.
    pub fn new(logs: &[PathBuf], catalog: &Arc<Catalog>) -> anyhow::Result<Self> {
        let (played, unread) = Played::open_readable(logs, catalog);
        let read = Self { played: with_movement(played, catalog), unread };
        if read.played.is_empty() {
            read.check()?;
        }
        Ok(read)
    }

    /// Those of these logs that can be read.
    pub fn readable(&self, logs: &[PathBuf]) -> Vec<PathBuf> {
        let is_unread = |log: &PathBuf| self.unread.iter().any(|(path, _)| path == log);
        logs.iter().filter(|log| !is_unread(log)).cloned().collect()
    }

    /// Names the logs that could not be read, all at once: what was made is of the others.
    pub fn check(&self) -> anyhow::Result<()> {
        let (read, unread) = (self.played.len(), self.unread.len());
        match &self.unread[..] {
            [] => Ok(()),
            [(_, error)] if read == 0 => Err(bad_input(error)),
            all => {
                let reasons: Vec<String> = all.iter().map(|(_, error)| format!("  {error}")).collect();
                let reasons = reasons.join("\n");
                let count = format!("{unread} of {}", read + unread);
                Err(bad_input(format!("{count} logs cannot be read, and are left out:\n{reasons}")))
            }
        }
    }
}
