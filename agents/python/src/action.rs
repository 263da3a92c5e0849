//! Actions, as Python makes them once it knows which object is meant.

use cohabit_cdf::{Action, GoToTarget, ObjectId, RoomId, Verb};
use pyo3::prelude::*;

use crate::error::bad_argument;

/// One thing that a body can be told to do; objects are given by their number.
#[pyclass(frozen, name = "Action", module = "cohabit._native")]
pub struct PyAction(pub Action);

/// The room that is called that in missions, in any case.
fn room_of(id: &str) -> PyResult<RoomId> {
    let found = RoomId::ALL.into_iter().find(|room| room.id().eq_ignore_ascii_case(id));
    let known = || RoomId::ALL.map(RoomId::id).join(", ");
    found.ok_or_else(|| bad_argument(format!("there is no room `{id}`: one of {}", known())))
}

fn finite(what: &str, value: f32) -> PyResult<f32> {
    if value.is_finite() { Ok(value) } else { Err(bad_argument(format!("`{what}` is {value}: it must be finite"))) }
}

#[pymethods]
impl PyAction {
    #[staticmethod]
    #[pyo3(name = "move")]
    fn advance(distance_m: f32) -> PyResult<Self> {
        Ok(Self(Action::Move { distance_m: finite("distance_m", distance_m)? }))
    }

    #[staticmethod]
    fn rotate(yaw_rad: f32) -> PyResult<Self> {
        Ok(Self(Action::Rotate { yaw_rad: finite("yaw_rad", yaw_rad)? }))
    }

    #[staticmethod]
    fn look(pitch_rad: f32) -> PyResult<Self> {
        Ok(Self(Action::Look { pitch_rad: finite("pitch_rad", pitch_rad)? }))
    }

    #[staticmethod]
    const fn look_around() -> Self {
        Self(Action::LookAround)
    }

    #[staticmethod]
    const fn go_to_object(object: u32) -> Self {
        Self(Action::GoTo { target: GoToTarget::Object(ObjectId(object)) })
    }

    #[staticmethod]
    fn go_to_room(room: &str) -> PyResult<Self> {
        Ok(Self(Action::GoTo { target: GoToTarget::Room(room_of(room)?) }))
    }

    #[staticmethod]
    fn go_to_viewpoint(room: &str, number: u8) -> PyResult<Self> {
        Ok(Self(Action::GoTo { target: GoToTarget::Viewpoint(room_of(room)?, number) }))
    }

    #[staticmethod]
    fn go_to_point(x_m: f32, y_m: f32) -> PyResult<Self> {
        Ok(Self(Action::GoTo { target: GoToTarget::Point([finite("x", x_m)?, finite("y", y_m)?]) }))
    }

    #[staticmethod]
    const fn pick_up(object: u32) -> Self {
        Self(Action::PickUp { object: ObjectId(object) })
    }

    #[staticmethod]
    const fn place(receptacle: u32) -> Self {
        Self(Action::Place { receptacle: ObjectId(receptacle) })
    }

    #[staticmethod]
    fn interact(verb: &str, object: u32) -> PyResult<Self> {
        let name = |verb: &Verb| format!("{verb:?}").to_lowercase();
        let verb = Verb::ALL.iter().find(|known| name(known).eq_ignore_ascii_case(verb)).ok_or_else(|| {
            let known: Vec<String> = Verb::ALL.iter().map(name).collect();
            bad_argument(format!("there is no verb `{verb}`: one of {}", known.join(", ")))
        })?;
        Ok(Self(Action::Interact { verb: *verb, object: ObjectId(object) }))
    }

    #[staticmethod]
    const fn highlight(object: u32) -> Self {
        Self(Action::Highlight { object: ObjectId(object) })
    }

    #[staticmethod]
    fn drive(forward_m_s: f32, turn_rad_s: f32, pitch_rad_s: f32) -> PyResult<Self> {
        Ok(Self(Action::Drive {
            forward_m_s: finite("forward_m_s", forward_m_s)?,
            turn_rad_s: finite("turn_rad_s", turn_rad_s)?,
            pitch_rad_s: finite("pitch_rad_s", pitch_rad_s)?,
        }))
    }

    #[staticmethod]
    const fn stop() -> Self {
        Self(Action::Stop)
    }

    fn __repr__(&self) -> String {
        format!("{:?}", self.0)
    }
}
