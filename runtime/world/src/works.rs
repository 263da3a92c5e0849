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

use cohabit_cdf::{ClassId, Color, ObjectId};
use serde::{Deserialize, Serialize};

pub use self::lab::EMBIGGEN;
pub(crate) use self::{
    kitchen::{can_brew, freeze, is_beans},
    lab::{cartridge, product_anchor},
    vending::{behind_glass, is_slot, tray_anchor, vended},
};
use crate::{anchors::fitting_anchors, effect::Effect, effect::Spot, facts::Facts};

/// Ticks from the start of a machine to its effect: a quarter of a second.
pub(crate) const EFFECT_TICKS: u64 = 15;
/// Ticks that a machine stays on for a moment: two seconds.
pub(crate) const MOMENT_TICKS: u64 = 120;

/// What a machine does.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub(crate) enum Work {
    /// Nothing but being on.
    Nothing,
    /// What can be heated gets hot.
    Heat,
    /// As [`Self::Heat`], and what can be cooked is cooked.
    Toast,
    /// What can be chilled gets cold.
    Chill,
    /// What is in it becomes what it was yesterday.
    Yesterday,
    /// What is in it becomes a carrot.
    Carrot,
    /// A cartridge makes its product, beside it.
    Print,
    /// What holds fluids gets hot coffee.
    Brew,
    /// Coffee becomes beans.
    Unbrew,
    /// What is in it takes a colour.
    Paint(Color),
    /// What is in it grows, or shrinks back.
    Embiggen,
    /// The object at this slot falls into the tray.
    Vend(u16),
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

/// What `work` changes at `site`, done by `machine`.
pub(crate) fn effects(facts: &Facts<'_>, machine: ObjectId, work: Work, site: ObjectId) -> Vec<Effect> {
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
    }
}

/// What follows once a circuit is fed again: freezers chill, computers read the disks that are in them.
pub(crate) fn on_power(facts: &Facts<'_>, circuit: i32) -> Vec<Effect> {
    let fed = facts.state.existing().filter(|(_, object)| object.circuit == Some(circuit)).map(|(id, _)| id);
    fed.flat_map(|id| {
        let chilled = if facts.is_shut(id) { freeze(facts, id) } else { Vec::new() };
        chilled.into_iter().chain(disk::read_all(facts, id))
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
