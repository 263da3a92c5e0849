//! How text is put together in English: lists, articles, numbers and plurals of nouns, sentences.

use crate::words::token::NUMBERS;

/// Nouns that take no article.
const MASS: [&str; 9] = ["tea", "milk", "bread", "coffee", "water", "cereal", "toast", "jelly", "peanut butter"];

/// Nouns of one thing that end as those of several do.
const SINGULAR: [&str; 9] = ["thermos", "bus", "gas", "lens", "canvas", "cactus", "atlas", "virus", "stylus"];

/// What joins more to a noun: `milk from the fridge`.
const JOINTS: [&str; 9] = ["of", "from", "in", "on", "with", "by", "at", "next", "that"];

/// Whether a name is of several things: `the glass doors`, `any keys on the table`, not `the stack of papers`.
fn is_plural(name: &str) -> bool {
    let last = name.split(' ').take_while(|word| !JOINTS.contains(word)).last().unwrap_or_default();
    last.ends_with('s') && !last.ends_with("ss") && !SINGULAR.contains(&last)
}

/// What an answer says beside its yes or no, as a sentence.
pub(crate) fn without_yes(text: &str) -> String {
    sentence(text.strip_prefix("Yes, ").or_else(|| text.strip_prefix("No, ")).unwrap_or(text))
}

/// `is` or `are`, after a name.
pub(crate) fn is(name: &str) -> &'static str {
    if is_plural(name) { "are" } else { "is" }
}

/// `was` or `were`, after a name.
pub(crate) fn was(name: &str) -> &'static str {
    if is_plural(name) { "were" } else { "was" }
}

/// What stands for a name: `it` or `them`.
pub(crate) fn it(name: &str) -> &'static str {
    if is_plural(name) { "them" } else { "it" }
}

/// What stands for a name as the subject: `it` or `they`.
pub(crate) fn they(name: &str) -> &'static str {
    if is_plural(name) { "they" } else { "it" }
}

/// `a, b and c`; `last` is the word before the last one.
pub(crate) fn list(items: &[String], last: &str) -> String {
    match items {
        [] => String::new(),
        [one] => one.clone(),
        [head @ .., tail] => format!("{} {last} {tail}", head.join(", ")),
    }
}

/// A noun with its indefinite article, or `some` where it takes none.
pub(crate) fn indefinite(noun: &str) -> String {
    let head = noun.split(' ').take_while(|word| !JOINTS.contains(word)).collect::<Vec<_>>().join(" ");
    if is_plural(noun)
        || MASS.iter().any(|mass| head.strip_suffix(mass).is_some_and(|rest| rest.is_empty() || rest.ends_with(' ')))
    {
        return format!("some {noun}");
    }
    let article = if noun.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
    format!("{article} {noun}")
}

/// So many of a noun, in words: `an apple`, `two apples`.
pub(crate) fn counted(noun: &str, count: usize) -> String {
    if count < 2 {
        return indefinite(noun);
    }
    let number = NUMBERS.get(count).map_or_else(|| count.to_string(), |number| (*number).to_owned());
    if MASS.contains(&noun) {
        return format!("{number} times {noun}");
    }
    format!("{number} {}", plural(noun))
}

/// Several of a noun.
pub(crate) fn plural(noun: &str) -> String {
    const VOWEL_Y: [&str; 4] = ["ay", "ey", "oy", "uy"];
    const HISSING: [&str; 5] = ["ss", "x", "z", "ch", "sh"];
    let ends = |endings: &[&str]| endings.iter().any(|ending| noun.ends_with(ending));
    if let Some(stem) = noun.strip_suffix("fe").or_else(|| noun.strip_suffix('f').filter(|_| ends(&["lf"]))) {
        return format!("{stem}ves");
    }
    if let Some(stem) = noun.strip_suffix('y').filter(|_| !ends(&VOWEL_Y)) {
        return format!("{stem}ies");
    }
    match noun {
        _ if ends(&HISSING) => format!("{noun}es"),
        _ if noun.ends_with('s') => noun.to_owned(),
        _ => format!("{noun}s"),
    }
}

/// The text with a capital letter at its start and a full stop at its end.
pub(crate) fn sentence(text: &str) -> String {
    let text = text.trim();
    let mut characters = text.chars();
    let Some(first) = characters.next() else { return String::new() };
    let ending = if text.trim_end_matches('"').ends_with(['.', '!', '?']) { "" } else { "." };
    format!("{}{}{ending}", first.to_uppercase(), characters.as_str())
}

/// What a request asks for, as a part of a sentence: `pour the milk. is it full?` → `pouring the milk and then answering "is it full?"`.
pub(crate) fn doing(request: &str) -> String {
    list(&doings(request), "and then")
}

/// The same, each deed by itself.
pub(crate) fn doings(request: &str) -> Vec<String> {
    let of_part = |part: &str| -> Vec<String> {
        if is_quoted(part) { vec![doing_one(part)] } else { part.split(" and then ").map(doing_one).collect() }
    };
    request.split(". ").flat_map(of_part).collect()
}

