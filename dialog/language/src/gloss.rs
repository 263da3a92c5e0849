//! What was named is said more exactly, or for a reason: `fill my cup, the red one`; `i could use a coffee, so take the mug`.

use crate::{
    clause::{Clause, Part},
    intent::Intent,
    lexicon::Pronoun,
    phrase::{Phrase, Place},
};

/// `i could use a coffee, so take the mug`: what was wished for is the reason.
pub(crate) fn demote(part: &mut Part) {
    if let Part::Clause(clause) = part
        && clause.is_wish
    {
        let phrase = clause.objects.first().cloned();
        *part = phrase.map_or_else(|| Part::Aside(Vec::new()), Part::Mention);
    }
}

/// `fill my cup, the red one`: what was said more exactly is meant so.
pub(crate) fn folded(parts: Vec<Part>) -> Vec<Part> {
    let mut folded: Vec<Part> = Vec::with_capacity(parts.len());
    for part in parts {
        match (part, folded.last_mut()) {
            (Part::Gloss(phrase), Some(Part::Clause(clause))) => {
                if let Some(said) = clause.last_phrase() {
                    let namings = if phrase.namings.is_empty() { said.namings.clone() } else { phrase.namings.clone() };
                    *said = Phrase { namings, pronoun: None, ..phrase };
                }
            }
            (Part::Where(preposition, place), Some(Part::Clause(clause))) => clause.take_where(preposition, place),
            (Part::Gloss(phrase) | Part::Where(_, Place::Object(phrase)), _) => folded.push(Part::Mention(phrase)),
            (Part::Where(..), _) => {}
            (part, _) => folded.push(part),
        }
    }
    folded
}

/// `go to the office, the one with the desks`: says of what was named which one it is.
pub(crate) fn is_gloss(clause: &Clause) -> bool {
    let is_one = |place: &Place| matches!(place, Place::Object(phrase) if phrase.pronoun == Some(Pronoun::One));
    clause.intent == Intent::GoTo && clause.places.iter().any(|(_, place)| is_one(place))
}

/// `fill my cup with water, the red cup`: says of what was named, and not described, which one it is.
pub(crate) fn of(previous: &Clause, clause: &Clause) -> Option<Phrase> {
    let mut previous = previous.clone();
    let said = previous.last_phrase()?;
    let place = clause.places.first().and_then(|(_, place)| match place {
        Place::Object(phrase) => Some(phrase),
        _ => None,
    });
    let phrase = match (clause.objects.as_slice(), clause.places.len()) {
        ([phrase], 0) => Some(phrase),
        ([], 1) => place,
        _ => None,
    }?;
    tells_more(said, phrase).then(|| phrase.clone())
}

/// Whether a phrase says which one is meant by what was said before it.
pub(crate) fn tells_more(said: &Phrase, phrase: &Phrase) -> bool {
    let is_vague = said.pronoun == Some(Pronoun::Thing) && !said.is_described()
        || said.pronoun == Some(Pronoun::One) && said.namings.is_empty();
    let is_same = phrase.namings.iter().any(|naming| said.naming(naming.class).is_some());
    let tells = phrase.is_described() || phrase.side.is_some() || phrase.ordinal.is_some() || !phrase.states.is_empty();
    let told = said.is_described() || said.side.is_some() || said.ordinal.is_some() || said.is_all;
    let is_one = phrase.pronoun == Some(Pronoun::One);
    is_vague && !phrase.namings.is_empty() || !told && tells && (is_same || is_one)
}
