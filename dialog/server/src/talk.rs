//! The conversation on the bus: what pages say goes in, what agents and the world tell comes back.

use std::{
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    thread,
    time::Duration,
};

use cohabit_bus::{
    Envelope, Heart, Inbox, Listener, Publisher, Sample, Topic, Transport, Wake,
    message::{self, BodyRecord, DialogKind, DialogMessage, DialogView, EventKind, EventMessage, StateView, Thing},
    monotonic_nanos,
};
use cohabit_cdf::{BodyId, Catalog, ObjectId};
use cohabit_language::Language;
use serde_json::Value;

use crate::{
    DialogError,
    affordances::{self, Affordance},
    conversation::{Conversation, Reaction},
    driving::Drivers,
    hub::Hub,
    journal::{Deed, Journal, Place},
    known::Knowledge,
    latency::{Latency, Moments},
    page::{self, Line, LineKind, Speaker},
};

/// The body that people speak to.
pub const BODY: BodyId = BodyId(0);

/// The conversation, with its ends on the bus and to the pages. One lock: who speaks first is heard first.
pub struct Talk {
    inner: Mutex<Inner>,
    hub: Arc<Hub>,
    drivers: Arc<Drivers>,
    catalog: Arc<Catalog>,
}

struct Inner {
    conversation: Conversation,
    knowledge: Knowledge,
    journal: Journal,
    latency: Latency,
    dialog: Box<dyn Publisher>,
    states: Inbox,
    newest: Option<Sample>,
}

