//! Whether a phrase says stop by where it stands in its clause.

use std::{collections::BTreeSet, ops::Range};

use crate::{
    stop::{
        tokens::{Clause, Pause, Token},
        words::Words,
    },
    words::table::PhraseTable,
};

/// How surely a phrase says stop.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub enum Firmness {
    /// It drops what was asked for, and says nothing to a robot that does nothing: "never mind".
    Dismissal,
    /// It may as well answer a question of the robot's: "leave it", "wait".
    Weak,
    /// It says stop and nothing else.
    Firm,
}

/// A phrase that says stop.
pub(crate) struct Found {
    /// Where what else is said begins.
    pub(crate) end: usize,
    pub(crate) firmness: Firmness,
    pub(crate) is_plain: bool,
}

/// What was said.
pub(crate) struct Said<'a> {
    pub(crate) words: &'a Words,
    pub(crate) tokens: &'a [Token],
    /// The same, as words alone.
    pub(crate) spelt: &'a [String],
    pub(crate) clauses: &'a [Clause],
}

impl Said<'_> {
    pub(crate) fn word(&self, at: usize) -> &str {
        self.tokens.get(at).map_or("", |token| token.word.as_str())
    }

    /// How many words of the longest phrase of a table are at `at`, before `end`.
    pub(crate) fn length(&self, table: &PhraseTable<()>, at: usize, end: usize) -> usize {
        table.longest(&self.spelt[at.min(end)..end]).map_or(0, |(length, ())| length)
    }

    pub(crate) fn rest(&self, text: &str, end: usize) -> String {
        self.tokens.get(end).map_or_else(String::new, |token| text[token.from..].trim().to_owned())
    }

    /// The stop that a phrase at `at` says, if it does; `follows` tells that one was said before.
    pub(crate) fn stop_at(&self, number: usize, at: usize, follows: bool) -> Option<Found> {
        let words = self.words;
        let end = self.clauses[number].words.end;
        if words.core.contains(self.word(at)) {
            let found = self.is_told(number, at).then(|| self.after_core(at + 1, end)).flatten();
            return found.map(|end| Found { end, firmness: Firmness::Firm, is_plain: true });
        }
        if let Some(end) = self.forbids_motion(number, at).or_else(|| self.bids_stillness(number, at)) {
            return Some(Found { end, firmness: Firmness::Firm, is_plain: false });
        }
        let tables = [&words.open, &words.closed, &words.weak, &words.dismissal, &words.pause];
        let lengths = tables.map(|table| self.length(table, at, end));
        let longest = lengths.into_iter().max().filter(|longest| *longest > 0)?;
        let kind = lengths.iter().position(|length| *length == longest)?;
        let after = at + longest;
        let begins = self.begins(number, at);
        let may_end =
            kind < 2 && longest > 1 && self.after_spare(after, end, true) == end && self.may_end_with(number, at);
        if !begins && !may_end {
            return None;
        }
        let (end, firmness) = match kind {
            0 => (self.after_spare(after, end, true), Firmness::Firm),
            1 if self.word(at) == "whoa" && self.is_praised(number, after) => return None,
            1 => (self.after_closed(at, after, end)?, Firmness::Firm),
            2 => (self.after_weak(number, after, follows)?, Firmness::Weak),
            3 => (self.after_weak(number, after, follows)?, Firmness::Dismissal),
            _ => (self.after_pause(number, after, follows)?, Firmness::Weak),
        };
        Some(Found { end, firmness, is_plain: false })
    }

    /// The words for what a phrase at `at` drops, whatever is said behind it: none of `forget it`, `the mug` of `never mind the mug`.
    pub(crate) fn dropped_at(&self, number: usize, at: usize) -> Option<Range<usize>> {
        let end = self.clauses[number].words.end;
        // `no no no` corrects as often.
        let weak = if self.word(at) == "no" { 0 } else { self.length(&self.words.weak, at, end) };
        let whole = self.length(&self.words.dismissal, at, end).max(weak);
        let thing = at + self.length(&self.words.drops, at, end);
        let dropped = if whole > 0 && self.after_spare(at + whole, end, true) == end {
            end..end
        } else if thing > at && self.words.determiners.contains(self.word(thing)) && thing + 1 < end {
            thing..self.joint(thing + 1, end)
        } else {
            return None;
        };
        self.begins(number, at).then_some(dropped)
    }

    /// `don't you go any closer`
    fn forbids_motion(&self, number: usize, at: usize) -> Option<usize> {
        let end = self.clauses[number].words.end;
        let negation = match (self.word(at), self.word(at + 1)) {
            ("dont", _) => 1,
            ("do", "not") => 2,
            _ => return None,
        };
        let verb = at + negation + usize::from(self.word(at + negation) == "you");
        if verb >= end || !self.words.moves.contains(self.word(verb)) || !self.begins(number, at) {
            return None;
        }
        let is_after = |at: &usize| self.words.moves_after.contains(self.word(*at));
        let after = verb + 1 + (verb + 1..end).take_while(is_after).count();
        self.closes(after, end).filter(|_| after < end || verb + 1 < end || self.word(verb) != "do")
    }

    /// `stand perfectly still`
    fn bids_stillness(&self, number: usize, at: usize) -> Option<usize> {
        let end = self.clauses[number].words.end;
        let is_adverb = |at: &usize| self.word(*at).ends_with("ly") || self.words.adverbs.contains(self.word(*at));
        let manner = (at + 1..end).take_while(is_adverb).count();
        let still = at + 1 + manner;
        let is_bidden = manner > 0 && still < end && self.words.postures.contains(self.word(at));
        if !is_bidden || !self.words.stillness.contains(self.word(still)) || !self.begins(number, at) {
            return None;
        }
        self.closes(still + 1, end)
    }

    /// Whether nothing stands before `at` in its clause but what is said before anything.
    fn begins(&self, number: usize, at: usize) -> bool {
        self.leads_to(number, at) && !self.is_conditional(number, at) && !self.is_sequel(number, at)
    }

    fn leads_to(&self, number: usize, at: usize) -> bool {
        let start = self.clauses[number].words.start;
        let mut reached = BTreeSet::from([start]);
        while let Some(from) = reached.pop_first() {
            if from == at {
                return true;
            }
            let words = &self.spelt[from..at];
            let fits = |length: &usize| self.words.lead.exact(&words[..*length]).is_some();
            let longest = words.len().min(self.words.lead.longest_phrase());
            reached.extend((1..=longest).filter(fits).map(|length| from + length));
            // `hey Robbie, freeze`
            let is_called = self.words.greetings.contains(&words[0]) && words.len() == 2;
            let is_name = |word: &str| !self.words.has(word) && !self.words.determiners.contains(word);
            if is_called && is_name(&words[1]) {
                reached.insert(at);
            }
        }
        false
    }

    /// Where what is said in a clause begins after what is said before anything; `end` at most.
    pub(crate) fn content(&self, start: usize, end: usize) -> usize {
        let mut at = start;
        while at < end {
            match self.length(&self.words.lead, at, end) {
                0 => break,
                length => at += length,
            }
        }
        at
    }

    /// `when you get there, stop`: not now.
    fn is_conditional(&self, number: usize, at: usize) -> bool {
        let clause = &self.clauses[number];
        let is_subordinate = |from: usize, end: usize| self.length(&self.words.subordinators, from, end) > 0;
        let content = self.content(clause.words.start, at);
        if (content..at).any(|from| is_subordinate(from, at)) {
            return true;
        }
        let Some(before) = number.checked_sub(1).map(|before| &self.clauses[before]) else { return false };
        let content = self.content(before.words.start, before.words.end);
        // `when I say stop I mean it, so stop`
        if self.word(clause.words.start) == "so" {
            return false;
        }
        clause.before == Pause::Short && content < before.words.end && is_subordinate(content, before.words.end)
    }

    /// `go two metres and stop`: the end of a plan, not of what the robot does now.
    fn is_sequel(&self, number: usize, at: usize) -> bool {
        let clause = &self.clauses[number];
        let asks = |range: Range<usize>| {
            let content = self.content(range.start, range.end);
            content < range.end && self.words.requests.contains(self.word(content))
        };
        let last = |at: usize| if at > clause.words.start { self.word(at - 1) } else { "" };
        let mut joint = at;
        while self.words.adverbs.contains(last(joint)) {
            joint -= 1;
        }
        let (mut from, mut is_then) = (joint, false);
        while matches!(last(from), "and" | "then") {
            is_then |= last(from) == "then";
            from -= 1;
        }
        let before = number.checked_sub(1).map(|before| self.clauses[before].words.clone());
        let goes_on = clause.before == Pause::Short || is_then;
        if from < joint {
            let content = self.content(clause.words.start, from);
            return if content < from { asks(content..from) } else { goes_on && before.is_some_and(asks) };
        }
        // `drive two metres, stop, turn left`
        let is_listed = joint == clause.words.start && clause.before == Pause::Short && clause.after == Pause::Short;
        is_listed
            && before.is_some_and(asks)
            && self.clauses.get(number + 1).is_some_and(|next| asks(next.words.clone()))
    }

    /// Whether a word for stop at `at` is told to the robot.
    fn is_told(&self, number: usize, at: usize) -> bool {
        let start = self.clauses[number].words.start;
        if self.is_conditional(number, at) || self.is_sequel(number, at) {
            return false;
        }
        if self.leads_to(number, at) {
            return true;
        }
        !self.is_negated(start, at) && self.may_follow(start, at) && !self.is_asked(start, at)
    }

    /// `I did not ask you to stop`
    pub(crate) fn is_negated(&self, start: usize, at: usize) -> bool {
        let words = self.words;
        let is_between = |word: &str| {
            word == "to"
                || [&words.adverbs, &words.persons, &words.told, &words.tellers].iter().any(|set| set.contains(word))
        };
        let mut from = at;
        while from > start && is_between(self.word(from - 1)) && !words.negations.contains(self.word(from - 1)) {
            from -= 1;
        }
        if from == start || !words.negations.contains(self.word(from - 1)) {
            return from > start + 1 && (self.word(from - 2), self.word(from - 1)) == ("no", "one");
        }
        // `why don't you stop`, `can't you stop`
        let asks = from < at
            && words.persons.contains(self.word(from))
            && words.negated_requests.contains(self.word(from - 1));
        let is_why = from > start + 1 && self.word(from - 2) == "why";
        !(asks && (is_why || self.word(from - 1) != "dont"))
    }

    /// Whether the words right before `at` let it be told: `the bus stop` and `ready to stop` do not.
    fn may_follow(&self, start: usize, at: usize) -> bool {
        let words = self.words;
        let is_light =
            |word: &str| words.adverbs.contains(word) && !words.saying.contains(word) && !words.told.contains(word);
        let mut last = at;
        while last > start && is_light(self.word(last - 1)) {
            last -= 1;
        }
        let back = |count: usize| if last >= start + count { self.word(last - count) } else { "" };
        let previous = back(1);
        match previous {
            "" => true,
            "that" => !matches!(back(2), "at" | "to" | "from" | "near" | "of" | "by"),
            "to" => {
                let is_you =
                    matches!(back(2), "you" | "u" | "it" | "him" | "her" | "robot" | "them" | "everyone" | "everybody");
                let teller = if back(3) == "the" { back(4) } else { back(3) };
                if is_you {
                    words.tellers.contains(teller)
                } else {
                    words.told.contains(back(2)) && (words.subjects.contains(back(3)) || back(3).is_empty())
                }
            }
            _ if words.saying.contains(previous) => {
                let mut subject = 2;
                while words.adverbs.contains(back(subject))
                    || matches!(back(subject), "already" | "clearly" | "literally")
                {
                    subject += 1;
                }
                back(subject).is_empty() || words.sayers.contains(back(subject))
            }
            "i" | "he" | "she" | "they" => false,
            _ if words.modals.contains(previous) => {
                let subject = back(if is_light(back(2)) { 3 } else { 2 });
                subject.is_empty() || words.subjects.contains(subject)
            }
            _ => !words.before_blocks.contains(previous),
        }
    }

    /// Whether the clause asks whether, when or why somebody stops.
    fn is_asked(&self, start: usize, at: usize) -> bool {
        let words = self.words;
        let first = self.content(start, at);
        let (one, next) = (self.word(first), self.word(first + 1));
        let between = || (first..at).map(|at| self.word(at));
        match one {
            "do" | "have" | "has" => {
                first + 1 < at && (words.subjects.contains(next) || words.determiners.contains(next))
            }
            "what" | "where" => between().any(|word| words.auxiliaries.contains(word)),
            _ if words.questions.contains(one) => true,
            _ if words.modals.contains(one) => !words.persons.contains(next) && !between().any(|word| word == "robot"),
            _ => false,
        }
    }

    /// Whether a phrase that says stop may end a clause that something else begins: `mind my foot hold it`.
    fn may_end_with(&self, number: usize, at: usize) -> bool {
        let words = self.words;
        let start = self.clauses[number].words.start;
        if at == start {
            return false;
        }
        let previous = self.word(at - 1);
        let is_open = words.modals.contains(previous)
            || words.determiners.contains(previous)
            || words.joints.contains(previous)
            || previous == "to";
        let content = self.content(start, at);
        !is_open
            && !words.requests.contains(self.word(content))
            && !words.modals.contains(self.word(content))
            && !self.is_conditional(number, at)
            && !self.is_negated(start, at)
            && self.may_follow(start, at)
            && !self.is_asked(start, at)
    }
}
