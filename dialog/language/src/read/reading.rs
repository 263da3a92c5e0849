//! A clause from its words: the verb's readings, its objects, and how far and how much.

use cohabit_cdf::Catalog;

use crate::{
    read::{
        clause::{Amount, Clause},
        color,
        phrase::{Phrase, Place},
        reader::Reader,
        slot, tail,
    },
    words::{
        intent::Intent,
        lexicon::{Direction, Lexicon, Manner, Preposition, Pronoun},
        token,
    },
};

/// `left`, `forward 2 meters`: motion without a verb, and nothing besides.
pub(crate) fn motion(lexicon: &Lexicon, words: &[String]) -> Option<(Clause, usize)> {
    let mut reader = Reader::new(lexicon, words);
    if read_amount(&mut reader).is_none() {
        reader.at = a_bit(words).unwrap_or_default();
    }
    let (_, direction) = lexicon.directions.longest(reader.rest())?;
    let intent = match direction {
        Direction::Forward | Direction::Backward => Intent::Travel,
        Direction::Left | Direction::Right | Direction::Around => Intent::Turn,
        Direction::Up | Direction::Down => Intent::Look,
    };
    let (mut clause, used) = read_as(lexicon, intent, intent.verb(), words, 0)?;
    clause.verb.clear();
    let is_motion = clause.direction.is_some() && clause.places.is_empty() && is_whole(&clause);
    (is_motion && used == words.len()).then_some((clause, used))
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
    readings.retain(|(clause, _)| is_complete(clause, catalog) && is_said_of_it(lexicon, clause, catalog));
    // `hit it`: rather a button than to pieces.
    // `make the apple a carrot`: rather that than to print it.
    let is_last_resort = |clause: &Clause| match clause.intent {
        Intent::Break => is_unnamed(clause),
        Intent::Print => clause.has_stray_noun,
        _ => false,
    };
    readings.sort_by_key(|(clause, _)| is_last_resort(clause));
    let best = readings.iter().position(|(clause, _)| is_sensible(clause, catalog)).unwrap_or(0);
    readings.into_iter().nth(best)
}

