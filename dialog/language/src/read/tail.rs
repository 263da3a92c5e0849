//! What follows a clause's verb and objects: places, what says more of what was named, and what says nothing.

use crate::{
    read::{
        clause::{self, Clause},
        color,
        phrase::{Phrase, Place},
        reader::Reader,
        segments, slot,
    },
    words::{
        intent::Intent,
        lexicon::{Preposition, Pronoun},
        token,
    },
};

pub(crate) fn read_tail(reader: &mut Reader<'_>, clause: &mut Clause) {
    while !reader.is_done() {
        if reader.and_room(clause) {
            continue;
        }
        if token::is_punctuation(&reader.words[reader.at]) || reader.next_is("and") {
            break;
        }
        if reader.until(clause) || color::read_color(reader, clause) || color::read_fluid(reader, clause) {
            continue;
        }
        if let Some((length, ())) = reader.lexicon.exits.longest(reader.rest()) {
            clause.is_leaving = true;
            reader.at += length;
            continue;
        }
        if let Some((length, preposition)) = reader.nook()
            && is_found_there(clause, preposition)
        {
            reader.at += length;
            continue;
        }
        let is_linked = reader.is_linked();
        if let Some(place) = reader.place() {
            // `the cup that is on the desk`: no place to do it at.
            if is_linked && let Some(phrase) = clause.last_phrase() {
                phrase.attach(place.0, place.1);
                continue;
            }
            let is_with = place.0 == Preposition::With;
            clause.places.push(place);
            // `the table that has the cartridge and the tip`
            while clause.intent == Intent::GoTo && is_with && reader.next_is("and") {
                let mut next = Reader { at: reader.at + 1, ..*reader };
                let Some(phrase) = next.phrase().filter(|phrase| !phrase.is_empty() && phrase.unknown.is_empty())
                else {
                    break;
                };
                clause.places.push((Preposition::With, Place::Object(phrase)));
                *reader = next;
            }
            if is_with && let Some((length, Pronoun::Place)) = reader.lexicon.pronouns.longest(reader.rest()) {
                reader.at += length;
            }
            continue;
        }
        if let Some((length, Pronoun::Place)) = reader.lexicon.pronouns.longest(reader.rest()) {
            let phrase = Phrase { pronoun: Some(Pronoun::Place), text: "there".to_owned(), ..Phrase::default() };
            clause.places.push((Preposition::On, Place::Object(phrase)));
            reader.at += length;
            continue;
        }
        if let Some((length, ())) = reader.lexicon.trail.longest(reader.rest()) {
            reader.at += length;
            continue;
        }
        if reader.at_verb() {
            break;
        }
        let start = reader.at;
        if let Some(phrase) = clause.last_phrase()
            && reader.after_noun(phrase)
        {
            phrase.say_more(&reader.words[start..reader.at]);
            continue;
        }
        if segments::is_subordinator(reader.lexicon, &reader.words[reader.at]) {
            reader.at += segments::chunk(reader.rest()).len();
            continue;
        }
        if reader.person() {
            continue;
        }
        if reader.names_late(clause) || reader.tells_of(clause) {
            continue;
        }
        let word = &reader.words[reader.at];
        if !reader.lexicon.vocabulary.has(word) || !reader.is_spare() {
            clause.unknown.push(word.clone());
        }
        let nouns = [
            reader.lexicon.classes.longest(reader.rest()).is_some(),
            reader.lexicon.generic.longest(reader.rest()).is_some(),
        ];
        // `move it to the table`: that, and not the robot itself.
        let is_moved = matches!(clause.intent, Intent::Travel | Intent::Turn)
            && (reader.lexicon.pronouns.longest(reader.rest()).is_some_and(|(_, one)| is_thing(*one))
                || reader.lexicon.name_parts.longest(reader.rest()).is_some() && reader.is_free_noun());
        clause.has_stray_noun |= nouns.contains(&true) || is_moved;
        reader.at += 1;
    }
}

