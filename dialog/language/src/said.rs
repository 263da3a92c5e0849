//! What is known of an utterance, whatever it means: its words, what they name, what the parser makes of it.

use std::ops::Range;

use cohabit_cdf::{ClassId, RoomId};
use cohabit_parser::{
    Reading,
    request::{Relation, Request},
};

use crate::{
    clause::{self, Part},
    condition,
    context::Context,
    conversation::Conversation,
    open_goals::OpenGoal,
    parsed, question,
    table::PhraseTable,
    wording::Wording,
};

/// What is known of an utterance, whatever it means.
pub(crate) struct Said<'a> {
    pub(crate) wording: &'a Wording<'a>,
    pub(crate) readings: Vec<Reading>,
    pub(crate) is_plain: bool,
    pub(crate) is_partial: bool,
    pub(crate) is_guessed: bool,
    pub(crate) is_asked: bool,
    pub(crate) is_forbidden: bool,
    pub(crate) is_conditional: bool,
    pub(crate) is_pending: bool,
    /// How many words nobody ever met, of 3 at most.
    pub(crate) unheard: f32,
    /// Whether some of the words are none of the grammar's.
    pub(crate) has_unknown: bool,
    pub(crate) named: Vec<Named>,
    pub(crate) mentions: Vec<Mention>,
    /// How many words there are, of 20 at most.
    pub(crate) length: f32,
    /// How many requests the parser sees, and how likely one replaces what was asked before.
    pub(crate) requests: f32,
    pub(crate) instead: f32,
    /// How many requests the grammar sees.
    pub(crate) clauses: f32,
    pub(crate) goals: Vec<OpenGoal>,
}

/// What a name may mean.
#[derive(PartialEq)]
pub(crate) enum Named {
    Thing(Vec<ClassId>),
    Room(RoomId),
    Color(String),
}

/// A thing or a room that was named, in the words that were said: `the yellow mug`.
pub(crate) struct Mention {
    pub(crate) words: String,
    pub(crate) named: Named,
}

impl Conversation<'_> {
    pub(crate) fn said<'a>(&self, wording: &'a Wording<'a>, context: &Context) -> Said<'a> {
        let readings = self.readings(wording.utterance, context);
        let parts = clause::parts(self.lexicon, self.catalog, &wording.tidied);
        let all: f32 = readings.iter().map(|reading| reading.probability).sum::<f32>().max(f32::MIN_POSITIVE);
        let mean = |of: &dyn Fn(&Reading) -> f32| {
            readings.iter().map(|reading| reading.probability * of(reading)).sum::<f32>() / all
        };
        Said {
            wording,
            is_plain: self.is_plain(wording),
            is_partial: self.leaves_words_out(wording),
            is_guessed: self.takes_for_question(wording),
            is_asked: self.is_question(wording),
            is_forbidden: clause::forbid(&parts),
            is_conditional: condition::is_conditional(self.lexicon, &wording.words),
            is_pending: context.pending.is_some(),
            unheard: share(wording.unheard.len()),
            has_unknown: !clause::unknown_words(self.lexicon, &wording.words).is_empty(),
            length: wording.words.len().min(20) as f32 / 20.0,
            named: self.names_in(&wording.words).into_iter().fold(Vec::new(), |mut all, (_, name)| {
                if !all.contains(&name) {
                    all.push(name);
                }
                all
            }),
            mentions: self.mentions(&wording.words),
            requests: mean(&|reading| count(&reading.requests)),
            instead: mean(&|reading| f32::from(u8::from(replaces(&reading.requests)))),
            clauses: parts.iter().filter(|part| matches!(part, Part::Clause(_) | Part::Forbidden(_))).count().max(1)
                as f32,
            goals: self.goals_to_meet(),
            readings,
        }
    }

    /// Whether something is asked that is to be answered.
    pub(crate) fn is_question(&self, wording: &Wording<'_>) -> bool {
        wording.ends_as_question() || question::read(self.lexicon, &wording.tidied).is_some()
    }

    /// What the words name, and where.
    pub(crate) fn names_in(&self, words: &[String]) -> Vec<(Range<usize>, Named)> {
        let mut named = Vec::new();
        let mut at = 0;
        while at < words.len() {
            let rest = &words[at..];
            let is_in_scene = |class: &ClassId| self.scene.objects.iter().any(|object| object.class == *class);
            let (room, things) = (self.lexicon.rooms.longest(rest), self.lexicon.classes.longest(rest));
            let things = things.filter(|(length, _)| !self.is_verb(rest, *length));
            let length_of_room = room.map_or(0, |(length, _)| length);
            let length = things.as_ref().map_or(0, |(length, _)| *length);
            let color = self.lexicon.colors.exact(&rest[..1]).map(|color| Named::Color(color.clone()));
            let name = match (room, things) {
                (Some((_, room)), _) if length_of_room >= length => Some(Named::Room(*room)),
                (_, Some((_, namings))) => {
                    let mut classes: Vec<ClassId> = namings.iter().map(|one| one.class).collect();
                    // What has not been seen is meant where nothing that has been is called so.
                    if classes.iter().any(is_in_scene) {
                        classes.retain(is_in_scene);
                    }
                    Some(Named::Thing(classes))
                }
                _ => color,
            };
            let end = at + length.max(length_of_room).max(1);
            named.extend(name.filter(|_| !self.is_denied(&words[..at])).map(|name| (at..end, name)));
            at = end;
        }
        named
    }

    /// Whether the first word is rather what is to be done: `pop it in the microwave`.
    fn is_verb(&self, words: &[String], length: usize) -> bool {
        let is_object = |word: &[String]| {
            self.lexicon.pronouns.exact(word).is_some() || self.lexicon.articles.exact(word).is_some()
        };
        length == 1 && self.lexicon.verbs.exact(&words[..1]).is_some() && words.get(1..2).is_some_and(is_object)
    }

    /// Whether what is named after these words is said not to be meant: `no bread`, `not the milk`.
    fn is_denied(&self, before: &[String]) -> bool {
        let is = |table: &PhraseTable<()>, word: &String| table.exact(std::slice::from_ref(word)).is_some();
        let bare = before.iter().rposition(|word| !is(&self.lexicon.articles, word));
        bare.is_some_and(|at| is(&self.lexicon.denials, &before[at]))
    }

    /// The things and rooms that the words name, each with the color before it.
    fn mentions(&self, words: &[String]) -> Vec<Mention> {
        let mut mentions: Vec<Mention> = Vec::new();
        let mut color: Option<Range<usize>> = None;
        for (at, named) in self.names_in(words) {
            if matches!(named, Named::Color(_)) {
                color = Some(at);
                continue;
            }
            let start = color.take().filter(|color| color.end == at.start).map_or(at.start, |color| color.start);
            let said = words[start..at.end].join(" ");
            if mentions.iter().all(|mention| mention.named != named || mention.words != format!("the {said}")) {
                mentions.push(Mention { words: format!("the {said}"), named });
            }
        }
        mentions
    }
}

/// A count as a share of 3, which stands for many.
pub(crate) fn share(count: usize) -> f32 {
    count.min(3) as f32 / 3.0
}

pub(crate) fn count(requests: &[Request]) -> f32 {
    requests.iter().filter(|request| parsed::asks(request)).count() as f32
}

pub(crate) fn replaces(requests: &[Request]) -> bool {
    requests.iter().any(|request| request.relation == Relation::Instead)
}
