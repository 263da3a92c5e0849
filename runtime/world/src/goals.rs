//! Goals: whether what a mission asks for holds now, and whether it was met before.

use cohabit_cdf::{
    Expression, Goal, GoalState, InstancePattern, Mission, ObjectId, Predicate, Property, Relation, StateFlag,
};
use serde::{Deserialize, Serialize};

use crate::{anchors::is_full, body::Body, facts::Facts, state::State};

/// How wide a camera sees to each side: the cosine of 45 degrees.
const SIGHT_COS: f32 = 0.707;

/// How far a mission's goal has come.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, PartialEq, Serialize)]
pub(crate) struct GoalProgress {
    pub met: bool,
    /// Whether a hidden goal was unlocked.
    pub shown: bool,
}

/// What everybody outside may know of a goal.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct GoalStatus {
    /// Its number in the mission.
    pub id: i64,
    /// What people read.
    pub description: String,
    /// Whether it is met.
    pub met: bool,
    /// Whether people do not see it yet.
    pub hidden: bool,
}

/// A change of one goal, by its index.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum GoalChange {
    Met(usize),
    Reset(usize),
    Shown(usize),
}

/// Judges all goals in order; returns what changed.
pub(crate) fn judge(facts: &Facts<'_>, mission: &Mission) -> Vec<GoalChange> {
    let judge = Judge { facts, mission };
    let mut progress = facts.state.goals.clone();
    let mut changes = Vec::new();
    for (index, goal) in mission.goals.iter().enumerate() {
        if goal.hidden && !progress[index].shown && judge.is_unlocked(goal) {
            progress[index].shown = true;
            changes.push(GoalChange::Shown(index));
        }
        if progress[index].met && !goal.can_reset {
            continue;
        }
        let ready = goal
            .preconditions
            .iter()
            .all(|id| mission.goals.iter().position(|goal| goal.id == *id).is_none_or(|before| progress[before].met));
        let holds = ready && judge.holds(goal);
        if holds != progress[index].met {
            progress[index].met = holds;
            changes.push(if holds { GoalChange::Met(index) } else { GoalChange::Reset(index) });
        }
    }
    changes
}

/// The goals as everybody outside may know them.
pub(crate) fn statuses(mission: &Mission, state: &State) -> Vec<GoalStatus> {
    let goals = mission.goals.iter().zip(&state.goals);
    goals
        .map(|(goal, progress)| GoalStatus {
            id: goal.id,
            description: goal.description.clone(),
            met: progress.met,
            hidden: goal.hidden && !progress.shown && !progress.met,
        })
        .collect()
}

/// Whether an object is one that `pattern` means.
pub(crate) fn is_meant(facts: &Facts<'_>, pattern: &InstancePattern, id: ObjectId) -> bool {
    let object = facts.object(id);
    let by_name = pattern.matches(&object.instance) || object.aliases.iter().any(|alias| pattern.matches(alias));
    // `Carrot_01_*` is any carrot, also one that a machine made and named after itself.
    by_name || pattern.0.strip_suffix('*').is_some_and(|prefix| prefix.trim_end_matches('_') == facts.class(id).id)
}

/// Facts and the mission whose conditions goals name.
struct Judge<'a> {
    facts: &'a Facts<'a>,
    mission: &'a Mission,
}

impl Judge<'_> {
    fn meant<'b>(&'b self, pattern: &'b InstancePattern) -> impl Iterator<Item = ObjectId> + 'b {
        self.facts.state.existing().map(|(id, _)| id).filter(move |id| is_meant(self.facts, pattern, *id))
    }

    fn any(&self, pattern: &InstancePattern, holds: impl Fn(ObjectId) -> bool) -> bool {
        self.meant(pattern).any(holds)
    }

    fn is_unlocked(&self, goal: &Goal) -> bool {
        goal.unlocked_by.as_ref().is_none_or(|instance| {
            self.facts
                .state
                .find(instance)
                .is_some_and(|id| self.facts.is(id, StateFlag::Examined) || self.facts.is(id, StateFlag::Used))
        })
    }

    fn holds(&self, goal: &Goal) -> bool {
        let holds = |state: &GoalState| self.state_holds(state);
        match goal.relation {
            Relation::And => !goal.states.is_empty() && goal.states.iter().all(holds),
            Relation::Or => goal.states.iter().any(holds),
        }
    }

    fn state_holds(&self, state: &GoalState) -> bool {
        let facts = self.facts;
        let of = &state.instance;
        match &state.predicate {
            Predicate::Flag(flag, value) => self.any(of, |id| facts.is(id, *flag) == *value),
            Predicate::Filled(fluid) => self.any(of, |id| facts.object(id).fluid == *fluid),
            Predicate::Color(color) => self.any(of, |id| facts.object(id).color == *color),
            Predicate::Contains(what) => self.any(of, |id| self.contains(id, what)),
            Predicate::ContainsCereal(value) => self.any(of, |id| facts.is(id, StateFlag::Cereal) == *value),
            Predicate::Empty(value) => self.any(of, |id| facts.held_in(id).is_empty() == *value),
            Predicate::Condition(name, value) => self
                .mission
                .conditions
                .iter()
                .find(|condition| condition.name == *name && of.matches(&condition.context))
                .or_else(|| self.mission.conditions.iter().find(|condition| condition.name == *name))
                .is_some_and(|condition| self.expression_holds(&condition.expression) == *value),
        }
    }

    fn contains(&self, receptacle: ObjectId, what: &InstancePattern) -> bool {
        self.facts.contents(receptacle).into_iter().any(|id| is_meant(self.facts, what, id))
    }

    fn expression_holds(&self, expression: &Expression) -> bool {
        let facts = self.facts;
        match expression {
            Expression::And(all) => all.iter().all(|inner| self.expression_holds(inner)),
            Expression::Or(any) => any.iter().any(|inner| self.expression_holds(inner)),
            Expression::Not(inner) => !self.expression_holds(inner),
            Expression::Flag { target, flag, value } => self.any(target, |id| facts.is(id, *flag) == *value),
            Expression::Contains { target, contains } => self.any(target, |id| self.contains(id, contains)),
            Expression::FilledWith { target, fluid } => self.any(target, |id| facts.object(id).fluid == *fluid),
            Expression::CanBeSeen { target, distance_m } => {
                self.any(target, |id| facts.state.bodies.iter().any(|body| self.sees(body, id, *distance_m)))
            }
            Expression::InRange { target, distance_m } => self.any(target, |id| {
                facts.state.bodies.iter().any(|body| facts.reach_to(id, body.position) <= *distance_m)
            }),
            Expression::HasColor { target, color } => self.any(target, |id| facts.object(id).color == *color),
            // No object of the catalogue can be fed.
            Expression::DinoFed { target, value } => self.any(target, |_| !*value),
            Expression::IsReceptacle { target, value } => {
                self.any(target, |id| facts.has(id, Property::Receptacle) == *value)
            }
            Expression::IsFull { target, value } => self.any(target, |id| is_full(facts, id) == *value),
        }
    }

    fn sees(&self, body: &Body, id: ObjectId, within_m: f32) -> bool {
        let facts = self.facts;
        let to = facts.object(id).pose.point(glam::Vec3::Z * (facts.size(id).z / 2.0)) - body.eye();
        to.length() <= within_m
            && to.normalize_or_zero().dot(body.gaze()) >= SIGHT_COS
            && facts.shut_around(id).is_none()
            && !facts.walled_off(id, body.position)
    }
}
