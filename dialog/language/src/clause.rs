//! Clauses: one verb with its objects, places, direction and amount.

use std::ops::Range;

use cohabit_cdf::{Catalog, Fluid, Property};
use serde::{Deserialize, Serialize};

use crate::{
    chatter,
    intent::Intent,
    lexicon::{Direction, Lexicon, Manner, Preposition, Pronoun},
    phrase::{Phrase, Place, Reader},
    reading, token, wish,
};

/// One request.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct Clause {
    pub(crate) intent: Intent,
    pub(crate) objects: Vec<Phrase>,
    pub(crate) places: Vec<(Preposition, Place)>,
    pub(crate) direction: Option<Direction>,
    pub(crate) amount: Option<Amount>,
    pub(crate) color: Option<String>,
    pub(crate) fluid: Option<Fluid>,
    /// Words that mean nothing to the robot.
    pub(crate) unknown: Vec<String>,
    /// Whether it has a noun that found no place in it.
    pub(crate) has_stray_noun: bool,
    /// The verb as it was said.
    pub(crate) verb: String,
    #[serde(default)]
    pub(crate) manner: Option<Manner>,
    /// Whether it says by what means the request before it is to be carried out.
    #[serde(default)]
    pub(crate) is_means: bool,
    /// Whether it was wished for rather than asked for.
    #[serde(default)]
    pub(crate) is_wish: bool,
}

impl Clause {
    /// The request to find an object.
    pub(crate) fn find(phrase: Phrase) -> Self {
        Self::about(Intent::Find, "find", phrase)
    }

    /// No request, but what is spoken of from here on.
    pub(crate) fn mention(phrase: Phrase) -> Self {
        Self::about(Intent::Mention, "", phrase)
    }

    fn names_any(&self) -> bool {
        !self.objects.is_empty() || !self.places.is_empty()
    }

    /// The thing that was named last.
    pub(crate) fn last_phrase(&mut self) -> Option<&mut Phrase> {
        let place = self.places.iter_mut().rev().find_map(|(_, place)| match place {
            Place::Object(phrase) => Some(phrase),
            _ => None,
        });
        match self.intent {
            Intent::GoTo | Intent::Place | Intent::Bring => place.or(self.objects.last_mut()),
            _ => self.objects.last_mut().or(place),
        }
    }

    pub(crate) fn about(intent: Intent, verb: &str, phrase: Phrase) -> Self {
        Self { objects: vec![phrase], ..Self::new(intent, verb) }
    }

    pub(crate) fn new(intent: Intent, verb: &str) -> Self {
        Self {
            intent,
            objects: Vec::new(),
            places: Vec::new(),
            direction: None,
            amount: None,
            color: None,
            fluid: None,
            unknown: Vec::new(),
            has_stray_noun: false,
            verb: verb.to_owned(),
            manner: None,
            is_means: false,
            is_wish: false,
        }
    }
}

/// How far, or how much.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) enum Amount {
    Meters(f32),
    Degrees(f32),
    Bare(f32),
}

/// What a part of an utterance turned out to be.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Part {
    Clause(Clause),
    /// Something that is not to be done, and what it is about.
    Forbidden(Option<Phrase>),
    /// An object without a verb.
    Fragment(Phrase),
    /// Something spoken of in passing.
    Mention(Phrase),
    /// Talk that asks for nothing; the words it does not know.
    Aside(Vec<String>),
    /// What is asked for, but not understood; the words it does not know.
    Unclear(Vec<String>),
}

/// The parts of an utterance, in order.
pub(crate) fn parts(lexicon: &Lexicon, catalog: &Catalog, words: &[String]) -> Vec<Part> {
    let mut parts = Vec::new();
    for cut in cuts(lexicon, words) {
        let before = parts.len();
        let is_consequence = cut.start > 0 && words[cut.start - 1] == "so" || words[cut.start] == "so";
        read_segment(lexicon, catalog, &words[cut], &mut parts);
        let asks = |part: &Part| matches!(part, Part::Clause(clause) if !clause.is_wish);
        if is_consequence && parts[before..].iter().any(asks) {
            parts[..before].iter_mut().for_each(demote);
        }
    }
    parts
}

