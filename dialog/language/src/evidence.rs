//! What speaks for a way to understand an utterance, and how probable that makes it.
//!
//! A conditional logit (McFadden 1974), as for referring expressions (see [`crate::confidence`]): each way has a utility, linear in its
//! [`Evidence`], and their probabilities are the softmax of these, with one more alternative, that none of them is meant. The likeliest are
//! then read together with what was said, by the re-ranker of `dialog/parser`; a second logit over what that says ([`Fit`]) and the same
//! evidence has the last word: how likely a way is meant is what becomes of it in such a situation. The weights are fitted to labelled
//! utterances by `dialog/language/fit`.

use std::{collections::BTreeMap, sync::LazyLock};

use serde::Deserialize;

use crate::confidence::{by_name, product};

/// Declares a kind of evidence: each with its name in `data/alternatives.toml`.
macro_rules! features {
    ($(#[$about:meta])* $evidence:ident, $features:ident: $($(#[$doc:meta])* $feature:ident = $name:literal,)*) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $evidence {
            /// By [`Self::NAMES`], in their order.
            pub values: [f32; Self::COUNT],
        }

        /// Which evidence.
        #[derive(Clone, Copy, Debug)]
        pub(crate) enum $features {
            $($(#[$doc])* $feature,)*
        }

        impl $evidence {
            /// Their names.
            pub const NAMES: [&str; Self::COUNT] = [$($name,)*];

            /// How many there are.
            pub const COUNT: usize = [$($name,)*].len();

            pub(crate) const fn get(&self, feature: $features) -> f32 {
                self.values[feature as usize]
            }

            pub(crate) const fn set(&mut self, feature: $features, value: f32) {
                self.values[feature as usize] = value;
            }

            pub(crate) fn set_if(&mut self, feature: $features, holds: bool) {
                self.set(feature, f32::from(u8::from(holds)));
            }
        }

        impl Default for $evidence {
            fn default() -> Self {
                Self { values: [0.0; Self::COUNT] }
            }
        }
    };
}

features! {
    /// What speaks for a way to understand an utterance, and against it, before it is read together with what was said.
    Evidence, Feature:
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
    /// Whether the grammar reads all to the last word.
    GrammarPlain = "grammar_plain",
    GrammarPlainLong = "grammar_plain_long",
    GrammarPlainShort = "grammar_plain_short",
    /// How likely its parts mean this, each by itself.
    Parts = "parts",
    /// What the things that were named may be asked for.
    Names = "names",
    /// The last request with what is named now: in place of something, or besides; how long it is, whether it asks for something by
    /// itself, and whether the robot waits for an answer.
    FollowUp = "follow_up",
    FollowUpReplaced = "follow_up_replaced",
    FollowUpAdded = "follow_up_added",
    FollowUpLong = "follow_up_long",
    FollowUpAsks = "follow_up_asks",
    FollowUpPending = "follow_up_pending",
    /// What share it has of all others of the kind that something was done with.
    FollowUpOther = "follow_up_other",
    /// It takes what the robot asked about: whether that is only one, how much the words are like it, whether they sound like a yes and a
    /// no, whether they name something, how long they are, and whether the parser takes them for a request.
    Reply = "reply",
    ReplyOnly = "reply_only",
    ReplyLike = "reply_like",
    ReplyAgrees = "reply_agrees",
    ReplyDenies = "reply_denies",
    ReplyNames = "reply_names",
    ReplyLong = "reply_long",
    ReplyAsks = "reply_asks",
    /// It leaves what the robot asked about, and whether the words sound like a no.
    ReplyLeaves = "reply_leaves",
    ReplyLeavesDenied = "reply_leaves_denied",
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
    /// Some of the words are none of the grammar's.
    PlanUnknown = "plan_unknown",
    /// What it changes is not simply put back.
    PlanLasting = "plan_lasting",
    /// It begins what is left of the mission.
    PlanOfMission = "plan_of_mission",
    /// It was done just before.
    PlanRepeats = "plan_repeats",
    /// More is to be done later.
    Later = "later",
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
    AnswerIdleAsked = "answer_idle_asked",
    AnswerUnheard = "answer_unheard",
    /// It is about nothing that was named, though it points at something.
    AnswerUnnamed = "answer_unnamed",
    Refusal = "refusal",
    // How much it is about what was named.
    Missing = "missing",
    MissingAny = "missing_any",
    Unnamed = "unnamed",
    UnnamedUnheard = "unnamed_unheard",
    /// How many requests fewer there are than the parser sees.
    Fewer = "fewer",
    More = "more",
    /// How likely, by the parser, something before it is to be replaced, where this one replaces nothing.
    NotInstead = "not_instead",
}

features! {
    /// What speaks for it once the re-ranker has read it together with what was said.
    Fit, FitFeature:
    /// How likely it is by [`Evidence`], and that none of the ways is meant, on a logarithmic scale.
    First = "first",
    FirstNone = "first_none",
    /// The re-ranker's score; its share among all scores; whether it is the highest, and by how much.
    Score = "score",
    Share = "share",
    Best = "best",
    Lead = "lead",
    ScoreOfQuestion = "score_of_question",
    ScoreOfAnswer = "score_of_answer",
    ScoreOfRefusal = "score_of_refusal",
}

impl Fit {
    /// The least probability that counts.
    const LEAST: f32 = 0.001;
    /// The highest score that counts.
    const MOST: f32 = 8.0;

    /// How likely it is by [`Evidence`], and none of the ways.
    #[must_use]
    pub fn with_first(mut self, probability: f32, none: f32) -> Self {
        let logarithm = |probability: f32| 1.0 - probability.clamp(Self::LEAST, 1.0).ln() / Self::LEAST.ln();
        self.set(FitFeature::First, logarithm(probability));
        self.set(FitFeature::FirstNone, logarithm(none));
        self
    }

    /// What the re-ranker's scores say of each way, and that of none of them, which is 0.
    pub(crate) fn of_scores(scores: &[f32]) -> Vec<Self> {
        let bounded: Vec<f32> = scores.iter().map(|score| score.clamp(-Self::MOST, Self::MOST)).collect();
        let whole: f32 = bounded.iter().map(|score| score.exp()).sum::<f32>() + 1.0;
        let fit = |at: usize| {
            let score = bounded[at];
            let others = bounded.iter().enumerate().filter(|(other, _)| *other != at).map(|(_, score)| *score);
            let lead = score - others.fold(-Self::MOST, f32::max);
            let mut fit = Self::default();
            fit.set(FitFeature::Score, score / Self::MOST);
            fit.set(FitFeature::Share, score.exp() / whole);
            fit.set_if(FitFeature::Best, lead > 0.0);
            fit.set(FitFeature::Lead, (lead / Self::MOST).clamp(0.0, 1.0));
            fit
        };
        (0..scores.len()).map(fit).collect()
    }
}

impl Evidence {
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

/// How much each evidence counts, and the utility of none of the ways.
#[derive(Clone, Debug)]
pub(crate) struct Weights {
    /// Before the re-ranker has read the ways.
    first: [f32; Evidence::COUNT],
    first_none: f32,
    /// After it.
    fit: [f32; Fit::COUNT],
    second: [f32; Evidence::COUNT],
    second_none: f32,
}

/// `data/alternatives.toml`: a weight by the name of each feature, and one of none of the ways.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WeightFile {
    first: BTreeMap<String, f32>,
    fit: BTreeMap<String, f32>,
    second: BTreeMap<String, f32>,
}

impl Weights {
    /// Those in `data/alternatives.toml`.
    pub(crate) fn builtin() -> &'static Self {
        static BUILTIN: LazyLock<Weights> = LazyLock::new(Weights::read);
        &BUILTIN
    }

    fn read() -> Self {
        let WeightFile { first, fit, second } = toml::from_str(include_str!("../data/alternatives.toml"))
            .expect("invariant: the built-in weights parse, which a test holds");
        let [[first_none], [second_none]] = [&first, &second].map(|weights| by_name(weights, ["none"]));
        Self {
            first: by_name(&first, Evidence::NAMES),
            first_none,
            fit: by_name(&fit, Fit::NAMES),
            second: by_name(&second, Evidence::NAMES),
            second_none,
        }
    }

    /// The probabilities of ways with this evidence, and what else speaks for each, nats; what is left to 1 is that of none of them.
    pub(crate) fn probabilities(&self, ways: &[(Evidence, f32)]) -> Vec<f32> {
        let utilities = ways.iter().map(|(evidence, prior)| product(&self.first, &evidence.values) + prior);
        shares(&utilities.collect::<Vec<_>>(), self.first_none)
    }

    /// The same of ways that were read together with what was said.
    pub(crate) fn fit_probabilities(&self, ways: &[(Fit, Evidence, f32)]) -> Vec<f32> {
        let utility = |(fit, evidence, prior): &(Fit, Evidence, f32)| {
            product(&self.fit, &fit.values) + product(&self.second, &evidence.values) + prior
        };
        shares(&ways.iter().map(utility).collect::<Vec<_>>(), self.second_none)
    }
}

/// The softmax of utilities, without that of none of them; negative infinity, where one of them must be meant.
pub(crate) fn shares(utilities: &[f32], none: f32) -> Vec<f32> {
    let highest = utilities.iter().copied().fold(none, f32::max);
    let parts: Vec<f32> = utilities.iter().map(|utility| (utility - highest).exp()).collect();
    let whole = parts.iter().sum::<f32>() + (none - highest).exp();
    parts.iter().map(|part| part / whole).collect()
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
        let both = weights.probabilities(&[(plan, 0.0), (Evidence::default(), 0.0)]);
        assert!(both[0] > both[1] && both.iter().sum::<f32>() < 1.0, "{both:?}");
        assert!(weights.probabilities(&[]).is_empty());
        assert!(weights.probabilities(&[(plan, 0.0)])[0] > both[0]);
        assert!(weights.probabilities(&[(plan, 1.0), (Evidence::default(), 0.0)])[0] > both[0]);
    }
}
