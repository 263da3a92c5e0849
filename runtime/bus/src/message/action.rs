//! An action as a record.

use bytemuck::{Pod, Zeroable};
use cohabit_cdf::{Action, GoToTarget, ObjectId, RoomId, Verb};

use super::Malformed;

/// An [`Action`] in fixed form; fields that its kind does not use are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ActionRecord {
    /// Which action: a constant of `action.rs`.
    kind: u32,
    /// The object's index.
    object: u32,
    /// `Verb`.
    verb: u32,
    /// `RoomId`.
    room: u32,
    /// Which of the room's viewpoints, from 1.
    number: u32,
    /// A distance in m, an angle in rad, or a speed in m/s.
    value: f32,
    /// On the floor, x and y in m; or how fast to turn and to pitch the head, rad/s.
    point: [f32; 2],
}

/// Move by `value` m; negative is backwards.
const MOVE: u32 = 1;
/// Turn by `value` rad; positive is to the left.
const ROTATE: u32 = 2;
/// Pitch the head by `value` rad; positive is up.
const LOOK: u32 = 3;
/// Turn once around, looking.
const LOOK_AROUND: u32 = 4;
/// Walk to where `object` is in reach.
const GO_TO_OBJECT: u32 = 5;
/// Walk into `room`.
const GO_TO_ROOM: u32 = 6;
/// Walk to viewpoint `number` of `room`.
const GO_TO_VIEWPOINT: u32 = 7;
/// Walk to `point`.
const GO_TO_POINT: u32 = 8;
/// Take `object`.
const PICK_UP: u32 = 9;
/// Put what is held on or into `object`.
const PLACE: u32 = 10;
/// Do `verb` to `object`.
const INTERACT: u32 = 11;
/// Point `object` out.
const HIGHLIGHT: u32 = 12;
/// Let go of whatever it is doing.
const STOP: u32 = 13;
/// Keep moving by `value` m/s, turning and pitching by `point` rad/s.
const DRIVE: u32 = 14;

impl From<Action> for ActionRecord {
    fn from(action: Action) -> Self {
        let of = |kind| Self { kind, ..Self::default() };
        match action {
            Action::Move { distance_m } => Self { value: distance_m, ..of(MOVE) },
            Action::Rotate { yaw_rad } => Self { value: yaw_rad, ..of(ROTATE) },
            Action::Look { pitch_rad } => Self { value: pitch_rad, ..of(LOOK) },
            Action::LookAround => of(LOOK_AROUND),
            Action::GoTo { target } => match target {
                GoToTarget::Object(object) => Self { object: object.0, ..of(GO_TO_OBJECT) },
                GoToTarget::Room(room) => Self { room: room as u32, ..of(GO_TO_ROOM) },
                GoToTarget::Viewpoint(room, number) => {
                    Self { room: room as u32, number: u32::from(number), ..of(GO_TO_VIEWPOINT) }
                }
                GoToTarget::Point(point) => Self { point, ..of(GO_TO_POINT) },
            },
            Action::PickUp { object } => Self { object: object.0, ..of(PICK_UP) },
            Action::Place { receptacle } => Self { object: receptacle.0, ..of(PLACE) },
            Action::Interact { verb, object } => Self { verb: verb as u32, object: object.0, ..of(INTERACT) },
            Action::Highlight { object } => Self { object: object.0, ..of(HIGHLIGHT) },
            Action::Stop => of(STOP),
            Action::Drive { forward_m_s, turn_rad_s, pitch_rad_s } => {
                Self { value: forward_m_s, point: [turn_rad_s, pitch_rad_s], ..of(DRIVE) }
            }
        }
    }
}

impl TryFrom<ActionRecord> for Action {
    type Error = Malformed;

    fn try_from(record: ActionRecord) -> Result<Self, Malformed> {
        let object = ObjectId(record.object);
        let room = || RoomId::from_index(record.room).ok_or(Malformed("no such room"));
        let number = |value: f32| if value.is_finite() { Ok(value) } else { Err(Malformed("not a finite number")) };
        Ok(match record.kind {
            MOVE => Self::Move { distance_m: number(record.value)? },
            ROTATE => Self::Rotate { yaw_rad: number(record.value)? },
            LOOK => Self::Look { pitch_rad: number(record.value)? },
            LOOK_AROUND => Self::LookAround,
            GO_TO_OBJECT => Self::GoTo { target: GoToTarget::Object(object) },
            GO_TO_ROOM => Self::GoTo { target: GoToTarget::Room(room()?) },
            GO_TO_VIEWPOINT => {
                let viewpoint = u8::try_from(record.number).map_err(|_| Malformed("no such viewpoint"))?;
                Self::GoTo { target: GoToTarget::Viewpoint(room()?, viewpoint) }
            }
            GO_TO_POINT => {
                Self::GoTo { target: GoToTarget::Point([number(record.point[0])?, number(record.point[1])?]) }
            }
            PICK_UP => Self::PickUp { object },
            PLACE => Self::Place { receptacle: object },
            INTERACT => {
                let verb = Verb::ALL.get(record.verb as usize).copied().ok_or(Malformed("no such verb"))?;
                Self::Interact { verb, object }
            }
            HIGHLIGHT => Self::Highlight { object },
            STOP => Self::Stop,
            DRIVE => Self::Drive {
                forward_m_s: number(record.value)?,
                turn_rad_s: number(record.point[0])?,
                pitch_rad_s: number(record.point[1])?,
            },
            _ => return Err(Malformed("no such action")),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_action_survives_the_record() {
        let mut actions = vec![
            Action::Move { distance_m: -1.5 },
            Action::Rotate { yaw_rad: 0.5 },
            Action::Look { pitch_rad: -0.25 },
            Action::LookAround,
            Action::GoTo { target: GoToTarget::Object(ObjectId(7)) },
            Action::GoTo { target: GoToTarget::Point([1.0, -2.0]) },
            Action::PickUp { object: ObjectId(3) },
            Action::Place { receptacle: ObjectId(4) },
            Action::Highlight { object: ObjectId(5) },
            Action::Stop,
            Action::Drive { forward_m_s: -1.0, turn_rad_s: 0.5, pitch_rad_s: 0.25 },
        ];
        actions.extend(Verb::ALL.map(|verb| Action::Interact { verb, object: ObjectId(9) }));
        for room in RoomId::ALL {
            actions.push(Action::GoTo { target: GoToTarget::Room(room) });
            actions.push(Action::GoTo { target: GoToTarget::Viewpoint(room, 8) });
        }
        for action in actions {
            assert_eq!(Action::try_from(ActionRecord::from(action)), Ok(action));
        }
    }

    #[test]
    fn nonsense_is_refused() {
        for record in [
            ActionRecord { kind: 0, ..ActionRecord::default() },
            ActionRecord { kind: 99, ..ActionRecord::default() },
            ActionRecord { kind: MOVE, value: f32::NAN, ..ActionRecord::default() },
            ActionRecord { kind: DRIVE, point: [0.0, f32::INFINITY], ..ActionRecord::default() },
            ActionRecord { kind: INTERACT, verb: 99, ..ActionRecord::default() },
            ActionRecord { kind: GO_TO_ROOM, room: 99, ..ActionRecord::default() },
        ] {
            assert!(Action::try_from(record).is_err(), "{record:?}");
        }
    }
}
