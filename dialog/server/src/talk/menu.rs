//! What a wizard can have the robot do with what they clicked.

use cohabit_bus::message::{StateView, Thing};
use cohabit_cdf::{BodyId, Catalog, ObjectId};
use serde_json::Value;

use super::Talk;
use crate::{
    DialogError,
    affordances::{self, Deed},
    page,
    wizard::Click,
};

impl Talk {
    /// What the robot of a body, or the first one, can be told to do with a thing; and where on the floor it was clicked, m, in the
    /// world. Nothing, if it is gone or nothing can be done with it.
    pub fn menu(
        &self,
        body: Option<BodyId>,
        thing: Thing,
        floor_m: Option<[f32; 2]>,
    ) -> Result<Option<Value>, DialogError> {
        let Some(body) = body.or_else(|| self.robots.first().copied()) else { return Ok(None) };
        let mut newest = self.state();
        newest.refresh()?;
        let Some(state) = newest.view()? else { return Ok(None) };
        Ok(match thing {
            Thing::Object(object) => state.objects.iter().find(|record| record.object == object.0).map(|record| {
                let choices = of_object(state, body, object, &self.catalog);
                page::menu(body.0, page::name(record, &self.catalog), &choices)
            }),
            Thing::Surface(index) => {
                let Some(room) = self.catalog.room_at(index) else { return Ok(None) };
                // Behind a wall the floor is another room's.
                let is_its = |at_m: &[f32; 2]| self.layout.room_at(at_m[0], at_m[1]) == Some(room);
                let there = floor_m.filter(is_its).map(|at_m| (Click::Floor { at_m }, "Go there".to_owned()));
                let into = (Click::Room { room }, format!("Go to the {}", room.name_in(&self.catalog)));
                let choices: Vec<_> = there.into_iter().chain([into]).collect();
                Some(page::menu(body.0, room.name_in(&self.catalog), &choices))
            }
            Thing::Body(_) | Thing::Nothing => None,
        })
    }

    /// The same for a point of the floor plan, m, in the world.
    pub fn floor_menu(&self, body: Option<BodyId>, at_m: [f32; 2]) -> Result<Option<Value>, DialogError> {
        let room = self.layout.room_at(at_m[0], at_m[1]);
        match room.and_then(|room| self.catalog.room_index(room)) {
            Some(index) => self.menu(body, Thing::Surface(index.into()), Some(at_m)),
            None => Ok(None),
        }
    }
}

/// What can be done with an object, the most obvious first.
fn of_object(state: StateView<'_>, body: BodyId, object: ObjectId, catalog: &Catalog) -> Vec<(Click, String)> {
    let afforded = affordances::afforded_from_afar(state, body.0, object, catalog);
    let deeds = afforded.into_iter().map(|one| (Click::Act { deed: one.deed, object: object.0 }, one.label));
    let always = [
        (Click::Act { deed: Deed::GoTo, object: object.0 }, "Go there"),
        (Click::Look { object: object.0 }, "Look at it"),
        (Click::Point { object: object.0 }, "Point at it"),
    ];
    deeds.chain(always.map(|(click, label)| (click, label.to_owned()))).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use cohabit_bus::message::{BodyRecord, NONE, ObjectRecord, StateHeader};

    use super::*;

    #[test]
    fn what_is_far_away_is_offered_too() {
        let catalog = Catalog::builtin();
        let bowl = ObjectRecord {
            object: 7,
            class: catalog.find("Bowl_01").unwrap().0,
            parent: NONE,
            held_by: NONE,
            position_m: [9.0, 0.0, 0.0],
            rotation: [0.0, 0.0, 0.0, 1.0],
            ..ObjectRecord::default()
        };
        let bodies = [BodyRecord { body: 1, held: NONE, ..BodyRecord::default() }];
        let header = StateHeader::default();
        let state = StateView { header: &header, bodies: &bodies, objects: &[bowl], goals: &[], notes: &[] };
        let choices = of_object(state, BodyId(1), ObjectId(7), &catalog);
        assert_eq!(choices[0], (Click::Act { deed: Deed::PickUp, object: 7 }, "Pick up".to_owned()));
        let labels: Vec<&str> = choices.iter().map(|(_, label)| label.as_str()).collect();
        assert!(labels.ends_with(&["Go there", "Look at it", "Point at it"]), "{labels:?}");
    }
}
