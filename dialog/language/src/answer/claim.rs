//! What is claimed of a thing by a question that wants a yes or a no, or by a condition: `is the fridge open`,
//! `if there is coffee in the mug`.

use cohabit_cdf::{Fluid, state::StateFlag};

use crate::{
    known::KnownObject,
    read::{
        phrase::{Phrase, RelationKind},
        question::Question,
        reader::Reader,
        saying,
    },
    words::lexicon::{Lexicon, Pronoun, StateWord},
};

/// What may be said of a thing.
pub(crate) enum Claim<'q> {
    /// It is open, broken, full; and the words for that.
    State(StateWord, &'q [String]),
    Color(&'q str),
    /// It has this in it.
    Full(Filling),
    /// It works as it should.
    Sound(bool),
    /// It has come to its end: `the microwave is done`, `the coffee is ready`.
    Done,
    /// It is where it was before it was taken.
    Back,
    /// It works something, or is needed for it.
    For,
    /// The first is what the second names: `the red thing the laser tip`.
    Same(Box<Phrase>, Box<Phrase>),
    /// It is where the phrase says.
    Placed,
    /// It is there at all.
    Present,
    /// Something that the robot cannot tell.
    Untold,
}

/// What can be in a mug or a bowl, and is no thing of its own.
#[derive(Clone, Copy)]
pub(crate) enum Filling {
    Fluid(Fluid),
    Cereal,
}

impl Filling {
    /// What a phrase names, if that can be poured.
    pub(crate) fn named(lexicon: &Lexicon, phrase: &Phrase) -> Option<Self> {
        let words = saying::noun(phrase).unwrap_or(&phrase.text);
        let words: Vec<String> = words.split(' ').map(str::to_owned).collect();
        let (first, last) = (words.first()?, words.last()?);
        let fluid = || lexicon.fluids.exact(std::slice::from_ref(last)).copied();
        let is_cereal = || lexicon.yes_no.cereals.contains(first) && words.get(1).is_none_or(|next| next != "box");
        phrase.fluid.or_else(fluid).map(Self::Fluid).or_else(|| is_cereal().then_some(Self::Cereal))
    }

    /// What words end with, if that can be poured: `full of coffee`, `coffee in it`.
    fn named_last(lexicon: &Lexicon, words: &[String]) -> Option<Self> {
        let last = (1..words.len()).find(|at| lexicon.yes_no.is_filler(&words[at + 1..]))?;
        let word = &words[last];
        let fluid = lexicon.fluids.exact(std::slice::from_ref(word)).copied().map(Self::Fluid);
        fluid.or_else(|| lexicon.yes_no.cereals.contains(word).then_some(Self::Cereal))
    }

    pub(crate) fn is_in(self, object: &KnownObject) -> bool {
        match self {
            Self::Fluid(fluid) => object.fluid == fluid && fluid != Fluid::None,
            Self::Cereal => object.has(StateFlag::Cereal),
        }
    }

    pub(crate) fn name(self) -> String {
        match self {
            Self::Fluid(fluid) => fluid.name().to_lowercase(),
            Self::Cereal => "cereal".to_owned(),
        }
    }
}

impl<'q> Claim<'q> {
    pub(crate) fn read(lexicon: &'q Lexicon, phrase: &'q Phrase, words: &'q [String]) -> Self {
        if let Some(filling) = Filling::named_last(lexicon, words).filter(|_| Filling::named(lexicon, phrase).is_none())
        {
            return Self::Full(filling);
        }
        if let Some((state, words)) = asked_state(lexicon, words) {
            return Self::State(state, words);
        }
        let said = &lexicon.yes_no;
        if said.says_done(words) {
            return Self::Done;
        }
        if said.says_back(words) {
            return Self::Back;
        }
        if let Some(is_sound) = said.soundness(words) {
            return Self::Sound(is_sound);
        }
        let mut reader = Reader::new(lexicon, words);
        // What stands for the subject elsewhere (`is it`, `the one for the laser`) has no words of its own to skip.
        let _ = reader.phrase_with_place();
        let left = if reader.at == 0 { &[] } else { said.without_fillers(reader.rest()) };
        if let Some((subject, other)) = pointed_out(lexicon, words) {
            return Self::Same(Box::new(subject), Box::new(other));
        }
        if let [color] = left
            && lexicon.colors.exact(left).is_some()
        {
            return Self::Color(color);
        }
        if let Some(color) = phrase.color.as_deref().filter(|color| ends_with_color(lexicon, words, color)) {
            return Self::Color(color);
        }
        let has = |kind| phrase.relations.iter().any(|relation| relation.kind == kind);
        let is_told = said.is_filler(left);
        if has(RelationKind::For) {
            return Self::For;
        }
        if let Some(other) = named(lexicon, left) {
            return Self::Same(Box::new(phrase.clone()), Box::new(other));
        }
        let is_placed = phrase.relations.iter().any(|one| one.kind != RelationKind::Has) || phrase.room.is_some();
        match () {
            () if is_placed && is_told => Self::Placed,
            () if is_about_presence(lexicon, words, phrase) => Self::Present,
            () => Self::Untold,
        }
    }
}

/// Whether what a question claims of a thing is something that the robot can tell.
pub(crate) fn can_be_told(lexicon: &Lexicon, question: &Question) -> bool {
    let is_told = |phrase| !matches!(Claim::read(lexicon, phrase, &question.rest), Claim::Untold | Claim::Present);
    question.about.as_ref().is_some_and(is_told)
}

/// `that the blue one`: what was spoken of, and what it may be.
fn pointed_out(lexicon: &Lexicon, words: &[String]) -> Option<(Phrase, Phrase)> {
    let [subject, article, ..] = words else { return None };
    let is_pointing =
        lexicon.yes_no.things.contains(subject) && lexicon.articles.exact(std::slice::from_ref(article)).is_some();
    let mut reader = Reader::new(lexicon, std::slice::from_ref(subject));
    is_pointing.then(|| Some((reader.phrase()?, named(lexicon, &words[1..])?)))?
}

/// What words name, if they do nothing else.
fn named(lexicon: &Lexicon, words: &[String]) -> Option<Phrase> {
    let mut reader = Reader::new(lexicon, words);
    let phrase = reader.phrase_with_place()?;
    let is_told = phrase.color.is_some() && phrase.is_one_of_kind();
    let is_name =
        is_told || !phrase.namings.is_empty() || phrase.pronoun == Some(Pronoun::Thing) && !phrase.is_bare_pronoun();
    (is_name && lexicon.yes_no.is_filler(reader.rest())).then_some(phrase)
}

/// `the hammer red`: whether a colour is the last that is said.
fn ends_with_color(lexicon: &Lexicon, words: &[String], color: &str) -> bool {
    let last = (1..words.len()).find(|at| lexicon.yes_no.is_filler(&words[at + 1..]));
    last.is_some_and(|at| lexicon.colors.exact(&words[at..=at]).is_some_and(|said| said == color))
}

/// Whether nothing is asked of a thing but that it is there.
pub(crate) fn is_about_presence(lexicon: &Lexicon, words: &[String], phrase: &Phrase) -> bool {
    let named: Vec<&str> = phrase.text.split(' ').collect();
    let is_spare = |word: &String| lexicon.yes_no.is_filler(std::slice::from_ref(word));
    words.iter().all(|word| is_spare(word) || named.contains(&word.as_str()))
}

/// What stands between two states of which one is asked for.
const OR: &str = "or";

/// The two states of which one is asked for, with the words for each: `the wardrobe open or shut now`.
pub(crate) fn asked_either<'w>(lexicon: &Lexicon, words: &'w [String]) -> Option<[(StateWord, &'w [String]); 2]> {
    let at = words.iter().position(|word| word == OR)?;
    let (before, after) = (&words[..at], &words[at + 1..]);
    let first = asked_state(lexicon, before).filter(|(_, said)| before.ends_with(said))?;
    let (length, second) = state_at_start(lexicon, after)?;
    lexicon.yes_no.is_filler(&after[length..]).then_some([first, (second, &after[..length])])
}

/// The state that words begin with, and how many of them say it.
fn state_at_start(lexicon: &Lexicon, words: &[String]) -> Option<(usize, StateWord)> {
    let on_or_off = match words.first()?.as_str() {
        "on" => Some((1, StateWord::Flag(StateFlag::Toggled, true))),
        "off" => Some((1, StateWord::Flag(StateFlag::Toggled, false))),
        _ => None,
    };
    lexicon.states.longest(words).map(|(length, state)| (length, *state)).or(on_or_off)
}

/// The state that a question asks for, which is named after what it asks about: `the fridge open right now`; and its words.
pub(crate) fn asked_state<'w>(lexicon: &Lexicon, words: &'w [String]) -> Option<(StateWord, &'w [String])> {
    let names =
        |at: usize| lexicon.classes.longest(&words[at..]).is_some() || lexicon.rooms.longest(&words[at..]).is_some();
    // `on it`
    let is_place = |end: usize| {
        Reader { at: end, ..Reader::new(lexicon, words) }.phrase().is_some_and(|phrase| phrase.pronoun.is_some())
    };
    let is_last = |end: usize| !is_place(end) && !(end..words.len()).any(names);
    (0..words.len()).rev().find_map(|at| {
        let (length, state) = state_at_start(lexicon, &words[at..])?;
        is_last(at + length).then(|| (state, &words[at..at + length]))
    })
}
