//! Portals: what a generator leads to, what passes it, and who waits behind it.
//!
//! The reference is silent about portals beyond their names; this is the project's reading. A generator leads to the
//! times that its mission lists, one after the other: each time it is opened anew, it leads to the next. What is put or
//! thrown into an open one comes back at its foot. From the past it comes as it was: whole, raw, clean, and what a
//! carrot was made of. From the future it comes as it will be: dried up, dusty, and as warm as the room. Behind the
//! past lives a dinosaur: food does not come back from there untouched.

use cohabit_cdf::{ObjectId, Property, StateFlag, mission::DinoFood, mission::Era};
use glam::{Vec2, Vec3};

use super::lab;
use crate::{
    body::RADIUS_M,
    effect::{Effect, Spot},
    facts::Facts,
    geometry::{Footprint, direction},
    mission_state::Gate,
    power::lacks_power,
    report::SoundKind,
};

/// The gate of a generator that is open now.
pub(crate) fn open_gate<'a>(facts: &Facts<'a>, generator: ObjectId) -> Option<&'a Gate> {
    let gate = facts.state.portals.get(&generator)?;
    let open =
        facts.object(generator).exists() && facts.is(generator, StateFlag::Toggled) && !lacks_power(facts, generator);
    open.then_some(gate)
}

/// Whether an object may go where a generator leads.
pub(crate) fn lets_pass(facts: &Facts<'_>, gate: &Gate, object: ObjectId) -> bool {
    facts.state.passes.get(&object).is_none_or(|names| names.contains(&gate.way().name))
}

/// What happens to an object that goes through a generator; nothing, if that does not let it pass.
pub(crate) fn pass(facts: &Facts<'_>, generator: ObjectId, object: ObjectId) -> Option<Vec<Effect>> {
    let gate = open_gate(facts, generator).filter(|gate| lets_pass(facts, gate, object))?;
    let way = gate.way();
    let spot = Spot::Floor(foot(facts, generator));
    let mut effects = vec![Effect::sound(SoundKind::Machine, generator)];
    effects.push(Effect::Put { object, spot });
    match way.era {
        Era::Past if eats(facts, generator, object) => effects.extend(eat(facts, generator, object)),
        Era::Past => effects.extend(to_the_past(facts, object, spot)),
        Era::Future => effects.extend(to_the_future(facts, object)),
    }
    Some(effects)
}

/// What people call where it leads.
pub(crate) const fn era_word(era: Era) -> &'static str {
    match era {
        Era::Past => "past",
        Era::Future => "future",
    }
}

/// As the time machine would, but for what was eaten; and clean.
fn to_the_past(facts: &Facts<'_>, object: ObjectId, spot: Spot) -> Vec<Effect> {
    let clean = |id: ObjectId| facts.is(id, StateFlag::Dirty).then_some(Effect::Set(id, StateFlag::Dirty, false));
    let all = std::iter::once(object).chain(facts.contents(object));
    let cleaned: Vec<Effect> = all.filter_map(clean).collect();
    let restored = lab::yesterday(facts, object, spot);
    cleaned
        .into_iter()
        .chain(restored)
        .filter(|effect| !matches!(effect, Effect::Set(_, StateFlag::Eaten, _)))
        .collect()
}

fn to_the_future(facts: &Facts<'_>, object: ObjectId) -> Vec<Effect> {
    let all = std::iter::once(object).chain(facts.contents(object));
    all.flat_map(|id| {
        let dusty = facts.has(id, Property::Dirtyable).then_some(Effect::Set(id, StateFlag::Dirty, true));
        let lost = [StateFlag::Hot, StateFlag::Cold, StateFlag::Cereal].map(|flag| Effect::Set(id, flag, false));
        lost.into_iter().chain(dusty).chain([Effect::Fill(id, cohabit_cdf::Fluid::None)])
    })
    .collect()
}

/// Whether the dinosaur at `dino` eats such things.
pub(crate) fn likes(facts: &Facts<'_>, dino: ObjectId, food: ObjectId) -> bool {
    let Some(dinosaur) = facts.state.dinosaurs.get(&dino) else { return false };
    match &dinosaur.food {
        None => facts.has(food, Property::Eatable),
        Some(DinoFood::Class(class)) => facts.class(food).id == *class,
        Some(DinoFood::Instance(instance)) => facts.object(food).is_called(instance),
    }
}

