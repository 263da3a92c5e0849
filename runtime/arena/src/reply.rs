//! What a batch is answered with.

use std::collections::BTreeMap;

use cohabit_cdf::{BodyId, Status};
use cohabit_world::World;
use serde::Serialize;
use serde_json::{Map, Value};

use crate::{
    axes::Place,
    object::{self, ObjectRecord},
    pictures::Pictures,
};

/// What came of a command: its status and a sentence.
pub type End = (Status, String);

/// The answer to a batch. Every field is always there; without a game the lists are empty.
#[derive(Debug, Default, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Reply {
    last_action_success: &'static str,
    last_action: LastAction,
    /// Beyond what clients of the reference know: what came of the last command, or what is wrong, for people.
    message: String,
    color_image: Vec<String>,
    depth_image: Vec<String>,
    normals_image: Vec<String>,
    instance_segmentation_image: Vec<String>,
    objects: Vec<ObjectRecord>,
    agent: AgentRecord,
    scene_metadata: SceneRecord,
    challenge_progress: ProgressRecord,
}

/// The command that the status is of, as a text of JSON: the command as it was sent, with `commandNum`, its place in the
/// batch from 0, and `commandType`. Where no command was carried out, they are -1 and empty.
#[derive(Debug, Serialize)]
#[serde(transparent)]
pub struct LastAction(String);

impl LastAction {
    /// The command at `index` of a batch.
    pub fn of(index: usize, command: &Value) -> Self {
        Self::with(Value::from(index), command.as_object().cloned().unwrap_or_default())
    }

    fn with(index: Value, mut fields: Map<String, Value>) -> Self {
        let kind = fields.get("commandType").and_then(Value::as_str).unwrap_or_default().to_owned();
        fields.insert("commandNum".to_owned(), index);
        fields.insert("commandType".to_owned(), kind.into());
        Self(Value::Object(fields).to_string())
    }
}

impl Default for LastAction {
    fn default() -> Self {
        Self::with(Value::from(-1), Map::new())
    }
}

#[derive(Debug, Default, Serialize)]
#[serde(rename_all = "camelCase")]
struct AgentRecord {
    /// Empty where the hand is.
    right_hand_held_object: String,
}

#[derive(Debug, Default, Serialize)]
#[serde(rename_all = "PascalCase")]
struct SceneRecord {
    go_to_points: BTreeMap<String, Place>,
}

#[derive(Debug, Default, Serialize)]
#[serde(rename_all = "PascalCase")]
struct ProgressRecord {
    challenge_goals: Vec<GoalRecord>,
}

#[derive(Debug, Serialize)]
struct GoalRecord {
    goal_id: i64,
    description: String,
    #[serde(rename = "isFinished")]
    is_finished: bool,
    /// Whether people do not see it yet.
    #[serde(rename = "isHidden")]
    is_hidden: bool,
}

impl Reply {
    /// One without a world.
    pub fn without_game(status: Status, message: impl Into<String>) -> Self {
        Self { last_action_success: name(status), message: message.into(), ..Self::default() }
    }

    /// What came of a batch, and the world after it as `body` sees it.
    pub fn new(end: End, last_action: LastAction, world: &World, body: BodyId, pictures: Pictures) -> Self {
        let (status, message) = end;
        let Pictures { color, depth, normals, instances } = pictures;
        let held = world.body(body).and_then(|body| body.held).and_then(|held| world.object(held));
        Self {
            last_action_success: name(status),
            last_action,
            message,
            color_image: color,
            depth_image: depth,
            normals_image: normals,
            instance_segmentation_image: instances,
            objects: object::records(world),
            agent: AgentRecord {
                right_hand_held_object: held.map_or_else(String::new, |held| held.instance.to_owned()),
            },
            scene_metadata: SceneRecord { go_to_points: go_to_points(world) },
            challenge_progress: ProgressRecord { challenge_goals: goals(world) },
        }
    }

    /// As it is sent.
    pub fn json(&self) -> Vec<u8> {
        serde_json::to_vec(self).expect("invariant: a reply is texts, lists and finite numbers")
    }
}

/// What clients call a status.
const fn name(status: Status) -> &'static str {
    match status {
        Status::ActionSuccessful => "ActionSuccessful",
        Status::UnsupportedAction => "UnsupportedAction",
        Status::UnsupportedNavigation => "UnsupportedNavigation",
        Status::AlreadyHoldingObject => "AlreadyHoldingObject",
        Status::ReceptacleIsFull => "ReceptacleIsFull",
        Status::ReceptacleIsClosed => "ReceptacleIsClosed",
        Status::TargetInaccessible => "TargetInaccessible",
        Status::KilledByHazard => "KilledByHazard",
        Status::TargetOutOfRange => "TargetOutOfRange",
        Status::AlternateNavigationUsed => "AlternateNavigationUsed",
        Status::ObjectUnpowered => "ObjectUnpowered",
        Status::ObjectOverloaded => "ObjectOverloaded",
        Status::InvalidCommand => "InvalidCommand",
        Status::ObjectNotPickedUp => "ObjectNotPickedUp",
        Status::ArenaUnavailable => "ArenaUnavailable",
        Status::IncorrectActionFormat => "IncorrectActionFormat",
        Status::InvalidObjectClass => "InvalidObjectClass",
        // Clients know of nobody who could interrupt them.
        Status::ActionExecutionError | Status::Interrupted => "ActionExecutionError",
        Status::PostProcessError => "PostProcessError",
    }
}

fn go_to_points(world: &World) -> BTreeMap<String, Place> {
    let viewpoints = &world.layout().viewpoints;
    let place = |[x, z]: [f32; 2]| Place { x, y: 0.0, z };
    viewpoints.iter().map(|point| (format!("{}_{}", point.room.id(), point.number), place(point.at_m))).collect()
}

fn goals(world: &World) -> Vec<GoalRecord> {
    let record = |goal: cohabit_world::GoalStatus| GoalRecord {
        goal_id: goal.id,
        description: goal.description,
        is_finished: goal.met,
        is_hidden: goal.hidden,
    };
    world.goals().into_iter().map(record).collect()
}
