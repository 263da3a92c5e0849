//! Second thoughts: `no, I meant the freezer`, `on the counter, sorry`, `the other one too`. The last request again, with
//! what was said now in the place of what was said then.

use std::collections::BTreeSet;

use serde::Deserialize;

use crate::{
    clause::{self, Clause, Part},
    intent::Intent,
    lexicon::{Direction, Lexicon, Preposition, Pronoun, Side},
    phrase::{Phrase, Place, Reader},
    reading,
    table::PhraseTable,
    token,
};

/// The words of second thoughts: `data/amends.toml` says what each list is.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Amends {
    markers: BTreeSet<String>,
    around: BTreeSet<String>,
    goes: BTreeSet<String>,
    places: BTreeSet<String>,
    keepers: BTreeSet<String>,
    stands: BTreeSet<String>,
    slips: PhraseTable<()>,
    own: BTreeSet<String>,
    fillers: BTreeSet<String>,
    pub(crate) likes: BTreeSet<String>,
    pub(crate) hesitations: BTreeSet<String>,
    pub(crate) numbered: BTreeSet<String>,
    pub(crate) pauses: PhraseTable<()>,
    pub(crate) adverbs: BTreeSet<String>,
}

/// The last request as it is meant now, if the words amend it.
pub(crate) fn amended(lexicon: &Lexicon, words: &[String], parts: &[Part], request: &[Clause]) -> Option<Vec<Clause>> {
    // `both`, `all of them`
    if lexicon.all.longest(words).is_some_and(|(length, ())| {
        words[length..].iter().all(|word| is_around(lexicon, word) || word == "them" || token::is_punctuation(word))
    }) {
        let mut clause = request.iter().rfind(|clause| clause.intent != Intent::Mention)?.clone();
        clause.objects.last_mut().map(|phrase| {
            phrase.is_all = true;
            phrase.chosen = None;
        })?;
        return Some(vec![clause]);
    }
    let is_new = parts.iter().any(|part| matches!(part, Part::Clause(clause) if !clause.verb.is_empty()));
    // `the one with the hammer`, of what was gone to already.
    let is_one = |part: &Part| matches!(part, Part::Fragment(phrase) if phrase.pronoun == Some(Pronoun::One));
    let is_marked = words.iter().any(|word| lexicon.amends.markers.contains(word)) || parts.iter().any(is_one);
    if is_new || !is_marked || words.len() > LONGEST {
        return None;
    }
    let last = request.iter().rfind(|clause| clause.intent != Intent::Mention)?;
    let words = &without_denied(lexicon, words);
    let plain: Vec<String> = words.iter().filter(|word| !token::is_punctuation(word)).cloned().collect();
    let starts = (0..plain.len()).filter(|start| plain[..*start].iter().all(|word| is_around(lexicon, word)));
    let is_wrong = words.iter().any(|word| word == "wrong");
    starts.into_iter().find_map(|start| amend(lexicon, &plain[start..], last, is_wrong)).map(|clause| vec![clause])
}

/// `no, not the knife! the bowl!`: without what was not meant, if what was is said after it.
fn without_denied(lexicon: &Lexicon, words: &[String]) -> Vec<String> {
    let denied = (0..words.len()).filter(|at| words[*at] == "not").find_map(|at| {
        let mut reader = Reader::new(lexicon, words);
        reader.at = at + 1;
        let is_named = reader.phrase().is_some_and(|phrase| !phrase.namings.is_empty());
        let is_end = reader.rest().first().is_some_and(|word| token::is_punctuation(word));
        (is_named && is_end && reader.at + 1 < words.len()).then_some(at..reader.at)
    });
    denied.map_or_else(|| words.to_vec(), |denied| [&words[..denied.start], &words[denied.end..]].concat())
}

/// More words than this are no second thought.
const LONGEST: usize = 14;

fn is_around(lexicon: &Lexicon, word: &String) -> bool {
    let word = std::slice::from_ref(word);
    lexicon.amends.around.contains(&word[0]) || lexicon.talk.exact(word).is_some() || lexicon.lead.exact(word).is_some()
}

