//! Whether somebody tells the robot to stop, and what else they say.
//!
//! Knows nothing of the rest of the language: text in, the stop and the rest of the text out. It is pure, total and quick, as
//! it is asked of every piece of speech before anything else is understood. All words lie in `data/stop.toml`.
//!
//! A phrase that says stop counts by where it stands in its clause and by what follows it: "stop by the kitchen", "did you
//! stop?", "stop the laser" and "go two metres and stop" tell the robot something else.

use std::{
    collections::{BTreeMap, BTreeSet},
    ops::Range,
    sync::OnceLock,
};

use serde::Deserialize;

use crate::{spelling::distance, table::PhraseTable};

/// Somebody tells the robot to stop.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Stop {
    /// What they say after it, without the stop itself; empty if that is all.
    pub rest: String,
    /// How surely they do.
    pub firmness: Firmness,
    /// Whether the word itself was said: a phrase such as "wait" may yet go on as "wait for me".
    pub is_plain: bool,
    /// Whether they say nothing else.
    pub is_all: bool,
}

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

/// The stop in a text, if there is one. What is said before it is taken back by it.
#[must_use]
pub fn find_stop(text: &str) -> Option<Stop> {
    let words = words();
    let tokens = tokens(words, text);
    let clauses = clauses(&tokens);
    let spelt: Vec<String> = tokens.iter().map(|token| token.word.clone()).collect();
    let said = Said { words, tokens: &tokens, spelt: &spelt, clauses: &clauses };
    let mut stop: Option<Stop> = None;
    let mut end = 0;
    for (number, clause) in clauses.iter().enumerate() {
        for at in clause.words.clone() {
            let Some(found) = (at >= end).then(|| said.stop_at(number, at, stop.is_some())).flatten() else { continue };
            end = found.end.max(at + 1);
            let before = stop.take();
            let rest = said.rest(text, end);
            stop = Some(Stop {
                is_all: rest.is_empty() && before.as_ref().map_or(number == 0, |before| before.is_all),
                rest,
                firmness: before.as_ref().map_or(found.firmness, |before| before.firmness.max(found.firmness)),
                is_plain: found.is_plain || before.is_some_and(|before| before.is_plain),
            });
        }
    }
    stop
}

/// Whether a text has the word itself in it, told to the robot or not: "OK, I stop."
#[must_use]
pub fn mentions_stop(text: &str) -> bool {
    let words = words();
    tokens(words, text).iter().any(|token| words.core.contains(&token.word))
}

/// Whether a text has the word itself in it, and none but what somebody says not to do: "don't stop now."
#[must_use]
pub(crate) fn denies_stop(text: &str) -> bool {
    let words = words();
    let tokens = tokens(words, text);
    let clauses = clauses(&tokens);
    let spelt: Vec<String> = tokens.iter().map(|token| token.word.clone()).collect();
    let said = Said { words, tokens: &tokens, spelt: &spelt, clauses: &clauses };
    let all = clauses.iter().flat_map(|clause| clause.words.clone().map(|at| (clause.words.start, at)));
    let mut stops = all.filter(|(_, at)| words.core.contains(said.word(*at))).peekable();
    stops.peek().is_some() && stops.all(|(start, at)| said.is_negated(start, at))
}

/// Words beyond these are not listened to.
const MOST_WORDS: usize = 400;
/// Most words of a noun phrase that are looked at.
const LONGEST_PHRASE: usize = 6;
/// Fewest letters of a word in which slips are repaired, and of several that were run together.
const SHORTEST_SLIP: usize = 3;
const SHORTEST_JOINED: usize = 5;

