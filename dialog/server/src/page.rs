//! What the page is told, as JSON.

use std::collections::BTreeMap;

use cohabit_bus::{
    CameraId, Text,
    message::{BodyRecord, CameraRecord, NONE, ObjectRecord, PlanStep, Plane, StateView, Thing},
};
use cohabit_cdf::{
    Action, BodyId, BodyKind, Catalog, ClassId, Layout, Mission, ObjectId, layout::OpeningKind, model::Axis,
};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::{
    affordances::Affordance,
    driving::DrivableBody,
    expression::FacialExpression,
    latency::Moments,
    person_seats::PersonSeat,
    text::{in_lines, in_one_line},
    wizard::{Click, Holding, LONGEST_SAYING, Proposal},
};

/// Who says a line of chat.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
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
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
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

/// What the game says when all goals are met.
pub const COMPLETE: &str = "Mission complete. Well done!";

/// What the game says when a hazard has ended the mission.
pub fn failed(why: &str) -> String {
    format!("Mission failed. {why}")
}

/// What the game says when a goal is discovered.
pub fn new_goal(goal: &str) -> String {
    format!("New goal: {goal}")
}

/// One line of chat.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Line {
    /// Always `chat`.
    #[serde(rename = "type", skip_deserializing, default = "Line::message")]
    pub message: &'static str,
    /// Who.
    pub from: Speaker,
    /// What kind.
    pub kind: LineKind,
    /// The turn; 0 is none.
    pub turn: u64,
    /// What.
    pub text: String,
    /// Which body speaks or is spoken to, where there are several robots.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub body: Option<u32>,
    /// What the peer is called that says it, where that is not the robot's own mind.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The page at which a person said it: pages are numbered as they come, from 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub visitor: Option<u32>,
    /// Answers that a question offers.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub answers: Vec<Answer>,
}

/// An answer that a question offers.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Answer {
    /// What it says.
    pub text: String,
    /// The object it means; without one, it is said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub object: Option<u32>,
}

impl Answer {
    /// The same on the bus.
    pub fn offer(&self) -> PlanStep {
        let action = self.object.map(|object| Action::Highlight { object: ObjectId(object) }.into());
        PlanStep { action: action.unwrap_or_default(), says: Text::new(&self.text) }
    }
}

impl Line {
    /// A line of chat.
    pub fn new(from: Speaker, kind: LineKind, turn: u64, text: impl Into<String>) -> Self {
        Self {
            message: Self::message(),
            from,
            kind,
            turn,
            text: in_lines(&text.into()),
            body: None,
            name: None,
            visitor: None,
            answers: Vec::new(),
        }
    }

    const fn message() -> &'static str {
        "chat"
    }
}

/// A camera that a page can look through, and what people call it.
pub struct ViewName {
    /// Which.
    pub camera: CameraId,
    /// What people call it.
    pub name: String,
}

/// A robot that people speak to.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct RobotName {
    /// Its body.
    pub body: BodyId,
    /// What people call it.
    pub name: String,
}

/// What people call bodies: as they were named, or else `robot`, `person`, with a number where there are several of a kind.
pub fn body_names(bodies: &[BodyRecord], named: &BTreeMap<u32, String>) -> Vec<String> {
    let kind = |record: &BodyRecord| body_kind(record);
    (0..bodies.len())
        .map(|index| {
            if let Some(name) = named.get(&bodies[index].body) {
                return name.clone();
            }
            let kin = |records: &[BodyRecord]| records.iter().filter(|one| kind(one) == kind(&bodies[index])).count();
            let name = kind(&bodies[index]);
            if kin(bodies) > 1 { format!("{name} {}", kin(&bodies[..=index])) } else { name.to_owned() }
        })
        .collect()
}

