//! A session that goes on from one of its steps, with something else in that step's place.

use std::{path::Path, sync::Arc};

use cohabit_agent::Deed;
use cohabit_cdf::{Action, BodyId};
use cohabit_dialog::Language;
use cohabit_engine::{ReplayError, Replayer};
use cohabit_record::{InputEntry, Log, LogError, SessionEntry};
use cohabit_tables::Played;
use cohabit_world::{Input, World};
use serde_json::Value;

use super::{Instead, listed, point::Point, rest::Rest, retold::Retold};
use crate::{
    lock_step::{BODY, LockStep},
    trace::Recording,
    trajectory,
};

/// Why a session cannot go on otherwise.
#[derive(Debug, thiserror::Error)]
pub enum RerunError {
    /// The new log cannot be written.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The session cannot be gone through.
    #[error(transparent)]
    Replay(#[from] ReplayError),
    /// It does not come out as it was recorded up to there.
    #[error("the session cannot be gone through up to step {step}: {reason}")]
    Otherwise {
        /// The step.
        step: usize,
        /// Why.
        reason: String,
    },
    /// Nothing can take the place of that step, or this cannot.
    #[error("step {step}: {reason}")]
    Refused {
        /// The step.
        step: usize,
        /// Why.
        reason: String,
    },
}

/// Goes through a session up to a step, with something else in that step's place, and on from there: the robot's own mind does what it
/// would do then, and people say what they said afterwards. All of it is in a new log.
///
/// What was said while the robot was at something is said at its time; all else once the robot is at rest, but no sooner than it was. Other
/// bodies, and a robot that does not follow what people say, are given the commands that they were given.
///
/// # Errors
/// [`RerunError`].
pub fn rerun(
    played: &Played,
    language: &Language,
    step: usize,
    instead: &Instead,
    out: &Path,
) -> Result<(), RerunError> {
    let (log, steps) = (played.log(), listed(played));
    let wrong = |reason: String| RerunError::Refused { step, reason };
    let changed = step.checked_sub(1).and_then(|at| steps.get(at));
    let changed = changed.ok_or_else(|| wrong(format!("there is none; the session has {}", steps.len())))?;
    let instead = &instead.for_step(changed);
    let point = Point::of(log, changed, instead).map_err(wrong)?;
    let mut replayer = Replayer::new(log, Arc::clone(language.catalog()))?;
    let mut retold = Retold::new(&replayer, language);
    go_to(&point, &mut replayer, &mut retold).map_err(|reason| RerunError::Otherwise { step, reason })?;
    let begun = begun(&point, instead, replayer.world(), &retold).map_err(wrong)?;
    let recording = Recording::after(out, &session_entry(log, step, instead, out), log, point.tick, point.dialog)?;
    let rest = Rest::after(log, &point, &retold);
    let (world, _) = replayer.into_parts();
    let Retold { conversation, knowledge, agent, mut deeds, newest, .. } = retold;
    let session = LockStep::new(world, conversation, knowledge);
    let mut session = session.going_on(agent, newest, highest_command(log), recording);
    // What was decided by then is done, but for the command that another one takes the place of.
    if point.input.as_ref().is_some_and(|input| input.body == BODY.0 && input.turn != 0) {
        deeds.retain(|deed| !matches!(deed, Deed::Act { .. }));
    }
    session.carry_out(deeds)?;
    match begun {
        Begun::Said { text, plain } => {
            session.say_called(&text, &plain)?;
        }
        Begun::Did(input, turn) => session.give(input, turn),
    }
    rest.play(&mut session)?;
    session.finish()?;
    Ok(())
}

/// What happens in a step's place.
enum Begun {
    /// Something is said; of it what is said to the robot, all but its name.
    Said { text: String, plain: String },
    /// A command is given, which belongs to a turn.
    Did(Input, u64),
}

fn begun(point: &Point, instead: &Instead, world: &World, robot: &Retold<'_>) -> Result<Begun, String> {
    match (instead, &point.input) {
        (Instead::Did(value), Some(InputEntry { command, turn, body, .. })) => {
            let input = Input { command: *command, body: BodyId(*body), action: action(value, world)? };
            Ok(Begun::Did(input, *turn))
        }
        _ if !robot.follows => {
            Err("the robot's mind did not do what people say: whatever they say, it would do the same".to_owned())
        }
        _ => {
            let text = instead.words();
            let plain = robot.without_name(&text);
            Ok(Begun::Said { text, plain })
        }
    }
}

/// Goes through the session up to there; or why that cannot be.
fn go_to(point: &Point, replayer: &mut Replayer<'_>, retold: &mut Retold<'_>) -> Result<(), String> {
    loop {
        retold.follow(replayer.world(), point.dialog);
        if replayer.world().tick() >= point.tick {
            return Ok(());
        }
        let Some(replayed) = replayer.step() else {
            return Err(replayer.gap().map_or_else(|| "it ends before".to_owned(), |gap| gap.to_string()));
        };
        if let Some(difference) = replayed.difference {
            return Err(difference.to_string());
        }
        retold.note(&replayed.inputs);
    }
}

/// A command as steps have it, or as models of Alexa Arena emit it.
fn action(value: &Value, world: &World) -> Result<Action, String> {
    match serde_json::from_value(value.clone()) {
        Ok(action) => Ok(action),
        Err(error) if value["type"].is_null() => Err(format!("{value} is no action: {error}")),
        Err(_) => trajectory::action(value, world)?.ok_or_else(|| format!("{value} is nothing that a body does")),
    }
}

/// The highest number that a command of the session has.
fn highest_command(log: &Log) -> u64 {
    log.ticks.iter().flat_map(|entry| &entry.inputs).map(|input| input.command).max().unwrap_or(0)
}

/// What the new log says that it is of.
fn session_entry(log: &Log, step: usize, instead: &Instead, out: &Path) -> SessionEntry {
    let session = out.file_stem().unwrap_or(out.as_os_str()).to_string_lossy().into_owned();
    let mut entry = SessionEntry { session, run: 0, frames: Vec::new(), audio: false, ..log.session.clone() };
    let changed = [
        ("changed_from", log.session.session.clone()),
        ("changed_step", step.to_string()),
        ("changed_to", instead.words()),
    ];
    entry.settings.extend(changed.map(|(name, value)| (name.to_owned(), value)));
    entry
}
