//! Filling, pouring and cleaning.

use cohabit_cdf::{Fluid, ObjectId, Property, StateFlag, Status};

use super::{Ruling, Scene, Verdict, refuse};
use crate::{effect::Effect, facts::Facts, report::SoundKind, works};

const SINK: &str = "KitchenCounterSink_01";
const WATER_COOLER: &str = "WaterCooler_01";
const CEREAL_BOX: &str = "Cereal_Box_01";
const BOWL: &str = "Bowl_01";
const COFFEE_MAKER: &str = "CoffeeMaker_01";

/// Fills what is held at a running sink or at the water cooler; either may be named, or the thing to fill at the sink.
pub(super) fn fill(scene: &Scene<'_>, object: ObjectId) -> Verdict {
    let facts = scene.facts;
    let target = if facts.class(object).id == WATER_COOLER {
        let held = scene.held_or_refuse()?;
        scene.touch(object)?;
        scene.needs(held, Property::Fillable, "filled")?;
        held
    } else {
        let (sink, target) = sink_and_target(scene, object, "filled")?;
        scene.needs(target, Property::Fillable, "filled")?;
        running(facts, sink)?;
        target
    };
    if facts.object(target).fluid != Fluid::None {
        return full(&facts.name(target));
    }
    whole(facts, target)?;
    let effects = vec![Effect::Fill(target, Fluid::Water), Effect::sound(SoundKind::Pour, target)];
    Ok(Ruling::done(format!("I filled {} with water", facts.name(target)), effects))
}

/// Cleans what is held, or lies in the sink, under running water.
pub(super) fn clean(scene: &Scene<'_>, object: ObjectId) -> Verdict {
    let facts = scene.facts;
    let (sink, target) = sink_and_target(scene, object, "cleaned")?;
    scene.needs(target, Property::Dirtyable, "cleaned")?;
    running(facts, sink)?;
    let effects = vec![Effect::Set(target, StateFlag::Dirty, false), Effect::sound(SoundKind::Pour, target)];
    Ok(Ruling::done(format!("I cleaned {}", facts.name(target)), effects))
}

/// Pours what is held into something else.
pub(super) fn pour(scene: &Scene<'_>, object: ObjectId) -> Verdict {
    let facts = scene.facts;
    let name = facts.name(object);
    let held = scene.held_or_refuse()?;
    let held_name = facts.name(held);
    if held == object {
        return refuse(Status::InvalidCommand, format!("{held_name} cannot be poured into itself"));
    }
    scene.touch(object)?;
    whole(facts, object)?;
    if facts.class(held).id == CEREAL_BOX {
        return pour_cereal(facts, held, object);
    }
    scene.needs(held, Property::Fillable, "poured")?;
    whole(facts, held)?;
    let fluid = facts.object(held).fluid;
    if fluid == Fluid::None && works::is_beans(facts, held) {
        return pour_beans(facts, held, object);
    }
    if facts.class(object).id == SINK {
        let effects = vec![Effect::Fill(held, Fluid::None), Effect::sound(SoundKind::Pour, object)];
        return if fluid == Fluid::None { empty(&held_name) } else { Ok(Ruling::done("I poured it away", effects)) };
    }
    scene.needs(object, Property::Fillable, "poured into")?;
    if fluid == Fluid::None {
        return empty(&held_name);
    }
    if facts.object(object).fluid != Fluid::None {
        return full(&name);
    }
    let mut effects = vec![Effect::Fill(held, Fluid::None), Effect::Fill(object, fluid)];
    effects.extend(warmth(facts, held, object));
    effects.push(Effect::Set(held, StateFlag::Used, true));
    effects.push(Effect::sound(SoundKind::Pour, object));
    let what = fluid.name().to_lowercase();
    Ok(Ruling::done(format!("I poured the {what} into {name}"), effects))
}

