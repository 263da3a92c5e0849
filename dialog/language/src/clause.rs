//! Clauses: one verb with its objects, places, direction and amount.

use cohabit_cdf::{Catalog, Fluid};
use serde::{Deserialize, Serialize};

use crate::{
    chatter,
    intent::Intent,
    lexicon::{Direction, Lexicon, Preposition, Pronoun},
    phrase::{Phrase, Place, Reader},
    token, wish,
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

    /// The thing that was named last.
    fn last_phrase(&mut self) -> Option<&mut Phrase> {
        let place = self.places.iter_mut().rev().find_map(|(_, place)| match place {
            Place::Object(phrase) => Some(phrase),
            _ => None,
        });
        match self.intent {
            Intent::GoTo | Intent::Place | Intent::Bring => place.or(self.objects.last_mut()),
            _ => self.objects.last_mut().or(place),
        }
    }

    fn about(intent: Intent, verb: &str, phrase: Phrase) -> Self {
        Self { objects: vec![phrase], ..Self::new(intent, verb) }
    }

    fn new(intent: Intent, verb: &str) -> Self {
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
    /// Something that is not to be done.
    Forbidden,
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
    for segment in segments(lexicon, words) {
        read_segment(lexicon, catalog, segment, &mut parts);
    }
    parts
}

/// Whether the word at `at` is in a part of the utterance that is not to be done.
pub(crate) fn is_forbidden(lexicon: &Lexicon, words: &[String], at: usize) -> bool {
    let mut end = 0;
    segments(lexicon, words).into_iter().any(|segment| {
        let start =
            words[end..].windows(segment.len()).position(|window| window == segment).map_or(end, |skip| end + skip);
        end = start + segment.len();
        (start..end).contains(&at)
            && lexicon.negation.longest(&segment[leading(lexicon, segment).min(segment.len() - 1)..]).is_some()
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

/// Cuts at sentence ends, and at `and` or a comma before a verb.
pub(crate) fn segments<'a>(lexicon: &Lexicon, words: &'a [String]) -> Vec<&'a [String]> {
    let mut segments = Vec::new();
    let mut start = 0;
    for at in 0..words.len() {
        let is_end = token::ends_sentence(&words[at]) || words[at] == "then";
        let is_joint = matches!(words[at].as_str(), "," | "and" | "but" | "so") && {
            let mut reader = Reader::new(lexicon, words);
            reader.at = at + 1;
            reader.skip(|lexicon| &lexicon.lead);
            reader.at_verb()
                || lexicon.negation.longest(reader.rest()).is_some()
                || at > 0
                    && lexicon.numbers.longest(&words[at - 1..at]).is_none()
                    && implied_motion(lexicon, chatter::chunk(reader.rest())).is_some()
        };
        if is_end || is_joint {
            segments.push(&words[start..at]);
            start = at + 1;
        }
    }
    segments.push(&words[start..]);
    segments.retain(|segment| segment.iter().any(|word| !token::is_punctuation(word)));
    segments
}

fn read_segment(lexicon: &Lexicon, catalog: &Catalog, segment: &[String], parts: &mut Vec<Part>) {
    let mut rest = segment;
    while !rest.is_empty() {
        let skipped = leading(lexicon, rest);
        rest = &rest[skipped..];
        if rest.is_empty() {
            break;
        }
        let (part, used) = read_part(lexicon, catalog, rest, parts);
        parts.push(part);
        rest = &rest[used.clamp(1, rest.len())..];
    }
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
        // `cool the banana` is no `cool!`.
        let is_verb = verb > 0 && talk == verb && rest.get(talk).is_some_and(|word| !token::is_punctuation(word));
        let talk = if is_verb { 0 } else { talk };
        match lead.max(talk) {
            length @ 1.. if length >= verb && (talk > 0 || lexicon.negation.longest(rest).is_none()) => at += length,
            _ if is_joint => at += 1,
            _ => return at,
        }
    }
}

fn read_part(lexicon: &Lexicon, catalog: &Catalog, words: &[String], before: &[Part]) -> (Part, usize) {
    if lexicon.negation.longest(words).is_some() && lexicon.verbs.longest(words).is_none() {
        return (Part::Forbidden, words.len());
    }
    if let Some((request, used)) = wish::request(lexicon, words)
        && let Some((clause, _)) = read(lexicon, catalog, &request)
    {
        return (Part::Clause(clause), used);
    }
    if let Some((clause, used)) = with_tool_first(lexicon, catalog, words).or_else(|| read(lexicon, catalog, words)) {
        return (Part::Clause(clause), used);
    }
    if let Some((clause, used)) = implied_motion(lexicon, words) {
        return (Part::Clause(clause), used);
    }
    let mut reader = Reader::new(lexicon, words);
    if let Some(Part::Clause(previous)) = before.last()
        && takes_objects(previous.intent)
        && let Some((clause, used)) = read_as(lexicon, previous.intent, &previous.verb, words, 0)
            .filter(|(clause, _)| is_complete(clause, catalog) && !is_gloss(clause))
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
    if let Some((clause, used)) = gap(lexicon, catalog, words, before) {
        return (Part::Clause(clause), used);
    }
    chatter::read(lexicon, catalog, words)
}

/// `go to the office, the one with the desks`: says of what was named which one it is.
fn is_gloss(clause: &Clause) -> bool {
    let is_one = |place: &Place| matches!(place, Place::Object(phrase) if phrase.pronoun == Some(Pronoun::One));
    clause.intent == Intent::GoTo && clause.places.iter().any(|(_, place)| is_one(place))
}

/// `a hammer that I would like you to pick up`: what the verb at the end is about was said before.
fn gap(lexicon: &Lexicon, catalog: &Catalog, words: &[String], before: &[Part]) -> Option<(Clause, usize)> {
    let (length, _) = lexicon.verbs.longest(words)?;
    let is_last = words[length..].iter().all(|word| token::is_punctuation(word));
    if before.is_empty() || !is_last {
        return None;
    }
    let mut whole = words[..length].to_vec();
    whole.push("it".to_owned());
    read(lexicon, catalog, &whole).map(|(clause, _)| (clause, words.len()))
}

/// The words that are not in the vocabulary.
pub(crate) fn unknown_words(lexicon: &Lexicon, words: &[String]) -> Vec<String> {
    words.iter().filter(|word| !lexicon.vocabulary.has(word) && !token::is_punctuation(word)).cloned().collect()
}

/// `use the hammer to break the mug`, `with the hammer, break the mug`.
fn with_tool_first(lexicon: &Lexicon, catalog: &Catalog, words: &[String]) -> Option<(Clause, usize)> {
    if !matches!(words.first()?.as_str(), "use" | "using" | "with" | "take") {
        return None;
    }
    let mut reader = Reader::new(lexicon, words);
    reader.at = 1;
    let tool = reader.phrase_with_place()?;
    if !matches!(reader.rest().first()?.as_str(), "to" | "and" | ",") || words[0] == "take" && !reader.next_is("to") {
        return None;
    }
    reader.at += 1;
    reader.skip(|lexicon| &lexicon.lead);
    if !reader.at_verb() {
        return None;
    }
    let start = reader.at;
    let (mut clause, used) = read(lexicon, catalog, reader.rest())?;
    clause.places.push((Preposition::With, Place::Object(tool)));
    Some((clause, start + used))
}

/// The best reading of a clause that begins with a verb, and how many words it took.
pub(crate) fn read(lexicon: &Lexicon, catalog: &Catalog, words: &[String]) -> Option<(Clause, usize)> {
    let (longest, _) = lexicon.verbs.longest(words).unwrap_or((0, &Vec::new()));
    let fixed = (1..=longest).rev().flat_map(|length| {
        let intents = lexicon.verbs.exact(&words[..length]).map_or(&[][..], Vec::as_slice);
        intents.iter().map(move |intent| (length, *intent))
    });
    let mut readings: Vec<(Clause, usize)> = Vec::new();
    if longest < 2 {
        readings.extend(split_readings(lexicon, words));
    }
    for (length, intent) in fixed {
        readings.extend(read_as(lexicon, intent, &words[..length].join(" "), words, length));
    }
    readings.retain(|(clause, _)| is_complete(clause, catalog));
    let best = readings.iter().position(|(clause, _)| is_sensible(clause, catalog)).unwrap_or(0);
    readings.into_iter().nth(best)
}

/// Readings with the verb's last word after the object: `turn the sink on`.
fn split_readings(lexicon: &Lexicon, words: &[String]) -> Vec<(Clause, usize)> {
    let mut readings = Vec::new();
    for (head, particle, intent) in &lexicon.separable {
        if !words.starts_with(head) {
            continue;
        }
        let found = (head.len() + 1..words.len()).find(|at| {
            let after = &words[at + 1..];
            words[*at] == *particle
                && (after.is_empty()
                    || lexicon.prepositions.longest(after).is_some()
                    || lexicon.trail.longest(after).is_some()
                    || after.first().is_some_and(|word| token::is_punctuation(word)))
        });
        if let Some(at) = found {
            let mut joined = words.to_vec();
            joined.remove(at);
            let verb = format!("{} {particle}", head.join(" "));
            // The particle was taken out; it counts as used once the clause reaches beyond it.
            readings.extend(
                read_as(lexicon, *intent, &verb, &joined, head.len())
                    .map(|(clause, used)| (clause, if used >= at { used + 1 } else { used })),
            );
        }
    }
    readings
}

fn read_as(
    lexicon: &Lexicon,
    intent: Intent,
    verb: &str,
    words: &[String],
    verb_length: usize,
) -> Option<(Clause, usize)> {
    let mut clause = Clause::new(intent, verb);
    let mut reader = Reader::new(lexicon, words);
    reader.at = verb_length;
    match intent {
        Intent::GoTo => clause.places.push((Preposition::To, reader.destination()?)),
        Intent::Travel | Intent::Turn | Intent::Look => read_motion(&mut reader, &mut clause),
        _ => read_objects(&mut reader, &mut clause),
    }
    read_tail(&mut reader, &mut clause);
    Some((clause, reader.at))
}

fn read_motion(reader: &mut Reader<'_>, clause: &mut Clause) {
    loop {
        let mut degrees = *reader;
        if let Some(amount) = read_amount(&mut degrees) {
            *reader = degrees;
            clause.amount = Some(amount);
        } else if let Some((length, direction)) = reader.lexicon.directions.longest(reader.rest()) {
            reader.at += length;
            // `walk down the hallway` is no way down.
            if clause.intent == Intent::Travel && matches!(direction, Direction::Up | Direction::Down) {
                continue;
            }
            // `turn right around`: the last word wins only over nothing.
            clause.direction = Some(clause.direction.unwrap_or(*direction));
        } else if let Some(length) = a_bit(reader.rest()) {
            reader.at += length;
            clause.amount = clause.amount.or(Some(little(clause.intent)));
        } else if matches!(
            reader.rest().first().map(String::as_str),
            Some(
                "your"
                    | "head"
                    | "a"
                    | "for"
                    | "by"
                    | "of"
                    | "an"
                    | "about"
                    | "only"
                    | "just"
                    | "exactly"
                    | "approximately"
                    | "another"
                    | "once"
                    | "more"
                    | "further"
            )
        ) {
            reader.at += 1;
        } else {
            break;
        }
    }
    if clause.verb.starts_with("back") {
        clause.direction = clause.direction.or(Some(Direction::Backward));
    }
    // `go kitchen`: people leave out the preposition.
    if clause.direction.is_none() && matches!(clause.verb.as_str(), "go" | "walk" | "head" | "come" | "proceed" | "run")
    {
        let mut place = *reader;
        if let Some(destination) = place.destination() {
            *reader = place;
            clause.places.push((Preposition::To, destination));
        }
    }
}

/// `a bit`, `slightly`: how many words say so.
fn a_bit(words: &[String]) -> Option<usize> {
    let skipped = words
        .iter()
        .take_while(|word| matches!(word.as_str(), "a" | "just" | "very" | "tiny" | "little" | "small" | "wee"))
        .count();
    let is_bit = |word: &String| matches!(word.as_str(), "bit" | "tad" | "touch" | "smidge" | "slightly" | "fraction");
    match words.get(skipped) {
        Some(word) if is_bit(word) => {
            Some(skipped + 1 + usize::from(words.get(skipped + 1).is_some_and(|word| word == "more")))
        }
        _ if skipped > 1 && words[skipped - 1] == "little" => Some(skipped),
        _ => None,
    }
}

/// How far or how much a bit is.
const fn little(intent: Intent) -> Amount {
    match intent {
        Intent::Travel => Amount::Meters(0.5),
        Intent::Look => Amount::Degrees(15.0),
        _ => Amount::Degrees(30.0),
    }
}

fn read_amount(reader: &mut Reader<'_>) -> Option<Amount> {
    let mut after = *reader;
    // `a step`: one.
    if matches!(after.rest().first().map(String::as_str), Some("a" | "an"))
        && let Some((length, unit)) = after.rest().get(1..).and_then(|rest| after.lexicon.units.longest(rest))
    {
        reader.at += 1 + length;
        return Some(Amount::Meters(*unit));
    }
    let value = after.number()?;
    // `three more steps`
    let is_size = |word: &String| {
        matches!(word.as_str(), "more" | "big" | "small" | "little" | "further" | "additional" | "full" | "extra")
    };
    after.at += after.rest().iter().take_while(|word| is_size(word)).count();
    let (lexicon, rest) = (after.lexicon, after.rest());
    let amount = if let Some((length, ())) = lexicon.degrees.longest(rest) {
        after.at += length;
        Amount::Degrees(value)
    } else if let Some((length, unit)) = lexicon.units.longest(rest) {
        after.at += length;
        Amount::Meters(value * unit)
    } else if token::digits(&reader.words[reader.at]).is_some() || lexicon.directions.longest(rest).is_some() {
        Amount::Bare(value)
    } else {
        return None;
    };
    *reader = after;
    Some(amount)
}

fn read_objects(reader: &mut Reader<'_>, clause: &mut Clause) {
    if reader.next_is("me") || reader.next_is("us") {
        reader.at += 1;
    }
    loop {
        let mut next = *reader;
        if !clause.objects.is_empty() {
            if !next.next_is("and") && !next.next_is(",") {
                break;
            }
            while next.next_is("and") || next.next_is(",") {
                next.at += 1;
            }
            if next.at_verb() {
                break;
            }
        } else if next.at_long_verb() {
            break;
        }
        let Some(phrase) = next.phrase() else { break };
        clause.objects.push(phrase);
        *reader = next;
    }
}

fn read_tail(reader: &mut Reader<'_>, clause: &mut Clause) {
    while !reader.is_done() {
        if token::is_punctuation(&reader.words[reader.at]) || reader.next_is("and") {
            break;
        }
        if read_color(reader, clause) || read_fluid(reader, clause) {
            continue;
        }
        if let Some(place) = reader.place() {
            let is_with = place.0 == Preposition::With;
            clause.places.push(place);
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
        if let Some(phrase) = clause.last_phrase()
            && reader.after_noun(phrase)
        {
            continue;
        }
        if chatter::is_subordinator(&reader.words[reader.at]) {
            reader.at += chatter::chunk(reader.rest()).len();
            continue;
        }
        let word = &reader.words[reader.at];
        if !reader.lexicon.vocabulary.has(word) {
            clause.unknown.push(word.clone());
        }
        clause.has_stray_noun |= reader.lexicon.classes.longest(reader.rest()).is_some();
        reader.at += 1;
    }
}

/// `paint the bowl red`, `make it blue`, `change the bowl's color to green`.
fn read_color(reader: &mut Reader<'_>, clause: &mut Clause) -> bool {
    if clause.intent != Intent::Color {
        return false;
    }
    let mut after = *reader;
    while matches!(after.rest().first().map(String::as_str), Some("to" | "into" | "in" | "color" | "the" | "be")) {
        after.at += 1;
    }
    let Some((length, color)) = after.lexicon.colors.longest(after.rest()) else { return false };
    let noun = after.lexicon.classes.longest(after.rest()).map_or(0, |(length, _)| length);
    if noun > length {
        return false;
    }
    after.at += length;
    clause.color = Some(color.clone());
    *reader = after;
    true
}

/// `with water`, after `fill`.
fn read_fluid(reader: &mut Reader<'_>, clause: &mut Clause) -> bool {
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

/// `left`, `forward 2 meters`: motion without a verb.
fn implied_motion(lexicon: &Lexicon, words: &[String]) -> Option<(Clause, usize)> {
    let mut reader = Reader::new(lexicon, words);
    let _ = read_amount(&mut reader);
    let (_, direction) = lexicon.directions.longest(reader.rest())?;
    let intent = match direction {
        Direction::Forward | Direction::Backward => Intent::Travel,
        Direction::Left | Direction::Right | Direction::Around => Intent::Turn,
        Direction::Up | Direction::Down => Intent::Look,
    };
    let (mut clause, used) = read_as(lexicon, intent, intent.verb(), words, 0)?;
    clause.verb.clear();
    (clause.direction.is_some() && used == words.len() && clause.places.is_empty()).then_some((clause, used))
}

const fn takes_objects(intent: Intent) -> bool {
    !matches!(intent, Intent::Stop | Intent::Travel | Intent::Turn | Intent::Look | Intent::LookAround)
}

/// Whether a reading has what its verb needs.
fn is_complete(clause: &Clause, catalog: &Catalog) -> bool {
    let has_object = clause.objects.iter().any(|phrase| phrase.says_something() || !phrase.unknown.is_empty());
    let is_named = |id: &str| {
        let class = catalog.find(id);
        clause.places.iter().any(|(preposition, place)| {
            *preposition == Preposition::In
                && matches!(place, Place::Object(phrase) if class.is_some_and(|class| phrase.naming(class).is_some()))
        })
    };
    match clause.intent {
        Intent::Stop => !has_object,
        Intent::GoTo => !clause.places.is_empty(),
        Intent::Travel if clause.verb == "take" => {
            !clause.has_stray_noun && (clause.direction.is_some() || clause.amount.is_some())
        }
        Intent::Travel => {
            !clause.has_stray_noun
                && (clause.direction.is_some() || clause.amount.is_some() || !clause.places.is_empty())
        }
        Intent::Turn if clause.has_stray_noun => false,
        Intent::Turn => {
            // A bare `turn` leaves open which way.
            let is_bare = matches!(clause.verb.as_str(), "turn" | "rotate" | "spin" | "pivot" | "swivel")
                && clause.amount.is_none()
                && clause.places.is_empty()
                && clause.unknown.is_empty();
            is_bare || clause.direction.is_some() || matches!(clause.amount, Some(Amount::Degrees(_) | Amount::Bare(_)))
        }
        Intent::Look => clause.direction.is_some() && !clause.has_stray_noun,
        Intent::LookAround | Intent::Brew | Intent::Impossible => true,
        Intent::PickUp => has_object && !clause.places.iter().any(|(preposition, _)| *preposition == Preposition::To),
        Intent::Place => has_object || !clause.places.is_empty(),
        Intent::Drop => true,
        Intent::Color => has_object && clause.color.is_some(),
        Intent::Carrot => has_object && (is_named("Carrot_01") || clause.verb.starts_with("carrot")),
        _ => has_object,
    }
}

/// Whether something it names affords what the verb asks.
fn is_sensible(clause: &Clause, catalog: &Catalog) -> bool {
    let affordances = clause.intent.affordances();
    let Some(phrase) = clause.objects.first().filter(|phrase| !phrase.namings.is_empty()) else { return true };
    affordances.is_empty()
        || phrase.fluid.is_some()
        || phrase
            .namings
            .iter()
            .any(|naming| affordances.iter().any(|affordance| catalog.class(naming.class).has(*affordance)))
}

impl Reader<'_> {
    /// Whether a verb of several words begins here: surely no noun.
    fn at_long_verb(&self) -> bool {
        self.at_verb() && self.lexicon.verbs.longest(self.rest()).is_some_and(|(length, _)| length > 1)
    }
}

/// Whether the words forbid something.
pub(crate) fn is_negation(lexicon: &Lexicon, words: &[String]) -> bool {
    (0..words.len()).any(|at| lexicon.negation.longest(&words[at..]).is_some())
}
