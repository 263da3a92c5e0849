//! One turn of a conversation: answers to the robot's own questions first (see [`crate::asked`]), then questions, then
//! requests.

use cohabit_cdf::{Catalog, ObjectId};

use crate::{
    answer::HINT,
    ask::{self, Ask},
    asked::plain,
    chatter,
    clause::{self, Clause, Part},
    confidence::Referents,
    context::{Consent, Context, Focus, Guess, Pending},
    describe,
    ground::{Ground, Miss, Want},
    habits::Habits,
    intent::Intent,
    judge::Judge,
    known::Known,
    lexicon::{Lexicon, Small},
    phrase::{Phrase, Place, RelationKind},
    plan::{Fault, Planner},
    process::Devices,
    question::{self, QuestionKind},
    remedy, reply,
    rewritten::Rewrite,
    room_kind,
    search::Search,
    spelling,
    stop::{self, Firmness, Stop},
    tidy,
    token::{self, MAX_CHARS},
    understanding::{Asking, Step, Understanding},
    way::Way,
};

/// All that stays the same during a turn.
#[derive(Clone, Copy)]
pub(crate) struct Conversation<'a> {
    pub(crate) catalog: &'a Catalog,
    pub(crate) lexicon: &'a Lexicon,
    pub(crate) devices: &'a Devices,
    pub(crate) habits: &'a Habits,
    pub(crate) scene: &'a Known,
    pub(crate) judge: Judge<'a>,
    pub(crate) rewriter: Option<Rewrite>,
}

