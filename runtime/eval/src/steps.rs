//! A recorded session step by step: what was said and how it was understood, what was done and what came of it; and what would have come
//! of another step.
//!
//! A log holds neither what the robot knew nor what else it took an utterance for. Both follow from the log: it is gone through again, with
//! a robot that hears what was heard. Where that robot would plan otherwise than the log tells, its understanding says so
//! ([`Understood::as_recorded`]): a wizard, an interpreter or another version decided then.

mod listed;
mod point;
mod rerun;
mod rest;
mod retold;

use std::collections::BTreeMap;

use cohabit_cdf::{Action, GoToTarget, ObjectId, Status};
use cohabit_dialog::Language;
use cohabit_engine::Replayer;
use cohabit_tables::Played;
use cohabit_world::World;
use serde::Serialize;
use serde_json::Value;

pub use listed::listed;
pub use rerun::{RerunError, rerun};
use retold::Retold;

/// Something that was said, or a command that a body was given.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Step {
    /// Its number, from 1.
    pub step: usize,
    /// The newest tick before it.
    pub tick: u64,
    /// Simulated time of that, s.
    pub time_s: f64,
    /// The turn that it belongs to, if somebody asked for it.
    pub turn: Option<u64>,
    /// The body that was spoken to, or that did it.
    pub body: u32,
    /// What was said, if something was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub said: Option<Said>,
    /// What was done, if something was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub did: Option<Did>,
    /// The goals that were met by it.
    pub goals_met: Vec<Goal>,
    /// The file of each picture of what was seen before it.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub frames: BTreeMap<&'static str, String>,
}

/// Something that was said.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Said {
    /// The number of the page at which it was said; 0 where that was not noted.
    pub person: u32,
    /// What.
    pub text: String,
    /// What it sounded like; nothing where it was typed.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub heard: String,
    /// How it was understood, where that follows from the log.
    pub understood: Option<Understood>,
    /// What the robot said to it.
    pub replies: Vec<String>,
    /// What the robot asked.
    pub questions: Vec<String>,
    /// What it planned.
    pub plan: Vec<Action>,
    /// How the last of its plans ended.
    pub ended: Option<Status>,
}

/// How something was understood.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Understood {
    /// What the robot made of it, in words.
    pub meaning: String,
    /// How likely that is what was meant, from 0 to 1.
    pub sureness: f32,
    /// All ways to take it: that of the grammar, then those of the language model, the likeliest first.
    pub readings: Vec<Reading>,
    /// The things that its first referring expression may mean, the likeliest first.
    pub referents: Vec<Referent>,
    /// Whether the plan that was recorded is what follows from it.
    pub as_recorded: bool,
}

/// A way to take an utterance.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reading {
    /// What was read: what was said, or the plain requests that the language model makes of it.
    pub text: String,
    /// Who reads it so: `grammar` or `rewriter`.
    pub by: &'static str,
    /// What it would mean, in words.
    pub meaning: String,
    /// How likely it is the one that is meant, from 0 to 1.
    pub probability: f32,
}

/// A thing that may be meant.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Referent {
    /// Its number in the session.
    pub object: u32,
    /// What people would call it.
    pub name: String,
    /// How likely it is meant, from 0 to 1.
    pub probability: f32,
}

/// A command.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Did {
    /// Its number.
    pub command: u64,
    /// What to do.
    pub action: Action,
    /// What it acts on, if that is an object, as it was before.
    pub target: Option<Target>,
    /// What came of it; nothing, if it had not ended.
    pub outcome: Option<Outcome>,
}

/// What a command acts on.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Target {
    /// Its number in the session.
    pub object: u32,
    /// Its id in the mission.
    pub instance: String,
    /// The id of its class.
    pub class: String,
    /// The room that it is in.
    pub room: String,
    /// Where, m.
    pub position_m: [f32; 3],
    /// Its mask in what the body saw, if that was drawn.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mask: Option<Mask>,
}

/// Where a picture shows a thing.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq, Serialize)]
pub struct Mask {
    /// Pixels that show it; 0 where it is not in sight.
    pub pixels: u32,
    /// The first column and row that show it, and those after the last.
    pub r#box: [u16; 4],
}

