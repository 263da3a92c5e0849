//! What a conversation holds back: what it has understood and not answered yet, until a wizard decides or a delay is over.
//!
//! One thing is held back at a time; what is said meanwhile waits, and is understood once that was answered. While it is held
//! back the conversation goes on as if it had not been said, and when something comes of that it is understood anew. A stop is
//! never held back, and ends what is.

mod deciding;

use cohabit_bus::message::DialogKind;
use cohabit_language::{Known, Understanding};
use cohabit_record::{DecisionOutcome, Proposed, WizardDecision};
use serde::{Deserialize, Serialize};

use super::{
    Conversation, Outgoing, TurnEnd,
    alone::ALONE,
    hearing::{Meaning, Words},
};
use crate::{
    known::Knowledge,
    page::LineKind,
    wizard::{HeldSince, Next, OnTimeout, Proposal},
};
use deciding::Own;

/// So much of a proposal's plan is noted.
const MOST_NOTED_STEPS: usize = 12;
/// The most that waits behind what is held back.
const MOST_WAITING: usize = 32;

/// What is held back.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(super) struct Held {
    words: Words,
    meaning: Meaning,
    /// What the robot made of the words by itself, for the record.
    own: Proposed,
    edits: Vec<String>,
    revision: u32,
    proposed_nanos: u64,
    is_late: bool,
    decided: Option<Decided>,
}

#[derive(Clone, Debug, Deserialize, Serialize)]
struct Decided {
    at_nanos: u64,
    /// What the wizard has the robot say and do; what it proposed, if absent.
    own: Option<Own>,
}

impl Held {
    fn since(&self) -> HeldSince {
        HeldSince {
            received_nanos: self.words.received_nanos,
            proposed_nanos: self.proposed_nanos,
            is_decided: self.decided.is_some(),
            is_late: self.is_late,
        }
    }

    /// What came of it, where the wizard decided; or did not in time.
    fn outcome(&self) -> DecisionOutcome {
        match &self.decided {
            None => DecisionOutcome::TimedOut,
            Some(Decided { own: Some(own), .. }) if own.is_nothing() => DecisionOutcome::Dismissed,
            Some(Decided { own: Some(_), .. }) => DecisionOutcome::Replaced,
            Some(Decided { own: None, .. }) if self.edits.is_empty() => DecisionOutcome::Accepted,
            Some(Decided { own: None, .. }) => DecisionOutcome::Edited,
        }
    }

    /// What is noted of it, answered then if it was.
    fn record(&self, outcome: DecisionOutcome, answered_nanos: Option<u64>) -> WizardDecision {
        let decided = self.decided.as_ref().filter(|_| outcome != DecisionOutcome::Stopped);
        let own = decided.and_then(|decided| decided.own.as_ref());
        WizardDecision {
            said: self.words.text.clone(),
            proposed: Some(self.own.clone()),
            edits: self.edits.clone(),
            is_late: self.is_late || outcome == DecisionOutcome::TimedOut,
            decided_ms: decided.map(|decided| milliseconds(self.proposed_nanos, decided.at_nanos)),
            answered_ms: answered_nanos.map(|nanos| milliseconds(self.words.received_nanos, nanos)),
            ..own.map_or_else(|| WizardDecision::of_outcome(outcome), |own| own.record(outcome))
        }
    }
}

fn milliseconds(from_nanos: u64, to_nanos: u64) -> f64 {
    to_nanos.saturating_sub(from_nanos) as f64 * 1e-6
}

/// What the robot would do, for a wizard and the record.
fn proposed(understanding: &Understanding) -> Proposed {
    let (kind, steps) = match understanding {
        Understanding::Plan { steps, .. } => ("plan", steps.as_slice()),
        Understanding::Question { .. } => ("question", &[][..]),
        Understanding::Answer { .. } => ("answer", &[][..]),
        Understanding::Refusal { .. } => ("refusal", &[][..]),
        Understanding::Stop { .. } => ("stop", &[][..]),
    };
    let steps = steps.iter().filter(|step| !step.says.is_empty()).map(|step| step.says.clone());
    let reply = understanding.reply().to_owned();
    Proposed { kind: kind.to_owned(), steps: steps.take(MOST_NOTED_STEPS).collect(), reply }
}