/// Whether it is told in its own words: a question, a condition, or what is no request by itself.
fn is_quoted(request: &str) -> bool {
    let verb = request.split_once(' ').map_or(request, |(verb, _)| verb);
    request.ends_with('?')
        || matches!(verb, "if" | "when" | "once" | "unless" | "until" | "wait")
        || verb.ends_with([',', ':'])
}

fn doing_one(request: &str) -> String {
    if request.ends_with('?') {
        return format!("answering \"{request}\"");
    }
    if let Some(request) = request.strip_prefix("do not ") {
        return format!("not {}", doing_one(request));
    }
    let (verb, rest) = request.split_once(' ').unwrap_or((request, ""));
    if is_quoted(request) {
        return format!("\"{request}\"");
    }
    format!("{} {rest}", gerund(verb)).trim_end().to_owned()
}

/// What is done, as what is to be done: `closing the fridge` → `close the fridge`.
pub(crate) fn to_do(doing: &str) -> String {
    const IRREGULAR: [(&str, &str); 24] = [
        ("closing", "close"),
        ("coming", "come"),
        ("cutting", "cut"),
        ("examining", "examine"),
        ("firing", "fire"),
        ("freezing", "freeze"),
        ("getting", "get"),
        ("giving", "give"),
        ("leaving", "leave"),
        ("making", "make"),
        ("moving", "move"),
        ("placing", "place"),
        ("putting", "put"),
        ("removing", "remove"),
        ("rinsing", "rinse"),
        ("scanning", "scan"),
        ("setting", "set"),
        ("shutting", "shut"),
        ("stopping", "stop"),
        ("storing", "store"),
        ("swapping", "swap"),
        ("taking", "take"),
        ("using", "use"),
        ("wiping", "wipe"),
    ];
    let (verb, rest) = doing.split_once(' ').unwrap_or((doing, ""));
    let lower = verb.to_lowercase();
    let irregular = IRREGULAR.iter().find(|(done, _)| *done == lower).map(|(_, plain)| *plain);
    let plain = irregular.or_else(|| lower.strip_suffix("ing")).unwrap_or(verb);
    format!("{plain} {rest}").trim_end().to_owned()
}

/// `put` → `putting`, `close` → `closing`.
fn gerund(verb: &str) -> String {
    let is_vowel = |letter: char| "aeiou".contains(letter);
    let letters: Vec<char> = verb.chars().collect();
    let vowels = letters.iter().filter(|letter| is_vowel(**letter)).count();
    match letters.as_slice() {
        [.., before, 'e'] if *before != 'e' && vowels > 1 => format!("{}ing", &verb[..verb.len() - 1]),
        [.., before, vowel, last]
            if vowels == 1 && is_vowel(*vowel) && !is_vowel(*before) && !is_vowel(*last) && !"wxy".contains(*last) =>
        {
            format!("{verb}{last}ing")
        }
        _ => format!("{verb}ing"),
    }
}

/// A sentence as the rest of another one: with a small letter at its start, unless that begins `I`.
pub(crate) fn within_sentence(text: &str) -> String {
    let mut characters = text.chars();
    match characters.next() {
        Some(first) if !text.starts_with("I ") => first.to_lowercase().chain(characters).collect(),
        _ => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stands_for_a_name_is_of_its_number() {
        let check = |name: &str, expected: [&str; 3]| assert_eq!([it(name), they(name), is(name)], expected, "{name}");
        for many in ["any keys", "the building blocks", "any keys on the table", "the reading glasses in the study"] {
            check(many, ["them", "they", "are"]);
        }
        for one in ["a mug", "the stack of papers", "the wine glass", "a thermos", "a bowl with grapes", "it"] {
            check(one, ["it", "it", "is"]);
        }
        assert_eq!([indefinite("thermos"), indefinite("keys on the table")], ["a thermos", "some keys on the table"]);
    }

    #[test]
    fn a_request_is_told_as_what_is_done() {
        let check = |request: &str, done: &str| assert_eq!(doing(request), done);
        check("put the mug on the desk", "putting the mug on the desk");
        check("close the fridge. wash the mug", "closing the fridge and then washing the mug");
        check("do not open the fridge", "not opening the fridge");
        check("go back", "going back");
        check("clean the cup and then fill it", "cleaning the cup and then filling it");
        check("is the laser on?", "answering \"is the laser on?\"");
        check("if the mug is dirty, wash it", "\"if the mug is dirty, wash it\"");
    }

    #[test]
    fn what_is_done_is_told_as_what_is_to_be_done() {
        let check = |doing: &str, plain: &str| assert_eq!(to_do(doing), plain);
        check("closing the fridge", "close the fridge");
        check("putting the mug on the desk", "put the mug on the desk");
        check("filling it", "fill it");
        check("looking around", "look around");
    }
}
