//! Where a hand puts things.

use cohabit_cdf::{BodyId, ObjectId};
use glam::Vec3;

use super::Observer;
use crate::{
    anchors::{Anchor, anchors, free_anchors, radius, roomy_and_tight},
    effect::{Effect, Spot},
    facts::Facts,
    works,
};

/// The widest gap between two things that stand beside each other, m.
const GAP_M: f32 = 0.4;
/// How far above or below a thing that which stands beside it may stand, m.
const LEVEL_M: f32 = 0.1;
/// How much more a metre up or down counts than one to the side: another board of a shelf is not beside a thing.
const STEEP: f32 = 4.0;
/// How little a metre to the hand counts where something is put beside a thing: it decides between places that are as near to that.
const WAY_SHARE: f32 = 0.01;

/// Puts a thing to the place that [`best_anchor`] finds, if there is one.
pub(super) fn put(observer: &Observer<'_>, object: ObjectId, receptacle: ObjectId) -> Option<Effect> {
    let anchor = best_anchor(observer.facts, observer.body?, receptacle, object, observer.beside)?;
    Some(Effect::Put { object, spot: Spot::Anchor { parent: receptacle, anchor: anchor.index } })
}

/// The anchors that a hand can put something at.
pub(super) fn open_anchors(facts: &Facts<'_>, receptacle: ObjectId) -> Vec<Anchor> {
    let mut free = free_anchors(facts, receptacle);
    free.retain(|anchor| !works::is_slot(facts, receptacle, anchor.index));
    free
}

/// The free anchor for what is held: its own where a receptacle is keyed, else the roomy one that is nearest to what it is to
/// stand beside, or to the hand.
pub(super) fn best_anchor(
    facts: &Facts<'_>,
    body: BodyId,
    receptacle: ObjectId,
    held: ObjectId,
    beside: Option<ObjectId>,
) -> Option<Anchor> {
    if let Some(anchors) = keyed_anchors(facts, receptacle, &facts.class(held).id) {
        return anchors.first().copied();
    }
    let from = facts.state.bodies[body.0 as usize].position;
    let object = facts.object(receptacle);
    let (mut roomy, mut tight) = roomy_and_tight(facts, receptacle, facts.size(held));
    for places in [&mut roomy, &mut tight] {
        places.retain(|anchor| !works::is_slot(facts, receptacle, anchor.index));
    }
    let near = beside.filter(|other| stands(facts, *other)).map(|other| facts.object(other).pose.position);
    let distance = |anchor: &Anchor| {
        let at = object.pose.point(anchor.local(object.scale).position);
        // A hand comes from the front and does not stoop without need.
        let way = at.truncate().distance(from) + (at.z - 0.9).abs() * 0.5;
        match near {
            Some(near) => at.truncate().distance(near.truncate()) + (at.z - near.z).abs() * STEEP + way * WAY_SHARE,
            None => way,
        }
    };
    let choice = if roomy.is_empty() { tight } else { roomy };
    choice.into_iter().min_by(|one, two| distance(one).total_cmp(&distance(two)))
}

/// Whether something can be put beside it: it is in the world, and in no hand.
fn stands(facts: &Facts<'_>, id: ObjectId) -> bool {
    let object = facts.object(id);
    object.exists() && object.held_by().is_none()
}

/// Whether what these effects put somewhere comes to stand beside another thing; nothing, where they put nothing.
pub(super) fn is_put_beside(facts: &Facts<'_>, effects: &[Effect], other: ObjectId) -> Option<bool> {
    let (object, at) = effects.iter().find_map(|effect| match *effect {
        Effect::Put { object, spot: Spot::Anchor { parent, anchor } } => {
            Some((object, point_of(facts, parent, anchor)?))
        }
        _ => None,
    })?;
    let foot_m = facts.object(other).pose.position.z;
    let is_level = (foot_m - LEVEL_M..=foot_m + facts.size(other).z + LEVEL_M).contains(&at.z);
    let gap_m = facts.footprint(other).distance(at.truncate()) - radius(facts, object);
    Some(stands(facts, other) && is_level && gap_m <= GAP_M)
}

/// Where an anchor of a receptacle is in the world.
fn point_of(facts: &Facts<'_>, receptacle: ObjectId, anchor: u16) -> Option<Vec3> {
    let object = facts.object(receptacle);
    let anchor = anchors(facts, receptacle).get(usize::from(anchor)).copied()?;
    Some(object.pose.point(anchor.local(object.scale).position))
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
