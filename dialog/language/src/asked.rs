//! What people say to a question of the robot's: yes and no, a description, a place, a click, or something else.

use cohabit_cdf::ObjectId;

use crate::{
    ask, chatter,
    clause::{self, Clause, Part},
    context::{Consent, Context, Pending, Role, Slot},
    conversation::Conversation,
    ground::{Ground, Miss, Want},
    hearing,
    intent::Intent,
    lexicon::{Direction, Preposition, Pronoun, Side, Small},
    phrase::{Phrase, Place, Reader, Relation},
    plan::Fault,
    question::{self, QuestionKind},
    reply, room_kind, token,
    understanding::Understanding,
};

/// What it says that is to do none of what it asked about.
const LEAVES: &str = "All right, I leave it.";

/// A request that waits for what one of its phrases means.
pub(crate) struct Open {
    pub(crate) clauses: Vec<Clause>,
    pub(crate) slot: Slot,
    pub(crate) consent: Consent,
}

impl Conversation<'_> {
    /// What was said, as an answer to the robot's own question; `None` if it is something else.
    pub(crate) fn answer_to_pending(
        &self,
        words: &[String],
        parts: &[Part],
        context: &mut Context,
    ) -> Option<Understanding> {
        if context.pending.is_some()
            && let Some((yes, more)) = self.yes_and_more(words)
        {
            let understanding = self.answer_to_pending(yes, &[], context)?;
            let later = context.later.iter().cloned().chain([token::sentence(more)]).collect();
            return Some(context.keep(later, understanding));
        }
        let pending = context.pending.take()?;
        let small = self.small(words);
        let is = |kind| small.contains(&kind);
        // `into the bowl` says where, whatever it would be by itself.
        let is_place = self.lexicon.prepositions.longest(words).is_some();
        let is_command = (small.is_empty() || is(Small::Search))
            && !is_place
            && parts.iter().any(|part| matches!(part, Part::Clause(_)));
        let is_yes = self.small_at_start(words, Small::Yes) && !is_command;
        let leaves = is(Small::No) || is(Small::Neither) && !matches!(pending, Pending::Which { .. });
        if leaves && !is_command && !matches!(&pending, Pending::Which { candidates, .. } if candidates.len() == 1) {
            return Some(Understanding::answer(LEAVES));
        }
        match pending {
            Pending::PutDown { clauses } if is_yes || self.agrees_to_put_down(words, parts) => {
                let consent = Consent { may_put_down: true, is_agreed: true };
                Some(self.plan(clauses, consent, context))
            }
            Pending::Offer { mut plans } => {
                let names: Vec<String> = plans.iter().map(|steps| reply::plan_in_words(steps)).collect();
                let at = self.chosen_plan(words, is_yes || is(Small::Any), is_command, &names)?;
                Some(self.go(plans.swap_remove(at), context))
            }
            Pending::Guess { mut guesses } => {
                let names: Vec<String> = guesses.iter().map(|guess| guess.name.clone()).collect();
                let at = self.chosen_plan(words, is_yes || is(Small::Any), is_command, &names)?;
                Some(self.go_as_guessed(guesses.swap_remove(at), context))
            }
            Pending::Search { clauses } if is_yes || is(Small::Search) => {
                Some(self.plan(clauses, Consent::default(), context))
            }
            Pending::PutDown { .. } | Pending::Search { .. } | Pending::Lab { .. } => None,
            Pending::Direction { clauses, clause } => self.turned(words, clauses, clause, context),
            Pending::Where { clauses, slot, consent } if is_yes || is(Small::Unsure) || is(Small::Search) => {
                Some(self.look_for(clauses, slot, consent, context))
            }
            Pending::Where { clauses, slot, consent } => {
                let open = Open { clauses, slot, consent };
                if is_command { None } else { self.told_where(words, open, context) }
            }
            Pending::Look { .. } if is(Small::Unsure) => {
                Some(Understanding::answer("All right. Tell me another name for it, or what else to do."))
            }
            Pending::Look { clauses, slot, consent } => {
                let open = Open { clauses, slot, consent };
                // `into the bowl` names the place that was asked for.
                let preposition = self.lexicon.prepositions.longest(words).map_or(0, |(length, _)| length);
                let named = if matches!(slot.role, Role::Place(_)) { &words[preposition..] } else { words };
                if is_command { None } else { self.told_look(named, open, context) }
            }
            Pending::Which { clauses, slot, candidates, consent } => {
                let open = Open { clauses, slot, consent };
                self.told_which(words, is_yes, is_command, &candidates, open, context)
            }
        }
    }

    /// Whether it is an answer to the robot's own question.
    pub(crate) fn answers(&self, words: &[String], context: &Context) -> bool {
        let open = context.pending.as_ref();
        let parts = || clause::parts(self.lexicon, self.catalog, words);
        open.is_some()
            && (self.answer_to_pending(words, &parts(), &mut context.clone()).is_some()
                || self.answered_first(words, open, &mut context.clone()).is_some())
    }

    /// What is to be done if an answer comes first, and then remarks, or what else is to be done: `the robot one, like I said`.
    pub(crate) fn answered_first(
        &self,
        words: &[String],
        pending: Option<&Pending>,
        context: &mut Context,
    ) -> Option<Understanding> {
        let end = words.iter().position(|word| token::is_punctuation(word)).filter(|end| *end > 0)?;
        let (first, rest) = words.split_at(end);
        let mut then = Context { pending: pending.cloned(), later: Vec::new(), ..context.clone() };
        let understanding = match pending? {
            Pending::Lab { words: before, at } => {
                let kind = room_kind::standing_at(self.lexicon, self.scene, before, *at)?;
                let room = kind.answered(self.lexicon, self.scene, first)?;
                then.pending = None;
                self.understand_words(kind.named(before, room, self.catalog), &mut then)
            }
            _ => self.answer_to_pending(first, &clause::parts(self.lexicon, self.catalog, first), &mut then)?,
        };
        if !matches!(understanding, Understanding::Plan { .. }) {
            return None;
        }
        let more: Vec<String> = clause::segments(self.lexicon, rest)
            .into_iter()
            .filter(|part| self.asks_for_more_than_agreed(part))
            .map(token::sentence)
            .collect();
        let own = std::mem::take(&mut then.later);
        then.later = context.later.iter().cloned().chain(own).collect();
        if !more.is_empty() {
            then.later.push(more.join(". "));
        }
        *context = then;
        Some(understanding)
    }

    /// Whether a part of an answer asks for what was not agreed to before: `yes, go to it` does not.
    fn asks_for_more_than_agreed(&self, part: &[String]) -> bool {
        let is_new = |clause: &Clause| {
            let goes = matches!(clause.intent, Intent::GoTo | Intent::Travel | Intent::Find | Intent::Look);
            chatter::is_clear(clause) && (!goes || self.names_anything(part))
        };
        let parts = clause::parts(self.lexicon, self.catalog, part);
        parts.iter().any(|part| matches!(part, Part::Clause(clause) if is_new(clause)))
    }

    /// One of the plans that the robot asked about, in the very words of its question, as a button has them.
    pub(crate) fn chosen_by_name(&self, utterance: &str, context: &mut Context) -> Option<Understanding> {
        let Some(Pending::Guess { guesses }) = &context.pending else { return None };
        let guess = guesses.iter().find(|guess| guess.name.eq_ignore_ascii_case(utterance.trim()))?.clone();
        Some(self.go_as_guessed(guess, context))
    }

    /// Which of the plans of these names an answer means: `yes`, `the second one`, or what it was called; where it commands nothing
    /// else, in part.
    fn chosen_plan(&self, words: &[String], is_yes: bool, is_command: bool, names: &[String]) -> Option<usize> {
        let told_apart = || if is_command { None } else { self.told_apart(words, names) };
        self.plan_called(words, is_yes, names).or_else(told_apart)
    }

    fn plan_called(&self, words: &[String], is_yes: bool, names: &[String]) -> Option<usize> {
        let is_called = |name: &String| plain(&self.lexicon.normalise(name).0) == plain(words);
        if let Some(at) = names.iter().position(is_called) {
            return Some(at);
        }
        let count = i32::try_from(names.len()).ok()?;
        // `the second one, pick it up`
        let first = words.split(|word| token::is_punctuation(word)).find(|part| !part.is_empty()).unwrap_or_default();
        let ordinal = self.answer_phrase(&plain(first)).and_then(|phrase| phrase.ordinal);
        let at = match ordinal {
            Some(ordinal) if ordinal < 0 => count + ordinal,
            Some(ordinal) => ordinal - 1,
            None if is_yes => 0,
            None => return None,
        };
        usize::try_from(at).ok().filter(|at| *at < names.len())
    }

    /// Which of the plans of these names is meant by words of which one alone has some: `the microwave, I said`.
    fn told_apart(&self, words: &[String], names: &[String]) -> Option<usize> {
        let lexicon = self.lexicon;
        let says = |word: &String| {
            !lexicon.is_small_word(word)
                && lexicon.answer_lead.exact(std::slice::from_ref(word)).is_none()
                && lexicon.prepositions.exact(std::slice::from_ref(word)).is_none()
        };
        // `the microwave, not the coffee maker`
        let end = words.iter().position(|word| lexicon.ifs.negations.contains(word)).unwrap_or(words.len());
        let said: Vec<String> = plain(&words[..end]).into_iter().filter(says).collect();
        let names: Vec<Vec<String>> = names.iter().map(|name| lexicon.normalise(name).0).collect();
        let having = |word: &String| names.iter().filter(|name| name.contains(word)).count();
        let is_told = |name: &Vec<String>| said.iter().any(|word| name.contains(word) && having(word) == 1);
        let known = said.iter().filter(|word| having(word) > 0).count();
        let mut told = (0..names.len()).filter(|at| is_told(&names[*at]));
        let at = told.next().filter(|_| 2 * known >= said.len())?;
        told.next().is_none().then_some(at)
    }

    /// `yes please, and then close the door`: the yes, and what else is to be done.
    fn yes_and_more<'w>(&self, words: &'w [String]) -> Option<(&'w [String], &'w [String])> {
        let at = words.iter().position(|word| matches!(word.as_str(), "and" | "then"))?;
        let (yes, more) = (&words[..at], &words[at + 1..]);
        let is_yes = self.small(yes).contains(&Small::Yes);
        let asks = |part: &Part| matches!(part, Part::Clause(clause) if chatter::is_clear(clause));
        (is_yes && clause::parts(self.lexicon, self.catalog, more).iter().any(asks)).then_some((yes, more))
    }

    /// `yes, do put it down first`.
    fn agrees_to_put_down(&self, words: &[String], parts: &[Part]) -> bool {
        let puts_it = |part: &Part| match part {
            Part::Clause(clause) => {
                let is_it = clause.objects.iter().all(|phrase| phrase.pronoun.is_some());
                matches!(clause.intent, Intent::Drop | Intent::Place) && is_it && clause.places.is_empty()
            }
            _ => true,
        };
        let yes = words.iter().take(3).any(|word| self.small_at_start(std::slice::from_ref(word), Small::Yes));
        yes && parts.iter().all(puts_it)
    }

    /// Somebody points at an object: the answer to what was asked, or what is spoken of from now on.
    pub(crate) fn chosen(&self, object: ObjectId, context: &mut Context) -> Understanding {
        match context.pending.take() {
            Some(
                Pending::Which { clauses, slot, consent, .. }
                | Pending::Where { clauses, slot, consent }
                | Pending::Look { clauses, slot, consent },
            ) => self.settle(Open { clauses, slot, consent }, object, context),
            pending => {
                context.pending = pending;
                context.focus.mention(object);
                self.ask().what_with(object)
            }
        }
    }

    /// Carries the request out with this object.
    fn settle(&self, open: Open, object: ObjectId, context: &mut Context) -> Understanding {
        let clauses = with_chosen(open.clauses, open.slot, object);
        self.plan(clauses, Consent { is_agreed: true, ..open.consent }, context)
    }

    /// Carries the request out with all of these, one after the other if they are few.
    pub(crate) fn settle_all(&self, mut open: Open, objects: &[ObjectId], context: &mut Context) -> Understanding {
        if objects.len() > ask::ASKED {
            if let Some(phrase) = phrase_mut(&mut open.clauses, open.slot) {
                phrase.is_all = true;
            }
            return self.plan(open.clauses, open.consent, context);
        }
        let clauses = objects.iter().flat_map(|object| with_chosen(open.clauses.clone(), open.slot, *object)).collect();
        self.plan(clauses, Consent { is_agreed: true, may_put_down: true }, context)
    }

    /// Carries the request out with any but these.
    fn settle_without(&self, mut open: Open, objects: &[ObjectId], context: &mut Context) -> Understanding {
        if let Some(phrase) = phrase_mut(&mut open.clauses, open.slot) {
            phrase.excluded.extend_from_slice(objects);
        }
        self.plan(open.clauses, open.consent, context)
    }

    /// What a question which one is meant was answered with.
    fn told_which(
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
        let points = self.answer_phrase(&plain(words)).is_some_and(|phrase| phrase.pronoun == Some(Pronoun::Thing));
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
        self.answer_phrase(&plain(words)).is_some_and(|told| says_where(&told) || !told.namings.is_empty())
    }

    /// None of those that were asked about was described: it is looked for.
    fn told_another(
        &self,
        words: &[String],
        candidates: &[ObjectId],
        mut open: Open,
        context: &mut Context,
    ) -> Option<Understanding> {
        let told = self.answer_phrase(&plain(words))?;
        describe_by(phrase_mut(&mut open.clauses, open.slot)?, told);
        Some(self.settle_without(open, candidates, context))
    }

    fn ask_which(&self, open: Open, candidates: Vec<ObjectId>, context: &mut Context) -> Understanding {
        let Open { clauses, slot, consent } = open;
        let question = self.ask().which(phrase(&clauses, slot), &candidates);
        context.pending = Some(Pending::Which { clauses, slot, candidates, consent });
        question
    }

    /// Where it is was said: it is found there, or looked for there.
    fn told_where(&self, words: &[String], mut open: Open, context: &mut Context) -> Option<Understanding> {
        let told = self.answer_phrase(&plain(words))?;
        if !says_where(&told) {
            // Another name for it.
            let ground = Ground { catalog: self.catalog, scene: self.scene, focus: &context.focus, judge: self.judge };
            let meant = ground.one(&told, &Want::place(Intent::Find, &[], None)).ok()?;
            return Some(self.settle(open, meant, context));
        }
        let said = phrase_mut(&mut open.clauses, open.slot)?;
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

    /// What it looks like was said: a thing that looks so is meant.
    fn told_look(&self, words: &[String], mut open: Open, context: &mut Context) -> Option<Understanding> {
        let told = self.answer_phrase(&plain(words))?;
        let said = phrase_mut(&mut open.clauses, open.slot)?;
        said.unknown.clear();
        describe_by(said, told);
        Some(self.plan(open.clauses, open.consent, context))
    }

    /// Which way was said.
    fn turned(
        &self,
        words: &[String],
        mut clauses: Vec<Clause>,
        clause: usize,
        context: &mut Context,
    ) -> Option<Understanding> {
        // `a hundred and eighty degrees` are the same either way.
        let half = |amount: crate::clause::Amount| amount == crate::clause::Amount::Degrees(180.0);
        let amount = crate::reading::amount(self.lexicon, words);
        let direction = (0..words.len()).find_map(|at| self.direction(&words[at..]));
        let direction = direction.or(amount.filter(|amount| half(*amount)).map(|_| Direction::Around))?;
        let told = crate::clause::parts(self.lexicon, self.catalog, words).into_iter().find_map(|part| match part {
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

    /// Whether it is a question, a courtesy or such, and so no answer.
    fn is_aside(&self, words: &[String]) -> bool {
        let aside = [Small::Hello, Small::Thanks, Small::Undo];
        let is_asked = words.iter().any(|word| word == "?");
        question::read(self.lexicon, words).is_some_and(|question| is_asked || question.kind != QuestionKind::Unknown)
            || self.chat(words).is_some()
            || self.small(words).iter().any(|small| aside.contains(small))
    }

    /// Whether all of them are meant: `both`, `all of them please`.
    fn is_all(&self, words: &[String]) -> bool {
        let words = plain(words);
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
        self.answer_phrase(&plain(words)).is_some_and(|phrase| phrase.side == Some(Side::Other))
    }

    /// The candidates that an answer leaves.
    fn answered(&self, words: &[String], candidates: &[ObjectId], context: &Context) -> Vec<ObjectId> {
        if let Some(number) = self.option(&plain(words)) {
            return candidates.get(number - 1).copied().into_iter().collect();
        }
        let Some(phrase) = self.answer_phrase(&plain(words)) else { return Vec::new() };
        if phrase.side == Some(Side::Other) {
            // Other than what was spoken of last; if none was, than what was named first.
            let last = context.focus.recent.iter().find(|id| candidates.contains(id)).or(candidates.first());
            return candidates.iter().filter(|id| Some(*id) != last).copied().collect();
        }
        // People count what was named.
        let named = if phrase.ordinal.is_some() { &candidates[..candidates.len().min(ask::ASKED)] } else { candidates };
        let ground = Ground { catalog: self.catalog, scene: self.scene, focus: &context.focus, judge: self.judge };
        let left = ground.narrow(&phrase, named);
        if left.len() < candidates.len() || phrase.pronoun.is_none() && candidates.len() == 1 {
            left
        } else {
            Vec::new()
        }
    }

    /// `2`, `option two`, `number 1 please`: which of those that were named.
    fn option(&self, words: &[String]) -> Option<usize> {
        let mut reader = Reader::new(self.lexicon, words);
        reader.at += usize::from(reader.next_is("the"));
        let title = self.lexicon.titles.longest(reader.rest()).map_or(0, |(length, ())| length);
        let is_titled = title > 0;
        reader.at += title;
        let is_digit = reader.rest().first().is_some_and(|word| token::digits(word).is_some());
        let number = reader.number().filter(|number| (is_titled || is_digit) && *number >= 1.0)?;
        reader.skip(|lexicon| &lexicon.trail);
        (reader.is_done() && number.fract() == 0.0).then_some(number as usize)
    }

    /// Of a long answer, the candidate that it comes to: the last one that is told from the others in it.
    fn told_at_last(&self, words: &[String], candidates: &[ObjectId], context: &Context) -> Option<ObjectId> {
        let ground = Ground { catalog: self.catalog, scene: self.scene, focus: &context.focus, judge: self.judge };
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
    fn answer_phrase(&self, words: &[String]) -> Option<Phrase> {
        self.phrase_of(words).or_else(|| self.phrase_of(&as_description(words)?))
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
            if phrase.pronoun.is_some_and(|pronoun| pronoun != crate::lexicon::Pronoun::One) && says_where(&phrase) {
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

/// The words without punctuation and without the robot's name.
pub(crate) fn plain(words: &[String]) -> Vec<String> {
    let is_address = |word: &str| matches!(word, "robot" | "tam");
    words.iter().filter(|word| !token::is_punctuation(word) && !is_address(word)).cloned().collect()
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

/// The phrase at a place of a request.
pub(crate) fn phrase(clauses: &[Clause], slot: Slot) -> Option<&Phrase> {
    let clause = clauses.get(slot.clause)?;
    match slot.role {
        Role::Object(index) => clause.objects.get(index),
        Role::Place(index) => match clause.places.get(index) {
            Some((_, Place::Object(phrase))) => Some(phrase),
            _ => None,
        },
    }
}

/// A request with this object meant at a place of it.
pub(crate) fn with_chosen(mut clauses: Vec<Clause>, slot: Slot, object: ObjectId) -> Vec<Clause> {
    if let Some(phrase) = phrase_mut(&mut clauses, slot) {
        phrase.chosen = Some(object);
    }
    clauses
}

fn phrase_mut(clauses: &mut [Clause], slot: Slot) -> Option<&mut Phrase> {
    let clause = clauses.get_mut(slot.clause)?;
    match slot.role {
        Role::Object(index) => clause.objects.get_mut(index),
        Role::Place(index) => match clause.places.get_mut(index) {
            Some((_, Place::Object(phrase))) => Some(phrase),
            _ => None,
        },
    }
}