/// `last` with what the words say, if they say nothing else.
fn amend(lexicon: &Lexicon, words: &[String], last: &Clause, is_wrong: bool) -> Option<Clause> {
    let mut clause = last.clone();
    let mut reader = Reader::new(lexicon, words);
    if matches!(last.intent, Intent::TurnOn | Intent::TurnOff | Intent::Toggle)
        && let Some(intent) = switched(words, |word| is_around(lexicon, word))
    {
        let verb = intent.verb().to_owned();
        return Some(Clause { intent, verb, ..clause });
    }
    if matches!(last.intent, Intent::Turn | Intent::Travel | Intent::Look) {
        let (length, direction) = lexicon.directions.longest(words)?;
        reader.at = length;
        // A turn the wrong way is made good by turning round.
        let is_taken_back = last.intent == Intent::Turn && *direction == Direction::Around;
        (clause.direction, clause.amount) = (Some(*direction), last.amount.filter(|_| !is_taken_back));
    } else if let Some((length, color)) = lexicon.colors.longest(words).filter(|_| last.intent == Intent::Color) {
        reader.at = length;
        clause.color = Some(color.clone());
    } else if let Some((preposition, place)) = reader.place() {
        match clause.places.last_mut().filter(|_| !matches!(place, Place::Side(_))) {
            Some(slot) => *slot = (preposition, place),
            None if clause.intent == Intent::GoTo => return None,
            None => clause.objects.last_mut()?.attach(preposition, place),
        }
    } else {
        match reader.destination()? {
            Place::Object(mut phrase) => {
                // `the one that has the hammer`
                while let Some((preposition, place)) = reader.place() {
                    phrase.attach(preposition, place);
                }
                // `wrong mug`: the other one.
                if is_wrong && !phrase.is_described() && phrase.side.is_none() {
                    phrase = Phrase { side: Some(Side::Other), ..Phrase::default() };
                }
                replace(lexicon, &mut clause, phrase)?;
            }
            place => match clause.places.last_mut()? {
                (_, slot) if matches!(slot, Place::Room(_) | Place::Object(_) | Place::Viewpoint(..)) => *slot = place,
                _ => return None,
            },
        }
        // Where it is: `the banana on the table`.
        while let Some((preposition, place)) = reader.place() {
            clause.objects.last_mut()?.attach(preposition, place);
        }
    }
    let is_whole = reader.rest().iter().all(|word| is_around(lexicon, word));
    is_whole.then_some(clause)
}

/// `on`, `off again`: what is to become of what was switched.
pub(crate) fn switched(words: &[String], is_spare: impl Fn(&String) -> bool) -> Option<Intent> {
    let (first, rest) = words.split_first()?;
    let intent = match first.as_str() {
        "on" => Intent::TurnOn,
        "off" => Intent::TurnOff,
        _ => return None,
    };
    rest.iter().all(is_spare).then_some(intent)
}

/// Puts a phrase where the last one of its kind stood; an adjective alone says more of what was named then.
fn replace(lexicon: &Lexicon, clause: &mut Clause, phrase: Phrase) -> Option<()> {
    let is_vague = phrase.pronoun.is_some_and(|pronoun| pronoun != Pronoun::One);
    if is_vague || !phrase.unknown.is_empty() || !phrase.says_something() {
        return None;
    }
    let slot = match (clause.intent, clause.objects.as_mut_slice(), clause.places.as_mut_slice()) {
        (Intent::GoTo, _, [.., (_, Place::Object(slot))]) => slot,
        (Intent::GoTo, _, [.., (_, place)]) => {
            *place = Place::Object(phrase);
            return Some(());
        }
        // `and now the machine`, after something was picked up: not that too.
        (Intent::PickUp, [.., _], _) if is_fixed(lexicon, &phrase) => return None,
        (_, [.., slot], _) => slot,
        (_, [], [.., (preposition, Place::Object(slot))]) if *preposition != Preposition::With => slot,
        _ => return None,
    };
    if phrase.side == Some(Side::Other) && phrase.namings.is_empty() {
        let excluded = slot.chosen.into_iter().collect();
        *slot = Phrase { chosen: None, excluded, side: Some(Side::Other), states: Vec::new(), ..slot.clone() };
        slot.color = None;
    } else if phrase.namings.is_empty() && phrase.instance.is_none() && phrase.fluid.is_none() {
        let namings = std::mem::take(&mut slot.namings);
        *slot = Phrase { namings, pronoun: None, ..phrase };
    } else {
        *slot = phrase;
    }
    Some(())
}

