//! What agents and the world tell on the bus, and what pages learn of that at once.

use std::{thread, time::Duration};

use cohabit_bus::{
    Envelope, Heart, Inbox, Listener, Topic, Transport, Wake,
    message::{self, DialogHeader, DialogKind, DialogView, EventKind, EventMessage, ObjectRecord},
    monotonic_nanos,
};
use cohabit_cdf::BodyId;
use serde_json::Value;

use super::{Talk, delivery::Delivery, mailbox::Message};
use crate::{
    DialogError,
    page::{self, Line, LineKind, Speaker},
    survey::Survey,
};

impl Talk {
    /// Passes on to the conversations what an agent tells that is of any use to them.
    fn take_from_agent(&self, envelope: &Envelope, header: &DialogHeader) {
        let is_of_use = match header.kind() {
            Some(DialogKind::Reply | DialogKind::Question) => header.turn == 0,
            Some(DialogKind::StepStarted | DialogKind::StepEnded | DialogKind::PlanEnded) => true,
            _ => false,
        };
        if is_of_use {
            // Where that takes time, the bus keeps what comes meanwhile.
            self.mailbox.leave_in_time(Message::FromAgent(*envelope, Box::new(*header)));
        }
    }

    /// Shows what a mind says of its own accord; with its name, if that is not the robot's own mind.
    pub(super) fn pass_on(&self, envelope: &Envelope, header: &DialogHeader, name: Option<&str>) {
        let kind = if header.kind() == Some(DialogKind::Question) { LineKind::Question } else { LineKind::Say };
        let mut line = Line::new(Speaker::Robot, kind, 0, header.text.as_str());
        // The one robot needs no name, and a body that is no robot does.
        let is_the_robot = self.robots == [BodyId(header.body)];
        line.body = (!is_the_robot).then_some(header.body);
        line.name = name.map(str::to_owned);
        let mut delivery = self.delivery();
        self.voice.say(&line, header.body);
        self.tell(&mut delivery, envelope, line);
    }

    /// Something happened in the world, while this service was there or before.
    fn note_event(&self, envelope: &Envelope, event: &EventMessage, is_new: bool) -> Result<(), DialogError> {
        if is_new {
            self.drivers.note(event);
        }
        let mut delivery = self.delivery();
        if delivery.journal.has_heard(envelope) {
            return Ok(());
        }
        let text = event.text.as_str();
        let mut game = |kind, text: &str| self.game(&mut delivery, envelope, kind, text);
        match event.kind() {
            Some(EventKind::Started) if is_new => {
                if let Some(moments) = delivery.latency.moved(event.turn, envelope.tick, envelope.sent_nanos) {
                    self.hub.tell(&page::latency(&moments, None));
                }
            }
            Some(EventKind::GoalMet) => game(LineKind::Goal, text),
            Some(EventKind::NoteRead) => game(LineKind::Note, text),
            Some(EventKind::Message | EventKind::CameraMovement) => game(LineKind::Say, text),
            Some(EventKind::GoalShown) => game(LineKind::Goal, &page::new_goal(text)),
            Some(EventKind::MissionComplete) => game(LineKind::Ending, page::COMPLETE),
            Some(EventKind::MissionFailed) => game(LineKind::Ending, &page::failed(text)),
            Some(EventKind::Highlighted) if is_new => {
                let number = self.hub.marked().iter().position(|one| one.0 == event.object).map(|at| at + 1);
                self.tell_of(event.object, |record| page::highlight(record, number, &self.catalog))?;
            }
            Some(EventKind::Sound) if is_new => {
                self.tell_of(event.object, |record| page::sound(record, text, &self.catalog))?;
            }
            _ => {}
        }
        Ok(())
    }

    fn game(&self, delivery: &mut Delivery, envelope: &Envelope, kind: LineKind, text: &str) {
        if !text.is_empty() {
            self.tell(delivery, envelope, Line::new(Speaker::Game, kind, 0, text));
        }
    }

    /// Tells the pages something of an object, if it is there.
    fn tell_of(&self, object: u32, message: impl FnOnce(&ObjectRecord) -> Value) -> Result<(), DialogError> {
        let mut newest = self.state();
        newest.refresh()?;
        let Some(state) = newest.view()? else { return Ok(()) };
        if let Some(record) = state.objects.iter().find(|record| record.object == object) {
            self.hub.tell(&message(record));
        }
        Ok(())
    }

    /// Shows the pages the state as it is.
    pub(super) fn show_state(&self) -> Result<(), DialogError> {
        let mut newest = self.state();
        newest.refresh()?;
        if let Some(state) = newest.view()? {
            self.hub.show_state(&page::state(newest.tick(), state, &self.drivers.driven(), &self.catalog));
        }
        Ok(())
    }
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
            let told = DialogView::new(sample.payload()).map_err(DialogError::from);
            pass_over(told.map(|view| talk.take_from_agent(sample.envelope(), view.header)))?;
        }
        heart.beat(talk.newest_tick(), events.lost() + dialog.lost())?;
    }
    Ok(())
}

/// A message whose memory was spoilt after it was looked at is passed over: the next one tells.
pub(super) fn pass_over(done: Result<(), DialogError>) -> Result<(), DialogError> {
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
        pass_over(talk.show_state())?;
        talk.delivery().dialog.update()?;
        survey.update()?;
        thread::sleep(every);
    }
    Ok(())
}
