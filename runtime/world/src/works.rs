//! What machines do to what is in them, once they work.
//!
//! A machine that works for a moment is on first, and only then changes its contents: goals that ask for both the
//! machine on and the thing in it must be able to see that.

pub(crate) mod disk;
mod kitchen;
mod lab;
pub(crate) mod portal;
mod recipes;
mod vending;

use cohabit_cdf::{
    ClassId, ObjectId,
    catalog::table::{Change, Over, Scope, View},
};

pub use self::lab::EMBIGGEN;
pub(crate) use self::{
    kitchen::is_beans,
    vending::{behind_glass, is_slot, vended},
};
use crate::{
    anchors::fitting_anchors,
    effect::{Effect, Spot},
    facts::Facts,
    power::lacks_power,
    run::Work,
};

/// What `work` changes at `site`, done by `machine`; `view` is how the table finds the world.
pub(crate) fn effects(
    facts: &Facts<'_>,
    view: &impl View,
    machine: ObjectId,
    work: Work,
    site: ObjectId,
) -> Vec<Effect> {
    let all = |change: fn(&Facts<'_>, ObjectId) -> Vec<Effect>| {
        facts.contents(site).into_iter().flat_map(|id| change(facts, id)).collect()
    };
    let direct = || facts.held_in(site).into_iter();
    match work {
        Work::Nothing => Vec::new(),
        Work::Heat => all(kitchen::heat),
        Work::Toast => all(kitchen::toast),
        Work::Chill => all(kitchen::chill),
        Work::Yesterday => direct()
            .flat_map(|id| lab::yesterday(facts, id, Spot::Anchor { parent: site, anchor: lab::anchor_of(facts, id) }))
            .collect(),
        Work::Carrot => direct().flat_map(|id| lab::carrot(facts, site, id)).collect(),
        Work::Print => lab::print(facts, site),
        Work::Brew => kitchen::brew(facts, site),
        Work::Unbrew => kitchen::unbrew(facts, site),
        Work::Paint(color) => direct().map(|id| Effect::Paint(id, color)).collect(),
        Work::Embiggen => direct().flat_map(|id| lab::embiggen(facts, id)).collect(),
        Work::Vend(slot) => vending::vend(facts, machine, site, slot),
        Work::Listed(index) => listed(facts, view, index, site),
    }
}

/// What a work that the table alone knows changes at `site`.
fn listed(facts: &Facts<'_>, view: &impl View, index: u16, site: ObjectId) -> Vec<Effect> {
    let Some(work) = facts.catalog.table().works().get(usize::from(index)) else { return Vec::new() };
    let things = match work.over {
        Over::Contents => facts.contents(site),
        Over::Inside => facts.held_in(site),
        Over::Machine => vec![site],
    };
    let change = |thing: ObjectId| {
        let scope = Scope { it: None, thing: Some(thing), machine: Some(site) };
        let changes = scope.changes(view, &work.effects);
        changes.into_iter().flat_map(move |change| thing_effects(facts, change, thing)).collect::<Vec<_>>()
    };
    things.into_iter().flat_map(change).collect()
}

/// What a change of the table does to a thing in a machine.
fn thing_effects(facts: &Facts<'_>, change: &Change, thing: ObjectId) -> Vec<Effect> {
    let spot =
        || facts.object(thing).parent().map(|parent| Spot::Anchor { parent, anchor: lab::anchor_of(facts, thing) });
    match change {
        Change::Set(_, flag, value) => vec![Effect::Set(thing, *flag, *value)],
        Change::Fill(_, fluid) => vec![Effect::Fill(thing, *fluid)],
        Change::Paint(_, color) => vec![Effect::Paint(thing, *color)],
        Change::Remove(_) => vec![Effect::Remove(thing)],
        Change::Resize(_) => lab::embiggen(facts, thing).to_vec(),
        Change::Restore(_) => spot().map_or_else(Vec::new, |spot| lab::yesterday(facts, thing, spot)),
        _ => Vec::new(),
    }
}

/// What something does to its contents once it is shut, or about to be, and has power.
pub(crate) fn settle(facts: &Facts<'_>, view: &impl View, id: ObjectId) -> Vec<Effect> {
    match &facts.catalog.table().device(&facts.class(id).id).shut_work {
        Some(work) if !lacks_power(facts, id) => effects(facts, view, id, Work::named(facts.catalog, work), id),
        _ => Vec::new(),
    }
}

/// What follows once a circuit is fed again: what is shut does its work, computers read the disks that are in them.
pub(crate) fn on_power(facts: &Facts<'_>, view: &impl View, circuit: i32) -> Vec<Effect> {
    let fed = facts.state.existing().filter(|(_, object)| object.circuit == Some(circuit)).map(|(id, _)| id);
    fed.flat_map(|id| {
        let settled = if facts.is_shut(id) { settle(facts, view, id) } else { Vec::new() };
        settled.into_iter().chain(disk::read_all(facts, id))
    })
    .collect()
}

/// The first free instance id of a class.
pub(crate) fn free_instance(facts: &Facts<'_>, class: &str) -> String {
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

/// The slice that comes off something, and the place it falls to: a fitting anchor beside what it was cut from.
pub(crate) fn slice(facts: &Facts<'_>, whole: ObjectId) -> Option<(ClassId, Spot)> {
    let class = recipes::slice(facts.catalog, facts.object(whole).class)?;
    let parent = facts.object(whole).parent()?;
    let size = facts.catalog.class(class).size_m.into();
    let anchor = fitting_anchors(facts, parent, size).first()?.index;
    Some((class, Spot::Anchor { parent, anchor }))
}
