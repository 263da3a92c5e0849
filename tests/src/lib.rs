//! What whole-system tests are made of: a session in real processes, a client of its page, and a real browser.
//!
//! The system tests themselves are test targets of the `cohabit` package, since cargo tells only those where the
//! binary is.

mod browser;
mod lateness;
mod page;
mod play;
mod python;
mod scratch;
mod script;
mod shell;
mod soak;
mod socket;
mod speech;

pub use browser::{Browser, Tab};
pub use lateness::Lateness;
pub use page::{Page, Pen, Received, Sound};
pub use play::{Play, reference_data, run};
pub use python::{output, python_with};
pub use scratch::{Scratch, files};
pub use script::{Block, NotRun, Role, Runner, Told, blocks};
pub use shell::{Call, commands};
pub use soak::{Resident, Soaked, soak};
pub use speech::{SpeechServer, babble, wav};

/// The processor and the number of cores, as benches print them.
#[must_use]
pub fn machine() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text.lines().find_map(|line| line.strip_prefix("model name")?.split(": ").nth(1));
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    format!("{}, {cores} cores", name.unwrap_or("an unknown processor"))
}
