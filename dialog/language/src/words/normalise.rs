//! The words of an utterance: set phrases replaced, spelling repaired.

use crate::words::{inflect, lexicon::Lexicon, spelling, token};

impl Lexicon {
    /// The words of an utterance: tokens, with spelling repaired and set phrases replaced; and how many were misspelt.
    pub(crate) fn normalise(&self, text: &str) -> (Vec<String>, usize) {
        // What is replaced may complete what is.
        let replaced = self.replaced(&self.replaced(&token::words(text)));
        let replaced = self.rejoined(self.vocabulary.respaced(replaced));
        let mut corrected: Vec<String> = Vec::with_capacity(replaced.len());
        let mut repairs = 0;
        for (at, word) in replaced.iter().enumerate() {
            if let Some(verb) = self.as_request(&corrected, word) {
                corrected.push(verb);
                continue;
            }
            let words = match self.completed(word, replaced.get(at + 1)) {
                Some(meant) => vec![meant],
                None => self.vocabulary.correct(word),
            };
            // `the mugs`: all of them.
            let is_plural = !self.vocabulary.has(word) && words.len() == 1 && self.classes.exact(&words).is_some();
            if is_plural && self.vocabulary.singular(word).as_ref() == words.first() {
                let article = corrected.len().saturating_sub(1);
                let says_which =
                    corrected.last().is_some_and(|last| matches!(last.as_str(), "the" | "these" | "those"));
                let is_all = article > 0 && self.all.exact(&corrected[article - 1..article]).is_some();
                if says_which && !is_all && article > 0 && corrected[article - 1] != "of" {
                    corrected.insert(article, "all".to_owned());
                }
            }
            // A plural, or two words run together, is no slip.
            repairs += usize::from(matches!(words.as_slice(), [one] if one != word && !word.starts_with(one.as_str())));
            corrected.extend(words);
        }
        (self.replaced(&corrected), repairs)
    }

    /// The words of an utterance as they were said: set phrases replaced, and no spelling repaired.
    pub(crate) fn as_said(&self, text: &str) -> Vec<String> {
        let words = self.replaced(&token::words(text));
        words
            .into_iter()
            .map(|word| self.vocabulary.singular(&word).filter(|_| !self.vocabulary.has(&word)).unwrap_or(word))
            .collect()
    }

    /// What a common word is a slip of all the same, as it makes a name of it and the next one: `bending machine`.
    fn completed(&self, word: &str, next: Option<&String>) -> Option<String> {
        let next = next.filter(|_| !self.vocabulary.has(word) && spelling::is_common(word))?;
        let name = [self.vocabulary.nearest(word)?.clone(), next.clone()];
        self.classes.exact(&name).is_some().then(|| name[0].clone())
    }

    /// `in serted`: a form of a verb with a space in it.
    fn rejoined(&self, words: Vec<String>) -> Vec<String> {
        let mut result: Vec<String> = Vec::with_capacity(words.len());
        for word in words {
            let is_odd = word.len() > 2
                && word.chars().all(|letter| letter.is_ascii_alphabetic())
                && !self.vocabulary.is_word(&word);
            let whole = result.last().filter(|_| is_odd).map(|last| format!("{last}{word}"));
            match whole.filter(|whole| inflect::stem(self, whole).is_some()) {
                Some(whole) => {
                    result.pop();
                    result.push(whole);
                }
                None => result.push(word),
            }
        }
        result
    }

    /// `opening` after `would you mind`, as the verb; and `makes` after what makes, as no verb.
    fn as_request(&self, before: &[String], word: &str) -> Option<String> {
        let last = before.last().map(String::as_str);
        let is_asked = matches!(
            last,
            None | Some(
                "mind"
                    | "awfully"
                    | "terribly"
                    | "kindly"
                    | "about"
                    | "by"
                    | "try"
                    | "start"
                    | "begin"
                    | "please"
                    | "meant"
                    | "mean"
                    | "to"
            )
        );
        let is_form = word.ends_with("ing") || last == Some("to") && word.ends_with("ed");
        if is_asked && is_form && !self.classes.words().any(|known| known == word) {
            return inflect::stem(self, word);
        }
        let verb = word.strip_suffix('s').filter(|verb| self.verb_heads.contains(*verb))?;
        let is_noun = self.classes.words().any(|known| known == verb || known == word);
        let is_told = last
            .is_some_and(|last| last.chars().all(char::is_alphabetic) && !self.lead.words().any(|lead| lead == last));
        (is_told && !is_noun && !self.vocabulary.has(word)).then(|| word.to_owned())
    }

    pub(crate) fn replaced(&self, words: &[String]) -> Vec<String> {
        let mut result = Vec::with_capacity(words.len());
        let mut at = 0;
        while at < words.len() {
            if let Some((length, meaning)) = self.replace.longest(&words[at..]) {
                result.extend(meaning.iter().cloned());
                at += length;
            } else {
                result.push(words[at].clone());
                at += 1;
            }
        }
        result
    }
}
