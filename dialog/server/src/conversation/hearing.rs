//! What somebody tells the robot, from words to what they mean in the conversation as it is; perhaps by an interpreter.

use cohabit_bus::message::DialogKind;
use cohabit_cdf::ObjectId;
use cohabit_language::{Clarification, Context, Known, Language, Meant, Understanding, says_stop};
use serde::{Deserialize, Serialize};

use super::{Conversation, Outgoing, TurnEnd, is_same};
use crate::{
    known::Knowledge,
    page::LineKind,
    spoken::{Reading, Spoken},
};

/// What somebody told the robot.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(super) struct Words {
    /// In which turn.
    pub turn: u64,
    /// When, ns of the monotonic clock.
    pub received_nanos: u64,
    /// All but the robot's name.
    pub text: String,
    /// How.
    pub by: By,
}

/// How somebody told something.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(super) enum By {
    /// In writing, or by a button that says it.
    Writing,
    /// Aloud: what it sounds like by itself, and whether the robot asks before it does it.
    Voice { raw: String, is_doubtful: bool },
    /// By pointing at an object.
    Pointing(ObjectId),
}

/// What was made of words.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(super) struct Meaning {
    pub understanding: Understanding,
    /// The conversation that it leads to.
    pub context: Context,
    /// What was heard and is not trusted, of which it asks whether it was said.
    pub unsure: Option<String>,
    /// The words that an interpreter may be asked about, if it may.
    pub open: Option<String>,
}

/// Words that an interpreter may make something of.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(super) struct Puzzle {
    pub words: Words,
    /// What the robot itself makes of it, in case that nobody knows better.
    pub meaning: Meaning,
}

/// An utterance as a robot would understand it now.
pub(crate) struct Thought {
    language: Language,
    known: Known,
    context: Context,
    text: String,
}

impl Thought {
    /// Has the language model make of it what it will be asked for again in the utterance's turn.
    pub fn think(mut self) {
        let _ = self.language.understand(&self.text, &self.known, &mut self.context);
    }
}

/// How something was heard that was said aloud.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Aloud<'a> {
    /// What it sounds like by itself.
    pub raw: &'a str,
    /// Whether the robot asks before it does it.
    pub is_doubtful: bool,
}

impl Conversation {
    /// Somebody said something. Gives the turn's number and what follows.
    pub fn hear(&mut self, text: &str, knowledge: &Knowledge) -> (u64, Vec<Outgoing>) {
        self.hear_called(text, text, 0, knowledge)
    }

    /// The same, of which `text` is said to this robot: all but its name. It was received then, ns of the monotonic clock.
    pub fn hear_called(
        &mut self,
        said: &str,
        text: &str,
        received_nanos: u64,
        knowledge: &Knowledge,
    ) -> (u64, Vec<Outgoing>) {
        self.hear_as(said, text, By::Writing, received_nanos, knowledge)
    }

    /// The same, said aloud: what is not trusted is asked about, and what is not understood is told as it was heard.
    pub(crate) fn hear_aloud(
        &mut self,
        said: &str,
        text: &str,
        aloud: Aloud<'_>,
        received_nanos: u64,
        knowledge: &Knowledge,
    ) -> (u64, Vec<Outgoing>) {
        let by = By::Voice { raw: aloud.raw.to_owned(), is_doubtful: aloud.is_doubtful };
        self.hear_as(said, text, by, received_nanos, knowledge)
    }

    /// Which reading of what was said aloud is meant, and whether it is to be asked about first; `called` takes the robot's name
    /// out of one.
    pub(crate) fn reading(
        &self,
        spoken: &Spoken,
        called: &dyn Fn(&str) -> String,
        knowledge: &Knowledge,
    ) -> Option<Reading> {
        let known = knowledge.known()?;
        let meant = |text: &str| self.language.understand(text, &known, &mut self.memory.context.clone());
        let consents = |text: &str| self.memory.unsure.is_some() && self.language.consent(text, &known).is_some();
        let reading = spoken.reading(|text| {
            let text = called(text);
            if consents(&text) {
                Understanding::Answer { text, highlight: Vec::new(), holds: Some(true) }
            } else {
                meant(&text)
            }
        })?;
        Some(Reading { is_doubtful: reading.is_doubtful && self.language.may_ask(), ..reading })
    }

