//! The table of actions and devices: what each needs, what it changes, how it is refused; as data, checked once.
//!
//! Whoever has to know what can be done reads it here: [`View`] evaluates it over any state that can answer for its
//! things, [`crate::symbolic`] predicts with it.

mod affords;
mod change;
mod condition;
mod faults;
mod file;
mod form;
mod kind;
mod listing;
mod view;

use std::collections::{BTreeMap, BTreeSet};

use serde::Deserialize;

pub use self::{
    change::{Change, Effect, GROWTH, SoundKind, UNDONE},
    condition::{ClassPattern, Condition, Content, Range, Term, Test},
    kind::ActionKind,
    listing::{ChangeForm, ConditionForm, Placeholder, change_forms, condition_forms, placeholders},
    view::{Judgement, Scope, View, takes},
};
use self::{
    condition::{Kinds, Test as T},
    file::Reader,
};
use crate::{action::Status, nearest::aside, state::StateFlag};

/// Something that must hold, and what is answered where it does not.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Need {
    /// One of these must hold.
    pub any: Vec<Condition>,
    /// The answer if none does.
    pub status: Status,
    /// The same for people, in the words of who acts; `{it}`, `{held}`, … stand for names.
    pub words: String,
}

impl Need {
    /// Whether it is about getting at the thing, not about the thing.
    #[must_use]
    pub fn is_of_access(&self) -> bool {
        self.any.iter().all(|condition| {
            let of_place = matches!(
                condition.test,
                T::Exists | T::Free | T::Uncovered | T::Within(_) | T::Accessible | T::BehindGlass
            );
            condition.term == Term::It && (of_place || condition.test == T::Is(StateFlag::Sparking))
        })
    }
}

/// One way of an action.
#[derive(Clone, Debug, PartialEq)]
pub struct Rule {
    /// What it is called.
    pub name: String,
    /// The action that it is of.
    pub action: ActionKind,
    /// When it is this rule that counts.
    pub when: Vec<Condition>,
    /// What people say for it.
    pub words: Vec<String>,
    /// What it needs, in order.
    pub needs: Vec<Need>,
    /// What it changes.
    pub effects: Vec<Effect>,
    /// What is said once it is done, in the words of who did it.
    pub done: String,
    /// What is to be said although it was done.
    pub but: Vec<Need>,
}

/// Where the work of a device is done.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, PartialEq)]
#[serde(rename_all = "snake_case")]
pub enum Site {
    /// In itself.
    #[default]
    It,
    /// In what it works.
    Machine,
    /// In what its machine aims at.
    Target,
}

/// A class of devices.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::struct_excessive_bools)]
pub struct Device {
    /// The classes.
    pub classes: Vec<String>,
    /// The classes that it works, where a floor plan does not say which object.
    pub works: Vec<String>,
    /// The classes that it aims at, the same.
    pub aims: Vec<String>,
    /// The classes that work it, if its own switch does not.
    pub worked_by: Vec<String>,
    /// What a press needs beyond the rule.
    pub needs: Vec<Need>,
    /// What a press changes beyond the rule.
    pub press: Vec<Effect>,
    /// The name of the work it does when it runs.
    pub work: Option<String>,
    /// Where it does that.
    pub at: Site,
    /// The name of the work it does while it is shut and has power.
    pub shut_work: Option<String>,
    /// Whether a press is answered although the class affords none.
    pub answers_always: bool,
    /// Whether it keeps its state when the power goes.
    pub stays_without_power: bool,
    /// Whether it is live, or frees a room of power.
    pub dangerous: bool,
    /// Whether it sounds like an alarm.
    pub alarm: bool,
    /// Whether its machine sounds like a ray.
    pub ray: bool,
    /// Whether the places of its last surface are slots behind glass.
    pub slots: bool,
    /// From the press to its work, s.
    pub work_s: f32,
    /// How long it is on, s.
    pub moment_s: f32,
}

impl Device {
    /// Whether it stays on when switched on.
    #[must_use]
    pub fn stays_on(&self) -> bool {
        self.presses(|change| matches!(change, Change::Flip(..)))
    }

    /// Whether a press has something run for a moment: it, or what it works.
    #[must_use]
    pub fn runs_for_a_moment(&self) -> bool {
        self.presses(|change| matches!(change, Change::Run(..)))
    }

    fn presses(&self, is_meant: impl FnMut(&Change) -> bool) -> bool {
        self.press.iter().flat_map(|effect| &effect.changes).any(is_meant)
    }
}

/// To which things a work is done.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq)]
#[serde(rename_all = "snake_case")]
pub enum Over {
    /// To all in it, at any depth.
    Contents,
    /// To what is directly in it.
    Inside,
    /// To the machine itself.
    Machine,
}

