//! Connects an agent to a session's bus.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};

use cohabit_bus::{
    BusError, CameraId, Inbox, Publisher, Sample, Subscriber, Topic, Transport, Wake,
    message::{BodyRecord, DialogKind, DialogView, EventKind, EventMessage, Malformed, MissionMessage, StateView},
    monotonic_nanos,
};
use cohabit_cdf::Catalog;

use crate::{
    agent::{Agent, Deed, Heard, Now, Senses},
    client::{Client, outcome},
    eyes::{Eyes, Glance, Sight},
    past::Past,
};

/// How long a late joiner listens to what was before it takes anything up: all publishers have greeted it by then, and
/// a short command that is under way has ended.
const SETTLE_NANOS: u64 = 600_000_000;
/// How long an agent sleeps at most; one that senses the world looks up more often.
const NAP: Duration = Duration::from_millis(100);
const SENSING_NAP: Duration = Duration::from_millis(10);
/// In lock-step the world waits so long for an agent that may hang.
const PATIENCE: Duration = Duration::from_secs(5);

/// Why an agent left its session.
#[derive(Debug, thiserror::Error)]
pub enum PeerError {
    /// The bus failed.
    #[error(transparent)]
    Bus(#[from] BusError),
    /// A peer sent nonsense.
    #[error(transparent)]
    Malformed(#[from] Malformed),
    /// The session has no such camera.
    #[error("body {0} has no camera of its own: bodies count from 0")]
    NoCamera(u32),
}

/// Runs `agent` for that body on `bus` until `stop`. One that joins in the middle of a plan carries on with it. If
/// another commands the body, it waits until it can.
///
/// # Errors
/// [`PeerError`].
pub fn run(agent: &mut dyn Agent, body: u32, bus: &dyn Transport, stop: &AtomicBool) -> Result<(), PeerError> {
    let Some(mission) = wait_for_mission(bus, stop)? else { return Ok(()) };
    let mut mind = Mind::join(agent, body, bus, mission.header.lock_step == 1)?;
    mind.client.claim(false)?;
    while !stop.load(Ordering::Relaxed) {
        mind.live()?;
    }
    Ok(())
}

/// The mission of the session on `bus`, as soon as there is a simulator; `None` if `stop` comes first.
///
/// # Errors
/// [`PeerError`].
pub fn wait_for_mission(bus: &dyn Transport, stop: &AtomicBool) -> Result<Option<MissionMessage>, PeerError> {
    let mut missions = bus.subscriber(Topic::Mission)?;
    let mut bell = bus.listener(Wake::State)?;
    while !stop.load(Ordering::Relaxed) {
        if let Some(sample) = missions.latest()? {
            return Ok(Some(MissionMessage::read(sample.payload())?));
        }
        bell.wait(Duration::from_millis(50))?;
    }
    Ok(None)
}

/// An agent with its ends on the bus.
struct Mind<'a> {
    agent: &'a mut dyn Agent,
    client: Client,
    dialog: Inbox,
    tells: Box<dyn Publisher>,
    senses: Senses,
    world: Option<Box<dyn Subscriber>>,
    state: Option<Sample>,
    eyes: Option<Eyes>,
    glance: Option<Glance>,
    /// What was before it joined, until it has taken that in.
    past: Option<Past>,
    /// The turn of the newest plan.
    turn: u64,
    joined_nanos: u64,
    lock_step: bool,
    attends: bool,
    /// Whether it has claimed its body and not heard that it is another's.
    hopes: bool,
    rest: u64,
    deeds: Vec<Deed>,
}

impl<'a> Mind<'a> {
    fn join(agent: &'a mut dyn Agent, body: u32, bus: &dyn Transport, lock_step: bool) -> Result<Self, PeerError> {
        let senses = agent.senses();
        let camera = u8::try_from(body).map(CameraId::Egocentric).map_err(|_| PeerError::NoCamera(body))?;
        let catalog = || Arc::new(Catalog::builtin());
        let world = (senses.sight || senses.state).then(|| bus.subscriber(Topic::State)).transpose()?;
        Ok(Self {
            client: Client::join(bus, body, "agent")?,
            dialog: Inbox::new(bus, Topic::Dialog)?,
            tells: bus.publisher(Topic::Dialog)?,
            world,
            state: None,
            eyes: senses.sight.then(|| Eyes::open(bus, camera, catalog())).transpose()?,
            glance: None,
            past: Some(Past::default()),
            turn: 0,
            joined_nanos: monotonic_nanos(),
            lock_step,
            attends: false,
            hopes: true,
            rest: 1,
            deeds: Vec::new(),
            agent,
            senses,
        })
    }

    /// Sleeps until something happens, and lives it.
    fn live(&mut self) -> Result<(), PeerError> {
        let looks_up = !self.lock_step && (self.senses.sight || self.senses.state);
        self.client.sleep(if looks_up { SENSING_NAP } else { NAP })?;
        self.tells.update()?;
        self.hear_events()?;
        self.hear_dialog()?;
        self.settle()?;
        if !self.attends {
            if !self.lock_step && self.past.is_none() && self.sense()? {
                self.hear_now(None)?;
            }
        } else if let Some(tick) = self.client.turn()? {
            // What belongs to the tick was sent before the turn.
            self.hear_events()?;
            self.sense()?;
            self.hear_now(Some(tick))?;
            self.client.ready(std::mem::replace(&mut self.rest, 1))?;
        }
        Ok(())
    }

