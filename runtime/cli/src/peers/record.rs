//! The recorder's process.

use std::{ffi::OsString, net::SocketAddr, path::PathBuf, sync::Arc};

use cohabit_record::{LogError, RecordError, Recorder};

use super::{Joining, Noted, tell_supervisor};
use crate::{
    failure::{IncompleteLog, bad_input},
    rerun,
    world::WorldPacks,
};

/// Writes the session log. Exit code 3 says that some of the session is not in it.
#[derive(clap::Args)]
pub struct Record {
    #[command(flatten)]
    joining: Joining,
    /// The log file to write; one of the same session is carried on with
    #[arg(long)]
    log: PathBuf,
    #[command(flatten)]
    noted: Noted,
    #[command(flatten)]
    watching: Watching,
    #[command(flatten)]
    packs: WorldPacks,
}

/// Who watches a session besides its pages.
#[derive(clap::Args, Clone, Copy, Debug, Default)]
pub struct Watching {
    /// Show the session live in rerun's viewer at an address; where none listens, one is started
    #[arg(long, value_name = "ADDRESS", num_args = 0..=1, require_equals = true, default_missing_value = "127.0.0.1:9876")]
    rerun: Option<SocketAddr>,
}

impl Watching {
    /// Says what is missing for it, before anything of a session with these packs is started.
    pub fn check(self, packs: &WorldPacks) -> anyhow::Result<()> {
        if self.rerun.is_none() {
            return Ok(());
        }
        if !packs.is_empty() {
            return Err(bad_input("`--rerun` cannot show a session of a world pack yet: leave it out"));
        }
        rerun::check()
    }

    /// The same as arguments of another process.
    pub fn arguments(self) -> Option<OsString> {
        self.rerun.map(|viewer| format!("--rerun={viewer}").into())
    }

    fn start(self, session: &str) -> anyhow::Result<Option<rerun::Live>> {
        self.rerun.map(|viewer| rerun::Live::start(session, viewer)).transpose()
    }
}

impl Record {
    /// Runs the recorder.
    pub fn run(&self) -> anyhow::Result<()> {
        let world = self.packs.read()?;
        let (bus, stop) = self.joining.join()?;
        let _live = self.watching.start(&self.joining.session)?;
        let caught_up = || tell_supervisor(&format!("recording {}", self.log.display()));
        let facts = self.noted.facts(&self.joining.session);
        let recorder = Recorder::new(&bus)?.knowing(Arc::clone(world.catalog())).filming(&bus, &facts.frames)?;
        let recorder = if facts.audio { recorder.taping(&bus)? } else { recorder };
        recorder.run(&facts, &self.log, &stop, caught_up).map_err(classified)
    }
}

/// What an error is to whoever started the recorder.
fn classified(error: RecordError) -> anyhow::Error {
    match error {
        RecordError::Incomplete { .. } | RecordError::Log(LogError::Disk { .. }) => {
            IncompleteLog(error.to_string()).into()
        }
        RecordError::Log(
            LogError::File { .. }
            | LogError::Busy { .. }
            | LogError::OtherSession { .. }
            | LogError::NotALog { .. }
            | LogError::TooNew { .. },
        ) => bad_input(error),
        other => other.into(),
    }
}
