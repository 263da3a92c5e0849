//! Looks up what a mission names: classes of objects, and the instances that will exist.

use super::{
    problem::Pointer,
    raw::{Loose, Scalar},
    reader::{Reader, did_you_mean},
};
use crate::catalog::ClassId;

/// What stands between a machine's instance id and the class it makes.
const SPAWNED: &str = "_Spawned_";

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
        self.class_of(at, &name)?;
        if self.listed.contains(&name) {
            self.error(at, format!("there is already an object `{name}`"), None);
        } else {
            self.listed.push(name.clone());
        }
        Some(name)
    }

    /// The class of an instance id; none and a problem if the catalogue lacks it.
    pub fn class_of(&mut self, at: &Pointer, instance: &str) -> Option<ClassId> {
        let made = instance.rsplit_once(SPAWNED).map_or(instance, |(_, made)| made);
        let Some(class) = self.catalog.class_of_instance(made) else {
            self.unknown_object(at, instance);
            return None;
        };
        let number = made[self.catalog.class(class).id.len()..].trim_start_matches('_');
        if !number.chars().all(|c| c.is_ascii_digit()) {
            let id = self.catalog.class(class).id.clone();
            self.warn(at, format!("`{instance}` is taken as a `{id}`: `{number}` is no number"), self.near(instance));
        }
        Some(class)
    }

    /// The class with this id, or of this instance; none and a problem if the catalogue lacks it.
    pub fn class_named(&mut self, at: &Pointer, id: &str) -> Option<String> {
        let class = self.class_of(at, id)?;
        Some(self.catalog.class(class).id.clone())
    }

    /// Checks that `name`, perhaps with a `*` at its end, can mean an object of this mission.
    pub fn reference(&mut self, at: &Pointer, name: &str) {
        if self.listed.iter().any(|listed| listed == name) {
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
            }
        } else if let Some(class) = self.class_of(at, name) {
            self.unlisted(at, name, class);
        }
    }

    /// Whether `pattern` is an instance id, or a prefix of some.
    fn is_class_pattern(&self, pattern: &str) -> bool {
        let Some(prefix) = pattern.strip_suffix('*') else { return self.catalog.class_of_instance(pattern).is_some() };
        let prefix = prefix.trim_end_matches('_');
        self.catalog.class_of_instance(prefix).is_some()
            || (!prefix.is_empty() && self.catalog.classes().iter().any(|class| class.id.starts_with(prefix)))
    }

    /// An instance that the mission does not list must be the layout's: under its id, or as one of its class.
    fn unlisted(&mut self, at: &Pointer, name: &str, class: ClassId) {
        let Some(layout) = &self.layout else { return };
        let class_of = |instance| self.catalog.class_of_instance(instance);
        if layout.placements.iter().any(|placement| class_of(&placement.instance) == Some(class)) {
            return;
        }
        let message = format!("no object `{name}`: neither the mission lists one, nor has layout `{}`", layout.id);
        let remedy = did_you_mean(name, self.listed.iter().map(String::as_str))
            .unwrap_or_else(|| "add it to `required_objects`".to_owned());
        self.error(at, message, Some(remedy));
    }

    fn unknown_object(&mut self, at: &Pointer, name: &str) {
        self.error(at, format!("unknown object `{name}`"), self.near(name));
    }

    /// A remedy for a misspelt instance: the nearest one listed, else the nearest class with the same number.
    fn near(&self, instance: &str) -> Option<String> {
        let listed = self.listed.iter().map(String::as_str);
        let classes = || self.catalog.classes().iter().map(|class| class.id.as_str());
        did_you_mean(instance, listed).or_else(|| did_you_mean(instance, classes())).or_else(|| {
            let (class, _) = instance.rsplit_once('_')?;
            did_you_mean(class, classes())
        })
    }
}
