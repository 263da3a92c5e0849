//! What an utterance means, by all that reads it: what speaks for itself is carried out, what is likely enough too; of what is less
//! likely the robot asks.

use cohabit_cdf::Action;

use crate::{
    alternatives::Alternative,
    ask, clause, condition,
    context::{Context, Guess, Pending},
    conversation::Conversation,
    describe,
    evidence::Feature,
    lab, parsed, reply,
    understanding::{Asking, Clarification, Step, Understanding},
    wording::Wording,
};

/// How likely steps must be meant for them to be taken without a question, where they change things and where they do not.
const TO_CHANGE: f32 = 0.6;
const TO_MOVE: f32 = 0.45;
/// The same where something that was named is left out.
const TO_CHANGE_IN_PART: f32 = 0.75;
const TO_MOVE_IN_PART: f32 = 0.5;
/// The same in words some of which nobody ever met: an unknown verb changes nothing.
const TO_CHANGE_UNHEARD: f32 = 0.85;
const TO_MOVE_UNHEARD: f32 = 0.75;
/// The same of things that nobody named, where a name is unknown.
const TO_TAKE_FOR_UNHEARD: f32 = 0.75;
/// The same where it is taken for the answer to a question of the robot's: what is to be done was said before.
const TO_ACT_ON_REPLY: f32 = 0.3;
/// The same of all that is left of the mission, which is wanted anyway.
const TO_PURSUE: f32 = 0.15;
/// How likely what the grammar reads to the last word, as an answer or as a yes-no question must be for nothing else to be asked: most of
/// that is right.
const TO_TRUST_EXACT: f32 = 0.08;
/// The same of up to so many words, and of answers, which nearly all are right; and how likely they are meant, at least.
const TO_TRUST_SHORT: f32 = 0.02;
const SHORT: usize = 6;
const SURE_IF_SHORT: f32 = 0.9;
/// How likely what is said must be the right reply, where nothing is done.
const TO_REPLY: f32 = 0.3;
/// The same of what is only about things that nobody named, and in words some of which nobody ever met.
const TO_REPLY_UNNAMED: f32 = 0.6;
const TO_REPLY_UNHEARD: f32 = 0.6;
/// The same where it asks which one of several is meant, in words some of which nobody ever met.
const TO_ASK_UNHEARD: f32 = 0.45;
/// How likely steps must be meant to be proposed: where every word is known, where not, where the grammar only finds a thing, and of things
/// that nobody named; and to be taken where nothing may be asked.
const TO_PROPOSE: f32 = 0.1;
const TO_PROPOSE_UNHEARD: f32 = 0.3;
const TO_PROPOSE_VAGUE: f32 = 0.2;
const TO_PROPOSE_UNNAMED: f32 = 0.2;
const TO_GUESS: f32 = 0.3;
/// What is proposed beside the likeliest is at least so likely, of that.
const RIVAL: f32 = 0.4;
/// How many plans are proposed at most.
const MOST_PROPOSED: usize = 3;
/// Below these, what is done is said to be what the robot thinks, and what it leaves out is said.
const SURELY: f32 = 0.7;
const SURELY_ALL: f32 = 0.9;
/// How likely that is meant which the sentences of an utterance mean by themselves, and which the grammar alone makes of it.
const BY_SENTENCES: f32 = 0.6;
const BY_GRAMMAR: f32 = 0.6;

