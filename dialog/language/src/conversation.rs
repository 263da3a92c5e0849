//! One turn of a conversation: answers to the robot's own questions first (see [`crate::asked`]), then questions, then
//! requests.

use cohabit_cdf::{Catalog, ObjectId};

use crate::{
    amend,
    answer::{Answerer, HINT},
    ask::{self, Ask},
    asked::plain,
    chatter,
    clause::{self, Clause, Part},
    confidence::Referents,
    context::{Consent, Context, Focus, Pending},
    describe,
    ground::{Ground, Miss, Want},
    habits::Habits,
    hearing,
    intent::Intent,
    judge::Judge,
    known::Known,
    lab,
    lexicon::{Lexicon, Small},
    phrase::{Phrase, Place},
    plan::{Fault, Planner},
    process::Devices,
    question, remedy, reply,
    search::Search,
    token::{self, MAX_CHARS},
    understanding::{Asking, Clarification, Step, Understanding},
};

/// An answer to `which lab` has fewer words than this; more is another request.
const LONGEST_LAB_ANSWER: usize = 6;

/// All that stays the same during a turn.
#[derive(Clone, Copy)]
pub(crate) struct Conversation<'a> {
    pub(crate) catalog: &'a Catalog,
    pub(crate) lexicon: &'a Lexicon,
    pub(crate) devices: &'a Devices,
    pub(crate) habits: &'a Habits,
    pub(crate) scene: &'a Known,
    pub(crate) judge: Judge<'a>,
}

