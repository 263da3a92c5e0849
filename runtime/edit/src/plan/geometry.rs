//! Where things lie on a floor plan: walls, outlines from above, and what is under a point.

use cohabit_cdf::{
    Catalog, Layout, RoomId,
    catalog::{ObjectClass, Stands},
    layout::{OpeningKind, Placement},
    model::Axis,
};

/// Half the thickness of walls, m.
pub const HALF_WALL_M: f32 = 0.06;
/// Rounding in plan files, m.
const SLACK_M: f32 = 0.002;
/// The lattice on which things that are dragged stand, m.
const LATTICE_M: f32 = 0.05;
/// Furniture that is dropped nearer to a wall stands at it, m.
const MAGNET_M: f32 = 0.2;
/// Sides of rooms that are drawn nearer to a wall of another room lie on it, m.
const ROOM_MAGNET_M: f32 = 0.25;
/// The lattice on which rooms are drawn, m.
const ROOM_LATTICE_M: f32 = 0.1;
/// The farthest from a wall that a door or a window may be dropped, m.
const OPENING_REACH_M: f32 = 1.0;
/// Kept of a wall at each end of an opening, m.
const END_M: f32 = 0.1;

/// A side of a room, in the middle of its wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wall {
    /// Whose side it is.
    pub room: RoomId,
    /// Which way it runs.
    pub runs: Axis,
    /// Where it lies, across the way that it runs, m.
    pub at_m: f32,
    /// From where to where it runs, m.
    pub span_m: [f32; 2],
    /// 1 if its room is north or east of it, and -1 if it is south or west.
    pub inward: f32,
}

impl Wall {
    /// The point on it that lies so far along, moved into the room, m.
    #[must_use]
    pub const fn point(&self, along_m: f32, inward_m: f32) -> [f32; 2] {
        let across = self.at_m + self.inward * inward_m;
        match self.runs {
            Axis::X => [along_m, across],
            _ => [across, along_m],
        }
    }

    /// The way that faces the room, degrees.
    #[must_use]
    pub const fn yaw_deg(&self) -> f32 {
        match (self.runs, self.inward > 0.0) {
            (Axis::X, true) => 90.0,
            (Axis::X, false) => -90.0,
            (_, true) => 0.0,
            (_, false) => 180.0,
        }
    }

    /// `[along, across]` of a point, m.
    #[must_use]
    pub const fn local(&self, [x, y]: [f32; 2]) -> [f32; 2] {
        match self.runs {
            Axis::X => [x, y],
            _ => [y, x],
        }
    }

    /// How far a point is from it, m.
    #[must_use]
    pub fn distance_m(&self, point_m: [f32; 2]) -> f32 {
        let [along, across] = self.local(point_m);
        libm::hypotf(along - along.clamp(self.span_m[0], self.span_m[1]), across - self.at_m)
    }
}

/// The sides of all rooms, but for those along which a room goes on.
#[must_use]
pub fn walls(layout: &Layout) -> Vec<Wall> {
    let mut walls = Vec::new();
    for room in &layout.rooms {
        for [west, south, east, north] in room.rects_m.iter().copied() {
            let sides = [
                (Axis::X, south, [west, east], 1.0),
                (Axis::X, north, [west, east], -1.0),
                (Axis::Y, west, [south, north], 1.0),
                (Axis::Y, east, [south, north], -1.0),
            ];
            for (runs, at_m, span_m, inward) in sides {
                let wall = Wall { room: room.id, runs, at_m, span_m, inward };
                let [x, y] = wall.point(f32::midpoint(span_m[0], span_m[1]), -HALF_WALL_M);
                // The span of a rectangle that was written the wrong way round is none.
                if !room.has(x, y) && span_m[0] < span_m[1] {
                    walls.push(wall);
                }
            }
        }
    }
    walls
}

/// A gap in a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// The two rooms that it joins, as plan files have them.
    pub between: [RoomId; 2],
    /// Its middle, m.
    pub at_m: [f32; 2],
    /// Which way its wall runs.
    pub runs: Axis,
}

