//! A mission played to its goals by the expert: nothing is said, and nothing is hidden from it.

use std::{collections::BTreeMap, sync::Arc, time::Instant};

use cohabit_bus::message::EventMessage;
use cohabit_cdf::{Action, ActionKind, BodyId, Catalog};
use cohabit_planner::{Executor, GivenUp, Limits, Next};
use cohabit_record::{InputEntry, LogError, SessionFacts};
use cohabit_world::{Input, Outcome, World};

use crate::{
    play::{Played, Settings, Trouble},
    task::Task,
    trace::{Trace, input},
};

/// The body that plays.
const BODY: BodyId = BodyId(0);
const TICKS_PER_SECOND: f32 = 60.0;
/// The longest that one action may take: two simulated minutes.
const PATIENCE_TICKS: u64 = 60 * 120;
/// What a search for a plan may take; no time, so that the same seed gives the same report on any machine.
const LIMITS: Limits = Limits::of_states(4_000);

/// Plays a task's mission to its goals from its goals alone: neither its preparation nor its script counts. That it cannot be
/// played is a result too, and so is a goal that cannot be reached.
///
/// # Errors
/// [`LogError`], when its log cannot be written.
pub fn solve(task: &Task, settings: &Settings, catalog: &Arc<Catalog>) -> Result<Played, LogError> {
    let began = Instant::now();
    let mut played = Played { id: task.id.clone(), ..Played::default() };
    let Some((plan, world)) = played.set_up(task, settings, catalog, began) else { return Ok(played) };
    let mut trace = None;
    if let Some(path) = settings.log(&task.id) {
        trace = Some(Trace::create(&path, &facts(&task.id), &plan)?);
        played.log = Some(path);
    }
    let executor = Executor::new(Arc::clone(&plan.mission), LIMITS, TICKS_PER_SECOND);
    let mut solver = Solver { world, trace, executor, commands: 0, played, settings };
    solver.run()?;
    let mut played = solver.judged()?;
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

struct Solver<'a> {
    world: World,
    trace: Option<Trace>,
    executor: Executor,
    commands: u64,
    played: Played,
    settings: &'a Settings,
}

impl Solver<'_> {
    fn run(&mut self) -> Result<(), LogError> {
        // What is met as the mission begins is met before anybody plans.
        self.tick(Vec::new())?;
        while self.played.ended_early.is_none() && self.world.finished().is_none() {
            let met: Vec<bool> = self.world.goals().iter().map(|goal| goal.met).collect();
            match self.executor.next(&self.world.symbols(BODY), &met) {
                Next::Act(action) => self.act(action)?,
                Next::Wait(ticks) => self.wait(ticks)?,
                Next::Over => break,
            }
        }
        Ok(())
    }

    fn act(&mut self, action: Action) -> Result<(), LogError> {
        self.commands += 1;
        let command = self.commands;
        let mut inputs = vec![InputEntry { command, turn: 0, body: BODY.0, action }];
        for _ in 0..PATIENCE_TICKS {
            let outcomes = self.tick(std::mem::take(&mut inputs))?;
            if let Some(outcome) = outcomes.iter().find(|outcome| outcome.command == command) {
                self.take_in(action, outcome);
                // What follows from it is there a tick later.
                return self.tick(Vec::new()).map(drop);
            }
        }
        self.played.ended_early = Some(format!("{} took too long", self.told(action)));
        Ok(())
    }

    fn take_in(&mut self, action: Action, outcome: &Outcome) {
        self.played.count(outcome, self.settings.caps);
        self.executor.outcome(outcome.status, &outcome.detail);
        if outcome.status.is_failure() {
            let (line, why) = (self.told(action), format!("{:?}: {}", outcome.status, outcome.detail));
            self.played.first_trouble.get_or_insert(Trouble { line, why });
        }
    }

    fn wait(&mut self, ticks: u32) -> Result<(), LogError> {
        for _ in 0..ticks {
            self.tick(Vec::new())?;
        }
        Ok(())
    }

    /// One tick; gives what ended in it.
    fn tick(&mut self, entries: Vec<InputEntry>) -> Result<Vec<Outcome>, LogError> {
        let inputs: Vec<Input> = entries.iter().map(input).collect();
        let told = self.world.step(&inputs);
        if let Some(trace) = &mut self.trace {
            trace.step(&self.world, entries, &told.events)?;
            for Outcome { command, body, status, detail } in &told.outcomes {
                let ended = EventMessage::outcome(*command, 0, body.0, *status, detail);
                trace.event(self.world.tick(), &ended)?;
            }
        }
        Ok(told.outcomes)
    }

    fn told(&self, action: Action) -> String {
        let name = |id| self.world.object(id).map_or("?", |view| view.instance);
        ActionKind::of(&action)
            .map_or_else(|| format!("{action:?}"), |(kind, id)| format!("{} {}", kind.name(), name(id)))
    }

    fn judged(mut self) -> Result<Played, LogError> {
        if let Some(trace) = self.trace.take() {
            trace.finish()?;
        }
        self.played.judge(&self.world);
        let given_up: Vec<String> = self.executor.given_up().iter().map(GivenUp::to_string).collect();
        if self.played.ended_early.is_none() && !given_up.is_empty() {
            self.played.ended_early = Some(given_up.join("; "));
        }
        Ok(self.played)
    }
}
