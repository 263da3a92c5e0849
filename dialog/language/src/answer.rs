//! Answers to questions about the world, the mission and the robot itself.

use cohabit_cdf::{Catalog, Fluid, ObjectId, Property, RoomId, state::StateFlag};

use crate::{
    claim::{Filling, asked_state, is_about_presence},
    contents,
    context::Context,
    describe,
    facts::Facts,
    ground::{self, Ground, Miss, Want},
    intent::Intent,
    judge::Judge,
    known::{self, Known, KnownObject},
    lexicon::{Lexicon, Pronoun, Side},
    phrase::{Phrase, RelationKind},
    process::Devices,
    question::{Question, QuestionKind},
    reply, report, saying, search,
    understanding::Understanding,
    yes_no,
};

/// How many neighbours of a thing.
const NEIGHBOURS: usize = 4;

/// What people can say, as examples.
pub(crate) const EXAMPLES: &str = "I can go to rooms and objects, pick things up and put them down, open, close, switch, fill, pour, clean, break, scan, heat, cool, \
     repair and color things. For example: \"go to the break room\", \"pick up the red mug\", \"heat the mug in the microwave\", \
     \"where is the milk?\". Say \"stop\" to stop me.";

/// One or two of them, where a reply has something else to say first.
pub(crate) const HINT: &str =
    "You can tell me, for example, \"go to the break room\" or \"pick up the mug\", or ask \"what can you do?\"";

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
            (QuestionKind::Abilities, _) => Understanding::answer(EXAMPLES),
            (QuestionKind::Doing, _) => self.doing(),
            (QuestionKind::Goals, _) => self.goals(),
            (QuestionKind::Options, _) => self.options(),
            (QuestionKind::HowTo, _) => Understanding::answer(EXAMPLES),
            (QuestionKind::Why, about) => self.why(about, question),
            (QuestionKind::Done, about) => self.done(about),
            (QuestionKind::DoneSoFar, _) => self.done_so_far(),
            (QuestionKind::Purpose, Some(phrase)) => self.purpose(phrase),
            (QuestionKind::Danger, about) => self.danger(about, question),
            (QuestionKind::People, _) => self.people(),
            (QuestionKind::Trouble, Some(phrase)) => self.with_object(phrase, |id| self.trouble(id)),
            (QuestionKind::Owner, Some(phrase)) => self.with_object(phrase, |id| {
                let place = describe::sentence(&self.place_sentence(id));
                Understanding::about(format!("I do not know whose it is. {place}"), vec![id])
            }),
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
            (QuestionKind::Rest, _) => self.goals(),
            (QuestionKind::Recording, _) => Understanding::whether(true, RECORDED, Vec::new()),
            (QuestionKind::Time, _) => Understanding::answer("I have no clock, so I cannot tell."),
            (QuestionKind::Seeing, _) => self.seeing(),
            (QuestionKind::Contents, about)
                if about.is_none_or(|phrase| phrase.namings.is_empty() && phrase.pronoun.is_none())
                    && let Some(room) = self.room_in(&question.rest) =>
            {
                self.room_contents(room)
            }
            (QuestionKind::Contents, about)
                if about.is_none_or(|phrase| phrase.namings.is_empty())
                    && self.lexicon.yes_no.says_floor(&question.rest) =>
            {
                self.on_floor()
            }
            (QuestionKind::Contents, None) if self.context.focus.place.is_some() => {
                self.context.focus.place.map_or_else(|| Understanding::refusal(HINT), |place| self.contents(place))
            }
            (QuestionKind::State | QuestionKind::Look | QuestionKind::Unknown | QuestionKind::Where, Some(phrase))
                if phrase.pronoun == Some(Pronoun::Thing) && (phrase.is_any || self.is_about_any_thing(question)) =>
            {
                match phrase.relations.first() {
                    None if let Some((state, words)) = asked_state(self.lexicon, &question.rest) => {
                        self.all_in_state(state, words, question.is_whether)
                    }
                    Some(relation) => self.with_object(&relation.to, |id| self.contents(id)),
                    None => self.seeing(),
                }
            }
            (QuestionKind::Contents, Some(phrase)) => {
                self.with_object(phrase, |id| self.contents(id)).with_yes_or_no(question.is_whether)
            }
            (QuestionKind::Near, Some(phrase)) => self.with_object(phrase, |id| self.neighbours(id)),
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
            (QuestionKind::Where, None) => Understanding::lost("I cannot tell what you mean. Name it to me, please."),
            _ => Understanding::lost(format!("I do not know how to answer that. {HINT}")),
        }
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

    fn holding(&self) -> Understanding {
        let Some(held) = self.scene.robot.held else { return empty_handed("My hand is empty.") };
        let text = format!("I am holding {}{}.", self.short(held), self.filling(held));
        Understanding::whether(true, text, Vec::new())
    }

    fn whether_holding(&self, phrase: &Phrase) -> Understanding {
        let Some(held) = self.scene.robot.held else { return empty_handed("No, my hand is empty.") };
        let is_it = self.ground().narrow(phrase, &[held]) == [held];
        let start = if is_it { "Yes" } else { "No" };
        Understanding::whether(is_it, format!("{start}, I am holding {}.", self.short(held)), Vec::new())
    }

    fn filling(&self, id: ObjectId) -> String {
        self.fillings(id).map_or_else(String::new, |filling| format!(" with {filling} in it"))
    }

    /// What was poured into a thing, if anything.
    pub(crate) fn fillings(&self, id: ObjectId) -> Option<String> {
        let object = self.scene.object(id)?;
        let mut filling: Vec<String> = Vec::new();
        if object.has(StateFlag::Cereal) {
            filling.push("cereal".to_owned());
        }
        if object.fluid != Fluid::None {
            filling.push(object.fluid.name().to_lowercase());
        }
        (!filling.is_empty()).then(|| describe::list(&filling, "and"))
    }

    fn robot(&self) -> Understanding {
        Understanding::answer(format!("I am in the {}.", self.scene.robot.room.name_in(self.catalog)))
    }

    /// `is there any thing in the fridge`.
    fn is_about_any_thing(&self, question: &Question) -> bool {
        question.is_whether && self.lexicon.generic.longest(&question.rest).is_some()
    }

    fn whether_in(&self, room: RoomId) -> Understanding {
        let here = self.scene.robot.room;
        let start = if here == room { "Yes" } else { "No" };
        let name = here.name_in(self.catalog);
        Understanding::whether(here == room, format!("{start}, I am in the {name}."), Vec::new())
    }

    fn doing(&self) -> Understanding {
        Understanding::answer(match self.context.running.first() {
            Some(step) => format!("I am {}.", step.says),
            None => "I am waiting for you to tell me what to do.".to_owned(),
        })
    }

    fn goals(&self) -> Understanding {
        let goals = self.scene.goals.iter().filter(|goal| !goal.text.is_empty());
        let (met, left): (Vec<_>, Vec<_>) = goals.partition(|goal| goal.met);
        if left.is_empty() {
            let text = if met.is_empty() { "There is no goal that I know of." } else { "Nothing: everything is done!" };
            return Understanding::whether(false, text, Vec::new());
        }
        let texts: Vec<String> = left.iter().map(|goal| goal.text.trim_end_matches('.').to_owned()).collect();
        let done = if met.is_empty() { String::new() } else { format!(" Done so far: {}.", met.len()) };
        Understanding::whether(true, format!("Still to do: {}.{done}", texts.join("; ")), Vec::new())
    }

    /// What the mission wants next, and how to ask for it.
    fn options(&self) -> Understanding {
        let how = "Tell me where to go, what to pick up, put, open, close or switch, or ask me where something is.";
        let goals = || self.scene.goals.iter().filter(|goal| !goal.text.is_empty());
        Understanding::answer(match goals().find(|goal| !goal.met) {
            Some(goal) => format!("The mission's next goal: {}. {how}", goal.text.trim_end_matches('.')),
            None if goals().next().is_some() => format!("Everything is done! {how}"),
            None => how.to_owned(),
        })
    }

    /// Why something is as it is, or why the last step failed, if it did; or else what the last plan, or what of it was done to an
    /// object, was for.
    fn why(&self, about: Option<&Phrase>, question: &Question) -> Understanding {
        if let Some(phrase) = about.filter(|_| asked_state(self.lexicon, &question.rest).is_some()) {
            return self.with_object(phrase, |id| self.why_so(id));
        }
        if let Some(chosen) = about.and_then(|phrase| self.why_this_one(phrase)) {
            return chosen;
        }
        if let Some(failure) = &self.context.failed {
            let cause = report::cause(failure.status);
            return Understanding::answer(match failure.step.says.as_str() {
                "" => describe::sentence(cause),
                says => format!("I did not finish {says}: {cause}."),
            });
        }
        if let Some(refused) = &self.context.refused {
            return Understanding::answer(refused);
        }
        let deed = yes_no::deed_asked_about(self.lexicon, self.catalog, &question.rest).map(|clause| clause.intent);
        let want = Want::place(Intent::Find, &[], None);
        let object = about.and_then(|phrase| self.ground().one(phrase, &want).ok());
        if let Some(not) = self.not_asked_for(object, &question.rest) {
            return Understanding::answer(not);
        }
        if let Some(why) = self.context.deeds.why(deed, object) {
            return Understanding::answer(format!("{why}."));
        }
        let Some(last) = self.context.last_plan.last().filter(|_| !self.context.reason.is_empty()) else {
            return Understanding::answer(match self.context.reason.as_str() {
                "" => "Nothing went wrong that I know of, and I have done nothing yet.".to_owned(),
                reason => format!("Because {reason}."),
            });
        };
        let step = object.and_then(|id| self.context.last_plan.iter().find(|step| step.object() == Some(id)));
        let reason = &self.context.planned_for;
        Understanding::answer(match step.filter(|step| *step != last) {
            Some(step) => format!("Because {reason}, and {} was needed for {}.", step.says, last.says),
            None => format!(
                "Because {reason}: my plan was {}{}.",
                reply::plan_in_words(&self.context.last_plan),
                self.context.deeds.goals_of(reason)
            ),
        })
    }

    /// `why did you not close the microwave`: that nobody asked for it, unless it was done.
    fn not_asked_for(&self, object: Option<ObjectId>, asked: &[String]) -> Option<String> {
        let at = asked.iter().position(|word| self.lexicon.ifs.negations.contains(word))?;
        let done = [&asked[..at], &asked[at + 1..]].concat();
        let intent = yes_no::deed_asked_about(self.lexicon, self.catalog, &done)?.intent;
        let what = object.map_or_else(|| "that".to_owned(), |id| self.short(id));
        let is_done = object.is_some_and(|id| self.context.deeds.did(intent, id));
        (!is_done).then(|| format!("You did not ask me to {} {what}.", intent.verb()))
    }

    /// Why a thing is as it is: what was done to it.
    fn why_so(&self, id: ObjectId) -> Understanding {
        let the = self.short(id);
        let text = match self.context.deeds.to(id).filter(|deed| deed.step.changes()) {
            Some(deed) => format!("I did that, since {}.", deed.reason),
            None => format!("I did not do that, as far as I remember: I found {the} so, and do not know why."),
        };
        Understanding::about(text, vec![id])
    }

    /// What it did last, or to a thing.
    fn done(&self, about: Option<&Phrase>) -> Understanding {
        let want = Want::place(Intent::Find, &[], None);
        let deed = about
            .and_then(|phrase| self.ground().one(phrase, &want).ok())
            .map(|id| (id, self.context.deeds.told_of(id)));
        let failed = self.context.failed.as_ref().filter(|failure| !failure.step.says.is_empty());
        let failed = failed
            .map(|failure| format!(" I did not finish {}: {}.", failure.step.says, report::cause(failure.status)));
        Understanding::answer(match (deed, self.context.deeds.told()) {
            (Some((id, None)), _) => format!("I did nothing with {} that I remember.", self.short(id)),
            (Some((_, Some(told))), _) => describe::sentence(&told),
            (None, Some(told)) => describe::sentence(&told) + &failed.unwrap_or_default(),
            (None, None) => {
                failed.map_or_else(|| "I have done nothing yet.".to_owned(), |failed| failed.trim().to_owned())
            }
        })
    }

    fn done_so_far(&self) -> Understanding {
        let told = self.context.deeds.all_told();
        Understanding::answer(
            told.map_or_else(|| "I have done nothing yet.".to_owned(), |told| describe::sentence(&told)),
        )
    }

    /// Why one of several that may be meant was taken; nothing, where there was no choice.
    fn why_this_one(&self, phrase: &Phrase) -> Option<Understanding> {
        let want = Want::place(Intent::Find, &[], None);
        let chosen = self.ground().one(phrase, &want).ok()?;
        self.context.last_plan.iter().find(|step| step.object() == Some(chosen))?;
        let is_in = |said: &&&Phrase| self.ground().all(said, &want).is_ok_and(|all| all.contains(&chosen));
        let named: Vec<&Phrase> = self.context.request.iter().flat_map(search::named).collect();
        let said = named.iter().filter(|said| said.chosen.is_none()).find(is_in)?;
        let others: Vec<ObjectId> =
            self.ground().all(said, &want).ok()?.into_iter().filter(|id| *id != chosen).collect();
        let in_mission = |id: ObjectId| self.scene.object(id).is_some_and(|object| object.in_mission);
        let why = match others.as_slice() {
            [] => return None,
            others if in_mission(chosen) && !others.iter().any(|other| in_mission(*other)) => {
                "it is part of the mission"
            }
            _ => "that seemed likeliest to me by what was near and what we spoke of",
        };
        let names: Vec<String> = others.iter().take(NEIGHBOURS).map(|id| self.short(*id)).collect();
        let text = format!(
            "You said \"{}\", which may also be {}; I took {}, since {why}. If you meant another one, tell me which.",
            said.text,
            describe::list(&names, "or"),
            self.short(chosen),
        );
        Some(Understanding::about(text, vec![chosen]))
    }

    pub(crate) fn facts(&self) -> Facts<'_> {
        Facts { catalog: self.catalog, devices: self.devices, scene: self.scene }
    }

    /// What a thing is for; of what was not seen yet, what its kind is for.
    fn purpose(&self, phrase: &Phrase) -> Understanding {
        let want = Want::place(Intent::Find, &[], None);
        let is_known = self.ground().one(phrase, &want).is_ok();
        let of_kind = || phrase.namings.iter().find_map(|naming| self.facts().purpose_of_kind(naming.class));
        match of_kind().filter(|_| !is_known) {
            Some(text) => Understanding::answer(text),
            None => {
                self.with_known(phrase, |object| Understanding::about(self.facts().purpose(object), vec![object.id]))
            }
        }
    }

    /// How things are, and what they are for.
    fn looks(&self, phrase: &Phrase) -> Understanding {
        let want = Want::place(Intent::Find, &[], None);
        match self.ground().plausible(phrase, &want) {
            Ok(found) if found.len() > 1 => self.place_of(phrase),
            Ok(_) => self.with_known(phrase, |object| {
                let facts = self.facts();
                let purpose = if facts.has_use(object) { facts.purpose(object) } else { String::new() };
                let text = describe::sentence(&facts.description(object));
                Understanding::about(format!("{text} {purpose}").trim(), vec![object.id])
            }),
            Err(_) => self.purpose(phrase),
        }
    }

    /// What is known of a thing, where that is not what was asked.
    fn unknown_of(&self, phrase: &Phrase) -> Understanding {
        self.with_known(phrase, |object| self.all_known(object, "I do not know that"))
    }

    /// Who is with the robot: it knows of nobody but who speaks to it.
    fn people(&self) -> Understanding {
        match self.scene.person.filter(|person| person.room == self.scene.robot.room) {
            Some(_) => Understanding::whether(true, "You are here with me. I see nobody else.", Vec::new()),
            None => Understanding::whether(false, "I see nobody here.", Vec::new()),
        }
    }

    fn danger(&self, about: Option<&Phrase>, question: &Question) -> Understanding {
        let want = Want::place(Intent::Find, &[], None);
        let object =
            about.and_then(|phrase| self.ground().one(phrase, &want).ok()).and_then(|id| self.scene.object(id));
        let facts = self.facts();
        let sparking = || self.scene.objects.iter().find(|object| object.has(StateFlag::Sparking));
        let (danger, object) = match object.or_else(sparking) {
            Some(object) => (facts.danger(object), Some(object)),
            None => (None, None),
        };
        let is_so = danger.is_some() != question.asks_for_safety();
        let of = object.map_or_else(|| "here".to_owned(), |object| format!("about {}", self.short(object.id)));
        let danger = danger.unwrap_or_else(|| format!("I know of nothing dangerous {of}"));
        let told = object.and_then(|object| facts.written_of(object)).unwrap_or_default();
        let text = format!("{} {told}", describe::sentence(&danger));
        Understanding::whether(is_so, text.trim(), object.map(|object| object.id).into_iter().collect())
    }

    fn trouble(&self, id: ObjectId) -> Understanding {
        let Some(object) = self.scene.object(id) else { return Understanding::refusal(HINT) };
        let failed = self.context.failed.as_ref().filter(|failure| failure.step.object() == Some(id));
        let text = match (self.facts().trouble(object), failed) {
            (Some(wrong), _) => wrong,
            (None, Some(failure)) => {
                format!("I did not finish {}: {}", failure.step.says, report::cause(failure.status))
            }
            (None, None) => format!("nothing that I can see: {}", self.facts().description(object)),
        };
        Understanding::about(describe::sentence(&text), vec![id])
    }

    fn holder(&self, id: ObjectId) -> Understanding {
        let is_held = self.scene.robot.held == Some(id);
        let who = if is_held { "I have it" } else { "Nobody that I know of" };
        Understanding::about(format!("{who}: {}.", self.place_sentence(id)), vec![id])
    }

    /// Where it was taken from, or where it is, if it was not taken.
    fn origin(&self, id: ObjectId) -> Understanding {
        let taken = self.context.focus.origins.iter().find(|(taken, _)| *taken == id);
        match taken {
            Some((_, from)) => {
                let text = format!("I took {} from {}.", self.short(id), self.full(*from));
                Understanding::about(text, vec![*from])
            }
            None => Understanding::about(describe::sentence(&self.place_sentence(id)), vec![id]),
        }
    }

    /// Which of several are as was asked.
    fn which(&self, phrase: &Phrase, question: &Question) -> Understanding {
        let all: Vec<ObjectId> = self.scene.objects.iter().map(|object| object.id).collect();
        let mut found = self.ground().narrow(phrase, &all);
        // `which shelves do you see there?`
        let is_here = question.rest.iter().any(|word| matches!(word.as_str(), "see" | "here" | "there"));
        if is_here {
            found.retain(|id| self.scene.object(*id).is_some_and(|object| object.room == self.scene.robot.room));
        }
        if phrase.relations.iter().any(|relation| relation.kind == RelationKind::For) {
            found.retain(|id| self.scene.object(*id).is_some_and(|object| object.works.is_some()));
        }
        if phrase.side.is_some()
            && let Ok(nearest) = self.ground().one(phrase, &Want::place(Intent::Find, &[], None))
        {
            found = vec![nearest];
        }
        match found {
            found if found.is_empty() => {
                let text =
                    if is_here { "None that I have seen here. I can look around." } else { "None that I know of." };
                Understanding::whether(false, text, Vec::new())
            }
            found => {
                let names: Vec<String> = found.iter().take(contents::LIST).map(|id| self.full(*id)).collect();
                Understanding::about(describe::sentence(&describe::list(&names, "and")), found)
            }
        }
    }

    fn seeing(&self) -> Understanding {
        let visible: Vec<&KnownObject> = self.scene.objects.iter().filter(|object| object.visible).collect();
        let here: Vec<&KnownObject> =
            self.scene.objects.iter().filter(|object| object.room == self.scene.robot.room).collect();
        let (list, start) = if visible.is_empty() { (here, "Around me there is") } else { (visible, "I see") };
        if list.is_empty() {
            return Understanding::whether(false, "I see nothing of note here.", Vec::new());
        }
        Understanding::answer(format!("{start} {}.", self.listed(&list)))
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

    /// The same with what is known of the object.
    pub(crate) fn with_known(&self, phrase: &Phrase, then: impl Fn(&KnownObject) -> Understanding) -> Understanding {
        let of = |id| self.scene.object(id).map_or_else(|| Understanding::refusal(HINT), &then);
        self.with_object(phrase, of)
    }

    pub(crate) fn unseen(&self, phrase: &Phrase) -> Understanding {
        if saying::noun(phrase).is_none() {
            return Understanding::refusal(saying::unresolved(phrase));
        }
        let said = saying::said(phrase);
        if self.scene.floor.is_some() && (phrase.unknown.is_empty() || !phrase.namings.is_empty()) {
            let text = format!("I have not seen {said} yet. Shall I look for it?");
            return crate::ask::confirmation(text);
        }
        let text = format!("I have not seen {said}. I can look around if you want.");
        Understanding::whether(false, text, Vec::new())
    }

    /// The room that words name.
    fn room_in(&self, words: &[String]) -> Option<RoomId> {
        (0..words.len()).find_map(|at| self.lexicon.rooms.longest(&words[at..]).map(|(_, room)| *room))
    }

    fn way_to(&self, room: RoomId) -> String {
        let name = room.name_in(self.catalog);
        if room == self.scene.robot.room {
            return format!("This is the {name}.");
        }
        format!("I know the way to the {name}: say \"go to the {name}\", and I will show you.")
    }

    pub(crate) fn place_of(&self, phrase: &Phrase) -> Understanding {
        let want = Want::place(Intent::Find, &[], None);
        let Ok(found) = self.ground().plausible(phrase, &want) else { return self.elsewhere(phrase) };
        let places: Vec<String> = found.iter().take(contents::LIST).map(|id| self.place_sentence(*id)).collect();
        Understanding::whether(true, describe::sentence(&describe::list(&places, "and")), found)
    }

    /// What is not where it was asked for may be known to be somewhere else.
    fn elsewhere(&self, phrase: &Phrase) -> Understanding {
        let bare = Phrase { room: None, is_here: false, relations: Vec::new(), ..phrase.clone() };
        let want = Want::place(Intent::Find, &[], None);
        match self.ground().plausible(&bare, &want) {
            Ok(found) if bare != *phrase && !found.is_empty() => {
                let places: Vec<String> =
                    found.iter().take(contents::LIST).map(|id| self.place_sentence(*id)).collect();
                Understanding::whether(false, format!("No, but {}.", describe::list(&places, "and")), found)
            }
            _ => self.unseen(phrase),
        }
    }

    pub(crate) fn place_sentence(&self, id: ObjectId) -> String {
        let (place, the) = (describe::location(self.catalog, self.scene, id), self.short(id));
        if !place.is_empty() {
            return format!("{the} {} {place}", describe::is(&the));
        }
        let side = self.scene.object(id).map_or("", |object| {
            let bearing = self.scene.bearing_rad(object);
            match bearing {
                _ if bearing.abs() < 0.6 => "in front of me",
                _ if bearing.abs() > 2.4 => "behind me",
                _ if bearing > 0.0 => "to my left",
                _ => "to my right",
            }
        });
        format!("{the} {} here in the {}, {side}", describe::is(&the), self.scene.robot.room.name_in(self.catalog))
    }

    fn room_contents(&self, room: RoomId) -> Understanding {
        let there: Vec<&KnownObject> = self.scene.objects.iter().filter(|object| object.room == room).collect();
        let place = format!("in the {}", room.name_in(self.catalog));
        if there.is_empty() {
            return Understanding::whether(false, format!("I have seen nothing {place} yet."), Vec::new());
        }
        let verb = if there.len() > 1 { "are" } else { "is" };
        let text =
            format!("{} there {verb} {}.", describe::sentence(&place).trim_end_matches('.'), self.listed(&there));
        Understanding::whether(true, text, Vec::new())
    }

    /// What lies about on the floor of this room.
    fn on_floor(&self) -> Understanding {
        let lies = |object: &&KnownObject| {
            let is_carried = self.catalog.class(object.class).has(Property::Pickupable);
            is_carried && object.parent.is_none() && object.room == self.scene.robot.room
        };
        let there: Vec<&KnownObject> = self.scene.objects.iter().filter(lies).collect();
        let ids = there.iter().map(|object| object.id).collect();
        let verb = if there.len() > 1 { "are" } else { "is" };
        match there.is_empty() {
            true => Understanding::whether(false, "I see nothing on the floor here but furniture.", ids),
            false => Understanding::whether(true, format!("On the floor there {verb} {}.", self.listed(&there)), ids),
        }
    }

    fn contents(&self, id: ObjectId) -> Understanding {
        if let Some(text) = contents::inside(self.catalog, self.scene, id, self.told) {
            let highlight = self.scene.contents(id).map(|object| object.id).collect();
            return Understanding::whether(true, describe::sentence(&text), highlight);
        }
        if let Some(note) = self.scene.object(id).filter(|object| !object.text.is_empty()) {
            return self.read_out(note);
        }
        let place = self.short(id);
        if let Some(filling) = self.fillings(id) {
            return Understanding::whether(true, format!("There is {filling} in {place}."), vec![id]);
        }
        let is_vessel = |object: &KnownObject| {
            let class = self.catalog.class(object.class);
            class.has(Property::Fillable) && class.has(Property::Pickupable)
        };
        if self.scene.object(id).is_some_and(is_vessel) {
            return Understanding::whether(false, describe::sentence(&format!("{place} is empty")), vec![id]);
        }
        // `what is on the screen of the computer?`
        let carries = |object: &&KnownObject| self.catalog.class(object.class).receptacle.is_some();
        match self.scene.object(id).filter(|object| !carries(object)) {
            Some(object) => {
                let purpose = if self.facts().has_use(object) { self.facts().purpose(object) } else { String::new() };
                let text = format!("There is nothing on {place} that I could read or take. {purpose}");
                Understanding::whether(false, text.trim(), vec![id])
            }
            None => {
                let preposition = describe::preposition(self.catalog, self.scene, id);
                Understanding::whether(false, format!("I know of nothing {preposition} {place}."), Vec::new())
            }
        }
    }

    /// What is next to a thing, the nearest first.
    fn neighbours(&self, id: ObjectId) -> Understanding {
        let Some(object) = self.scene.object(id) else { return Understanding::refusal(HINT) };
        let apart_m = |other: &KnownObject| known::distance_m(object.position_m, other.position_m);
        let is_free = |other: &&KnownObject| {
            let is_within = |inner: ObjectId, outer: ObjectId| self.scene.ancestors(inner).any(|one| one.id == outer);
            other.id != id
                && other.room == object.room
                && self.scene.robot.held != Some(other.id)
                && !is_within(other.id, id)
                && !is_within(id, other.id)
                && apart_m(other) < ground::NEAR_M
        };
        let mut near: Vec<&KnownObject> = self.scene.objects.iter().filter(is_free).collect();
        near.sort_by(|one, other| apart_m(one).total_cmp(&apart_m(other)).then(one.id.cmp(&other.id)));
        near.truncate(NEIGHBOURS);
        let the = self.short(id);
        if near.is_empty() {
            return Understanding::whether(false, format!("I know of nothing next to {the}."), Vec::new());
        }
        let names: Vec<String> = near.iter().map(|other| self.short(other.id)).collect();
        let verb = if near.len() > 1 { "are" } else { "is" };
        let text = format!("Next to {the} {verb} {}.", describe::list(&names, "and"));
        Understanding::whether(true, text, near.iter().map(|other| other.id).collect())
    }

    fn read_out(&self, note: &KnownObject) -> Understanding {
        let the = describe::sentence(&self.full(note.id));
        let text = format!("{} says: \"{}\"", the.trim_end_matches('.'), note.text);
        Understanding::whether(true, text, vec![note.id])
    }

    fn text(&self, phrase: Option<&Phrase>) -> Understanding {
        let notes = || self.scene.objects.iter().filter(|object| !object.text.is_empty());
        let of_phrase = phrase.filter(|phrase| !phrase.is_empty()).and_then(|phrase| {
            let want = Want::place(Intent::Find, &[], None);
            self.ground().one(phrase, &want).ok().and_then(|id| self.scene.object(id))
        });
        if let Some(object) = of_phrase.filter(|object| object.text.is_empty()) {
            // `what does the scale show?`
            if self.scene.contents(object.id).next().is_some() {
                return self.contents(object.id);
            }
            let text = format!("I see nothing written on {} that I could read.", self.short(object.id));
            return Understanding::whether(false, text, vec![object.id]);
        }
        let nearest = || {
            notes().min_by(|a, b| self.scene.distance_m(a).total_cmp(&self.scene.distance_m(b)).then(a.id.cmp(&b.id)))
        };
        match of_phrase.or_else(nearest) {
            Some(note) => self.read_out(note),
            None => {
                let text = "I know of nothing written here. I can look at a note if you point me to one.";
                Understanding::whether(false, text, Vec::new())
            }
        }
    }

    /// The colour of a thing, or of each that may be meant.
    fn colors(&self, phrase: &Phrase) -> Understanding {
        let want = Want::place(Intent::Find, &[], None);
        let Ok(found) = self.ground().plausible(phrase, &want) else {
            return self.with_object(phrase, |id| {
                Understanding::about(describe::sentence(&self.color_sentence(id)), vec![id])
            });
        };
        let mut said: Vec<String> = found.iter().take(contents::LIST).map(|id| self.color_sentence(*id)).collect();
        said.dedup();
        Understanding::about(describe::sentence(&describe::list(&said, "and")), found)
    }

    fn color_sentence(&self, id: ObjectId) -> String {
        let Some(object) = self.scene.object(id) else { return String::new() };
        let name = describe::name(self.catalog, object.class);
        format!("the {name} {} {}", describe::is(&name), describe::color(self.catalog, object))
    }

    fn distance(&self, id: ObjectId) -> Understanding {
        let Some(object) = self.scene.object(id) else { return Understanding::refusal(HINT) };
        let meters = self.scene.distance_m(object);
        let text = format!("{} is {meters:.1} m away from me.", self.short(id));
        Understanding::about(describe::sentence(&text), vec![id])
    }

    fn count(&self, phrase: &Phrase, question: &Question) -> Understanding {
        let is_them = phrase.is_many() || phrase.is_one_of_kind();
        if is_them && self.context.focus.group.is_empty() {
            return Understanding::lost(saying::unresolved(phrase));
        }
        let all: Vec<ObjectId> = match is_them {
            true => self.context.focus.group.clone(),
            false => self.scene.objects.iter().map(|object| object.id).collect(),
        };
        let bare = Phrase { pronoun: None, ..phrase.clone() };
        let mut found = self.ground().narrow(if is_them { &bare } else { phrase }, &all);
        // `how many mugs are empty`
        let state = asked_state(self.lexicon, &question.rest).filter(|(state, _)| !phrase.states.contains(state));
        if let Some((state, _)) = state {
            found.retain(|id| self.scene.object(*id).is_some_and(|object| self.is_so(object, state)));
        }
        let noun = saying::noun_or_thing(phrase);
        let text = match found.len() {
            0 => format!("I know of no {noun}."),
            1 => format!("I know of one: {}.", self.full(found[0])),
            count if noun.contains(' ') => format!("I know of {count}."),
            count => format!("I know of {count} {}.", describe::plural(noun)),
        };
        Understanding::whether(!found.is_empty(), text, found)
    }

    /// What is known of a thing, after why that is no answer.
    pub(crate) fn all_known(&self, object: &KnownObject, why: &str) -> Understanding {
        let known = describe::sentence(&self.facts().description(object));
        Understanding::about(format!("{why}. What I know: {known}"), vec![object.id])
    }
}

/// What is said of recordings: every session is.
const RECORDED: &str = "Yes: what is said, and what I see and do, is written into the log of this session.";

fn empty_handed(text: &str) -> Understanding {
    Understanding::whether(false, text, Vec::new())
}
