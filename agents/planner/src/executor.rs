//! Carries plans out one step at a time, and plans anew where the world is not what the plan expects.
//!
//! It is pure, as the planner is: whoever owns a body hands over the state as it is, does what comes back, and says what came of
//! it.

use std::{collections::VecDeque, fmt, sync::Arc};

use cohabit_cdf::{
    Action, ActionKind, Mission, ObjectId, StateFlag, Status,
    symbolic::{Place, SymbolicState, Thing},
};

use crate::{
    limits::Limits,
    plan::{PlanError, Step, plan_without},
};

/// Plans that are made without a goal being met in between, before the rest is given up.
const MOST_PLANS: u32 = 40;
/// Failures of the same action on the same thing, after which plans do without it.
const MOST_TRIES: usize = 2;
/// How long a body waits for goals that hold by the table to be met in the world, ticks.
const GRACE_TICKS: u32 = 30;

/// What is to be done next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Next {
    /// The body does this; [`Executor::outcome`] hears what came of it.
    Act(Action),
    /// The body waits for so many ticks, for a machine that runs.
    Wait(u32),
    /// Nothing: all goals are met, but for those that were given up.
    Over,
}

/// A goal that nothing leads to.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct GivenUp {
    /// Its number in the mission; none, if no single goal is to blame: all that were open are given up.
    pub goal: Option<i64>,
    /// Why, in words that name the goal.
    pub reason: String,
}

impl fmt::Display for GivenUp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.reason)
    }
}

/// An action that the world refused.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Failure {
    /// The kind of action.
    pub action: ActionKind,
    /// What it was about.
    pub object: ObjectId,
    /// The instance id of that.
    pub instance: String,
    /// How it failed.
    pub status: Status,
    /// The world's sentence about it.
    pub detail: String,
}

/// Plays a mission to its goals with one body.
#[derive(Debug)]
pub struct Executor {
    mission: Arc<Mission>,
    limits: Limits,
    ticks_per_second: f32,
    steps: VecDeque<Step>,
    /// The step under way, with the instance id of what it is about.
    doing: Option<(Step, String)>,
    pause: Option<u32>,
    /// The state that the latest step leads to, by the table.
    expected: Option<SymbolicState>,
    failures: Vec<Failure>,
    given_up: Vec<GivenUp>,
    met: usize,
    /// Plans since a goal was met.
    in_vain: u32,
    plans: u32,
}

impl Executor {
    /// An executor for a mission in a world that has so many ticks a second.
    #[must_use]
    pub fn new(mission: Arc<Mission>, limits: Limits, ticks_per_second: f32) -> Self {
        Self {
            mission,
            limits,
            ticks_per_second,
            steps: VecDeque::new(),
            doing: None,
            pause: None,
            expected: None,
            failures: Vec::new(),
            given_up: Vec::new(),
            met: 0,
            in_vain: 0,
            plans: 0,
        }
    }

    /// The goals that were given up, in the order in which they were.
    #[must_use]
    pub fn given_up(&self) -> &[GivenUp] {
        &self.given_up
    }

    /// The actions that failed.
    #[must_use]
    pub fn failures(&self) -> &[Failure] {
        &self.failures
    }

    /// How many plans were made.
    #[must_use]
    pub const fn plans(&self) -> u32 {
        self.plans
    }

    /// What to do in this state; `met` says which goals are met, in the order of the mission.
    pub fn next(&mut self, state: &SymbolicState, met: &[bool]) -> Next {
        if let Some(ticks) = self.pause.take() {
            return Next::Wait(ticks);
        }
        let now_met = met.iter().filter(|met| **met).count();
        if std::mem::replace(&mut self.met, now_met) != now_met {
            self.in_vain = 0;
        }
        if self.is_over(met) {
            return Next::Over;
        }
        if !state.alive {
            self.give_all_up("the body was destroyed");
            return Next::Over;
        }
        if !self.is_as_expected(state) {
            self.steps.clear();
        }
        self.act(state, met)
    }

    /// Hears what came of the latest action.
    pub fn outcome(&mut self, status: Status, detail: &str) {
        let Some((step, instance)) = self.doing.take() else { return };
        if status.is_success() {
            let ticks = step.wait_ticks(self.ticks_per_second);
            self.pause = (ticks > 0).then_some(ticks);
            return;
        }
        self.drop_plan();
        if let Some((action, object)) = ActionKind::of(&step.action).filter(|_| status.is_failure()) {
            self.failures.push(Failure { action, object, instance, status, detail: detail.to_owned() });
        }
    }

    /// Others had the body: it may be anywhere, and so may be what it held.
    pub fn forget(&mut self) {
        self.drop_plan();
        self.doing = None;
        self.pause = None;
    }

    fn drop_plan(&mut self) {
        self.steps.clear();
        self.expected = None;
    }

    /// The next step, of a new plan if there is none left or the table refuses it.
    fn act(&mut self, state: &SymbolicState, met: &[bool]) -> Next {
        for _ in 0..2 {
            if self.steps.is_empty() {
                self.plan(state, met);
            }
            let Some(step) = self.steps.pop_front() else {
                return self.pause.take().map_or(Next::Over, Next::Wait);
            };
            if let Some((instance, expected)) = expected(state, step.action) {
                self.expected = Some(expected);
                self.doing = Some((step, instance));
                return Next::Act(step.action);
            }
            self.drop_plan();
        }
        self.give_all_up("the table of actions refuses the first step of the plan that it led to");
        Next::Over
    }

