//! What people ask, among what else they say.

use crate::{
    answer::{self, Answerer},
    clause::{Clause, Part},
    context::{Context, Pending},
    conversation::Conversation,
    question::{self, QuestionKind},
    reply, token,
    understanding::{Clarification, Understanding},
    wording::Wording,
};

/// The fewest words of a question beside others.
const SHORTEST: usize = 3;

/// How many questions of one utterance are answered.
const MOST_QUESTIONS: usize = 4;

impl Conversation<'_> {
    /// Where questions begin: at the first word, after a pause or `and`, and after who asks to be told; each with where that begins.
    fn inquiries_in(&self, words: &[String]) -> Vec<(usize, usize)> {
        let told_from = |at: usize| {
            let ends_here = |from: &usize| {
                let (length, ()) = self.lexicon.tells.longest(&words[*from..]).unwrap_or((0, &()));
                let spare = &words[(from + length).min(at)..at];
                length > 0
                    && from + length <= at
                    && spare.iter().all(|word| self.lexicon.trail.exact(std::slice::from_ref(word)).is_some())
            };
            (0..at).find(ends_here)
        };
        let mut found: Vec<(usize, usize)> = Vec::new();
        for at in (0..words.len()).filter(|at| self.lexicon.inquiries.longest(&words[*at..]).is_some()) {
            if let Some(from) = told_from(at) {
                // `do you know where …` is one question, and `can you tell me what …`.
                let ends = |start: usize| {
                    start + self.lexicon.inquiries.longest(&words[start..]).map_or(0, |(length, ())| length)
                };
                found.retain(|(start, _)| ends(*start) <= from);
                found.push((at, from));
            } else if at == 0 || joins(&words[at - 1]) {
                found.push((at, at));
            }
        }
        found
    }

    /// The questions of an utterance that asks several and nothing else: `where are we, and what do you see?`
    fn questions_in(&self, wording: &Wording<'_>) -> Vec<String> {
        let words = token::words(wording.utterance);
        let starts = self.inquiries_in(&words);
        let Some((_, first)) = starts.first().copied() else { return Vec::new() };
        let is_told = starts.iter().any(|(start, from)| from < start);
        let ends = starts.iter().skip(1).map(|(_, from)| *from).chain([words.len()]);
        let asked: Vec<&[String]> =
            starts.iter().zip(ends).map(|((start, _), end)| within(&words[*start..end])).collect();
        // `what is that, is it?` asks once.
        let is_whole = asked.iter().all(|asked| asked.len() >= SHORTEST);
        let is_all = is_whole && self.names_nothing(&words[..first]) && (is_told || wording.ends_as_question());
        if !is_all || !(2..=MOST_QUESTIONS).contains(&asked.len()) {
            return Vec::new();
        }
        asked.into_iter().map(as_question).collect()
    }

    /// Whether it only asks to be told something: `can you tell me what you have done?`
    pub(crate) fn asks_to_be_told(&self, words: &[String]) -> bool {
        let first = self.inquiries_in(words).into_iter().next();
        first.is_some_and(|(start, from)| from < start && self.names_nothing(&words[..from]))
    }

    /// Whether words name nothing, politeness left out: `can you please`.
    fn names_nothing(&self, words: &[String]) -> bool {
        self.names_in(&self.without_politeness(words)).is_empty()
    }

    fn without_politeness(&self, words: &[String]) -> Vec<String> {
        let mut left = Vec::new();
        let mut at = 0;
        while at < words.len() {
            let polite = self.lexicon.lead.longest(&words[at..]).map_or(0, |(length, ())| length);
            left.extend_from_slice(&words[at..at + usize::from(polite == 0)]);
            at += polite.max(1);
        }
        left
    }

    /// What is to be done, and what is to be told after it: `take the can and then tell me what else is on the table`.
    fn asked_at_end(&self, wording: &Wording<'_>, context: &Context) -> Option<(String, String)> {
        let words = token::words(wording.utterance);
        let (start, from) = self.inquiries_in(&words).into_iter().next_back().filter(|(start, from)| from < start)?;
        let before = within(&words[..from]);
        let asks = !within(&self.without_politeness(before)).is_empty()
            && self.parser_sees_request(&token::sentence(before), context);
        asks.then(|| (token::sentence(before), as_question(within(&words[start..]))))
    }

    /// Does what is to be done, and leaves the question after it for then; nothing, where it is not so understood.
    pub(crate) fn told_at_end(&self, wording: &Wording<'_>, context: &mut Context) -> Option<(Understanding, f32)> {
        let (before, question) = self.asked_at_end(wording, context)?;
        let mut then = context.clone();
        let (understanding, sureness) = self.understand_weighed(&before, &mut then);
        let understanding = match understanding {
            // What is only guessed at before a question may ask for nothing.
            Understanding::Question { kind: Clarification::Confirmation, .. } => return None,
            Understanding::Plan { .. } | Understanding::Question { .. } => {
                let later = then.later.iter().cloned().chain([question]).collect();
                then.keep(later, understanding)
            }
            Understanding::Answer { ref text, .. } if then.is_met => {
                let (answer, _) = self.understand_weighed(&question, &mut then);
                answer.after(text)
            }
            _ => return None,
        };
        *context = then;
        Some((understanding, sureness))
    }

    /// Answers several questions, one after the other; nothing, where one of them asks for more than an answer.
    pub(crate) fn answered_each(&self, wording: &Wording<'_>, context: &mut Context) -> Option<(Understanding, f32)> {
        let mut then = context.clone();
        let mut said: Vec<String> = Vec::new();
        let mut sureness: f32 = 1.0;
        let questions = self.questions_in(wording);
        let (last, earlier) = questions.split_last()?;
        for question in earlier {
            let (understanding, sure) = self.understand_weighed(question, &mut then);
            let Understanding::Answer { text, .. } = understanding else { return None };
            said.push(text);
            sureness = sureness.min(sure);
        }
        let (understanding, sure) = self.understand_weighed(last, &mut then);
        if !matches!(understanding, Understanding::Answer { .. } | Understanding::Question { .. }) {
            return None;
        }
        *context = then;
        Some((understanding.after(&said.join(" ")), sureness.min(sure)))
    }

    /// `I have lost my trophy. Have you seen it?`: the question, where nothing was asked for before it.
    pub(crate) fn asked_after_talk(&self, words: &[String], parts: &[Part]) -> Option<question::Question> {
        let asks = |part: &Part| matches!(part, Part::Clause(_) | Part::Forbidden(_));
        let later = later_sentences(words);
        if parts.iter().any(asks) {
            return None;
        }
        // `the note on the wall, what does it say?`
        let after = (0..words.len()).filter(|at| words[*at] == ",").map(|at| &words[at + 1..]);
        let mut later = std::iter::once(later).chain(after).filter(|later| !later.is_empty());
        later.find_map(|later| {
            question::read(self.lexicon, later).filter(|question| question.kind != QuestionKind::Unknown)
        })
    }

    /// What talk is about is what `it` stands for after it.
    pub(crate) fn mention(&self, part: &Part, context: &mut Context) {
        let (Part::Mention(phrase) | Part::Fragment(phrase)) = part else { return };
        let mut planner = self.planner(context.focus.clone());
        if planner.run(&[Clause::mention(phrase.clone())]).is_ok() {
            context.focus = planner.focus;
        }
    }

    pub(crate) fn answerer<'c>(&'c self, context: &'c Context, told: usize) -> Answerer<'c> {
        let Self { catalog, lexicon, devices, scene, judge, .. } = *self;
        Answerer { catalog, lexicon, devices, scene, judge, context, told }
    }

    /// How something is done: the plan for it, which `yes` then means.
    fn how_to(&self, wish: Vec<String>, context: &mut Context) -> Understanding {
        let said = token::sentence(&wish);
        let mut then = context.clone();
        then.pending = None;
        match self.understand_all(wish, &mut then) {
            Understanding::Plan { steps, .. } => {
                let guess = then.guess(&steps);
                let text = match &then.search {
                    Some(_) => {
                        let request = reply::request_in_words(&then.request);
                        format!("I would {request}, and look for what I have not seen yet. Tell me to, and I do it.")
                    }
                    None => format!("By {}. Tell me to, and I do it.", reply::plan_in_words(&steps)),
                };
                context.pending = Some(Pending::Guess { guesses: vec![guess] });
                Understanding::answer(text)
            }
            Understanding::Answer { text, highlight, .. } => Understanding::about(text, highlight),
            Understanding::Refusal { text, is_lost: false } => Understanding::answer(text),
            _ => Understanding::answer(format!("Tell me \"{said}\", and I will try.")),
        }
    }

    /// Answers a question, and remembers what it is about.
    pub(crate) fn answer(&self, question: &question::Question, context: &mut Context) -> Understanding {
        if question.kind == QuestionKind::HowTo && !question.rest.is_empty() {
            return self.how_to(question.rest.clone(), context);
        }
        let listed = context.list.take();
        let (question, told) = match (question.kind, &listed) {
            (QuestionKind::Rest, Some((listed, told))) => (listed, *told),
            _ => (question, 0),
        };
        let answer = self.answerer(context, told).answer(question);
        if matches!(question.kind, QuestionKind::Seeing | QuestionKind::Contents) {
            context.list = Some((question.clone(), told + answer::LIST));
        }
        context.question = Some(question.kind);
        // Only what it has not seen makes it ask back.
        if let (Understanding::Question { .. }, Some(phrase)) = (&answer, &question.about) {
            context.focus.unseen = Some(phrase.clone());
            context.pending = Some(Pending::Search { clauses: vec![Clause::find(phrase.clone())] });
        }
        if let Understanding::Answer { highlight, .. } = &answer {
            match highlight.as_slice() {
                [one] => {
                    context.focus.mention(*one);
                    context.focus.place = self.place_spoken_of(*one);
                }
                several => context.focus.group = several.to_vec(),
            }
        }
        answer
    }
}