/// `i could use a coffee, so take the mug`: what was wished for is the reason.
fn demote(part: &mut Part) {
    if let Part::Clause(clause) = part
        && clause.is_wish
    {
        let phrase = clause.objects.first().cloned();
        *part = phrase.map_or_else(|| Part::Aside(Vec::new()), Part::Mention);
    }
}

/// The request to put a thing where it is said to be.
pub(crate) fn placing(mut phrase: Phrase) -> Option<Clause> {
    let place = phrase.relations.pop()?.to;
    Some(Clause {
        places: vec![(Preposition::In, Place::Object(place))],
        ..Clause::about(Intent::Place, "put", phrase)
    })
}

/// Whether the word at `at` is in a part of the utterance that is not to be done.
pub(crate) fn is_forbidden(lexicon: &Lexicon, words: &[String], at: usize) -> bool {
    cuts(lexicon, words).into_iter().filter(|cut| cut.contains(&at)).any(|cut| {
        let segment = &words[cut];
        lexicon.negation.longest(&segment[leading(lexicon, segment).min(segment.len() - 1)..]).is_some()
    })
}

/// `main office`: whoever names a room wants the robot there.
pub(crate) fn to_room(lexicon: &Lexicon, words: &[String]) -> Option<Clause> {
    let mut reader = Reader::new(lexicon, words);
    reader.at = leading(lexicon, words);
    reader.skip(|lexicon| &lexicon.articles);
    let place = reader.destination().filter(|place| matches!(place, Place::Room(_)))?;
    reader.skip(|lexicon| &lexicon.trail);
    let is_whole = reader.rest().iter().all(|word| token::is_punctuation(word));
    let clause = Clause::about(Intent::GoTo, "go to", Phrase::default());
    is_whole.then(|| Clause { objects: Vec::new(), places: vec![(Preposition::To, place)], ..clause })
}

/// `pick up the mug and the bowl and put them on the desk` is one errand: each is carried there in its turn.
pub(crate) fn joined(clauses: Vec<Clause>) -> Vec<Clause> {
    let mut joined: Vec<Clause> = Vec::with_capacity(clauses.len());
    for mut clause in clauses {
        let says_them = |phrase: &Phrase| phrase.pronoun == Some(Pronoun::Things);
        let is_errand = matches!(clause.intent, Intent::Place | Intent::Bring) && clause.objects.iter().all(says_them);
        let gathers = |before: &mut Clause| before.intent == Intent::PickUp && before.objects.len() > 1;
        if is_errand && let Some(before) = joined.pop_if(gathers) {
            clause.objects = before.objects;
        }
        // `put it, put it there`
        let is_begun = |before: &mut Clause| {
            before.intent == clause.intent
                && before.objects == clause.objects
                && before.places.is_empty()
                && !clause.places.is_empty()
                && !clause.objects.is_empty()
        };
        joined.pop_if(is_begun);
        // `left, turn left!` is one turn.
        let is_same = |before: &mut Clause| {
            before.verb.is_empty() && before.intent == clause.intent && before.direction == clause.direction
        };
        if clause.intent == Intent::Turn {
            joined.pop_if(is_same);
        }
        joined.push(clause);
    }
    joined
}

/// `fill the bowl with cereal`: what can be carried is poured into it.
pub(crate) fn poured(catalog: &Catalog, mut clause: Clause) -> Clause {
    let is_carried =
        |phrase: &Phrase| phrase.namings.iter().any(|naming| catalog.class(naming.class).has(Property::Pickupable));
    if clause.intent == Intent::Fill
        && let [filled] = clause.objects.as_slice()
        && let [(Preposition::With, Place::Object(what))] = clause.places.as_slice()
        && is_carried(what)
    {
        let (filled, what) = (filled.clone(), what.clone());
        clause.intent = Intent::Pour;
        clause.objects = vec![what];
        clause.places = vec![(Preposition::In, Place::Object(filled))];
    }
    clause
}

