//! What is done later: at a time, or once something is so. "Wait ten seconds, then close it", "when the mug is full, bring it to me",
//! "wait until the light is off".
//!
//! Whoever holds the conversation calls [`crate::Language::wake`] now and then, with the time; until then nothing is done.

use cohabit_cdf::{ObjectId, Property, StateFlag};

use crate::{
    context::{
        Context,
        awaited::{Awaited, Until},
        search::Consent,
    },
    ground::want::Want,
    known::describe,
    read::{clause::Clause, phrase::Phrase, reader::Reader, tidy},
    talk::{
        condition::{Truth, trimmed},
        conversation::Conversation,
    },
    understanding::Understanding,
    words::{intent::Intent, prose, token},
};

/// The longest that is waited for something to be so, s.
const LONGEST_S: f32 = 600.0;
/// The longest time that may be asked for, s.
const MOST_S: f32 = 3600.0;

/// The parts of what was said.
struct Said {
    /// Which of its words begins the wait: what is said before is done before.
    at: usize,
    until: Until,
    then: Vec<String>,
    /// What is to run meanwhile.
    runs: Option<Phrase>,
}

impl Conversation<'_> {
    /// What was said, if anything of it is to be done later.
    pub(crate) fn waits(&self, words: &[String], context: &mut Context) -> Option<Understanding> {
        let Said { at, until, then, runs } = self.said_of_waiting(words)?;
        let before = trimmed(&words[..at]);
        if before.is_empty() {
            return Some(match runs.and_then(|phrase| self.machine_meant(&phrase, context)) {
                Some(machine) => self.run_until(machine, until, then, context),
                None => self.wait_for(until, &then, context),
            });
        }
        let understanding = self.understand_all(tidy::tidied(self.lexicon, before), context);
        Some(match &understanding {
            Understanding::Answer { text, .. } => self.wait_for(until, &then, context).after(text),
            _ => context.keep(vec![token::sentence(&words[at..])], understanding),
        })
    }

    /// `did you wait?`: what it waited for last.
    pub(crate) fn whether_waited(&self, done: &[String], context: &Context) -> Option<Understanding> {
        self.lexicon.waiting.waits.longest(done)?;
        let text = match &context.waited {
            _ if !context.awaited.is_empty() => "Yes, I am waiting now.".to_owned(),
            Some(waited) => format!("Yes, I waited {waited}."),
            None => "No, I have waited for nothing.".to_owned(),
        };
        Some(Understanding::whether(context.waited.is_some() || !context.awaited.is_empty(), text, Vec::new()))
    }

    /// Whether a text says how long to wait, or for what, and so is no stop.
    pub(crate) fn is_wait(&self, words: &[String]) -> bool {
        self.said_of_waiting(words).is_some()
    }

    /// The same, of one whose other words the grammar reads.
    pub(crate) fn is_plain_wait(&self, words: &[String]) -> bool {
        let reads = |part: &[String]| part.is_empty() || self.reads_all(&self.wording(&token::sentence(part)));
        self.said_of_waiting(words).is_some_and(|said| reads(trimmed(&words[..said.at])) && reads(&said.then))
    }

    /// Goes on with what was put off, if its time has come: nothing before that, or while there is something else to do.
    pub(crate) fn wake(&self, now_s: f64, context: &mut Context) -> Option<Understanding> {
        for awaited in &mut context.awaited {
            awaited.since_s.get_or_insert(now_s);
        }
        if context.is_busy() || context.must_be_answered() || !context.later.is_empty() {
            return None;
        }
        let waited_s = |awaited: &Awaited| now_s - awaited.since_s.unwrap_or(now_s);
        let is_due = |awaited: &Awaited| {
            let request = awaited.then.first().map(|then| self.lexicon.normalise(then).0).unwrap_or_default();
            match &awaited.until {
                Until::Seconds(seconds) => waited_s(awaited) >= f64::from(*seconds),
                Until::So(claim) => matches!(self.truth(claim, &request, true, context), Truth::Holds),
            }
        };
        let is_over = |awaited: &Awaited| waited_s(awaited) >= f64::from(LONGEST_S.max(awaited.until.seconds()));
        let due = context.awaited.iter().position(is_due);
        let is_due = due.is_some();
        let Some(at) = due.or_else(|| context.awaited.iter().position(is_over)) else {
            // `wait ten seconds`: where it is.
            let stays = |awaited: &Awaited| awaited.then.is_empty() && matches!(awaited.until, Until::Seconds(_));
            return if context.awaited.iter().any(stays) { None } else { self.catch_up(context) };
        };
        let Awaited { until, then, .. } = context.awaited.remove(at);
        let words = until.in_words();
        let longest = Until::Seconds(LONGEST_S).in_words();
        context.waited = Some(match &until {
            Until::Seconds(_) => format!("for {words}"),
            Until::So(_) if is_due => format!("until {words}"),
            Until::So(_) => format!("for {longest}"),
        });
        if !is_due {
            let text =
                format!("I have waited for {longest}, and it is not so yet that {words}. I do not wait any longer.");
            return Some(Understanding::answer(text));
        }
        let go_on = |text: &str, context: &mut Context| {
            let understanding = self.understand_said(text, context);
            (!understanding.is_lost()).then_some(understanding)
        };
        let since = match &until {
            Until::Seconds(_) => format!("{words} are over."),
            Until::So(_) => prose::sentence(&words),
        };
        match self.one_after_the_other(then, context, go_on) {
            Some(understanding) => Some(understanding.after(&since)),
            None => Some(Understanding::answer(since)),
        }
    }

    /// What is to run: the machine that is named, or of those spoken of the last that can be switched.
    fn machine_meant(&self, phrase: &Phrase, context: &Context) -> Option<ObjectId> {
        if !phrase.is_bare_pronoun() {
            return self.ground(&context.focus).one(phrase, &Want::object(Intent::TurnOn)).ok();
        }
        let is_machine = |id: &ObjectId| {
            let object = self.scene.object(*id);
            object.is_some_and(|object| self.catalog.class(object.class).has(Property::Toggleable))
        };
        context.focus.recent.iter().chain(&context.focus.place).copied().find(is_machine)
    }

    /// Has a machine run until then: it is turned on, if it is off, and off again, if it does not go off by itself.
    fn run_until(&self, machine: ObjectId, until: Until, then: Vec<String>, context: &mut Context) -> Understanding {
        let the = describe::short(self.catalog, self.scene, machine);
        let known = self.scene.object(machine);
        let then = match known.filter(|known| self.devices.stays_on(known.class)) {
            Some(_) if then.is_empty() => token::words(&format!("turn off {the}")),
            Some(_) => token::words(&format!("turn off {the}. {}", token::sentence(&then))),
            None => then,
        };
        if known.is_some_and(|known| known.has(StateFlag::Toggled)) {
            return self.wait_for(until, &then, context);
        }
        let words = until.in_words();
        let wait = match until {
            Until::Seconds(_) => format!("wait for {words}"),
            Until::So(_) => format!("wait until {words}"),
        };
        let wait = if then.is_empty() { wait } else { format!("{wait}, then {}", token::sentence(&then)) };
        let phrase = Phrase { text: the, chosen: Some(machine), ..Phrase::default() };
        let clause = Clause::about(Intent::TurnOn, Intent::TurnOn.verb(), phrase);
        let understanding = self.plan(vec![clause], Consent::default(), context);
        context.keep(vec![wait], understanding)
    }

    fn wait_for(&self, until: Until, then: &[String], context: &mut Context) -> Understanding {
        let then = tidy::tidied(self.lexicon, then);
        if let Until::So(claim) = &until {
            match self.truth(claim, &then, true, context) {
                Truth::Holds if then.is_empty() => {
                    return Understanding::answer(prose::sentence(&until.in_words()));
                }
                Truth::Fails(_) | Truth::Unknown if then.is_empty() || self.can_watch(claim, &then, context) => {}
                // What it does not see may be so by now.
                Truth::Holds | Truth::Fails(_) | Truth::Unknown => {
                    self.speak_of(claim, &then, context);
                    return self.understand_all(then, context);
                }
            }
        }
        let words = until.in_words();
        let text = match until {
            Until::Seconds(_) => format!("I wait for {words}."),
            Until::So(_) => format!("I wait until {words}."),
        };
        let (text, then) = match then.is_empty() {
            true => (text, Vec::new()),
            false => (format!("{text} Then I go on."), vec![token::sentence(&then)]),
        };
        // The same said again is for another time.
        context.awaited.retain(|before| before.then != then);
        context.awaited.push(Awaited { until, then, since_s: None });
        Understanding::answer(text)
    }

    fn said_of_waiting(&self, words: &[String]) -> Option<Said> {
        let begins = |at: &usize| {
            let before = at.checked_sub(1).map(|before| words[before].as_str());
            before.is_none_or(|word| token::is_punctuation(word) || matches!(word, "and" | "then" | "please" | "but"))
        };
        let said = (0..words.len()).filter(begins).find_map(|at| {
            let (until, then) = self.timed(&words[at..]).or_else(|| self.awaits(&words[at..]))?;
            let runs = self.run_begun(&words[at..]).map(|(_, machine)| machine);
            Some(Said { at, until, then, runs })
        });
        said.or_else(|| self.put_last(words))
    }

    /// How many words begin a wait.
    fn wait_begun(&self, words: &[String]) -> Option<usize> {
        let runs = self.run_begun(words).map(|(length, _)| length);
        runs.or_else(|| self.lexicon.waiting.waits.longest(words).map(|(length, ())| length))
    }

    /// How many words say that something is to run meanwhile, and what: `let it run`, `leave the oven on for`, `run the fan for`.
    fn run_begun(&self, words: &[String]) -> Option<(usize, Phrase)> {
        let said = &self.lexicon.waiting;
        let lets = said.lets.longest(words).map(|(length, ())| length);
        let lead = lets.or_else(|| said.runs.longest(words).map(|(length, ())| length))?;
        let mut reader = Reader { at: lead, ..Reader::new(self.lexicon, words) };
        let machine = reader.phrase()?;
        let table = if lets.is_some() { &said.running } else { &said.lasting };
        let tail = table.longest(reader.rest()).map(|(length, ())| length);
        let tail = if lets.is_some() { tail? } else { tail.unwrap_or(0) };
        Some((reader.at + tail, machine))
    }

    /// `wait ten seconds, then close it`; `in ten seconds close it`.
    fn timed(&self, words: &[String]) -> Option<(Until, Vec<String>)> {
        let said = &self.lexicon.waiting;
        let delay = said.delays.longest(words).map(|(length, ())| length);
        let length = self.wait_begun(words).or(delay)?;
        let mut rest = &words[length..];
        while let Some((about, ())) = said.about.longest(rest) {
            rest = &rest[about..];
        }
        let first = rest.first()?;
        let spelt = || self.lexicon.numbers.longest(rest).map(|(length, value)| (length, *value));
        let (length, value) = token::digits(first).map(|value| (1, value)).or_else(spelt)?;
        let (unit, seconds) = said.units_s.longest(&rest[length..])?;
        let seconds = value * seconds;
        (0.0..=MOST_S).contains(&seconds).then(|| (Until::Seconds(seconds), trimmed(&rest[length + unit..]).to_vec()))
    }

    /// `wait until the mug is full, then bring it`; `when the mug is full, bring it`.
    fn awaits(&self, words: &[String]) -> Option<(Until, Vec<String>)> {
        let said = &self.lexicon.waiting;
        let waits = self.wait_begun(words).unwrap_or(0);
        let tells = said.tells.longest(words).map_or(0, |(length, ())| length);
        let until = said.until.longest(&words[waits..]).filter(|_| waits > 0).map(|(length, ())| waits + length);
        let told = said.whens.longest(&words[tells..]).filter(|_| tells > 0).map(|(length, ())| tells + length);
        let until = until.or(told);
        let when = said.whens.longest(words).map(|(length, ())| length);
        let rest = &words[until.or(when)?..];
        let is_end = |word: &String| token::is_punctuation(word) || word == "then";
        let splits = |end: usize| {
            let then = trimmed(&rest[end..]);
            // `when the kettle is hot, tell me`
            let is_told = said.tells.exact(then).is_some();
            let then = if is_told { &[][..] } else { then };
            let is_whole = (is_told || until.is_some()) && then.is_empty() || self.is_request(then);
            let joint = |length: &usize| said.joints.exact(&rest[*length..end]).is_some();
            let end = (1..end).find(joint).unwrap_or(end);
            let claim = self.claim(&rest[..end], then).filter(|_| is_whole)?;
            Some((Until::So(claim), then.to_vec()))
        };
        match rest.iter().position(is_end) {
            Some(end) => splits(end),
            // `once the light is off go to the lab`: the first verb after what can be told.
            None => splits(rest.len()).or_else(|| {
                let is_verb = |at: &usize| self.lexicon.verbs.longest(&rest[*at..]).is_some();
                (1..rest.len()).filter(is_verb).find_map(splits)
            }),
        }
    }

    /// `bring me the mug when it is full`, `bring it in ten seconds`.
    fn put_last(&self, words: &[String]) -> Option<Said> {
        let end = words.iter().rposition(|word| !token::is_punctuation(word))? + 1;
        let delayed = (1..end).find_map(|at| {
            self.lexicon.waiting.delays.longest(&words[at..])?;
            let (until, rest) = self.timed(&words[at..])?;
            let then = trimmed(&words[..at]);
            (rest.is_empty() && self.is_request(then)).then(|| Said { at: 0, until, then: then.to_vec(), runs: None })
        });
        if delayed.is_some() {
            return delayed;
        }
        let (at, length) =
            (1..end).find_map(|at| Some((at, self.lexicon.waiting.whens.longest(&words[at..end])?.0)))?;
        let (then, claim) = (trimmed(&words[..at]), &words[at + length..end]);
        if !self.is_request(then) || claim.iter().any(|word| token::is_punctuation(word)) {
            return None;
        }
        let claim = self.claim(claim, then)?;
        Some(Said { at: 0, until: Until::So(claim), then: then.to_vec(), runs: None })
    }

    /// Whether the robot would see it become so: it sees what that is about.
    fn can_watch(&self, claim: &[String], request: &[String], context: &Context) -> bool {
        let Some((question, _)) = self.question_of(claim, request) else { return false };
        let answer = self.answerer(context, 0).answer(&question);
        // What it cannot tell it would not see either.
        let Understanding::Answer { highlight, holds: Some(_), .. } = answer else { return false };
        let is_seen = |id: &ObjectId| {
            let is_held = self.scene.robot.held == Some(*id);
            is_held || self.scene.object(*id).is_some_and(|object| object.visible && !object.is_hidden)
        };
        highlight.iter().all(is_seen)
    }

    /// A claim that the robot can tell.
    fn claim(&self, words: &[String], request: &[String]) -> Option<Vec<String>> {
        let words = self.with_copula(words);
        // `the mug is full you bring it to me` goes on with the request.
        let goes_on = |at: usize| self.lexicon.verbs.longest(&words[at..]).is_some() && self.is_request(&words[at..]);
        let is_claim = !(1..words.len()).any(goes_on) && self.question_of(&words, request).is_some();
        is_claim.then_some(words)
    }

    /// `its done`, which has lost its apostrophe: `it is done`; but not `its door is open`.
    fn with_copula(&self, words: &[String]) -> Vec<String> {
        match words {
            [its, rest @ ..] if its == "its" && !rest.iter().any(|word| self.lexicon.ifs.copulas.contains(word)) => {
                let it_is = ["it", "is"].map(str::to_owned);
                it_is.into_iter().chain(rest.iter().cloned()).collect()
            }
            _ => words.to_vec(),
        }
    }
}
