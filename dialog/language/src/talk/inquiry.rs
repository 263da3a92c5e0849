//! Questions of people: answered, looked into first, or answered with a plan.

use cohabit_cdf::ObjectId;

use crate::{
    answer::{Answerer, claim::asked_state},
    context::{Context, Pending, search::Consent},
    ground::{focus::Focus, want::Want},
    known::{contents, memory},
    read::{clause::Clause, phrase::Phrase, question, saying},
    say::{ask, reply},
    talk::conversation::Conversation,
    understanding::{Asking, Understanding},
    words::{intent::Intent, prose, question_kind::QuestionKind, token},
};

/// What is said of a deed that was perhaps not meant, and what is offered.
const SORRY: &str = "I am sorry if that is not what you meant.";
const SHALL_UNDO: &str = "Shall I undo it?";

impl Conversation<'_> {
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

    /// What is near and in the open, and may be warmer or colder than it was when the robot last saw it.
    fn unwatched(&self, question: &question::Question, answer: &Understanding, context: &Context) -> Option<ObjectId> {
        let Understanding::Answer { highlight, .. } = answer else { return None };
        let [id] = highlight.as_slice() else { return None };
        let (state, _) = asked_state(self.lexicon, &question.rest).filter(|_| question.kind == QuestionKind::State)?;
        let is_near = self.scene.object(*id)?.room == self.scene.robot.room;
        let is_shut_in = self.scene.ancestors(*id).any(|outer| memory::is_shut(self.catalog, outer));
        (is_near && !is_shut_in && self.answerer(context, 0).may_have_changed(*id, state)).then_some(*id)
    }

    /// Looks first at what was asked about, where all that was said only asks; the answer comes after that.
    pub(crate) fn with_a_look(
        &self,
        utterance: &str,
        understanding: Understanding,
        context: &mut Context,
    ) -> Understanding {
        let Some(id) = context.unwatched.take().filter(|_| matches!(understanding, Understanding::Answer { .. }))
        else {
            return understanding;
        };
        let phrase = Phrase { chosen: Some(id), ..Phrase::default() };
        let mut then = context.clone();
        let look = self.plan(vec![Clause::about(Intent::Examine, "look at", phrase)], Consent::default(), &mut then);
        if !matches!(look, Understanding::Plan { .. }) {
            return understanding;
        }
        *context = then;
        context.keep(vec![utterance.to_owned()], look.after("I have not looked at it since."))
    }

    /// Whether it knows where such a thing is.
    fn is_known(&self, phrase: &Phrase) -> bool {
        self.ground(&Focus::default()).one(phrase, &Want::place(Intent::Find, &[], None)).is_ok()
    }

    /// Answers where each of several things is, and offers to look for those that it has not seen.
    fn answer_each(&self, each: &[Phrase], question: &question::Question, context: &mut Context) -> Understanding {
        let (mut told, mut unseen, mut known, mut held) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for phrase in each {
            let rest = token::words(&phrase.text);
            let one = question::Question { about: Some(phrase.clone()), rest, ..question.clone() };
            match self.answerer(context, 0).answer(&one) {
                Understanding::Question { .. } => unseen.push(phrase.clone()),
                Understanding::Answer { text, highlight, holds } => {
                    told.push(text);
                    known.extend(highlight);
                    held.extend(holds);
                }
                other => told.push(other.reply().to_owned()),
            }
        }
        context.question = Some(question.kind);
        if !known.is_empty() {
            context.focus.group.clone_from(&known);
        }
        told.dedup();
        if unseen.is_empty() {
            let is_any = question.rest.iter().any(|word| word == "or");
            let holds = if is_any { held.contains(&true) } else { held.len() == each.len() && !held.contains(&false) };
            return Understanding::whether(holds, told.join(" "), known);
        }
        let names: Vec<String> = unseen.iter().map(saying::said).collect();
        let them = if names.len() > 1 { "them" } else { "it" };
        told.push(format!("I have not seen {} yet. Shall I look for {them}?", prose::list(&names, "or")));
        context.focus.unseen = unseen.last().cloned();
        context.pending = Some(Pending::Search { clauses: unseen.into_iter().map(Clause::find).collect() });
        ask::confirmation(told.join(" "))
    }

    /// The same, with an apology and an offer to take it back, where it is asked why it did what was perhaps not meant.
    fn regretted(&self, why: Understanding, question: &question::Question, context: &mut Context) -> Understanding {
        if !self.answerer(context, 0).may_be_mistaken(question) {
            return why;
        }
        match self.undo(&mut context.at_new_utterance()) {
            Understanding::Plan { steps, .. } if !context.is_busy() && self.judge.asking != Asking::Never => {
                context.pending = Some(Pending::Offer { plans: vec![steps] });
                why.before(SORRY).before(SHALL_UNDO)
            }
            _ => why.before(SORRY),
        }
    }

    /// The same question about what was spoken of last and was not seen yet, where it asks where `it` is or what `it` does.
    fn about_unseen(&self, question: &question::Question, context: &Context) -> Option<question::Question> {
        let is_meant = matches!(question.kind, QuestionKind::Where | QuestionKind::Purpose);
        let is_it = |about: &Phrase| about.is_bare_pronoun() && !about.is_many();
        let is_about_it = question.about.as_ref().map_or(question.rest.is_empty(), is_it);
        let unseen = context.focus.unseen.clone().filter(|_| is_meant && is_about_it)?;
        Some(question::Question { about: Some(unseen), ..question.clone() })
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
        if let Some(each) = question::each_of(self.lexicon, question) {
            return self.answer_each(&each, question, context);
        }
        let of_unseen = self.about_unseen(question, context);
        let question = of_unseen.as_ref().unwrap_or(question);
        let answer = self.answerer(context, told).answer(question);
        let is_why = question.kind == QuestionKind::Why;
        let answer = if is_why { self.regretted(answer, question, context) } else { answer };
        if matches!(question.kind, QuestionKind::Seeing | QuestionKind::Contents | QuestionKind::Carried) {
            // What else there is, is no yes or no.
            let listed = question::Question { is_whether: false, ..question.clone() };
            context.list = Some((listed, told + contents::LIST));
        }
        context.question = Some(question.kind);
        context.unwatched = self.unwatched(question, &answer, context);
        // Only what it has not seen makes it ask back.
        if let (Understanding::Question { .. }, Some(phrase)) = (&answer, &question.about) {
            let clause = match question.kind {
                // `is the fridge empty`
                QuestionKind::Contents | QuestionKind::State if self.is_known(phrase) => {
                    Clause::about(Intent::LookIn, "look in", phrase.clone())
                }
                _ => {
                    context.focus.unseen = Some(phrase.clone());
                    Clause::find(phrase.clone())
                }
            };
            context.pending = Some(Pending::Search { clauses: vec![clause] });
        }
        if let Understanding::Answer { highlight, .. } = &answer {
            match highlight.as_slice() {
                [one] => {
                    context.focus.mention(*one);
                    context.focus.place = self.place_spoken_of(*one);
                }
                // What a kind of thing does was told without a thing of that kind.
                [] if matches!(question.kind, QuestionKind::Purpose | QuestionKind::Look) => {
                    context.focus.group.clear();
                    context.focus.unseen = question.about.clone().filter(|about| !about.namings.is_empty());
                }
                several => context.focus.group = several.to_vec(),
            }
        }
        answer
    }
}
