//! Whether different words ask for the same: `put the bear in the box`, and `pick up the bear; put it in the toy box`.

use crate::{
    read::{
        clause::{Clause, Part},
        parts,
        phrase::{Phrase, Place, Relation},
    },
    talk::{conversation::Conversation, search::classes_of},
    words::intent::Intent,
};

impl Conversation<'_> {
    /// Whether two texts of plain requests ask for the same things to be done, by what their words mean: what is to be done with things that were
    /// not seen yet cannot be told apart by what it would change.
    pub(crate) fn asks_the_same(&self, one: &str, other: &str) -> bool {
        match (self.asked_deeds(one), self.asked_deeds(other)) {
            (Some(one), Some(other)) => {
                one.len() == other.len() && one.iter().zip(&other).all(|(one, other)| is_clause_alike(one, other))
            }
            _ => false,
        }
    }

    /// The requests of a text, without the picking up of what is put somewhere next; nothing, if there is anything else in it.
    fn asked_deeds(&self, text: &str) -> Option<Vec<Clause>> {
        let mut deeds: Vec<Clause> = Vec::new();
        for request in text.split("; ").filter(|_| !text.contains('?')) {
            for part in parts::parts(self.lexicon, self.catalog, &self.wording(request).tidied) {
                let Part::Clause(mut clause) = part else { return None };
                let taken = deeds.last().filter(|before| before.intent == Intent::PickUp).and_then(taken_alone);
                if let Some((taken, placed)) = taken.zip(placed(&mut clause))
                    && (placed.is_bare_pronoun() || is_phrase_alike(&taken, placed))
                {
                    *placed = taken;
                    deeds.pop();
                }
                deeds.push(clause);
            }
        }
        (!deeds.is_empty()).then_some(deeds)
    }
}

/// What a clause has picked up, if that is one thing.
fn taken_alone(clause: &Clause) -> Option<Phrase> {
    match (clause.objects.as_slice(), clause.places.as_slice()) {
        ([thing], []) => Some(thing.clone()),
        _ => None,
    }
}

/// What a clause has put somewhere.
fn placed(clause: &mut Clause) -> Option<&mut Phrase> {
    let is_put = matches!(clause.intent, Intent::Place | Intent::Bring);
    clause.objects.first_mut().filter(|_| is_put)
}

fn is_clause_alike(one: &Clause, other: &Clause) -> bool {
    let is_thing_alike = |(one, other): (&Phrase, &Phrase)| is_phrase_alike(one, other);
    let is_place_alike = |((_, one), (_, other)): (&(_, Place), &(_, Place))| match (one, other) {
        (Place::Object(one), Place::Object(other)) => is_phrase_alike(one, other),
        (one, other) => one == other,
    };
    one.intent == other.intent
        && one.manner == other.manner
        && (&one.direction, &one.amount, &one.color, &one.fluid)
            == (&other.direction, &other.amount, &other.color, &other.fluid)
        && one.objects.len() == other.objects.len()
        && one.places.len() == other.places.len()
        && one.objects.iter().zip(&other.objects).all(is_thing_alike)
        && one.places.iter().zip(&other.places).all(is_place_alike)
}

/// Whether two phrases mean things of one class, of which the same is said besides.
fn is_phrase_alike(one: &Phrase, other: &Phrase) -> bool {
    let plain =
        |phrase: &Phrase| Phrase { text: String::new(), namings: Vec::new(), relations: Vec::new(), ..phrase.clone() };
    let classes = classes_of(other);
    let is_relation_alike =
        |(one, other): (&Relation, &Relation)| one.kind == other.kind && is_phrase_alike(&one.to, &other.to);
    let is_class_alike =
        one.namings.is_empty() && classes.is_empty() || classes_of(one).iter().any(|class| classes.contains(class));
    is_class_alike
        && plain(one) == plain(other)
        && one.relations.len() == other.relations.len()
        && one.relations.iter().zip(&other.relations).all(is_relation_alike)
}
