//! One body's connection to its session.

use std::time::{Duration, Instant};

use cohabit_bus::{
    BusError, Envelope, Heart, Inbox, Listener, Publisher, Topic, Transport, Wake,
    message::{self, CommandKind, CommandMessage, EventKind, EventMessage, StepView},
    monotonic_nanos,
};
use cohabit_cdf::{Action, Status};

/// Commands a body and hears what comes of it. Dropping it lets go of the body, and the world waits for it no more.
pub struct Client {
    body: u32,
    peer: String,
    commands: Box<dyn Publisher>,
    events: Inbox,
    steps: Inbox,
    bell: Box<dyn Listener>,
    heart: Heart,
    /// The numbers of its claims begin here, and those of its acts too, unless it was there from the first tick.
    base: u64,
    /// The numbers of its acts begin here: no matter of chance in lock-step, for they are part of the world's digest.
    base_of_acts: u64,
    count: u64,
    latest: u64,
    /// When its latest turn was told: all that belongs to it was sent before.
    turn_nanos: u64,
    /// The newest tick that it heard of.
    tick: u64,
    /// The newest tick whose world it has sensed, or at which it had its turn.
    sensed: u64,
    commands_body: bool,
}

/// What came of a command.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// The command's number.
    pub command: u64,
    /// How it went.
    pub status: Status,
    /// The world's sentence about it.
    pub detail: String,
    /// The tick at which it ended.
    pub tick: u64,
}

impl Client {
    /// Joins the session on `bus` as a peer of that kind, for that body. It commands nothing before it claims it.
    ///
    /// # Errors
    /// [`BusError::Open`].
    pub fn join(bus: &dyn Transport, body: u32, peer: &str) -> Result<Self, BusError> {
        let base = first_command();
        Ok(Self {
            body,
            peer: peer.to_owned(),
            bell: bus.listener(Wake::Talk)?,
            events: Inbox::new(bus, Topic::Events)?,
            steps: Inbox::new(bus, Topic::Steps)?,
            commands: bus.publisher(Topic::Commands)?,
            heart: Heart::new(bus, peer, body)?,
            base,
            base_of_acts: base,
            count: 0,
            latest: 0,
            turn_nanos: 0,
            tick: 0,
            sensed: 0,
            commands_body: false,
        })
    }

    /// The body.
    #[must_use]
    pub const fn body(&self) -> u32 {
        self.body
    }

    /// Is called so from now on by those who read its claims and its pulse.
    pub fn rename(&mut self, peer: &str) {
        peer.clone_into(&mut self.peer);
        self.heart.rename(peer);
    }

    /// Who it is, as states and events name the commander of a body.
    pub(crate) fn run(&self) -> u64 {
        self.commands.run()
    }

    /// Whether it commands the body, as far as it has heard.
    #[must_use]
    pub const fn commands_body(&self) -> bool {
        self.commands_body
    }

    /// The number of its latest command; 0 before the first.
    #[must_use]
    pub const fn latest(&self) -> u64 {
        self.latest
    }

    /// When its latest turn in lock-step was told, ns of the monotonic clock.
    pub(crate) const fn turn_nanos(&self) -> u64 {
        self.turn_nanos
    }

    /// The newest tick that it heard of.
    #[must_use]
    pub const fn tick(&self) -> u64 {
        self.tick
    }

    /// Asks to command the body; whoever does now, if it is to be taken over. Gives the claim's number: its outcome
    /// says whether it was granted.
    ///
    /// # Errors
    /// [`BusError::Send`].
    pub fn claim(&mut self, take_over: bool) -> Result<u64, BusError> {
        self.claim_of(self.body, take_over)
    }

    /// The same for any body: one peer may command several.
    pub(crate) fn claim_of(&mut self, body: u32, take_over: bool) -> Result<u64, BusError> {
        let command = self.next_after(self.base);
        let claim = CommandMessage::claim(command, body, &self.peer, take_over);
        self.send(&claim)?;
        Ok(command)
    }

    /// Lets go of the body: it goes back to whom it was taken from.
    ///
    /// # Errors
    /// [`BusError::Send`].
    pub fn release(&mut self) -> Result<(), BusError> {
        self.commands_body = false;
        self.send(&CommandMessage::new(CommandKind::Release, self.body))
    }

    /// Has the body do something, as part of a dialog turn, or of none if 0. Gives the command's number.
    ///
    /// # Errors
    /// [`BusError::Send`].
    pub fn act(&mut self, turn: u64, action: Action) -> Result<u64, BusError> {
        self.act_in(self.body, turn, action)
    }

    /// The same in any body that it commands.
    pub(crate) fn act_in(&mut self, body: u32, turn: u64, action: Action) -> Result<u64, BusError> {
        let command = self.next_after(self.base_of_acts);
        self.send(&CommandMessage::act(command, turn, body, action))?;
        Ok(command)
    }

    /// The next event that was not heard yet, if there is one.
    ///
    /// # Errors
    /// [`BusError::Receive`].
    pub fn event(&mut self) -> Result<Option<(Envelope, EventMessage)>, BusError> {
        let next = self.events.next(|sample| message::read::<EventMessage>(sample.payload()))?;
        let Some((sample, event)) = next else { return Ok(None) };
        self.tick = self.tick.max(sample.envelope().tick);
        if event.kind() == Some(EventKind::Commander) && event.body == self.body {
            self.commands_body = event.number.cast_unsigned() == self.commands.run();
        }
        Ok(Some((*sample.envelope(), event)))
    }

