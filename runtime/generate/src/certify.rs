//! Certificates: a mission read as any other, solved by the planner, its plan carried out in a world.

use std::sync::Arc;

use cohabit_cdf::{ActionKind, Catalog, GoToTarget, Layout, RoomId, mission::read_mission};
use cohabit_planner::{Limits, Plan, Step, plan};
use cohabit_world::{Action, Input, World};
use serde::Serialize;

use crate::lock_step::{self, BODY, TICKS_PER_SECOND};

/// No limit of time: what is made must not depend on the machine.
const LIMITS: Limits = Limits::of_states(400);

/// One step of a plan, by name.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlannedStep {
    /// What is done.
    pub action: &'static str,
    /// To which instance.
    pub object: String,
    /// How people say it.
    #[serde(skip)]
    pub said: String,
}

/// That a mission can be solved, and how.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Certificate {
    /// The seed of what the mission leaves to chance.
    pub seed: u64,
    /// The digest of the world at the tick at which all goals were met, in hexadecimal.
    pub digest: String,
    /// That tick.
    pub ticks: u64,
    /// The score at it.
    pub score: u32,
    /// The plan.
    #[serde(skip)]
    pub plan: Vec<PlannedStep>,
    /// The rooms that the plan leads to.
    #[serde(skip)]
    pub rooms: Vec<RoomId>,
    /// States that the planner looked at.
    #[serde(skip)]
    pub expanded: usize,
    /// Goals that are met as the mission begins.
    #[serde(skip)]
    pub met_at_first: usize,
}

/// The world of a mission before its first tick.
///
/// # Errors
/// Why it cannot be read or laid out, in words.
pub fn world_of(id: &str, cdf: &str, catalog: &Arc<Catalog>, seed: u64) -> Result<World, String> {
    let checked = read_mission(id, cdf, catalog).map_err(|problems| problems.to_string())?;
    let layout = Layout::find(&checked.mission.layout, catalog).map_err(|error| error.to_string())?;
    let world = World::new(Arc::clone(catalog), Arc::new(layout), Arc::new(checked.mission), seed);
    world.map_err(|error| error.to_string())
}

/// Reads, solves and plays a mission.
///
/// # Errors
/// Why it cannot be read, laid out, solved or played, in words.
pub fn certify(id: &str, cdf: &str, catalog: &Arc<Catalog>, seed: u64) -> Result<Certificate, String> {
    let mut world = world_of(id, cdf, catalog, seed)?;
    // What is met as the mission begins is met before anybody plans.
    world.step(&[]);
    let met: Vec<bool> = world.goals().iter().map(|goal| goal.met).collect();
    let planned = plan(&world.symbols(BODY), world.mission(), &met, &LIMITS);
    let planned = planned.map_err(|error| error.to_string())?;
    let (steps, rooms) = carry_out(&mut world, &planned)?;
    if world.finished().is_none() {
        let open = world.goals().iter().filter(|goal| !goal.met).count();
        return Err(format!("{open} goals are open after the plan"));
    }
    let digest = world.digest().iter().map(|byte| format!("{byte:02x}")).collect();
    let (ticks, score) = (world.tick(), world.score());
    let met_at_first = met.iter().filter(|met| **met).count();
    Ok(Certificate { seed, digest, ticks, score, plan: steps, rooms, expanded: planned.expanded, met_at_first })
}

fn carry_out(world: &mut World, plan: &Plan) -> Result<(Vec<PlannedStep>, Vec<RoomId>), String> {
    let mut steps = Vec::new();
    let mut rooms = std::collections::BTreeSet::new();
    for step in &plan.steps {
        steps.extend(named(world, step.action));
        run(world, step.action)?;
        rooms.extend(world.body(BODY).map(|body| body.room));
        wait(world, step);
    }
    Ok((steps, rooms.into_iter().collect()))
}

/// Has the body do something; why it could not, in words.
pub(crate) fn run(world: &mut World, action: Action) -> Result<(), String> {
    let command = Input { command: world.tick() + 1, body: BODY, action };
    let Ok(outcome) = lock_step::carry_out(world, &mut (), command);
    match outcome {
        Some(outcome) if outcome.status.is_success() => Ok(()),
        Some(outcome) => Err(outcome.detail),
        None => Err(format!("{action:?} never came to an end")),
    }
}

/// Lets the world go on after a step, for as long as the machine runs that it set going.
pub(crate) fn wait(world: &mut World, step: &Step) {
    for _ in 0..step.wait_ticks(TICKS_PER_SECOND).max(1) {
        if world.finished().is_none() {
            world.step(&[]);
        }
    }
}

fn named(world: &World, action: Action) -> Option<PlannedStep> {
    let (kind, id) = ActionKind::of(&action)?;
    let view = world.object(id)?;
    let said = crate::instructions::instruction(world, kind, id);
    debug_assert!(!matches!(action, Action::GoTo { target: GoToTarget::Room(_) }));
    Some(PlannedStep { action: kind.name(), object: view.instance.to_owned(), said })
}
