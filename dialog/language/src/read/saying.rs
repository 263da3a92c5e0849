//! How the robot says back what people called a thing: `a red mug`, `any milk`; what a pronoun stands for it cannot.

use crate::{
    read::{phrase::Phrase, slot::Role},
    words::{intent::Intent, prose},
};

/// Words before a noun that say which of them, or how many, and not what it is.
const DETERMINERS: &[&str] = &[
    "the",
    "a",
    "an",
    "my",
    "your",
    "our",
    "its",
    "his",
    "her",
    "their",
    "this",
    "that",
    "these",
    "those",
    "some",
    "any",
    "all",
    "both",
    "each",
    "every",
    "either",
    "one",
    "of",
    "another",
    "whichever",
    "certain",
];

/// Whose things are, as it is spelt when its mark is left out.
const OWNERS: [(&str, &str); 2] = [("managers ", "manager"), ("bosss ", "boss")];

/// Words that stand for things, and name none.
const PRONOUNS: &[&str] = &[
    "it",
    "them",
    "they",
    "this",
    "that",
    "these",
    "those",
    "one",
    "ones",
    "itself",
    "there",
    "here",
    "something",
    "thing",
    "things",
    "object",
    "item",
    "stuff",
    "inside",
    "in",
    "on",
];

/// First words of what names nothing: `it in the kitchen`, `not the red one`.
const VAGUE_FIRST: &[&str] = &["", "it", "them", "they", "there", "here", "not"];

/// What somebody called an object, without an article; nothing where that is no name of it.
pub(crate) fn noun(phrase: &Phrase) -> Option<&str> {
    let mut noun = phrase.text.as_str();
    while let Some((first, rest)) = noun.split_once(' ').filter(|(first, _)| DETERMINERS.contains(first)) {
        // `one that is red`
        if first == "one" && rest.starts_with("that ") {
            break;
        }
        noun = rest;
    }
    let first = noun.split(' ').next().unwrap_or_default();
    let is_vague = PRONOUNS.contains(&noun) || DETERMINERS.contains(&noun) || VAGUE_FIRST.contains(&first);
    (!is_vague).then_some(noun)
}

/// The same for where some noun must stand.
pub(crate) fn noun_or_thing(phrase: &Phrase) -> &str {
    noun(phrase).unwrap_or("thing")
}

/// What was said of an object, as something that is not there: `a mug`, `any milk`.
pub(crate) fn said(phrase: &Phrase) -> String {
    let Some(noun) = noun(phrase) else { return "what you mean".to_owned() };
    if let Some(owned) = OWNERS.iter().find_map(|(spelt, owner)| Some((owner, noun.strip_prefix(spelt)?))) {
        return format!("the {}'s {}", owned.0, owned.1);
    }
    let text = prose::indefinite(noun);
    text.strip_prefix("some ").map_or_else(|| text.clone(), |noun| format!("any {noun}"))
}

/// That nothing is known that a pronoun could stand for.
pub(crate) fn unresolved(phrase: &Phrase) -> String {
    match phrase.text.as_str() {
        "" => "I cannot tell what you mean.".to_owned(),
        text => format!("I cannot tell what you mean by \"{text}\"."),
    }
}

/// What is asked where it was not said, or could not be found out.
pub(crate) fn what_for(intent: Intent, role: Option<Role>) -> String {
    match intent {
        Intent::GoTo | Intent::Travel => "Where shall I go?".to_owned(),
        Intent::Find => "What shall I look for?".to_owned(),
        Intent::Place | Intent::Bring | Intent::Drop if matches!(role, Some(Role::Place(_))) => {
            "Where shall I put it?".to_owned()
        }
        Intent::Pour if matches!(role, Some(Role::Place(_))) => "What shall I pour it into?".to_owned(),
        _ if matches!(role, Some(Role::Place(_))) => format!("What shall I {} it with?", intent.verb()),
        _ => format!("What shall I {}?", intent.verb()),
    }
}

impl Phrase {
    /// Takes words that say more of it; a colour alone is said before its noun.
    pub(crate) fn say_more(&mut self, words: &[String]) {
        let color = words.last().filter(|last| self.color.as_ref() == Some(*last));
        let noun = noun(self).filter(|noun| !noun.contains(' ')).map(str::to_owned);
        self.text = match (color, noun) {
            (Some(color), Some(noun)) => format!("the {color} {noun}"),
            _ => format!("{} {}", self.text, words.join(" ")).trim().to_owned(),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_said_is_said_back_as_a_name() {
        let check = |text: &str, expected: &str| {
            let phrase = Phrase { text: text.to_owned(), ..Phrase::default() };
            assert_eq!(said(&phrase), expected, "{text}");
        };
        check("the red mug", "a red mug");
        check("all of the apples", "any apples");
        check("one of the mugs", "any mugs");
        check("the milk", "any milk");
        check("an ice cube", "an ice cube");
        check("that", "what you mean");
        check("the one", "what you mean");
        check("it", "what you mean");
        check("the red one", "a red one");
        check("it in the kitchen", "what you mean");
    }
}
