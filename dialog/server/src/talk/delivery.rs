//! The way out: what the conversations let happen is written down, and then delivered to the bus, the pages and whoever speaks aloud.

use std::collections::BTreeMap;

use cohabit_bus::{
    Envelope, Publisher, Topic, Transport,
    message::{DialogKind, DialogMessage},
    monotonic_nanos,
};
use cohabit_cdf::{BodyId, ObjectId};
use serde_json::Value;

use super::Talk;
use crate::{
    DialogError,
    conversation::{Memory, Outgoing},
    interpreter::Asked,
    journal::{Deed, Journal},
    latency::{Latency, Moments},
    page::{self, Line, Speaker},
};

/// All by which something is delivered, behind a lock that is held while one message's outbox is, and for nothing that takes longer.
pub(super) struct Delivery {
    pub journal: Journal,
    pub latency: Latency,
    pub dialog: Box<dyn Publisher>,
    /// The body that was spoken to last.
    pub spoken_to: BodyId,
    /// The visitors who are there, and how many pages each has open.
    pub present: BTreeMap<u32, usize>,
    /// How many wizards' pages are open.
    pub wizards: usize,
}

/// What something follows from.
#[derive(Clone, Copy)]
pub(super) enum Heard {
    /// What a visitor said at a page.
    AtPage(u32),
    /// A message on the bus: its publisher's run and its number there.
    OnBus(u64, u64),
    /// What was heard before.
    Nothing,
}

/// A turn that begins.
pub(super) struct Begun {
    pub turn: u64,
    pub received_nanos: u64,
    pub understood_nanos: u64,
    /// Of a spoken one, when speech began, when it ended, and when its text was there, ns; and what it sounded like.
    pub speech: Option<([u64; 3], String)>,
}

/// All that follows from one message for the robot of a body.
pub(super) struct Outbox {
    pub body: BodyId,
    pub heard: Heard,
    /// The turn that begins with it, if one does.
    pub begun: Option<Begun>,
    /// What happens, in this order.
    pub items: Vec<Outgoing>,
    /// What the conversation must know to go on where it is then.
    pub memory: Memory,
    /// The objects that a robot asks about then, in the order of their numbers.
    pub numbered: Vec<ObjectId>,
    /// What is held back then, for wizards, if that has changed.
    pub proposal: Option<Value>,
}

impl Heard {
    pub const fn message(envelope: &Envelope) -> Self {
        Self::OnBus(envelope.run, envelope.sequence)
    }

    const fn run_and_number(self) -> Option<(u64, u64)> {
        match self {
            Self::OnBus(run, number) => Some((run, number)),
            Self::AtPage(_) | Self::Nothing => None,
        }
    }

    const fn visitor(self) -> Option<u32> {
        match self {
            Self::AtPage(visitor) => Some(visitor),
            Self::OnBus(..) | Self::Nothing => None,
        }
    }
}

impl Begun {
    /// A turn that was received then, and is understood now.
    pub fn now(turn: u64, received_nanos: u64) -> Self {
        Self { turn, received_nanos, understood_nanos: monotonic_nanos(), speech: None }
    }
}

impl Outbox {
    /// Has each line say which of several robots it is of, and who said it.
    fn address(&mut self, are_several: bool) {
        for item in &mut self.items {
            if let Outgoing::Utterance { line, .. } | Outgoing::Say(line) | Outgoing::Ask(line) = item {
                line.body = are_several.then_some(self.body.0);
                line.visitor = self.heard.visitor().filter(|_| line.from == Speaker::Person);
            }
        }
    }

    /// What is written down before anything of it is told.
    fn deed(&self) -> Deed {
        Deed {
            heard: self.heard.run_and_number(),
            lines: self.items.iter().filter_map(Outgoing::line).cloned().collect(),
            conversations: BTreeMap::from([(self.body.0, self.memory.clone())]),
        }
    }
}

impl Delivery {
    /// With that journal; the publisher is on `bus`.
    pub fn new(bus: &dyn Transport, journal: Journal) -> Result<Self, DialogError> {
        Ok(Self {
            journal,
            latency: Latency::default(),
            dialog: bus.publisher(Topic::Dialog)?,
            spoken_to: BodyId(0),
            present: BTreeMap::new(),
            wizards: 0,
        })
    }

    pub fn publish(&mut self, message: &DialogMessage) -> Result<(), DialogError> {
        self.dialog.send(0, message.bytes(), &mut |bytes| message.write(bytes))?;
        Ok(())
    }

