//! Filling, pouring and cleaning.

use cohabit_cdf::{Fluid, ObjectId, Property, StateFlag, Status};

use super::{Ruling, Scene, Verdict, refuse};
use crate::{effect::Effect, facts::Facts, report::SoundKind};

const SINK: &str = "KitchenCounterSink_01";
const CEREAL_BOX: &str = "Cereal_Box_01";
const BOWL: &str = "Bowl_01";

/// Fills what is held at a running sink; the sink may be named, or the thing to fill.
pub(super) fn fill(scene: &Scene<'_>, object: ObjectId) -> Verdict {
    let facts = scene.facts;
    let (sink, target) = sink_and_target(scene, object, "filled")?;
    scene.needs(target, Property::Fillable, "filled")?;
    running(facts, sink)?;
    if facts.object(target).fluid != Fluid::None {
        return refuse(Status::ActionExecutionError, format!("{} is full already", facts.name(target)));
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
    let fluid = facts.object(held).fluid;
    if facts.class(object).id == SINK {
        let effects = vec![Effect::Fill(held, Fluid::None), Effect::sound(SoundKind::Pour, object)];
        return if fluid == Fluid::None { empty(&held_name) } else { Ok(Ruling::done("I poured it away", effects)) };
    }
    scene.needs(object, Property::Fillable, "poured into")?;
    if fluid == Fluid::None {
        return empty(&held_name);
    }
    if facts.object(object).fluid != Fluid::None {
        return refuse(Status::ActionExecutionError, format!("{name} is full already"));
    }
    let mut effects = vec![Effect::Fill(held, Fluid::None), Effect::Fill(object, fluid)];
    for flag in [StateFlag::Hot, StateFlag::Cold] {
        let takes_it = facts.has(object, if flag == StateFlag::Hot { Property::Heatable } else { Property::Chillable });
        if takes_it && facts.is(held, flag) {
            effects.push(Effect::Set(object, flag, true));
        }
    }
    effects.push(Effect::Set(held, StateFlag::Used, true));
    effects.push(Effect::sound(SoundKind::Pour, object));
    let what = fluid.name().to_lowercase();
    Ok(Ruling::done(format!("I poured the {what} into {name}"), effects))
}

fn pour_cereal(facts: &Facts<'_>, held: ObjectId, object: ObjectId) -> Verdict {
    let name = facts.name(object);
    if facts.class(object).id != BOWL {
        return refuse(Status::UnsupportedAction, format!("cereal does not belong into {name}"));
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
        return refuse(Status::ObjectNotPickedUp, format!("{name} must be in my hand or in the sink to be {what}"));
    }
    let sinks = facts.state.existing().map(|(id, _)| id).filter(|id| facts.class(*id).id == SINK);
    let near = sinks.into_iter().find(|sink| scene.touch(*sink).is_ok());
    near.map_or_else(|| refuse(Status::TargetOutOfRange, "there is no sink in reach"), |sink| Ok((sink, object)))
}

fn running(facts: &Facts<'_>, sink: ObjectId) -> Result<(), Ruling> {
    if facts.is(sink, StateFlag::Toggled) {
        return Ok(());
    }
    refuse(Status::ActionExecutionError, format!("the water in {} is off", facts.name(sink)))
}

fn whole(facts: &Facts<'_>, object: ObjectId) -> Result<(), Ruling> {
    if facts.is(object, StateFlag::Broken) {
        return refuse(Status::ActionExecutionError, format!("{} is broken", facts.name(object)));
    }
    Ok(())
}

fn empty(name: &str) -> Verdict {
    refuse(Status::ActionExecutionError, format!("{name} is empty"))
}
