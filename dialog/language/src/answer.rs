//! Answers to questions about the world, the mission and the robot itself.

pub(crate) mod claim;
mod claimed;
mod facts;
mod needs;
mod places;
mod robot;
mod state;
mod things;

use cohabit_cdf::{Catalog, ObjectId, Property};

use crate::{
    answer::{
        claim::{Filling, asked_state, is_about_presence},
        facts::Facts,
    },
    context::Context,
    ground::{
        Ground,
        judge::Judge,
        want::{Miss, Want},
    },
    known::{Known, KnownObject, contents, describe, memory, process::Devices},
    read::{
        phrase::{Phrase, RelationKind},
        question::Question,
        saying,
    },
    say::examples,
    understanding::Understanding,
    words::{
        intent::Intent,
        lexicon::{Lexicon, Pronoun, Side},
        prose,
        question_kind::QuestionKind,
    },
};

/// How many neighbours of a thing.
const NEIGHBOURS: usize = 4;

/// Answers questions in a scene.
pub(crate) struct Answerer<'a> {
    pub(crate) catalog: &'a Catalog,
    pub(crate) lexicon: &'a Lexicon,
    pub(crate) devices: &'a Devices,
    pub(crate) scene: &'a Known,
    pub(crate) judge: Judge<'a>,
    pub(crate) context: &'a Context,
    /// How much of a list was told already.
    pub(crate) told: usize,
}

