//! What ends what the robot does, or takes back what was asked for: stop, never mind, leave it.

use crate::{
    context::Context,
    read::{asked_about, clause::Part, phrase::Phrase, slot},
    stop::{self, Stop, said::Firmness},
    talk::{conversation::Conversation, taken_back, way::Way},
    understanding::{Step, Understanding},
    words::intent::Intent,
};

/// What it says when it stops.
const STOPS: &str = "OK, I stop.";
/// What it says where something is to stay as it is.
pub(crate) const LEAVES_AS_IS: &str = "All right, I leave it as it is.";

impl Conversation<'_> {
    /// `turn off the light, no, leave it`: what is taken back in the same breath is not asked for.
    pub(crate) fn taken_back(&self, utterance: &str, context: &mut Context) -> Option<(Understanding, f32)> {
        let rest = self.without_taken_back(utterance)?;
        if taken_back::says_anything(&rest) {
            return Some(self.understand_whole(&rest, context));
        }
        context.pending = None;
        Some((Understanding::answer(LEAVES_AS_IS), 1.0))
    }

    /// `never mind the mug, bring me the plate instead`, of a robot that is at that: it stops, whatever comes of what else is said. A question
    /// or an answer alone would leave it at what nobody wants any longer.
    pub(crate) fn dropped(&self, utterance: &str, context: &mut Context) -> Option<(Understanding, f32)> {
        let is_free = !context.is_busy() || context.must_be_answered();
        let dropped = stop::find_dropped(utterance).filter(|dropped| !is_free && self.is_at(&dropped.what, context))?;
        let asks = self.asks_for_anything(&dropped.rest);
        // `forget it, the red one` asks by what it names.
        if !asks && self.names_anything(&self.lexicon.normalise(&dropped.rest).0) {
            return None;
        }
        let stopped = self.stopped("", context);
        if !asks {
            return Some((stopped, 1.0));
        }
        let (then, sureness) = self.understand_whole(&dropped.rest, context);
        let then = match then {
            Understanding::Stop { then, .. } => then,
            then => Some(Box::new(then)),
        };
        Some((Understanding::Stop { reply: stopped.reply().to_owned(), then }, sureness))
    }

    /// Whether what the robot is at is about a thing of these words, or the words name none.
    pub(crate) fn is_at(&self, what: &str, context: &Context) -> bool {
        let Some(phrase) = asked_about::named(self.lexicon, &self.lexicon.normalise(what).0) else {
            return what.is_empty();
        };
        let is_named = |other: &Phrase| other.namings.iter().any(|naming| phrase.naming(naming.class).is_some());
        let is_touched = |step: &Step| {
            let object = step.object().and_then(|id| self.scene.object(id));
            object.is_some_and(|object| phrase.naming(object.class).is_some())
        };
        context.request.iter().flat_map(slot::named).any(is_named) || context.running.iter().any(is_touched)
    }

    /// `that will do, off with it`, to a robot that does nothing: what is asked for beside the stop, said before it or after it.
    pub(crate) fn asked_at_rest(
        &self,
        stop: &Stop,
        utterance: &str,
        context: &mut Context,
    ) -> Option<(Understanding, f32)> {
        if stop.is_all || context.is_busy() || context.pending.is_some() || context.awaits() {
            return None;
        }
        let ways = self.rewritten(&self.wording(utterance), context, None);
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
        context.halt();
        if !context.running.is_empty() && context.last_plan.ends_with(&context.running) {
            context.left_undone = context.running.len();
        }
        context.running.clear();
        context.failed = None;
        context.search = None;
        context.awaited.clear();
        context.later.clear();
        context.agreed = None;
        // A reason for it is taken for many things, but it is no question.
        let asks = self.asks_for_anything(rest) || rest.contains('?') && self.is_rewritten_as_request(rest, context);
        let then = asks.then(|| Box::new(self.understand_whole(rest, context).0));
        Understanding::Stop { reply: STOPS.to_owned(), then }
    }
}

/// Whether a stop is meant as one: "leave it" may answer the robot's question, and "that's plenty" and "never mind" say nothing to a
/// robot that does nothing.
pub(crate) fn is_heeded(stop: &Stop, context: &Context) -> bool {
    match stop.firmness {
        Firmness::Firm => true,
        Firmness::Weak => !context.must_be_answered() && (context.is_busy() || stop.is_plain),
        Firmness::Dismissal => !context.must_be_answered() && (context.is_busy() || context.awaits()),
    }
}

/// Whether nothing but to stop is asked for.
pub(crate) fn stops(parts: &[Part]) -> bool {
    let mut asked =
        parts.iter().filter_map(|part| if let Part::Clause(clause) = part { Some(clause) } else { None }).peekable();
    asked.peek().is_some() && asked.all(|clause| clause.intent == Intent::Stop)
}
