//! Connects an agent to a session's bus.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};

use cohabit_bus::{
    Envelope, Inbox, Publisher, Sample, Topic, Transport, Wake,
    message::{DialogKind, DialogView, EventKind, EventMessage, Malformed, MissionMessage, StateView},
    monotonic_nanos,
};
use cohabit_cdf::{Catalog, Status};

use crate::{
    agent::{Agent, Deed, Heard, Now, Senses, TICKS_PER_SECOND},
    client::{Client, Outcome, outcome},
    error::PeerError,
    eyes::{Eyes, Glance, Sight},
    past::Past,
};

/// How long a late joiner listens to what was before it takes anything up: all publishers have greeted it by then, and
/// a short command that is under way has ended.
const SETTLE_NANOS: u64 = 600_000_000;
/// How long an agent sleeps at most; one that senses the world looks up more often.
const NAP: Duration = Duration::from_millis(100);
const SENSING_NAP: Duration = Duration::from_millis(10);
/// Nobody needs more than the newest plan; a turn's worth of them is kept. (A subscriber may hold eight samples.)
const MOST_PLANS: usize = 4;
/// An agent is asked again after so many ticks, however long it wants to rest: ten seconds.
const MOST_REST: u64 = 10 * TICKS_PER_SECOND;
/// In lock-step the world waits so long for an agent that may hang.
const PATIENCE: Duration = Duration::from_secs(5);

/// Runs `agent` for that body on `bus` until `stop`. One that joins in the middle of a plan carries on with it. If
/// another commands the body, it waits until it can.
///
/// # Errors
/// [`PeerError`].
pub fn run(agent: &mut dyn Agent, body: u32, bus: &dyn Transport, stop: &AtomicBool) -> Result<(), PeerError> {
    run_in(&Arc::new(Catalog::builtin()), agent, body, bus, stop)
}

/// The same in a world with this catalogue.
///
/// # Errors
/// [`PeerError`].
pub fn run_in(
    catalog: &Arc<Catalog>,
    agent: &mut dyn Agent,
    body: u32,
    bus: &dyn Transport,
    stop: &AtomicBool,
) -> Result<(), PeerError> {
    let Some(mission) = wait_for_mission(bus, stop)? else { return Ok(()) };
    let Some(world) = World::look_at(bus, stop)? else { return Ok(()) };
    let bodies = StateView::new(world.newest.payload())?.bodies;
    if bodies.iter().all(|record| record.body != body) {
        return Err(PeerError::NoBody { body, last: bodies.len().saturating_sub(1) });
    }
    let mut mind = Mind::join(catalog, agent, body, bus, mission.header.lock_step == 1, world)?;
    mind.claim()?;
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
    let mut missions = Inbox::new(bus, Topic::Mission)?;
    let mut bell = bus.listener(Wake::State)?;
    while !stop.load(Ordering::Relaxed) {
        if let Some((_, mission)) = missions.latest(|sample| MissionMessage::read(sample.payload()))? {
            return Ok(Some(mission));
        }
        bell.wait(Duration::from_millis(50))?;
    }
    Ok(None)
}

/// The state of the world as it comes in.
struct World {
    states: Inbox,
    newest: Sample,
}

impl World {
    /// Subscribes to the state, and waits until it is there; `None` if `stop` comes first.
    fn look_at(bus: &dyn Transport, stop: &AtomicBool) -> Result<Option<Self>, PeerError> {
        let mut states = Inbox::new(bus, Topic::State)?;
        let mut bell = bus.listener(Wake::State)?;
        while !stop.load(Ordering::Relaxed) {
            if let Some((newest, ())) = states.latest(is_state)? {
                return Ok(Some(Self { states, newest }));
            }
            bell.wait(Duration::from_millis(50))?;
        }
        Ok(None)
    }

    /// Takes in the newest state, and says whether it is new.
    fn look(&mut self) -> Result<bool, PeerError> {
        let Some((newest, ())) = self.states.latest(is_state)? else { return Ok(false) };
        self.newest = newest;
        Ok(true)
    }
}

fn is_state(sample: &Sample) -> Result<(), Malformed> {
    StateView::new(sample.payload()).map(drop)
}

