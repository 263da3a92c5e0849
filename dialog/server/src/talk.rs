//! The conversation on the bus: what pages say goes in, what agents and the world tell comes back.

mod audience;
mod held;
mod inner;
mod menu;
mod outbox;
mod picture;
mod seated;
mod world;

use std::{
    collections::BTreeMap,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::Duration,
};

use cohabit_bus::{Envelope, Inbox, Topic, Transport, Wake, monotonic_nanos};
use cohabit_cdf::{BodyId, Catalog, Layout, ObjectId};
use cohabit_language::Meant;

use crate::{
    DialogError,
    alarm::Alarm,
    conversation::Aloud,
    drafts::{Drafted, Drafts, Thought},
    driving::Drivers,
    expression::FacialExpression,
    hub::Hub,
    interpreter::Puzzles,
    journal::{Journal, Place},
    latency::Latency,
    page,
    robots::{Robots, Visitor},
    spoken::{Reading, Spoken},
    voice::Voice,
};
use inner::Inner;
use outbox::is_shown_to_all;

pub use world::{Ears, listen, show_state, wait_for_world};

/// Why nothing came of an interpreter, for the log.
const NOT_ANSWERED: &str = "the service that asked ended before the answer";

/// The conversations, with their ends on the bus and to the pages. One lock: who speaks first is heard first.
pub struct Talk {
    inner: Mutex<Inner>,
    hub: Arc<Hub>,
    drivers: Arc<Drivers>,
    catalog: Arc<Catalog>,
    layout: Arc<Layout>,
    /// Who makes something of what is not understood, if anybody.
    interpreter: Option<Puzzles>,
    /// How robots speak, and who is heard.
    voice: Arc<Voice>,
    /// What robots were named.
    names: Vec<String>,
    /// When something that is held back is answered without anybody's doing.
    alarm: Alarm,
    /// What pages may say next.
    drafts: Drafts,
}

/// All by which a conversation has to do with pages.
pub struct Pages {
    /// What they share.
    pub hub: Arc<Hub>,
    /// Who drives.
    pub drivers: Arc<Drivers>,
    /// How they are heard, and hear.
    pub voice: Arc<Voice>,
    /// Where they leave what they may say next.
    pub drafts: Drafts,
    /// The floor plan that they show.
    pub layout: Arc<Layout>,
}

/// What something follows from.
#[derive(Clone, Copy)]
enum Heard<'a> {
    /// What somebody said at a page.
    AtPage(Visitor),
    /// A message on the bus.
    OnBus(&'a Envelope),
    /// What was heard before.
    Nothing,
}

impl Talk {
    /// A conversation on `bus`, shown to the pages; it goes on where that of `journal` was.
    pub fn new(
        bus: &dyn Transport,
        catalog: Arc<Catalog>,
        mut robots: Robots,
        interpreter: Option<Puzzles>,
        pages: Pages,
        journal: Journal,
    ) -> Result<Arc<Self>, DialogError> {
        let Pages { hub, drivers, voice, drafts, layout } = pages;
        let names = if robots.are_several() { robots.called_by().map(str::to_owned).collect() } else { Vec::new() };
        let past = journal.past();
        hub.restore(&past.lines);
        robots.restore(&past.conversations, &past.lessons);
        for robot in robots.iter().filter(|robot| robot.conversation.expression() != FacialExpression::default()) {
            hub.show_face(robot.body.0, &page::expression(robot.body.0, robot.conversation.expression()));
        }
        let mut inner = Inner {
            robots,
            journal,
            latency: Latency::default(),
            dialog: bus.publisher(Topic::Dialog)?,
            states: Inbox::new(bus, Topic::State)?,
            newest: None,
            spoken_to: BodyId(0),
            woke_at: 0,
            present: BTreeMap::new(),
            wizards: 0,
        };
        inner.tell_again()?;
        let alarm = Alarm::default();
        alarm.set(inner.due());
        let inner = Mutex::new(inner);
        Ok(Arc::new(Self { inner, hub, drivers, catalog, layout, interpreter, voice, names, alarm, drafts }))
    }

    /// Waits until this conversation sees the world, or until `over`: who is let in then is understood at once.
    pub fn wait_until_it_sees(&self, bus: &dyn Transport, over: &dyn Fn() -> bool) -> Result<(), DialogError> {
        let mut listener = bus.listener(Wake::State)?;
        while !over() {
            let mut inner = self.lock();
            inner.refresh()?;
            if inner.newest.is_some() {
                break;
            }
            drop(inner);
            listener.wait(Duration::from_millis(20))?;
        }
        Ok(())
    }

