//! What a mission asks for: goals, the states they name, and the expressions that missions define.
//!
//! Instances stay text here (`Bowl_01_1`, `Printer_3D_1_Spawned_ActionFigure_*`): what they mean is known only in a world.

use serde::{Deserialize, Serialize};

use crate::state::{Color, Fluid, StateFlag};

/// An instance id, or a prefix with `*` that means any instance of that type.
#[derive(Clone, Debug, Deserialize, Eq, Hash, PartialEq, Serialize)]
#[serde(transparent)]
pub struct InstancePattern(pub String);

impl InstancePattern {
    /// Whether it means any instance of a type.
    #[must_use]
    pub fn is_wildcard(&self) -> bool {
        self.0.ends_with('*')
    }

    /// Whether `instance` is meant.
    #[must_use]
    pub fn matches(&self, instance: &str) -> bool {
        match self.0.strip_suffix('*') {
            Some(prefix) => instance.starts_with(prefix),
            None => self.0 == instance,
        }
    }
}

/// One goal of a mission.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Goal {
    /// Its number in the mission file.
    pub id: i64,
    /// What people read; empty goals are shown by their mission's text.
    pub description: String,
    /// What must hold.
    pub states: Vec<GoalState>,
    /// Whether all or any of `states`.
    pub relation: Relation,
    /// Numbers of goals that must be met before this one counts.
    pub preconditions: Vec<i64>,
    /// Whether people see it only once it is unlocked.
    pub hidden: bool,
    /// The instance whose examining or use unlocks it, if hidden.
    pub unlocked_by: Option<String>,
    /// Whether it opens again when its states no longer hold.
    pub can_reset: bool,
}

/// How the states of a goal combine.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Relation {
    /// All of them.
    And,
    /// Any of them.
    Or,
}

/// One `{instance: "key=value"}` of a goal.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GoalState {
    /// Whose state.
    pub instance: InstancePattern,
    /// What must hold of it.
    pub predicate: Predicate,
}

/// What can hold of one object.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Predicate {
    /// A flag has this value.
    Flag(StateFlag, bool),
    /// It is filled with this.
    Filled(Fluid),
    /// It has this colour.
    Color(Color),
    /// It contains that instance, at any depth.
    Contains(InstancePattern),
    /// It contains cereal, or does not.
    ContainsCereal(bool),
    /// Nothing is in it, or something is.
    Empty(bool),
    /// The mission's own condition of this name has this value in its context.
    Condition(String, bool),
}

/// A condition that the mission defines and its goals name.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StateCondition {
    /// The name that goals use.
    pub name: String,
    /// The instance it belongs to.
    pub context: String,
    /// What must hold.
    pub expression: Expression,
}

/// A condition's expression.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Expression {
    /// All hold.
    And(Vec<Expression>),
    /// Any holds.
    Or(Vec<Expression>),
    /// It does not hold.
    Not(Box<Expression>),
    /// A flag of the target has this value; a flag that the target cannot have is false.
    Flag {
        /// Whose.
        target: InstancePattern,
        /// Which.
        flag: StateFlag,
        /// The value wanted.
        value: bool,
    },
    /// The target contains that instance, perhaps at a named anchor.
    Contains {
        /// The receptacle.
        target: InstancePattern,
        /// What it contains.
        contains: InstancePattern,
    },
    /// The target is filled with this.
    FilledWith {
        /// Whose.
        target: InstancePattern,
        /// With what.
        fluid: Fluid,
    },
    /// A robot sees the target within this distance, m.
    CanBeSeen {
        /// What.
        target: InstancePattern,
        /// From how far, m.
        distance_m: f32,
    },
    /// A robot is within this distance of the target, m.
    InRange {
        /// Of what.
        target: InstancePattern,
        /// How near, m.
        distance_m: f32,
    },
    /// The target has this colour.
    HasColor {
        /// Whose.
        target: InstancePattern,
        /// Which.
        color: Color,
    },
    /// The dinosaur was fed, or not.
    DinoFed {
        /// Which.
        target: InstancePattern,
        /// The value wanted.
        value: bool,
    },
    /// The target takes other objects, or does not.
    IsReceptacle {
        /// Whose.
        target: InstancePattern,
        /// The value wanted.
        value: bool,
    },
    /// Every anchor of the target is taken, or not.
    IsFull {
        /// Whose.
        target: InstancePattern,
        /// The value wanted.
        value: bool,
    },
}
