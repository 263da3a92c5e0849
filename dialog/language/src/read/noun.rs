//! Noun phrases, word by word: what stands before the noun, the noun, and what describes it after.

use cohabit_cdf::RoomId;

use crate::{
    read::{
        phrase::{BOTH, Phrase},
        reader::Reader,
    },
    words::{
        lexicon::{Naming, Pronoun, Side},
        token,
    },
};

impl<'a> Reader<'a> {
    /// What describes a thing after its noun: `not the red one`, `furthest away`, `that is red`.
    pub(crate) fn after_noun(&mut self, phrase: &mut Phrase) -> bool {
        let mut reader = *self;
        // `all the apples but the green one`
        if phrase.is_all && ["but", "minus", "without"].iter().any(|word| reader.next_is(word)) {
            let mut other = Self { at: reader.at + 1, ..reader };
            let is_verb = other.at_verb();
            if let Some(not) = other.phrase().filter(|not| !is_verb && not.unknown.is_empty() && !not.is_all) {
                phrase.not.push(not);
                *self = other;
                return true;
            }
        }
        while reader.next_is(",") || reader.next_is("but") {
            reader.at += 1;
        }
        let is_linked = ["that", "which", "who"].into_iter().any(|word| reader.next_is(word))
            && reader.rest().get(1).is_some_and(|word| matches!(word.as_str(), "is" | "are"))
            && reader.rest().get(2).is_some_and(|word| word == "not");
        if is_linked {
            reader.at += 2;
        }
        if reader.next_is("not") {
            reader.at += 1;
            let Some(other) = reader.phrase().filter(|other| other.unknown.is_empty()) else { return false };
            phrase.not.push(other);
            *self = reader;
            return true;
        }
        // `whatever is open`
        if phrase.pronoun == Some(Pronoun::Thing)
            && phrase.text.is_empty()
            && let Some((length, state)) = self.lexicon.states.longest(self.rest())
        {
            phrase.states.push(*state);
            self.at += length;
            return true;
        }
        if phrase.color.is_none()
            && !phrase.is_empty()
            && let Some((length, color)) = self.late_color()
        {
            phrase.color = Some(color);
            self.at += length;
            return true;
        }
        let mut reader = *self;
        if phrase.side.is_none()
            && let Some((length, side @ (Side::Nearest | Side::Farthest))) = reader.lexicon.sides.longest(reader.rest())
            && length > 1
        {
            phrase.side = Some(*side);
            self.at += length;
            return true;
        }
        let is_linked = ["that", "which", "what"].into_iter().any(|word| reader.next_is(word))
            && reader.rest().get(1).is_some_and(|word| matches!(word.as_str(), "is" | "are"));
        if !is_linked {
            return false;
        }
        reader.at += 2;
        // `that is still open`, `that is long and yellow`
        while ["still", "already", "now", "currently", "rather", "quite"].iter().any(|word| reader.next_is(word)) {
            reader.at += 1;
        }
        while let Some((length, ())) = reader.lexicon.adjectives.longest(reader.rest()) {
            reader.at += length + usize::from(reader.rest().get(length).is_some_and(|word| word == "and"));
        }
        let rest = reader.rest();
        let noun = reader.lexicon.classes.longest(rest).map_or(0, |(length, _)| length);
        if let Some((length, color)) = reader.lexicon.colors.longest(rest).filter(|(length, _)| *length > noun) {
            (phrase.color, phrase.is_look_late) = (Some(color.clone()), true);
            self.at = reader.at + length;
            return true;
        }
        let preposition = reader.lexicon.prepositions.longest(rest).map_or(0, |(length, _)| length);
        if let Some((length, side @ (Side::Nearest | Side::Farthest))) = reader.lexicon.sides.longest(rest)
            && length >= preposition
        {
            phrase.side = Some(*side);
            self.at = reader.at + length;
            return true;
        }
        if let Some((length, state)) = reader.lexicon.states.longest(rest).filter(|(length, _)| *length > noun) {
            phrase.states.push(*state);
            phrase.is_look_late = true;
            self.at = reader.at + length;
            return true;
        }
        false
    }

