//! What wizards decide: of what is held back, and of their own accord.

use cohabit_cdf::Action;
use cohabit_language::{Asking, Context, Step, Understanding};
use cohabit_record::{DecisionOutcome, WizardDecision};
use serde::{Deserialize, Serialize};

use super::{Decided, Held};
use crate::{
    conversation::{Conversation, Outgoing, TurnEnd, alone::NOT_ORDERED},
    expression::FacialExpression,
    known::Knowledge,
    page::LineKind,
    text::in_one_line,
    wizard::{Click, Decision, LONGEST_SAYING},
};

/// What a wizard reads who decides what is over.
pub(super) const PAST: &str = "That is past: it was answered, or the person has said something else.";
pub(super) const CHANGED: &str = "The proposal has changed meanwhile: look again.";
const BLIND: &str = "The robot does not see anything yet.";

/// What a wizard has the robot say, do and show.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
#[serde(default)]
pub(super) struct Own {
    say: String,
    phrase: Option<char>,
    order: Option<Order>,
    expression: Option<FacialExpression>,
    /// The name of the planned error that this is.
    injected: Option<String>,
    chosen_ms: Option<f64>,
}

/// What a wizard wrote or clicked that can be carried out.
#[derive(Clone, Debug, Deserialize, Serialize)]
struct Order {
    text: String,
    steps: Vec<Step>,
    context: Context,
    #[serde(default)]
    click: Option<Click>,
}

impl Own {
    pub(super) fn is_nothing(&self) -> bool {
        self.say.is_empty() && self.order.is_none() && self.expression.is_none()
    }

    /// Whether it has the robot stop, and nothing else.
    fn only_stops(&self) -> bool {
        let stops = |order: &Order| matches!(order.steps[..], [Step { action: Action::Stop, .. }]);
        self.say.is_empty() && self.injected.is_none() && self.order.as_ref().is_some_and(stops)
    }

    pub(super) fn record(&self, outcome: DecisionOutcome) -> WizardDecision {
        let order = self.order.as_ref();
        let click = order.and_then(|order| order.click);
        WizardDecision {
            spoke: self.say.clone(),
            phrase: self.phrase,
            ordered: order.map(|order| order.text.clone()).unwrap_or_default(),
            clicked: click.map(|click| click.name().to_owned()),
            object: click.and_then(Click::object),
            expression: self.expression.map(|shown| shown.name().to_owned()),
            injected: self.injected.clone(),
            chosen_ms: self.chosen_ms,
            ..WizardDecision::of_outcome(outcome)
        }
    }
}

impl Conversation {
    /// A wizard decides.
    ///
    /// # Errors
    /// Why that cannot be, in words for the wizard.
    pub(crate) fn decide(
        &mut self,
        decision: Decision,
        now_nanos: u64,
        knowledge: &Knowledge,
    ) -> Result<Vec<Outgoing>, String> {
        match decision {
            Decision::Accept { turn, revision } => {
                let held = self.undecided(turn)?;
                if held.revision != revision {
                    return Err(CHANGED.to_owned());
                }
                held.decided = Some(Decided { at_nanos: now_nanos, own: None });
                Ok(self.decided(now_nanos, knowledge))
            }
            Decision::Edit { turn, text } => self.edit(turn, &text, knowledge),
            Decision::Own { turn, say, phrase, order } => {
                let own = self.own(&say, phrase, &order, knowledge)?;
                self.take_own(turn, own, now_nanos, knowledge)
            }
            Decision::Click { turn, click, chosen_ms } => {
                let own = self.clicked(click, chosen_ms, knowledge)?;
                self.take_own(turn, own, now_nanos, knowledge)
            }
            Decision::Inject { turn, error } => {
                let own = self.planned_error(turn, &error, knowledge)?;
                self.take_own(turn, own, now_nanos, knowledge)
            }
            Decision::Express { expression } => {
                self.act(Own { expression: Some(expression), ..Own::default() }, knowledge)
            }
        }
    }

    fn undecided(&mut self, turn: u64) -> Result<&mut Held, String> {
        let held = self.memory.held.as_deref_mut();
        held.filter(|held| held.words.turn == turn && held.decided.is_none()).ok_or_else(|| PAST.to_owned())
    }

    /// What follows from a decision, by now.
    fn decided(&mut self, now_nanos: u64, knowledge: &Knowledge) -> Vec<Outgoing> {
        let mut outbox = vec![Outgoing::Proposes];
        outbox.extend(self.elapse(now_nanos, knowledge));
        outbox
    }

