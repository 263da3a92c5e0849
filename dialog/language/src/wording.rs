//! The words of an utterance, and how much of them the grammar reads.

use cohabit_cdf::ClassId;

use crate::{
    chatter,
    clause::{self, Clause, Part},
    condition,
    context::Context,
    conversation::Conversation,
    hearing, inquiry,
    intent::Intent,
    question::{self, Question, QuestionKind},
    tidy,
    token::{self, MAX_CHARS},
    understanding::Understanding,
};

/// An utterance and its words.
pub(crate) struct Wording<'a> {
    pub(crate) utterance: &'a str,
    /// With their spelling repaired.
    pub(crate) words: Vec<String>,
    /// Without those that ask for nothing.
    pub(crate) tidied: Vec<String>,
    /// The words that neither grammar nor parser has ever met.
    pub(crate) unheard: Vec<String>,
}

impl Conversation<'_> {
    pub(crate) fn wording<'a>(&self, utterance: &'a str) -> Wording<'a> {
        let (words, _) = self.lexicon.normalise(utterance);
        let tidied = tidy::tidied(self.lexicon, &words);
        let mut unheard = clause::unknown_words(self.lexicon, &words);
        unheard.retain(|word| !self.parser.is_some_and(|parser| parser.knows(word)) && !stands_apart(&words, word));
        Wording { utterance, words, tidied, unheard }
    }

    /// Whether it only wants to know something: `do you know the way to the lab?`
    pub(crate) fn inquires(&self, wording: &Wording<'_>, context: &Context) -> bool {
        // As it was said: `do you know how to …` is often a request, but not for who wants to know it.
        let words = token::words(wording.utterance);
        if self.asks_to_be_told(&words) {
            return true;
        }
        let words = asked_before_statement(&words);
        if words.iter().rev().find(|word| token::ends_sentence(word)).is_none_or(|end| end != "?") {
            return false;
        }
        let (before, last) = last_sentence(words);
        // `there is a tip for it as well, do you see it?`
        let pause = last.iter().rposition(|word| word == ",").map_or(0, |at| at + 1);
        let starts = [0, clause::leading(self.lexicon, last).min(last.len())];
        let inquiry = |start: usize| {
            let (length, ()) = self.lexicon.inquiries.longest(&last[start..])?;
            Some((start, start + length))
        };
        let after_statement = || inquiry(pause).filter(|_| !self.orders(&last[..pause]));
        let Some((lead, end)) = starts.into_iter().find_map(inquiry).or_else(after_statement) else { return false };
        let rest = &last[end..];
        let is_idiom = self.lexicon.favours.longest(&last[lead..]).is_some();
        let asks_before = || !before.is_empty() && self.parser_sees_request(&token::sentence(before), context);
        !is_idiom && !self.lexicon.favours.occurs_in(rest) && !asks_before()
    }

    /// Whether these words begin with what is to be done.
    fn orders(&self, words: &[String]) -> bool {
        let start = clause::leading(self.lexicon, words).min(words.len());
        self.lexicon.verbs.longest(&words[start..]).is_some()
    }

    /// Whether it has any word that somebody knows, and is not too long.
    pub(crate) fn may_be_weighed(&self, wording: &Wording<'_>) -> bool {
        let is_known = |word: &String| {
            let parser_knows = || self.parser.is_some_and(|parser| parser.knows(word));
            word.contains(char::is_alphabetic) && (self.lexicon.vocabulary.has(word) || parser_knows())
        };
        wording.utterance.chars().nth(MAX_CHARS).is_none() && wording.words.iter().any(is_known)
    }

    /// Whether the grammar reads it to the last word, as one that it knows: requests, or a question, or small talk.
    pub(crate) fn is_plain(&self, Wording { tidied, .. }: &Wording<'_>) -> bool {
        if !self.small(tidied).is_empty() || self.chat(tidied).is_some() {
            return true;
        }
        // `did you close the fridge`
        let answer = self.answered_yes_or_no(tidied, &mut Context::default());
        if matches!(answer, Some(Understanding::Answer { holds: Some(_), .. })) {
            return true;
        }
        if let Some(question) = question::read(self.lexicon, tidied) {
            let is_known = question.kind != QuestionKind::Unknown && knows_what_about(&question);
            return is_known && inquiry::later_sentences(tidied).is_empty();
        }
        let parts = clause::parts(self.lexicon, self.catalog, tidied);
        let is_read = |part: &Part| match part {
            Part::Clause(clause) => {
                (chatter::is_clear(clause) || clause.intent == Intent::Impossible && parts.len() == 1)
                    && clause.unknown.is_empty()
                    && !clause.has_stray_noun
                    && !clause.is_wish
                    && !self.prints_nothing(clause)
            }
            Part::Forbidden(_) => true,
            // `the microwave`
            Part::Fragment(phrase) => parts.len() == 1 && phrase.unknown.is_empty(),
            _ => false,
        };
        !parts.is_empty() && parts.iter().all(is_read)
    }

    /// Whether it is to make what no cartridge is for: `make us some cereal` rather asks for something else.
    fn prints_nothing(&self, clause: &Clause) -> bool {
        let is_printed = |class: ClassId| {
            self.devices.cartridges(class).next().is_some() || self.devices.printed_by(class).is_some()
        };
        let mut named = clause.objects.iter().flat_map(|phrase| &phrase.namings).peekable();
        clause.intent == Intent::Print && named.peek().is_some() && !named.any(|naming| is_printed(naming.class))
    }

    /// Whether the grammar takes it for a question that it does not read to the last word, or that nothing but its guess speaks for.
    pub(crate) fn takes_for_question(&self, wording: &Wording<'_>) -> bool {
        question::read(self.lexicon, &wording.tidied).is_some_and(|question| {
            let is_known = question.kind != QuestionKind::Unknown && knows_what_about(&question);
            !is_known || !wording.ends_as_question()
        })
    }

    /// Whether the grammar leaves words out.
    pub(crate) fn leaves_words_out(&self, Wording { tidied, .. }: &Wording<'_>) -> bool {
        // A condition is read for itself.
        if condition::is_conditional(self.lexicon, tidied) {
            return false;
        }
        let heard =
            hearing::readings(self.lexicon, self.catalog, tidied).into_iter().find(|reading| !reading.is_doubtful);
        let words = heard.as_ref().map_or(tidied.as_slice(), |reading| &reading.words);
        clause::parts(self.lexicon, self.catalog, words).iter().any(|part| match part {
            Part::Clause(clause) if clause.intent == Intent::Impossible => false,
            Part::Clause(clause) => !clause.unknown.is_empty() || clause.has_stray_noun || !chatter::is_clear(clause),
            Part::Unclear(_) => true,
            Part::Aside(words) => !words.is_empty(),
            _ => false,
        })
    }
}

