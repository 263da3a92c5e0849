//! A running session, shown while it runs: from its bus, through the same conversion as a log.

use std::{
    collections::VecDeque,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};

use cohabit_bus::{
    Heart, Inbox, Listener, Sample, Topic, Transport, Wake,
    message::{
        self, AnswerMessage, DialogView, EventMessage, FrameView, MissionMessage, NONE, StateParts, StateView, TickView,
    },
};
use cohabit_cdf::Catalog;
use cohabit_engine::SessionPlan;
use cohabit_record::{AnswerEntry, DialogEntry, EventEntry, InputEntry};
use cohabit_render::MeshLibrary;
use re_sdk::RecordingStream;

use crate::{
    recording::{Recording, Side, When},
    replay::CAMERA,
    showing::Showing,
};

/// What has arrived is shown so often.
const EVERY: Duration = Duration::from_millis(50);
/// Wall times of so many ticks are remembered.
const MOMENTS: usize = 256;

/// A peer that watches.
pub struct Watch {
    mission: Inbox,
    state: Inbox,
    ticks: Inbox,
    events: Inbox,
    dialog: Inbox,
    answers: Inbox,
    frames: Inbox,
    bell: Box<dyn Listener>,
    heart: Heart,
    moments: VecDeque<When>,
}

impl Watch {
    /// Subscribes to all that is shown.
    pub fn new(bus: &dyn Transport) -> anyhow::Result<Self> {
        Ok(Self {
            mission: Inbox::new(bus, Topic::Mission)?,
            state: Inbox::new(bus, Topic::State)?,
            ticks: Inbox::new(bus, Topic::Ticks)?,
            events: Inbox::new(bus, Topic::Events)?,
            dialog: Inbox::new(bus, Topic::Dialog)?,
            answers: Inbox::new(bus, Topic::Answers)?,
            frames: Inbox::new(bus, Topic::Frames(CAMERA))?,
            bell: bus.listener(Wake::State)?,
            heart: Heart::new(bus, "viewer", NONE)?,
            moments: VecDeque::new(),
        })
    }

    /// Waits for the mission that is played; `None` if it is to end before.
    pub fn plan(&mut self, catalog: &Arc<Catalog>, stop: &AtomicBool) -> anyhow::Result<Option<SessionPlan>> {
        while !stop.load(Ordering::Relaxed) {
            let Some((_, mission)) = self.mission.next(|sample| MissionMessage::read(sample.payload()))? else {
                self.bell.wait(EVERY)?;
                continue;
            };
            let (file, seed) = (mission.header.file.as_str().to_owned(), mission.header.seed);
            let plan = SessionPlan::new(&file, &mission.text, Arc::clone(catalog), seed)?;
            return Ok(Some(plan.with_bodies(mission.bodies)));
        }
        Ok(None)
    }

    /// Shows the session until `stop`.
    pub fn show(
        mut self,
        stream: &RecordingStream,
        plan: SessionPlan,
        meshes: Arc<MeshLibrary>,
        about: &[(String, String)],
        stop: &AtomicBool,
    ) -> anyhow::Result<()> {
        let mut showing = Showing::new(Recording::new(stream.clone(), Side::Only), plan, meshes, about)?;
        while !stop.load(Ordering::Relaxed) {
            self.bell.wait(EVERY)?;
            self.tell(&mut showing)?;
            // State comes 60 times a second: more often than anybody looks.
            std::thread::sleep(EVERY);
        }
        self.tell(&mut showing)
    }

    /// Tells all that has arrived: state before what happened in it.
    fn tell(&mut self, showing: &mut Showing) -> anyhow::Result<()> {
        let inputs = self.inputs()?;
        let mut newest = None;
        while let Some((sample, ())) = self.state.next(|sample| StateView::new(sample.payload()).map(drop))? {
            newest = Some(sample);
        }
        if let Some(sample) = newest {
            showing.at(self.when(sample.envelope().tick));
            showing.state(parts(&StateView::new(sample.payload())?))?;
        }
        for (when, input) in inputs {
            showing.at(when);
            showing.input(&input)?;
        }
        while let Some((sample, event)) = self.events.next(|sample| message::read::<EventMessage>(sample.payload()))? {
            let Some(entry) = EventEntry::new(sample.envelope(), &event) else { continue };
            showing.at(self.when(entry.tick));
            showing.event(&entry)?;
        }
        while let Some((sample, ())) = self.dialog.next(|sample| DialogView::new(sample.payload()).map(drop))? {
            let now = self.moments.back().copied().unwrap_or_default();
            let view = DialogView::new(sample.payload())?;
            let Some(entry) = DialogEntry::new(now.tick, sample.envelope(), view) else { continue };
            showing.at(now);
            showing.dialog(&entry)?;
        }
        while let Some((sample, answer)) =
            self.answers.next(|sample| message::read::<AnswerMessage>(sample.payload()))?
        {
            let now = self.moments.back().copied().unwrap_or_default();
            let Some(entry) = AnswerEntry::new(now.tick, sample.envelope(), &answer) else { continue };
            showing.at(now);
            showing.answer(&entry)?;
        }
        while let Some((sample, ())) = self.frames.next(|sample| FrameView::new(sample.payload()).map(drop))? {
            self.frame(showing, &sample)?;
        }
        let (tick, lost) = (self.moments.back().map_or(0, |now| now.tick), self.lost());
        Ok(self.heart.beat(tick, lost)?)
    }

    fn frame(&self, showing: &mut Showing, sample: &Sample) -> anyhow::Result<()> {
        showing.at(self.when(sample.envelope().tick));
        showing.frame(CAMERA, &FrameView::new(sample.payload())?)
    }

    /// What ticks took in, and when they were.
    fn inputs(&mut self) -> anyhow::Result<Vec<(When, InputEntry)>> {
        let mut inputs = Vec::new();
        while let Some((sample, ())) = self.ticks.next(|sample| TickView::new(sample.payload()).map(drop))? {
            let view = TickView::new(sample.payload())?;
            let when = When { tick: sample.envelope().tick, wall_nanos: view.header.wall_nanos };
            if self.moments.len() == MOMENTS {
                self.moments.pop_front();
            }
            self.moments.push_back(when);
            inputs.extend(view.inputs.iter().filter_map(|input| Some((when, InputEntry::new(input)?))));
        }
        Ok(inputs)
    }

    /// The moment of a tick; its wall time is that of the nearest tick that is remembered.
    fn when(&self, tick: u64) -> When {
        let nearest = self.moments.iter().min_by_key(|moment| moment.tick.abs_diff(tick));
        When { tick, wall_nanos: nearest.map_or(0, |moment| moment.wall_nanos) }
    }

    fn lost(&self) -> u64 {
        self.ticks.lost() + self.events.lost() + self.dialog.lost() + self.answers.lost()
    }
}

fn parts(view: &StateView<'_>) -> StateParts {
    StateParts {
        header: *view.header,
        bodies: view.bodies.to_vec(),
        objects: view.objects.to_vec(),
        goals: view.goals.to_vec(),
        notes: view.notes.to_vec(),
    }
}
