//! What was heard, taken as it is or for what it sounds like; and what is said before the words that count.

use crate::{
    context::{Context, Pending},
    read::{chatter, clause::Part, hearing, parts, question},
    say::ask,
    talk::conversation::Conversation,
    understanding::{Asking, Clarification, Understanding},
    words::{intent::Intent, question_kind::QuestionKind, token},
};

/// An answer to `which lab` has fewer words than this; more is another request.
const LONGEST_LAB_ANSWER: usize = 6;

impl Conversation<'_> {
    /// What was heard, or else what may have been said instead: what sounds like it, and can be done.
    pub(crate) fn understand_heard(
        &self,
        words: Vec<String>,
        as_said: Option<Vec<String>>,
        context: &mut Context,
    ) -> Understanding {
        let parts = parts::parts(self.lexicon, self.catalog, &words);
        let is_puzzled = hearing::is_puzzled(&parts, &words);
        if !is_puzzled && as_said.is_none() {
            return self.understand_all(words, context);
        }
        let before = context.clone();
        let heard = self.understand_all(words.clone(), context);
        let is_unclear = |part: &Part| matches!(part, Part::Clause(clause) if !chatter::is_clear(clause) || !clause.unknown.is_empty());
        let is_doubtful = parts.iter().any(is_unclear)
            && matches!(heard, Understanding::Question { .. } | Understanding::Refusal { .. });
        if !is_lost(&heard) && !is_doubtful
            || question::read(self.lexicon, &words).is_some_and(|one| one.kind != QuestionKind::Unknown)
        {
            return heard;
        }
        // What made sense, and cannot be, was perhaps repaired amiss.
        let heard_words = Some(&words).filter(|_| is_puzzled);
        let readings = as_said.iter().chain(heard_words);
        let readings: Vec<_> =
            readings.flat_map(|words| hearing::readings(self.lexicon, self.catalog, words)).collect();
        let mut asked = None;
        for reading in readings {
            let mut then = before.clone();
            let understanding = self.understand_all(reading.words, &mut then);
            match understanding {
                Understanding::Plan { steps, .. } if reading.is_doubtful && self.judge.asking != Asking::Never => {
                    *context = before;
                    let question = ask::shall_i(&steps, &[]);
                    context.pending = Some(Pending::Offer { plans: vec![steps] });
                    return question;
                }
                Understanding::Plan { .. } | Understanding::Answer { .. } => {
                    *context = then;
                    return understanding;
                }
                Understanding::Question { .. } if !is_lost(&understanding) => {
                    asked = asked.or(Some((understanding, then)));
                }
                _ => {}
            }
        }
        let Some((question, then)) = asked else { return heard };
        *context = then;
        question
    }

    /// The words without `wait` and such at their start, if there are more.
    pub(crate) fn without_pause(&self, words: Vec<String>) -> Vec<String> {
        let Some((length, ())) = self.lexicon.fillers.pauses.longest(&words) else { return words };
        let rest = words[length..].iter().position(|word| !token::is_punctuation(word)).map(|at| &words[length + at..]);
        let goes_on = |rest: &[String]| {
            self.lexicon.verbs.longest(rest).is_none_or(|(_, intents)| !intents.contains(&Intent::Stop))
        };
        rest.filter(|rest| goes_on(rest)).map_or_else(|| words.clone(), <[String]>::to_vec)
    }

    /// Whether a pause is made for a question: `wait, is there anything in it?`
    pub(crate) fn pauses_to_ask(&self, words: &[String]) -> bool {
        let asks =
            |rest: &[String]| question::read(self.lexicon, rest).is_some_and(|one| one.kind != QuestionKind::Unknown);
        let length = self.lexicon.fillers.pauses.longest(words).map_or(0, |(length, ())| length);
        length > 0 && words.iter().any(|word| word == "?") && asks(&words[length..])
    }

    /// Whether the words are a request or a question of their own, and no answer to which lab is meant.
    pub(crate) fn asks_for_more(&self, words: &[String]) -> bool {
        if self.lexicon.rooms.occurs_in(words) {
            return words.len() >= LONGEST_LAB_ANSWER;
        }
        let asks = |part: &Part| matches!(part, Part::Clause(clause) if chatter::is_clear(clause));
        // `where the printer is` answers.
        let is_asked = words.iter().any(|word| word == "?");
        let asks_else = |kind| kind != QuestionKind::Unknown && (is_asked || kind != QuestionKind::Where);
        let is_question = || question::read(self.lexicon, words).is_some_and(|one| asks_else(one.kind));
        parts::parts(self.lexicon, self.catalog, words).iter().any(asks) || is_question()
    }
}

/// Whether little came of an utterance.
const fn is_lost(understanding: &Understanding) -> bool {
    match understanding {
        Understanding::Refusal { .. } => true,
        Understanding::Question { kind, .. } => {
            matches!(
                kind,
                Clarification::Appearance | Clarification::Location | Clarification::Request | Clarification::Direction
            )
        }
        _ => false,
    }
}
