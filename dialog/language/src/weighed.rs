//! What an utterance means, by all that reads it: the grammar, the learned parser, and the likeness to plain requests. Each says what it
//! takes the utterance for, and how sure it is; what they agree on counts most.

use cohabit_cdf::Action;
use cohabit_parser::Reading;

use crate::{
    answer::HINT,
    ask,
    context::{Context, Pending},
    conversation::Conversation,
    describe,
    parsed::{self, Worth, worth},
    reply,
    understanding::{Asking, Clarification, Step, Understanding},
};

/// How much each counts.
const PARSER: f32 = 0.55;
const LIKENESS: f32 = 0.45;
/// What the grammar's sense of an utterance counts that it does not read to the last word.
const GRAMMAR_ASKED: f32 = 0.55;
const GRAMMAR_PARTIAL: f32 = 0.42;
const GRAMMAR_ANSWER: f32 = 0.6;
const GRAMMAR_ANSWERED: f32 = 0.4;
const GRAMMAR_GUESSED: f32 = 0.12;
const GRAMMAR_REFUSED: f32 = 0.35;
const GRAMMAR_PARTLY_REFUSED: f32 = 0.1;

/// What a reading counts that leaves something out, of one that does not.
const LEFT_OUT: f32 = 0.6;
/// What a question counts that the robot has just asked.
const REPEATED: f32 = 0.1;

/// How much must speak for an understanding for it to be acted on, where it changes things and where it does not; and to be proposed.
const TO_CHANGE: f32 = 0.52;
const TO_MOVE: f32 = 0.4;
const TO_PROPOSE: f32 = 0.1;
/// The same for an answer to be given.
const TO_ANSWER: f32 = 0.3;
/// The least for an utterance with a word that nobody ever met, and where that is the name of a thing, which the robot can ask for.
const UNHEARD: f32 = 0.3;
const UNHEARD_NAME: f32 = 0.8;
/// How much must then speak for steps for them to be taken.
const UNHEARD_TO_ACT: f32 = 0.8;
/// The same for what is done where nothing may be asked.
const TO_GUESS: f32 = 0.3;
/// What is proposed beside the likeliest is at least so likely, of that.
const RIVAL: f32 = 0.45;
/// How many plans are proposed at most.
const MOST_PROPOSED: usize = 3;

/// A way to understand an utterance.
struct Hypothesis {
    understanding: Understanding,
    /// The conversation after it.
    context: Context,
    weight: f32,
}

