//! What it takes to heat, cool, clean, repair and so on: what the language needs of the table of actions and devices, with class names
//! resolved.

use std::sync::Arc;

use cohabit_cdf::{
    ActionKind, ActionTable, Catalog, ClassId, Fluid, Property,
    state::StateFlag,
    table::{Change, Device, Effect, Rule, Site, Term, Test, Work},
};
use serde::Deserialize;

use crate::{known::uses::Uses, words::intent::Intent};

/// One way to get something done.
#[derive(Clone, Debug)]
pub(crate) struct Process {
    pub(crate) intent: Intent,
    /// Where the object goes.
    pub(crate) at: Vec<ClassId>,
    /// Other things by which people name that.
    pub(crate) also: Vec<ClassId>,
    /// What sets it off; the place itself, or what a colour chooses, if this is empty.
    pub(crate) start: Vec<ClassId>,
    pub(crate) steps: Vec<Act>,
    pub(crate) fluid: Option<Fluid>,
    pub(crate) object: Vec<ClassId>,
}

/// What a step of a process does.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
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
    /// The table that all of it is taken from.
    pub(crate) catalog: Arc<Catalog>,
    pub(crate) processes: Vec<Process>,
    /// The names of colours, and what gives them.
    buttons: Vec<(String, ClassId)>,
    cartridges: Vec<(ClassId, ClassId)>,
    shut_to_run: Vec<ClassId>,
    stays_on: Vec<ClassId>,
    /// Those of the others that have a screen, which is lit while they have power.
    is_lit: Vec<ClassId>,
    worked: Vec<(ClassId, Vec<ClassId>)>,
    pub(crate) hammers: Vec<ClassId>,
    pub(crate) knives: Vec<ClassId>,
    pub(crate) bins: Vec<ClassId>,
    /// What feeds and cuts circuits.
    pub(crate) levers: Vec<ClassId>,
    /// What machines turn other things into.
    pub(crate) made: Vec<ClassId>,
    pub(crate) uses: Uses,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    way: Vec<WayEntry>,
}

/// What is asked for, and one of `work`, `makes`, `action` and `kept_in`: how it comes about.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WayEntry {
    intent: Intent,
    #[serde(default)]
    work: Option<String>,
    #[serde(default)]
    makes: Option<String>,
    #[serde(default)]
    action: Option<ActionKind>,
    #[serde(default)]
    kept_in: Vec<String>,
    #[serde(default)]
    leaves: bool,
    #[serde(default)]
    object: Vec<String>,
}

