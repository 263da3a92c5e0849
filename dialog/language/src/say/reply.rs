//! The sentences around a plan: what the robot is about to do, what it must ask, why it cannot.

use cohabit_cdf::{Action, Verb};

use crate::{
    ground::want::Miss,
    read::{
        clause::Clause,
        phrase::{Phrase, Place},
        saying,
        slot::Role,
    },
    understanding::{Step, Understanding},
    words::{
        intent::Intent,
        lexicon::{Manner, Preposition},
        prose,
    },
};

/// Why something is done: who says it so plainly that there is nothing to interpret has asked for it.
pub(crate) const ASKED_TO: &str = "you asked me to ";
pub(crate) const UNDERSTOOD_TO: &str = "I understood that I should ";

/// How many steps are named at most.
const NAMED: usize = 6;
/// How many of them name what is only on the way, too.
const FEW: usize = 4;

/// `The fridge is closed, so I open it first. OK, picking up the milk.`
pub(crate) fn plan_reply(steps: &[Step], notes: &[String]) -> String {
    let mut parts: Vec<String> = Vec::new();
    for note in notes.iter().map(|note| prose::sentence(note)) {
        if !parts.contains(&note) {
            parts.push(note);
        }
    }
    if !steps.is_empty() {
        parts.push(prose::sentence(&format!("OK, {}", plan_in_words(steps))));
    }
    parts.join(" ")
}

/// A part of a plan in words.
#[derive(Clone, Debug, Eq, PartialEq)]
pub(crate) struct Told {
    says: String,
    /// What is opened, closed and gone to: where there is much to tell, that goes without saying.
    is_on_the_way: bool,
}

impl Told {
    /// What a step says.
    pub(crate) fn of_step(step: &Step) -> Self {
        let is_on_the_way =
            matches!(step.action, Action::Interact { verb: Verb::Open | Verb::Close, .. } | Action::GoTo { .. });
        Self { says: step.says.clone(), is_on_the_way }
    }

    /// What is planned once it comes to it.
    pub(crate) const fn then(says: String) -> Self {
        Self { says, is_on_the_way: false }
    }
}

/// `picking up the milk and then putting the milk on the table`
pub(crate) fn plan_in_words(steps: &[Step]) -> String {
    told_in_words(&steps.iter().map(Told::of_step).collect::<Vec<_>>())
}

/// The parts of a plan as one.
pub(crate) fn told_in_words(told: &[Told]) -> String {
    let named = |is_named: &dyn Fn(&Told) -> bool| {
        let mut says: Vec<String> = told.iter().filter(|part| is_named(part)).map(|part| part.says.clone()).collect();
        says.dedup();
        says
    };
    let mut says = named(&|_| true);
    if says.len() > FEW {
        says = Some(named(&|part| !part.is_on_the_way)).filter(|says| !says.is_empty()).unwrap_or(says);
    }
    if says.len() > NAMED {
        let last = says.last().cloned();
        says.truncate(NAMED - 1);
        says.push("so on".to_owned());
        return format!("{} until {}", prose::list(&says, "and"), last.unwrap_or_default());
    }
    prose::list(&says, "and then")
}

/// `find the bowl and then put it on the table`: what is asked for, in plain words.
pub(crate) fn request_in_words(clauses: &[Clause]) -> String {
    let asked: Vec<String> =
        clauses.iter().filter(|clause| clause.intent != Intent::Mention).map(clause_in_words).collect();
    prose::list(&asked, "and then")
}

/// `finding the bowl`, `putting it on the table`: the same, as what is done.
pub(crate) fn doings(clauses: &[Clause]) -> impl Iterator<Item = String> {
    let asked = clauses.iter().filter(|clause| clause.intent != Intent::Mention);
    asked.map(|clause| prose::doing(&clause_in_words(clause)))
}