/// The words of `data/stop.toml`, whose comments say what they are.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Words {
    core: BTreeSet<String>,
    closed: PhraseTable<()>,
    open: PhraseTable<()>,
    weak: PhraseTable<()>,
    dismissal: PhraseTable<()>,
    pause: PhraseTable<()>,
    lead: PhraseTable<()>,
    closing: PhraseTable<()>,
    spare: PhraseTable<()>,
    reason: BTreeSet<String>,
    grounds: PhraseTable<()>,
    corrections: PhraseTable<()>,
    negations: BTreeSet<String>,
    before_blocks: BTreeSet<String>,
    adverbs: BTreeSet<String>,
    subordinators: PhraseTable<()>,
    questions: BTreeSet<String>,
    auxiliaries: BTreeSet<String>,
    modals: BTreeSet<String>,
    persons: BTreeSet<String>,
    tellers: BTreeSet<String>,
    told: BTreeSet<String>,
    requests: BTreeSet<String>,
    compounds: BTreeSet<String>,
    machines: BTreeSet<String>,
    determiners: BTreeSet<String>,
    own: BTreeSet<String>,
    places: BTreeSet<String>,
    copulas: BTreeSet<String>,
    relatives: BTreeSet<String>,
    not_gerunds: BTreeSet<String>,
    praise: PhraseTable<()>,
    acts: BTreeSet<String>,
    sayers: BTreeSet<String>,
    saying: BTreeSet<String>,
    objects: BTreeSet<String>,
    negated_requests: BTreeSet<String>,
    joints: BTreeSet<String>,
    asking: BTreeSet<String>,
    moves: BTreeSet<String>,
    moves_after: BTreeSet<String>,
    postures: BTreeSet<String>,
    stillness: BTreeSet<String>,
    deictics: BTreeSet<String>,
    subjects: BTreeSet<String>,
    greetings: BTreeSet<String>,
    mistyped: Vec<String>,
    swapped: Vec<String>,
    drawn: Vec<String>,
    words: BTreeSet<String>,
    same: BTreeMap<String, String>,
    joined: BTreeSet<String>,
}

impl Words {
    /// Whether it is a word of one of the phrases, or one that looks like a slip of one.
    fn has(&self, word: &str) -> bool {
        let in_set =
            [&self.core, &self.words, &self.reason, &self.requests, &self.compounds, &self.machines, &self.places]
                .iter()
                .any(|set| set.contains(word));
        in_set || self.known().contains(word)
    }

    fn known(&self) -> &'static BTreeSet<String> {
        static KNOWN: OnceLock<BTreeSet<String>> = OnceLock::new();
        KNOWN.get_or_init(|| {
            let tables =
                [&self.closed, &self.open, &self.weak, &self.dismissal, &self.pause, &self.lead, &self.closing];
            tables.iter().flat_map(|table| table.phrases()).flatten().cloned().collect()
        })
    }
}

fn words() -> &'static Words {
    static WORDS: OnceLock<Words> = OnceLock::new();
    WORDS.get_or_init(|| {
        toml::from_str(include_str!("../data/stop.toml"))
            .expect("invariant: the built-in table parses, the tests load it")
    })
}

/// A word of a text.
#[derive(Clone, Debug)]
struct Token {
    word: String,
    /// Where it is in the text, bytes.
    from: usize,
    /// What stands between it and the word before.
    pause: Pause,
}

/// What stands between two words.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
enum Pause {
    None,
    /// A comma or a dash.
    Short,
    /// The end of a sentence.
    Long,
    /// The same, with an exclamation mark.
    Exclaimed,
}

fn pause_of(mark: char) -> Option<Pause> {
    match mark {
        ',' | ':' | '—' | '–' | '(' | ')' | '*' | '/' => Some(Pause::Short),
        '.' | '?' | ';' | '\n' | '…' => Some(Pause::Long),
        '!' => Some(Pause::Exclaimed),
        _ => None,
    }
}