impl Devices {
    /// What the catalogue's table says, and the built-in ways to what people ask for.
    pub(crate) fn new(catalog: &Arc<Catalog>) -> Self {
        let file: File = toml::from_str(include_str!("../../data/processes.toml"))
            .expect("invariant: the built-in table parses, the tests load it");
        let table = catalog.table();
        let known = |ids: &[String]| of_ids(catalog, ids);
        let of_class = |fits: &dyn Fn(ClassId, &Device) -> bool| -> Vec<ClassId> {
            let classes = (0..).map(ClassId).zip(catalog.classes());
            classes.filter(|(id, class)| fits(*id, table.device(&class.id))).map(|(id, _)| id).collect()
        };
        let of_kind = |kind: &str| of_class(&|class, _| table.is_of_kind(kind, &catalog.class(class).id));
        let has = |class: ClassId, property| catalog.class(class).has(property);
        let named: Vec<&str> = file.way.iter().filter_map(|way| way.work.as_deref()).collect();
        let feeds = |device: &Device| pressed(device).any(|change| matches!(change, Change::Feed(..)));
        let made = table.works().iter().flat_map(Work::changes).filter_map(|change| match change {
            Change::Become(_, class) => catalog.find(class),
            _ => None,
        });
        Self {
            processes: file.way.iter().flat_map(|way| way.processes(catalog, &named)).collect(),
            buttons: buttons(table).filter_map(|(color, class)| Some((color, catalog.find(class)?))).collect(),
            cartridges: table
                .cartridges()
                .filter_map(|(cartridge, prints)| Some((catalog.find(cartridge)?, catalog.find(prints)?)))
                .collect(),
            shut_to_run: of_class(&|class, device| has(class, Property::Openable) && works_in_itself(device)),
            stays_on: of_class(&|_, device| device.stays_on()),
            is_lit: of_class(&|class, device| {
                has(class, Property::Powerable) && !device.works.is_empty() && !device.stays_on()
            }),
            worked: table
                .devices()
                .iter()
                .filter(|device| !device.worked_by.is_empty())
                .flat_map(|device| known(&device.classes).into_iter().map(|class| (class, known(&device.worked_by))))
                .collect(),
            hammers: of_kind("hammer"),
            knives: of_kind("knife"),
            bins: known(table.kind("bin")),
            levers: of_class(&|_, device| feeds(device)),
            made: made.collect(),
            uses: Uses::new(catalog),
            catalog: Arc::clone(catalog),
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

impl WayEntry {
    /// One process for each place where it is done; `named` are the works that ways name.
    fn processes(&self, catalog: &Catalog, named: &[&str]) -> Vec<Process> {
        let table = catalog.table();
        if let Some(action) = self.action {
            let rules = table.rules().iter().filter(|rule| rule.action == action);
            return rules.filter_map(|rule| self.by_rule(catalog, rule)).collect();
        }
        if !self.kept_in.is_empty() {
            let steps = vec![Act::Hold, Act::Open, Act::Place, Act::Close];
            return vec![self.process(of_ids(catalog, &self.kept_in), [Vec::new(), Vec::new()], steps, None, catalog)];
        }
        let makes = self.makes.as_ref().map(|text| {
            let change = text.parse::<Change>();
            change.expect("invariant: the built-in table parses, the tests load it")
        });
        let is_meant = |name: &str| {
            let kind = name.split(' ').next().unwrap_or(name);
            let does = |change: &Change| table.work(name).is_some_and(|work| work.changes().any(|one| one == change));
            self.work.as_deref() == Some(kind) || (!named.contains(&kind) && makes.as_ref().is_some_and(does))
        };
        let mut doers: Vec<&Device> = table.devices().iter().filter(|device| works_of(device).any(is_meant)).collect();
        doers.sort_by_key(|device| device.at != Site::It);
        self.by_devices(catalog, &doers)
    }

    /// What a rule does with what is held, at things of the class that it names.
    fn by_rule(&self, catalog: &Catalog, rule: &Rule) -> Option<Process> {
        let places = rule.when.iter().find_map(|condition| match &condition.test {
            Test::IsA(pattern) if condition.term == Term::It && !condition.negated => Some(of_ids(catalog, &pattern.0)),
            _ => None,
        })?;
        let act = match rule.action {
            ActionKind::Fill => Act::Fill,
            ActionKind::Clean => Act::Clean,
            _ => return None,
        };
        let is_on = |test: &Test| *test == Test::Is(StateFlag::Toggled);
        let conditions = || rule.needs.iter().flat_map(|need| &need.any);
        let runs = conditions().any(|one| one.term == Term::It && !one.negated && is_on(&one.test));
        let steps = [Act::Hold].into_iter().chain(runs.then_some(Act::Run)).chain([act]).collect();
        let fluid = changes(&rule.effects).find_map(fluid_of);
        Some(self.process(places, [Vec::new(), Vec::new()], steps, fluid, catalog))
    }

    fn by_devices(&self, catalog: &Catalog, doers: &[&Device]) -> Vec<Process> {
        let table = catalog.table();
        let mut processes: Vec<Process> = Vec::new();
        for device in doers {
            let at = of_ids(catalog, &places(table, device));
            let (machines, classes) = (of_ids(catalog, &device.works), of_ids(catalog, &device.classes));
            if let Some(other) = processes.iter_mut().find(|process| process.at == at) {
                // Which of several sets it off is to be said.
                (other.also, other.start) = (Vec::new(), Vec::new());
                continue;
            }
            let by = match device.at {
                Site::It => [Vec::new(), Vec::new()],
                Site::Machine => [classes.clone(), classes],
                Site::Target => [[machines, classes.clone()].concat(), classes],
            };
            let is_openable = at.iter().any(|class| catalog.class(*class).has(Property::Openable));
            let mut works = works_of(device).filter_map(|name| table.work(name));
            let fluid = works.find_map(|work| work.changes().find_map(fluid_of));
            processes.push(self.process(at, by, self.steps_at(device, is_openable), fluid, catalog));
        }
        processes
    }

    fn steps_at(&self, device: &Device, is_openable: bool) -> Vec<Act> {
        let mut steps = vec![Act::Hold];
        steps.extend(is_openable.then_some(Act::Open));
        steps.push(Act::Place);
        steps.extend(is_openable.then_some(Act::Close));
        steps.extend(device.work.is_some().then_some(Act::Start));
        if !self.leaves {
            steps.extend(is_openable.then_some(Act::Open));
            steps.push(Act::Take);
        }
        steps
    }

    fn process(
        &self,
        at: Vec<ClassId>,
        [also, start]: [Vec<ClassId>; 2],
        steps: Vec<Act>,
        fluid: Option<Fluid>,
        catalog: &Catalog,
    ) -> Process {
        // With what counts where it is asked for to be filled.
        let fluid = fluid.filter(|_| self.intent == Intent::Fill);
        Process { intent: self.intent, at, also, start, steps, fluid, object: of_ids(catalog, &self.object) }
    }
}

fn of_ids(catalog: &Catalog, ids: &[String]) -> Vec<ClassId> {
    ids.iter().filter_map(|id| catalog.find(id)).collect()
}

/// The names of the works that a device does; `paint red` is a kind of `paint`.
fn works_of(device: &Device) -> impl Iterator<Item = &str> {
    device.work.iter().chain(&device.shut_work).map(String::as_str)
}

fn changes(effects: &[Effect]) -> impl Iterator<Item = &Change> {
    effects.iter().flat_map(|effect| &effect.changes)
}

fn pressed(device: &Device) -> impl Iterator<Item = &Change> {
    changes(&device.press)
}

/// What a change fills something with.
fn fluid_of(change: &Change) -> Option<Fluid> {
    match change {
        Change::Fill(_, fluid) if *fluid != Fluid::None => Some(*fluid),
        _ => None,
    }
}

/// The classes in or on which a device does its work.
fn places(table: &ActionTable, device: &Device) -> Vec<String> {
    match device.at {
        Site::It => device.classes.clone(),
        Site::Machine => device.works.clone(),
        Site::Target => device.works.iter().flat_map(|machine| table.device(machine).aims.clone()).collect(),
    }
}

fn works_in_itself(device: &Device) -> bool {
    device.work.is_some() && device.at == Site::It
}

/// The names of colours, and the classes that paint what is in their machine so.
fn buttons(table: &ActionTable) -> impl Iterator<Item = (String, &str)> {
    table.devices().iter().flat_map(|device| {
        let work = device.work.as_ref().and_then(|work| table.work(work));
        let colors = work.into_iter().flat_map(Work::changes).filter_map(|change| match change {
            Change::Paint(_, color) => Some(color.name().to_lowercase()),
            _ => None,
        });
        colors.flat_map(|color| device.classes.iter().map(move |class| (color.clone(), class.as_str())))
    })
}
