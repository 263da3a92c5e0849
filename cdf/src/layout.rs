//! Floor plans: rooms, openings, what stands where, and the circuits that feed it.

mod check;
mod fault;
mod file;
mod floor;
mod footprint;
mod mirror;
mod ways;

use serde::{Deserialize, Serialize};

use crate::builtin;
use crate::catalog::Catalog;
use crate::nearest::aside;
use crate::room::RoomId;
use footprint::Footprint;

pub use fault::{LayoutFault, NoStand, NoWay};
pub use floor::FreeFloor;

/// A floor plan, ready to be built: bases resolved, mirrored if its id says so.
///
/// A file in `cdf/layouts` is either a whole plan or, with `base = "…"`, what differs from another one; every plan
/// also exists mirrored left to right under its id and `_mirror`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Layout {
    /// Its id, such as `OfficeLayout1` or `OfficeLayout1_mirror`.
    pub id: String,
    /// Height of all rooms, m.
    pub wall_height_m: f32,
    /// The rooms.
    pub rooms: Vec<Room>,
    /// Doors, passages and windows in the walls between them.
    pub openings: Vec<Opening>,
    /// What stands where, parents before what stands on them; the doors of the openings are among them.
    pub placements: Vec<Placement>,
    /// Named viewpoints, eight a room.
    pub viewpoints: Vec<Viewpoint>,
    /// Where sticky notes can be stuck.
    pub note_places: Vec<NotePlace>,
}

impl Layout {
    /// The project's own plan with this id, such as `OfficeLayout1` or `OfficeLayout1_mirror`.
    ///
    /// # Errors
    /// [`LayoutError::Unknown`] names the ids there are.
    pub fn builtin(id: &str) -> Result<Self, LayoutError> {
        Self::parse(id, builtin::LAYOUTS)
    }

    /// The ids that [`Self::builtin`] knows, mirrored ones last.
    #[must_use]
    pub fn builtin_ids() -> Vec<String> {
        file::ids(builtin::LAYOUTS)
    }

    /// The plan with this id that there is with this catalogue: one of the project's own, or of a world pack.
    ///
    /// # Errors
    /// [`LayoutError`] names the file and what is wrong in it, or the ids there are.
    pub fn find(id: &str, catalog: &Catalog) -> Result<Self, LayoutError> {
        Self::parse(id, &files(catalog))
    }

    /// The plan `id` as `text` of its `file` has it, whatever the catalogue has of it; its bases are those that [`Self::find`] knows.
    ///
    /// # Errors
    /// As [`Self::find`].
    pub fn draft(id: &str, file: &str, text: &str, catalog: &Catalog) -> Result<Self, LayoutError> {
        let mut all = vec![(file, text)];
        all.extend(files(catalog));
        Self::parse(id, &all)
    }

    /// The ids that [`Self::find`] knows, mirrored ones last.
    #[must_use]
    pub fn ids(catalog: &Catalog) -> Vec<String> {
        file::ids(&files(catalog))
    }

    /// The room whose floor has this point, if any.
    #[must_use]
    pub fn room_at(&self, x_m: f32, y_m: f32) -> Option<RoomId> {
        self.rooms.iter().find(|room| room.has(x_m, y_m)).map(|room| room.id)
    }

    /// The room with this id.
    #[must_use]
    pub fn room(&self, id: RoomId) -> Option<&Room> {
        self.rooms.iter().find(|room| room.id == id)
    }

    /// `[west, south, east, north]` around all rooms, m.
    #[must_use]
    pub fn bounds_m(&self) -> [f32; 4] {
        self.rooms.iter().flat_map(|room| &room.rects_m).fold(
            [f32::INFINITY, f32::INFINITY, f32::NEG_INFINITY, f32::NEG_INFINITY],
            |[west, south, east, north], rect| {
                [west.min(rect[0]), south.min(rect[1]), east.max(rect[2]), north.max(rect[3])]
            },
        )
    }

