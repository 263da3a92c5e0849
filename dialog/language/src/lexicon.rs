//! All words the robot understands: its own tables, and the names of the catalogue's classes.

use std::collections::{BTreeMap, BTreeSet};

use cohabit_cdf::{Catalog, ClassId, Fluid, Property, RoomId, state::StateFlag};
use serde::{Deserialize, Serialize};

use crate::{
    amend::Amends, chatter::Chatter, inflect, intent::Intent, misheard::Misheard, question::QuestionKind,
    sound::Sounding, spelling::Vocabulary, table::PhraseTable, token, wish::Wishes,
};

/// A class that a word may mean, and how much it means it: 1 for its name, less for words further down its list.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct Naming {
    pub(crate) class: ClassId,
    pub(crate) weight: f32,
}

/// How much one word of a name of several means its class.
const NAME_PART: f32 = 0.6;

/// The same of its other names.
const WORD_PART: f32 = 0.5;

/// How much the word for a kind of things means a class of that kind.
const KIND: f32 = 0.3;

/// Words that join others or carry no meaning of their own: nobody takes them for others.
const SMALL_WORDS: &[&str] = &[
    "and", "to", "in", "on", "at", "of", "i", "you", "please", "with", "then", "can", "could", "would", "will",
    "should", "must", "may", "might", "be", "is", "are", "was", "has", "have", "had", "do", "does", "did", "not", "no",
    "me", "us", "there", "here", "what", "which", "who", "where", "when", "why", "how", "if", "as", "so", "but", "or",
    "for", "from", "off", "out", "by", "now", "just", "also", "again", "all", "both", "either", "neither", "go", "put",
    "take", "get", "we", "he", "she", "up", "down",
];

/// How a verb has it done, besides what it asks for.
#[derive(Clone, Copy, Debug, Deserialize, Eq, Ord, PartialEq, PartialOrd, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Manner {
    /// Into what was made for it.
    Insert,
    /// To nowhere that could be named.
    Shift,
    /// As it is, or where it is.
    Leave,
    /// To where it was taken from.
    Back,
    /// In a color, said or not.
    Color,
}

/// What an adjective demands of an object's state.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub(crate) enum StateWord {
    Flag(StateFlag, bool),
    Filled(bool),
}

/// What a preposition says about the phrase after it.
#[derive(Clone, Copy, Debug, Deserialize, Eq, Ord, PartialEq, PartialOrd, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Preposition {
    In,
    On,
    To,
    At,
    From,
    Near,
    With,
    For,
    LeftOf,
    RightOf,
}

/// Which of several, by where they are.
#[derive(Clone, Copy, Debug, Deserialize, Eq, Ord, PartialEq, PartialOrd, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Side {
    Left,
    Right,
    Front,
    Behind,
    Nearest,
    Farthest,
    Middle,
    Other,
}

/// Which way.
#[derive(Clone, Copy, Debug, Deserialize, Eq, Ord, PartialEq, PartialOrd, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Direction {
    Forward,
    Backward,
    Left,
    Right,
    Around,
    Up,
    Down,
}

/// What a pronoun stands for.
#[derive(Clone, Copy, Debug, Deserialize, Eq, Ord, PartialEq, PartialOrd, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Pronoun {
    Thing,
    Things,
    Place,
    One,
}

/// Words that are a whole utterance, or its beginning.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub(crate) enum Small {
    Yes,
    No,
    Neither,
    Unsure,
    /// Look for it.
    Search,
    Any,
    Hello,
    Thanks,
    Again,
    Undo,
    /// Do what the mission wants next.
    Goal,
}

