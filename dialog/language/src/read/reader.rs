//! Reads referring expressions and places from words.

use cohabit_cdf::RoomId;

use crate::{
    read::phrase::{Phrase, Place},
    words::{
        lexicon::{Lexicon, Naming, Preposition, Pronoun, Side},
        token,
    },
};

/// Reads phrases from words.
#[derive(Clone, Copy)]
pub(crate) struct Reader<'a> {
    pub(crate) lexicon: &'a Lexicon,
    pub(crate) words: &'a [String],
    pub(crate) at: usize,
}

impl<'a> Reader<'a> {
    pub(crate) fn new(lexicon: &'a Lexicon, words: &'a [String]) -> Self {
        Self { lexicon, words, at: 0 }
    }

    pub(crate) fn rest(&self) -> &'a [String] {
        &self.words[self.at.min(self.words.len())..]
    }

    pub(crate) fn next_is(&self, word: &str) -> bool {
        self.rest().first().is_some_and(|next| next == word)
    }

    pub(crate) fn is_done(&self) -> bool {
        self.at >= self.words.len()
    }

    /// Whether a verb begins here, rather than a noun that looks like one.
    pub(crate) fn at_verb(&self) -> bool {
        let rest = self.rest();
        let Some((length, _)) = self.lexicon.verbs.longest(rest) else { return false };
        let noun = self.lexicon.classes.longest(rest).map_or(0, |(length, _)| length);
        noun < length || (noun == length && rest.len() > length)
    }

    /// A phrase with all that follows and describes it; `None`, and no step forward, if there is none.
    pub(crate) fn phrase_with_place(&mut self) -> Option<Phrase> {
        let mut phrase = self.phrase()?;
        let said = phrase.text.clone();
        let start = self.at;
        loop {
            if let Some((length, _)) = self.nook() {
                self.at += length;
            } else if let Some((preposition, place)) = self.place() {
                let is_with = preposition == Preposition::With;
                phrase.attach(preposition, place);
                // `the desk with the computer on it`
                if is_with && let Some((length, Pronoun::Place)) = self.lexicon.pronouns.longest(self.rest()) {
                    self.at += length;
                }
            } else if !self.after_noun(&mut phrase) {
                break;
            }
        }
        if self.at > start {
            phrase.text = format!("{said} {}", self.words[start..self.at].join(" "));
        }
        Some(phrase)
    }

    /// A noun phrase without what follows it.
    pub(crate) fn phrase(&mut self) -> Option<Phrase> {
        let mut reader = *self;
        let start = reader.at;
        if let Some(pronoun) = reader.pronoun() {
            let text = reader.words[start..reader.at].join(" ");
            *self = reader;
            return Some(Phrase { text, pronoun: Some(pronoun), ..Phrase::default() });
        }
        let mut phrase = Phrase::default();
        if reader.next_is("not") {
            phrase.pronoun = Some(Pronoun::One);
        } else {
            while !reader.is_done() && reader.modifier(&mut phrase) {}
            reader.head(&mut phrase);
        }
        while reader.after_noun(&mut phrase) {}
        if !phrase.says_something() && phrase.unknown.is_empty() {
            return None;
        }
        phrase.text = reader.words[start..reader.at].join(" ");
        *self = reader;
        Some(phrase)
    }

    pub(crate) fn pronoun(&mut self) -> Option<Pronoun> {
        let rest = self.rest();
        let (length, pronoun) = self.lexicon.pronouns.longest(rest)?;
        // `the tool board` is no tool.
        let is_named =
            |at: usize| self.lexicon.classes.longest(&rest[at..]).is_some_and(|(noun, _)| at + noun > length);
        if length > 1 && self.lexicon.articles.exact(&rest[..1]).is_some() && is_named(1) {
            return None;
        }
        // `something sharp` is the name of things by what they are for.
        let is_longer = |found: Option<(usize, &Vec<Naming>)>| found.is_some_and(|(noun, _)| noun > length);
        if is_longer(self.lexicon.classes.longest(rest)) || is_longer(self.lexicon.name_parts.longest(rest)) {
            return None;
        }
        // `that mug`, `this one red mug`: an article, unless nothing follows that could be a noun phrase.
        let mut after = *self;
        after.at += length;
        let is_article = self.lexicon.articles.longest(rest).is_some_and(|(article, _)| article == length);
        if *pronoun == Pronoun::One || (is_article && after.starts_noun()) {
            return None;
        }
        if *pronoun == Pronoun::Place && after.starts_noun() {
            return None;
        }
        self.at += length;
        Some(*pronoun)
    }

    pub(crate) fn starts_noun(&self) -> bool {
        let rest = self.rest();
        let lexicon = self.lexicon;
        lexicon.classes.longest(rest).is_some()
            || lexicon.colors.longest(rest).is_some()
            || lexicon.states.longest(rest).is_some()
            || lexicon.sides.longest(rest).is_some_and(|(_, side)| !matches!(side, Side::Front | Side::Behind))
            || lexicon.ordinals.longest(rest).is_some()
            || lexicon.articles.longest(rest).is_some_and(|(length, _)| rest.len() > length && !self.at_verb())
    }

    /// A preposition and what stands after it.
    pub(crate) fn place(&mut self) -> Option<(Preposition, Place)> {
        let mut linked = *self;
        // `that has` is a preposition here, `that` a link.
        if self.lexicon.prepositions.longest(self.rest()).is_none_or(|(length, _)| length < 2) {
            linked.skip(|lexicon| &lexicon.link);
        }
        // `over` is a link in `over on the desk`, and a preposition in `over it`.
        let (place, end) = [linked, *self]
            .into_iter()
            .find_map(|mut reader| Some((reader.place_here()?, reader.at)))
            .or_else(|| self.worked(linked))?;
        self.at = end;
        Some(place)
    }

    /// `that controls the laser`: for the laser; `linked` stands after `that`.
    fn worked(&self, mut linked: Self) -> Option<((Preposition, Place), usize)> {
        let (length, ()) = self.lexicon.control_words.longest(linked.rest()).filter(|_| linked.at > self.at)?;
        linked.at += length;
        let place =
            linked.destination().filter(|place| matches!(place, Place::Object(what) if !what.namings.is_empty()))?;
        Some(((Preposition::For, place), linked.at))
    }

    fn place_here(&mut self) -> Option<(Preposition, Place)> {
        let mut reader = *self;
        if let Some(side) = reader.side_place() {
            *self = reader;
            return Some((Preposition::At, Place::Side(side)));
        }
        if let Some(phrase) = reader.on_which() {
            *self = reader;
            return Some((Preposition::With, Place::Object(phrase)));
        }
        if let Some((length, ())) = reader.lexicon.here.longest(reader.rest()) {
            reader.at += length;
            *self = reader;
            return Some((Preposition::In, Place::Here));
        }
        if let Some(room) = reader.of_room() {
            *self = reader;
            return Some((Preposition::In, Place::Room(reader.lexicon.named_room(room))));
        }
        let (length, preposition) = reader.lexicon.prepositions.longest(reader.rest())?;
        reader.at += length;
        if preposition == &Preposition::On && reader.is_done() {
            return None;
        }
        let place = reader.destination()?;
        *self = reader;
        Some((*preposition, place))
    }

    /// `the door of the break room`: which room.
    fn of_room(&mut self) -> Option<RoomId> {
        let mut reader = *self;
        reader.at += usize::from(reader.next_is("of"));
        if reader.at == self.at {
            return None;
        }
        reader.skip(|lexicon| &lexicon.articles);
        let (length, room) = reader.lexicon.rooms.longest(reader.rest())?;
        reader.at += length;
        *self = reader;
        Some(*room)
    }

    /// A room, a viewpoint, or an object.
    pub(crate) fn destination(&mut self) -> Option<Place> {
        let mut reader = *self;
        if let Some((length, ())) = reader.lexicon.here.longest(reader.rest()) {
            self.at += length;
            // `the room with the laser`
            let mut what = *self;
            if let Some((Preposition::With, place @ Place::Object(_))) = what.place() {
                *self = what;
                return Some(place);
            }
            return Some(Place::Here);
        }
        if let Some(place) = reader.viewpoint() {
            *self = reader;
            return Some(place);
        }
        if let Some(floor) = reader.floor() {
            *self = reader;
            return Some(Place::Object(floor));
        }
        reader.skip(|lexicon| &lexicon.articles);
        if reader.room_before_noun().is_none()
            && let Some((length, room)) = reader.lexicon.rooms.longest(reader.rest())
            && reader.lexicon.classes.longest(reader.rest()).is_none_or(|(noun, _)| noun <= length)
        {
            reader.at += length;
            *self = reader;
            return Some(Place::Room(reader.lexicon.named_room(*room)));
        }
        let mut reader = *self;
        let phrase = reader.phrase()?;
        *self = reader;
        Some(Place::Object(phrase))
    }

    /// `the floor`, `the kitchen floor`; what is called by that word and another one is a thing: `the floor lamp`.
    fn floor(&mut self) -> Option<Phrase> {
        let mut reader = *self;
        reader.skip(|lexicon| &lexicon.articles);
        let room = reader.lexicon.rooms.longest(reader.rest());
        let (length, room) = room.map_or((0, None), |(length, room)| (length, Some(*room)));
        let of_room = Self { at: reader.at + length, ..reader };
        let (floor, room) = if of_room.at_floor() { (of_room, room) } else { (reader, None) };
        if !floor.at_floor() {
            return None;
        }
        let start = self.at;
        self.at = floor.at + 1;
        let text = self.words[start..self.at].join(" ");
        Some(Phrase { text, room, is_floor: true, ..Phrase::default() })
    }

    /// Whether the next word is the floor, and no name of a thing.
    pub(crate) fn at_floor(&self) -> bool {
        let rest = self.rest();
        rest.first().is_some_and(|word| self.lexicon.yes_no.says_floor(std::slice::from_ref(word)))
            && self.lexicon.classes.longest(rest).is_none()
    }

    /// A room with which a request ends; no step forward, if there is none.
    pub(crate) fn last_room(&mut self) -> Option<Place> {
        let mut reader = *self;
        let room = reader.destination().filter(|place| matches!(place, Place::Room(_)))?;
        let mut after = reader;
        after.skip(|lexicon| &lexicon.trail);
        let is_last = after.rest().first().is_none_or(|word| token::is_punctuation(word));
        is_last.then(|| {
            *self = reader;
            room
        })
    }

    /// `viewpoint 3 in the lab`, `lab1_3`.
    fn viewpoint(&mut self) -> Option<Place> {
        if let Some(word) = self.rest().first()
            && let Some((room, number)) = word.rsplit_once('_')
            && let (Some(room), Ok(number)) = (self.lexicon.room_ids.get(room), number.parse())
        {
            self.at += 1;
            return Some(Place::Viewpoint(self.lexicon.named_room(*room), number));
        }
        let mut reader = *self;
        reader.skip(|lexicon| &lexicon.articles);
        let (length, ()) = reader.lexicon.viewpoints.longest(reader.rest())?;
        reader.at += length;
        let number = reader.number()?;
        // Saturates: a viewpoint beyond 255 does not exist, and the world says so.
        let number = number as u8;
        let mut tail = reader;
        // `viewpoint 5 of the lab`: the number took the `of`.
        if let Some(Place::Room(room)) = tail.destination() {
            *self = tail;
            return Some(Place::Viewpoint(room, number));
        }
        let mut tail = reader;
        if let Some((_, Place::Room(room))) = tail.place() {
            *self = tail;
            return Some(Place::Viewpoint(room, number));
        }
        *self = reader;
        Some(Place::Viewpoints(number))
    }

    /// `on which the record is lying`, `where the hammer is`: with that on it.
    fn on_which(&mut self) -> Option<Phrase> {
        let mut reader = *self;
        let is_placed = ["on", "in", "at"].iter().any(|word| reader.next_is(word));
        reader.at += usize::from(is_placed);
        if !(is_placed && reader.next_is("which") || !is_placed && reader.next_is("where")) {
            return None;
        }
        reader.at += 1;
        let phrase = reader.phrase().filter(|phrase| !phrase.is_empty() && phrase.unknown.is_empty())?;
        let start = reader.at;
        reader.skip(|lexicon| &lexicon.link);
        let is_said = reader.at > start || reader.next_is("are");
        reader.at += usize::from(reader.next_is("are"));
        is_said.then(|| {
            *self = reader;
            phrase
        })
    }

    /// `on the left`, `in front of you`.
    fn side_place(&mut self) -> Option<Side> {
        let mut reader = *self;
        if let Some((length, side @ (Side::Front | Side::Behind))) = reader.lexicon.sides.longest(reader.rest())
            && length > 1
        {
            reader.at += length;
            *self = reader;
            return Some(*side);
        }
        let (length, _) = reader.lexicon.prepositions.longest(reader.rest())?;
        reader.at += length;
        reader.skip(|lexicon| &lexicon.articles);
        let (length, side) = reader.lexicon.sides.longest(reader.rest())?;
        reader.at += length;
        let is_end = reader.is_done() || !reader.starts_noun() && !reader.next_is("one") && !reader.next_is("of");
        if !is_end || reader.lexicon.classes.longest(reader.rest()).is_some() {
            return None;
        }
        if reader.next_is("side") {
            reader.at += 1;
        }
        *self = reader;
        Some(*side)
    }

    /// `in the corner`, `on the wall`: where in a room, which tells the robot nothing; how many words say so, and the preposition.
    pub(crate) fn nook(&self) -> Option<(usize, Preposition)> {
        let mut reader = *self;
        reader.skip(|lexicon| &lexicon.link);
        let (length, preposition) = reader.lexicon.prepositions.longest(reader.rest())?;
        reader.at += length;
        reader.skip(|lexicon| &lexicon.articles);
        let (length, ()) = reader.lexicon.nooks.longest(reader.rest())?;
        let noun = reader.lexicon.classes.longest(reader.rest()).map_or(0, |(length, _)| length);
        reader.at += length;
        // `on the wall shelf`, `in the corner cupboard`
        let is_name = noun > length || reader.lexicon.classes.longest(reader.rest()).is_some();
        // `on the corner of the desk` is on the desk, `in the corner of the kitchen` in the kitchen.
        let mut whole = reader;
        let is_of_thing = reader.next_is("of") && whole.of_room().is_none();
        let says_where = matches!(
            preposition,
            Preposition::In | Preposition::On | Preposition::At | Preposition::Near | Preposition::From
        );
        (says_where && !is_name && !is_of_thing).then_some((reader.at - self.at, *preposition))
    }

    /// A number in digits or words: `2.5`, `two`, `one and a half`, `half a`, `a couple of`.
    pub(crate) fn number(&mut self) -> Option<f32> {
        let mut reader = *self;
        if reader.next_is("a") {
            reader.at += 1;
        }
        let word = reader.rest().first()?;
        let mut value = match token::digits(word) {
            Some(value) => {
                reader.at += 1;
                value
            }
            None => {
                let (length, value) = reader.lexicon.numbers.longest(reader.rest())?;
                reader.at += length;
                *value
            }
        };
        if let Some((length, unit)) = reader.lexicon.numbers.longest(reader.rest())
            && value >= 20.0
            && *unit >= 1.0
            && *unit < 10.0
        {
            value += unit;
            reader.at += length;
        }
        if reader.next_is("hundred") {
            value *= 100.0;
            reader.at += 1;
            reader.at += usize::from(reader.next_is("and"));
            if let Some((length, more)) = reader.lexicon.numbers.longest(reader.rest()) {
                value += more;
                reader.at += length;
                if let Some((length, unit)) =
                    reader.lexicon.numbers.longest(reader.rest()).filter(|(_, unit)| **unit < 10.0)
                {
                    value += unit;
                    reader.at += length;
                }
            }
        }
        // `a hundred and eighty`
        let mut more = reader;
        more.at += usize::from(more.next_is("and"));
        if value >= 100.0
            && let Some((length, rest)) = more.lexicon.numbers.longest(more.rest()).filter(|(_, rest)| **rest < 100.0)
            && *rest >= 1.0
        {
            value += rest;
            more.at += length;
            reader = more;
        }
        let half = ["and", "a", "half"];
        if reader.rest().iter().map(String::as_str).take(3).eq(half) {
            value += 0.5;
            reader.at += 3;
        }
        for word in ["a", "of"] {
            if reader.next_is(word) {
                reader.at += 1;
            }
        }
        *self = reader;
        Some(value)
    }

    /// Steps over all phrases of a table that stand here.
    pub(crate) fn skip(&mut self, table: impl Fn(&Lexicon) -> &crate::words::table::PhraseTable<()>) {
        while let Some((length, ())) = table(self.lexicon).longest(self.rest()) {
            self.at += length;
        }
    }
}
