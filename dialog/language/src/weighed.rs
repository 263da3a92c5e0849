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
    lab, open_goals, parsed, question, reply,
    rewritten::pooled,
    token,
    understanding::{Asking, Clarification, Step, Understanding},
    wording::Wording,
};

/// How likely steps must be meant for them to be taken without a question, where what they change is not simply put back and where it is; the
/// same where nobody ever met some of the words: an unknown verb changes nothing.
const TO_CHANGE: f32 = 0.7;
const TO_MOVE: f32 = 0.6;
const TO_CHANGE_UNHEARD: f32 = 0.95;
const TO_MOVE_UNHEARD: f32 = 0.9;
/// The same of the only thing that the robot proposed, where the words agree to it, and of what it proposed where they do not deny it.
const TO_ACCEPT: f32 = 0.1;
const TO_ACCEPT_UNSAID: f32 = 0.5;
/// How many words that nobody ever met may be of another language.
const SEVERAL: usize = 2;
/// The same of all that is left of the mission.
const TO_PURSUE: f32 = 0.1;
/// The same of what brings a goal about that is not met.
const TO_PURSUE_GOAL: f32 = 0.45;
/// How likely what is said must be the right reply, where nothing is done.
const TO_REPLY: f32 = 0.2;
/// The same in words some of which nobody ever met, or about things that nobody named.
const TO_REPLY_UNSURE: f32 = 0.6;
/// How likely steps must be meant to be proposed, also in words some of which nobody ever met, and to be taken where nothing may be asked.
const TO_PROPOSE: f32 = 0.05;
const TO_PROPOSE_UNHEARD: f32 = 0.15;
const TO_GUESS: f32 = 0.3;
/// The same of steps where somebody only wants to know something.
const TO_OFFER: f32 = 0.3;
/// How likely what the grammar reads to the last word must be meant for nothing else to be asked, and where it is an answer to the robot,
/// names a condition or has few words, and where it answers who only wants to know something.
const TO_TRUST: f32 = 0.08;
const TO_TRUST_SHORT: f32 = 0.005;
const TO_TRUST_ANSWER: f32 = 0.03;
const SHORT: usize = 6;
/// How likely the latter is meant, at least.
const SURE_IF_SHORT: f32 = 0.9;
/// What is proposed beside the likeliest is at least so likely, of that.
const RIVAL: f32 = 0.25;
/// How many plans are proposed at most.
const MOST_PROPOSED: usize = 3;
/// Below these, what is done is said to be what the robot thinks, and what it leaves out is said.
const SURELY: f32 = 0.7;
const SURELY_ALL: f32 = 0.9;
/// What it says before what it is not sure of.
const UNSURE: &str = "If I understand you right:";
/// How likely that is meant which the grammar alone makes of it.
const BY_GRAMMAR: f32 = 0.6;

