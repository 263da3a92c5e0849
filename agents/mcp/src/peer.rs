//! A body of a session, seen from outside: what it is told to do, what comes of it, what it sees, and what is said.

use std::{
    collections::{BTreeMap, VecDeque},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

use cohabit_agent::{Client, Eyes, Outcome, outcome};
use cohabit_bus::{
    Inbox, Publisher, Sample, Topic, Transport, Wake, is_alive,
    message::{DialogKind, DialogMessage, DialogView, Malformed, MissionMessage, StateView},
    monotonic_nanos,
};
use cohabit_cdf::{Action, BodyId, Catalog};
use cohabit_dialog::known::everything;
use cohabit_language::Known;

use crate::{
    body_choice::{BodyChoice, listed},
    error::BridgeError,
    hearing,
    limits::{MOST_CALLS, MOST_HEARD, WORLD_PATIENCE},
};

/// What the others call a peer of this kind whose client has not said its name.
const PEER: &str = "mcp";
/// How long it sleeps while it waits for the world.
const NAP: Duration = Duration::from_millis(50);
/// The most commands whose outcomes are kept: a claim and an action for each call, and those that were given up.
const MOST_OUTCOMES: usize = 4 * MOST_CALLS;

/// Something that was said or told.
struct Heard {
    number: u64,
    /// Whether a person said it to this body.
    is_to_it: bool,
    text: String,
}

/// A body, and the connection to its session.
pub(crate) struct Peer<'a> {
    bus: &'a dyn Transport,
    catalog: Arc<Catalog>,
    joined_nanos: u64,
    client: Client,
    dialog: Inbox,
    says: Box<dyn Publisher>,
    states: Inbox,
    newest: Sample,
    /// Of commands that were given here and have no outcome yet, nothing; else what came of them.
    outcomes: BTreeMap<u64, Option<Outcome>>,
    heard: VecDeque<Heard>,
    /// How much was ever heard.
    count: u64,
    tells_goals: bool,
}

fn is_state(sample: &Sample) -> Result<(), Malformed> {
    StateView::new(sample.payload()).map(drop)
}

impl<'a> Peer<'a> {
    /// Joins the session on `bus` for the body that is meant; `None` if `stop` comes first.
    ///
    /// # Errors
    /// [`BridgeError`]: there is no world, no such body, or another world than that of the catalogue.
    pub fn join(
        bus: &'a dyn Transport,
        catalog: &Arc<Catalog>,
        choice: BodyChoice,
        tells_goals: bool,
        stop: &AtomicBool,
    ) -> Result<Option<Self>, BridgeError> {
        let mut states = Inbox::new(bus, Topic::State)?;
        let Some((mission, newest)) = wait_for_world(bus, &mut states, stop)? else { return Ok(None) };
        if mission.header.lock_step == 1 {
            return Err(BridgeError::LockStep);
        }
        let state = StateView::new(newest.payload())?;
        let body = choice.among(state.bodies);
        let body = body.ok_or_else(|| BridgeError::NoBody { asked: choice, there: listed(state.bodies) })?;
        if state.objects.iter().any(|object| usize::from(object.class) >= catalog.classes().len()) {
            return Err(BridgeError::OtherWorld);
        }
        Ok(Some(Self {
            bus,
            catalog: Arc::clone(catalog),
            joined_nanos: monotonic_nanos(),
            client: Client::join(bus, body, PEER)?,
            dialog: Inbox::new(bus, Topic::Dialog)?,
            says: bus.publisher(Topic::Dialog)?,
            states,
            newest,
            outcomes: BTreeMap::new(),
            heard: VecDeque::new(),
            count: 0,
            tells_goals,
        }))
    }

    /// The number of the body.
    pub const fn body(&self) -> u32 {
        self.client.body()
    }

    /// Is called so from now on by people and other peers: the name of its client.
    pub fn rename(&mut self, name: &str) {
        self.client.rename(name);
    }

    /// The classes of things, and the table of what can be done to them.
    pub const fn catalog(&self) -> &Arc<Catalog> {
        &self.catalog
    }

