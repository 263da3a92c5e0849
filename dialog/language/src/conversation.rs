//! One turn of a conversation: answers to the robot's own questions first, then questions, then requests.

use cohabit_cdf::{Catalog, ObjectId};

use crate::{
    answer::{Answerer, HINT},
    clause::{self, Clause, Part},
    context::{Context, Focus, Pending, Role, Slot},
    describe,
    ground::{Ground, Miss},
    habits::Habits,
    intent::Intent,
    known::Known,
    lab,
    lexicon::{Lexicon, Preposition, Small},
    phrase::{Phrase, Place, Reader},
    plan::{Fault, Planner},
    process::Devices,
    question, remedy, reply,
    search::Search,
    token::{self, MAX_CHARS},
    understanding::{Step, Understanding},
};

/// An answer to `which lab` has fewer words than this; more is another request.
const LONGEST_LAB_ANSWER: usize = 6;

/// All that stays the same during a turn.
pub(crate) struct Conversation<'a> {
    pub(crate) catalog: &'a Catalog,
    pub(crate) lexicon: &'a Lexicon,
    pub(crate) devices: &'a Devices,
    pub(crate) habits: &'a Habits,
    pub(crate) scene: &'a Known,
}

impl Conversation<'_> {
    pub(crate) fn understand(&self, utterance: &str, context: &mut Context) -> Understanding {
        if utterance.chars().nth(MAX_CHARS).is_some() {
            return Understanding::refusal("That is too much for me at once. Please say it in a few short sentences.");
        }
        let words = self.lexicon.normalise(utterance);
        if words.iter().all(|word| token::is_punctuation(word)) {
            return Understanding::refusal(format!("I did not hear anything. {HINT}"));
        }
        if let Some(Pending::Lab { words: before, at }) = &context.pending
            && let Some(room) = lab::answered(self.lexicon, &words)
            && words.len() < LONGEST_LAB_ANSWER
        {
            let words = lab::named(before, *at, room);
            context.pending = None;
            return self.understand_words(words, context);
        }
        self.understand_words(words, context)
    }

    fn understand_words(&self, words: Vec<String>, context: &mut Context) -> Understanding {
        let parts = clause::parts(self.lexicon, self.catalog, &words);
        if parts.iter().any(|part| matches!(part, Part::Clause(clause) if clause.intent == Intent::Stop)) {
            context.pending = None;
            context.running.clear();
            context.failed = None;
            context.search = None;
            return Understanding::Stop { reply: "OK, I stop.".to_owned() };
        }
        if let Some(understanding) = self.answer_to_pending(&words, &parts, context) {
            return understanding;
        }
        if let Some(at) = lab::bare(self.lexicon, &words) {
            if let Some(room) = lab::here(self.scene.robot.room) {
                return self.understand_words(lab::named(&words, at, room), context);
            }
            context.pending = Some(Pending::Lab { words, at });
            return lab::question();
        }
        self.fresh(&words, parts, context)
    }

    /// What was said, if it is no answer to a question of the robot's.
    fn fresh(&self, words: &[String], parts: Vec<Part>, context: &mut Context) -> Understanding {
        if let Some(understanding) = self.small_talk(words, context) {
            return understanding;
        }
        if let Some(question) = question::read(self.lexicon, words) {
            let answerer = Answerer {
                catalog: self.catalog,
                lexicon: self.lexicon,
                scene: self.scene,
                focus: &context.focus,
                running: &context.running,
                failed: context.failed.as_ref(),
            };
            let answer = answerer.answer(&question);
            // Only what it has not seen makes it ask back.
            if let (Understanding::Question { .. }, Some(phrase)) = (&answer, &question.about) {
                context.pending = Some(Pending::Search { clauses: vec![Clause::find(phrase.clone())] });
            }
            if let Understanding::Answer { highlight, .. } = &answer
                && let [one] = highlight.as_slice()
            {
                context.focus.mention(*one);
                context.focus.place = self.place_spoken_of(*one);
            }
            return answer;
        }
        if self.is_foreign(words) {
            return reply::unclear(&clause::unknown_words(self.lexicon, words));
        }
        self.request(parts, context)
    }

    /// `go there`, `put it there`, after an answer about `id`: itself, or what carries it.
    fn place_spoken_of(&self, id: ObjectId) -> Option<ObjectId> {
        let object = self.scene.object(id)?;
        let is_carried = self.catalog.class(object.class).has(cohabit_cdf::Property::Pickupable);
        if is_carried { object.parent } else { Some(id) }
    }

    /// Takes back the last plan.
    fn undo(&self, context: &mut Context) -> Understanding {
        if context.last_plan.is_empty() {
            return Understanding::answer("There is nothing to undo yet.");
        }
        if context.failed.is_some() || !context.running.is_empty() {
            return Understanding::answer("That was not finished, so I cannot undo it. Tell me what to do instead.");
        }
        let mut planner = self.planner(context.focus.clone());
        match planner.undo(&context.last_plan) {
            Ok(()) => {
                context.focus = planner.focus;
                if planner.steps.is_empty() {
                    return Understanding::answer("There is nothing to undo: I only looked.");
                }
                let reply = reply::plan_reply(&planner.steps, &planner.notes);
                context.begin(&planner.steps);
                Understanding::Plan { steps: planner.steps, reply }
            }
            Err(Fault::Cannot(text)) => Understanding::refusal(text),
            Err(_) => Understanding::refusal("I cannot undo that. Tell me what to do instead."),
        }
    }

    /// Whether most of the words are not known: then a verb among them is chance.
    fn is_foreign(&self, words: &[String]) -> bool {
        let said = words.iter().filter(|word| !token::is_punctuation(word)).count();
        clause::unknown_words(self.lexicon, words).iter().filter(|word| !word.contains('_')).count() * 2 > said
    }

    fn request(&self, parts: Vec<Part>, context: &mut Context) -> Understanding {
        context.search = None;
        let mut clauses = Vec::new();
        let mut unclear: Option<Vec<String>> = None;
        let mut fragment = None;
        let mut is_forbidden = false;
        for part in parts {
            match part {
                Part::Clause(clause) => clauses.push(clause),
                Part::Forbidden => is_forbidden = true,
                Part::Fragment(phrase) => fragment = fragment.or(Some(phrase)),
                Part::Unclear(words) => unclear = unclear.or(Some(words)),
            }
        }
        if clauses.is_empty() {
            return match (fragment, unclear) {
                _ if is_forbidden => Understanding::answer("All right, I will not do that."),
                (Some(phrase), _) => self.fragment(&phrase, context),
                (None, unclear) => reply::unclear(&unclear.unwrap_or_default()),
            };
        }
        // A part with unknown words could change all the rest: better to ask than to do half of it.
        if let Some(words) = unclear.filter(|words| !words.is_empty()) {
            return reply::unclear(&words);
        }
        self.plan(clause::joined(clauses), false, context)
    }

    /// An object without a verb.
    fn fragment(&self, phrase: &Phrase, context: &mut Context) -> Understanding {
        let ground = Ground { catalog: self.catalog, scene: self.scene, focus: &context.focus };
        let want = crate::ground::Want::object(Intent::Find);
        match ground.one(phrase, &want) {
            Ok(object) => {
                context.focus.mention(object);
                reply::what_with(self.catalog, self.scene, object)
            }
            Err(_) => reply::what(),
        }
    }

    fn planner(&self, focus: Focus) -> Planner<'_> {
        remedy::planner(self.catalog, self.devices, self.scene, focus)
    }

    fn plan(&self, clauses: Vec<Clause>, may_put_down: bool, context: &mut Context) -> Understanding {
        self.proceed(Search::new(clauses, may_put_down), context)
    }

    /// What was planned is done; `found` is said first.
    pub(crate) fn planned(&self, planner: Planner<'_>, found: Option<String>, context: &mut Context) -> Understanding {
        context.focus = planner.focus;
        self.remember_start(&planner.steps, context);
        let notes: Vec<String> = found.into_iter().chain(planner.notes).collect();
        let text = reply::plan_reply(&planner.steps, &notes);
        if planner.steps.is_empty() {
            (context.pending, context.search) = (None, None);
            return Understanding::answer(text);
        }
        context.begin(&planner.steps);
        Understanding::Plan { steps: planner.steps, reply: text }
    }

    /// Where the robot stands, if it is about to leave.
    pub(crate) fn remember_start(&self, steps: &[Step], context: &mut Context) {
        use cohabit_cdf::Action::{GoTo, Interact, PickUp, Place};
        let leaves = |step: &Step| matches!(step.action, GoTo { .. } | PickUp { .. } | Place { .. } | Interact { .. });
        if steps.iter().any(leaves) {
            let [x, y, _] = self.scene.robot.position_m;
            context.focus.start_m = Some([x, y]);
        }
    }

    /// A question, where an answer would help; a refusal with its reason otherwise.
    pub(crate) fn fault(
        &self,
        fault: Fault,
        clauses: Vec<Clause>,
        may_put_down: bool,
        context: &mut Context,
    ) -> Understanding {
        (context.pending, context.search) = (None, None);
        match fault {
            Fault::Cannot(text) | Fault::Need { text, .. } => Understanding::refusal(text),
            Fault::HandFull { held, .. } => {
                context.pending = Some(Pending::PutDown { clauses });
                let held = describe::short(self.catalog, self.scene, held);
                Understanding::confirmation(format!("I am holding {held}. Shall I put it down first?"))
            }
            Fault::Miss { slot: Some(slot), phrase, miss: Miss::Several(candidates), .. } => {
                let question = reply::which(self.catalog, self.scene, Some(&phrase), &candidates);
                context.pending = Some(Pending::Which { clauses, slot, candidates, may_put_down });
                question
            }
            Fault::Miss { slot: Some(slot), phrase, miss: Miss::Mismatch(others), .. } => {
                self.ask_instead(&phrase, others, clauses, slot, may_put_down, context)
            }
            Fault::Miss { phrase, miss: Miss::Unseen, intent, .. } if phrase.unknown.is_empty() => {
                let steps = vec![Step { action: cohabit_cdf::Action::LookAround, says: "looking around".to_owned() }];
                context.pending = Some(Pending::Offer { steps });
                let text = format!("{} Shall I look around?", reply::miss(&phrase, &Miss::Unseen, intent));
                Understanding::confirmation(text)
            }
            Fault::Miss { phrase, miss, intent, .. } => Understanding::refusal(reply::miss(&phrase, &miss, intent)),
        }
    }

    /// There is none as described: perhaps another one will do.
    fn ask_instead(
        &self,
        phrase: &Phrase,
        others: Vec<ObjectId>,
        clauses: Vec<Clause>,
        slot: Slot,
        may_put_down: bool,
        context: &mut Context,
    ) -> Understanding {
        let mut candidates: Vec<ObjectId> = Vec::new();
        for other in others {
            let looks_new = candidates.iter().all(|seen| match (self.scene.object(*seen), self.scene.object(other)) {
                (Some(seen), Some(other)) => !describe::look_alike(self.catalog, seen, other),
                _ => false,
            });
            if looks_new && candidates.len() < reply::ASKED {
                candidates.push(other);
            }
        }
        let names = describe::apart(self.catalog, self.scene, &candidates);
        let said = crate::plan::said(phrase);
        let text = format!("I do not know of {said}. Do you mean {}?", describe::list(&names, "or"));
        context.pending = Some(Pending::Which { clauses, slot, candidates: candidates.clone(), may_put_down });
        reply::reference(Some(phrase), text, candidates, names)
    }

    /// The reply to what asks for nothing to be done.
    fn chat(&self, words: &[String]) -> Option<&str> {
        self.lexicon.chat.exact(&plain(words)).map(String::as_str)
    }

    fn small(&self, words: &[String]) -> Vec<Small> {
        let exact = self.lexicon.small.exact(&plain(words));
        exact.map(|smalls| smalls.iter().copied().collect()).unwrap_or_default()
    }

    /// Whether the words are a yes or a no, alone or before something else: `yes, please open it`.
    fn small_at_start(&self, words: &[String], small: Small) -> bool {
        let exact = self.small(words);
        if !exact.is_empty() {
            return exact.contains(&small);
        }
        words.first().is_some_and(|word| match small {
            Small::Yes => matches!(word.as_str(), "yes" | "yeah" | "yep" | "yup" | "sure"),
            Small::No => matches!(word.as_str(), "no" | "nope" | "nah"),
            _ => false,
        })
    }

    fn small_talk(&self, words: &[String], context: &mut Context) -> Option<Understanding> {
        let small = self.small(words);
        let is = |kind| small.contains(&kind);
        if is(Small::Again) && !context.last_plan.is_empty() {
            let steps = context.failed.take().map_or_else(
                || context.last_plan.clone(),
                |failure| std::iter::once(failure.step).chain(failure.rest).collect(),
            );
            return Some(self.go(steps, context));
        }
        if is(Small::Yes) || is(Small::No) {
            let failure = context.failed.take();
            return Some(match failure {
                Some(failure) if is(Small::Yes) => self.mend(&failure, context),
                _ if is(Small::Yes) => Understanding::answer("OK. What shall I do?"),
                _ => Understanding::answer("All right."),
            });
        }
        if is(Small::Undo) {
            return Some(self.undo(context));
        }
        if is(Small::Thanks) {
            return Some(Understanding::answer("You are welcome!"));
        }
        if is(Small::Hello) {
            return Some(Understanding::answer("Hello! What can I do for you?"));
        }
        self.chat(words).map(Understanding::answer)
    }

    /// The remedy that was offered after a failure, then the failed step again, then the rest.
    fn mend(&self, failure: &crate::context::Failure, context: &mut Context) -> Understanding {
        let planner = self.planner(context.focus.clone());
        let remedy = remedy::remedy(planner, &failure.step, failure.status);
        let again = std::iter::once(failure.step.clone()).chain(failure.rest.iter().cloned());
        let steps = remedy.map(|remedy| remedy.steps).unwrap_or_default().into_iter().chain(again).collect();
        self.go(steps, context)
    }

    fn go(&self, steps: Vec<Step>, context: &mut Context) -> Understanding {
        steps.iter().for_each(|step| context.focus.follow(&step.action));
        context.begin(&steps);
        Understanding::Plan { reply: reply::plan_reply(&steps, &[]), steps }
    }

    /// What was said, as an answer to the robot's own question; `None` if it is something else.
    fn answer_to_pending(&self, words: &[String], parts: &[Part], context: &mut Context) -> Option<Understanding> {
        let pending = context.pending.take()?;
        let is_command = parts.iter().any(|part| matches!(part, Part::Clause(_)));
        let is_no = self.small_at_start(words, Small::No);
        if is_no && !is_command && self.small(words).contains(&Small::No) {
            return Some(Understanding::answer("All right, I leave it."));
        }
        let is_yes = self.small_at_start(words, Small::Yes);
        match pending {
            Pending::PutDown { clauses } if is_yes && !is_command => Some(self.plan(clauses, true, context)),
            Pending::Offer { steps } if is_yes && !is_command => Some(self.go(steps, context)),
            Pending::Search { clauses } if is_yes && !is_command => Some(self.plan(clauses, false, context)),
            Pending::PutDown { .. } | Pending::Offer { .. } | Pending::Search { .. } | Pending::Lab { .. } => None,
            Pending::Which { clauses, slot, candidates, may_put_down } => {
                let left = self.answered(words, &candidates, is_yes, context);
                match left.as_slice() {
                    [one] => Some(self.plan(chosen(clauses, slot, *one), may_put_down, context)),
                    [] if is_command || self.is_aside(words) => None,
                    [] => {
                        let question = reply::which(self.catalog, self.scene, phrase(&clauses, slot), &candidates);
                        context.pending = Some(Pending::Which { clauses, slot, candidates, may_put_down });
                        Some(question)
                    }
                    several => {
                        let question = reply::which(self.catalog, self.scene, phrase(&clauses, slot), several);
                        let candidates = several.to_vec();
                        context.pending = Some(Pending::Which { clauses, slot, candidates, may_put_down });
                        Some(question)
                    }
                }
            }
        }
    }

    /// Whether it is a question, a courtesy or such, and so no answer.
    fn is_aside(&self, words: &[String]) -> bool {
        let aside = [Small::Hello, Small::Thanks, Small::Undo];
        question::read(self.lexicon, words).is_some()
            || self.chat(words).is_some()
            || self.small(words).iter().any(|small| aside.contains(small))
    }

    /// The candidates that an answer leaves.
    fn answered(&self, words: &[String], candidates: &[ObjectId], is_yes: bool, context: &Context) -> Vec<ObjectId> {
        let plain: Vec<String> = words.iter().filter(|word| !token::is_punctuation(word)).cloned().collect();
        if is_yes && candidates.len() == 1 {
            return candidates.to_vec();
        }
        if self.small(words).contains(&Small::Any) {
            return candidates[..candidates.len().min(1)].to_vec();
        }
        let Some(phrase) = self.answer_phrase(&plain) else { return Vec::new() };
        let ground = Ground { catalog: self.catalog, scene: self.scene, focus: &context.focus };
        let left = ground.narrow(&phrase, candidates);
        if left.len() < candidates.len() || phrase.pronoun.is_none() && candidates.len() == 1 {
            left
        } else {
            Vec::new()
        }
    }

    /// The phrase that an answer consists of, after `i mean` or `take`; `None` if there is more to it.
    fn answer_phrase(&self, words: &[String]) -> Option<Phrase> {
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
            while let Some((preposition, place)) = reader.place() {
                // `to the red one` belongs to `i am referring`.
                if preposition == Preposition::To {
                    return None;
                }
                phrase.attach(preposition, place);
            }
            reader.skip(|lexicon| &lexicon.trail);
            (reader.is_done() && phrase.says_something() && phrase.unknown.is_empty()).then_some(phrase)
        })
    }
}

