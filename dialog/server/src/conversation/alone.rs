//! A robot whose mind goes by no plan of a conversation: it answers what people ask, and says of all that they tell it to do that
//! nothing comes of it.

use cohabit_language::Understanding;

use super::Conversation;

/// What it says to who tells it to do something, or to stop.
pub(super) const ALONE: &str =
    "In this session I act on my own, and cannot be told to do or to stop anything. You can still ask me things.";
/// What a wizard reads who orders it to do something.
pub(super) const NOT_ORDERED: &str = "This robot acts on its own: it carries out no orders.";

impl Conversation {
    /// The same, of a robot that acts on its own, whatever it is told; or that does what it is told.
    pub(crate) fn alone(self, is_alone: bool) -> Self {
        Self { is_alone, ..self }
    }

    /// Whether it is told that, and nothing would come of it, at once or later.
    pub(super) const fn is_in_vain(&self, understanding: &Understanding, awaits: bool) -> bool {
        self.is_alone && (awaits || matches!(understanding, Understanding::Plan { .. } | Understanding::Stop { .. }))
    }
}
