//! What people ask, among what else they say.

use crate::{
    answer::Answerer,
    clause::{Clause, Part},
    context::{Context, Pending},
    conversation::Conversation,
    question::{self, QuestionKind},
    token,
    understanding::Understanding,
};

impl Conversation<'_> {
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

    /// Answers a question, and remembers what it is about.
    pub(crate) fn answer(&self, question: &question::Question, context: &mut Context) -> Understanding {
        let answerer = Answerer {
            catalog: self.catalog,
            lexicon: self.lexicon,
            scene: self.scene,
            focus: &context.focus,
            judge: self.judge,
            running: &context.running,
            failed: context.failed.as_ref(),
            last_plan: &context.last_plan,
            asked: &context.asked,
        };
        let answer = answerer.answer(question);
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

/// Whether the first sentence ends as no question does.
pub(crate) fn is_exclaimed(words: &[String]) -> bool {
    words.iter().find(|word| token::ends_sentence(word)).is_some_and(|end| end != "?")
}

/// What is said after the first sentence.
pub(crate) fn later_sentences(words: &[String]) -> &[String] {
    let end = words.iter().position(|word| token::ends_sentence(word)).unwrap_or(words.len());
    words.get(end + 1..).unwrap_or_default()
}
