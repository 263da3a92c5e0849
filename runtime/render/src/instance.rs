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
    /// An object of the catalogue that is a gate to another time, while it is on.
    Gate {
        /// Its class.
        class: ClassId,
        /// To the future; otherwise to the past.
        future: bool,
    },
    /// The robot. Its flags say which face it shows.
    Robot {
        /// How far its head looks up.
        head_pitch_rad: f32,
        /// Its right arm: 0 at rest, 1 reaching forward.
        arm: f32,
        /// Whether it holds something.
        holds: bool,
        /// How far it has rolled: turns its wheels.
        rolled_m: f32,
    },
    /// A person. Its flags say which face they show.
    Person {
        /// Which of the outfits, counted round and round.
        outfit: u32,
        /// How far the head looks up.
        head_pitch_rad: f32,
        /// The right arm: 0 at rest, 1 reaching forward.
        arm: f32,
        /// Whether they hold something.
        holds: bool,
        /// How far they have walked: moves their legs.
        walked_m: f32,
        /// How briskly: 0 standing, 1 walking.
        pace: f32,
    },
    /// What is being poured: falls from the instance's place by this height, in the colour of its fluid.
    Stream {
        /// How far it falls.
        height_m: f32,
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
