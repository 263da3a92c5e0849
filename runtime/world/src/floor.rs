//! What never changes about a floor: rooms, walls with their gaps, and how each class of furniture opens. Never knows
//! what stands where.

use cohabit_cdf::layout::{Layout, OpeningKind};
use cohabit_cdf::{Catalog, ObjectId, RoomId, model::Axis};
use glam::Vec2;

use crate::{geometry::Footprint, swing::Swings};

/// Thickness of all walls, m: the renderer draws the same.
pub(crate) const WALL_THICKNESS_M: f32 = 0.12;

/// A gap in a wall that can be walked through.
#[derive(Clone, Debug)]
pub(crate) struct Gap {
    /// The part of the wall that is missing.
    pub print: Footprint,
    /// The door in it, if one is.
    pub door: Option<String>,
    /// The object that this door is, once it is built.
    pub door_object: Option<ObjectId>,
    /// The heading that faces along the passage, rad.
    pub yaw_rad: f32,
    /// The rooms it joins.
    pub between: [RoomId; 2],
}

/// Rooms and walls, from a layout.
#[derive(Clone, Debug)]
pub(crate) struct Floor {
    rooms: Vec<(RoomId, [f32; 4])>,
    /// Stretches of wall from the floor to the ceiling, gaps left out.
    pub walls: Vec<Footprint>,
    /// Gaps with and without doors.
    pub gaps: Vec<Gap>,
    /// `[west, south, east, north]` of everything, m.
    pub bounds: [f32; 4],
    /// Height of all rooms, m.
    pub wall_height_m: f32,
    /// The moving parts of all classes.
    pub swings: Swings,
}

/// A stretch of a wall's middle line.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Line {
    runs: Axis,
    at: f32,
    from: f32,
    to: f32,
}

impl Floor {
    /// Works out walls and gaps.
    pub fn new(layout: &Layout, catalog: &Catalog) -> Self {
        let rooms: Vec<(RoomId, [f32; 4])> =
            layout.rooms.iter().flat_map(|room| room.rects_m.iter().map(|rect| (room.id, *rect))).collect();
        let mut lines: Vec<Line> = rooms.iter().flat_map(|room| room_lines(*room, &rooms)).collect();
        for opening in layout.openings.iter().filter(|opening| opening.kind != OpeningKind::Window) {
            let (at, along) = split(opening.wall_runs, Vec2::from(opening.at_m));
            let half = opening.width_m / 2.0;
            lines = lines
                .into_iter()
                .flat_map(|line| cut(line, opening.wall_runs, at, along - half, along + half))
                .collect();
        }
        let gaps = layout
            .openings
            .iter()
            .filter(|opening| opening.kind != OpeningKind::Window)
            .map(|opening| {
                let half_width = opening.width_m / 2.0;
                let (half, yaw_rad) = match opening.wall_runs {
                    Axis::X => (Vec2::new(half_width, WALL_THICKNESS_M / 2.0), std::f32::consts::FRAC_PI_2),
                    Axis::Y | Axis::Z => (Vec2::new(WALL_THICKNESS_M / 2.0, half_width), 0.0),
                };
                Gap {
                    print: Footprint::new(opening.at_m.into(), half, 0.0),
                    door: opening.door.clone(),
                    door_object: None,
                    yaw_rad,
                    between: opening.between,
                }
            })
            .collect();
        let bounds = rooms.iter().fold([f32::MAX, f32::MAX, f32::MIN, f32::MIN], |all, (_, rect)| {
            [all[0].min(rect[0]), all[1].min(rect[1]), all[2].max(rect[2]), all[3].max(rect[3])]
        });
        Self {
            walls: lines.into_iter().map(Line::print).collect(),
            rooms,
            gaps,
            bounds,
            wall_height_m: layout.wall_height_m,
            swings: Swings::new(catalog),
        }
    }