impl Wording<'_> {
    pub(crate) fn ends_as_question(&self) -> bool {
        self.utterance.trim_end().ends_with('?')
    }
}

/// Up to a question after which nothing but statements of the speaker follow: `why did you take it? I only asked you to open it`.
fn asked_before_statement(words: &[String]) -> &[String] {
    let (before, last) = last_sentence(words);
    let is_stated = last.first().is_some_and(|first| matches!(first.as_str(), "i" | "we"));
    if is_stated && before.iter().any(|word| word == "?") { asked_before_statement(before) } else { words }
}

/// What is said before the last sentence, and that sentence.
fn last_sentence(words: &[String]) -> (&[String], &[String]) {
    let end = words.iter().rposition(|word| !token::is_punctuation(word)).map_or(0, |at| at + 1);
    let start = words[..end].iter().rposition(|word| token::ends_sentence(word)).map_or(0, |at| at + 1);
    (&words[..start], &words[start..end])
}

/// Whether a word is set off from all others, as names and exclamations are: `put it back, habibi`, `arrey no`.
fn stands_apart(words: &[String], word: &str) -> bool {
    let is_alone =
        |segment: &[String]| segment.len() == 1 || segment[0] == word && matches!(segment[1].as_str(), "no" | "yes");
    let mut segments = words.split(|word| token::is_punctuation(word)).filter(|segment| !segment.is_empty());
    let is_all = segments.clone().nth(1).is_none() && words.len() == 1;
    !is_all && segments.all(|segment| !segment.iter().any(|other| other == word) || is_alone(segment))
}

fn knows_what_about(question: &Question) -> bool {
    question.about.as_ref().is_none_or(|about| about.unknown.is_empty())
}
