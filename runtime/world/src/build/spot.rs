//! Free spots on the floor and the walls of a room, for what a mission wants beyond the floor plan.

use cohabit_cdf::{ObjectId, Property, RoomId};
use glam::{Vec2, Vec3};

use super::{BuildError, Builder, on_floor};
use crate::{
    entity::Support,
    floor::WALL_THICKNESS_M,
    geometry::{Footprint, Pose, direction},
    navigation::{Navigation, blocks_the_way},
};

/// Tries before a room counts as full.
const TRIES: usize = 300;
/// Free floor kept in front of furniture, m.
const FRONT_M: f32 = 0.8;
/// Free floor kept around doors, m.
const DOOR_M: f32 = 1.0;
/// Height at which things are hung, m.
const HANG_M: f32 = 1.35;

/// A wall of a room, seen from inside: where it begins, where it ends, and the heading away from it, rad.
type Side = (Vec2, Vec2, f32);

impl Builder<'_> {
    /// Stands an object somewhere free on the floor of a room: furniture with its back to a wall, if it can.
    pub(super) fn stand_somewhere(&mut self, id: ObjectId, room: RoomId) -> Result<(), BuildError> {
        let sides = self.sides(room);
        let half = self.facts().size(id).truncate() / 2.0;
        let small = self.facts().has(id, Property::Pickupable);
        let area_before = self.blocking(id).then(|| self.reachable());
        for attempt in 0..TRIES {
            let (start, end, yaw_rad) = sides[self.pick(sides.len())];
            let along = self.fraction();
            // Later tries stand further into the room.
            let depth = if small { self.fraction() * 1.5 + 0.1 } else { 0.03 + 0.01 * attempt as f32 };
            let wall = start.lerp(end, along);
            let center = wall + direction(yaw_rad) * (WALL_THICKNESS_M / 2.0 + depth + half.x);
            let print = Footprint::new(center, half, yaw_rad);
            if !self.is_free(&print, room, if small { 0.1 } else { FRONT_M }) {
                continue;
            }
            self.fix(id, Pose::level(on_floor(center), yaw_rad), room);
            if area_before.is_none_or(|before| self.leaves_ways(before, &print)) {
                return Ok(());
            }
        }
        Err(self.no_free_spot(&self.state.at(id).instance, room))
    }

    /// Hangs an object somewhere free on a wall of a room.
    pub(super) fn hang_somewhere(&mut self, id: ObjectId, room: RoomId) -> Result<(), BuildError> {
        let sides = self.sides(room);
        let size = self.facts().size(id);
        for _ in 0..TRIES {
            let (start, end, yaw_rad) = sides[self.pick(sides.len())];
            let wall = start.lerp(end, self.fraction());
            let out = direction(yaw_rad);
            let center = wall + out * (WALL_THICKNESS_M / 2.0 + size.x / 2.0 + 0.002);
            let print = Footprint::new(center, size.truncate() / 2.0, yaw_rad);
            let at_wall = [-1.0, 1.0].iter().all(|side| {
                let edge = wall + out.perp() * (size.y / 2.0 * side);
                self.floor.walls.iter().any(|stretch| stretch.distance(edge) < 0.02)
            });
            let taken = self.state.existing().any(|(other, object)| {
                let top = object.pose.position.z + self.facts().size(other).z;
                other != id && top > HANG_M - 0.1 && self.facts().footprint(other).overlaps(&print.grown(0.05))
            });
            if at_wall && !taken {
                self.fix(id, Pose::level(center.extend(HANG_M), yaw_rad), room);
                return Ok(());
            }
        }
        Err(self.no_free_spot(&self.state.at(id).instance, room))
    }

    /// A room is full.
    pub(super) fn no_free_spot(&self, object: &str, room: RoomId) -> BuildError {
        BuildError::NoFreeSpot { object: object.to_owned(), room: room.name_in(self.catalog).to_owned() }
    }

    fn fix(&mut self, id: ObjectId, pose: Pose, room: RoomId) {
        let object = self.state.at_mut(id);
        object.support = Support::Fixed;
        object.pose = pose;
        object.room = room;
    }

    /// The walls around a room, from inside.
    fn sides(&self, room: RoomId) -> Vec<Side> {
        use std::f32::consts::{FRAC_PI_2, PI};
        self.floor
            .rects(room)
            .flat_map(|[west, south, east, north]| {
                let [sw, se] = [Vec2::new(west, south), Vec2::new(east, south)];
                let [nw, ne] = [Vec2::new(west, north), Vec2::new(east, north)];
                [(sw, se, FRAC_PI_2), (nw, ne, -FRAC_PI_2), (sw, nw, 0.0), (se, ne, PI)]
            })
            .collect()
    }

    fn blocking(&self, id: ObjectId) -> bool {
        let size: Vec3 = self.facts().size(id);
        !self.facts().has(id, Property::Pickupable) && size.z > 0.1
    }

    /// Whether a rectangle of floor is free, with room before it, and clear of doors.
    fn is_free(&self, print: &Footprint, room: RoomId, front_m: f32) -> bool {
        let facts = self.facts();
        let inside = print.corners().iter().all(|corner| facts.floor.room_at(*corner) == Some(room));
        let before = Footprint {
            center: print.center + print.axis * (front_m / 2.0),
            half: print.half + Vec2::new(front_m / 2.0, 0.0),
            ..*print
        };
        inside
            && !facts.floor.walls.iter().any(|wall| wall.overlaps(print))
            && !facts.floor.gaps.iter().any(|gap| gap.print.grown(DOOR_M).overlaps(print))
            && !facts.state.existing().any(|(id, object)| {
                let low = object.parent().is_none() && object.pose.position.z < 1.0;
                low && (blocks_the_way(&facts, id) || facts.has(id, Property::Pickupable))
                    && facts.footprint(id).overlaps(&before)
            })
    }

    /// How many of the named viewpoints can be walked to from the first one of all.
    fn reachable(&self) -> usize {
        let navigation = Navigation::new(&self.facts());
        let mut points = self.layout.viewpoints.iter().map(|viewpoint| Vec2::from(viewpoint.at_m));
        let Some(first) = points.next() else { return 0 };
        points.filter(|point| navigation.path(first, *point).is_some()).count()
    }

    /// Whether as many viewpoints can be walked to as before, but for those that the new thing stands on.
    fn leaves_ways(&self, before: usize, print: &Footprint) -> bool {
        let covered =
            self.layout.viewpoints.iter().filter(|viewpoint| print.distance(viewpoint.at_m.into()) < 0.3).count();
        self.reachable() + covered >= before
    }
}
