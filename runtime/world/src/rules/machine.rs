//! What a device works, or aims at.

use cohabit_cdf::ObjectId;

use crate::facts::Facts;

/// What a device works, or aims at: as the layout says, else the nearest of its kind in the room.
pub(crate) fn works(facts: &Facts<'_>, object: ObjectId) -> Option<ObjectId> {
    let told = facts.object(object).works.filter(|id| facts.object(*id).exists());
    told.or_else(|| {
        let device = facts.catalog.table().device(&facts.class(object).id);
        let room = facts.object(object).room;
        let here = facts.object(object).pose.position;
        let classes = device.works.iter().chain(&device.aims);
        classes.flat_map(|class| facts.of_class_in(class, room)).min_by(|one, two| {
            let distance = |id: &ObjectId| facts.object(*id).pose.position.distance(here);
            distance(one).total_cmp(&distance(two))
        })
    })
}
