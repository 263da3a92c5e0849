//! The conversation on the bus: what pages say goes in, what agents and the world tell comes back.

mod held;

use std::{
    collections::BTreeMap,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    thread,
    time::Duration,
};

use cohabit_bus::{
    Envelope, Heart, Inbox, Listener, Publisher, Sample, Topic, Transport, Wake,
    message::{
        self, BodyRecord, DialogHeader, DialogKind, DialogMessage, DialogView, EventKind, EventMessage, ObjectRecord,
        StateView, Thing,
    },
    monotonic_nanos,
};
use cohabit_cdf::{BodyId, Catalog, ObjectId};
use cohabit_language::Meant;
use cohabit_speech::Scene;
use serde_json::Value;

use crate::{
    DialogError,
    affordances::{self, Affordance},
    alarm::Alarm,
    conversation::{self, Aloud, Reaction},
    driving::Drivers,
    frames::Shown,
    hub::Hub,
    interpreter::{Asked, Puzzles},
    journal::{Deed, Journal, Place},
    latency::{Latency, Moments},
    page::{self, Line, LineKind, Speaker},
    robots::{Robot, Robots, Visitor},
    spoken::{Reading, Spoken},
    survey::{Register, Survey},
    voice::{Audience, Voice},
};

/// How often a robot that waits for something looks whether it is so, ticks.
const WAKES_EVERY: u64 = 15;
/// The time of a tick, s.
const TICK_S: f64 = 1.0 / 60.0;
/// What is said for whoever says stop aloud, in whatever words.
const STOP: &str = "stop";
/// Why nothing came of an interpreter, for the log.
const NOT_ASKED: &str = "too much was asked already";
const NOT_ANSWERED: &str = "the service that asked ended before the answer";

/// The conversations, with their ends on the bus and to the pages. One lock: who speaks first is heard first.
pub struct Talk {
    inner: Mutex<Inner>,
    hub: Arc<Hub>,
    drivers: Arc<Drivers>,
    catalog: Arc<Catalog>,
    /// Who makes something of what is not understood, if anybody.
    interpreter: Option<Puzzles>,
    /// How robots speak, and who is heard.
    voice: Arc<Voice>,
    /// What robots were named.
    names: Vec<String>,
    /// When something that is held back is answered without anybody's doing.
    alarm: Alarm,
}

/// All by which a conversation has to do with pages.
pub struct Pages {
    /// What they share.
    pub hub: Arc<Hub>,
    /// Who drives.
    pub drivers: Arc<Drivers>,
    /// How they are heard, and hear.
    pub voice: Arc<Voice>,
}

