//! How many of a kind are meant: a rewriter that has read of single things writes of one, where two were asked for.

use std::collections::BTreeSet;

use cohabit_cdf::ClassId;

use crate::{
    read::reader::Reader,
    talk::{conversation::Conversation, source::things_of, wording::Wording},
    words::token,
};

/// How plain requests begin that take things, and that put them somewhere.
const TAKES: &str = "pick up ";
const PUTS: [&str; 2] = ["put ", "bring "];
/// What stands for things that were named before: `the cups, two of them`.
const OF: &str = "of";
const THEM: [&str; 4] = ["them", "em", "those", "these"];

impl Conversation<'_> {
    /// Plain requests with as many of a kind as were said, where they speak of one.
    pub(crate) fn with_counts(&self, text: &str, wording: &Wording<'_>) -> String {
        let counted = self.counted(&wording.words);
        counted
            .iter()
            .fold(text.to_owned(), |text, (count, classes)| self.with_count(&text, *count, classes).unwrap_or(text))
    }

    /// What was counted, and how many of it there are to be.
    fn counted(&self, words: &[String]) -> Vec<(u8, BTreeSet<ClassId>)> {
        // `one of the two cups` is one.
        let is_of_more = |at: usize| {
            let is_article = |word: &&String| self.lexicon.articles.exact(std::slice::from_ref(*word)).is_some();
            let before = words[..at].iter().rev().find(|word| !is_article(word));
            before
                .is_some_and(|word| word == OF || self.lexicon.prepositions.exact(std::slice::from_ref(word)).is_some())
        };
        let named_at = |at: usize| {
            if is_of_more(at) {
                return None;
            }
            let phrase = Reader { at, ..Reader::new(self.lexicon, words) }.phrase()?;
            let classes: BTreeSet<ClassId> = phrase.namings.iter().map(|naming| naming.class).collect();
            Some((phrase.count?, classes)).filter(|(_, classes)| !classes.is_empty())
        };
        let of_them = |at: usize| {
            let (length, value) = self.lexicon.numbers.longest(&words[at..])?;
            let behind = &words[at + length..];
            let is_of_them = behind.first()? == OF && THEM.contains(&behind.get(1)?.as_str());
            let is_count = is_of_them && (2.0..=f32::from(u8::MAX)).contains(value) && value.fract() == 0.0;
            let before = (0..at).rev().find_map(|from| {
                let (_, namings) = self.lexicon.classes.longest(&words[from..at])?;
                Some(namings.iter().map(|naming| naming.class).collect())
            });
            Some((*value as u8, before?)).filter(|_| is_count)
        };
        (0..words.len()).filter_map(|at| named_at(at).or_else(|| of_them(at))).collect()
    }

    /// The same of one kind: each is taken where it is put somewhere. Nothing, where several requests put such things somewhere: they may
    /// be those that were counted.
    fn with_count(&self, text: &str, count: u8, classes: &BTreeSet<ClassId>) -> Option<String> {
        let is_of_kind =
            |request: &&str| things_of(self.lexicon, &token::words(request)).any(|one| classes.contains(&one));
        let puts = |request: &&str| PUTS.iter().any(|put| request.starts_with(put)) && is_of_kind(request);
        let takes = |request: &&str| request.starts_with(TAKES) && is_of_kind(request);
        let requests: Vec<&str> = text.split("; ").collect();
        let put: Vec<&str> = requests.iter().copied().filter(puts).collect();
        let (counted, is_put) = match put.as_slice() {
            [] => (requests.iter().copied().find(takes)?, false),
            [one] => (*one, true),
            _ => return None,
        };
        let with_count = self.counting(counted, count, classes)?;
        let kept = requests.into_iter().filter(|request| !(is_put && takes(request)));
        let all: Vec<&str> =
            kept.map(|request| if request == counted { with_count.as_str() } else { request }).collect();
        Some(all.join("; "))
    }

    /// A plain request with that many of what it names first, instead of one of it.
    fn counting(&self, request: &str, count: u8, classes: &BTreeSet<ClassId>) -> Option<String> {
        let words: Vec<String> = request.split(' ').map(str::to_owned).collect();
        let name = (0..words.len()).find(|at| self.lexicon.classes.longest(&words[*at..]).is_some())?;
        let (_, namings) = self.lexicon.classes.longest(&words[name..])?;
        let is_kind = namings.iter().any(|naming| classes.contains(&naming.class));
        let article = name.checked_sub(1).filter(|_| is_kind)?;
        self.lexicon.articles.exact(&words[article..name])?;
        let count = count.to_string();
        let all = words.iter().enumerate().map(|(at, word)| if at == article { &count } else { word });
        Some(all.map(String::as_str).collect::<Vec<_>>().join(" "))
    }
}
