//! What the network reads: the last lines of the dialog, then the utterance.

use std::ops::Range;

use crate::{
    Said,
    words::{Vocabulary, words},
};

/// The most lines before the utterance that are read, the words of one, and of all.
const MOST_LINES: usize = 4;
const MOST_LINE_WORDS: usize = 30;
const MOST_CONTEXT_WORDS: usize = 60;
/// The most words and pieces of an utterance and what was said before.
pub(crate) const MOST_WORDS: usize = 120;
pub(crate) const MOST_PIECES: usize = 190;

/// Who says a piece: what the person said before, the robot, what is said now.
const PERSON: u8 = 0;
const ROBOT: u8 = 1;
const NOW: u8 = 2;

/// Lines of a dialog as words and pieces.
pub(crate) struct Source<'a> {
    /// The words; marks between lines are empty ones.
    pub(crate) words: Vec<&'a str>,
    /// The text that each word is part of, and where.
    places: Vec<(&'a str, Range<usize>)>,
    pub(crate) pieces: Vec<u32>,
    pub(crate) speakers: Vec<u8>,
    /// The pieces of each word.
    pub(crate) spans: Vec<Range<usize>>,
}

impl<'a> Source<'a> {
    /// Nothing, if the utterance is too long to be read.
    pub(crate) fn new(vocabulary: &Vocabulary, utterance: &'a str, before: &[Said<'a>]) -> Option<Self> {
        let now = words(utterance);
        if now.is_empty() || now.len() > MOST_WORDS {
            return None;
        }
        let mut source = Self {
            words: Vec::new(),
            places: Vec::new(),
            pieces: vec![vocabulary.piece("[CLS]")],
            speakers: vec![PERSON],
            spans: Vec::new(),
        };
        for (line, words) in recent(before) {
            let (mark, speaker) = if line.by_robot { ("[unused1]", ROBOT) } else { ("[unused2]", PERSON) };
            source.add(vocabulary.piece(mark), vocabulary, line.text, &words, speaker);
        }
        source.add(vocabulary.piece("[SEP]"), vocabulary, utterance, &now, NOW);
        if source.pieces.len() <= MOST_PIECES {
            return Some(source);
        }
        // Too long with what was said before.
        if before.is_empty() { None } else { Self::new(vocabulary, utterance, &[]) }
    }

    fn add(&mut self, mark: u32, vocabulary: &Vocabulary, text: &'a str, words: &[Range<usize>], speaker: u8) {
        self.add_word(vec![mark], text, 0..0, speaker);
        for word in words {
            self.add_word(vocabulary.pieces(&text[word.clone()]), text, word.clone(), speaker);
        }
    }

    fn add_word(&mut self, pieces: Vec<u32>, text: &'a str, place: Range<usize>, speaker: u8) {
        let begin = self.pieces.len();
        self.speakers.extend(std::iter::repeat_n(speaker, pieces.len()));
        self.pieces.extend(pieces);
        self.spans.push(begin..self.pieces.len());
        self.words.push(&text[place.clone()]);
        self.places.push((text, place));
    }

    /// The text from one word to another, as it was said; of two lines, that of the last.
    pub(crate) fn text(&self, first: usize, last: usize) -> &'a str {
        let (text, end) = &self.places[last];
        let (other, begin) = &self.places[first];
        let begin = if std::ptr::eq(*text, *other) { begin.start } else { 0 };
        &text[begin.min(end.end)..end.end]
    }
}

/// The lines before an utterance that are read, each cut to its first words.
fn recent<'a>(before: &[Said<'a>]) -> Vec<(Said<'a>, Vec<Range<usize>>)> {
    let mut left = MOST_CONTEXT_WORDS;
    let mut lines = Vec::new();
    for line in before.iter().rev().take(MOST_LINES) {
        let mut words = words(line.text);
        words.truncate(MOST_LINE_WORDS);
        let Some(rest) = left.checked_sub(words.len()) else { break };
        left = rest;
        lines.push((*line, words));
    }
    lines.reverse();
    lines
}