    /// The newest state.
    pub fn state(&self) -> Result<StateView<'_>, BridgeError> {
        Ok(StateView::new(self.newest.payload())?)
    }

    /// The tick of the newest state.
    pub fn tick(&self) -> u64 {
        self.newest.envelope().tick
    }

    /// Whether its simulator has ended, and the session with it.
    pub fn is_over(&self) -> bool {
        !is_alive(self.newest.envelope().run)
    }

    /// All there is, as language speaks of it; nothing, where the body is not in any room.
    pub fn scene(&self) -> Result<Option<Known>, BridgeError> {
        Ok(everything(self.state()?, BodyId(self.body()), &self.catalog))
    }

    /// Sleeps until something is said or happens, at most so long.
    pub fn sleep(&mut self, timeout: Duration) -> Result<(), BridgeError> {
        Ok(self.client.sleep(timeout)?)
    }

    /// Takes in all that came, and shows that it lives.
    pub fn take_in(&mut self) -> Result<(), BridgeError> {
        self.client.beat()?;
        // Who joins late hears what was said before.
        self.says.update()?;
        self.take_in_events()?;
        self.take_in_dialog()?;
        if let Some((newest, ())) = self.states.latest(is_state)? {
            self.client.note_sensed(newest.envelope().tick);
            self.newest = newest;
        }
        Ok(())
    }

    fn take_in_events(&mut self) -> Result<(), BridgeError> {
        while let Some((envelope, event)) = self.client.event()? {
            if envelope.sent_nanos < self.joined_nanos {
                continue;
            }
            match outcome(&envelope, &event) {
                Some(outcome) => {
                    if let Some(expected) = self.outcomes.get_mut(&outcome.command) {
                        *expected = Some(outcome);
                    }
                }
                None => {
                    if let Some(text) = hearing::event(&event, self.tells_goals) {
                        self.hear(text, false);
                    }
                }
            }
        }
        Ok(())
    }

    fn take_in_dialog(&mut self) -> Result<(), BridgeError> {
        let (own, body) = (self.says.run(), self.body());
        while let Some((sample, ())) = self.dialog.next(|sample| DialogView::new(sample.payload()).map(drop))? {
            let envelope = sample.envelope();
            if envelope.run == own || envelope.sent_nanos < self.joined_nanos {
                continue;
            }
            let DialogView { header, .. } = DialogView::new(sample.payload())?;
            if let Some(text) = hearing::dialog(header, body) {
                let is_to_it = header.kind() == Some(DialogKind::Utterance) && header.body == body;
                self.hear(text, is_to_it);
            }
        }
        Ok(())
    }

    fn hear(&mut self, text: String, is_to_it: bool) {
        if self.heard.len() >= MOST_HEARD {
            self.heard.pop_front();
        }
        self.heard.push_back(Heard { number: self.count, is_to_it, text });
        self.count += 1;
    }

    /// How much was ever heard: what comes from now on has this number, or a higher one.
    pub const fn heard_so_far(&self) -> u64 {
        self.count
    }

    /// All that was heard and not told yet.
    pub fn take_heard(&mut self) -> Vec<String> {
        self.heard.drain(..).map(|heard| heard.text).collect()
    }

    /// What people have said to the body since that much was heard, which is then told.
    pub fn take_said_since(&mut self, count: u64) -> Vec<String> {
        let is_answer = |heard: &Heard| heard.is_to_it && heard.number >= count;
        let said = self.heard.iter().filter(|heard| is_answer(heard)).map(|heard| heard.text.clone()).collect();
        self.heard.retain(|heard| !is_answer(heard));
        said
    }

    /// Asks to command the body, whoever does now. Gives the claim's number.
    pub fn claim(&mut self) -> Result<u64, BridgeError> {
        let command = self.client.claim(true)?;
        Ok(self.expect(command))
    }

    /// Whether it commands the body, as far as it has heard.
    pub const fn commands_body(&self) -> bool {
        self.client.commands_body()
    }

    /// Has the body do something, in place of what it was doing. Gives the command's number.
    pub fn act(&mut self, action: Action) -> Result<u64, BridgeError> {
        let command = self.client.act(0, action)?;
        Ok(self.expect(command))
    }

    fn expect(&mut self, command: u64) -> u64 {
        if self.outcomes.len() >= MOST_OUTCOMES {
            self.outcomes.pop_first();
        }
        self.outcomes.insert(command, None);
        command
    }

    /// What came of a command, once it has ended; asked again, nothing.
    pub fn take_outcome(&mut self, command: u64) -> Option<Outcome> {
        let outcome = self.outcomes.get_mut(&command)?.take()?;
        self.outcomes.remove(&command);
        Some(outcome)
    }

    /// Says or asks something as the body: to all who listen, and to the log.
    pub fn say(&mut self, kind: DialogKind, text: &str) -> Result<(), BridgeError> {
        let message = DialogMessage::new(kind, self.body(), 0, text);
        self.says.send(self.client.tick(), message.bytes(), &mut |bytes| message.write(bytes))?;
        Ok(())
    }

    /// Opens the body's own eyes; while they are open, their pictures are rendered.
    pub fn open_eyes(&self) -> Result<Eyes, BridgeError> {
        Ok(Eyes::of_body(self.bus, self.body(), Arc::clone(&self.catalog))?)
    }
}

/// The mission and the first state of the session on `bus`; `None` if `stop` comes first.
fn wait_for_world(
    bus: &dyn Transport,
    states: &mut Inbox,
    stop: &AtomicBool,
) -> Result<Option<(MissionMessage, Sample)>, BridgeError> {
    let mut missions = Inbox::new(bus, Topic::Mission)?;
    let mut bell = bus.listener(Wake::State)?;
    let deadline = Instant::now() + WORLD_PATIENCE;
    let (mut mission, mut state) = (None, None);
    while !stop.load(Ordering::Relaxed) {
        mission = missions.latest(|sample| MissionMessage::read(sample.payload()))?.map(|(_, told)| told).or(mission);
        state = states.latest(is_state)?.map(|(sample, ())| sample).or(state);
        match (mission, state) {
            (Some(mission), Some(state)) => return Ok(Some((mission, state))),
            (told, seen) => (mission, state) = (told, seen),
        }
        if Instant::now() >= deadline {
            return Err(BridgeError::NoWorld);
        }
        bell.wait(NAP)?;
    }
    Ok(None)
}