fn tokens(words: &Words, text: &str) -> Vec<Token> {
    let mut tokens: Vec<Token> = Vec::new();
    let (mut word, mut from, mut pause) = (String::new(), 0, Pause::None);
    let mut characters = text.char_indices().chain([(text.len(), ' ')]).peekable();
    while let Some((at, character)) = characters.next() {
        let is_sign = words.same.contains_key(character.encode_utf8(&mut [0; 4]) as &str);
        if character.is_alphanumeric() || is_sign {
            if word.is_empty() {
                from = at;
            }
            word.extend(character.to_lowercase());
            continue;
        }
        let follows = characters.peek().is_some_and(|(_, next)| next.is_alphanumeric());
        if matches!(character, '\'' | '’' | '‘' | '`') || character == '.' && follows && is_number(&word) {
            continue;
        }
        if !word.is_empty() {
            push(words, &mut tokens, std::mem::take(&mut word), from, std::mem::replace(&mut pause, Pause::None));
        }
        let is_dash = character == '-' && !follows;
        pause = pause.max(pause_of(character).unwrap_or(if is_dash { Pause::Short } else { Pause::None }));
        if tokens.len() > MOST_WORDS {
            break;
        }
    }
    spelt_out(words, tokens)
}

fn is_number(word: &str) -> bool {
    word.starts_with(|first: char| first.is_ascii_digit())
}

fn push(words: &Words, tokens: &mut Vec<Token>, word: String, from: usize, pause: Pause) {
    let parts = parts(words, &word).unwrap_or_else(|| vec![meant(words, word)]);
    for (at, word) in parts.into_iter().enumerate() {
        tokens.push(Token { word, from, pause: if at == 0 { pause } else { Pause::None } });
    }
}

/// The word that was meant: drawn out, mistyped or spelt otherwise.
fn meant(words: &Words, word: String) -> String {
    if let Some(same) = words.same.get(&word) {
        return same.clone();
    }
    if word.len() < SHORTEST_SLIP || words.has(&word) || !word.chars().all(|letter| letter.is_ascii_alphabetic()) {
        return word;
    }
    let single = squeezed(&word);
    let drawn = words.drawn.iter().find(|known| single.len() < word.len() && squeezed(known) == single);
    let slip = |known: &&String| distance(word.as_bytes(), known.as_bytes()) == 1;
    let swap = |known: &&String| known.len() == word.len() && slip(known) && is_reordered(&word, known);
    let found = drawn.or_else(|| words.swapped.iter().find(swap)).or_else(|| words.mistyped.iter().find(slip));
    found.cloned().unwrap_or_else(|| words.same.get(&single).cloned().unwrap_or(word))
}

/// `stooop` as `stop`.
fn squeezed(word: &str) -> String {
    let mut letters: Vec<char> = word.chars().collect();
    letters.dedup();
    letters.into_iter().collect()
}

fn is_reordered(one: &str, other: &str) -> bool {
    let sorted = |word: &str| {
        let mut letters = word.as_bytes().to_vec();
        letters.sort_unstable();
        letters
    };
    sorted(one) == sorted(other)
}

/// `stopit`: the words that were run together.
fn parts(words: &Words, word: &str) -> Option<Vec<String>> {
    if word.len() < SHORTEST_JOINED || word.len() > 40 || !word.is_ascii() || words.has(word) {
        return None;
    }
    // The words up to each letter.
    let mut best: Vec<Option<Vec<String>>> = vec![None; word.len() + 1];
    best[0] = Some(Vec::new());
    for end in 1..=word.len() {
        best[end] = (0..end).find_map(|start| {
            let before = best[start].as_ref()?;
            let part = words.joined.get(&word[start..end])?;
            Some(before.iter().chain([part]).cloned().collect())
        });
    }
    best.pop().flatten().filter(|parts| parts.len() > 1)
}

