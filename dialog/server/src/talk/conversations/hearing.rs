//! What people tell the robots, in the order in which they said it, but that who says stop is heard at once.

use cohabit_bus::monotonic_nanos;
use cohabit_cdf::{BodyId, ObjectId};
use cohabit_language::says_stop;

use super::Conversations;
use crate::{
    DialogError,
    conversation::{Aloud, Outgoing, Thought},
    page,
    robots::{Robots, Visitor},
    spoken::{Reading, Spoken},
    talk::{
        Said, UNREACHABLE, Utterance,
        delivery::{Begun, Heard},
    },
    voice::FromEar,
    world_state::NewestState,
};

impl Conversations {
    /// Somebody tells the robots something.
    pub(super) fn take_utterance(&mut self, utterance: Utterance) {
        let is_stop = match &utterance.said {
            Said::Shown(_) | Said::Choice { .. } => false,
            said => said.words().is_some_and(|words| says_stop(&self.robots.called(words))),
        };
        if is_stop {
            self.leave_unheard(&utterance);
            self.hear(utterance);
            return;
        }
        if let Some(oldest) = self.unheard.push(utterance) {
            self.leave(&oldest);
        }
        self.hear_next();
    }

    /// The language model has thought of the utterance of that number.
    pub(super) fn hear_considered(&mut self, number: u64) {
        if let Some(utterance) = self.unheard.considered(number) {
            self.hear(utterance);
        }
        self.hear_next();
    }

    /// Hears what is next, up to something that is to be thought of first.
    fn hear_next(&mut self) {
        while let Some(first) = self.unheard.first() {
            let (words, visitor) = (first.said.words().map(str::to_owned), first.visitor);
            let thoughts = match words {
                Some(words) => self.thoughts(&words, visitor).unwrap_or_else(|error| {
                    tracing::warn!("{error}");
                    Vec::new()
                }),
                None => Vec::new(),
            };
            if self.unheard.consider(thoughts) {
                return;
            }
            if let Some(utterance) = self.unheard.pop() {
                self.hear(utterance);
            }
        }
    }

    /// What was said before a stop to those who are to stop, and is not heard yet, is over: nobody wants it done any more.
    fn leave_unheard(&mut self, stop: &Utterance) {
        let (robots, state) = (&self.robots, &self.state);
        let stopped = hearers(robots, state, stop);
        let is_over = |one: &Utterance| {
            !matches!(one.said, Said::Shown(_)) && hearers(robots, state, one).iter().any(|body| stopped.contains(body))
        };
        let over = self.unheard.take(is_over);
        over.iter().for_each(|utterance| self.leave(utterance));
    }

    /// What somebody said is over before it is understood; it is shown all the same.
    fn leave(&mut self, utterance: &Utterance) {
        let left = match &utterance.said {
            Said::Shown(_) => {
                utterance.tell(FromEar::Shown(None));
                Ok(())
            }
            said => {
                if matches!(said, Said::Aloud { spoken, .. } if spoken.settled.is_none()) {
                    utterance.tell(FromEar::Page(page::hearing("said")));
                }
                said.words().map_or(Ok(()), |words| self.hear_in_vain(words, utterance))
            }
        };
        if let Err(error) = left {
            tracing::error!("{error}");
        }
    }

    fn hear_in_vain(&mut self, words: &str, utterance: &Utterance) -> Result<(), DialogError> {
        for (nth, body) in hearers(&self.robots, &self.state, utterance).into_iter().enumerate() {
            let Some(robot) = self.robots.of_body(body) else { continue };
            let items = shown_once(nth, robot.conversation.hear_in_vain(words));
            self.deliver(body, Heard::AtPage(utterance.visitor.number), None, items)?;
        }
        Ok(())
    }

    /// Has the robots hear what somebody tells them. If that cannot be, who told it learns so.
    fn hear(&mut self, utterance: Utterance) {
        let visitor = utterance.visitor;
        let heard = match &utterance.said {
            Said::Text { text, received_nanos } => self.hear_text(text, visitor, *received_nanos),
            Said::Aloud { spoken, meant_nanos } => self.hear_aloud(spoken, &utterance, *meant_nanos),
            Said::Shown(spoken) => self.read(spoken, visitor).map(|reading| {
                let settled = |reading| Box::new(Spoken { settled: Some(reading), ..(**spoken).clone() });
                utterance.tell(FromEar::Shown(reading.map(settled)));
            }),
            Said::Choice { object, is_answer: true, .. } if self.robots.answered_by(*object).is_none() => Ok(()),
            Said::Choice { object, received_nanos, is_answer } => {
                if *is_answer {
                    self.talk.voice.hush();
                }
                self.choose(*object, visitor, *received_nanos)
            }
        };
        if let Err(error) = heard {
            tracing::error!("{error}");
            utterance.tell(FromEar::Page(page::error(UNREACHABLE)));
        }
    }

