//! Being asked to end.

use std::sync::{Arc, atomic::AtomicBool};

use anyhow::Context as _;
use rustix::process::{Pid, Signal, getppid, set_parent_process_death_signal};
use signal_hook::consts::{SIGINT, SIGTERM};

/// Becomes true at Ctrl-C or a termination request. Ending is bounded in time, so an impatient second one changes
/// nothing, and all is cleaned up all the same.
pub fn on_request() -> anyhow::Result<Arc<AtomicBool>> {
    let stop = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        signal_hook::flag::register(signal, Arc::clone(&stop)).context("signals")?;
    }
    Ok(stop)
}

/// Makes this process end with the supervisor that started it, however that one ends.
pub fn with_supervisor(supervisor: Option<i32>) -> anyhow::Result<()> {
    let Some(supervisor) = supervisor.and_then(Pid::from_raw) else { return Ok(()) };
    set_parent_process_death_signal(Some(Signal::TERM)).context("ask to end with the supervisor")?;
    anyhow::ensure!(getppid() == Some(supervisor), "the supervisor is gone already");
    Ok(())
}
