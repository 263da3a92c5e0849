//! The walls of a floor plan, worked out from its file alone, to judge from outside where bodies may be.

use cohabit_cdf::{Layout, RoomId, layout::OpeningKind, model::Axis};
use cohabit_world::Vec2;

/// The middle lines of walls, openings left out.
pub struct Walls {
    lines: Vec<[Vec2; 2]>,
}

impl Walls {
    pub fn new(layout: &Layout) -> Self {
        /// How finely an edge is looked at, m.
        const PIECE_M: f32 = 0.02;
        let mut lines = Vec::new();
        for room in &layout.rooms {
            for [west, south, east, north] in &room.rects_m {
                let corners = [(*west, *south), (*east, *south), (*east, *north), (*west, *north)];
                let corners = corners.map(|(x, y)| Vec2::new(x, y));
                for at in 0..4 {
                    let (from, to) = (corners[at], corners[(at + 1) % 4]);
                    let along = (to - from).normalize();
                    let pieces = ((to - from).length() / PIECE_M) as u32;
                    let is_wall = |piece: &u32| {
                        let middle = from + along * ((*piece as f32 + 0.5) * PIECE_M);
                        !in_room(layout, room.id, middle, along) && !is_open(layout, middle, along)
                    };
                    let walls: Vec<u32> = (0..pieces).filter(is_wall).collect();
                    let point = |piece: u32| from + along * (piece as f32 * PIECE_M);
                    let runs = walls.chunk_by(|one, two| one + 1 == *two);
                    lines.extend(runs.map(|run| [point(run[0]), point(run[run.len() - 1] + 1)]));
                }
            }
        }
        Self { lines }
    }

    /// How far `point` is from the middle of the nearest wall, m.
    pub fn distance(&self, point: Vec2) -> f32 {
        let to_line = |[from, to]: &[Vec2; 2]| {
            let along = *to - *from;
            let part = ((point - *from).dot(along) / along.length_squared()).clamp(0.0, 1.0);
            point.distance(*from + along * part)
        };
        self.lines.iter().map(to_line).fold(f32::INFINITY, f32::min)
    }
}

/// Whether the same room goes on at both sides of an edge.
fn in_room(layout: &Layout, room: RoomId, middle: Vec2, along: Vec2) -> bool {
    const ASIDE_M: f32 = 0.15;
    let has = |point: Vec2| layout.room(room).is_some_and(|room| room.has(point.x, point.y));
    has(middle + along.perp() * ASIDE_M) && has(middle - along.perp() * ASIDE_M)
}

/// Whether one can walk through here.
fn is_open(layout: &Layout, middle: Vec2, along: Vec2) -> bool {
    const SAME_WALL_M: f32 = 0.2;
    let open = layout.openings.iter().filter(|opening| opening.kind != OpeningKind::Window);
    open.into_iter().any(|opening| {
        let runs = if opening.wall_runs == Axis::X { Vec2::X } else { Vec2::Y };
        let from = middle - Vec2::from(opening.at_m);
        runs.dot(along).abs() > 0.5
            && from.dot(runs).abs() < opening.width_m / 2.0
            && from.dot(runs.perp()).abs() < SAME_WALL_M
    })
}
