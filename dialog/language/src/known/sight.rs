//! What an eye takes in: its field of view, how small a thing still shows, and what stands in between.

use cohabit_cdf::{Catalog, ObjectClass, ObjectId, Property, RoomId, catalog::Stands};

use crate::known::{
    Known, KnownObject,
    floor::{FloorPlan, distance_m},
};

/// How far off things are looked for, m: what is tiny is not looked for from a foot away, nor what is large from afar.
pub(crate) const REACH_M: (f32, f32) = (1.5, 8.0);

/// Half the field of view of the egocentric camera, both ways: it takes in 60 degrees.
const HALF_VIEW_RAD: f32 = std::f32::consts::FRAC_PI_6;
/// Its pictures are so wide and high, pixels.
const PICTURE: f32 = 300.0;
/// What shows fewer pixels is overlooked.
const LEAST_PIXELS: f32 = 12.0;
/// Thickness of a board of open furniture, m.
const BOARD_M: f32 = 0.04;
/// What is smaller than this hides nothing worth the name, m.
const SMALL_M: f32 = 0.25;
/// The share of its box that a thing on a table fills: computers are mostly air.
const FILLED: f32 = 0.7;
/// The heights at which one looks at a piece of floor, m: that of tables, and that of what lies on the floor.
pub(crate) const TABLE_M: f32 = 0.8;
pub(crate) const FLOOR_M: f32 = 0.1;
/// From how far the floor is in view of a robot that looks straight ahead: its eye is 1.3 m up, m.
pub(crate) const FLOOR_FROM_M: f32 = 2.1;

/// Where an eye is, and where it looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaze {
    /// The eye, m, in the world.
    pub eye_m: [f32; 3],
    /// The room it is in.
    pub room: RoomId,
    /// Where it looks, in the world.
    pub yaw_rad: f32,
    /// How far up it looks.
    pub pitch_rad: f32,
    /// Whether it has just looked all around from here.
    pub is_around: bool,
}

/// One look: the eye, and all large things in its room.
pub(crate) struct Sight<'a> {
    catalog: &'a Catalog,
    plan: &'a FloorPlan,
    pub(crate) gaze: Gaze,
    blocks: Vec<Block>,
}

/// A box that hides what is behind it.
struct Block {
    of: ObjectId,
    on: Option<ObjectId>,
    at_m: [f32; 3],
    yaw: [f32; 2],
    center_m: [f32; 3],
    half_m: [f32; 3],
}

impl Gaze {
    /// Whether a point is within the field of view.
    fn takes_in(&self, point_m: [f32; 3]) -> bool {
        let [dx, dy, dz] = [0, 1, 2].map(|axis| point_m[axis] - self.eye_m[axis]);
        let (sin, cos) = self.yaw_rad.sin_cos();
        let level = if self.is_around { (dx * dx + dy * dy).sqrt() } else { dx * cos + dy * sin };
        let aside = if self.is_around { 0.0 } else { dy * cos - dx * sin };
        let (sin, cos) = self.pitch_rad.sin_cos();
        let (ahead, up) = (level * cos + dz * sin, dz * cos - level * sin);
        let widest = ahead * HALF_VIEW_RAD.tan();
        ahead > 0.0 && aside.abs() <= widest && up.abs() <= widest
    }
}

/// From how far a thing of a class still shows, m.
pub(crate) fn reach_m(class: &ObjectClass) -> f32 {
    let [x, y, z] = class.size_m;
    // A convex body shows a quarter of its surface, over all directions (Cauchy).
    let area = (x * y + y * z + z * x) / 2.0;
    let focal = PICTURE / 2.0 / HALF_VIEW_RAD.tan();
    focal * (area / LEAST_PIXELS).sqrt()
}

impl<'a> Sight<'a> {
    /// A look at `world`, in which all is that there is.
    pub(crate) fn new(catalog: &'a Catalog, plan: &'a FloorPlan, gaze: Gaze, world: &Known) -> Self {
        let is_solid = |object: &&KnownObject| {
            let size = catalog.class(object.class).size_m;
            let is_held = world.robot.held == Some(object.id);
            object.room == gaze.room
                && !object.is_hidden
                && !is_held
                && !plan.has_door(&object.instance)
                && size.iter().any(|side| *side >= SMALL_M)
        };
        let blocks = world.objects.iter().filter(is_solid).flat_map(|object| blocks(catalog, object)).collect();
        Self { catalog, plan, gaze, blocks }
    }

