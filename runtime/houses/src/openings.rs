//! Doors, passages and windows of a house, each in the wall that its rooms share or that leads outside.

use cohabit_cdf::layout::OpeningKind;
use cohabit_floorplans::parts::{Entry, Floor, Gap, Wall, borders, metres, outer, shared};

use crate::{
    error::HouseError,
    house::{House, HouseOpening, HouseOpeningKind},
    lattice::Lattice,
};

/// Width of doors, dm: that of their class.
const DOOR: i32 = 10;
/// The widest passage, dm.
const WIDEST: i32 = 30;
/// The narrowest window, dm.
const NARROWEST: i32 = 6;
/// From an opening to the end of its wall, and to another one, dm.
const END: i32 = 1;
/// The shortest wall for a door, dm.
const SHORTEST: i32 = DOOR + 2 * END;

/// The openings of a floor plan.
#[derive(Clone, Debug, Default)]
pub struct Openings {
    pub gaps: Vec<Gap>,
    /// Doors to the outside, one of a room at most.
    pub entries: Vec<Entry>,
    /// What is said of those that are left out.
    pub notes: Vec<String>,
}

/// An opening where it should be, on the lattice.
struct Wanted {
    kind: OpeningKind,
    at_m: [f32; 2],
    width: i32,
}

impl Openings {
    /// Those of a house whose rooms have these floors.
    ///
    /// # Errors
    /// [`HouseError::Content`], if one is of rooms that are not there.
    pub fn of(house: &House, lattice: &Lattice, floors: &[Floor]) -> Result<Self, HouseError> {
        let mut openings = Self::default();
        for opening in &house.openings {
            let rooms = rooms_of(opening, house)?;
            let wanted = Wanted::of(opening, lattice);
            let is_placed = match rooms.as_slice() {
                [one, other] => openings.join([*one, *other], &wanted, floors),
                [room] if opening.kind == HouseOpeningKind::Window => openings.add_window(*room, &wanted, floors),
                [room] => openings.add_entry(*room, &wanted, floors),
                _ => true,
            };
            if !is_placed {
                let what = if opening.kind == HouseOpeningKind::Window { "window" } else { "door" };
                openings.notes.push(format!("{}: no wall of its rooms has a place for the {what}", opening.at));
            }
        }
        openings.open_walls(house, lattice, floors);
        Ok(openings)
    }

    /// Puts an opening into a wall between two rooms; whether one has a place for it.
    fn join(&mut self, rooms: [usize; 2], wanted: &Wanted, floors: &[Floor]) -> bool {
        let all = borders(floors, SHORTEST).into_iter();
        let own = all.filter(|border| rooms.iter().all(|room| border.between.contains(room)));
        let found = own.filter_map(|border| {
            let (middle, width, away) = self.nearest(border.wall, wanted)?;
            Some((Gap { kind: wanted.kind, between: border.between, wall: border.wall, middle, width }, away))
        });
        let best = found.min_by(|one, other| one.1.total_cmp(&other.1));
        self.gaps.extend(best.as_ref().map(|(gap, _)| *gap));
        best.is_some()
    }

    fn add_window(&mut self, room: usize, wanted: &Wanted, floors: &[Floor]) -> bool {
        let Some((wall, middle, width)) = self.outside(room, wanted, floors) else { return false };
        self.gaps.push(Gap { kind: wanted.kind, between: [room, room], wall, middle, width });
        true
    }

    fn add_entry(&mut self, room: usize, wanted: &Wanted, floors: &[Floor]) -> bool {
        if self.entries.iter().any(|entry| entry.room == room) {
            return false;
        }
        // The door to the outside is as wide as all doors.
        let wanted = Wanted { kind: OpeningKind::Door, ..*wanted };
        let Some((wall, middle, width)) = self.outside(room, &wanted, floors) else { return false };
        self.entries.push(Entry { room, wall, middle, width });
        true
    }

    /// A place in an outer wall of a room.
    fn outside(&self, room: usize, wanted: &Wanted, floors: &[Floor]) -> Option<(Wall, i32, i32)> {
        let found = outer(floors, room).into_iter().filter_map(|wall| {
            let (middle, width, away) = self.nearest(wall, wanted)?;
            Some(((wall, middle, width), away))
        });
        found.min_by(|one, other| one.1.total_cmp(&other.1)).map(|(place, _)| place)
    }

    /// The free place along a wall that is nearest to where an opening should be: its middle, its width, and how far that is, m.
    fn nearest(&self, wall: Wall, wanted: &Wanted) -> Option<(i32, i32, f32)> {
        let room = (wall.length() - 2 * END) / 2 * 2;
        let width = match wanted.kind {
            OpeningKind::Door => DOOR,
            OpeningKind::Passage => wanted.width.clamp(DOOR, WIDEST).min(room),
            OpeningKind::Window => wanted.width.max(NARROWEST).min(room),
        };
        let least = if wanted.kind == OpeningKind::Window { NARROWEST } else { DOOR };
        let (from, to) = (wall.from + END + width / 2, wall.to - END - width / 2);
        if width < least || from > to {
            return None;
        }
        let away = |middle: i32| {
            let [x, y] = wall.point(metres(middle), 0.0);
            libm::hypotf(x - wanted.at_m[0], y - wanted.at_m[1])
        };
        let free = (from..=to).filter(|middle| self.is_free(wall, *middle, width));
        let best = free.min_by(|one, other| away(*one).total_cmp(&away(*other)))?;
        Some((best, width, away(best)))
    }

