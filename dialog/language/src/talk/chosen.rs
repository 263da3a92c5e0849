//! Which of the plans that the robot asked about somebody chooses.

use crate::{
    context::{Context, Pending},
    read::{reader::Reader, tidy},
    talk::conversation::Conversation,
    understanding::Understanding,
    words::token,
};

impl Conversation<'_> {
    /// One of the plans that the robot asked about, in the very words of its question, as a button has them.
    pub(crate) fn chosen_by_name(&self, utterance: &str, context: &mut Context) -> Option<Understanding> {
        let Some(Pending::Guess { guesses }) = &context.pending else { return None };
        let guess = guesses.iter().find(|guess| guess.name.eq_ignore_ascii_case(utterance.trim()))?.clone();
        Some(self.go_as_guessed(guess, context))
    }

    /// Which of the plans of these names an answer means: `yes`, `the second one`, or what it was called; where it commands nothing
    /// else, in part.
    pub(crate) fn chosen_plan(
        &self,
        words: &[String],
        is_yes: bool,
        is_command: bool,
        names: &[String],
    ) -> Option<usize> {
        let told_apart = || if is_command { None } else { self.told_apart(words, names) };
        self.plan_called(words, is_yes, names).or_else(told_apart)
    }

    fn plan_called(&self, words: &[String], is_yes: bool, names: &[String]) -> Option<usize> {
        let is_called = |name: &String| tidy::plain(&self.lexicon.normalise(name).0) == tidy::plain(words);
        if let Some(at) = names.iter().position(is_called) {
            return Some(at);
        }
        let count = i32::try_from(names.len()).ok()?;
        // `the second one, pick it up`
        let first = words.split(|word| token::is_punctuation(word)).find(|part| !part.is_empty()).unwrap_or_default();
        let ordinal = self.answer_phrase(&tidy::plain(first)).and_then(|phrase| phrase.ordinal);
        let at = match ordinal {
            Some(ordinal) if ordinal < 0 => count + ordinal,
            Some(ordinal) => ordinal - 1,
            None if is_yes => 0,
            None => return None,
        };
        usize::try_from(at).ok().filter(|at| *at < names.len())
    }

    /// Which of the plans of these names is meant by words of which one alone has some: `the microwave, I said`.
    fn told_apart(&self, words: &[String], names: &[String]) -> Option<usize> {
        let lexicon = self.lexicon;
        let says = |word: &String| {
            !lexicon.is_small_word(word)
                && lexicon.answer_lead.exact(std::slice::from_ref(word)).is_none()
                && lexicon.prepositions.exact(std::slice::from_ref(word)).is_none()
        };
        // `the microwave, not the coffee maker`
        let end = words.iter().position(|word| lexicon.ifs.negations.contains(word)).unwrap_or(words.len());
        let said: Vec<String> = tidy::plain(&words[..end]).into_iter().filter(says).collect();
        let names: Vec<Vec<String>> = names.iter().map(|name| lexicon.normalise(name).0).collect();
        let having = |word: &String| names.iter().filter(|name| name.contains(word)).count();
        let is_told = |name: &Vec<String>| said.iter().any(|word| name.contains(word) && having(word) == 1);
        let known = said.iter().filter(|word| having(word) > 0).count();
        let mut told = (0..names.len()).filter(|at| is_told(&names[*at]));
        let at = told.next().filter(|_| 2 * known >= said.len())?;
        told.next().is_none().then_some(at)
    }

    /// `2`, `option two`, `number 1 please`: which of those that were named.
    pub(crate) fn option(&self, words: &[String]) -> Option<usize> {
        let mut reader = Reader::new(self.lexicon, words);
        reader.at += usize::from(reader.next_is("the"));
        let title = self.lexicon.titles.longest(reader.rest()).map_or(0, |(length, ())| length);
        let is_titled = title > 0;
        reader.at += title;
        let is_digit = reader.rest().first().is_some_and(|word| token::digits(word).is_some());
        let number = reader.number().filter(|number| (is_titled || is_digit) && *number >= 1.0)?;
        reader.skip(|lexicon| &lexicon.trail);
        (reader.is_done() && number.fract() == 0.0).then_some(number as usize)
    }
}
