//! What of a house stands in each room of its floor plan, and what lies on it.

use cohabit_cdf::{Catalog, ClassId};
use cohabit_floorplans::parts::{Arrangement, Gap, Note, Places, Site, Thing, Turn, View, WALL_HEIGHT_M, notes, views};

use crate::{
    house::HouseObject,
    lattice::Lattice,
    poses::{Pose, Stance, Wanted},
    report::{Reason, Tally},
    types::{ObjectType, TypeTable, classes},
    walk::begins_on_its_floor,
};

/// What is so much nearer to its place than the next class is of the next class, m.
const NEXT_CLASS_M: f32 = 0.4;
/// What has both on the floor and on walls hangs from this height of its middle on, m.
const HUNG_FROM_M: f32 = 1.2;
/// What is for furniture and has its middle below this height is on the floor, m.
const LYING_M: f32 = 0.35;
/// The farthest that something lies from the furniture that it is on, if the house does not say which, m.
const REACH_M: f32 = 1.2;
/// What is so far from its place counts as moved, m.
const MOVED_M: f32 = 0.25;
/// So many places that there is room at are tried: at each it is in the way.
const TRIES: usize = 80;
/// The lowest and the highest foot of what hangs, m.
const HUNG_M: [f32; 2] = [0.2, 2.0];

/// An object of a house that stands on the floor or hangs on a wall of a room.
#[derive(Clone, Debug)]
pub struct Item<'a> {
    kind: &'a str,
    /// The best first.
    classes: Vec<ClassId>,
    wanted: Wanted,
    /// The height of its middle, m, by which what hangs is hung.
    middle_height_m: f32,
    /// What is on it.
    things: Vec<Small<'a>>,
}

/// An object that is on furniture.
#[derive(Clone, Debug)]
pub struct Small<'a> {
    kind: &'a str,
    classes: Vec<ClassId>,
    at_m: [f32; 3],
    yaw_deg: f32,
}

/// All that is to be in one room.
#[derive(Clone, Debug, Default)]
pub struct Contents<'a> {
    items: Vec<Item<'a>>,
    /// What is on furniture, nobody says which.
    loose: Vec<Small<'a>>,
    /// Whether all ways begin in this room.
    is_start: bool,
    tally: Tally,
}

/// A room with all that is in it.
#[derive(Debug)]
pub struct Furnished<'a> {
    pub site: Site<'a>,
    pub things: Vec<Thing>,
    pub views: Vec<View>,
    pub notes: Vec<Note>,
    pub tally: Tally,
}

/// Sorts the objects of a house by what becomes of them.
pub struct Sorter<'a> {
    pub types: &'a TypeTable,
    pub catalog: &'a Catalog,
    pub lattice: &'a Lattice,
}

impl<'a> Sorter<'a> {
    /// Adds an object to the contents of its room.
    pub fn add(&self, object: &'a HouseObject, contents: &mut Contents<'a>) {
        let Some(kind) = self.types.find(&object.kind).filter(|kind| !kind.is_without_class()) else {
            contents.tally.leave_out(&object.kind, Reason::NoClass);
            // What is on it is nowhere.
            return self.leave_out_children(object, &mut contents.tally);
        };
        let height_m = object.middle_m[2] as f32;
        let on_floor = classes(kind.on_floor(height_m * 2.0), self.catalog);
        let is_hung = !kind.wall.is_empty() && (on_floor.is_empty() || height_m > HUNG_FROM_M);
        let is_lying = on_floor.is_empty() && !is_hung && height_m < LYING_M;
        let classes = if is_hung {
            classes(&kind.wall, self.catalog)
        } else if is_lying {
            classes(&kind.surface, self.catalog)
        } else {
            on_floor
        };
        if classes.is_empty() {
            contents.loose.extend(self.small(object, kind));
            return self.add_children(object, &mut contents.loose, &mut contents.tally);
        }
        let stance = match (is_hung, kind.backed) {
            (true, _) => Stance::Hung,
            (false, true) => Stance::Backed,
            (false, false) => Stance::Free,
        };
        let wanted = Wanted { middle_m: self.point_m(object), height_m: 0.0, turn: turn(object.yaw_deg), stance };
        let mut things = Vec::new();
        self.add_children(object, &mut things, &mut contents.tally);
        contents.items.push(Item { kind: &object.kind, classes, wanted, middle_height_m: height_m, things });
    }

    /// What is on an object, and on that.
    fn add_children(&self, object: &'a HouseObject, things: &mut Vec<Small<'a>>, tally: &mut Tally) {
        for child in &object.children {
            let kind = self.types.find(&child.kind).filter(|kind| !kind.surface.is_empty());
            match kind.and_then(|kind| self.small(child, kind)) {
                Some(small) => things.push(small),
                None => tally.leave_out(&child.kind, Reason::NoClass),
            }
            self.add_children(child, things, tally);
        }
    }

