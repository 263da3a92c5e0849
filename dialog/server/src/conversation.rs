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
pub enum Send {
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
        status: &'static str,
    },
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
    pub fn hear(&mut self, text: &str, known: Option<&Known>) -> (u64, Vec<Send>) {
        self.turns += 1;
        let turn = self.turns;
        let mut sends = vec![
            self.bus(DialogKind::Utterance, turn, text),
            Send::Chat(Line::new(Speaker::Person, LineKind::Say, turn, text)),
        ];
        let Some(known) = known else {
            self.say(turn, DialogKind::Reply, LineKind::Problem, "I am not there yet; one moment.", &mut sends);
            sends.push(Send::TurnEnded { turn, status: "refused" });
            return (turn, sends);
        };
        match self.language.understand(text, known, &mut self.context) {
            Understanding::Plan { steps, reply } => {
                self.say(turn, DialogKind::Reply, LineKind::Say, &reply, &mut sends);
                self.plan(turn, steps, &mut sends);
            }
            Understanding::Question { text, candidates } => {
                self.say(turn, DialogKind::Question, LineKind::Question, &text, &mut sends);
                self.point_out(turn, &candidates, "asked", &mut sends);
            }
            Understanding::Answer { text, highlight } => {
                self.say(turn, DialogKind::Reply, LineKind::Say, &text, &mut sends);
                self.point_out(turn, &highlight, "answered", &mut sends);
            }
            Understanding::Refusal { text } => {
                self.say(turn, DialogKind::Reply, LineKind::Problem, &text, &mut sends);
                sends.push(Send::TurnEnded { turn, status: "refused" });
            }
            Understanding::Stop { reply } => {
                self.say(turn, DialogKind::Reply, LineKind::Say, &reply, &mut sends);
                let stop = Step { action: Action::Stop, says: String::new() };
                self.plan(turn, vec![stop], &mut sends);
            }
        }
        (turn, sends)
    }

    /// The agent told something about a plan.
    pub fn follow(&mut self, header: &DialogHeader, known: Option<&Known>) -> Vec<Send> {
        let mut sends = Vec::new();
        let turn = header.turn;
        let (Some(kind), Some(plan)) = (header.kind(), self.plans.get_mut(&turn)) else { return sends };
        let count = plan.steps.len();
        let step = plan.steps.get(header.step as usize).cloned();
        match kind {
            DialogKind::StepStarted => {
                if let Some(step) = step.filter(|step| !step.says.is_empty()) {
                    sends.push(Send::Page(page::progress(turn, header.step, count, &step.says)));
                }
            }
            DialogKind::StepEnded => {
                let (Some(step), Some(status)) = (step, header.status()) else { return sends };
                self.context.note_outcome(&step, status);
                let whole = status.is_success() && header.step as usize + 1 == count;
                let failed = !status.is_success() && status != Status::Interrupted;
                if (whole && worth_telling(step.action)) || failed {
                    plan.told_end = true;
                    if let Some(known) = known {
                        let text = self.language.report(&step, status, header.text.as_str(), known);
                        let line = if failed { LineKind::Problem } else { LineKind::Say };
                        self.say(turn, DialogKind::Reply, line, &text, &mut sends);
                    }
                }
            }
            DialogKind::PlanEnded => {
                let told = plan.told_end;
                self.plans.remove(&turn);
                let status = header.status().unwrap_or(Status::ActionExecutionError);
                if !told && !status.is_success() && status != Status::Interrupted {
                    self.say(turn, DialogKind::Reply, LineKind::Problem, "That did not work.", &mut sends);
                }
                let status = match status {
                    Status::Interrupted => "interrupted",
                    status if status.is_success() => "done",
                    _ => "failed",
                };
                sends.push(Send::TurnEnded { turn, status });
            }
            _ => {}
        }
        sends
    }

    fn plan(&mut self, turn: u64, steps: Vec<Step>, sends: &mut Vec<Send>) {
        let mut message = DialogMessage::new(DialogKind::Plan, self.body, turn, "");
        message.steps =
            steps.iter().map(|step| PlanStep { action: step.action.into(), says: Text::new(&step.says) }).collect();
        sends.push(Send::Bus(Box::new(message)));
        self.plans.insert(turn, Plan { steps, told_end: false });
    }

    /// Has objects outlined, one after the other, without anything being said about it.
    fn point_out(&mut self, turn: u64, objects: &[ObjectId], status: &'static str, sends: &mut Vec<Send>) {
        if objects.is_empty() {
            sends.push(Send::TurnEnded { turn, status });
            return;
        }
        let point = |object: &ObjectId| Step { action: Action::Highlight { object: *object }, says: String::new() };
        self.plan(turn, objects.iter().map(point).collect(), sends);
    }

    fn say(&self, turn: u64, kind: DialogKind, line: LineKind, text: &str, sends: &mut Vec<Send>) {
        if !text.is_empty() {
            sends.push(self.bus(kind, turn, text));
            sends.push(Send::Chat(Line::new(Speaker::Robot, line, turn, text)));
        }
    }

    fn bus(&self, kind: DialogKind, turn: u64, text: &str) -> Send {
        Send::Bus(Box::new(DialogMessage::new(kind, self.body, turn, text)))
    }
}

/// Whether the end of a plan whose last step is this is told; that it stopped or pointed was told before.
const fn worth_telling(action: Action) -> bool {
    !matches!(action, Action::Stop | Action::Highlight { .. })
}
