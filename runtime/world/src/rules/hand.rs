//! Picking up, placing and throwing.

use cohabit_cdf::{ObjectId, Property, StateFlag, Status};
use glam::Vec3;

use super::{Ruling, Scene, Verdict, refuse};
use crate::{
    anchors::{Anchor, anchors, free_anchors, roomy_and_tight},
    effect::{Effect, Spot},
    facts::Facts,
    power::lacks_power,
    works::{self, disk, portal},
};

/// How high a throw goes above the straight line, s of flight: half a second is a gentle toss.
const FLIGHT_S: f32 = 0.5;
const GRAVITY_M_S2: f32 = 9.81;

pub(super) fn pick_up(scene: &Scene<'_>, object: ObjectId) -> Verdict {
    let facts = scene.facts;
    let name = facts.name(object);
    if let Some(held) = scene.held() {
        return refuse(
            Status::AlreadyHoldingObject,
            format!("I am already holding {}: I have to put it down first", facts.name(held)),
        );
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
    if facts.state.portals.contains_key(&receptacle) {
        return hand_through(scene, held, receptacle);
    }
    scene.needs(receptacle, Property::Receptacle, "used to put things in or on")?;
    scene.touch(receptacle)?;
    if facts.is_shut(receptacle) {
        return refuse(Status::ReceptacleIsClosed, super::closed(facts, receptacle));
    }
    let Some(kind) = &facts.class(receptacle).receptacle else {
        return refuse(Status::UnsupportedAction, format!("{name} takes nothing"));
    };
    let class = facts.class(held).id.as_str();
    let keyed = !kind.keys.is_empty();
    if (keyed && !kind.keys.iter().any(|key| key == class)) || kind.refuses.iter().any(|refused| refused == class) {
        let detail = if keyed {
            format!("{name} does not take {held_name}: it only takes {}", names_of(facts, &kind.keys))
        } else {
            format!("{name} does not take {held_name}")
        };
        return refuse(Status::UnsupportedAction, detail);
    }
    let full = || format!("{name} is full: something has to be taken away first");
    if open_anchors(facts, receptacle).is_empty() {
        return refuse(Status::ReceptacleIsFull, full());
    }
    let Some(anchor) = best_anchor(scene, receptacle, held) else {
        if keyed {
            return refuse(Status::ReceptacleIsFull, full());
        }
        return refuse(Status::UnsupportedAction, format!("{held_name} is too large to fit there"));
    };
    let spot = Spot::Anchor { parent: receptacle, anchor: anchor.index };
    let mut effects = vec![Effect::Put { object: held, spot }];
    effects.extend(what_follows(facts, held, receptacle));
    if disk::is_effective(facts, held, receptacle) && lacks_power(facts, receptacle) {
        let detail = format!("{held_name} is in, but {name} has no power to read it: the fuse box gives it power");
        return Ok(Ruling { status: Status::PostProcessError, detail, effects });
    }
    Ok(Ruling::done(format!("I put {held_name} in place: {name}"), effects))
}

/// What a thing does to the receptacle that it was put into, and that to it.
fn what_follows(facts: &Facts<'_>, object: ObjectId, receptacle: ObjectId) -> Vec<Effect> {
    // A lever comes into a fuse box the way that the box stands.
    let lever = (facts.object(receptacle).feeds.is_some() && facts.has(object, Property::Toggleable))
        .then(|| Effect::Set(object, StateFlag::Toggled, facts.is(receptacle, StateFlag::Toggled)));
    disk::read(facts, object, receptacle).into_iter().chain(lever).collect()
}

/// Puts what is held through an open portal.
fn hand_through(scene: &Scene<'_>, held: ObjectId, generator: ObjectId) -> Verdict {
    scene.touch(generator)?;
    let facts = scene.facts;
    let effects = portal::pass(facts, generator, held).map_err(|(status, detail)| Ruling::refusal(status, detail))?;
    Ok(Ruling::done(format!("I put {} through the portal", facts.name(held)), effects))
}

/// What people call the things of these classes, each once: `the laser tip or the control panel`.
fn names_of(facts: &Facts<'_>, classes: &[String]) -> String {
    let mut names: Vec<String> = Vec::new();
    for class in classes.iter().filter_map(|class| facts.catalog.find(class)) {
        let name = facts.catalog.class(class).name.to_lowercase();
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names.join(" or ")
}

/// The anchors that a hand can put something at.
pub(super) fn open_anchors(facts: &Facts<'_>, receptacle: ObjectId) -> Vec<Anchor> {
    let mut free = free_anchors(facts, receptacle);
    free.retain(|anchor| !works::is_slot(facts, receptacle, anchor.index));
    free
}

/// The free anchor for what is held: its own where a receptacle is keyed, else the nearest roomy one.
pub(super) fn best_anchor(scene: &Scene<'_>, receptacle: ObjectId, held: ObjectId) -> Option<Anchor> {
    let facts = scene.facts;
    if let Some(anchors) = keyed_anchors(facts, receptacle, &facts.class(held).id) {
        return anchors.first().copied();
    }
    let from = facts.state.bodies[scene.body.0 as usize].position;
    let object = facts.object(receptacle);
    let (mut roomy, mut tight) = roomy_and_tight(facts, receptacle, facts.size(held));
    for places in [&mut roomy, &mut tight] {
        places.retain(|anchor| !works::is_slot(facts, receptacle, anchor.index));
    }
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
        return refuse(
            Status::TargetOutOfRange,
            format!("{} is too far away to throw at: I have to go nearer", facts.name(target)),
        );
    }
    let velocity = (aim - hand) / FLIGHT_S + Vec3::Z * (GRAVITY_M_S2 * FLIGHT_S / 2.0);
    let detail = format!("I threw {} at {}", facts.name(held), facts.name(target));
    Ok(Ruling::done(detail, vec![Effect::LetGo(held, velocity)]))
}