/// What a machine does.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Work {
    /// What it is called.
    pub name: String,
    /// To which things.
    pub over: Over,
    /// What it changes about each of them.
    pub effects: Vec<Effect>,
    /// What it changes about the machine, once and after them.
    pub then: Vec<Effect>,
}

impl Work {
    /// All that it changes, whatever holds.
    pub fn changes(&self) -> impl Iterator<Item = &Change> {
        self.effects.iter().chain(&self.then).flat_map(|effect| &effect.changes)
    }
}

/// Why a table could not be read.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// The text is not the TOML expected.
    #[error("{file}: {source}")]
    Syntax {
        /// Which file.
        file: String,
        /// Where and what.
        source: Box<toml::de::Error>,
    },
    /// A condition, a change or a name of shared needs does not exist.
    #[error("{file}: {reason}; `cohabit catalog conditions changes words` lists what there is")]
    Text {
        /// Which file.
        file: String,
        /// What is wrong.
        reason: String,
    },
    /// A press cannot change that: it sets, fills, paints, flips, runs, feeds, turns or swings.
    #[error("{file}: the device `{device}` changes on a press what no press can: {change:?}; make it a work")]
    NoPress {
        /// Which file.
        file: String,
        /// The first class of the device.
        device: String,
        /// The change.
        change: Change,
    },
    /// A device has a work, and no press of it has it run.
    #[error("{file}: no press of the device `{device}` begins its work `{work}`: write `press = [\"run it\"]`")]
    NotBegun {
        /// Which file.
        file: String,
        /// The first class of the device.
        device: String,
        /// The name of the work.
        work: String,
    },
    /// The work of a machine cannot change that: it has no hand, and presses nothing.
    #[error("{file}: the work `{work}` changes what no machine can: {change:?}; make it a rule or a press")]
    NotOfAWork {
        /// Which file.
        file: String,
        /// The name of the work.
        work: String,
        /// The change.
        change: Change,
    },
    /// It names a class that the catalogue does not have.
    #[error("{file}: `{class}` is no class of the catalogue{}", aside(.near))]
    NoClass {
        /// Which file.
        file: String,
        /// The id.
        class: String,
        /// The class that it may have been meant to be.
        near: Option<String>,
    },
    /// A device, or what gets power, does a work that no file has.
    #[error("{file}: `{device}` does `{work}`, which no work is called")]
    NoWork {
        /// Which file.
        file: String,
        /// The first class of the device, or `power_work`.
        device: String,
        /// The name.
        work: String,
    },
}

/// The kind of what water runs in.
const BASIN: &str = "basin";

/// All rules, devices, works and recipes.
#[derive(Clone, Debug)]
pub struct ActionTable {
    rules: Vec<Rule>,
    devices: Vec<Device>,
    device_by_class: BTreeMap<String, usize>,
    works: Vec<Work>,
    plain: Device,
    kinds: Kinds,
    power_work: Option<String>,
    slice: BTreeMap<String, String>,
    prints: BTreeMap<String, String>,
    yesterday: BTreeMap<String, String>,
}

/// An empty table: nothing can be done, and what is switched flips.
impl Default for ActionTable {
    fn default() -> Self {
        let flip = Effect { when: Vec::new(), changes: vec![Change::Flip(Term::It, None)] };
        let plain = Device {
            classes: Vec::new(),
            works: Vec::new(),
            aims: Vec::new(),
            worked_by: Vec::new(),
            needs: Vec::new(),
            press: vec![flip],
            work: None,
            at: Site::It,
            shut_work: None,
            answers_always: false,
            stays_without_power: false,
            dangerous: false,
            alarm: false,
            ray: false,
            slots: false,
            work_s: 0.0,
            moment_s: 0.0,
        };
        Self {
            rules: Vec::new(),
            devices: Vec::new(),
            device_by_class: BTreeMap::new(),
            works: Vec::new(),
            plain,
            kinds: Kinds::new(),
            power_work: None,
            slice: BTreeMap::new(),
            prints: BTreeMap::new(),
            yesterday: BTreeMap::new(),
        }
    }
}

