//! What is told and said in a session, as Python hears it.

use cohabit_bus::message::{DialogKind, DialogView, EventKind, EventMessage, NONE};
use pyo3::prelude::*;

/// Something that was told or said in a session.
#[pyclass(frozen, get_all, module = "cohabit._native")]
#[derive(Clone)]
pub struct Heard {
    /// What it is: an event (`outcome`, `started`, `goal_met`, `sound`, …) or dialog (`utterance`, `reply`, …).
    pub kind: String,
    /// The tick at which it happened; 0 of dialog.
    pub tick: u64,
    /// The body concerned.
    pub body: Option<u32>,
    /// The object concerned.
    pub object: Option<u32>,
    /// The command concerned; 0 is none.
    pub command: u64,
    /// The dialog turn that it belongs to; 0 is none.
    pub turn: u64,
    /// A goal's number, or how long something is shown.
    pub number: i64,
    /// Of an outcome, one of `STATUSES`.
    pub status: String,
    /// A sentence for people.
    pub text: String,
}

#[pymethods]
impl Heard {
    fn __repr__(&self) -> String {
        format!("Heard({}, body={:?}, {:?})", self.kind, self.body, self.text)
    }
}

fn some(index: u32) -> Option<u32> {
    (index != NONE).then_some(index)
}

/// `GoalMet` as `goal_met`.
fn snake(name: &str) -> String {
    let mut snake = String::new();
    for letter in name.chars() {
        if letter.is_uppercase() && !snake.is_empty() {
            snake.push('_');
        }
        snake.extend(letter.to_lowercase());
    }
    snake
}

impl Heard {
    pub(super) fn event(event: &EventMessage, kind: EventKind, tick: u64) -> Self {
        let status = if kind == EventKind::Outcome { event.status() } else { None };
        Self {
            kind: snake(&format!("{kind:?}")),
            tick,
            body: some(event.body),
            object: some(event.object),
            command: event.command,
            turn: event.turn,
            number: event.number,
            status: status.map_or_else(String::new, |status| format!("{status:?}")),
            text: event.text.as_str().to_owned(),
        }
    }

    pub(super) fn dialog(view: &DialogView<'_>, kind: DialogKind) -> Self {
        let ended = matches!(kind, DialogKind::StepEnded | DialogKind::PlanEnded);
        let status = view.header.status().filter(|_| ended);
        Self {
            kind: snake(&format!("{kind:?}")),
            tick: 0,
            body: some(view.header.body),
            object: None,
            command: 0,
            turn: view.header.turn,
            number: i64::from(view.header.step),
            status: status.map_or_else(String::new, |status| format!("{status:?}")),
            text: view.header.text.as_str().to_owned(),
        }
    }
}