/// The words between cuts.
pub(crate) fn segments<'a>(lexicon: &Lexicon, words: &'a [String]) -> Vec<&'a [String]> {
    cuts(lexicon, words).into_iter().map(|cut| &words[cut]).collect()
}

/// Cuts at sentence ends, and at `and` or a comma before a verb.
fn cuts(lexicon: &Lexicon, words: &[String]) -> Vec<Range<usize>> {
    let mut cuts = Vec::new();
    let mut start = 0;
    for at in 0..words.len() {
        let is_end = token::ends_sentence(&words[at]) || words[at] == "then";
        let is_joint = matches!(words[at].as_str(), "," | "and" | "but" | "so")
            && !ends_courtesy(lexicon, &words[start..=at])
            && {
                let mut reader = Reader::new(lexicon, words);
                reader.at = at + 1;
                let forbids = lexicon.negation.longest(reader.rest()).is_some();
                reader.skip(|lexicon| &lexicon.lead);
                forbids || reader.at_verb() || lexicon.negation.longest(reader.rest()).is_some()
            };
        if is_end || is_joint {
            cuts.push(start..at);
            start = at + 1;
        }
    }
    cuts.push(start..words.len());
    cuts.retain(|cut| words[cut.clone()].iter().any(|word| !token::is_punctuation(word)));
    cuts
}

/// `go ahead and`, `be so kind and`: no joint between two requests.
fn ends_courtesy(lexicon: &Lexicon, words: &[String]) -> bool {
    let is_one = |start: usize| {
        let said = &words[start..];
        lexicon.lead.exact(said).is_some() || lexicon.talk.exact(said).is_some()
    };
    words.len() > 1 && (words.len().saturating_sub(LONGEST_COURTESY)..words.len() - 1).any(is_one)
}

/// Most words of a courtesy that ends in `and`.
const LONGEST_COURTESY: usize = 6;

fn read_segment(lexicon: &Lexicon, catalog: &Catalog, segment: &[String], parts: &mut Vec<Part>) {
    let mut rest = segment;
    while !rest.is_empty() {
        let skipped = leading(lexicon, rest);
        rest = &rest[skipped..];
        if rest.is_empty() {
            break;
        }
        if let Some(used) = read_wish(lexicon, catalog, rest, parts) {
            rest = &rest[used..];
            continue;
        }
        let start = segment.len() - rest.len();
        let is_means = start > 0 && segment[start - 1] == "by";
        let (mut part, used) = read_part(lexicon, catalog, rest, parts);
        if let Part::Clause(clause) = &mut part {
            clause.is_means = is_means && matches!(parts.last(), Some(Part::Clause(_)));
        }
        parts.push(part);
        rest = &rest[used.clamp(1, rest.len())..];
    }
}

/// What is wished for, and how many words say so.
fn read_wish(lexicon: &Lexicon, catalog: &Catalog, words: &[String], parts: &mut Vec<Part>) -> Option<usize> {
    let (request, used) = wish::request(lexicon, words)?;
    let (clause, read) = reading::read(lexicon, catalog, &request)?;
    parts.push(Part::Clause(Clause { is_wish: true, ..clause }));
    // `I want the apple on the plate and the banana in the fridge`
    let rest = &request[read..];
    if rest.first().is_some_and(|word| word == "and") {
        read_segment(lexicon, catalog, &rest[1..], parts);
    }
    Some(used)
}

