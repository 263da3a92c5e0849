//! Actions, as Python makes them once it knows which object is meant.

use cohabit_cdf::{Action, GoToTarget, ObjectId, RoomId, Verb};
use pyo3::prelude::*;

use crate::{error::bad_argument, known_rooms};

/// One thing that a body can be told to do; objects are given by their number.
#[pyclass(frozen, name = "Action", module = "cohabit._native")]
pub struct PyAction {
    /// What is sent.
    pub action: Action,
    /// Why there is no object of the name that was given: the world refuses the action, and this is the reason.
    pub unknown: Option<String>,
}

/// What no object of any world has for its number.
const NOBODY: ObjectId = ObjectId(u32::MAX);

/// The object of an action: its number, or a sentence that says why there is none.
#[derive(FromPyObject)]
pub enum ObjectArgument {
    /// Its number.
    Number(u32),
    /// Why there is none.
    Unknown(String),
}

impl PyAction {
    /// An action that is done to no object, or to one that is known.
    pub const fn new(action: Action) -> Self {
        Self { action, unknown: None }
    }

    fn on(object: ObjectArgument, action: impl FnOnce(ObjectId) -> Action) -> Self {
        let (object, unknown) = object.found();
        Self { action: action(object), unknown }
    }
}

impl ObjectArgument {
    /// The object, and why there is none, if there is none.
    fn found(self) -> (ObjectId, Option<String>) {
        match self {
            Self::Number(number) => (ObjectId(number), None),
            Self::Unknown(why) => (NOBODY, Some(why)),
        }
    }
}

/// The room that is called that in missions, in any case.
fn room_of(id: &str) -> PyResult<RoomId> {
    let known = || known_rooms::builtin().listed();
    known_rooms::find(id).ok_or_else(|| bad_argument(format!("there is no room `{id}`: one of {}", known())))
}

fn finite(what: &str, value: f32) -> PyResult<f32> {
    if value.is_finite() { Ok(value) } else { Err(bad_argument(format!("`{what}` is {value}: it must be finite"))) }
}

#[pymethods]
impl PyAction {
    #[staticmethod]
    #[pyo3(name = "move")]
    fn advance(distance_m: f32) -> PyResult<Self> {
        Ok(Self::new(Action::Move { distance_m: finite("distance_m", distance_m)? }))
    }

    #[staticmethod]
    fn rotate(yaw_rad: f32) -> PyResult<Self> {
        Ok(Self::new(Action::Rotate { yaw_rad: finite("yaw_rad", yaw_rad)? }))
    }

    #[staticmethod]
    fn look(pitch_rad: f32) -> PyResult<Self> {
        Ok(Self::new(Action::Look { pitch_rad: finite("pitch_rad", pitch_rad)? }))
    }

    #[staticmethod]
    const fn look_around() -> Self {
        Self::new(Action::LookAround)
    }

    #[staticmethod]
    fn go_to_object(object: ObjectArgument) -> Self {
        Self::on(object, |object| Action::GoTo { target: GoToTarget::Object(object) })
    }

    #[staticmethod]
    fn go_to_room(room: &str) -> PyResult<Self> {
        Ok(Self::new(Action::GoTo { target: GoToTarget::Room(room_of(room)?) }))
    }

    #[staticmethod]
    fn go_to_viewpoint(room: &str, number: u8) -> PyResult<Self> {
        Ok(Self::new(Action::GoTo { target: GoToTarget::Viewpoint(room_of(room)?, number) }))
    }

    #[staticmethod]
    fn go_to_point(x_m: f32, y_m: f32) -> PyResult<Self> {
        Ok(Self::new(Action::GoTo { target: GoToTarget::Point([finite("x", x_m)?, finite("y", y_m)?]) }))
    }

    #[staticmethod]
    fn pick_up(object: ObjectArgument) -> Self {
        Self::on(object, |object| Action::PickUp { object })
    }

    #[staticmethod]
    #[pyo3(signature = (receptacle, beside=None))]
    fn place(receptacle: ObjectArgument, beside: Option<ObjectArgument>) -> Self {
        let (receptacle, unknown) = receptacle.found();
        let (beside, beside_unknown) = beside.map(ObjectArgument::found).unzip();
        Self { action: Action::place(receptacle, beside), unknown: unknown.or(beside_unknown.flatten()) }
    }

    #[staticmethod]
    fn interact(verb: &str, object: ObjectArgument) -> PyResult<Self> {
        let name = |verb: &Verb| format!("{verb:?}").to_lowercase();
        let verb = Verb::ALL.iter().find(|known| name(known).eq_ignore_ascii_case(verb)).ok_or_else(|| {
            let known: Vec<String> = Verb::ALL.iter().map(name).collect();
            bad_argument(format!("there is no verb `{verb}`: one of {}", known.join(", ")))
        })?;
        Ok(Self::on(object, |object| Action::Interact { verb: *verb, object }))
    }

    #[staticmethod]
    fn highlight(object: ObjectArgument) -> Self {
        Self::on(object, |object| Action::Highlight { object })
    }

    #[staticmethod]
    fn drive(forward_m_s: f32, turn_rad_s: f32, pitch_rad_s: f32) -> PyResult<Self> {
        Ok(Self::new(Action::Drive {
            forward_m_s: finite("forward_m_s", forward_m_s)?,
            turn_rad_s: finite("turn_rad_s", turn_rad_s)?,
            pitch_rad_s: finite("pitch_rad_s", pitch_rad_s)?,
        }))
    }

    #[staticmethod]
    const fn stop() -> Self {
        Self::new(Action::Stop)
    }

    fn __repr__(&self) -> String {
        format!("{:?}", self.action)
    }
}