    /// A text as it would be understood now, if that takes long enough to be done ahead.
    pub(crate) fn thought(&self, text: &str, knowledge: &Knowledge) -> Option<Thought> {
        let known = knowledge.known().filter(|_| self.language.may_think_long())?;
        let (language, context) = (self.language.clone(), self.memory.context.clone());
        Some(Thought { language, known, context, text: text.to_owned() })
    }

    /// Somebody said something that is over before it is understood: they say stop by now, or too much at once. Gives what follows.
    pub(crate) fn hear_in_vain(&mut self, said: &str) -> Vec<Outgoing> {
        self.memory.turns += 1;
        let turn = self.memory.turns;
        vec![Outgoing::utterance(turn, said), Outgoing::TurnEnded { turn, end: TurnEnd::Interrupted }]
    }

    fn hear_as(
        &mut self,
        said: &str,
        text: &str,
        by: By,
        received_nanos: u64,
        knowledge: &Knowledge,
    ) -> (u64, Vec<Outgoing>) {
        self.memory.turns += 1;
        let turn = self.memory.turns;
        let mut outbox = vec![Outgoing::utterance(turn, said)];
        if knowledge.known().is_none() {
            self.say(turn, LineKind::Problem, "I am not there yet; one moment.", &mut outbox);
            outbox.push(Outgoing::TurnEnded { turn, end: TurnEnd::Refused });
            return (turn, outbox);
        }
        self.leave_puzzle(&mut outbox);
        let words = Words { turn, received_nanos, text: text.to_owned(), by };
        if self.is_holding_back() && !says_stop(text) {
            self.let_wait(words, &mut outbox);
        } else {
            self.take_in(words, knowledge, &mut outbox);
        }
        (turn, outbox)
    }

    /// Understands what somebody told the robot, and answers it.
    pub(super) fn take_in(&mut self, words: Words, knowledge: &Knowledge, outbox: &mut Vec<Outgoing>) {
        let Some(known) = knowledge.known() else { return };
        let meaning = self.meaning(&words, &known);
        let interception = self.interception(&meaning, Some(&known));
        if !matches!(words.by, By::Pointing(_)) {
            self.note_line(false, &words.text);
        }
        self.pass(words, meaning, interception, knowledge, outbox);
    }

    /// What the robot itself makes of words, in the conversation as it is.
    pub(super) fn meaning(&self, words: &Words, known: &Known) -> Meaning {
        let mut context = self.memory.context.clone();
        if let By::Pointing(object) = words.by {
            let understanding = self.language.choose(object, known, &mut context);
            return Meaning { understanding, context, unsure: self.memory.unsure.clone(), open: None };
        }
        let mut text = &words.text;
        if let Some(unsure) = &self.memory.unsure {
            match self.language.consent(text, known) {
                Some(true) => text = unsure,
                Some(false) => {
                    let again = "All right. Please say it once more, or type it.".to_owned();
                    let understanding = Understanding::Answer { text: again, highlight: Vec::new(), holds: None };
                    return Meaning { understanding, context, unsure: None, open: None };
                }
                None => {}
            }
        }
        let raw = match &words.by {
            By::Voice { is_doubtful: true, .. } => {
                return Meaning { understanding: doubt(text), context, unsure: Some(text.clone()), open: None };
            }
            By::Voice { raw, .. } => Some(raw),
            By::Writing | By::Pointing(_) => None,
        };
        let understood = match (self.language.understand(text, known, &mut context), raw) {
            (Understanding::Refusal { is_lost: true, text }, Some(raw)) => {
                Understanding::Refusal { is_lost: true, text: heard(raw, &text) }
            }
            // Nobody knows what that is: perhaps it was misheard.
            (
                Understanding::Question { kind: Clarification::Appearance, about, text, candidates, options },
                Some(raw),
            ) if candidates.is_empty() => {
                let text = heard(raw, &text);
                Understanding::Question { kind: Clarification::Appearance, about, text, candidates, options }
            }
            (understood, _) => understood,
        };
        Meaning { understanding: understood, context, unsure: None, open: Some(text.clone()) }
    }