impl Conversation<'_> {
    /// What speaks for itself, or what most speaks for; and how likely it is what was meant.
    pub(crate) fn understand_weighed(&self, utterance: &str, context: &mut Context) -> (Understanding, f32) {
        let wording = self.wording(utterance);
        let by_grammar = self.read(utterance, context);
        if self.speaks_for_itself(&wording, &by_grammar) {
            let sureness = if self.parser.is_some() { 1.0 } else { BY_GRAMMAR };
            *context = by_grammar.context;
            return (by_grammar.understanding, sureness);
        }
        // What has no name that is known may only be guessed at.
        let unheard = match &by_grammar.understanding {
            Understanding::Question { kind: Clarification::Appearance, about, .. } => {
                match wording.unheard.as_slice() {
                    [] if self.lexicon.is_small_word(about) => &[],
                    [] => std::slice::from_ref(about),
                    _ => {
                        *context = by_grammar.context;
                        return (by_grammar.understanding, 0.0);
                    }
                }
            }
            _ => wording.unheard.as_slice(),
        };
        let mut alternatives = self.alternatives_to(by_grammar.clone(), &wording, context);
        let is_alone = alternatives.len() == 1;
        let unknown = clause::unknown_words(self.lexicon, &wording.words);
        // `walk the dog` is no walk.
        if !unknown.is_empty() {
            alternatives.retain(|one| !one.only_moves());
        }
        let is_short = wording.words.len() <= SHORT;
        let is_trusted = |one: &&Alternative| {
            let least = if is_short || one.is_grammars_reply() { TO_TRUST_SHORT } else { TO_TRUST_EXACT };
            one.is_exact() && one.probability >= least
        };
        if let Some(trusted) = alternatives.iter().find(|one| is_alone || is_trusted(one)) {
            *context = trusted.context.clone();
            let least = if is_short { SURE_IF_SHORT } else { 0.0 };
            return (trusted.understanding.clone(), trusted.probability.max(least));
        }
        // A question that the grammar answers is not carried out, nor what it leaves because a condition does not hold.
        let is_open = wording.ends_as_question() || condition::is_conditional(self.lexicon, &wording.words);
        if matches!(by_grammar.understanding, Understanding::Answer { .. }) && is_open {
            alternatives.retain(|one| !matches!(one.understanding, Understanding::Plan { .. }));
        }
        // An unknown name is no other thing that is in the hand already; who may not ask does not take it for any other.
        if !unknown.is_empty() {
            let may_ask = self.judge.asking != Asking::Never;
            alternatives.retain(|one| {
                let is_sure = may_ask || !one.is_unnamed() || one.probability >= TO_TAKE_FOR_UNHEARD;
                is_sure && (!one.context.is_met || one.is_exact())
            });
        }
        // Who asks why, who or when wants an answer, whatever it is about.
        if wording.asks_for_reason() {
            alternatives.retain(|one| !one.understanding.commits());
        }
        let likeliest = alternatives.first();
        let likeliest = likeliest.filter(|one| one.is_likely(unheard) || unheard.is_empty() && self.pursues_goals(one));
        if likeliest.is_none_or(|one| one.probability < SURELY_ALL)
            && let Some((understanding, then)) = self.by_sentences(&wording, context)
        {
            *context = then;
            return (understanding, BY_SENTENCES);
        }
        if let Some(likeliest) = likeliest {
            *context = likeliest.context.clone();
            return (likeliest.understood(unheard), likeliest.probability);
        }
        let is_vague = matches!(by_grammar.understanding, Understanding::Question { kind: Clarification::Request, .. });
        let least = match unheard {
            [] if is_vague => TO_PROPOSE_VAGUE,
            [] => TO_PROPOSE,
            _ => TO_PROPOSE_UNHEARD,
        };
        if let Some(question) = self.proposed(&alternatives, least, unheard, context) {
            return (question, 0.0);
        }
        if matches!(by_grammar.understanding, Understanding::Plan { .. }) {
            return (self.unclear(&unknown), 0.0);
        }
        *context = by_grammar.context;
        (by_grammar.understanding, 0.0)
    }

    /// Whether it is a wish to have all done that is left of the mission.
    fn pursues_goals(&self, one: &Alternative) -> bool {
        let later = &one.context.later;
        let is_goal = |text: &String| self.scene.goals.iter().any(|goal| goal.text == *text);
        let is_plan = matches!(one.understanding, Understanding::Plan { .. });
        is_plan && !later.is_empty() && later.iter().all(is_goal) && one.probability >= TO_PURSUE
    }

    /// Whether what the grammar makes of it needs no other opinion: it is a set phrase of small talk, names a lab that the grammar knows to
    /// tell or to ask for, or could not be weighed.
    pub(crate) fn speaks_for_itself(&self, wording: &Wording<'_>, by_grammar: &Alternative) -> bool {
        let is_lost = matches!(by_grammar.understanding, Understanding::Refusal { is_lost: true, .. });
        let is_exact = !self.small(&wording.tidied).is_empty() || self.chat(&wording.tidied).is_some();
        let is_of_lab = matches!(by_grammar.context.pending, Some(Pending::Lab { .. }))
            || lab::here(self.scene.robot.room).is_some() && lab::bare(self.lexicon, &wording.words).is_some();
        self.parser.is_none() || is_of_lab || !self.may_be_weighed(wording) || !is_lost && is_exact
    }

    /// Asks which of the likeliest plans is meant, instead of carrying any out; nothing, where none is likely at all.
    fn proposed(
        &self,
        alternatives: &[Alternative],
        least: f32,
        unheard: &[String],
        context: &mut Context,
    ) -> Option<Understanding> {
        let plans = alternatives.iter().filter_map(|one| match &one.understanding {
            Understanding::Plan { steps, .. } => {
                let least = if one.is_unnamed() { least.max(TO_PROPOSE_UNNAMED) } else { least };
                (one.probability >= least).then_some((one, steps))
            }
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
        let likely = plans.filter(|(one, _)| one.probability >= least).take(MOST_PROPOSED);
        let mut guesses: Vec<Guess> = likely.map(|(one, steps)| one.context.guess(steps)).collect();
        let mut named: Vec<String> = Vec::new();
        guesses.retain(|guess| {
            let is_new = !named.contains(&guess.name);
            named.push(guess.name.clone());
            is_new
        });
        if guesses.len() > 1 && guesses.iter().all(|guess| guess.search.is_none()) {
            let plans: Vec<&[Step]> = guesses.iter().map(|guess| guess.steps.as_slice()).collect();
            let names = reply::apart(&plans);
            guesses.iter_mut().zip(names).for_each(|(guess, name)| guess.name = name);
        }
        let names: Vec<&str> = guesses.iter().map(|guess| guess.name.as_str()).collect();
        let question = match names.as_slice() {
            [name] => ask::is_it(name),
            names => ask::which_plan(names),
        };
        context.pending = Some(Pending::Guess { guesses });
        Some(if unheard.is_empty() { question } else { question.after(&reply::unknown(unheard)) })
    }
}

impl Alternative {
    /// Whether it is likely enough to be carried out, or said.
    fn is_likely(&self, unheard: &[String]) -> bool {
        let least = match &self.understanding {
            // What has no known name is no other thing, unless that is most likely.
            Understanding::Plan { .. } if !unheard.is_empty() && self.is_unnamed() => TO_TAKE_FOR_UNHEARD,
            Understanding::Plan { steps, .. } if !unheard.is_empty() => {
                if self.is_bold(steps) {
                    TO_CHANGE_UNHEARD
                } else {
                    TO_MOVE_UNHEARD
                }
            }
            Understanding::Plan { steps, .. } => match (self.leaves_out_named(), self.is_bold(steps)) {
                (true, true) => TO_CHANGE_IN_PART,
                (true, false) => TO_MOVE_IN_PART,
                _ if unheard.is_empty() && self.is_reply() => TO_ACT_ON_REPLY,
                (false, true) => TO_CHANGE,
                (false, false) => TO_MOVE,
            },
            // What is asked back, or said against what was only guessed of a word, would puzzle.
            Understanding::Question { kind: Clarification::Reference, .. } if !unheard.is_empty() => TO_ASK_UNHEARD,
            Understanding::Question { .. } | Understanding::Refusal { .. } if !unheard.is_empty() => return false,
            Understanding::Answer { .. } if !unheard.is_empty() => TO_REPLY_UNHEARD,
            // What it says of a thing that it does not know what to do with, it says where it has no guess.
            Understanding::Question { kind: Clarification::Request, .. } => return false,
            Understanding::Answer { highlight, .. } if !highlight.is_empty() && self.is_unnamed() => TO_REPLY_UNNAMED,
            _ => TO_REPLY,
        };
        self.probability >= least
    }

    /// What is understood, with what it leaves open said before it is done.
    fn understood(&self, unheard: &[String]) -> Understanding {
        let is_plan = matches!(self.understanding, Understanding::Plan { .. });
        let is_said = self.understanding.reply().starts_with(parsed::LEAVES_OUT);
        let note = match unheard {
            _ if !is_plan || is_said => return self.understanding.clone(),
            [_, ..] => format!("{}, but I think you mean this:", reply::unknown(unheard).trim_end_matches('.')),
            [] if self.probability < SURELY_ALL && !self.leaves_out.is_empty() => {
                format!("I leave out what you said of {}.", describe::list(&self.leaves_out, "and"))
            }
            [] if self.probability < SURELY => "If I understand you right:".to_owned(),
            [] => return self.understanding.clone(),
        };
        self.understanding.clone().after(&note)
    }

    /// Whether the grammar reads it to the last word, as the answer to a question of the robot's, or as a yes-no question.
    fn is_exact(&self) -> bool {
        let is_answered = matches!(self.understanding, Understanding::Answer { holds: Some(_), .. });
        // A deed with a question after it, or several goals.
        let is_series = self.evidence.get(Feature::GrammarPlan) > 0.0 && !self.context.later.is_empty();
        self.is_plain()
            || is_series
            || self.is_grammars_reply()
            || is_answered && self.evidence.get(Feature::GrammarAnswer) > 0.0
    }

    /// Whether the grammar takes it for what is to be done, as an answer to a question of the robot's.
    fn is_grammars_reply(&self) -> bool {
        self.evidence.get(Feature::GrammarPlanReply) > 0.0
    }

    /// Whether it is a move that is about no thing and no place.
    fn only_moves(&self) -> bool {
        let moves = |step: &Step| matches!(step.action, Action::Move { .. } | Action::Rotate { .. });
        matches!(&self.understanding, Understanding::Plan { steps, .. } if steps.iter().all(moves))
    }

    fn leaves_out_named(&self) -> bool {
        self.evidence.get(Feature::MissingAny) > 0.0
    }

    /// Whether it is only about things that nobody named.
    fn is_unnamed(&self) -> bool {
        self.evidence.get(Feature::Unnamed) >= 1.0
    }

    /// Whether it would not simply be undone, or changes what nobody named.
    fn is_bold(&self, steps: &[Step]) -> bool {
        steps.iter().any(|step| step.is_lasting() || step.changes() && self.is_unnamed())
    }

    /// Whether grammar or parser takes it for the answer to a question of the robot's.
    fn is_reply(&self) -> bool {
        self.is_grammars_reply() || self.evidence.get(Feature::ParserReply) > 0.0
    }
}