    fn edit(&mut self, turn: u64, text: &str, knowledge: &Knowledge) -> Result<Vec<Outgoing>, String> {
        self.undecided(turn)?;
        let known = knowledge.known().ok_or(BLIND)?;
        let request = request(text)?;
        let meaning = self.requested(&request, &known);
        let held = self.undecided(turn)?;
        held.edits.push(request);
        held.revision += 1;
        held.meaning = meaning;
        Ok(vec![Outgoing::Proposes])
    }

    /// Takes what a wizard has the robot say and do in place of what it proposes in a turn, or of its own accord.
    fn take_own(
        &mut self,
        turn: Option<u64>,
        own: Own,
        now_nanos: u64,
        knowledge: &Knowledge,
    ) -> Result<Vec<Outgoing>, String> {
        let Some(turn) = turn else { return self.act(own, knowledge) };
        let only_stops = own.only_stops();
        self.undecided(turn)?.decided = Some(Decided { at_nanos: now_nanos, own: Some(own) });
        if !only_stops {
            return Ok(self.decided(now_nanos, knowledge));
        }
        // A stop waits for no delay, whoever gives it.
        let mut outbox = Vec::new();
        self.release(now_nanos, knowledge, &mut outbox);
        Ok(outbox)
    }

    /// What a wizard wrote or picked, as far as it can be said and done.
    fn own(&self, say: &str, phrase: Option<char>, order: &str, knowledge: &Knowledge) -> Result<Own, String> {
        let mut phrases = self.holding.wizard.iter().flat_map(|wizard| &wizard.phrases);
        let say = match phrase {
            Some(key) => {
                let known = phrases.find(|one| one.key == key);
                known.ok_or_else(|| format!("No phrase has the key {key}."))?.text.clone()
            }
            None => in_one_line(say.trim()),
        };
        if say.chars().count() > LONGEST_SAYING {
            return Err(format!("The robot says {LONGEST_SAYING} characters at most."));
        }
        let order = if order.trim().is_empty() { None } else { Some(self.order(&request(order)?, knowledge)?) };
        Ok(Own { say, phrase, order, ..Own::default() })
    }

    /// What a wizard's plain request comes to; nothing is asked about it.
    fn order(&self, text: &str, knowledge: &Knowledge) -> Result<Order, String> {
        self.takes_orders()?;
        let known = knowledge.known().ok_or(BLIND)?;
        let mut context = self.memory.context.clone();
        let understood = self.language.clone().asking(Asking::Never).understand(text, &known, &mut context);
        let stop = || Step { action: Action::Stop, says: String::new() };
        let steps = match understood {
            Understanding::Plan { steps, .. } => steps,
            Understanding::Stop { then: None, .. } => vec![stop()],
            other => return Err(format!("The robot would not do that: {}", other.reply())),
        };
        Ok(Order { text: text.to_owned(), steps, context, click: None })
    }

    /// Says so, if nothing comes of orders.
    fn takes_orders(&self) -> Result<(), String> {
        if self.is_alone { Err(NOT_ORDERED.to_owned()) } else { Ok(()) }
    }

    /// What a wizard clicked, as the robot does it.
    fn clicked(&self, click: Click, chosen_ms: Option<f64>, knowledge: &Knowledge) -> Result<Own, String> {
        self.takes_orders()?;
        let known = knowledge.known().ok_or(BLIND)?;
        let action = click.action(|object| known.bearing_in_room_rad(object))?;
        let step = self.language.step(action, &known);
        let (text, context) = (step.says.clone(), self.memory.context.clone());
        let order = Order { text, steps: vec![step], context, click: Some(click) };
        Ok(Own { order: Some(order), chosen_ms, ..Own::default() })
    }

    /// A planned error, as far as it can be made now.
    fn planned_error(&self, turn: Option<u64>, name: &str, knowledge: &Knowledge) -> Result<Own, String> {
        let mut errors = self.holding.wizard.iter().flat_map(|wizard| &wizard.errors);
        let planned = errors.find(|one| one.name == name);
        let planned = planned.ok_or_else(|| format!("No planned error is called {name}."))?;
        let mut own = Own { say: planned.say.clone(), injected: Some(name.to_owned()), ..Own::default() };
        if planned.order.is_empty() {
            return Ok(own);
        }
        let wrong = self.order(&planned.order, knowledge)?;
        own.order = Some(match planned.step {
            None => wrong,
            Some(step) => {
                let (order, reply) = self.in_place_of(turn, usize::from(step), wrong)?;
                if own.say.is_empty() {
                    own.say = reply;
                }
                order
            }
        });
        Ok(own)
    }

