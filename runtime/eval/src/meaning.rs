//! What a person wants done, one thing at a time: the expert's plan of a mission.

use cohabit_cdf::{
    Catalog, Color, Fluid, Mission, RoomId, StateFlag,
    goal::{Expression, GoalState, Predicate},
};
use serde::{Deserialize, Serialize};

/// One thing that is wanted. Objects are instance ids.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(tag = "want", rename_all = "snake_case")]
#[allow(missing_docs, reason = "the names of the fields say all")]
pub enum Meaning {
    /// Be in a room, which people call that.
    GoTo { room: RoomId, name: String },
    /// Hold something.
    PickUp { object: String },
    /// Have something on or in something else.
    Place { object: String, receptacle: String },
    /// Have a part in the machine that needs it.
    Insert { object: String, device: String },
    /// Have a machine on.
    TurnOn { device: String },
    /// Have something scanned.
    Scan { object: String },
    /// Have something broken.
    Break { object: String },
    /// Have something clean.
    Clean { object: String },
    /// Have something full of water.
    Fill { object: String },
    /// Have what is in one thing in the other.
    Pour { from: String, into: String },
    /// Have something hot.
    Heat { object: String },
    /// Have something cold.
    Cool { object: String },
    /// Have something whole again.
    Repair { object: String },
    /// Have something in another colour.
    Color { object: String, color: Color },
}

impl Meaning {
    /// What somebody wants who wants that state of a mission's goals, if it can be said.
    #[must_use]
    pub fn of_goal(state: &GoalState, mission: &Mission, catalog: &Catalog) -> Option<Self> {
        if state.instance.is_wildcard() {
            return None;
        }
        let object = state.instance.0.clone();
        Some(match &state.predicate {
            Predicate::Flag(StateFlag::PickedUp, true) => Self::PickUp { object },
            Predicate::Flag(StateFlag::Toggled, true) => Self::TurnOn { device: object },
            Predicate::Flag(StateFlag::Broken, true) => Self::Break { object },
            Predicate::Flag(StateFlag::Broken, false) => Self::Repair { object },
            Predicate::Flag(StateFlag::Dirty, false) => Self::Clean { object },
            Predicate::Flag(StateFlag::Hot, true) => Self::Heat { object },
            Predicate::Flag(StateFlag::Cold, true) => Self::Cool { object },
            Predicate::Flag(StateFlag::Scanned, true) => Self::Scan { object },
            Predicate::Filled(Fluid::Water) => Self::Fill { object },
            Predicate::Color(color) => Self::Color { object, color: *color },
            Predicate::Contains(thing) if !thing.is_wildcard() => Self::to_place(&thing.0, &object, catalog),
            Predicate::Condition(name, true) => return Self::of_color(name, &object, mission),
            _ => return None,
        })
    }

    /// To have a thing on something, or in the machine that needs it.
    fn to_place(thing: &str, place: &str, catalog: &Catalog) -> Self {
        let class = catalog.class_of_instance(place).map(|id| catalog.class(id));
        let is_machine = class.and_then(|class| class.receptacle.as_ref()).is_some_and(|takes| !takes.keys.is_empty());
        let (object, place) = (thing.to_owned(), place.to_owned());
        if is_machine { Self::Insert { object, device: place } } else { Self::Place { object, receptacle: place } }
    }

    /// A condition that says nothing but a colour.
    fn of_color(name: &str, context: &str, mission: &Mission) -> Option<Self> {
        match &mission.condition(name, context)?.expression {
            Expression::HasColor { target, color, .. } if !target.is_wildcard() => {
                Some(Self::Color { object: target.0.clone(), color: *color })
            }
            _ => None,
        }
    }

    /// The object that it is about.
    #[must_use]
    pub fn object(&self) -> Option<&str> {
        match self {
            Self::GoTo { .. } => None,
            Self::TurnOn { device } => Some(device),
            Self::Pour { from, .. } => Some(from),
            Self::PickUp { object }
            | Self::Place { object, .. }
            | Self::Insert { object, .. }
            | Self::Scan { object }
            | Self::Break { object }
            | Self::Clean { object }
            | Self::Fill { object }
            | Self::Heat { object }
            | Self::Cool { object }
            | Self::Repair { object }
            | Self::Color { object, .. } => Some(object),
        }
    }

    /// The other object that it needs.
    #[must_use]
    pub fn target(&self) -> Option<&str> {
        match self {
            Self::Place { receptacle, .. } => Some(receptacle),
            Self::Insert { device, .. } => Some(device),
            Self::Pour { into, .. } => Some(into),
            _ => None,
        }
    }
}
