//! Who is in the world: what kinds of bodies there are, and how one is asked for.

use std::{fmt, str::FromStr};

use serde::{Deserialize, Serialize};

use crate::room::{ROOM_ID_RULE, RoomId};

/// What kind of body it is.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, Hash, PartialEq, Serialize)]
#[repr(u8)]
pub enum BodyKind {
    /// A robot on wheels, with one arm.
    #[default]
    Robot,
    /// The avatar of a person.
    Person,
}

impl BodyKind {
    /// All kinds.
    pub const ALL: [Self; 2] = [Self::Robot, Self::Person];

    /// As people call it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Robot => "robot",
            Self::Person => "person",
        }
    }
}

/// A body that a session starts with, beside those of its mission.
///
/// As text it is a kind, perhaps with a room: `person`, `robot@Lab1`.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub struct BodyRequest {
    /// Its kind.
    pub kind: BodyKind,
    /// Where it starts; the mission's start room if absent.
    pub room: Option<RoomId>,
}

/// Why a text asks for no body.
#[derive(Clone, Debug, Eq, PartialEq, thiserror::Error)]
pub enum BodyRequestError {
    /// There is no such kind.
    #[error("there is no body `{0}`: robot or person, such as `person@BreakRoom`")]
    Kind(String),
    /// No room can have this id.
    #[error("`{0}` is no id of a room: {ROOM_ID_RULE}")]
    Room(String),
}

impl FromStr for BodyRequest {
    type Err = BodyRequestError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (kind, room) = text.split_once('@').map_or((text, None), |(kind, room)| (kind, Some(room)));
        let is_meant = |known: &BodyKind| known.name().eq_ignore_ascii_case(kind.trim());
        let kind =
            BodyKind::ALL.into_iter().find(is_meant).ok_or_else(|| BodyRequestError::Kind(kind.trim().to_owned()))?;
        let known = |room: &str| RoomId::new(room.trim()).ok_or_else(|| BodyRequestError::Room(room.to_owned()));
        Ok(Self { kind, room: room.map(known).transpose()? })
    }
}

impl fmt::Display for BodyRequest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.kind.name())?;
        self.room.map_or(Ok(()), |room| write!(f, "@{}", room.id()))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn requests_read_as_they_print() {
        for text in ["robot", "person", "robot@Lab1", "person@BreakRoom", "person@SunLounge"] {
            assert_eq!(text.parse::<BodyRequest>().unwrap().to_string(), text);
        }
        assert_eq!("dog".parse::<BodyRequest>(), Err(BodyRequestError::Kind("dog".to_owned())));
        assert_eq!("robot@the attic".parse::<BodyRequest>(), Err(BodyRequestError::Room("the attic".to_owned())));
    }
}
