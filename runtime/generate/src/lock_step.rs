//! A world in lock-step: it waits for who acts in it, tick by tick. All that carries out actions without a clock does so here; who
//! wants to know what comes of each tick observes it.

use std::{convert::Infallible, sync::Arc};

use cohabit_planner::{Executor, GivenUp, Limits, Next};
use cohabit_world::{Action, BodyId, Input, Outcome, Report, World};

/// The body that acts: the first.
pub(crate) const BODY: BodyId = BodyId(0);
/// The ticks of a simulated second.
pub(crate) const TICKS_PER_SECOND: f32 = 60.0;
/// The longest that one action may take: two simulated minutes.
const LONGEST_TICKS: u32 = 60 * 120;
/// What an expert's search for a plan may take; no time, so that no machine plays otherwise than another.
const EXPERT_LIMITS: Limits = Limits::of_states(4_000);

/// Who takes note of what happens in a world.
pub trait Observer {
    /// Why no note could be taken; then the world goes no further.
    type Error;

    /// Takes note of a tick: `world` is as it is after it, `inputs` are the commands that were given in it, `report` is what it had
    /// to tell.
    ///
    /// # Errors
    /// That no note could be taken.
    fn note(&mut self, world: &World, inputs: &[Input], report: &Report) -> Result<(), Self::Error>;
}

/// Nobody takes note of anything.
impl Observer for () {
    type Error = Infallible;

    fn note(&mut self, _: &World, _: &[Input], _: &Report) -> Result<(), Infallible> {
        Ok(())
    }
}

/// Has the world go on by a tick; gives the outcomes of the commands that ended in it.
///
/// # Errors
/// Those of the observer.
pub fn tick<O: Observer>(world: &mut World, observer: &mut O, inputs: &[Input]) -> Result<Vec<Outcome>, O::Error> {
    let report = world.step(inputs);
    observer.note(world, inputs, &report)?;
    Ok(report.outcomes)
}

/// Has a command carried out; gives its outcome, or none where it takes longer than two simulated minutes.
///
/// # Errors
/// Those of the observer.
pub fn carry_out<O: Observer>(
    world: &mut World,
    observer: &mut O,
    command: Input,
) -> Result<Option<Outcome>, O::Error> {
    let mut inputs: &[Input] = &[command];
    for _ in 0..LONGEST_TICKS {
        let outcomes = tick(world, observer, inputs)?;
        inputs = &[];
        if let Some(outcome) = outcomes.into_iter().find(|outcome| outcome.command == command.command) {
            return Ok(Some(outcome));
        }
    }
    Ok(None)
}

/// A mission that the expert plays to its goals with the first body: a planner that knows all that is in the world.
pub struct ExpertPlay<O> {
    /// The world, as it is by now.
    pub world: World,
    /// Who takes note of each tick.
    pub observer: O,
    executor: Executor,
    commands: u64,
}

impl<O: Observer> ExpertPlay<O> {
    /// The mission of a world, which was not yet played. What is met as it begins is met before anybody plans.
    ///
    /// # Errors
    /// Those of the observer, here and below.
    pub fn begin(world: World, observer: O) -> Result<Self, O::Error> {
        let executor = Executor::new(Arc::clone(world.mission()), EXPERT_LIMITS, TICKS_PER_SECOND);
        let mut begun = Self { world, observer, executor, commands: 0 };
        begun.wait(1)?;
        Ok(begun)
    }

    /// What is to be done next, once machines that run are waited for; nothing, if the mission is over or nothing more can be done.
    ///
    /// # Errors
    /// Those of the observer.
    pub fn decide(&mut self) -> Result<Option<Action>, O::Error> {
        while self.world.finished().is_none() {
            let met: Vec<bool> = self.world.goals().iter().map(|goal| goal.met).collect();
            match self.executor.next(&self.world.symbols(BODY), &met) {
                Next::Act(action) => return Ok(Some(action)),
                Next::Wait(ticks) => self.wait(ticks)?,
                Next::Over => break,
            }
        }
        Ok(None)
    }

    /// Does what was decided; gives its outcome and the tick of that, or nothing where it takes longer than two simulated minutes.
    ///
    /// # Errors
    /// Those of the observer.
    pub fn act(&mut self, action: Action) -> Result<Option<(Outcome, u64)>, O::Error> {
        self.commands += 1;
        let command = Input { command: self.commands, body: BODY, action };
        let Some(outcome) = carry_out(&mut self.world, &mut self.observer, command)? else { return Ok(None) };
        let ended_at = self.world.tick();
        self.executor.outcome(outcome.status, &outcome.detail);
        // What follows from it is there a tick later.
        self.wait(1)?;
        Ok(Some((outcome, ended_at)))
    }

    /// Why goals were given up, in the order in which they were.
    #[must_use]
    pub fn given_up(&self) -> Vec<String> {
        self.executor.given_up().iter().map(GivenUp::to_string).collect()
    }

    fn wait(&mut self, ticks: u32) -> Result<(), O::Error> {
        (0..ticks).try_for_each(|_| tick(&mut self.world, &mut self.observer, &[]).map(drop))
    }
}
