//! What people say to a question of the robot's: yes and no, a description, a place, a click, or something else.

use cohabit_cdf::ObjectId;

use crate::{
    context::{Context, Pending, search::Consent},
    read::{
        chatter,
        clause::{Clause, Part},
        parts, question, segments,
        slot::{self, Role, Slot},
    },
    say::{ask, reply},
    talk::{conversation::Conversation, room_kind},
    understanding::Understanding,
    words::{intent::Intent, lexicon::Small, question_kind::QuestionKind, token},
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
        let is_yes = (self.small_at_start(words, Small::Yes) || is(Small::Resume)) && !is_command;
        // Whoever orders or asks something else names none of the plans by a word that one of them has, too.
        let is_else = is_command || self.asks_of_its_own(words);
        let leaves = is(Small::No) || is(Small::Neither) && !matches!(pending, Pending::Which { .. });
        // `no, not the dryer`
        let declines = matches!(pending, Pending::Also { .. }) && self.small_at_start(words, Small::No);
        if (leaves || declines)
            && !is_command
            && !matches!(&pending, Pending::Which { candidates, .. } if candidates.len() == 1)
        {
            return Some(Understanding::answer(LEAVES));
        }
        match pending {
            Pending::PutDown { clauses } if is_yes || self.agrees_to_put_down(words, parts) => {
                let consent = Consent { may_put_down: true, is_agreed: true };
                Some(self.plan(clauses, consent, context))
            }
            Pending::Offer { mut plans } => {
                let names: Vec<String> = plans.iter().map(|steps| reply::plan_in_words(steps)).collect();
                let at = self.chosen_plan(words, is_yes || is(Small::Any), is_else, &names)?;
                Some(self.go(plans.swap_remove(at), context))
            }
            Pending::Guess { mut guesses } => {
                let names: Vec<String> = guesses.iter().map(|guess| guess.name.clone()).collect();
                let at = self.chosen_plan(words, is_yes || is(Small::Any), is_else, &names)?;
                let guess = self.without_denied(guesses.swap_remove(at), words)?;
                Some(self.go_as_guessed(guess, context))
            }
            Pending::Also { guess, .. } => {
                let is_wanted = is_yes || is(Small::More) || self.is_all(words);
                let names = std::slice::from_ref(&guess.name);
                // `what is in the dryer?` is no wish for it.
                let names_it = || !self.is_aside(words) && self.chosen_plan(words, false, is_command, names).is_some();
                (is_wanted || names_it()).then(|| self.agreed_to_more((*guess).clone(), context))
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
        let parts = || parts::parts(self.lexicon, self.catalog, words);
        open.is_some()
            && (self.answer_to_pending(words, &parts(), &mut context.clone()).is_some()
                || self.answered_first(words, open, &mut context.clone()).is_some())
    }

    /// What is to be done if an answer comes before remarks, or before what else is to be done, or behind a remark: `the robot one, like I said`,
    /// `what a mouthful! the last one`.
    pub(crate) fn answered_first(
        &self,
        words: &[String],
        pending: Option<&Pending>,
        context: &mut Context,
    ) -> Option<Understanding> {
        let mut from = 0;
        while from < words.len() {
            let mark = words[from..].iter().position(|word| token::is_punctuation(word)).map(|at| from + at);
            let end = mark.unwrap_or(words.len());
            let said = &words[from..end];
            let is_all = from == 0 && mark.is_none();
            // `a light bulb? open the fridge`: who asks back chooses nothing.
            let is_echo = words.get(end).is_some_and(|mark| mark == "?") && end + 1 < words.len();
            let is_asked = is_echo || self.small(said).is_empty() && self.is_part_of_question(words, end);
            if !said.is_empty() && !is_all && !is_asked {
                let answered = self.answered_by(said, &words[end..], pending, context);
                if answered.is_some() || self.asks_for_more_than_agreed(said) {
                    return answered;
                }
            }
            from = end + 1;
        }
        None
    }

    /// The same where `first` answers, and `rest` follows.
    fn answered_by(
        &self,
        first: &[String],
        rest: &[String],
        pending: Option<&Pending>,
        context: &mut Context,
    ) -> Option<Understanding> {
        let more: Vec<String> = segments::segments(self.lexicon, rest)
            .into_iter()
            .filter(|part| self.asks_for_more_than_agreed(part))
            .map(token::sentence)
            .collect();
        // `fine, bring me the banana`: of several plans a yes before something else chooses none.
        let is_bare_yes = || {
            let small = self.small(first);
            small.contains(&Small::Yes) && !small.contains(&Small::Any)
        };
        if !more.is_empty() && pending.is_some_and(Pending::offers_several) && is_bare_yes() {
            return None;
        }
        // `no, leave that. I need the hammer`: who names something else does not want the search to go on.
        let offers_one = matches!(pending, Some(Pending::Which { candidates, .. }) if candidates.len() == 1);
        let is_else = more.iter().any(|part| self.names_anything(&token::words(part)));
        if offers_one && is_else && self.small(first).contains(&Small::No) {
            return None;
        }
        let mut then = Context { pending: pending.cloned(), later: Vec::new(), ..context.clone() };
        let understanding = match pending? {
            Pending::Lab { words: before, at } => {
                let kind = room_kind::standing_at(self.lexicon, self.scene, before, *at)?;
                let room = kind.answered(self.lexicon, self.scene, first)?;
                then.pending = None;
                self.understand_words(kind.named(before, room, self.catalog), &mut then)
            }
            _ => self.answer_to_pending(first, &parts::parts(self.lexicon, self.catalog, first), &mut then)?,
        };
        if !matches!(understanding, Understanding::Plan { .. }) {
            return None;
        }
        let own = std::mem::take(&mut then.later);
        then.later = context.later.iter().cloned().chain(own).collect();
        if !more.is_empty() {
            then.later.push(more.join(". "));
        }
        *context = then;
        Some(understanding)
    }

    /// Whether what ends at `end` is part of a question that began by then: `what is over there, the big one?` chooses nothing.
    fn is_part_of_question(&self, words: &[String], end: usize) -> bool {
        let Some(mark) = (end..words.len()).find(|at| token::ends_sentence(&words[*at])) else { return false };
        let start = words[..end].iter().rposition(|word| token::ends_sentence(word)).map_or(0, |at| at + 1);
        let begins = |at: &usize| *at == start || token::is_punctuation(&words[*at - 1]);
        words[mark] == "?" && (start..end).filter(begins).any(|at| self.asks_of_its_own(&words[at..=mark]))
    }

    /// Whether words ask something of their own, and so choose nothing of what the robot asked about; `how about the last one?` chooses.
    fn asks_of_its_own(&self, words: &[String]) -> bool {
        let is_asked = words.iter().any(|word| word == "?");
        // `where the printer is` answers.
        let is_own = |kind| is_asked || !matches!(kind, QuestionKind::Unknown | QuestionKind::Where);
        self.lexicon.fillers.suggests.longest(words).is_none()
            && question::read(self.lexicon, words).is_some_and(|question| is_own(question.kind))
    }

    /// Whether it asks something of its own, and asks for nothing to be done.
    pub(crate) fn only_asks(&self, words: &[String]) -> bool {
        let sentences: Vec<&[String]> = words.split_inclusive(|word| token::ends_sentence(word)).collect();
        let asks = |sentence: &&[String]| self.is_part_of_question(sentence, sentence.len() - 1);
        sentences.iter().any(asks) && !sentences.iter().any(|sentence| self.is_request(sentence))
    }

    /// Whether a part of an answer asks for what was not agreed to before: `yes, go to it` does not.
    fn asks_for_more_than_agreed(&self, part: &[String]) -> bool {
        let is_new = |clause: &Clause| {
            let goes = matches!(clause.intent, Intent::GoTo | Intent::Travel | Intent::Find | Intent::Look);
            chatter::is_clear(clause) && (!goes || self.names_anything(part))
        };
        let parts = parts::parts(self.lexicon, self.catalog, part);
        parts.iter().any(|part| matches!(part, Part::Clause(clause) if is_new(clause)))
    }

    /// `yes please, and then close the door`: the yes, and what else is to be done.
    fn yes_and_more<'w>(&self, words: &'w [String]) -> Option<(&'w [String], &'w [String])> {
        let at = words.iter().position(|word| matches!(word.as_str(), "and" | "then"))?;
        let (yes, more) = (&words[..at], &words[at + 1..]);
        let is_yes = self.small(yes).contains(&Small::Yes);
        let asks = |part: &Part| matches!(part, Part::Clause(clause) if chatter::is_clear(clause));
        (is_yes && parts::parts(self.lexicon, self.catalog, more).iter().any(asks)).then_some((yes, more))
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
    pub(crate) fn settle(&self, open: Open, object: ObjectId, context: &mut Context) -> Understanding {
        let clauses = slot::with_chosen(open.clauses, open.slot, object);
        self.plan(clauses, Consent { is_agreed: true, ..open.consent }, context)
    }

    /// Carries the request out with all of these, one after the other if they are few.
    pub(crate) fn settle_all(&self, mut open: Open, objects: &[ObjectId], context: &mut Context) -> Understanding {
        if objects.len() > ask::ASKED {
            if let Some(phrase) = slot::phrase_mut(&mut open.clauses, open.slot) {
                phrase.is_all = true;
            }
            return self.plan(open.clauses, open.consent, context);
        }
        let clauses =
            objects.iter().flat_map(|object| slot::with_chosen(open.clauses.clone(), open.slot, *object)).collect();
        self.plan(clauses, Consent { is_agreed: true, may_put_down: true }, context)
    }

    /// Carries the request out with any but these.
    pub(crate) fn settle_without(&self, mut open: Open, objects: &[ObjectId], context: &mut Context) -> Understanding {
        if let Some(phrase) = slot::phrase_mut(&mut open.clauses, open.slot) {
            phrase.excluded.extend_from_slice(objects);
        }
        self.plan(open.clauses, open.consent, context)
    }

    /// Whether it is a question, a courtesy or such, and so no answer.
    pub(crate) fn is_aside(&self, words: &[String]) -> bool {
        let aside = [Small::Hello, Small::Thanks, Small::Undo];
        let is_asked = words.iter().any(|word| word == "?");
        question::read(self.lexicon, words).is_some_and(|question| is_asked || question.kind != QuestionKind::Unknown)
            || self.chat(words).is_some()
            || self.small(words).iter().any(|small| aside.contains(small))
    }
}
