//! One step of an episode, as its line has it.

use std::collections::BTreeMap;

use cohabit_bus::message::{FrameHeader, FrameView, SeenRecord, Thing};
use cohabit_cdf::{Action, ActionKind, BodyId, ObjectId, RoomId, SemanticClass, Status};
use cohabit_render::instance_color;
use cohabit_world::{Outcome, World};
use serde::Serialize;

use crate::{instruction, objects::ObjectEntry, question::QuestionEntry};

/// A line of `steps.jsonl`: the state before a step, the step, and what came of it. The last line has no step.
#[derive(Debug, Serialize)]
pub(crate) struct StepEntry {
    pub step: usize,
    /// The tick at which it begins.
    pub tick: u64,
    pub action: Option<ActionEntry>,
    /// What people would say for it, by style.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub instructions: BTreeMap<&'static str, String>,
    /// What somebody asks who is told to do it, and what an oracle answers.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub questions: Vec<QuestionEntry>,
    pub outcome: Option<OutcomeEntry>,
    pub pose: Option<PoseEntry>,
    /// Whether each goal is met, by its number.
    pub goals: BTreeMap<i64, bool>,
    /// The objects that are not as they were before the step before; all of them in the first line.
    pub objects: Vec<ObjectEntry>,
    /// The instance ids of what has left the world since.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub gone: Vec<String>,
    /// The picture of each modality.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub frames: BTreeMap<&'static str, String>,
    pub camera: Option<CameraEntry>,
    /// What is seen, by its id.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub seen: Vec<SeenEntry>,
}

#[derive(Debug, Serialize)]
pub(crate) struct ActionEntry {
    kind: &'static str,
    object: String,
    class: String,
    /// The id of the object in the pictures: its mask is what has the colour of that id, if it is seen.
    id: u32,
    is_seen: bool,
}

#[derive(Debug, Serialize)]
pub(crate) struct OutcomeEntry {
    status: Status,
    detail: String,
    /// The tick at which it was over.
    tick: u64,
}

/// Where the robot is.
#[derive(Debug, Serialize)]
pub(crate) struct PoseEntry {
    position_m: [f32; 3],
    yaw_rad: f32,
    head_pitch_rad: f32,
    room: RoomId,
    held: Option<String>,
}

/// Where its camera is.
#[derive(Debug, Serialize)]
pub(crate) struct CameraEntry {
    position_m: [f32; 3],
    yaw_rad: f32,
    pitch_rad: f32,
    fov_y_rad: f32,
    width: u32,
    height: u32,
}

/// A thing in the pictures.
#[derive(Debug, Serialize)]
pub(crate) struct SeenEntry {
    pub id: u32,
    /// Its colour in the picture of ids, as red, green, blue.
    color: [u8; 3],
    #[serde(skip_serializing_if = "Option::is_none")]
    instance: Option<String>,
    /// What people call it: no id of a class.
    class: String,
    pixels: u32,
    /// Its first column and row, and those after its last.
    r#box: [u16; 4],
}

impl StepEntry {
    /// Says what the step is; what is seen of its object is so before it.
    pub fn with_action(&mut self, world: &World, action: Action) {
        let Some((kind, object)) = ActionKind::of(&action) else { return };
        let Some(view) = world.object(object) else { return };
        let id = cohabit_engine::object_instance_id(object);
        self.instructions = instruction::in_all_styles(world, kind, object);
        self.action = Some(ActionEntry {
            kind: kind.name(),
            object: view.instance.to_owned(),
            class: world.catalog().class(view.class).id.clone(),
            id,
            is_seen: self.seen.iter().any(|seen| seen.id == id),
        });
    }

    /// Says what came of it.
    pub fn with_outcome(&mut self, outcome: &Outcome, tick: u64) {
        self.outcome = Some(OutcomeEntry { status: outcome.status, detail: outcome.detail.clone(), tick });
    }

    /// Says what a frame shows.
    pub fn with_frame(&mut self, world: &World, frame: &FrameView<'_>) {
        let FrameHeader { position_m, yaw_rad, pitch_rad, fov_y_rad, width, height, .. } = frame.header;
        self.camera = Some(CameraEntry { position_m, yaw_rad, pitch_rad, fov_y_rad, width, height });
        self.seen = frame.seen().iter().map(|record| seen(world, record)).collect();
    }
}

impl PoseEntry {
    /// Where a body is.
    pub fn of(world: &World, body: BodyId) -> Option<Self> {
        let view = world.body(body)?;
        let name = |id: ObjectId| world.object(id).map(|view| view.instance.to_owned());
        Some(Self {
            position_m: view.position_m.to_array(),
            yaw_rad: view.yaw_rad,
            head_pitch_rad: view.head_pitch_rad,
            room: view.room,
            held: view.held.and_then(name),
        })
    }
}

fn seen(world: &World, record: &SeenRecord) -> SeenEntry {
    let instance = match Thing::of_id(record.id) {
        Thing::Object(object) => world.object(object).map(|view| view.instance.to_owned()),
        Thing::Body(_) | Thing::Surface(_) | Thing::Nothing => None,
    };
    SeenEntry {
        id: record.id,
        color: instance_color(record.id),
        instance,
        class: SemanticClass::from_index(record.class).name(world.catalog()).to_owned(),
        pixels: record.pixels,
        r#box: [record.left, record.top, record.right, record.bottom],
    }
}