impl Talk {
    /// A conversation on `bus`, shown to the pages of `hub`; it goes on where that of `journal` was.
    pub fn new(
        bus: &dyn Transport,
        language: Language,
        mut knowledge: Knowledge,
        hub: Arc<Hub>,
        drivers: Arc<Drivers>,
        journal: Journal,
    ) -> Result<Arc<Self>, DialogError> {
        hub.restore(&journal.past().lines);
        let memory = journal.past().conversation.clone();
        knowledge.study(&journal.past().lessons);
        let catalog = Arc::clone(language.catalog());
        let mut inner = Inner {
            conversation: Conversation::after(memory, language, BODY.0),
            knowledge,
            journal,
            latency: Latency::default(),
            dialog: bus.publisher(Topic::Dialog)?,
            states: Inbox::new(bus, Topic::State)?,
            newest: None,
        };
        inner.tell_again()?;
        Ok(Arc::new(Self { inner: Mutex::new(inner), hub, drivers, catalog }))
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

    /// Somebody at a page said something, received at `received_nanos`.
    pub fn hear(&self, text: &str, received_nanos: u64) -> Result<(), DialogError> {
        let mut inner = self.lock();
        inner.look()?;
        let Inner { conversation, knowledge, .. } = &mut *inner;
        let (turn, reactions) = conversation.hear(text, knowledge);
        inner.latency.begin(turn, received_nanos, monotonic_nanos());
        self.carry_out(&mut inner, None, reactions)
    }

    /// Somebody at a page chose an object, received at `received_nanos`.
    pub fn choose(&self, object: ObjectId, received_nanos: u64) -> Result<(), DialogError> {
        let mut inner = self.lock();
        inner.look()?;
        let Inner { conversation, knowledge, .. } = &mut *inner;
        let (turn, reactions) = conversation.choose(object, knowledge);
        inner.latency.begin(turn, received_nanos, monotonic_nanos());
        self.carry_out(&mut inner, None, reactions)
    }

    /// Whether pointing at an object answers what the robot asks.
    pub fn is_answer(&self, object: ObjectId) -> bool {
        self.lock().conversation.asked().is_some_and(|asked| asked.is_answered_by(object))
    }

    /// Notes where the page is served.
    pub fn serve_at(&self, place: Place) {
        self.lock().journal.serve_at(place);
    }

    /// An agent said something about a plan.
    fn follow(&self, envelope: &Envelope, view: DialogView<'_>) -> Result<(), DialogError> {
        let mut inner = self.lock();
        if inner.journal.has_heard(envelope) {
            return Ok(());
        }
        let deed = inner.conversation.deed(view.header);
        if let Some(DialogKind::StepEnded | DialogKind::PlanEnded) = view.header.kind() {
            inner.look()?;
        }
        if let Some(action) = deed {
            inner.knowledge.note_deed(&action);
        }
        let Inner { conversation, knowledge, .. } = &mut *inner;
        let reactions = conversation.follow(view.header, knowledge);
        if reactions.is_empty() && view.header.kind() != Some(DialogKind::StepEnded) {
            return Ok(());
        }
        self.carry_out(&mut inner, Some(envelope), reactions)
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
                    self.hub.tell(&page::latency(&moments));
                }
            }
            Some(EventKind::GoalMet) => game(LineKind::Goal, text),
            Some(EventKind::NoteRead) => game(LineKind::Note, text),
            Some(EventKind::Message | EventKind::CameraMovement) => game(LineKind::Say, text),
            Some(EventKind::GoalShown) => game(LineKind::Goal, &format!("New goal: {text}")),
            Some(EventKind::MissionComplete) => game(LineKind::Ending, "Mission complete. Well done!"),
            Some(EventKind::MissionFailed) => game(LineKind::Ending, &format!("Mission failed. {text}")),
            Some(EventKind::Highlighted) if is_new => self.show_highlight(&mut inner, event.object)?,
            _ => {}
        }
        Ok(())
    }

    fn game(&self, inner: &mut Inner, envelope: &Envelope, kind: LineKind, text: &str) {
        if !text.is_empty() {
            let line = Line::new(Speaker::Game, kind, 0, text);
            let heard = Some((envelope.run, envelope.sequence));
            inner.journal.will_tell(Deed { heard, lines: vec![line.clone()], conversation: None });
            self.hub.say(&line);
            inner.journal.told();
        }
    }

    fn show_highlight(&self, inner: &mut Inner, object: u32) -> Result<(), DialogError> {
        inner.refresh()?;
        let Some(sample) = &inner.newest else { return Ok(()) };
        let state = StateView::new(sample.payload())?;
        if let Some(record) = state.objects.iter().find(|record| record.object == object) {
            let asked = inner.conversation.asked().filter(|asked| asked.candidates.len() > 1);
            let at = asked.and_then(|asked| asked.candidates.iter().position(|one| one.0 == object));
            self.hub.tell(&page::highlight(record, at.map(|at| at + 1), &self.catalog));
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

    /// A frame was shown that was seen after `command` began.
    pub fn note_frame(&self, command: u64, sent_nanos: u64) -> Result<(), DialogError> {
        let mut inner = self.lock();
        let Some(moments) = inner.latency.shown(command, sent_nanos) else { return Ok(()) };
        self.hub.tell(&page::latency(&moments));
        log_latency(&moments);
        let mut message = DialogMessage::new(DialogKind::Latency, BODY.0, moments.turn, "");
        message.header.stamps = moments.stamps();
        inner.publish(&message)
    }

    fn show_state(&self, inner: &mut Inner) -> Result<(), DialogError> {
        inner.refresh()?;
        if let Some(sample) = &inner.newest {
            let state = StateView::new(sample.payload())?;
            self.hub.show_state(&page::state(sample.envelope().tick, state, &self.drivers.driven(), &self.catalog));
        }
        Ok(())
    }

    /// Does what follows from a message, `None` of a page's, once it is written down.
    fn carry_out(
        &self,
        inner: &mut Inner,
        heard: Option<&Envelope>,
        reactions: Vec<Reaction>,
    ) -> Result<(), DialogError> {
        inner.journal.will_tell(Deed {
            heard: heard.map(|envelope| (envelope.run, envelope.sequence)),
            lines: reactions.iter().filter_map(Reaction::line).cloned().collect(),
            conversation: Some(inner.conversation.memory().clone()),
        });
        for reaction in reactions {
            match reaction {
                Reaction::Bus(message) => inner.publish(&message)?,
                Reaction::Chat(line) => self.hub.say(&line),
                Reaction::Page(message) => self.hub.tell(&message),
                Reaction::TurnEnded { turn, end } => {
                    self.show_state(inner)?;
                    self.hub.tell(&page::turn_ended(turn, end.name()));
                }
            }
        }
        let asked = inner.conversation.asked().filter(|asked| asked.candidates.len() > 1);
        self.hub.mark(asked.map(|asked| asked.candidates.as_slice()).unwrap_or_default());
        inner.journal.told();
        Ok(())
    }
}

impl Inner {
    fn refresh(&mut self) -> Result<(), DialogError> {
        while let Some((sample, ())) = self.states.next(|sample| StateView::new(sample.payload()).map(drop))? {
            self.newest = Some(sample);
        }
        Ok(())
    }

    /// Has the robot look at the world as it is now.
    fn look(&mut self) -> Result<(), DialogError> {
        self.refresh()?;
        let Self { newest, knowledge, journal, .. } = self;
        if let Some(sample) = newest {
            knowledge.look(StateView::new(sample.payload())?, sample.envelope().tick);
        }
        if let Some(lessons) = knowledge.take_lessons() {
            journal.note_lessons(lessons);
        }
        Ok(())
    }

    /// The same, if it is time.
    fn look_by_and_by(&mut self) -> Result<(), DialogError> {
        let Some(sample) = &self.newest else { return Ok(()) };
        let state = StateView::new(sample.payload())?;
        let body = state.bodies.iter().find(|record| record.body == BODY.0);
        let tick = sample.envelope().tick;
        if body.is_some_and(|body| self.knowledge.is_due(tick, body.position_m, body.yaw_rad)) {
            self.look()?;
        }
        Ok(())
    }

    /// Tells the bus what a service that was killed may not have told, and the plan under way: an agent that joins later
    /// would not know of it.
    fn tell_again(&mut self) -> Result<(), DialogError> {
        let lines = self.journal.past().untold.clone();
        for line in lines {
            if let Some(message) = self.conversation.message(&line) {
                self.publish(&message)?;
            }
        }
        self.journal.told();
        match self.conversation.plan_under_way() {
            Some(plan) => self.publish(&plan),
            None => Ok(()),
        }
    }

    fn publish(&mut self, message: &DialogMessage) -> Result<(), DialogError> {
        self.dialog.send(0, message.bytes(), &mut |bytes| message.write(bytes))?;
        Ok(())
    }
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
    let is_handled = |afforded: &[Affordance]| afforded.iter().any(|one| one.deed.is_of_the_hand());
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
            heart: Heart::new(bus, "dialog", BODY.0)?,
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
            talk.note_event(envelope, &event, envelope.sent_nanos >= joined_nanos)?;
        }
        while let Some((sample, ())) = dialog.next(|sample| DialogView::new(sample.payload()).map(drop))? {
            talk.follow(sample.envelope(), DialogView::new(sample.payload())?)?;
        }
        heart.beat(talk.newest_tick(), events.lost() + dialog.lost())?;
    }
    Ok(())
}

/// Shows the state to the pages, and what was said to peers that joined, again and again, until `over`.
pub fn show_state(talk: &Talk, every: Duration, over: &dyn Fn() -> bool) -> Result<(), DialogError> {
    while !over() {
        let mut inner = talk.lock();
        talk.show_state(&mut inner)?;
        inner.look_by_and_by()?;
        inner.dialog.update()?;
        drop(inner);
        thread::sleep(every);
    }
    Ok(())
}