    /// `the mug yellow`, `the apple of color green`: the colour after its noun, and how many words say it.
    fn late_color(&self) -> Option<(usize, String)> {
        let mut reader = *self;
        let is_said = ["of", "in", "with"].iter().any(|word| reader.next_is(word));
        reader.at += usize::from(is_said);
        while is_said && ["the", "a", "color"].iter().any(|word| reader.next_is(word)) {
            reader.at += 1;
        }
        let (length, color) = reader.lexicon.colors.longest(reader.rest())?;
        let is_noun = |reader: &Self| reader.lexicon.classes.longest(reader.rest()).map_or(0, |(length, _)| length);
        let is_name = is_noun(&reader) > length;
        reader.at += length;
        let is_told = reader.next_is("color");
        reader.at += usize::from(is_told);
        let is_adjective = is_noun(&reader) > 0 || reader.next_is("one") || reader.next_is("and") && !is_said;
        (!is_name && !is_adjective && (!is_said || is_told || reader.at > self.at + 1 + length || reader.is_done()))
            .then(|| (reader.at - self.at, color.clone()))
    }

    /// One word or phrase before the noun.
    pub(crate) fn modifier(&mut self, phrase: &mut Phrase) -> bool {
        let (rest, lexicon) = (self.rest(), self.lexicon);
        let noun = lexicon.classes.longest(rest).map_or(0, |(length, _)| length);
        let step = |reader: &mut Self, length: usize| {
            reader.at += length;
            true
        };
        if let Some((length, ())) = lexicon.one_of.longest(rest).filter(|(length, ())| rest.len() > *length) {
            phrase.is_any = true;
            return step(self, length);
        }
        if let Some((length, count)) = self.count() {
            (phrase.is_all, phrase.count) = (true, Some(count));
            return step(self, length);
        }
        if let Some((length, ())) = lexicon.all.longest(rest) {
            phrase.is_all = true;
            return step(self, length);
        }
        if let Some((length, room)) = self.room_before_noun() {
            phrase.room = Some(room);
            return step(self, length);
        }
        if let Some((length, colors)) = self.two_colors() {
            phrase.color = Some(colors);
            return step(self, length);
        }
        if let Some((length, color)) = lexicon.colors.longest(rest)
            && length > noun
        {
            phrase.color = Some(color.clone());
            return step(self, length);
        }
        if let Some((length, state)) = lexicon.states.longest(rest)
            && length > noun
        {
            phrase.states.push(*state);
            return step(self, length);
        }
        if let Some((length, side)) = lexicon.sides.longest(rest)
            && length > noun
        {
            phrase.side = Some(*side);
            return step(self, length);
        }
        if let Some((length, ordinal)) = lexicon.ordinals.longest(rest)
            && length > noun
        {
            phrase.ordinal = Some(*ordinal);
            return step(self, length);
        }
        // Each of these is one of the adjectives, too, which are stepped over below.
        let size = lexicon.sizes.longest(rest).filter(|(length, _)| *length > noun && rest.len() > *length);
        phrase.sizes.extend(size.map(|(_, side)| *side));
        let filler = lexicon.articles.longest(rest).or_else(|| lexicon.adjectives.longest(rest));
        if let Some((length, ())) = filler
            && length > noun
            && rest.len() > length
            && !self.is_one_head()
        {
            return step(self, length);
        }
        // `the managers mug`: what this word says of things elsewhere, it does not say here.
        if noun == 0 && self.is_after_article() && lexicon.classes.longest(&rest[1..]).is_some() {
            phrase.unknown.push(rest[0].clone());
            return step(self, 1);
        }
        false
    }

    /// `red and white`, of one machine: how many words say so, and both colours. `the red and blue desks` are two desks.
    fn two_colors(&self) -> Option<(usize, String)> {
        let (rest, lexicon) = (self.rest(), self.lexicon);
        let (first, one) = lexicon.colors.longest(rest)?;
        let behind = rest.get(first + 1..).filter(|_| rest[first] == "and")?;
        let (second, other) = lexicon.colors.longest(behind)?;
        let name = |words: &[String]| lexicon.classes.longest(words).map_or(0, |(length, _)| length);
        if name(rest) > first || name(behind) > second {
            return None;
        }
        let length = first + 1 + second;
        let mut noun = Self { at: self.at + length, ..*self };
        noun.skip(|lexicon| &lexicon.adjectives);
        let words = noun.rest();
        let part = lexicon.name_parts.longest(words).map_or(0, |(length, _)| length);
        let generic = lexicon.generic.longest(words).map_or(0, |(length, ())| length);
        let last = words[..name(words).max(part).max(generic)].last()?;
        let is_one = !last.ends_with('s') || last.ends_with("ss");
        is_one.then(|| (length, format!("{one}{BOTH}{other}")))
    }

