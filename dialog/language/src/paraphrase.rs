//! What a way to understand an utterance comes to, in plain words, as the re-ranker reads it.

use cohabit_cdf::{Action, GoToTarget};

use crate::{
    alternatives::Alternative,
    conversation::Conversation,
    describe, reply,
    understanding::{Step, Understanding},
};

/// How many steps are told at most.
const MOST_STEPS: usize = 12;

impl Conversation<'_> {
    /// `picking up the mug on the table, putting the mug in the sink`; `? Which one do you mean: …`; `= The milk is in the fridge.`; `! The fridge
    /// is locked.`
    pub(crate) fn paraphrase(&self, one: &Alternative) -> String {
        let text = match &one.understanding {
            Understanding::Plan { steps, .. } => match &one.context.search {
                Some(_) => format!("looking first: {}", reply::request_in_words(&one.context.request)),
                None => self.steps_in_words(steps),
            },
            Understanding::Question { text, .. } => format!("? {text}"),
            Understanding::Answer { text, .. } => format!("= {text}"),
            Understanding::Refusal { text, .. } => format!("! {text}"),
            Understanding::Stop { reply, .. } => reply.clone(),
        };
        one.context.later.iter().fold(text, |text, later| format!("{text}; then {later}"))
    }

    fn steps_in_words(&self, steps: &[Step]) -> String {
        let mut told: Vec<String> = Vec::new();
        for step in steps.iter().take(MOST_STEPS) {
            let full = |object| describe::full(self.catalog, self.scene, object);
            let words = match step.action {
                Action::PickUp { object } => format!("picking up {}", full(object)),
                Action::GoTo { target: GoToTarget::Object(object) } => format!("going to {}", full(object)),
                Action::Highlight { object } => format!("showing {}", full(object)),
                _ => step.says.clone(),
            };
            if told.last() != Some(&words) {
                told.push(words);
            }
        }
        told.join(", ")
    }
}