impl ActionTable {
    /// Reads a table from `(file name, text)`, and says all that is wrong in it; `is_class` says which classes there are, and
    /// which classes begin as it says before a `*`. A later file's device takes the place of an earlier one of the same class.
    pub fn gather(files: &[(&str, &str)], is_class: &dyn Fn(&str) -> bool) -> (Self, Vec<TableError>) {
        let (mut table, mut errors, mut read) = (Self::default(), Vec::new(), Vec::new());
        for (file, text) in files {
            match file::read(file, text) {
                Ok(one) => read.push((*file, one)),
                Err(error) => errors.push(error),
            }
        }
        let times = read.iter().find_map(|(_, file)| file.times);
        let times = times.unwrap_or(file::Times { work_s: 0.25, moment_s: 2.0 });
        (table.plain.work_s, table.plain.moment_s) = (times.work_s, times.moment_s);
        let works: BTreeSet<&str> = read.iter().flat_map(|(_, file)| file.work_names()).collect();
        let mut kinds = Kinds::new();
        for (kind, classes) in read.iter().flat_map(|(_, file)| &file.kinds) {
            kinds.entry(kind.clone()).or_default().extend(classes.iter().cloned());
        }
        for (file, read) in &read {
            let part = Self::of_file(&Reader { file, times, kinds: &kinds }, read, &mut errors);
            errors.extend(part.faults(file, is_class, &works));
            table.add(part);
        }
        table.kinds = kinds;
        (table, errors)
    }

    /// What one file says.
    fn of_file(reader: &Reader<'_>, read: &file::TableFile, errors: &mut Vec<TableError>) -> Self {
        Self {
            rules: reader.rules(read, errors),
            works: reader.works(read, errors),
            devices: reader.devices(read, errors),
            kinds: read.kinds.clone(),
            power_work: read.power_work.clone(),
            slice: read.slice.clone(),
            prints: read.prints.clone(),
            yesterday: read.yesterday.clone(),
            ..Self::default()
        }
    }

    /// Adds what a later file says.
    fn add(&mut self, part: Self) {
        self.rules.extend(part.rules);
        self.works.extend(part.works);
        for device in part.devices {
            for class in &device.classes {
                self.device_by_class.insert(class.clone(), self.devices.len());
            }
            self.devices.push(device);
        }
        self.power_work = part.power_work.or(self.power_work.take());
        self.slice.extend(part.slice);
        self.prints.extend(part.prints);
        self.yesterday.extend(part.yesterday);
    }

    /// All rules, in the order in which they are tried.
    #[must_use]
    pub fn rules(&self) -> &[Rule] {
        &self.rules
    }

    /// All devices.
    #[must_use]
    pub fn devices(&self) -> &[Device] {
        &self.devices
    }

    /// The device of a class; one that flips, if no entry has it.
    #[must_use]
    pub fn device(&self, class: &str) -> &Device {
        self.device_by_class.get(class).map_or(&self.plain, |index| &self.devices[*index])
    }

    /// Whether a class has an entry of its own.
    #[must_use]
    pub fn is_device(&self, class: &str) -> bool {
        self.device_by_class.contains_key(class)
    }

    /// The work of that name.
    #[must_use]
    pub fn work(&self, name: &str) -> Option<&Work> {
        self.works.iter().find(|work| work.name == name)
    }

    /// All works.
    #[must_use]
    pub fn works(&self) -> &[Work] {
        &self.works
    }

    /// The classes of a kind, in the order in which they are named.
    #[must_use]
    pub fn kind(&self, kind: &str) -> &[String] {
        self.kinds.get(kind).map_or(&[], Vec::as_slice)
    }

    /// Whether a class is of a kind.
    #[must_use]
    pub fn is_of_kind(&self, kind: &str, class: &str) -> bool {
        self.kind(kind).iter().any(|one| one == class)
    }

    /// Whether water runs in things of a class: what the term `basin` means.
    #[must_use]
    pub fn is_basin(&self, class: &str) -> bool {
        self.is_of_kind(BASIN, class)
    }

    /// The name of the work that is done to each thing as power comes to it.
    #[must_use]
    pub fn power_work(&self) -> Option<&str> {
        self.power_work.as_deref()
    }

    /// The class of what comes off when that class is cut.
    #[must_use]
    pub fn slice(&self, class: &str) -> Option<&str> {
        self.slice.get(class).map(String::as_str)
    }

    /// The class that a cartridge of that class prints by itself; none for what is no cartridge.
    #[must_use]
    pub fn prints(&self, class: &str) -> Option<&str> {
        self.prints.get(class).map(String::as_str)
    }

    /// The class that things of that class were of yesterday.
    #[must_use]
    pub fn yesterday(&self, class: &str) -> Option<&str> {
        self.yesterday.get(class).map(String::as_str)
    }

    /// Cartridges, with what they print.
    pub fn cartridges(&self) -> impl Iterator<Item = (&str, &str)> {
        self.prints.iter().map(|(from, to)| (from.as_str(), to.as_str()))
    }
}
