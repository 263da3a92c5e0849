//! Goals: whether what a mission asks for holds now, and whether it was met before.

use cohabit_cdf::{
    Catalog, ClassId, Expression, Fluid, Goal, GoalState, InstancePattern, Mission, ObjectId, Occasion, Predicate,
    Property, Relation, StateFlag, StateFlags,
};

use crate::{anchors::is_full, facts::Facts, sight::sees, state::State};

/// What missions call the robots: `TAM_1`, `TAM_2`, in the order of the bodies.
const ROBOT: &str = "TAM";

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
        let holds = ready && judge.all_hold(&goal.states, goal.relation);
        if holds != progress[index].met {
            progress[index].met = holds;
            changes.push(if holds { GoalChange::Met(index) } else { GoalChange::Reset(index) });
        }
    }
    changes
}

/// Whether what a mission waits for holds now.
pub(crate) fn occurs(facts: &Facts<'_>, mission: &Mission, occasion: &Occasion) -> bool {
    let judge = Judge { facts, mission };
    match occasion {
        Occasion::States(states, relation) => judge.all_hold(states, *relation),
        Occasion::Expression(expression) => judge.expression_holds(expression),
    }
}

/// The goals as everybody outside may know them.
pub(crate) fn statuses(mission: &Mission, state: &State) -> Vec<GoalStatus> {
    let goals = mission.goals.iter().zip(&state.goals);
    goals
        .map(|(goal, progress)| GoalStatus {
            id: goal.id,
            description: mission.words_of(goal).to_owned(),
            met: progress.met,
            hidden: goal.hidden && !progress.shown && !progress.met,
        })
        .collect()
}

/// The objects that a pattern means.
pub(crate) enum Meant<'p> {
    /// This one.
    One(&'p str),
    /// Those of this class: `Carrot_01_*` is any carrot, also one that a machine made and named after itself.
    Class(ClassId),
    /// Those whose instance begins so.
    Any(&'p str),
}

impl<'p> Meant<'p> {
    pub(crate) fn new(catalog: &Catalog, pattern: &'p InstancePattern) -> Self {
        match (pattern.class_in(catalog), pattern.0.strip_suffix('*')) {
            (Some(class), _) => Self::Class(class),
            (None, Some(prefix)) => Self::Any(prefix),
            (None, None) => Self::One(&pattern.0),
        }
    }

    pub(crate) fn is(&self, facts: &Facts<'_>, id: ObjectId) -> bool {
        let object = facts.object(id);
        match self {
            Self::One(instance) => object.is_called(instance),
            Self::Class(class) => object.class == *class,
            Self::Any(prefix) => {
                object.instance.starts_with(prefix)
                    || object.aliases.iter().any(|alias| alias.starts_with(prefix))
                    || facts.class(id).id == *prefix
            }
        }
    }
}

/// Facts and the mission whose conditions goals name.
struct Judge<'a> {
    facts: &'a Facts<'a>,
    mission: &'a Mission,
}