    fn leave_out_children(&self, object: &HouseObject, tally: &mut Tally) {
        for child in &object.children {
            let is_known = self.types.find(&child.kind).is_some_and(|kind| !kind.is_without_class());
            tally.leave_out(&child.kind, if is_known { Reason::NoHolder } else { Reason::NoClass });
            self.leave_out_children(child, tally);
        }
    }

    fn small(&self, object: &'a HouseObject, kind: &ObjectType) -> Option<Small<'a>> {
        let classes = classes(&kind.surface, self.catalog);
        let [x, y] = self.point_m(object);
        let at_m = [x, y, object.middle_m[2] as f32];
        (!classes.is_empty()).then(|| Small { kind: &object.kind, classes, at_m, yaw_deg: yaw(object.yaw_deg) })
    }

    /// Where an object is in the floor plan, m.
    pub fn point_m(&self, object: &HouseObject) -> [f32; 2] {
        self.lattice.point_m([object.middle_m[0], object.middle_m[1]])
    }

    /// Counts an object that is in no room, and what is on it.
    pub fn leave_out(&self, object: &HouseObject, tally: &mut Tally) {
        let is_known = self.types.find(&object.kind).is_some_and(|kind| !kind.is_without_class());
        tally.leave_out(&object.kind, if is_known { Reason::OutsideRooms } else { Reason::NoClass });
        self.leave_out_children(object, tally);
    }
}

/// The quarter turn that is nearest to a yaw.
fn turn(yaw_deg: f64) -> Turn {
    Turn::of_degrees((yaw_deg.rem_euclid(360.0) / 90.0).round() as i32 * 90)
}

/// A yaw from -180 to 180 degrees.
fn yaw(yaw_deg: f64) -> f32 {
    ((yaw_deg + 180.0).rem_euclid(360.0) - 180.0) as f32
}

impl<'a> Contents<'a> {
    /// Those of the room where all ways begin, or of another one.
    pub fn of(is_start: bool) -> Self {
        Self { is_start, ..Self::default() }
    }

    /// Furnishes a bare room; nothing, if it has too little free floor or wall whatever stands in it.
    pub fn furnish<'c>(mut self, bare: &Site<'c>, door: Option<&Gap>, room: usize) -> Option<Furnished<'c>> {
        // What needs much room has the first choice.
        let area = |item: &Item<'_>| item.classes.first().map_or(0.0, |class| footprint_m2(bare.catalog, *class));
        self.items.sort_by(|one, other| area(other).total_cmp(&area(one)));
        let mut most = self.items.len();
        loop {
            let (site, holders, tally) = self.stand(bare, most);
            if let (Some(views), Some(notes)) = (views(&site, door, room), notes(&site)) {
                let mut furnished = Furnished { site, things: Vec::new(), views, notes, tally };
                self.lay(&holders, &mut furnished);
                return Some(furnished);
            }
            // Furniture leaves no place to stand or for notes: there is less of it.
            most = most.checked_sub(1)?;
        }
    }

    /// Puts the first of the items down. Gives for each its place among the furniture, if it has one.
    fn stand<'c>(&self, bare: &Site<'c>, most: usize) -> (Site<'c>, Vec<Option<usize>>, Tally) {
        let (mut site, mut tally, mut holders) = (bare.clone(), self.tally.clone(), Vec::new());
        for (index, item) in self.items.iter().enumerate() {
            let placed = if index < most { item.place(&mut site, self.is_start) } else { Err(Reason::InTheWay) };
            match placed {
                Ok(is_moved) => {
                    tally.place(is_moved);
                    holders.push(Some(site.placed.len() - 1));
                }
                Err(reason) => {
                    tally.leave_out(item.kind, reason);
                    holders.push(None);
                }
            }
        }
        (site, holders, tally)
    }

    /// Puts down what is on the furniture.
    fn lay(&self, holders: &[Option<usize>], furnished: &mut Furnished<'_>) {
        let Furnished { site, things, tally, .. } = furnished;
        let mut places: Vec<Option<Places<'_>>> =
            (0..site.placed.len()).map(|index| Places::of(&site.placed, index, site.catalog)).collect();
        let near = |small: &Small<'_>, holder: usize| {
            let placed = &site.placed[holder];
            let [x, y] = [0, 1].map(|axis| small.at_m[axis] - placed.at_m[axis]);
            let [x, y] = placed.turn.inverse().apply([x, y]);
            [x, y, small.at_m[2] - placed.at_m[2]]
        };
        let mut lay = |small: &Small<'_>, holder: Option<usize>, places: &mut [Option<Places<'_>>]| {
            let Some(holder) = holder else { return tally.leave_out(small.kind, Reason::NoHolder) };
            let near_m = near(small, holder);
            let put = |places: &mut Places<'_>| {
                small.classes.iter().find_map(|class| {
                    let height_m = site.catalog.class(*class).size_m[2];
                    places.put(*class, [near_m[0], near_m[1], near_m[2] - height_m / 2.0], small.yaw_deg)
                })
            };
            match places.get_mut(holder).and_then(Option::as_mut).and_then(put) {
                Some(thing) => {
                    let is_far =
                        thing.at_m.is_some_and(|[x, y, _]| libm::hypotf(x - near_m[0], y - near_m[1]) > MOVED_M);
                    tally.place(is_far);
                    things.push(thing);
                }
                None => tally.leave_out(small.kind, Reason::HolderFull),
            }
        };
        for (item, holder) in self.items.iter().zip(holders) {
            for small in &item.things {
                lay(small, *holder, &mut places);
            }
        }
        for small in &self.loose {
            let away = |index: &usize| {
                let [x, y, _] = site.placed[*index].at_m;
                libm::hypotf(x - small.at_m[0], y - small.at_m[1])
            };
            let takes = holders.iter().flatten().copied().filter(|index| places[*index].is_some());
            let nearest = takes.min_by(|one, other| away(one).total_cmp(&away(other)));
            lay(small, nearest.filter(|index| away(index) < REACH_M), &mut places);
        }
    }
}

