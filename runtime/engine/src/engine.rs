//! One tick after the other: the world between its inputs and its outputs.

use std::collections::BTreeMap;

use cohabit_bus::{
    BusError, Publisher, Subscriber, Topic, Transport,
    message::{self, CommandMessage, EventMessage, Malformed, MissionMessage, TickHeader, TickMessage},
};
use cohabit_cdf::{Action, BodyId, ObjectId, Status};
use cohabit_world::{CameraTarget, DT_NANOS, Event, Input, Report, World};

use crate::{build::SessionPlan, camera_plan::CameraPlan, motion::Motion, report};

/// Commands that one tick takes in at most; the rest wait for the next.
const MAX_INPUTS: usize = 64;

/// How long an object that is pointed out stays outlined.
const HIGHLIGHT_TICKS: u64 = 240;

/// Why a tick could not be completed.
#[derive(Debug, thiserror::Error)]
pub enum EngineError {
    /// The bus failed.
    #[error(transparent)]
    Bus(#[from] BusError),
}

/// The world of one session, connected to a bus.
pub struct Engine {
    world: World,
    commands: Box<dyn Subscriber>,
    mission: Box<dyn Publisher>,
    state: Box<dyn Publisher>,
    ticks: Box<dyn Publisher>,
    events: Box<dyn Publisher>,
    turn_by_command: BTreeMap<u64, u64>,
    latest_started: u64,
    highlighted: Vec<(ObjectId, u64)>,
    /// What the mission shows, one after the other, each until a tick.
    shown: Vec<(CameraTarget, u64)>,
    motion: Motion,
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
            commands: bus.subscriber(Topic::Commands)?,
            mission: bus.publisher(Topic::Mission)?,
            state: bus.publisher(Topic::State)?,
            ticks: bus.publisher(Topic::Ticks)?,
            events: bus.publisher(Topic::Events)?,
            turn_by_command: BTreeMap::new(),
            latest_started: 0,
            highlighted: Vec::new(),
            shown: Vec::new(),
            motion: Motion::default(),
        };
        let cameras = cameras.iter().map(CameraPlan::record).collect();
        let message = MissionMessage { cameras, ..plan.message() };
        engine.mission.send(0, message.bytes(), &mut |bytes| message.write(bytes))?;
        Ok(engine)
    }

    /// The world as it is.
    #[must_use]
    pub const fn world(&self) -> &World {
        &self.world
    }

    /// The latest command that has begun to move its body; 0 if none has.
    #[must_use]
    pub const fn latest_started(&self) -> u64 {
        self.latest_started
    }

    /// What is seen to move besides.
    pub(crate) const fn motion(&self) -> &Motion {
        &self.motion
    }

    /// The objects that are outlined now.
    pub fn highlighted(&self) -> impl Iterator<Item = ObjectId> + '_ {
        self.highlighted.iter().map(|(object, _)| *object)
    }

    /// What the mission shows now to the people who watch.
    #[must_use]
    pub fn shown(&self) -> Option<CameraTarget> {
        self.shown.iter().find(|(_, until)| *until > self.world.tick()).map(|(target, _)| *target)
    }

    /// One tick, whose wall time is stamped `wall_nanos` (since 1970).
    ///
    /// # Errors
    /// [`EngineError::Bus`].
    pub fn tick(&mut self, wall_nanos: u64) -> Result<(), EngineError> {
        let messages = self.drain()?;
        let inputs: Vec<Input> = messages.iter().filter_map(|message| self.input(message)).collect();
        let report = self.world.step(&inputs);
        self.note_started(&inputs);
        self.note_shown(&report);
        self.motion.note(&self.world, &report);
        // State before events: who hears of an event finds the state that it speaks of.
        self.publish_state()?;
        self.publish_events(&inputs, report)?;
        self.publish_tick(messages, wall_nanos)?;
        Ok(())
    }

    /// Hands the mission and the state to peers that joined since the last tick.
    ///
    /// # Errors
    /// [`EngineError::Bus`].
    pub fn greet(&mut self) -> Result<(), EngineError> {
        self.mission.update()?;
        self.events.update()?;
        Ok(())
    }

    fn drain(&mut self) -> Result<Vec<CommandMessage>, EngineError> {
        let mut messages = Vec::new();
        while messages.len() < MAX_INPUTS {
            let Some(sample) = self.commands.receive()? else { break };
            match message::read::<CommandMessage>(sample.payload()) {
                Ok(message) if Action::try_from(message.action).is_ok() => messages.push(message),
                Ok(message) => self.refuse(&message, Malformed("no such action"))?,
                Err(malformed) => tracing::warn!("a command was dropped: {malformed}"),
            }
        }
        Ok(messages)
    }

    fn input(&mut self, message: &CommandMessage) -> Option<Input> {
        self.turn_by_command.insert(message.command, message.turn);
        let action = Action::try_from(message.action).ok()?;
        Some(Input { command: message.command, body: BodyId(message.body), action })
    }

    fn refuse(&mut self, message: &CommandMessage, malformed: Malformed) -> Result<(), EngineError> {
        let status = Status::IncorrectActionFormat;
        let outcome =
            EventMessage::outcome(message.command, message.turn, message.body, status, &malformed.to_string());
        self.send_event(&outcome)
    }

    fn note_started(&mut self, inputs: &[Input]) {
        if let Some(input) = inputs.last() {
            self.latest_started = input.command;
        }
    }

    fn note_shown(&mut self, report: &Report) {
        let now = self.world.tick();
        self.highlighted.retain(|(_, until)| *until > now);
        self.shown.retain(|(_, until)| *until > now);
        for event in &report.events {
            match event {
                Event::Highlighted { object, .. } => {
                    self.highlighted.retain(|(other, _)| other != object);
                    self.highlighted.push((*object, now + HIGHLIGHT_TICKS));
                }
                Event::CameraMovement { target, duration_s, .. } => {
                    let ticks = (f64::from(*duration_s) / (DT_NANOS as f64 * 1e-9)) as u64;
                    let from = self.shown.last().map_or(now, |(_, until)| *until);
                    self.shown.push((*target, from + ticks));
                }
                _ => {}
            }
        }
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

    fn publish_tick(&mut self, inputs: Vec<CommandMessage>, wall_nanos: u64) -> Result<(), EngineError> {
        let header = TickHeader { digest: self.world.digest(), wall_nanos, ..TickHeader::default() };
        let message = TickMessage { header, inputs };
        self.ticks.send(self.world.tick(), message.bytes(), &mut |bytes| message.write(bytes))?;
        Ok(())
    }

    fn publish_state(&mut self) -> Result<(), EngineError> {
        if self.state.subscribers() == 0 {
            return Ok(());
        }
        let parts = report::state(&self.world);
        self.state.send(self.world.tick(), parts.bytes(), &mut |bytes| parts.write(bytes))?;
        Ok(())
    }

    fn send_event(&mut self, message: &EventMessage) -> Result<(), EngineError> {
        self.events.send(self.world.tick(), size_of::<EventMessage>(), &mut |bytes| {
            bytes.copy_from_slice(bytemuck::bytes_of(message));
        })?;
        Ok(())
    }
}