/// What is poured brings its warmth along.
fn warmth(facts: &Facts<'_>, from: ObjectId, to: ObjectId) -> Vec<Effect> {
    const WARMTH: [(StateFlag, StateFlag, Property); 2] =
        [(StateFlag::Hot, StateFlag::Cold, Property::Heatable), (StateFlag::Cold, StateFlag::Hot, Property::Chillable)];
    let takes = |(flag, _, needs): &(StateFlag, StateFlag, Property)| facts.is(from, *flag) && facts.has(to, *needs);
    let set = |(flag, other, _): (StateFlag, StateFlag, Property)| {
        [Effect::Set(to, flag, true), Effect::Set(to, other, false)]
    };
    WARMTH.into_iter().find(takes).map_or_else(Vec::new, |warmth| set(warmth).to_vec())
}

/// Beans go into the coffee maker alone, which makes coffee of them as of water.
fn pour_beans(facts: &Facts<'_>, beans: ObjectId, maker: ObjectId) -> Verdict {
    let name = facts.name(maker);
    if facts.class(maker).id != COFFEE_MAKER {
        let detail = format!("coffee beans do not belong into {name}: they go into the coffee maker");
        return refuse(Status::UnsupportedAction, detail);
    }
    if facts.object(maker).fluid != Fluid::None {
        return full(&name);
    }
    let effects = vec![
        Effect::Fill(maker, Fluid::Coffee),
        Effect::Set(beans, StateFlag::Used, true),
        Effect::sound(SoundKind::Pour, maker),
    ];
    Ok(Ruling::done(format!("I poured coffee beans into {name}"), effects))
}

fn pour_cereal(facts: &Facts<'_>, held: ObjectId, object: ObjectId) -> Verdict {
    let name = facts.name(object);
    if facts.class(object).id != BOWL {
        return refuse(Status::UnsupportedAction, format!("cereal does not belong into {name}: it goes into a bowl"));
    }
    if facts.is(object, StateFlag::Cereal) {
        return refuse(Status::ActionExecutionError, format!("{name} has cereal in it already"));
    }
    let effects = vec![
        Effect::Set(object, StateFlag::Cereal, true),
        Effect::Set(held, StateFlag::Used, true),
        Effect::sound(SoundKind::Pour, object),
    ];
    Ok(Ruling::done(format!("I poured cereal into {name}"), effects))
}

/// The sink meant, and what is to be treated in it, from the one object that was named.
fn sink_and_target(scene: &Scene<'_>, object: ObjectId, what: &str) -> Result<(ObjectId, ObjectId), Ruling> {
    let facts = scene.facts;
    if facts.class(object).id == SINK {
        let held = scene.held_or_refuse()?;
        scene.touch(object)?;
        return Ok((object, held));
    }
    if let Some(sink) = facts.object(object).parent().filter(|parent| facts.class(*parent).id == SINK) {
        scene.touch(object)?;
        return Ok((sink, object));
    }
    if scene.held() != Some(object) {
        let name = facts.name(object);
        return refuse(Status::ObjectNotPickedUp, format!("{name} has to be in my hand or in the sink to be {what}"));
    }
    scene.basin().map_or_else(
        || refuse(Status::TargetOutOfRange, "there is no sink in reach: I have to go to one first"),
        |sink| Ok((sink, object)),
    )
}

fn running(facts: &Facts<'_>, sink: ObjectId) -> Result<(), Ruling> {
    if facts.is(sink, StateFlag::Toggled) {
        return Ok(());
    }
    refuse(
        Status::ActionExecutionError,
        format!("the water in {} is off: it has to be turned on first", facts.name(sink)),
    )
}

fn whole(facts: &Facts<'_>, object: ObjectId) -> Result<(), Ruling> {
    if facts.is(object, StateFlag::Broken) {
        return refuse(
            Status::ActionExecutionError,
            format!("{} is broken: the time machine makes it whole", facts.name(object)),
        );
    }
    Ok(())
}

fn empty(name: &str) -> Verdict {
    refuse(Status::ActionExecutionError, format!("{name} is empty: it has to be filled first"))
}

fn full<T>(name: &str) -> Result<T, Ruling> {
    refuse(Status::ActionExecutionError, format!("{name} is full already: it has to be emptied first"))
}