    /// Whether no other opening is there.
    fn is_free(&self, wall: Wall, middle: i32, width: i32) -> bool {
        let gaps = self.gaps.iter().map(|gap| (gap.wall, gap.middle, gap.width));
        let entries = self.entries.iter().map(|entry| (entry.wall, entry.middle, entry.width));
        gaps.chain(entries).all(|(other, at, wide)| {
            let is_same = other.axis() == wall.axis() && other.at == wall.at;
            !is_same || (at - middle).abs() >= (width + wide) / 2 + END
        })
    }

    /// Where a wall is not built, there is a passage.
    fn open_walls(&mut self, house: &House, lattice: &Lattice, floors: &[Floor]) {
        for border in borders(floors, SHORTEST) {
            let is_joined = |gap: &Gap| gap.is_way() && gap.between == border.between;
            if self.gaps.iter().any(is_joined) {
                continue;
            }
            let of_border = house.open_walls.iter().filter(|open| {
                border.between.iter().any(|room| house.rooms.get(*room).is_some_and(|room| room.id == open.room))
            });
            let stretch = of_border.filter_map(|open| {
                let [one, other] = open.ends_m.map(|end| lattice.point_m(end));
                shared(border.wall, opposite(border.wall, one, other)?)
            });
            let Some((from, to)) = stretch.max_by_key(|(from, to)| to - from) else { continue };
            let middle = metres(from + to) / 2.0;
            let at_m = border.wall.point(middle, 0.0);
            let wanted = Wanted { kind: OpeningKind::Passage, at_m, width: (to - from - 2 * END) / 2 * 2 };
            if wanted.width >= DOOR {
                self.join(border.between, &wanted, floors);
            }
        }
    }
}

/// A wall of a house as one that faces another one of the floor plan, if it is on the same line.
fn opposite(wall: Wall, one: [f32; 2], other: [f32; 2]) -> Option<Wall> {
    let (along, across) = if wall.axis() == cohabit_cdf::model::Axis::X { (0, 1) } else { (1, 0) };
    let dm = |m: f32| (m * 10.0).round() as i32;
    let is_on_line = dm(one[across]) == wall.at && dm(other[across]) == wall.at;
    let ends = [dm(one[along]), dm(other[along])];
    is_on_line.then(|| Wall {
        faces: wall.faces.back(),
        at: wall.at,
        from: ends[0].min(ends[1]),
        to: ends[0].max(ends[1]),
    })
}

impl Wanted {
    fn of(opening: &HouseOpening, lattice: &Lattice) -> Self {
        let kind = match opening.kind {
            HouseOpeningKind::Door => OpeningKind::Door,
            HouseOpeningKind::Frame => OpeningKind::Passage,
            HouseOpeningKind::Window => OpeningKind::Window,
        };
        let width = (opening.width_m.clamp(0.0, 20.0) * 5.0).round() as i32 * 2;
        Self { kind, at_m: lattice.point_m(opening.middle_m), width }
    }
}

/// The rooms of an opening: two, or one to the outside; none, if those were left out.
fn rooms_of(opening: &HouseOpening, house: &House) -> Result<Vec<usize>, HouseError> {
    let index = |id: &String| house.rooms.iter().position(|room| room.id == *id);
    let mut rooms: Vec<usize> = opening.rooms.iter().filter_map(index).collect();
    rooms.dedup();
    if rooms.is_empty() && !opening.rooms.iter().any(|id| house.left_out.contains(id)) {
        let reason = format!("there is neither a room `{}` nor `{}`", opening.rooms[0], opening.rooms[1]);
        return Err(HouseError::at(&format!("{}/room0", opening.at), reason, "name one of `rooms`"));
    }
    Ok(rooms)
}

/// Whether an opening of a room with these rectangles would be cut where two of them meet.
pub fn is_cut(opening: &HouseOpening, lattice: &Lattice, floor: &Floor) -> bool {
    let Wanted { at_m: [x, y], width, .. } = Wanted::of(opening, lattice);
    let half_m = metres(width) / 2.0;
    let is_near = |one: f32, other: f32| (one - other).abs() < 0.02;
    let is_within = |end: i32, at_m: f32| (metres(end) - at_m).abs() < half_m - 0.01;
    floor.rects.iter().any(|rect| {
        let lies_along = [rect.south, rect.north].into_iter().any(|line| is_near(metres(line), y));
        let stands_along = [rect.west, rect.east].into_iter().any(|line| is_near(metres(line), x));
        lies_along && [rect.west, rect.east].into_iter().any(|end| is_within(end, x))
            || stands_along && [rect.south, rect.north].into_iter().any(|end| is_within(end, y))
    })
}