    /// Whether the next word is the last of its phrase.
    fn ends_phrase(&self) -> bool {
        let after = self.rest().get(1..).unwrap_or_default();
        let ends = |word: &String| token::is_punctuation(word) || matches!(word.as_str(), "and" | "then" | "to");
        after.first().is_none_or(ends) || self.lexicon.prepositions.longest(after).is_some()
    }

    /// Whether nothing but a noun or what describes it can follow: after `the`, and where no preposition stands.
    fn is_after_article(&self) -> bool {
        let lexicon = self.lexicon;
        let is_article = |at: usize| {
            let before = &self.words[at - 1..at];
            lexicon.articles.exact(before).is_some() && lexicon.pronouns.exact(before).is_none()
        };
        let is_other = lexicon.prepositions.longest(self.rest()).is_some()
            || lexicon.pronouns.longest(self.rest()).is_some()
            || lexicon.generic.longest(self.rest()).is_some()
            || lexicon.rooms.longest(self.rest()).is_some()
            || self.rest().first().is_none_or(|word| token::is_punctuation(word) || word.contains('_'));
        self.at > 0 && is_article(self.at) && !is_other
    }

    /// `the two apples`, `2 of those mugs`: how many, and how many words say so.
    pub(crate) fn count(&self) -> Option<(usize, u8)> {
        let (rest, lexicon) = (self.rest(), self.lexicon);
        let (mut length, value) = match rest.first().and_then(|word| token::digits(word)) {
            Some(value) => (1, value),
            None => lexicon.numbers.longest(rest).map(|(length, value)| (length, *value))?,
        };
        let is_name = lexicon.classes.longest(rest).is_some();
        let is_count = (2.0..=f32::from(u8::MAX)).contains(&value) && value.fract() == 0.0;
        if is_name || !is_count || lexicon.units.longest(&rest[length..]).is_some() {
            return None;
        }
        while let Some((article, ())) = lexicon.articles.longest(&rest[length..]) {
            length += article;
        }
        let after = Self { at: self.at + length, ..*self };
        let starts_noun = lexicon.classes.longest(after.rest()).is_some()
            || lexicon.colors.longest(after.rest()).is_some()
            || lexicon.states.longest(after.rest()).is_some();
        starts_noun.then_some((length, value as u8))
    }

    /// `one` as the noun itself, as in `the red one`.
    fn is_one_head(&self) -> bool {
        let rest = self.rest();
        let is_one = self.lexicon.pronouns.longest(rest).is_some_and(|(_, pronoun)| *pronoun == Pronoun::One);
        let mut after = *self;
        after.at += 1;
        let is_described = ["that", "which", "who", "not"].into_iter().any(|word| after.next_is(word));
        is_one && (is_described || !after.starts_noun())
    }

    /// `break room` in `the break room table`.
    pub(crate) fn room_before_noun(&self) -> Option<(usize, RoomId)> {
        let (length, room) = self.lexicon.rooms.longest(self.rest())?;
        let noun = self.lexicon.classes.longest(self.rest()).map_or(0, |(length, _)| length);
        let after = &self.rest()[length..];
        (noun <= length && self.lexicon.classes.longest(after).is_some()).then_some((length, *room))
    }