/// The tables.
#[derive(Debug, Default)]
pub(crate) struct Lexicon {
    pub(crate) replace: PhraseTable<Vec<String>>,
    pub(crate) lead: PhraseTable<()>,
    pub(crate) trail: PhraseTable<()>,
    pub(crate) articles: PhraseTable<()>,
    pub(crate) adjectives: PhraseTable<()>,
    pub(crate) all: PhraseTable<()>,
    /// Any one of several.
    pub(crate) one_of: PhraseTable<()>,
    pub(crate) link: PhraseTable<()>,
    pub(crate) here: PhraseTable<()>,
    pub(crate) degrees: PhraseTable<()>,
    pub(crate) viewpoints: PhraseTable<()>,
    pub(crate) negation: PhraseTable<()>,
    /// Openers, fillers and oaths.
    pub(crate) talk: PhraseTable<()>,
    pub(crate) answer_lead: PhraseTable<()>,
    /// Nouns for anything.
    pub(crate) generic: PhraseTable<()>,
    pub(crate) people: PhraseTable<()>,
    pub(crate) goal_words: PhraseTable<()>,
    pub(crate) text_words: PhraseTable<()>,
    pub(crate) hand_words: PhraseTable<()>,
    pub(crate) motion_spare: PhraseTable<()>,
    pub(crate) reports: PhraseTable<()>,
    /// What is to be done if something holds, or if it does not.
    pub(crate) conditions: PhraseTable<bool>,
    /// `show me`, before `how many mugs there are`.
    pub(crate) tells: PhraseTable<()>,
    pub(crate) undone: PhraseTable<()>,
    pub(crate) titles: PhraseTable<()>,
    pub(crate) pronouns: PhraseTable<Pronoun>,
    pub(crate) prepositions: PhraseTable<Preposition>,
    pub(crate) sides: PhraseTable<Side>,
    pub(crate) ordinals: PhraseTable<i32>,
    pub(crate) directions: PhraseTable<Direction>,
    pub(crate) units: PhraseTable<f32>,
    /// Parts of a turn, in degrees.
    pub(crate) turns: PhraseTable<f32>,
    pub(crate) numbers: PhraseTable<f32>,
    pub(crate) colors: PhraseTable<String>,
    pub(crate) states: PhraseTable<StateWord>,
    /// Words for a state, and the verb that brings it about.
    pub(crate) brings_about: PhraseTable<Vec<String>>,
    pub(crate) fluids: PhraseTable<Fluid>,
    pub(crate) rooms: PhraseTable<RoomId>,
    pub(crate) small: PhraseTable<BTreeSet<Small>>,
    pub(crate) verbs: PhraseTable<Vec<Intent>>,
    /// The first words of all verbs.
    pub(crate) verb_heads: BTreeSet<String>,
    pub(crate) manners: PhraseTable<Manner>,
    /// First words of a verb whose last word may stand after the object; that word; the intent.
    pub(crate) separable: Vec<(Vec<String>, String, Intent)>,
    pub(crate) questions: PhraseTable<QuestionKind>,
    /// Replies to what asks for nothing to be done.
    pub(crate) chat: PhraseTable<String>,
    pub(crate) classes: PhraseTable<Vec<Naming>>,
    /// Single words of names of several words: `trash` for the trash can.
    pub(crate) name_parts: PhraseTable<Vec<Naming>>,
    /// Words for kinds of things.
    pub(crate) kinds: BTreeSet<String>,
    /// What can be picked up.
    pub(crate) carried: BTreeSet<ClassId>,
    /// All words that name a class, by its index.
    pub(crate) class_words: Vec<BTreeSet<String>>,
    pub(crate) vocabulary: Vocabulary,
    pub(crate) wishes: Wishes,
    pub(crate) amends: Amends,
    pub(crate) chatter: Chatter,
    /// How the words sound that may be taken for others.
    pub(crate) sounds: Sounding,
    pub(crate) misheard: Misheard,
}

