//! What a robot's face shows: few things, which people tell apart at a glance.

use serde::{Deserialize, Serialize};

/// What a robot's face shows.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FacialExpression {
    /// Nothing in particular.
    #[default]
    Neutral,
    /// It is glad of something.
    Happy,
    /// Something did not work, or it will not do it.
    Sorry,
    /// It did not understand.
    Confused,
    /// It takes a moment.
    Thinking,
}

impl FacialExpression {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Neutral, Self::Happy, Self::Sorry, Self::Confused, Self::Thinking];

    /// In one word, for pages and the log.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Neutral => "neutral",
            Self::Happy => "happy",
            Self::Sorry => "sorry",
            Self::Confused => "confused",
            Self::Thinking => "thinking",
        }
    }

    /// The one of that name.
    #[must_use]
    pub fn of(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|one| one.name() == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn expressions_have_the_same_names_everywhere() {
        for one in FacialExpression::ALL {
            assert_eq!(FacialExpression::of(one.name()), Some(one));
            assert_eq!(serde_json::to_value(one).ok(), Some(one.name().into()));
        }
        assert_eq!(FacialExpression::of("angry"), None);
    }
}