impl Conversation<'_> {
    /// What speaks for itself, or what most speaks for; and how likely it is what was meant.
    pub(crate) fn understand_weighed(&self, utterance: &str, context: &mut Context) -> (Understanding, f32) {
        let wording = self.wording(utterance);
        if let Some((rest, left_out)) = self.without_asides(&wording, context) {
            let (understanding, sureness) = self.understand_weighed(&rest, context);
            let note = reply::unknown(&left_out);
            return (if left_out.is_empty() { understanding } else { understanding.after(&note) }, sureness);
        }
        if let Some(named) = self.with_lab_named(&wording) {
            return self.understand_weighed(&named, context);
        }
        if let Some(understood) = self.answered_each(&wording, context).or_else(|| self.told_at_end(&wording, context))
        {
            return understood;
        }
        self.understand_weighed_with(&wording, &[], context)
    }

    /// The same of the whole utterance, given what the rewriter takes it for.
    pub(crate) fn understand_weighed_with(
        &self,
        wording: &Wording<'_>,
        rewritten: &[Alternative],
        context: &mut Context,
    ) -> (Understanding, f32) {
        let by_grammar = self.read(wording.utterance, context);
        if self.speaks_for_itself(wording, &by_grammar) {
            let sureness = if self.parser.is_some() { 1.0 } else { BY_GRAMMAR };
            *context = by_grammar.context;
            return (by_grammar.understanding, sureness);
        }
        // What has no name that is known may only be guessed at; the rewriter knows more names.
        let unheard = match &by_grammar.understanding {
            _ if !rewritten.is_empty() => &[],
            Understanding::Question { kind: Clarification::Appearance, about, .. } => {
                match wording.unheard.as_slice() {
                    [] if self.lexicon.is_small_word(about) => &[],
                    [] => std::slice::from_ref(about),
                    // What answers a question may have a remark beside it.
                    unheard if context.pending.is_some() => unheard,
                    _ => {
                        *context = by_grammar.context;
                        return (by_grammar.understanding, 0.0);
                    }
                }
            }
            _ => wording.unheard.as_slice(),
        };
        let unknown = clause::unknown_words(self.lexicon, &wording.words);
        // Of another language nothing is guessed.
        let said = wording.words.iter().filter(|word| !token::is_punctuation(word)).count();
        if rewritten.is_empty() && wording.unheard.len() >= SEVERAL && wording.unheard.len() * 2 >= said {
            *context = by_grammar.context;
            return (by_grammar.understanding, 0.0);
        }
        let mut alternatives = pooled(self.alternatives_to(by_grammar.clone(), wording, context), rewritten);
        let is_alone = alternatives.len() == 1;
        // `walk the dog` is no walk.
        if !unknown.is_empty() {
            alternatives.retain(|one| !one.only_moves());
        }
        // Who only wants to know something wants an answer, whatever it is about.
        let inquires = self.inquires(wording, context);
        let is_held_back = |one: &Alternative| inquires && one.understanding.commits();
        let (held_back, mut alternatives): (Vec<_>, Vec<_>) = alternatives.into_iter().partition(is_held_back);
        let is_shaped = question::is_shaped(self.lexicon, &wording.tidied);
        let is_short = wording.words.len() <= SHORT;
        let is_conditional = condition::is_conditional(self.lexicon, &wording.words);
        // What is to be done otherwise only the grammar knows to take up where the condition does not hold.
        let has_otherwise = is_conditional && condition::has_otherwise(self.lexicon, &wording.words);
        let is_trusted = |one: &&Alternative| {
            let is_plain = context.pending.is_none() || one.is_plain();
            let is_reply = one.is_grammars_reply() || is_shaped && one.answers();
            let is_sure = is_plain && (is_short || is_reply) || is_conditional;
            let least = if is_sure {
                TO_TRUST_SHORT
            } else if is_plain && inquires && one.answers() {
                TO_TRUST_ANSWER
            } else {
                TO_TRUST
            };
            (one.is_exact() || has_otherwise && one.is_grammars_plan()) && one.probability >= least
        };
        if let Some(trusted) = alternatives.iter().find(|one| is_alone || is_trusted(one)) {
            *context = trusted.context.clone();
            let least = if is_short { SURE_IF_SHORT } else { 0.0 };
            return (trusted.understanding.clone(), trusted.probability.max(least));
        }
        // A question that the grammar answers is not carried out, nor what it leaves because a condition does not hold.
        let is_open = wording.ends_as_question() || is_conditional;
        if matches!(by_grammar.understanding, Understanding::Answer { .. }) && is_open {
            alternatives.retain(|one| !matches!(one.understanding, Understanding::Plan { .. }));
        }
        // An unknown name is no other thing that is in the hand already.
        if !unknown.is_empty() {
            alternatives.retain(|one| !one.context.is_met || one.is_plain());
        }
        let highest = alternatives.first().map_or(0.0, |one| one.probability);
        let leaves_out = alternatives.first().is_some_and(|one| !one.leaves_out.is_empty());
        if highest < SURELY_ALL || leaves_out {
            // They leave nothing out.
            let is_likely = |one: &Alternative| one.probability > highest || one.probability >= TO_MOVE;
            let by_sentences = self.by_sentences(wording, context);
            let by_sentences = by_sentences.filter(|one| is_likely(one) && !is_held_back(one));
            alternatives.splice(0..0, by_sentences);
        }
        let unheard_here = alternatives.first().map(|one| self.unheard_about(one, wording)).unwrap_or_default();
        let unheard = if rewritten.is_empty() && unheard == wording.unheard.as_slice() {
            unheard_here.as_slice()
        } else {
            unheard
        };
        let likely = alternatives.first().filter(|one| one.probability >= one.least(unheard));
        // What is left of the mission is wanted anyway.
        let pursues = |one: &&Alternative| one.of_mission() && one.probability >= TO_PURSUE && unheard.is_empty();
        if let Some(likeliest) = likely.or_else(|| alternatives.iter().find(pursues)) {
            *context = likeliest.context.clone();
            return (likeliest.understood(unheard), likeliest.probability);
        }
        if let Some(first) = self.first_of(wording, context) {
            return first;
        }
        // `do you know how to go there?` may well want it done: what is likely enough is asked about.
        let is_answered = matches!(
            by_grammar.understanding,
            Understanding::Answer { .. } | Understanding::Question { kind: Clarification::Confirmation, .. }
        );
        if !is_answered {
            alternatives.extend(held_back.into_iter().filter(|one| one.probability >= TO_OFFER));
        }
        // What sounds like the words that nobody knows is likelier than what is guessed without them.
        if !unheard.is_empty() && matches!(by_grammar.context.pending, Some(Pending::Offer { .. })) {
            *context = by_grammar.context;
            return (by_grammar.understanding, 0.0);
        }
        if let Some(question) = self.proposed(&alternatives, unheard, context) {
            return (question, 0.0);
        }
        if matches!(by_grammar.understanding, Understanding::Plan { .. }) {
            return (self.unclear(&unknown), 0.0);
        }
        *context = by_grammar.context;
        (by_grammar.understanding, 0.0)
    }

    /// Whether what the grammar makes of it needs no other opinion: it is a set phrase of small talk, names a lab that the grammar knows to
    /// tell or to ask for, or could not be weighed.
    pub(crate) fn speaks_for_itself(&self, wording: &Wording<'_>, by_grammar: &Alternative) -> bool {
        let is_lost = matches!(by_grammar.understanding, Understanding::Refusal { is_lost: true, .. });
        let is_exact = !self.small(&wording.tidied).is_empty() || self.chat(&wording.tidied).is_some();
        let is_of_lab = matches!(by_grammar.context.pending, Some(Pending::Lab { .. }));
        self.parser.is_none() || is_of_lab || !self.may_be_weighed(wording) || !is_lost && is_exact
    }

    /// The utterance with the name of the lab that the robot is in, where that is what `the lab` means.
    pub(crate) fn with_lab_named(&self, wording: &Wording<'_>) -> Option<String> {
        let at = lab::bare(self.lexicon, &wording.words)?;
        let room = lab::here(self.scene.robot.room)?;
        let is_told = lab::described(self.lexicon, self.scene, &wording.words[at + 1..]).is_some();
        (!is_told).then(|| token::sentence(&lab::named(&wording.words, at, room)))
    }

    /// Asks which of the likeliest plans is meant, instead of carrying any out; nothing, where none is likely at all.
    fn proposed(
        &self,
        alternatives: &[Alternative],
        unheard: &[String],
        context: &mut Context,
    ) -> Option<Understanding> {
        let least = if unheard.is_empty() { TO_PROPOSE } else { TO_PROPOSE_UNHEARD };
        let plans = alternatives.iter().filter(|one| one.probability >= least);
        let plans = plans.filter_map(|one| match &one.understanding {
            Understanding::Plan { steps, .. } => Some((one, steps)),
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
        // What is about more that nobody named is no rival.
        let strays = |one: &Alternative| one.evidence.get(Feature::Unnamed);
        let is_rival = |one: &Alternative| one.probability >= least && strays(one) <= strays(likeliest);
        let likely = plans.filter(|(one, _)| is_rival(one)).take(MOST_PROPOSED);
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
    /// How likely it must be meant to be carried out, or said.
    pub(crate) fn least(&self, unheard: &[String]) -> f32 {
        let is_known = unheard.is_empty();
        match &self.understanding {
            Understanding::Plan { .. } if self.is_proposed() => {
                let is_only = self.evidence.get(Feature::ReplyOnly) > 0.0;
                if is_only && self.evidence.get(Feature::ReplyAgrees) > 0.0 { TO_ACCEPT } else { TO_ACCEPT_UNSAID }
            }
            Understanding::Plan { .. } if is_known && self.meets_goal() => TO_PURSUE_GOAL,
            Understanding::Plan { steps, .. } => match (steps.iter().any(Step::is_lasting), is_known) {
                (true, true) => TO_CHANGE,
                (true, false) => TO_CHANGE_UNHEARD,
                (false, true) => TO_MOVE,
                (false, false) => TO_MOVE_UNHEARD,
            },
            // What it says of a thing that it does not know what to do with, it says where it has no guess.
            Understanding::Question { kind: Clarification::Request, .. } => f32::INFINITY,
            // Whatever else may be meant says more than that nothing was understood.
            Understanding::Refusal { is_lost: true, .. } => f32::INFINITY,
            _ if is_known && self.evidence.get(Feature::AnswerUnnamed) < 1.0 => TO_REPLY,
            _ => TO_REPLY_UNSURE,
        }
    }

    /// What is understood, with what it leaves open said before it is done.
    fn understood(&self, unheard: &[String]) -> Understanding {
        let is_plan = matches!(self.understanding, Understanding::Plan { .. });
        let is_said = [parsed::LEAVES_OUT, UNSURE].iter().any(|start| self.understanding.reply().starts_with(start));
        let note = match unheard {
            _ if !is_plan || is_said => return self.understanding.clone(),
            [_, ..] => format!("{}, but I think you mean this:", reply::unknown(unheard).trim_end_matches('.')),
            [] if self.probability < SURELY_ALL && !self.leaves_out.is_empty() => {
                format!("I leave out what you said of {}.", describe::list(&self.leaves_out, "and"))
            }
            [] if self.probability < SURELY => UNSURE.to_owned(),
            [] => return self.understanding.clone(),
        };
        self.understanding.clone().after(&note)
    }

    /// Whether the grammar reads it to the last word, as the answer to a question of the robot's, or as a yes-no question.
    fn is_exact(&self) -> bool {
        let is_answered = matches!(self.understanding, Understanding::Answer { holds: Some(_), .. });
        // A deed with a question after it, or several goals.
        let is_series = self.is_grammars_plan() && !self.context.later.is_empty();
        self.is_plain()
            || is_series
            || self.is_grammars_reply()
            || is_answered && self.evidence.get(Feature::GrammarAnswer) > 0.0
    }

    /// Whether the robot proposed it, and the words do not deny it.
    fn is_proposed(&self) -> bool {
        self.evidence.get(Feature::Reply) > 0.0 && self.evidence.get(Feature::ReplyDenies) == 0.0
    }

    /// Whether it brings about a goal that is not met, with what was named.
    fn meets_goal(&self) -> bool {
        self.prior >= open_goals::MEETS && self.evidence.get(Feature::Unnamed) < 1.0
    }

    /// Whether it begins what is left of the mission.
    fn of_mission(&self) -> bool {
        self.evidence.get(Feature::PlanOfMission) > 0.0
    }

    /// Whether the grammar takes it for what is to be done.
    fn is_grammars_plan(&self) -> bool {
        self.evidence.get(Feature::GrammarPlan) > 0.0
    }

    /// Whether the grammar takes it for what is to be done, as an answer to a question of the robot's.
    fn is_grammars_reply(&self) -> bool {
        self.evidence.get(Feature::GrammarPlanReply) > 0.0
    }

    /// Whether it tells something and does nothing.
    const fn answers(&self) -> bool {
        matches!(self.understanding, Understanding::Answer { .. })
    }

    /// Whether it is a move that is about no thing and no place.
    fn only_moves(&self) -> bool {
        let moves = |step: &Step| matches!(step.action, Action::Move { .. } | Action::Rotate { .. });
        matches!(&self.understanding, Understanding::Plan { steps, .. } if steps.iter().all(moves))
    }
}
