//! Another one of a kind was meant than the one that the robot has just done something to, or is at: `no, the other one`.

use cohabit_cdf::ObjectId;

use crate::{
    context::{Context, search::Consent},
    known::KnownObject,
    read::{
        phrase::Phrase,
        reader::Reader,
        slot::{self, Role, Slot},
        tidy,
    },
    talk::conversation::Conversation,
    understanding::{Step, Understanding},
    words::{
        lexicon::{Naming, Side, Small},
        token::{self, MAX_CHARS},
    },
};

/// What stands for one of a kind.
const ONE: &str = "one";

impl Conversation<'_> {
    /// `no, the other one`, `not that one, the one by the door`, `the left one`: the last request again, of the one that is said now. Nothing,
    /// where something else is said, or another one is not known.
    pub(crate) fn corrected(&self, words: &[String], context: &mut Context) -> Option<Understanding> {
        if context.last_plan.is_empty() || context.question.is_some() || words.iter().any(|word| word == "?") {
            return None;
        }
        let said = tidy::plain(words);
        let (denied, at) = self.denied(&said);
        let rest = &said[at..];
        // `pick up the other mug` is a request of its own.
        if self.lexicon.verbs.longest(rest).is_some() {
            return None;
        }
        let told = if rest.is_empty() { Phrase::default() } else { self.answer_phrase(rest)? };
        let is_other = denied != Denied::Nothing || told.side == Some(Side::Other);
        let says_which =
            told.is_described() || told.side.is_some() || told.ordinal.is_some() || !told.states.is_empty();
        let is_meant = match rest.is_empty() {
            true => denied == Denied::That && said.iter().any(|word| word == ONE),
            false => says_which && (told.is_one_of_kind() || is_other && !told.namings.is_empty()),
        };
        if !is_meant {
            return None;
        }
        let (slot, done) = self.done_to_one_of_several(&told, context)?;
        let mut clauses = context.request.clone();
        let phrase = slot::phrase_mut(&mut clauses, slot)?;
        *phrase = self.another(phrase, told, is_other.then_some(done), done);
        context.search = None;
        context.later.clear();
        context.reason = format!("you said \"{}\"", token::sentence(words));
        context.mistaken = Some(done);
        Some(self.plan(clauses, Consent::default(), context))
    }

    /// `no, not the whole laser, I mean only the tip`, of who was just told that a laser cannot be taken: the same of the tip. Nothing,
    /// where no other thing is named.
    pub(crate) fn meant_instead(&self, utterance: &str, context: &mut Context) -> Option<Understanding> {
        let is_refusal = |(by_robot, text): &(bool, String)| *by_robot && context.refused.as_ref() == Some(text);
        if !context.lines().last().is_some_and(is_refusal) || utterance.chars().nth(MAX_CHARS).is_some() {
            return None;
        }
        let (words, _) = self.lexicon.normalise(utterance);
        let denial = words.iter().position(|word| self.lexicon.ifs.negations.contains(word))?;
        let said_at = |at: usize| self.lexicon.instead.longest(&words[at..]).map(|(length, ())| at + length);
        let first = (denial + 1..words.len()).find_map(said_at)?;
        let mut reader = Reader::new(self.lexicon, &words);
        reader.at = first;
        reader.skip(|lexicon| &lexicon.instead);
        if reader.at_verb() {
            return None;
        }
        let is_thing = |phrase: &Phrase| !phrase.namings.is_empty() && phrase.unknown.is_empty();
        let meant = reader.phrase_with_place().filter(is_thing)?;
        let mut clauses = context.impossible.clone();
        let object = clauses.iter_mut().find_map(|clause| clause.objects.first_mut())?;
        *object = meant;
        (context.pending, context.search) = (None, None);
        context.later.clear();
        context.impossible.clear();
        Some(self.plan(clauses, Consent::default(), context))
    }

    /// What words deny at their start, and how many of them do.
    fn denied(&self, words: &[String]) -> (Denied, usize) {
        let (mut denied, mut at) = (Denied::Nothing, 0);
        while at < words.len() {
            let rest = &words[at..];
            let small = self.lexicon.small.longest(rest).filter(|(_, smalls)| smalls.contains(&Small::Neither));
            let neither = small.map_or(0, |(length, _)| length);
            let is_no = self.lexicon.small.exact(&rest[..1]).is_some_and(|smalls| smalls.contains(&Small::No));
            let that = self.lexicon.corrections.longest(rest).map_or(0, |(length, ())| length).max(neither);
            if that > 0 {
                (denied, at) = (Denied::That, at + that);
            } else if is_no {
                (denied, at) = (if denied == Denied::That { denied } else { Denied::No }, at + 1);
            } else {
                break;
            }
        }
        (denied, at)
    }

    /// The phrase of the last request that was taken for one of several of its kind, and the one that it was taken for.
    fn done_to_one_of_several(&self, told: &Phrase, context: &Context) -> Option<(Slot, ObjectId)> {
        let touched: Vec<ObjectId> = context.last_plan.iter().rev().filter_map(Step::object).collect();
        let taken_for = |phrase: &Phrase| {
            let object = |id: ObjectId| self.scene.object(id);
            let is_it = |id: &&ObjectId| match phrase.chosen {
                Some(chosen) => chosen == **id,
                None => object(**id).is_some_and(|object| phrase.naming(object.class).is_some()),
            };
            let done = object(touched.iter().find(is_it).copied()?)?;
            let is_of_kind = told.namings.is_empty() || told.naming(done.class).is_some();
            let name = &self.catalog.names(done.class).plain;
            let is_another = |other: &KnownObject| {
                other.id != done.id
                    && (phrase.naming(other.class).is_some() || self.catalog.names(other.class).plain == *name)
            };
            (is_of_kind && self.scene.objects.iter().any(is_another)).then_some(done.id)
        };
        let mut slots = context.request.iter().enumerate().rev().flat_map(|(clause, of)| {
            let objects = (0..of.objects.len()).map(Role::Object);
            let places = (0..of.places.len()).map(Role::Place);
            objects.chain(places).map(move |role| Slot { clause, role })
        });
        slots.find_map(|slot| Some((slot, taken_for(slot::phrase(&context.request, slot)?)?)))
    }

    /// A phrase of the same kind as one that was taken for `done`, with what is said of it now; `excluded` is not meant.
    fn another(&self, before: &Phrase, told: Phrase, excluded: Option<ObjectId>, done: ObjectId) -> Phrase {
        let plain = |class| &self.catalog.names(class).plain;
        let name = self.scene.object(done).map(|object| plain(object.class));
        let is_of_kind = |other: &&KnownObject| name.is_some_and(|name| plain(other.class) == name);
        let is_called_so = |other: &KnownObject| other.id != done && before.naming(other.class).is_some();
        // `the other one`, of who said `the red shelf`: any shelf.
        let namings = if self.scene.objects.iter().any(is_called_so) {
            before.namings.clone()
        } else {
            let kind = self.scene.objects.iter().filter(is_of_kind);
            kind.map(|other| Naming { class: other.class, weight: 1.0 }).collect()
        };
        let says_where = !told.relations.is_empty() || told.room.is_some() || told.is_here;
        let relations = if says_where { told.relations } else { before.relations.clone() };
        Phrase {
            text: before.text.clone(),
            pronoun: None,
            namings,
            fluid: before.fluid,
            side: told.side.filter(|side| *side != Side::Other),
            room: told.room.or(before.room.filter(|_| !says_where)),
            relations,
            chosen: None,
            excluded: before.excluded.iter().copied().chain(excluded).collect(),
            ..told
        }
    }
}

/// What is denied before it is said which one is meant.
#[derive(Clone, Copy, Eq, PartialEq)]
enum Denied {
    Nothing,
    /// `no`, which may deny anything.
    No,
    /// `not that one`, `the wrong one`.
    That,
}
