//! The tables of words as they lie in `data`, and how they come into the lexicon.

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::Arc,
};

use cohabit_cdf::{Catalog, Fluid, Property, state::StateFlag};
use serde::Deserialize;

use crate::words::{
    intent::Intent,
    lexicon::{Direction, Lexicon, Manner, Preposition, Pronoun, Side, Small, StateWord},
    lists::TalkReply,
    misheard::Misheard,
    question_kind::{QuestionKind, Shape},
    sound::Sounding,
    spelling::Vocabulary,
    table::PhraseTable,
    token,
};

/// A word behind which others are read as within a sentence: a verb at its beginning would be a request.
const WITHIN: &str = "it";

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
    nooks: Words,
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
    control_words: Words,
    hand_words: Words,
    motion_spare: Words,
    reports: Words,
    corrections: Words,
    instead: Words,
    exits: Words,
    tells: Words,
    conditions: Words,
    undone: Words,
    beforehand: Words,
    titles: Words,
    pronouns: BTreeMap<Pronoun, Vec<String>>,
    prepositions: BTreeMap<Preposition, Vec<String>>,
    sides: BTreeMap<Side, Vec<String>>,
    sizes: BTreeMap<Side, Vec<String>>,
    ordinals: BTreeMap<String, i32>,
    directions: BTreeMap<Direction, Vec<String>>,
    units: BTreeMap<String, f32>,
    turns: BTreeMap<String, f32>,
    numbers: BTreeMap<String, f32>,
    colors: BTreeMap<String, Vec<String>>,
    states: BTreeMap<String, Vec<String>>,
    fill_words: FillWords,
    fluids: BTreeMap<String, Vec<String>>,
    aliases: BTreeMap<String, Vec<String>>,
    yes: Words,
    no: Words,
    neither: Words,
    more: Words,
    unsure: Words,
    search: Words,
    any: Words,
    longer: Words,
    shorter: Words,
    hello: Words,
    thanks: Words,
    again: Words,
    undo: Words,
    resume: Words,
    do_goal: Words,
    follow: Words,
    unfollow: Words,
    aside: Words,
    do_mission: Words,
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
    /// The kind of things of which alone they are said.
    #[serde(default)]
    of: Option<String>,
    #[serde(default)]
    words: Vec<String>,
    #[serde(default)]
    split: Vec<String>,
}

