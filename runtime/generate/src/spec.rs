//! A specification of missions: types as templates, and pools that they draw from.

use std::collections::BTreeSet;

use cohabit_cdf::{Catalog, Layout, Property};
use serde::{Deserialize, Serialize};

/// Why a specification cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum SpecError {
    /// It is not the TOML expected.
    #[error("{file}: {source}")]
    Syntax {
        /// Which file.
        file: String,
        /// Where and what.
        source: Box<toml::de::Error>,
    },
    /// It asks for what there is not.
    #[error("{file}: {place}: {reason}")]
    Wrong {
        /// Which file.
        file: String,
        /// The type, or the pools.
        place: String,
        /// What is wrong, and what would be right.
        reason: String,
    },
}

/// Types of missions, and what they draw from.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spec {
    #[serde(default)]
    pub(crate) pools: Pools,
    #[serde(rename = "type")]
    pub(crate) types: Vec<MissionType>,
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Pools {
    /// Floor plans; all built-in ones, if empty.
    #[serde(default)]
    pub layouts: Vec<String>,
    /// The share of things of which there is another one.
    #[serde(default)]
    pub doubles: f64,
    /// Things that no goal is about.
    #[serde(default)]
    pub distractors: usize,
    /// The share of missions in which something stands in the way.
    #[serde(default)]
    pub blockers: f64,
    /// What stands in the way; anything, if empty.
    #[serde(default)]
    pub blocker_kinds: Vec<BlockerKind>,
    /// Whether no goal may be met as a mission begins.
    #[serde(default)]
    pub all_open: bool,
}

/// What stands in the way of a goal.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum BlockerKind {
    /// What a goal is about is in something shut.
    Closed,
    /// What would be used does not open: there is another way.
    Locked,
    /// A machine that is needed has no power: the lever of its fuse box is down.
    Unpowered,
}

impl BlockerKind {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Closed, Self::Locked, Self::Unpowered];
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct MissionType {
    pub name: String,
    pub vars: Vec<VarSpec>,
    pub goals: Vec<String>,
    /// Fewest and most actions of its plan.
    #[serde(default)]
    pub steps: Option<[usize; 2]>,
    /// Whether a goal counts only after those before it.
    #[serde(default)]
    pub then: bool,
    /// How many robots there are; the first one does all that the plan has.
    #[serde(default = "one")]
    pub robots: usize,
}

const fn one() -> usize {
    1
}

/// The first types of the built-in specification are those of the paper.
const TYPES_OF_THE_PAPER: usize = 12;
/// Most robots of a mission.
const MOST_ROBOTS: usize = 4;

#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, PartialEq)]
#[serde(rename_all = "snake_case")]
pub(crate) enum VarKind {
    #[default]
    Thing,
    Surface,
    Device,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct VarSpec {
    pub name: String,
    #[serde(default)]
    pub kind: VarKind,
    #[serde(default)]
    pub class: Vec<String>,
    #[serde(default)]
    pub affords: Vec<Property>,
    #[serde(default)]
    pub without: Vec<Property>,
    /// The var whose keys are meant.
    #[serde(default)]
    pub key_of: Option<String>,
    #[serde(default)]
    pub state: Vec<String>,
    #[serde(default)]
    pub inside: Vec<String>,
}

impl Spec {
    /// The project's own: the twelve types of the paper, and twelve more.
    ///
    /// # Panics
    /// Never: the tests read the same text.
    #[must_use]
    pub fn builtin(catalog: &Catalog) -> Self {
        let text = include_str!("../data/missions.toml");
        Self::parse("missions.toml", text, catalog).expect("invariant: the built-in specification is right")
    }

    /// Reads a specification, and checks it against the catalogue.
    ///
    /// # Errors
    /// [`SpecError`] names the file, the type and what is wrong.
    pub fn parse(file: &str, text: &str, catalog: &Catalog) -> Result<Self, SpecError> {
        let read: Result<Self, _> = toml::from_str(text);
        let spec = read.map_err(|source| SpecError::Syntax { file: file.to_owned(), source: Box::new(source) })?;
        let wrong = |place: &str, reason: String| {
            Err(SpecError::Wrong { file: file.to_owned(), place: place.to_owned(), reason })
        };
        if spec.types.is_empty() {
            return wrong("type", "there is no type of missions; write at least one [[type]]".to_owned());
        }
        let known = Layout::ids(catalog);
        if let Some(layout) = spec.pools.layouts.iter().find(|layout| !known.contains(layout)) {
            return wrong("pools", format!("there is no floor plan `{layout}`; there are {}", known.join(", ")));
        }
        for (name, share) in [("doubles", spec.pools.doubles), ("blockers", spec.pools.blockers)] {
            if !(0.0..=1.0).contains(&share) {
                return wrong("pools", format!("{name} is a share, from 0 to 1"));
            }
        }
        for kind in &spec.types {
            if let Some(reason) = kind.fault(catalog) {
                return wrong(&format!("type `{}`", kind.name), reason);
            }
        }
        Ok(spec)
    }