fn footprint_m2(catalog: &Catalog, class: ClassId) -> f32 {
    let [depth, width, _] = catalog.class(class).size_m;
    depth * width
}

impl Item<'_> {
    /// Puts it at the nearest free place; says whether that is another one than in the house.
    fn place(&self, site: &mut Site<'_>, is_start: bool) -> Result<bool, Reason> {
        let mut in_the_way = 0;
        let mut tries = Vec::new();
        for (rank, class) in self.classes.iter().enumerate() {
            let arrangement = Arrangement::of(*class, site.catalog);
            let wanted = Wanted { height_m: self.foot_m(site.catalog, *class), ..self.wanted };
            let poses = wanted.poses(site, &arrangement).into_iter();
            tries.extend(poses.map(|pose| (pose.cost_m + rank as f32 * NEXT_CLASS_M, pose, rank)));
        }
        tries.sort_by(|one, other| one.0.total_cmp(&other.0));
        for (_, pose, rank) in tries {
            let arrangement = Arrangement::of(self.classes[rank], site.catalog);
            if put(site, &arrangement, pose, is_start) {
                let [x, y] = [0, 1].map(|axis| pose.origin_m[axis] - self.wanted.middle_m[axis]);
                return Ok(pose.turn != self.wanted.turn || libm::hypotf(x, y) > MOVED_M);
            }
            in_the_way += usize::from(site.is_free_for(&arrangement, pose.origin_m, pose.turn));
            if in_the_way == TRIES {
                break;
            }
        }
        Err(if in_the_way > 0 { Reason::InTheWay } else { Reason::NoSpace })
    }

    /// The height of its foot, m.
    fn foot_m(&self, catalog: &Catalog, class: ClassId) -> f32 {
        if self.wanted.stance != Stance::Hung {
            return 0.0;
        }
        let height_m = catalog.class(class).size_m[2];
        let [low, high] = HUNG_M;
        (self.middle_height_m - height_m / 2.0).clamp(low, high.min(WALL_HEIGHT_M - height_m).max(low))
    }
}

/// Puts something down, unless it would be in the way.
fn put(site: &mut Site<'_>, arrangement: &Arrangement, pose: Pose, is_start: bool) -> bool {
    let before = is_start.then(|| site.clone());
    let is_placed = site.try_place(arrangement, pose.origin_m, pose.turn);
    match before {
        Some(before) if is_placed && !begins_on_its_floor(site) => {
            *site = before;
            false
        }
        _ => is_placed,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_yaw_goes_to_the_nearest_quarter_turn() {
        for (yaw_deg, expected) in [
            (90.0, Turn::NORTH),
            (-90.0, Turn::SOUTH),
            (44.0, Turn::EAST),
            (46.0, Turn::NORTH),
            (359.0, Turn::EAST),
            (-630.0, Turn::NORTH),
        ] {
            assert_eq!(turn(yaw_deg), expected, "{yaw_deg}");
        }
        assert_eq!([yaw(270.0), yaw(-90.0), yaw(180.0), yaw(725.0)], [-90.0, -90.0, -180.0, 5.0]);
    }
}
