//! Questions that want a yes or a no: "did you close the fridge?" asks, while "can you close the fridge?" requests.

use cohabit_cdf::{ObjectId, Property, RoomId, state::StateFlag};

use crate::{
    answer::claim::asked_state,
    context::Context,
    ground::want::{Miss, Want},
    known::{contents, describe},
    plan::settle::{self, Settled},
    read::{
        asked_about, chatter,
        clause::{Clause, Part},
        parts,
        phrase::{Phrase, Place},
        question::{self, Question},
        reader::Reader,
        whether,
    },
    talk::conversation::Conversation,
    understanding::Understanding,
    words::{intent::Intent, lexicon::Preposition, prose, question_kind::QuestionKind, token},
};

/// Verbs of leaving something as it is, in a question whether that was done.
const LEFT: [&str; 2] = ["leave", "left"];

impl Conversation<'_> {
    /// The answer to a question among what was said that would otherwise be carried out; nothing, where there is none.
    pub(crate) fn answered_yes_or_no(&self, words: &[String], context: &mut Context) -> Option<Understanding> {
        let sentences = whether::sentences(words);
        let mut asked = sentences.iter().map(|sentence| whether::asked_at(self.lexicon, sentence)).enumerate();
        let (at, start) = asked.find_map(|(at, start)| Some((at, start?)))?;
        let asked = &sentences[at][start..];
        // What is asked for in other sentences is done.
        let requests = |sentence: &&&[String]| {
            let parts = parts::parts(self.lexicon, self.catalog, sentence);
            whether::asked_at(self.lexicon, sentence).is_none()
                && parts.iter().any(|part| matches!(part, Part::Clause(clause) if chatter::is_clear(clause)))
        };
        let others: Vec<&[String]> = sentences.iter().filter(requests).copied().collect();
        let does_ask = question::read(self.lexicon, asked).is_some_and(|one| one.kind != QuestionKind::Unknown);
        if others.is_empty() {
            let parts = parts::parts(self.lexicon, self.catalog, words);
            let is_safe = does_ask && !parts.iter().any(|part| matches!(part, Part::Clause(_)));
            // What is a question anyway is read with what was said before it, where it begins with that.
            let is_deed = whether::put_actively(self.lexicon, asked).is_some();
            if is_safe && !is_deed && (at == 0 || question::read(self.lexicon, words).is_some()) {
                return None;
            }
            // `Iced coffee for the boss! Is it cold?` asks about what was handled, `the red mug. Is it cold?` about that.
            if let Some(named) = self.named_alone(&parts, context) {
                context.focus.mention(named);
            }
            return Some(self.whether(asked, context));
        }
        // `is the mug empty? if so, fill it` is told by what comes after it.
        let is_condition = |sentence: &&&[String]| self.lexicon.conditions.longest(sentence).is_some();
        if at == 0 && (does_ask || others.iter().any(|sentence| is_condition(&sentence))) {
            return None;
        }
        let answer = self.whether(asked, &mut context.clone());
        let rest = others.join(&".".to_owned());
        let then = self.understand_all(rest, context);
        Some(match answer {
            Understanding::Answer { text, .. } => then.after(&text),
            _ => then,
        })
    }

    /// What was named before a question and nothing said of it, where that is known.
    fn named_alone(&self, parts: &[Part], context: &Context) -> Option<ObjectId> {
        let Some(Part::Fragment(phrase)) = parts.first() else { return None };
        let is_named = !phrase.namings.is_empty() && phrase.unknown.is_empty();
        let found = is_named.then(|| self.ground(&context.focus).one(phrase, &Want::place(Intent::Find, &[], None)));
        found?.ok()
    }

    /// Whether what is asked is so.
    fn whether(&self, asked: &[String], context: &mut Context) -> Understanding {
        if let Some(question) = self.left_so(asked) {
            return self.answer(&question, context);
        }
        if let Some(answer) = self.whether_done(asked, context) {
            return answer;
        }
        if let Some(answer) = self.whether_touched(asked, context) {
            return answer;
        }
        match question::read(self.lexicon, asked) {
            Some(question) if question.kind != QuestionKind::Unknown || question.about.is_some() => {
                self.answer(&question, context)
            }
            // `did somebody leave the toaster on`
            Some(question) if asked_state(self.lexicon, &question.rest).is_some() => {
                let about = asked_about::named(self.lexicon, &question.rest);
                self.answer(&Question { kind: QuestionKind::State, about, ..question }, context)
            }
            _ => Understanding::answer("I cannot say. Tell me to do it, and I will try."),
        }
    }

    /// `did you leave the oven on`, `did somebody leave the window open`: whether it is so now, whoever left it; of several, any of them.
    fn left_so(&self, asked: &[String]) -> Option<Question> {
        let words = &self.lexicon.yes_no;
        let (helper, done) = asked.split_first()?;
        let at = done.iter().position(|word| LEFT.contains(&word.as_str()))?;
        let is_asked = words.past.contains(helper) || words.perfect.contains(helper);
        let rest: Vec<String> = done[at + 1..].iter().filter(|word| !token::is_punctuation(word)).cloned().collect();
        asked_state(self.lexicon, &rest).filter(|_| is_asked)?;
        let it = || Reader::new(self.lexicon, &rest).phrase().filter(|phrase| phrase.pronoun.is_some());
        let about = asked_about::named(self.lexicon, &rest).or_else(it)?;
        let is_any = about.is_any || about.is_all || prose::is(&about.text) == "are";
        let about = Phrase { is_any, is_all: false, ..about };
        Some(Question { is_whether: true, ..Question::new(QuestionKind::State, Some(about), rest) })
    }

    /// `did you close the fridge`: whether it did, as it remembers, and how things are now.
    fn whether_done(&self, asked: &[String], context: &mut Context) -> Option<Understanding> {
        if let [helper, subject, done @ ..] = asked
            && self.lexicon.yes_no.past.contains(helper)
            && subject == "you"
            && let Some(waited) = self.whether_waited(done, context)
        {
            return Some(waited);
        }
        let clause = whether::deed_asked_about(self.lexicon, self.catalog, asked)?;
        if let Some(room) =
            clause.places.iter().find_map(|(_, place)| room_of(place)).filter(|_| clause.objects.is_empty())
        {
            return Some(self.whether_been(room, context));
        }
        let settled = settle::settle(&self.planner(context.focus.clone()), &clause);
        let is_group = |phrase: &Phrase| phrase.is_many() && context.focus.group.len() > 1;
        let is_several =
            settled.objects.len() > 1 || settled.objects.iter().any(|phrase| phrase.is_all || is_group(phrase));
        if is_several && clause.intent != Intent::Find {
            return self.whether_each_done(&clause, &settled, context);
        }
        let phrase = settled.objects.first()?;
        let ground = self.ground(&context.focus);
        let want = Want::place(Intent::Find, affordances_of(clause.intent), None);
        let last = phrase.is_bare_pronoun().then(|| context.deeds.last_done_to(clause.intent)).flatten();
        let Ok(id) = last.map_or_else(|| ground.one(phrase, &want), Ok) else {
            let is_search = clause.intent == Intent::Find && !phrase.is_empty();
            return is_search.then(|| Understanding::whether(false, "No, I have not found it yet.", Vec::new()));
        };
        let there = self.place_asked_about(&settled, Some(id), context);
        context.focus.mention(id);
        let place = self.answerer(context, 0).place_sentence(id);
        if clause.intent == Intent::Find {
            return Some(Understanding::whether(true, format!("Yes, {place}."), vec![id]));
        }
        let state = state_after(&clause);
        let is_so = |(flag, expected, _): &(StateFlag, bool, _)| {
            self.scene.object(id).is_some_and(|object| object.has(*flag)) == *expected
        };
        let did = self.has_done(&clause, id, there, context);
        let stated = state.map(|state| {
            let (_, expected, states) = state;
            let the = describe::short(self.catalog, self.scene, id);
            let state = if is_so(&state) == expected { states[0] } else { states[1] };
            format!("{the} {} {state}", prose::is(&the))
        });
        let is_put = clause.intent == Intent::Place && !clause.places.is_empty();
        // `has the milk been put in the fridge` asks how things are, whoever did it.
        let is_passive = whether::put_actively(self.lexicon, asked).is_some();
        let is_there = there.is_some() && self.scene.object(id).is_some_and(|object| object.parent == there);
        let is_otherwise_so = is_passive && !did && (state.as_ref().is_some_and(is_so) || is_there);
        let is_undone = state.as_ref().is_some_and(|state| !is_so(state));
        let text = match (did, stated) {
            (true, Some(stated)) if is_undone => format!("I did, but now {stated}."),
            (true, Some(stated)) => format!("Yes, I did: {stated}."),
            (false, Some(stated)) if is_otherwise_so => format!("Yes, {stated}."),
            (false, None) if is_otherwise_so => format!("Yes, {place}."),
            (false, Some(stated)) if state.as_ref().is_some_and(is_so) => format!("No, but {stated}."),
            (false, Some(stated)) => format!("No, {stated}."),
            (true, None) => format!("Yes, I did: {place}."),
            (false, None) if is_put => format!("No, {place}."),
            (false, None) => format!("No, not that I remember: {place}."),
        };
        Some(Understanding::whether(did || is_otherwise_so, text, vec![id]))
    }

    /// `did you wash the plate and the cup`: whether it did so to each of them, or which of them it left out.
    fn whether_each_done(&self, clause: &Clause, settled: &Settled, context: &Context) -> Option<Understanding> {
        let ground = self.ground(&context.focus);
        let want = Want::place(Intent::Find, affordances_of(clause.intent), None);
        let mut asked: Vec<ObjectId> = Vec::new();
        for phrase in &settled.objects {
            let found = match ground.one(phrase, &want) {
                _ if phrase.is_all => ground.all(phrase, &want),
                _ if phrase.is_many() => ground.plausible(phrase, &want),
                Err(Miss::Several(ids)) => Ok(ids.into_iter().take(1).collect()),
                found => found.map(|id| vec![id]),
            };
            asked.extend(found.ok()?);
        }
        let there = self.place_asked_about(settled, None, context);
        let state = state_after(clause);
        // What is so already was not left out.
        let is_so = |id: &ObjectId| {
            self.scene.object(*id).is_some_and(|object| match (there, state) {
                (Some(place), _) => object.parent == Some(place),
                (None, Some((flag, expected, _))) => object.has(flag) == expected,
                (None, None) => false,
            })
        };
        let (done, others): (Vec<ObjectId>, Vec<ObjectId>) =
            asked.into_iter().partition(|id| self.has_done(clause, *id, there, context));
        let left: Vec<ObjectId> = others.into_iter().filter(|id| !is_so(id)).collect();
        let listed = |ids: &[ObjectId]| {
            let names = ids.iter().take(contents::LIST).map(|id| describe::full(self.catalog, self.scene, *id));
            prose::list(&names.collect::<Vec<_>>(), "and")
        };
        if done.is_empty() {
            return Some(Understanding::whether(false, "No, not that I remember.", left));
        }
        Some(match left.is_empty() {
            true => Understanding::whether(true, format!("Yes, I did: {}.", listed(&done)), done),
            false => Understanding::whether(false, format!("No, I left out {}.", listed(&left)), left),
        })
    }

    /// Where it is asked whether something was put, of `did you put the milk in the fridge`, where that was milk that it put on the table.
    fn place_asked_about(&self, settled: &Settled, thing: Option<ObjectId>, context: &Context) -> Option<ObjectId> {
        let goal = settled.goal.as_ref().filter(|_| settled.intent == Intent::Place)?;
        let (Preposition::In | Preposition::On, Place::Object(place)) = (goal.preposition, &goal.place) else {
            return None;
        };
        self.ground(&context.focus).one(place, &Want::place(Intent::Find, &[], thing)).ok()
    }

    /// Whether it did that to a thing, as it remembers, or put it there, where a place was named.
    fn has_done(&self, clause: &Clause, id: ObjectId, there: Option<ObjectId>, context: &Context) -> bool {
        if let Some(place) = there {
            return context.deeds.did_put(id, place);
        }
        let is_discarded = matches!(clause.intent, Intent::Discard | Intent::Throw) && self.is_in_bin(id);
        let is_so = state_after(clause)
            .is_none_or(|(flag, expected, _)| self.scene.object(id).is_some_and(|object| object.has(flag)) == expected);
        context.deeds.did(clause.intent, id)
            || is_discarded && context.deeds.to(id).is_some()
            || is_so && context.deeds.had_done(clause.intent, id)
    }

    fn is_in_bin(&self, id: ObjectId) -> bool {
        let parent = self.scene.object(id).and_then(|object| self.scene.object(object.parent?));
        parent.is_some_and(|parent| self.devices.bins.contains(&parent.class))
    }

    /// `did you touch the plant`: what it did with it, whatever that verb means.
    fn whether_touched(&self, asked: &[String], context: &mut Context) -> Option<Understanding> {
        let words = &self.lexicon.yes_no;
        let [helper, subject, done @ ..] = asked else { return None };
        if !words.past.contains(helper) || subject != "you" {
            return None;
        }
        let question = Question::new(QuestionKind::Done, asked_about::named(self.lexicon, done), Vec::new());
        let ground = self.ground(&context.focus);
        let id = ground.one(question.about.as_ref()?, &Want::place(Intent::Find, &[], None)).ok()?;
        let has_touched = context.deeds.told_of(id).is_some();
        let answer = self.answer(&question, context);
        Some(Understanding::whether(has_touched, answer.reply(), vec![id]))
    }

    /// `did you go to the hallway`.
    fn whether_been(&self, room: RoomId, context: &Context) -> Understanding {
        let is_here = self.scene.robot.room == room;
        let (been, name) = (is_here || context.deeds.went_to(room), room.name_in(self.catalog));
        let here = self.scene.robot.room.name_in(self.catalog);
        let text = match (is_here, been) {
            (true, _) => format!("Yes, I am in the {name}."),
            (false, true) => format!("Yes, I was in the {name}."),
            (false, false) => format!("No, not that I remember: I am in the {here}."),
        };
        Understanding::whether(been, text, Vec::new())
    }
}

