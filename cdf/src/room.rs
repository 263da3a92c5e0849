//! The rooms that there are.

use serde::{Deserialize, Serialize};

/// A room, by the id that missions use.
#[derive(Clone, Copy, Debug, Deserialize, Eq, Hash, Ord, PartialEq, PartialOrd, Serialize)]
#[repr(u8)]
pub enum RoomId {
    /// Break room, kitchen.
    BreakRoom,
    /// Main office.
    MainOffice,
    /// Small office, manager's office.
    SmallOffice,
    /// Robotics lab.
    Lab1,
    /// Quantum lab.
    Lab2,
    /// Reception.
    Reception,
    /// Warehouse.
    Warehouse,
    /// Hallway.
    Hallway,
}

impl RoomId {
    /// All rooms.
    pub const ALL: [Self; 8] = [
        Self::BreakRoom,
        Self::MainOffice,
        Self::SmallOffice,
        Self::Lab1,
        Self::Lab2,
        Self::Reception,
        Self::Warehouse,
        Self::Hallway,
    ];

    /// Its id in a mission file.
    #[must_use]
    pub const fn id(self) -> &'static str {
        match self {
            Self::BreakRoom => "BreakRoom",
            Self::MainOffice => "MainOffice",
            Self::SmallOffice => "SmallOffice",
            Self::Lab1 => "Lab1",
            Self::Lab2 => "Lab2",
            Self::Reception => "Reception",
            Self::Warehouse => "Warehouse",
            Self::Hallway => "Hallway",
        }
    }

    /// What people read.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::BreakRoom => "break room",
            Self::MainOffice => "main office",
            Self::SmallOffice => "small office",
            Self::Lab1 => "robotics lab",
            Self::Lab2 => "quantum lab",
            Self::Reception => "reception",
            Self::Warehouse => "warehouse",
            Self::Hallway => "hallway",
        }
    }

    /// The room with this id, in any case (missions write `Breakroom` too).
    #[must_use]
    pub fn from_id(id: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|room| room.id().eq_ignore_ascii_case(id))
    }

    /// The room at this index of [`Self::ALL`].
    #[must_use]
    pub fn from_index(index: u32) -> Option<Self> {
        Self::ALL.get(index as usize).copied()
    }
}
