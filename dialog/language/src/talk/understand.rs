//! One turn of a conversation: answers to the robot's own questions first (see [`crate::talk::asked`]), then questions, then
//! requests.

use cohabit_cdf::ObjectId;

use crate::{
    context::{Context, Pending, search::Consent},
    ground::{
        confidence::Referents,
        judge::Judge,
        want::{Miss, Want},
    },
    plan::settle,
    read::{
        chatter,
        clause::{self, Clause, Part},
        parts,
        phrase::{Phrase, Place, RelationKind},
        question, segments, tidy, wish,
    },
    say::{ask, examples, reply},
    stop::{self, Stop, said::Firmness},
    talk::{
        conversation::Conversation,
        halted::{LEAVES_AS_IS, is_heeded, stops},
        room_kind,
    },
    understanding::{Asking, Understanding},
    words::{
        intent::Intent,
        lexicon::Small,
        question_kind::QuestionKind,
        spelling,
        token::{self, MAX_CHARS},
    },
};

/// What it says besides where an answer chose nothing, and it has to ask the same again.
const NAME_ONE: &str = "Name one of them, or say its number.";
/// What stands between two of which one is asked for, and what follows it where there is no second one: `is it hot or what?`
const OR: &str = "or";
const NO_SECOND: [&str; 5] = ["what", "not", "no", "?", "something"];

