//! Breaking and cutting with a tool in hand, scanning, examining.

use cohabit_cdf::{ObjectId, Property, StateFlag, Status};

use super::{LOOK_CLOSELY_M, Ruling, Scene, Verdict, refuse};
use crate::{
    effect::Effect,
    report::{Event, SoundKind},
    works,
};

const HAMMER: &str = "Hammer";
const KNIFE: &str = "Knife_01";

/// Breaks with the hammer; with the knife, cuts.
pub(super) fn break_or_cut(scene: &Scene<'_>, object: ObjectId) -> Verdict {
    let facts = scene.facts;
    let tool = scene.held().map(|held| (held, facts.class(held).id.as_str()));
    if let (Some((knife, KNIFE)), true) = (tool, facts.has(object, Property::Cuttable)) {
        return cut(scene, knife, object);
    }
    if facts.has(object, Property::Cuttable) && !facts.has(object, Property::Breakable) {
        return refuse(Status::ObjectNotPickedUp, format!("I have to hold the knife to cut {}", facts.name(object)));
    }
    scene.needs(object, Property::Breakable, "broken")?;
    let Some((hammer, HAMMER)) = tool else {
        return refuse(Status::ObjectNotPickedUp, "I have to hold the hammer to break something");
    };
    scene.touch(object)?;
    if facts.is(object, StateFlag::Broken) {
        return refuse(Status::InvalidCommand, format!("{} is broken already", facts.name(object)));
    }
    let effects = vec![
        Effect::Set(object, StateFlag::Broken, true),
        Effect::Fill(object, cohabit_cdf::Fluid::None),
        Effect::Set(object, StateFlag::Cereal, false),
        Effect::Set(hammer, StateFlag::Used, true),
        Effect::sound(SoundKind::Break, object),
    ];
    Ok(Ruling::done(format!("I broke {}", facts.name(object)), effects))
}

fn cut(scene: &Scene<'_>, knife: ObjectId, object: ObjectId) -> Verdict {
    let facts = scene.facts;
    scene.touch(object)?;
    if facts.is(object, StateFlag::Cut) {
        return refuse(Status::InvalidCommand, format!("{} is cut already", facts.name(object)));
    }
    let mut effects = vec![Effect::Set(object, StateFlag::Cut, true), Effect::Set(knife, StateFlag::Used, true)];
    if let Some((class, spot)) = works::slice(facts, object) {
        let instance = works::free_instance(facts, &facts.catalog.class(class).id);
        effects.push(Effect::Spawn { class, instance, spot, by: None, was: None });
    }
    Ok(Ruling::done(format!("I cut {}", facts.name(object)), effects))
}

pub(super) fn scan(scene: &Scene<'_>, object: ObjectId) -> Verdict {
    scene.near(object, LOOK_CLOSELY_M)?;
    let effects = vec![Effect::Set(object, StateFlag::Scanned, true), Effect::Tell(Event::Scanned { object })];
    Ok(Ruling::done(format!("I scanned {}", scene.facts.name(object)), effects))
}

pub(super) fn examine(scene: &Scene<'_>, object: ObjectId) -> Verdict {
    scene.near(object, LOOK_CLOSELY_M)?;
    let facts = scene.facts;
    let text = facts.object(object).text.clone();
    let mut effects = vec![Effect::Set(object, StateFlag::Examined, true)];
    if text.is_empty() {
        return Ok(Ruling::done(format!("I looked closely at {}", facts.name(object)), effects));
    }
    effects.push(Effect::Tell(Event::NoteRead { object, text: text.clone() }));
    Ok(Ruling::done(format!("{} says: {text}", facts.name(object)), effects))
}
