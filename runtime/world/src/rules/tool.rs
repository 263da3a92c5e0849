//! Breaking and cutting with a tool in hand, scanning, examining, and what floppy disks do.

use cohabit_cdf::{ObjectId, Property, StateFlag, Status};

use super::{LOOK_CLOSELY_M, Ruling, Scene, Verdict, refuse};
use crate::{
    effect::Effect,
    facts::Facts,
    report::{Event, SoundKind},
    works,
};

/// What comes off when something is cut.
const SLICES: &[(&str, &str)] = &[
    ("Apple", "AppleSlice_01"),
    ("BreadLoaf", "BreadSlice_01"),
    ("Cake_02", "CakeSlice_02"),
    ("PieFruit_01", "PieFruitSlice_01"),
];

/// Breaks with the hammer; with the knife, cuts.
pub(super) fn break_or_cut(scene: &Scene<'_>, object: ObjectId) -> Verdict {
    let facts = scene.facts;
    let tool = scene.held().map(|held| (held, facts.class(held).id.as_str()));
    if let (Some((knife, "Knife_01")), true) = (tool, facts.has(object, Property::Cuttable)) {
        return cut(scene, knife, object);
    }
    scene.needs(object, Property::Breakable, "broken")?;
    let Some((hammer, "Hammer")) = tool else {
        return refuse(Status::ObjectNotPickedUp, "I need the hammer in my hand");
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
    let mut effects = vec![Effect::Set(object, StateFlag::Cut, true), Effect::Set(knife, StateFlag::Used, true)];
    let slice = SLICES.iter().find(|(whole, _)| *whole == facts.class(object).id);
    if let Some(class) = slice.and_then(|(_, slice)| facts.catalog.find(slice))
        && let Some((parent, anchor)) = works::slice_place(facts, object, class)
    {
        let instance = works::free_instance(facts, &facts.catalog.class(class).id);
        effects.push(Effect::Spawn { class, instance, parent, anchor, yesterday: None, by: None });
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

/// A whole virus disk in a clean terminal infects it; an antivirus disk in an infected one cleans it.
pub(super) fn infection(facts: &Facts<'_>, disk: ObjectId, terminal: ObjectId) -> Option<Effect> {
    if !facts.has(terminal, Property::Infectable) || facts.is(disk, StateFlag::Broken) {
        return None;
    }
    match facts.class(disk).id.as_str() {
        "Floppy_Virus" => Some(Effect::Set(terminal, StateFlag::Infected, true)),
        "Floppy_AntiVirus" => Some(Effect::Set(terminal, StateFlag::Infected, false)),
        _ => None,
    }
}