impl Conversation<'_> {
    pub(crate) fn understand(&self, utterance: &str, context: &mut Context) -> Understanding {
        context.unwatched = None;
        let followed = std::mem::take(&mut context.follows);
        context.followed = followed;
        if followed && self.lets_go(utterance) {
            context.sureness = 1.0;
            return self.stopped("", context);
        }
        let (understanding, sureness) = self.understand_hinted(utterance, context);
        let understanding = self.not_asked_twice(understanding, context);
        // Who asks for something else is not followed any longer.
        context.follows |=
            followed && !matches!(understanding, Understanding::Plan { .. } | Understanding::Stop { .. });
        let understanding = if self.offers_two(utterance) { understanding.without_yes() } else { understanding };
        let is_lost = matches!(understanding, Understanding::Refusal { is_lost: true, .. });
        context.sureness = if is_lost { 0.0 } else { sureness };
        self.with_a_look(utterance, understanding, context)
    }

    /// A question is not asked twice in a row in the same words: what nobody tells the place of is looked for, as was offered, and who
    /// is to choose is told how.
    fn not_asked_twice(&self, understanding: Understanding, context: &mut Context) -> Understanding {
        let is_asked_again = |text: &str| matches!(context.lines.last(), Some((true, last)) if last.ends_with(text));
        if !matches!(&understanding, Understanding::Question { text, .. } if is_asked_again(text)) {
            return understanding;
        }
        match context.pending.take() {
            Some(Pending::Where { clauses, slot, consent }) => {
                let later = std::mem::take(&mut context.later);
                let looks = self.look_for(clauses, slot, consent, context);
                context.keep(later, looks)
            }
            pending => {
                let is_choice = match &pending {
                    Some(Pending::Which { candidates, .. }) => candidates.len() > 1,
                    Some(Pending::Offer { plans }) => plans.len() > 1,
                    Some(Pending::Guess { guesses }) => guesses.len() > 1,
                    _ => false,
                };
                context.pending = pending;
                if is_choice { understanding.before(NAME_ONE) } else { understanding }
            }
        }
    }

    /// Whether it asks which of two is so: no yes says that.
    fn offers_two(&self, utterance: &str) -> bool {
        let words = token::words(utterance);
        let at = words.iter().position(|word| word == OR);
        utterance.trim_end().ends_with('?')
            && at.is_some_and(|at| words.get(at + 1).is_some_and(|next| !NO_SECOND.contains(&next.as_str())))
    }

    /// What is asked for, looked for where somebody thinks that it is; with how likely it is what was meant.
    fn understand_hinted(&self, utterance: &str, context: &mut Context) -> (Understanding, f32) {
        match self.without_hint(utterance) {
            Some((rest, hint)) if rest.is_empty() => match self.hinted(hint, context) {
                Some(understanding) => (understanding, 1.0),
                None => self.understand_surely(utterance, context),
            },
            Some((rest, hint)) => {
                context.hint = Some(hint);
                let understood = self.understand_surely(&rest, context);
                self.heed_hint_in_question(context);
                context.hint = None;
                understood
            }
            None => self.understand_surely(utterance, context),
        }
    }

    /// The same of what has no hint in it.
    fn understand_surely(&self, utterance: &str, context: &mut Context) -> (Understanding, f32) {
        if let Some(understanding) = self.chosen_by_name(utterance, context) {
            return (understanding, 1.0);
        }
        // `leave it` leaves what was offered besides, and stops nothing.
        let declines = |stop: &Stop| {
            !matches!(stop.firmness, Firmness::Firm)
                && matches!(context.pending, Some(Pending::Also { .. }))
                && self.small(&self.lexicon.normalise(utterance).0).contains(&Small::No)
        };
        if let Some(stop) = stop::find_stop(utterance).filter(|stop| is_heeded(stop, context) && !declines(stop))
            && (context.is_busy() || !self.is_wait(&self.lexicon.normalise(utterance).0))
        {
            return self
                .asked_at_rest(&stop, utterance, context)
                .unwrap_or_else(|| (self.stopped(&stop.rest, context), 1.0));
        }
        self.dropped(utterance, context)
            .or_else(|| self.taken_back(utterance, context))
            .unwrap_or_else(|| self.understand_whole(utterance, context))
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
        parts::parts(self.lexicon, self.catalog, &words).iter().any(asks) || is_question()
    }

    /// What the grammar makes of what was said.
    pub(crate) fn understand_said(&self, utterance: &str, context: &mut Context) -> Understanding {
        if utterance.chars().nth(MAX_CHARS).is_some() {
            return Understanding::refusal("That is too much for me at once. Please say it in a few short sentences.");
        }
        let (words, repairs) = self.lexicon.normalise(utterance);
        if let Some(understanding) = self.waits(&words, context).or_else(|| self.follows_then(&words, context)) {
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
        let this = Self { judge: Judge { repairs, ..self.judge }, ..*self };
        let ground = this.ground(&context.focus);
        parts::parts(self.lexicon, self.catalog, &words).iter().find_map(|part| {
            let Part::Clause(clause) = part else { return None };
            let place = clause.places.iter().find_map(|(_, place)| match place {
                Place::Object(phrase) => Some(phrase),
                _ => None,
            });
            let settled = settle::settle(&this.planner(context.focus.clone()), clause);
            let phrase = settled.objects.first().or(place)?;
            ground.referents(phrase, &Want::object(clause.intent))
        })
    }

    pub(crate) fn understand_all(&self, words: Vec<String>, context: &mut Context) -> Understanding {
        if words.iter().all(|word| token::is_punctuation(word)) {
            return Understanding::refusal(format!("I did not hear anything. {}", self.hint()));
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
        let parts = parts::parts(self.lexicon, self.catalog, &words);
        // `why did you stop` asks, and `it should stay there` is of a thing.
        if stops(&parts) && question::read(self.lexicon, &words).is_none() && !wish::leaves_as_is(self.lexicon, &words)
        {
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
        if let Some(kind) = kind.filter(|kind| !segments::is_forbidden(self.lexicon, &words, kind.at)) {
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
        let under_way = (context.search.clone(), context.later.clone(), context.reason.clone());
        let understanding = self.fresh(&words, parts, context);
        // What was not understood changes nothing of what is under way.
        if understanding.is_lost() {
            (context.search, context.later, context.reason) = under_way;
        }
        // What was said in between leaves the robot's own question open.
        if matches!(understanding, Understanding::Answer { .. } | Understanding::Refusal { .. }) {
            context.pending = context.pending.take().or(open);
        }
        understanding
    }

    /// What was said, if it is no answer to a question of the robot's.
    fn fresh(&self, words: &[String], parts: Vec<Part>, context: &mut Context) -> Understanding {
        if let Some(understanding) = self.corrected(words, context) {
            return understanding;
        }
        if let Some(understanding) = self.small_talk(words, context) {
            return understanding;
        }
        if let Some(understanding) = self.answered_yes_or_no(words, context) {
            return understanding;
        }
        if let Some(understanding) = self.on_condition(words, context) {
            return understanding;
        }
        if let Some(questions) = self.questions_asked(words) {
            let understand = |text: &str, context: &mut Context| Some(self.understand_said(text, context));
            let answers = self.one_after_the_other(questions, context, understand);
            return answers.unwrap_or_else(|| self.unclear(&[]));
        }
        // `why do you need a computer for it, could you not press a button?`
        if let Some(question) = self.asked_why(words).and_then(|asked| question::read(self.lexicon, asked)) {
            return self.answer(&question, context);
        }
        // `so this is the lab! What else is in here?`
        if let Some(question) = self.asked_alone(words).and_then(|asked| question::read(self.lexicon, asked)) {
            return self.answer(&question, context);
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
            return self.unclear(&segments::unknown_words(self.lexicon, words));
        }
        self.request(words, parts, context)
    }

    /// `go there`, `put it there`, after an answer about `id`: itself, or what carries it.
    pub(crate) fn place_spoken_of(&self, id: ObjectId) -> Option<ObjectId> {
        let object = self.scene.object(id)?;
        let is_carried = self.catalog.class(object.class).has(cohabit_cdf::Property::Pickupable);
        if is_carried { object.parent } else { Some(id) }
    }

    /// Whether most of the words are not known: then a verb among them is chance.
    fn is_foreign(&self, words: &[String]) -> bool {
        let said = words.iter().filter(|word| !token::is_punctuation(word)).count();
        segments::unknown_words(self.lexicon, words).iter().filter(|word| !word.contains('_')).count() * 2 > said
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
            if let Some(clause) = parts::to_room(self.lexicon, words) {
                return self.plan(vec![clause], Consent::default(), context);
            }
            // `and the trophy`, after `where is the knife`
            let goes_on = context.question.is_some() && matches!(words[0].as_str(), "and" | "or" | "how" | "what");
            let mentioned = clauses.into_iter().flat_map(|clause| clause.objects).next();
            return match (fragment.or(mentioned), unclear) {
                _ if is_forbidden => Understanding::answer("All right, I will not do that."),
                _ if wish::leaves_as_is(self.lexicon, words) => Understanding::answer(LEAVES_AS_IS),
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

    fn hint(&self) -> String {
        examples::hint(self.catalog, self.scene)
    }

    /// That nothing was understood, and the words that nobody ever met.
    pub(crate) fn unclear(&self, words: &[String]) -> Understanding {
        let words: Vec<String> = words.iter().filter(|word| !spelling::is_english(word)).cloned().collect();
        reply::unclear(&words, &self.hint())
    }

    /// `both apples on the plate`, of such as are not on it: there they are to be.
    fn is_to_be_there(&self, phrase: &Phrase, context: &Context) -> bool {
        let [relation] = phrase.relations.as_slice() else { return false };
        if relation.kind != RelationKind::Inside || phrase.namings.is_empty() || relation.to.namings.is_empty() {
            return false;
        }
        let ground = self.ground(&context.focus);
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
        let ground = self.ground(&context.focus);
        let want = Want::place(Intent::Find, &[], None);
        match ground.one(phrase, &want) {
            Ok(object) => {
                context.focus.mention(object);
                self.ask().what_with(object)
            }
            Err(_) => ask::what(),
        }
    }
}