    /// The twelve types of Alexa Arena's trajectory data set, as the project has them.
    #[must_use]
    pub fn of_the_paper(catalog: &Catalog) -> Self {
        let mut spec = Self::builtin(catalog);
        spec.types.truncate(TYPES_OF_THE_PAPER);
        spec
    }

    /// The same with one type and one floor plan alone.
    #[must_use]
    pub fn only(&self, kind: &str, floor_plan: &str) -> Self {
        let types = self.types.iter().filter(|one| one.name == kind).cloned().collect();
        Self { types, pools: Pools { layouts: vec![floor_plan.to_owned()], ..self.pools.clone() } }
    }

    /// The same with something in the way in that share of missions, from 0 to 1.
    #[must_use]
    pub fn with_blockers(mut self, share: f64) -> Self {
        self.pools.blockers = share.clamp(0.0, 1.0);
        self
    }

    /// The same with these of its types alone; `file` is only what an error calls them.
    ///
    /// # Errors
    /// [`SpecError::Wrong`] if there is none of that name.
    pub fn of_types(mut self, file: &str, names: &[String]) -> Result<Self, SpecError> {
        let known: Vec<&str> = self.types().collect();
        if let Some(name) = names.iter().find(|name| !known.contains(&name.as_str())) {
            let reason = format!("there is no type `{name}`; there are {}", known.join(", "));
            return Err(SpecError::Wrong { file: file.to_owned(), place: "type".to_owned(), reason });
        }
        self.types.retain(|kind| names.contains(&kind.name));
        Ok(self)
    }

    /// The names of its types.
    pub fn types(&self) -> impl Iterator<Item = &str> {
        self.types.iter().map(|kind| kind.name.as_str())
    }
}

impl MissionType {
    fn fault(&self, catalog: &Catalog) -> Option<String> {
        let mut names = BTreeSet::new();
        for var in &self.vars {
            if !names.insert(var.name.as_str()) {
                return Some(format!("there are two vars `{}`", var.name));
            }
            let classes = var.class.iter().chain(&var.inside);
            if let Some(class) = classes.into_iter().find(|class| catalog.find(class).is_none()) {
                return Some(format!("`{class}` of the var `{}` is no class of the catalogue", var.name));
            }
            if let Some(of) = var.key_of.as_ref().filter(|of| !names.contains(of.as_str())) {
                return Some(format!("the var `{}` is a key of `{of}`, which is no var before it", var.name));
            }
            if let Some(state) = var.state.iter().find(|state| !state.contains('=')) {
                return Some(format!("`{state}` of the var `{}` is no state; write KEY=VALUE", var.name));
            }
        }
        if self.goals.is_empty() {
            return Some("it has no goals".to_owned());
        }
        if !(1..=MOST_ROBOTS).contains(&self.robots) {
            return Some(format!("robots = {}: a mission has 1 to {MOST_ROBOTS}", self.robots));
        }
        for goal in self.goals.iter().flat_map(|goal| goal.split(" and ")) {
            let (of, state) = goal.split_once(' ').unwrap_or((goal, ""));
            if !state.contains('=') {
                return Some(format!("`{goal}` is no goal; write VAR KEY=VALUE"));
            }
            if !names.contains(of) && !of.trim_end_matches(':').ends_with('*') {
                return Some(format!("the goal `{goal}` is about `{of}`, which is no var of the type"));
            }
        }
        match self.steps {
            Some([fewest, most]) if fewest > most => Some(format!("steps from {fewest} to {most}: there are none")),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_builtin_specification_is_right() {
        let spec = Spec::builtin(&Catalog::builtin());
        assert_eq!(spec.types().count(), 24);
        let paper = Spec::of_the_paper(&Catalog::builtin());
        assert_eq!((paper.types().count(), paper.types().last()), (12, Some("toggleDevice")));
        assert_eq!(paper.only("fill&deliver", "OfficeLayout1").types().collect::<Vec<_>>(), ["fill&deliver"]);
    }

    #[test]
    fn what_is_wrong_is_named() {
        let catalog = Catalog::builtin();
        let kind = |text: &str| format!("[[type]]\nname = \"one\"\n{text}");
        for (text, expected) in [
            ("[[type]]", "missing field"),
            (&kind("vars = []\ngoals = []"), "it has no goals"),
            (&kind("vars = [{ name = \"a\", class = [\"Nix\"] }]\ngoals = [\"a isHot=true\"]"), "`Nix`"),
            (&kind("vars = []\ngoals = [\"b isHot=true\"]"), "is about `b`"),
            (&kind("vars = [{ name = \"a\" }]\ngoals = [\"a isHot\"]"), "is no goal"),
            ("type = []", "no type of missions"),
            ("[pools]\nblockers = 2.0\n[[type]]\nname = \"one\"\nvars = []\ngoals = []", "blockers is a share"),
            (&kind("robots = 9\nvars = []\ngoals = [\"a* isHot=true\"]"), "robots = 9"),
        ] {
            let error = Spec::parse("spec.toml", text, &catalog).unwrap_err().to_string();
            assert!(error.contains(expected) && error.starts_with("spec.toml"), "{error}");
        }
    }
}