impl Judge<'_> {
    fn meant<'b>(&'b self, pattern: &'b InstancePattern) -> impl Iterator<Item = ObjectId> + 'b {
        let meant = Meant::new(self.facts.catalog, pattern);
        self.facts.state.existing().map(|(id, _)| id).filter(move |id| meant.is(self.facts, *id))
    }

    fn any(&self, pattern: &InstancePattern, holds: impl Fn(ObjectId) -> bool) -> bool {
        self.meant(pattern).any(holds)
    }

    /// A hidden goal without a key is shown from the start; any other once somebody did something to its key.
    fn is_unlocked(&self, goal: &Goal) -> bool {
        let key = |instance: &String| self.facts.state.objects.iter().find(|object| object.is_called(instance));
        let seen = StateFlags::default().with(StateFlag::Examined).with(StateFlag::Used).with(StateFlag::Scanned);
        goal.unlocked_by
            .as_ref()
            .is_none_or(|instance| key(instance).is_some_and(|key| key.touched || key.flags.0 & seen.0 != 0))
    }

    fn all_hold(&self, states: &[GoalState], relation: Relation) -> bool {
        let holds = |state: &GoalState| self.state_holds(state);
        match relation {
            Relation::And => !states.is_empty() && states.iter().all(holds),
            Relation::Or => states.iter().any(holds),
        }
    }

    fn state_holds(&self, state: &GoalState) -> bool {
        let facts = self.facts;
        let of = &state.instance;
        match &state.predicate {
            Predicate::Flag(flag, value) => self.flag_holds(of, *flag, *value),
            Predicate::Filled(fluid) => self.any(of, |id| facts.object(id).fluid == *fluid),
            Predicate::FilledWithAny => self.any(of, |id| facts.object(id).fluid != Fluid::None),
            Predicate::Color(color) => self.any(of, |id| facts.object(id).color == *color),
            Predicate::Contains(what) => self.any(of, |id| self.contains(id, what)),
            Predicate::ContainsCereal(value) => self.any(of, |id| facts.is(id, StateFlag::Cereal) == *value),
            Predicate::Empty(value) => self.any(of, |id| self.is_empty(id) == *value),
            Predicate::Condition(name, value) => self
                .mission
                .condition(name, &of.0)
                .is_some_and(|condition| self.expression_holds(&condition.expression) == *value),
        }
    }

    /// Whether a flag of an object, or of a robot, has that value.
    fn flag_holds(&self, of: &InstancePattern, flag: StateFlag, value: bool) -> bool {
        let robots =
            || (1..).zip(&self.facts.state.bodies).filter(|(number, _)| of.matches(&format!("{ROBOT}_{number}")));
        self.any(of, |id| self.facts.is(id, flag) == value)
            || (of.0.starts_with(ROBOT) && robots().any(|(_, body)| body.flags.has(flag) == value))
    }

    /// Whether nothing is in or on it, neither things nor a fluid.
    fn is_empty(&self, id: ObjectId) -> bool {
        let facts = self.facts;
        facts.held_in(id).is_empty() && facts.object(id).fluid == Fluid::None && !facts.is(id, StateFlag::Cereal)
    }

    fn contains(&self, receptacle: ObjectId, what: &InstancePattern) -> bool {
        let meant = Meant::new(self.facts.catalog, what);
        self.facts.contents(receptacle).into_iter().any(|id| meant.is(self.facts, id))
    }

    fn expression_holds(&self, expression: &Expression) -> bool {
        let facts = self.facts;
        match expression {
            Expression::And(all) => all.iter().all(|inner| self.expression_holds(inner)),
            Expression::Or(any) => any.iter().any(|inner| self.expression_holds(inner)),
            Expression::Not(inner) => !self.expression_holds(inner),
            Expression::Flag { target, flag, value } => self.flag_holds(target, *flag, *value),
            Expression::Contains { target, contains } => self.any(target, |id| self.contains(id, contains)),
            Expression::FilledWith { target, fluid } => self.any(target, |id| facts.object(id).fluid == *fluid),
            Expression::FilledWithAny { target } => self.any(target, |id| facts.object(id).fluid != Fluid::None),
            Expression::CanBeSeen { target, distance_m } => {
                self.any(target, |id| facts.state.bodies.iter().any(|body| sees(facts, body, id, *distance_m)))
            }
            Expression::InRange { target, distance_m } => self.any(target, |id| {
                facts.state.bodies.iter().any(|body| facts.reach_to(id, body.position) <= *distance_m)
            }),
            Expression::HasColor { target, color } => self.any(target, |id| facts.object(id).color == *color),
            Expression::DinoFed { target, value } => self.dino_fed(target) == *value,
            Expression::IsReceptacle { target, value } => {
                self.any(target, |id| facts.has(id, Property::Receptacle) == *value)
            }
            Expression::IsFull { target, value } => self.any(target, |id| is_full(facts, id) == *value),
        }
    }

    /// Whether that dinosaur was fed; any, if the target is none.
    fn dino_fed(&self, target: &InstancePattern) -> bool {
        let dinosaurs = &self.facts.state.dinosaurs;
        let meant = Meant::new(self.facts.catalog, target);
        let known = |id: &ObjectId| meant.is(self.facts, *id);
        let named = dinosaurs.keys().any(known);
        dinosaurs.iter().any(|(id, dinosaur)| dinosaur.fed && (!named || known(id)))
    }
}
