//! The kinds of actions that the table has rules for.

use serde::{Deserialize, Serialize};

use crate::action::{Action, GoToTarget, ObjectId, Verb};

/// A kind of action on an object.
#[derive(Clone, Copy, Debug, Deserialize, Eq, Hash, Ord, PartialEq, PartialOrd, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ActionKind {
    /// Walk to it.
    GoTo,
    /// Take it.
    PickUp,
    /// Put what is held into it.
    Place,
    /// Open it.
    Open,
    /// Close it.
    Close,
    /// Break or cut it.
    Break,
    /// Scan it.
    Scan,
    /// Pour what is held into it.
    Pour,
    /// Switch it.
    Toggle,
    /// Throw what is held at it.
    Throw,
    /// Fill it, or what is held at it.
    Fill,
    /// Clean it, or what is held at it.
    Clean,
    /// Look closely at it.
    Examine,
}

impl ActionKind {
    /// All of them.
    pub const ALL: [Self; 13] = [
        Self::GoTo,
        Self::PickUp,
        Self::Place,
        Self::Open,
        Self::Close,
        Self::Break,
        Self::Scan,
        Self::Pour,
        Self::Toggle,
        Self::Throw,
        Self::Fill,
        Self::Clean,
        Self::Examine,
    ];

    /// The kind and the object of an action; none for motions, which are about no object.
    #[must_use]
    pub const fn of(action: &Action) -> Option<(Self, ObjectId)> {
        Some(match *action {
            Action::GoTo { target: GoToTarget::Object(object) } => (Self::GoTo, object),
            Action::PickUp { object } => (Self::PickUp, object),
            Action::Place { receptacle } | Action::PlaceBeside { receptacle, .. } => (Self::Place, receptacle),
            Action::Interact { verb, object } => (Self::of_verb(verb), object),
            _ => return None,
        })
    }

    /// The kind of a verb.
    #[must_use]
    pub const fn of_verb(verb: Verb) -> Self {
        match verb {
            Verb::Open => Self::Open,
            Verb::Close => Self::Close,
            Verb::Break => Self::Break,
            Verb::Scan => Self::Scan,
            Verb::Pour => Self::Pour,
            Verb::Toggle => Self::Toggle,
            Verb::Throw => Self::Throw,
            Verb::Fill => Self::Fill,
            Verb::Clean => Self::Clean,
            Verb::Examine => Self::Examine,
        }
    }

    /// The verb of this kind; none for walking, picking up and placing.
    #[must_use]
    pub const fn verb(self) -> Option<Verb> {
        match self.on(ObjectId(0)) {
            Action::Interact { verb, .. } => Some(verb),
            _ => None,
        }
    }

    /// The action of this kind on an object.
    #[must_use]
    pub const fn on(self, object: ObjectId) -> Action {
        let verb = match self {
            Self::GoTo => return Action::GoTo { target: GoToTarget::Object(object) },
            Self::PickUp => return Action::PickUp { object },
            Self::Place => return Action::Place { receptacle: object },
            Self::Open => Verb::Open,
            Self::Close => Verb::Close,
            Self::Break => Verb::Break,
            Self::Scan => Verb::Scan,
            Self::Pour => Verb::Pour,
            Self::Toggle => Verb::Toggle,
            Self::Throw => Verb::Throw,
            Self::Fill => Verb::Fill,
            Self::Clean => Verb::Clean,
            Self::Examine => Verb::Examine,
        };
        Action::Interact { verb, object }
    }

    /// Its name in the table and on wires.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::GoTo => "go_to",
            Self::PickUp => "pick_up",
            Self::Place => "place",
            Self::Open => "open",
            Self::Close => "close",
            Self::Break => "break",
            Self::Scan => "scan",
            Self::Pour => "pour",
            Self::Toggle => "toggle",
            Self::Throw => "throw",
            Self::Fill => "fill",
            Self::Clean => "clean",
            Self::Examine => "examine",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_and_actions_stand_for_each_other() {
        for kind in ActionKind::ALL {
            assert_eq!(ActionKind::of(&kind.on(ObjectId(7))), Some((kind, ObjectId(7))));
        }
        let beside = Action::place(ObjectId(7), Some(ObjectId(8)));
        assert_eq!(ActionKind::of(&beside), Some((ActionKind::Place, ObjectId(7))));
        assert_eq!(ActionKind::of(&Action::Stop), None);
    }
}
