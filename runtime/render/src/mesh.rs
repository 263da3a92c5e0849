//! Meshes as the rasteriser wants them: corners, triangles, surfaces, and pieces that come and go.

use core::ops::Range;

use cohabit_cdf::model::When;
use glam::Vec3;

use crate::kit::Solid;
use crate::pattern::Pattern;
use crate::veil::Veil;

/// A box along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Its least coordinates, m.
    pub min: Vec3,
    /// Its greatest coordinates, m.
    pub max: Vec3,
}

impl Aabb {
    /// What holds nothing: every union with it is the other.
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The least box around both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The least box around this and a point.
    #[must_use]
    pub fn with(self, point: Vec3) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }

    /// Its extent along each axis, m; zero where it is empty.
    #[must_use]
    pub fn size(self) -> Vec3 {
        (self.max - self.min).max(Vec3::ZERO)
    }

    /// Its middle.
    #[must_use]
    pub fn center(self) -> Vec3 {
        (self.min + self.max) * 0.5
    }

    /// Its eight corners.
    #[must_use]
    pub fn corners(self) -> [Vec3; 8] {
        core::array::from_fn(|corner| {
            let pick = |axis: usize| if corner >> axis & 1 == 0 { self.min[axis] } else { self.max[axis] };
            Vec3::new(pick(0), pick(1), pick(2))
        })
    }
}

/// Where a surface's colour comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Paint {
    /// Always this linear light.
    Fixed(Vec3),
    /// The instance's tint.
    Tint,
    /// The colour of what fills the instance.
    Fluid,
}

/// The look of some triangles: paint, pattern, and how the pattern lies on them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Surface {
    /// Its colour.
    pub paint: Paint,
    /// Its pattern.
    pub pattern: Pattern,
    /// The direction in which the pattern's first coordinate grows, and its value at the origin, m.
    pub u: (Vec3, f32),
    /// The same for the second coordinate.
    pub v: (Vec3, f32),
    /// Of a see-through pattern: how much of what is behind it it hides where it is looked at squarely.
    pub opacity: f32,
}

/// Triangles that are drawn, and move, together.
#[derive(Clone, Debug)]
pub(crate) struct Piece {
    /// The state in which alone they are drawn.
    pub when: Option<When>,
    /// The joint that moves them.
    pub joint: Option<u8>,
    /// How they are seen through; nothing for what is drawn first, and hides what is behind it.
    pub veil: Option<Veil>,
    /// Their corners.
    pub corners: Range<u32>,
    /// Which triangles.
    pub triangles: Range<u32>,
    /// The box around their corners.
    pub bounds: Aabb,
    /// The same triangles in smaller parts, of which some may be seen while others are not; empty where it is small.
    pub clusters: Vec<Cluster>,
}

/// Some triangles of a piece that follow each other, and share no corners with others.
#[derive(Clone, Debug)]
pub(crate) struct Cluster {
    /// Their corners.
    pub corners: Range<u32>,
    /// Which triangles.
    pub triangles: Range<u32>,
    /// The box around their corners.
    pub bounds: Aabb,
}

/// Corners that a cluster has at least.
const CLUSTER_CORNERS: u32 = 64;

/// Everything there is to draw of one model at one level of detail.
#[derive(Clone, Debug, Default)]
pub(crate) struct Mesh {
    /// Corners, m.
    pub positions: Vec<Vec3>,
    /// Unit normals at the corners.
    pub normals: Vec<Vec3>,
    /// Three corners each, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// The surface of each triangle.
    pub surface_of: Vec<u16>,
    /// All surfaces.
    pub surfaces: Vec<Surface>,
    /// All pieces.
    pub pieces: Vec<Piece>,
}

impl Piece {
    /// Whether it is drawn while nothing has happened to the object.
    pub(crate) fn is_usual(&self) -> bool {
        self.when.is_none_or(is_usual)
    }
}

/// Whether an object is in this state while nothing has happened to it.
pub(crate) fn is_usual(when: When) -> bool {
    use When::{Neutral, Off, Powered, Raw, Uncut, Uneaten, Whole};
    matches!(when, Off | Powered | Raw | Uneaten | Whole | Uncut | Neutral)
}

/// The usual state that another one ends.
fn instead_of(when: When) -> Option<When> {
    Some(match when {
        When::On | When::Past | When::Future => When::Off,
        When::Broken => When::Whole,
        When::Unpowered => When::Powered,
        When::Cooked => When::Raw,
        When::Eaten => When::Uneaten,
        When::Cut => When::Uncut,
        When::Happy | When::Sad | When::Angry | When::Scared => When::Neutral,
        _ => return None,
    })
}

