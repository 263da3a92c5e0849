//! A mission played to its goals by the expert: nothing is said, and nothing is hidden from it.

use std::{collections::BTreeMap, sync::Arc, time::Instant};

use cohabit_cdf::{Action, ActionKind, Catalog};
use cohabit_generate::ExpertPlay;
use cohabit_record::{LogError, SessionFacts};
use cohabit_world::World;

use crate::{
    play::{Played, Settings, Trouble},
    task::Task,
    trace::Recording,
};

/// Plays a task's mission to its goals from its goals alone: neither its preparation nor its script counts. That it cannot be
/// played is a result too, and so is a goal that cannot be reached.
///
/// # Errors
/// [`LogError`], when its log cannot be written.
pub fn solve(task: &Task, settings: &Settings, catalog: &Arc<Catalog>) -> Result<Played, LogError> {
    let began = Instant::now();
    let mut played = Played { id: task.id.clone(), ..Played::default() };
    let Some((plan, world)) = played.set_up(task, settings, catalog, began) else { return Ok(played) };
    let mut recording = Recording::default();
    if let Some(path) = settings.log(&task.id) {
        recording.begin(&path, &facts(&task.id), &plan)?;
        played.log = Some(path);
    }
    let mut expert = ExpertPlay::begin(world, recording)?;
    while played.ended_early.is_none()
        && let Some(action) = expert.decide()?
    {
        let line = told(action, &expert.world);
        let Some((outcome, _)) = expert.act(action)? else {
            played.ended_early = Some(format!("{line} took too long"));
            break;
        };
        played.count(&outcome, settings.caps);
        if outcome.status.is_failure() {
            let why = format!("{:?}: {}", outcome.status, outcome.detail);
            played.first_trouble.get_or_insert(Trouble { line, why });
        }
    }
    expert.observer.finish()?;
    played.judge(&expert.world);
    let given_up = expert.given_up();
    if played.ended_early.is_none() && !given_up.is_empty() {
        played.ended_early = Some(given_up.join("; "));
    }
    played.wall_s = began.elapsed().as_secs_f64();
    Ok(played)
}

/// What a log notes of who played.
fn facts(id: &str) -> SessionFacts {
    let noted = [("agents", "expert@0"), ("knows", "everything")];
    let settings: BTreeMap<String, String> =
        noted.into_iter().map(|(name, value)| (name.to_owned(), value.to_owned())).collect();
    SessionFacts { settings, ..SessionFacts::named(id) }
}

fn told(action: Action, world: &World) -> String {
    let name = |id| world.object(id).map_or("?", |view| view.instance);
    ActionKind::of(&action).map_or_else(|| format!("{action:?}"), |(kind, id)| format!("{} {}", kind.name(), name(id)))
}