/// Whether the dinosaur at `dino` eats that, as it is.
fn eats(facts: &Facts<'_>, dino: ObjectId, food: ObjectId) -> bool {
    likes(facts, dino, food) && !facts.is(food, StateFlag::Eaten)
}

/// The dinosaur at `dino` is fed; of what can be eaten something is left, all else is gone.
fn eat(facts: &Facts<'_>, dino: ObjectId, food: ObjectId) -> [Effect; 2] {
    let eaten = if facts.has(food, Property::Eatable) {
        Effect::Set(food, StateFlag::Eaten, true)
    } else {
        Effect::Remove(food)
    };
    [Effect::Sate(dino), eaten]
}

/// What the dinosaurs that stand in the office eat now: what lies before them, or in or on them.
pub(crate) fn meals(facts: &Facts<'_>) -> Vec<Effect> {
    /// How far a dinosaur stretches its neck, m.
    const NECK_M: f32 = 0.8;
    let hungry = facts.state.dinosaurs.iter().filter(|(dino, dinosaur)| {
        !dinosaur.fed && facts.object(**dino).exists() && !facts.state.portals.contains_key(dino)
    });
    let meal = |dino: ObjectId| {
        let near = facts.footprint(dino);
        let in_reach = |id: ObjectId| {
            let object = facts.object(id);
            id != dino
                && object.held_by().is_none()
                && near.distance(object.pose.position.truncate()) < NECK_M
                && facts.shut_around(id).is_none()
                && eats(facts, dino, id)
        };
        facts.state.existing().map(|(id, _)| id).find(|id| in_reach(*id))
    };
    hungry.filter_map(|(dino, _)| meal(*dino).map(|food| eat(facts, *dino, food))).flatten().collect()
}

/// What flies into an open portal now, with what follows.
pub(crate) fn swallowed(facts: &Facts<'_>) -> Vec<Effect> {
    /// How near the ring a flying thing must come, m.
    const NEAR_M: f32 = 0.2;
    let open = facts.state.portals.keys().filter(|generator| open_gate(facts, **generator).is_some());
    open.flat_map(|generator| {
        let ring = facts.footprint(*generator);
        let height = facts.size(*generator).z;
        let flying = facts.state.existing().filter(|(_, object)| object.support == crate::entity::Support::Loose);
        let caught: Vec<ObjectId> = flying
            .filter(|(_, object)| {
                let at = object.pose.position;
                at.z > 0.05 && at.z < height && ring.distance(at.truncate()) < NEAR_M
            })
            .map(|(id, _)| id)
            .collect();
        caught.into_iter().flat_map(|id| pass(facts, *generator, id).unwrap_or_default())
    })
    .collect()
}

/// A free place on the floor at the foot of something; before it, if no place is free.
pub(crate) fn foot(facts: &Facts<'_>, around: ObjectId) -> Vec3 {
    const HALF_M: f32 = 0.2;
    /// Places are tried every 15 degrees, from the front to both sides.
    const STEPS: usize = 24;
    let print = facts.footprint(around);
    let yaw = facts.object(around).pose.yaw_rad();
    let room = facts.object(around).room;
    let spread = |step: usize| {
        let side = if step.is_multiple_of(2) { 1.0 } else { -1.0 };
        side * step.div_ceil(2) as f32 * std::f32::consts::TAU / STEPS as f32
    };
    let reach = print.half.x + HALF_M + 0.15;
    let places = [0.0, 0.3, 0.6, 0.9].into_iter().flat_map(|further: f32| {
        (0..STEPS).map(move |step| {
            let out = direction(yaw + spread(step));
            let edge = print.closest(print.center + out * 10.0);
            edge + out * (HALF_M + 0.15 + further)
        })
    });
    let free = |point: &Vec2| {
        let own = Footprint::new(*point, Vec2::splat(HALF_M), 0.0);
        facts.floor.room_at(*point) == Some(room)
            && !facts.floor.walls.iter().any(|wall| wall.overlaps(&own))
            && !facts.state.bodies.iter().any(|body| body.position.distance(*point) < RADIUS_M + HALF_M)
            && !facts.state.existing().any(|(id, object)| {
                let stands = object.parent().is_none() && object.held_by().is_none() && object.pose.position.z < 1.0;
                stands && facts.footprint(id).overlaps(&own)
            })
    };
    let front = print.center + direction(yaw) * reach;
    places.into_iter().find(free).unwrap_or(front).extend(0.0)
}