    /// The room that `point` is in.
    pub fn room_at(&self, point: Vec2) -> Option<RoomId> {
        self.rooms
            .iter()
            .find(|(_, rect)| point.x >= rect[0] && point.x <= rect[2] && point.y >= rect[1] && point.y <= rect[3])
            .map(|(id, _)| *id)
    }

    /// The room whose floor is nearest to `point`; `None` on a floor without rooms.
    pub fn nearest_room(&self, point: Vec2) -> Option<RoomId> {
        let away_m = |[west, south, east, north]: [f32; 4]| {
            point.distance(point.clamp(Vec2::new(west, south), Vec2::new(east, north)))
        };
        let nearest = self.rooms.iter().min_by(|(_, one), (_, other)| away_m(*one).total_cmp(&away_m(*other)));
        nearest.map(|(id, _)| *id)
    }

    /// The rectangles of a room, `[west, south, east, north]`, m.
    pub fn rects(&self, room: RoomId) -> impl Iterator<Item = [f32; 4]> + '_ {
        self.rooms.iter().filter(move |(id, _)| *id == room).map(|(_, rect)| *rect)
    }

    /// The rectangles of all rooms, `[west, south, east, north]`, m.
    pub fn all_rects(&self) -> impl Iterator<Item = [f32; 4]> + '_ {
        self.rooms.iter().map(|(_, rect)| *rect)
    }

    /// Whether a wall stands between two points.
    pub fn wall_between(&self, a: Vec2, b: Vec2) -> bool {
        self.walls.iter().any(|wall| wall.cut_by(a, b))
    }
}

impl Line {
    fn print(self) -> Footprint {
        // Walls reach into the corners, so that no slit stays open there.
        let (middle, half) = ((self.from + self.to) / 2.0, (self.to - self.from) / 2.0);
        let thin = WALL_THICKNESS_M / 2.0;
        match self.runs {
            Axis::X => Footprint::new(Vec2::new(middle, self.at), Vec2::new(half, thin), 0.0),
            Axis::Y | Axis::Z => Footprint::new(Vec2::new(self.at, middle), Vec2::new(thin, half), 0.0),
        }
    }
}

fn split(runs: Axis, point: Vec2) -> (f32, f32) {
    match runs {
        Axis::X => (point.y, point.x),
        Axis::Y | Axis::Z => (point.x, point.y),
    }
}

/// The walls around one rectangle of a room, less where another rectangle of the same room goes on.
fn room_lines((room, [west, south, east, north]): (RoomId, [f32; 4]), rooms: &[(RoomId, [f32; 4])]) -> Vec<Line> {
    let mut lines = vec![
        Line { runs: Axis::X, at: south, from: west, to: east },
        Line { runs: Axis::X, at: north, from: west, to: east },
        Line { runs: Axis::Y, at: west, from: south, to: north },
        Line { runs: Axis::Y, at: east, from: south, to: north },
    ];
    for (_, other) in rooms.iter().filter(|(id, rect)| *id == room && *rect != [west, south, east, north]) {
        lines = lines
            .into_iter()
            .flat_map(|line| {
                let (low, high, from, to) = match line.runs {
                    Axis::X => (other[1], other[3], other[0], other[2]),
                    Axis::Y | Axis::Z => (other[0], other[2], other[1], other[3]),
                };
                if line.at < low - 1e-3 || line.at > high + 1e-3 {
                    vec![line]
                } else {
                    cut(line, line.runs, line.at, from, to)
                }
            })
            .collect();
    }
    lines
}

/// What is left of `line` where `from..to` of a wall on the same middle line is taken out.
fn cut(line: Line, runs: Axis, at: f32, from: f32, to: f32) -> Vec<Line> {
    const SAME_WALL_M: f32 = 0.1;
    if line.runs != runs || (line.at - at).abs() > SAME_WALL_M || to <= line.from || from >= line.to {
        return vec![line];
    }
    [(line.from, from.min(line.to)), (to.max(line.from), line.to)]
        .into_iter()
        .filter(|(from, to)| to - from > 1e-3)
        .map(|(from, to)| Line { from, to, ..line })
        .collect()
}
