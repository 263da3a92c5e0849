//! What people say of themselves beside what they ask for: `close the door on your way out, I am going to lunch`.

use std::{iter, slice};

use crate::{
    read::tidy,
    words::{lexicon::Lexicon, token},
};

/// What ends a piece of a sentence, and what ends a sentence.
const ENDS: [char; 8] = [',', ';', '.', '!', '?', '—', '–', '\n'];
const SENTENCE_ENDS: [char; 3] = ['.', '!', '?'];

/// An utterance without the remarks in it; nothing, where it has none.
pub(crate) fn parted(lexicon: &Lexicon, utterance: &str) -> Option<String> {
    let mut rest = String::new();
    let mut has_remark = false;
    for piece in utterance.split_inclusive(ENDS) {
        // `tell the boss I am late`
        let is_told = |start: &usize| tells(lexicon, &rest) || tells(lexicon, &piece[..*start]);
        let Some(start) = start(lexicon, piece).filter(|start| !is_told(start)) else {
            rest.push_str(piece);
            continue;
        };
        has_remark = true;
        rest.push_str(&piece[..start]);
        // What follows is another sentence.
        if piece.ends_with(SENTENCE_ENDS) {
            let said = rest.trim_end().trim_end_matches([',', ';']).trim_end().len();
            rest.truncate(said);
            rest.push_str(if said == 0 || rest.ends_with(SENTENCE_ENDS) { "" } else { "." });
        }
    }
    let rest = rest.trim().trim_end_matches([',', ';', ' ']);
    has_remark.then(|| rest.to_owned())
}

/// Where in a piece of a sentence a remark begins that goes to its end.
fn start(lexicon: &Lexicon, piece: &str) -> Option<usize> {
    if piece.ends_with('?') {
        return None;
    }
    let words = || piece.split_whitespace().map(|word| (word.as_ptr() as usize - piece.as_ptr() as usize, word));
    let plain = |word: &str| token::words(word).concat();
    // `the cup that I am going to use`, `if I am late`
    let is_own = |before: &str| {
        let before = plain(before);
        !lexicon.hints.not_after.contains(&before) && !lexicon.chatter.subordinators.contains(&before)
    };
    let pairs = words().zip(words().skip(1));
    let within = pairs.filter(|((_, before), (_, word))| is_own(before) && begins(lexicon, word));
    iter::once(0).chain(within.map(|(_, (at, _))| at)).find(|at| is_remark(lexicon, &piece[*at..]))
}

/// Whether words say that what follows is to be told.
fn tells(lexicon: &Lexicon, text: &str) -> bool {
    token::words(text).iter().any(|word| lexicon.chatter.tellers.contains(word))
}

/// Whether a remark may begin with a word.
fn begins(lexicon: &Lexicon, word: &str) -> bool {
    let said = lexicon.replaced(&token::words(word));
    said.first().is_some_and(|first| lexicon.chatter.remarks.phrases().any(|remark| remark[0] == *first))
}

/// Whether somebody says no more than what they do themselves: they name nothing and ask for nothing.
fn is_remark(lexicon: &Lexicon, text: &str) -> bool {
    let said = tidy::plain(&lexicon.normalise(text).0);
    let mut at = 0;
    while let Some((length, ())) = lexicon.hints.between.longest(&said[at..]) {
        at += length;
    }
    let Some((length, ())) = lexicon.chatter.remarks.longest(&said[at..]) else { return false };
    let rest = &said[at + length..];
    let counts = |at: usize| {
        let words = &rest[at..];
        lexicon.verbs.longest(words).is_some()
            || lexicon.classes.longest(words).is_some()
            || lexicon.rooms.longest(words).is_some()
            || lexicon.pronouns.longest(words).is_some()
            || lexicon.negation.longest(words).is_some()
            || lexicon.wishes.wishes.contains(&words[0])
    };
    // `the room I am going to`
    let is_cut = rest.last().is_some_and(|last| lexicon.prepositions.exact(slice::from_ref(last)).is_some());
    !is_cut && !(0..rest.len()).any(counts)
}

#[cfg(test)]
mod tests {
    use cohabit_cdf::Catalog;

    use super::*;

    #[test]
    fn what_people_say_of_themselves_is_parted_from_what_they_ask_for() {
        let lexicon = Lexicon::new(&Catalog::builtin());
        for (said, rest) in [
            ("close the door on your way out, I'm going to lunch", "close the door on your way out"),
            ("I'm off to lunch, close the door on your way out", "close the door on your way out"),
            ("close the door on your way out I'm going to lunch", "close the door on your way out"),
            ("Open the fridge, I'll be right back. Then close it!", "Open the fridge. Then close it!"),
            ("I have to go now. Turn off the light.", "Turn off the light."),
        ] {
            assert_eq!(parted(&lexicon, said).as_deref(), Some(rest), "{said}");
        }
    }

    #[test]
    fn what_says_where_or_which_or_asks_for_something_is_no_remark() {
        let lexicon = Lexicon::new(&Catalog::builtin());
        for said in [
            "close the door",
            "bring me the mug, I'm going to the break room",
            "I'm going to need the hammer",
            "go to the room I am going to",
            "if I'm late, close the door",
            "am I late?",
            "tell the boss I'm running late",
            "say to the boss, I'm late",
            "I am not going",
        ] {
            assert_eq!(parted(&lexicon, said), None, "{said}");
        }
    }
}