/// The words without punctuation and without the robot's name.
fn plain(words: &[String]) -> Vec<String> {
    let is_address = |word: &str| matches!(word, "robot" | "tam");
    words.iter().filter(|word| !token::is_punctuation(word) && !is_address(word)).cloned().collect()
}

/// The phrase at a place of a request.
fn phrase(clauses: &[Clause], slot: Slot) -> Option<&Phrase> {
    let clause = clauses.get(slot.clause)?;
    match slot.role {
        Role::Object(index) => clause.objects.get(index),
        Role::Place(index) => match clause.places.get(index) {
            Some((_, Place::Object(phrase))) => Some(phrase),
            _ => None,
        },
    }
}

/// The clauses with one phrase settled.
fn chosen(mut clauses: Vec<Clause>, slot: Slot, object: ObjectId) -> Vec<Clause> {
    if let Some(clause) = clauses.get_mut(slot.clause) {
        match slot.role {
            Role::Object(index) => {
                if let Some(phrase) = clause.objects.get_mut(index) {
                    phrase.chosen = Some(object);
                }
            }
            Role::Place(index) => {
                if let Some((_, Place::Object(phrase))) = clause.places.get_mut(index) {
                    phrase.chosen = Some(object);
                }
            }
        }
    }
    clauses
}
