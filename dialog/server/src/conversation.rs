//! The conversation with one robot: from what people say to plans, and from what comes of them to what it says.
//!
//! Pure: the newest knowledge comes in with every call, and what is to be sent comes out.

mod alone;
mod face;
mod following;
mod hearing;
mod held;
mod insight;
mod interception;
mod manner;
mod outbox;

use std::collections::{BTreeMap, VecDeque};

use cohabit_bus::message::{DialogHeader, DialogKind, DialogMessage};
use cohabit_cdf::{Action, GoToTarget, ObjectId, Status};
use cohabit_language::{Clarification, Consulting, Context, Language, Step, Understanding, within_half_turn};
use serde::{Deserialize, Serialize};

use crate::{
    expression::FacialExpression,
    known::Knowledge,
    page::{Answer, Line, LineKind, Speaker},
    wizard::Holding,
};
pub(crate) use hearing::{Aloud, Thought};
use hearing::{Puzzle, Words};
use held::Held;
pub use insight::Insight;
pub use manner::{Manner, Politeness, Verbosity};
pub(crate) use outbox::line_message;
pub use outbox::{Outgoing, TurnEnd};

/// A conversation with the robot of one body.
pub struct Conversation {
    language: Language,
    body: u32,
    memory: Memory,
    /// When an interpreter is asked.
    consulting: Consulting,
    /// What is held back.
    holding: Holding,
    /// How it words what it says.
    manner: Manner,
    /// Whether its mind acts on its own, whatever it is told.
    is_alone: bool,
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
    /// Whether a wizard ordered it: people are told nothing of it.
    #[serde(default)]
    is_silent: bool,
    /// Whether its turn was over before it: nothing more is told of it.
    #[serde(default)]
    is_after_turn: bool,
}

impl Plan {
    fn new(turn: u64, steps: Vec<Step>) -> Self {
        Self { turn, steps, told_end: false, missing: None, is_silent: false, is_after_turn: false }
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
    /// What was understood and is not answered yet.
    held: Option<Box<Held>>,
    /// What was said since, and is not understood yet.
    waiting: VecDeque<Words>,
    /// Since when nothing is held back that was before, and no interpreter is asked, ns of the monotonic clock.
    free_since_nanos: u64,
    /// What its face shows.
    expression: FacialExpression,
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
        Self {
            language,
            body,
            memory: Memory::default(),
            consulting: Consulting::Never,
            holding: Holding::default(),
            manner: Manner::default(),
            is_alone: false,
        }
    }

    /// The same, with an interpreter that is asked at these times: [`Outgoing::Interpret`] asks it.
    pub(crate) fn consulting(self, consulting: Consulting) -> Self {
        Self { consulting, ..self }
    }

