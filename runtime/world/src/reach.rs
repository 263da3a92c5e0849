//! What stands between a body and a thing: walls, doors, and the sides of what the thing is in.

use cohabit_cdf::ObjectId;
use glam::{Vec2, Vec3};

use crate::{
    facts::Facts,
    swing::{LEAF_M, Leaf},
};

/// Things on walls and in doorways touch the wall themselves: the last hand's breadth does not count, m.
const TOUCH_M: f32 = 0.2;
/// Height of a shoulder, m.
const SHOULDER_M: f32 = 1.0;
/// A hand bends around the edge of a front by so much, m.
const AROUND_M: f32 = 0.1;
/// A door of furniture that is open less than this gives way to an arm.
const WIDE: f32 = 0.99;

/// What a hand, or a look, does not get through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Barrier {
    /// A wall.
    Wall,
    /// The door or drawer of this object.
    Door(ObjectId),
    /// The sides of this object, which has to be reached into from its front.
    Side(ObjectId),
}

impl<'a> Facts<'a> {
    /// Its doors, lids and drawers, where they are now.
    pub fn leaves(&self, id: ObjectId) -> impl Iterator<Item = Leaf> + 'a {
        self.leaves_at(id, self.object(id).opened)
    }

    /// The same, were it open so far, 0 to 1.
    pub fn leaves_at(&self, id: ObjectId, opened: f32) -> impl Iterator<Item = Leaf> + 'a {
        let object = self.object(id);
        let scale = Vec3::from(object.scale);
        self.floor.swings.of(object.class).iter().map(move |swing| swing.leaf(&object.pose, scale, opened))
    }

    /// Whether the object is a door between rooms.
    pub fn is_room_door(&self, id: ObjectId) -> bool {
        self.floor.gaps.iter().any(|gap| gap.door_object == Some(id))
    }

    /// Whether anything stands between a body at `from` and the object.
    pub fn walled_off(&self, id: ObjectId, from: Vec2) -> bool {
        self.barrier(id, from).is_some()
    }

    /// What stands between a body at `from` and the object.
    pub fn barrier(&self, id: ObjectId, from: Vec2) -> Option<Barrier> {
        if let Some(hollow) = self.closed_side(id, from) {
            return Some(Barrier::Side(hollow));
        }
        let doors = self.doors_near(id, from);
        let shoulder = from.extend(SHOULDER_M);
        let between = |to: Vec3| {
            let line = to - shoulder;
            let level = line.truncate().length();
            if level <= TOUCH_M {
                return None;
            }
            let to = shoulder + line * ((level - TOUCH_M) / level);
            if self.floor.wall_between(from, to.truncate()) {
                return Some(Barrier::Wall);
            }
            doors.iter().find(|(_, leaf)| leaf.cuts(shoulder, to)).map(|(door, _)| Barrier::Door(*door))
        };
        let aim = self.aim_point(id);
        let at_aim = between(aim)?;
        between(self.footprint(id).closest(from).extend(aim.z)).map(|_| at_aim)
    }

    /// The closed kind of furniture around an object that a hand at `from` does not get straight into: it has sides and
    /// a back.
    fn closed_side(&self, id: ObjectId, from: Vec2) -> Option<ObjectId> {
        let aim = self.aim_point(id).truncate();
        let inside = std::iter::successors(Some(id), |id| self.object(*id).parent()).filter(|id| self.is_within(*id));
        let mut hollows = inside
            .filter_map(|id| self.object(id).parent())
            .filter(|parent| self.class(*parent).receptacle.as_ref().is_some_and(|kind| kind.enclosed));
        hollows.find(|hollow| {
            let print = self.footprint(*hollow);
            let (from, to, front) = (print.local(from), print.local(aim), print.half.x);
            let at_front = to.y + (from.y - to.y) * ((front - to.x) / (from.x - to.x)).clamp(0.0, 1.0);
            from.x <= front || at_front.abs() > print.half.y + AROUND_M
        })
    }

    /// The leaves that could stand between a body and an object: of doors between rooms, and of furniture that stands
    /// wide open.
    fn doors_near(&self, id: ObjectId, from: Vec2) -> Vec<(ObjectId, Leaf)> {
        let to = self.object(id).pose.position.truncate();
        let (low, high) = (from.min(to) - LEAF_M, from.max(to) + LEAF_M);
        let near = self.state.existing().filter(|(other, object)| {
            let at = object.pose.position.truncate();
            *other != id
                && at.cmpge(low).all()
                && at.cmple(high).all()
                && !self.floor.swings.of(object.class).is_empty()
                && (object.opened >= WIDE || self.is_room_door(*other))
        });
        near.flat_map(|(other, _)| self.leaves(other).map(move |leaf| (other, leaf))).collect()
    }
}
