//! What people say besides what they mean, left out: numbering, hesitation, and words said twice.

use crate::{
    read::{reader::Reader, segments},
    words::{lexicon::Lexicon, token},
};

/// So many words may be said twice in a row.
const LONGEST_STUTTER: usize = 4;

/// The words that are meant.
pub(crate) fn tidied(lexicon: &Lexicon, words: &[String]) -> Vec<String> {
    let words = without_numbers(lexicon, words);
    let words = without_stutter(&without_tags(without_like(lexicon, without_hesitation(lexicon, words))));
    without_pause(lexicon, words)
}

/// `open up, fridge`, `bring! the mug!`: a verb and what it is about, with a pause between.
fn without_pause(lexicon: &Lexicon, mut words: Vec<String>) -> Vec<String> {
    let is_pause = |at: usize| {
        let mut reader = Reader::new(lexicon, &words);
        reader.at = at + 1;
        let is_noun = lexicon.articles.longest(reader.rest()).is_some() || reader.starts_noun();
        let start = words[..at].iter().rposition(|word| token::is_punctuation(word)).map_or(0, |last| last + 1);
        let start = start + segments::leading(lexicon, &words[start..at]);
        let verb = lexicon.verbs.exact(&words[start..at]);
        matches!(words[at].as_str(), "," | "!")
            && verb.is_some_and(|intents| intents.iter().all(|intent| intent.needs_object()))
            && is_noun
            && !reader.at_verb()
    };
    let pauses: Vec<usize> = (1..words.len()).filter(|at| is_pause(*at)).collect();
    pauses.into_iter().rev().for_each(|at| drop(words.remove(at)));
    words
}

/// `1. open the fridge 2. take the milk`, `step 1: …`: the numbers end sentences, and mean no more.
fn without_numbers(lexicon: &Lexicon, words: &[String]) -> Vec<String> {
    let mut result = Vec::with_capacity(words.len());
    let mut at = 0;
    while at < words.len() {
        let is_start = at == 0 || result.last().is_some_and(|last: &String| token::is_punctuation(last));
        match numbering(lexicon, &words[at..], is_start) {
            Some(length) => {
                if result.last().is_some_and(|last| !token::ends_sentence(last)) {
                    result.push(".".to_owned());
                }
                at += length;
            }
            None => {
                // `give me please the mug`
                let is_polite = words[at] == "please" && at > 0 && at + 1 < words.len();
                if is_polite
                    && !token::is_punctuation(&words[at - 1])
                    && !token::is_punctuation(&words[at + 1])
                    && words[at - 1] != "please"
                {
                    at += 1;
                    continue;
                }
                let is_and = words[at] == "n" && at > 0 && at + 1 < words.len();
                result.push(if is_and { "and".to_owned() } else { words[at].clone() });
                at += 1;
            }
        }
    }
    result
}

/// How many words number what comes next.
fn numbering(lexicon: &Lexicon, words: &[String], is_start: bool) -> Option<usize> {
    let titled = usize::from(lexicon.fillers.numbered.contains(&words[0]));
    let is_number =
        |word: &String| token::digits(word).is_some() || lexicon.numbers.exact(std::slice::from_ref(word)).is_some();
    words.get(titled).filter(|word| is_number(word))?;
    let marked = words.get(titled + 1).is_some_and(|word| matches!(word.as_str(), ":" | "." | ","));
    let mut reader = Reader::new(lexicon, words);
    reader.at = titled + 1 + usize::from(marked);
    let is_numbered = marked && titled > 0 || (is_start || marked) && token::digits(&words[titled]).is_some();
    (is_numbered && reader.at_verb()).then_some(reader.at)
}

/// `pick up the um, yellow mug`; what consists of nothing else stays.
fn without_hesitation(lexicon: &Lexicon, words: Vec<String>) -> Vec<String> {
    let hesitates = |word: &String| lexicon.fillers.hesitations.contains(word);
    if words.iter().all(|word| hesitates(word) || token::is_punctuation(word)) {
        return words;
    }
    let mut result: Vec<String> = Vec::with_capacity(words.len());
    let mut was_hesitant = false;
    for word in words {
        if hesitates(&word) {
            was_hesitant = true;
            result.pop_if(|last| last == ",");
        } else if word != "," || !was_hesitant {
            was_hesitant = false;
            result.push(word);
        }
    }
    result
}

/// `could you like open it`, `turn like ninety degrees`: a word that fills, not what somebody likes or what is alike.
fn without_like(lexicon: &Lexicon, mut words: Vec<String>) -> Vec<String> {
    let fills = |at: usize| {
        let rest = &words[at + 1..];
        let says_more = at > 0 && lexicon.fillers.likes.contains(&words[at - 1]);
        let leads = lexicon.lead.longest(rest).is_some_and(|(length, ())| length > 1);
        let is_number = rest.first().is_some_and(|word| token::digits(word).is_some())
            || lexicon.numbers.longest(rest).is_some_and(|(_, number)| *number > 1.0);
        words[at] == "like" && !says_more && (Reader::new(lexicon, rest).at_verb() || leads || is_number)
    };
    let fillers: Vec<usize> = (0..words.len()).filter(|at| fills(*at)).collect();
    fillers.into_iter().rev().for_each(|at| drop(words.remove(at)));
    words
}

/// `that is the laser, right?`: no way to turn.
fn without_tags(mut words: Vec<String>) -> Vec<String> {
    let is_tag = |at: usize| words[at] == "," && words[at + 1] == "right" && words[at + 2] == "?";
    let tags: Vec<usize> = (1..words.len().saturating_sub(2)).filter(|at| is_tag(*at)).collect();
    tags.into_iter().rev().for_each(|at| drop(words.drain(at..at + 2)));
    words
}

/// `go to the, go to the fridge`, `the the`; numbers are said twice for a reason.
fn without_stutter(words: &[String]) -> Vec<String> {
    let mut result: Vec<String> = Vec::with_capacity(words.len());
    for word in words {
        result.push(word.clone());
        while let Some(length) = stuttered(&result) {
            result.truncate(result.len() - length);
        }
    }
    result
}

fn stuttered(words: &[String]) -> Option<usize> {
    (1..=LONGEST_STUTTER).find(|length| {
        let Some(start) = words.len().checked_sub(2 * length) else { return false };
        let (first, second) = words[start..].split_at(*length);
        let is_spoken = |word: &String| word.chars().all(char::is_alphabetic);
        first == second && first.iter().all(is_spoken)
    })
}

/// The words without punctuation and without the robot's name.
pub(crate) fn plain(words: &[String]) -> Vec<String> {
    let is_address = |word: &str| matches!(word, "robot" | "tam");
    words.iter().filter(|word| !token::is_punctuation(word) && !is_address(word)).cloned().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use cohabit_cdf::Catalog;

    #[test]
    fn what_is_not_meant_is_left_out() {
        let lexicon = Lexicon::new(&Catalog::builtin());
        let check = |said: &str, expected: &str| {
            assert_eq!(tidied(&lexicon, &token::words(said)).join(" "), expected, "{said}");
        };
        check("pick up the um the uh yellow mug", "pick up the yellow mug");
        check("go to the go to the fridge", "go to the fridge");
        check("1. open the fridge 2. take the milk", "open the fridge . take the milk");
        check("Step 1: open it. Step two: close it", "open it . close it");
        check("move 2 meters", "move 2 meters");
        check("could you like go over to the fridge", "could you go over to the fridge");
        check("i would like water", "i would like water");
        check("um", "um");
        check("open up, fridge", "open up fridge");
        check("take the milk n close it", "take the milk and close it");
    }
}
