//! What the rewriter of `dialog/parser` makes of an utterance: plain requests, which the grammar understands.

use std::sync::LazyLock;

use cohabit_parser::{
    Rewriting,
    request::{Act, Social},
};

use crate::{
    alternatives::{Alternative, is_same, lines},
    cache::Cache,
    context::Context,
    conversation::Conversation,
    evidence::Evidence,
    parsed::{Worth, small_talk, transcript, worth},
    token,
    understanding::Understanding,
    wording::Wording,
};

/// How likely the likeliest must be meant for nobody else to be asked.
const SURE: f32 = 0.6;
/// One in so many words that nobody ever met is too much to guess at.
const STRANGE: usize = 6;
/// How much the other readers are believed where the rewriter is not sure.
const OTHERS: f32 = 0.5;

impl Conversation<'_> {
    /// What the rewriter takes it for, the likeliest first; nothing of what the grammar reads to the last word, or others need not be asked about.
    pub(crate) fn rewritten(&self, wording: &Wording<'_>, context: &Context) -> Vec<Alternative> {
        let by_grammar = self.read(wording.utterance, context);
        let is_plain = self.is_plain(wording) && worth(&by_grammar.understanding) >= Worth::Answered;
        // An unknown verb is no deed, and of another language nothing is guessed.
        let said = wording.words.iter().filter(|word| !token::is_punctuation(word)).count();
        let is_strange = !wording.unheard.is_empty() && wording.unheard.len() * STRANGE >= said;
        if is_plain || is_strange || self.speaks_for_itself(wording, &by_grammar) {
            return Vec::new();
        }
        self.ways_of_rewriter(wording, context)
    }

    fn ways_of_rewriter(&self, wording: &Wording<'_>, context: &Context) -> Vec<Alternative> {
        let mut ways: Vec<Alternative> = Vec::new();
        for (at, rewriting) in self.rewritings(wording.utterance, context).iter().enumerate() {
            let way = match self.of_rewriting(rewriting, wording, context) {
                Some(way) => way,
                // It keeps a name that nobody knows: others are mere guesses.
                None if at == 0 => return Vec::new(),
                None => continue,
            };
            match ways.iter_mut().find(|other| is_same(&other.understanding, &way.understanding)) {
                Some(other) => other.probability += rewriting.probability,
                None => ways.push(Alternative { probability: rewriting.probability, ..way }),
            }
        }
        // What it gives a probability of p is right about as often as √p, by writers that it was not fitted to: others may have said it otherwise.
        ways.iter_mut().for_each(|way| way.probability = way.probability.sqrt());
        ways.sort_by(|one, other| other.probability.total_cmp(&one.probability));
        ways
    }

    fn of_rewriting(&self, rewriting: &Rewriting, wording: &Wording<'_>, context: &Context) -> Option<Alternative> {
        let mut then = context.at_new_utterance();
        let understanding = match rewriting.text.as_str() {
            "?" => return None,
            "none" => Understanding::answer(small_talk(Social::Agreement)),
            "social" => self.small_talk_about(wording, &then),
            requests => {
                let said = requests.replace("; ", ". ");
                let said = self.with_lab_named(&self.wording(&said)).unwrap_or(said);
                let plain = self.wording(&said);
                let understanding = self.understand_said(&said, &mut then);
                let is_known = self.is_plain(&plain) && worth(&understanding) >= Worth::Answered;
                // Stops were heard before.
                if !is_known || matches!(understanding, Understanding::Stop { .. }) {
                    return None;
                }
                understanding
            }
        };
        Some(Alternative::new(understanding, then, Evidence::default()))
    }

    /// What is said to who asks for nothing.
    fn small_talk_about(&self, wording: &Wording<'_>, context: &Context) -> Understanding {
        let readings = self.readings(wording.utterance, context);
        let requests = readings.iter().flat_map(|reading| &reading.requests);
        let kind = requests.rev().find_map(|request| match request.act {
            Act::Social(social) => Some(social),
            _ => None,
        });
        self.reply_to_talk(wording.utterance, kind.unwrap_or(Social::SmallTalk), context)
    }

    fn rewritings(&self, utterance: &str, context: &Context) -> Vec<Rewriting> {
        static WRITTEN: LazyLock<Cache<Vec<Rewriting>>> = LazyLock::new(Cache::default);
        let Some(rewriter) = self.rewriter else { return Vec::new() };
        let lines = lines(context);
        WRITTEN.get_or_insert_with(&transcript(utterance, &lines), || rewriter().rewrite(utterance, &lines))
    }
}

/// The likeliest way, if the rewriter is sure of it.
pub(crate) fn sure(ways: &[Alternative]) -> Option<&Alternative> {
    ways.first().filter(|likeliest| likeliest.probability >= likeliest.least(&[]).max(SURE))
}

/// What others found with what the rewriter did, the likeliest first: what both take it for is likelier than either says.
pub(crate) fn pooled(others: Vec<Alternative>, rewritten: &[Alternative]) -> Vec<Alternative> {
    if rewritten.is_empty() {
        return others;
    }
    let mut all: Vec<Alternative> = rewritten.to_vec();
    for mut other in others {
        other.probability *= OTHERS;
        match all.iter_mut().find(|one| is_same(&one.understanding, &other.understanding)) {
            Some(one) => {
                other.probability = 1.0 - (1.0 - one.probability) * (1.0 - other.probability);
                *one = other;
            }
            None => all.push(other),
        }
    }
    all.sort_by(|one, other| other.probability.total_cmp(&one.probability));
    all
}