/// Whether its verb is said of what is named: `draw the curtains`, and no picture.
fn is_said_of_it(lexicon: &Lexicon, clause: &Clause, catalog: &Catalog) -> bool {
    let kinds = lexicon.verbs_of_kinds.exact(&token::words(&clause.verb)).map_or(&[][..], Vec::as_slice);
    let Some((_, kind)) = kinds.iter().find(|(intent, _)| *intent == clause.intent) else { return true };
    let named = clause.objects.first().map_or(&[][..], |phrase| phrase.namings.as_slice());
    named.iter().any(|naming| catalog.table().is_of_kind(kind, &catalog.class(naming.class).id))
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

pub(crate) fn read_as(
    lexicon: &Lexicon,
    intent: Intent,
    verb: &str,
    words: &[String],
    verb_length: usize,
) -> Option<(Clause, usize)> {
    let mut clause = Clause::new(intent, verb);
    clause.manner = lexicon.manners.exact(&token::words(verb)).copied();
    let mut reader = Reader::new(lexicon, words);
    reader.at = verb_length;
    // `fill also the cup`, and not `fill also`.
    let besides = lexicon.fillers.besides.longest(reader.rest()).map_or(0, |(length, ())| length);
    if verb_length > 0 && reader.rest().get(besides).is_some_and(|next| !token::is_punctuation(next)) {
        reader.at += besides;
    }
    match intent {
        // `go back one meter`: no way to a thing of that name.
        Intent::GoTo if matches!(amount(lexicon, reader.rest()), Some(Amount::Meters(_))) => return None,
        Intent::GoTo => clause.places.push((Preposition::To, reader.destination()?)),
        Intent::Travel | Intent::Turn | Intent::Look => read_motion(&mut reader, &mut clause),
        // `look around the kitchen`
        Intent::LookAround if let Some(room) = reader.last_room() => clause.places.push((Preposition::In, room)),
        // `look in the kitchen` is no look into a thing.
        Intent::LookIn if reader.last_room().is_some() => return None,
        _ => read_objects(&mut reader, &mut clause),
    }
    tail::read_tail(&mut reader, &mut clause);
    color::take_late_color(lexicon, &mut clause);
    take_exceptions(&mut clause);
    // `a little closer to the table`
    if clause.amount == Some(little(intent)) && !clause.places.is_empty() {
        clause.amount = None;
    }
    Some((clause, reader.at))
}

/// `put all the fruit on the plate except the banana`: all the fruit but that.
fn take_exceptions(clause: &mut Clause) {
    let Some(all) = clause.objects.last_mut().filter(|phrase| phrase.is_all) else { return };
    for (_, place) in &mut clause.places {
        if let Place::Object(phrase) = place {
            all.not.append(&mut phrase.not);
        }
    }
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
        } else if let Some((length, ())) = reader.lexicon.motion_spare.longest(reader.rest()) {
            reader.at += length;
        } else {
            break;
        }
    }
    if clause.verb.starts_with("back") || clause.verb == "reverse" {
        clause.direction = clause.direction.or(Some(Direction::Backward));
    }
    // `go kitchen`: people leave out the preposition.
    if clause.direction.is_none() && matches!(clause.verb.as_str(), "go" | "walk" | "head" | "come" | "proceed" | "run")
    {
        let mut place = *reader;
        let is_named =
            |place: &Place| !matches!(place, Place::Object(phrase) if phrase.pronoun == Some(Pronoun::Thing));
        if let Some(destination) = place.destination().filter(is_named) {
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
pub(crate) const fn little(intent: Intent) -> Amount {
    match intent {
        Intent::Travel => Amount::Meters(0.5),
        Intent::Look => Amount::Degrees(15.0),
        _ => Amount::Degrees(30.0),
    }
}

/// How much the words say, at their start.
pub(crate) fn amount(lexicon: &Lexicon, words: &[String]) -> Option<Amount> {
    read_amount(&mut Reader::new(lexicon, words))
}

fn read_amount(reader: &mut Reader<'_>) -> Option<Amount> {
    let mut after = *reader;
    // `a step`: one.
    if matches!(after.rest().first().map(String::as_str), Some("a" | "an"))
        && let Some((length, unit)) = after.rest().get(1..).and_then(|rest| after.lexicon.units.longest(rest))
    {
        reader.at += 1 + length;
        // `a meter and a half`
        let has_half = reader.rest().iter().map(String::as_str).take(3).eq(["and", "a", "half"]);
        reader.at += if has_half { 3 } else { 0 };
        return Some(Amount::Meters(if has_half { unit * 1.5 } else { *unit }));
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
    } else if let Some((length, turn)) = lexicon.turns.longest(rest) {
        after.at += length;
        Amount::Degrees(value * turn)
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
    // `pour a bit into the bowl`
    let bit = a_bit(reader.rest()).unwrap_or_default();
    if reader.rest().get(bit..).is_some_and(|rest| reader.lexicon.prepositions.longest(rest).is_some()) {
        reader.at += bit;
    }
    loop {
        let mut next = *reader;
        if !clause.objects.is_empty() {
            let is_listed = next.lexicon.classes.longest(next.rest()).is_some() && !next.at_verb();
            if !next.next_is("and") && !next.next_is(",") && !is_listed {
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
        let phrase = if clause.intent == Intent::Swap { placed(&mut next) } else { next.phrase() };
        let Some(mut phrase) = phrase else { break };
        // `one of the apples, whichever is nearer`: which one that is.
        if reader.next_is(",")
            && let Some(said) =
                clause.objects.last_mut().filter(|said| phrase.is_one_of_kind() && tail::tells_more(said, &phrase))
        {
            *said = Phrase { namings: said.namings.clone(), pronoun: None, ..phrase };
            *reader = next;
            continue;
        }
        // `the red mug and the yellow one`
        if let Some(before) = clause.objects.last().filter(|_| phrase.is_one_of_kind()) {
            phrase.namings.clone_from(&before.namings);
        }
        clause.objects.push(phrase);
        *reader = next;
    }
}

/// `the mug on the desk`, of `swap the mug on the desk with the bowl`.
fn placed(reader: &mut Reader<'_>) -> Option<Phrase> {
    let mut phrase = reader.phrase()?;
    loop {
        let mut next = *reader;
        match next.place() {
            Some((Preposition::With | Preposition::For | Preposition::To, _)) | None => return Some(phrase),
            Some((preposition, place)) => {
                phrase.attach(preposition, place);
                *reader = next;
            }
        }
    }
}

fn is_unnamed(clause: &Clause) -> bool {
    clause.objects.first().is_some_and(|phrase| phrase.namings.is_empty() && phrase.instance.is_none())
}

/// Whether every word of it found its place.
pub(crate) fn is_whole(clause: &Clause) -> bool {
    clause.unknown.is_empty() && !clause.has_stray_noun
}

/// Whether a reading has what its verb needs.
pub(crate) fn is_complete(clause: &Clause, catalog: &Catalog) -> bool {
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
        Intent::Travel if matches!(clause.verb.as_str(), "take" | "make" | "do") => {
            let is_way = clause.verb == "take" && clause.direction.is_some();
            !clause.has_stray_noun && (is_way || clause.amount.is_some())
        }
        Intent::Travel if matches!(clause.verb.as_str(), "move" | "walk" | "step") && is_whole(clause) => true,
        Intent::Travel => {
            !clause.has_stray_noun
                && (clause.direction.is_some() && clause.unknown.is_empty()
                    || clause.amount.is_some()
                    || !clause.places.is_empty())
        }
        Intent::Turn if clause.has_stray_noun => false,
        Intent::Turn => {
            // A bare `turn` leaves open which way.
            let is_bare = matches!(clause.verb.as_str(), "turn" | "rotate" | "spin" | "pivot" | "swivel")
                && clause.amount.is_none()
                && clause.direction.is_none()
                && clause.places.is_empty()
                && clause.unknown.is_empty();
            let turns = |direction| !matches!(direction, Direction::Forward | Direction::Up | Direction::Down);
            is_bare
                || clause.direction.is_some_and(turns)
                || clause.direction.is_none() && matches!(clause.amount, Some(Amount::Degrees(_) | Amount::Bare(_)))
        }
        Intent::Look => (clause.direction.is_some() || clause.looked_over().is_some()) && is_whole(clause),
        Intent::LookAround | Intent::Brew | Intent::Tea | Intent::Impossible => true,
        Intent::PickUp => has_object && !clause.places.iter().any(|(preposition, _)| *preposition == Preposition::To),
        Intent::Place => has_object || !clause.places.is_empty(),
        Intent::Pour => has_object || !clause.places.is_empty(),
        Intent::Drop => true,
        Intent::Swap => slot::is_of_two(clause),
        Intent::Color => has_object && (clause.color.is_some() || clause.manner == Some(Manner::Color)),
        Intent::Carrot => has_object && (is_named("Carrot_01") || clause.verb.starts_with("carrot")),
        _ => has_object,
    }
}

/// Whether something it names affords what the verb asks.
fn is_sensible(clause: &Clause, catalog: &Catalog) -> bool {
    // `look at the floor` looks down.
    if clause.objects.iter().any(|phrase| phrase.is_floor) {
        return false;
    }
    let affordances = clause.intent.affordances();
    let Some(phrase) = clause.objects.first().filter(|phrase| !phrase.namings.is_empty()) else { return true };
    affordances.is_empty()
        || phrase.fluid.is_some()
        || phrase
            .namings
            .iter()
            .any(|naming| affordances.iter().any(|affordance| catalog.class(naming.class).has(*affordance)))
}