impl Conversation {
    /// Whether something is held back, so that what is said now has to wait.
    pub(super) fn is_holding_back(&self) -> bool {
        self.memory.held.is_some()
    }

    /// Has words wait until what is held back is answered; of too many the oldest are over.
    pub(super) fn let_wait(&mut self, words: Words, outbox: &mut Vec<Outgoing>) {
        self.memory.waiting.push_back(words);
        if self.memory.waiting.len() > MOST_WAITING
            && let Some(Words { turn, .. }) = self.memory.waiting.pop_front()
        {
            outbox.push(Outgoing::TurnEnded { turn, end: TurnEnd::Interrupted });
        }
        outbox.push(Outgoing::Proposes);
    }

    /// Answers what was understood: from here on the conversation is the one that it leads to.
    pub(super) fn take_up(
        &mut self,
        meaning: Meaning,
        turn: u64,
        number: u64,
        knowledge: &Knowledge,
        outbox: &mut Vec<Outgoing>,
    ) {
        let Meaning { understanding, context, unsure, .. } = meaning;
        self.memory.unsure = unsure;
        if self.is_in_vain(&understanding, context.awaits()) {
            // There is nothing to go on with: the conversation stays where it was.
            let refusal = Understanding::Refusal { text: ALONE.to_owned(), is_lost: false };
            return self.react(turn, number, refusal, knowledge, outbox);
        }
        self.memory.context = context;
        self.react(turn, number, understanding, knowledge, outbox);
    }

    /// Holds back what was understood.
    pub(super) fn hold(&mut self, words: Words, meaning: Meaning, outbox: &mut Vec<Outgoing>) {
        let proposed_nanos = words.received_nanos.max(self.memory.free_since_nanos);
        let held = Held {
            own: proposed(&meaning.understanding),
            words,
            meaning,
            edits: Vec::new(),
            revision: 0,
            proposed_nanos,
            is_late: false,
            decided: None,
        };
        self.memory.held = Some(Box::new(held));
        outbox.push(Outgoing::Proposes);
    }

    /// The person told the robot to stop: what is held back, and what waits behind it, is over.
    pub(super) fn stop_held(&mut self, outbox: &mut Vec<Outgoing>) {
        let waiting = std::mem::take(&mut self.memory.waiting);
        if let Some(held) = self.memory.held.take() {
            self.note_decision(held.words.turn, &held.record(DecisionOutcome::Stopped, None), outbox);
            outbox.push(Outgoing::TurnEnded { turn: held.words.turn, end: TurnEnd::Interrupted });
            outbox.push(Outgoing::Proposes);
        }
        for words in waiting {
            let record = WizardDecision { said: words.text, ..WizardDecision::of_outcome(DecisionOutcome::Stopped) };
            self.note_decision(words.turn, &record, outbox);
            outbox.push(Outgoing::TurnEnded { turn: words.turn, end: TurnEnd::Interrupted });
        }
    }

    /// What is noted of what is held back, and waits behind it, when the session ends; it stays, should the session go on.
    pub(crate) fn left_undecided(&self) -> Vec<Outgoing> {
        if self.holding.wizard.is_none() {
            return Vec::new();
        }
        let held = self.memory.held.iter().map(|held| {
            let outcome = if held.decided.is_some() { held.outcome() } else { DecisionOutcome::Undecided };
            decided(held.words.turn, &held.record(outcome, None))
        });
        let waiting = self.memory.waiting.iter().map(|words| {
            let said = words.text.clone();
            decided(words.turn, &WizardDecision { said, ..WizardDecision::of_outcome(DecisionOutcome::Undecided) })
        });
        held.chain(waiting).collect()
    }

    /// Notes a decision for the log; where nobody decides there is none.
    fn note_decision(&self, turn: u64, record: &WizardDecision, outbox: &mut Vec<Outgoing>) {
        if self.holding.wizard.is_some() {
            outbox.push(decided(turn, record));
        }
    }

    /// Understands what is held back anew, in the conversation as it is by now. What is decided stays as it was seen.
    pub(super) fn propose_again(&mut self, knowledge: &Knowledge, outbox: &mut Vec<Outgoing>) {
        let Some(held) = self.memory.held.as_ref().filter(|held| held.decided.is_none()) else { return };
        let Some(known) = knowledge.known() else { return };
        let meaning = match held.edits.last() {
            Some(request) => self.requested(request, &known),
            None => self.meaning(&held.words, &known),
        };
        let Some(held) = &mut self.memory.held else { return };
        if !super::is_same(&held.meaning.understanding, &meaning.understanding) {
            held.revision += 1;
            if held.edits.is_empty() {
                held.own = proposed(&meaning.understanding);
            }
            outbox.push(Outgoing::Proposes);
        }
        held.meaning = meaning;
    }