const fn room_of(place: &Place) -> Option<RoomId> {
    match place {
        Place::Room(room) | Place::Viewpoint(room, _) => Some(room.id),
        _ => None,
    }
}

/// What is asked about affords: `did you throw it away` is of what was carried, not of where it went.
const fn affordances_of(intent: Intent) -> &'static [Property] {
    match intent {
        Intent::Place | Intent::Drop | Intent::Bring | Intent::Throw | Intent::Discard => &[Property::Pickupable],
        _ => &[],
    }
}

/// The state that a request brings about, and how it is called where it holds and where it does not.
fn state_after(clause: &Clause) -> Option<(StateFlag, bool, [&'static str; 2])> {
    Some(match clause.intent {
        Intent::Open => (StateFlag::Opened, true, ["open", "closed"]),
        Intent::Close => (StateFlag::Opened, false, ["open", "closed"]),
        Intent::TurnOn => (StateFlag::Toggled, true, ["on", "off"]),
        Intent::TurnOff => (StateFlag::Toggled, false, ["on", "off"]),
        Intent::Break => (StateFlag::Broken, true, ["broken", "whole"]),
        Intent::Cut => (StateFlag::Cut, true, ["cut", "whole"]),
        Intent::Repair => (StateFlag::Broken, false, ["broken", "whole"]),
        Intent::Clean => (StateFlag::Dirty, false, ["dirty", "clean"]),
        Intent::Heat => (StateFlag::Hot, true, ["hot", "not hot"]),
        Intent::Cool => (StateFlag::Cold, true, ["cold", "not cold"]),
        Intent::Dry => (StateFlag::Wet, false, ["wet", "dry"]),
        Intent::Iron => (StateFlag::Creased, false, ["creased", "smooth"]),
        Intent::Water => (StateFlag::Wet, true, ["wet", "dry"]),
        Intent::Fold => (StateFlag::Folded, true, ["folded", "not folded"]),
        Intent::Unfold => (StateFlag::Folded, false, ["folded", "not folded"]),
        Intent::Toast => (StateFlag::Cooked, true, ["toasted", "not toasted"]),
        _ => return None,
    })
}
