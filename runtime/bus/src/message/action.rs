//! An action as a record.

use bytemuck::{Pod, Zeroable};
use cohabit_cdf::{Action, GoToTarget, ObjectId, RoomId, Verb};

use super::{Malformed, room};

/// An [`Action`] in fixed form; fields that its kind does not use are zero. Of a room that is not built in it is a
/// `NamedRoomRecord` instead.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ActionRecord {
    /// Which action: a constant of `action.rs`.
    kind: u32,
    /// The object's index.
    object: u32,
    /// `Verb`.
    verb: u32,
    /// `RoomId`, of those that are built in.
    room: u32,
    /// Which of the room's viewpoints, from 1; or the index of what something is put beside.
    number: u32,
    /// A distance in m, an angle in rad, or a speed in m/s.
    value: f32,
    /// On the floor, x and y in m; or how fast to turn and to pitch the head, rad/s.
    point: [f32; 2],
}

/// What an [`ActionRecord`] is of `GO_TO_NAMED_ROOM` and `GO_TO_NAMED_VIEWPOINT`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct NamedRoomRecord {
    /// As of an `ActionRecord`.
    kind: u32,
    /// Which of the room's viewpoints, from 1.
    number: u32,
    /// The room's id, and zeroes behind it.
    room: [u8; 24],
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
/// Walk into `room`, which is built in.
const GO_TO_ROOM: u32 = 6;
/// Walk to viewpoint `number` of `room`, which is built in.
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
/// Walk into the `room` of a `NamedRoomRecord`.
const GO_TO_NAMED_ROOM: u32 = 15;
/// Walk to viewpoint `number` of the `room` of a `NamedRoomRecord`.
const GO_TO_NAMED_VIEWPOINT: u32 = 16;
/// Put what is held on or into `object`, beside the object of the index `number`.
const PLACE_BESIDE: u32 = 17;

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
                GoToTarget::Room(room) => Self::to_room([GO_TO_ROOM, GO_TO_NAMED_ROOM], room, 0),
                GoToTarget::Viewpoint(room, number) => {
                    Self::to_room([GO_TO_VIEWPOINT, GO_TO_NAMED_VIEWPOINT], room, number)
                }
                GoToTarget::Point(point) => Self { point, ..of(GO_TO_POINT) },
            },
            Action::PickUp { object } => Self { object: object.0, ..of(PICK_UP) },
            Action::Place { receptacle } => Self { object: receptacle.0, ..of(PLACE) },
            Action::PlaceBeside { receptacle, beside } => {
                Self { object: receptacle.0, number: beside.0, ..of(PLACE_BESIDE) }
            }
            Action::Interact { verb, object } => Self { verb: verb as u32, object: object.0, ..of(INTERACT) },
            Action::Highlight { object } => Self { object: object.0, ..of(HIGHLIGHT) },
            Action::Stop => of(STOP),
            Action::Drive { forward_m_s, turn_rad_s, pitch_rad_s } => {
                Self { value: forward_m_s, point: [turn_rad_s, pitch_rad_s], ..of(DRIVE) }
            }
        }
    }
}

impl ActionRecord {
    /// Of the first kind if the room is built in, of the second if it is not.
    fn to_room([builtin, named]: [u32; 2], room: RoomId, number: u8) -> Self {
        let number = u32::from(number);
        match room.builtin_index() {
            Some(index) => Self { kind: builtin, room: u32::from(index), number, ..Self::default() },
            None => bytemuck::cast(NamedRoomRecord { kind: named, number, room: room::text_of(room) }),
        }
    }
}

impl TryFrom<ActionRecord> for Action {
    type Error = Malformed;

    fn try_from(record: ActionRecord) -> Result<Self, Malformed> {
        let object = ObjectId(record.object);
        let room = || {
            let index = usize::try_from(record.room).ok();
            index.and_then(|index| RoomId::BUILTIN.get(index).copied()).ok_or(Malformed("no such room"))
        };
        let viewpoint = |number: u32| u8::try_from(number).map_err(|_| Malformed("no such viewpoint"));
        let number = |value: f32| if value.is_finite() { Ok(value) } else { Err(Malformed("not a finite number")) };
        Ok(match record.kind {
            MOVE => Self::Move { distance_m: number(record.value)? },
            ROTATE => Self::Rotate { yaw_rad: number(record.value)? },
            LOOK => Self::Look { pitch_rad: number(record.value)? },
            LOOK_AROUND => Self::LookAround,
            GO_TO_OBJECT => Self::GoTo { target: GoToTarget::Object(object) },
            GO_TO_ROOM => Self::GoTo { target: GoToTarget::Room(room()?) },
            GO_TO_VIEWPOINT => Self::GoTo { target: GoToTarget::Viewpoint(room()?, viewpoint(record.number)?) },
            GO_TO_NAMED_ROOM | GO_TO_NAMED_VIEWPOINT => {
                let record: NamedRoomRecord = bytemuck::cast(record);
                let room = room::of_text(&record.room)?;
                let target = if record.kind == GO_TO_NAMED_ROOM {
                    GoToTarget::Room(room)
                } else {
                    GoToTarget::Viewpoint(room, viewpoint(record.number)?)
                };
                Self::GoTo { target }
            }
            GO_TO_POINT => {
                Self::GoTo { target: GoToTarget::Point([number(record.point[0])?, number(record.point[1])?]) }
            }
            PICK_UP => Self::PickUp { object },
            PLACE => Self::Place { receptacle: object },
            PLACE_BESIDE => Self::PlaceBeside { receptacle: object, beside: ObjectId(record.number) },
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
#[allow(clippy::unwrap_used)]
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
            Action::PlaceBeside { receptacle: ObjectId(4), beside: ObjectId(0) },
            Action::Highlight { object: ObjectId(5) },
            Action::Stop,
            Action::Drive { forward_m_s: -1.0, turn_rad_s: 0.5, pitch_rad_s: 0.25 },
        ];
        actions.extend(Verb::ALL.map(|verb| Action::Interact { verb, object: ObjectId(9) }));
        let lounge = RoomId::new("Sun-Lounge_on_the_2nd_fl").unwrap();
        for room in RoomId::BUILTIN.into_iter().chain([lounge]) {
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
            ActionRecord { kind: GO_TO_NAMED_ROOM, ..ActionRecord::default() },
            bytemuck::cast(NamedRoomRecord { kind: GO_TO_NAMED_ROOM, number: 0, room: [0xFF; 24] }),
            bytemuck::cast(NamedRoomRecord { kind: GO_TO_NAMED_VIEWPOINT, number: 256, room: [b'A'; 24] }),
        ] {
            assert!(Action::try_from(record).is_err(), "{record:?}");
        }
    }
}
