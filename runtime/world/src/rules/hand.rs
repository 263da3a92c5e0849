//! Picking up, placing and throwing.

use cohabit_cdf::{ObjectId, Property, Status};
use glam::Vec3;

use super::{Ruling, Scene, Verdict, refuse};
use crate::{
    anchors::{Anchor, anchors, free_anchors, roomy_and_tight},
    effect::Effect,
    facts::Facts,
    rules::tool,
};

/// How high a throw goes above the straight line, s of flight: half a second is a gentle toss.
const FLIGHT_S: f32 = 0.5;
const GRAVITY_M_S2: f32 = 9.81;

pub(super) fn pick_up(scene: &Scene<'_>, object: ObjectId) -> Verdict {
    let facts = scene.facts;
    let name = facts.name(object);
    if let Some(held) = scene.held() {
        return refuse(Status::AlreadyHoldingObject, format!("I am already holding {}", facts.name(held)));
    }
    scene.needs(object, Property::Pickupable, "picked up")?;
    scene.touch(object)?;
    Ok(Ruling::done(format!("I am holding {name}"), vec![Effect::Hold(object, scene.body)]))
}

pub(super) fn place(scene: &Scene<'_>, receptacle: ObjectId) -> Verdict {
    let facts = scene.facts;
    let name = facts.name(receptacle);
    let held = scene.held_or_refuse()?;
    let held_name = facts.name(held);
    if held == receptacle || facts.state.ancestors(receptacle).any(|ancestor| ancestor == held) {
        return refuse(Status::InvalidCommand, format!("{held_name} cannot be put into itself"));
    }
    scene.needs(receptacle, Property::Receptacle, "used to put things in or on")?;
    scene.touch(receptacle)?;
    if facts.is_shut(receptacle) {
        return refuse(Status::ReceptacleIsClosed, format!("{name} is closed"));
    }
    let Some(kind) = &facts.class(receptacle).receptacle else {
        return refuse(Status::UnsupportedAction, format!("{name} takes nothing"));
    };
    let class = facts.class(held).id.as_str();
    let keyed = !kind.keys.is_empty();
    if (keyed && !kind.keys.iter().any(|key| key == class)) || kind.refuses.iter().any(|refused| refused == class) {
        return refuse(Status::UnsupportedAction, format!("{name} does not take {held_name}"));
    }
    if free_anchors(facts, receptacle).is_empty() {
        return refuse(Status::ReceptacleIsFull, format!("{name} is full"));
    }
    let Some(anchor) = best_anchor(scene, receptacle, held) else {
        let fits = if keyed { Status::ReceptacleIsFull } else { Status::UnsupportedAction };
        return refuse(fits, format!("{held_name} does not fit there"));
    };
    let mut effects = vec![Effect::PutOn { object: held, parent: receptacle, anchor: anchor.index }];
    effects.extend(tool::infection(facts, held, receptacle));
    Ok(Ruling::done(format!("I put {held_name} in place: {name}"), effects))
}

/// The free anchor for what is held: its own where a receptacle is keyed, else the nearest roomy one.
fn best_anchor(scene: &Scene<'_>, receptacle: ObjectId, held: ObjectId) -> Option<Anchor> {
    let facts = scene.facts;
    if let Some(anchors) = keyed_anchors(facts, receptacle, &facts.class(held).id) {
        return anchors.first().copied();
    }
    let from = facts.state.bodies[scene.body.0 as usize].position;
    let object = facts.object(receptacle);
    let (roomy, tight) = roomy_and_tight(facts, receptacle, facts.size(held));
    let distance = |anchor: &Anchor| {
        let at = object.pose.point(anchor.local(object.scale).position);
        // A hand comes from the front and does not stoop without need.
        at.truncate().distance(from) + (at.z - 0.9).abs() * 0.5
    };
    let choice = if roomy.is_empty() { tight } else { roomy };
    choice.into_iter().min_by(|one, two| distance(one).total_cmp(&distance(two)))
}

/// The free anchors that a key object may take, if the receptacle is keyed: its own, where each key has one.
pub(crate) fn keyed_anchors(facts: &Facts<'_>, receptacle: ObjectId, class: &str) -> Option<Vec<Anchor>> {
    let keys = &facts.class(receptacle).receptacle.as_ref()?.keys;
    if keys.is_empty() {
        return None;
    }
    let each_has_one = keys.len() == anchors(facts, receptacle).len();
    let mut free = free_anchors(facts, receptacle);
    if each_has_one {
        free.retain(|anchor| keys.get(usize::from(anchor.index)).is_some_and(|key| key == class));
    }
    Some(free)
}

pub(super) fn throw(scene: &Scene<'_>, target: ObjectId) -> Verdict {
    let facts = scene.facts;
    let held = scene.held_or_refuse()?;
    if held == target {
        return refuse(Status::InvalidCommand, "I cannot throw something at itself");
    }
    let hand = facts.state.bodies[scene.body.0 as usize].hand().position;
    let aim = facts.aim_point(target);
    const FURTHEST_M: f32 = 6.0;
    if hand.distance(aim) > FURTHEST_M {
        return refuse(Status::TargetOutOfRange, format!("{} is too far away to throw at", facts.name(target)));
    }
    let velocity = (aim - hand) / FLIGHT_S + Vec3::Z * (GRAVITY_M_S2 * FLIGHT_S / 2.0);
    let detail = format!("I threw {} at {}", facts.name(held), facts.name(target));
    Ok(Ruling::done(detail, vec![Effect::LetGo(held, velocity)]))
}
