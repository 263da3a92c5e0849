//! Plans: from a state and a mission's goals to actions.

use cohabit_cdf::{
    Action, ActionKind, GoToTarget, Mission, ObjectId,
    catalog::table::View as _,
    symbolic::{Place, SymbolicState},
};

use crate::{
    ground::Grounder,
    limits::Limits,
    matter::{self, Matter},
    problem::{Deed, Index},
    relaxed::Relaxed,
    search::{Found, search},
};

/// One step of a plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// What the body does.
    pub action: Action,
    /// How long a machine runs that it sets going, s: the next step comes after that. Zero, if it sets none going.
    pub wait_s: f32,
}

/// What to do, in order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plan {
    /// The steps: a body goes to each thing before it acts on it.
    pub steps: Vec<Step>,
    /// States that the search looked at.
    pub expanded: usize,
}

impl Step {
    /// The same as ticks of that many a second, with some to spare.
    #[must_use]
    pub fn wait_ticks(&self, per_second: f32) -> u32 {
        const SPARE_S: f32 = 0.15;
        if self.wait_s > 0.0 { ((self.wait_s + SPARE_S) * per_second).ceil() as u32 } else { 0 }
    }
}

impl Plan {
    /// How many of its steps are more than a walk.
    #[must_use]
    pub fn deeds(&self) -> usize {
        self.steps.iter().filter(|step| !matches!(step.action, Action::GoTo { .. })).count()
    }
}

/// Why there is no plan.
#[derive(Clone, Debug, thiserror::Error, PartialEq)]
pub enum PlanError {
    /// A goal can never be met.
    #[error("goal {goal} (`{description}`) cannot be reached: {reason}")]
    Unreachable {
        /// Its number in the mission.
        goal: i64,
        /// What people read of it.
        description: String,
        /// Why, in one sentence.
        reason: String,
    },
    /// Each goal seems within reach, but nothing leads to all of them.
    #[error("no plan reaches all goals: {expanded} states were looked at, and there are no others")]
    NoPlan {
        /// How many.
        expanded: usize,
    },
    /// The search gave up.
    #[error("the search for a plan ran out of {of} after {expanded} states; raise its limits")]
    GaveUp {
        /// What there was too little of.
        of: &'static str,
        /// How many states were looked at.
        expanded: usize,
    },
    /// The table predicts that a step of the plan is refused: the planner and the table disagree.
    #[error("step {step} of the plan is refused: {reason}")]
    Refused {
        /// Which, from 1.
        step: usize,
        /// Why.
        reason: String,
    },
}

/// Plans from a state to the goals of a mission; `met` says which of them are met already.
///
/// # Errors
/// [`PlanError`] names the goal that cannot be reached, and why.
pub fn plan(state: &SymbolicState, mission: &Mission, met: &[bool], limits: &Limits) -> Result<Plan, PlanError> {
    plan_without(state, mission, met, limits, &[])
}

/// Plans without some actions, such as those that the world has refused, each a kind and the thing that it is about. Without
/// [`ActionKind::GoTo`] nothing at all is done with a thing.
///
/// # Errors
/// [`PlanError`] names the goal that cannot be reached, and why.
pub fn plan_without(
    state: &SymbolicState,
    mission: &Mission,
    met: &[bool],
    limits: &Limits,
    refused: &[(ActionKind, ObjectId)],
) -> Result<Plan, PlanError> {
    let mut grounder = grounded(state, mission, met);
    let things = &grounder.things;
    grounder.problem.operators.retain(|operator| match operator.deed {
        Deed::Act(kind, thing) => things[usize::from(thing)].id.is_none_or(|id| !is_refused(refused, kind, id)),
        Deed::Nothing => true,
    });
    grounder.problem.keep_relevant(&grounder.tables);
    let relaxed = Relaxed::new(&grounder.problem);
    let (found, effort) = search(&grounder.problem, &relaxed, limits);
    let expanded = effort.expanded;
    match found {
        Found::Plan(operators) => emit(&grounder, &operators, expanded),
        Found::OutOf(of) => Err(PlanError::GaveUp { of, expanded }),
        Found::Exhausted => {
            let costs = relaxed.look(&grounder.problem.initial).fact_costs;
            Err(match grounder.unreachable(&relaxed, &costs) {
                Some((number, reason)) => {
                    let goal = &mission.goals[number];
                    PlanError::Unreachable { goal: goal.id, description: goal.description.clone(), reason }
                }
                None => PlanError::NoPlan { expanded },
            })
        }
    }
}

