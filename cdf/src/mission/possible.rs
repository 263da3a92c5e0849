//! What can never hold, whatever is done: goals that ask for it cannot be reached.
//!
//! Only what the catalogue and the mission say for certain counts; where a world might surprise, nothing is said.

use super::{ObjectRequest, names::made};
use crate::{
    catalog::{Catalog, ClassId, ObjectClass, Property},
    flag_key::{flag_key, property_of},
    goal::{Expression, GoalState, InstancePattern, Predicate, Relation, StateCondition},
    state::{Fluid, StateFlag},
};

/// The one class that takes cereal.
const BOWL: &str = "Bowl_01";

/// The catalogue, and what the mission says, as far as it decides what can hold.
pub(super) struct Possibility<'a> {
    pub catalog: &'a Catalog,
    pub conditions: &'a [StateCondition],
    pub objects: &'a [ObjectRequest],
}

/// One state of one object, asked for together with others.
type Atom<'e> = (&'e InstancePattern, Wish);

#[derive(Clone, Copy, PartialEq)]
enum Wish {
    Flag(StateFlag, bool),
    Filled(Fluid),
}

impl Possibility<'_> {
    /// Why states as a goal combines them never hold; none if they may.
    pub fn never_all(&self, states: &[&GoalState], relation: Relation) -> Option<String> {
        let mut reasons = states.iter().map(|state| self.never_state(state));
        match relation {
            Relation::Or => reasons.collect::<Option<Vec<_>>>()?.into_iter().next(),
            Relation::And => reasons.find_map(|reason| reason).or_else(|| {
                let atoms: Vec<_> = states.iter().filter_map(|state| wish_of(state)).collect();
                contradiction(&atoms)
            }),
        }
    }

    /// Why a state never holds.
    pub fn never_state(&self, state: &GoalState) -> Option<String> {
        let of = &state.instance;
        if !matches!(state.predicate, Predicate::Condition(..))
            && let Some(reason) = self.gone(of)
        {
            return Some(reason);
        }
        match &state.predicate {
            Predicate::Flag(flag, true) => self.never_flag(of, *flag),
            Predicate::Filled(Fluid::None) | Predicate::Flag(_, false) | Predicate::ContainsCereal(false) => None,
            Predicate::Filled(_) | Predicate::FilledWithAny => self.lacks(of, Property::Fillable),
            Predicate::Contains(what) => self.never_contains(of, what),
            Predicate::ContainsCereal(true) => {
                let class = self.class(of).filter(|class| class.id != BOWL)?;
                Some(format!("cereal does not belong into `{of}`: {} is no bowl", class.name))
            }
            // A fluid is something in it, too.
            Predicate::Empty(false) => self.lacks(of, Property::Fillable).and_then(|_| self.no_receptacle(of)),
            Predicate::Empty(true) | Predicate::Color(_) => None,
            Predicate::Condition(name, value) => {
                let condition = self.condition(name, of)?;
                let reason = if *value {
                    self.never(&condition.expression)?
                } else {
                    self.always(&condition.expression).then(|| "it always holds".to_owned())?
                };
                Some(format!("of condition `{name}`: {reason}"))
            }
        }
    }

    /// Why an object is not there to have any state.
    fn gone(&self, of: &InstancePattern) -> Option<String> {
        let removed = self.objects.iter().any(|object| object.removed && object.instance == of.0);
        removed.then(|| format!("`{of}` is taken out of the world: it is `Removed`"))
    }

    /// The condition that a goal's state means.
    fn condition(&self, name: &str, of: &InstancePattern) -> Option<&StateCondition> {
        let named = || self.conditions.iter().filter(|condition| condition.name == name);
        named().find(|condition| of.matches(&condition.context)).or_else(|| named().next())
    }

    /// Why an expression never holds.
    fn never(&self, expression: &Expression) -> Option<String> {
        match expression {
            Expression::And(all) => all.iter().find_map(|inner| self.never(inner)).or_else(|| {
                let atoms: Vec<_> = all.iter().filter_map(wish_in).collect();
                contradiction(&atoms)
            }),
            Expression::Or(any) => {
                any.iter().map(|inner| self.never(inner)).collect::<Option<Vec<_>>>()?.into_iter().next()
            }
            Expression::Not(inner) => self.always(inner).then(|| format!("{inner} always holds")),
            Expression::Flag { target, flag, value: true } => self.never_flag(target, *flag),
            Expression::Contains { target, contains } => self.never_contains(target, contains),
            Expression::FilledWith { fluid: Fluid::None, .. } => None,
            Expression::FilledWith { target, .. } | Expression::FilledWithAny { target } => {
                self.lacks(target, Property::Fillable)
            }
            Expression::IsReceptacle { target, value } => {
                let takes = takes_things(self.class(target)?);
                (takes != *value).then(|| format!("`{target}` is {} receptacle", if takes { "a" } else { "no" }))
            }
            Expression::IsFull { target, value: true } => self.no_receptacle(target),
            Expression::Flag { value: false, .. }
            | Expression::IsFull { value: false, .. }
            | Expression::CanBeSeen { .. }
            | Expression::InRange { .. }
            | Expression::HasColor { .. }
            | Expression::DinoFed { .. } => None,
        }
    }

    /// Whether an expression holds whatever is done.
    fn always(&self, expression: &Expression) -> bool {
        match expression {
            Expression::And(all) => all.iter().all(|inner| self.always(inner)),
            Expression::Or(any) => any.iter().any(|inner| self.always(inner)),
            Expression::Not(inner) => self.never(inner).is_some(),
            Expression::Flag { target, flag, value: false } => self.never_flag(target, *flag).is_some(),
            Expression::FilledWith { target, fluid: Fluid::None } => self.lacks(target, Property::Fillable).is_some(),
            Expression::IsReceptacle { target, value } => {
                self.class(target).is_some_and(|class| takes_things(class) == *value)
            }
            Expression::IsFull { target, value: false } => self.no_receptacle(target).is_some(),
            _ => false,
        }
    }

    /// The class that is meant, if it is only one for certain.
    fn class(&self, of: &InstancePattern) -> Option<&ObjectClass> {
        let name = made(&of.0);
        let id: Option<ClassId> = match name.strip_suffix('*') {
            Some(prefix) => self.catalog.find(prefix.trim_end_matches('_')).filter(|id| {
                let own = &self.catalog.class(*id).id;
                self.catalog.classes().iter().all(|class| class.id == *own || !class.id.starts_with(prefix))
            }),
            None => self.catalog.class_of_instance(name),
        };
        id.map(|id| self.catalog.class(id))
    }

    fn never_flag(&self, of: &InstancePattern, flag: StateFlag) -> Option<String> {
        match property_of(flag) {
            Some(property) => self.lacks(of, property),
            None => self.never_set(of, flag),
        }
    }

    /// Why a thing never gets into a state that the table alone brings about, and is not in from the start.
    fn never_set(&self, of: &InstancePattern, flag: StateFlag) -> Option<String> {
        const OF_THE_TABLE: [StateFlag; 3] = [StateFlag::Wet, StateFlag::Creased, StateFlag::Folded];
        let from_the_start =
            |object: &ObjectRequest| of.matches(&object.instance) && object.flags.contains(&(flag, true));
        if !OF_THE_TABLE.contains(&flag) || self.objects.iter().any(from_the_start) {
            return None;
        }
        let class = self.class(of).filter(|class| !self.catalog.table().may_set(flag, class))?;
        Some(format!("`{of}` never gets into this state: nothing gets a {} into it", class.name))
    }

    fn lacks(&self, of: &InstancePattern, property: Property) -> Option<String> {
        let class = self.class(of).filter(|class| !class.has(property))?;
        let word = format!("{property:?}").to_lowercase();
        Some(format!("`{of}` never gets into this state: {} is not {word}", class.name))
    }

    fn no_receptacle(&self, of: &InstancePattern) -> Option<String> {
        let class = self.class(of).filter(|class| !takes_things(class))?;
        Some(format!("nothing can be in or on `{of}`: {} is no receptacle", class.name))
    }

    /// Why a receptacle never contains something; it need not be there itself, also what it stands in counts.
    fn never_contains(&self, of: &InstancePattern, what: &InstancePattern) -> Option<String> {
        if of == what && !of.is_wildcard() {
            return Some(format!("`{of}` is never in itself"));
        }
        if let Some(reason) = self.no_receptacle(of) {
            return Some(reason);
        }
        // What a machine makes lies in it whatever it takes.
        if made(&what.0) != what.0 {
            return None;
        }
        let (receptacle, content) = (self.class(of)?, self.class(what)?);
        let keys = &receptacle.receptacle.as_ref()?.keys;
        let from_the_start = |object: &ObjectRequest| {
            what.matches(&object.instance) && object.inside.as_ref().is_some_and(|inside| of.matches(inside))
        };
        if self.objects.iter().any(from_the_start) {
            return None;
        }
        let within = |key: &String| self.catalog.find(key).is_none_or(|id| takes_things(self.catalog.class(id)));
        if keys.is_empty() || keys.contains(&content.id) || keys.iter().any(within) {
            return None;
        }
        let mut keys: Vec<_> = keys.iter().map(|key| format!("`{key}`")).collect();
        keys.dedup();
        Some(format!("`{of}` never contains `{what}`: it takes only {}", keys.join(", ")))
    }
}