/// The gap of that width nearest to a point.
///
/// # Errors
/// Why there is none, in words.
pub fn gap_at(layout: &Layout, kind: OpeningKind, width_m: f32, point_m: [f32; 2]) -> Result<Gap, String> {
    let walls = walls(layout);
    let nearest = walls.iter().min_by(|one, other| one.distance_m(point_m).total_cmp(&other.distance_m(point_m)));
    let wall = nearest.filter(|wall| wall.distance_m(point_m) <= OPENING_REACH_M);
    let wall = wall.ok_or("there is no wall here: choose a place on one")?;
    let [along, _] = wall.local(point_m);
    let along = along.clamp(wall.span_m[0], wall.span_m[1]);
    let is_behind = |other: &&Wall| {
        let is_on_line = other.runs == wall.runs && (other.at_m - wall.at_m).abs() < SLACK_M;
        other.room != wall.room && is_on_line && other.span_m[0] <= along && along <= other.span_m[1]
    };
    let behind = walls.iter().find(is_behind);
    let (between, span_m) = match (kind, behind) {
        (OpeningKind::Window, None) => ([wall.room; 2], wall.span_m),
        (OpeningKind::Window, Some(_)) => {
            return Err("a window is in a wall to the outside, and there is a room behind this one".to_owned());
        }
        (_, None) => return Err("doors and passages join two rooms, and there is none behind this wall".to_owned()),
        (_, Some(other)) => {
            let span_m = [wall.span_m[0].max(other.span_m[0]), wall.span_m[1].min(other.span_m[1])];
            (if wall.inward < 0.0 { [wall.room, other.room] } else { [other.room, wall.room] }, span_m)
        }
    };
    let [least, most] = [span_m[0] + width_m / 2.0 + END_M, span_m[1] - width_m / 2.0 - END_M];
    if least > most {
        return Err(format!("the wall is too short here for an opening of {width_m} m"));
    }
    let along = on_lattice(along, LATTICE_M).clamp(least, most);
    Ok(Gap { between, at_m: wall.point(along, 0.0), runs: wall.runs })
}

/// A rectangle as it is drawn, with its sides on those of other rooms that are near.
#[must_use]
pub fn rect_at(layout: &Layout, room: RoomId, rect_m: [f32; 4]) -> [f32; 4] {
    let others = layout.rooms.iter().filter(|other| other.id != room);
    let others: Vec<[f32; 4]> = others.flat_map(|other| other.rects_m.iter().copied()).collect();
    let snapped = |axis: usize, at: f32| {
        let sides = others.iter().flat_map(|rect| [rect[axis], rect[axis + 2]]);
        let near = sides.filter(|side| (side - at).abs() <= ROOM_MAGNET_M);
        let nearest = near.min_by(|one, other| (one - at).abs().total_cmp(&(other - at).abs()));
        nearest.unwrap_or_else(|| on_lattice(at, ROOM_LATTICE_M))
    };
    let [one, two, three, four] = rect_m;
    let [west, south] = [snapped(0, one.min(three)), snapped(1, two.min(four))];
    [west, south, snapped(0, one.max(three)), snapped(1, two.max(four))]
}

/// The room that a rectangle would share floor with.
#[must_use]
pub fn overlapped(layout: &Layout, room: RoomId, rect_m: [f32; 4]) -> Option<RoomId> {
    let shares = |other: &[f32; 4]| {
        (0..2).all(|axis| rect_m[axis].max(other[axis]) + SLACK_M < rect_m[axis + 2].min(other[axis + 2]))
    };
    let mut others = layout.rooms.iter().filter(|other| other.id != room);
    others.find(|other| other.rects_m.iter().any(shares)).map(|other| other.id)
}

/// The corners of an object seen from above, in order, m.
#[must_use]
pub fn corners_m(class: &ObjectClass, scale: [f32; 3], at_m: [f32; 2], yaw_deg: f32) -> [[f32; 2]; 4] {
    let (sin, cos) = libm::sincosf(yaw_deg.to_radians());
    let half_m = [0, 1].map(|axis| class.size_m[axis] * scale[axis] / 2.0);
    [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]].map(|[ahead, left]| {
        let [x, y] = [ahead * half_m[0], left * half_m[1]];
        [at_m[0] + x * cos - y * sin, at_m[1] + x * sin + y * cos]
    })
}

/// A point in the frame of an object that stands there, m.
#[must_use]
pub fn local_m(origin_m: [f32; 2], yaw_deg: f32, point_m: [f32; 2]) -> [f32; 2] {
    let (sin, cos) = libm::sincosf(yaw_deg.to_radians());
    let [x, y] = [point_m[0] - origin_m[0], point_m[1] - origin_m[1]];
    [x * cos + y * sin, y * cos - x * sin]
}