/// Whether what was named is in such a place, rather than to be put there.
fn is_found_there(clause: &Clause, preposition: Preposition) -> bool {
    let is_put = matches!(clause.intent, Intent::Place | Intent::Drop | Intent::Throw) && clause.places.is_empty();
    let is_named = |phrase: &&Phrase| !phrase.is_bare_pronoun();
    slot::named(clause).iter().any(is_named) && (preposition == Preposition::From || !is_put)
}

pub(crate) const fn is_thing(pronoun: Pronoun) -> bool {
    matches!(pronoun, Pronoun::Thing | Pronoun::Things)
}

impl Reader<'_> {
    /// `put it on the desk and the robotics lab`: heard for `in`, as nothing can be put on a room.
    fn and_room(&mut self, clause: &mut Clause) -> bool {
        let mut reader = Self { at: self.at + 1, ..*self };
        let takes_things = clause::takes_objects(clause.intent) && clause.intent != Intent::GoTo;
        if !self.next_is("and") || !takes_things {
            return false;
        }
        let Some(place @ Place::Room(_)) = reader.destination().filter(|_| !reader.at_verb()) else { return false };
        reader.skip(|lexicon| &lexicon.trail);
        let is_end = reader.rest().first().is_none_or(|word| token::is_punctuation(word));
        let Some(phrase) = clause.last_phrase().filter(|phrase| is_end && phrase.room.is_none()) else { return false };
        phrase.attach(Preposition::In, place);
        self.at = reader.at;
        true
    }

    /// `to my boss`, `for the guests`: steps over whom something is for.
    pub(crate) fn person(&mut self) -> bool {
        let mut reader = *self;
        if !["to", "for", "with", "over"].iter().any(|word| reader.next_is(word)) {
            return false;
        }
        while ["to", "for", "with", "over"].iter().any(|word| reader.next_is(word)) {
            reader.at += 1;
        }
        let Some((length, ())) = reader.lexicon.people.longest(reader.rest()) else { return false };
        self.at = reader.at + length;
        true
    }

    /// `walk until you reach the table`
    pub(crate) fn until(&mut self, clause: &mut Clause) -> bool {
        if clause.intent != Intent::Travel || !self.next_is("until") && !self.next_is("till") {
            return false;
        }
        let mut reader = Self { at: self.at + 1, ..*self };
        reader.at += usize::from(reader.next_is("you"));
        let goes = |(length, intents): (usize, &Vec<Intent>)| intents.contains(&Intent::GoTo).then_some(length);
        let verb = reader.lexicon.verbs.longest(reader.rest()).and_then(goes);
        let is_there = ["hit", "see", "touch"].iter().any(|word| reader.next_is(word));
        let Some(length) = verb.or(is_there.then_some(1)) else { return false };
        reader.at += length;
        let Some(place) = reader.destination() else { return false };
        clause.places.push((Preposition::To, place));
        clause.direction = None;
        self.at = reader.at;
        true
    }

    /// `take out of the cabinet the bread`, `the apple the red apple`, `turn the apple a carrot`.
    fn names_late(&mut self, clause: &mut Clause) -> bool {
        let mut reader = *self;
        let is_noun = |phrase: &Phrase| {
            let is_one = phrase.pronoun == Some(Pronoun::One) && phrase.is_described();
            (!phrase.namings.is_empty() || is_one) && phrase.unknown.is_empty()
        };
        let Some(mut phrase) = reader.phrase().filter(is_noun) else { return false };
        // `the apple the green one`
        if phrase.namings.is_empty() {
            let Some(said) = clause.last_phrase().filter(|said| tells_more(said, &phrase)) else {
                return false;
            };
            (phrase.namings, phrase.pronoun) = (said.namings.clone(), None);
        }
        if clause.objects.is_empty()
            && !clause.places.is_empty()
            && clause::takes_objects(clause.intent)
            && clause.intent != Intent::GoTo
        {
            clause.objects.push(phrase);
        } else if clause.intent == Intent::Carrot && clause.places.is_empty() {
            clause.places.push((Preposition::In, Place::Object(phrase)));
        } else if let Some(said) = clause.last_phrase().filter(|said| tells_more(said, &phrase)) {
            *said = phrase;
        } else {
            return false;
        }
        self.at = reader.at;
        true
    }

    /// `in the think`: what stands where a place was to be named, and is none.
    fn tells_of(&mut self, clause: &mut Clause) -> bool {
        let rest = self.rest();
        // `past the fridge to the cabinet`
        if matches!(clause.intent, Intent::GoTo | Intent::Travel)
            && matches!(rest[0].as_str(), "past" | "through" | "along")
        {
            let mut reader = Self { at: self.at + 1, ..*self };
            if reader.destination().is_some() {
                self.at = reader.at;
                return true;
            }
        }
        // `so it dances`
        let is_purpose = rest[0] == "so"
            && rest
                .get(1)
                .is_some_and(|word| matches!(word.as_str(), "it" | "that" | "he" | "she" | "we" | "i" | "they"));
        // `the machine that fixes things`
        let is_subject = |word: &String| matches!(word.as_str(), "i" | "you" | "we" | "he" | "she" | "they");
        let is_relative = matches!(rest[0].as_str(), "that" | "which" | "who")
            && !rest.get(1).is_some_and(is_subject)
            && clause.last_phrase().is_some();
        if is_purpose || is_relative {
            let chunk = segments::chunk(rest);
            let end = chunk.iter().position(|word| word == "and").unwrap_or(chunk.len()).max(1);
            if is_relative {
                clause.unknown.extend(segments::unknown_words(self.lexicon, &chunk[..end]));
            }
            self.at += end;
            return true;
        }
        let Some((length, preposition)) = self.lexicon.prepositions.longest(rest) else { return false };
        // `open the machine, put it in`
        let is_last = rest.get(length).is_none_or(|word| token::is_punctuation(word) || word == "and");
        if is_last && *preposition == Preposition::In && clause.places.is_empty() && clause.intent == Intent::Place {
            let there = Phrase { pronoun: Some(Pronoun::Place), text: "there".to_owned(), ..Phrase::default() };
            clause.places.push((*preposition, Place::Object(there)));
            self.at += length;
            return true;
        }
        let word = match &rest[length..] {
            [article, word, ..] if article == "the" && clause.intent.is_about_held() => word,
            _ => return false,
        };
        let phrase = Phrase { text: word.clone(), unknown: vec![word.clone()], ..Phrase::default() };
        clause.places.push((*preposition, Place::Object(phrase)));
        self.at += length + 2;
        true
    }

    /// Whether the next word says nothing by itself.
    pub(crate) fn is_spare(&self) -> bool {
        let word = &self.rest()[..1];
        let lexicon = self.lexicon;
        let tables =
            [&lexicon.lead, &lexicon.trail, &lexicon.talk, &lexicon.articles, &lexicon.adjectives, &lexicon.link];
        lexicon.is_small_word(&word[0])
            || tables.iter().any(|table| table.exact(word).is_some())
            || lexicon.prepositions.exact(word).is_some()
            || token::digits(&word[0]).is_some()
    }

    /// `that is`, `which lies`, before a place.
    pub(crate) fn is_linked(&self) -> bool {
        let is = |at: usize, any: &[&str]| self.rest().get(at).is_some_and(|word| any.contains(&word.as_str()));
        is(0, &["that", "which"])
            && is(1, &["is", "are", "stands", "lies", "sits", "was", "were", "stand", "lie", "sit", "hangs", "rests"])
    }

    /// Whether a verb of several words begins here: surely no noun.
    pub(crate) fn at_long_verb(&self) -> bool {
        self.at_verb() && self.lexicon.verbs.longest(self.rest()).is_some_and(|(length, _)| length > 1)
    }
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
