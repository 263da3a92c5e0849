//! What machines do to what is in them, once they work, by the works of the table.
//!
//! A machine that works for a moment is on first, and only then changes its contents: goals that ask for both the
//! machine on and the thing in it must be able to see that.

pub(crate) mod lab;
pub(crate) mod portal;
mod recipes;
pub(crate) mod vending;

use cohabit_cdf::{
    ActionTable, Catalog, ClassId, Color, ObjectId,
    catalog::table::{Device, Over, Scope, Work as Entry},
};
use serde::{Deserialize, Serialize};

pub(crate) use self::vending::{behind_glass, is_slot, vended};
use crate::{
    effect::Effect,
    facts::Facts,
    power::lacks_power,
    rules::{Observer, effects_of},
};

const TICKS_A_SECOND: f32 = 60.0;

/// Ticks from the start of a machine to its effect, and to its end.
pub(crate) fn ticks(device: &Device) -> [u64; 2] {
    [device.work_s, device.moment_s].map(|seconds| (seconds * TICKS_A_SECOND).round() as u64)
}

/// Which work a machine does, as snapshots and digests write it down. What it changes is the table's to say, by its name.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub(crate) enum Work {
    /// None: it is on, and that is all.
    Nothing,
    Heat,
    Toast,
    Chill,
    Yesterday,
    Carrot,
    Print,
    Brew,
    Unbrew,
    Paint(Color),
    Embiggen,
    /// `vend` of the slot of this number.
    Vend(u16),
    /// The work of this number in the table, which is none of those above.
    Listed(u16),
}

impl Work {
    /// The names of those that have a number of their own.
    const NAMES: [(Self, &'static str); 12] = [
        (Self::Heat, "heat"),
        (Self::Toast, "toast"),
        (Self::Chill, "chill"),
        (Self::Yesterday, "yesterday"),
        (Self::Carrot, "carrot"),
        (Self::Print, "print"),
        (Self::Brew, "brew"),
        (Self::Unbrew, "unbrew"),
        (Self::Paint(Color::Red), "paint red"),
        (Self::Paint(Color::Green), "paint green"),
        (Self::Paint(Color::Blue), "paint blue"),
        (Self::Embiggen, "embiggen"),
    ];

    /// The work of that name in the table.
    pub fn named(catalog: &Catalog, name: &str) -> Self {
        let known = Self::NAMES.iter().find(|(_, known)| *known == name).map(|(work, _)| *work);
        let slot = || name.strip_prefix("vend ").and_then(|slot| slot.parse().ok()).map(Self::Vend);
        let listed = || {
            let index = catalog.table().works().iter().position(|work| work.name == name)?;
            u16::try_from(index).ok().map(Self::Listed)
        };
        known.or_else(slot).or_else(listed).unwrap_or(Self::Nothing)
    }

    /// Its entry in the table.
    fn entry(self, table: &ActionTable) -> Option<&Entry> {
        match self {
            Self::Nothing => None,
            Self::Vend(slot) => table.work(&format!("vend {slot}")),
            Self::Listed(index) => table.works().get(usize::from(index)),
            _ => Self::NAMES.iter().find(|(work, _)| *work == self).and_then(|(_, name)| table.work(name)),
        }
    }
}

/// A machine at work for a moment.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct Run {
    /// The tick in which it came on.
    pub since: u64,
    pub work: Work,
    /// Where the work is done: the machine itself, or what it is aimed at.
    pub site: ObjectId,
    /// What is on for as long.
    pub drives: Option<ObjectId>,
}

/// What `work` changes at `site`, once `machine` was pressed for it.
pub(crate) fn effects(facts: &Facts<'_>, machine: ObjectId, work: Work, site: ObjectId) -> Vec<Effect> {
    let entry = work.entry(facts.catalog.table());
    entry.map_or_else(Vec::new, |entry| effects_at(facts, entry, machine, site))
}

/// What a work of the table changes at `site`; `by` is what was pressed for it.
fn effects_at(facts: &Facts<'_>, work: &Entry, by: ObjectId, site: ObjectId) -> Vec<Effect> {
    let observer = Observer { facts, body: None };
    let things = match work.over {
        Over::Contents => facts.contents(site),
        Over::Inside => facts.held_in(site),
        Over::Machine => vec![site],
    };
    let each = things.into_iter().map(|thing| (Some(thing), &work.effects));
    let all = each.chain([(None, &work.then)]).flat_map(|(thing, effects)| {
        let scope = Scope { it: Some(by), thing, machine: Some(site) };
        effects_of(&observer, &scope, &scope.changes(&observer, effects))
    });
    all.collect()
}

/// What something does to its contents once it is shut, or about to be, and has power.
pub(crate) fn settle(facts: &Facts<'_>, id: ObjectId) -> Vec<Effect> {
    match &facts.catalog.table().device(&facts.class(id).id).shut_work {
        Some(work) if !lacks_power(facts, id) => effects(facts, id, Work::named(facts.catalog, work), id),
        _ => Vec::new(),
    }
}

/// What follows once a circuit is fed again: what is shut does its work, and what is done as power comes is done.
pub(crate) fn on_power(facts: &Facts<'_>, circuit: i32) -> Vec<Effect> {
    let fed = facts.state.existing().filter(|(_, object)| object.circuit == Some(circuit)).map(|(id, _)| id);
    fed.flat_map(|id| {
        let settled = if facts.is_shut(id) { settle(facts, id) } else { Vec::new() };
        settled.into_iter().chain(powered(facts, id))
    })
    .collect()
}

/// What is done to a thing as power comes to it.
pub(crate) fn powered(facts: &Facts<'_>, id: ObjectId) -> Vec<Effect> {
    let table = facts.catalog.table();
    let work = table.power_work().and_then(|work| table.work(work));
    work.map_or_else(Vec::new, |work| effects_at(facts, work, id, id))
}

/// The first free instance id of a class.
fn free_instance(facts: &Facts<'_>, class: &str) -> String {
    numbered(facts, class)
}

/// The id of the next thing of a class that a machine makes.
fn product_instance(facts: &Facts<'_>, machine: ObjectId, class: ClassId) -> String {
    numbered(facts, &format!("{}_Spawned_{}", facts.object(machine).instance, facts.catalog.class(class).id))
}

/// `stem_1`, or the next number that nothing ever had.
fn numbered(facts: &Facts<'_>, stem: &str) -> String {
    (1_u32..)
        .map(|number| format!("{stem}_{number}"))
        .find(|instance| !facts.state.objects.iter().any(|object| object.is_called(instance)))
        .expect("invariant: fewer objects than numbers")
}
