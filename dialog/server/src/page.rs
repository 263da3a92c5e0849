//! What the page is told, as JSON.

use cohabit_bus::message::{NONE, ObjectRecord, StateView};
use cohabit_cdf::{Catalog, ClassId, Layout, Mission, RoomId, layout::OpeningKind, model::Axis};
use serde::Serialize;
use serde_json::{Value, json};

use crate::latency::Moments;

/// Who says a line of chat.
#[derive(Clone, Copy, Debug, Eq, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Speaker {
    /// Somebody at a page.
    Person,
    /// The robot.
    Robot,
    /// The game.
    Game,
}

/// What kind of line it is.
#[derive(Clone, Copy, Debug, Eq, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum LineKind {
    /// Something said.
    Say,
    /// A question that waits for an answer.
    Question,
    /// Something that did not work, or was not understood.
    Problem,
    /// A goal was reached.
    Goal,
    /// A note was read.
    Note,
    /// The mission ended.
    Ending,
}

/// One line of chat.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Line {
    /// Always `chat`.
    #[serde(rename = "type")]
    pub message: &'static str,
    /// Who.
    pub from: Speaker,
    /// What kind.
    pub kind: LineKind,
    /// The turn; 0 is none.
    pub turn: u64,
    /// What.
    pub text: String,
}

impl Line {
    /// A line of chat.
    pub fn new(from: Speaker, kind: LineKind, turn: u64, text: impl Into<String>) -> Self {
        Self { message: "chat", from, kind, turn, text: text.into() }
    }
}

/// What a page learns first: the mission and the floor plan.
pub fn hello(session: &str, mission: &Mission, layout: &Layout) -> Value {
    let rooms: Vec<Value> = layout
        .rooms
        .iter()
        .map(|room| json!({ "id": room.id.id(), "name": room.id.name(), "rects": room.rects_m, "floor": room.floor.color }))
        .collect();
    let openings: Vec<Value> = layout
        .openings
        .iter()
        .filter(|opening| opening.kind != OpeningKind::Window)
        .map(|opening| {
            json!({ "x": opening.at_m[0], "y": opening.at_m[1], "width": opening.width_m,
                    "along": if opening.wall_runs == Axis::X { "x" } else { "y" } })
        })
        .collect();
    json!({
        "type": "hello",
        "session": session,
        "mission": { "title": mission.goal_text, "description": mission.description },
        "map": { "rooms": rooms, "openings": openings },
    })
}

/// The present state.
pub fn state(tick: u64, state: StateView<'_>, catalog: &Catalog) -> Value {
    let goals: Vec<Value> = state
        .goals
        .iter()
        .map(|goal| {
            let hidden = goal.hidden == 1;
            let text = if hidden { "A goal you have yet to discover" } else { goal.description.as_str() };
            json!({ "text": text, "met": goal.met == 1, "hidden": hidden })
        })
        .collect();
    let notes: Vec<Value> = state
        .notes
        .iter()
        .filter_map(|note| {
            let object = state.objects.iter().find(|object| object.object == note.object)?;
            let [x, y, _] = object.position_m;
            (object.hidden == 0).then(|| json!({ "x": x, "y": y, "read": note.read == 1 }))
        })
        .collect();
    let ending = ["running", "complete", "failed"].get(state.header.ending as usize);
    json!({
        "type": "state",
        "tick": tick,
        "score": state.header.score,
        "ending": ending,
        "robot": robot(state, catalog),
        "goals": goals,
        "notes": notes,
    })
}

fn robot(state: StateView<'_>, catalog: &Catalog) -> Value {
    let Some(body) = state.bodies.first() else { return Value::Null };
    let [x, y, _] = body.position_m;
    let room = RoomId::from_index(body.room);
    let held = (body.held != NONE).then(|| state.objects.iter().find(|object| object.object == body.held)).flatten();
    json!({
        "x": x,
        "y": y,
        "yaw": body.yaw_rad,
        "room": room.map(RoomId::id),
        "room_name": room.map(RoomId::name),
        "holding": held.map(|object| name(object, catalog)),
        "busy": body.busy == 1,
    })
}

/// What people call an object.
pub fn name<'a>(object: &ObjectRecord, catalog: &'a Catalog) -> &'a str {
    let known = usize::from(object.class) < catalog.classes().len();
    if known { &catalog.class(ClassId(object.class)).name } else { "something" }
}

/// An object is pointed out.
pub fn highlight(object: &ObjectRecord, catalog: &Catalog) -> Value {
    let [x, y, _] = object.position_m;
    json!({ "type": "highlight", "x": x, "y": y, "name": name(object, catalog) })
}

/// A plan goes on.
pub fn progress(turn: u64, step: u32, steps: usize, says: &str) -> Value {
    json!({ "type": "progress", "turn": turn, "step": step + 1, "steps": steps, "text": says })
}

/// A turn is over.
pub fn turn_ended(turn: u64, status: &str) -> Value {
    json!({ "type": "turn", "turn": turn, "ended": true, "status": status })
}

/// How long a turn took so far.
pub fn latency(moments: &Moments) -> Value {
    let [understood, moved, shown] = moments.milliseconds();
    json!({ "type": "latency", "turn": moments.turn, "understood_ms": understood, "moved_ms": moved, "shown_ms": shown })
}

/// Something is wrong with what a page sent.
pub fn error(text: &str) -> Value {
    json!({ "type": "error", "text": text })
}