fn clause_in_words(clause: &Clause) -> String {
    // Words have lost their apostrophes: no other one ends like `boss's`.
    let said = |phrase: &Phrase| match phrase.text.as_str() {
        "" => "it".to_owned(),
        text => text.replace("sss ", "ss's "),
    };
    // `make coffee`, where nobody said in what.
    let is_told = !clause.objects.is_empty() || !clause.places.is_empty();
    let verb = clause.intent.verb();
    let verb = verb.strip_suffix(" in").filter(|_| !is_told).unwrap_or(verb);
    // `go to the table`, of who goes to it
    let word = |preposition: &Preposition| Some(preposition.word()).filter(|word| !verb.ends_with(&format!(" {word}")));
    let place_of = |preposition: &Preposition, place: String| match word(preposition) {
        Some(word) => format!("{word} {place}"),
        None => place,
    };
    let objects: Vec<String> = clause.objects.iter().map(said).collect();
    let places = clause.places.iter().filter_map(|(preposition, place)| {
        Some(match place {
            Place::Room(room) | Place::Viewpoint(room, _) => place_of(preposition, format!("the {}", room.name)),
            Place::Object(phrase) => place_of(preposition, said(phrase)),
            Place::Viewpoints(_) | Place::Side(_) | Place::Here => return None,
        })
    });
    let color = clause.color.clone();
    let words = std::iter::once(verb.to_owned());
    let words = words.chain([prose::list(&objects, "and")]).chain(color).chain(places);
    let away = (clause.manner == Some(Manner::Store) && clause.places.is_empty()).then(|| "away".to_owned());
    words.chain(away).filter(|word| !word.is_empty()).collect::<Vec<_>>().join(" ")
}

/// Plans told apart.
pub(crate) struct Apart {
    /// What all of them begin with, and end with, in words; nothing, where they do not.
    pub(crate) head: String,
    pub(crate) tail: String,
    /// What each does between.
    pub(crate) names: Vec<String>,
}

/// What several plans share, and what each has of its own. Where one has nothing of its own, nothing is shared: it would have no name.
pub(crate) fn apart(plans: &[Vec<Told>]) -> Apart {
    let first = plans.first().map(Vec::as_slice).unwrap_or_default();
    let most = plans.iter().map(Vec::len).min().unwrap_or_default().saturating_sub(1);
    let is_shared = |at: &usize| plans.iter().all(|plan| plan[*at] == first[*at]);
    let head = (0..most).take_while(is_shared).count();
    let is_shared = |at: &usize| plans.iter().all(|plan| plan[plan.len() - 1 - at] == first[first.len() - 1 - at]);
    let tail = (0..most - head).take_while(is_shared).count();
    Apart {
        head: told_in_words(&first[..head]),
        tail: told_in_words(&first[first.len() - tail..]),
        names: plans.iter().map(|plan| told_in_words(&plan[head..plan.len() - tail])).collect(),
    }
}

/// What to say where a phrase found nothing; mismatches and several candidates are questions of their own.
pub(crate) fn miss(phrase: &Phrase, miss: &Miss, intent: Intent, role: Option<Role>) -> String {
    if !phrase.unknown.is_empty() && phrase.namings.is_empty() {
        let words = phrase.unknown.join(" ");
        return format!("I do not know what \"{words}\" is. Name me something else, such as the mug or the fridge.");
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
pub(crate) fn unclear(words: &[String], hint: &str) -> Understanding {
    if words.is_empty() {
        return Understanding::lost(format!("I did not understand that. {hint}"));
    }
    Understanding::lost(format!("{} What shall I do? {hint}", unknown(words)))
}

/// That it does not know these words.
pub(crate) fn unknown(words: &[String]) -> String {
    let quoted: Vec<String> = words.iter().take(3).map(|word| format!("\"{word}\"")).collect();
    let noun = if quoted.len() == 1 { "the word" } else { "the words" };
    format!("I do not know {noun} {}.", prose::list(&quoted, "and"))
}
