//! What it takes to heat, cool, clean, repair and so on: what the language needs of the table of actions and devices, with class names
//! resolved.

use std::sync::Arc;

use cohabit_cdf::{
    ActionKind, ActionTable, Catalog, ClassId, Fluid, Property, Verb,
    state::StateFlag,
    table::{Change, Condition, Device, Effect, Over, Rule, Site, Term, Test, Work},
};
use serde::Deserialize;

use crate::{known::uses::Uses, words::intent::Intent};

/// One way to get something done.
#[derive(Clone, Debug)]
pub(crate) struct Process {
    pub(crate) intent: Intent,
    /// Where the object goes, or the tool; nowhere, if the bare hand does it.
    pub(crate) at: Vec<ClassId>,
    /// What it can be done to; to all, if this is empty.
    pub(crate) of: Vec<ClassId>,
    /// What it is made for, as a washing machine is for laundry.
    pub(crate) suits: Vec<ClassId>,
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
    /// Fills the object, if it is empty, and puts it back.
    FillFirst,
    /// Takes the tool in the hand.
    Tool,
    /// Takes something with this in it in the hand.
    Vessel(Fluid),
    /// Does this to the object.
    Do(Verb),
    /// Turns the tool off.
    Rest,
    /// Turns off what ran for it alone.
    RunNoMore,
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
    /// What is made for carrying water to something.
    pub(crate) watering_cans: Vec<ClassId>,
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

/// What is asked for, and one of `work`, `makes`, `action`, `by_hand` and `kept_in`: how it comes about.
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
    by_hand: Option<String>,
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
            watering_cans: known(table.kind("watering_can")),
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
        if let Some(text) = &self.by_hand {
            let change = read(text);
            return table.rules().iter().filter_map(|rule| self.by_hand(catalog, rule, &change)).collect();
        }
        if !self.kept_in.is_empty() {
            let steps = vec![Act::Hold, Act::Open, Act::Place, Act::Close];
            return vec![self.process(of_ids(catalog, &self.kept_in), [Vec::new(), Vec::new()], steps, None, catalog)];
        }
        let makes = self.makes.as_deref().map(read);
        let is_meant = |name: &str| {
            let kind = name.split(' ').next().unwrap_or(name);
            let does = |change: &Change| table.work(name).is_some_and(|work| work.changes().any(|one| one == change));
            self.work.as_deref() == Some(kind) || (!named.contains(&kind) && makes.as_ref().is_some_and(does))
        };
        let mut doers: Vec<&Device> = table.devices().iter().filter(|device| works_of(device).any(is_meant)).collect();
        doers.sort_by_key(|device| device.at != Site::It);
        self.by_devices(catalog, &doers, makes.as_ref())
    }

    /// What a rule does with whatever is held, at things of the class that it names.
    fn by_rule(&self, catalog: &Catalog, rule: &Rule) -> Option<Process> {
        let places = named(catalog, rule, Term::It).filter(|places| !places.is_empty())?;
        if named(catalog, rule, Term::Held).is_some() {
            return None;
        }
        let act = match rule.action {
            ActionKind::Fill => Act::Fill,
            ActionKind::Clean => Act::Clean,
            _ => return None,
        };
        let runs = has_to_run(rule, Term::It);
        let run = |act| runs.then_some(act);
        let steps = [Act::Hold].into_iter().chain(run(Act::Run)).chain([act]).chain(run(Act::RunNoMore)).collect();
        let fluid = changes(&rule.effects).find_map(fluid_of);
        Some(self.process(places, [Vec::new(), Vec::new()], steps, fluid, catalog))
    }

    /// What a hand does by a rule that makes `change`, to what the rule names: to what is held at a place, or to `it` with a tool.
    fn by_hand(&self, catalog: &Catalog, rule: &Rule, change: &Change) -> Option<Process> {
        let Change::Set(_, flag, value) = *change else { return None };
        let does = |term| {
            let always = rule.effects.iter().filter(|effect| effect.when.is_empty());
            always.flat_map(|effect| &effect.changes).any(|one| *one == Change::Set(term, flag, value))
        };
        let (it, held) = (named(catalog, rule, Term::It)?, named(catalog, rule, Term::Held));
        if it.is_empty() || held.as_ref().is_some_and(Vec::is_empty) {
            return None;
        }
        if does(Term::Held) && rule.action == ActionKind::Place {
            let process = self.process(it, [Vec::new(), Vec::new()], vec![Act::Hold, Act::Place], None, catalog);
            return Some(Process { of: held.unwrap_or_default(), ..process });
        }
        let verb = rule.action.verb().filter(|_| does(Term::It))?;
        let runs = has_to_run(rule, Term::Held);
        let with = held.as_ref().map(|_| Act::Tool).or_else(|| holds(rule, Term::Held).map(Act::Vessel));
        let runs_for = |act: Act| runs.then_some(act);
        let steps =
            with.into_iter().chain(runs_for(Act::Run)).chain([Act::Do(verb)]).chain(runs_for(Act::Rest)).collect();
        let process = self.process(held.unwrap_or_default(), [Vec::new(), Vec::new()], steps, None, catalog);
        Some(Process { of: it, ..process })
    }

    /// What a device does to what is in itself, as a kettle boils its water.
    fn in_itself(&self, catalog: &Catalog, device: &Device) -> Process {
        let is_filled = |one: &Condition| one.term == Term::It && !one.negated && one.test == Test::Filled;
        let fills = device.needs.iter().flat_map(|need| &need.any).any(is_filled);
        let steps = fills.then_some(Act::FillFirst).into_iter().chain([Act::Start]).collect();
        let process = self.process(Vec::new(), [Vec::new(), Vec::new()], steps, None, catalog);
        Process { of: of_ids(catalog, &device.classes), ..process }
    }

    fn by_devices(&self, catalog: &Catalog, doers: &[&Device], makes: Option<&Change>) -> Vec<Process> {
        let table = catalog.table();
        let mut processes: Vec<Process> = Vec::new();
        // What the catalogue lacks does nothing.
        let is_there = |device: &&&Device| !of_ids(catalog, &device.classes).is_empty();
        for device in doers.iter().filter(is_there) {
            let works: Vec<&Work> = works_of(device).filter_map(|name| table.work(name)).collect();
            if makes.is_some() && works.iter().any(|work| work.over == Over::Machine) {
                processes.push(self.in_itself(catalog, device));
                continue;
            }
            let at = of_ids(catalog, &places(table, device));
            if at.is_empty() {
                continue;
            }
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
            let fluid = works.iter().find_map(|work| work.changes().find_map(fluid_of));
            let process = self.process(at, by, self.steps_at(device, is_openable), fluid, catalog);
            let effects: Vec<&Effect> = works.iter().flat_map(|work| &work.effects).collect();
            let makes_it = |effect: &&&Effect| makes.is_some_and(|change| effect.changes.contains(change));
            let of = classes_of_all(catalog, effects.iter().filter(makes_it).copied());
            let suits = effects.iter().filter_map(|effect| thing_of(catalog, effect)).flatten().collect();
            processes.push(Process { of, suits, ..process });
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
        let object = of_ids(catalog, &self.object);
        Process { intent: self.intent, at, of: Vec::new(), suits: Vec::new(), also, start, steps, fluid, object }
    }
}