impl Conversation<'_> {
    pub(crate) fn understand(&self, utterance: &str, context: &mut Context) -> Understanding {
        if utterance.chars().nth(MAX_CHARS).is_some() {
            return Understanding::refusal("That is too much for me at once. Please say it in a few short sentences.");
        }
        let (words, repairs) = self.lexicon.normalise(utterance);
        let words = amend::without_where(self.lexicon, amend::without_slips(self.lexicon, &words));
        Self { judge: Judge { repairs, ..self.judge }, ..*self }.understand_heard(words, context)
    }

    /// What was heard, or else what may have been said instead: what sounds like it, and can be done.
    fn understand_heard(&self, words: Vec<String>, context: &mut Context) -> Understanding {
        if !hearing::is_puzzled(&clause::parts(self.lexicon, self.catalog, &words), &words) {
            return self.understand_all(words, context);
        }
        let before = context.clone();
        let heard = self.understand_all(words.clone(), context);
        if !is_lost(&heard) || question::read(self.lexicon, &words).is_some() {
            return heard;
        }
        let mut asked = None;
        for reading in hearing::readings(self.lexicon, self.catalog, &words) {
            let mut then = before.clone();
            let understanding = self.understand_all(reading, &mut then);
            match understanding {
                Understanding::Plan { .. } | Understanding::Answer { .. } => {
                    *context = then;
                    return understanding;
                }
                Understanding::Question { .. } if !is_lost(&understanding) => {
                    asked = asked.or(Some((understanding, then)));
                }
                _ => {}
            }
        }
        let Some((question, then)) = asked else { return heard };
        *context = then;
        question
    }

    /// The candidates for the first referring expression of an utterance.
    pub(crate) fn referents(&self, utterance: &str, context: &Context) -> Option<Referents> {
        let (words, repairs) = self.lexicon.normalise(utterance);
        let judge = Judge { repairs, ..self.judge };
        let ground = Ground { catalog: self.catalog, scene: self.scene, focus: &context.focus, judge };
        clause::parts(self.lexicon, self.catalog, &words).iter().find_map(|part| {
            let Part::Clause(clause) = part else { return None };
            let place = clause.places.iter().find_map(|(_, place)| match place {
                Place::Object(phrase) => Some(phrase),
                _ => None,
            });
            let planner = remedy::planner(self.catalog, self.devices, judge, self.scene, context.focus.clone());
            let settled = crate::settle::settle(&planner, clause);
            let phrase = settled.objects.first().or(place)?;
            ground.referents(phrase, &Want::object(clause.intent))
        })
    }

    fn understand_all(&self, words: Vec<String>, context: &mut Context) -> Understanding {
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
        if let Some(at) = lab::bare(self.lexicon, &words).filter(|at| !clause::is_forbidden(self.lexicon, &words, *at))
        {
            let guessed = || (self.judge.asking == Asking::Never).then(|| lab::guessed(self.scene));
            if let Some(room) = lab::here(self.scene.robot.room).or_else(guessed) {
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
        // `when you get a minute, bring me the knife` asks for no time.
        let is_asked_to = |question: &question::Question| {
            let is_when = words
                .iter()
                .find(|word| !token::is_punctuation(word))
                .is_some_and(|word| word == "when" || word == "what");
            let asks = |part: &Part| matches!(part, Part::Clause(clause) if chatter::is_clear(clause));
            question.kind == question::QuestionKind::Unknown
                && is_when
                && words.iter().any(|word| word == ",")
                && parts.iter().any(asks)
        };
        if let Some(question) = question::read(self.lexicon, words).filter(|question| !is_asked_to(question)) {
            let answerer = Answerer {
                catalog: self.catalog,
                lexicon: self.lexicon,
                scene: self.scene,
                focus: &context.focus,
                judge: self.judge,
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
        if let Some(clauses) = amend::amended(self.lexicon, words, &parts, &context.request) {
            return self.plan(clauses, Consent::default(), context);
        }
        self.request(words, parts, context)
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

    fn request(&self, words: &[String], parts: Vec<Part>, context: &mut Context) -> Understanding {
        context.search = None;
        let mut clauses = Vec::new();
        let mut unclear: Option<Vec<String>> = None;
        let (mut fragment, mut aside) = (None, Vec::new());
        let mut is_forbidden = false;
        for part in parts {
            match part {
                Part::Clause(clause) => clauses.push(clause),
                Part::Forbidden => is_forbidden = true,
                Part::Mention(phrase) => clauses.push(Clause::mention(phrase)),
                Part::Fragment(phrase) => {
                    clauses.push(Clause::mention(phrase.clone()));
                    fragment = fragment.or(Some(phrase));
                }
                Part::Aside(words) => aside.extend(words),
                Part::Unclear(words) => unclear = unclear.or(Some(words)),
            }
        }
        if clauses.iter().all(|clause| clause.intent == Intent::Mention) {
            if let Some(clause) = clause::to_room(self.lexicon, words) {
                return self.plan(vec![clause], Consent::default(), context);
            }
            let mentioned = clauses.into_iter().flat_map(|clause| clause.objects).next();
            return match (fragment.or(mentioned), unclear) {
                _ if is_forbidden => Understanding::answer("All right, I will not do that."),
                (_, Some(words)) if !words.is_empty() => reply::unclear(&words),
                (Some(phrase), _) => self.fragment(&phrase, context),
                (None, _) => reply::unclear(&aside),
            };
        }
        // A part with unknown words could change all the rest: better to ask than to do half of it.
        if let Some(words) = unclear.filter(|words| !words.is_empty()) {
            return reply::unclear(&words);
        }
        self.plan(clause::joined(clauses), Consent::default(), context)
    }

    /// An object without a verb.
    fn fragment(&self, phrase: &Phrase, context: &mut Context) -> Understanding {
        let ground = Ground { catalog: self.catalog, scene: self.scene, focus: &context.focus, judge: self.judge };
        let want = Want::place(Intent::Find, &[], None);
        match ground.one(phrase, &want) {
            Ok(object) => {
                context.focus.mention(object);
                self.ask().what_with(object)
            }
            Err(_) => ask::what(),
        }
    }

    pub(crate) fn ask(&self) -> Ask<'_> {
        Ask { catalog: self.catalog, scene: self.scene }
    }

    pub(crate) fn planner(&self, focus: Focus) -> Planner<'_> {
        remedy::planner(self.catalog, self.devices, self.judge, self.scene, focus)
    }

    pub(crate) fn plan(&self, clauses: Vec<Clause>, consent: Consent, context: &mut Context) -> Understanding {
        self.proceed(Search::new(clauses, consent), context)
    }

    /// What was planned is done, or agreed upon first; `found` is said before.
    pub(crate) fn planned(
        &self,
        planner: Planner<'_>,
        consent: Consent,
        found: Option<String>,
        context: &mut Context,
    ) -> Understanding {
        let notes: Vec<String> = found.into_iter().chain(planner.notes).collect();
        if self.judge.asking == Asking::Always && !consent.is_agreed && commits(&planner.steps) {
            let question = ask::shall_i(&planner.steps, &notes);
            context.pending = Some(Pending::Offer { steps: planner.steps });
            return question;
        }
        context.focus = planner.focus;
        self.remember_start(&planner.steps, context);
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
        if commits(steps) {
            let [x, y, _] = self.scene.robot.position_m;
            context.focus.start_m = Some([x, y]);
        }
    }

    /// A question, where an answer would help; a refusal with its reason otherwise.
    pub(crate) fn fault(
        &self,
        fault: Fault,
        clauses: Vec<Clause>,
        consent: Consent,
        context: &mut Context,
    ) -> Understanding {
        (context.pending, context.search) = (None, None);
        let asks = self.judge.asking != Asking::Never;
        match fault {
            Fault::Cannot(text) | Fault::Need { text, .. } => Understanding::refusal(text),
            Fault::Offer { text, steps } if asks => {
                context.pending = Some(Pending::Offer { steps });
                ask::confirmation(text)
            }
            Fault::Offer { text, .. } => Understanding::refusal(text),
            Fault::HandFull { held, .. } => {
                context.pending = Some(Pending::PutDown { clauses });
                let held = describe::short(self.catalog, self.scene, held);
                ask::confirmation(format!("I am holding {held}. Shall I put it down first?"))
            }
            Fault::Direction => {
                context.pending = Some(Pending::Direction { clauses, clause: 0 });
                ask::direction()
            }
            Fault::Miss { slot: Some(slot), phrase, miss: Miss::Several(candidates), intent } => {
                let question = self.which(&phrase, &candidates, intent);
                context.pending = Some(Pending::Which { clauses, slot, candidates, consent });
                question
            }
            Fault::Miss { slot: Some(slot), phrase, miss: Miss::Mismatch(others), .. } => {
                let candidates = self.look_different(others);
                let question = self.ask().instead(&phrase, candidates.clone());
                context.pending = Some(Pending::Which { clauses, slot, candidates, consent });
                question
            }
            Fault::Miss { slot: Some(slot), phrase, miss: Miss::Unseen, .. } if asks && phrase.unknown.is_empty() => {
                context.pending = Some(Pending::Where { clauses, slot, consent });
                ask::location(&phrase)
            }
            Fault::Miss { slot: Some(slot), phrase, .. }
                if asks && phrase.namings.is_empty() && !phrase.unknown.is_empty() =>
            {
                context.pending = Some(Pending::Look { clauses, slot, consent });
                ask::appearance(&phrase)
            }
            Fault::Miss { phrase, miss, intent, .. } => Understanding::refusal(reply::miss(&phrase, &miss, intent)),
        }
    }

    fn which(&self, phrase: &Phrase, candidates: &[ObjectId], intent: Intent) -> Understanding {
        if let [one] = candidates
            && let Some(object) = self.scene.object(*one)
            && self.judge.is_for_good(intent, object.class)
        {
            return self.ask().for_good(Some(phrase), intent.verb(), *one);
        }
        self.ask().which(Some(phrase), candidates)
    }

    /// The first few of these that do not look alike.
    fn look_different(&self, objects: Vec<ObjectId>) -> Vec<ObjectId> {
        let mut different: Vec<ObjectId> = Vec::new();
        for other in objects {
            let looks_new = different.iter().all(|seen| match (self.scene.object(*seen), self.scene.object(other)) {
                (Some(seen), Some(other)) => !describe::look_alike(self.catalog, seen, other),
                _ => false,
            });
            if looks_new && different.len() < ask::ASKED {
                different.push(other);
            }
        }
        different
    }

    /// The reply to what asks for nothing to be done.
    pub(crate) fn chat(&self, words: &[String]) -> Option<&str> {
        self.lexicon.chat.exact(&plain(words)).map(String::as_str)
    }

    pub(crate) fn small(&self, words: &[String]) -> Vec<Small> {
        let words = plain(words);
        let known = |words: &[String]| self.lexicon.small.exact(words).map(|smalls| smalls.iter().copied().collect());
        known(&words).or_else(|| self.several_smalls(&words).and_then(known)).unwrap_or_default()
    }

    /// `neither, leave it`, `ok, once more please`: the first of several that make up all of it.
    fn several_smalls<'w>(&self, words: &'w [String]) -> Option<&'w [String]> {
        let (mut at, mut first) = (0, None);
        while at < words.len() {
            let rest = &words[at..];
            let small = self.lexicon.small.longest(rest).map_or(0, |(length, _)| length);
            let polite = matches!(
                rest[0].as_str(),
                "please" | "ok" | "okay" | "well" | "hmm" | "oh" | "then" | "and" | "so" | "which"
            );
            if small == 0 && !polite {
                return None;
            }
            if small > 0 && !(polite && small == 1) {
                first = first.or(Some(&rest[..small]));
            }
            at += small.max(1);
        }
        first
    }

    /// Whether the words are a yes or a no, alone or before something else: `yes, please open it`.
    pub(crate) fn small_at_start(&self, words: &[String], small: Small) -> bool {
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

    pub(crate) fn go(&self, steps: Vec<Step>, context: &mut Context) -> Understanding {
        self.remember_start(&steps, context);
        steps.iter().for_each(|step| context.focus.follow(&step.action));
        context.begin(&steps);
        Understanding::Plan { reply: reply::plan_reply(&steps, &[]), steps }
    }
}

/// Whether it does more than look and point.
fn commits(steps: &[Step]) -> bool {
    use cohabit_cdf::Action::{GoTo, Interact, PickUp, Place};
    steps.iter().any(|step| matches!(step.action, GoTo { .. } | PickUp { .. } | Place { .. } | Interact { .. }))
}

/// Whether little came of an utterance.
const fn is_lost(understanding: &Understanding) -> bool {
    match understanding {
        Understanding::Refusal { .. } => true,
        Understanding::Question { kind, .. } => {
            matches!(
                kind,
                Clarification::Appearance | Clarification::Location | Clarification::Request | Clarification::Direction
            )
        }
        _ => false,
    }
}
