//! What a mission asks for: goals, the states they name, and the expressions that missions define.
//!
//! Instances stay text here (`Bowl_01_1`, `Printer_3D_1_Spawned_ActionFigure_*`): what they mean is known only in a world.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::{
    catalog::{Catalog, ClassId},
    flag_key::flag_key,
    state::{Color, Fluid, StateFlag},
};

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

    /// The class whose things it means, if it is a class and `_*`: `Egg_*` is any egg, and no egg box.
    #[must_use]
    pub fn class_in(&self, catalog: &Catalog) -> Option<ClassId> {
        self.0.strip_suffix("_*").and_then(|class| catalog.find(class))
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
    /// It is filled with anything.
    FilledWithAny,
    /// It has this colour.
    Color(Color),
    /// It contains that instance, at any depth.
    Contains(InstancePattern),
    /// It contains cereal, or does not.
    ContainsCereal(bool),
    /// Nothing is in it, or something is.
    Empty(bool),
    /// The mission's own condition of this name has this value; see [`crate::Mission::condition`] for which one it is.
    Condition(String, bool),
}

/// What must hold of objects for something else to happen: for a message to be shown, for an object to be there.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Occasion {
    /// States as goals name them.
    States(Vec<GoalState>, Relation),
    /// An expression.
    Expression(Expression),
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
    /// The target is filled with anything.
    FilledWithAny {
        /// Whose.
        target: InstancePattern,
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

impl Expression {
    /// Has `visit` take all objects that it names, in its order.
    pub fn for_each_named(&self, visit: &mut impl FnMut(&InstancePattern)) {
        match self {
            Self::And(parts) | Self::Or(parts) => parts.iter().for_each(|part| part.for_each_named(visit)),
            Self::Not(inner) => inner.for_each_named(visit),
            Self::Contains { target, contains } => {
                visit(target);
                visit(contains);
            }
            Self::Flag { target, .. }
            | Self::FilledWith { target, .. }
            | Self::FilledWithAny { target }
            | Self::CanBeSeen { target, .. }
            | Self::InRange { target, .. }
            | Self::HasColor { target, .. }
            | Self::DinoFed { target, .. }
            | Self::IsReceptacle { target, .. }
            | Self::IsFull { target, .. } => visit(target),
        }
    }
}

impl fmt::Display for InstancePattern {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// As missions write it: `isHot=true`, `isFilled=Milk`.
impl fmt::Display for Predicate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Flag(flag, value) => write!(f, "{}={value}", flag_key(*flag)),
            Self::Filled(fluid) => write!(f, "isFilled={}", fluid.name()),
            Self::FilledWithAny => f.write_str("isFilled=true"),
            Self::Color(color) => write!(f, "ColorMetaDataChange={}", color.name()),
            Self::Contains(contained) => write!(f, "Contains={contained}"),
            Self::ContainsCereal(value) => write!(f, "ContainsCereal={value}"),
            Self::Empty(value) => write!(f, "isEmpty={value}"),
            Self::Condition(name, value) => write!(f, "{name}={value}"),
        }
    }
}

/// `Bowl_01_1: isHot=true`.
impl fmt::Display for GoalState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.instance, self.predicate)
    }
}

/// In the words of missions: `Bowl_01_1: isHot=true AND NOT Bowl_01_1: isFilledWith=Milk`; inner `AND` and `OR` in
/// brackets.
impl fmt::Display for Expression {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::And(all) => joined(f, all, "AND"),
            Self::Or(any) => joined(f, any, "OR"),
            Self::Not(inner) => {
                f.write_str("NOT ")?;
                bracketed(f, inner)
            }
            Self::Flag { target, flag, value } => write!(f, "{target}: {}={value}", flag_key(*flag)),
            Self::Contains { target, contains } => write!(f, "{target}: Contains={contains}"),
            Self::FilledWith { target, fluid } => write!(f, "{target}: isFilledWith={}", fluid.name()),
            Self::FilledWithAny { target } => write!(f, "{target}: isFilled=true"),
            Self::CanBeSeen { target, distance_m } => write!(f, "{target}: CanBeSeen={distance_m}"),
            Self::InRange { target, distance_m } => write!(f, "{target}: IsInRange={distance_m}"),
            Self::HasColor { target, color } => write!(f, "{target}: ColorMetaDataChange={}", color.name()),
            Self::DinoFed { target, value } => write!(f, "{target}: DinoFed={value}"),
            Self::IsReceptacle { target, value } => write!(f, "{target}: IsReceptacle={value}"),
            Self::IsFull { target, value } => write!(f, "{target}: isFullOfItems={value}"),
        }
    }
}

fn joined(f: &mut fmt::Formatter<'_>, expressions: &[Expression], word: &str) -> fmt::Result {
    for (index, expression) in expressions.iter().enumerate() {
        if index > 0 {
            write!(f, " {word} ")?;
        }
        bracketed(f, expression)?;
    }
    Ok(())
}

fn bracketed(f: &mut fmt::Formatter<'_>, expression: &Expression) -> fmt::Result {
    match expression {
        Expression::And(parts) | Expression::Or(parts) if parts.len() > 1 => write!(f, "({expression})"),
        _ => write!(f, "{expression}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bowl() -> InstancePattern {
        InstancePattern("Bowl_01_1".to_owned())
    }

    #[test]
    fn predicates_print_as_missions_write_them() {
        for (predicate, expected) in [
            (Predicate::Flag(StateFlag::Opened, false), "isOpen=false"),
            (Predicate::Filled(Fluid::Milk), "isFilled=Milk"),
            (Predicate::FilledWithAny, "isFilled=true"),
            (Predicate::Contains(bowl()), "Contains=Bowl_01_1"),
            (Predicate::ContainsCereal(true), "ContainsCereal=true"),
            (Predicate::Condition("InSink".to_owned(), true), "InSink=true"),
        ] {
            assert_eq!(predicate.to_string(), expected);
            let state = GoalState { instance: bowl(), predicate };
            assert_eq!(state.to_string(), format!("Bowl_01_1: {expected}"));
        }
    }

    #[test]
    fn expressions_print_with_brackets_inside_alone() {
        let hot = || Expression::Flag { target: bowl(), flag: StateFlag::Hot, value: true };
        let near = Expression::InRange { target: bowl(), distance_m: 1.5 };
        let either = Expression::Or(vec![near, Expression::FilledWith { target: bowl(), fluid: Fluid::Water }]);
        let all = Expression::And(vec![hot(), Expression::Not(Box::new(hot())), either]);
        assert_eq!(
            all.to_string(),
            "Bowl_01_1: isHot=true AND NOT Bowl_01_1: isHot=true AND \
             (Bowl_01_1: IsInRange=1.5 OR Bowl_01_1: isFilledWith=Water)"
        );
    }
}
