//! The floor plan as a mesh: floors, walls with their openings, frames, skirting, ceilings and lamps.
//!
//! Every room has its own faces, which look into the room alone; so a camera outside looks in.

mod light;
mod outline;
mod room;

use cohabit_cdf::RoomId;
use cohabit_cdf::layout::{Layout, OpeningKind};
use cohabit_cdf::model::Axis;
use glam::Vec3;

pub(crate) use outline::walls;

use crate::mesh::{Aabb, Mesh};

/// Half a wall's thickness, m.
pub(crate) const HALF_WALL_M: f32 = 0.06;

/// A surface of a room that has an id of its own.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
#[repr(u8)]
pub enum RoomSurface {
    /// What is walked on.
    Floor,
    /// What is overhead.
    Ceiling,
    /// The wall in the east, which faces west; with its skirting.
    EastWall,
    /// The wall in the north.
    NorthWall,
    /// The wall in the west.
    WestWall,
    /// The wall in the south.
    SouthWall,
    /// Frames of doors, passages and windows, with their glass.
    Frame,
    /// Lamps in the ceiling.
    Lamp,
}

impl RoomSurface {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Floor,
        Self::Ceiling,
        Self::EastWall,
        Self::NorthWall,
        Self::WestWall,
        Self::SouthWall,
        Self::Frame,
        Self::Lamp,
    ];
}

/// The ids of rooms' surfaces: those of instances are below.
pub(crate) const SURFACE_IDS: core::ops::Range<u32> = 1 << 24..(1 << 24) + (1 << 16);

/// What stands in the id plane where `surface` of `room` is seen: never the id of an instance below 2^24.
#[must_use]
pub const fn room_surface_id(room: RoomId, surface: RoomSurface) -> u32 {
    1 << 24 | (room as u32) << 8 | surface as u32
}

/// A piece of the plan's mesh, and what it belongs to.
#[derive(Clone, Debug)]
pub(crate) struct PlanPart {
    pub piece: u32,
    /// The room whose lamps light it.
    pub room: RoomId,
    /// The rooms from which it is seen, as bits.
    pub rooms: u8,
    pub id: u32,
    pub bounds: Aabb,
    pub surface: RoomSurface,
}

/// A gap in a wall, to be looked through.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gap {
    /// The rooms on its sides, as bits; one alone if the other side is outside.
    pub rooms: u8,
    pub bounds: Aabb,
    pub runs_x: bool,
    pub kind: OpeningKind,
}

/// The static part of a scene.
#[derive(Debug)]
pub(crate) struct Plan {
    pub mesh: Mesh,
    /// How much light reaches each corner of the mesh; around 1.
    pub ambient: Vec<f32>,
    pub parts: Vec<PlanPart>,
    pub gaps: Vec<Gap>,
    /// `[west, south, east, north]` at the middle of the walls.
    pub rects: Vec<(RoomId, [f32; 4])>,
    pub bounds: Aabb,
    pub height_m: f32,
}

impl Plan {
    pub(crate) fn new(layout: &Layout) -> Self {
        let rects: Vec<(RoomId, [f32; 4])> =
            layout.rooms.iter().flat_map(|room| room.rects_m.iter().map(|rect| (room.id, *rect))).collect();
        let mut bounds = Aabb::EMPTY;
        for (_, [west, south, east, north]) in &rects {
            bounds = bounds.with(Vec3::new(*west, *south, 0.0)).with(Vec3::new(*east, *north, layout.wall_height_m));
        }
        let mut plan = Self {
            mesh: Mesh::default(),
            ambient: Vec::new(),
            parts: Vec::new(),
            gaps: Vec::new(),
            rects,
            bounds,
            height_m: layout.wall_height_m,
        };
        plan.gaps = layout.openings.iter().map(|opening| plan.gap(opening)).collect();
        for room in &layout.rooms {
            room::build(&mut plan, room);
        }
        room::frames(&mut plan);
        plan.ambient.resize(plan.mesh.positions.len(), 1.0);
        plan
    }

    fn gap(&self, opening: &cohabit_cdf::layout::Opening) -> Gap {
        let (low, high): (f32, f32) = match opening.kind {
            OpeningKind::Door => (0.0, 2.1),
            OpeningKind::Passage => (0.0, 2.3),
            OpeningKind::Window => (1.0, 2.2),
        };
        let runs_x = opening.wall_runs == Axis::X;
        let half = opening.width_m * 0.5;
        let extent = if runs_x { [half, HALF_WALL_M] } else { [HALF_WALL_M, half] };
        let [x, y] = opening.at_m;
        let aside = if runs_x { [0.0, 0.3] } else { [0.3, 0.0] };
        let rooms = self.rooms_at(x + aside[0], y + aside[1], 0.0) | self.rooms_at(x - aside[0], y - aside[1], 0.0);
        let bounds = Aabb {
            min: Vec3::new(x - extent[0], y - extent[1], low),
            max: Vec3::new(x + extent[0], y + extent[1], high.min(self.height_m - 0.05)),
        };
        Gap { rooms, bounds, runs_x, kind: opening.kind }
    }

    /// The rooms at a place, as bits; `margin_m` makes every room that much larger.
    pub(crate) fn rooms_at(&self, x: f32, y: f32, margin_m: f32) -> u8 {
        self.rooms_touching([x, y, x, y], margin_m)
    }

    /// The rooms that a rectangle touches, as bits.
    pub(crate) fn rooms_touching(&self, rect: [f32; 4], margin_m: f32) -> u8 {
        let touches = |own: &[f32; 4]| {
            rect[0] <= own[2] + margin_m
                && rect[2] >= own[0] - margin_m
                && rect[1] <= own[3] + margin_m
                && rect[3] >= own[1] - margin_m
        };
        self.rects.iter().filter(|(_, own)| touches(own)).fold(0, |bits, (room, _)| bits | 1 << *room as u8)
    }

    /// Begins a part; what is pushed until [`Self::end`] belongs to it.
    fn begin(&mut self, room: RoomId, rooms: u8, surface: RoomSurface) {
        self.mesh.begin_piece(None, None, None);
        let piece = self.mesh.pieces.len() as u32 - 1;
        let id = room_surface_id(room, surface);
        self.parts.push(PlanPart { piece, room, rooms, id, bounds: Aabb::EMPTY, surface });
    }

    fn end(&mut self) {
        self.mesh.end_piece();
        if let (Some(part), Some(piece)) = (self.parts.last_mut(), self.mesh.pieces.last()) {
            part.bounds = self.mesh.piece_bounds(piece);
        }
        if self.mesh.pieces.last().is_some_and(|piece| piece.triangles.is_empty()) {
            self.parts.pop();
        }
    }
}

#[cfg(test)]
mod tests;
