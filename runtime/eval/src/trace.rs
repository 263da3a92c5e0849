//! The session log of a task played in lock-step: the same entries as of a session that people played.

use std::{
    path::Path,
    time::{SystemTime, UNIX_EPOCH},
};

use cohabit_bus::{
    Envelope,
    message::{DialogMessage, DialogView, EventMessage},
    monotonic_nanos,
};
use cohabit_engine::SessionPlan;
use cohabit_record::{DialogEntry, EventEntry, InputEntry, LogError, LogWriter, SessionEntry, TickEntry, entry::hex};
use cohabit_world::World;

/// Writes a log.
pub struct Trace {
    log: LogWriter,
}

impl Trace {
    /// Creates the log of `plan`, which must not exist.
    pub fn create(path: &Path, session: &str, plan: &SessionPlan) -> Result<Self, LogError> {
        let entry = SessionEntry {
            format: SessionEntry::FORMAT,
            program: env!("CARGO_PKG_VERSION").to_owned(),
            session: session.to_owned(),
            mission_file: plan.file.clone(),
            mission_text: plan.text.clone(),
            seed: plan.seed,
            bodies: plan.bodies.clone(),
        };
        Ok(Self { log: LogWriter::create(path, &entry, wall_nanos())? })
    }

    /// A tick was made of these inputs.
    pub fn tick(&mut self, world: &World, inputs: Vec<InputEntry>) -> Result<(), LogError> {
        let digest = hex(&world.digest());
        self.log.tick(&TickEntry { tick: world.tick(), digest, wall_nanos: wall_nanos(), inputs })
    }

    /// Something happened.
    pub fn event(&mut self, tick: u64, message: &EventMessage) -> Result<(), LogError> {
        match EventEntry::new(tick, message) {
            Some(entry) => self.log.event(&entry, wall_nanos()),
            None => Ok(()),
        }
    }

    /// Something was said or planned.
    pub fn dialog(&mut self, message: &DialogMessage) -> Result<(), LogError> {
        let envelope = Envelope { sent_nanos: monotonic_nanos(), ..Envelope::default() };
        let view = DialogView { header: &message.header, steps: &message.steps };
        match DialogEntry::new(&envelope, view) {
            Some(entry) => self.log.dialog(&entry, wall_nanos()),
            None => Ok(()),
        }
    }

    /// Ends the log.
    pub fn finish(self) -> Result<(), LogError> {
        self.log.finish()
    }
}

fn wall_nanos() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    u64::try_from(since.as_nanos()).unwrap_or(u64::MAX)
}