/// The cameras that people can look through, the one behind the first body first.
pub fn views(cameras: &[CameraRecord], names: &[String], robots: usize) -> Vec<ViewName> {
    let name_of = |body: u8| names.get(usize::from(body)).map_or("somebody", String::as_str);
    let one = robots < 2;
    let mut views: Vec<ViewName> = (cameras.iter().filter(|camera| camera.has(Plane::Color)))
        .filter_map(|record| {
            let camera = record.camera()?;
            let name = match camera {
                CameraId::Spectator(0) if one => "Third person".to_owned(),
                CameraId::Spectator(body) => format!("Behind {}", the(name_of(body))),
                CameraId::Eyes(0) if one => "Robot's eyes".to_owned(),
                CameraId::Eyes(body) => format!("Eyes of {}", the(name_of(body))),
                CameraId::Overhead(0) if one => "From above".to_owned(),
                CameraId::Overhead(body) => format!("Above {}", the(name_of(body))),
                CameraId::Named(name) => name.to_string(),
                // People have the same, larger, by `Eyes`.
                CameraId::Egocentric(_) => return None,
            };
            Some(ViewName { camera, name })
        })
        .take(usize::from(u8::MAX))
        .collect();
    let rank = |camera: CameraId| match camera {
        CameraId::Spectator(0) => 0,
        CameraId::Eyes(0) => 1,
        CameraId::Overhead(0) => 2,
        CameraId::Named(_) => 3,
        _ => 4,
    };
    views.sort_by_key(|view| rank(view.camera));
    views
}

/// Which number a page has among all, the questionnaires that it has answered, and its seat, if it has one.
pub fn you(visitor: u32, answered: &[String], seat: Option<PersonSeat>) -> Value {
    let mut you = json!({ "type": "you", "visitor": visitor, "answered": answered });
    if let Some(seat) = seat {
        you["seat"] = json!(seat);
    }
    you
}

/// A questionnaire is answered, or is not, and why.
pub fn answered(questionnaire: &str, problem: Option<&str>) -> Value {
    json!({ "type": "answered", "questionnaire": questionnaire, "problem": problem })
}

/// A name that somebody was given stands alone.
fn the(name: &str) -> String {
    let is_kind = BodyKind::ALL.iter().any(|kind| name.starts_with(kind.name()));
    if is_kind { format!("the {name}") } else { name.to_owned() }
}

/// What a page learns first: the mission, the floor plan and the views.
pub fn hello(
    session: &str,
    mission: &Mission,
    layout: &Layout,
    catalog: &Catalog,
    views: &[ViewName],
    drivable: &[DrivableBody],
    robots: &[RobotName],
) -> Value {
    let rooms: Vec<Value> = layout
        .rooms
        .iter()
        .map(|room| {
            let (id, name) = (room.id.id(), room.id.name_in(catalog));
            json!({ "id": id, "name": name, "rects": room.rects_m, "floor": room.floor.color })
        })
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
    let view = |view: &ViewName| json!({ "camera": view.camera.to_string(), "name": view.name });
    let views: Vec<Value> = views.iter().map(view).collect();
    let drivable = drivable
        .iter()
        .map(|one| json!({ "body": one.body, "name": one.name, "camera": one.camera.to_string() }))
        .collect::<Vec<Value>>();
    json!({
        "type": "hello",
        "session": session,
        "mission": { "title": in_one_line(&mission.goal_text), "description": in_one_line(&mission.description) },
        "map": { "rooms": rooms, "openings": openings, "furniture": layout.furniture_outlines_m(catalog) },
        "views": views,
        "drivable": drivable,
        "robots": robots.iter().map(|one| json!({ "body": one.body.0, "name": one.name })).collect::<Vec<Value>>(),
    })
}

/// The present state, and which bodies people drive.
pub fn state(tick: u64, state: StateView<'_>, driven: &[u32], catalog: &Catalog) -> Value {
    let goals: Vec<Value> = state
        .goals
        .iter()
        .map(|goal| {
            let hidden = goal.hidden == 1;
            let text = match goal.description.as_str() {
                _ if hidden => "A goal you have yet to discover",
                "" => "A goal that the mission does not describe",
                text => text,
            };
            json!({ "text": in_one_line(text), "met": goal.met == 1, "hidden": hidden })
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
        "others": others(state, catalog),
        "driven": driven,
        "goals": goals,
        "notes": notes,
    })
}