/// An agent with its ends on the bus.
struct Mind<'a> {
    agent: &'a mut dyn Agent,
    client: Client,
    dialog: Inbox,
    tells: Box<dyn Publisher>,
    senses: Senses,
    /// Absent for an agent that senses nothing: a state that nobody looks at is not made.
    world: Option<World>,
    eyes: Option<Eyes>,
    glance: Option<Glance>,
    /// What was before it joined, until it has taken that in.
    past: Option<Past>,
    /// The turn of the newest plan.
    turn: u64,
    joined_nanos: u64,
    lock_step: bool,
    attends: bool,
    /// An event and plans that came too late for the turn before.
    later_event: Option<(Envelope, EventMessage)>,
    later_plans: Vec<Sample>,
    /// Whether it has claimed its body and not heard that it is another's.
    hopes: bool,
    /// The numbers of its latest claim, and of the act whose outcome it waits for.
    claim: u64,
    act: Option<u64>,
    rest: u64,
    /// In real time: it senses nothing before that tick.
    rests_until: u64,
    deeds: Vec<Deed>,
}

impl<'a> Mind<'a> {
    fn join(
        catalog: &Arc<Catalog>,
        agent: &'a mut dyn Agent,
        body: u32,
        bus: &dyn Transport,
        lock_step: bool,
        world: World,
    ) -> Result<Self, PeerError> {
        let senses = agent.senses();
        // Before the first tick there is no past, and all that was said is new.
        let is_first = lock_step && world.newest.envelope().tick == 0;
        Ok(Self {
            client: Client::join(bus, body, "agent")?,
            dialog: Inbox::new(bus, Topic::Dialog)?,
            tells: bus.publisher(Topic::Dialog)?,
            world: (senses.sight || senses.state).then_some(world),
            eyes: senses.sight.then(|| Eyes::of_body(bus, body, Arc::clone(catalog))).transpose()?,
            glance: None,
            past: (!is_first).then(Past::default),
            turn: 0,
            joined_nanos: if is_first { 0 } else { monotonic_nanos() },
            lock_step,
            attends: false,
            later_event: None,
            later_plans: Vec::new(),
            hopes: true,
            claim: 0,
            act: None,
            rest: 1,
            rests_until: 0,
            deeds: Vec::new(),
            agent,
            senses,
        })
    }

    fn claim(&mut self) -> Result<(), PeerError> {
        self.claim = self.client.claim(false)?;
        Ok(())
    }

    /// Sleeps until something happens, and lives it.
    fn live(&mut self) -> Result<(), PeerError> {
        let looks_up = !self.lock_step && self.world.is_some();
        self.client.sleep(if looks_up { SENSING_NAP } else { NAP })?;
        self.tells.update()?;
        if self.attends {
            return self.take_turn();
        }
        self.hear_events(None)?;
        self.hear_dialog(None)?;
        self.settle()?;
        if !self.lock_step && self.past.is_none() && self.sense()? {
            let tick = self.world.as_ref().map_or(0, |world| world.newest.envelope().tick);
            if tick >= self.rests_until {
                self.hear_now(tick)?;
                self.rests_until = tick + std::mem::replace(&mut self.rest, 1);
            }
        }
        Ok(())
    }

    /// In lock-step it hears and does things in its turn alone, and nothing that came after the turn was told: what it
    /// does is no matter of how fast who is.
    fn take_turn(&mut self) -> Result<(), PeerError> {
        let Some(tick) = self.client.turn()? else { return Ok(()) };
        self.hear_events(Some(self.client.turn_nanos()))?;
        self.hear_dialog(Some(tick))?;
        self.sense()?;
        self.hear_now(tick)?;
        self.client.ready(std::mem::replace(&mut self.rest, 1))?;
        Ok(())
    }

    /// Hears what has happened; of what was sent after `until_nanos`, the rest later.
    fn hear_events(&mut self, until_nanos: Option<u64>) -> Result<(), PeerError> {
        while let Some((envelope, event)) = self.next_event()? {
            if until_nanos.is_some_and(|until| envelope.sent_nanos > until) {
                self.later_event = Some((envelope, event));
                return Ok(());
            }
            if event.body == self.client.body() {
                self.hear_event(&envelope, &event)?;
            }
        }
        Ok(())
    }

    fn next_event(&mut self) -> Result<Option<(Envelope, EventMessage)>, PeerError> {
        match self.later_event.take() {
            Some(later) => Ok(Some(later)),
            None => Ok(self.client.event()?),
        }
    }

    fn hear_event(&mut self, envelope: &Envelope, event: &EventMessage) -> Result<(), PeerError> {
        if event.kind() == Some(EventKind::Commander) {
            return self.hear_commander(event);
        }
        let Some(Outcome { command, status, detail, .. }) = outcome(envelope, event) else { return Ok(()) };
        if command == self.claim {
            return self.hear_claim(status, &detail);
        }
        if let Some(past) = &mut self.past {
            past.note_outcome(event.turn, status, &detail);
        } else if self.act == Some(command) {
            self.act = None;
            // What came of an act is worth a look.
            self.rests_until = 0;
            self.hear(&Heard::Outcome { status, detail: &detail })?;
        }
        Ok(())
    }

