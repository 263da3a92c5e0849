//! The session log of a task played in lock-step: the same entries as of a session that people played.

use std::{collections::BTreeMap, path::Path};

use cohabit_bus::{
    Envelope,
    message::{DialogMessage, DialogView, EventMessage},
    monotonic_nanos, wall_nanos,
};
use cohabit_engine::{SessionPlan, report};
use cohabit_generate::Observer;
use cohabit_record::{
    DialogEntry, EventEntry, InputEntry, Log, LogError, LogWriter, SessionEntry, SessionFacts, TickEntry, entry::hex,
};
use cohabit_world::{Input, Outcome, Report, World};

/// What is kept of a session: its log, if one is wanted, and the turns that commands belong to.
#[derive(Default)]
pub struct Recording {
    log: Option<LogWriter>,
    /// The turn of each command that has one; it stays until it is taken out.
    pub turns: BTreeMap<u64, u64>,
}

impl Recording {
    /// Records all that follows in the log of `plan`, which must not exist.
    pub fn begin(&mut self, path: &Path, facts: &SessionFacts, plan: &SessionPlan) -> Result<(), LogError> {
        let entry = SessionEntry::new(facts, &plan.message());
        let entry = entry.with(&plan.catalog, &plan.layout);
        self.log = Some(LogWriter::create(path, &entry, wall_nanos())?);
        Ok(())
    }

    /// Records all that follows in a new log, behind what another log has up to a tick, and of its dialog so many entries.
    pub fn after(path: &Path, entry: &SessionEntry, log: &Log, tick: u64, dialog: usize) -> Result<Self, LogError> {
        let mut writer = LogWriter::create(path, entry, wall_nanos())?;
        let mut copied = Copied { log, dialog: &log.dialog[..dialog], events: 0, said: 0, snapshots: 0 };
        if let Some(first) = log.ticks.first() {
            copied.up_to(first.tick.saturating_sub(1), first.wall_nanos, &mut writer)?;
        }
        let mut turns = BTreeMap::new();
        for entry in log.ticks.iter().take_while(|entry| entry.tick <= tick) {
            writer.tick(entry)?;
            copied.up_to(entry.tick, entry.wall_nanos, &mut writer)?;
            turns.extend(entry.inputs.iter().map(|input| (input.command, input.turn)));
        }
        Ok(Self { log: Some(writer), turns })
    }

    /// Something was said or planned.
    pub fn dialog(&mut self, tick: u64, message: &DialogMessage) -> Result<(), LogError> {
        let Some(log) = &mut self.log else { return Ok(()) };
        let envelope = Envelope { sent_nanos: monotonic_nanos(), ..Envelope::default() };
        let view = DialogView { header: &message.header, steps: &message.steps };
        match DialogEntry::new(tick, &envelope, view) {
            Some(entry) => log.dialog(&entry, wall_nanos()),
            None => Ok(()),
        }
    }

    /// Ends the log.
    pub fn finish(&mut self) -> Result<(), LogError> {
        self.log.take().map_or(Ok(()), LogWriter::finish)
    }
}

impl Observer for Recording {
    type Error = LogError;

    fn note(&mut self, world: &World, inputs: &[Input], told: &Report) -> Result<(), LogError> {
        let Self { log: Some(log), turns } = self else { return Ok(()) };
        let turn = |command: u64| turns.get(&command).copied().unwrap_or(0);
        let entry = |Input { command, body, action }: &Input| InputEntry {
            command: *command,
            turn: turn(*command),
            body: body.0,
            action: *action,
        };
        let (tick, digest) = (world.tick(), hex(&world.digest()));
        let entries = inputs.iter().map(entry).collect();
        log.tick(&TickEntry { tick, digest, wall_nanos: wall_nanos(), inputs: entries })?;
        let started = inputs.iter().map(|input| report::started(input, turn(input.command)));
        let happened = told.events.iter().map(|event| report::event(world, event));
        let ended = told.outcomes.iter().map(|Outcome { command, body, status, detail }| {
            EventMessage::outcome(*command, turn(*command), body.0, *status, detail)
        });
        for message in started.chain(happened).chain(ended) {
            if let Some(entry) = EventEntry::new(&Envelope { tick, ..Envelope::default() }, &message) {
                log.event(&entry, wall_nanos())?;
            }
        }
        Ok(())
    }
}

/// How far a log was copied, tick by tick.
struct Copied<'a> {
    log: &'a Log,
    /// What of its dialog is copied.
    dialog: &'a [DialogEntry],
    events: usize,
    said: usize,
    snapshots: usize,
}

impl Copied<'_> {
    /// Copies what was noted up to a tick, which began at that time.
    fn up_to(&mut self, tick: u64, wall_nanos: u64, writer: &mut LogWriter) -> Result<(), LogError> {
        let (log, dialog) = (self.log, self.dialog);
        while let Some(snapshot) = log.snapshots.get(self.snapshots).filter(|one| one.tick <= tick) {
            self.snapshots += 1;
            writer.snapshot(snapshot, wall_nanos)?;
        }
        while let Some(entry) = log.events.get(self.events).filter(|entry| entry.tick <= tick) {
            self.events += 1;
            writer.event(entry, wall_nanos)?;
        }
        while let Some(entry) = dialog.get(self.said).filter(|entry| entry.tick <= tick) {
            self.said += 1;
            writer.dialog(entry, wall_nanos)?;
        }
        Ok(())
    }
}
