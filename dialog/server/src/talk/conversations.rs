//! The conversations of all robots, on the thread that owns them: messages come in by the mailbox, and what follows goes out by
//! [`Talk::deliver`]. Language is understood here, without any lock.

mod hearing;

use std::{
    sync::{Arc, mpsc::RecvTimeoutError},
    time::{Duration, Instant},
};

use cohabit_bus::{
    Envelope, Transport,
    message::{DialogHeader, DialogKind},
    monotonic_nanos,
};
use cohabit_cdf::BodyId;
use cohabit_language::Meant;
use cohabit_speech::Scene;
use serde_json::Value;
use tokio::sync::oneshot;

use super::{
    Talk,
    delivery::{Begun, Heard, Outbox},
    mailbox::{Mail, Message},
    pass_over,
    unheard::{Thoughts, Unheard, unheard},
};
use crate::{
    DialogError,
    conversation::{Outgoing, line_message},
    expression::FacialExpression,
    interpreter::Interpretation,
    page::{self, Line},
    peers::{Peers, for_people},
    robots::{Robot, Robots, Visitor},
    wizard::Decision,
    world_state::NewestState,
};

/// How often robots look whether the world has changed.
const LOOKS_EVERY: Duration = Duration::from_millis(100);
/// How often a robot that waits for something looks whether it is so, ticks.
const WAKES_EVERY: u64 = 15;
/// The time of a tick, s.
const TICK_S: f64 = 1.0 / 60.0;
/// Why nothing came of an interpreter, for the log.
const NOT_ANSWERED: &str = "the service that asked ended before the answer";
const NOT_ASKED: &str = "too much was asked already";

/// The conversations of all robots.
pub struct Conversations {
    talk: Arc<Talk>,
    robots: Robots,
    state: NewestState,
    peers: Peers,
    unheard: Unheard,
    looked_at: Instant,
    /// The tick at which those who wait for something looked last.
    woke_at: u64,
}

impl Conversations {
    /// The conversations of these robots, which go on where those of the journal were; and what is to be thought of ahead.
    pub fn begin(bus: &dyn Transport, talk: Arc<Talk>, mut robots: Robots) -> Result<(Self, Thoughts), DialogError> {
        {
            let delivery = talk.delivery();
            let past = delivery.journal.past();
            robots.restore(&past.conversations, &past.lessons);
        }
        for robot in robots.iter().filter(|robot| robot.conversation.expression() != FacialExpression::default()) {
            let shown = page::expression(robot.body.0, robot.conversation.expression());
            talk.hub.show_face(robot.body.0, &shown);
        }
        let (unheard, thoughts) = unheard();
        let (state, peers) = (NewestState::new(bus)?, Peers::new(bus)?);
        let conversations = Self { talk, robots, state, peers, unheard, looked_at: Instant::now(), woke_at: 0 };
        conversations.tell_again()?;
        Ok((conversations, thoughts))
    }

    /// Tells the bus what a service that was killed may not have told, and the plan under way: an agent that joins later
    /// would not know of it.
    fn tell_again(&self) -> Result<(), DialogError> {
        let delivery = &mut *self.talk.delivery();
        let untold = &delivery.journal.past().untold;
        let is_its = |robot: &Robot, line: &Line| line.body.is_none_or(|body| body == robot.body.0);
        let mut messages = Vec::new();
        for robot in self.robots.iter() {
            let lines = untold.iter().filter(|line| is_its(robot, line));
            messages.extend(lines.filter_map(|line| line_message(line, robot.body.0)));
            messages.extend(robot.conversation.plan_under_way());
        }
        self.talk.hub.mark(self.robots.numbered());
        messages.iter().try_for_each(|message| delivery.publish(message))?;
        delivery.journal.told();
        Ok(())
    }

    /// Waits until the robots see the world, or until `over`: who is let in then is understood at once.
    pub fn wait_until_they_see(&mut self, bus: &dyn Transport, over: &dyn Fn() -> bool) -> Result<(), DialogError> {
        self.state.wait(bus, over)
    }

    /// Gives up on what a service before this one asked an interpreter.
    pub fn leave_puzzles(&mut self) -> Result<(), DialogError> {
        let puzzled: Vec<_> =
            self.robots.iter().filter_map(|one| Some((one.body, one.conversation.puzzled()?))).collect();
        puzzled.into_iter().try_for_each(|(body, turn)| self.note_interpretation(body, turn, None, NOT_ANSWERED))
    }