/// What a body does to do something to a thing: it goes there first, unless it holds it, and waits for the machine that it sets
/// going.
#[must_use]
pub fn steps_to(state: &SymbolicState, kind: ActionKind, id: ObjectId) -> Vec<Step> {
    let walk = Step { action: Action::GoTo { target: GoToTarget::Object(id) }, wait_s: 0.0 };
    if kind == ActionKind::GoTo {
        return vec![walk];
    }
    let mut at_hand = state.clone();
    at_hand.ignore_distance();
    let runs = at_hand.successor(kind, id).is_some_and(|next| next.running.is_some());
    let moment_s = state.catalog.table().device(&state.class(id).id).moment_s;
    let act = Step { action: kind.on(id), wait_s: if runs { moment_s } else { 0.0 } };
    if state.thing(id).place == Place::Held { vec![act] } else { vec![walk, act] }
}

/// The problem of a mission over the things that matter, with all its operators.
pub(crate) fn grounded<'a>(state: &'a SymbolicState, mission: &Mission, met: &[bool]) -> Grounder<'a> {
    let chosen = matter::of_the_world(state, mission);
    let mut things: Vec<Matter> = chosen
        .iter()
        .map(|id| {
            let thing = state.thing(*id);
            let names = std::iter::once(&thing.instance).chain(&thing.aliases).cloned().collect();
            Matter { id: Some(*id), class: thing.class, names }
        })
        .collect();
    things.extend(matter::products(state, &chosen, mission));
    let mut grounder = Grounder::new(state, things);
    grounder.goals(mission, met);
    grounder.ground();
    grounder
}

fn is_refused(refused: &[(ActionKind, ObjectId)], kind: ActionKind, id: ObjectId) -> bool {
    refused.iter().any(|(other, of)| *of == id && (*other == kind || *other == ActionKind::GoTo))
}

/// The steps that operators stand for, checked by the table; what is made on the way gets its id as it is made.
fn emit(grounder: &Grounder<'_>, operators: &[usize], expanded: usize) -> Result<Plan, PlanError> {
    let mut state = grounder.state.clone();
    state.ignore_distance();
    let mut ids: Vec<Option<ObjectId>> = grounder.things.iter().map(|thing| thing.id).collect();
    let mut plan = Plan { steps: Vec::new(), expanded };
    let mut near = None;
    for operator in operators {
        let operator = &grounder.problem.operators[*operator];
        let Deed::Act(kind, thing) = operator.deed else { continue };
        let step = plan.steps.len() + 1;
        let refused = |reason: String| PlanError::Refused { step, reason };
        let id = ids[usize::from(thing)].ok_or_else(|| refused("what it is about was never made".to_owned()))?;
        if state.thing(id).place != Place::Held && near != Some(id) {
            plan.steps.push(Step { action: Action::GoTo { target: GoToTarget::Object(id) }, wait_s: 0.0 });
            near = Some(id);
        }
        if kind == ActionKind::GoTo {
            continue;
        }
        let next = state.successor(kind, id).ok_or_else(|| refused("the table has no rule for it".to_owned()))?;
        if !next.status.is_success() {
            return Err(refused(format!("{:?}: {}", next.status, next.lack)));
        }
        let device = state.catalog.table().device(&state.class(id).id);
        let wait_s = if next.running.is_some() { device.moment_s } else { 0.0 };
        plan.steps.push(Step { action: kind.on(id), wait_s });
        note_made(grounder, &state, &next.state, &mut ids);
        state = next.state;
        state.ignore_distance();
    }
    Ok(plan)
}

/// Gives what was just made the ids that it has.
fn note_made(grounder: &Grounder<'_>, before: &SymbolicState, after: &SymbolicState, ids: &mut [Option<ObjectId>]) {
    for (index, thing) in after.things.iter().enumerate().skip(before.things.len()) {
        let id = ObjectId(u32::try_from(index).expect("invariant: fewer than 2^32 objects"));
        let is_it = |number: &usize| {
            grounder.things[*number].id.is_none()
                && ids[*number].is_none()
                && grounder.things[*number].class == thing.class
        };
        let named = |number: &usize| grounder.things[*number].names.contains(&thing.instance);
        let candidates: Vec<usize> = (0..ids.len()).filter(is_it).collect();
        let made: Option<Index> = candidates
            .iter()
            .find(|number| named(number))
            .or(candidates.first())
            .map(|number| Index::try_from(*number).unwrap_or(0));
        if let Some(made) = made {
            ids[usize::from(made)] = Some(id);
        }
    }
}
