//! A camera of the session, as others are told of it.

use bytemuck::{Pod, Zeroable};

use super::Plane;
use crate::{camera::CameraId, text::Text};

/// Where a camera is and how it moves.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
#[repr(u32)]
pub enum CameraKind {
    /// In a body's head.
    Egocentric = 0,
    /// In a body's head, looking ahead, to the right, back and to the left at once.
    Panorama = 1,
    /// Behind a body.
    ThirdPerson = 2,
    /// In one place.
    Fixed = 3,
    /// Above the whole plan, or above a body.
    TopDown = 4,
}

impl CameraKind {
    /// All kinds.
    pub const ALL: [Self; 5] = [Self::Egocentric, Self::Panorama, Self::ThirdPerson, Self::Fixed, Self::TopDown];

    /// As options and pages call it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Egocentric => "egocentric",
            Self::Panorama => "panorama",
            Self::ThirdPerson => "third-person",
            Self::Fixed => "fixed",
            Self::TopDown => "top-down",
        }
    }
}

/// A camera that there is, whether or not anybody looks through it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct CameraRecord {
    /// As in the topic, after `frames/`.
    name: Text<30>,
    /// `CameraKind`.
    kind: u32,
    /// The body it belongs to, or [`NONE`](super::NONE).
    pub body: u32,
    /// Pixels across, of one picture.
    pub width: u32,
    /// Pixels down, of one picture.
    pub height: u32,
    /// Pictures a frame: 4 of a panorama, else 1.
    pub views: u32,
    /// The planes of its frames: bit `i` for `Plane::ALL[i]`.
    pub planes: u32,
}

impl CameraRecord {
    /// A camera of which nothing but its id and kind is told yet.
    #[must_use]
    pub fn new(camera: CameraId, kind: CameraKind) -> Self {
        Self { name: Text::new(&camera.to_string()), kind: kind as u32, views: 1, ..Self::default() }
    }

    /// Which it is; `None` if a peer wrote what is no name.
    #[must_use]
    pub fn camera(&self) -> Option<CameraId> {
        self.name.as_str().parse().ok()
    }

    /// What it is; `None` if a peer wrote a kind that does not exist.
    #[must_use]
    pub fn kind(&self) -> Option<CameraKind> {
        CameraKind::ALL.get(self.kind as usize).copied()
    }

    /// Whether its frames have a plane.
    #[must_use]
    pub const fn has(&self, plane: Plane) -> bool {
        self.planes & 1 << plane as u32 != 0
    }
}
