//! What it takes to heat, cool, clean, repair and so on: the table of devices, with its class names resolved.

use cohabit_cdf::{Catalog, ClassId, Fluid};
use serde::Deserialize;

use crate::{facts::Uses, intent::Intent};

/// One way to get something done.
#[derive(Clone, Debug)]
pub(crate) struct Process {
    pub(crate) intent: Intent,
    pub(crate) at: Vec<ClassId>,
    pub(crate) also: Vec<ClassId>,
    pub(crate) start: Vec<ClassId>,
    pub(crate) steps: Vec<Act>,
    pub(crate) fluid: Option<Fluid>,
    pub(crate) object: Vec<ClassId>,
}

/// What a step of a process does.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Act {
    Hold,
    Open,
    Place,
    Close,
    Start,
    Run,
    Take,
    Fill,
    Clean,
}

/// All that is known of devices.
#[derive(Clone, Debug)]
pub(crate) struct Devices {
    pub(crate) processes: Vec<Process>,
    buttons: Vec<(String, ClassId)>,
    cartridges: Vec<(ClassId, ClassId)>,
    shut_to_run: Vec<ClassId>,
    stays_on: Vec<ClassId>,
    /// Those of the others that have a screen, which is lit while they have power.
    is_lit: Vec<ClassId>,
    worked: Vec<(ClassId, Vec<ClassId>)>,
    pub(crate) hammers: Vec<ClassId>,
    pub(crate) uses: Uses,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    process: Vec<ProcessEntry>,
    button: Vec<Button>,
    cartridge: Vec<Cartridge>,
    doors: Doors,
    running: Running,
    worked: Vec<Worked>,
    tools: Tools,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ProcessEntry {
    intent: Intent,
    at: Vec<String>,
    #[serde(default)]
    also: Vec<String>,
    #[serde(default)]
    start: Vec<String>,
    steps: Vec<Act>,
    #[serde(default)]
    fluid: Option<String>,
    #[serde(default)]
    object: Vec<String>,
}

#[derive(Deserialize)]
struct Button {
    color: String,
    class: String,
}

#[derive(Deserialize)]
struct Cartridge {
    class: String,
    prints: String,
}

#[derive(Deserialize)]
struct Doors {
    shut_to_run: Vec<String>,
}

#[derive(Deserialize)]
struct Running {
    stays_on: Vec<String>,
    lit: Vec<String>,
}

#[derive(Deserialize)]
struct Worked {
    class: String,
    by: Vec<String>,
}

#[derive(Deserialize)]
struct Tools {
    #[serde(rename = "break")]
    to_break: Vec<String>,
}

impl Devices {
    /// The built-in table, as far as the catalogue has its classes.
    pub(crate) fn new(catalog: &Catalog) -> Self {
        let file: File = toml::from_str(include_str!("../data/processes.toml"))
            .expect("invariant: the built-in table parses, the tests load it");
        let classes = |ids: &[String]| -> Vec<ClassId> { ids.iter().filter_map(|id| catalog.find(id)).collect() };
        let processes = file.process.iter().map(|entry| Process {
            intent: entry.intent,
            at: classes(&entry.at),
            also: classes(&entry.also),
            start: classes(&entry.start),
            steps: entry.steps.clone(),
            fluid: entry.fluid.as_deref().and_then(Fluid::from_name),
            object: classes(&entry.object),
        });
        Self {
            processes: processes.collect(),
            buttons: file
                .button
                .into_iter()
                .filter_map(|button| Some((button.color, catalog.find(&button.class)?)))
                .collect(),
            cartridges: file
                .cartridge
                .iter()
                .filter_map(|entry| Some((catalog.find(&entry.class)?, catalog.find(&entry.prints)?)))
                .collect(),
            shut_to_run: classes(&file.doors.shut_to_run),
            stays_on: classes(&file.running.stays_on),
            is_lit: classes(&file.running.lit),
            worked: file
                .worked
                .iter()
                .filter_map(|entry| Some((catalog.find(&entry.class)?, classes(&entry.by))))
                .collect(),
            hammers: classes(&file.tools.to_break),
            uses: Uses::new(catalog),
        }
    }

    /// The button of the colour changer for a colour.
    pub(crate) fn button(&self, color: &str) -> Option<ClassId> {
        self.buttons.iter().find(|(name, _)| name == color).map(|(_, class)| *class)
    }

    /// The classes of cartridges that print a class.
    pub(crate) fn cartridges(&self, prints: ClassId) -> impl Iterator<Item = ClassId> {
        self.cartridges.iter().filter(move |(_, printed)| *printed == prints).map(|(cartridge, _)| *cartridge)
    }

    /// Whether it runs only with its door shut.
    pub(crate) fn must_be_shut(&self, class: ClassId) -> bool {
        self.shut_to_run.contains(&class)
    }

    /// Whether its screen is lit although it runs for a moment only.
    pub(crate) fn is_lit(&self, class: ClassId) -> bool {
        self.is_lit.contains(&class)
    }

    /// Whether it stays on when switched on.
    pub(crate) fn stays_on(&self, class: ClassId) -> bool {
        self.stays_on.contains(&class)
    }

    /// The classes that work it, if it is worked by another object.
    pub(crate) fn workers(&self, class: ClassId) -> Option<&[ClassId]> {
        self.worked.iter().find(|(worked, _)| *worked == class).map(|(_, workers)| workers.as_slice())
    }

    /// The class that it works, if it works another.
    pub(crate) fn worked_by(&self, worker: ClassId) -> Option<ClassId> {
        self.worked.iter().find(|(_, workers)| workers.contains(&worker)).map(|(worked, _)| *worked)
    }

    /// What a cartridge prints.
    pub(crate) fn printed_by(&self, cartridge: ClassId) -> Option<ClassId> {
        self.cartridges.iter().find(|(class, _)| *class == cartridge).map(|(_, prints)| *prints)
    }
}
