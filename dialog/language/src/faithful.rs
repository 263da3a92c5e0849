//! Whether plain requests keep to what was said: a rewriter that has read of many red mugs may write of one that nobody spoke of, and a
//! condition may lose its `not`.

use std::collections::BTreeSet;

use cohabit_cdf::Property;

use crate::{conversation::Conversation, lexicon::Lexicon, token};

/// How likely a condition is meant the other way round than was said.
const TURNED_ROUND: f32 = 0.2;

/// What was said, and before.
pub(crate) struct Heard {
    words: BTreeSet<String>,
    /// Whether a condition was denied: `if it is not`.
    is_denied: bool,
    /// Whether anything was.
    has_denial: bool,
}

impl Heard {
    pub(crate) fn new(lexicon: &Lexicon, utterance: &str, lines: &[(bool, String)]) -> Self {
        let (said, _) = lexicon.normalise(utterance);
        let before = lines.iter().flat_map(|(_, line)| lexicon.normalise(line).0);
        Self {
            is_denied: denies_condition(lexicon, &said),
            has_denial: said.iter().any(|word| lexicon.ifs.negations.contains(word)),
            words: said.iter().cloned().chain(before).collect(),
        }
    }
}

impl Conversation<'_> {
    /// Plain requests without the colours of things that nobody named: `the red mug` where no red was spoken of. Devices may be called
    /// by theirs.
    pub(crate) fn without_invention(&self, text: &str, heard: &Heard) -> String {
        let words: Vec<&str> = text.split(' ').collect();
        let lexicon = self.lexicon;
        let is_carried = |rest: &[&str]| {
            let rest: Vec<String> = rest.iter().flat_map(|word| token::words(word)).collect();
            let named = lexicon.classes.longest(&rest).map(|(_, namings)| namings);
            named.is_some_and(|namings| {
                namings.iter().all(|naming| self.catalog.class(naming.class).has(Property::Pickupable))
            })
        };
        let is_invented = |at: usize| {
            let color = [words[at].to_owned()];
            lexicon.colors.exact(&color).is_some() && !heard.words.contains(words[at]) && is_carried(&words[at + 1..])
        };
        let kept = (0..words.len()).filter(|at| !is_invented(*at)).map(|at| words[at]);
        kept.collect::<Vec<_>>().join(" ")
    }

    /// How likely a condition is as it was said, by what it denies alone.
    pub(crate) fn polarity(&self, text: &str, heard: &Heard) -> f32 {
        let conditions: Vec<Vec<String>> = text
            .split("; ")
            .filter_map(|request| request.strip_prefix("if "))
            .map(|request| token::words(request.split(',').next().unwrap_or(request)))
            .collect();
        let denies = |words: &Vec<String>| words.iter().any(|word| self.lexicon.ifs.negations.contains(word));
        let is_said = |words: &Vec<String>| words.last().is_some_and(|last| heard.words.contains(last));
        let (denied, claimed): (Vec<_>, Vec<_>) = conditions.into_iter().partition(denies);
        let adds = !heard.has_denial && !denied.is_empty();
        let drops = heard.is_denied && denied.is_empty() && claimed.iter().any(is_said);
        if adds || drops { TURNED_ROUND } else { 1.0 }
    }
}

/// `if it is not`, `if not`, `unless`.
fn denies_condition(lexicon: &Lexicon, words: &[String]) -> bool {
    let after = |at: usize| lexicon.ifs.holds.longest(&words[at..]).map(|(length, ())| at + length);
    (0..words.len()).filter_map(after).any(|start| {
        let end =
            words[start..].iter().position(|word| token::is_punctuation(word)).map_or(words.len(), |end| start + end);
        words[start..end.min(start + CLAUSE)].iter().any(|word| lexicon.ifs.negations.contains(word))
    })
}

/// Within so many words after `if` its `not` is said.
const CLAUSE: usize = 6;
