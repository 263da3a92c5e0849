//! Doors between rooms: who stands in them, and those that security buttons work.

use cohabit_cdf::{ObjectId, StateFlag};

use crate::{effect::Effect, facts::Facts, report::SoundKind};

/// Whether nobody stands in the doorway of a door; what is no door between rooms has none.
pub(crate) fn is_doorway_clear(facts: &Facts<'_>, door: ObjectId) -> bool {
    facts.floor.gaps.iter().find(|gap| gap.door_object == Some(door)).is_none_or(|gap| {
        !facts.state.bodies.iter().any(|body| gap.print.distance(body.position) < crate::body::RADIUS_M)
    })
}

/// The doors that security buttons work: those of secured rooms, such as the reception.
pub(crate) fn doors_of_buttons(facts: &Facts<'_>) -> Vec<ObjectId> {
    let rooms = facts.catalog.rooms();
    let secured = facts.floor.gaps.iter().filter(|gap| gap.between.iter().any(|room| rooms.is_secured(*room)));
    secured.filter_map(|gap| gap.door_object).filter(|door| facts.object(*door).exists()).collect()
}

/// Whether a press of a security button opens its doors: one of them is shut.
pub(super) fn opens(facts: &Facts<'_>, doors: &[ObjectId]) -> bool {
    doors.iter().any(|door| !facts.is(*door, StateFlag::Opened))
}

/// What such a press does to its doors.
pub(super) fn swing(facts: &Facts<'_>) -> Vec<Effect> {
    let doors = doors_of_buttons(facts);
    let open = opens(facts, &doors);
    let sound = if open { SoundKind::Open } else { SoundKind::Close };
    doors.iter().flat_map(|door| [Effect::Set(*door, StateFlag::Opened, open), Effect::sound(sound, *door)]).collect()
}
