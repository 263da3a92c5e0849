//! The questions the robot asks: the four of Alexa Arena (location, appearance, direction, reference) and confirmations.

use std::collections::{BTreeMap, BTreeSet};

use cohabit_cdf::{Catalog, ObjectId};

use crate::{
    known::{Known, KnownObject, describe},
    read::{phrase::Phrase, saying},
    say::reply,
    understanding::{Clarification, Step, Understanding},
    words::prose,
};

/// Most candidates that a question names.
pub(crate) const ASKED: usize = 4;

/// Most answers that a question for the look or the place offers.
const OFFERED: usize = 6;

/// The least that an answer about look or place must tell to be asked for, bits.
const TELLING_BITS: f32 = 0.5;

const YES_OR_NO: [&str; 2] = ["yes", "no"];

/// Speaks of objects in a scene.
#[derive(Clone, Copy)]
pub(crate) struct Ask<'a> {
    pub(crate) catalog: &'a Catalog,
    pub(crate) scene: &'a Known,
}

impl Ask<'_> {
    /// Which of these is meant? Names them where they are few; of many, asks for what parts them best, where that is
    /// their look or their place.
    pub(crate) fn which(self, phrase: Option<&Phrase>, candidates: &[ObjectId]) -> Understanding {
        if candidates.len() > ASKED
            && let Some(question) = self.what_parts(phrase, candidates)
        {
            return question;
        }
        let candidates = candidates[..candidates.len().min(ASKED)].to_vec();
        let names = describe::apart(self.catalog, self.scene, &candidates);
        let text = match names.as_slice() {
            [one] => format!("Do you mean {one}?"),
            _ => format!("Which one do you mean: {}?", prose::list(&names, "or")),
        };
        reference(phrase, text, candidates, names)
    }

    /// There is none as described: perhaps one of these will do.
    pub(crate) fn instead(self, phrase: &Phrase, candidates: Vec<ObjectId>) -> Understanding {
        let names = describe::apart_from(self.catalog, self.scene, &candidates, phrase);
        let unknown = saying::noun(phrase).filter(|noun| !names.iter().any(|name| describe::is_same(name, noun)));
        let denied = unknown.map(|_| format!("{UNKNOWN} {}. ", saying::said(phrase))).unwrap_or_default();
        let text = format!("{denied}Do you mean {}?", prose::list(&names, "or"));
        reference(Some(phrase), text, candidates, names)
    }

    /// Whether the doubtful one is meant, where it cannot be undone.
    pub(crate) fn for_good(self, phrase: Option<&Phrase>, verb: &str, object: ObjectId) -> Understanding {
        let names = describe::apart(self.catalog, self.scene, &[object]);
        let the = names.first().map_or("it", String::as_str);
        let text = format!("Shall I {verb} {the}? That cannot be undone.");
        reference(phrase, text, vec![object], names.clone())
    }

    /// The question whose answer tells most, if look or place tell enough.
    fn what_parts(self, phrase: Option<&Phrase>, candidates: &[ObjectId]) -> Option<Understanding> {
        let objects: Vec<&KnownObject> = candidates.iter().filter_map(|id| self.scene.object(*id)).collect();
        let looks = self.parts(&objects, |object| describe::look(self.catalog, object));
        let places = self.parts(&objects, |object| describe::place(self.catalog, self.scene, object.id));
        let noun = phrase.and_then(saying::noun).unwrap_or("thing");
        let names: BTreeSet<String> = objects.iter().map(|object| describe::name(self.catalog, object.class)).collect();
        // `garbage`: of so many trash cans.
        let kind = names
            .first()
            .filter(|_| names.len() == 1)
            .map_or(if noun.contains(' ') { "thing" } else { noun }, String::as_str);
        let known = format!("I know of {}.", prose::counted(kind, objects.len()));
        let (kind, text, parts) = if bits(&looks) >= bits(&places) {
            (Clarification::Appearance, format!("{known} What does the one you mean look like?"), looks)
        } else {
            (Clarification::Location, format!("{known} Where is the one you mean?"), places)
        };
        (bits(&parts) >= TELLING_BITS).then(|| Understanding::Question {
            kind,
            about: noun.to_owned(),
            text,
            candidates: candidates.to_vec(),
            options: parts.into_keys().filter(|part| !part.is_empty()).take(OFFERED).collect(),
        })
    }

    fn parts(self, objects: &[&KnownObject], part: impl Fn(&KnownObject) -> String) -> BTreeMap<String, usize> {
        let mut parts = BTreeMap::new();
        objects.iter().for_each(|object| *parts.entry(part(object)).or_default() += 1);
        parts
    }

    /// What shall I do with this?
    pub(crate) fn what_with(self, object: ObjectId) -> Understanding {
        Understanding::Question {
            kind: Clarification::Request,
            about: describe::bare(self.catalog, self.scene, object),
            text: format!("What shall I do with {}?", describe::full(self.catalog, self.scene, object)),
            candidates: vec![object],
            options: Vec::new(),
        }
    }
}

