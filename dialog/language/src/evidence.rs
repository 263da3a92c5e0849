//! What speaks for a way to understand an utterance, and how probable that makes it.
//!
//! A conditional logit (McFadden 1974), as for referring expressions (see [`crate::confidence`]): each way has a utility, linear in its
//! [`Evidence`], and their probabilities are the softmax of these, with one more alternative, that none of them is meant. The weights are
//! fitted to labelled utterances by `dialog/language/fit`.

use std::{collections::BTreeMap, sync::LazyLock};

use serde::Deserialize;

use crate::confidence::{by_name, product};

/// What speaks for a way to understand an utterance, and against it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evidence {
    /// By [`Self::NAMES`], in their order.
    pub values: [f32; Self::COUNT],
}

/// Declares which evidence there is: each with its name in `data/alternatives.toml`.
macro_rules! features {
    ($($(#[$doc:meta])* $feature:ident = $name:literal,)*) => {
        /// Which evidence.
        #[derive(Clone, Copy, Debug)]
        pub(crate) enum Feature {
            $($(#[$doc])* $feature,)*
        }

        impl Evidence {
            /// Their names.
            pub const NAMES: [&str; Self::COUNT] = [$($name,)*];

            /// How many there are.
            pub const COUNT: usize = [$($name,)*].len();
        }
    };
}

features! {
    // Who takes the utterance for it: what the learned parser gives it, the likeness to plain requests, the grammar.
    Parser = "parser",
    ParserFirst = "parser_first",
    ParserOfQuestion = "parser_of_question",
    ParserOfAnswer = "parser_of_answer",
    ParserOfRefusal = "parser_of_refusal",
    /// Whether words that it does not know are left out.
    ParserLeftOut = "parser_left_out",
    /// Whether the parser takes it for the answer to a question of the robot's.
    ParserReply = "parser_reply",
    Likeness = "likeness",
    LikenessFirst = "likeness_first",
    LikenessOfQuestion = "likeness_of_question",
    LikenessOfAnswer = "likeness_of_answer",
    LikenessOfRefusal = "likeness_of_refusal",
    /// How many requests more than this one the parser sees.
    LikenessOfSeveral = "likeness_of_several",
    LikenessPending = "likeness_pending",
    /// How long the utterance is, for a single plain request.
    LikenessOfLong = "likeness_of_long",
    GrammarPlan = "grammar_plan",
    GrammarPlanLong = "grammar_plan_long",
    GrammarPlanPartial = "grammar_plan_partial",
    GrammarPlanReply = "grammar_plan_reply",
    GrammarQuestion = "grammar_question",
    GrammarQuestionPartial = "grammar_question_partial",
    GrammarMismatch = "grammar_mismatch",
    GrammarAnswer = "grammar_answer",
    GrammarAnswerPartial = "grammar_answer_partial",
    GrammarAnswerGuessed = "grammar_answer_guessed",
    GrammarRefusal = "grammar_refusal",
    GrammarRefusalPartial = "grammar_refusal_partial",
    /// How likely its parts mean this, each by itself.
    Parts = "parts",
    /// How likely the words mean this one of those that another way would ask about, and how that way came about.
    Candidate = "candidate",
    CandidateOnly = "candidate_only",
    /// What another way would ask whether to put something down for; and that likely replaces what was asked before.
    Agreed = "agreed",
    AgreedInstead = "agreed_instead",
    // The logarithms of how likely these are, from 0 for the least that counts to 1 for what is sure; and the most of them.
    ParserLog = "parser_log",
    LikenessLog = "likeness_log",
    CandidateLog = "candidate_log",
    Supported = "supported",
    // What it is.
    Plan = "plan",
    PlanAsked = "plan_asked",
    PlanForbidden = "plan_forbidden",
    PlanUnheard = "plan_unheard",
    Steps = "steps",
    Looks = "looks",
    Question = "question",
    /// How likely the words mean one of those that it asks about rather than the others.
    QuestionDecided = "question_decided",
    QuestionOpen = "question_open",
    Mismatch = "mismatch",
    Repeated = "repeated",
    QuestionUnheard = "question_unheard",
    Answer = "answer",
    AnswerWhether = "answer_whether",
    AnswerAsked = "answer_asked",
    /// An answer to a request: that it is done already, or will be left.
    AnswerIdle = "answer_idle",
    Refusal = "refusal",
    // How much it is about what was named.
    Missing = "missing",
    MissingAny = "missing_any",
    Unnamed = "unnamed",
    /// How many requests fewer there are than the parser sees.
    Fewer = "fewer",
    More = "more",
    /// How likely, by the parser, something before it is to be replaced, where this one replaces nothing.
    NotInstead = "not_instead",
}

impl Default for Evidence {
    fn default() -> Self {
        Self { values: [0.0; Self::COUNT] }
    }
}

impl Evidence {
    pub(crate) const fn get(&self, feature: Feature) -> f32 {
        self.values[feature as usize]
    }

    pub(crate) const fn set(&mut self, feature: Feature, value: f32) {
        self.values[feature as usize] = value;
    }

    pub(crate) fn set_if(&mut self, feature: Feature, holds: bool) {
        self.set(feature, f32::from(u8::from(holds)));
    }

    /// Takes over how it goes with what was said, from the way that this one settles.
    pub(crate) fn take_over(&mut self, other: &Self) {
        for feature in [Feature::Fewer, Feature::More, Feature::NotInstead] {
            self.set(feature, other.get(feature));
        }
    }

    /// What speaks for the same in two ways: probabilities add up, of what speaks against both the less counts, of the rest the more.
    pub(crate) fn join(&mut self, other: &Self) {
        const SUMS: [Feature; 6] = [
            Feature::Parser,
            Feature::Likeness,
            Feature::Candidate,
            Feature::Agreed,
            Feature::AgreedInstead,
            Feature::Parts,
        ];
        const LEAST: [Feature; 6] = [
            Feature::ParserLeftOut,
            Feature::LikenessOfSeveral,
            Feature::LikenessOfLong,
            Feature::Fewer,
            Feature::More,
            Feature::NotInstead,
        ];
        let before = *self;
        self.values.iter_mut().zip(other.values).for_each(|(one, other)| *one = one.max(other));
        SUMS.into_iter().for_each(|feature| self.set(feature, before.get(feature) + other.get(feature)));
        LEAST.into_iter().for_each(|feature| self.set(feature, before.get(feature).min(other.get(feature))));
    }
}

/// How much each evidence counts.
#[derive(Clone, Debug)]
pub(crate) struct Weights {
    values: [f32; Evidence::COUNT],
    /// The utility of none of the ways.
    none: f32,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WeightFile {
    none: f32,
    evidence: BTreeMap<String, f32>,
}

impl Weights {
    /// Those in `data/alternatives.toml`.
    pub(crate) fn builtin() -> &'static Self {
        static BUILTIN: LazyLock<Weights> = LazyLock::new(Weights::read);
        &BUILTIN
    }

    fn read() -> Self {
        let file: WeightFile = toml::from_str(include_str!("../data/alternatives.toml"))
            .expect("invariant: the built-in weights parse, which a test holds");
        Self { values: by_name(&file.evidence, Evidence::NAMES), none: file.none }
    }

    /// The probabilities of ways with this evidence; what is left to 1 is that of none of them.
    pub(crate) fn probabilities(&self, ways: &[Evidence]) -> Vec<f32> {
        let utilities: Vec<f32> = ways.iter().map(|way| product(&self.values, &way.values)).collect();
        let highest = utilities.iter().copied().fold(self.none, f32::max);
        let parts: Vec<f32> = utilities.iter().map(|utility| (utility - highest).exp()).collect();
        let whole = parts.iter().sum::<f32>() + (self.none - highest).exp();
        parts.iter().map(|part| part / whole).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_add_up_to_one_with_that_of_none() {
        let weights = Weights::builtin();
        let mut plan = Evidence::default();
        plan.set(Feature::Parser, 0.9);
        plan.set(Feature::Plan, 1.0);
        let both = weights.probabilities(&[plan, Evidence::default()]);
        assert!(both[0] > both[1] && both.iter().sum::<f32>() < 1.0, "{both:?}");
        assert!(weights.probabilities(&[]).is_empty());
        assert!(weights.probabilities(&[plan])[0] > both[0]);
    }
}