fn robot(state: StateView<'_>, catalog: &Catalog) -> Value {
    let Some(body) = state.bodies.first() else { return Value::Null };
    let [x, y, _] = body.position_m;
    let room = catalog.room_at(body.room);
    json!({
        "body": body.body,
        "x": x,
        "y": y,
        "yaw": body.yaw_rad,
        "room": room.map(|room| room.to_string()),
        "room_name": room.map(|room| room.name_in(catalog)),
        "holding": holding(body, state, catalog),
        "busy": body.busy == 1,
    })
}

/// What a body holds, in people's words.
fn holding<'a>(body: &BodyRecord, state: StateView<'_>, catalog: &'a Catalog) -> Option<&'a str> {
    let held = state.objects.iter().find(|object| body.held != NONE && object.object == body.held)?;
    Some(name(held, catalog))
}

/// All bodies but the one that people speak to.
fn others(state: StateView<'_>, catalog: &Catalog) -> Vec<Value> {
    let place = |body: &BodyRecord| {
        let [x, y, _] = body.position_m;
        json!({ "body": body.body, "kind": body_kind(body), "x": x, "y": y, "yaw": body.yaw_rad,
                "room_name": catalog.room_at(body.room).map(|room| room.name_in(catalog)),
                "holding": holding(body, state, catalog) })
    };
    state.bodies.iter().skip(1).map(place).collect()
}

fn body_kind(body: &BodyRecord) -> &'static str {
    body.kind().map_or("somebody", BodyKind::name)
}

/// What somebody points at, at a place of the picture.
pub fn seen(thing: Thing, [x, y]: [f32; 2], state: StateView<'_>, catalog: &Catalog) -> Option<Value> {
    let (name, at_m) = match thing {
        Thing::Object(id) => {
            let object = state.objects.iter().find(|object| object.object == id.0)?;
            (name(object, catalog), Some(object.position_m))
        }
        Thing::Body(id) => {
            let body = state.bodies.iter().find(|body| body.body == id.0)?;
            (body_kind(body), Some(body.position_m))
        }
        Thing::Surface(room) => (catalog.room_at(room)?.name_in(catalog), None),
        Thing::Nothing => return None,
    };
    Some(json!({ "type": "seen", "name": name, "x": x, "y": y, "at": at_m.map(|[x, y, _]| [x, y]) }))
}

/// What people call an object.
pub fn name<'a>(object: &ObjectRecord, catalog: &'a Catalog) -> &'a str {
    let known = usize::from(object.class) < catalog.classes().len();
    if known { &catalog.class(ClassId(object.class)).name } else { "something" }
}

/// An object is pointed out, with its number if it is one of several answers.
pub fn highlight(object: &ObjectRecord, number: Option<usize>, catalog: &Catalog) -> Value {
    let [x, y, _] = object.position_m;
    json!({ "type": "highlight", "x": x, "y": y, "name": name(object, catalog), "number": number })
}

/// Something can be heard of an object: what kind of sound, of what class, and where, m.
pub fn sound(object: &ObjectRecord, kind: &str, catalog: &Catalog) -> Value {
    let [x, y, z] = object.position_m;
    let known = usize::from(object.class) < catalog.classes().len();
    let class = if known { &catalog.class(ClassId(object.class)).id } else { "" };
    json!({ "type": "sound", "kind": kind.to_lowercase(), "of": class, "x": x, "y": y, "z": z })
}

/// Where in the picture of a camera the numbered answers to the open question are: number, and how far from the left and
/// from the top, 0 to 1.
pub fn marks(camera: CameraId, marks: &[(usize, [f32; 2])]) -> Value {
    let mark = |(number, [x, y]): &(usize, [f32; 2])| json!({ "number": number, "x": x, "y": y });
    json!({ "type": "marks", "camera": camera.to_string(), "marks": marks.iter().map(mark).collect::<Vec<Value>>() })
}

/// A plan goes on.
pub fn progress(body: u32, turn: u64, step: u32, steps: usize, says: &str) -> Value {
    let says = in_one_line(says);
    json!({ "type": "progress", "body": body, "turn": turn, "step": step + 1, "steps": steps, "text": says })
}

/// What the face of a robot shows from now on.
pub fn expression(body: u32, shown: FacialExpression) -> Value {
    json!({ "type": "expression", "body": body, "expression": shown.name() })
}