    pub fn publish_latency(&mut self, moments: &Moments) -> Result<(), DialogError> {
        let mut message = DialogMessage::new(DialogKind::Latency, self.spoken_to.0, moments.turn, "");
        message.header.stamps = moments.stamps();
        self.publish(&message)
    }

    pub fn publish_spoken(&mut self, moments: &Moments) -> Result<(), DialogError> {
        let heard = self.latency.heard.clone();
        let mut message = DialogMessage::new(DialogKind::Spoken, self.spoken_to.0, moments.turn, &heard);
        message.header.stamps = moments.spoken_stamps();
        self.publish(&message)
    }

    pub fn publish_pointed(&mut self, name: &str, visitor: u32) -> Result<(), DialogError> {
        let mut message = DialogMessage::new(DialogKind::Pointed, self.spoken_to.0, 0, name);
        message.header.person = visitor;
        self.publish(&message)
    }

    /// Notes that a turn begins; gives its moments, if it was spoken.
    fn begin(&mut self, body: BodyId, begun: &Begun) -> Option<Moments> {
        self.spoken_to = body;
        self.latency.begin(begun.turn, begun.received_nanos, begun.understood_nanos);
        let (speech, sound) = begun.speech.as_ref()?;
        Some(self.latency.spoken(*speech, sound))
    }
}

impl Talk {
    /// Delivers an outbox, once it is written down. Gives the turns about which no interpreter could be asked.
    pub(super) fn deliver(&self, mut outbox: Outbox) -> Result<Vec<u64>, DialogError> {
        outbox.address(self.robots.len() > 1);
        let delivery = &mut *self.delivery();
        let spoken = outbox.begun.as_ref().and_then(|begun| delivery.begin(outbox.body, begun));
        delivery.journal.will_tell(outbox.deed());
        let mut unasked = Vec::new();
        for item in outbox.items {
            if let Some(turn) = self.deliver_item(delivery, outbox.body, item)? {
                unasked.push(turn);
            }
        }
        self.hub.mark(&outbox.numbered);
        delivery.journal.told();
        if let Some(proposal) = &outbox.proposal {
            self.hub.tell_wizards(proposal);
        }
        if let Some(moments) = &spoken {
            delivery.publish_spoken(moments)?;
            self.hub.tell(&page::latency(moments, None));
        }
        Ok(unasked)
    }

    /// Delivers an item; gives its turn, if no interpreter could be asked about that.
    fn deliver_item(&self, delivery: &mut Delivery, body: BodyId, item: Outgoing) -> Result<Option<u64>, DialogError> {
        if let Some(message) = item.message(body.0) {
            delivery.publish(&message)?;
        }
        match item {
            Outgoing::Utterance { line, is_shown: true } => self.hub.say(&line),
            Outgoing::Say(line) | Outgoing::Ask(line) => {
                self.hub.say(&line);
                self.voice.say(&line, body.0);
            }
            Outgoing::Progress { turn, step, steps, says } => {
                self.hub.show_progress(body.0, turn, &page::progress(body.0, turn, step, steps, &says));
            }
            Outgoing::Express { shown, .. } => self.hub.show_face(body.0, &page::expression(body.0, shown)),
            Outgoing::Interpret { turn, unclear } => {
                let asked = Asked { body, turn, unclear: *unclear };
                let is_asked = self.interpreter.as_ref().is_some_and(|puzzles| puzzles.ask(asked));
                return Ok((!is_asked).then_some(turn));
            }
            Outgoing::ForWizard(text) => self.hub.tell_wizards(&page::unsaid(body.0, &text)),
            Outgoing::Answers { turn, received_nanos } => {
                delivery.latency.answered(turn, received_nanos, monotonic_nanos());
            }
            Outgoing::TurnEnded { turn, end } => {
                self.show_state()?;
                self.hub.end_turn(body.0, turn, &page::turn_ended(body.0, turn, end.name()));
            }
            Outgoing::Utterance { is_shown: false, .. }
            | Outgoing::Plan { .. }
            | Outgoing::Note { .. }
            | Outgoing::Proposes => {}
        }
        Ok(None)
    }

    /// Tells the pages a line that follows from a message on the bus, once it is written down.
    pub(super) fn tell(&self, delivery: &mut Delivery, envelope: &Envelope, line: Line) {
        let heard = Heard::message(envelope).run_and_number();
        delivery.journal.will_tell(Deed { heard, lines: vec![line.clone()], ..Deed::default() });
        self.hub.say(&line);
        delivery.journal.told();
    }
}
