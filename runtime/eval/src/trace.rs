//! The session log of a task played in lock-step: the same entries as of a session that people played.

use std::path::Path;

use cohabit_bus::{
    Envelope,
    message::{DialogMessage, DialogView, EventMessage},
    monotonic_nanos, wall_nanos,
};
use cohabit_cdf::BodyId;
use cohabit_engine::{SessionPlan, report};
use cohabit_record::{
    DialogEntry, EventEntry, InputEntry, LogError, LogWriter, SessionEntry, SessionFacts, TickEntry, entry::hex,
};
use cohabit_world::{Event, Input, World};

/// Writes a log.
pub struct Trace {
    log: LogWriter,
}

impl Trace {
    /// Creates the log of `plan`, which must not exist.
    pub fn create(path: &Path, facts: &SessionFacts, plan: &SessionPlan) -> Result<Self, LogError> {
        let entry = SessionEntry::new(facts, &plan.message());
        let entry = entry.with(&plan.catalog, &plan.layout);
        Ok(Self { log: LogWriter::create(path, &entry, wall_nanos())? })
    }

    fn tick(&mut self, world: &World, inputs: Vec<InputEntry>) -> Result<(), LogError> {
        let digest = hex(&world.digest());
        self.log.tick(&TickEntry { tick: world.tick(), digest, wall_nanos: wall_nanos(), inputs })
    }

    /// A tick was made of these inputs, and this happened in it.
    pub fn step(&mut self, world: &World, inputs: Vec<InputEntry>, events: &[Event]) -> Result<(), LogError> {
        let tick = world.tick();
        let started: Vec<EventMessage> =
            inputs.iter().map(|entry| report::started(&input(entry), entry.turn)).collect();
        self.tick(world, inputs)?;
        for message in &started {
            self.event(tick, message)?;
        }
        for event in events {
            self.event(tick, &report::event(world, event))?;
        }
        Ok(())
    }

    /// Something happened.
    pub fn event(&mut self, tick: u64, message: &EventMessage) -> Result<(), LogError> {
        match EventEntry::new(&Envelope { tick, ..Envelope::default() }, message) {
            Some(entry) => self.log.event(&entry, wall_nanos()),
            None => Ok(()),
        }
    }

    /// Something was said or planned.
    pub fn dialog(&mut self, tick: u64, message: &DialogMessage) -> Result<(), LogError> {
        let envelope = Envelope { sent_nanos: monotonic_nanos(), ..Envelope::default() };
        let view = DialogView { header: &message.header, steps: &message.steps };
        match DialogEntry::new(tick, &envelope, view) {
            Some(entry) => self.log.dialog(&entry, wall_nanos()),
            None => Ok(()),
        }
    }

    /// Ends the log.
    pub fn finish(self) -> Result<(), LogError> {
        self.log.finish()
    }
}

/// An input as the world takes it.
pub fn input(entry: &InputEntry) -> Input {
    Input { command: entry.command, body: BodyId(entry.body), action: entry.action }
}
