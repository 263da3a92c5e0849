//! What heat, cold and the coffee machines do.

use cohabit_cdf::{Fluid, ObjectId, Property, StateFlag};

use super::product_instance;
use crate::{
    anchors::free_anchors,
    effect::{Effect, Spot},
    facts::Facts,
    report::SoundKind,
};

const BEANS: &str = "CoffeeBeans_01";

/// What gets hot is no longer cold; a floppy disk breaks.
pub(crate) fn heat(facts: &Facts<'_>, id: ObjectId) -> Vec<Effect> {
    if !facts.has(id, Property::Heatable) {
        return Vec::new();
    }
    let mut effects = vec![Effect::Set(id, StateFlag::Hot, true), Effect::Set(id, StateFlag::Cold, false)];
    if facts.class(id).id.starts_with("Floppy_") && !facts.is(id, StateFlag::Broken) {
        effects.extend([Effect::Set(id, StateFlag::Broken, true), Effect::sound(SoundKind::Break, id)]);
    }
    effects
}

/// The same, and what can be cooked is cooked.
pub(super) fn toast(facts: &Facts<'_>, id: ObjectId) -> Vec<Effect> {
    let cooked = facts.has(id, Property::Cookable).then_some(Effect::Set(id, StateFlag::Cooked, true));
    heat(facts, id).into_iter().chain(cooked).collect()
}

/// What gets cold is no longer hot.
pub(super) fn chill(facts: &Facts<'_>, id: ObjectId) -> Vec<Effect> {
    if !facts.has(id, Property::Chillable) {
        return Vec::new();
    }
    vec![Effect::Set(id, StateFlag::Cold, true), Effect::Set(id, StateFlag::Hot, false)]
}

/// Whether it is a bag of coffee beans.
pub(crate) fn is_beans(facts: &Facts<'_>, id: ObjectId) -> bool {
    facts.class(id).id == BEANS
}

/// Coffee comes hot into everything whole under the spout that takes it; water and beans are used up.
pub(super) fn brew(facts: &Facts<'_>, maker: ObjectId) -> Vec<Effect> {
    let mut effects = Vec::new();
    for id in facts.contents(maker) {
        if is_beans(facts, id) {
            effects.push(Effect::Remove(id));
        } else if facts.has(id, Property::Fillable) && !facts.is(id, StateFlag::Broken) {
            effects.push(Effect::Fill(id, Fluid::Coffee));
            effects.extend(heat(facts, id));
        }
    }
    effects.push(Effect::Fill(maker, Fluid::None));
    effects
}

/// Coffee in the unmaker, or in what stands in it, comes out as beans.
pub(super) fn unbrew(facts: &Facts<'_>, unmaker: ObjectId) -> Vec<Effect> {
    let filled: Vec<ObjectId> = std::iter::once(unmaker)
        .chain(facts.contents(unmaker))
        .filter(|id| facts.object(*id).fluid == Fluid::Coffee)
        .collect();
    let mut effects: Vec<Effect> = filled.iter().map(|id| Effect::Fill(*id, Fluid::None)).collect();
    let beans = facts.catalog.find(BEANS);
    if let (false, Some(class), Some(anchor)) = (filled.is_empty(), beans, free_anchors(facts, unmaker).first()) {
        let instance = product_instance(facts, unmaker, class);
        let spot = Spot::Anchor { parent: unmaker, anchor: anchor.index };
        effects.push(Effect::Spawn { class, instance, spot, by: Some(unmaker), was: None });
    }
    effects
}