    /// The tick of the state that it knows.
    fn newest_tick(&self) -> u64 {
        self.lock().newest.as_ref().map_or(0, |sample| sample.envelope().tick)
    }

    fn lock(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A page of this key is open from now on: the number of its visitor, and what they have answered; `None`, if no
    /// more visitors can be told apart.
    pub fn enter(&self, key: u64) -> Option<(u32, Vec<String>)> {
        let Inner { journal, present, .. } = &mut *self.lock();
        let number = journal.visitor(key, |number| present.contains_key(&number))?;
        *present.entry(number).or_default() += 1;
        Some((number, journal.past().answered.get(&number).into_iter().flatten().cloned().collect()))
    }

    /// A page of that visitor is gone.
    pub fn leave(&self, number: u32) {
        let present = &mut self.lock().present;
        if let Some(pages) = present.get_mut(&number) {
            *pages -= 1;
            if *pages == 0 {
                present.remove(&number);
            }
        }
    }

    /// Somebody at a page has typed this so far, and says it perhaps.
    pub fn note_draft(&self, text: &str, visitor: Visitor) {
        self.drafts.leave(visitor, text);
    }

    /// Understands what pages may say next, until `over`.
    pub fn read_ahead(&self, drafted: Drafted, over: &dyn Fn() -> bool) -> Result<(), DialogError> {
        drafted.until(over).try_for_each(|draft| self.think_of(&draft.text, draft.visitor))
    }

    /// Understands an utterance without a lock, so that there is less to do in its turn. What others say meanwhile comes first.
    fn think_of(&self, said: &str, visitor: Visitor) -> Result<(), DialogError> {
        let thoughts = self.lock().thoughts(said, visitor)?;
        thoughts.into_iter().for_each(Thought::think);
        Ok(())
    }

    /// Somebody at a page said something, received at `received_nanos`.
    pub fn hear(&self, said: &str, visitor: Visitor, received_nanos: u64) -> Result<(), DialogError> {
        // What was being said is the answer to something else.
        self.voice.hush();
        self.think_of(said, visitor)?;
        let mut inner = self.lock();
        let (bodies, text) = inner.addressed(said, visitor, received_nanos)?;
        for (nth, body) in bodies.into_iter().enumerate() {
            inner.listen_to(visitor, body)?;
            let Some(robot) = inner.robots.of_body(body) else { continue };
            let (turn, mut reactions) = robot.conversation.hear_called(said, &text, received_nanos, &robot.knowledge);
            reactions.retain(|reaction| nth == 0 || is_shown_to_all(reaction));
            inner.latency.begin(turn, received_nanos, monotonic_nanos());
            self.carry_out(&mut inner, body, Heard::AtPage(visitor), reactions)?;
        }
        Ok(())
    }

    /// Somebody at a page said something aloud, and meant it then, perhaps in other words than were heard. Whether anybody
    /// seems to have said anything.
    pub fn hear_aloud(&self, spoken: &Spoken, visitor: Visitor, meant_nanos: u64) -> Result<bool, DialogError> {
        let Some(first) = spoken.first() else { return Ok(false) };
        self.think_of(first, visitor)?;
        let mut inner = self.lock();
        let Some(body) = inner.addressed(first, visitor, spoken.text_nanos)?.0.first().copied() else {
            return Ok(false);
        };
        let called = |text: &str| inner.robots.called(text);
        let reading =
            inner.robots.look_at(body).and_then(|robot| robot.conversation.reading(spoken, &called, &robot.knowledge));
        let Some(Reading { text: said, is_doubtful }) = reading else { return Ok(false) };
        self.voice.hush();
        let (bodies, text) = inner.addressed(&said, visitor, spoken.text_nanos)?;
        let aloud = Aloud { raw: &spoken.heard.raw, is_doubtful };
        for (nth, body) in bodies.into_iter().enumerate() {
            inner.listen_to(visitor, body)?;
            let Some(robot) = inner.robots.of_body(body) else { continue };
            let (turn, mut reactions) =
                robot.conversation.hear_aloud(&said, &text, aloud, meant_nanos, &robot.knowledge);
            reactions.retain(|reaction| nth == 0 || is_shown_to_all(reaction));
            inner.latency.begin(turn, meant_nanos, monotonic_nanos());
            let speech = [spoken.began_nanos, spoken.ended_nanos, spoken.text_nanos];
            let moments = inner.latency.spoken(speech, &spoken.heard.raw);
            self.carry_out(&mut inner, body, Heard::AtPage(visitor), reactions)?;
            inner.publish_spoken(&moments)?;
            self.hub.tell(&page::latency(&moments, None));
        }
        Ok(true)
    }

    /// Which reading of what was said aloud is meant; `None` if nobody seems to have said anything.
    pub fn read(&self, spoken: &Spoken, visitor: Visitor) -> Result<Option<Reading>, DialogError> {
        let Some(first) = spoken.first() else { return Ok(None) };
        self.think_of(first, visitor)?;
        let mut inner = self.lock();
        let Some(body) = inner.addressed(first, visitor, spoken.text_nanos)?.0.first().copied() else {
            return Ok(None);
        };
        let called = |text: &str| inner.robots.called(text);
        let robot = inner.robots.look_at(body);
        Ok(robot.and_then(|robot| robot.conversation.reading(spoken, &called, &robot.knowledge)))
    }

    /// A page plays the first sound of an answer.
    pub fn note_sounded(&self, turn: u64, nanos: u64) -> Result<(), DialogError> {
        let mut inner = self.lock();
        let Some(moments) = inner.latency.sounded(turn, nanos) else { return Ok(()) };
        self.hub.tell(&page::latency(&moments, None));
        inner.publish_spoken(&moments)
    }

    /// Somebody at a page chose an object, received at `received_nanos`.
    pub fn choose(&self, object: ObjectId, visitor: Visitor, received_nanos: u64) -> Result<(), DialogError> {
        self.voice.hush();
        let mut inner = self.lock();
        let answered = inner.robots.answered_by(object);
        let body = match answered {
            Some(body) => body,
            None => match inner.addressed("", visitor, received_nanos)?.0.first() {
                Some(body) => *body,
                None => return Ok(()),
            },
        };
        inner.listen_to(visitor, body)?;
        let Some(robot) = inner.robots.of_body(body) else { return Ok(()) };
        let (turn, reactions) = robot.conversation.choose(object, received_nanos, &robot.knowledge);
        inner.latency.begin(turn, received_nanos, monotonic_nanos());
        self.carry_out(&mut inner, body, Heard::AtPage(visitor), reactions)
    }

    /// Somebody at a page pointed at a thing that is called so.
    pub fn note_pointed(&self, name: &str, visitor: Visitor) -> Result<(), DialogError> {
        self.lock().publish_pointed(name, visitor.number)
    }

    /// What an interpreter takes for meant that the robot of a body was told in a turn, and how it came to that.
    pub fn note_interpretation(
        &self,
        body: BodyId,
        turn: u64,
        meant: Option<&Meant>,
        note: &str,
    ) -> Result<(), DialogError> {
        let mut inner = self.lock();
        inner.look()?;
        self.interpreted(&mut inner, body, turn, meant, note)
    }

    fn interpreted(
        &self,
        inner: &mut Inner,
        body: BodyId,
        turn: u64,
        meant: Option<&Meant>,
        note: &str,
    ) -> Result<(), DialogError> {
        let Some(robot) = inner.robots.of_body(body) else { return Ok(()) };
        let reactions = robot.conversation.interpreted(turn, meant, note, &robot.knowledge);
        if reactions.is_empty() { Ok(()) } else { self.carry_out(inner, body, Heard::Nothing, reactions) }
    }

    /// Gives up on what a service before this one asked an interpreter.
    pub fn leave_puzzles(&self) -> Result<(), DialogError> {
        let mut inner = self.lock();
        let puzzled: Vec<_> =
            inner.robots.iter().filter_map(|one| Some((one.body, one.conversation.puzzled()?))).collect();
        puzzled.into_iter().try_for_each(|(body, turn)| self.interpreted(&mut inner, body, turn, None, NOT_ANSWERED))
    }

    /// Whether pointing at an object answers what a robot asks.
    pub fn is_answer(&self, object: ObjectId) -> bool {
        self.lock().robots.answered_by(object).is_some()
    }

    /// Notes where the page is served.
    pub fn serve_at(&self, place: Place) {
        self.lock().journal.serve_at(place);
    }
}

impl Heard<'_> {
    const fn envelope(&self) -> Option<&Envelope> {
        match self {
            Self::OnBus(envelope) => Some(envelope),
            Self::AtPage(_) | Self::Nothing => None,
        }
    }

    const fn visitor(&self) -> Option<u32> {
        match self {
            Self::AtPage(visitor) => Some(visitor.number),
            Self::OnBus(_) | Self::Nothing => None,
        }
    }
}