/// Whether a word stands between two questions.
fn joins(word: &str) -> bool {
    token::is_punctuation(word) || matches!(word, "and" | "but" | "also" | "so" | "then")
}

/// Words without those that join them to others at either end.
fn within(words: &[String]) -> &[String] {
    let start = words.iter().take_while(|word| joins(word)).count();
    let end = words.len() - words[start..].iter().rev().take_while(|word| joins(word)).count();
    &words[start..end]
}

/// Words that ask, in the order of a question of its own: `what it has hit` is `what has it hit`, `which shelves you see` is
/// `which shelves do you see`.
fn as_question(words: &[String]) -> String {
    const ASKERS: [&str; 6] = ["what", "which", "where", "why", "when", "how"];
    const SUBJECTS: [&str; 6] = ["you", "i", "we", "it", "they", "there"];
    const HELPERS: [&str; 14] =
        ["is", "are", "was", "were", "am", "have", "has", "had", "did", "do", "can", "could", "will", "would"];
    const LONGEST_ASKER: usize = 4;
    let is_helper = |word: &String| HELPERS.contains(&word.as_str());
    let subject = words.iter().take(LONGEST_ASKER).position(|word| SUBJECTS.contains(&word.as_str()));
    let is_asked = words.first().is_some_and(|asker| ASKERS.contains(&asker.as_str()));
    let told = subject.filter(|at| is_asked && !words[..*at].iter().any(is_helper));
    let asked = match told.map(|at| words.split_at(at)) {
        Some((asker, [subject, verb, rest @ ..])) if is_helper(verb) => {
            [asker, std::slice::from_ref(verb), std::slice::from_ref(subject), rest].concat()
        }
        Some((asker, rest @ [_, _, ..])) => [asker, &["do".to_owned()], rest].concat(),
        _ => words.to_vec(),
    };
    format!("{}?", token::sentence(&asked))
}

/// Whether the first sentence ends as no question does.
pub(crate) fn is_exclaimed(words: &[String]) -> bool {
    words.iter().find(|word| token::ends_sentence(word)).is_some_and(|end| end != "?")
}

/// What is said after the first sentence.
pub(crate) fn later_sentences(words: &[String]) -> &[String] {
    let end = words.iter().position(|word| token::ends_sentence(word)).unwrap_or(words.len());
    words.get(end + 1..).unwrap_or_default()
}
