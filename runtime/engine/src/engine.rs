//! One tick after the other: the world between its inputs and its outputs.

use std::collections::BTreeMap;

use cohabit_bus::{
    BusError, Heart, Publisher, Topic, Transport,
    message::{
        CommandMessage, Control, EventKind, EventMessage, MissionMessage, NONE, SnapshotView, Stage, StepView,
        TickHeader, TickMessage,
    },
};
use cohabit_cdf::{Action, BodyId};
use cohabit_world::{Input, Report, World};

use crate::{
    appearance::{Appearance, Visible},
    attendance::Due,
    build::SessionPlan,
    camera_plan::CameraPlan,
    intake::Intake,
    report,
    snapshot::{self, RestoreError},
    stopwatch::{Stopwatch, stage_of},
};

/// Ticks between two snapshots: what is between can be worked out anew in a tenth of a second.
const SNAPSHOT_EVERY: u64 = 600;

/// Why a tick could not be completed.
#[derive(Debug, thiserror::Error)]
pub enum EngineError {
    /// The bus failed.
    #[error(transparent)]
    Bus(#[from] BusError),
}

/// What is still to be recorded of a tick.
struct Unrecorded {
    inputs: Vec<CommandMessage>,
    wall_nanos: u64,
    late_nanos: u64,
}

/// The world of one session, connected to a bus.
pub struct Engine {
    world: World,
    intake: Intake,
    mission: Box<dyn Publisher>,
    state: Box<dyn Publisher>,
    ticks: Box<dyn Publisher>,
    snapshots: Box<dyn Publisher>,
    events: Box<dyn Publisher>,
    steps: Box<dyn Publisher>,
    heart: Heart,
    stopwatch: Stopwatch,
    paused: bool,
    unrecorded: Option<Unrecorded>,
    turn_by_command: BTreeMap<u64, u64>,
    appearance: Appearance,
    /// Whether ticks are told, for a recorder that is there or may join.
    tells_ticks: bool,
}

impl Engine {
    /// Connects a plan's world to `bus`, and publishes the mission and which cameras there are.
    ///
    /// # Errors
    /// [`EngineError::Bus`].
    pub fn new(
        plan: &SessionPlan,
        world: World,
        cameras: &[CameraPlan],
        bus: &dyn Transport,
    ) -> Result<Self, EngineError> {
        let mut engine = Self {
            world,
            intake: Intake::new(bus)?,
            mission: bus.publisher(Topic::Mission)?,
            state: bus.publisher(Topic::State)?,
            ticks: bus.publisher(Topic::Ticks)?,
            snapshots: bus.publisher(Topic::Snapshots)?,
            events: bus.publisher(Topic::Events)?,
            steps: bus.publisher(Topic::Steps)?,
            heart: Heart::new(bus, "sim", NONE)?,
            stopwatch: Stopwatch::new(),
            paused: false,
            unrecorded: None,
            turn_by_command: BTreeMap::new(),
            appearance: Appearance::default(),
            tells_ticks: true,
        };
        let cameras = cameras.iter().map(CameraPlan::record).collect();
        let message = MissionMessage { cameras, ..plan.message() };
        engine.mission.send(0, message.bytes(), &mut |bytes| message.write(bytes))?;
        Ok(engine)
    }

    /// The same when nobody will ever record it: no digests are worked out, which take longer than all else of a tick.
    #[must_use]
    pub fn without_recorder(self) -> Self {
        Self { tells_ticks: false, ..self }
    }

    /// The same, going on from a moment at which that was seen of its world besides.
    #[must_use]
    pub fn appearing(self, appearance: Appearance) -> Self {
        Self { appearance, ..self }
    }

    /// The world as it is.
    #[must_use]
    pub const fn world(&self) -> &World {
        &self.world
    }

    /// The world, when nobody is to be told of it any more.
    #[must_use]
    pub fn into_world(self) -> World {
        self.world
    }

    /// All that can be seen now.
    #[must_use]
    pub const fn visible(&self) -> Visible<'_> {
        Visible { world: &self.world, appearance: &self.appearance }
    }

