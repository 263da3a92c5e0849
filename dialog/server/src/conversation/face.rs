//! What the robot's face shows of the conversation, with a wizard and without.

use cohabit_language::Understanding;

use super::{Conversation, Outgoing};
use crate::expression::FacialExpression;

impl Conversation {
    /// What its face shows.
    pub(crate) const fn expression(&self) -> FacialExpression {
        self.memory.expression
    }

    /// Has its face show something from now on, which is told if it is news.
    pub(super) fn express(&mut self, turn: u64, shown: FacialExpression, outbox: &mut Vec<Outgoing>) {
        if self.memory.expression != shown {
            self.memory.expression = shown;
            outbox.push(Outgoing::Express { turn, shown });
        }
    }
}

/// What its face shows while it answers so.
pub(super) const fn shown_with(understanding: &Understanding) -> FacialExpression {
    match understanding {
        Understanding::Refusal { is_lost: true, .. } => FacialExpression::Confused,
        Understanding::Refusal { .. } => FacialExpression::Sorry,
        Understanding::Plan { .. }
        | Understanding::Question { .. }
        | Understanding::Answer { .. }
        | Understanding::Stop { .. } => FacialExpression::Neutral,
    }
}
