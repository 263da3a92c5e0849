//! The floor plan as a mesh: floors, walls with their openings, frames, skirting, ceilings and lamps.
//!
//! Every room has its own faces, which look into the room alone; so a camera outside looks in.

mod light;
mod outline;
mod room;

use cohabit_cdf::RoomId;
use cohabit_cdf::layout::{Layout, OpeningKind};
use cohabit_cdf::model::Axis;
use cohabit_cdf::room::MOST_ROOMS;
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

/// What stands in the id plane where `surface` of the room with this index is seen: never the id of an instance below
/// 2^24.
#[must_use]
pub const fn room_surface_id(room: u8, surface: RoomSurface) -> u32 {
    1 << 24 | (room as u32) << 8 | surface as u32
}

/// The rooms of a set of bits, in their order.
pub(crate) fn rooms_of(bits: u64) -> impl Iterator<Item = usize> {
    let first = (bits != 0).then_some(bits);
    let sets = core::iter::successors(first, |left| Some(left & (left - 1)).filter(|left| *left != 0));
    sets.map(|left| left.trailing_zeros() as usize)
}

/// A piece of the plan's mesh, and what it belongs to.
#[derive(Clone, Debug)]
pub(crate) struct PlanPart {
    pub piece: u32,
    /// The index of the room whose lamps light it.
    pub room: u8,
    /// The rooms from which it is seen, as bits.
    pub rooms: u64,
    pub id: u32,
    pub bounds: Aabb,
    pub surface: RoomSurface,
}

/// A gap in a wall, to be looked through.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gap {
    /// The rooms on its sides, as bits; one alone if the other side is outside.
    pub rooms: u64,
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
    pub rects: Vec<(u8, [f32; 4])>,
    pub bounds: Aabb,
    pub height_m: f32,
    /// All rooms of the world, by index.
    ids: Vec<RoomId>,
    /// What tells rooms apart in the map of shadows, by index.
    shadow_rooms: [u8; MOST_ROOMS],
}

impl Plan {
    /// The plan's mesh; `ids` are the rooms of the world, by index.
    pub(crate) fn new(layout: &Layout, ids: &[RoomId]) -> Self {
        let rooms = layout.rooms.iter().map(|room| (index_of(ids, room.id), room));
        let rects: Vec<(u8, [f32; 4])> =
            rooms.clone().flat_map(|(index, room)| room.rects_m.iter().map(move |rect| (index, *rect))).collect();
        let mut bounds = Aabb::EMPTY;
        for (_, [west, south, east, north]) in &rects {
            bounds = bounds.with(Vec3::new(*west, *south, 0.0)).with(Vec3::new(*east, *north, layout.wall_height_m));
        }
        let mut plan = Self {
            mesh: Mesh::default(),
            ambient: Vec::new(),
            parts: Vec::new(),
            gaps: Vec::new(),
            shadow_rooms: shadow_rooms(&rects),
            rects,
            bounds,
            height_m: layout.wall_height_m,
            ids: ids.to_vec(),
        };
        plan.gaps = layout.openings.iter().map(|opening| plan.gap(opening)).collect();
        for (index, room) in rooms {
            room::build(&mut plan, room, index);
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

    /// The index of a room.
    pub(crate) fn index_of(&self, room: RoomId) -> u8 {
        index_of(&self.ids, room)
    }

    /// What tells the room with this index apart in the map of shadows.
    pub(crate) fn shadow_room(&self, room: u8) -> u8 {
        self.shadow_rooms[usize::from(room)]
    }

    /// The rooms at a place, as bits; `margin_m` makes every room that much larger.
    pub(crate) fn rooms_at(&self, x: f32, y: f32, margin_m: f32) -> u64 {
        self.rooms_touching([x, y, x, y], margin_m)
    }

    /// The rooms that a rectangle touches, as bits.
    pub(crate) fn rooms_touching(&self, rect: [f32; 4], margin_m: f32) -> u64 {
        rooms_touching(&self.rects, rect, margin_m)
    }

    /// Begins a part; what is pushed until [`Self::end`] belongs to it.
    fn begin(&mut self, room: u8, rooms: u64, surface: RoomSurface) {
        self.mesh.begin_piece(None, None, None);
        let piece = self.mesh.pieces.len() as u32 - 1;
        let id = room_surface_id(room, surface);
        self.parts.push(PlanPart { piece, room, rooms, id, bounds: Aabb::EMPTY, surface });
    }

    fn end(&mut self) {
        self.mesh.end_piece();
        if let (Some(part), Some(piece)) = (self.parts.last_mut(), self.mesh.pieces.last()) {
            part.bounds = piece.bounds;
        }
        if self.mesh.pieces.last().is_some_and(|piece| piece.triangles.is_empty()) {
            self.parts.pop();
        }
    }
}

/// The index of a room. No floor plan has one that its world lacks.
fn index_of(ids: &[RoomId], room: RoomId) -> u8 {
    let place = || ids.iter().position(|known| *known == room).map_or(0, |place| place as u8);
    room.builtin_index().unwrap_or_else(place)
}

/// The rooms that a rectangle touches, as bits.
fn rooms_touching(rects: &[(u8, [f32; 4])], rect: [f32; 4], margin_m: f32) -> u64 {
    let touches = |own: &[f32; 4]| {
        rect[0] <= own[2] + margin_m
            && rect[2] >= own[0] - margin_m
            && rect[1] <= own[3] + margin_m
            && rect[3] >= own[1] - margin_m
    };
    rects.iter().filter(|(_, own)| touches(own)).fold(0, |bits, (room, _)| bits | 1 << *room)
}

/// What tells rooms apart in the map of shadows, which has four bits for that: of built-in ones their index, of each other
/// one a number that no room has which is so near that shadows fall from one into the other.
fn shadow_rooms(rects: &[(u8, [f32; 4])]) -> [u8; MOST_ROOMS] {
    /// Numbers that there are.
    const NUMBERS: u8 = 16;
    /// Light falls 0.3 m aside for each metre down, and no wall is higher than 6 m.
    const REACH_M: f32 = 2.0;
    let mut numbers: [u8; MOST_ROOMS] = core::array::from_fn(|index| index as u8 % NUMBERS);
    let mut settled = rects.iter().fold(0_u64, |bits, (room, _)| bits | 1 << *room);
    let others: Vec<usize> = rooms_of(settled).skip_while(|room| *room < RoomId::BUILTIN.len()).collect();
    others.iter().for_each(|room| settled &= !(1_u64 << *room));
    for room in others {
        let own = rects.iter().filter(|(index, _)| usize::from(*index) == room);
        let near = own.fold(0_u64, |bits, (_, rect)| bits | rooms_touching(rects, *rect, REACH_M)) & settled;
        let is_free = |number: &u8| rooms_of(near).all(|other| numbers[other] != *number);
        if let Some(number) = (0..NUMBERS).find(is_free) {
            numbers[room] = number;
        }
        settled |= 1_u64 << room;
    }
    numbers
}

#[cfg(test)]
mod tests;
