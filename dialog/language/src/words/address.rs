//! Whom of several robots somebody speaks to: `Rosie, bring me the mug`, `stop, robot 2`, `both of you, look around`.

use std::{collections::BTreeSet, ops::Range};

use crate::words::{spelling, token::NUMBERS};

/// What may stand before a name that is called.
const CALLS: &[&str] =
    &["hey", "hi", "hello", "ok", "okay", "yo", "oi", "dear", "now", "and", "so", "well", "please", "excuse", "me"];
/// What is said of somebody begins so after the name.
const SAYS_OF: &[&str] =
    &["is", "has", "was", "s", "had", "says", "said", "knows", "took", "does", "did", "should", "needs", "wants"];
/// A name after these is not called, but spoken of.
const SPEAKS_OF: &[&str] = &[
    "to", "at", "with", "of", "from", "near", "by", "behind", "follow", "find", "see", "where", "is", "for", "than",
    "a", "the", "called", "named", "and", "or", "beside", "help", "show", "like", "that", "about", "tell", "ask",
    "give", "bring",
];
/// What may follow a name at the end.
const AFTER: &[&str] = &["please", "now", "thanks", "thank", "you", "ok", "okay", "will"];
/// All of them.
const ALL: &[&[&str]] = &[
    &["both", "of", "you"],
    &["all", "of", "you"],
    &["you", "both"],
    &["you", "two"],
    &["you", "all"],
    &["both", "robots"],
    &["all", "robots"],
    &["everybody"],
    &["everyone"],
    &["robots"],
];
const ORDINALS: &[&str] =
    &["zeroth", "first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth"];
/// A name of fewer letters must be spelt as it is.
const SHORTEST_MISSPELT: usize = 4;

/// The robots that people speak to, by their names.
#[derive(Clone, Debug)]
pub struct Roster {
    /// How each may be called, in words.
    calls: Vec<Vec<Vec<String>>>,
}

/// Who is spoken to, and what is said to them.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Addressed {
    /// Which of the roster, in its order; none, if no name was called.
    pub robots: Vec<usize>,
    /// What was said, without the names.
    pub text: String,
}

/// A word of a text: in small letters, where it is, and whether a comma or the like stands right after it.
struct Word {
    text: String,
    at: Range<usize>,
    pauses: bool,
}

impl Roster {
    /// Robots of these names, such as `Rosie` or `robot 2`.
    #[must_use]
    pub fn new<'n>(names: impl IntoIterator<Item = &'n str>) -> Self {
        Self { calls: names.into_iter().map(calls).collect() }
    }

    /// Who is called by name in `text`.
    #[must_use]
    pub fn addressed(&self, text: &str) -> Addressed {
        let words = words(text);
        let called = self.at_start(&words).or_else(|| self.at_end(&words)).or_else(|| self.between_commas(&words));
        let Some((robots, span)) = called else { return Addressed { robots: Vec::new(), text: text.to_owned() } };
        Addressed { robots: robots.into_iter().collect(), text: without(text, &words, span) }
    }

    /// `hey Rosie, …`, `Rosie and Bob: …`
    fn at_start(&self, words: &[Word]) -> Option<(BTreeSet<usize>, Range<usize>)> {
        let is_call = |word: &&Word| CALLS.contains(&word.text.as_str());
        let most = words.iter().take_while(is_call).count();
        let (robots, span) = (0..=most).find_map(|start| self.names_at(words, start))?;
        let is_called = words.get(span.end).is_none_or(|next| !SAYS_OF.contains(&next.text.as_str()));
        (is_called || words[span.end - 1].pauses).then_some((robots, span))
    }

    /// `…, Rosie`, `… please, Rosie and Bob`
    fn at_end(&self, words: &[Word]) -> Option<(BTreeSet<usize>, Range<usize>)> {
        let kept = words.iter().rposition(|word| !AFTER.contains(&word.text.as_str()))? + 1;
        (1..kept).find_map(|start| {
            let (robots, span) = self.names_at(words, start).filter(|(_, span)| span.end == kept)?;
            let before = &words[start - 1];
            (before.pauses || !SPEAKS_OF.contains(&before.text.as_str())).then_some((robots, span))
        })
    }

    /// `could you, Rosie, …`
    fn between_commas(&self, words: &[Word]) -> Option<(BTreeSet<usize>, Range<usize>)> {
        (1..words.len()).filter(|at| words[at - 1].pauses).find_map(|at| {
            let (robots, span) = self.names_at(words, at)?;
            words[span.end - 1].pauses.then_some((robots, span))
        })
    }

    /// The names that stand there, one after the other.
    fn names_at(&self, words: &[Word], start: usize) -> Option<(BTreeSet<usize>, Range<usize>)> {
        let is = |at: usize, said: &str| words.get(at).is_some_and(|word| word.text == said);
        let all = ALL.iter().find(|all| (start..).zip(all.iter()).all(|(at, said)| is(at, said)));
        if let Some(all) = all.filter(|_| self.calls.len() > 1) {
            return Some(((0..self.calls.len()).collect(), start..start + all.len()));
        }
        let (mut robots, mut end) = (BTreeSet::new(), start);
        loop {
            let at = if end > start && is(end, "and") { end + 1 } else { end };
            let Some((robot, length)) = self.name_at(words, at) else { break };
            robots.insert(robot);
            end = at + length;
        }
        (!robots.is_empty()).then_some((robots, start..end))
    }

    fn name_at(&self, words: &[Word], at: usize) -> Option<(usize, usize)> {
        let rest = words.get(at..).unwrap_or_default();
        let called = |alike: fn(&str, &str) -> bool| {
            let fits = |call: &Vec<String>| {
                call.len() <= rest.len() && call.iter().zip(rest).all(|(called, word)| alike(called, &word.text))
            };
            let of = |calls: &Vec<Vec<String>>| calls.iter().filter(|call| fits(call)).map(Vec::len).max();
            self.calls.iter().enumerate().find_map(|(robot, calls)| Some((robot, of(calls)?)))
        };
        called(|called, word| called == word).or_else(|| {
            let is_apart = at == 0 || words[at - 1].pauses || CALLS.contains(&words[at - 1].text.as_str());
            let pauses = rest.first().is_some_and(|word| word.pauses);
            if is_apart && pauses { called(is_misspelt) } else { None }
        })
    }
}