    /// Makes a plan for the goals that are open; gives up those that cannot be reached.
    fn plan(&mut self, state: &SymbolicState, met: &[bool]) {
        while !self.is_over(met) {
            if self.in_vain >= MOST_PLANS {
                return self.give_all_up(&format!("{MOST_PLANS} plans were made, and none met a goal"));
            }
            self.in_vain += 1;
            self.plans += 1;
            let (mission, met_of_it) = self.within_reach(met);
            match plan_without(state, &mission, &met_of_it, &self.limits, &self.refused()) {
                Ok(plan) if plan.steps.is_empty() => {
                    self.pause = Some(GRACE_TICKS);
                    return;
                }
                Ok(plan) => {
                    self.steps = plan.steps.into();
                    return;
                }
                Err(PlanError::Unreachable { goal, description, reason }) => {
                    let error = PlanError::Unreachable { goal, description, reason };
                    self.give_up(goal, &self.with_failures(&error.to_string()), met);
                }
                Err(error) => return self.give_all_up(&error.to_string()),
            }
        }
    }

    fn is_given_up(&self, goal: i64) -> bool {
        self.given_up.iter().any(|one| one.goal.is_none_or(|id| id == goal))
    }

    fn is_over(&self, met: &[bool]) -> bool {
        let is_met = |number: usize| met.get(number).copied().unwrap_or(false);
        self.mission.goals.iter().enumerate().all(|(number, goal)| is_met(number) || self.is_given_up(goal.id))
    }

    /// The mission without the goals that were given up, and which of the others are met.
    fn within_reach(&self, met: &[bool]) -> (Mission, Vec<bool>) {
        let mut mission = Mission::clone(&self.mission);
        mission.goals.retain(|goal| !self.is_given_up(goal.id));
        let of_others = self.mission.goals.iter().zip(met).filter(|(goal, _)| !self.is_given_up(goal.id));
        (mission, of_others.map(|(_, met)| *met).collect())
    }

    /// Gives a goal up, and those that come after it.
    fn give_up(&mut self, goal: i64, reason: &str, met: &[bool]) {
        self.given_up.push(GivenUp { goal: Some(goal), reason: reason.to_owned() });
        let mission = Arc::clone(&self.mission);
        for (number, other) in mission.goals.iter().enumerate() {
            let is_met = met.get(number).copied().unwrap_or(false);
            if !is_met && other.preconditions.contains(&goal) && !self.is_given_up(other.id) {
                let (id, words) = (other.id, &other.description);
                let reason = format!("goal {id} (`{words}`) cannot be reached: it counts only after goal {goal}");
                self.give_up(id, &reason, met);
            }
        }
    }

    fn give_all_up(&mut self, reason: &str) {
        let reason = self.with_failures(&format!("the open goals cannot be reached: {reason}"));
        self.drop_plan();
        self.given_up.push(GivenUp { goal: None, reason });
    }

    /// A reason, and what was tried in vain before it.
    fn with_failures(&self, reason: &str) -> String {
        let refused = self.refused();
        let is_refused = |one: &&Failure| refused.contains(&(one.action, one.object));
        let mut tried: Vec<String> = Vec::new();
        for Failure { action, instance, status, detail, .. } in self.failures.iter().filter(is_refused) {
            let words = format!("{} {instance}: {status:?}: {detail}", action.name());
            if !tried.contains(&words) {
                tried.push(words);
            }
        }
        if tried.is_empty() { reason.to_owned() } else { format!("{reason} (tried: {})", tried.join("; ")) }
    }

    /// What plans do without.
    fn refused(&self) -> Vec<(ActionKind, ObjectId)> {
        let all: Vec<_> = self.failures.iter().map(|one| (one.action, one.object)).collect();
        let is_hopeless = |one: &(ActionKind, ObjectId)| all.iter().filter(|other| *other == one).count() >= MOST_TRIES;
        let mut refused: Vec<_> = all.iter().copied().filter(is_hopeless).collect();
        refused.sort_unstable();
        refused.dedup();
        refused
    }

    /// Whether all that the rest of the plan is about is as the table said it would be.
    fn is_as_expected(&self, found: &SymbolicState) -> bool {
        let Some(expected) = &self.expected else { return true };
        let ids = self.steps.iter().filter_map(|step| ActionKind::of(&step.action)).map(|(_, id)| id);
        let mut known = ids.chain(expected.held).filter(|id| (id.0 as usize) < expected.things.len());
        let is_same = |id: ObjectId| {
            found.things.get(id.0 as usize).is_some_and(|thing| looks(expected.thing(id)) == looks(thing))
        };
        expected.held == found.held && known.all(is_same)
    }
}

/// The instance id of what an action is about, and the state that it leads to; none where the table refuses it.
fn expected(state: &SymbolicState, action: Action) -> Option<(String, SymbolicState)> {
    let (kind, id) = ActionKind::of(&action)?;
    let instance = state.things.get(id.0 as usize).filter(|thing| thing.place != Place::Gone)?.instance.clone();
    let mut at_hand = state.clone();
    at_hand.ignore_distance();
    if kind == ActionKind::GoTo {
        return Some((instance, at_hand));
    }
    let next = at_hand.successor(kind, id)?;
    next.status.is_success().then_some((instance, next.state))
}

/// What of a thing matters to a plan: where it is, and its states.
fn looks(thing: &Thing) -> (u8, Option<ObjectId>, Vec<StateFlag>, u8, u8) {
    let (kind, parent) = match &thing.place {
        Place::Own | Place::Loose => (0, None),
        Place::On { parent, within, .. } => (1 + u8::from(*within), Some(*parent)),
        Place::Held => (3, None),
        Place::InAnotherHand => (4, None),
        Place::Gone => (5, None),
    };
    let flags = thing.flags.iter().filter(|flag| !flag.is_mood()).collect();
    (kind, parent, flags, thing.fluid as u8, thing.color as u8)
}