/// Whether objects of a class take others.
pub(super) fn takes_things(class: &ObjectClass) -> bool {
    class.has(Property::Receptacle) || class.receptacle.is_some()
}

fn wish_of(state: &GoalState) -> Option<Atom<'_>> {
    let wish = match &state.predicate {
        Predicate::Flag(flag, value) => Wish::Flag(*flag, *value),
        Predicate::Filled(fluid) => Wish::Filled(*fluid),
        _ => return None,
    };
    Some((&state.instance, wish))
}

fn wish_in(expression: &Expression) -> Option<Atom<'_>> {
    match expression {
        Expression::Flag { target, flag, value } => Some((target, Wish::Flag(*flag, *value))),
        Expression::FilledWith { target, fluid } => Some((target, Wish::Filled(*fluid))),
        _ => None,
    }
}

/// Two states of one object that exclude each other.
fn contradiction(atoms: &[Atom<'_>]) -> Option<String> {
    atoms.iter().enumerate().find_map(|(index, (of, one))| {
        let mut others = atoms[index + 1..].iter().filter(|(other, _)| other == of && !of.is_wildcard());
        others.find_map(|(_, other)| excludes(*one, *other).map(|why| format!("`{of}` is never {why} at once")))
    })
}

fn excludes(one: Wish, other: Wish) -> Option<String> {
    let key = flag_key;
    match (one, other) {
        (Wish::Flag(a, x), Wish::Flag(b, y)) if a == b && x != y => Some(format!("{0}=true and {0}=false", key(a))),
        (Wish::Flag(a, true), Wish::Flag(b, true)) if a != b && (a.is_mood() && b.is_mood() || hot_and_cold(a, b)) => {
            Some(format!("{}=true and {}=true", key(a), key(b)))
        }
        (Wish::Filled(a), Wish::Filled(b)) if a != b => Some(format!("filled with {} and {}", a.name(), b.name())),
        _ => None,
    }
}

fn hot_and_cold(one: StateFlag, other: StateFlag) -> bool {
    matches!((one, other), (StateFlag::Hot, StateFlag::Cold) | (StateFlag::Cold, StateFlag::Hot))
}
