//! The discrete actions of environments: what a policy chooses from, and what of it makes sense.

use std::{
    f32::consts::PI,
    sync::{Arc, OnceLock},
};

use cohabit_cdf::{Action, ActionKind, Catalog, GoToTarget, ObjectClass, ObjectId, RoomId, Verb};
use pyo3::prelude::*;

use crate::{action::PyAction, error::bad_argument, known_rooms};

/// One step ahead or back, m.
const STRIDE_M: f32 = 0.5;
/// One turn to a side, rad: 30 degrees.
const TURN_RAD: f32 = PI / 6.0;
/// One look up or down, rad: 15 degrees.
const LOOK_RAD: f32 = PI / 12.0;

/// A kind of action; those on an object take one of the slots.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Choice {
    Wait,
    MoveAhead,
    MoveBack,
    TurnLeft,
    TurnRight,
    LookUp,
    LookDown,
    GoToRoom(RoomId),
    GoTo,
    PickUp,
    Place,
    Interact(Verb),
}

impl Choice {
    /// All of them, in the order of their numbers.
    pub fn all() -> impl Iterator<Item = Self> {
        use Choice::{GoTo, LookDown, LookUp, MoveAhead, MoveBack, PickUp, Place, TurnLeft, TurnRight, Wait};
        let moves = [Wait, MoveAhead, MoveBack, TurnLeft, TurnRight, LookUp, LookDown];
        let acts = [GoTo, PickUp, Place].into_iter().chain(Verb::ALL.map(Self::Interact));
        moves.into_iter().chain(known_rooms::builtin().ids().map(Self::GoToRoom)).chain(acts)
    }

    /// The choice of that number.
    ///
    /// # Errors
    /// A `ValueError` if there is none.
    pub fn numbered(number: i64) -> PyResult<Self> {
        let choice = usize::try_from(number).ok().and_then(|number| Self::all().nth(number));
        let last = Self::all().count() - 1;
        choice.ok_or_else(|| bad_argument(format!("there is no choice {number}: 0 to {last}")))
    }

    /// As documents call it.
    pub fn name(self) -> String {
        match self {
            Self::Wait => "wait".to_owned(),
            Self::MoveAhead => "move_ahead".to_owned(),
            Self::MoveBack => "move_back".to_owned(),
            Self::TurnLeft => "turn_left".to_owned(),
            Self::TurnRight => "turn_right".to_owned(),
            Self::LookUp => "look_up".to_owned(),
            Self::LookDown => "look_down".to_owned(),
            Self::GoToRoom(room) => format!("go_to_{}", room.id()),
            Self::GoTo => "go_to".to_owned(),
            Self::PickUp => "pick_up".to_owned(),
            Self::Place => "place".to_owned(),
            Self::Interact(verb) => format!("{verb:?}").to_lowercase(),
        }
    }

    /// Whether it is done to an object.
    pub const fn takes_slot(self) -> bool {
        matches!(self, Self::GoTo | Self::PickUp | Self::Place | Self::Interact(_))
    }

    /// The room that it leads to, if it is to go to one.
    pub const fn room(self) -> Option<RoomId> {
        if let Self::GoToRoom(room) = self { Some(room) } else { None }
    }

    /// The command that it means, done to `object` if to one; none for waiting.
    pub const fn action(self, object: ObjectId) -> Option<Action> {
        Some(match self {
            Self::Wait => return None,
            Self::MoveAhead => Action::Move { distance_m: STRIDE_M },
            Self::MoveBack => Action::Move { distance_m: -STRIDE_M },
            Self::TurnLeft => Action::Rotate { yaw_rad: TURN_RAD },
            Self::TurnRight => Action::Rotate { yaw_rad: -TURN_RAD },
            Self::LookUp => Action::Look { pitch_rad: LOOK_RAD },
            Self::LookDown => Action::Look { pitch_rad: -LOOK_RAD },
            Self::GoToRoom(room) => Action::GoTo { target: GoToTarget::Room(room) },
            Self::GoTo => Action::GoTo { target: GoToTarget::Object(object) },
            Self::PickUp => Action::PickUp { object },
            Self::Place => Action::Place { receptacle: object },
            Self::Interact(verb) => Action::Interact { verb, object },
        })
    }

    /// Whether things of that class afford it to somebody who holds `held`, by the table of actions. The world may refuse it
    /// all the same: what is locked affords opening.
    pub fn is_afforded(self, catalog: &Catalog, class: &ObjectClass, held: Option<&ObjectClass>) -> bool {
        self.kind().is_none_or(|kind| catalog.table().affords(kind, class, held))
    }

    /// What it does to an object, if it is done to one.
    const fn kind(self) -> Option<ActionKind> {
        match self {
            Self::PickUp => Some(ActionKind::PickUp),
            Self::Place => Some(ActionKind::Place),
            Self::Interact(verb) => Some(ActionKind::of_verb(verb)),
            _ => None,
        }
    }
}

/// What things of a catalogue's classes afford to somebody, by what they hold.
pub struct Affordances {
    catalog: Arc<Catalog>,
    /// For nothing that is held, then for each class that is: of each class the choices, a bit each by their numbers.
    by_held: Vec<OnceLock<Vec<u64>>>,
}

impl Affordances {
    /// Those of a catalogue, of which nothing is worked out yet.
    pub fn new(catalog: Arc<Catalog>) -> Self {
        let by_held = (0..=catalog.classes().len()).map(|_| OnceLock::new()).collect();
        Self { catalog, by_held }
    }

    /// The choices that things of a class afford to somebody who holds a thing of another class, or nothing: a bit each, by their
    /// numbers. Worked out for all classes at once when something of a class is held first.
    pub fn of(&self, class: u16, held: Option<u16>) -> u64 {
        let classes = self.catalog.classes();
        let held_class = held.and_then(|held| classes.get(usize::from(held)));
        let place = held.map_or(0, |held| usize::from(held) + 1);
        let row = |class: &ObjectClass| {
            let suits = |choice: Choice| u64::from(choice.is_afforded(&self.catalog, class, held_class));
            (0_u32..).zip(Choice::all()).fold(0, |bits, (number, choice)| bits | suits(choice) << number)
        };
        let rows = self.by_held.get(place).map(|rows| rows.get_or_init(|| classes.iter().map(row).collect()));
        rows.and_then(|rows| rows.get(usize::from(class))).copied().unwrap_or(0)
    }
}

/// The command that a choice means, done to an object if to one; none for waiting.
///
/// # Errors
/// A `ValueError` if there is no such choice.
#[pyfunction]
pub fn choice_action(choice: i64, object: u32) -> PyResult<Option<PyAction>> {
    Ok(Choice::numbered(choice)?.action(ObjectId(object)).map(PyAction::new))
}
