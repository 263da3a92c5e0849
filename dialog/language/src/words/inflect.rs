//! Forms of verbs: `cleaned`, `washing`, `taken` → the verb in the tables.

use crate::words::lexicon::Lexicon;

/// Participles that no rule makes.
const IRREGULAR: &[(&str, &str)] = &[
    ("taken", "take"),
    ("took", "take"),
    ("brought", "bring"),
    ("broken", "break"),
    ("broke", "break"),
    ("thrown", "throw"),
    ("threw", "throw"),
    ("left", "leave"),
    ("frozen", "freeze"),
    ("hung", "hang"),
    ("given", "give"),
    ("held", "hold"),
    ("gotten", "get"),
    ("got", "get"),
    ("made", "make"),
    ("gone", "go"),
    ("went", "go"),
    ("brewn", "brew"),
    ("stuck", "stick"),
    ("laid", "lay"),
    ("shown", "show"),
    ("spun", "spin"),
    ("found", "find"),
    ("lit", "light"),
    ("shot", "shoot"),
    ("ran", "run"),
];

/// Whether the word is a verb of the tables by itself, or begins one of them.
pub(crate) fn is_verb(lexicon: &Lexicon, word: &str) -> bool {
    lexicon.verb_heads.contains(word)
}

/// The verb of which `word` is a participle or a gerund, if it is one.
pub(crate) fn stem(lexicon: &Lexicon, word: &str) -> Option<String> {
    if let Some((_, verb)) = IRREGULAR.iter().find(|(form, _)| *form == word) {
        return is_verb(lexicon, verb).then(|| (*verb).to_owned());
    }
    let bare = word.strip_suffix("ing").or_else(|| word.strip_suffix("ed"))?;
    let mut letters = bare.chars().rev();
    let is_doubled = letters.next().is_some_and(|last| letters.next() == Some(last));
    let stems = [
        Some(bare.to_owned()),
        Some(format!("{bare}e")),
        bare.strip_suffix('i').map(|stem| format!("{stem}y")),
        is_doubled.then(|| bare[..bare.len().saturating_sub(1)].to_owned()),
    ];
    stems.into_iter().flatten().find(|stem| stem.len() > 1 && is_verb(lexicon, stem))
}
