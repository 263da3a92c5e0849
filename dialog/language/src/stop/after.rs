//! Whether a phrase says stop by what follows it, and where what else is said begins.

use std::ops::Range;

use crate::stop::{
    said::Said,
    tokens::{self, Pause},
};

/// Most words of a noun phrase that are looked at.
const LONGEST_PHRASE: usize = 6;

impl Said<'_> {
    /// Where what else is said begins, if nothing before it belongs to what is closed at `from`.
    pub(crate) fn closes(&self, from: usize, end: usize) -> Option<usize> {
        let at = self.after_spare(from, end, true);
        (at >= end || self.words.reason.contains(self.word(at))).then_some(at)
    }

    /// Where what is said after a phrase and its emphasis begins.
    pub(crate) fn after_spare(&self, from: usize, end: usize, with_closing: bool) -> usize {
        let mut at = from;
        loop {
            let closing = if with_closing && !self.words.objects.contains(self.word(at)) {
                self.length(&self.words.closing, at, end)
            } else {
                0
            };
            match closing.max(self.length(&self.words.spare, at, end)) {
                0 => return at,
                length => at += length,
            }
        }
    }

    /// Where what else is said begins, if what follows the word leaves it a stop.
    pub(crate) fn after_core(&self, from: usize, end: usize) -> Option<usize> {
        let words = self.words;
        let (mut at, mut is_closed) = (from, false);
        loop {
            let closing = self.length(&words.closing, at, end);
            let is_thing = words.objects.contains(self.word(at)) && closing == 1 && !self.ends_at(at + 1, end);
            if closing > 0 && !(is_thing && self.word(at) != "it") {
                (at, is_closed) = (at + closing, true);
            } else if at < end && words.core.contains(self.word(at)) {
                at += 1;
            } else {
                match self.length(&words.spare, at, end) {
                    0 => break,
                    length => at += length,
                }
            }
        }
        let word = self.word(at);
        if at >= end {
            return Some(end);
        }
        if word == "from" {
            return None;
        }
        if is_closed {
            return Some(at);
        }
        if word == "before" {
            return (!words.determiners.contains(self.word(at + 1))).then_some(at);
        }
        if words.determiners.contains(word) {
            return self.after_noun(at, end);
        }
        if self.is_gerund(word) {
            return Some(self.joint(at, end));
        }
        let is_question = word == "where" && words.asking.contains(self.word(at + 1));
        let is_object = words.places.contains(word) && !is_question
            || words.compounds.contains(word)
            || words.machines.contains(word) && !words.requests.contains(word)
            || tokens::is_number(word);
        (!is_object).then_some(at)
    }

    /// Whether a pronoun before `at` is the whole object.
    fn ends_at(&self, at: usize, end: usize) -> bool {
        at >= end
            || self.length(&self.words.closing, at, end) > 0
            || self.length(&self.words.spare, at, end) > 0
            || self.words.reason.contains(self.word(at))
            || self.words.joints.contains(self.word(at))
    }

    /// The same of a noun phrase that follows it: `stop the search` is about the robot, `stop the laser` is not.
    fn after_noun(&self, at: usize, end: usize) -> Option<usize> {
        let words = self.words;
        let last = (at + 1..end.min(at + 1 + LONGEST_PHRASE)).find(|at| words.joints.contains(self.word(*at)));
        let phrase = at + 1..last.unwrap_or(end.min(at + 1 + LONGEST_PHRASE));
        let mut nouns = phrase.clone().map(|at| (at, self.word(at)));
        if let Some((at, _)) = nouns.clone().find(|(_, noun)| words.own.contains(*noun)) {
            let has_machine = nouns.any(|(_, noun)| words.machines.contains(noun) && !words.own.contains(noun));
            return (!has_machine).then_some(at + 1);
        }
        let copula = phrase.clone().find(|at| words.copulas.contains(self.word(*at)));
        let relative = phrase.clone().find(|at| words.relatives.contains(self.word(*at)));
        if copula.is_some_and(|copula| relative.is_none_or(|relative| copula < relative)) {
            return Some(at);
        }
        let has_machine = nouns.any(|(_, noun)| words.machines.contains(noun));
        let is_vague = matches!(self.word(at), "that" | "this" | "these" | "those" | "all" | "your");
        let acts = phrase.start < end && self.is_gerund(self.word(phrase.start));
        (!has_machine && (is_vague || acts)).then(|| self.joint(at, end))
    }

    fn is_gerund(&self, word: &str) -> bool {
        word.len() > 4 && word.ends_with("ing") && !self.words.not_gerunds.contains(word)
    }

    /// Where the next request begins, after what is to be stopped.
    pub(crate) fn joint(&self, at: usize, end: usize) -> usize {
        let begins =
            |at: &usize| self.words.joints.contains(self.word(*at)) || self.words.requests.contains(self.word(*at));
        (at + 1..end).find(begins).unwrap_or(end)
    }

    pub(crate) fn after_closed(&self, at: usize, after: usize, end: usize) -> Option<usize> {
        let words = self.words;
        let from = self.after_spare(after, end, true);
        let word = self.word(from);
        if from >= end || self.word(at) == "whoa" || words.reason.contains(word) || words.core.contains(word) {
            return Some(from);
        }
        let acts = words.acts.contains(self.word(at));
        if acts && self.is_gerund(word) {
            return Some(self.joint(from, end));
        }
        if !words.determiners.contains(word) && !acts {
            return None;
        }
        let noun = self.after_noun(from, end)?;
        // `freeze, the floor is wet` tells something; `freeze that` does not stop.
        (acts || noun == from).then_some(noun)
    }

    /// `whoa, nice!`
    pub(crate) fn is_praised(&self, number: usize, after: usize) -> bool {
        let from = self.after_spare(after, self.clauses[number].words.end, true);
        let end = self.clauses.iter().map(|clause| clause.words.end).find(|end| *end > from).unwrap_or(from);
        self.length(&self.words.praise, from, end) > 0
    }

    /// After what may answer a question: nothing that asks for something else.
    pub(crate) fn after_weak(&self, number: usize, after: usize, follows: bool) -> Option<usize> {
        let end = self.clauses[number].words.end;
        if self.words.deictics.contains(self.word(after)) && after < end {
            return None;
        }
        let at = self.after_spare(after, end, true);
        if at < end {
            let is_reason = self.length(&self.words.grounds, at, end) > 0 || self.leads_out(at, end);
            return is_reason.then_some(at);
        }
        (follows || self.ends_or_explains(number)).then_some(at)
    }

    /// After what begins a correction as often.
    pub(crate) fn after_pause(&self, number: usize, after: usize, follows: bool) -> Option<usize> {
        let end = self.clauses[number].words.end;
        let mut at = self.after_spare(after, end, true);
        loop {
            match self.length(&self.words.pause, at, end) {
                0 => break,
                length => at = self.after_spare(at + length, end, true),
            }
        }
        if at < end {
            return (self.explains(at, end) || self.leads_out(at, end) && number + 1 == self.clauses.len())
                .then_some(at);
        }
        let is_exclaimed = self.clauses[number].after == Pause::Exclaimed;
        (follows || is_exclaimed || self.ends_or_explains(number)).then_some(at)
    }

    /// Whether nothing is left but what is said before anything, too: `wait no`.
    fn leads_out(&self, at: usize, end: usize) -> bool {
        self.content(at, end) == end
    }

    /// Whether it gives a reason, rather than another wish.
    fn explains(&self, at: usize, end: usize) -> bool {
        if self.length(&self.words.corrections, at, end) > 0 {
            return false;
        }
        let tells = self.words.determiners.contains(self.word(at)) && self.after_noun(at, end) == Some(at);
        tells || self.length(&self.words.grounds, at, end) > 0
    }

    /// Whether a clause is the last, or what follows it gives a reason or says it again.
    fn ends_or_explains(&self, number: usize) -> bool {
        self.clauses[number + 1..].iter().all(|next| {
            let Range { start, end } = next.words;
            let again = self.length(&self.words.pause, start, end).max(self.length(&self.words.weak, start, end));
            start + again == end || self.leads_out(start, end) || self.explains(self.content(start, end), end)
        })
    }
}