    /// Hears what comes, and does what its time has come for, until `over`.
    pub fn run(&mut self, mail: Mail, over: &dyn Fn() -> bool) -> Result<(), DialogError> {
        while !over() {
            match mail.0.recv_timeout(self.pause()) {
                Ok(message) => pass_over(self.take(message))?,
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
            pass_over(self.elapse())?;
            if self.looked_at.elapsed() >= LOOKS_EVERY {
                self.looked_at = Instant::now();
                pass_over(self.look_by_and_by())?;
                pass_over(self.wake())?;
                self.peers.refresh()?;
            }
        }
        Ok(())
    }

    /// The session is over: notes what was held back and never answered.
    pub fn close(&self) -> Result<(), DialogError> {
        let delivery = &mut *self.talk.delivery();
        for robot in self.robots.iter() {
            let left = robot.conversation.left_undecided();
            let mut messages = left.iter().filter_map(|item| item.message(robot.body.0));
            messages.try_for_each(|message| delivery.publish(&message))?;
        }
        Ok(())
    }

    /// How long nothing is to be done unless somebody tells something.
    fn pause(&self) -> Duration {
        let looks = LOOKS_EVERY.saturating_sub(self.looked_at.elapsed());
        let now_nanos = monotonic_nanos();
        let answers = self.due(now_nanos).map(|due| Duration::from_nanos(due.saturating_sub(now_nanos)));
        answers.map_or(looks, |answers| answers.min(looks))
    }

    /// When something that is held back is answered without anybody's doing.
    fn due(&self, now_nanos: u64) -> Option<u64> {
        self.robots.iter().filter_map(|robot| robot.conversation.due(now_nanos)).min()
    }

    fn take(&mut self, message: Message) -> Result<(), DialogError> {
        match message {
            Message::Utterance(utterance) => self.take_utterance(utterance),
            Message::Considered(number) => self.hear_considered(number),
            Message::Draft(visitor, text, to) => answer(to, self.thoughts(&text, visitor)?),
            Message::FromAgent(envelope, header) => self.follow(&envelope, &header)?,
            Message::Interpreted(Interpretation { body, turn, meant, note }) => {
                self.look()?;
                self.note_interpretation(body, turn, meant.as_ref(), &note)?;
            }
            Message::Decision(body, decision, to) => match self.decide(body, decision) {
                Ok(decided) => answer(to, decided),
                // Who asked is told as much when nothing comes.
                Err(error) => tracing::error!("{error}"),
            },
            Message::Proposals(to) => {
                let now_nanos = monotonic_nanos();
                answer(to, self.robots.iter().map(|robot| proposed(robot, now_nanos)).collect());
            }
            Message::IsWhole(text, to) => answer(to, self.is_whole(&text)),
            Message::Likely(before, to) => answer(to, self.likely(before)),
        }
        Ok(())
    }

    /// Has the robots look at the world as it is now.
    fn look(&mut self) -> Result<(), DialogError> {
        self.state.refresh()?;
        let tick = self.state.tick();
        let state = self.state.view()?;
        for robot in self.robots.iter_mut() {
            if let Some(state) = state {
                robot.knowledge.look(state, tick);
            }
            if let Some(lessons) = robot.knowledge.take_lessons() {
                self.talk.delivery().journal.note_lessons(robot.body.0, lessons);
            }
        }
        Ok(())
    }

    /// The same, if it is time.
    fn look_by_and_by(&mut self) -> Result<(), DialogError> {
        self.state.refresh()?;
        let Some(state) = self.state.view()? else { return Ok(()) };
        let tick = self.state.tick();
        let is_due = |robot: &Robot| {
            let body = state.bodies.iter().find(|record| record.body == robot.body.0);
            body.is_some_and(|body| robot.knowledge.is_due(tick, body.position_m, body.yaw_rad))
        };
        if self.robots.iter().any(is_due) { self.look() } else { Ok(()) }
    }

    /// Has robots go on with what they were told to do later, if it is time.
    fn wake(&mut self) -> Result<(), DialogError> {
        let tick = self.state.tick();
        let is_due = tick >= self.woke_at.saturating_add(WAKES_EVERY);
        if !is_due || !self.robots.iter().any(|robot| robot.conversation.awaits()) {
            return Ok(());
        }
        self.woke_at = tick;
        self.look()?;
        #[allow(clippy::cast_precision_loss, reason = "a session is no 10^15 ticks long")]
        let now_s = tick as f64 * TICK_S;
        let woken: Vec<(BodyId, Vec<Outgoing>)> = self
            .robots
            .iter_mut()
            .map(|robot| (robot.body, robot.conversation.wake(now_s, &robot.knowledge)))
            .collect();
        for (body, items) in woken.into_iter().filter(|(_, items)| !items.is_empty()) {
            self.deliver(body, Heard::Nothing, None, items)?;
        }
        Ok(())
    }

    /// Answers what is held back, if its time has come.
    fn elapse(&mut self) -> Result<(), DialogError> {
        let now_nanos = monotonic_nanos();
        if self.due(now_nanos).is_none_or(|due| due > now_nanos) {
            return Ok(());
        }
        self.look()?;
        let now_nanos = monotonic_nanos();
        for body in self.robots.iter().map(|robot| robot.body).collect::<Vec<_>>() {
            let Some(robot) = self.robots.of_body(body) else { continue };
            let items = robot.conversation.elapse(now_nanos, &robot.knowledge);
            if !items.is_empty() {
                self.deliver(body, Heard::Nothing, None, items)?;
            }
        }
        Ok(())
    }

    /// An agent said something, about a plan or of its own accord.
    fn follow(&mut self, envelope: &Envelope, header: &DialogHeader) -> Result<(), DialogError> {
        if self.talk.delivery().journal.has_heard(envelope) {
            return Ok(());
        }
        let (kind, body) = (header.kind(), BodyId(header.body));
        if let (Some(DialogKind::Reply | DialogKind::Question), 0) = (kind, header.turn) {
            self.peers.refresh()?;
            self.talk.pass_on(envelope, header, self.peers.name(envelope.run, header.body));
            return Ok(());
        }
        if let Some(DialogKind::StepEnded | DialogKind::PlanEnded) = kind {
            self.look()?;
        }
        let told = for_people(&self.robots.names.told(&header.text));
        let Some(Robot { conversation, knowledge, .. }) = self.robots.of_body(body) else { return Ok(()) };
        if let Some(action) = conversation.deed(header) {
            knowledge.note_deed(&action);
        }
        let mut header = *header;
        header.text = told;
        let items = conversation.follow(&header, knowledge);
        if items.is_empty() && kind != Some(DialogKind::StepEnded) {
            return Ok(());
        }
        self.deliver(body, Heard::message(envelope), None, items)
    }

    /// What an interpreter takes for meant that the robot of a body was told in a turn, and how it came to that.
    fn note_interpretation(
        &mut self,
        body: BodyId,
        turn: u64,
        meant: Option<&Meant>,
        note: &str,
    ) -> Result<(), DialogError> {
        let Some(robot) = self.robots.of_body(body) else { return Ok(()) };
        let items = robot.conversation.interpreted(turn, meant, note, monotonic_nanos(), &robot.knowledge);
        if items.is_empty() { Ok(()) } else { self.deliver(body, Heard::Nothing, None, items) }
    }

    /// A wizard decides what is answered: the robot of a body, or else the one that holds something back. Gives why it cannot be.
    fn decide(&mut self, body: Option<BodyId>, decision: Decision) -> Result<Result<(), String>, DialogError> {
        let now_nanos = monotonic_nanos();
        self.look()?;
        let holds = |robot: &&Robot| robot.conversation.proposal(now_nanos).is_some();
        let meant = self.robots.iter().find(holds).or_else(|| self.robots.iter().next()).map(|robot| robot.body);
        let Some(body) = body.or(meant) else { return Ok(Err("There is no robot.".to_owned())) };
        let Some(robot) = self.robots.of_body(body) else { return Ok(Err("There is no such robot.".to_owned())) };
        match robot.conversation.decide(decision, now_nanos, &robot.knowledge) {
            Ok(items) => self.deliver(body, Heard::Nothing, None, items).map(Ok),
            Err(problem) => Ok(Err(problem)),
        }
    }

    fn is_whole(&self, text: &str) -> bool {
        let text = self.robots.called(text);
        let spoken_to = self.talk.delivery().spoken_to;
        let robot = self.robots.look_at(spoken_to).or_else(|| self.robots.iter().next());
        let is_whole = robot.is_some_and(|robot| robot.conversation.is_whole(&text, &robot.knowledge));
        if is_whole {
            self.talk.note_draft(&text, Visitor::default());
        }
        is_whole
    }

    fn likely(&self, before: u64) -> Option<(u64, Scene)> {
        let robot = self.robots.iter().next()?;
        let number = robot.knowledge.number();
        if number == before {
            return None;
        }
        let names = robot.conversation.language().spoken_names(robot.knowledge.world()?);
        let [things, places, rooms] =
            [names.things, names.places, names.rooms].map(|names| names.into_iter().collect());
        Some((number, Scene { things, places, rooms, words: self.robots.called_by().to_vec(), known: names.words }))
    }

    /// Delivers what follows for the robot of a body.
    fn deliver(
        &mut self,
        body: BodyId,
        heard: Heard,
        begun: Option<Begun>,
        items: Vec<Outgoing>,
    ) -> Result<(), DialogError> {
        self.robots.note_speech(body);
        let Some(robot) = self.robots.of_body(body) else { return Ok(()) };
        let memory = robot.conversation.memory().clone();
        let proposes = items.contains(&Outgoing::Proposes);
        let proposal = proposes.then(|| proposed(robot, monotonic_nanos()));
        let numbered = self.robots.numbered().to_vec();
        let unasked = self.talk.deliver(Outbox { body, heard, begun, items, memory, numbered, proposal })?;
        unasked.into_iter().try_for_each(|turn| self.note_interpretation(body, turn, None, NOT_ASKED))
    }
}

/// Who asked may be gone.
fn answer<T>(to: oneshot::Sender<T>, answer: T) {
    let _ = to.send(answer);
}

/// What a robot holds back, for wizards.
fn proposed(robot: &Robot, now_nanos: u64) -> Value {
    page::proposal(robot.body.0, robot.conversation.proposal(now_nanos).as_ref())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