/// Whether all that it may name stays where it is.
fn is_fixed(lexicon: &Lexicon, phrase: &Phrase) -> bool {
    !phrase.namings.is_empty() && phrase.namings.iter().all(|naming| !lexicon.carried.contains(&naming.class))
}

/// `go where the hammer is`: to the hammer.
pub(crate) fn without_where(lexicon: &Lexicon, words: Vec<String>) -> Vec<String> {
    let start = clause::leading(lexicon, &words);
    let goes = words.get(start).is_some_and(|word| lexicon.amends.goes.contains(word));
    let Some(at) = words.iter().position(|word| word == "where").filter(|at| goes && *at > start) else { return words };
    let end = words[at..]
        .iter()
        .position(|word| token::is_punctuation(word) || word == "and")
        .map_or(words.len(), |skip| at + skip);
    let is_spare = |word: &&String| !lexicon.amends.places.contains(*word);
    let head = words[..at].iter().rposition(|word| is_spare(&word)).map_or(0, |last| last + 1);
    let thing = &words[at + 1..end];
    let from = thing.iter().take_while(|word| lexicon.amends.keepers.contains(*word)).count();
    let to = thing.iter().rposition(|word| !lexicon.amends.stands.contains(word)).map_or(from, |last| last + 1);
    let is_thing = Reader { at: from, ..Reader::new(lexicon, thing) }.phrase().is_some_and(|phrase| !phrase.is_empty());
    if from >= to || !is_thing {
        return words;
    }
    let to_there = ["to".to_owned()];
    words[..head].iter().chain(&to_there).chain(&thing[from..to]).chain(&words[end..]).cloned().collect()
}

/// Most slips of one utterance that are made good.
const MOST_SLIPS: usize = 3;

/// `pick up the red, no, the yellow mug`: what was taken back in the same breath, left out.
pub(crate) fn without_slips(lexicon: &Lexicon, words: &[String]) -> Vec<String> {
    let mut words = words.to_vec();
    for _ in 0..MOST_SLIPS {
        let Some((before, after)) = slip(lexicon, &words) else { break };
        let (before, after) = (&words[..before], &words[after..]);
        match told_anew(lexicon, before, after).or_else(|| named_anew(lexicon, before, after)) {
            Some(meant) => words = meant,
            None => break,
        }
    }
    words
}

/// `open the fridge, no, scratch that, open the freezer`: the last request goes, unless the new one speaks of it.
fn told_anew(lexicon: &Lexicon, before: &[String], after: &[String]) -> Option<Vec<String>> {
    let at_request = |words: &[String], at: usize| {
        let mut reader = Reader::new(lexicon, words);
        reader.at = at;
        reader.skip(|lexicon| &lexicon.lead);
        reader.at_verb().then_some(reader.at)
    };
    let begun = at_request(after, 0)?;
    let stops = lexicon.verbs.longest(&after[begun..]).is_some_and(|(_, intents)| intents.contains(&Intent::Stop));
    let clause = crate::chatter::chunk(&after[begun..]);
    let speaks_of_it = clause.iter().any(|word| lexicon.pronouns.exact(std::slice::from_ref(word)).is_some());
    if stops || speaks_of_it {
        return None;
    }
    let begins = |at: &usize| {
        let is_joint = |word: &String| token::is_punctuation(word) || matches!(word.as_str(), "and" | "then");
        (*at == 0 || is_joint(&before[*at - 1])) && at_request(before, *at).is_some()
    };
    let start = (0..before.len()).rev().find(begins)?;
    Some(before[..start].iter().chain(after).cloned().collect())
}

