//! What somebody says of what the robot asked about: a description, a place, a direction.

use cohabit_cdf::{Fluid, ObjectId, Property};

use crate::{
    context::{Context, Pending, search::Consent},
    ground::want::{Miss, Want},
    plan::Fault,
    read::{
        clause::{Clause, Part},
        hearing,
        phrase::{Phrase, Relation, RelationKind},
        reader::Reader,
        slot::{self, Role},
        tidy,
    },
    say::ask,
    talk::{asked::Open, conversation::Conversation},
    understanding::Understanding,
    words::{
        intent::Intent,
        lexicon::{Direction, Preposition, Pronoun, Side, Small},
    },
};

/// What is said of where somebody stands, and of what things are made: it tells nothing apart.
const ASIDES: &[&[&str]] = &[
    &["to", "your", "left"],
    &["to", "your", "right"],
    &["on", "your", "left"],
    &["on", "your", "right"],
    &["in", "front", "of", "you"],
    &["behind", "you"],
];
const ENDINGS: &[&[&str]] = &[&["it", "is", "made"], &["made", "of"], &["made", "from"], &["it", "is", "closest"]];

impl Conversation<'_> {
    /// What a question which one is meant was answered with.
    pub(crate) fn told_which(
        &self,
        words: &[String],
        is_yes: bool,
        is_command: bool,
        candidates: &[ObjectId],
        open: Open,
        context: &mut Context,
    ) -> Option<Understanding> {
        let small = self.small(words);
        let is = |kind| small.contains(&kind);
        let is_one = candidates.len() == 1;
        let rejects = is(Small::Neither) || is_one && (is(Small::No) || self.is_other(words));
        if rejects && !is_command {
            return Some(self.settle_without(open, candidates, context));
        }
        let is_any = is(Small::Any) || is(Small::Unsure) || is_yes && is_one;
        if let Some(first) = candidates.first().filter(|_| is_any) {
            return Some(self.settle(open, *first, context));
        }
        if self.is_all(words) {
            return Some(self.settle_all(open, candidates, context));
        }
        let mut left = self.answered(words, candidates, context);
        let points =
            self.answer_phrase(&tidy::plain(words)).is_some_and(|phrase| phrase.pronoun == Some(Pronoun::Thing));
        if left.is_empty() && points {
            left.extend(context.focus.recent.first().filter(|id| candidates.contains(id)));
        }
        if left.is_empty() && !is_command && !self.is_aside(words) {
            left.extend(self.told_at_last(words, candidates, context));
        }
        if left.is_empty() && !is_command && !self.is_aside(words) {
            let heard = hearing::variants(self.lexicon, words).into_iter();
            left = heard
                .map(|words| self.answered(&words, candidates, context))
                .find(|left| left.len() == 1)
                .unwrap_or_default();
        }
        match left.as_slice() {
            [one] => Some(self.settle(open, *one, context)),
            [] if is_command || self.is_aside(words) => None,
            [] if self.names_another(words) => self.told_another(words, candidates, open, context),
            left => {
                let candidates = if left.is_empty() { candidates } else { left };
                Some(self.ask_which(open, candidates.to_vec(), context))
            }
        }
    }

    /// Whether it says where something is, or what: `the purple one` alone is no help.
    fn names_another(&self, words: &[String]) -> bool {
        self.answer_phrase(&tidy::plain(words)).is_some_and(|told| says_where(&told) || !told.namings.is_empty())
    }

    /// None of those that were asked about was described: it is looked for.
    fn told_another(
        &self,
        words: &[String],
        candidates: &[ObjectId],
        mut open: Open,
        context: &mut Context,
    ) -> Option<Understanding> {
        let told = self.answer_phrase(&tidy::plain(words))?;
        describe_by(slot::phrase_mut(&mut open.clauses, open.slot)?, told);
        Some(self.settle_without(open, candidates, context))
    }

    fn ask_which(&self, open: Open, candidates: Vec<ObjectId>, context: &mut Context) -> Understanding {
        let Open { clauses, slot, consent } = open;
        let question = self.ask().which(slot::phrase(&clauses, slot), &candidates);
        context.pending = Some(Pending::Which { clauses, slot, candidates, consent });
        question
    }

    /// Where it is was said: it is found there, or looked for there.
    pub(crate) fn told_where(&self, words: &[String], mut open: Open, context: &mut Context) -> Option<Understanding> {
        let told = self.answer_phrase(&tidy::plain(words))?;
        if !says_where(&told) {
            // Another name for it.
            let ground = self.ground(&context.focus);
            let meant = ground.one(&told, &Want::place(Intent::Find, &[], None)).ok()?;
            return Some(self.settle(open, meant, context));
        }
        if let Some(vessel) = self.vessel_told(&told, &open, context) {
            return Some(self.settle(open, vessel, context));
        }
        let said = slot::phrase_mut(&mut open.clauses, open.slot)?;
        describe_by(said, told);
        let consent = Consent { is_agreed: true, ..open.consent };
        let mut planner = self.planner(context.focus.clone());
        planner.may_put_down = consent.may_put_down;
        match planner.run(&open.clauses) {
            Err(Fault::Miss { miss: Miss::Unseen, .. }) => {
                Some(self.look_for(open.clauses, open.slot, consent, context))
            }
            _ => Some(self.plan(open.clauses, consent, context)),
        }
    }

    /// The vessel that what is to be poured is said to be in: tea is no thing of its own there, and the pot is what is poured.
    fn vessel_told(&self, told: &Phrase, open: &Open, context: &Context) -> Option<ObjectId> {
        let is_poured = open.slot.role == Role::Object(0)
            && open.clauses.get(open.slot.clause).is_some_and(|clause| clause.intent == Intent::Pour);
        let inside = told.relations.iter().find(|relation| relation.kind == RelationKind::Inside)?;
        let want = Want::place(Intent::Use, &[Property::Fillable], None);
        let vessel = self.ground(&context.focus).one(&inside.to, &want).ok().filter(|_| is_poured)?;
        self.scene.object(vessel).is_some_and(|object| object.fluid != Fluid::None).then_some(vessel)
    }

    /// What it looks like was said: a thing that looks so is meant.
    pub(crate) fn told_look(&self, words: &[String], mut open: Open, context: &mut Context) -> Option<Understanding> {
        let told = self.answer_phrase(&tidy::plain(words))?;
        let said = slot::phrase_mut(&mut open.clauses, open.slot)?;
        said.unknown.clear();
        describe_by(said, told);
        Some(self.plan(open.clauses, open.consent, context))
    }

    /// Which way was said.
    pub(crate) fn turned(
        &self,
        words: &[String],
        mut clauses: Vec<Clause>,
        clause: usize,
        context: &mut Context,
    ) -> Option<Understanding> {
        // `a hundred and eighty degrees` are the same either way.
        let half = |amount: crate::read::clause::Amount| amount == crate::read::clause::Amount::Degrees(180.0);
        let amount = crate::read::reading::amount(self.lexicon, words);
        let direction = (0..words.len()).find_map(|at| self.direction(&words[at..]));
        let direction = direction.or(amount.filter(|amount| half(*amount)).map(|_| Direction::Around))?;
        let told =
            crate::read::parts::parts(self.lexicon, self.catalog, words).into_iter().find_map(|part| match part {
                Part::Clause(told) if told.intent == Intent::Turn => told.amount,
                _ => None,
            });
        let turn = clauses.get_mut(clause)?;
        (turn.direction, turn.amount) = (Some(direction), told.or(turn.amount));
        Some(self.plan(clauses, Consent { is_agreed: true, ..Consent::default() }, context))
    }

    fn direction(&self, words: &[String]) -> Option<Direction> {
        let turns = |direction: &Direction| {
            matches!(direction, Direction::Left | Direction::Right | Direction::Around | Direction::Backward)
        };
        if let Some((_, direction)) = self.lexicon.directions.longest(words).filter(|(_, direction)| turns(direction)) {
            return Some(*direction);
        }
        match self.lexicon.sides.longest(words)?.1 {
            Side::Left => Some(Direction::Left),
            Side::Right => Some(Direction::Right),
            Side::Behind => Some(Direction::Around),
            _ => None,
        }
    }

    /// Whether all of them are meant: `both`, `all of them please`.
    pub(crate) fn is_all(&self, words: &[String]) -> bool {
        let words = tidy::plain(words);
        let Some((length, ())) = self.lexicon.all.longest(&words) else { return false };
        let mut reader = Reader::new(self.lexicon, &words);
        reader.at = length;
        while matches!(
            reader.rest().first().map(String::as_str),
            Some("them" | "those" | "these" | "of" | "ones" | "one")
        ) {
            reader.at += 1;
        }
        reader.skip(|lexicon| &lexicon.trail);
        reader.is_done()
    }

    /// Whether the other one is asked for.
    fn is_other(&self, words: &[String]) -> bool {
        self.answer_phrase(&tidy::plain(words)).is_some_and(|phrase| phrase.side == Some(Side::Other))
    }

    /// The candidates that an answer leaves.
    pub(crate) fn answered(&self, words: &[String], candidates: &[ObjectId], context: &Context) -> Vec<ObjectId> {
        if let Some(number) = self.option(&tidy::plain(words)) {
            return candidates.get(number - 1).copied().into_iter().collect();
        }
        let Some(phrase) = self.answer_phrase(&tidy::plain(words)) else { return Vec::new() };
        if phrase.side == Some(Side::Other) {
            // Other than what was spoken of last; if none was, than what was named first.
            let last = context.focus.recent.iter().find(|id| candidates.contains(id)).or(candidates.first());
            return candidates.iter().filter(|id| Some(*id) != last).copied().collect();
        }
        // People count what was named.
        let named = if phrase.ordinal.is_some() { &candidates[..candidates.len().min(ask::ASKED)] } else { candidates };
        let ground = self.ground(&context.focus);
        let left = ground.narrow(&phrase, named);
        if left.len() < candidates.len() || phrase.pronoun.is_none() && candidates.len() == 1 {
            left
        } else {
            Vec::new()
        }
    }

    /// Of a long answer, the candidate that it comes to: the last one that is told from the others in it.
    fn told_at_last(&self, words: &[String], candidates: &[ObjectId], context: &Context) -> Option<ObjectId> {
        let ground = self.ground(&context.focus);
        let (mut told, mut at) = (None, 0);
        while at < words.len() {
            let mut reader = Reader::new(self.lexicon, words);
            reader.at = at;
            let is_denied = reader.next_is("not");
            reader.at += usize::from(is_denied);
            let Some(phrase) = reader.phrase().filter(|phrase| phrase.unknown.is_empty()) else {
                at += 1;
                continue;
            };
            at = reader.at;
            let others = || candidates.iter().copied().filter(|id| Some(*id) != told);
            let left: Vec<ObjectId> = if phrase.side == Some(Side::Other) {
                others().collect()
            } else {
                let meant = ground.narrow(&phrase, candidates);
                candidates.iter().copied().filter(|id| meant.contains(id) != is_denied).collect()
            };
            if let [one] = left[..] {
                told = Some(one);
            }
        }
        told
    }

    /// The phrase that an answer consists of, after `i mean` or `take`; `None` if there is more to it.
    pub(crate) fn answer_phrase(&self, words: &[String]) -> Option<Phrase> {
        let spelt = self.with_apostrophe(words);
        let words = spelt.as_deref().unwrap_or(words);
        self.phrase_of(words).or_else(|| self.phrase_of(&as_description(words)?))
    }

    /// `its in the teapot`, which has lost its apostrophe: `it is in the teapot`; nothing, where none is lost.
    fn with_apostrophe(&self, words: &[String]) -> Option<Vec<String>> {
        let (_, rest) = words.split_first().filter(|(its, _)| *its == "its")?;
        self.lexicon.prepositions.longest(rest)?;
        Some(["it", "is"].map(str::to_owned).into_iter().chain(rest.iter().cloned()).collect())
    }

    fn phrase_of(&self, words: &[String]) -> Option<Phrase> {
        let starts = 0..words.len().min(6);
        starts.into_iter().find_map(|start| {
            let is_lead = words[..start]
                .iter()
                .all(|word| self.lexicon.answer_lead.longest(std::slice::from_ref(word)).is_some());
            if !is_lead {
                return None;
            }
            let mut reader = Reader::new(self.lexicon, &words[start..]);
            let mut phrase = reader.phrase_with_place().unwrap_or_default();
            self.skip_and(&mut reader);
            while let Some((preposition, place)) = reader.place() {
                // `to the red one` belongs to `i am referring`.
                if preposition == Preposition::To {
                    return None;
                }
                phrase.attach(preposition, place);
                self.skip_and(&mut reader);
            }
            reader.skip(|lexicon| &lexicon.trail);
            // `it is in the break room`: the place is what is said.
            if phrase.pronoun.is_some_and(|pronoun| pronoun != crate::words::lexicon::Pronoun::One)
                && says_where(&phrase)
            {
                phrase.pronoun = None;
            }
            (reader.is_done() && phrase.says_something() && phrase.unknown.is_empty()).then_some(phrase)
        })
    }

    /// `red and in the kitchen`, `over there on the left`.
    fn skip_and(&self, reader: &mut Reader<'_>) {
        while reader.next_is("and") {
            reader.at += 1;
        }
    }
}