    /// A placement by its instance id.
    #[must_use]
    pub fn placement(&self, instance: &str) -> Option<&Placement> {
        self.placements.iter().find(|placement| placement.instance == instance)
    }

    /// The outlines of the furniture seen from above, m: corners in order, lower pieces before those above them. What
    /// stands on other things, and doors, are not among them.
    #[must_use]
    pub fn furniture_outlines_m(&self, catalog: &Catalog) -> Vec<[[f32; 2]; 4]> {
        let is_door = |placement: &Placement| {
            self.openings.iter().any(|opening| opening.door.as_ref() == Some(&placement.instance))
        };
        let stands = |placement: &&Placement| placement.on.is_none() && !is_door(placement);
        let mut prints: Vec<Footprint> = (self.placements.iter().filter(stands))
            .filter_map(|placement| {
                let class = catalog.class(catalog.class_of_instance(&placement.instance)?);
                Some(Footprint::of(self, placement, class))
            })
            .collect();
        prints.sort_by(|a, b| a.height_m[1].total_cmp(&b.height_m[1]));
        prints.iter().map(Footprint::corners_m).collect()
    }

    /// Where a placement's origin lies in the world, m: its own `at_m`, through the frames of all it stands on. One
    /// that takes an anchor counts as standing in the middle of what has the anchor.
    #[must_use]
    pub fn origin_in_world_m(&self, placement: &Placement) -> [f32; 3] {
        let parent = placement.on.as_deref().and_then(|on| self.placement(on));
        let Some(parent) = parent else { return placement.at_m };
        let base = self.origin_in_world_m(parent);
        let [x, y, z] = if placement.anchor { [0.0; 3] } else { placement.at_m };
        let yaw = parent.yaw_deg.to_radians();
        let (sin, cos) = (libm::sinf(yaw), libm::cosf(yaw));
        [base[0] + cos * x - sin * y, base[1] + sin * x + cos * y, base[2] + z]
    }
}

/// The project's own plan files, and those of the world packs that a catalogue has.
fn files(catalog: &Catalog) -> Vec<(&str, &str)> {
    builtin::LAYOUTS.iter().copied().chain(catalog.plans()).collect()
}

/// A room: a rectangle of floor, walls around it.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Room {
    /// Which.
    pub id: RoomId,
    /// `[west, south, east, north]` at the middle of its walls, m. Several rectangles make an L.
    pub rects_m: Vec<[f32; 4]>,
    /// Floor: material and colour, such as `tile #d8d2c4`.
    pub floor: Finish,
    /// Walls.
    pub wall: Finish,
    /// The lower part of the walls up to 1 m, if it differs.
    #[serde(default)]
    pub wainscot: Option<Finish>,
    /// The circuit that feeds its lights and machines; the fuse box that stands in one of its rooms feeds it.
    pub circuit: u8,
}

impl Room {
    /// Whether its floor has this point.
    #[must_use]
    pub fn has(&self, x_m: f32, y_m: f32) -> bool {
        self.rects_m.iter().any(|r| x_m > r[0] && x_m < r[2] && y_m > r[1] && y_m < r[3])
    }

    /// Floor area to the middle of its walls, m²; its rectangles do not overlap.
    #[must_use]
    pub fn area_m2(&self) -> f32 {
        self.rects_m.iter().map(|r| (r[2] - r[0]) * (r[3] - r[1])).sum()
    }
}

/// The surface of a floor or wall.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Finish {
    /// Pattern.
    pub material: crate::model::Material,
    /// `#rrggbb`.
    pub color: String,
}

/// A gap in a wall.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Opening {
    /// What kind of gap.
    pub kind: OpeningKind,
    /// The door's instance id, such as `Door_01_1`.
    #[serde(default)]
    pub door: Option<String>,
    /// The two rooms it joins, in a file the southern or western one first; a door's front faces the second. The same
    /// twice for a window to the outside.
    pub between: [RoomId; 2],
    /// Its middle on the wall's middle line, m.
    pub at_m: [f32; 2],
    /// Its width, m.
    pub width_m: f32,
    /// Which way the wall runs: `x` east-west, `y` north-south.
    pub wall_runs: crate::model::Axis,
}