    /// The same, with answers held back so.
    pub(crate) fn holding(self, holding: Holding) -> Self {
        Self { holding, ..self }
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
    pub fn count_from(&mut self, turns: u64) {
        self.memory.turns = self.memory.turns.max(turns);
    }

    /// What it must know to go on where it is.
    pub const fn memory(&self) -> &Memory {
        &self.memory
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
        Some(outbox::plan_message(*turn, &plan.steps, self.body))
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

    fn note_line(&mut self, is_robot: bool, text: &str) {
        if is_robot {
            self.memory.context.note_said(true, text);
        }
        self.memory.said.push_back((is_robot, text.to_owned()));
        while self.memory.said.len() > LINES_BEFORE {
            self.memory.said.pop_front();
        }
    }

    /// Says and does what was understood in `turn`; what is to be done is the plan of that number.
    fn react(
        &mut self,
        turn: u64,
        number: u64,
        understanding: Understanding,
        knowledge: &Knowledge,
        outbox: &mut Vec<Outgoing>,
    ) {
        self.memory.asked = None;
        self.express(turn, face::shown_with(&understanding), outbox);
        match self.manner.worded(understanding) {
            Understanding::Plan { steps, reply } => {
                self.say(turn, LineKind::Say, &reply, outbox);
                let (steps, missing) = to_where_it_was(steps, knowledge);
                self.plan(number, Plan { missing, ..Plan::new(turn, steps) }, outbox);
            }
            Understanding::Question { kind, text, candidates, options, .. } => {
                let asked = Asked { kind, candidates: candidates.clone() };
                self.note_line(true, &text);
                let mut line = Line::new(Speaker::Robot, LineKind::Question, turn, text);
                line.answers = asked.answers(options);
                self.memory.asked = Some(asked);
                outbox.push(Outgoing::Ask(line));
                self.point_out(turn, number, &candidates, knowledge, TurnEnd::Asked, outbox);
            }
            Understanding::Answer { text, highlight, .. } => {
                self.say(turn, LineKind::Say, &text, outbox);
                // To point is a plan of its own, which would end what the robot is at.
                let shown: &[ObjectId] = if self.is_at_work() { &[] } else { &highlight };
                self.point_out(turn, number, shown, knowledge, TurnEnd::Answered, outbox);
            }
            Understanding::Refusal { text, .. } => {
                self.say(turn, LineKind::Problem, &text, outbox);
                outbox.push(Outgoing::TurnEnded { turn, end: TurnEnd::Refused });
            }
            Understanding::Stop { reply, then } => self.stop(turn, number, reply, then, knowledge, outbox),
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
        outbox: &mut Vec<Outgoing>,
    ) {
        let stop = Step { action: Action::Stop, says: String::new() };
        match then.map(|then| *then) {
            Some(Understanding::Plan { mut steps, reply: does }) => {
                steps.insert(0, stop);
                let reply = format!("{reply} {does}");
                self.react(turn, number, Understanding::Plan { steps, reply }, knowledge, outbox);
            }
            Some(then) => {
                self.say(turn, LineKind::Say, &reply, outbox);
                // The turn ends with what is said next, so nobody waits for the end of this plan.
                outbox.push(Outgoing::Plan { number, steps: vec![stop] });
                self.memory.turns = self.memory.turns.max(number) + 1;
                self.react(turn, self.memory.turns, then, knowledge, outbox);
            }
            None => {
                self.say(turn, LineKind::Say, &reply, outbox);
                self.plan(number, Plan::new(turn, vec![stop]), outbox);
            }
        }
    }

    /// Whether something was put off that [`Self::wake`] goes on with.
    #[must_use]
    pub const fn awaits(&self) -> bool {
        // Of what was put off before its mind was another, nothing comes.
        !self.is_alone && self.memory.context.awaits()
    }

    /// Goes on with what was put off, once its time has come, s, or what it waits for is so.
    pub fn wake(&mut self, now_s: f64, knowledge: &Knowledge) -> Vec<Outgoing> {
        let mut outbox = Vec::new();
        let Some(known) = knowledge.known().filter(|_| self.awaits()) else { return outbox };
        if let Some(understanding) = self.language.wake(now_s, &known, &mut self.memory.context) {
            let turn = self.memory.turns;
            self.memory.turns += 1;
            self.react(turn, self.memory.turns, understanding, knowledge, &mut outbox);
            self.propose_again(knowledge, &mut outbox);
        }
        outbox
    }

    fn plan(&mut self, number: u64, plan: Plan, outbox: &mut Vec<Outgoing>) {
        outbox.push(Outgoing::Plan { number, steps: plan.steps.clone() });
        self.memory.plans.insert(number, plan);
        while self.memory.plans.len() > MOST_PLANS {
            self.memory.plans.pop_first();
        }
    }

    /// Whether a plan is under way that does more than stop or point.
    fn is_at_work(&self) -> bool {
        self.memory.plans.values().any(|plan| plan.steps.iter().any(|step| !step.says.is_empty()))
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
        outbox: &mut Vec<Outgoing>,
    ) {
        // Who acts on its own outlines nothing for people.
        let most = if self.is_alone { 0 } else { MOST_SHOWN };
        let shown = &objects[..objects.len().min(most)];
        if shown.is_empty() {
            outbox.push(Outgoing::TurnEnded { turn, end });
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
        self.plan(number, Plan::new(turn, steps), outbox);
    }

    fn say(&mut self, turn: u64, kind: LineKind, text: &str, outbox: &mut Vec<Outgoing>) {
        if !text.is_empty() {
            self.note_line(true, text);
            outbox.push(Outgoing::Say(Line::new(Speaker::Robot, kind, turn, text)));
        }
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

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
