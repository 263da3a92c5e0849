//! What the scene is told about each thing that may move or change.

use cohabit_cdf::{ClassId, Color, Fluid, RoomId, StateFlags};

/// One thing in the scene, as it is now.
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    /// What stands in the id plane where it is seen: unique, above zero, below 2^24.
    pub id: u32,
    /// Its looks.
    pub look: Look,
    /// Its origin in the world, m.
    pub position_m: [f32; 3],
    /// Its rotation, a unit quaternion `[x, y, z, w]`.
    pub rotation: [f32; 4],
    /// Its scale along its own axes.
    pub scale: [f32; 3],
    /// Its states.
    pub flags: StateFlags,
    /// What fills it.
    pub fluid: Fluid,
    /// The colour that replaces its tint.
    pub color: Color,
    /// How far it is open, 0 to 1.
    pub opened: f32,
    /// How far it runs, 0 to 1.
    pub running: f32,
    /// The room whose lamps light it.
    pub room: RoomId,
    /// Whether it is drawn at all.
    pub visible: bool,
}

/// What an instance looks like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Look {
    /// As the catalogue has it.
    Object(ClassId),
    /// The robot.
    Robot {
        /// How far its head looks up.
        head_pitch_rad: f32,
        /// Its arms: 0 at rest, 1 reaching forward.
        arm: f32,
    },
    /// A person.
    Human {
        /// The arms: 0 at rest, 1 reaching forward.
        arm: f32,
    },
    /// A sticky note: faces `+x`, its back on the wall at `x = 0`, its lower edge at `z = 0`.
    Note {},
}

/// A coloured outline, for people's cameras.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Highlight {
    /// The instance.
    pub id: u32,
    /// Red, green, blue.
    pub color: [u8; 3],
}