#[derive(Deserialize)]
struct Words {
    words: Vec<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WordFile {
    replace: BTreeMap<String, String>,
    lead: Words,
    trail: Words,
    articles: Words,
    adjectives: Words,
    all: Words,
    one_of: Words,
    link: Words,
    here: Words,
    degrees: Words,
    viewpoints: Words,
    negation: Words,
    talk: Words,
    brings_about: BTreeMap<String, Vec<String>>,
    kinds: BTreeMap<String, Property>,
    answer_lead: Words,
    generic: Words,
    people: Words,
    goal_words: Words,
    text_words: Words,
    hand_words: Words,
    motion_spare: Words,
    reports: Words,
    tells: Words,
    conditions: Conditions,
    undone: Words,
    titles: Words,
    pronouns: BTreeMap<Pronoun, Vec<String>>,
    prepositions: BTreeMap<Preposition, Vec<String>>,
    sides: BTreeMap<Side, Vec<String>>,
    ordinals: BTreeMap<String, i32>,
    directions: BTreeMap<Direction, Vec<String>>,
    units: BTreeMap<String, f32>,
    turns: BTreeMap<String, f32>,
    numbers: BTreeMap<String, f32>,
    colors: BTreeMap<String, Vec<String>>,
    states: BTreeMap<String, Vec<String>>,
    fill_words: FillWords,
    fluids: BTreeMap<String, Vec<String>>,
    rooms: BTreeMap<String, Vec<String>>,
    aliases: BTreeMap<String, Vec<String>>,
    yes: Words,
    no: Words,
    neither: Words,
    unsure: Words,
    search: Words,
    any: Words,
    hello: Words,
    thanks: Words,
    again: Words,
    undo: Words,
    do_goal: Words,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Conditions {
    holds: Vec<String>,
    fails: Vec<String>,
}

#[derive(Deserialize)]
struct FillWords {
    full: Vec<String>,
    empty: Vec<String>,
}

#[derive(Deserialize)]
struct VerbFile {
    #[serde(rename = "verb")]
    verbs: Vec<VerbEntry>,
    manners: BTreeMap<Manner, Vec<String>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct VerbEntry {
    intent: Intent,
    #[serde(default)]
    words: Vec<String>,
    #[serde(default)]
    split: Vec<String>,
}

#[derive(Deserialize)]
struct ChatFile {
    chat: Vec<ChatEntry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ChatEntry {
    words: Vec<String>,
    reply: String,
}

#[derive(Deserialize)]
struct QuestionFile {
    #[serde(rename = "question")]
    questions: Vec<QuestionEntry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct QuestionEntry {
    kind: QuestionKind,
    starts: Vec<String>,
}

impl Lexicon {
    /// The built-in tables, and the names of the catalogue's classes.
    pub(crate) fn new(catalog: &Catalog) -> Self {
        let file: WordFile = parse(include_str!("../data/words.toml"));
        let mut lexicon = Self {
            wishes: parse(include_str!("../data/wishes.toml")),
            amends: parse(include_str!("../data/amends.toml")),
            chatter: parse(include_str!("../data/chatter.toml")),
            ..Self::default()
        };
        lexicon.add_words(&file);
        lexicon.add_smalls(&file);
        lexicon.add_verbs();
        lexicon.add_classes(catalog, &file.aliases);
        lexicon.add_word_parts(catalog);
        lexicon.add_kinds(catalog, &file.kinds);
        lexicon.build_vocabulary();
        lexicon.build_sounds();
        lexicon
    }

    /// Whether it only joins other words, and nobody mistakes it.
    pub(crate) fn is_small_word(&self, word: &str) -> bool {
        let word = [word.to_owned()];
        self.articles.exact(&word).is_some()
            || self.pronouns.exact(&word).is_some()
            || SMALL_WORDS.contains(&word[0].as_str())
    }

    /// Whether it is a word of the name of a thing.
    pub(crate) fn is_noun(&self, word: &str) -> bool {
        let word = [word.to_owned()];
        self.classes.exact(&word).is_some() || self.name_parts.exact(&word).is_some()
    }

    /// The words of an utterance: tokens, with spelling repaired and set phrases replaced; and how many were misspelt.
    pub(crate) fn normalise(&self, text: &str) -> (Vec<String>, usize) {
        // What is replaced may complete what is.
        let replaced = self.replaced(&self.replaced(&token::words(text)));
        let replaced = self.rejoined(self.vocabulary.respaced(replaced));
        let mut corrected: Vec<String> = Vec::with_capacity(replaced.len());
        let mut repairs = 0;
        for word in &replaced {
            if let Some(verb) = self.as_request(&corrected, word) {
                corrected.push(verb);
                continue;
            }
            let words = self.vocabulary.correct(word);
            // `the mugs`: all of them.
            let is_plural = !self.vocabulary.has(word) && words.len() == 1 && self.classes.exact(&words).is_some();
            if is_plural && self.vocabulary.singular(word).as_ref() == words.first() {
                let article = corrected.len().saturating_sub(1);
                let says_which =
                    corrected.last().is_some_and(|last| matches!(last.as_str(), "the" | "these" | "those"));
                let is_all = article > 0 && self.all.exact(&corrected[article - 1..article]).is_some();
                if says_which && !is_all && article > 0 && corrected[article - 1] != "of" {
                    corrected.insert(article, "all".to_owned());
                }
            }
            // A plural, or two words run together, is no slip.
            repairs += usize::from(matches!(words.as_slice(), [one] if one != word && !word.starts_with(one.as_str())));
            corrected.extend(words);
        }
        (self.replaced(&corrected), repairs)
    }

    /// The words of an utterance as they were said: set phrases replaced, and no spelling repaired.
    pub(crate) fn as_said(&self, text: &str) -> Vec<String> {
        let words = self.replaced(&token::words(text));
        words
            .into_iter()
            .map(|word| self.vocabulary.singular(&word).filter(|_| !self.vocabulary.has(&word)).unwrap_or(word))
            .collect()
    }

    /// `in serted`: a form of a verb with a space in it.
    fn rejoined(&self, words: Vec<String>) -> Vec<String> {
        let mut result: Vec<String> = Vec::with_capacity(words.len());
        for word in words {
            let is_odd = word.len() > 2
                && word.chars().all(|letter| letter.is_ascii_alphabetic())
                && !self.vocabulary.is_word(&word);
            let whole = result.last().filter(|_| is_odd).map(|last| format!("{last}{word}"));
            match whole.filter(|whole| inflect::stem(self, whole).is_some()) {
                Some(whole) => {
                    result.pop();
                    result.push(whole);
                }
                None => result.push(word),
            }
        }
        result
    }

    /// `opening` after `would you mind`, as the verb; and `makes` after what makes, as no verb.
    fn as_request(&self, before: &[String], word: &str) -> Option<String> {
        let last = before.last().map(String::as_str);
        let is_asked = matches!(
            last,
            None | Some(
                "mind"
                    | "awfully"
                    | "terribly"
                    | "kindly"
                    | "about"
                    | "by"
                    | "try"
                    | "start"
                    | "begin"
                    | "please"
                    | "meant"
                    | "mean"
                    | "to"
            )
        );
        let is_form = word.ends_with("ing") || last == Some("to") && word.ends_with("ed");
        if is_asked && is_form && !self.classes.words().any(|known| known == word) {
            return inflect::stem(self, word);
        }
        let verb = word.strip_suffix('s').filter(|verb| self.verb_heads.contains(*verb))?;
        let is_noun = self.classes.words().any(|known| known == verb || known == word);
        let is_told = last
            .is_some_and(|last| last.chars().all(char::is_alphabetic) && !self.lead.words().any(|lead| lead == last));
        (is_told && !is_noun && !self.vocabulary.has(word)).then(|| word.to_owned())
    }

    pub(crate) fn replaced(&self, words: &[String]) -> Vec<String> {
        let mut result = Vec::with_capacity(words.len());
        let mut at = 0;
        while at < words.len() {
            if let Some((length, meaning)) = self.replace.longest(&words[at..]) {
                result.extend(meaning.iter().cloned());
                at += length;
            } else {
                result.push(words[at].clone());
                at += 1;
            }
        }
        result
    }

    fn add_words(&mut self, file: &WordFile) {
        for (from, to) in &file.replace {
            self.replace.insert(from, token::words(to));
        }
        let plain = [
            (&mut self.lead, &file.lead),
            (&mut self.trail, &file.trail),
            (&mut self.articles, &file.articles),
            (&mut self.adjectives, &file.adjectives),
            (&mut self.all, &file.all),
            (&mut self.one_of, &file.one_of),
            (&mut self.link, &file.link),
            (&mut self.here, &file.here),
            (&mut self.degrees, &file.degrees),
            (&mut self.viewpoints, &file.viewpoints),
            (&mut self.negation, &file.negation),
            (&mut self.talk, &file.talk),
            (&mut self.answer_lead, &file.answer_lead),
            (&mut self.generic, &file.generic),
            (&mut self.people, &file.people),
            (&mut self.goal_words, &file.goal_words),
            (&mut self.text_words, &file.text_words),
            (&mut self.hand_words, &file.hand_words),
            (&mut self.motion_spare, &file.motion_spare),
            (&mut self.reports, &file.reports),
            (&mut self.tells, &file.tells),
            (&mut self.undone, &file.undone),
            (&mut self.titles, &file.titles),
        ];
        for (table, entry) in plain {
            entry.words.iter().for_each(|word| table.insert(word, ()));
        }
        file.conditions.holds.iter().for_each(|words| self.conditions.insert(words, true));
        file.conditions.fails.iter().for_each(|words| self.conditions.insert(words, false));
        add_all(&mut self.pronouns, &file.pronouns);
        add_all(&mut self.prepositions, &file.prepositions);
        add_all(&mut self.sides, &file.sides);
        add_all(&mut self.directions, &file.directions);
        file.ordinals.iter().for_each(|(word, value)| self.ordinals.insert(word, *value));
        file.units.iter().for_each(|(word, value)| self.units.insert(word, *value));
        file.turns.iter().for_each(|(word, value)| self.turns.insert(word, *value));
        file.numbers.iter().for_each(|(word, value)| self.numbers.insert(word, *value));
        for (color, words) in &file.colors {
            words.iter().for_each(|word| self.colors.insert(word, color.clone()));
        }
        for words in file.states.values() {
            let state = words.first().and_then(|flag| state_word(flag));
            let state = state.expect("invariant: each list of state words begins with a flag");
            words.iter().skip(1).for_each(|word| self.states.insert(word, state));
        }
        for (verb, words) in &file.brings_about {
            words.iter().for_each(|word| self.brings_about.insert(word, token::words(verb)));
        }
        file.fill_words.full.iter().for_each(|word| self.states.insert(word, StateWord::Filled(true)));
        file.fill_words.empty.iter().for_each(|word| self.states.insert(word, StateWord::Filled(false)));
        for (fluid, words) in &file.fluids {
            let fluid = Fluid::from_name(fluid).expect("invariant: the file names fluids");
            words.iter().for_each(|word| self.fluids.insert(word, fluid));
        }
        for (room, words) in &file.rooms {
            let room = RoomId::from_id(room).expect("invariant: the file names rooms");
            words.iter().for_each(|word| self.rooms.insert(word, room));
            self.rooms.insert(room.id(), room);
        }
    }

    fn add_smalls(&mut self, file: &WordFile) {
        let lists = [
            (Small::Yes, &file.yes),
            (Small::No, &file.no),
            (Small::Neither, &file.neither),
            (Small::Unsure, &file.unsure),
            (Small::Search, &file.search),
            (Small::Any, &file.any),
            (Small::Hello, &file.hello),
            (Small::Thanks, &file.thanks),
            (Small::Again, &file.again),
            (Small::Undo, &file.undo),
            (Small::Goal, &file.do_goal),
        ];
        for (small, list) in lists {
            for word in &list.words {
                self.small.entry(word).insert(small);
            }
        }
    }

    fn add_verbs(&mut self) {
        let file: VerbFile = parse(include_str!("../data/verbs.toml"));
        for entry in file.verbs {
            for word in entry.words.iter().chain(&entry.split) {
                self.verb_heads.extend(token::words(word).into_iter().next());
                let intents = self.verbs.entry(word);
                if !intents.contains(&entry.intent) {
                    intents.push(entry.intent);
                }
            }
            for phrase in &entry.split {
                let mut head = token::words(phrase);
                if let Some(particle) = head.pop() {
                    self.separable.push((head, particle, entry.intent));
                }
            }
        }
        add_all(&mut self.manners, &file.manners);
        let file: QuestionFile = parse(include_str!("../data/questions.toml"));
        for entry in file.questions {
            entry.starts.iter().for_each(|start| self.questions.insert(start, entry.kind));
        }
        let file: ChatFile = parse(include_str!("../data/chat.toml"));
        for entry in file.chat {
            entry.words.iter().for_each(|words| self.chat.insert(words, entry.reply.clone()));
        }
    }

    fn add_classes(&mut self, catalog: &Catalog, aliases: &BTreeMap<String, Vec<String>>) {
        for (index, class) in (0_u16..).zip(catalog.classes()) {
            let id = ClassId(index);
            if class.has(Property::Pickupable) {
                self.carried.insert(id);
            }
            self.name_class(&class.name, id, 1.0);
            self.name_class(&class.id, id, 1.0);
            self.add_name_parts(&class.name, id);
            for (rank, word) in (0_u8..).zip(&class.words) {
                self.name_class(word, id, 0.9 - 0.05 * f32::from(rank.min(8)));
            }
        }
        for (alias, classes) in aliases {
            for class in classes.iter().filter_map(|id| catalog.find(id)) {
                self.name_class(alias, class, 0.9);
            }
        }
    }

    fn add_name_parts(&mut self, name: &str, class: ClassId) {
        let words = self.replaced(&token::words(name));
        let is_room = |word: &String| self.rooms.words().any(|known| known == word);
        let parts: Vec<String> = words.iter().filter(|word| word.len() > 2 && !is_room(word)).cloned().collect();
        for word in parts.iter().filter(|_| words.len() > 1) {
            self.name_parts.entry(word).push(Naming { class, weight: NAME_PART });
        }
    }

    /// `garbage` for the garbage can: parts of other names than the first, where the word means nothing else.
    fn add_word_parts(&mut self, catalog: &Catalog) {
        for (index, class) in (0_u16..).zip(catalog.classes()).filter(|(_, class)| !class.has(Property::Decor)) {
            for name in class.words.iter().map(|name| token::words(name)).filter(|name| name.len() == 2) {
                let word = &name[..1];
                let is_free = word[0].len() > 3
                    && !self.is_small_word(&word[0])
                    && self.classes.exact(word).is_none()
                    && self.name_parts.exact(word).is_none_or(|known| known.iter().all(|one| one.weight < NAME_PART))
                    && [
                        self.colors.exact(word).is_some(),
                        self.fluids.exact(word).is_some(),
                        self.states.exact(word).is_some(),
                    ] == [false; 3]
                    && !self
                        .adjectives
                        .words()
                        .chain(self.rooms.words())
                        .chain(self.verbs.words())
                        .any(|known| *known == word[0]);
                let namings = is_free.then(|| self.name_parts.entry(&word[0]));
                if let Some(namings) = namings.filter(|known| known.iter().all(|one| one.class != ClassId(index))) {
                    namings.push(Naming { class: ClassId(index), weight: WORD_PART });
                }
            }
        }
    }

    /// `machine`, `food`: all classes that are such, where the word is no part of a name that was meant.
    fn add_kinds(&mut self, catalog: &Catalog, kinds: &BTreeMap<String, Property>) {
        for (word, property) in kinds {
            let namings = self.name_parts.entry(word);
            for (index, _) in (0_u16..).zip(catalog.classes()).filter(|(_, class)| class.has(*property)) {
                if namings.iter().all(|known| known.class != ClassId(index)) {
                    namings.push(Naming { class: ClassId(index), weight: KIND });
                }
            }
            self.kinds.insert(word.clone());
        }
    }

    fn name_class(&mut self, phrase: &str, class: ClassId, weight: f32) {
        // The same replacements as in utterances, so that `breakroom sign` is found again.
        let phrase = self.replaced(&token::words(phrase)).join(" ");
        if phrase.is_empty() {
            return;
        }
        let index = usize::from(class.0);
        if self.class_words.len() <= index {
            self.class_words.resize(index + 1, BTreeSet::new());
        }
        self.class_words[index].extend(token::words(&phrase));
        let namings = self.classes.entry(&phrase);
        match namings.iter_mut().find(|naming| naming.class == class) {
            Some(naming) => naming.weight = naming.weight.max(weight),
            None => namings.push(Naming { class, weight }),
        }
    }

    fn build_sounds(&mut self) {
        let tables = [
            self.classes.words().collect::<Vec<_>>(),
            self.verbs.words().collect(),
            self.rooms.words().collect(),
            self.directions.words().collect(),
            self.colors.words().collect(),
            self.states.words().collect(),
            self.ordinals.words().collect(),
            self.units.words().collect(),
            self.numbers.words().collect(),
            self.prepositions.words().collect(),
        ];
        let is_vague = |word: &str| {
            matches!(word, "front" | "back" | "about" | "behind" | "up" | "down" | "other" | "way" | "of" | "the" | "a")
        };
        let spoken = |word: &&&String| {
            word.len() > 1 && !is_vague(word) && word.chars().all(|letter| letter.is_ascii_alphabetic())
        };
        let words: BTreeSet<&String> = tables.iter().flatten().filter(spoken).copied().collect();
        self.sounds = Sounding::new(words.into_iter());
        let names = self.classes.phrases().chain(self.rooms.phrases()).filter(|name| name.len() > 1);
        self.misheard = Misheard::new(names);
    }

    fn build_vocabulary(&mut self) {
        let mut vocabulary = Vocabulary::default();
        let mut learn = |word: &String| vocabulary.learn(word);
        for table in [
            &self.lead,
            &self.trail,
            &self.articles,
            &self.adjectives,
            &self.all,
            &self.one_of,
            &self.link,
            &self.here,
            &self.degrees,
            &self.viewpoints,
            &self.negation,
            &self.answer_lead,
            &self.generic,
            &self.goal_words,
            &self.text_words,
            &self.hand_words,
            &self.motion_spare,
            &self.reports,
            &self.tells,
            &self.undone,
            &self.titles,
        ] {
            table.words().for_each(&mut learn);
        }
        self.replace.words().for_each(&mut learn);
        self.pronouns.words().for_each(&mut learn);
        self.prepositions.words().for_each(&mut learn);
        self.sides.words().for_each(&mut learn);
        self.ordinals.words().for_each(&mut learn);
        self.directions.words().for_each(&mut learn);
        self.units.words().for_each(&mut learn);
        self.turns.words().for_each(&mut learn);
        self.numbers.words().for_each(&mut learn);
        self.colors.words().for_each(&mut learn);
        self.states.words().for_each(&mut learn);
        self.fluids.words().for_each(&mut learn);
        self.rooms.words().for_each(&mut learn);
        self.small.words().for_each(&mut learn);
        self.verbs.words().for_each(&mut learn);
        self.questions.words().for_each(&mut learn);
        self.classes.words().for_each(&mut learn);
        self.brings_about.words().for_each(&mut learn);
        self.wishes.shooters.words().chain(&self.wishes.subjecters).chain(&self.wishes.infecters).for_each(&mut learn);
        self.kinds.iter().for_each(&mut learn);
        self.talk.words().chain(self.people.words()).for_each(|word| vocabulary.learn_talk(word));
        self.chat.words().for_each(|word| vocabulary.learn_plain(word));
        include_str!("../data/common.txt").split_whitespace().for_each(|word| vocabulary.learn_plain(word));
        include_str!("../data/ordinary.txt").split_whitespace().for_each(|word| vocabulary.learn_ordinary(word));
        self.vocabulary = vocabulary;
    }
}

fn add_all<T: Copy>(table: &mut PhraseTable<T>, entries: &BTreeMap<T, Vec<String>>) {
    for (meaning, words) in entries {
        words.iter().for_each(|word| table.insert(word, *meaning));
    }
}

fn state_word(flag: &str) -> Option<StateWord> {
    let value = flag.starts_with('+');
    let name = flag.get(1..)?;
    let flag = StateFlag::ALL.into_iter().find(|flag| format!("{flag:?}") == name)?;
    Some(StateWord::Flag(flag, value))
}

fn parse<T: serde::de::DeserializeOwned>(text: &str) -> T {
    toml::from_str(text).expect("invariant: the built-in tables parse, the tests load them")
}