/// `s t o p` as one word.
fn spelt_out(words: &Words, tokens: Vec<Token>) -> Vec<Token> {
    let mut result: Vec<Token> = Vec::with_capacity(tokens.len());
    let mut at = 0;
    while at < tokens.len() {
        let letters = tokens[at..].iter().take_while(|token| token.word.chars().count() == 1).count();
        let word: String = tokens[at..at + letters].iter().map(|token| token.word.as_str()).collect();
        if words.core.contains(&word) {
            result.push(Token { word, ..tokens[at].clone() });
            at += letters;
        } else {
            result.push(tokens[at].clone());
            at += 1;
        }
    }
    result
}

/// The words between two pauses.
#[derive(Clone, Debug)]
struct Clause {
    words: Range<usize>,
    /// The pauses before and after it.
    before: Pause,
    after: Pause,
}

fn clauses(tokens: &[Token]) -> Vec<Clause> {
    let mut starts: Vec<usize> = (0..tokens.len()).filter(|at| *at == 0 || tokens[*at].pause > Pause::None).collect();
    starts.push(tokens.len());
    let pause = |at: usize| tokens.get(at).map_or(Pause::Long, |token| token.pause);
    let clause = |pair: &[usize]| Clause { words: pair[0]..pair[1], before: pause(pair[0]), after: pause(pair[1]) };
    starts.windows(2).map(clause).collect()
}

/// A phrase that says stop.
struct Found {
    /// Where what else is said begins.
    end: usize,
    firmness: Firmness,
    is_plain: bool,
}

/// What was said.
struct Said<'a> {
    words: &'a Words,
    tokens: &'a [Token],
    /// The same, as words alone.
    spelt: &'a [String],
    clauses: &'a [Clause],
}

impl Said<'_> {
    fn word(&self, at: usize) -> &str {
        self.tokens.get(at).map_or("", |token| token.word.as_str())
    }

    /// How many words of the longest phrase of a table are at `at`, before `end`.
    fn length(&self, table: &PhraseTable<()>, at: usize, end: usize) -> usize {
        table.longest(&self.spelt[at.min(end)..end]).map_or(0, |(length, ())| length)
    }

    fn rest(&self, text: &str, end: usize) -> String {
        self.tokens.get(end).map_or_else(String::new, |token| text[token.from..].trim().to_owned())
    }

    /// The stop that a phrase at `at` says, if it does; `follows` tells that one was said before.
    fn stop_at(&self, number: usize, at: usize, follows: bool) -> Option<Found> {
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

    /// Where what else is said begins, if nothing before it belongs to what is closed at `from`.
    fn closes(&self, from: usize, end: usize) -> Option<usize> {
        let at = self.after_spare(from, end, true);
        (at >= end || self.words.reason.contains(self.word(at))).then_some(at)
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
    fn content(&self, start: usize, end: usize) -> usize {
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
    fn is_negated(&self, start: usize, at: usize) -> bool {
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

    /// Where what is said after a phrase and its emphasis begins.
    fn after_spare(&self, from: usize, end: usize, with_closing: bool) -> usize {
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
    fn after_core(&self, from: usize, end: usize) -> Option<usize> {
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
            || is_number(word);
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
    fn joint(&self, at: usize, end: usize) -> usize {
        let begins =
            |at: &usize| self.words.joints.contains(self.word(*at)) || self.words.requests.contains(self.word(*at));
        (at + 1..end).find(begins).unwrap_or(end)
    }

    fn after_closed(&self, at: usize, after: usize, end: usize) -> Option<usize> {
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
    fn is_praised(&self, number: usize, after: usize) -> bool {
        let from = self.after_spare(after, self.clauses[number].words.end, true);
        let end = self.clauses.iter().map(|clause| clause.words.end).find(|end| *end > from).unwrap_or(from);
        self.length(&self.words.praise, from, end) > 0
    }

    /// After what may answer a question: nothing that asks for something else.
    fn after_weak(&self, number: usize, after: usize, follows: bool) -> Option<usize> {
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
    fn after_pause(&self, number: usize, after: usize, follows: bool) -> Option<usize> {
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
