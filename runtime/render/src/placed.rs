//! What is drawn of an instance, and where.

use glam::{Mat3, Vec3};

use crate::mesh::Aabb;
use crate::weather::Weather;

/// From an instance's frame, or a moving part's, to the world, and back.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Transform {
    pub rotation: Mat3,
    pub offset: Vec3,
    pub inverse: Mat3,
}

impl Transform {
    pub(crate) const IDENTITY: Self = Self { rotation: Mat3::IDENTITY, offset: Vec3::ZERO, inverse: Mat3::IDENTITY };

    pub(crate) fn new(rotation: Mat3, offset: Vec3) -> Self {
        let inverse = if rotation.determinant().abs() > 1e-12 { rotation.inverse() } else { Mat3::ZERO };
        Self { rotation, offset, inverse }
    }

    pub(crate) fn bounds(&self, own: Aabb) -> Aabb {
        own.corners().iter().fold(Aabb::EMPTY, |all, corner| all.with(self.rotation * *corner + self.offset))
    }
}

/// An instance, ready to be drawn.
#[derive(Clone, Debug)]
pub(crate) struct Placed {
    pub id: u32,
    pub model: usize,
    /// The body's, then each joint's.
    pub transforms: Vec<Transform>,
    /// Pieces shown, each with the transform that moves it.
    pub pieces: Vec<(u16, u16)>,
    pub center: Vec3,
    pub radius: f32,
    pub bounds: Aabb,
    /// Rooms it touches, as bits.
    pub rooms: u64,
    /// The index of the room whose lamps light it, and what tells that apart in the map of shadows.
    pub room: u8,
    pub shadow_room: u8,
    pub tint: Vec3,
    pub fluid: Vec3,
    pub weather: Weather,
    pub casts_shadow: bool,
}