    /// What a plain request means that somebody else wrote.
    fn requested(&self, request: &str, known: &Known) -> Meaning {
        let mut context = self.memory.context.clone();
        let understanding = self.language.understand(request, known, &mut context);
        Meaning { understanding, context, unsure: None, open: None }
    }

    /// What is proposed to a wizard now, if anything is held back.
    pub(crate) fn proposal(&self, now_nanos: u64) -> Option<Proposal> {
        let held = self.memory.held.as_ref()?;
        let Proposed { kind, steps, reply } = proposed(&held.meaning.understanding);
        let due = self.due(now_nanos);
        Some(Proposal {
            turn: held.words.turn,
            revision: held.revision,
            said: held.words.text.clone(),
            edits: held.edits.clone(),
            kind,
            steps,
            reply,
            sureness: held.meaning.context.sureness(),
            waiting: self.memory.waiting.iter().map(|words| words.text.clone()).collect(),
            is_decided: held.decided.is_some(),
            is_late: held.is_late,
            left_ms: due.map(|due| due.saturating_sub(now_nanos) / 1_000_000),
        })
    }

    /// When something follows without anybody's doing, if it does.
    pub(crate) fn due(&self, now_nanos: u64) -> Option<u64> {
        match self.holding.next(self.memory.held.as_ref()?.since(), now_nanos) {
            Next::Wait(until) => until,
            Next::Answer | Next::TimeOut(_) => Some(now_nanos),
        }
    }

    /// What follows by now without anybody's doing.
    pub(crate) fn elapse(&mut self, now_nanos: u64, knowledge: &Knowledge) -> Vec<Outgoing> {
        let mut outbox = Vec::new();
        let Some(held) = &mut self.memory.held else { return outbox };
        match self.holding.next(held.since(), now_nanos) {
            Next::Wait(_) => {}
            Next::Answer | Next::TimeOut(OnTimeout::Act) => self.release(now_nanos, knowledge, &mut outbox),
            Next::TimeOut(follows) => {
                held.is_late = true;
                let turn = held.words.turn;
                let moment = self.holding.wizard.as_ref().map(|wizard| wizard.moment.clone());
                if let (OnTimeout::Say, Some(moment)) = (follows, moment) {
                    self.say(turn, LineKind::Say, &moment, &mut outbox);
                }
                outbox.push(Outgoing::Proposes);
            }
        }
        outbox
    }

    /// Answers what is held back, and takes up what was said since.
    fn release(&mut self, now_nanos: u64, knowledge: &Knowledge, outbox: &mut Vec<Outgoing>) {
        let Some(held) = self.memory.held.take() else { return };
        let record = held.record(held.outcome(), Some(now_nanos));
        let Held { words: Words { turn, received_nanos, text, .. }, meaning, decided, .. } = *held;
        let number = self.number_of(turn);
        outbox.push(Outgoing::Answers { turn: number, received_nanos });
        match decided.and_then(|decided| decided.own) {
            Some(own) => {
                self.memory.context.note_said(false, &text);
                self.do_own(turn, number, own, knowledge, outbox);
            }
            None => self.take_up(meaning, turn, number, knowledge, outbox),
        }
        self.note_decision(turn, &record, outbox);
        outbox.push(Outgoing::Proposes);
        self.memory.free_since_nanos = now_nanos;
        if let Some(words) = self.memory.waiting.pop_front() {
            self.take_in(words, knowledge, outbox);
        }
    }

    /// The number of the plan that answers a turn: that of the turn, if nothing was numbered since.
    const fn number_of(&mut self, turn: u64) -> u64 {
        if self.memory.turns > turn {
            self.memory.turns += 1;
        }
        self.memory.turns
    }
}

/// The note of a decision.
fn decided(turn: u64, record: &WizardDecision) -> Outgoing {
    Outgoing::Note { kind: DialogKind::Decided, turn, text: record.text() }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
