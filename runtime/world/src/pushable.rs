//! What a body can push along the floor.

use cohabit_cdf::{ObjectId, Property, catalog::Stands};

use crate::{entity::Support, facts::Facts};

/// What a body can push along, with all that stands on it, kg.
const PUSHED_KG: f32 = 15.0;
/// Nothing that stands higher than this is on the floor, m.
const FLOOR_M: f32 = 0.06;
/// Flat things that nobody carries about (mats, cords, puddles) are walked over, m.
const FLAT_M: f32 = 0.1;

/// Whether a body could push an object along the floor.
pub(crate) fn is_pushable(facts: &Facts<'_>, id: ObjectId) -> bool {
    let object = facts.object(id);
    let class = facts.class(id);
    object.support == Support::Fixed
        && object.pose.position.z.abs() < FLOOR_M
        && class.stands != Stands::OnWall
        && (class.has(Property::Pickupable) || facts.size(id).z > FLAT_M || class.stands == Stands::OnSurface)
        && facts.floor.swings.of(object.class).is_empty()
        && mass_kg(facts, id) <= PUSHED_KG
}

/// What it weighs with all that stands on it, kg.
fn mass_kg(facts: &Facts<'_>, id: ObjectId) -> f32 {
    let own = facts.object(id).mass_kg(facts.class(id));
    if own > PUSHED_KG {
        return own;
    }
    own + facts.state.children(id).map(|child| mass_kg(facts, child)).sum::<f32>()
}
