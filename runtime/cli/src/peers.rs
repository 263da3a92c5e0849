//! The processes of a session, each of which can also be started by hand.

mod agent;
mod body_name;
mod bridge;
mod dialog;
mod listening;
mod noted;
mod record;
mod sim;
mod timing;

use std::{
    io::Write as _,
    sync::{Arc, atomic::AtomicBool},
};

use cohabit_bus::{Session, Shm};

use crate::{
    failure::{bad_input, joining},
    stop,
};

pub use agent::Agent;
pub use bridge::Bridge;
pub use dialog::{Dialog, journal};
pub use listening::Listening;
pub use noted::{NAME_OF, Noted, label};
pub use record::{Record, Watching};
pub use sim::Sim;
pub use timing::{Timing, speed};

/// What all peers of a session are told.
#[derive(clap::Args)]
pub struct Joining {
    /// The session's name
    #[arg(long)]
    session: String,
    /// The process that supervises this one
    #[arg(long, hide = true)]
    supervisor: Option<i32>,
}

impl Joining {
    fn join(&self) -> anyhow::Result<(Shm, Arc<AtomicBool>)> {
        let stop = stop::on_request()?;
        stop::with_supervisor(self.supervisor)?;
        let session = Session::new(&self.session).map_err(bad_input)?;
        Ok((Shm::join(&session).map_err(joining)?, stop))
    }
}

/// Tells whoever started this process a line.
fn tell_supervisor(line: &str) {
    let mut out = std::io::stdout().lock();
    // Nobody listening is no reason to stop serving.
    let _ = writeln!(out, "{line}").and_then(|()| out.flush());
}
