//! Which of the plans that the robot asked about somebody chooses.

use cohabit_cdf::{Action, Verb};

use crate::{
    context::{Context, Guess, Pending},
    read::{reader::Reader, tidy},
    talk::conversation::Conversation,
    understanding::{Step, Understanding},
    words::{inflect, lexicon::Small, token},
};

/// What is said of no more than this: `just the shirt`.
const ONLY: [&str; 2] = ["just", "only"];

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
        let by_length = || self.by_length(words, names);
        self.plan_called(words, is_yes, names)
            .or_else(by_length)
            .or_else(told_apart)
            .or_else(|| self.least(words, names))
    }

    /// `the longer one`, where one alone is.
    fn by_length(&self, words: &[String], names: &[String]) -> Option<usize> {
        // `the longer one, chief`
        let first = words.split(|word| token::is_punctuation(word)).find(|part| !part.is_empty()).unwrap_or_default();
        let small = self.small(first);
        let lengths: Vec<usize> = names.iter().map(|name| name.split(' ').count()).collect();
        let wanted = if small.contains(&Small::Longer) {
            lengths.iter().max()?
        } else if small.contains(&Small::Shorter) {
            lengths.iter().min()?
        } else {
            return None;
        };
        only_one((0..names.len()).filter(|at| lengths[*at] == *wanted))
    }

    /// `just the shirt`, `only put the shirt in the basket`: of several that have all of these words, the one that has least beside them.
    fn least(&self, words: &[String], names: &[String]) -> Option<usize> {
        let is_only = |word: &String| ONLY.contains(&word.as_str());
        if !words.iter().any(is_only) {
            return None;
        }
        let said: Vec<String> = self.telling(words).into_iter().filter(|word| !is_only(word)).collect();
        // `close`, of `closing`.
        let has = |name: &[String], word: &String| {
            name.iter().any(|own| own == word || own.ends_with("ing") && own.starts_with(word.trim_end_matches('e')))
        };
        let names: Vec<Vec<String>> = names.iter().map(|name| self.lexicon.normalise(name).0).collect();
        let fits: Vec<usize> = (0..names.len()).filter(|at| said.iter().all(|word| has(&names[*at], word))).collect();
        let least = fits.iter().map(|at| names[*at].len()).min().filter(|_| !said.is_empty() && fits.len() > 1)?;
        only_one(fits.into_iter().filter(|at| names[*at].len() == least))
    }

    /// The words of an answer that may tell plans apart.
    fn telling(&self, words: &[String]) -> Vec<String> {
        let lexicon = self.lexicon;
        let tells = |word: &String| {
            !lexicon.is_small_word(word)
                && lexicon.answer_lead.exact(std::slice::from_ref(word)).is_none()
                && lexicon.prepositions.exact(std::slice::from_ref(word)).is_none()
        };
        tidy::plain(words).into_iter().filter(tells).collect()
    }

    /// A guess without what an answer leaves out of it: `the second one, but without closing the dryer`; nothing, where the rest needs that.
    pub(crate) fn without_denied(&self, mut guess: Guess, words: &[String]) -> Option<Guess> {
        let denial = words.iter().rposition(|word| self.lexicon.ifs.negations.contains(word));
        // `turning`, and `turn`.
        let plain = |word: String| inflect::stem(self.lexicon, &word).unwrap_or(word);
        let denied: Vec<String> =
            denial.map(|at| self.telling(&words[at + 1..])).unwrap_or_default().into_iter().map(plain).collect();
        let is_denied = |step: &Step| {
            let says: Vec<String> = self.lexicon.normalise(&step.says).0.into_iter().map(plain).collect();
            !denied.is_empty() && denied.iter().all(|word| says.contains(word))
        };
        let can_do_without =
            |step: &Step| matches!(step.action, Action::Interact { verb: Verb::Open | Verb::Close | Verb::Toggle, .. });
        if guess.steps.iter().any(|step| is_denied(step) && !can_do_without(step)) {
            return None;
        }
        guess.steps.retain(|step| !is_denied(step));
        (!guess.steps.is_empty()).then_some(guess)
    }

    fn plan_called(&self, words: &[String], is_yes: bool, names: &[String]) -> Option<usize> {
        let is_called = |name: &String| tidy::plain(&self.lexicon.normalise(name).0) == tidy::plain(words);
        if let Some(at) = names.iter().position(is_called) {
            return Some(at);
        }
        let count = i32::try_from(names.len()).ok()?;
        // `the second one, pick it up`, `yes, the second one`
        let is_yes_alone = |part: &[String]| self.small(part).contains(&Small::Yes);
        let mut parts = words.split(|word| token::is_punctuation(word));
        let first = parts.find(|part| !part.is_empty() && !is_yes_alone(part)).unwrap_or_default();
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
        // `the microwave, not the coffee maker`
        let end = words.iter().position(|word| lexicon.ifs.negations.contains(word)).unwrap_or(words.len());
        let said = self.telling(&words[..end]);
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

/// The only one of some.
fn only_one(mut some: impl Iterator<Item = usize>) -> Option<usize> {
    let one = some.next()?;
    some.next().is_none().then_some(one)
}
