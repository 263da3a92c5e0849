//! The conversation on the bus: what pages say goes in, what agents and the world tell comes back.

use std::{
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    thread,
    time::Duration,
};

use cohabit_bus::{
    Listener, Publisher, Sample, Subscriber, Topic, Transport, Wake,
    message::{self, BodyRecord, DialogKind, DialogMessage, DialogView, EventKind, EventMessage, StateView, Thing},
    monotonic_nanos,
};
use cohabit_cdf::{BodyId, Catalog, ObjectId};
use cohabit_language::Known;
use serde_json::Value;

use crate::{
    DialogError,
    affordances::{self, Affordance},
    conversation::{Conversation, Reaction},
    driving::Drivers,
    hub::Hub,
    known,
    latency::{Latency, Moments},
    page::{self, Line, LineKind, Speaker},
};

/// The body that people speak to.
const BODY: BodyId = BodyId(0);

/// The conversation, with its ends on the bus and to the pages. One lock: who speaks first is heard first.
pub struct Talk {
    inner: Mutex<Inner>,
    hub: Arc<Hub>,
    drivers: Arc<Drivers>,
    catalog: Arc<Catalog>,
}

struct Inner {
    conversation: Conversation,
    latency: Latency,
    dialog: Box<dyn Publisher>,
    states: Box<dyn Subscriber>,
    newest: Option<Sample>,
}

impl Talk {
    /// A conversation on `bus`, shown to the pages of `hub`.
    pub fn new(
        bus: &dyn Transport,
        catalog: Arc<Catalog>,
        hub: Arc<Hub>,
        drivers: Arc<Drivers>,
    ) -> Result<Arc<Self>, DialogError> {
        let inner = Inner {
            conversation: Conversation::new(Arc::clone(&catalog), BODY.0),
            latency: Latency::default(),
            dialog: bus.publisher(Topic::Dialog)?,
            states: bus.subscriber(Topic::State)?,
            newest: None,
        };
        Ok(Arc::new(Self { inner: Mutex::new(inner), hub, drivers, catalog }))
    }

    fn lock(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Somebody at a page said something, received at `received_nanos`.
    pub fn hear(&self, text: &str, received_nanos: u64) -> Result<(), DialogError> {
        let mut inner = self.lock();
        let known = inner.known()?;
        let (turn, reactions) = inner.conversation.hear(text, known.as_ref());
        inner.latency.begin(turn, received_nanos, monotonic_nanos());
        self.carry_out(&mut inner, reactions)
    }

    /// An agent said something about a plan.
    fn follow(&self, view: DialogView<'_>) -> Result<(), DialogError> {
        let mut inner = self.lock();
        inner.refresh()?;
        let Inner { conversation, newest, .. } = &mut *inner;
        let state = newest.as_ref().map(|sample| StateView::new(sample.payload())).transpose()?;
        let reactions = conversation.follow(view.header, || known::known(state?, BODY));
        self.carry_out(&mut inner, reactions)
    }

    /// Something happened in the world.
    fn note_event(&self, event: &EventMessage, sent_nanos: u64) -> Result<(), DialogError> {
        let text = event.text.as_str();
        self.drivers.note(event);
        match event.kind() {
            Some(EventKind::Started) => {
                let mut inner = self.lock();
                if let Some(moments) = inner.latency.moved(event.turn, event.command, sent_nanos) {
                    self.hub.tell(&page::latency(&moments));
                }
            }
            Some(EventKind::GoalMet) => self.game(LineKind::Goal, text),
            Some(EventKind::NoteRead) => self.game(LineKind::Note, text),
            Some(EventKind::Message | EventKind::CameraMovement) => self.game(LineKind::Say, text),
            Some(EventKind::GoalShown) => self.game(LineKind::Goal, &format!("New goal: {text}")),
            Some(EventKind::MissionComplete) => self.game(LineKind::Ending, "Mission complete. Well done!"),
            Some(EventKind::MissionFailed) => self.game(LineKind::Ending, &format!("Mission failed. {text}")),
            Some(EventKind::Highlighted) => self.show_highlight(event.object)?,
            _ => {}
        }
        Ok(())
    }

    fn game(&self, kind: LineKind, text: &str) {
        if !text.is_empty() {
            self.hub.say(&Line::new(Speaker::Game, kind, 0, text));
        }
    }

    fn show_highlight(&self, object: u32) -> Result<(), DialogError> {
        let mut inner = self.lock();
        inner.refresh()?;
        let Some(sample) = &inner.newest else { return Ok(()) };
        let state = StateView::new(sample.payload())?;
        if let Some(record) = state.objects.iter().find(|record| record.object == object) {
            self.hub.tell(&page::highlight(record, &self.catalog));
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

    fn carry_out(&self, inner: &mut Inner, reactions: Vec<Reaction>) -> Result<(), DialogError> {
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
        Ok(())
    }
}

impl Inner {
    fn refresh(&mut self) -> Result<(), DialogError> {
        if let Some(sample) = self.states.latest()? {
            self.newest = Some(sample);
        }
        Ok(())
    }

    fn known(&mut self) -> Result<Option<Known>, DialogError> {
        self.refresh()?;
        let Some(sample) = &self.newest else { return Ok(None) };
        Ok(known::known(StateView::new(sample.payload())?, BODY))
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
    let mut states = bus.subscriber(Topic::State)?;
    while !over() {
        if let Some(sample) = states.latest()? {
            return Ok(StateView::new(sample.payload())?.bodies.to_vec());
        }
        listener.wait(Duration::from_millis(20))?;
    }
    Ok(Vec::new())
}

/// Where the service hears what others say on the bus: to be had before the first page is let in, lest an answer to it
/// be missed.
pub struct Ears {
    listener: Box<dyn Listener>,
    dialog: Box<dyn Subscriber>,
    events: Box<dyn Subscriber>,
    joined_nanos: u64,
}

impl Ears {
    /// Hears all that is said from now on.
    pub fn new(bus: &dyn Transport) -> Result<Self, DialogError> {
        Ok(Self {
            listener: bus.listener(Wake::Talk)?,
            dialog: bus.subscriber(Topic::Dialog)?,
            events: bus.subscriber(Topic::Events)?,
            joined_nanos: monotonic_nanos(),
        })
    }
}

/// Follows what others say on the bus, until `over`.
pub fn listen(mut ears: Ears, talk: &Talk, over: &dyn Fn() -> bool) -> Result<(), DialogError> {
    while !over() {
        ears.listener.wait(Duration::from_millis(100))?;
        while let Some(sample) = ears.events.receive()? {
            let event: EventMessage = message::read(sample.payload())?;
            if sample.envelope().sent_nanos >= ears.joined_nanos {
                talk.note_event(&event, sample.envelope().sent_nanos)?;
            }
        }
        while let Some(sample) = ears.dialog.receive()? {
            if sample.envelope().sent_nanos >= ears.joined_nanos {
                talk.follow(DialogView::new(sample.payload())?)?;
            }
        }
    }
    Ok(())
}

/// Shows the state to the pages, and what was said to peers that joined, again and again, until `over`.
pub fn show_state(talk: &Talk, every: Duration, over: &dyn Fn() -> bool) -> Result<(), DialogError> {
    while !over() {
        let mut inner = talk.lock();
        talk.show_state(&mut inner)?;
        inner.dialog.update()?;
        drop(inner);
        thread::sleep(every);
    }
    Ok(())
}
