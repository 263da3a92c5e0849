//! What the robot says and does as its plans go on and end.

use cohabit_bus::message::{DialogHeader, DialogKind};
use cohabit_cdf::{Action, ObjectId, Status};
use cohabit_language::{Step, Understanding};

use super::{Conversation, Outgoing, Plan, TurnEnd};
use crate::{expression::FacialExpression, known::Knowledge, page::LineKind};

impl Conversation {
    /// The agent told something about a plan.
    pub fn follow(&mut self, header: &DialogHeader, knowledge: &mut Knowledge) -> Vec<Outgoing> {
        let is_silent = self.is_silent(header.turn);
        let mut outbox = self.follow_plan(header, knowledge);
        if is_silent {
            outbox = self.unsaid(header.turn, outbox);
        }
        if matches!(header.kind(), Some(DialogKind::StepEnded | DialogKind::PlanEnded)) {
            self.propose_again(knowledge, &mut outbox);
        }
        outbox
    }

    fn follow_plan(&mut self, header: &DialogHeader, knowledge: &mut Knowledge) -> Vec<Outgoing> {
        let mut outbox = Vec::new();
        match header.kind() {
            Some(DialogKind::StepStarted) => self.step_started(header, &mut outbox),
            Some(DialogKind::StepEnded) => self.step_ended(header, knowledge, &mut outbox),
            Some(DialogKind::PlanEnded) => self.plan_ended(header, knowledge, &mut outbox),
            _ => {}
        }
        outbox
    }

    fn step_started(&self, header: &DialogHeader, outbox: &mut Vec<Outgoing>) {
        let Some(plan) = self.memory.plans.get(&header.turn).filter(|plan| !plan.is_after_turn) else { return };
        let Some(step) = plan.steps.get(header.step as usize).filter(|step| !step.says.is_empty()) else { return };
        let (turn, steps, says) = (plan.turn, plan.steps.len(), step.says.clone());
        outbox.push(Outgoing::Progress { turn, step: header.step, steps, says });
    }

    fn step_ended(&mut self, header: &DialogHeader, knowledge: &Knowledge, outbox: &mut Vec<Outgoing>) {
        let Some(plan) = self.memory.plans.get_mut(&header.turn) else { return };
        let step = plan.steps.get(header.step as usize).cloned();
        let (Some(step), Some(status)) = (step, header.status()) else { return };
        if plan.is_after_turn && !status.is_success() {
            return;
        }
        self.memory.context.note_outcome(&step, status);
        let whole = status.is_success() && header.step as usize + 1 == plan.steps.len();
        let failed = status.is_failure();
        let is_worth_telling = (whole && worth_telling(&step)) || failed;
        let is_expected = plan.missing.is_some() || plan.told_end || self.memory.context.is_searching();
        if !is_worth_telling || is_expected {
            return;
        }
        plan.told_end = true;
        let turn = plan.turn;
        let (language, context) = (&self.language, &self.memory.context);
        let is_news = |known: &_| failed || language.is_worth_telling(&step, known, context);
        if let Some(known) = knowledge.known().filter(is_news) {
            let text = self.language.report(&step, status, header.text.as_str(), &known);
            let line = if failed { LineKind::Problem } else { LineKind::Say };
            self.say(turn, line, &text, outbox);
        }
    }

    fn plan_ended(&mut self, header: &DialogHeader, knowledge: &mut Knowledge, outbox: &mut Vec<Outgoing>) {
        let Some(Plan { turn, told_end, missing, is_silent, is_after_turn, .. }) =
            self.memory.plans.remove(&header.turn)
        else {
            return;
        };
        if is_after_turn {
            return;
        }
        let status = header.status().unwrap_or(Status::ActionExecutionError);
        if status.is_success() && missing.is_some_and(|id| self.miss(turn, id, knowledge, outbox)) {
            return;
        }
        if goes_on(status) && self.carry_on(turn, knowledge, outbox) {
            return;
        }
        if !told_end && status.is_failure() {
            self.say(turn, LineKind::Problem, "That did not work.", outbox);
        }
        let end = match status {
            Status::Interrupted => TurnEnd::Interrupted,
            status if status.is_success() => TurnEnd::Done,
            _ => TurnEnd::Failed,
        };
        if end == TurnEnd::Failed && !is_silent {
            self.express(turn, FacialExpression::Sorry, outbox);
        }
        if end == TurnEnd::Failed && goes_on(status) {
            self.put_right(turn, is_silent, knowledge, outbox);
        }
        outbox.push(Outgoing::TurnEnded { turn, end });
    }

    /// Closes and turns off what a plan that failed left open or on, and would not have. Nobody waits for that.
    fn put_right(&mut self, turn: u64, is_silent: bool, knowledge: &Knowledge, outbox: &mut Vec<Outgoing>) {
        let right = knowledge.known().and_then(|known| self.language.put_right(&known, &self.memory.context));
        let Some(Understanding::Plan { steps, reply }) = right else { return };
        self.say(turn, LineKind::Say, &reply, outbox);
        self.memory.turns += 1;
        let plan = Plan { told_end: true, is_silent, is_after_turn: true, ..Plan::new(turn, steps) };
        self.plan(self.memory.turns, plan, outbox);
    }

    /// Goes on with a search after one of its plans; tells whether there was more to do.
    fn carry_on(&mut self, turn: u64, knowledge: &Knowledge, outbox: &mut Vec<Outgoing>) -> bool {
        if !self.memory.context.awaits_more() {
            return false;
        }
        let Some(known) = knowledge.known() else { return false };
        let Some(understanding) = self.language.carry_on(&known, &mut self.memory.context) else { return false };
        self.memory.turns += 1;
        self.react(turn, self.memory.turns, understanding, knowledge, outbox);
        true
    }

    /// Says that a thing is not where it was, and forgets that it is there; asks whether to look for it.
    fn miss(&mut self, turn: u64, id: ObjectId, knowledge: &mut Knowledge, outbox: &mut Vec<Outgoing>) -> bool {
        let Some(known) = knowledge.known() else { return false };
        let question = self.language.report_missing(id, &known, &mut self.memory.context);
        knowledge.forget(id);
        self.react(turn, turn, question, knowledge, outbox);
        true
    }
}

/// Whether a plan that ended so may be followed by more.
const fn goes_on(status: Status) -> bool {
    !matches!(status, Status::Interrupted | Status::KilledByHazard)
}

/// Whether the end of a plan whose last step is this is told; that it stopped or pointed was told before.
fn worth_telling(step: &Step) -> bool {
    !matches!(step.action, Action::Stop | Action::Highlight { .. }) && !step.says.is_empty()
}
