//! Where a hand puts things.

use cohabit_cdf::{BodyId, ObjectId};

use crate::{
    anchors::{Anchor, anchors, free_anchors, roomy_and_tight},
    effect::{Effect, Spot},
    facts::Facts,
    works,
};

/// Puts a thing to the place that [`best_anchor`] finds, if there is one.
pub(super) fn put(facts: &Facts<'_>, body: BodyId, object: ObjectId, receptacle: ObjectId) -> Option<Effect> {
    let anchor = best_anchor(facts, body, receptacle, object)?;
    Some(Effect::Put { object, spot: Spot::Anchor { parent: receptacle, anchor: anchor.index } })
}

/// The anchors that a hand can put something at.
pub(super) fn open_anchors(facts: &Facts<'_>, receptacle: ObjectId) -> Vec<Anchor> {
    let mut free = free_anchors(facts, receptacle);
    free.retain(|anchor| !works::is_slot(facts, receptacle, anchor.index));
    free
}

/// The free anchor for what is held: its own where a receptacle is keyed, else the nearest roomy one.
pub(super) fn best_anchor(facts: &Facts<'_>, body: BodyId, receptacle: ObjectId, held: ObjectId) -> Option<Anchor> {
    if let Some(anchors) = keyed_anchors(facts, receptacle, &facts.class(held).id) {
        return anchors.first().copied();
    }
    let from = facts.state.bodies[body.0 as usize].position;
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
