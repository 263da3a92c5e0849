//! What is claimed of a thing by a question that wants a yes or a no, or by a condition, and whether it is so: `is the fridge open`,
//! `if there is coffee in the mug`.
//!
//! What the robot cannot tell is neither true nor false: it says so, and what it knows of the thing instead.

use cohabit_cdf::{Fluid, ObjectId, Property, state::StateFlag};

use crate::{
    answer::Answerer,
    contents, describe,
    ground::{Want, has_state},
    intent::Intent,
    known::KnownObject,
    lexicon::{Lexicon, Pronoun, StateWord},
    phrase::{Phrase, Reader, RelationKind},
    question::Question,
    saying,
    understanding::Understanding,
};

/// What may be said of a thing.
enum Claim<'q> {
    /// It is open, broken, full; and the words for that.
    State(StateWord, &'q [String]),
    Color(&'q str),
    /// It has this in it.
    Full(Filling),
    /// It works as it should.
    Sound(bool),
    /// It has come to its end: `the microwave is done`, `the coffee is ready`.
    Done,
    /// It works something, or is needed for it.
    For,
    /// It is what else is named: `the red thing the laser tip`.
    Same(Box<Phrase>),
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

    fn is_in(self, object: &KnownObject) -> bool {
        match self {
            Self::Fluid(fluid) => object.fluid == fluid && fluid != Fluid::None,
            Self::Cereal => object.has(StateFlag::Cereal),
        }
    }

    fn name(self) -> String {
        match self {
            Self::Fluid(fluid) => fluid.name().to_lowercase(),
            Self::Cereal => "cereal".to_owned(),
        }
    }
}

impl<'q> Claim<'q> {
    fn read(lexicon: &'q Lexicon, phrase: &'q Phrase, words: &'q [String]) -> Self {
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
        if let Some(is_sound) = said.soundness(words) {
            return Self::Sound(is_sound);
        }
        let mut reader = Reader::new(lexicon, words);
        // What stands for the subject elsewhere (`is it`, `the one for the laser`) has no words of its own to skip.
        let _ = reader.phrase_with_place();
        let left = if reader.at == 0 { &[] } else { reader.rest() };
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
            return Self::Same(Box::new(other));
        }
        let is_placed = phrase.relations.iter().any(|one| one.kind != RelationKind::Has) || phrase.room.is_some();
        match () {
            () if is_placed && is_told => Self::Placed,
            () if is_about_presence(lexicon, words, phrase) => Self::Present,
            () => Self::Untold,
        }
    }
}

