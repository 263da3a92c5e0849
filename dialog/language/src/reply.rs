//! The sentences around a plan: what the robot is about to do, what it must ask, why it cannot.

use crate::{
    answer::HINT,
    context::Role,
    describe,
    ground::Miss,
    intent::Intent,
    phrase::Phrase,
    saying,
    understanding::{Step, Understanding},
};

/// How many steps are named before the rest is left to be seen.
const NAMED: usize = 3;

/// `OK. The fridge is closed, so I open it first. I am picking up the milk.`
pub(crate) fn plan_reply(steps: &[Step], notes: &[String]) -> String {
    let mut parts: Vec<String> = notes.iter().map(|note| describe::sentence(note)).collect();
    if !steps.is_empty() {
        parts.push(describe::sentence(&format!("OK, {}", plan_in_words(steps))));
    }
    parts.join(" ")
}

/// `picking up the milk and then putting the milk on the table`
pub(crate) fn plan_in_words(steps: &[Step]) -> String {
    let mut says: Vec<String> = steps.iter().map(|step| step.says.clone()).collect();
    says.dedup();
    if says.len() > NAMED + 1 {
        let last = says.last().cloned();
        says.truncate(NAMED);
        says.extend(last);
    }
    describe::list(&says, "and then")
}

/// What to say where a phrase found nothing; mismatches and several candidates are questions of their own.
pub(crate) fn miss(phrase: &Phrase, miss: &Miss, intent: Intent, role: Option<Role>) -> String {
    if !phrase.unknown.is_empty() && phrase.namings.is_empty() {
        let words = phrase.unknown.join(" ");
        return format!(
            "I do not know what \"{words}\" is. Name me something in the office, such as the mug or the fridge."
        );
    }
    let what = || saying::what_for(intent, role);
    match miss {
        Miss::NoReferent if phrase.text.is_empty() => what(),
        Miss::NoReferent => format!("{} {}", what(), saying::unresolved(phrase)),
        Miss::Unknown => what(),
        _ if saying::noun(phrase).is_none() => {
            format!("{} {}", saying::unresolved(phrase), what())
        }
        _ => format!("I have not seen {}.", saying::said(phrase)),
    }
}

/// What is said when nothing was understood.
pub(crate) fn unclear(words: &[String]) -> Understanding {
    if words.is_empty() {
        return Understanding::lost(format!("I did not understand that. {HINT}"));
    }
    Understanding::lost(format!("{} What shall I do? {HINT}", unknown(words)))
}

/// That it does not know these words.
pub(crate) fn unknown(words: &[String]) -> String {
    let quoted: Vec<String> = words.iter().take(3).map(|word| format!("\"{word}\"")).collect();
    let noun = if quoted.len() == 1 { "the word" } else { "the words" };
    format!("I do not know {noun} {}.", describe::list(&quoted, "and"))
}
