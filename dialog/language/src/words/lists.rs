//! The words that one reader each asks for, as they lie in `data`: the file that a table is named after says what each list is.

use std::collections::{BTreeMap, BTreeSet};

use serde::Deserialize;

use crate::words::table::{self, PhraseTable};

/// The words of talk: `data/chatter.toml` says what each list is.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Chatter {
    pub(crate) remarks: PhraseTable<()>,
    pub(crate) tellers: BTreeSet<String>,
    pub(crate) subordinators: BTreeSet<String>,
    pub(crate) before_requests: BTreeSet<String>,
    pub(crate) reports: BTreeSet<String>,
}

/// The words of conditions: `data/conditions.toml` says what each list is.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Conditions {
    pub(crate) holds: PhraseTable<()>,
    pub(crate) fails: PhraseTable<()>,
    pub(crate) asks: BTreeSet<String>,
    pub(crate) courtesies: PhraseTable<()>,
    pub(crate) own: PhraseTable<()>,
    pub(crate) copulas: BTreeSet<String>,
    pub(crate) otherwise: PhraseTable<()>,
    pub(crate) pronouns: BTreeSet<String>,
    pub(crate) adverbs: BTreeSet<String>,
    #[serde(deserialize_with = "table::of_meanings")]
    pub(crate) becomes: PhraseTable<String>,
    pub(crate) nobody: PhraseTable<()>,
    pub(crate) negations: BTreeSet<String>,
}

/// The words that only fill: `data/fillers.toml` says what each list is.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Fillers {
    pub(crate) likes: BTreeSet<String>,
    pub(crate) hesitations: BTreeSet<String>,
    pub(crate) numbered: BTreeSet<String>,
    pub(crate) pauses: PhraseTable<()>,
    pub(crate) adverbs: BTreeSet<String>,
    pub(crate) second_thoughts: PhraseTable<()>,
    pub(crate) takes_back: PhraseTable<()>,
    pub(crate) leaves: PhraseTable<()>,
    pub(crate) besides: PhraseTable<()>,
    pub(crate) suggests: PhraseTable<()>,
}

/// The words of waiting: `data/waiting.toml` says what each list is.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct WaitingWords {
    pub(crate) waits: PhraseTable<()>,
    pub(crate) lets: PhraseTable<()>,
    pub(crate) running: PhraseTable<()>,
    pub(crate) runs: PhraseTable<()>,
    pub(crate) lasting: PhraseTable<()>,
    pub(crate) tells: PhraseTable<()>,
    pub(crate) delays: PhraseTable<()>,
    pub(crate) about: PhraseTable<()>,
    #[serde(deserialize_with = "table::of_meanings")]
    pub(crate) units_s: PhraseTable<f32>,
    pub(crate) until: PhraseTable<()>,
    pub(crate) whens: PhraseTable<()>,
    pub(crate) joints: PhraseTable<()>,
}

/// The words of where somebody thinks that something is: `data/hints.toml` says what each list is.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct HintWords {
    pub(crate) guesses: PhraseTable<()>,
    pub(crate) between: PhraseTable<()>,
    pub(crate) subjects: PhraseTable<()>,
    pub(crate) subjects_plainly: PhraseTable<()>,
    pub(crate) plainly: PhraseTable<()>,
    pub(crate) supposedly: PhraseTable<()>,
    pub(crate) owed: PhraseTable<()>,
    pub(crate) persons: PhraseTable<()>,
    pub(crate) kept: PhraseTable<()>,
    pub(crate) things: PhraseTable<()>,
    pub(crate) either: PhraseTable<()>,
    pub(crate) not_after: BTreeSet<String>,
}

/// The words of wishing: `data/wishes.toml` says what each list is.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Wishes {
    pub(crate) wishers: BTreeSet<String>,
    pub(crate) wishes: BTreeSet<String>,
    pub(crate) musts: PhraseTable<()>,
    pub(crate) stayers: BTreeSet<String>,
    pub(crate) as_is: PhraseTable<()>,
    pub(crate) makers: BTreeSet<String>,
    pub(crate) orders: BTreeSet<String>,
    pub(crate) measures: BTreeSet<String>,
    pub(crate) between: BTreeSet<String>,
    pub(crate) after: BTreeSet<String>,
    pub(crate) dirt: BTreeSet<String>,
    pub(crate) removers: PhraseTable<()>,
    pub(crate) ensurers: PhraseTable<()>,
    pub(crate) performers: PhraseTable<()>,
    pub(crate) undoes: BTreeMap<String, String>,
    pub(crate) subjecters: BTreeSet<String>,
    pub(crate) infecters: BTreeSet<String>,
    pub(crate) shooters: PhraseTable<()>,
    /// Verbs of moving a thing, and where to, if anywhere else will do.
    pub(crate) movers: BTreeSet<String>,
    pub(crate) clearers: PhraseTable<()>,
    pub(crate) asides: PhraseTable<()>,
    pub(crate) to_dry: PhraseTable<()>,
}