/// Kinds of gaps in walls.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum OpeningKind {
    /// With a door in it, 2.1 m high.
    Door,
    /// Without a door, 2.3 m high.
    Passage,
    /// From 1 m to 2.2 m, glazed.
    Window,
}

/// Something that stands in the layout from the start.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Placement {
    /// Its instance id, such as `Microwave_01_10000`.
    pub instance: String,
    /// Its room.
    pub room: RoomId,
    /// Its origin, m: in the world, or in the frame of `on` if that is given.
    #[serde(default)]
    pub at_m: [f32; 3],
    /// Its yaw, degrees: in the world, also when it stands on something.
    #[serde(default)]
    pub yaw_deg: f32,
    /// The instance it stands on or in; `at_m` may then be left to the next free anchor by `anchor = true`.
    #[serde(default)]
    pub on: Option<String>,
    /// Whether to ignore `at_m` and take the next free anchor of `on`.
    #[serde(default)]
    pub anchor: bool,
    /// Where its device works from or on, by instance id: a monitor's machine, a button's station, a ray's shelf.
    #[serde(default)]
    pub works: Option<String>,
    /// Its model's scale along x, y, z: for walls of cupboards, long shelves.
    #[serde(default = "unit_scale")]
    pub scale: [f32; 3],
}

const fn unit_scale() -> [f32; 3] {
    [1.0; 3]
}

/// A named place to stand and look from.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Viewpoint {
    /// Its room.
    pub room: RoomId,
    /// Its number in the room, from 1.
    pub number: u8,
    /// Where to stand, m.
    pub at_m: [f32; 2],
    /// Where to look, degrees.
    pub yaw_deg: f32,
}

/// A place where a sticky note can be stuck.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct NotePlace {
    /// Its room; the order within a room is the index that missions use.
    pub room: RoomId,
    /// The note's origin, m.
    pub at_m: [f32; 3],
    /// The way the note faces, degrees.
    pub yaw_deg: f32,
}

/// Why a floor plan could not be had.
#[derive(Debug, thiserror::Error)]
pub enum LayoutError {
    /// The text is not the TOML expected.
    #[error("{file}: {source}")]
    Syntax {
        /// Which file.
        file: String,
        /// Where and what.
        source: Box<toml::de::Error>,
    },
    /// No file has this id.
    #[error("there is no layout `{id}`{}; there are {known}", aside(.near))]
    Unknown {
        /// What was asked for.
        id: String,
        /// The one that it may have been meant to be.
        near: Option<String>,
        /// What there is.
        known: String,
    },
    /// A file names an instance that is not there to be removed, or to be stood on.
    #[error("{file}: there is no `{instance}`{}: name an instance placed earlier", aside(.near))]
    NoInstance {
        /// Which file.
        file: String,
        /// The instance it names.
        instance: String,
        /// The one that it may have been meant to be.
        near: Option<String>,
    },
    /// Two placements share an id.
    #[error("{file}: `{instance}` is placed twice")]
    Duplicate {
        /// Which file.
        file: String,
        /// The id.
        instance: String,
    },
    /// A file has a room, a door or a viewpoint twice; the second would take the place of the first.
    #[error("{file}: the {what} is there twice: {remedy}")]
    Twice {
        /// Which file.
        file: String,
        /// What, with its id.
        what: String,
        /// What would be right.
        remedy: &'static str,
    },
    /// An object stands on what stands on it.
    #[error("{file}: `{instance}` stands on itself")]
    OnItself {
        /// Which plan.
        file: String,
        /// One of the objects.
        instance: String,
    },
    /// Files name each other as bases in a circle.
    #[error("{file}: its bases lead back to itself")]
    Circle {
        /// Which file.
        file: String,
    },
}

#[cfg(test)]
mod tests;