/// A turn is over.
pub fn turn_ended(body: u32, turn: u64, status: &str) -> Value {
    json!({ "type": "turn", "body": body, "turn": turn, "ended": true, "status": status })
}

/// How long a turn took so far; of its first changed frame the tick, which a page tells when it has shown it.
pub fn latency(moments: &Moments, frame: Option<u64>) -> Value {
    let [understood, moved, shown] = moments.milliseconds();
    let [heard, sounded] = moments.spoken_milliseconds();
    json!({ "type": "latency", "turn": moments.turn, "frame": frame, "heard_ms": heard, "understood_ms": understood,
            "moved_ms": moved, "shown_ms": shown, "sounded_ms": sounded })
}

/// The page drives a body from now on, or none any more; why, if it did not ask for that.
pub fn driving(body: Option<u32>, text: &str) -> Value {
    json!({ "type": "driving", "body": body, "text": text })
}

/// What a driven body has before it, and what can be done with that; `far` if it is out of reach.
pub fn aim(object: Option<(u32, &str)>, afforded: &[Affordance], far: bool) -> Value {
    let options: Vec<Value> = afforded.iter().map(Affordance::json).collect();
    let (object, name) = object.unzip();
    json!({ "type": "aim", "object": object, "name": name, "options": options, "far": far })
}

/// What came of a deed.
pub fn acted(ok: bool, text: &str) -> Value {
    json!({ "type": "acted", "ok": ok, "text": text })
}

/// What was heard at a page, to be changed there before the robot hears it: its number, and for how long.
pub fn heard(number: u64, text: &str, edit_ms: u128) -> Value {
    json!({ "type": "heard", "number": number, "text": text, "edit_ms": edit_ms as u64 })
}

/// What came of what was being said at a page: `said`, or `nothing`.
pub fn hearing(state: &str) -> Value {
    json!({ "type": "hearing", "state": state, "text": "" })
}

/// What a robot holds back, for a wizard; nothing, if it holds back nothing.
pub fn proposal(body: u32, proposal: Option<&Proposal>) -> Value {
    json!({ "type": "proposal", "body": body, "proposal": proposal })
}

/// What a robot would say of something that a wizard ordered.
pub fn unsaid(body: u32, text: &str) -> Value {
    json!({ "type": "unsaid", "body": body, "text": text })
}

/// What a wizard can have the robot of a body do with a thing that they clicked: what is sent back to have it done, and what a
/// button says.
pub fn menu(body: u32, name: &str, choices: &[(Click, String)]) -> Value {
    let choice = |(click, label): &(Click, String)| json!({ "click": click, "label": label });
    let choices: Vec<Value> = choices.iter().map(choice).collect();
    json!({ "type": "menu", "body": body, "name": name, "choices": choices })
}

/// How a wizard takes part, for their page.
pub fn seat(holding: &Holding) -> Value {
    let wizard = holding.wizard.as_ref();
    json!({
        "type": "seat",
        "delay_ms": holding.delay.as_millis() as u64,
        "timeout_ms": wizard.and_then(|wizard| wizard.timeout).map(|timeout| timeout.as_millis() as u64),
        "on_timeout": wizard.map(|wizard| wizard.on_timeout.name()),
        "phrases": wizard.map(|wizard| wizard.phrases.as_slice()).unwrap_or_default(),
        "errors": wizard.map(|wizard| wizard.errors.as_slice()).unwrap_or_default(),
        "expressions": FacialExpression::ALL.map(FacialExpression::name),
        "longest_saying": LONGEST_SAYING,
    })
}

/// What came of a wizard's decision: what is wrong with it, if anything.
pub fn decided(problem: Option<&str>) -> Value {
    json!({ "type": "decided", "problem": problem })
}

/// A page's microphone is not listened to any more.
pub fn deaf() -> Value {
    json!({ "type": "deaf" })
}

/// There is no seat for a page.
pub fn full(most: usize) -> Value {
    error(&format!("{most} pages are open already; close one and reload."))
}

/// Something is wrong with what a page sent.
pub fn error(text: &str) -> Value {
    json!({ "type": "error", "text": text })
}
