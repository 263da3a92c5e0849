//! What agents and the world tell on the bus, and what follows from that.

use std::{thread, time::Duration};

use cohabit_bus::{
    Envelope, Heart, Inbox, Listener, Topic, Transport, Wake,
    message::{
        self, BodyRecord, DialogHeader, DialogKind, DialogView, EventKind, EventMessage, ObjectRecord, StateView,
    },
    monotonic_nanos,
};
use cohabit_cdf::BodyId;
use serde_json::Value;

use super::{Heard, Inner, Talk};
use crate::{
    DialogError,
    conversation::Reaction,
    journal::Deed,
    page::{self, Line, LineKind, Speaker},
    robots::Robot,
    survey::Survey,
};

/// How often a robot that waits for something looks whether it is so, ticks.
const WAKES_EVERY: u64 = 15;
/// The time of a tick, s.
const TICK_S: f64 = 1.0 / 60.0;

impl Talk {
    /// An agent said something, about a plan or of its own accord.
    pub(super) fn follow(&self, envelope: &Envelope, view: DialogView<'_>) -> Result<(), DialogError> {
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
    pub(super) fn pass_on(
        &self,
        inner: &mut Inner,
        envelope: &Envelope,
        header: &DialogHeader,
    ) -> Result<(), DialogError> {
        let kind = if header.kind() == Some(DialogKind::Question) { LineKind::Question } else { LineKind::Say };
        let mut line = Line::new(Speaker::Robot, kind, 0, header.text.as_str());
        line.body = Some(header.body);
        self.voice.say(&line, header.body);
        self.tell(inner, envelope, line);
        Ok(())
    }

    /// Something happened in the world, while this service was there or before.
    pub(super) fn note_event(
        &self,
        envelope: &Envelope,
        event: &EventMessage,
        is_new: bool,
    ) -> Result<(), DialogError> {
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

    pub(super) fn game(&self, inner: &mut Inner, envelope: &Envelope, kind: LineKind, text: &str) {
        if !text.is_empty() {
            self.tell(inner, envelope, Line::new(Speaker::Game, kind, 0, text));
        }
    }

    /// Tells the pages a line that follows from a message on the bus, once it is written down.
    pub(super) fn tell(&self, inner: &mut Inner, envelope: &Envelope, line: Line) {
        let heard = Some((envelope.run, envelope.sequence));
        inner.journal.will_tell(Deed { heard, lines: vec![line.clone()], ..Deed::default() });
        self.hub.say(&line);
        inner.journal.told();
    }

    pub(super) fn show_highlight(&self, inner: &mut Inner, object: u32) -> Result<(), DialogError> {
        self.tell_of(inner, object, |inner, record| {
            let at = inner.numbered().and_then(|asked| asked.candidates.iter().position(|one| one.0 == object));
            page::highlight(record, at.map(|at| at + 1), &self.catalog)
        })
    }

    /// Tells the pages something of an object, if it is there.
    pub(super) fn tell_of(
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

    pub(super) fn show_state(&self, inner: &mut Inner) -> Result<(), DialogError> {
        inner.refresh()?;
        if let Some(sample) = &inner.newest {
            let state = StateView::new(sample.payload())?;
            self.hub.show_state(&page::state(sample.envelope().tick, state, &self.drivers.driven(), &self.catalog));
        }
        Ok(())
    }

    /// Has robots go on with what they were told to do later, if it is time.
    pub(super) fn wake(&self, inner: &mut Inner) -> Result<(), DialogError> {
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
