//! The colour that a thing is to get, and the liquid that it is to be filled with.

use crate::{
    read::{clause::Clause, reader::Reader},
    words::{
        intent::Intent,
        lexicon::{Lexicon, Preposition},
    },
};

/// `paint the bowl red`: no red bowl.
pub(crate) fn take_late_color(lexicon: &Lexicon, clause: &mut Clause) {
    let Some(phrase) = clause.objects.last_mut().filter(|_| clause.intent == Intent::Color && clause.color.is_none())
    else {
        return;
    };
    if ends_in_color(lexicon, &phrase.text) && !phrase.text.contains(" is ") {
        clause.color = phrase.color.take();
    }
}

/// Whether the last word is a colour.
pub(crate) fn ends_in_color(lexicon: &Lexicon, text: &str) -> bool {
    text.split_whitespace().last().is_some_and(|word| lexicon.colors.exact(&[word.to_owned()]).is_some())
}

/// `paint the bowl red`, `make it blue`, `change the bowl's color to green`.
pub(crate) fn read_color(reader: &mut Reader<'_>, clause: &mut Clause) -> bool {
    if clause.intent != Intent::Color {
        return false;
    }
    let mut after = *reader;
    while matches!(after.rest().first().map(String::as_str), Some("to" | "into" | "in" | "color" | "the" | "be")) {
        after.at += 1;
    }
    let Some((length, color)) = after.lexicon.colors.longest(after.rest()) else { return false };
    let noun = after.lexicon.classes.longest(after.rest()).map_or(0, |(length, _)| length);
    let is_adjective = after.lexicon.classes.longest(&after.rest()[length..]).is_some();
    if noun > length || is_adjective {
        return false;
    }
    after.at += length;
    clause.color = Some(color.clone());
    *reader = after;
    true
}

/// `with water`, after `fill`.
pub(crate) fn read_fluid(reader: &mut Reader<'_>, clause: &mut Clause) -> bool {
    if clause.intent != Intent::Fill {
        return false;
    }
    let mut after = *reader;
    let Some((length, Preposition::With)) = after.lexicon.prepositions.longest(after.rest()) else { return false };
    after.at += length;
    after.skip(|lexicon| &lexicon.articles);
    let Some((length, fluid)) = after.lexicon.fluids.longest(after.rest()) else { return false };
    after.at += length;
    clause.fluid = Some(*fluid);
    *reader = after;
    true
}
