//! The floor plan's own things: placed as it says, in the states that they are in on an ordinary day.

use cohabit_cdf::{
    ObjectId, RoomId,
    layout::{OpeningKind, Placement},
};
use glam::{Quat, Vec3};

use super::{BuildError, Builder};
use crate::{
    anchors::free_anchors,
    entity::Object,
    geometry::{Pose, turn, wrap},
    works,
};

impl Builder<'_> {
    /// Places all that the floor plan has.
    pub(super) fn furnish(&mut self) -> Result<(), BuildError> {
        for placement in &self.layout.placements {
            self.place(placement)?;
        }
        self.hang_missing_doors()?;
        for placement in &self.layout.placements {
            let (Some(id), Some(works)) = (self.state.find(&placement.instance), &placement.works) else { continue };
            self.state.at_mut(id).works = self.state.find(works);
        }
        Ok(())
    }

    fn place(&mut self, placement: &Placement) -> Result<(), BuildError> {
        let yaw_rad = wrap(placement.yaw_deg.to_radians());
        let at = Vec3::from(placement.at_m);
        let id = self.create(&placement.instance, placement.room, Pose::level(at, yaw_rad))?;
        self.state.at_mut(id).scale = placement.scale;
        let Some(on) = &placement.on else { return Ok(()) };
        let parent = self.state.find(on).filter(|parent| *parent != id).ok_or_else(|| BuildError::NoSuchParent {
            object: placement.instance.clone(),
            parent: on.clone(),
            layout: self.layout.id.clone(),
        })?;
        // The plan gives its yaw in the world, what holds it needs it in its own frame.
        let rotation = self.state.at(parent).pose.rotation.inverse() * turn(yaw_rad);
        let facts = self.facts();
        let mut free = free_anchors(&facts, parent);
        // Goods stand in the slots of a vending machine, not in its tray.
        free.sort_by_key(|anchor| !works::is_slot(&facts, parent, anchor.index));
        let (anchor, position) = match (placement.anchor, free.first()) {
            (true, Some(anchor)) => (Some(anchor.index), anchor.local(self.state.at(parent).scale).position),
            (true, None) => {
                let object = placement.instance.clone();
                return Err(BuildError::NoFreePlace { object, receptacle: on.clone() });
            }
            (false, _) => (None, at),
        };
        self.changes().attach(id, parent, anchor, Pose { position, rotation });
        Ok(())
    }

    /// Doors that the plan has in an opening but not among its things.
    fn hang_missing_doors(&mut self) -> Result<(), BuildError> {
        let missing: Vec<(String, Pose, RoomId)> = self
            .layout
            .openings
            .iter()
            .filter(|opening| opening.kind == OpeningKind::Door)
            .zip(self.floor.gaps.iter().filter(|gap| gap.door.is_some()))
            .filter_map(|(opening, gap)| {
                let door = opening.door.clone().filter(|door| self.state.find(door).is_none())?;
                Some((door, Pose::level(gap.print.center.extend(0.0), gap.yaw_rad), opening.between[0]))
            })
            .collect();
        for (door, pose, room) in missing {
            self.create(&door, room, pose)?;
        }
        Ok(())
    }

    /// Makes an object of the class that its id says, in its everyday state.
    pub(super) fn create(&mut self, instance: &str, room: RoomId, pose: Pose) -> Result<ObjectId, BuildError> {
        let class = self
            .catalog
            .class_of_instance(instance)
            .ok_or_else(|| BuildError::UnknownClass { object: instance.to_owned() })?;
        let mut object = Object::new(instance.to_owned(), class, room, pose);
        let circuit = self.circuit_of(room);
        object.circuit = circuit;
        let class = self.catalog.class(class);
        (object.flags, object.fluid) = (class.states_as_built(), class.fluid_as_built());
        if matches!(class.id.as_str(), "FuseBox_01" | "FuseBox_02") {
            object.feeds = circuit;
        }
        Ok(self.changes().add(object))
    }

    /// The circuit that feeds a room.
    pub(super) fn circuit_of(&self, room: RoomId) -> Option<i32> {
        self.layout.rooms.iter().find(|plan| plan.id == room).map(|plan| i32::from(plan.circuit))
    }
}

/// Nothing turned.
pub(super) const UPRIGHT: Quat = Quat::IDENTITY;
