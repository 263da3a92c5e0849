//! How text is put together in English: lists, articles, numbers and plurals of nouns, sentences.

use crate::words::token::NUMBERS;

/// Nouns that take no article.
const MASS: [&str; 8] = ["milk", "bread", "coffee", "water", "cereal", "toast", "jelly", "peanut butter"];

/// Whether a name is of several things: `the glass doors`, not `the stack of papers`.
fn is_plural(name: &str) -> bool {
    let head = name.split(" of ").next().unwrap_or(name);
    head.ends_with('s') && !head.ends_with("ss")
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
    // `milk from the fridge`
    let is_joint = |word: &&str| ["of", "from", "in", "on", "with", "by", "at", "next", "that"].contains(word);
    let head = noun.split(' ').take_while(|word| !is_joint(word)).collect::<Vec<_>>().join(" ");
    let is_plural = head.ends_with('s') && !head.ends_with("ss");
    if is_plural
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

/// A sentence as the rest of another one: with a small letter at its start, unless that begins `I`.
pub(crate) fn within_sentence(text: &str) -> String {
    let mut characters = text.chars();
    match characters.next() {
        Some(first) if !text.starts_with("I ") => first.to_lowercase().chain(characters).collect(),
        _ => text.to_owned(),
    }
}