impl Mesh {
    /// How many triangles are drawn at once, in the usual state or in the one other state that takes the most.
    pub(crate) fn triangles_at_once(&self) -> usize {
        let others = self.pieces.iter().filter(|piece| !piece.is_usual()).filter_map(|piece| piece.when);
        let states = core::iter::once(None).chain(others.map(Some));
        states.map(|state| self.triangles_in(state)).max().unwrap_or(0)
    }

    /// How many are drawn in one state that is not usual, or in none.
    fn triangles_in(&self, state: Option<When>) -> usize {
        let hidden = state.and_then(instead_of);
        let shown = |piece: &&Piece| match piece.when {
            None => true,
            Some(when) if is_usual(when) => hidden != Some(when),
            // What leads to the past or the future is on.
            Some(When::On) => matches!(state, Some(When::On | When::Past | When::Future)),
            Some(when) => state == Some(when),
        };
        self.pieces.iter().filter(shown).map(|piece| piece.triangles.len()).sum()
    }

    /// Starts a piece; what is pushed until [`Self::end_piece`] belongs to it.
    pub(crate) fn begin_piece(&mut self, when: Option<When>, joint: Option<u8>, veil: Option<Veil>) {
        let (corner, triangle) = (self.positions.len() as u32, self.triangles.len() as u32);
        let (corners, triangles) = (corner..corner, triangle..triangle);
        self.pieces.push(Piece { when, joint, veil, corners, triangles, bounds: Aabb::EMPTY, clusters: Vec::new() });
    }

    /// Ends the piece that was begun last.
    pub(crate) fn end_piece(&mut self) {
        if let Some(piece) = self.pieces.last_mut() {
            piece.corners.end = self.positions.len() as u32;
            piece.triangles.end = self.triangles.len() as u32;
            piece.bounds = bounds_of(&self.positions[piece.corners.start as usize..]);
            piece.clusters = clusters(&self.positions, &self.triangles, piece);
        }
    }

    /// Adds a solid; `surface` says for each triangle's outward direction which surface it has.
    pub(crate) fn push(&mut self, solid: &Solid, mut surface: impl FnMut(Vec3) -> Surface) {
        let base = self.positions.len() as u32;
        self.positions.extend_from_slice(&solid.positions);
        self.normals.extend_from_slice(&solid.normals);
        for triangle in &solid.triangles {
            let [a, b, c] = triangle.map(|corner| solid.positions[corner as usize]);
            let index = self.surface_index(surface((b - a).cross(c - a)));
            self.triangles.push(triangle.map(|corner| corner + base));
            self.surface_of.push(index);
        }
    }

    fn surface_index(&mut self, surface: Surface) -> u16 {
        let found = self.surfaces.iter().rposition(|known| *known == surface);
        found.unwrap_or_else(|| {
            self.surfaces.push(surface);
            self.surfaces.len() - 1
        }) as u16
    }
}

fn bounds_of(positions: &[Vec3]) -> Aabb {
    positions.iter().fold(Aabb::EMPTY, |bounds, corner| bounds.with(*corner))
}

/// Cuts a piece wherever no later triangle has a corner of an earlier one; nothing, if that leaves it in one.
fn clusters(positions: &[Vec3], triangles: &[[u32; 3]], piece: &Piece) -> Vec<Cluster> {
    let own = &triangles[piece.triangles.start as usize..piece.triangles.end as usize];
    // For each triangle the least corner that it and all later ones have.
    let mut least = piece.corners.end;
    let mut leasts: Vec<u32> =
        own.iter().rev().map(|[a, b, c]| (least = least.min(*a).min(*b).min(*c), least).1).collect();
    leasts.reverse();
    let (mut all, mut corner, mut triangle, mut next) = (Vec::new(), piece.corners.start, piece.triangles.start, 0);
    for (index, ([a, b, c], least)) in piece.triangles.clone().zip(own.iter().zip(leasts)) {
        if least >= next && next >= corner + CLUSTER_CORNERS && piece.corners.end >= next + CLUSTER_CORNERS {
            let bounds = bounds_of(&positions[corner as usize..next as usize]);
            all.push(Cluster { corners: corner..next, triangles: triangle..index, bounds });
            (corner, triangle) = (next, index);
        }
        next = next.max(a + 1).max(b + 1).max(c + 1);
    }
    if !all.is_empty() {
        let (corners, triangles) = (corner..piece.corners.end, triangle..piece.triangles.end);
        let bounds = bounds_of(&positions[corner as usize..piece.corners.end as usize]);
        all.push(Cluster { corners, triangles, bounds });
    }
    all
}