/// How it begins to say that nothing is as described, and that it has not seen what was.
const UNKNOWN: &str = "I do not know of";
const UNSEEN: &str = "I have not seen";

/// What an answer that names a part tells: the entropy of the parts.
fn bits(parts: &BTreeMap<String, usize>) -> f32 {
    let all: usize = parts.values().sum();
    let share = |count: &usize| *count as f32 / all.max(1) as f32;
    parts.values().map(share).map(|share| -share * share.log2()).sum()
}

/// A question which of `candidates` is meant, called so by `names`; of a single one, whether it is.
fn reference(phrase: Option<&Phrase>, text: String, candidates: Vec<ObjectId>, names: Vec<String>) -> Understanding {
    let is_one = candidates.len() == 1;
    Understanding::Question {
        kind: if is_one { Clarification::Confirmation } else { Clarification::Reference },
        about: phrase.and_then(saying::noun).unwrap_or_default().to_owned(),
        text,
        candidates,
        options: if is_one { YES_OR_NO.map(str::to_owned).to_vec() } else { names },
    }
}

fn of_kind(kind: Clarification, about: &str, text: String, options: &[&str]) -> Understanding {
    let options = options.iter().map(|option| (*option).to_owned()).collect();
    Understanding::Question { kind, about: about.to_owned(), text, candidates: Vec::new(), options }
}

/// A question that is answered by yes or no.
pub(crate) fn confirmation(text: impl Into<String>) -> Understanding {
    of_kind(Clarification::Confirmation, "", text.into(), &YES_OR_NO)
}

/// Whether to carry out a plan.
pub(crate) fn shall_i(steps: &[Step], notes: &[String]) -> Understanding {
    let notes: Vec<String> = notes.iter().map(|note| prose::sentence(note)).collect();
    let question = is_it(&reply::plan_in_words(steps));
    if notes.is_empty() { question } else { question.after(&notes.join(" ")) }
}

/// Whether to do what it comes to in these words.
pub(crate) fn is_it(name: &str) -> Understanding {
    confirmation(format!("I understand: {name}. Shall I?"))
}

/// Which of these plans is meant? What all of them begin with, and end with, is said once.
pub(crate) fn which_plan(names: &[&str], head: &str, tail: &str) -> Understanding {
    let named: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
    let which = prose::list(&named, "or");
    let text = match (head, tail) {
        ("", "") => format!("I am not sure what you mean: {which}?"),
        ("", tail) => format!("I am not sure what you mean before {tail}: {which}?"),
        (head, "") => format!("I understand: {head}. I am not sure what comes then: {which}?"),
        (head, tail) => format!("I understand: {head}. I am not sure what comes then, before {tail}: {which}?"),
    };
    of_kind(Clarification::Confirmation, "", text, names)
}

/// Where is what nobody has seen?
pub(crate) fn location(phrase: &Phrase) -> Understanding {
    let unseen = saying::noun(phrase)
        .map_or_else(|| saying::unresolved(phrase), |_| format!("{UNSEEN} {}.", saying::said(phrase)));
    let text = format!("{unseen} Where is it, or shall I look around?");
    of_kind(Clarification::Location, saying::noun(phrase).unwrap_or_default(), text, &["look around"])
}

/// What does it look like, whose name means nothing to the robot?
pub(crate) fn appearance(phrase: &Phrase) -> Understanding {
    let word = phrase.unknown.join(" ");
    let text = format!("I do not know what \"{word}\" is. What does it look like?");
    of_kind(Clarification::Appearance, &word, text, &[])
}

/// What does `it` stand for?
pub(crate) fn referent(text: String) -> Understanding {
    of_kind(Clarification::Request, "", text, &[])
}

/// Which way?
pub(crate) fn direction() -> Understanding {
    let text = "Which direction should I turn to?".to_owned();
    of_kind(Clarification::Direction, "", text, &["left", "right", "around"])
}

/// Which room is meant?
pub(crate) fn which_room(kind: &str, names: &[String]) -> Understanding {
    let text = format!("Which {kind} do you mean: {}?", names.join(" or "));
    let options: Vec<&str> = names.iter().map(String::as_str).collect();
    of_kind(Clarification::Reference, kind, text, &options)
}

/// What shall I do with what you spoke of?
pub(crate) fn what() -> Understanding {
    let text = "What shall I do with it? Tell me, for example, \"pick up the mug\".".to_owned();
    of_kind(Clarification::Request, "", text, &[])
}
