//! What is to be done first and what next, where people say it the other way round: `before going there, take the bowl`.

use crate::{clause, inflect, lexicon::Lexicon, phrase::Reader, tidy, token};

/// The words with each `after you have …` as the request that it is, and without what comes after a `before …`.
pub(crate) fn in_order(lexicon: &Lexicon, words: &[String]) -> Vec<String> {
    let mut result = Vec::with_capacity(words.len());
    let mut start = 0;
    for end in (0..=words.len()).filter(|at| *at == words.len() || token::ends_sentence(&words[*at])) {
        result.extend(sentence(lexicon, &words[start..end]));
        result.extend(words.get(end).cloned());
        start = end + 1;
    }
    result
}

fn sentence(lexicon: &Lexicon, words: &[String]) -> Vec<String> {
    let begun = |at: usize| {
        let is_before = words[at] == "before";
        let is_after =
            matches!(words[at].as_str(), "after" | "once" | "when") || starts(&words[at..], &["as", "soon", "as"]);
        let skipped = if words[at] == "as" { 3 } else { 1 };
        let verb = at + skipped + subject(&words[(at + skipped).min(words.len())..]);
        let is_verb = verb < words.len() && is_done(lexicon, &words[verb..], verb > at + skipped);
        ((is_before || is_after) && is_verb).then_some((at, verb, is_before))
    };
    let begins = |at: &usize| *at == 0 || words[*at - 1] == "," || clause::leading(lexicon, &words[..*at]) == *at;
    let Some((at, verb, is_before)) = (0..words.len()).filter(begins).find_map(begun) else { return words.to_vec() };
    let done = tidy::stemmed(lexicon, &words[verb..]);
    let Some(next) = next_request(lexicon, &done) else { return words.to_vec() };
    let (done, next) = done.split_at(next);
    if is_before {
        return words[..at].iter().chain(next).cloned().collect();
    }
    let then = ["then".to_owned()];
    words[..at].iter().chain(done.iter().filter(|word| *word != ",")).chain(&then).chain(next).cloned().collect()
}

fn starts(words: &[String], with: &[&str]) -> bool {
    words.len() >= with.len() && with.iter().zip(words).all(|(one, word)| one == word)
}

/// How many words say who does it.
fn subject(words: &[String]) -> usize {
    match words {
        [you, have, ..] if you == "you" && have == "have" => 2,
        [you, ..] if you == "you" => 1,
        _ => 0,
    }
}

/// Whether something is done there: `going`, `you picked up`, `you go`.
fn is_done(lexicon: &Lexicon, words: &[String], has_subject: bool) -> bool {
    let form = inflect::stem(lexicon, &words[0]);
    let is_gerund = words[0].ends_with("ing") && form.is_some();
    let verb = tidy::stemmed(lexicon, words);
    let is_known = lexicon.verbs.longest(&verb).is_some();
    is_known && (is_gerund || has_subject && (form.is_some() || inflect::is_verb(lexicon, &words[0])))
}

/// Where the request begins that is to be done after it or before it.
fn next_request(lexicon: &Lexicon, words: &[String]) -> Option<usize> {
    let at_verb = |at: usize| {
        let mut reader = Reader::new(lexicon, words);
        reader.at = at;
        reader.skip(|lexicon| &lexicon.lead);
        reader.at_verb()
    };
    let comma = words.iter().position(|word| word == ",").map(|at| at + 1).filter(|at| at_verb(*at));
    let is_free = |at: &usize| {
        let is_particle = lexicon.prepositions.exact(&words[*at..=*at]).is_some();
        let follows =
            matches!(words[*at - 1].as_str(), "to" | "and") || lexicon.articles.exact(&words[*at - 1..*at]).is_some();
        !is_particle && !follows && at_verb(*at)
    };
    comma.or_else(|| (2..words.len()).find(is_free))
}
