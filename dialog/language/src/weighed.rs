//! What an utterance means, by all that reads it: what speaks for itself is carried out, what is likely enough too; of what is less
//! likely the robot asks.

use cohabit_cdf::Action;

use crate::{
    alternatives::Alternative,
    answer::HINT,
    ask,
    context::{Context, Pending},
    conversation::Conversation,
    evidence::Feature,
    reply,
    understanding::{Asking, Clarification, Step, Understanding},
};

/// How likely steps must be meant for them to be taken without a question, where they change things and where they do not.
const TO_CHANGE: f32 = 0.7;
const TO_MOVE: f32 = 0.45;
/// The same where the grammar takes it for the answer to a question of the robot's: what is to be done was said before.
const TO_ACT_ON_REPLY: f32 = 0.35;
/// The same where there is a word that nobody ever met, and where something that was named is left out.
const TO_ACT_UNHEARD: f32 = 0.8;
const TO_ACT_IN_PART: f32 = 0.9;
/// How likely what is said must be the right reply, where nothing is done.
const TO_REPLY: f32 = 0.3;
/// How likely steps must be meant to be proposed, where every word is known and where not; and to be taken where nothing may be asked.
const TO_PROPOSE: f32 = 0.1;
const TO_PROPOSE_UNHEARD: f32 = 0.3;
const TO_GUESS: f32 = 0.3;
/// What is proposed beside the likeliest is at least so likely, of that.
const RIVAL: f32 = 0.4;
/// How many plans are proposed at most.
const MOST_PROPOSED: usize = 3;

impl Conversation<'_> {
    /// What speaks for itself, or what most speaks for.
    pub(crate) fn understand_best(&self, utterance: &str, context: &mut Context) -> Understanding {
        let mut read = Context { is_met: false, ..context.clone() };
        let by_grammar = self.understand_said(utterance, &mut read);
        if self.speaks_for_itself(utterance, &by_grammar, &read) {
            *context = read;
            return by_grammar;
        }
        let unheard = self.unheard_words(utterance);
        let asks_for_name = matches!(by_grammar, Understanding::Question { kind: Clarification::Appearance, .. });
        if asks_for_name && !unheard.is_empty() {
            *context = read;
            return by_grammar;
        }
        let mut ways = self.alternatives_to(by_grammar.clone(), read.clone(), utterance, context);
        // A question that the grammar answers is not carried out.
        if matches!(by_grammar, Understanding::Answer { .. }) && utterance.trim_end().ends_with('?') {
            ways.retain(|way| !matches!(way.understanding, Understanding::Plan { .. }));
        }
        if let Some(way) = ways.first().filter(|way| way.is_likely(&unheard)) {
            *context = way.context.clone();
            return way.understanding.clone();
        }
        if let Some(question) = self.proposed(&ways, &unheard, context) {
            return question;
        }
        if matches!(by_grammar, Understanding::Plan { .. }) {
            return Understanding::lost(format!("I did not understand that. {HINT}"));
        }
        *context = read;
        by_grammar
    }

    /// Whether what the grammar makes of it needs no other opinion: it reads it to the last word, or knows what it lacks.
    pub(crate) fn speaks_for_itself(&self, utterance: &str, by_grammar: &Understanding, then: &Context) -> bool {
        let is_lost = matches!(by_grammar, Understanding::Refusal { is_lost: true, .. });
        let lacks_lab = matches!(then.pending, Some(Pending::Lab { .. }));
        self.parser.is_none() || lacks_lab || !self.may_be_weighed(utterance) || !is_lost && self.is_plain(utterance)
    }

    /// Asks which of the likeliest plans is meant, instead of carrying any out; nothing, where none is likely at all.
    fn proposed(&self, ways: &[Alternative], unheard: &[String], context: &mut Context) -> Option<Understanding> {
        let least = if unheard.is_empty() { TO_PROPOSE } else { TO_PROPOSE_UNHEARD };
        let plans = ways.iter().filter_map(|way| match &way.understanding {
            Understanding::Plan { steps, .. } if way.probability >= least => Some((way, steps)),
            _ => None,
        });
        let mut plans = plans.peekable();
        let (likeliest, _) = *plans.peek()?;
        if self.judge.asking == Asking::Never {
            return (likeliest.probability >= TO_GUESS).then(|| {
                *context = likeliest.context.clone();
                likeliest.understanding.clone()
            });
        }
        let least = likeliest.probability * RIVAL;
        let plans: Vec<Vec<Step>> = plans
            .filter(|(way, _)| way.probability >= least)
            .take(MOST_PROPOSED)
            .map(|(_, steps)| steps.clone())
            .collect();
        let question = match plans.as_slice() {
            [steps] => ask::shall_i(steps, &[]),
            plans => ask::which_plan(plans),
        };
        context.pending = Some(Pending::Guess { plans });
        Some(if unheard.is_empty() { question } else { question.after(&reply::unknown(unheard)) })
    }
}

impl Alternative {
    /// Whether it is likely enough to be carried out, or said.
    fn is_likely(&self, unheard: &[String]) -> bool {
        let least = match &self.understanding {
            Understanding::Plan { .. } if !unheard.is_empty() => TO_ACT_UNHEARD,
            Understanding::Plan { .. } if self.evidence.get(Feature::MissingAny) > 0.0 => TO_ACT_IN_PART,
            Understanding::Plan { .. } if self.evidence.get(Feature::GrammarPlanReply) > 0.0 => TO_ACT_ON_REPLY,
            Understanding::Plan { steps, .. } if changes(steps) => TO_CHANGE,
            Understanding::Plan { .. } => TO_MOVE,
            // What is asked back about a word that it guesses at would only puzzle.
            Understanding::Question { .. } if !unheard.is_empty() => return false,
            _ => TO_REPLY,
        };
        self.probability >= least
    }
}

fn changes(steps: &[Step]) -> bool {
    steps.iter().any(|step| matches!(step.action, Action::Interact { .. } | Action::Place { .. }))
}