impl Conversation<'_> {
    pub(crate) fn understand(&self, utterance: &str, context: &mut Context) -> Understanding {
        context.unwatched = None;
        let (understanding, sureness) = self.understand_surely(utterance, context);
        let is_lost = matches!(understanding, Understanding::Refusal { is_lost: true, .. });
        context.sureness = if is_lost { 0.0 } else { sureness };
        self.with_a_look(utterance, understanding, context)
    }

    /// The same with how likely it is what was meant.
    fn understand_surely(&self, utterance: &str, context: &mut Context) -> (Understanding, f32) {
        if let Some(understanding) = self.chosen_by_name(utterance, context) {
            return (understanding, 1.0);
        }
        if let Some(stop) = stop::find_stop(utterance).filter(|stop| is_heeded(stop, context))
            && (context.is_busy() || !self.is_wait(&self.lexicon.normalise(utterance).0))
        {
            return self
                .asked_at_rest(&stop, utterance, context)
                .unwrap_or_else(|| (self.stopped(&stop.rest, context), 1.0));
        }
        self.understand_whole(utterance, context)
    }

    /// `that will do, off with it`, to a robot that does nothing: what is asked for beside the stop, said before it or after it.
    fn asked_at_rest(&self, stop: &Stop, utterance: &str, context: &mut Context) -> Option<(Understanding, f32)> {
        if stop.is_all || context.is_busy() || context.pending.is_some() || context.awaits() {
            return None;
        }
        let ways = self.rewritten(&self.wording(utterance), context);
        if ways.first().is_none_or(Way::stops) {
            return None;
        }
        let mut then = context.clone();
        let understood = self.understand_whole(utterance, &mut then);
        let is_reply = matches!(understood.0, Understanding::Plan { .. } | Understanding::Answer { .. });
        is_reply.then(|| {
            *context = then;
            understood
        })
    }

    /// It stops, and then does what else was asked for.
    pub(crate) fn stopped(&self, rest: &str, context: &mut Context) -> Understanding {
        context.pending = None;
        context.running.clear();
        context.failed = None;
        context.search = None;
        context.awaited = None;
        context.later.clear();
        let then = self.asks_for_anything(rest).then(|| Box::new(self.understand_whole(rest, context).0));
        Understanding::Stop { reply: STOPS.to_owned(), then }
    }

    /// Whether there is a request or a question in a text, rather than the reason for a stop.
    pub(crate) fn asks_for_anything(&self, text: &str) -> bool {
        if text.is_empty() || text.chars().nth(MAX_CHARS).is_some() {
            return !text.is_empty();
        }
        let (words, _) = self.lexicon.normalise(text);
        let words = tidy::tidied(self.lexicon, &words);
        let asks = |part: &Part| {
            let Part::Clause(clause) = part else { return false };
            !matches!(clause.intent, Intent::Stop | Intent::Mention) && !clause.is_wish && chatter::is_clear(clause)
        };
        let is_question = || question::read(self.lexicon, &words).is_some_and(|one| one.kind != QuestionKind::Unknown);
        clause::parts(self.lexicon, self.catalog, &words).iter().any(asks) || is_question()
    }

    /// What the grammar makes of what was said.
    pub(crate) fn understand_said(&self, utterance: &str, context: &mut Context) -> Understanding {
        if utterance.chars().nth(MAX_CHARS).is_some() {
            return Understanding::refusal("That is too much for me at once. Please say it in a few short sentences.");
        }
        let (words, repairs) = self.lexicon.normalise(utterance);
        if let Some(understanding) = self.waits(&words, context) {
            return understanding;
        }
        let words = tidy::tidied(self.lexicon, &words);
        let this = Self { judge: Judge { repairs, ..self.judge }, ..*self };
        // What a recogniser took for other words is best told from those words, not from repaired ones.
        let as_said = tidy::tidied(self.lexicon, &self.lexicon.as_said(utterance));
        let others = (as_said != words).then_some(as_said);
        this.understand_heard(words, others, context)
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

    pub(crate) fn understand_all(&self, words: Vec<String>, context: &mut Context) -> Understanding {
        if words.iter().all(|word| token::is_punctuation(word)) {
            return Understanding::refusal(format!("I did not hear anything. {HINT}"));
        }
        // `wait, how many are there?`, in answer to a question
        let words =
            if context.pending.is_some() || self.pauses_to_ask(&words) { self.without_pause(words) } else { words };
        if let Some(Pending::Lab { words: before, at }) = &context.pending
            && !self.asks_for_more(&words)
            && let Some(kind) = room_kind::standing_at(self.lexicon, self.scene, before, *at)
            && let Some(room) = kind.answered(self.lexicon, self.scene, &words)
        {
            let words = kind.named(before, room, self.catalog);
            let later = std::mem::take(&mut context.later);
            let open = context.pending.take();
            let understanding = self.understand_words(words, context);
            return context.keep_both(later, open.as_ref(), understanding);
        }
        self.understand_words(words, context)
    }

    pub(crate) fn understand_words(&self, words: Vec<String>, context: &mut Context) -> Understanding {
        let parts = clause::parts(self.lexicon, self.catalog, &words);
        // `why did you stop` asks.
        if stops(&parts) && question::read(self.lexicon, &words).is_none() {
            return self.stopped("", context);
        }
        let open = context.pending.clone();
        let later = std::mem::take(&mut context.later);
        if let Some(understanding) = self.answer_to_pending(&words, &parts, context) {
            return context.keep_both(later, open.as_ref(), understanding);
        }
        context.later = later;
        if let Some(understanding) = self.answered_first(&words, open.as_ref(), context) {
            return understanding;
        }
        let kind = room_kind::bare(self.lexicon, self.scene, &words);
        if let Some(kind) = kind.filter(|kind| !clause::is_forbidden(self.lexicon, &words, kind.at)) {
            let furnished = || kind.furnished(self.lexicon, self.catalog, self.scene, &words);
            if let Some(room) = kind
                .described(self.lexicon, self.scene, kind.after(&words))
                .or_else(|| kind.beside(self.lexicon, &words))
                .or_else(furnished)
            {
                return self.understand_words(kind.named(&words, room, self.catalog), context);
            }
            let guessed = || (self.judge.asking == Asking::Never).then(|| kind.guessed(self.scene));
            if let Some(room) = kind.here(self.scene.robot.room).or_else(guessed) {
                return self.understand_words(kind.named(&words, room, self.catalog), context);
            }
            context.pending = Some(Pending::Lab { words, at: kind.at });
            return kind.question(self.catalog);
        }
        let understanding = self.fresh(&words, parts, context);
        // What was said in between leaves the robot's own question open.
        if matches!(understanding, Understanding::Answer { .. } | Understanding::Refusal { .. }) {
            context.pending = context.pending.take().or(open);
        }
        understanding
    }

    /// What was said, if it is no answer to a question of the robot's.
    fn fresh(&self, words: &[String], parts: Vec<Part>, context: &mut Context) -> Understanding {
        if let Some(understanding) = self.small_talk(words, context) {
            return understanding;
        }
        if let Some(understanding) = self.answered_yes_or_no(words, context) {
            return understanding;
        }
        if let Some(understanding) = self.on_condition(words, context) {
            return understanding;
        }
        // `when you get a minute, bring me the knife` asks for no time.
        let is_asked_to = |question: &question::Question| {
            let is_when = words
                .iter()
                .find(|word| !token::is_punctuation(word))
                .is_some_and(|word| word == "when" || word == "what");
            let asks = |part: &Part| matches!(part, Part::Clause(clause) if chatter::is_clear(clause));
            question.kind == QuestionKind::Unknown
                && is_when
                && words.iter().any(|word| word == ",")
                && parts.iter().any(asks)
        };
        if let Some(question) = question::read(self.lexicon, words).filter(|question| !is_asked_to(question)) {
            return self.answer(&question, context);
        }
        if self.is_foreign(words) {
            return self.unclear(&clause::unknown_words(self.lexicon, words));
        }
        self.request(words, parts, context)
    }

    /// `go there`, `put it there`, after an answer about `id`: itself, or what carries it.
    pub(crate) fn place_spoken_of(&self, id: ObjectId) -> Option<ObjectId> {
        let object = self.scene.object(id)?;
        let is_carried = self.catalog.class(object.class).has(cohabit_cdf::Property::Pickupable);
        if is_carried { object.parent } else { Some(id) }
    }

    /// Takes back the last plan.
    fn undo(&self, context: &mut Context) -> Understanding {
        if context.last_plan.is_empty() {
            return Understanding::answer("There is nothing to undo yet.");
        }
        if !context.running.is_empty() {
            return self.stopped("", context);
        }
        if context.failed.is_some() {
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

    pub(crate) fn request(&self, words: &[String], parts: Vec<Part>, context: &mut Context) -> Understanding {
        context.search = None;
        context.later.clear();
        context.reason = format!("you said \"{}\"", token::sentence(words));
        let mut clauses = Vec::new();
        let mut unclear: Option<Vec<String>> = None;
        let (mut fragment, mut aside) = (None, Vec::new());
        let mut is_forbidden = false;
        for part in parts {
            match part {
                Part::Clause(clause) if clause.intent == Intent::Stop => {}
                Part::Clause(clause) => clauses.push(clause),
                Part::Forbidden(about) => {
                    is_forbidden = true;
                    clauses.extend(about.map(Clause::mention));
                }
                Part::Mention(phrase) => clauses.push(Clause::mention(phrase)),
                Part::Fragment(phrase) if self.is_to_be_there(&phrase, context) => {
                    clauses.extend(clause::placing(phrase))
                }
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
            // `and the trophy`, after `where is the knife`
            let goes_on = context.question.is_some() && matches!(words[0].as_str(), "and" | "or" | "how" | "what");
            let mentioned = clauses.into_iter().flat_map(|clause| clause.objects).next();
            return match (fragment.or(mentioned), unclear) {
                _ if is_forbidden => Understanding::answer("All right, I will not do that."),
                (_, Some(words)) if !words.is_empty() => self.unclear(&words),
                (Some(phrase), _) if words.last().is_some_and(|word| word == "?") || goes_on => {
                    let kind = context.question.filter(|_| goes_on).unwrap_or(QuestionKind::Where);
                    let question = question::Question::new(kind, Some(phrase), words.to_vec());
                    self.answer(&question, context)
                }
                (Some(phrase), _) => self.fragment(&phrase, context),
                (None, _) => self.unclear(&aside),
            };
        }
        // A part with unknown words could change all the rest: better to ask than to do half of it.
        if let Some(words) = unclear.filter(|words| !words.is_empty()) {
            return self.unclear(&words);
        }
        // `make me a bowl of cereal`: no cartridge is for that, but it is what the mission is about.
        if let [clause] = clauses.as_slice()
            && self.prints_nothing(clause)
            && self.is_of_mission(clause)
        {
            return self.pursue(context);
        }
        let clauses = clauses.into_iter().map(|clause| clause::poured(self.catalog, clause)).collect();
        self.plan(clause::joined(clauses), Consent::default(), context)
    }

    /// That nothing was understood, and the words that nobody ever met.
    pub(crate) fn unclear(&self, words: &[String]) -> Understanding {
        reply::unclear(&words.iter().filter(|word| !spelling::is_english(word)).cloned().collect::<Vec<_>>())
    }

    /// `both apples on the plate`, of such as are not on it: there they are to be.
    fn is_to_be_there(&self, phrase: &Phrase, context: &Context) -> bool {
        let [relation] = phrase.relations.as_slice() else { return false };
        if relation.kind != RelationKind::Inside || phrase.namings.is_empty() || relation.to.namings.is_empty() {
            return false;
        }
        let ground = Ground { catalog: self.catalog, scene: self.scene, focus: &context.focus, judge: self.judge };
        let bare = Phrase { relations: Vec::new(), ..phrase.clone() };
        let want = Want::object(Intent::Place);
        let is_carried = |id: &ObjectId| {
            let object = self.scene.object(*id);
            object.is_some_and(|object| self.catalog.class(object.class).has(cohabit_cdf::Property::Pickupable))
        };
        let elsewhere = ground.all(&bare, &want).is_ok_and(|found| found.iter().all(is_carried));
        let place = ground.all(&relation.to, &Want::place(Intent::Place, &[], None)).is_ok();
        elsewhere && place && matches!(ground.all(phrase, &want), Err(Miss::Mismatch(_)))
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
        let request = reply::request_in_words(&clauses);
        if !request.is_empty() {
            context.reason = format!("{}{request}", reply::ASKED_TO);
        }
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
        if self.judge.asking == Asking::Always && !consent.is_agreed && planner.steps.iter().any(Step::commits) {
            let question = ask::shall_i(&planner.steps, &notes);
            context.pending = Some(Pending::Offer { plans: vec![planner.steps] });
            return question;
        }
        context.focus = planner.focus;
        self.remember_start(&planner.steps, context);
        let text = reply::plan_reply(&planner.steps, &notes);
        context.is_met = planner.steps.is_empty();
        if context.is_met {
            (context.pending, context.search) = (None, None);
            return Understanding::answer(text);
        }
        context.begin(&planner.steps);
        Understanding::Plan { steps: planner.steps, reply: text }
    }

    /// Where the robot stands, if it is about to leave.
    pub(crate) fn remember_start(&self, steps: &[Step], context: &mut Context) {
        if steps.iter().any(Step::commits) {
            let [x, y, _] = self.scene.robot.position_m;
            context.focus.start_m = Some([x, y]);
        }
    }

    /// A question, where an answer would help; a refusal with its reason otherwise.
    pub(crate) fn fault(
        &self,
        fault: Fault,
        mut clauses: Vec<Clause>,
        consent: Consent,
        context: &mut Context,
    ) -> Understanding {
        if let Fault::Miss { slot: Some(slot), .. } = &fault {
            slot.make_room(&mut clauses);
        }
        (context.pending, context.search) = (None, None);
        let asks = self.judge.asking != Asking::Never;
        match fault {
            // What nothing makes was perhaps not to be made.
            Fault::Need { classes, text } if classes.is_empty() => Understanding::lost(text),
            Fault::Cannot(text) | Fault::Need { text, .. } => Understanding::refusal(text),
            Fault::Offer { text, steps } if asks => {
                context.pending = Some(Pending::Offer { plans: vec![steps] });
                ask::confirmation(text)
            }
            Fault::Offer { text, .. } => Understanding::refusal(text),
            // To put down what it holds is little, and easily undone.
            Fault::HandFull { held, .. }
                if self.scene.robot.held == Some(held)
                    && !consent.may_put_down
                    && self.judge.asking != Asking::Always =>
            {
                self.proceed(Search::new(clauses, Consent { may_put_down: true, ..consent }), context)
            }
            Fault::HandFull { held, .. } => {
                context.pending = Some(Pending::PutDown { clauses });
                // What is asked for before may have it take that first.
                let holds = if self.scene.robot.held == Some(held) { "I am holding" } else { "I will be holding" };
                let held = describe::short(self.catalog, self.scene, held);
                ask::confirmation(format!("{holds} {held}. Shall I put it down first?"))
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
            Fault::Miss { slot: Some(slot), phrase, miss: miss @ (Miss::NoReferent | Miss::Unknown), intent }
                if asks && phrase.unknown.is_empty() =>
            {
                context.pending = Some(Pending::Look { clauses, slot, consent });
                ask::referent(reply::miss(&phrase, &miss, intent, Some(slot.role)))
            }
            Fault::Miss { slot: Some(slot), phrase, .. }
                if asks && phrase.namings.is_empty() && !phrase.unknown.is_empty() =>
            {
                context.pending = Some(Pending::Look { clauses, slot, consent });
                ask::appearance(&phrase)
            }
            Fault::Miss { phrase, miss, intent, .. } => {
                let text = reply::miss(&phrase, &miss, intent, None);
                if phrase.unknown.is_empty() { Understanding::refusal(text) } else { Understanding::lost(text) }
            }
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
        let plainly = || -> Vec<String> {
            words.iter().filter(|word| !self.lexicon.fillers.adverbs.contains(*word)).cloned().collect()
        };
        let several = || self.several_smalls(&words).and_then(known);
        known(&words).or_else(several).or_else(|| known(&plainly())).unwrap_or_default()
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
        // `why not?` asks, where the robot did not.
        let is_why = || question::read(self.lexicon, words).is_some_and(|asked| asked.kind == QuestionKind::Why);
        if (is(Small::Yes) || is(Small::No)) && !is_why() {
            let failure = context.failed.take();
            return Some(match failure {
                Some(failure) if is(Small::Yes) => self.mend(&failure, context),
                _ if is(Small::Yes) => Understanding::answer("OK. What shall I do?"),
                _ => Understanding::answer("All right."),
            });
        }
        if is(Small::Goal) {
            return Some(self.next_goal(context));
        }
        if is(Small::Mission) {
            return Some(self.pursue(context));
        }
        if is(Small::Undo) || self.is_undo(words) {
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

    /// `undo the previous command`.
    fn is_undo(&self, words: &[String]) -> bool {
        let words = plain(words);
        let spare = |word: &String| self.lexicon.undone.exact(std::slice::from_ref(word)).is_some();
        let (verb, rest) = words.split_first().map_or(("", &[][..]), |(verb, rest)| (verb.as_str(), rest));
        matches!(verb, "undo" | "revert" | "reverse") && !rest.is_empty() && rest.iter().all(spare)
    }

    /// The remedy that was offered after a failure, then the failed step again, then the rest.
    fn mend(&self, failure: &crate::context::Failure, context: &mut Context) -> Understanding {
        let planner = self.planner(context.focus.clone());
        let remedy = remedy::remedy(planner, &failure.step, failure.status);
        let again = std::iter::once(failure.step.clone()).chain(failure.rest.iter().cloned());
        let steps = remedy.map(|remedy| remedy.steps).unwrap_or_default().into_iter().chain(again).collect();
        self.go(steps, context)
    }

    pub(crate) fn go_as_guessed(&self, guess: Guess, context: &mut Context) -> Understanding {
        let steps = guess.steps.clone();
        self.remember_start(&steps, context);
        if guess.search.is_none() {
            steps.iter().for_each(|step| context.focus.follow(&step.action));
        }
        context.begin_guessed(guess);
        Understanding::Plan { reply: reply::plan_reply(&steps, &[]), steps }
    }

    pub(crate) fn go(&self, steps: Vec<Step>, context: &mut Context) -> Understanding {
        self.remember_start(&steps, context);
        steps.iter().for_each(|step| context.focus.follow(&step.action));
        context.begin(&steps);
        Understanding::Plan { reply: reply::plan_reply(&steps, &[]), steps }
    }
}

/// What it says when it stops.
const STOPS: &str = "OK, I stop.";

/// Whether a stop is meant as one: "leave it" may answer the robot's question, and "that's plenty" and "never mind" say nothing to a
/// robot that does nothing.
fn is_heeded(stop: &Stop, context: &Context) -> bool {
    match stop.firmness {
        Firmness::Firm => true,
        Firmness::Weak => context.pending.is_none() && (context.is_busy() || stop.is_plain),
        Firmness::Dismissal => context.pending.is_none() && (context.is_busy() || context.awaits()),
    }
}

/// Whether nothing but to stop is asked for.
fn stops(parts: &[Part]) -> bool {
    let mut asked =
        parts.iter().filter_map(|part| if let Part::Clause(clause) = part { Some(clause) } else { None }).peekable();
    asked.peek().is_some() && asked.all(|clause| clause.intent == Intent::Stop)
}