impl Answerer<'_> {
    /// Whether what is asked of a thing is so.
    pub(crate) fn claim(&self, phrase: &Phrase, question: &Question) -> Understanding {
        let claim = Claim::read(self.lexicon, phrase, &question.rest);
        let bare = Phrase { relations: Vec::new(), room: None, ..phrase.clone() };
        if let (Claim::Placed | Claim::Present | Claim::Done, Some(filling)) =
            (&claim, Filling::named(self.lexicon, phrase))
            && let Some(answer) = self.filled(phrase, filling)
        {
            return answer;
        }
        if bare.is_empty() {
            return Understanding::lost("I do not know what you mean.");
        }
        match claim {
            Claim::State(state, words) if bare.is_all || bare.is_many() => self.are_in_state(&bare, state, words),
            Claim::State(state, words) => {
                self.with_object_that(may_be(state), &bare, |id| self.is_in_state(id, state, words))
            }
            Claim::Full(filling) => self.with_known(&bare, |object| self.is_filled(object, filling)),
            Claim::Color(asked) => {
                let color = bare.color.clone().filter(|color| color != asked);
                let colorless = Phrase { color, ..bare };
                self.with_known(&colorless, |object| self.is_of_color(object, asked))
            }
            Claim::Sound(is_asked) => self.with_known(&bare, |object| {
                let trouble = self.facts().trouble(object);
                let the = self.short(object.id);
                let text = match &trouble {
                    Some(_) if describe::bare(self.catalog, self.scene, object.id).contains("broken") => {
                        format!("{the} does not work")
                    }
                    Some(trouble) => format!("there is something wrong with {the}: {trouble}"),
                    None => format!("I see nothing wrong with {the}"),
                };
                self.told(trouble.is_none() == is_asked, &text, object.id)
            }),
            Claim::Done => self.with_known(&bare, |object| self.is_done(object)),
            Claim::For => self.with_known(&bare, |object| {
                if object.works.is_none() {
                    return self.cannot_tell(object);
                }
                let holds = self.ground().narrow(phrase, &[object.id]) == [object.id];
                let start = if holds { "Yes" } else { "No, as far as I know" };
                let text = format!("{start}: {}", describe::within_sentence(&self.facts().purpose(object)));
                Understanding::whether(holds, text, vec![object.id])
            }),
            Claim::Same(other) => self.is_same(phrase, &other),
            Claim::Placed => self.with_object(&bare, |id| {
                let holds = self.ground().narrow(phrase, &[id]) == [id];
                self.told(holds, &self.place_sentence(id), id)
            }),
            Claim::Present => self.place_of(&bare),
            Claim::Untold => self.with_known(&bare, |object| self.cannot_tell(object)),
        }
    }

    fn told(&self, holds: bool, text: &str, id: ObjectId) -> Understanding {
        let start = if holds { "Yes" } else { "No" };
        Understanding::whether(holds, format!("{start}, {text}."), vec![id])
    }

    /// Whether what is described is what is named; or where the latter is, if nothing is known that fits the description.
    fn is_same(&self, described: &Phrase, named: &Phrase) -> Understanding {
        let want = Want::place(Intent::Find, &[], None);
        let Ok(id) = self.ground().one(described, &want) else { return self.place_of(named) };
        if self.ground().narrow(named, &[id]) == [id] {
            return self.told(true, &format!("that is {}", self.full(id)), id);
        }
        let instead = match self.ground().one(named, &want) {
            Ok(other) => format!(", and {}", self.place_sentence(other)),
            Err(_) => String::new(),
        };
        self.told(false, &format!("that is {}{instead}", self.short(id)), id)
    }

    fn is_in_state(&self, id: ObjectId, state: StateWord, words: &[String]) -> Understanding {
        let holds = self.scene.object(id).is_some_and(|object| self.is_so(object, state));
        let (the, words) = (self.short(id), words.join(" "));
        let is_lit = self.scene.object(id).is_some_and(|object| self.devices.is_lit(object.class));
        let is_switched = matches!(state, StateWord::Flag(StateFlag::Toggled, _));
        let text = if is_switched && is_lit {
            let state = if holds { "" } else { "not " };
            format!("{the} is {state}{words}: it runs for a moment only, and its screen stays lit")
        } else if holds {
            format!("{the} {} {words}", describe::is(&the))
        } else if self.may_have_changed(id, state) {
            format!("{the} {} not {words} when I last saw {}", describe::was(&the), describe::it(&the))
        } else {
            format!("{the} {} not {words}", describe::is(&the))
        };
        self.told(holds, &text, id)
    }

    /// Whether all of several are in a state, and which are not.
    fn are_in_state(&self, phrase: &Phrase, state: StateWord, words: &[String]) -> Understanding {
        let Ok(all) = self.ground().all(phrase, &Want::place(Intent::Find, may_be(state), None)) else {
            return self.unseen(phrase);
        };
        let is_not = |id: &&ObjectId| !self.scene.object(**id).is_some_and(|object| self.is_so(object, state));
        let others: Vec<ObjectId> = all.iter().filter(is_not).copied().collect();
        let (words, named) = (words.join(" "), |ids: &[ObjectId]| {
            describe::list(&ids.iter().take(contents::LIST).map(|id| self.full(*id)).collect::<Vec<_>>(), "and")
        });
        let text = match (others.len(), all.len()) {
            (0, 1) => return self.is_in_state(all[0], state, &[words]),
            (0, _) => format!("Yes, they are all {words}."),
            (1, _) => format!("No, {} {} not {words}.", named(&others), describe::is(&self.short(others[0]))),
            (count, total) if count == total => format!("No, none of them is {words}."),
            _ => format!("No, {} are not {words}.", named(&others)),
        };
        Understanding::whether(others.is_empty(), text, all)
    }

    /// What is in a state here: `is anything broken`.
    pub(crate) fn all_in_state(&self, state: StateWord, words: &[String], is_whether: bool) -> Understanding {
        // What is so needs no leave to be so.
        let may = if matches!(state, StateWord::Flag(_, true)) { &[] } else { may_be(state) };
        let is_in = |object: &&KnownObject| {
            let class = self.catalog.class(object.class);
            object.room == self.scene.robot.room
                && (may.is_empty() || may.iter().any(|property| class.has(*property)))
                && self.is_so(object, state)
        };
        let found: Vec<ObjectId> = self.scene.objects.iter().filter(is_in).map(|object| object.id).collect();
        if found.is_empty() {
            let start = if is_whether { "No, " } else { "" };
            let text = describe::sentence(&format!("{start}I know of nothing {} here", words.join(" ")));
            return Understanding::whether(false, text, Vec::new());
        }
        let named: Vec<String> = found.iter().take(contents::LIST).map(|id| self.full(*id)).collect();
        let start = if is_whether { "yes: " } else { "" };
        let text = describe::sentence(&format!("{start}{}", describe::list(&named, "and")));
        Understanding::whether(true, text, found)
    }

    fn is_of_color(&self, object: &KnownObject, asked: &str) -> Understanding {
        let color = describe::color(self.catalog, object);
        if color.is_empty() {
            return self.cannot_tell(object);
        }
        let the = format!("the {}", describe::name(self.catalog, object.class));
        self.told(color.contains(asked), &format!("{the} {} {color}", describe::is(&the)), object.id)
    }

    /// Whether something poured is in what is named, or anywhere; nothing, where it is spoken of as a thing: `is the milk in the fridge`.
    pub(crate) fn filled(&self, phrase: &Phrase, filling: Filling) -> Option<Understanding> {
        let fills = filling.name();
        let Some(relation) = phrase.relations.iter().find(|relation| relation.kind == RelationKind::Inside) else {
            let is_thing = !phrase.namings.is_empty() || phrase.room.is_some();
            let found = || self.scene.objects.iter().filter(|object| filling.is_in(object)).map(|object| object.id);
            let full: Vec<String> = found().take(contents::LIST).map(|id| self.full(id)).collect();
            return (!is_thing).then(|| match full.is_empty() {
                true => Understanding::whether(false, format!("I have seen no {fills}."), Vec::new()),
                false => {
                    let text = format!("Yes, there is {fills} in {}.", describe::list(&full, "and"));
                    Understanding::whether(true, text, found().collect())
                }
            });
        };
        let id = self.ground().one(&relation.to, &Want::place(Intent::Find, &[], None)).ok()?;
        let object = self.scene.object(id)?;
        let is_thing =
            !phrase.namings.is_empty() && (!self.can_be_filled(object) || self.scene.contents(id).next().is_some());
        (!is_thing).then(|| self.is_filled(object, filling))
    }

    fn is_filled(&self, object: &KnownObject, filling: Filling) -> Understanding {
        let (id, fills) = (object.id, filling.name());
        let within = self.scene.contents(id).find(|inner| filling.is_in(inner));
        if let Some(full) = std::iter::once(object).find(|object| filling.is_in(object)).or(within) {
            let text = format!("there is {fills} in {}", self.short(full.id));
            return self.told(true, &text, full.id);
        }
        if !self.can_be_filled(object) {
            return self.cannot_tell(object);
        }
        let instead = match self.fillings(id) {
            None => "it is empty".to_owned(),
            Some(other) => format!("there is {other} in it"),
        };
        self.told(false, &format!("there is no {fills} in {}: {instead}", self.short(id)), id)
    }

    /// Whether a machine has run its time, or what is to be warm is so.
    fn is_done(&self, object: &KnownObject) -> Understanding {
        let (class, the) = (self.catalog.class(object.class), self.short(object.id));
        let is_on = object.has(StateFlag::Toggled);
        match () {
            () if class.has(Property::Toggleable) => self.told(
                !is_on,
                &format!("{the} {} {}", describe::is(&the), if is_on { "still on" } else { "off" }),
                object.id,
            ),
            () if class.has(Property::Heatable) => {
                let is_warm = object.has(StateFlag::Hot) || object.has(StateFlag::Cooked);
                let not = if is_warm { "" } else { "not " };
                self.told(is_warm, &format!("{the} {} {not}warm", describe::is(&the)), object.id)
            }
            () => self.cannot_tell(object),
        }
    }

    fn can_be_filled(&self, object: &KnownObject) -> bool {
        self.catalog.class(object.class).has(Property::Fillable)
    }

    /// The same, of a question whose beginning does not tell that it wants a yes or a no: `does the radio work`.
    pub(crate) fn claim_told(&self, phrase: &Phrase, question: &Question) -> Option<Understanding> {
        let claim = Claim::read(self.lexicon, phrase, &question.rest);
        matches!(claim, Claim::Sound(_) | Claim::Full(_) | Claim::Color(_)).then(|| self.claim(phrase, question))
    }

    /// Whether a thing is in a state as people say it: coffee that is no longer hot is cold.
    pub(crate) fn is_so(&self, object: &KnownObject, state: StateWord) -> bool {
        match state {
            StateWord::Flag(StateFlag::Cold, is_cold) if object.fluid == Fluid::Coffee => {
                object.has(StateFlag::Hot) != is_cold
            }
            // What things stand in is not empty.
            StateWord::Filled(is_full) if self.scene.contents(object.id).next().is_some() => is_full,
            StateWord::Flag(StateFlag::Broken, is_broken) => self.facts().is_broken(object) == is_broken,
            state => has_state(object, state),
        }
    }

    fn cannot_tell(&self, object: &KnownObject) -> Understanding {
        self.all_known(object, "I cannot tell")
    }

    /// Whether a machine may have made it hot or cold since the robot saw it.
    pub(crate) fn may_have_changed(&self, id: ObjectId, state: StateWord) -> bool {
        let is_warmth = matches!(state, StateWord::Flag(StateFlag::Hot | StateFlag::Cold, _));
        let is_seen = self.scene.robot.held == Some(id) || self.scene.object(id).is_some_and(|object| object.visible);
        is_warmth && !is_seen
    }
}