/// `on the table, no, on the counter`: from the preposition on; `the red, no, the yellow`: from the phrase on.
fn named_anew(lexicon: &Lexicon, before: &[String], after: &[String]) -> Option<Vec<String>> {
    let has_verb = lexicon.verbs.longest(after).is_some();
    let spans = |kind: Said, at: usize| {
        let reader = Reader { at, ..Reader::new(lexicon, before) };
        kind.read(reader).is_some_and(|reader| reader.is_done()) && !reader.at_verb()
    };
    let kinds = if lexicon.prepositions.longest(after).is_some() { &[Said::Place][..] } else { &Said::NAMED };
    let kinds = kinds.iter().filter(|kind| kind.read(Reader::new(lexicon, after)).is_some());
    let at = kinds.filter_map(|kind| (0..before.len()).find(|at| spans(*kind, *at))).next().filter(|_| !has_verb)?;
    let mut words: Vec<String> = before[..at].iter().chain(after).cloned().collect();
    // `the red mug, I mean the yellow one`: a mug still.
    let noun = (at..before.len()).find(|at| lexicon.classes.exact(&before[*at..]).is_some());
    if let Some(noun) = noun
        && let Some(one) = words.iter().skip(at).position(|word| word == "one").map(|skip| at + skip)
    {
        words.splice(one..=one, before[noun..].iter().cloned());
    }
    Some(words)
}

/// What may be said anew.
#[derive(Clone, Copy)]
enum Said {
    Place,
    Thing,
    Room,
    Amount,
}

impl Said {
    const NAMED: [Self; 3] = [Self::Thing, Self::Room, Self::Amount];

    /// The reader behind it, if it stands there.
    fn read(self, mut reader: Reader<'_>) -> Option<Reader<'_>> {
        match self {
            Self::Place => drop(reader.place()?),
            Self::Thing => drop(reader.phrase()?),
            Self::Room => {
                reader.destination().filter(|place| matches!(place, Place::Room(_)))?;
            }
            Self::Amount => {
                reading::read_amount(&mut reader).map(drop).or_else(|| reader.number().map(drop))?;
            }
        }
        Some(reader)
    }
}

/// Where somebody takes back what was just said: where that ends, and where what is said instead begins.
fn slip(lexicon: &Lexicon, words: &[String]) -> Option<(usize, usize)> {
    let is_filler = |word: &String| word == "," || lexicon.amends.fillers.contains(word);
    let start = (1..words.len()).find(|at| {
        let before = &words[at - 1];
        let is_own = lexicon.amends.own.contains(&words[*at]);
        lexicon.amends.slips.longest(&words[*at..]).is_some() && (is_own || before == "." || is_filler(before))
    })?;
    let mut end = start;
    while end < words.len() {
        let rest = &words[end..];
        let length = lexicon.amends.slips.longest(rest).map_or(0, |(length, ())| length);
        match length.max(usize::from(is_filler(&rest[0]))).max(denied(lexicon, rest)) {
            0 => break,
            length => end += length,
        }
    }
    let is_spare = |word: &String| is_filler(word) || matches!(word.as_str(), "and" | "but" | "well");
    let cut = words[..start].iter().rposition(|word| !is_spare(word)).map_or(0, |at| at + 1);
    (end < words.len() && cut > 0).then_some((cut, end))
}

/// `not that`, `not the knife,`: how many words say what was not meant, before what was.
fn denied(lexicon: &Lexicon, words: &[String]) -> usize {
    if words[0] != "not" {
        return usize::from(words[0] == "that" && words.get(1).is_some_and(|next| token::is_punctuation(next)));
    }
    let mut reader = Reader::new(lexicon, words);
    reader.at = 1;
    let is_named = reader.phrase().is_some() && (reader.next_is(",") || reader.next_is("but"));
    if is_named { reader.at + 1 } else { 1 }
}