/// What a thing of a class would be put on or into at a point: the highest that takes it there, but for `except`.
#[must_use]
pub fn holder_at<'a>(
    layout: &'a Layout,
    catalog: &Catalog,
    class: &ObjectClass,
    point_m: [f32; 2],
    except: &[&str],
) -> Option<&'a Placement> {
    let takes = |placement: &&Placement| {
        let Some(own) = catalog.class_of_instance(&placement.instance).map(|own| catalog.class(own)) else {
            return false;
        };
        let Some(place) = &own.receptacle else { return false };
        let is_taken =
            if place.keys.is_empty() { !place.refuses.contains(&class.id) } else { place.keys.contains(&class.id) };
        let [x, y, _] = layout.origin_in_world_m(placement);
        let [ahead, left] = local_m([x, y], placement.yaw_deg, point_m);
        let sides = own.size_m.iter().zip(placement.scale).map(|(size, scale)| size * scale);
        let is_over = [ahead, left].iter().zip(sides).all(|(at, side)| at.abs() <= side / 2.0);
        is_taken && is_over && !except.contains(&placement.instance.as_str())
    };
    let height_m = |placement: &Placement| layout.origin_in_world_m(placement)[2];
    let holders = layout.placements.iter().filter(takes);
    holders.max_by(|one, other| height_m(one).total_cmp(&height_m(other)))
}

/// Where an object that is dropped at a point of a room stands: on the lattice, and with its side at a wall that is near. What hangs on
/// walls goes to the nearest one, and faces the room.
#[must_use]
pub fn standing_at(
    layout: &Layout,
    room: RoomId,
    class: &ObjectClass,
    scale: [f32; 3],
    (point_m, yaw_deg): ([f32; 2], f32),
) -> ([f32; 2], f32) {
    let walls: Vec<Wall> = walls(layout).into_iter().filter(|wall| wall.room == room).collect();
    if class.stands == Stands::OnWall {
        let nearest = walls.iter().min_by(|one, other| one.distance_m(point_m).total_cmp(&other.distance_m(point_m)));
        let Some(wall) = nearest else { return (point_m, yaw_deg) };
        let half_m = class.size_m[1] * scale[1] / 2.0 + HALF_WALL_M;
        let [along, _] = wall.local(point_m);
        let along = on_lattice(along, LATTICE_M);
        let [least, most] = [wall.span_m[0] + half_m, wall.span_m[1] - half_m];
        let along = if least <= most { along.clamp(least, most) } else { along };
        return (wall.point(along, HALF_WALL_M + class.size_m[0] * scale[0] / 2.0), wall.yaw_deg());
    }
    let mut at_m = point_m.map(|at| on_lattice(at, LATTICE_M));
    let corners = corners_m(class, scale, [0.0; 2], yaw_deg);
    for wall in walls {
        let [along, across] = wall.local(point_m);
        // How far the object reaches towards the wall.
        let reach_m = corners.iter().map(|corner| -wall.inward * wall.local(*corner)[1]).fold(0.0, f32::max);
        let gap_m = (across - wall.at_m) * wall.inward - reach_m - HALF_WALL_M;
        let is_beside = wall.span_m[0] <= along && along <= wall.span_m[1];
        if is_beside && gap_m.abs() <= MAGNET_M {
            let across = wall.at_m + wall.inward * (HALF_WALL_M + reach_m);
            at_m[usize::from(wall.runs == Axis::X)] = across;
        }
    }
    (at_m, yaw_deg)
}

/// The way that furniture faces which is put down at a point of a room: away from the wall that is nearest to it.
#[must_use]
pub fn facing_deg(layout: &Layout, room: RoomId, point_m: [f32; 2]) -> f32 {
    let walls = walls(layout).into_iter().filter(|wall| wall.room == room);
    let nearest = walls.min_by(|one, other| one.distance_m(point_m).total_cmp(&other.distance_m(point_m)));
    nearest.map_or(0.0, |wall| wall.yaw_deg())
}

/// A heading in `(-180, 180]`, to the tenth of a degree.
#[must_use]
pub fn heading_deg(yaw_deg: f32) -> f32 {
    let turned = ((yaw_deg * 10.0).round() / 10.0).rem_euclid(360.0);
    if turned > 180.0 { turned - 360.0 } else { turned }
}

