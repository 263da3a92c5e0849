//! Looks up what a mission names: classes of objects, and the instances that will exist.

use super::{
    problem::Pointer,
    raw::{Loose, Scalar},
    reader::Reader,
};
use crate::{
    catalog::{ClassId, Property},
    nearest::{did_you_mean, suggestion},
};

/// What stands between a machine's instance id and the class it makes.
const SPAWNED: &str = "_Spawned_";

/// What stands before the number of a robot, which missions may name but do not list.
const ROBOT: &str = "TAM_";

/// Whether `name` is a robot's.
pub(super) fn is_robot(name: &str) -> bool {
    name.strip_prefix(ROBOT).is_some_and(|number| !number.is_empty() && number.chars().all(|c| c.is_ascii_digit()))
}

/// What a machine made, without the machine: `Hammer_1` of `Printer_3D_1_Spawned_Hammer_1`.
pub(super) fn made(instance: &str) -> &str {
    instance.rsplit_once(SPAWNED).map_or(instance, |(_, made)| made)
}

impl Reader<'_> {
    /// The instance id that an entry of the mission introduces; none and a problem if it has none, an unknown class,
    /// or one that is taken.
    pub fn new_instance(&mut self, at: &Pointer, field: &Loose<Scalar>) -> Option<String> {
        let Some(name) = self.text(at, field) else {
            if field.misfit().is_none() {
                self.error(at, "the object has no name", None);
            }
            return None;
        };
        if self.class_of(at, &name).is_none() {
            self.error(at, format!("unknown object `{name}`"), self.near_class(&name));
            // What is meant is told once: naming it elsewhere is right.
            self.misspelt.extend(self.catalog.near(&name));
            return None;
        }
        if self.listed.contains(&name) {
            self.error(at, format!("there is already an object `{name}`"), None);
        } else {
            self.listed.push(name.clone());
        }
        Some(name)
    }

    /// The class of an instance id, if the catalogue has it; what is no number at its end is warned of.
    fn class_of(&mut self, at: &Pointer, instance: &str) -> Option<ClassId> {
        let made = made(instance);
        let class = self.catalog.class_of_instance(made)?;
        let number = made[self.catalog.class(class).id.len()..].trim_start_matches('_');
        if !number.chars().all(|c| c.is_ascii_digit()) {
            let id = self.catalog.class(class).id.clone();
            self.warn(
                at,
                format!("`{instance}` is taken as a `{id}`: `{number}` is no number"),
                self.near_class(instance),
            );
        }
        Some(class)
    }

    /// The class with this id, or of this instance; none and a problem if the catalogue lacks it.
    pub fn class_named(&mut self, at: &Pointer, id: &str) -> Option<String> {
        let Some(class) = self.class_of(at, id) else {
            self.error(at, format!("unknown object `{id}`"), self.near_class(id));
            return None;
        };
        Some(self.catalog.class(class).id.clone())
    }

    /// Checks that `name`, perhaps with a `*` at its end, can mean an object of this mission.
    pub fn reference(&mut self, at: &Pointer, name: &str) {
        if self.listed.iter().chain(&self.misspelt).any(|listed| listed == name) || is_robot(name) {
            return;
        }
        if let Some((machine, made)) = name.split_once(SPAWNED) {
            self.reference(at, machine);
            if !self.is_class_pattern(made) {
                self.unknown_object(at, name);
            }
        } else if name.ends_with('*') {
            if !self.is_class_pattern(name) {
                self.unknown_object(at, name);
            } else if self.is_of_nothing(name) {
                let message = format!("no object `{name}`: neither the mission lists one, nor has the layout");
                self.error(at, message, Some("add it to `required_objects`".to_owned()));
            }
        } else {
            match self.class_of(at, name) {
                Some(class) => self.unlisted(at, name, class),
                None => self.unknown_object(at, name),
            }
        }
    }

    /// Whether `pattern` is an instance id, or a prefix of some.
    fn is_class_pattern(&self, pattern: &str) -> bool {
        let Some(prefix) = pattern.strip_suffix('*') else { return self.catalog.class_of_instance(pattern).is_some() };
        let prefix = prefix.trim_end_matches('_');
        self.catalog.class_of_instance(prefix).is_some()
            || (!prefix.is_empty() && self.catalog.classes().iter().any(|class| class.id.starts_with(prefix)))
    }

    /// Whether a wildcard means only what is neither there nor ever made: what can be carried may be made by a machine.
    fn is_of_nothing(&self, pattern: &str) -> bool {
        let prefix = pattern.trim_end_matches('*');
        let class = prefix.trim_end_matches('_');
        let mut meant = self.catalog.classes().iter().filter(|known| known.id == class || known.id.starts_with(prefix));
        let placed = self.layout.map_or(&[][..], |layout| &layout.placements).iter().map(|placed| &placed.instance);
        self.layout.is_some()
            && !self.unlisted_all
            && !self.listed.iter().chain(&self.misspelt).chain(placed).any(|name| name.starts_with(prefix))
            && meant.all(|class| !class.has(Property::Pickupable))
    }

    /// An instance that the mission does not list must be the layout's: under its id, or as the only machine of its class.
    fn unlisted(&mut self, at: &Pointer, name: &str, class: ClassId) {
        let Some(layout) = self.layout else { return };
        if self.unlisted_all || layout.placements.iter().any(|placement| placement.instance == name) {
            return;
        }
        let of_class = |instance: &&str| self.catalog.class_of_instance(instance) == Some(class);
        let placed: Vec<_> =
            layout.placements.iter().map(|placement| placement.instance.as_str()).filter(of_class).collect();
        let listed: Vec<_> = self.listed.iter().map(String::as_str).filter(of_class).collect();
        let carried = self.catalog.class(class).has(Property::Pickupable);
        if placed.len() == 1 && listed.is_empty() && !carried {
            return;
        }
        let near = did_you_mean(name, listed.iter().chain(&placed).copied());
        let message = match placed.as_slice() {
            [] => format!("no object `{name}`: neither the mission lists one, nor has layout `{}`", layout.id),
            [only] => format!("no object `{name}`: the layout's is `{only}`"),
            [first, .., last] => {
                format!("no object `{name}`: the layout has {}, `{first}` to `{last}`", placed.len())
            }
        };
        self.error(at, message, Some(near.unwrap_or_else(|| "add it to `required_objects`".to_owned())));
    }

    fn unknown_object(&mut self, at: &Pointer, name: &str) {
        let listed = self.listed.iter().map(String::as_str);
        let remedy = did_you_mean(name, listed).or_else(|| self.near_class(name));
        self.error(at, format!("unknown object `{name}`"), remedy);
    }

    /// A remedy for a misspelt instance.
    fn near_class(&self, instance: &str) -> Option<String> {
        self.catalog.near(instance).as_deref().map(suggestion)
    }
}