impl Conversation<'_> {
    /// What speaks for itself, or what most speaks for.
    pub(crate) fn understand_best(&self, utterance: &str, context: &mut Context) -> Understanding {
        let mut read = context.clone();
        let by_grammar = self.understand_said(utterance, &mut read);
        let is_lost = matches!(by_grammar, Understanding::Refusal { is_lost: true, .. });
        if self.parser.is_none() || !is_lost && self.is_plain(utterance) {
            *context = read;
            return by_grammar;
        }
        let mut hypotheses = self.hypotheses(utterance, context);
        // Why the grammar thinks that it cannot be done says more than why another reading cannot.
        let is_reason = worth(&by_grammar) > Worth::None;
        hypotheses.retain(|one| !(is_reason && worth(&one.understanding) == Worth::Refused));
        let weight = self.weight_of_grammar(utterance, &by_grammar, context);
        let weight = if is_repeated(&by_grammar, context) { REPEATED } else { weight };
        add(&mut hypotheses, Hypothesis { understanding: by_grammar.clone(), context: read.clone(), weight });
        hypotheses.sort_by(|one, other| other.weight.total_cmp(&one.weight));
        let unheard = self.unheard_words(utterance);
        let is_named = matches!(by_grammar, Understanding::Question { kind: Clarification::Appearance, .. });
        let least = match unheard.as_slice() {
            [] if is_named => UNHEARD,
            [] => TO_PROPOSE,
            _ if is_named => UNHEARD_NAME,
            _ => UNHEARD,
        };
        // What is asked back about a word that it guesses at would only puzzle.
        // A question that the grammar answers is not carried out.
        let is_question = worth(&by_grammar) == Worth::Answered && utterance.trim_end().ends_with('?');
        let is_fit = |best: &&Hypothesis| match best.understanding {
            Understanding::Plan { .. } => best.weight >= least && !is_question,
            Understanding::Answer { .. } => best.weight >= least.max(TO_ANSWER),
            _ => best.weight >= least && unheard.is_empty() && !is_named,
        };
        let best = hypotheses.iter().find(is_fit);
        let Some(best) = best else {
            *context = read;
            return by_grammar;
        };
        match &best.understanding {
            Understanding::Plan { steps, .. } if best.weight < weight_to_act(steps, !unheard.is_empty()) => {
                match self.judge.asking {
                    Asking::Never if best.weight < TO_GUESS => {
                        Understanding::lost(format!("I did not understand that. {HINT}"))
                    }
                    Asking::Never => {
                        *context = best.context.clone();
                        best.understanding.clone()
                    }
                    _ if unheard.is_empty() => self.proposed(&hypotheses, best.weight, context),
                    _ => self.proposed(&hypotheses, best.weight, context).after(&reply::unknown(&unheard)),
                }
            }
            understanding => {
                *context = best.context.clone();
                understanding.clone()
            }
        }
    }

    /// How much the grammar's sense of an utterance counts that it does not read to the last word.
    fn weight_of_grammar(&self, utterance: &str, understanding: &Understanding, context: &Context) -> f32 {
        let is_partial = self.leaves_words_out(utterance);
        let is_plan = matches!(understanding, Understanding::Plan { .. });
        match worth(understanding) {
            Worth::Asked if is_plan && context.pending.is_some() => GRAMMAR_ANSWER,
            Worth::Asked if is_plan && is_partial => GRAMMAR_PARTIAL,
            Worth::Asked => GRAMMAR_ASKED,
            Worth::Answered if matches!(understanding, Understanding::Answer { holds: Some(_), .. }) => {
                GRAMMAR_ANSWERED
            }
            Worth::Answered if self.takes_for_question(utterance) => GRAMMAR_GUESSED,
            Worth::Answered => GRAMMAR_ANSWERED,
            Worth::Refused if is_partial => GRAMMAR_PARTLY_REFUSED,
            Worth::Refused => GRAMMAR_REFUSED,
            Worth::None => 0.0,
        }
    }

    /// What parser and likeness make of it; the same in several ways counts as one.
    fn hypotheses(&self, utterance: &str, context: &Context) -> Vec<Hypothesis> {
        let mut hypotheses = Vec::new();
        let readings = self.readings(utterance, context);
        let several = |reading: &&Reading| reading.requests.iter().filter(|request| parsed::asks(request)).count() > 1;
        let is_single = 1.0 - readings.iter().filter(several).map(|reading| reading.probability).sum::<f32>();
        for reading in &readings {
            // Stops were heard before.
            if reading.requests.iter().any(parsed::stops) {
                continue;
            }
            let mut then = context.clone();
            let Some((understanding, certainty)) = self.understand_reading(reading, utterance, &mut then) else {
                continue;
            };
            let leaves_out = reading.requests.iter().any(|request| parsed::unknown_words(request).is_some());
            let part = if leaves_out { LEFT_OUT } else { 1.0 };
            let weight = PARSER * reading.probability * certainty * part;
            add(&mut hypotheses, Hypothesis { understanding, context: then, weight });
        }
        for likely in self.likely_requests(utterance) {
            let mut then = context.clone();
            let understanding = match likely.request.strip_prefix("social: ") {
                Some(kind) => match parsed::social(kind) {
                    Some(social) => Understanding::answer(parsed::small_talk(social)),
                    None => continue,
                },
                None if likely.request == "nothing" => {
                    Understanding::refusal(format!("That is nothing that I can do. {HINT}"))
                }
                None => as_it_is(self.understand_said(&likely.request, &mut then)),
            };
            let weight = LIKENESS * likely.probability * is_single.max(0.0);
            add(&mut hypotheses, Hypothesis { understanding, context: then, weight });
        }
        hypotheses
    }

    /// Asks which of these is meant, instead of doing any.
    fn proposed(&self, hypotheses: &[Hypothesis], highest: f32, context: &mut Context) -> Understanding {
        let likely = hypotheses.iter().filter(|one| one.weight >= highest * RIVAL);
        let plans = likely.filter_map(|one| match &one.understanding {
            Understanding::Plan { steps, .. } => Some(steps.clone()),
            _ => None,
        });
        let plans: Vec<Vec<Step>> = plans.take(MOST_PROPOSED).collect();
        let question = match plans.as_slice() {
            [] => return ask::what(),
            [steps] => ask::shall_i(steps, &[]),
            plans => ask::which_plan(plans),
        };
        context.pending = Some(Pending::Guess { plans });
        question
    }
}

/// Whether it asks what the robot asked last.
fn is_repeated(understanding: &Understanding, context: &Context) -> bool {
    let asked = context.lines.iter().rev().find(|(by_robot, _)| *by_robot);
    matches!(understanding, Understanding::Question { text, .. } if asked.is_some_and(|(_, last)| last == text))
}

/// Adds what is not there yet, or what speaks for it to what is.
fn add(hypotheses: &mut Vec<Hypothesis>, new: Hypothesis) {
    if worth(&new.understanding) == Worth::None || matches!(new.understanding, Understanding::Stop { .. }) {
        return;
    }
    let is_same = |one: &&mut Hypothesis| match (&one.understanding, &new.understanding) {
        (Understanding::Plan { steps: one, .. }, Understanding::Plan { steps: other, .. }) => {
            one.iter().map(|step| &step.action).eq(other.iter().map(|step| &step.action))
        }
        (one, other) => one == other,
    };
    match hypotheses.iter_mut().find(is_same) {
        Some(one) => one.weight += new.weight,
        None => hypotheses.push(new),
    }
}

/// The answer without its yes or no: what was asked may have been the contrary.
fn as_it_is(understanding: Understanding) -> Understanding {
    let Understanding::Answer { text, highlight, .. } = &understanding else { return understanding };
    match text.strip_prefix("Yes, ").or_else(|| text.strip_prefix("No, ")) {
        Some(text) => Understanding::about(describe::sentence(text), highlight.clone()),
        None => understanding,
    }
}

/// How much must speak for steps for them to be taken without a question.
fn weight_to_act(steps: &[Step], has_unheard_word: bool) -> f32 {
    if has_unheard_word {
        return UNHEARD_TO_ACT;
    }
    let changes = steps.iter().any(|step| matches!(step.action, Action::Interact { .. } | Action::Place { .. }));
    if changes { TO_CHANGE } else { TO_MOVE }
}