fn on_lattice(at_m: f32, step_m: f32) -> f32 {
    (at_m / step_m).round() * step_m
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// A room of 4 m by 3 m, and one of 2 m by 3 m east of it.
    fn plan() -> (Catalog, Layout) {
        let finish = "floor = { material = \"wood\", color = \"#aaaaaa\" }, \
                      wall = { material = \"plain\", color = \"#eeeeee\" }, circuit = 1";
        let text = format!(
            "room = [\n  {{ id = \"Lab1\", rects_m = [[0.0, 0.0, 4.0, 3.0]], {finish} }},\n  \
             {{ id = \"Hallway\", rects_m = [[4.0, 0.0, 6.0, 3.0]], {finish} }},\n]\n\
             placement = [\n  {{ instance = \"Desk_01_1\", room = \"Lab1\", at_m = [2.0, 1.5, 0.0] }},\n]\n"
        );
        let catalog = Catalog::builtin();
        let layout = Layout::draft("Plan", "Plan.toml", &text, &catalog).unwrap();
        (catalog, layout)
    }

    fn near(one: [f32; 2], other: [f32; 2]) -> bool {
        one.iter().zip(other).all(|(one, other)| (one - other).abs() < 1e-3)
    }

    #[test]
    fn doors_join_rooms_and_windows_lead_outside() {
        let (_, layout) = plan();
        let gap = gap_at(&layout, OpeningKind::Door, 1.0, [4.2, 2.6]).unwrap();
        assert_eq!((gap.between, gap.runs), ([RoomId::LAB1, RoomId::HALLWAY], Axis::Y));
        assert!(near(gap.at_m, [4.0, 2.4]), "{gap:?}");
        let gap = gap_at(&layout, OpeningKind::Window, 1.2, [2.02, 0.3]).unwrap();
        assert_eq!((gap.between, gap.runs), ([RoomId::LAB1; 2], Axis::X));
        assert!(near(gap.at_m, [2.0, 0.0]), "{gap:?}");
        for (kind, width_m, at, said) in [
            (OpeningKind::Door, 1.0, [0.1, 1.5], "none behind this wall"),
            (OpeningKind::Window, 1.0, [4.1, 1.5], "a room behind this one"),
            (OpeningKind::Window, 3.5, [0.1, 1.5], "too short"),
            (OpeningKind::Door, 1.0, [20.0, 1.5], "no wall here"),
        ] {
            assert!(gap_at(&layout, kind, width_m, at).unwrap_err().contains(said), "{said}");
        }
    }

    #[test]
    fn rooms_that_are_drawn_near_others_share_their_walls() {
        let (_, layout) = plan();
        assert_eq!(
            rect_at(&layout, RoomId::LAB2, [6.1, 3.2, 2.06, 5.0]).map(|at| (at * 100.0).round()),
            [210.0, 300.0, 600.0, 500.0]
        );
        assert_eq!(overlapped(&layout, RoomId::LAB2, [3.9, 2.0, 5.0, 4.0]), Some(RoomId::LAB1));
        assert_eq!(overlapped(&layout, RoomId::LAB2, [4.0, 3.0, 5.0, 4.0]), None);
        assert_eq!(overlapped(&layout, RoomId::LAB1, [0.0, 0.0, 4.0, 2.0]), None);
    }

    #[test]
    fn furniture_goes_to_walls_and_things_onto_furniture() {
        let (catalog, layout) = plan();
        let class = |id: &str| catalog.class(catalog.find(id).unwrap());
        let desk = class("Desk_01");
        let depth_m = desk.size_m[0];
        let (at, yaw) = standing_at(&layout, RoomId::LAB1, desk, [1.0; 3], ([depth_m / 2.0 + 0.1, 1.52], 0.0));
        assert!(near(at, [depth_m / 2.0 + HALF_WALL_M, 1.5]) && yaw == 0.0, "{at:?}");
        let (at, yaw) = standing_at(&layout, RoomId::LAB1, class("LightSwitch_01"), [1.0; 3], ([1.0, 2.8], 0.0));
        assert!((at[0] - 1.0).abs() < 1e-3 && at[1] > 2.8 && yaw == -90.0, "{at:?} {yaw}");
        let holder =
            |point| holder_at(&layout, &catalog, class("Bowl_01"), point, &[]).map(|holder| holder.instance.as_str());
        assert_eq!((holder([2.0, 1.5]), holder([3.8, 0.2])), (Some("Desk_01_1"), None));
        assert!(holder_at(&layout, &catalog, class("Bowl_01"), [2.0, 1.5], &["Desk_01_1"]).is_none());
        assert_eq!([270.0, -180.0, 540.04, -90.0].map(heading_deg), [-90.0, 180.0, 180.0, -90.0]);
    }
}