    /// All that is needed to go on from here, as bytes: see [`Self::restore`].
    #[must_use]
    pub fn snapshot(&self) -> Vec<u8> {
        snapshot::write(self.visible())
    }

    /// Goes on from where an engine of the same mission was.
    ///
    /// # Errors
    /// [`RestoreError`]; the world is then as it was.
    pub fn restore(&mut self, bytes: &[u8]) -> Result<(), RestoreError> {
        self.appearance = snapshot::restore(&mut self.world, bytes)?;
        Ok(())
    }

    /// One tick, whose wall time is stamped `wall_nanos` (since 1970).
    ///
    /// # Errors
    /// [`EngineError::Bus`].
    pub fn tick(&mut self, wall_nanos: u64) -> Result<(), EngineError> {
        self.advance(wall_nanos, 0)?;
        self.record()
    }

    /// The first part of a tick, which began so many nanoseconds later than it should: all but its record.
    pub(crate) fn advance(&mut self, wall_nanos: u64, late_nanos: u64) -> Result<(), EngineError> {
        self.stopwatch.restart();
        self.listen()?;
        let messages = self.intake.commands();
        let inputs: Vec<Input> = messages.iter().filter_map(|message| self.input(message)).collect();
        self.stopwatch.over(Stage::Drain);
        let report = self.world.step_telling(&inputs, &mut |phase| self.stopwatch.over(stage_of(phase)));
        self.appearance.note(&self.world, &inputs, &report);
        // State before events: who hears of an event finds the state that it speaks of.
        self.publish_state()?;
        self.publish_events(&inputs, report)?;
        self.stopwatch.over(Stage::Publish);
        self.unrecorded = Some(Unrecorded { inputs: messages, wall_nanos, late_nanos });
        Ok(())
    }

    /// The rest of a tick that was not recorded yet: its inputs, and the digest of what came of them, which takes longer
    /// than the tick. In lock-step, agents think meanwhile.
    pub(crate) fn record(&mut self) -> Result<(), EngineError> {
        if let Some(tick) = self.unrecorded.take().filter(|_| self.tells_ticks) {
            self.stopwatch.restart();
            self.publish_tick(tick)?;
            if self.world.tick().is_multiple_of(SNAPSHOT_EVERY) {
                self.keep_state()?;
            }
            self.stopwatch.over(Stage::Record);
        }
        self.beat()
    }

    /// Takes in what has arrived, and tells what comes of it at once.
    ///
    /// # Errors
    /// [`EngineError::Bus`].
    pub(crate) fn listen(&mut self) -> Result<(), EngineError> {
        let told = self.intake.take_in(self.world.tick(), self.world.bodies().len())?;
        told.iter().try_for_each(|event| self.send_event(event))
    }

    /// What was asked of the clock since this was last called.
    pub(crate) fn take_controls(&mut self) -> Vec<Control> {
        std::mem::take(&mut self.intake.controls)
    }

    /// Tells that time goes otherwise now, and shows the world as it stands.
    pub(crate) fn set_clock(&mut self, paused: bool, sentence: &str) -> Result<(), EngineError> {
        self.paused = paused;
        self.show_state()?;
        self.send_event(&EventMessage::new(EventKind::Clock).saying(sentence))
    }

    /// How many are waited for in lock-step.
    pub(crate) fn attending(&self) -> usize {
        self.intake.attendance.count()
    }

    /// Whether somebody's turn is not over yet.
    pub(crate) fn is_awaited(&self) -> bool {
        self.intake.attendance.is_awaited()
    }

    /// Whose turn it is now.
    pub(crate) fn ask(&mut self) -> Due {
        self.intake.attendance.ask(self.world.tick())
    }

    /// Tells them so: all that belongs to this tick has been sent.
    pub(crate) fn publish_step(&mut self, due: &[u64]) -> Result<(), EngineError> {
        self.steps.send(self.world.tick(), StepView::bytes(due.len()), &mut |bytes| StepView::write(due, bytes))?;
        Ok(())
    }