    /// What came of its claim, also where it still takes in what was before it. Whoever started it sees nothing else of a refusal.
    fn hear_claim(&mut self, status: Status, detail: &str) -> Result<(), PeerError> {
        if status.is_success() {
            return Ok(());
        }
        tracing::warn!("{detail}; this agent waits until the body is free");
        if std::mem::replace(&mut self.hopes, false) {
            self.hear(&Heard::Commands(false))?;
        }
        Ok(())
    }

    /// Its body has another commander: perhaps itself, perhaps nobody, which it does not leave at that.
    fn hear_commander(&mut self, event: &EventMessage) -> Result<(), PeerError> {
        let commands = self.client.commands_body();
        if event.number == 0 {
            self.claim()?;
        }
        if std::mem::replace(&mut self.hopes, commands) != commands {
            self.hear(&Heard::Commands(commands))?;
        }
        Ok(())
    }

    /// Hears what is asked of its body; in a turn, what was said at earlier ticks.
    fn hear_dialog(&mut self, turn: Option<u64>) -> Result<(), PeerError> {
        let body = self.client.body();
        while let Some((sample, is_mine)) = self.dialog.next(|sample| {
            let DialogView { header, .. } = DialogView::new(sample.payload())?;
            Ok(header.kind() == Some(DialogKind::Plan) && header.body == body)
        })? {
            if is_mine {
                self.later_plans.push(sample);
                self.later_plans.drain(..self.later_plans.len().saturating_sub(MOST_PLANS));
            }
        }
        // Of several at one tick, the newest turn of the dialog counts, whoever was the fastest.
        let mut plans = std::mem::take(&mut self.later_plans);
        let dialog_turn = |sample: &Sample| DialogView::new(sample.payload()).map_or(0, |view| view.header.turn);
        plans.sort_by_key(|sample| (sample.envelope().tick, dialog_turn(sample)));
        for sample in plans {
            if turn.is_some_and(|tick| sample.envelope().tick >= tick) {
                self.later_plans.push(sample);
            } else {
                self.hear_plan(&sample)?;
            }
        }
        Ok(())
    }

    fn hear_plan(&mut self, sample: &Sample) -> Result<(), PeerError> {
        let view = DialogView::new(sample.payload())?;
        // A dialog service that takes a dead one's place tells the plan under way once more.
        let turn = view.header.turn;
        if std::mem::replace(&mut self.turn, turn) == turn && turn != 0 {
            return Ok(());
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
        let is_new = self.world.as_mut().map_or(Ok(false), World::look)?;
        if let Some(world) = &self.world {
            self.client.note_sensed(world.newest.envelope().tick);
        }
        let Some(eyes) = &mut self.eyes else { return Ok(is_new) };
        let glance = eyes.look()?;
        let is_new = glance.is_some();
        self.glance = glance.or(self.glance.take());
        Ok(is_new)
    }

    /// Has the agent hear how the world is; at a turn of lock-step even if it senses nothing of it.
    fn hear_now(&mut self, tick: u64) -> Result<(), PeerError> {
        let body = self.client.body();
        let state = self.world.as_ref().map(|world| StateView::new(world.newest.payload())).transpose()?;
        let own = state.and_then(|state| state.bodies.iter().find(|record| record.body == body));
        let sight = self.glance.as_ref().zip(state).map(|(glance, state)| Sight::new(glance, state));
        let now = Now { tick, own, sight: sight.as_ref(), state: state.filter(|_| self.senses.state) };
        self.agent.hear(&Heard::Now(&now), &mut self.deeds);
        self.carry_out()
    }

    fn hear(&mut self, heard: &Heard<'_>) -> Result<(), PeerError> {
        self.agent.hear(heard, &mut self.deeds);
        self.carry_out()
    }

    fn carry_out(&mut self) -> Result<(), PeerError> {
        for deed in self.deeds.drain(..) {
            match deed {
                Deed::Act { turn, action } => self.act = Some(self.client.act(turn, action)?),
                Deed::Tell(message) => {
                    self.tells.send(self.client.tick(), message.bytes(), &mut |bytes| message.write(bytes))?;
                }
                Deed::Rest(ticks) => self.rest = ticks.clamp(1, MOST_REST),
            }
        }
        Ok(())
    }
}
