//! Things that come into being, become others, and change their size.

use cohabit_cdf::{
    ClassId, ObjectId, StateFlag,
    catalog::table::{GROWTH, UNDONE},
};

use super::{free_instance, product_instance, recipes};
use crate::{
    anchors::{fitting_anchors, free_anchors},
    effect::{Effect, Spot},
    entity::Support,
    facts::Facts,
};

/// Broken, eaten, cooked and cut things are whole again; a carrot is what it was.
pub(crate) fn yesterday(facts: &Facts<'_>, id: ObjectId, spot: Spot) -> Vec<Effect> {
    let object = facts.object(id);
    if let Some(was) = object.was {
        return vec![Effect::Remove(id), Effect::Return { object: was, spot }];
    }
    let class = object.yesterday.or_else(|| recipes::yesterday(facts.catalog, object.class));
    match class.filter(|class| *class != object.class) {
        Some(class) => {
            let instance = free_instance(facts, &facts.catalog.class(class).id);
            vec![Effect::Remove(id), Effect::Spawn { class, instance, spot, by: None, was: None }]
        }
        None => {
            UNDONE.into_iter().filter(|flag| facts.is(id, *flag)).map(|flag| Effect::Set(id, flag, false)).collect()
        }
    }
}

/// Whatever it was, with all that stood on it, is one thing of a class now.
pub(crate) fn become_one(facts: &Facts<'_>, id: ObjectId, class: &str) -> Option<Vec<Effect>> {
    let class = facts.catalog.find(class)?;
    let machine = facts.object(id).parent();
    let instance = machine.map_or_else(
        || free_instance(facts, &facts.catalog.class(class).id),
        |machine| product_instance(facts, machine, class),
    );
    let spot = spot_of(facts, id);
    let gone = std::iter::once(id).chain(facts.contents(id));
    // What stands on something goes before it, or it would take its place.
    let mut effects: Vec<Effect> = gone.map(Effect::Remove).collect();
    effects.reverse();
    effects.push(Effect::Spawn { class, instance, spot, by: machine, was: Some(id) });
    Some(effects)
}

/// Where a thing is, for what takes its place.
pub(crate) fn spot_of(facts: &Facts<'_>, id: ObjectId) -> Spot {
    match facts.object(id).support {
        Support::On { parent, anchor, .. } => Spot::Anchor { parent, anchor: anchor.unwrap_or(0) },
        _ => Spot::Floor(facts.object(id).pose.position),
    }
}

/// The slice that comes off something: it falls to a fitting place beside what it was cut from.
pub(crate) fn slice(facts: &Facts<'_>, whole: ObjectId) -> Option<Effect> {
    let class = recipes::slice(facts.catalog, facts.object(whole).class)?;
    let parent = facts.object(whole).parent()?;
    let size = facts.catalog.class(class).size_m.into();
    let anchor = fitting_anchors(facts, parent, size).first()?.index;
    let instance = free_instance(facts, &facts.catalog.class(class).id);
    Some(Effect::Spawn { class, instance, spot: Spot::Anchor { parent, anchor }, by: None, was: None })
}

/// A thing of a class comes out of a machine, if a place in it is free.
pub(crate) fn spawn(facts: &Facts<'_>, machine: ObjectId, class: &str) -> Option<Effect> {
    let class = facts.catalog.find(class)?;
    let anchor = free_anchors(facts, machine).first()?.index;
    Some(product(facts, machine, class, anchor))
}

/// The product of its cartridge comes out of a printer, at the last free place.
pub(crate) fn print(facts: &Facts<'_>, printer: ObjectId) -> Option<Effect> {
    let class = printed(facts, printer)?;
    let anchor = free_anchors(facts, printer).pop()?.index;
    Some(product(facts, printer, class, anchor))
}

/// The class that a printer prints: what somebody put in counts before what it came with.
fn printed(facts: &Facts<'_>, printer: ObjectId) -> Option<ClassId> {
    let loaded = facts.state.children(printer).filter_map(|child| {
        let object = facts.object(child);
        let by_class = recipes::printed(facts.catalog, object.class)?;
        Some((object.touched, object.prints.unwrap_or(by_class)))
    });
    loaded.max_by_key(|(touched, _)| *touched).map(|(_, class)| class)
}

fn product(facts: &Facts<'_>, machine: ObjectId, class: ClassId, anchor: u16) -> Effect {
    let instance = product_instance(facts, machine, class);
    let spot = Spot::Anchor { parent: machine, anchor };
    Effect::Spawn { class, instance, spot, by: Some(machine), was: None }
}

/// What is small grows, what is large shrinks.
pub(crate) fn resize(facts: &Facts<'_>, id: ObjectId) -> [Effect; 2] {
    let large = facts.is(id, StateFlag::Embiggenated);
    [Effect::Set(id, StateFlag::Embiggenated, !large), Effect::Scale(id, if large { 1.0 / GROWTH } else { GROWTH })]
}
