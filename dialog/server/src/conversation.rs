//! The conversation with one robot: from what people say to plans, and from what comes of them to what it says.
//!
//! Pure: the newest knowledge comes in with every call, and what is to be sent comes out.

use std::{collections::BTreeMap, sync::Arc};

use cohabit_bus::{
    Text,
    message::{DialogHeader, DialogKind, DialogMessage, PlanStep},
};
use cohabit_cdf::{Action, Catalog, ObjectId, Status};
use cohabit_language::{Context, Known, Language, Step, Understanding};
use serde_json::Value;

use crate::page::{self, Line, LineKind, Speaker};

/// What the conversation wants done.
#[derive(Clone, Debug, PartialEq)]
pub enum Reaction {
    /// To the bus.
    Bus(Box<DialogMessage>),
    /// To the chat of all pages.
    Chat(Line),
    /// To all pages, not kept.
    Page(Value),
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
    context: Context,
    body: u32,
    turns: u64,
    plans: BTreeMap<u64, Plan>,
}

struct Plan {
    steps: Vec<Step>,
    told_end: bool,
}

impl Conversation {
    /// A conversation in which nothing was said yet.
    pub fn new(catalog: Arc<Catalog>, body: u32) -> Self {
        let language = Language::new(catalog);
        Self { language, context: Context::default(), body, turns: 0, plans: BTreeMap::new() }
    }

    /// Somebody said something. Gives the turn's number and what follows.
    pub fn hear(&mut self, text: &str, known: Option<&Known>) -> (u64, Vec<Reaction>) {
        self.turns += 1;
        let turn = self.turns;
        let mut reactions = vec![
            self.bus(DialogKind::Utterance, turn, text),
            Reaction::Chat(Line::new(Speaker::Person, LineKind::Say, turn, text)),
        ];
        let Some(known) = known else {
            self.say(turn, DialogKind::Reply, LineKind::Problem, "I am not there yet; one moment.", &mut reactions);
            reactions.push(Reaction::TurnEnded { turn, end: TurnEnd::Refused });
            return (turn, reactions);
        };
        match self.language.understand(text, known, &mut self.context) {
            Understanding::Plan { steps, reply } => {
                self.say(turn, DialogKind::Reply, LineKind::Say, &reply, &mut reactions);
                self.plan(turn, steps, &mut reactions);
            }
            Understanding::Question { text, candidates } => {
                self.say(turn, DialogKind::Question, LineKind::Question, &text, &mut reactions);
                self.point_out(turn, &candidates, TurnEnd::Asked, &mut reactions);
            }
            Understanding::Answer { text, highlight } => {
                self.say(turn, DialogKind::Reply, LineKind::Say, &text, &mut reactions);
                self.point_out(turn, &highlight, TurnEnd::Answered, &mut reactions);
            }
            Understanding::Refusal { text } => {
                self.say(turn, DialogKind::Reply, LineKind::Problem, &text, &mut reactions);
                reactions.push(Reaction::TurnEnded { turn, end: TurnEnd::Refused });
            }
            Understanding::Stop { reply } => {
                self.say(turn, DialogKind::Reply, LineKind::Say, &reply, &mut reactions);
                let stop = Step { action: Action::Stop, says: String::new() };
                self.plan(turn, vec![stop], &mut reactions);
            }
        }
        (turn, reactions)
    }

    /// The agent told something about a plan. What the robot knows is asked for only where it is spoken of.
    pub fn follow(&mut self, header: &DialogHeader, known: impl FnOnce() -> Option<Known>) -> Vec<Reaction> {
        let mut reactions = Vec::new();
        let turn = header.turn;
        let (Some(kind), Some(plan)) = (header.kind(), self.plans.get_mut(&turn)) else { return reactions };
        let count = plan.steps.len();
        let step = plan.steps.get(header.step as usize).cloned();
        match kind {
            DialogKind::StepStarted => {
                if let Some(step) = step.filter(|step| !step.says.is_empty()) {
                    reactions.push(Reaction::Page(page::progress(turn, header.step, count, &step.says)));
                }
            }
            DialogKind::StepEnded => {
                let (Some(step), Some(status)) = (step, header.status()) else { return reactions };
                self.context.note_outcome(&step, status);
                let whole = status.is_success() && header.step as usize + 1 == count;
                let failed = status.is_failure();
                if (whole && worth_telling(step.action)) || failed {
                    plan.told_end = true;
                    if let Some(known) = known() {
                        let text = self.language.report(&step, status, header.text.as_str(), &known);
                        let line = if failed { LineKind::Problem } else { LineKind::Say };
                        self.say(turn, DialogKind::Reply, line, &text, &mut reactions);
                    }
                }
            }
            DialogKind::PlanEnded => {
                let told = plan.told_end;
                self.plans.remove(&turn);
                let status = header.status().unwrap_or(Status::ActionExecutionError);
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

    fn plan(&mut self, turn: u64, steps: Vec<Step>, reactions: &mut Vec<Reaction>) {
        let mut message = DialogMessage::new(DialogKind::Plan, self.body, turn, "");
        message.steps =
            steps.iter().map(|step| PlanStep { action: step.action.into(), says: Text::new(&step.says) }).collect();
        reactions.push(Reaction::Bus(Box::new(message)));
        self.plans.insert(turn, Plan { steps, told_end: false });
    }

    /// Has objects outlined, one after the other, without anything being said about it.
    fn point_out(&mut self, turn: u64, objects: &[ObjectId], end: TurnEnd, reactions: &mut Vec<Reaction>) {
        if objects.is_empty() {
            reactions.push(Reaction::TurnEnded { turn, end });
            return;
        }
        let point = |object: &ObjectId| Step { action: Action::Highlight { object: *object }, says: String::new() };
        self.plan(turn, objects.iter().map(point).collect(), reactions);
    }

    fn say(&self, turn: u64, kind: DialogKind, line: LineKind, text: &str, reactions: &mut Vec<Reaction>) {
        if !text.is_empty() {
            reactions.push(self.bus(kind, turn, text));
            reactions.push(Reaction::Chat(Line::new(Speaker::Robot, line, turn, text)));
        }
    }

    fn bus(&self, kind: DialogKind, turn: u64, text: &str) -> Reaction {
        Reaction::Bus(Box::new(DialogMessage::new(kind, self.body, turn, text)))
    }
}

/// Whether the end of a plan whose last step is this is told; that it stopped or pointed was told before.
const fn worth_telling(action: Action) -> bool {
    !matches!(action, Action::Stop | Action::Highlight { .. })
}