/// Whether what a question claims of a thing is something that the robot can tell.
pub(crate) fn can_be_told(lexicon: &Lexicon, question: &Question) -> bool {
    let is_told = |phrase| !matches!(Claim::read(lexicon, phrase, &question.rest), Claim::Untold | Claim::Present);
    question.about.as_ref().is_some_and(is_told)
}

/// What words name, if they do nothing else.
fn named(lexicon: &Lexicon, words: &[String]) -> Option<Phrase> {
    let mut reader = Reader::new(lexicon, words);
    let phrase = reader.phrase_with_place()?;
    let is_name = !phrase.namings.is_empty() || phrase.pronoun == Some(Pronoun::Thing) && !phrase.is_bare_pronoun();
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

/// What things afford that may be in a state.
const fn may_be(state: StateWord) -> &'static [Property] {
    match state {
        StateWord::Flag(StateFlag::Dirty, _) => &[Property::Dirtyable],
        StateWord::Flag(StateFlag::Broken, _) => &[Property::Breakable],
        StateWord::Flag(StateFlag::Opened, _) => &[Property::Openable],
        StateWord::Flag(StateFlag::Toggled, _) => &[Property::Toggleable, Property::Powerable],
        StateWord::Filled(_) => &[Property::Fillable],
        StateWord::Flag(..) => &[],
    }
}

/// The state that a question asks for, which is named after what it asks about: `the fridge open right now`; and its words.
pub(crate) fn asked_state<'w>(lexicon: &Lexicon, words: &'w [String]) -> Option<(StateWord, &'w [String])> {
    let named = |at: usize| {
        let on_or_off = match words[at].as_str() {
            "on" => Some((1, StateWord::Flag(StateFlag::Toggled, true))),
            "off" => Some((1, StateWord::Flag(StateFlag::Toggled, false))),
            _ => None,
        };
        lexicon.states.longest(&words[at..]).map(|(length, state)| (length, *state)).or(on_or_off)
    };
    let names =
        |at: usize| lexicon.classes.longest(&words[at..]).is_some() || lexicon.rooms.longest(&words[at..]).is_some();
    // `on it`
    let is_place = |end: usize| {
        Reader { at: end, ..Reader::new(lexicon, words) }.phrase().is_some_and(|phrase| phrase.pronoun.is_some())
    };
    let is_last = |end: usize| !is_place(end) && !(end..words.len()).any(names);
    (0..words.len()).rev().find_map(|at| {
        let (length, state) = named(at)?;
        is_last(at + length).then(|| (state, &words[at..at + length]))
    })
}