/// How many words at the start mean nothing: politeness, `and`, commas.
pub(crate) fn leading(lexicon: &Lexicon, words: &[String]) -> usize {
    let mut at = 0;
    loop {
        let rest = &words[at..];
        let is_joint = rest.first().is_some_and(|word| token::is_punctuation(word));
        let verb = lexicon.verbs.longest(rest).map_or(0, |(length, _)| length);
        let lead = lexicon.lead.longest(rest).map_or(0, |(length, ())| length);
        let talk = lexicon.talk.longest(rest).map_or(0, |(length, ())| length);
        // `cool the banana` is no `cool!`, nor `move it to the table` a `move it!`.
        let is_verb = verb > 0
            && rest.get(talk).is_some_and(|word| !token::is_punctuation(word))
            && (talk == verb || talk > verb && lexicon.prepositions.longest(&rest[talk..]).is_some());
        let talk = if is_verb { 0 } else { talk };
        match lead.max(talk) {
            length @ 1.. if length >= verb && (talk > 0 || lexicon.negation.longest(rest).is_none()) => at += length,
            _ if is_joint || verb == 1 && goes_to_do(lexicon, rest) => at += 1,
            _ => return at,
        }
    }
}

/// `go fill the mug`: one who goes to do something does it.
fn goes_to_do(lexicon: &Lexicon, words: &[String]) -> bool {
    let does = |rest: &[String]| {
        let is_way = lexicon.directions.longest(rest).is_some() || lexicon.prepositions.longest(rest).is_some();
        !is_way && Reader::new(lexicon, rest).at_verb()
    };
    matches!(words[0].as_str(), "go" | "come") && does(&words[1..])
}

fn read_part(lexicon: &Lexicon, catalog: &Catalog, words: &[String], before: &[Part]) -> (Part, usize) {
    let length = |found: Option<usize>| found.unwrap_or(0);
    if length(lexicon.negation.longest(words).map(|(length, ())| length))
        > length(lexicon.verbs.longest(words).map(|(length, _)| length))
    {
        let chunk = chatter::chunk(words);
        return (Part::Forbidden(chatter::mention(lexicon, chunk).map(|(phrase, _)| phrase)), chunk.len());
    }
    if let Some((clause, used)) = reading::read(lexicon, catalog, words) {
        return (Part::Clause(clause), used);
    }
    let mut reader = Reader::new(lexicon, words);
    if let Some(Part::Clause(previous)) = before.last()
        && reading::takes_objects(previous.intent)
        && !tells_of_it(lexicon, words)
        && let Some((clause, used)) = reading::read_as(lexicon, previous.intent, &previous.verb, words, 0)
            .filter(|(clause, _)| reading::is_complete(clause, catalog) && clause.names_any())
    {
        return (Part::Clause(clause), used);
    }
    if let Some(phrase) = reader.phrase_with_place().filter(|phrase| !phrase.is_empty() && phrase.unknown.is_empty()) {
        reader.skip(|lexicon| &lexicon.trail);
        let is_whole = reader.rest().first().is_none_or(|word| token::is_punctuation(word));
        if is_whole {
            return (Part::Fragment(phrase), reader.at);
        }
    }
    chatter::read(lexicon, catalog, words)
}

/// `shut the fridge, it lets the cold out`: says something of it, and asks for nothing.
fn tells_of_it(lexicon: &Lexicon, words: &[String]) -> bool {
    let is_subject = matches!(words[0].as_str(), "it" | "they" | "he" | "she" | "i" | "we");
    is_subject
        && words.get(1).is_some_and(|next| !token::is_punctuation(next) && lexicon.trail.longest(&words[1..]).is_none())
        && lexicon.prepositions.longest(&words[1..]).is_none()
}

/// The words that are not in the vocabulary.
pub(crate) fn unknown_words(lexicon: &Lexicon, words: &[String]) -> Vec<String> {
    let is_unknown =
        |word: &&String| !lexicon.vocabulary.has(word) && !token::is_punctuation(word) && token::digits(word).is_none();
    words.iter().filter(is_unknown).cloned().collect()
}