    fn hear_events(&mut self) -> Result<(), PeerError> {
        let body = self.client.body();
        while let Some((envelope, event)) = self.client.event()? {
            if event.body == body && event.kind() == Some(EventKind::Commander) {
                self.hear_commander(&event)?;
            }
            let Some(outcome) = outcome(&envelope, &event) else { continue };
            if let Some(past) = self.past.as_mut().filter(|_| event.body == body) {
                past.note_outcome(event.turn, outcome.status, &outcome.detail);
            } else if outcome.command == self.client.latest() {
                self.hear(&Heard::Outcome { status: outcome.status, detail: &outcome.detail })?;
            }
        }
        Ok(())
    }

    /// Its body has another commander: perhaps itself, perhaps nobody, which it does not leave at that.
    fn hear_commander(&mut self, event: &EventMessage) -> Result<(), PeerError> {
        let commands = self.client.commands_body();
        if event.number == 0 {
            self.client.claim(false)?;
        }
        if std::mem::replace(&mut self.hopes, commands) != commands {
            self.hear(&Heard::Commands(commands))?;
        }
        Ok(())
    }

    fn hear_dialog(&mut self) -> Result<(), PeerError> {
        while let Some((sample, ())) = self.dialog.next(|sample| DialogView::new(sample.payload()).map(drop))? {
            let view = DialogView::new(sample.payload())?;
            if view.header.kind() != Some(DialogKind::Plan) || view.header.body != self.client.body() {
                continue;
            }
            // A dialog service that takes a dead one's place tells the plan under way once more.
            let turn = view.header.turn;
            if std::mem::replace(&mut self.turn, turn) == turn && turn != 0 {
                continue;
            }
            let is_new = sample.envelope().sent_nanos >= self.joined_nanos;
            match &mut self.past {
                Some(past) if !is_new || past.knows(turn) => past.note_plan(turn, view.steps),
                None if !is_new => {}
                _ => {
                    self.past = None;
                    self.hear(&Heard::Plan { turn, steps: view.steps })?;
                }
            }
        }
        Ok(())
    }

    /// Takes up what was before it joined, once all of that has been heard; in lock-step, has the world wait from then on.
    fn settle(&mut self) -> Result<(), PeerError> {
        if monotonic_nanos() - self.joined_nanos > SETTLE_NANOS
            && let Some(past) = self.past.take()
        {
            self.deeds.extend(past.relive(self.agent));
            self.carry_out()?;
        }
        if self.lock_step && !self.attends && self.past.is_none() {
            self.attends = true;
            self.client.attend(Some(PATIENCE))?;
        }
        Ok(())
    }

    /// Takes in the newest state and sight; says whether there is anything new.
    fn sense(&mut self) -> Result<bool, PeerError> {
        let state = self.world.as_mut().map(|world| world.latest()).transpose()?.flatten();
        let glance = self.eyes.as_mut().map(Eyes::look).transpose()?.flatten();
        let is_new = if self.senses.sight { glance.is_some() } else { state.is_some() };
        if let Some(sample) = &state {
            self.client.note_sensed(sample.envelope().tick);
        }
        self.state = state.or(self.state.take());
        self.glance = glance.or(self.glance.take());
        Ok(is_new)
    }

    /// Has the agent hear how the world is; at a turn of lock-step even if it senses nothing of it.
    fn hear_now(&mut self, turn: Option<u64>) -> Result<(), PeerError> {
        let (sample, glance) = (self.state.take(), self.glance.take());
        let state = sample.as_ref().map(|sample| StateView::new(sample.payload())).transpose()?;
        let tick = turn.or(sample.as_ref().map(|sample| sample.envelope().tick)).unwrap_or(0);
        let body = self.client.body();
        let own: Option<&BodyRecord> = state.and_then(|state| state.bodies.iter().find(|record| record.body == body));
        let sight = glance.as_ref().zip(state).map(|(glance, state)| Sight::new(glance, state));
        let now = Now { tick, own, sight: sight.as_ref(), state: state.filter(|_| self.senses.state) };
        self.agent.hear(&Heard::Now(&now), &mut self.deeds);
        self.carry_out()?;
        (self.state, self.glance) = (sample, glance);
        Ok(())
    }

    fn hear(&mut self, heard: &Heard<'_>) -> Result<(), PeerError> {
        self.agent.hear(heard, &mut self.deeds);
        self.carry_out()
    }

    fn carry_out(&mut self) -> Result<(), PeerError> {
        for deed in self.deeds.drain(..) {
            match deed {
                Deed::Act { turn, action } => drop(self.client.act(turn, action)?),
                Deed::Tell(message) => {
                    self.tells.send(0, message.bytes(), &mut |bytes| message.write(bytes))?;
                }
                Deed::Rest(ticks) => self.rest = ticks,
            }
        }
        Ok(())
    }
}