impl Answerer<'_> {
    /// The answer, and the objects it speaks of.
    pub(crate) fn answer(&self, question: &Question) -> Understanding {
        let about = question.about.as_ref().filter(|phrase| phrase.says_something());
        match (question.kind, about) {
            (QuestionKind::Holding, Some(phrase)) if !phrase.is_empty() => self.whether_holding(phrase),
            (QuestionKind::Holding, _) => self.holding(),
            (QuestionKind::Robot, _) => match self.room_in(&question.rest) {
                Some(room) if question.is_whether => self.whether_in(room),
                _ => self.robot(),
            },
            (QuestionKind::Abilities | QuestionKind::HowTo, _) => {
                Understanding::answer(examples::abilities(self.catalog, self.scene))
            }
            (QuestionKind::Carried, about) => self.carried(about, question),
            (QuestionKind::Doing, _) => self.doing(),
            (QuestionKind::Finished, Some(phrase)) if !phrase.namings.is_empty() => self.done(Some(phrase)),
            (QuestionKind::Finished, _) => self.finished(),
            (QuestionKind::Goals, _) => self.goals(),
            (QuestionKind::Options, _) => self.options(),
            (QuestionKind::Why, about) => self.why(about, question),
            (QuestionKind::Done, about) => self.done(about),
            (QuestionKind::DoneSoFar, _) => self.done_so_far(),
            (QuestionKind::Purpose, Some(phrase)) => self.purpose(phrase),
            (QuestionKind::Danger, about) => self.danger(about, question),
            // `who is in the photo`
            (QuestionKind::People, Some(phrase))
                if !phrase.namings.is_empty()
                    && matches!(question.rest.as_slice(), [first, the, ..] if first == "in" && the == "the")
                    && self.room_in(&question.rest).is_none() =>
            {
                self.unknown_of(phrase)
            }
            (QuestionKind::People, _) => self.people(self.room_in(&question.rest)),
            (QuestionKind::Rooms, _) => self.rooms(),
            (QuestionKind::RoomCount, _) => self.room_count(),
            (QuestionKind::Trouble, Some(phrase)) => self.with_object(phrase, |id| self.trouble(id)),
            (QuestionKind::Owner, Some(phrase)) => self.with_object(phrase, |id| self.owner(id)),
            (QuestionKind::Holder, Some(phrase)) => self.with_object(phrase, |id| self.holder(id)),
            (QuestionKind::Origin, Some(phrase)) if !phrase.is_empty() => {
                self.with_object(phrase, |id| self.origin(id))
            }
            (QuestionKind::Origin, _) => match self.context.focus.recent.first() {
                Some(id) => self.origin(*id),
                None => Understanding::lost("I cannot tell what you mean. Name it to me, please."),
            },
            (QuestionKind::Which, Some(phrase)) if phrase.namings.is_empty() && phrase.side == Some(Side::Front) => {
                self.seeing()
            }
            (QuestionKind::Which, Some(phrase)) => self.which(phrase, question),
            (QuestionKind::OfKind, Some(phrase)) => self.of_kind(phrase).with_yes_or_no(question.is_whether),
            (QuestionKind::Rest, _) => self.goals(),
            (QuestionKind::Said, _) => self.said(),
            (QuestionKind::Recording, _) => Understanding::whether(true, RECORDED, Vec::new()),
            (QuestionKind::Time, _) => Understanding::answer("I have no clock, so I cannot tell."),
            // Before what is named: a floor lamp is called by that word, too.
            (QuestionKind::Contents | QuestionKind::Seeing, _) if self.is_about_floor(question) => {
                self.on_floor(self.room_in(&question.rest)).with_yes_or_no(question.is_whether)
            }
            (QuestionKind::Seeing, _) => self.seeing(),
            (QuestionKind::Contents, about)
                if about.is_none_or(|phrase| phrase.namings.is_empty() && phrase.pronoun.is_none())
                    && let Some(room) = self.room_in(&question.rest) =>
            {
                self.room_contents(room)
            }
            (QuestionKind::Contents, None) if self.context.focus.place.is_some() => {
                self.context.focus.place.map_or_else(|| self.hint(), |place| self.contents(place))
            }
            (QuestionKind::State | QuestionKind::Look | QuestionKind::Unknown | QuestionKind::Where, Some(phrase))
                if phrase.pronoun == Some(Pronoun::Thing) && (phrase.is_any || self.is_about_any_thing(question)) =>
            {
                match phrase.relations.first() {
                    _ if self.is_about_floor(question) => {
                        self.on_floor(self.room_in(&question.rest)).with_yes_or_no(question.is_whether)
                    }
                    None if let Some((state, words)) = asked_state(self.lexicon, &question.rest) => {
                        self.all_in_state(state, words, question.is_whether)
                    }
                    Some(relation) if relation.kind == RelationKind::Near => {
                        self.with_object(&relation.to, |id| self.neighbours(id))
                    }
                    Some(relation) => self.with_object(&relation.to, |id| self.contents(id)),
                    None => self.seeing(),
                }
            }
            (QuestionKind::Contents, Some(phrase)) => {
                self.with_object(phrase, |id| self.contents(id)).with_yes_or_no(question.is_whether)
            }
            (QuestionKind::Near, Some(phrase)) => self.with_object(phrase, |id| self.neighbours(id)),
            (QuestionKind::Before, Some(phrase)) => self.with_object(phrase, |id| self.before(id)),
            (QuestionKind::Under, Some(phrase)) => {
                self.with_object(phrase, |id| self.under(id)).with_yes_or_no(question.is_whether)
            }
            (QuestionKind::Text, phrase) => self.text(phrase),
            (QuestionKind::Color, Some(phrase)) => self.colors(phrase),
            (QuestionKind::Distance, Some(phrase)) => self.with_object(phrase, |id| self.distance(id)),
            (QuestionKind::Count | QuestionKind::Where, Some(phrase))
                if let Some(filling) = Filling::named(self.lexicon, phrase)
                    && (question.kind == QuestionKind::Count || question.is_whether)
                    && let Some(answer) = self.filled(phrase, filling) =>
            {
                if question.is_whether {
                    answer
                } else {
                    answer.without_yes()
                }
            }
            (QuestionKind::Count, Some(phrase)) => self.count(phrase, question),
            // `are there any lights on`
            (QuestionKind::Where, Some(phrase))
                if question.is_whether
                    && !phrase.namings.is_empty()
                    && let Some((state, words)) = self.state_after_name(question) =>
            {
                self.any_in_state(phrase, state, words)
            }
            (QuestionKind::State, _) if self.lexicon.yes_no.says_meal_is_done(&question.rest) => self.meal(),
            (QuestionKind::State, Some(phrase)) => self.claim(phrase, question),
            (QuestionKind::Where, about)
                if about.as_ref().is_none_or(|phrase| phrase.namings.is_empty() && phrase.fluid.is_none())
                    && let Some(room) = self.room_in(&question.rest) =>
            {
                Understanding::answer(self.way_to(room))
            }
            (QuestionKind::Where, Some(phrase)) if !phrase.is_empty() => {
                self.place_of(phrase).with_yes_or_no(question.is_whether)
            }
            (QuestionKind::Look, Some(phrase))
                if !phrase.is_empty() && is_about_presence(self.lexicon, &question.rest, phrase) =>
            {
                self.looks(phrase)
            }
            (QuestionKind::Look | QuestionKind::Unknown, Some(phrase))
                if question.is_whether
                    && let Some(answer) = self.claim_told(phrase, question) =>
            {
                answer
            }
            (QuestionKind::Look, Some(phrase)) if !phrase.is_empty() => self.unknown_of(phrase),
            (QuestionKind::Unknown, Some(phrase)) if !phrase.is_empty() => self.unknown_of(phrase),
            (QuestionKind::Where, Some(phrase)) if phrase.pronoun.is_some() => {
                Understanding::lost(saying::unresolved(phrase))
            }
            (QuestionKind::Where, _) if !question.rest.is_empty() => {
                let phrase = Phrase { text: question.rest.join(" "), ..Phrase::default() };
                let text = saying::noun(&phrase).map(|noun| format!("I do not know what \"{noun}\" is."));
                Understanding::lost(text.unwrap_or_else(|| saying::unresolved(&phrase)))
            }
            // `where is it?`
            (QuestionKind::Where, None) if let Some(id) = self.context.focus.recent.first() => {
                Understanding::about(prose::sentence(&self.place_sentence(*id)), vec![*id])
            }
            (QuestionKind::Where, None) => Understanding::lost("I cannot tell what you mean. Name it to me, please."),
            _ => Understanding::lost(format!(
                "I do not know how to answer that. {}",
                examples::hint(self.catalog, self.scene)
            )),
        }
    }

    /// What can be said, where there is nothing else to say.
    pub(crate) fn hint(&self) -> Understanding {
        Understanding::refusal(examples::hint(self.catalog, self.scene))
    }

    pub(crate) fn ground(&self) -> Ground<'_> {
        Ground { catalog: self.catalog, scene: self.scene, focus: &self.context.focus, judge: self.judge }
    }

    pub(crate) fn full(&self, id: ObjectId) -> String {
        describe::full(self.catalog, self.scene, id)
    }

    pub(crate) fn short(&self, id: ObjectId) -> String {
        describe::short(self.catalog, self.scene, id)
    }

    pub(crate) fn facts(&self) -> Facts<'_> {
        Facts { catalog: self.catalog, devices: self.devices, scene: self.scene }
    }

    fn listed(&self, objects: &[&KnownObject]) -> String {
        contents::listed(self.catalog, self.scene, objects, self.told)
    }

    pub(crate) fn with_object(&self, phrase: &Phrase, then: impl Fn(ObjectId) -> Understanding) -> Understanding {
        self.with_object_that(&[], phrase, then)
    }

    /// The same, of an object that affords something, where `it` may be any that was spoken of.
    pub(crate) fn with_object_that(
        &self,
        affords: &[Property],
        phrase: &Phrase,
        then: impl Fn(ObjectId) -> Understanding,
    ) -> Understanding {
        let want = Want::place(Intent::Find, affords, None);
        match self.ground().one(phrase, &want) {
            Ok(id) => then(id),
            Err(Miss::Several(ids) | Miss::Mismatch(ids)) if !ids.is_empty() => then(ids[0]),
            Err(_) => self.unseen(phrase),
        }
    }

    /// `the tip in the laser`, which stands here and has none: that it is not there, and what has none.
    pub(crate) fn absent(&self, phrase: &Phrase) -> Option<(String, ObjectId)> {
        let [relation] = phrase.relations.as_slice() else { return None };
        let at = self.ground().one(&relation.to, &Want::place(Intent::Find, &[], None)).ok()?;
        let place = self.scene.object(at)?;
        let is_in_view = place.visible && !memory::is_shut(self.catalog, place);
        (is_in_view && relation.kind == RelationKind::Inside)
            .then(|| (format!("I do not see {}.", saying::said(phrase)), at))
    }

    /// The same with what is known of the object.
    pub(crate) fn with_known(&self, phrase: &Phrase, then: impl Fn(&KnownObject) -> Understanding) -> Understanding {
        let of = |id| self.scene.object(id).map_or_else(|| self.hint(), &then);
        self.with_object(phrase, of)
    }

    pub(crate) fn unseen(&self, phrase: &Phrase) -> Understanding {
        if saying::noun(phrase).is_none() {
            return Understanding::refusal(saying::unresolved(phrase));
        }
        if let Some((text, place)) = self.absent(phrase) {
            return Understanding::whether(false, text, vec![place]);
        }
        let said = saying::said(phrase);
        if self.scene.floor.is_some() && (phrase.unknown.is_empty() || !phrase.namings.is_empty()) {
            let text = format!("I have not seen {said} yet. Shall I look for {}?", prose::it(&said));
            return crate::say::ask::confirmation(text);
        }
        let text = format!("I have not seen {said}. I can look around if you want.");
        Understanding::whether(false, text, Vec::new())
    }

    /// What is known of a thing, after why that is no answer.
    pub(crate) fn all_known(&self, object: &KnownObject, why: &str) -> Understanding {
        let known = prose::sentence(&self.facts().description(object));
        Understanding::about(format!("{why}. What I know: {known}"), vec![object.id])
    }
}

/// What is said of recordings: every session is.
const RECORDED: &str = "Yes: what is said, and what I see and do, is written into the log of this session.";