fn is_misspelt(called: &str, word: &str) -> bool {
    called == word || called.len() >= SHORTEST_MISSPELT && spelling::distance(called.as_bytes(), word.as_bytes()) <= 1
}

/// How a robot of this name may be called.
fn calls(name: &str) -> Vec<Vec<String>> {
    let name: Vec<String> = words(name).into_iter().map(|word| word.text).collect();
    let mut calls = Vec::new();
    if let [kind, number] = name.as_slice()
        && let Some(number) = number.parse::<usize>().ok().filter(|number| *number < NUMBERS.len())
    {
        let owned = |words: &[&str]| words.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>();
        let digits = number.to_string();
        for written in [digits.as_str(), NUMBERS[number]] {
            calls.push(owned(&[kind, written]));
            calls.push(owned(&[kind, "number", written]));
        }
        calls.push(owned(&[ORDINALS[number], kind]));
        calls.push(owned(&["the", ORDINALS[number], kind]));
    } else if !name.is_empty() {
        calls.push(name);
    }
    calls
}

fn words(text: &str) -> Vec<Word> {
    let mut words: Vec<Word> = Vec::new();
    for (at, character) in text.char_indices() {
        let end = at + character.len_utf8();
        match words.last_mut().filter(|word| word.at.end == at) {
            _ if !character.is_alphanumeric() => {
                if let Some(word) = words.last_mut().filter(|_| ",:;.!?–-".contains(character)) {
                    word.pauses = true;
                }
            }
            Some(word) => {
                word.text.extend(character.to_lowercase());
                word.at.end = end;
            }
            None => words.push(Word { text: character.to_lowercase().collect(), at: at..end, pauses: false }),
        }
    }
    words
}

/// The text without some of its words, and without the commas that set them apart; a greeting, if nothing else is left.
fn without(text: &str, words: &[Word], span: Range<usize>) -> String {
    let (first, last) = (&words[span.start], &words[span.end - 1]);
    let before = text[..first.at.start].trim_end_matches([' ', ',', ':', ';']);
    let after = text[last.at.end..].trim_start_matches([' ', ',', ':', ';', '-', '–']);
    let left = match (before.is_empty(), after.chars().any(char::is_alphanumeric)) {
        (true, _) => after.to_owned(),
        (false, true) => format!("{before} {after}"),
        (false, false) => format!("{before}{after}"),
    };
    if left.chars().any(char::is_alphanumeric) { left } else { "hello".to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(roster: &Roster, text: &str) -> (Vec<usize>, String) {
        let Addressed { robots, text } = roster.addressed(text);
        (robots, text)
    }

    #[test]
    fn names_are_called_at_the_start_at_the_end_and_between_commas() {
        let roster = Roster::new(["Rosie", "robot 2"]);
        for (text, robots, left) in [
            ("Rosie, bring me the mug", &[0][..], "bring me the mug"),
            ("hey rosie bring me the mug", &[0], "hey bring me the mug"),
            ("Rosi, stop!", &[0], "stop!"),
            ("stop, Rosie!", &[0], "stop!"),
            ("go to the kitchen please rosie", &[0], "go to the kitchen please"),
            ("could you, Rosie, open the fridge?", &[0], "could you open the fridge?"),
            ("robot 2, look around", &[1], "look around"),
            ("Robot two: look around", &[1], "look around"),
            ("the second robot, look around", &[1], "look around"),
            ("look around, robot number two.", &[1], "look around."),
            ("Rosie and robot 2, look around", &[0, 1], "look around"),
            ("both of you, stop", &[0, 1], "stop"),
            ("Stop, everybody!", &[0, 1], "Stop!"),
            ("Rosie?", &[0], "hello"),
            ("hello Rosie", &[0], "hello"),
        ] {
            assert_eq!(said(&roster, text), (robots.to_vec(), left.to_owned()), "{text}");
        }
    }

    #[test]
    fn who_is_spoken_of_is_not_spoken_to() {
        let roster = Roster::new(["Rosie", "robot 2"]);
        for text in [
            "go to Rosie",
            "where is Rosie",
            "Rosie is in the kitchen",
            "Rosie's mug is red",
            "pick up the robot arm",
            "give the mug to robot 2",
            "open the second drawer",
            "",
            "🙂 , ,",
        ] {
            assert_eq!(said(&roster, text), (vec![], text.to_owned()), "{text}");
        }
    }

    #[test]
    fn one_robot_alone_is_not_everybody() {
        let roster = Roster::new(["robot"]);
        assert_eq!(said(&roster, "stop, everybody"), (vec![], "stop, everybody".to_owned()));
        assert_eq!(said(&roster, "robot, stop"), (vec![0], "stop".to_owned()));
    }
}
