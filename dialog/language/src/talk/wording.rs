//! The words of an utterance, and how much of them the grammar reads.

use cohabit_cdf::ClassId;

use crate::{
    context::Context,
    read::{
        chatter,
        clause::{Clause, Part},
        parts,
        question::{self, Question},
        remark, segments, tidy, whether,
    },
    talk::{condition, conversation::Conversation},
    understanding::Understanding,
    words::{intent::Intent, lexicon::Small, question_kind::QuestionKind, spelling, token},
};

/// An utterance and its words.
pub(crate) struct Wording<'a> {
    pub(crate) utterance: &'a str,
    /// With their spelling repaired.
    pub(crate) words: Vec<String>,
    /// Without those that ask for nothing.
    pub(crate) tidied: Vec<String>,
    /// The words that are neither the grammar's nor common English.
    pub(crate) unheard: Vec<String>,
}

/// How a doubt begins, behind a question why.
const COULD_YOU: [&str; 2] = ["could", "you"];

impl Conversation<'_> {
    pub(crate) fn wording<'a>(&self, utterance: &'a str) -> Wording<'a> {
        let (words, _) = self.lexicon.normalise(utterance);
        let tidied = tidy::tidied(self.lexicon, &words);
        let mut unheard = segments::unknown_words(self.lexicon, &words);
        unheard.retain(|word| !spelling::is_english(word) && !stands_apart(&words, word));
        Wording { utterance, words, tidied, unheard }
    }

    /// The sentence that asks what is here, what was done or where the robot is, where all else only says something: such a question stands
    /// by itself, whatever is said around it.
    pub(crate) fn asked_alone<'w>(&self, words: &'w [String]) -> Option<&'w [String]> {
        let sentences = whether::sentences(words);
        let stands_alone = |sentence: &&[String]| {
            let kind = question::read(self.lexicon, sentence).map(|one| one.kind);
            let is_one = matches!(
                kind,
                Some(
                    QuestionKind::Seeing
                        | QuestionKind::Rooms
                        | QuestionKind::RoomCount
                        | QuestionKind::Robot
                        | QuestionKind::DoneSoFar
                )
            );
            is_one && !self.asks_beside(sentence)
        };
        let at = sentences.iter().position(stands_alone)?;
        let mut others = sentences.iter().enumerate().filter(|(other, _)| *other != at);
        (!others.any(|(_, other)| self.asks_for_anything(&other.join(" ")))).then_some(sentences[at])
    }

    /// The questions that are asked in one sentence, where they are several and each is one that the grammar knows.
    pub(crate) fn questions_asked(&self, words: &[String]) -> Option<Vec<String>> {
        let asked = question::several(words);
        let is_known = |piece: &&[String]| {
            let read = question::read(self.lexicon, piece);
            let is_one = read.is_some_and(|one| one.kind != QuestionKind::Unknown && knows_what_about(&one));
            is_one && !self.asks_beside(piece)
        };
        let is_several = asked.len() > 1 && asked.iter().all(is_known);
        is_several.then(|| asked.into_iter().map(|piece| format!("{}?", token::sentence(piece))).collect())
    }

    /// The words in which it is asked why the robot does something, where nothing else is asked for: `could you not just press it` is a doubt.
    pub(crate) fn asked_why<'w>(&self, words: &'w [String]) -> Option<&'w [String]> {
        let sentences = whether::sentences(words);
        let asked = sentences.iter().find_map(|sentence| question::asked_why(self.lexicon, sentence))?;
        // `why do you need it, couldn't you just do without?` orders nothing either.
        let is_beside = |piece: &[String]| asked.ends_with(piece) && piece.starts_with(&COULD_YOU.map(str::to_owned));
        let is_doubt =
            |piece: &[String]| is_beside(piece) || piece.iter().any(|word| self.lexicon.ifs.negations.contains(word));
        let is_why = |piece: &[String]| question::asked_why(self.lexicon, piece).is_some();
        let mut pieces = words.split(|word| token::is_punctuation(word) || word == "and");
        let asks = |piece: &[String]| !is_doubt(piece) && !is_why(piece) && self.asks_for_anything(&piece.join(" "));
        (!pieces.any(asks)).then_some(asked)
    }

    /// What is said behind thanks or a greeting.
    fn without_greeting<'w>(&self, words: &'w [String]) -> &'w [String] {
        let is_greeting = |small: &Small| matches!(small, Small::Hello | Small::Thanks);
        match words.iter().position(|word| token::ends_sentence(word)) {
            Some(end) if end + 1 < words.len() && self.small(&words[..end]).iter().any(is_greeting) => {
                &words[end + 1..]
            }
            _ => words,
        }
    }

    /// Whether the grammar reads it to the last word, as one that it knows: requests, or a question, or small talk.
    pub(crate) fn is_plain(&self, Wording { tidied, .. }: &Wording<'_>) -> bool {
        if !self.small(tidied).is_empty() || self.chat(tidied).is_some() {
            return true;
        }
        if self.asked_alone(tidied).is_some() || self.questions_asked(tidied).is_some() {
            return true;
        }
        // `thanks! did you close the fridge`
        let asked = self.without_greeting(tidied);
        let answer = self.answered_yes_or_no(asked, &mut Context::default());
        if matches!(answer, Some(Understanding::Answer { holds: Some(_), .. })) {
            return !self.asks_beside(asked);
        }
        if let Some(question) = question::read(self.lexicon, tidied) {
            let is_known = question.kind != QuestionKind::Unknown && knows_what_about(&question);
            return is_known && !self.asks_beside(tidied);
        }
        let parts = parts::parts(self.lexicon, self.catalog, tidied);
        let is_read = |part: &Part| match part {
            Part::Clause(clause) => {
                (chatter::is_clear(clause) || clause.intent == Intent::Impossible && parts.len() == 1)
                    && clause.unknown.is_empty()
                    && !clause.has_stray_noun
                    && !clause.is_wish
                    && (!self.prints_nothing(clause) || self.is_of_mission(clause))
            }
            Part::Forbidden(_) => true,
            // `the microwave`
            Part::Fragment(phrase) => parts.len() == 1 && phrase.unknown.is_empty(),
            _ => false,
        };
        !parts.is_empty() && parts.iter().all(is_read)
    }

    /// Whether it is to make what no cartridge is for: `make us some cereal` rather asks for something else.
    pub(crate) fn prints_nothing(&self, clause: &Clause) -> bool {
        let is_printed = |class: ClassId| {
            self.devices.cartridges(class).next().is_some() || self.devices.printed_by(class).is_some()
        };
        let mut named = clause.objects.iter().flat_map(|phrase| &phrase.namings).peekable();
        clause.intent == Intent::Print && named.peek().is_some() && !named.any(|naming| is_printed(naming.class))
    }

    /// Whether the grammar knows all words of a plain request, although it may make something of it by a rule of thumb: `make coffee`.
    pub(crate) fn reads_all(&self, wording: &Wording<'_>) -> bool {
        if self.is_wait(&wording.words) {
            return true;
        }
        if self.is_plain(wording) || condition::is_conditional(self.lexicon, &wording.tidied) {
            return true;
        }
        let parts = parts::parts(self.lexicon, self.catalog, &wording.tidied);
        let is_read = |part: &Part| match part {
            Part::Clause(clause) => chatter::is_clear(clause) && clause.unknown.is_empty() && !clause.has_stray_noun,
            Part::Mention(phrase) | Part::Fragment(phrase) => phrase.unknown.is_empty(),
            Part::Forbidden(_) => true,
            Part::Aside(_) | Part::Unclear(_) => false,
        };
        parts.iter().any(|part| matches!(part, Part::Clause(_))) && parts.iter().all(is_read)
    }

    /// Whether more is asked for after a pause or an `and`: `what is in the fridge, and bring me the milk`.
    fn asks_beside(&self, words: &[String]) -> bool {
        let parts = words.split(|word| token::is_punctuation(word) || word == "and").filter(|part| !part.is_empty());
        parts.skip(1).any(|part| self.asks_for_anything(&part.join(" ")))
    }

    /// What is asked for, without what somebody says of themselves beside it; nothing, where nobody does.
    pub(crate) fn without_remark(&self, utterance: &str) -> Option<String> {
        if utterance.chars().nth(token::MAX_CHARS).is_some() {
            return None;
        }
        remark::parted(self.lexicon, utterance).filter(|rest| self.asks_for_anything(rest))
    }

    /// Whether any of these words names a thing or a room.
    pub(crate) fn names_anything(&self, words: &[String]) -> bool {
        (0..words.len()).any(|at| {
            let rest = &words[at..];
            self.lexicon.rooms.longest(rest).is_some() || self.lexicon.classes.longest(rest).is_some()
        })
    }
}

impl Wording<'_> {
    /// How many words there are.
    pub(crate) fn length(&self) -> usize {
        self.words.iter().filter(|word| !token::is_punctuation(word)).count()
    }
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
