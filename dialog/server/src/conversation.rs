//! The conversation with one robot: from what people say to plans, and from what comes of them to what it says.
//!
//! Pure: the newest knowledge comes in with every call, and what is to be sent comes out.

use std::collections::{BTreeMap, VecDeque};

use cohabit_bus::{
    Text,
    message::{DialogHeader, DialogKind, DialogMessage, PlanStep},
};
use cohabit_cdf::{Action, GoToTarget, ObjectId, Status};
use cohabit_language::{
    Clarification, Consulting, Context, Language, Meant, Step, Unclear, Understanding, within_half_turn,
};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::known::Knowledge;
use crate::page::{self, Answer, Line, LineKind, Speaker};
use crate::spoken::{Reading, Spoken};

/// What the conversation wants done.
#[derive(Clone, Debug, PartialEq)]
pub enum Reaction {
    /// To the bus.
    Bus(Box<DialogMessage>),
    /// To the chat of all pages.
    Chat(Line),
    /// To all pages, not kept.
    Page(Value),
    /// To an interpreter: what is not understood in this turn.
    Interpret(u64, Box<Unclear>),
    /// The turn is over: show the state as it is, then say so.
    TurnEnded {
        /// Which.
        turn: u64,
        /// How.
        end: TurnEnd,
    },
}

/// How a turn ended.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum TurnEnd {
    /// The robot did all that was asked.
    Done,
    /// The robot answered.
    Answered,
    /// The robot asks, and waits for an answer.
    Asked,
    /// A step failed.
    Failed,
    /// The robot did not understand, or will not.
    Refused,
    /// Something else was asked for meanwhile.
    Interrupted,
}

impl Reaction {
    /// The line of chat, if it is one.
    pub const fn line(&self) -> Option<&Line> {
        match self {
            Self::Chat(line) => Some(line),
            _ => None,
        }
    }
}

impl TurnEnd {
    /// In one word, for the page and for reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::Answered => "answered",
            Self::Asked => "asked",
            Self::Failed => "failed",
            Self::Refused => "refused",
            Self::Interrupted => "interrupted",
        }
    }

    /// Whether it is what the person wanted.
    #[must_use]
    pub const fn is_success(self) -> bool {
        matches!(self, Self::Done | Self::Answered)
    }
}

/// A conversation with the robot of one body.
pub struct Conversation {
    language: Language,
    body: u32,
    memory: Memory,
    /// When an interpreter is asked.
    consulting: Consulting,
}

/// What the robot asks.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Asked {
    /// What kind of answer it needs.
    pub kind: Clarification,
    /// The objects in question.
    pub candidates: Vec<ObjectId>,
}

impl Asked {
    /// Whether pointing at an object answers it.
    pub fn is_answered_by(&self, object: ObjectId) -> bool {
        match self.kind {
            Clarification::Reference | Clarification::Confirmation => self.candidates.contains(&object),
            Clarification::Location | Clarification::Appearance => true,
            Clarification::Direction | Clarification::Request => false,
        }
    }

    /// The answers that a page offers: of a reference, its candidates.
    fn answers(&self, options: Vec<String>) -> Vec<Answer> {
        let object = |at: usize| {
            let candidate = self.candidates.get(at).filter(|_| self.kind == Clarification::Reference)?;
            Some(candidate.0)
        };
        options.into_iter().enumerate().map(|(at, text)| Answer { text, object: object(at) }).collect()
    }
}

#[derive(Clone, Debug, Deserialize, Serialize)]
struct Plan {
    /// The turn that it is for: a search goes on with plans of its own.
    turn: u64,
    steps: Vec<Step>,
    told_end: bool,
    /// What the robot will find gone at its end.
    #[serde(default)]
    missing: Option<ObjectId>,
}

impl Plan {
    fn new(turn: u64, steps: Vec<Step>) -> Self {
        Self { turn, steps, told_end: false, missing: None }
    }
}

/// What a conversation must know to go on where it was.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
#[serde(default)]
pub struct Memory {
    turns: u64,
    context: Context,
    plans: BTreeMap<u64, Plan>,
    asked: Option<Asked>,
    /// What was said, the latest last: whether by the robot, and what.
    said: VecDeque<(bool, String)>,
    /// What an interpreter was asked about.
    puzzle: Option<Puzzle>,
    /// What was heard, and is not trusted: a yes means it.
    unsure: Option<String>,
}

