//! What the machines of the laboratories do: back to yesterday, into a carrot, out of the printer, large and small.

use cohabit_cdf::{ClassId, ObjectId, StateFlag};

use super::{free_instance, product_instance, recipes};
use crate::{
    anchors::{Anchor, free_anchors},
    effect::{Effect, Spot},
    entity::Support,
    facts::Facts,
};

/// How much larger the embiggenator makes things.
pub const EMBIGGEN: f32 = 1.8;
const CARROT: &str = "Carrot_01";
/// What a day undoes.
const UNDONE: [StateFlag; 4] = [StateFlag::Broken, StateFlag::Eaten, StateFlag::Cooked, StateFlag::Cut];

/// Broken, eaten, cooked and cut things are whole again; a carrot is what it was.
pub(super) fn yesterday(facts: &Facts<'_>, id: ObjectId, spot: Spot) -> Vec<Effect> {
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

/// Whatever it was, with all that stood on it, is a carrot now.
pub(super) fn carrot(facts: &Facts<'_>, machine: ObjectId, id: ObjectId) -> Vec<Effect> {
    let Some(class) = facts.catalog.find(CARROT).filter(|class| *class != facts.object(id).class) else {
        return Vec::new();
    };
    let instance = product_instance(facts, machine, class);
    let spot = Spot::Anchor { parent: machine, anchor: anchor_of(facts, id) };
    let gone = std::iter::once(id).chain(facts.contents(id));
    // What stands on something goes before it, or it would take its place.
    let mut effects: Vec<Effect> = gone.map(Effect::Remove).collect();
    effects.reverse();
    effects.push(Effect::Spawn { class, instance, spot, by: Some(machine), was: Some(id) });
    effects
}

/// The anchor at which it stands.
pub(super) fn anchor_of(facts: &Facts<'_>, id: ObjectId) -> u16 {
    match facts.object(id).support {
        Support::On { anchor: Some(anchor), .. } => anchor,
        _ => 0,
    }
}

/// The class that a printer prints: what somebody put in counts before what it came with.
pub(super) fn cartridge(facts: &Facts<'_>, printer: ObjectId) -> Option<ClassId> {
    let loaded = facts.state.children(printer).filter_map(|child| {
        let object = facts.object(child);
        let by_class = recipes::printed(facts.catalog, object.class)?;
        Some((object.touched, object.prints.unwrap_or(by_class)))
    });
    loaded.max_by_key(|(touched, _)| *touched).map(|(_, class)| class)
}

/// The anchor of a printer where its product comes out: the last free one.
pub(super) fn product_anchor(facts: &Facts<'_>, printer: ObjectId) -> Option<Anchor> {
    free_anchors(facts, printer).pop()
}

pub(super) fn print(facts: &Facts<'_>, printer: ObjectId) -> Vec<Effect> {
    let (Some(class), Some(anchor)) = (cartridge(facts, printer), product_anchor(facts, printer)) else {
        return Vec::new();
    };
    let instance = product_instance(facts, printer, class);
    let spot = Spot::Anchor { parent: printer, anchor: anchor.index };
    vec![Effect::Spawn { class, instance, spot, by: Some(printer), was: None }]
}

/// What is small grows, what is large shrinks.
pub(super) fn embiggen(facts: &Facts<'_>, id: ObjectId) -> [Effect; 2] {
    let large = facts.is(id, StateFlag::Embiggenated);
    [Effect::Set(id, StateFlag::Embiggenated, !large), Effect::Scale(id, if large { 1.0 / EMBIGGEN } else { EMBIGGEN })]
}
