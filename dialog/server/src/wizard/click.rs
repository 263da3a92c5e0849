//! What a wizard clicks in the picture or on the floor plan, and the action that it comes to.

use std::f32::consts::PI;

use cohabit_cdf::{Action, GoToTarget, ObjectId, RoomId};
use serde::{Deserialize, Serialize};

use crate::affordances::Deed;

/// The furthest that the robot moves at a press of a key, m.
const FURTHEST_M: f32 = 2.0;

/// What the robot is to do with what a wizard clicked.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(tag = "does", rename_all = "snake_case")]
pub(crate) enum Click {
    /// Point it out.
    Point {
        /// Which object.
        object: u32,
    },
    /// Turn to it.
    Look {
        /// Which object.
        object: u32,
    },
    /// Do something to it, or walk to it.
    Act {
        /// What.
        deed: Deed,
        /// Which object.
        object: u32,
    },
    /// Walk into a room.
    Room {
        /// Which.
        room: RoomId,
    },
    /// Walk to a point on the floor.
    Floor {
        /// Where, m, in the world.
        at_m: [f32; 2],
    },
    /// Turn where it stands.
    Turn {
        /// Signed angle, rad, positive to the left.
        yaw_rad: f32,
    },
    /// Move along its heading.
    Move {
        /// Signed distance, m.
        distance_m: f32,
    },
}

impl Click {
    /// The action that it comes to for a robot that sees an object of its room in that direction, rad.
    ///
    /// # Errors
    /// Why it comes to none, in words for the wizard.
    pub fn action(self, bearing_rad: impl Fn(ObjectId) -> Option<f32>) -> Result<Action, String> {
        Ok(match self {
            Self::Point { object } => Action::Highlight { object: ObjectId(object) },
            Self::Look { object } => {
                let bearing_rad = bearing_rad(ObjectId(object));
                Action::Rotate { yaw_rad: bearing_rad.ok_or("The robot has to be in that room to look there.")? }
            }
            Self::Act { deed, object } => deed.on(ObjectId(object)),
            Self::Room { room } => Action::GoTo { target: GoToTarget::Room(room) },
            Self::Floor { at_m } if at_m.iter().all(|along| along.is_finite()) => {
                Action::GoTo { target: GoToTarget::Point(at_m) }
            }
            Self::Floor { .. } => return Err("That is no place on the floor.".to_owned()),
            Self::Turn { yaw_rad } => Action::Rotate { yaw_rad: yaw_rad.clamp(-PI, PI) },
            Self::Move { distance_m } => Action::Move { distance_m: distance_m.clamp(-FURTHEST_M, FURTHEST_M) },
        })
    }

    /// What was chosen, for the record.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Point { .. } => "point",
            Self::Look { .. } => "look",
            Self::Act { deed, .. } => deed.name(),
            Self::Room { .. } => "go_to_room",
            Self::Floor { .. } => "go_to_point",
            Self::Turn { .. } => "turn",
            Self::Move { .. } => "move",
        }
    }

    /// The object that was clicked, if one was.
    pub const fn object(self) -> Option<u32> {
        match self {
            Self::Point { object } | Self::Look { object } | Self::Act { object, .. } => Some(object),
            Self::Room { .. } | Self::Floor { .. } | Self::Turn { .. } | Self::Move { .. } => None,
        }
    }

    /// Whether it is chosen from what the page offers for a place, and not by a key alone.
    pub const fn is_of_menu(self) -> bool {
        !matches!(self, Self::Turn { .. } | Self::Move { .. })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn clicks_are_actions_of_the_robot() {
        let bearing = |object: ObjectId| (object == ObjectId(7)).then_some(0.5);
        for (click, name, expected) in [
            (Click::Point { object: 7 }, "point", Action::Highlight { object: ObjectId(7) }),
            (Click::Look { object: 7 }, "look", Action::Rotate { yaw_rad: 0.5 }),
            (Click::Act { deed: Deed::PickUp, object: 7 }, "pick_up", Action::PickUp { object: ObjectId(7) }),
            (Click::Floor { at_m: [1.0, 2.0] }, "go_to_point", Action::GoTo { target: GoToTarget::Point([1.0, 2.0]) }),
            (Click::Room { room: RoomId::LAB1 }, "go_to_room", Action::GoTo { target: GoToTarget::Room(RoomId::LAB1) }),
            (Click::Turn { yaw_rad: 9.0 }, "turn", Action::Rotate { yaw_rad: PI }),
            (Click::Move { distance_m: -9.0 }, "move", Action::Move { distance_m: -FURTHEST_M }),
        ] {
            assert_eq!((click.action(bearing), click.name()), (Ok(expected), name));
            let echoed: Click = serde_json::from_str(&serde_json::to_string(&click).unwrap()).unwrap();
            assert_eq!(echoed, click, "pages send back what they are offered");
        }
        for none in [Click::Look { object: 8 }, Click::Floor { at_m: [f32::INFINITY, 0.0] }] {
            assert!(none.action(bearing).is_err(), "{none:?}");
        }
    }
}