/// A change that the built-in table names.
fn read(text: &str) -> Change {
    text.parse().expect("invariant: the built-in table parses, the tests load it")
}

/// The classes that a rule is for alone.
fn named(catalog: &Catalog, rule: &Rule, term: Term) -> Option<Vec<ClassId>> {
    class_of(catalog, &rule.when, term)
}

/// The classes of things that an effect comes to alone.
fn thing_of(catalog: &Catalog, effect: &Effect) -> Option<Vec<ClassId>> {
    class_of(catalog, &effect.when, Term::Thing)
}

/// The classes to which effects come; none in particular, if one of them comes to all.
fn classes_of_all<'e>(catalog: &Catalog, mut effects: impl Iterator<Item = &'e Effect>) -> Vec<ClassId> {
    let classes = effects.try_fold(Vec::new(), |mut all, effect| {
        all.extend(thing_of(catalog, effect)?);
        Some(all)
    });
    classes.unwrap_or_default()
}

/// Those of them that the catalogue has.
fn class_of(catalog: &Catalog, conditions: &[Condition], term: Term) -> Option<Vec<ClassId>> {
    conditions.iter().find_map(|condition| match &condition.test {
        Test::IsA(pattern) if condition.term == term && !condition.negated => Some(of_ids(catalog, &pattern.0)),
        _ => None,
    })
}

/// What has to be in it for a rule to count.
fn holds(rule: &Rule, term: Term) -> Option<Fluid> {
    rule.when.iter().find_map(|condition| match condition.test {
        Test::Holds(fluid) if condition.term == term && !condition.negated => Some(fluid),
        _ => None,
    })
}

/// Whether a rule needs this to be switched on.
fn has_to_run(rule: &Rule, term: Term) -> bool {
    let mut conditions = rule.needs.iter().flat_map(|need| &need.any);
    conditions.any(|one| one.term == term && !one.negated && one.test == Test::Is(StateFlag::Toggled))
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