    fn hear_text(&mut self, said: &str, visitor: Visitor, received_nanos: u64) -> Result<(), DialogError> {
        let (bodies, text) = self.addressed(said, visitor, received_nanos)?;
        for (nth, body) in bodies.into_iter().enumerate() {
            self.listen_to(visitor, body)?;
            let Some(robot) = self.robots.of_body(body) else { continue };
            let (turn, items) = robot.conversation.hear_called(said, &text, received_nanos, &robot.knowledge);
            let begun = Some(Begun::now(turn, received_nanos));
            self.deliver(body, Heard::AtPage(visitor.number), begun, shown_once(nth, items))?;
        }
        Ok(())
    }

    /// Somebody said something aloud, and meant it then, perhaps in other words than were heard.
    fn hear_aloud(&mut self, spoken: &Spoken, utterance: &Utterance, meant_nanos: u64) -> Result<(), DialogError> {
        let visitor = utterance.visitor;
        let reading = self.read(spoken, visitor)?;
        if spoken.settled.is_none() {
            let state = if reading.is_some() { "said" } else { "nothing" };
            utterance.tell(FromEar::Page(page::hearing(state)));
        }
        let Some(Reading { text: said, is_doubtful }) = reading else { return Ok(()) };
        self.talk.voice.hush();
        let (bodies, text) = self.addressed(&said, visitor, spoken.text_nanos)?;
        let raw = &spoken.heard.raw;
        for (nth, body) in bodies.into_iter().enumerate() {
            self.listen_to(visitor, body)?;
            let Some(robot) = self.robots.of_body(body) else { continue };
            let aloud = Aloud { raw, is_doubtful };
            let (turn, items) = robot.conversation.hear_aloud(&said, &text, aloud, meant_nanos, &robot.knowledge);
            let speech = ([spoken.began_nanos, spoken.ended_nanos, spoken.text_nanos], raw.clone());
            let begun = Begun { speech: Some(speech), ..Begun::now(turn, meant_nanos) };
            self.deliver(body, Heard::AtPage(visitor.number), Some(begun), shown_once(nth, items))?;
        }
        Ok(())
    }

    /// Which reading of what was said aloud is meant; `None` if nobody seems to have said anything.
    fn read(&mut self, spoken: &Spoken, visitor: Visitor) -> Result<Option<Reading>, DialogError> {
        let Some(first) = spoken.first() else { return Ok(None) };
        let Some(body) = self.addressed(first, visitor, spoken.text_nanos)?.0.first().copied() else {
            return Ok(None);
        };
        let called = |text: &str| self.robots.called(text);
        let robot = self.robots.look_at(body);
        Ok(robot.and_then(|robot| robot.conversation.reading(spoken, &called, &robot.knowledge)))
    }

    /// Somebody chose an object, as an answer or to speak of it.
    fn choose(&mut self, object: ObjectId, visitor: Visitor, received_nanos: u64) -> Result<(), DialogError> {
        let body = match self.robots.answered_by(object) {
            Some(body) => body,
            None => match self.addressed("", visitor, received_nanos)?.0.first() {
                Some(body) => *body,
                None => return Ok(()),
            },
        };
        self.listen_to(visitor, body)?;
        let Some(robot) = self.robots.of_body(body) else { return Ok(()) };
        let (turn, items) = robot.conversation.choose(object, received_nanos, &robot.knowledge);
        self.deliver(body, Heard::AtPage(visitor.number), Some(Begun::now(turn, received_nanos)), items)
    }

    /// What would be understood of what a visitor says.
    pub(super) fn thoughts(&mut self, said: &str, visitor: Visitor) -> Result<Vec<Thought>, DialogError> {
        self.look()?;
        Ok(self.robots.thoughts(said, visitor, self.state.view()?, monotonic_nanos()))
    }

    /// Whom a visitor speaks to, and what is said to them.
    fn addressed(&mut self, said: &str, visitor: Visitor, nanos: u64) -> Result<(Vec<BodyId>, String), DialogError> {
        self.look()?;
        Ok(self.robots.addressed(said, visitor, self.state.view()?, nanos))
    }

    /// Has the robot of a body know who speaks to it.
    fn listen_to(&mut self, visitor: Visitor, body: BodyId) -> Result<(), DialogError> {
        let Some(state) = self.state.view()? else { return Ok(()) };
        if let Some(robot) = self.robots.of_body(body) {
            robot.knowledge.note_speaker(visitor.body, state);
        }
        Ok(())
    }
}

/// Who would hear something now.
fn hearers(robots: &Robots, state: &NewestState, utterance: &Utterance) -> Vec<BodyId> {
    let answered = match &utterance.said {
        Said::Choice { object, .. } => robots.answered_by(*object),
        _ => None,
    };
    let state = state.view().ok().flatten();
    let words = utterance.said.words().unwrap_or_default();
    let addressed = || robots.would_hear(words, utterance.visitor, state, monotonic_nanos());
    answered.map_or_else(addressed, |body| vec![body])
}

/// All that were called hear what somebody said, and it is shown once.
fn shown_once(nth: usize, mut items: Vec<Outgoing>) -> Vec<Outgoing> {
    for item in &mut items {
        if let Outgoing::Utterance { is_shown, .. } = item {
            *is_shown = nth == 0;
        }
    }
    items
}