    /// Goes on without those who took too long.
    pub(crate) fn give_up_waiting(&mut self) -> Result<(), EngineError> {
        for late in self.intake.attendance.give_up(self.world.tick()) {
            let mut event = EventMessage::new(EventKind::TimedOut).saying(&late.sentence);
            (event.body, event.number) = (late.body, late.count.cast_signed());
            self.send_event(&event)?;
        }
        Ok(())
    }

    /// A stage of the tick that is not the engine's own is over.
    pub(crate) fn note_stage(&mut self, stage: Stage) {
        self.stopwatch.over(stage);
    }

    /// What is timed next begins now.
    pub(crate) fn restart_stopwatch(&mut self) {
        self.stopwatch.restart();
    }

    /// Hands what is kept for late joiners to peers that joined meanwhile, and says whose commander is gone.
    ///
    /// # Errors
    /// [`EngineError::Bus`].
    pub fn greet(&mut self) -> Result<(), EngineError> {
        for topic in [&mut self.mission, &mut self.state, &mut self.events, &mut self.ticks, &mut self.snapshots] {
            topic.update()?;
        }
        let buried = self.intake.bury();
        buried.iter().try_for_each(|event| self.send_event(event))
    }

    /// Shows that the simulator lives.
    pub(crate) fn beat(&mut self) -> Result<(), EngineError> {
        self.heart.beat(self.world.tick(), self.intake.lost())?;
        Ok(())
    }

    fn input(&mut self, message: &CommandMessage) -> Option<Input> {
        self.turn_by_command.insert(message.command, message.turn);
        let action = Action::try_from(message.action).ok()?;
        Some(Input { command: message.command, body: BodyId(message.body), action })
    }

    fn publish_events(&mut self, inputs: &[Input], report: Report) -> Result<(), EngineError> {
        for input in inputs {
            let turn = self.turn_by_command.get(&input.command).copied().unwrap_or(0);
            self.send_event(&report::started(input, turn))?;
        }
        for event in &report.events {
            self.send_event(&report::event(&self.world, event))?;
        }
        for outcome in &report.outcomes {
            self.intake.attendance.note_outcome(outcome.body.0);
            let turn = self.turn_by_command.remove(&outcome.command).unwrap_or(0);
            self.send_event(&EventMessage::outcome(
                outcome.command,
                turn,
                outcome.body.0,
                outcome.status,
                &outcome.detail,
            ))?;
        }
        Ok(())
    }

    fn publish_tick(&mut self, tick: Unrecorded) -> Result<(), EngineError> {
        let Unrecorded { inputs, wall_nanos, late_nanos } = tick;
        let (digest, stage_nanos) = (self.world.digest(), self.stopwatch.nanos);
        let header = TickHeader { digest, wall_nanos, late_nanos, stage_nanos, ..TickHeader::default() };
        let message = TickMessage { header, inputs };
        self.ticks.send(self.world.tick(), message.bytes(), &mut |bytes| message.write(bytes))?;
        Ok(())
    }

    /// Sends all that is needed to go on from here.
    pub(crate) fn keep_state(&mut self) -> Result<(), EngineError> {
        let state = snapshot::write(self.visible());
        let bytes = SnapshotView::bytes(state.len());
        self.snapshots.send(self.world.tick(), bytes, &mut |bytes| SnapshotView::write(&state, bytes))?;
        Ok(())
    }

    fn publish_state(&mut self) -> Result<(), EngineError> {
        if self.state.subscribers() == 0 { Ok(()) } else { self.show_state() }
    }

    /// Sends the state, whether or not anybody is there to see it: the latest is kept for late joiners.
    pub(crate) fn show_state(&mut self) -> Result<(), EngineError> {
        let mut parts = report::state(&self.world);
        parts.header.paused = u32::from(self.paused);
        for body in &mut parts.bodies {
            body.commander = self.intake.commander(body.body);
        }
        self.state.send(self.world.tick(), parts.bytes(), &mut |bytes| parts.write(bytes))?;
        Ok(())
    }

    fn send_event(&mut self, message: &EventMessage) -> Result<(), EngineError> {
        self.events.send_record(self.world.tick(), message)?;
        Ok(())
    }
}