#[derive(Deserialize)]
struct ChatFile {
    chat: Vec<ChatEntry>,
    talk: BTreeMap<String, TalkReply>,
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
    #[serde(rename = "shape")]
    shapes: Vec<Shape>,
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
        let file: WordFile = parse(include_str!("../../data/words.toml"));
        let mut lexicon = Self {
            wishes: parse(include_str!("../../data/wishes.toml")),
            fillers: parse(include_str!("../../data/fillers.toml")),
            chatter: parse(include_str!("../../data/chatter.toml")),
            ifs: parse(include_str!("../../data/conditions.toml")),
            waiting: parse(include_str!("../../data/waiting.toml")),
            hints: parse(include_str!("../../data/hints.toml")),
            yes_no: parse(include_str!("../../data/yes_no.toml")),
            ..Self::default()
        };
        lexicon.add_words(&file);
        lexicon.add_rooms(catalog);
        lexicon.add_smalls(&file);
        lexicon.add_verbs();
        lexicon.add_classes(catalog, &file.aliases);
        lexicon.add_word_parts(catalog);
        lexicon.add_kinds(catalog, &file.kinds);
        lexicon.build_vocabulary();
        lexicon.normalise_shapes();
        lexicon.build_sounds();
        lexicon
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
            (&mut self.nooks, &file.nooks),
            (&mut self.degrees, &file.degrees),
            (&mut self.viewpoints, &file.viewpoints),
            (&mut self.negation, &file.negation),
            (&mut self.talk, &file.talk),
            (&mut self.answer_lead, &file.answer_lead),
            (&mut self.generic, &file.generic),
            (&mut self.people, &file.people),
            (&mut self.goal_words, &file.goal_words),
            (&mut self.text_words, &file.text_words),
            (&mut self.control_words, &file.control_words),
            (&mut self.hand_words, &file.hand_words),
            (&mut self.motion_spare, &file.motion_spare),
            (&mut self.reports, &file.reports),
            (&mut self.corrections, &file.corrections),
            (&mut self.instead, &file.instead),
            (&mut self.exits, &file.exits),
            (&mut self.tells, &file.tells),
            (&mut self.conditions, &file.conditions),
            (&mut self.undone, &file.undone),
            (&mut self.beforehand, &file.beforehand),
            (&mut self.titles, &file.titles),
        ];
        for (table, entry) in plain {
            entry.words.iter().for_each(|word| table.insert(word, ()));
        }
        // `what i would like you to do is …`
        file.talk
            .words
            .iter()
            .filter(|said| said.starts_with("what "))
            .for_each(|said| self.talk.insert(&format!("{said} is"), ()));
        add_all(&mut self.pronouns, &file.pronouns);
        add_all(&mut self.prepositions, &file.prepositions);
        add_all(&mut self.sides, &file.sides);
        add_all(&mut self.sizes, &file.sizes);
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
    }

    /// What rooms are called in this world.
    fn add_rooms(&mut self, catalog: &Catalog) {
        let rooms = catalog.rooms().all();
        for entry in rooms {
            let room = entry.id;
            entry.words.iter().for_each(|words| self.rooms.insert(words, room));
            self.rooms.insert(room.id(), room);
            self.room_ids.insert(room.id().to_lowercase(), room);
            self.room_names.insert(room, entry.name.clone());
            entry.kind.iter().for_each(|kind| self.room_kinds.entry(kind).push(room));
            self.rooms_of_kinds.extend((!entry.kind.is_empty()).then_some(room));
        }
        // The name of one is no other word for another one.
        rooms.iter().for_each(|entry| self.rooms.insert(&entry.name, entry.id));
    }

    fn add_smalls(&mut self, file: &WordFile) {
        let lists = [
            (Small::Yes, &file.yes),
            (Small::No, &file.no),
            (Small::Neither, &file.neither),
            (Small::More, &file.more),
            (Small::Unsure, &file.unsure),
            (Small::Search, &file.search),
            (Small::Any, &file.any),
            (Small::Longer, &file.longer),
            (Small::Shorter, &file.shorter),
            (Small::Hello, &file.hello),
            (Small::Thanks, &file.thanks),
            (Small::Again, &file.again),
            (Small::Undo, &file.undo),
            (Small::Resume, &file.resume),
            (Small::Goal, &file.do_goal),
            (Small::Follow, &file.follow),
            (Small::Unfollow, &file.unfollow),
            (Small::Aside, &file.aside),
            (Small::Mission, &file.do_mission),
        ];
        for (small, list) in lists {
            for word in &list.words {
                self.small.entry(word).insert(small);
            }
        }
    }

    fn add_verbs(&mut self) {
        let file: VerbFile = parse(include_str!("../../data/verbs.toml"));
        for entry in file.verbs {
            for word in entry.words.iter().chain(&entry.split) {
                self.verb_heads.extend(token::words(word).into_iter().next());
                let intents = self.verbs.entry(word);
                if !intents.contains(&entry.intent) {
                    intents.push(entry.intent);
                }
                if let Some(kind) = &entry.of {
                    self.verbs_of_kinds.entry(word).push((entry.intent, kind.clone()));
                }
            }
            for phrase in &entry.split {
                let mut head = token::words(phrase);
                if let Some(particle) = head.pop() {
                    self.separable.push((head, particle, entry.intent));
                }
            }
        }
        let (mut risky, mut harmless) = (BTreeSet::new(), BTreeSet::new());
        for verb in self.verbs.phrases() {
            for intent in self.verbs.exact(verb).into_iter().flatten() {
                let heads = if intent.changes() { &mut risky } else { &mut harmless };
                heads.extend(verb.first().cloned());
            }
        }
        self.risky_verbs = &risky - &harmless;
        add_all(&mut self.manners, &file.manners);
        let file: QuestionFile = parse(include_str!("../../data/questions.toml"));
        for entry in file.questions {
            entry.starts.iter().for_each(|start| self.questions.insert(start, entry.kind));
        }
        self.question_shapes = file.shapes;
        let file: ChatFile = parse(include_str!("../../data/chat.toml"));
        for entry in file.chat {
            entry.words.iter().for_each(|words| self.chat.insert(words, entry.reply.clone()));
        }
        self.talk_replies = file.talk;
    }

    /// The shapes of questions as utterances that have them are read.
    fn normalise_shapes(&mut self) {
        let mut shapes = std::mem::take(&mut self.question_shapes);
        for shape in &mut shapes {
            let begins = self.as_read(shape.begins.phrases(), "");
            begins.iter().for_each(|begin| shape.begins.insert(begin, ()));
            // A word alone may be another part of speech as it is read: `switches`.
            let has = self.as_read(shape.has.phrases(), WITHIN);
            has.iter().filter(|words| words.contains(' ')).for_each(|words| shape.has.insert(words, ()));
            let ends: Vec<Vec<String>> = shape.ends.iter().map(|end| token::words(end)).collect();
            shape.ends.extend(self.as_read(ends.iter().map(Vec::as_slice), WITHIN));
        }
        self.question_shapes = shapes;
    }

    /// Phrases as they are read behind a word, without it, where that is otherwise than they are written. What would be taken for a slip
    /// stays as it is.
    fn as_read<'p>(&self, phrases: impl Iterator<Item = &'p [String]>, before: &str) -> Vec<String> {
        let read = |phrase: &[String]| {
            let (words, repairs) = self.normalise(&format!("{before} {}", phrase.join(" ")));
            let words = words.strip_prefix(token::words(before).as_slice())?;
            (repairs == 0 && words != phrase && !words.is_empty()).then(|| words.join(" "))
        };
        phrases.filter_map(read).collect()
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
            &self.nooks,
            &self.degrees,
            &self.viewpoints,
            &self.negation,
            &self.answer_lead,
            &self.generic,
            &self.goal_words,
            &self.text_words,
            &self.control_words,
            &self.hand_words,
            &self.motion_spare,
            &self.reports,
            &self.tells,
            &self.undone,
            &self.beforehand,
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
        self.room_kinds.words().for_each(&mut learn);
        self.small.words().for_each(&mut learn);
        self.verbs.words().for_each(&mut learn);
        self.questions.words().for_each(&mut learn);
        self.classes.words().for_each(&mut learn);
        self.brings_about.words().for_each(&mut learn);
        self.wishes.shooters.words().chain(&self.wishes.subjecters).chain(&self.wishes.infecters).for_each(&mut learn);
        self.wishes.asides.words().chain(self.wishes.to_dry.words()).chain(&self.wishes.movers).for_each(&mut learn);
        self.kinds.iter().for_each(&mut learn);
        self.talk.words().chain(self.people.words()).for_each(|word| vocabulary.learn_talk(word));
        self.chat.words().chain(&self.ifs.negations).for_each(|word| vocabulary.learn_plain(word));
        self.verb_heads
            .iter()
            .filter(|verb| !self.is_noun(verb))
            .for_each(|verb| vocabulary.learn_verb(verb, self.risky_verbs.contains(verb)));
        include_str!("../../data/verbs.txt").split_whitespace().for_each(|word| vocabulary.learn_ordinary(word));
        include_str!("../../data/common.txt").split_whitespace().for_each(|word| vocabulary.learn_plain(word));
        include_str!("../../data/ordinary.txt").split_whitespace().for_each(|word| vocabulary.learn_ordinary(word));
        self.known = Arc::new(vocabulary.words().cloned().collect());
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_of_questions_are_written_plainly_and_found_in_what_is_read() {
        let lexicon = Lexicon::new(&Catalog::builtin());
        let has = |words: &[String]| lexicon.question_shapes.iter().any(|shape| shape.begins.exact(words).is_some());
        let begins =
            ["what rooms are there", "list all the rooms", "is anything wrong with", "tell me everything you did"];
        for begin in begins {
            let (read, _) = lexicon.normalise(begin);
            assert!(has(&token::words(begin)) && has(&read), "{begin}: {read:?}");
        }
    }

    #[test]
    fn only_verbs_have_a_manner() {
        let lexicon = Lexicon::new(&Catalog::builtin());
        let strange: Vec<_> = lexicon.manners.phrases().filter(|verb| lexicon.verbs.exact(verb).is_none()).collect();
        assert!(strange.is_empty(), "{strange:?}");
    }
}