    pub(crate) fn head(&mut self, phrase: &mut Phrase) {
        let (rest, lexicon) = (self.rest(), self.lexicon);
        if let Some((length, namings)) = self.turned_round() {
            phrase.namings = namings.clone();
            self.at += length;
            return;
        }
        if let Some((length, namings)) = lexicon.classes.longest(rest) {
            phrase.namings = namings.clone();
            phrase.fluid = lexicon.fluids.exact(&rest[..length]).copied();
            // `red apple` may be a name in the catalogue; that it is to be red holds all the same.
            if let Some((_, color)) = lexicon.colors.longest(rest).filter(|(color, _)| *color < length) {
                phrase.color = phrase.color.take().or_else(|| Some(color.clone()));
            }
            self.at += length;
            self.compound(&rest[..length], phrase);
            return;
        }
        let Some(word) = rest.first() else { return };
        // `any thing to eat`: a kind of things.
        let generic = lexicon.generic.longest(rest).map_or(0, |(length, ())| length);
        if let Some((length, namings)) =
            lexicon.name_parts.longest(rest).filter(|(length, _)| generic > 0 && *length > generic)
        {
            phrase.namings = namings.clone();
            self.at += length;
        } else if let Some((length, ())) = lexicon.generic.longest(rest) {
            phrase.pronoun = Some(Pronoun::Thing);
            self.at += length;
        } else if self.is_one_head() {
            phrase.pronoun = Some(Pronoun::One);
            self.at += 1;
            // `the yellow one of the mugs`
            let mut of = Self { at: self.at + 1, ..*self };
            if self.next_is("of")
                && let Some(kind) = of.phrase().filter(|kind| !kind.namings.is_empty())
            {
                phrase.namings = kind.namings;
                self.at = of.at;
            }
        } else if word.contains('_') {
            phrase.instance = Some(word.clone());
            self.at += 1;
        } else if let Some((length, fluid)) = lexicon.fluids.longest(rest) {
            phrase.fluid = Some(*fluid);
            self.at += length;
        } else if self.at_floor() && self.is_free_noun() {
            phrase.is_floor = true;
            self.at += 1;
        } else if let Some((length, namings)) = lexicon.name_parts.longest(rest).filter(|_| self.is_free_noun()) {
            phrase.namings = namings.clone();
            self.at += length;
        } else if !lexicon.vocabulary.has(word) && !token::is_punctuation(word) {
            self.unknown_head(phrase);
        } else if self.at_verb() && self.is_after_article() && self.ends_phrase() {
            // `the sponge in the sink`: no thing that it knows, and no verb here.
            phrase.unknown.push(word.clone());
            self.at += 1;
        }
    }

    /// Whether the next word is no verb and no form of address.
    pub(crate) fn is_free_noun(&self) -> bool {
        let is_noun = self.at > 0 && self.lexicon.articles.exact(&self.words[self.at - 1..self.at]).is_some();
        (is_noun || !self.at_verb()) && self.lexicon.trail.longest(self.rest()).is_none()
    }

    /// `hammer cartridge`: the second noun is meant, and the first says which; `fridge door` stays the fridge.
    fn compound(&mut self, first: &[String], phrase: &mut Phrase) {
        if self.at_verb() {
            return;
        }
        let lexicon = self.lexicon;
        let Some((length, namings)) = lexicon.classes.longest(self.rest()) else { return };
        let is_said = |naming: &&Naming| {
            let words = lexicon.class_words.get(usize::from(naming.class.0));
            words.is_some_and(|words| first.iter().all(|word| words.contains(word)))
        };
        let meant: Vec<Naming> = namings.iter().filter(is_said).copied().collect();
        // `hammer trophy and record` are three things.
        if meant.is_empty() && namings.iter().any(|naming| lexicon.carried.contains(&naming.class)) {
            return;
        }
        self.at += length;
        if !meant.is_empty() {
            phrase.namings = meant;
            phrase.fluid = None;
        }
    }

    /// `the machine of time`, `the arm of the robot`: a name with its words the other way round.
    fn turned_round(&self) -> Option<(usize, &'a Vec<Naming>)> {
        let (rest, lexicon) = (self.rest(), self.lexicon);
        let of = (1..=2).find(|at| rest.get(*at).is_some_and(|word| word == "of"))?;
        let article = usize::from(rest.get(of + 1).is_some_and(|word| word == "the"));
        let start = of + 1 + article;
        (start + 1..=start + 2).rev().filter(|end| *end <= rest.len()).find_map(|end| {
            let name: Vec<String> = rest[start..end].iter().chain(&rest[..of]).cloned().collect();
            lexicon.classes.exact(&name).map(|namings| (end, namings))
        })
    }

    /// Words nobody taught it: they may be adjectives before a noun it knows, or the noun.
    fn unknown_head(&mut self, phrase: &mut Phrase) {
        let mut reader = *self;
        while let Some(word) = reader.rest().first()
            && !reader.lexicon.vocabulary.has(word)
            && !token::is_punctuation(word)
        {
            phrase.unknown.push(word.clone());
            reader.at += 1;
        }
        while !reader.is_done() && reader.modifier(phrase) {}
        if let Some((length, namings)) = reader.lexicon.classes.longest(reader.rest()) {
            phrase.namings = namings.clone();
            reader.at += length;
        }
        *self = reader;
    }
}