/// What came of a command.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// How it ended.
    pub status: Status,
    /// Whether it did what was asked.
    pub success: bool,
    /// What the world said about it.
    pub detail: String,
    /// When.
    pub tick: u64,
    /// Simulated time from its beginning, s.
    pub duration_s: f64,
}

/// A goal that was met.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Goal {
    /// Its number in the mission.
    pub number: i64,
    /// What people read.
    pub description: String,
    /// When it was met.
    pub tick: u64,
}

/// What takes the place of a step.
#[derive(Clone, Debug, PartialEq)]
pub enum Instead {
    /// Something else is said.
    Said(String),
    /// Another command is given: as steps have it, or as models of Alexa Arena emit it, `{"type": "Pickup", "pickup": …}`.
    Did(Value),
}

/// The steps of a session.
#[derive(Clone, Debug, PartialEq)]
pub struct Told {
    /// In their order.
    pub steps: Vec<Step>,
    /// Why the session could not be gone through to its end, if it could not: what only follows from that is not known from there on.
    pub problem: Option<String>,
}

/// Goes through a session and tells its steps; `look` sees each as it was before it, and may add what is to be seen.
///
/// # Errors
/// Those of `look`.
pub fn steps<E>(
    played: &Played,
    replayer: &mut Replayer<'_>,
    language: &Language,
    look: &mut dyn FnMut(&Replayer<'_>, &mut Step) -> Result<(), E>,
) -> Result<Told, E> {
    let mut steps = listed(played);
    let mut retold = Retold::new(replayer, language).explaining();
    let (dialog, mut next) = (replayer.log().dialog.len(), 0);
    let problem = loop {
        retold.follow(replayer.world(), dialog);
        let tick = replayer.world().tick();
        while let Some(step) = steps.get_mut(next).filter(|step| step.tick <= tick) {
            step.note(replayer.world(), &mut retold);
            look(replayer, step)?;
            next += 1;
        }
        let Some(replayed) = replayer.step() else { break replayer.gap().map(|gap| gap.to_string()) };
        if let Some(difference) = replayed.difference {
            break Some(difference.to_string());
        }
        retold.note(&replayed.inputs);
    };
    Ok(Told { steps, problem })
}

impl Step {
    /// Takes in what follows from going through the session.
    fn note(&mut self, world: &World, retold: &mut Retold<'_>) {
        if let Some(said) = &mut self.said {
            said.understood = self.turn.and_then(|turn| retold.take_understood(turn, self.body));
        }
        if let Some(did) = &mut self.did {
            did.target = object_of(&did.action).and_then(|object| Target::of(world, object));
        }
    }
}

impl Instead {
    /// What somebody writes: an object of JSON is a command, all else is said.
    #[must_use]
    pub fn read(text: &str) -> Self {
        let command = serde_json::from_str(text).ok().filter(Value::is_object);
        command.map_or_else(|| Self::Said(text.to_owned()), Self::Did)
    }

    /// The same in the place of a step: where a command was given, a word such as `Stop` is one.
    pub(crate) fn for_step(&self, step: &Step) -> Self {
        match self {
            Self::Said(text) if step.did.is_some() => {
                let word = Value::String(text.clone());
                let is_command = serde_json::from_value::<Action>(word.clone()).is_ok();
                if is_command { Self::Did(word) } else { self.clone() }
            }
            _ => self.clone(),
        }
    }

    /// The same as it was written.
    pub(crate) fn words(&self) -> String {
        match self {
            Self::Said(text) => text.clone(),
            Self::Did(value) => value.to_string(),
        }
    }
}

impl Target {
    fn of(world: &World, object: ObjectId) -> Option<Self> {
        let view = world.object(object)?;
        Some(Self {
            object: object.0,
            instance: view.instance.to_owned(),
            class: world.catalog().class(view.class).id.clone(),
            room: view.room.id().to_owned(),
            position_m: view.position_m.to_array(),
            mask: None,
        })
    }
}

const fn object_of(action: &Action) -> Option<ObjectId> {
    match *action {
        Action::GoTo { target: GoToTarget::Object(object) }
        | Action::PickUp { object }
        | Action::Place { receptacle: object }
        | Action::Interact { object, .. }
        | Action::Highlight { object } => Some(object),
        _ => None,
    }
}