    /// What is proposed in a turn, with an order in place of a step, from 1; and what the robot would have said.
    fn in_place_of(&self, turn: Option<u64>, step: usize, order: Order) -> Result<(Order, String), String> {
        let held = self.memory.held.as_ref().filter(|held| turn == Some(held.words.turn));
        let Some(Understanding::Plan { steps, reply }) = held.map(|held| &held.meaning.understanding) else {
            return Err("This error is made in a plan, and none is proposed.".to_owned());
        };
        // Steps are counted as the wizard sees them.
        let mut told = (0..steps.len()).filter(|at| !steps[*at].says.is_empty());
        let at = told.nth(step.saturating_sub(1));
        let at = at.ok_or_else(|| format!("What is proposed has no step {step}, in which this error is made."))?;
        let context = held.map_or(order.context, |held| held.meaning.context.clone());
        let steps = [&steps[..at], &order.steps[..], &steps[at + 1..]].concat();
        Ok((Order { text: order.text, steps, context, click: None }, reply.clone()))
    }

    /// Has the robot say, do and show something of the wizard's own accord.
    fn act(&mut self, own: Own, knowledge: &Knowledge) -> Result<Vec<Outgoing>, String> {
        if own.is_nothing() {
            return Err("Write what the robot is to say or to do.".to_owned());
        }
        let mut outbox = Vec::new();
        let record = own.record(DecisionOutcome::Unprompted);
        let turn = self.memory.turns.max(1);
        // What is held back keeps its number.
        self.memory.turns = turn + u64::from(own.order.is_some());
        let number = self.memory.turns;
        let has_order = own.order.is_some();
        self.do_own(turn, number, own, knowledge, &mut outbox);
        if !has_order {
            // No turn ends by what the robot says of its own accord.
            outbox.retain(|item| !matches!(item, Outgoing::TurnEnded { .. }));
        }
        self.note_decision(turn, &record, &mut outbox);
        self.propose_again(knowledge, &mut outbox);
        Ok(outbox)
    }

    /// Says, does and shows what a wizard wrote, picked or clicked.
    pub(super) fn do_own(
        &mut self,
        turn: u64,
        number: u64,
        own: Own,
        knowledge: &Knowledge,
        outbox: &mut Vec<Outgoing>,
    ) {
        let Own { say, order, expression, injected, .. } = own;
        let end = if say.is_empty() { TurnEnd::Interrupted } else { TurnEnd::Answered };
        if !say.is_empty() {
            self.memory.asked = None;
            self.say(turn, LineKind::Say, &say, outbox);
        }
        match order {
            Some(Order { steps, context, .. }) => {
                self.memory.context = context;
                let silently = Understanding::Plan { steps, reply: String::new() };
                self.react(turn, number, silently, knowledge, outbox);
                // What comes of an error is told as of all that the robot does by itself.
                if injected.is_none() {
                    self.silence(number);
                }
            }
            None => outbox.push(Outgoing::TurnEnded { turn, end }),
        }
        if let Some(shown) = expression {
            self.express(turn, shown, outbox);
        }
    }

    fn silence(&mut self, number: u64) {
        if let Some(plan) = self.memory.plans.get_mut(&number) {
            plan.is_silent = true;
        }
    }

    /// Whether what comes of that plan is told to nobody but the wizard.
    pub(in crate::conversation) fn is_silent(&self, number: u64) -> bool {
        self.memory.plans.get(&number).is_some_and(|plan| plan.is_silent)
    }

    /// What came of an order, of which people are told nothing: the wizard reads what the robot would say.
    pub(in crate::conversation) fn unsaid(&mut self, after: u64, outbox: Vec<Outgoing>) -> Vec<Outgoing> {
        let newest = self.memory.plans.last_key_value().map(|(number, _)| *number);
        if let Some(number) = newest.filter(|number| *number > after) {
            self.silence(number);
        }
        let unsaid = |item: Outgoing| match item {
            Outgoing::Say(line) | Outgoing::Ask(line) => Outgoing::ForWizard(line.text),
            other => other,
        };
        outbox.into_iter().map(unsaid).collect()
    }
}

/// A wizard's request, if it is one.
fn request(text: &str) -> Result<String, String> {
    let text = in_one_line(text.trim());
    if (1..=LONGEST_SAYING).contains(&text.chars().count()) {
        return Ok(text);
    }
    Err(format!("Write a plain request of 1 to {LONGEST_SAYING} characters."))
}