/// Words that an interpreter may make something of.
#[derive(Clone, Debug, Deserialize, Serialize)]
struct Puzzle {
    turn: u64,
    /// What the robot itself makes of it, and the conversation then, in case that nobody knows better.
    understanding: Understanding,
    context: Context,
}

/// How something was heard that was said aloud.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Aloud<'a> {
    /// What it sounds like by itself.
    pub raw: &'a str,
    /// Whether the robot asks before it does it.
    pub is_doubtful: bool,
}

/// So many lines tell an interpreter what it is about.
const LINES_BEFORE: usize = 6;

/// The most objects that are shown one after the other.
const MOST_SHOWN: usize = 6;
/// What is further to the side than this is out of sight, rad.
const HALF_VIEW_RAD: f32 = 0.7;

/// The most plans of which the end is waited for; an agent ends one when it begins the next.
const MOST_PLANS: usize = 16;

impl Conversation {
    /// A conversation in which nothing was said yet.
    pub fn new(language: Language, body: u32) -> Self {
        Self { language, body, memory: Memory::default(), consulting: Consulting::Never }
    }

    /// The same, with an interpreter that is asked at these times: [`Reaction::Interpret`] asks it.
    pub(crate) fn consulting(self, consulting: Consulting) -> Self {
        Self { consulting, ..self }
    }

    /// What it asks, if that is the last that it said.
    pub const fn asked(&self) -> Option<&Asked> {
        self.memory.asked.as_ref()
    }

    /// Goes on where this one was.
    pub(crate) fn restore(&mut self, memory: Memory) {
        self.memory = memory;
    }

    /// How many turns there were.
    pub(crate) const fn turns(&self) -> u64 {
        self.memory.turns
    }

    /// Its next turn comes after those so far, which may have been of others.
    pub(crate) fn count_from(&mut self, turns: u64) {
        self.memory.turns = self.memory.turns.max(turns);
    }

    /// What it must know to go on where it is.
    pub const fn memory(&self) -> &Memory {
        &self.memory
    }

    /// What the bus is told of a line of chat: nothing of what the game says, or a mind of its own accord.
    pub fn message(&self, line: &Line) -> Option<DialogMessage> {
        let kind = match (line.from, line.kind) {
            (Speaker::Person, _) => DialogKind::Utterance,
            (Speaker::Robot, _) if line.turn == 0 => return None,
            (Speaker::Robot, LineKind::Question) => DialogKind::Question,
            (Speaker::Robot, _) => DialogKind::Reply,
            (Speaker::Game, _) => return None,
        };
        let mut message = DialogMessage::new(kind, self.body, line.turn, &line.text);
        message.header.person = line.visitor.unwrap_or(0);
        message.steps = line.answers.iter().map(Answer::offer).collect();
        Some(message)
    }

    /// What the robot did, if this tells of a step that succeeded: to be noted before the conversation follows it.
    pub fn deed(&self, header: &DialogHeader) -> Option<Action> {
        let is_done = header.kind() == Some(DialogKind::StepEnded) && header.status().is_some_and(Status::is_success);
        let plan = self.memory.plans.get(&header.turn).filter(|_| is_done)?;
        plan.steps.get(header.step as usize).map(|step| step.action)
    }

    /// The newest plan, if its end was not told yet, once more.
    pub fn plan_under_way(&self) -> Option<DialogMessage> {
        let (turn, plan) = self.memory.plans.last_key_value()?;
        Some(self.plan_message(*turn, &plan.steps))
    }

    /// Somebody said something. Gives the turn's number and what follows.
    pub fn hear(&mut self, text: &str, knowledge: &Knowledge) -> (u64, Vec<Reaction>) {
        self.hear_called(text, text, knowledge)
    }

    /// The same, of which `text` is said to this robot: all but its name.
    pub(crate) fn hear_called(&mut self, said: &str, text: &str, knowledge: &Knowledge) -> (u64, Vec<Reaction>) {
        self.hear_as(said, text, None, knowledge)
    }

