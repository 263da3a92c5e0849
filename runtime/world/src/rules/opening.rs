//! Opening and closing doors, lids and drawers.

use cohabit_cdf::{ObjectId, Property, StateFlag, Status};

use super::{Observer, Ruling, Scene, Verdict, refuse};
use crate::{effect::Effect, facts::Facts, report::SoundKind, works};

pub(super) fn open(scene: &Scene<'_>, object: ObjectId) -> Verdict {
    let facts = scene.facts;
    let name = facts.name(object);
    scene.needs(object, Property::Openable, "opened")?;
    scene.touch(object)?;
    if facts.is(object, StateFlag::Locked) {
        return refuse(Status::ActionExecutionError, format!("{name} is locked: it does not open by hand"));
    }
    if facts.is(object, StateFlag::Opened) {
        return refuse(Status::InvalidCommand, format!("{name} is already open"));
    }
    let effects = vec![Effect::Set(object, StateFlag::Opened, true), Effect::sound(SoundKind::Open, object)];
    Ok(Ruling::done(format!("I opened {name}"), effects))
}

pub(super) fn close(scene: &Scene<'_>, object: ObjectId) -> Verdict {
    let facts = scene.facts;
    let name = facts.name(object);
    scene.needs(object, Property::Openable, "closed")?;
    scene.touch(object)?;
    if !facts.is(object, StateFlag::Opened) {
        return refuse(Status::InvalidCommand, format!("{name} is already closed"));
    }
    clear_doorway(facts, object)?;
    let mut effects = vec![Effect::Set(object, StateFlag::Opened, false), Effect::sound(SoundKind::Close, object)];
    effects.extend(works::settle(facts, &Observer { facts, body: None }, object));
    Ok(Ruling::done(format!("I closed {name}"), effects))
}

/// Refuses to close a door on somebody.
pub(super) fn clear_doorway(facts: &Facts<'_>, door: ObjectId) -> Result<(), Ruling> {
    if !is_doorway_clear(facts, door) {
        return refuse(Status::TargetInaccessible, "somebody stands in the doorway: it has to be clear first");
    }
    Ok(())
}

/// Whether nobody stands in the doorway of a door; what is no door between rooms has none.
pub(crate) fn is_doorway_clear(facts: &Facts<'_>, door: ObjectId) -> bool {
    facts.floor.gaps.iter().find(|gap| gap.door_object == Some(door)).is_none_or(|gap| {
        !facts.state.bodies.iter().any(|body| gap.print.distance(body.position) < crate::body::RADIUS_M)
    })
}