    /// What an interpreter takes for meant by now that was said in a turn, if it knows, and how it came to that, for the log.
    pub(crate) fn interpreted(
        &mut self,
        turn: u64,
        meant: Option<&Meant>,
        note: &str,
        now_nanos: u64,
        knowledge: &Knowledge,
    ) -> Vec<Outgoing> {
        let mut outbox = Vec::new();
        let Some(Puzzle { words, meaning: own }) = self.memory.puzzle.take_if(|puzzle| puzzle.words.turn == turn)
        else {
            return outbox;
        };
        outbox.push(Outgoing::Note { kind: DialogKind::Interpreted, turn, text: note.to_owned() });
        // Nobody could decide it before: a wizard's time begins now.
        self.memory.free_since_nanos = now_nanos;
        let mut context = self.memory.context.clone();
        let known = knowledge.known().zip(meant);
        let understood = known.and_then(|(known, meant)| self.language.understand_meant(meant, &known, &mut context));
        let Some(understanding) = understood else {
            let interception = self.interception(&own, None);
            self.pass(words, own, interception, knowledge, &mut outbox);
            return outbox;
        };
        let is_other = !is_same(&own.understanding, &understanding);
        if let Some(Meant::Do(requests)) = meant.filter(|_| is_other && !self.holding.holds()) {
            let taken = format!("I take that as: \"{}\".", requests.join(", then "));
            self.say(turn, LineKind::Say, &taken, &mut outbox);
            context.note_said(true, &taken);
        }
        let meaning = Meaning { understanding, context, unsure: None, open: None };
        let interception = self.interception(&meaning, None);
        self.pass(words, meaning, interception, knowledge, &mut outbox);
        outbox
    }

    /// The turn that an interpreter was asked about and has not answered yet.
    pub(crate) fn puzzled(&self) -> Option<u64> {
        self.memory.puzzle.as_ref().map(|puzzle| puzzle.words.turn)
    }

    /// Something else is said meanwhile.
    fn leave_puzzle(&mut self, outbox: &mut Vec<Outgoing>) {
        if let Some(Puzzle { words, .. }) = self.memory.puzzle.take() {
            outbox.push(Outgoing::TurnEnded { turn: words.turn, end: TurnEnd::Interrupted });
        }
    }

    /// Somebody points at an object, as an answer or to speak of it. Gives the turn's number and what follows.
    pub(crate) fn choose(
        &mut self,
        object: ObjectId,
        received_nanos: u64,
        knowledge: &Knowledge,
    ) -> (u64, Vec<Outgoing>) {
        let known = knowledge.known();
        let Some(known) = known.filter(|known| known.object(object).is_some()) else {
            return self.hear_called("this one", "this one", received_nanos, knowledge);
        };
        self.memory.turns += 1;
        let turn = self.memory.turns;
        let text = self.language.name(object, &known);
        let mut outbox = vec![Outgoing::utterance(turn, &text)];
        let words = Words { turn, received_nanos, text, by: By::Pointing(object) };
        if self.is_holding_back() {
            self.let_wait(words, &mut outbox);
        } else {
            self.take_in(words, knowledge, &mut outbox);
        }
        (turn, outbox)
    }
}

/// What was heard, to be quoted.
fn plainly(heard: &str) -> &str {
    heard.trim().trim_end_matches(['.', '!', ','])
}

/// The question whether what was heard was said; a yes means it.
fn doubt(text: &str) -> Understanding {
    Understanding::Question {
        kind: Clarification::Confirmation,
        about: String::new(),
        text: format!("I am not sure I heard that right: \"{}\". Shall I do that?", plainly(text)),
        candidates: Vec::new(),
        options: vec!["yes".to_owned(), "no".to_owned()],
    }
}

/// What is said of what was heard and not understood.
fn heard(raw: &str, text: &str) -> String {
    format!("I heard \"{}\". {text}", plainly(raw))
}
