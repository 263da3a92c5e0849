//! What an utterance may mean to the robot, and how likely that is: for who looks into what it understands.

use cohabit_cdf::ObjectId;
use cohabit_language::{Alternative, Understanding};

use super::Conversation;
use crate::known::Knowledge;

/// What an utterance may mean, in a conversation as it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Insight {
    /// What the robot makes of it.
    pub understanding: Understanding,
    /// How likely that is what was meant, from 0 to 1.
    pub sureness: f32,
    /// All ways to take it.
    pub alternatives: Vec<Alternative>,
    /// The things that its first referring expression may mean, with what people would call them and how likely each is; the likeliest
    /// first.
    pub referents: Vec<(ObjectId, String, f32)>,
}

impl Conversation {
    /// What an utterance may mean now; nothing, if the robot has not looked around yet. The conversation stays as it is.
    #[must_use]
    pub fn insight(&self, text: &str, knowledge: &Knowledge) -> Option<Insight> {
        let (known, context) = (knowledge.known()?, &self.memory.context);
        let mut then = context.clone();
        let understanding = self.language.understand(text, &known, &mut then);
        let found = self.language.referents(text, &known, context);
        let candidates = found.iter().flat_map(|found| &found.candidates);
        let named = candidates.map(|one| (one.object, self.language.name(one.object, &known), one.probability));
        Some(Insight {
            understanding,
            sureness: then.sureness(),
            alternatives: self.language.alternatives(text, &known, context),
            referents: named.collect(),
        })
    }
}
