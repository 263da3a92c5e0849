//! The recorder: a peer that writes down what passes on the bus.

use std::{
    path::Path,
    sync::atomic::{AtomicBool, Ordering},
    time::{Duration, Instant},
};

use cohabit_bus::{
    BusError, Listener, Sample, Subscriber, Topic, Transport, Wake,
    message::{self, DialogView, EventMessage, Malformed, MissionMessage, TickView},
    wall_nanos,
};

use crate::{
    entry::{DialogEntry, EventEntry, SessionEntry, TickEntry},
    log::LogError,
    writer::LogWriter,
};

/// The longest that an entry stays in this process alone.
const FLUSH_EVERY: Duration = Duration::from_millis(100);

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
}

/// Records one session.
pub struct Recorder {
    mission: Box<dyn Subscriber>,
    ticks: Box<dyn Subscriber>,
    events: Box<dyn Subscriber>,
    dialog: Box<dyn Subscriber>,
    listener: Box<dyn Listener>,
    lost: u64,
}

impl Recorder {
    /// Subscribes to all that is recorded.
    ///
    /// # Errors
    /// [`BusError`].
    pub fn new(bus: &dyn Transport) -> Result<Self, BusError> {
        Ok(Self {
            mission: bus.subscriber(Topic::Mission)?,
            ticks: bus.subscriber(Topic::Ticks)?,
            events: bus.subscriber(Topic::Events)?,
            dialog: bus.subscriber(Topic::Dialog)?,
            listener: bus.listener(Wake::State)?,
            lost: 0,
        })
    }

    /// Records until `stop`, then ends the log. Writes nothing if no simulator ever came.
    ///
    /// # Errors
    /// [`RecordError`].
    pub fn run(mut self, session: &str, path: &Path, stop: &AtomicBool) -> Result<(), RecordError> {
        let Some(mission) = self.wait_for_mission(stop)? else { return Ok(()) };
        let mut recording = self.open(session, path, &mission)?;
        while !stop.load(Ordering::Relaxed) {
            recording.recorder.listener.wait(FLUSH_EVERY / 2)?;
            recording.take_down()?;
        }
        recording.finish()
    }

    /// Begins the log of a simulator that has published its mission already, for somebody who says when there is
    /// something to take down: where the world runs as fast as it can, a recorder beside it would miss ticks.
    ///
    /// # Errors
    /// [`RecordError`].
    pub fn begin(mut self, session: &str, path: &Path) -> Result<Recording, RecordError> {
        let sample = self.mission.latest()?.ok_or(RecordError::NoMission)?;
        let mission = MissionMessage::read(sample.payload())?;
        self.open(session, path, &mission)
    }

    fn open(self, session: &str, path: &Path, mission: &MissionMessage) -> Result<Recording, RecordError> {
        let log = LogWriter::create(path, &SessionEntry::new(session, mission), wall_nanos())?;
        Ok(Recording { recorder: self, log, flushed: Instant::now() })
    }

    fn wait_for_mission(&mut self, stop: &AtomicBool) -> Result<Option<MissionMessage>, RecordError> {
        while !stop.load(Ordering::Relaxed) {
            if let Some(sample) = self.mission.latest()? {
                return Ok(Some(MissionMessage::read(sample.payload())?));
            }
            self.listener.wait(FLUSH_EVERY)?;
        }
        Ok(None)
    }

    fn drain(&mut self, log: &mut LogWriter) -> Result<(), RecordError> {
        let now = wall_nanos();
        for_each(&mut *self.ticks, |sample| {
            log.tick(&TickEntry::new(sample.envelope().tick, TickView::new(sample.payload())?))?;
            Ok(())
        })?;
        for_each(&mut *self.events, |sample| {
            let event: EventMessage = message::read(sample.payload())?;
            if let Some(entry) = EventEntry::new(sample.envelope().tick, &event) {
                log.event(&entry, now)?;
            }
            Ok(())
        })?;
        for_each(&mut *self.dialog, |sample| {
            if let Some(entry) = DialogEntry::new(sample.envelope(), DialogView::new(sample.payload())?) {
                log.dialog(&entry, now)?;
            }
            Ok(())
        })?;
        let lost = self.ticks.lost() + self.events.lost() + self.dialog.lost();
        if lost > self.lost {
            tracing::error!("the log misses {} messages: the disk is too slow", lost - self.lost);
            self.lost = lost;
        }
        Ok(())
    }
}

/// A log that is being written.
pub struct Recording {
    recorder: Recorder,
    log: LogWriter,
    flushed: Instant,
}

impl Recording {
    /// Takes down all that was published since the last time.
    ///
    /// # Errors
    /// [`RecordError`].
    pub fn take_down(&mut self) -> Result<(), RecordError> {
        self.recorder.drain(&mut self.log)?;
        if self.flushed.elapsed() >= FLUSH_EVERY { self.flush() } else { Ok(()) }
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

    /// Ends the log.
    ///
    /// # Errors
    /// [`RecordError`].
    pub fn finish(mut self) -> Result<(), RecordError> {
        self.recorder.drain(&mut self.log)?;
        self.log.finish()?;
        Ok(())
    }
}

fn for_each(
    subscriber: &mut dyn Subscriber,
    mut take: impl FnMut(&Sample) -> Result<(), RecordError>,
) -> Result<(), RecordError> {
    while let Some(sample) = subscriber.receive()? {
        take(&sample)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use cohabit_bus::Local;

    use super::*;

    #[test]
    fn where_no_simulator_came_there_is_nothing_to_record() {
        let path = std::env::temp_dir().join(format!("cohabit-no-mission-{}.mcap", std::process::id()));
        let recorder = Recorder::new(&Local::new(1)).expect("a bus");
        assert!(matches!(recorder.begin("s", &path), Err(RecordError::NoMission)));
        assert!(!path.exists());
    }
}