fn says_where(phrase: &Phrase) -> bool {
    phrase.room.is_some() || phrase.is_here || phrase.side.is_some() || !phrase.relations.is_empty()
}

/// Adds to what was said of an object what was said of it now.
fn describe_by(said: &mut Phrase, told: Phrase) {
    if said.namings.is_empty() && said.fluid.is_none() {
        if !told.namings.is_empty() {
            said.pronoun = told.pronoun;
        }
        (said.namings, said.fluid, said.text) = (told.namings, told.fluid, told.text);
    }
    said.color = told.color.or(said.color.take());
    said.room = told.room.or(said.room);
    said.side = told.side.or(said.side);
    said.ordinal = told.ordinal.or(said.ordinal);
    said.is_here |= told.is_here;
    said.states.extend(told.states);
    let is_new = |relation: &Relation| !said.relations.contains(relation);
    let new: Vec<Relation> = told.relations.into_iter().filter(is_new).collect();
    said.relations.extend(new);
}

/// `the desk is square and blue it is made of wood` → `square blue the desk`, `the mug is on the desk` → `the mug on the
/// desk`; `None` where nothing is said to be anything.
fn as_description(words: &[String]) -> Option<Vec<String>> {
    let starts =
        |rest: &[String], with: &&[&str]| rest.len() >= with.len() && with.iter().zip(rest).all(|(a, b)| a == b);
    let end = (1..words.len()).find(|at| ENDINGS.iter().any(|ending| starts(&words[*at..], ending)));
    let mut words = words[..end.unwrap_or(words.len())].to_vec();
    while let Some((at, aside)) = (0..words.len())
        .find_map(|at| ASIDES.iter().find(|aside| starts(&words[at..], aside)).map(|aside| (at, aside.len())))
    {
        words.drain(at..at + aside);
    }
    let verb = words.iter().position(|word| matches!(word.as_str(), "is" | "are"))?;
    let (thing, said) = (&words[..verb], &words[verb + 1..]);
    if said.is_empty() {
        return None;
    }
    let is_placed =
        matches!(said[0].as_str(), "in" | "on" | "at" | "next" | "near" | "under" | "inside" | "by" | "behind");
    let is_joint = |word: &&String| !matches!(word.as_str(), "and" | "of" | "a" | "an" | "the");
    Some(if is_placed {
        thing.iter().chain(said).cloned().collect()
    } else {
        let thing = thing.iter().filter(is_joint);
        said.iter().filter(is_joint).chain(thing).cloned().collect()
    })
}