struct Inner {
    robots: Robots,
    journal: Journal,
    latency: Latency,
    dialog: Box<dyn Publisher>,
    states: Inbox,
    newest: Option<Sample>,
    /// The body that was spoken to last.
    spoken_to: BodyId,
    /// The tick at which those who wait for something looked last.
    woke_at: u64,
    /// The visitors who are there, and how many pages each has open.
    present: BTreeMap<u32, usize>,
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
        let Pages { hub, drivers, voice } = pages;
        let names = if robots.are_several() { robots.called_by().map(str::to_owned).collect() } else { Vec::new() };
        let past = journal.past();
        hub.restore(&past.lines);
        robots.restore(&past.conversations, &past.lessons);
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
        };
        inner.tell_again()?;
        let alarm = Alarm::default();
        alarm.set(inner.due());
        Ok(Arc::new(Self { inner: Mutex::new(inner), hub, drivers, catalog, interpreter, voice, names, alarm }))
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

    /// Somebody at a page said something, received at `received_nanos`.
    pub fn hear(&self, said: &str, visitor: Visitor, received_nanos: u64) -> Result<(), DialogError> {
        // What was being said is the answer to something else.
        self.voice.hush();
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
        let mut inner = self.lock();
        let Some(first) = spoken.first() else { return Ok(false) };
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
        let mut inner = self.lock();
        let Some(first) = spoken.first() else { return Ok(None) };
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

    /// Has robots go on with what they were told to do later, if it is time.
    fn wake(&self, inner: &mut Inner) -> Result<(), DialogError> {
        let tick = inner.newest.as_ref().map_or(0, |sample| sample.envelope().tick);
        let is_due = tick >= inner.woke_at.saturating_add(WAKES_EVERY);
        if !is_due || !inner.robots.iter().any(|robot| robot.conversation.awaits()) {
            return Ok(());
        }
        inner.woke_at = tick;
        inner.look()?;
        #[allow(clippy::cast_precision_loss, reason = "a session is no 10^15 ticks long")]
        let now_s = tick as f64 * TICK_S;
        let woken: Vec<(BodyId, Vec<Reaction>)> = inner
            .robots
            .iter_mut()
            .map(|robot| (robot.body, robot.conversation.wake(now_s, &robot.knowledge)))
            .collect();
        for (body, reactions) in woken.into_iter().filter(|(_, reactions)| !reactions.is_empty()) {
            self.carry_out(inner, body, Heard::Nothing, reactions)?;
        }
        Ok(())
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

    /// An agent said something, about a plan or of its own accord.
    fn follow(&self, envelope: &Envelope, view: DialogView<'_>) -> Result<(), DialogError> {
        let mut inner = self.lock();
        if inner.journal.has_heard(envelope) {
            return Ok(());
        }
        let (kind, body) = (view.header.kind(), BodyId(view.header.body));
        if let (Some(DialogKind::Reply | DialogKind::Question), 0) = (kind, view.header.turn) {
            return self.pass_on(&mut inner, envelope, view.header);
        }
        if let Some(DialogKind::StepEnded | DialogKind::PlanEnded) = kind {
            inner.look()?;
        }
        let told = inner.robots.names.told(&view.header.text);
        let Some(Robot { conversation, knowledge, .. }) = inner.robots.of_body(body) else { return Ok(()) };
        if let Some(action) = conversation.deed(view.header) {
            knowledge.note_deed(&action);
        }
        let mut header = *view.header;
        header.text = told;
        let reactions = conversation.follow(&header, knowledge);
        if reactions.is_empty() && kind != Some(DialogKind::StepEnded) {
            return Ok(());
        }
        self.carry_out(&mut inner, body, Heard::OnBus(envelope), reactions)
    }

    /// Shows what a mind says of its own accord.
    fn pass_on(&self, inner: &mut Inner, envelope: &Envelope, header: &DialogHeader) -> Result<(), DialogError> {
        let kind = if header.kind() == Some(DialogKind::Question) { LineKind::Question } else { LineKind::Say };
        let mut line = Line::new(Speaker::Robot, kind, 0, header.text.as_str());
        line.body = Some(header.body);
        self.voice.say(&line, header.body);
        self.tell(inner, envelope, line);
        Ok(())
    }

    /// Something happened in the world, while this service was there or before.
    fn note_event(&self, envelope: &Envelope, event: &EventMessage, is_new: bool) -> Result<(), DialogError> {
        if is_new {
            self.drivers.note(event);
        }
        let mut inner = self.lock();
        if inner.journal.has_heard(envelope) {
            return Ok(());
        }
        let text = event.text.as_str();
        let mut game = |kind, text: &str| self.game(&mut inner, envelope, kind, text);
        match event.kind() {
            Some(EventKind::Started) if is_new => {
                if let Some(moments) = inner.latency.moved(event.turn, event.command, envelope.sent_nanos) {
                    self.hub.tell(&page::latency(&moments, None));
                }
            }
            Some(EventKind::GoalMet) => game(LineKind::Goal, text),
            Some(EventKind::NoteRead) => game(LineKind::Note, text),
            Some(EventKind::Message | EventKind::CameraMovement) => game(LineKind::Say, text),
            Some(EventKind::GoalShown) => game(LineKind::Goal, &page::new_goal(text)),
            Some(EventKind::MissionComplete) => game(LineKind::Ending, page::COMPLETE),
            Some(EventKind::MissionFailed) => game(LineKind::Ending, &page::failed(text)),
            Some(EventKind::Highlighted) if is_new => self.show_highlight(&mut inner, event.object)?,
            Some(EventKind::Sound) if is_new => {
                self.tell_of(&mut inner, event.object, |_, record| page::sound(record, text, &self.catalog))?;
            }
            _ => {}
        }
        Ok(())
    }

    fn game(&self, inner: &mut Inner, envelope: &Envelope, kind: LineKind, text: &str) {
        if !text.is_empty() {
            self.tell(inner, envelope, Line::new(Speaker::Game, kind, 0, text));
        }
    }

    /// Tells the pages a line that follows from a message on the bus, once it is written down.
    fn tell(&self, inner: &mut Inner, envelope: &Envelope, line: Line) {
        let heard = Some((envelope.run, envelope.sequence));
        inner.journal.will_tell(Deed { heard, lines: vec![line.clone()], ..Deed::default() });
        self.hub.say(&line);
        inner.journal.told();
    }

    fn show_highlight(&self, inner: &mut Inner, object: u32) -> Result<(), DialogError> {
        self.tell_of(inner, object, |inner, record| {
            let at = inner.numbered().and_then(|asked| asked.candidates.iter().position(|one| one.0 == object));
            page::highlight(record, at.map(|at| at + 1), &self.catalog)
        })
    }

    /// Tells the pages something of an object, if it is there.
    fn tell_of(
        &self,
        inner: &mut Inner,
        object: u32,
        message: impl FnOnce(&Inner, &ObjectRecord) -> Value,
    ) -> Result<(), DialogError> {
        inner.refresh()?;
        let Some(sample) = &inner.newest else { return Ok(()) };
        let state = StateView::new(sample.payload())?;
        if let Some(record) = state.objects.iter().find(|record| record.object == object) {
            self.hub.tell(&message(inner, record));
        }
        Ok(())
    }

    /// What a thing is that somebody points at, at a place of the picture; `None` if it is gone.
    pub fn seen(&self, thing: Thing, place: [f32; 2]) -> Result<Option<Value>, DialogError> {
        let mut inner = self.lock();
        inner.refresh()?;
        let Some(sample) = &inner.newest else { return Ok(None) };
        Ok(page::seen(thing, place, StateView::new(sample.payload())?, &self.catalog))
    }

    /// What a driven body has before it: the first of `things`, the nearest to the middle first, that it can do most with.
    pub fn aim(&self, things: &[Thing], body: u32) -> Result<Value, DialogError> {
        let mut inner = self.lock();
        inner.refresh()?;
        let Some(sample) = &inner.newest else { return Ok(page::aim(None, &[], false)) };
        let state = StateView::new(sample.payload())?;
        Ok(aimed(things, body, state, &self.catalog))
    }

    /// A frame was shown.
    pub fn note_frame(&self, Shown { command, tick, sent_nanos }: Shown) -> Result<(), DialogError> {
        let mut inner = self.lock();
        let Some(moments) = inner.latency.shown(command, sent_nanos) else { return Ok(()) };
        self.hub.tell(&page::latency(&moments, Some(tick)));
        log_latency(&moments);
        inner.publish_latency(&moments)
    }

    /// A page has shown the frame in which the robot first moved in a turn.
    pub fn note_drawn(&self, turn: u64, nanos: u64) -> Result<(), DialogError> {
        let mut inner = self.lock();
        match inner.latency.drawn(turn, nanos) {
            Some(moments) => inner.publish_latency(&moments),
            None => Ok(()),
        }
    }

    fn show_state(&self, inner: &mut Inner) -> Result<(), DialogError> {
        inner.refresh()?;
        if let Some(sample) = &inner.newest {
            let state = StateView::new(sample.payload())?;
            self.hub.show_state(&page::state(sample.envelope().tick, state, &self.drivers.driven(), &self.catalog));
        }
        Ok(())
    }

    /// Does what follows from a message for the robot of a body, once it is written down.
    fn carry_out(
        &self,
        inner: &mut Inner,
        body: BodyId,
        heard: Heard<'_>,
        mut reactions: Vec<Reaction>,
    ) -> Result<(), DialogError> {
        let are_several = inner.robots.are_several();
        for reaction in &mut reactions {
            match reaction {
                Reaction::Chat(line) => {
                    line.body = are_several.then_some(body.0);
                    line.visitor = heard.visitor().filter(|_| line.from == Speaker::Person);
                }
                Reaction::Bus(message) if message.header.kind() == Some(DialogKind::Utterance) => {
                    message.header.person = heard.visitor().unwrap_or(0);
                }
                _ => {}
            }
        }
        let Some(robot) = inner.robots.of_body(body) else { return Ok(()) };
        let memory = robot.conversation.memory().clone();
        inner.robots.note_speech(body);
        inner.journal.will_tell(Deed {
            heard: heard.envelope().map(|envelope| (envelope.run, envelope.sequence)),
            lines: reactions.iter().filter_map(Reaction::line).cloned().collect(),
            conversations: BTreeMap::from([(body.0, memory)]),
        });
        let proposes = reactions.contains(&Reaction::Proposes);
        for reaction in reactions {
            match reaction {
                Reaction::Proposes => {}
                Reaction::ForWizard(text) => self.hub.tell_wizards(&page::unsaid(body.0, &text)),
                Reaction::Answers { turn, received_nanos } => {
                    inner.latency.answered(turn, received_nanos, monotonic_nanos());
                }
                Reaction::Bus(message) => inner.publish(&message)?,
                Reaction::Chat(line) => {
                    self.hub.say(&line);
                    if line.from == Speaker::Robot {
                        self.voice.say(&line, body.0);
                    }
                }
                Reaction::Page(message) => self.hub.tell(&message),
                Reaction::Interpret(turn, unclear) => {
                    let is_asked = self
                        .interpreter
                        .as_ref()
                        .is_some_and(|puzzles| puzzles.ask(Asked { body, turn, unclear: *unclear }));
                    if !is_asked {
                        self.interpreted(inner, body, turn, None, NOT_ASKED)?;
                    }
                }
                Reaction::TurnEnded { turn, end } => {
                    self.show_state(inner)?;
                    self.hub.tell(&page::turn_ended(body.0, turn, end.name()));
                }
            }
        }
        self.hub.mark(inner.numbered().map(|asked| asked.candidates.as_slice()).unwrap_or_default());
        inner.journal.told();
        if let Some(robot) = inner.robots.look_at(body).filter(|_| proposes) {
            self.hub.tell_wizards(&held::proposed(robot, monotonic_nanos()));
        }
        self.alarm.set(inner.due());
        Ok(())
    }
}

impl Register for Talk {
    fn has_answered(&self, visitor: u32, questionnaire: &str) -> bool {
        let inner = self.lock();
        inner.journal.past().answered.get(&visitor).is_some_and(|answered| answered.contains(questionnaire))
    }

    fn note_answered(&self, visitor: u32, questionnaire: &str) {
        self.lock().journal.note_answered(visitor, questionnaire);
    }

    fn is_mission_running(&self) -> bool {
        let inner = self.lock();
        let state = inner.newest.as_ref().and_then(|sample| StateView::new(sample.payload()).ok());
        // What has no goals does not end.
        state.is_none_or(|state| state.header.ending == 0 && state.header.goals > 0)
    }
}

impl Audience for Talk {
    fn is_whole(&self, text: &str) -> bool {
        let inner = self.lock();
        let text = inner.robots.called(text);
        let robot = inner.robots.look_at(inner.spoken_to).or_else(|| inner.robots.iter().next());
        robot.is_some_and(|robot| robot.conversation.is_whole(&text, &robot.knowledge))
    }

    fn is_at_work(&self) -> bool {
        let inner = self.lock();
        let Some(state) = inner.newest.as_ref().and_then(|sample| StateView::new(sample.payload()).ok()) else {
            return false;
        };
        inner.robots.iter().any(|robot| state.bodies.iter().any(|body| body.body == robot.body.0 && body.busy == 1))
    }

    fn likely(&self, before: u64) -> Option<(u64, Scene)> {
        let inner = self.lock();
        let robot = inner.robots.iter().next()?;
        let number = robot.knowledge.number();
        if number == before {
            return None;
        }
        let names = robot.conversation.language().spoken_names(robot.knowledge.world()?);
        drop(inner);
        let [things, places, rooms] =
            [names.things, names.places, names.rooms].map(|names| names.into_iter().collect());
        Some((number, Scene { things, places, rooms, words: self.names.clone(), known: names.words }))
    }

    fn stop(&self, visitor: u32, heard_nanos: u64) {
        if let Err(error) = self.hear(STOP, Visitor { number: visitor, body: None }, heard_nanos) {
            tracing::error!("{error}");
        }
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

impl Inner {
    /// Whom a visitor speaks to, and what is said to them.
    fn addressed(&mut self, said: &str, visitor: Visitor, nanos: u64) -> Result<(Vec<BodyId>, String), DialogError> {
        self.look()?;
        let state = self.newest.as_ref().map(|sample| StateView::new(sample.payload())).transpose()?;
        Ok(self.robots.addressed(said, visitor, state, nanos))
    }

    /// Has the robot of a body know who speaks to it.
    fn listen_to(&mut self, visitor: Visitor, body: BodyId) -> Result<(), DialogError> {
        self.spoken_to = body;
        let Some(sample) = &self.newest else { return Ok(()) };
        let state = StateView::new(sample.payload())?;
        if let Some(robot) = self.robots.of_body(body) {
            robot.knowledge.note_speaker(visitor.body, state);
        }
        Ok(())
    }

    /// What is asked of which the answers are numbered.
    fn numbered(&self) -> Option<&conversation::Asked> {
        self.robots.asking()?.conversation.asked().filter(|asked| asked.candidates.len() > 1)
    }

    /// When something that is held back is answered without anybody's doing.
    fn due(&self) -> Option<u64> {
        let now_nanos = monotonic_nanos();
        self.robots.iter().filter_map(|robot| robot.conversation.due(now_nanos)).min()
    }

    fn refresh(&mut self) -> Result<(), DialogError> {
        while let Some((sample, ())) = self.states.next(|sample| StateView::new(sample.payload()).map(drop))? {
            self.newest = Some(sample);
        }
        Ok(())
    }

    /// Has the robot look at the world as it is now.
    fn look(&mut self) -> Result<(), DialogError> {
        self.refresh()?;
        let Self { newest, robots, journal, .. } = self;
        for robot in robots.iter_mut() {
            if let Some(sample) = newest {
                robot.knowledge.look(StateView::new(sample.payload())?, sample.envelope().tick);
            }
            if let Some(lessons) = robot.knowledge.take_lessons() {
                journal.note_lessons(robot.body.0, lessons);
            }
        }
        Ok(())
    }

    /// The same, if it is time.
    fn look_by_and_by(&mut self) -> Result<(), DialogError> {
        let Some(sample) = &self.newest else { return Ok(()) };
        let state = StateView::new(sample.payload())?;
        let tick = sample.envelope().tick;
        let is_due = |robot: &Robot| {
            let body = state.bodies.iter().find(|record| record.body == robot.body.0);
            body.is_some_and(|body| robot.knowledge.is_due(tick, body.position_m, body.yaw_rad))
        };
        if self.robots.iter().any(is_due) {
            self.look()?;
        }
        Ok(())
    }

    /// Tells the bus what a service that was killed may not have told, and the plan under way: an agent that joins later
    /// would not know of it.
    fn tell_again(&mut self) -> Result<(), DialogError> {
        let untold = &self.journal.past().untold;
        let is_its = |robot: &Robot, line: &Line| line.body.is_none_or(|body| body == robot.body.0);
        let mut messages = Vec::new();
        for robot in self.robots.iter() {
            let lines = untold.iter().filter(|line| is_its(robot, line));
            messages.extend(lines.filter_map(|line| robot.conversation.message(line)));
            messages.extend(robot.conversation.plan_under_way());
        }
        messages.iter().try_for_each(|message| self.publish(message))?;
        self.journal.told();
        Ok(())
    }

    fn publish_latency(&mut self, moments: &Moments) -> Result<(), DialogError> {
        let mut message = DialogMessage::new(DialogKind::Latency, self.spoken_to.0, moments.turn, "");
        message.header.stamps = moments.stamps();
        self.publish(&message)
    }

    fn publish_spoken(&mut self, moments: &Moments) -> Result<(), DialogError> {
        let heard = self.latency.heard.clone();
        let mut message = DialogMessage::new(DialogKind::Spoken, self.spoken_to.0, moments.turn, &heard);
        message.header.stamps = moments.spoken_stamps();
        self.publish(&message)
    }

    fn publish(&mut self, message: &DialogMessage) -> Result<(), DialogError> {
        self.dialog.send(0, message.bytes(), &mut |bytes| message.write(bytes))?;
        Ok(())
    }
}

/// All that were called hear what somebody said, and it is shown once.
fn is_shown_to_all(reaction: &Reaction) -> bool {
    reaction.line().is_none_or(|line| line.from != Speaker::Person)
}

fn aimed(things: &[Thing], body: u32, state: StateView<'_>, catalog: &Catalog) -> Value {
    let objects = things.iter().filter_map(|thing| match thing {
        Thing::Object(id) => state.objects.iter().find(|record| record.object == id.0),
        _ => None,
    });
    let seen: Vec<_> = objects
        .map(|record| {
            let (afforded, far) = affordances::afforded(state, body, ObjectId(record.object), catalog);
            (record, afforded, far)
        })
        .collect();
    let is_handled = |afforded: &[Affordance]| afforded.iter().any(|one| affordances::is_of_the_hand(one.deed));
    let best = seen.iter().find(|(_, afforded, _)| is_handled(afforded)).or_else(|| seen.first());
    match best {
        Some((record, afforded, far)) => {
            let far = *far && !is_handled(afforded);
            page::aim(Some((record.object, page::name(record, catalog))), afforded, far)
        }
        None => page::aim(None, &[], false),
    }
}

fn log_latency(moments: &Moments) {
    let [understood, moved, shown] = moments.milliseconds().map(Option::unwrap_or_default);
    tracing::info!(
        "turn {}: understood after {understood:.1} ms, moving after {moved:.1} ms, seen after {shown:.1} ms",
        moments.turn
    );
}

/// Waits until the world can be seen, or until `over`; gives the bodies in it.
pub fn wait_for_world(bus: &dyn Transport, over: &dyn Fn() -> bool) -> Result<Vec<BodyRecord>, DialogError> {
    let mut listener = bus.listener(Wake::State)?;
    let mut states = Inbox::new(bus, Topic::State)?;
    while !over() {
        if let Some((_, bodies)) = states.next(|sample| Ok(StateView::new(sample.payload())?.bodies.to_vec()))? {
            return Ok(bodies);
        }
        listener.wait(Duration::from_millis(20))?;
    }
    Ok(Vec::new())
}

/// Where the service hears what others say on the bus: to be had before the first page is let in, lest an answer to it
/// be missed.
pub struct Ears {
    listener: Box<dyn Listener>,
    dialog: Inbox,
    events: Inbox,
    heart: Heart,
    joined_nanos: u64,
}

impl Ears {
    /// Hears all that is said from now on, and what is kept of what was said before.
    pub fn new(bus: &dyn Transport) -> Result<Self, DialogError> {
        Ok(Self {
            listener: bus.listener(Wake::Talk)?,
            dialog: Inbox::new(bus, Topic::Dialog)?,
            events: Inbox::new(bus, Topic::Events)?,
            heart: Heart::new(bus, "dialog", 0)?,
            joined_nanos: monotonic_nanos(),
        })
    }
}

/// Follows what others say on the bus, until `over`.
pub fn listen(ears: Ears, talk: &Talk, over: &dyn Fn() -> bool) -> Result<(), DialogError> {
    let Ears { mut listener, mut dialog, mut events, mut heart, joined_nanos } = ears;
    while !over() {
        listener.wait(Duration::from_millis(100))?;
        while let Some((sample, event)) = events.next(|sample| message::read::<EventMessage>(sample.payload()))? {
            let envelope = sample.envelope();
            pass_over(talk.note_event(envelope, &event, envelope.sent_nanos >= joined_nanos))?;
        }
        while let Some((sample, ())) = dialog.next(|sample| DialogView::new(sample.payload()).map(drop))? {
            let followed = DialogView::new(sample.payload()).map_err(DialogError::from);
            pass_over(followed.and_then(|view| talk.follow(sample.envelope(), view)))?;
        }
        heart.beat(talk.newest_tick(), events.lost() + dialog.lost())?;
    }
    Ok(())
}

/// A message whose memory was spoilt after it was looked at is passed over: the next one tells.
fn pass_over(done: Result<(), DialogError>) -> Result<(), DialogError> {
    match done {
        Err(DialogError::Malformed(error)) => {
            tracing::warn!("a message was passed over: {error}");
            Ok(())
        }
        done => done,
    }
}

/// Shows the state to the pages, and what was said to peers that joined, again and again, until `over`.
pub fn show_state(talk: &Talk, survey: &Survey, every: Duration, over: &dyn Fn() -> bool) -> Result<(), DialogError> {
    while !over() {
        let mut inner = talk.lock();
        let shown = talk.show_state(&mut inner);
        pass_over(shown.and_then(|()| inner.look_by_and_by()))?;
        pass_over(talk.wake(&mut inner))?;
        inner.dialog.update()?;
        drop(inner);
        survey.update()?;
        thread::sleep(every);
    }
    Ok(())
}
