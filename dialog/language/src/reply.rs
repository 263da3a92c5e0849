//! The sentences around a plan: what the robot is about to do, what it must ask, why it cannot.

use cohabit_cdf::{Catalog, ObjectId};

use crate::{
    answer::HINT,
    describe,
    ground::Miss,
    intent::Intent,
    known::Known,
    phrase::Phrase,
    plan,
    understanding::{Clarification, Step, Understanding, YES_OR_NO},
};

/// How many steps are named before the rest is left to be seen.
const NAMED: usize = 3;

/// Most candidates that a question names.
pub(crate) const ASKED: usize = 4;

/// `OK. The fridge is closed, so I open it first. I am picking up the milk.`
pub(crate) fn plan_reply(steps: &[Step], notes: &[String]) -> String {
    let mut parts: Vec<String> = notes.iter().map(|note| describe::sentence(note)).collect();
    let mut says: Vec<String> = steps.iter().map(|step| step.says.clone()).collect();
    says.dedup();
    if says.len() > NAMED + 1 {
        let last = says.last().cloned();
        says.truncate(NAMED);
        says.extend(last);
    }
    if !says.is_empty() {
        parts.push(describe::sentence(&format!("OK, {}", describe::list(&says, "and then"))));
    }
    parts.join(" ")
}

/// `Which one do you mean: the red mug on the desk or the yellow mug on the table?`
pub(crate) fn which(
    catalog: &Catalog,
    scene: &Known,
    phrase: Option<&Phrase>,
    candidates: &[ObjectId],
) -> Understanding {
    let candidates = candidates[..candidates.len().min(ASKED)].to_vec();
    let names = describe::apart(catalog, scene, &candidates);
    let text = format!("Which one do you mean: {}?", describe::list(&names, "or"));
    reference(phrase, text, candidates, names)
}

/// A question which of `candidates` is meant, called so by `names`.
pub(crate) fn reference(
    phrase: Option<&Phrase>,
    text: String,
    candidates: Vec<ObjectId>,
    mut names: Vec<String>,
) -> Understanding {
    // A single one is a guess: that it is not it must be as easy to say.
    if candidates.len() == 1 {
        names = YES_OR_NO.map(str::to_owned).to_vec();
    }
    Understanding::Question {
        kind: if candidates.len() == 1 { Clarification::Confirmation } else { Clarification::Reference },
        about: phrase.map(plan::noun).unwrap_or_default().to_owned(),
        text,
        candidates,
        options: names,
    }
}

/// What shall I do with this?
pub(crate) fn what_with(catalog: &Catalog, scene: &Known, object: ObjectId) -> Understanding {
    let text = format!("What shall I do with {}?", describe::full(catalog, scene, object));
    let about = describe::bare(catalog, scene, object);
    Understanding::Question { kind: Clarification::Request, about, text, candidates: vec![object], options: Vec::new() }
}

/// What shall I do with what you spoke of?
pub(crate) fn what() -> Understanding {
    Understanding::Question {
        kind: Clarification::Request,
        about: String::new(),
        text: "What shall I do with it? Tell me, for example, \"pick up the mug\".".to_owned(),
        candidates: Vec::new(),
        options: Vec::new(),
    }
}

/// What to say where a phrase found nothing; mismatches and several candidates are questions of their own.
pub(crate) fn miss(phrase: &Phrase, miss: &Miss, intent: Intent) -> String {
    if !phrase.unknown.is_empty() && phrase.namings.is_empty() {
        let words = phrase.unknown.join(" ");
        return format!(
            "I do not know what \"{words}\" is. Name me something in the office, such as the mug or the fridge."
        );
    }
    match miss {
        Miss::NoReferent => format!("What shall I {}? I do not know what \"{}\" is.", intent.verb(), phrase.text),
        Miss::Unknown => format!("What shall I {}?", intent.verb()),
        _ => format!("I have not seen {}.", plan::said(phrase)),
    }
}

/// What is said when nothing was understood.
pub(crate) fn unclear(unknown: &[String]) -> Understanding {
    let quoted: Vec<String> = unknown.iter().take(3).map(|word| format!("\"{word}\"")).collect();
    if quoted.is_empty() {
        return Understanding::refusal(format!("I did not understand that. {HINT}"));
    }
    let noun = if quoted.len() == 1 { "the word" } else { "the words" };
    Understanding::refusal(format!("I do not know {noun} {}. {HINT}", describe::list(&quoted, "and")))
}
