//! What comes between what the robot makes of an utterance and what it lets happen of that. Whoever intercepts does so here: an
//! interpreter that is asked what is meant, and a wizard or a constant delay, which hold it back. A stop passes.

use cohabit_language::{Known, Unclear, Understanding};

use super::{
    Conversation, Outgoing,
    hearing::{Meaning, Puzzle, Words},
};
use crate::{expression::FacialExpression, known::Knowledge, page::LineKind};

/// What comes between.
pub(super) enum Interception {
    /// Nothing: it is answered.
    Nothing,
    /// An interpreter is asked.
    Interpreter(Box<Unclear>),
    /// It stops, and ends what is held back.
    Stop,
    /// It waits behind what is held back.
    Queue,
    /// It is held back.
    Hold,
}

impl Conversation {
    /// What comes between a meaning and its answer. An interpreter is asked only where what is `known` is given: once.
    pub(super) fn interception(&self, meaning: &Meaning, known: Option<&Known>) -> Interception {
        let is_asked = |_: &&String| self.consulting.is_asked(&meaning.understanding, &meaning.context);
        if let Some((text, known)) = meaning.open.as_ref().filter(is_asked).zip(known) {
            let before = self.memory.said.iter().cloned().collect();
            return Interception::Interpreter(Box::new(self.language.unclear(text, known, before)));
        }
        if !self.holding.holds() {
            Interception::Nothing
        } else if matches!(meaning.understanding, Understanding::Stop { .. }) {
            Interception::Stop
        } else if self.is_holding_back() {
            // It sounded like a stop, and was none.
            Interception::Queue
        } else {
            Interception::Hold
        }
    }

    /// Answers what was understood, as far as nothing comes between.
    pub(super) fn pass(
        &mut self,
        words: Words,
        meaning: Meaning,
        interception: Interception,
        knowledge: &Knowledge,
        outbox: &mut Vec<Outgoing>,
    ) {
        let turn = words.turn;
        match interception {
            Interception::Nothing => self.take_up(meaning, turn, turn, knowledge, outbox),
            Interception::Interpreter(unclear) => {
                self.memory.unsure = None;
                self.memory.puzzle = Some(Puzzle { words, meaning });
                self.express(turn, FacialExpression::Thinking, outbox);
                self.say(turn, LineKind::Say, "One moment, let me think.", outbox);
                outbox.push(Outgoing::Interpret { turn, unclear });
            }
            Interception::Stop => self.pass_stop(words, meaning, knowledge, outbox),
            Interception::Queue => self.let_wait(words, outbox),
            Interception::Hold => self.hold(words, meaning, outbox),
        }
    }

    /// Stops at once; what else was asked for is held back.
    fn pass_stop(&mut self, words: Words, meaning: Meaning, knowledge: &Knowledge, outbox: &mut Vec<Outgoing>) {
        let Understanding::Stop { reply, then } = meaning.understanding else { return };
        self.stop_held(outbox);
        let stop = Understanding::Stop { reply, then: None };
        self.take_up(Meaning { understanding: stop, ..meaning }, words.turn, words.turn, knowledge, outbox);
        if let Some(then) = then {
            // The plan of that number is the stop's.
            self.memory.turns += 1;
            let context = self.memory.context.clone();
            self.hold(words, Meaning { understanding: *then, context, unsure: None, open: None }, outbox);
        }
    }
}