    /// Sleeps until something is said or happens, or it is somebody's turn, at most for `timeout`.
    ///
    /// # Errors
    /// [`BusError::Receive`].
    pub fn sleep(&mut self, timeout: Duration) -> Result<(), BusError> {
        self.beat()?;
        self.bell.wait(timeout)?;
        Ok(())
    }

    /// Waits for what comes of a command, at most for `timeout`. Events before it are heard by nobody else.
    ///
    /// # Errors
    /// [`BusError::Receive`].
    pub fn outcome(&mut self, command: u64, timeout: Duration) -> Result<Option<Outcome>, BusError> {
        let deadline = Instant::now() + timeout;
        loop {
            while let Some((envelope, event)) = self.event()? {
                if let Some(outcome) = outcome(&envelope, &event).filter(|outcome| outcome.command == command) {
                    return Ok(Some(outcome));
                }
            }
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Ok(None);
            }
            self.sleep(left.min(Duration::from_millis(100)))?;
        }
    }

    /// In lock-step: has the world wait for it, at most so long a turn; for ever, if nothing is said.
    ///
    /// # Errors
    /// [`BusError::Send`].
    pub fn attend(&mut self, patience: Option<Duration>) -> Result<(), BusError> {
        let nanos = patience.map_or(0, |patience| u64::try_from(patience.as_nanos()).unwrap_or(0));
        self.send(&CommandMessage::new(CommandKind::Attend, self.body).with(nanos))
    }

    /// In lock-step: has the world wait for it no more.
    ///
    /// # Errors
    /// [`BusError::Send`].
    pub fn leave(&mut self) -> Result<(), BusError> {
        self.send(&CommandMessage::new(CommandKind::Leave, self.body))
    }

    /// In lock-step: its turn is over, and the next comes so many ticks later, or with an outcome of its body.
    ///
    /// # Errors
    /// [`BusError::Send`].
    pub fn ready(&mut self, ticks: u64) -> Result<(), BusError> {
        self.send(&CommandMessage::new(CommandKind::Ready, self.body).with(ticks))
    }

    /// In lock-step: the tick of its turn, if it has come.
    ///
    /// # Errors
    /// [`BusError::Receive`].
    pub fn turn(&mut self) -> Result<Option<u64>, BusError> {
        let run = self.commands.run();
        let mut turn = None;
        while let Some((sample, is_due)) =
            self.steps.next(|sample| Ok(StepView::new(sample.payload())?.due.contains(&run)))?
        {
            let envelope = sample.envelope();
            self.note_sensed(envelope.tick);
            if is_due {
                turn = Some(envelope.tick);
                self.turn_nanos = envelope.sent_nanos;
            }
        }
        if turn == Some(0) {
            self.base_of_acts = first_act(&self.peer, self.body);
        }
        Ok(turn)
    }

    /// In lock-step: waits for its turn, at most for `timeout`; gives its tick.
    ///
    /// # Errors
    /// [`BusError::Receive`].
    pub fn wait_for_turn(&mut self, timeout: Duration) -> Result<Option<u64>, BusError> {
        let deadline = Instant::now() + timeout;
        loop {
            let turn = self.turn()?;
            let left = deadline.saturating_duration_since(Instant::now());
            if turn.is_some() || left.is_zero() {
                return Ok(turn);
            }
            self.sleep(left.min(Duration::from_millis(100)))?;
        }
    }

    /// Shows that it lives; call it twice a second or more often. [`Self::sleep`] does.
    ///
    /// # Errors
    /// [`BusError::Send`].
    pub fn beat(&mut self) -> Result<(), BusError> {
        self.heart.beat(self.sensed, self.events.lost() + self.steps.lost())
    }

    /// It has sensed the world as it was at a tick: how far it is behind shows in its heartbeat.
    pub fn note_sensed(&mut self, tick: u64) {
        self.tick = self.tick.max(tick);
        self.sensed = self.sensed.max(tick);
    }

    const fn next_after(&mut self, base: u64) -> u64 {
        self.count += 1;
        self.latest = base + self.count;
        self.latest
    }

    fn send(&mut self, message: &CommandMessage) -> Result<(), BusError> {
        self.commands.send_record(self.tick, message).map(drop)
    }
}

impl Drop for Client {
    fn drop(&mut self) {
        // The session may be gone already.
        let _ = self.release().and_then(|()| self.leave());
    }
}

/// The outcome that an event tells of, if it does.
#[must_use]
pub fn outcome(envelope: &Envelope, event: &EventMessage) -> Option<Outcome> {
    let status = event.status().filter(|_| event.kind() == Some(EventKind::Outcome))?;
    let detail = event.text.as_str().to_owned();
    Some(Outcome { command: event.command, status, detail, tick: envelope.tick })
}

/// A number unlike that of other agents, in the upper bits of what JSON can hold exactly.
fn first_command() -> u64 {
    let mixed = monotonic_nanos() ^ (u64::from(std::process::id()) << 7);
    (mixed & 0xf_ffff) << 32
}

/// The same in every run of a session, for a peer that is there from the first tick; apart for peers of different kinds
/// at one body.
fn first_act(peer: &str, body: u32) -> u64 {
    let mixed = peer.bytes().fold(body, |hash, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193));
    u64::from(mixed & 0xf_ffff) << 32
}