    /// The same, said aloud: what is not trusted is asked about, and what is not understood is told as it was heard.
    pub(crate) fn hear_aloud(
        &mut self,
        said: &str,
        text: &str,
        aloud: Aloud<'_>,
        knowledge: &Knowledge,
    ) -> (u64, Vec<Reaction>) {
        self.hear_as(said, text, Some(aloud), knowledge)
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

    /// Whether what was said so far is a whole sentence.
    pub(crate) fn is_whole(&self, text: &str, knowledge: &Knowledge) -> bool {
        let known = knowledge.known();
        known.is_some_and(|known| self.language.is_whole(text, &known, &self.memory.context))
    }

    /// Its language, to be asked while it goes on.
    pub(crate) const fn language(&self) -> &Language {
        &self.language
    }

    fn hear_as(
        &mut self,
        said: &str,
        text: &str,
        aloud: Option<Aloud<'_>>,
        knowledge: &Knowledge,
    ) -> (u64, Vec<Reaction>) {
        self.memory.turns += 1;
        let turn = self.memory.turns;
        let mut reactions = vec![
            self.bus(DialogKind::Utterance, turn, said),
            Reaction::Chat(Line::new(Speaker::Person, LineKind::Say, turn, said)),
        ];
        let Some(known) = knowledge.known() else {
            self.say(turn, DialogKind::Reply, LineKind::Problem, "I am not there yet; one moment.", &mut reactions);
            reactions.push(Reaction::TurnEnded { turn, end: TurnEnd::Refused });
            return (turn, reactions);
        };
        self.leave_puzzle(&mut reactions);
        let before = self.memory.said.iter().cloned().collect();
        self.note_line(false, text);
        let mut text = text.to_owned();
        if let Some(unsure) = self.memory.unsure.take() {
            match self.language.consent(&text, &known) {
                Some(true) => text = unsure,
                Some(false) => {
                    self.memory.asked = None;
                    let again = "All right. Please say it once more, or type it.";
                    self.say(turn, DialogKind::Reply, LineKind::Say, again, &mut reactions);
                    reactions.push(Reaction::TurnEnded { turn, end: TurnEnd::Answered });
                    return (turn, reactions);
                }
                None => {}
            }
        }
        if aloud.is_some_and(|aloud| aloud.is_doubtful) {
            self.ask_what_was_heard(turn, &text, &mut reactions);
            return (turn, reactions);
        }
        let text = text.as_str();
        let context = self.memory.context.clone();
        let understood = match (self.language.understand(text, &known, &mut self.memory.context), aloud) {
            (Understanding::Refusal { is_lost: true, text }, Some(Aloud { raw, .. })) => {
                Understanding::Refusal { is_lost: true, text: heard(raw, &text) }
            }
            // Nobody knows what that is: perhaps it was misheard.
            (
                Understanding::Question { kind: Clarification::Appearance, about, text, candidates, options },
                Some(aloud),
            ) if candidates.is_empty() => {
                let text = heard(aloud.raw, &text);
                Understanding::Question { kind: Clarification::Appearance, about, text, candidates, options }
            }
            (understood, _) => understood,
        };
        match understood {
            understanding if self.consulting.is_asked(&understanding, &self.memory.context) => {
                let unclear = self.language.unclear(text, &known, before);
                let context = std::mem::replace(&mut self.memory.context, context);
                self.memory.puzzle = Some(Puzzle { turn, understanding, context });
                self.say(turn, DialogKind::Reply, LineKind::Say, "One moment, let me think.", &mut reactions);
                reactions.push(Reaction::Interpret(turn, Box::new(unclear)));
            }
            understanding => self.react(turn, turn, understanding, knowledge, &mut reactions),
        }
        (turn, reactions)
    }

    /// Asks whether what was heard was said; a yes means it.
    fn ask_what_was_heard(&mut self, turn: u64, text: &str, reactions: &mut Vec<Reaction>) {
        let question = format!("I am not sure I heard that right: \"{}\". Shall I do that?", plainly(text));
        self.memory.unsure = Some(text.to_owned());
        self.note_line(true, &question);
        let asked = Asked { kind: Clarification::Confirmation, candidates: Vec::new() };
        let mut line = Line::new(Speaker::Robot, LineKind::Question, turn, question);
        line.answers = asked.answers(vec!["yes".to_owned(), "no".to_owned()]);
        self.memory.asked = Some(asked);
        reactions.push(self.bus(DialogKind::Question, turn, &line.text));
        reactions.push(Reaction::Chat(line));
        reactions.push(Reaction::TurnEnded { turn, end: TurnEnd::Asked });
    }

    /// What an interpreter takes for meant that was said in a turn, if it knows, and how it came to that, for the log.
    pub(crate) fn interpreted(
        &mut self,
        turn: u64,
        meant: Option<&Meant>,
        note: &str,
        knowledge: &Knowledge,
    ) -> Vec<Reaction> {
        let mut reactions = Vec::new();
        let Some(Puzzle { understanding: own, context, .. }) = self.memory.puzzle.take_if(|puzzle| puzzle.turn == turn)
        else {
            return reactions;
        };
        reactions.push(self.bus(DialogKind::Interpreted, turn, note));
        let known = knowledge.known().zip(meant);
        let understood =
            known.and_then(|(known, meant)| self.language.understand_meant(meant, &known, &mut self.memory.context));
        let Some(understanding) = understood else {
            self.memory.context = context;
            self.react(turn, turn, own, knowledge, &mut reactions);
            return reactions;
        };
        if let Some(Meant::Do(requests)) = meant.filter(|_| !is_same(&own, &understanding)) {
            let taken = format!("I take that as: \"{}\".", requests.join(", then "));
            self.say(turn, DialogKind::Reply, LineKind::Say, &taken, &mut reactions);
        }
        self.react(turn, turn, understanding, knowledge, &mut reactions);
        reactions
    }

    /// The turn that an interpreter was asked about and has not answered yet.
    pub(crate) fn puzzled(&self) -> Option<u64> {
        self.memory.puzzle.as_ref().map(|puzzle| puzzle.turn)
    }

    /// Something else is said meanwhile.
    fn leave_puzzle(&mut self, reactions: &mut Vec<Reaction>) {
        if let Some(Puzzle { turn, .. }) = self.memory.puzzle.take() {
            reactions.push(Reaction::TurnEnded { turn, end: TurnEnd::Interrupted });
        }
    }

    fn note_line(&mut self, is_robot: bool, text: &str) {
        if is_robot {
            self.memory.context.note_said(true, text);
        }
        self.memory.said.push_back((is_robot, text.to_owned()));
        while self.memory.said.len() > LINES_BEFORE {
            self.memory.said.pop_front();
        }
    }

    /// Somebody points at an object, as an answer or to speak of it. Gives the turn's number and what follows.
    pub fn choose(&mut self, object: ObjectId, knowledge: &Knowledge) -> (u64, Vec<Reaction>) {
        let known = knowledge.known();
        let Some(known) = known.filter(|known| known.object(object).is_some()) else {
            return self.hear("this one", knowledge);
        };
        self.memory.turns += 1;
        let turn = self.memory.turns;
        let text = self.language.name(object, &known);
        let mut reactions = vec![
            self.bus(DialogKind::Utterance, turn, &text),
            Reaction::Chat(Line::new(Speaker::Person, LineKind::Say, turn, text)),
        ];
        let understanding = self.language.choose(object, &known, &mut self.memory.context);
        self.react(turn, turn, understanding, knowledge, &mut reactions);
        (turn, reactions)
    }

    /// Says and does what was understood in `turn`; what is to be done is the plan of that number.
    fn react(
        &mut self,
        turn: u64,
        number: u64,
        understanding: Understanding,
        knowledge: &Knowledge,
        reactions: &mut Vec<Reaction>,
    ) {
        self.memory.asked = None;
        match understanding {
            Understanding::Plan { steps, reply } => {
                self.say(turn, DialogKind::Reply, LineKind::Say, &reply, reactions);
                let (steps, missing) = to_where_it_was(steps, knowledge);
                self.plan(number, Plan { missing, ..Plan::new(turn, steps) }, reactions);
            }
            Understanding::Question { kind, text, candidates, options, .. } => {
                let asked = Asked { kind, candidates: candidates.clone() };
                self.note_line(true, &text);
                let mut line = Line::new(Speaker::Robot, LineKind::Question, turn, text);
                line.answers = asked.answers(options);
                self.memory.asked = Some(asked);
                reactions.extend(self.message(&line).map(|message| Reaction::Bus(Box::new(message))));
                reactions.push(Reaction::Chat(line));
                self.point_out(turn, number, &candidates, knowledge, TurnEnd::Asked, reactions);
            }
            Understanding::Answer { text, highlight, .. } => {
                self.say(turn, DialogKind::Reply, LineKind::Say, &text, reactions);
                self.point_out(turn, number, &highlight, knowledge, TurnEnd::Answered, reactions);
            }
            Understanding::Refusal { text, .. } => {
                self.say(turn, DialogKind::Reply, LineKind::Problem, &text, reactions);
                reactions.push(Reaction::TurnEnded { turn, end: TurnEnd::Refused });
            }
            Understanding::Stop { reply, then } => self.stop(turn, number, reply, then, knowledge, reactions),
        }
    }

    /// Stops, and says and does what else was asked for.
    fn stop(
        &mut self,
        turn: u64,
        number: u64,
        reply: String,
        then: Option<Box<Understanding>>,
        knowledge: &Knowledge,
        reactions: &mut Vec<Reaction>,
    ) {
        let stop = Step { action: Action::Stop, says: String::new() };
        match then.map(|then| *then) {
            Some(Understanding::Plan { mut steps, reply: does }) => {
                steps.insert(0, stop);
                let reply = format!("{reply} {does}");
                self.react(turn, number, Understanding::Plan { steps, reply }, knowledge, reactions);
            }
            Some(then) => {
                self.say(turn, DialogKind::Reply, LineKind::Say, &reply, reactions);
                // The turn ends with what is said next, so nobody waits for the end of this plan.
                reactions.push(Reaction::Bus(Box::new(self.plan_message(number, &[stop]))));
                self.memory.turns = self.memory.turns.max(number) + 1;
                self.react(turn, self.memory.turns, then, knowledge, reactions);
            }
            None => {
                self.say(turn, DialogKind::Reply, LineKind::Say, &reply, reactions);
                self.plan(number, Plan::new(turn, vec![stop]), reactions);
            }
        }
    }

    /// The agent told something about a plan.
    pub fn follow(&mut self, header: &DialogHeader, knowledge: &mut Knowledge) -> Vec<Reaction> {
        let mut reactions = Vec::new();
        let number = header.turn;
        let (Some(kind), Some(plan)) = (header.kind(), self.memory.plans.get_mut(&number)) else { return reactions };
        let turn = plan.turn;
        let count = plan.steps.len();
        let step = plan.steps.get(header.step as usize).cloned();
        match kind {
            DialogKind::StepStarted => {
                if let Some(step) = step.filter(|step| !step.says.is_empty()) {
                    reactions.push(Reaction::Page(page::progress(self.body, turn, header.step, count, &step.says)));
                }
            }
            DialogKind::StepEnded => {
                let (Some(step), Some(status)) = (step, header.status()) else { return reactions };
                self.memory.context.note_outcome(&step, status);
                let whole = status.is_success() && header.step as usize + 1 == count;
                let failed = status.is_failure();
                let is_worth_telling = (whole && worth_telling(&step)) || failed;
                let is_worth_telling =
                    is_worth_telling && plan.missing.is_none() && !self.memory.context.is_searching();
                if is_worth_telling && !plan.told_end {
                    plan.told_end = true;
                    if let Some(known) = knowledge.known() {
                        let text = self.language.report(&step, status, header.text.as_str(), &known);
                        let line = if failed { LineKind::Problem } else { LineKind::Say };
                        self.say(turn, DialogKind::Reply, line, &text, &mut reactions);
                    }
                }
            }
            DialogKind::PlanEnded => {
                let (told, missing) = (plan.told_end, plan.missing);
                self.memory.plans.remove(&number);
                let status = header.status().unwrap_or(Status::ActionExecutionError);
                if status.is_success() && missing.is_some_and(|id| self.miss(turn, id, knowledge, &mut reactions)) {
                    return reactions;
                }
                if goes_on(status) && self.carry_on(turn, knowledge, &mut reactions) {
                    return reactions;
                }
                if !told && status.is_failure() {
                    self.say(turn, DialogKind::Reply, LineKind::Problem, "That did not work.", &mut reactions);
                }
                let end = match status {
                    Status::Interrupted => TurnEnd::Interrupted,
                    status if status.is_success() => TurnEnd::Done,
                    _ => TurnEnd::Failed,
                };
                reactions.push(Reaction::TurnEnded { turn, end });
            }
            _ => {}
        }
        reactions
    }

    /// Goes on with a search after one of its plans; tells whether there was more to do.
    fn carry_on(&mut self, turn: u64, knowledge: &Knowledge, reactions: &mut Vec<Reaction>) -> bool {
        if !self.memory.context.awaits_more() {
            return false;
        }
        let Some(known) = knowledge.known() else { return false };
        let Some(understanding) = self.language.carry_on(&known, &mut self.memory.context) else { return false };
        self.memory.turns += 1;
        self.react(turn, self.memory.turns, understanding, knowledge, reactions);
        true
    }

    /// Whether something was put off that [`Self::wake`] goes on with.
    #[must_use]
    pub const fn awaits(&self) -> bool {
        self.memory.context.awaits()
    }

    /// Goes on with what was put off, once its time has come, s, or what it waits for is so.
    pub fn wake(&mut self, now_s: f64, knowledge: &Knowledge) -> Vec<Reaction> {
        let mut reactions = Vec::new();
        let Some(known) = knowledge.known().filter(|_| self.awaits()) else { return reactions };
        if let Some(understanding) = self.language.wake(now_s, &known, &mut self.memory.context) {
            let turn = self.memory.turns;
            self.memory.turns += 1;
            self.react(turn, self.memory.turns, understanding, knowledge, &mut reactions);
        }
        reactions
    }

    /// Says that a thing is not where it was, and forgets that it is there; asks whether to look for it.
    fn miss(&mut self, turn: u64, id: ObjectId, knowledge: &mut Knowledge, reactions: &mut Vec<Reaction>) -> bool {
        let Some(known) = knowledge.known() else { return false };
        let question = self.language.report_missing(id, &known, &mut self.memory.context);
        knowledge.forget(id);
        self.react(turn, turn, question, knowledge, reactions);
        true
    }

    fn plan(&mut self, number: u64, plan: Plan, reactions: &mut Vec<Reaction>) {
        reactions.push(Reaction::Bus(Box::new(self.plan_message(number, &plan.steps))));
        self.memory.plans.insert(number, plan);
        while self.memory.plans.len() > MOST_PLANS {
            self.memory.plans.pop_first();
        }
    }

    fn plan_message(&self, turn: u64, steps: &[Step]) -> DialogMessage {
        let mut message = DialogMessage::new(DialogKind::Plan, self.body, turn, "");
        message.steps =
            steps.iter().map(|step| PlanStep { action: step.action.into(), says: Text::new(&step.says) }).collect();
        message
    }

    /// Has objects outlined, one after the other, without anything being said about it; the robot turns to those behind it
    /// and back.
    fn point_out(
        &mut self,
        turn: u64,
        number: u64,
        objects: &[ObjectId],
        knowledge: &Knowledge,
        end: TurnEnd,
        reactions: &mut Vec<Reaction>,
    ) {
        let shown = &objects[..objects.len().min(MOST_SHOWN)];
        if shown.is_empty() {
            reactions.push(Reaction::TurnEnded { turn, end });
            return;
        }
        let known = knowledge.known();
        let silently = |action| Step { action, says: String::new() };
        let mut steps = Vec::new();
        let mut turned_rad = 0.0;
        for object in shown {
            if let Some(bearing) = known.as_ref().and_then(|known| known.bearing_in_room_rad(*object)) {
                let turn_rad = within_half_turn(bearing - turned_rad);
                if turn_rad.abs() > HALF_VIEW_RAD {
                    steps.push(silently(Action::Rotate { yaw_rad: turn_rad }));
                    turned_rad += turn_rad;
                }
            }
            steps.push(silently(Action::Highlight { object: *object }));
        }
        let back_rad = within_half_turn(-turned_rad);
        if back_rad.abs() > f32::EPSILON {
            steps.push(silently(Action::Rotate { yaw_rad: back_rad }));
        }
        self.plan(number, Plan::new(turn, steps), reactions);
    }

    fn say(&mut self, turn: u64, kind: DialogKind, line: LineKind, text: &str, reactions: &mut Vec<Reaction>) {
        if !text.is_empty() {
            self.note_line(true, text);
            reactions.push(self.bus(kind, turn, text));
            reactions.push(Reaction::Chat(Line::new(Speaker::Robot, line, turn, text)));
        }
    }

    fn bus(&self, kind: DialogKind, turn: u64, text: &str) -> Reaction {
        Reaction::Bus(Box::new(DialogMessage::new(kind, self.body, turn, text)))
    }
}

/// Whether both come to the same: the same actions, or the same answer.
fn is_same(one: &Understanding, other: &Understanding) -> bool {
    match (one, other) {
        (Understanding::Plan { steps: one, .. }, Understanding::Plan { steps: other, .. }) => {
            one.iter().map(|step| &step.action).eq(other.iter().map(|step| &step.action))
        }
        (one, other) => one == other,
    }
}

/// The steps up to the first whose object is not where the robot believes it to be; then to that place, where it finds
/// that out. The world knows where things are, and would lead it there.
fn to_where_it_was(mut steps: Vec<Step>, knowledge: &Knowledge) -> (Vec<Step>, Option<ObjectId>) {
    let believed = |step: &Step| knowledge.mistaken_place(&step.action);
    let Some((at, (id, place))) = steps.iter().enumerate().find_map(|(at, step)| Some((at, believed(step)?))) else {
        return (steps, None);
    };
    let says = steps[at].says.clone();
    steps.truncate(at);
    steps.push(Step { action: Action::GoTo { target: GoToTarget::Point(place) }, says });
    (steps, Some(id))
}

/// What was heard, to be quoted.
fn plainly(heard: &str) -> &str {
    heard.trim().trim_end_matches(['.', '!', ','])
}

/// Whether a plan that ended so may be followed by more.
const fn goes_on(status: Status) -> bool {
    !matches!(status, Status::Interrupted | Status::KilledByHazard)
}

/// Whether the end of a plan whose last step is this is told; that it stopped or pointed was told before.
fn worth_telling(step: &Step) -> bool {
    !matches!(step.action, Action::Stop | Action::Highlight { .. }) && !step.says.is_empty()
}

/// What is said of what was heard and not understood.
fn heard(raw: &str, text: &str) -> String {
    format!("I heard \"{}\". {text}", plainly(raw))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::sync::Arc;

    use cohabit_bus::message::{BodyRecord, NONE, StateParts, StateView};
    use cohabit_cdf::{BodyId, Catalog, Layout, RoomId};
    use cohabit_language::Knows;
    use cohabit_speech::Recognition;

    use super::*;

    /// What a robot knows that stands in an empty break room.
    fn knowledge() -> Knowledge {
        let (catalog, layout) = (Arc::new(Catalog::builtin()), Layout::builtin("OfficeLayout1").unwrap());
        let room = RoomId::ALL.iter().position(|room| *room == RoomId::BreakRoom).unwrap() as u32;
        let body = BodyRecord { room, held: NONE, position_m: [4.0, 10.0, 0.0], ..BodyRecord::default() };
        let parts = StateParts { bodies: vec![body], ..StateParts::default() };
        let mut bytes = vec![0_u64; parts.bytes().div_ceil(8)];
        let bytes = &mut bytemuck::cast_slice_mut(&mut bytes)[..parts.bytes()];
        parts.write(bytes);
        let mut knowledge = Knowledge::new(Knows::Everything, catalog, &layout, BodyId(0));
        knowledge.look(StateView::new(bytes).unwrap(), 1);
        knowledge
    }

    fn conversation() -> Conversation {
        Conversation::new(Language::new(Arc::new(Catalog::builtin())), 0)
    }

    fn says(reactions: &[Reaction]) -> String {
        let lines = reactions.iter().filter_map(Reaction::line).filter(|line| line.from == Speaker::Robot);
        lines.map(|line| line.text.clone()).collect::<Vec<_>>().join(" ")
    }

    fn plans(reactions: &[Reaction]) -> bool {
        let is_plan = |reaction: &Reaction| matches!(reaction, Reaction::Bus(message) if message.header.kind() == Some(DialogKind::Plan));
        reactions.iter().any(is_plan)
    }

    const DOUBTED: Aloud<'_> = Aloud { raw: "go to the main office", is_doubtful: true };

    #[test]
    fn what_is_doubted_is_asked_about_and_a_yes_means_it() {
        let (mut conversation, knowledge) = (conversation(), knowledge());
        let said = "go to the main office";
        let (_, reactions) = conversation.hear_aloud(said, said, DOUBTED, &knowledge);
        assert!(!plans(&reactions));
        assert!(says(&reactions).contains("\"go to the main office\". Shall I do that?"), "{}", says(&reactions));
        let question =
            reactions.iter().filter_map(Reaction::line).find(|line| line.kind == LineKind::Question).unwrap();
        assert_eq!(question.answers.iter().map(|answer| answer.text.as_str()).collect::<Vec<_>>(), ["yes", "no"]);
        // A yes that is heard makes sense, though no question of the language's waits for it.
        let yes = Spoken { heard: Recognition::trusted("yes", 0.3), ..Spoken::default() };
        let reading = conversation.reading(&yes, &str::to_owned, &knowledge).unwrap();
        assert!(!reading.is_doubtful);
        let (_, reactions) = conversation.hear("yes", &knowledge);
        assert!(plans(&reactions), "{}", says(&reactions));
    }

    #[test]
    fn what_was_not_said_is_not_done() {
        let (mut conversation, knowledge) = (conversation(), knowledge());
        let said = "go to the main office";
        conversation.hear_aloud(said, said, DOUBTED, &knowledge);
        let (_, reactions) = conversation.hear("no", &knowledge);
        assert!(!plans(&reactions) && says(&reactions).contains("once more"), "{}", says(&reactions));
        // Nor later.
        let (_, reactions) = conversation.hear("yes", &knowledge);
        assert!(!plans(&reactions), "{}", says(&reactions));
        // Something else is what it is.
        conversation.hear_aloud(said, said, DOUBTED, &knowledge);
        let (_, reactions) = conversation.hear("go to the reception", &knowledge);
        assert!(plans(&reactions) && says(&reactions).contains("reception"), "{}", says(&reactions));
    }

    #[test]
    fn a_stop_is_carried_out_before_what_else_was_said() {
        let (mut conversation, knowledge) = (conversation(), knowledge());
        let actions = |reactions: &[Reaction]| -> Vec<Vec<Action>> {
            let messages = reactions.iter().filter_map(|reaction| match reaction {
                Reaction::Bus(message) if message.header.kind() == Some(DialogKind::Plan) => Some(message),
                _ => None,
            });
            messages
                .map(|message| message.steps.iter().map(|step| Action::try_from(step.action).unwrap()).collect())
                .collect()
        };
        conversation.hear("go to the main office", &knowledge);
        let (_, reactions) = conversation.hear("Arre stop stop, go to the reception", &knowledge);
        let [steps] = &actions(&reactions)[..] else { panic!("one plan: {reactions:?}") };
        assert!(matches!(steps[..], [Action::Stop, Action::GoTo { .. }]), "{steps:?}");
        assert!(says(&reactions).starts_with("OK, I stop. OK, going to the reception"), "{}", says(&reactions));
        // What asks for no motion does not keep it from stopping.
        conversation.hear("go to the main office", &knowledge);
        let (_, reactions) = conversation.hear("stop! what are you holding?", &knowledge);
        assert_eq!(actions(&reactions), [[Action::Stop]]);
        assert_eq!(says(&reactions), "OK, I stop. My hand is empty.");
        let ends = reactions.iter().filter(|reaction| matches!(reaction, Reaction::TurnEnded { .. })).count();
        assert_eq!(ends, 1);
    }

    #[test]
    fn what_is_put_off_is_done_when_its_time_has_come() {
        let (mut conversation, knowledge) = (conversation(), knowledge());
        let (_, reactions) = conversation.hear("wait 10 seconds, then go to the main office", &knowledge);
        assert!(!plans(&reactions) && conversation.awaits(), "{}", says(&reactions));
        assert!(conversation.wake(100.0, &knowledge).is_empty() && conversation.wake(109.9, &knowledge).is_empty());
        let reactions = conversation.wake(110.0, &knowledge);
        assert!(plans(&reactions) && !conversation.awaits());
        assert_eq!(says(&reactions), "10 seconds are over. OK, going to the main office.");
        assert!(conversation.wake(500.0, &knowledge).is_empty());
    }

    #[test]
    fn what_is_not_known_is_repeated_as_it_was_heard() {
        let (mut conversation, knowledge) = (conversation(), knowledge());
        let aloud = Aloud { raw: "Blorp the zargle.", is_doubtful: false };
        let (_, reactions) = conversation.hear_aloud("blorp the zargle", "blorp the zargle", aloud, &knowledge);
        assert!(says(&reactions).starts_with("I heard \"Blorp the zargle\". "), "{}", says(&reactions));
        let (_, reactions) = conversation.hear("blorp the zargle", &knowledge);
        assert!(!says(&reactions).contains("I heard"), "who types knows what they typed");
    }
}