/// The words of questions that want a yes or a no: `data/yes_no.toml` says what each list is.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct YesNo {
    pub(crate) past: BTreeSet<String>,
    pub(crate) perfect: BTreeSet<String>,
    pub(crate) subjects: BTreeSet<String>,
    pub(crate) persons: BTreeSet<String>,
    pub(crate) stated: BTreeSet<String>,
    pub(crate) being: BTreeSet<String>,
    pub(crate) modals: BTreeSet<String>,
    pub(crate) things: BTreeSet<String>,
    pub(crate) knowing: PhraseTable<()>,
    there: PhraseTable<()>,
    around: PhraseTable<()>,
    stands: PhraseTable<()>,
    pub(crate) passive: BTreeSet<String>,
    pub(crate) between: BTreeSet<String>,
    filler: PhraseTable<()>,
    sound: PhraseTable<()>,
    unsound: PhraseTable<()>,
    whole: PhraseTable<()>,
    pub(crate) done: PhraseTable<()>,
    meals: PhraseTable<()>,
    floor: BTreeSet<String>,
    pub(crate) cereals: BTreeSet<String>,
    back: PhraseTable<()>,
    #[serde(deserialize_with = "table::of_meanings")]
    pub(crate) gets: PhraseTable<String>,
}

impl YesNo {
    /// How words that follow a kind of things ask which of them there are, the longest first, and how many words do.
    pub(crate) fn asks_which(&self, words: &[String]) -> Vec<(usize, Whereabouts)> {
        let tables = [
            (&self.there, Whereabouts::Anywhere),
            (&self.around, Whereabouts::Here),
            (&self.stands, Whereabouts::Told),
        ];
        let length = |table: &PhraseTable<()>| table.longest(words).map(|(length, ())| length);
        let mut found: Vec<(usize, Whereabouts)> =
            tables.into_iter().filter_map(|(table, whereabouts)| Some((length(table)?, whereabouts))).collect();
        found.sort_by_key(|(length, _)| std::cmp::Reverse(*length));
        found
    }

    /// Whether words add nothing to what is claimed: `still there`.
    pub(crate) fn is_filler(&self, words: &[String]) -> bool {
        let mut left = words;
        while let Some((length, ())) = self.filler.longest(left) {
            left = &left[length..];
        }
        left.is_empty()
    }

    /// Words without those at their end that add nothing.
    pub(crate) fn without_fillers<'w>(&self, words: &'w [String]) -> &'w [String] {
        let end = (0..words.len()).find(|at| self.is_filler(&words[*at..])).unwrap_or(words.len());
        &words[..end]
    }

    /// Whether words are of the floor.
    pub(crate) fn says_floor(&self, words: &[String]) -> bool {
        words.iter().any(|word| self.floor.contains(word))
    }

    /// Whether words end by saying that something has come to its end.
    pub(crate) fn says_done(&self, words: &[String]) -> bool {
        self.is_last_of(words, &self.done)
    }

    /// Whether words end by saying that something is where it was before.
    pub(crate) fn says_back(&self, words: &[String]) -> bool {
        self.is_last_of(words, &self.back)
    }

    /// Whether words end by saying that nothing is missing in something.
    pub(crate) fn says_whole(&self, words: &[String]) -> bool {
        self.is_last_of(words, &self.whole)
    }

    /// Whether words say that a meal is done, and nothing else: `dinner ready yet`.
    pub(crate) fn says_meal_is_done(&self, words: &[String]) -> bool {
        let is_done =
            |rest: &[String]| self.done.longest(rest).is_some_and(|(length, ())| self.is_filler(&rest[length..]));
        self.meals.longest(words).is_some_and(|(length, ())| is_done(&words[length..]))
    }

    /// Whether words end by saying that something works as it should, or that it does not.
    pub(crate) fn soundness(&self, words: &[String]) -> Option<bool> {
        if self.is_last_of(words, &self.unsound) {
            return Some(false);
        }
        self.is_last_of(words, &self.sound).then_some(true)
    }

    /// Whether words say something and end with one of these phrases.
    fn is_last_of(&self, words: &[String], phrases: &PhraseTable<()>) -> bool {
        (1..words.len())
            .any(|at| phrases.longest(&words[at..]).is_some_and(|(length, ())| self.is_filler(&words[at + length..])))
    }
}

/// Where things are of which it is asked which there are.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Whereabouts {
    Anywhere,
    Here,
    /// Where words say that follow.
    Told,
}

/// What is said to a kind of talk that asks for nothing.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct TalkReply {
    pub(crate) reply: String,
    /// The same to a question.
    pub(crate) asked: Option<String>,
}