    /// Whether this thing is seen, if it is there; what encloses it is the caller's to know.
    pub(crate) fn sees(&self, object: &KnownObject, ancestors: &[ObjectId]) -> bool {
        let class = self.catalog.class(object.class);
        let eye = self.gaze.eye_m;
        let at = [object.position_m[0], object.position_m[1]];
        if object.room != self.gaze.room
            || distance_m(eye, object.position_m) > reach_m(class)
            || !self.plan.is_straight(self.gaze.room, [eye[0], eye[1]], at)
        {
            return false;
        }
        let is_own =
            |block: &Block| block.of == object.id || block.on == Some(object.id) || ancestors.contains(&block.of);
        marks(object, class).into_iter().any(|point| {
            self.gaze.takes_in(point) && !self.blocks.iter().any(|block| !is_own(block) && block.hides(eye, point))
        })
    }

    /// From how near the places of the floor are seen that are seen at a height, by cell, m.
    pub(crate) fn floor(&self, height_m: f32) -> impl Iterator<Item = (usize, f32)> {
        let eye = self.gaze.eye_m;
        let cells = self.plan.cells.iter().enumerate().filter(|(_, cell)| cell.room == self.gaze.room);
        cells.filter_map(move |(index, cell)| {
            let point = [cell.at_m[0], cell.at_m[1], height_m];
            let is_seen = self.gaze.takes_in(point)
                && self.plan.is_straight(cell.room, [eye[0], eye[1]], cell.at_m)
                && !self.blocks.iter().any(|block| !block.holds(point) && block.hides(eye, point));
            is_seen.then(|| (index, distance_m(eye, point)))
        })
    }
}

/// The points of a thing that are looked for: its middle, and places near its ends.
fn marks(object: &KnownObject, class: &ObjectClass) -> [[f32; 3]; 6] {
    let size = class.size_m;
    let (sin, cos) = object.yaw_rad.sin_cos();
    let at = |x: f32, y: f32, z: f32| {
        let (x, y) = (x * size[0], y * size[1]);
        let [px, py, pz] = object.position_m;
        [px + cos * x - sin * y, py + sin * x + cos * y, pz + z * size[2]]
    };
    [at(0.0, 0.0, 0.5), at(0.0, 0.0, 0.9), at(0.4, 0.0, 0.5), at(-0.4, 0.0, 0.5), at(0.0, 0.4, 0.5), at(0.0, -0.4, 0.5)]
}

/// Open furniture is its boards; everything else is its whole box.
fn blocks(catalog: &Catalog, object: &KnownObject) -> Vec<Block> {
    let class = catalog.class(object.class);
    let (sin, cos) = object.yaw_rad.sin_cos();
    let block = |center_m, half_m| Block {
        of: object.id,
        on: object.parent,
        at_m: object.position_m,
        yaw: [cos, sin],
        center_m,
        half_m,
    };
    match &class.receptacle {
        Some(kind) if !kind.enclosed && !class.has(Property::Powerable) => {
            let board = |[x, y, z]: [f32; 3], [width, depth]: [f32; 2]| {
                block([x, y, z - BOARD_M / 2.0], [width / 2.0, depth / 2.0, BOARD_M / 2.0])
            };
            kind.surfaces.iter().map(|surface| board(surface.center_m, surface.size_m)).collect()
        }
        _ => {
            let share = if class.stands == Stands::OnSurface { FILLED } else { 1.0 };
            let [x, y, z] = class.size_m.map(|side| side / 2.0);
            vec![block([0.0, 0.0, z], [x * share, y * share, z])]
        }
    }
}

impl Block {
    fn local(&self, point: [f32; 3]) -> [f32; 3] {
        let [dx, dy, dz] = [0, 1, 2].map(|axis| point[axis] - self.at_m[axis]);
        let [cos, sin] = self.yaw;
        let [x, y, z] = self.center_m;
        [cos * dx + sin * dy - x, cos * dy - sin * dx - y, dz - z]
    }

    /// Whether the point stands on the floor that it covers.
    fn holds(&self, point: [f32; 3]) -> bool {
        let local = self.local(point);
        local[0].abs() <= self.half_m[0] && local[1].abs() <= self.half_m[1]
    }

    /// Whether the straight line from `eye` to `point` goes through it.
    fn hides(&self, eye: [f32; 3], point: [f32; 3]) -> bool {
        let (from, to) = (self.local(eye), self.local(point));
        // What is within the box of another thing is where that has a gap.
        if (0..3).all(|axis| to[axis].abs() <= self.half_m[axis]) {
            return false;
        }
        let (mut enter, mut leave) = (0.0_f32, 1.0_f32);
        for axis in 0..3 {
            let along = to[axis] - from[axis];
            let half = self.half_m[axis];
            if along.abs() < 1e-6 {
                if from[axis].abs() > half {
                    return false;
                }
                continue;
            }
            let (one, two) = ((-half - from[axis]) / along, (half - from[axis]) / along);
            enter = enter.max(one.min(two));
            leave = leave.min(one.max(two));
        }
        enter < leave
    }
}

/// From how far a thing of a class is looked for, m.
pub(crate) fn reach_of(class: &ObjectClass) -> f32 {
    reach_m(class).clamp(REACH_M.0, REACH_M.1)
}
