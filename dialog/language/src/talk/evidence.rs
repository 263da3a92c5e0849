//! How likely each way to take an utterance is the one that is meant.
//!
//! A conditional logit (McFadden 1974) over the ways and none of them: each has a utility, linear in what speaks for it, and the
//! probabilities are the softmax of these and of 0 for none. The weights are fitted to labelled utterances of people whose words the rewriter
//! had not read, by `dialog/language/fit`.

use std::{collections::BTreeMap, sync::LazyLock};

use crate::{
    ground::confidence::{by_name, product, softmax},
    talk::{conversation::Conversation, faithful::covered, prior::Outcome, source::Source, way::Way},
    understanding::{Clarification, Understanding},
};

/// A way to take an utterance, by what a rewriter wrote.
pub(crate) struct Hypothesis {
    pub(crate) way: Way,
    /// As it was read, and how likely it is by the rewriter, with all that come to the same.
    pub(crate) text: String,
    pub(crate) probability: f32,
    pub(crate) edit: Edit,
    pub(crate) outcome: Outcome,
    pub(crate) is_unfaithful: bool,
    /// How many things were said that it does not name, and how many it names of which nobody spoke.
    pub(crate) unnamed: usize,
    pub(crate) unspoken: usize,
}

/// What was made of what a rewriter wrote.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Edit {
    /// Nothing.
    Kept,
    /// What nobody spoke of and is not around became what was said.
    Renamed,
    /// The same with what is around.
    Swapped,
    /// What it would be done with is left out.
    WithoutMeans,
}

/// The n-best list of a rewriter.
pub(crate) struct NBest {
    /// What the grammar reads of it, the likeliest first.
    pub(crate) hypotheses: Vec<Hypothesis>,
    /// How likely all that was written is together.
    pub(crate) all: f32,
    /// Whether the grammar does not read what is likeliest.
    pub(crate) is_first_unread: bool,
}

/// What speaks for a way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evidence {
    /// By [`Self::NAMES`], in their order.
    pub values: [f32; Self::COUNT],
}

impl Evidence {
    /// How many there are.
    pub const COUNT: usize = 14;

    /// Their names. Those without a unit here are 0 or 1.
    pub const NAMES: [&str; Self::COUNT] = [
        // Always 1.
        "always",
        // By the rewriter, natural logarithms: of its probability, and of its share of all that is written.
        "log_probability",
        "log_share",
        // A thing that nobody spoke of became what was said: one that is not around, or one that is; what it would be done with is left out.
        "renamed",
        "swapped",
        "without_means",
        // It changes nothing; it goes to a room and acts in another.
        "in_vain",
        "astray",
        // It asks something, other than which thing is meant.
        "asks",
        // Things that were said and are not named, things named that nobody spoke of, and of these those that are not around: 3 at most.
        "unnamed",
        "unspoken",
        "invented",
        // The share of the words that were said which is written, too.
        "covered",
        // The grammar takes it so, too.
        "as_grammar",
    ];
}

/// The least logarithm of a probability that counts.
const FAINTEST: f32 = -12.0;

impl Conversation<'_> {
    /// What speaks for each of the ways.
    pub(crate) fn evidence(&self, n_best: &NBest, source: &Source, by_grammar: Option<&Way>) -> Vec<Evidence> {
        let is = |holds: bool| f32::from(u8::from(holds));
        let few = |count: usize| count.min(3) as f32;
        let log = |share: f32| share.max(f32::MIN_POSITIVE).ln().max(FAINTEST);
        let of = |Hypothesis { way, text, probability, edit, outcome, unnamed, unspoken, .. }: &Hypothesis| {
            let asks =
                matches!(&way.understanding, Understanding::Question { kind, .. } if *kind != Clarification::Reference);
            let values = [
                1.0,
                log(*probability),
                log(probability / n_best.all),
                is(*edit == Edit::Renamed),
                is(*edit == Edit::Swapped),
                is(*edit == Edit::WithoutMeans),
                is(*outcome == Outcome::InVain),
                is(*outcome == Outcome::Astray),
                is(asks),
                few(*unnamed),
                few(*unspoken),
                few(self.invented(text, source)),
                covered(text, source),
                is(by_grammar.is_some_and(|grammar| way.is_same(grammar))),
            ];
            Evidence { values }
        };
        n_best.hypotheses.iter().map(of).collect()
    }
}

impl Evidence {
    /// The utility of a way.
    pub(crate) fn utility(&self) -> f32 {
        static WEIGHTS: LazyLock<[f32; Evidence::COUNT]> = LazyLock::new(weights);
        product(WEIGHTS.as_slice(), &self.values)
    }
}

/// Those in `data/ways.toml`.
fn weights() -> [f32; Evidence::COUNT] {
    let file: BTreeMap<String, f32> = toml::from_str(include_str!("../../data/ways.toml"))
        .expect("invariant: the built-in weights parse, which a test holds");
    by_name(&file, Evidence::NAMES)
}

/// The probabilities of ways of these utilities, where none of them has a utility of 0.
pub(crate) fn probabilities(utilities: &[f32]) -> Vec<f32> {
    let mut shares = softmax(&[utilities, &[0.0]].concat());
    shares.pop();
    shares
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_evidence_has_a_weight_and_what_is_likelier_by_the_rewriter_is_likelier() {
        let of = |share: f32| {
            let mut values = [0.0; Evidence::COUNT];
            (values[0], values[1], values[2]) = (1.0, share.ln(), share.ln());
            Evidence { values }.utility()
        };
        let shares = probabilities(&[of(0.6), of(0.2)]);
        assert!(shares[0] > shares[1] && shares.iter().sum::<f32>() < 1.0, "{shares:?}");
    }
}
