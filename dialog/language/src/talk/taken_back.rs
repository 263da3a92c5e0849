//! What is taken back in the same breath: `turn off the light, no, leave it`, `open the fridge. Actually, scrap that`.

use crate::{
    read::tidy,
    talk::conversation::Conversation,
    words::{
        lexicon::Small,
        token::{self, MAX_CHARS},
    },
};

/// What ends a piece of what is said, and what ends a sentence of it.
const PIECE_ENDS: [char; 8] = ['.', '!', '?', ';', ',', '—', '–', '\n'];
const SENTENCE_ENDS: [char; 4] = ['.', '!', '?', ';'];

impl Conversation<'_> {
    /// What is left of an utterance without what is taken back in it; nothing, where nothing is, or something else is asked for instead.
    pub(crate) fn without_taken_back(&self, utterance: &str) -> Option<String> {
        if utterance.chars().nth(MAX_CHARS).is_some() {
            return None;
        }
        let pieces: Vec<&str> = utterance.split_inclusive(PIECE_ENDS).collect();
        let words: Vec<Vec<String>> = pieces.iter().map(|piece| self.plain_words(piece)).collect();
        let (from, to) = (1..pieces.len()).find_map(|at| Some((self.takes_back_from(&words, at)?, at)))?;
        let after = pieces[to + 1..].concat();
        // `scratch that, the blue one`: another thing is meant, and the rest stays.
        if !self.says_no_more(&after) {
            return None;
        }
        let before = pieces[..self.kept_before(&pieces, from)].concat();
        Some(format!("{before}{after}").trim().to_owned())
    }

    fn plain_words(&self, text: &str) -> Vec<String> {
        tidy::plain(&self.lexicon.normalise(text).0)
    }

    /// The piece with which something begins to be taken back, if the piece at `at` ends that: `no`, and then `leave it`.
    fn takes_back_from(&self, pieces: &[Vec<String>], at: usize) -> Option<usize> {
        let words = &self.lexicon.fillers;
        let is_thought = |piece: &&Vec<String>| words.second_thoughts.exact(piece).is_some();
        let from = at - pieces[..at].iter().rev().take_while(is_thought).count();
        let length = words.second_thoughts.longest(&pieces[at]).map_or(0, |(length, ())| length);
        // `leave it` alone may say where something is to stay.
        let takes_back = |skipped: usize| {
            let said = &pieces[at][skipped..];
            let has_thought = from < at || skipped > 0;
            words.takes_back.exact(said).is_some() || has_thought && words.leaves.exact(said).is_some()
        };
        ((takes_back(0) || takes_back(length)) && pieces[..from].iter().any(|piece| !piece.is_empty())).then_some(from)
    }

    /// Whether words behind it ask for nothing, and name nothing that could be meant instead.
    fn says_no_more(&self, after: &str) -> bool {
        let words = self.plain_words(after);
        let is_courtesy = |small: &Small| matches!(small, Small::Hello | Small::Thanks);
        let asks = self.is_request(&words) || after.contains('?') || !self.small(&words).iter().all(is_courtesy);
        !asks && !self.names_anything(&words) && self.answer_phrase(&words).is_none()
    }

    /// How many pieces stay in front of what is taken back: the last request is gone, with what belongs to it.
    fn kept_before(&self, pieces: &[&str], from: usize) -> usize {
        let ends = |piece: &&str| piece.trim_end().ends_with(SENTENCE_ENDS);
        let is_in_sentence = !ends(&pieces[from - 1]);
        let last = if is_in_sentence { from } else { from - 1 };
        let start = pieces[..last].iter().rposition(ends).map_or(0, |at| at + 1);
        let asks = |at: &usize| {
            let (words, _) = self.lexicon.normalise(&pieces[*at..from].concat());
            self.is_request(&tidy::tidied(self.lexicon, &words))
        };
        // A statement or a question is no less so.
        let stays = if is_in_sentence { start } else { from };
        (start..from).rev().find(asks).unwrap_or(stays)
    }
}

/// Whether anything is said in a text.
pub(crate) fn says_anything(text: &str) -> bool {
    token::words(text).iter().any(|word| !token::is_punctuation(word))
}
