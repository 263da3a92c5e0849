//! What machines do to what is in them, once they work, by the works of the table.
//!
//! A machine that works for a moment is on first, and only then changes its contents: goals that ask for both the
//! machine on and the thing in it must be able to see that.

use cohabit_cdf::{
    ObjectId,
    catalog::table::{Over, Scope, Work as Entry},
};

use super::{Observer, effects::effects_of};
use crate::{effect::Effect, facts::Facts, power::lacks_power, run::Work};

/// What `work` changes at `site`, once `machine` was pressed for it.
pub(crate) fn effects_of_work(facts: &Facts<'_>, machine: ObjectId, work: Work, site: ObjectId) -> Vec<Effect> {
    let entry = work.entry(facts.catalog.table());
    entry.map_or_else(Vec::new, |entry| effects_at(facts, entry, machine, site))
}

/// What a work of the table changes at `site`; `by` is what was pressed for it.
fn effects_at(facts: &Facts<'_>, work: &Entry, by: ObjectId, site: ObjectId) -> Vec<Effect> {
    let observer = Observer { facts, body: None, beside: None };
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
        Some(work) if !lacks_power(facts, id) => effects_of_work(facts, id, Work::named(facts.catalog, work), id),
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
