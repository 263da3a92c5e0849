//! Questions of people: answered, looked into first, or answered with a plan.

use cohabit_cdf::ObjectId;

use crate::{
    answer::{Answerer, claim::asked_state},
    context::{Context, Pending, search::Consent},
    ground::{focus::Focus, want::Want},
    known::{contents, memory},
    read::{clause::Clause, phrase::Phrase, question},
    say::reply,
    talk::conversation::Conversation,
    understanding::Understanding,
    words::{intent::Intent, question_kind::QuestionKind, token},
};

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
                several => context.focus.group = several.to_vec(),
            }
        }
        answer
    }
}
