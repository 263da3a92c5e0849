//! The recorder: a peer that writes down what passes on the bus.

use std::{
    io::Write,
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

use cohabit_bus::{
    BusError, CameraId, Heart, Inbox, Listener, Sample, Topic, Transport, Wake,
    message::{self, AnswerMessage, DialogView, EventMessage, Malformed, MissionMessage, NONE, SnapshotView, TickView},
    process_of, wall_nanos,
};
use cohabit_cdf::{Catalog, Layout, mission::read_mission};

use crate::{
    carry_on::Written,
    entry::{AnswerEntry, DialogEntry, EventEntry, GapEntry, SessionEntry, SessionFacts, TickEntry},
    film::Film,
    log::LogError,
    snapshot::Snapshot,
    tape::Tape,
    turns::Turns,
    writer::LogWriter,
};

/// The longest that an entry stays in this process alone.
const FLUSH_EVERY: Duration = Duration::from_millis(100);

/// All peers hand what they keep to late joiners within this time.
const GREETED_WITHIN: Duration = Duration::from_millis(300);

/// Why recording ended early.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The bus failed.
    #[error(transparent)]
    Bus(#[from] BusError),
    /// The log failed.
    #[error(transparent)]
    Log(#[from] LogError),
    /// A peer sent nonsense.
    #[error(transparent)]
    Malformed(#[from] Malformed),
    /// There is nothing to record.
    #[error("no simulator has published a mission yet")]
    NoMission,
    /// The log was written to its end, but not all that passed on the bus is in it.
    #[error(
        "{path} is incomplete: {missing} messages are missing in it, as its recorder was away, or its disk slow, for too long; \
         `cohabit replay` says which"
    )]
    Incomplete {
        /// Which.
        path: PathBuf,
        /// How many messages.
        missing: u64,
    },
}

/// Records one session.
pub struct Recorder {
    mission: Inbox,
    ticks: Inbox,
    events: Inbox,
    dialog: Inbox,
    answers: Inbox,
    snapshots: Inbox,
    films: Vec<Film>,
    tape: Option<Tape>,
    listener: Box<dyn Listener>,
    heart: Heart,
    turns: Turns,
    /// The catalogue that the session is played with; the built-in one, if nothing is said.
    catalog: Option<Arc<Catalog>>,
}

/// What was published before a recorder took it down.
struct Began {
    run: u64,
    mission: MissionMessage,
}

impl Recorder {
    /// Subscribes to all that is recorded.
    ///
    /// # Errors
    /// [`BusError`].
    pub fn new(bus: &dyn Transport) -> Result<Self, BusError> {
        Ok(Self {
            mission: Inbox::new(bus, Topic::Mission)?,
            ticks: Inbox::new(bus, Topic::Ticks)?,
            events: Inbox::new(bus, Topic::Events)?,
            dialog: Inbox::new(bus, Topic::Dialog)?,
            answers: Inbox::new(bus, Topic::Answers)?,
            snapshots: Inbox::new(bus, Topic::Snapshots)?,
            films: Vec::new(),
            tape: None,
            listener: bus.listener(Wake::State)?,
            heart: Heart::new(bus, "recorder", NONE)?,
            turns: Turns::new(bus)?,
            catalog: None,
        })
    }

    /// The same of a session that is played with this catalogue.
    #[must_use]
    pub fn knowing(self, catalog: Arc<Catalog>) -> Self {
        Self { catalog: Some(catalog), ..self }
    }

    /// The same with the frames of these cameras, which are then rendered whether or not anybody else looks.
    ///
    /// # Errors
    /// [`BusError`].
    pub fn filming(self, bus: &dyn Transport, cameras: &[CameraId]) -> Result<Self, BusError> {
        let films = cameras.iter().map(|camera| Film::new(bus, *camera)).collect::<Result<_, _>>()?;
        Ok(Self { films, ..self })
    }

    /// The same with what is said aloud.
    ///
    /// # Errors
    /// [`BusError`].
    pub fn taping(self, bus: &dyn Transport) -> Result<Self, BusError> {
        Ok(Self { tape: Some(Tape::new(bus)?), ..self })
    }

    /// Records until `stop`, then ends the log. Writes nothing if no simulator ever came. Where the log is there already,
    /// it carries on with it: an earlier recorder of the same session was killed. `caught_up` is called once, when all
    /// that peers keep for who joins late has been taken down.
    ///
    /// # Errors
    /// [`RecordError`]; [`RecordError::Incomplete`] when all went well but for what this recorder, or an earlier one of the
    /// same log, could not take down in time.
    pub fn run(
        mut self,
        facts: &SessionFacts,
        path: &Path,
        stop: &AtomicBool,
        caught_up: impl FnOnce(),
    ) -> Result<(), RecordError> {
        let Some(began) = self.wait_for_mission(stop)? else { return Ok(()) };
        let (entry, now) = (self.entry(&began, facts), wall_nanos());
        let (log, written) = match LogWriter::carry_on(path, &entry, now) {
            Err(LogError::File { source, .. }) if source.kind() == std::io::ErrorKind::NotFound => {
                (LogWriter::create(path, &entry, now)?, Written::default())
            }
            found => found?,
        };
        let mut recording = Recording::new(self, process_of(began.run), log, written);
        if began.mission.header.lock_step == 1 {
            recording.recorder.turns.attend()?;
        }
        let (opened, mut caught_up) = (Instant::now(), Some(caught_up));
        while !stop.load(Ordering::Relaxed) {
            recording.recorder.listener.wait(FLUSH_EVERY)?;
            let is_waited_for = recording.recorder.turns.has_come()?;
            recording.take_down()?;
            // Tick by tick: what was published before this process is killed can be read after.
            recording.flush()?;
            if is_waited_for {
                recording.recorder.turns.end()?;
            }
            if let Some(caught_up) = caught_up.take_if(|_| opened.elapsed() > GREETED_WITHIN) {
                caught_up();
            }
        }
        match recording.finish()? {
            0 => Ok(()),
            missing => Err(RecordError::Incomplete { path: path.to_owned(), missing }),
        }
    }

    /// Begins the log of a simulator that has published its mission already, for somebody who says when there is
    /// something to take down: where the world runs as fast as it can, a recorder beside it would miss ticks.
    ///
    /// # Errors
    /// [`RecordError`].
    pub fn begin(mut self, facts: &SessionFacts, path: &Path) -> Result<Recording, RecordError> {
        let began = self.mission()?.ok_or(RecordError::NoMission)?;
        let log = LogWriter::create(path, &self.entry(&began, facts), wall_nanos())?;
        Ok(Recording::new(self, process_of(began.run), log, Written::default()))
    }

    /// The same with a log that goes to `out`.
    ///
    /// # Errors
    /// [`RecordError`].
    pub fn begin_in(mut self, facts: &SessionFacts, out: Box<dyn Write + Send>) -> Result<Recording, RecordError> {
        let began = self.mission()?.ok_or(RecordError::NoMission)?;
        let log = LogWriter::begin(Path::new("the log"), out, &self.entry(&began, facts), wall_nanos())?;
        Ok(Recording::new(self, process_of(began.run), log, Written::default()))
    }

    fn entry(&self, began: &Began, facts: &SessionFacts) -> SessionEntry {
        match &self.catalog {
            Some(catalog) => began.entry(facts, catalog),
            None => began.entry(facts, &Catalog::builtin()),
        }
    }

    fn mission(&mut self) -> Result<Option<Began>, RecordError> {
        let mut newest = None;
        while let Some((sample, mission)) = self.mission.next(|sample| MissionMessage::read(sample.payload()))? {
            newest = Some(Began { run: sample.envelope().run, mission });
        }
        Ok(newest)
    }

    fn wait_for_mission(&mut self, stop: &AtomicBool) -> Result<Option<Began>, RecordError> {
        loop {
            match self.mission()? {
                None if stop.load(Ordering::Relaxed) => return Ok(None),
                None => self.listener.wait(FLUSH_EVERY)?,
                began => return Ok(began),
            };
        }
    }
}

impl Began {
    fn entry(&self, facts: &SessionFacts, catalog: &Catalog) -> SessionEntry {
        let entry = SessionEntry { run: self.run, ..SessionEntry::new(facts, &self.mission) };
        // What cannot be read was not played by a simulator of this program.
        let checked = read_mission(&entry.mission_file, &entry.mission_text, catalog).ok();
        match checked.and_then(|checked| Layout::find(&checked.mission.layout, catalog).ok()) {
            Some(layout) => entry.with(catalog, &layout),
            None => entry,
        }
    }
}

/// A log that is being written.
pub struct Recording {
    recorder: Recorder,
    log: LogWriter,
    written: Written,
    /// The process that publishes ticks and events.
    simulator: u32,
    /// How many messages the log lacks.
    missing: u64,
    flushed: Instant,
}

impl Recording {
    fn new(recorder: Recorder, simulator: u32, log: LogWriter, written: Written) -> Self {
        let missing = written.missing;
        Self { recorder, log, written, simulator, missing, flushed: Instant::now() }
    }

    /// Takes down all that was published since the last time.
    ///
    /// # Errors
    /// [`RecordError`].
    pub fn take_down(&mut self) -> Result<(), RecordError> {
        self.drain()?;
        if self.flushed.elapsed() >= FLUSH_EVERY { self.flush() } else { Ok(()) }
    }

    fn drain(&mut self) -> Result<(), RecordError> {
        let now = wall_nanos();
        let gap = GapEntry {
            ticks: self.drain_ticks()?,
            events: self.drain_events(now)?,
            dialog: self.drain_dialog(now)?,
            answers: self.drain_answers(now)?,
            tick: self.written.tick,
        };
        self.drain_snapshots(now)?;
        self.drain_frames(now)?;
        self.drain_audio(now)?;
        if gap.messages() > 0 {
            self.log.gap(&gap, now)?;
            self.missing += gap.messages();
            tracing::error!("{gap}");
        }
        self.recorder.heart.beat(self.written.tick, self.missing)?;
        Ok(())
    }

    /// Takes down ticks; how many are missing among them. So do the following of theirs.
    fn drain_ticks(&mut self) -> Result<u64, RecordError> {
        let Self { recorder, log, written, simulator, .. } = self;
        let mut missing = 0;
        while let Some((sample, ())) = recorder.ticks.next(|sample| {
            is_of(*simulator, sample)?;
            TickView::new(sample.payload()).map(drop)
        })? {
            let tick = sample.envelope().tick;
            let Some(gap) = written.tick(tick) else { continue };
            missing += gap;
            log.tick(&TickEntry::new(tick, TickView::new(sample.payload())?))?;
        }
        Ok(missing)
    }

    fn drain_events(&mut self, now: u64) -> Result<u64, RecordError> {
        let Self { recorder, log, written, simulator, .. } = self;
        let mut missing = 0;
        while let Some((sample, event)) = recorder
            .events
            .next(|sample| is_of(*simulator, sample).and_then(|()| message::read::<EventMessage>(sample.payload())))?
        {
            let envelope = sample.envelope();
            let Some(gap) = written.event(envelope.run, envelope.sequence) else { continue };
            missing += gap;
            if let Some(entry) = EventEntry::new(envelope, &event) {
                log.event(&entry, now)?;
            }
        }
        Ok(missing)
    }

    fn drain_dialog(&mut self, now: u64) -> Result<u64, RecordError> {
        let Self { recorder, log, written, .. } = self;
        let mut missing = 0;
        while let Some((sample, ())) = recorder.dialog.next(|sample| DialogView::new(sample.payload()).map(drop))? {
            let envelope = sample.envelope();
            let Some(gap) = written.dialog(envelope.run, envelope.sequence) else { continue };
            missing += gap;
            if let Some(entry) = DialogEntry::new(written.tick, envelope, DialogView::new(sample.payload())?) {
                log.dialog(&entry, now)?;
            }
        }
        Ok(missing)
    }

    fn drain_answers(&mut self, now: u64) -> Result<u64, RecordError> {
        let Self { recorder, log, written, .. } = self;
        let mut missing = 0;
        while let Some((sample, answer)) =
            recorder.answers.next(|sample| message::read::<AnswerMessage>(sample.payload()))?
        {
            let envelope = sample.envelope();
            let Some(gap) = written.answer(envelope.run, envelope.sequence) else { continue };
            missing += gap;
            if let Some(entry) = AnswerEntry::new(written.tick, envelope, &answer) {
                log.answer(&entry, now)?;
            }
        }
        Ok(missing)
    }

    /// One that is missing is no loss: the ticks tell all that it would.
    fn drain_snapshots(&mut self, now: u64) -> Result<(), RecordError> {
        let Self { recorder, log, written, simulator, .. } = self;
        while let Some((sample, ())) = recorder.snapshots.next(|sample| {
            is_of(*simulator, sample)?;
            SnapshotView::new(sample.payload()).map(drop)
        })? {
            let tick = sample.envelope().tick;
            if written.snapshot(tick) {
                log.snapshot(&Snapshot::pack(tick, SnapshotView::new(sample.payload())?.state), now)?;
            }
        }
        Ok(())
    }

    /// Nor is a frame: it can be rendered anew.
    fn drain_frames(&mut self, now: u64) -> Result<(), RecordError> {
        for film in &mut self.recorder.films {
            while let Some(entry) = film.next(now)? {
                self.log.frame(&entry, now)?;
            }
        }
        Ok(())
    }

    fn drain_audio(&mut self, now: u64) -> Result<(), RecordError> {
        let Self { recorder, log, written, .. } = self;
        let Some(tape) = &mut recorder.tape else { return Ok(()) };
        while let Some((channel, entry)) = tape.next(written.tick, now)? {
            log.audio(channel, &entry, now)?;
        }
        Ok(())
    }

    /// Hands all that was taken down to the operating system.
    ///
    /// # Errors
    /// [`RecordError::Log`].
    pub fn flush(&mut self) -> Result<(), RecordError> {
        self.log.flush()?;
        self.flushed = Instant::now();
        Ok(())
    }

    /// Ends the log; how many messages it lacks.
    ///
    /// # Errors
    /// [`RecordError`].
    pub fn finish(mut self) -> Result<u64, RecordError> {
        self.drain()?;
        self.log.finish()?;
        Ok(self.missing)
    }
}

/// What only the simulator may say.
fn is_of(simulator: u32, sample: &Sample) -> Result<(), Malformed> {
    let is_its = process_of(sample.envelope().run) == simulator;
    if is_its { Ok(()) } else { Err(Malformed("it is the simulator's to say")) }
}

#[cfg(test)]
mod tests {
    use cohabit_bus::Local;

    use super::*;

    #[test]
    fn where_no_simulator_came_there_is_nothing_to_record() {
        let path = std::env::temp_dir().join(format!("cohabit-no-mission-{}.mcap", std::process::id()));
        let recorder = Recorder::new(&Local::new(1)).expect("a bus");
        assert!(matches!(recorder.begin(&SessionFacts::named("s"), &path), Err(RecordError::NoMission)));
        assert!(!path.exists());
    }
}
