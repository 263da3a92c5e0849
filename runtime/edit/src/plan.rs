//! A floor plan that is edited: each edit is a change of its file's text, and nothing else.

mod geometry;
mod openings;
mod rooms;
mod shown;
mod stand;
mod things;

use std::sync::Arc;

use cohabit_cdf::{Catalog, Layout, RoomId, layout::OpeningKind, model::Material, world_pack::PlanDraft};
use cohabit_render::furnish;
use serde::Deserialize;
use serde_json::Value;

use crate::{
    document::{Document, Drawn},
    entries::Entrywise,
    mission::blank,
};

/// The end of the ids of mirrored plans, which have no files.
const MIRRORED: &str = "_mirror";
/// What a plan begins with that has no file yet.
const EMPTY: &str = "wall_height_m = 2.8\n";

/// A change of a floor plan. Points are in metres, x east and y north; headings are in degrees.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(tag = "do", rename_all = "snake_case")]
pub enum PlanEdit {
    /// Another text.
    Text {
        /// All of it.
        text: String,
    },
    /// Other height of the rooms.
    Height {
        /// The height.
        wall_height_m: f32,
    },
    /// A room.
    AddRoom {
        /// Which.
        room: RoomId,
        /// Two of its corners: x, y, x, y.
        rect_m: [f32; 4],
    },
    /// Another outline of a room; what stands in it stays where it is.
    SetRoom {
        /// Which.
        room: RoomId,
        /// Its rectangles.
        rects_m: Vec<[f32; 4]>,
    },
    /// A room elsewhere, with all that is in it but for doors to other rooms.
    MoveRoom {
        /// Which.
        room: RoomId,
        /// How far.
        by_m: [f32; 2],
    },
    /// Another surface of a room.
    Finish {
        /// Which room.
        room: RoomId,
        /// Which surface.
        surface: Surface,
        /// What it is of.
        material: Material,
        /// Its colour, `#rrggbb`.
        color: String,
    },
    /// An opening in the wall that is nearest.
    AddOpening {
        /// What it is.
        kind: OpeningKind,
        /// Near its middle.
        at_m: [f32; 2],
    },
    /// An opening elsewhere, or of another width.
    SetOpening {
        /// Its place among the openings of the plan.
        index: usize,
        /// Near its middle.
        at_m: [f32; 2],
        /// Its width.
        width_m: f32,
    },
    /// An object: on what takes it there, at the wall, or on the floor.
    AddThing {
        /// Its class.
        class: String,
        /// Where.
        at_m: [f32; 2],
    },
    /// An object that was dropped elsewhere: on what takes it there, at the wall, or on the floor.
    DropThing {
        /// Which.
        instance: String,
        /// Where.
        at_m: [f32; 2],
    },
    /// An object at the very place that is said: in the world, or in the frame of what it stands on.
    SetThing {
        /// Which.
        instance: String,
        /// Where.
        at_m: [f32; 3],
        /// The way that it faces.
        yaw_deg: f32,
    },
    /// A viewpoint elsewhere.
    SetView {
        /// Its room.
        room: RoomId,
        /// Its number.
        number: u8,
        /// Where to stand.
        at_m: [f32; 2],
        /// Where to look.
        yaw_deg: f32,
    },
    /// Something gone, with what stands on it.
    Remove(Item),
    /// The viewpoints and places for notes that rooms lack.
    Complete,
}

/// A surface of a room.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq)]
#[serde(rename_all = "snake_case")]
pub enum Surface {
    /// Its floor.
    Floor,
    /// Its walls.
    Wall,
}

/// Something in a floor plan.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(tag = "what", rename_all = "snake_case")]
pub enum Item {
    /// A room.
    Room {
        /// Which.
        room: RoomId,
    },
    /// An opening.
    Opening {
        /// Its place among the openings of the plan.
        index: usize,
    },
    /// An object.
    Thing {
        /// Which.
        instance: String,
    },
    /// A viewpoint.
    View {
        /// Its room.
        room: RoomId,
        /// Its number.
        number: u8,
    },
    /// A place for notes.
    Note {
        /// Its place among those of the plan.
        index: usize,
    },
}

/// The floor plan of a file, and what it is checked against.
#[derive(Clone, Debug)]
pub struct PlanDocument {
    id: String,
    file: String,
    catalog: Arc<Catalog>,
}

/// A plan at work: its text, and what the text says.
struct Work<'a> {
    text: Entrywise,
    layout: &'a Layout,
    catalog: &'a Catalog,
}

impl PlanDocument {
    /// The plan of `file`, whose name without its ending is the plan's id. The catalogue has all of its world but for the plan.
    ///
    /// # Errors
    /// Why no file of a plan may be called so, in words.
    pub fn new(file: &str, catalog: Arc<Catalog>) -> Result<Self, String> {
        let name = file.rsplit('/').next().unwrap_or(file);
        let id = name.strip_suffix(".toml").unwrap_or(name).to_owned();
        if id.ends_with(MIRRORED) {
            return Err(format!(
                "`{id}` is the name of a mirror image, which each plan has without a file: take another name"
            ));
        }
        if Layout::ids(&catalog).contains(&id) {
            return Err(format!("there is a floor plan `{id}` already: take another name"));
        }
        Ok(Self { id, file: file.to_owned(), catalog })
    }

    /// The text of a plan that has no file yet.
    #[must_use]
    pub const fn empty() -> &'static str {
        EMPTY
    }

    /// The text after an edit.
    ///
    /// # Errors
    /// Why that cannot be, in words.
    pub fn apply(&self, text: &str, edit: PlanEdit) -> Result<String, String> {
        if let PlanEdit::Text { text } = edit {
            return Ok(text);
        }
        let draft = self.draft(text);
        let layout = draft.layout.ok_or("the text of the file cannot be read as it is: mend it first, or undo")?;
        let mut work = Work { text: Entrywise::new(text)?, layout: &layout, catalog: &self.catalog };
        match edit {
            PlanEdit::Text { .. } => {}
            PlanEdit::Height { wall_height_m } => work.text.set_height(wall_height_m)?,
            PlanEdit::AddRoom { room, rect_m } => work.add_room(room, rect_m)?,
            PlanEdit::SetRoom { room, rects_m } => work.set_room(room, &rects_m)?,
            PlanEdit::MoveRoom { room, by_m } => work.move_room(room, by_m)?,
            PlanEdit::Finish { room, surface, material, color } => work.finish(room, surface, material, &color)?,
            PlanEdit::AddOpening { kind, at_m } => work.add_opening(kind, at_m)?,
            PlanEdit::SetOpening { index, at_m, width_m } => work.set_opening(index, at_m, width_m)?,
            PlanEdit::AddThing { class, at_m } => work.add_thing(&class, at_m)?,
            PlanEdit::DropThing { instance, at_m } => work.drop_thing(&instance, at_m)?,
            PlanEdit::SetThing { instance, at_m, yaw_deg } => work.set_thing(&instance, at_m, yaw_deg)?,
            PlanEdit::SetView { room, number, at_m, yaw_deg } => work.set_view(room, number, at_m, yaw_deg)?,
            PlanEdit::Remove(item) => work.remove(item)?,
            PlanEdit::Complete => work.complete()?,
        }
        let text = work.text.into_text();
        // Numbers that are none, and whatever else the file of a plan cannot say, are no change of a plan.
        let changed = self.draft(&text);
        match (changed.layout, changed.errors.first()) {
            (None, Some(error)) => Err(error.to_string()),
            _ => Ok(text),
        }
    }

    /// What a text says, and what is wrong with it.
    #[must_use]
    pub fn draft(&self, text: &str) -> PlanDraft {
        PlanDraft::read(&self.id, &self.file, text, &self.catalog)
    }
}

impl Document for PlanDocument {
    fn kind(&self) -> &'static str {
        "plan"
    }

    fn edited(&self, text: &str, edit: Value) -> Result<String, String> {
        let edit = serde_json::from_value(edit).map_err(|error| format!("this is no edit of a floor plan: {error}"))?;
        self.apply(text, edit)
    }

    fn shown(&self, text: &str) -> Value {
        shown::plan(&self.draft(text), &self.catalog)
    }

    fn choices(&self) -> Value {
        shown::choices(&self.catalog)
    }

    fn drawn(&self, text: &str) -> Option<Drawn> {
        let draft = self.draft(text);
        let layout = draft.layout.filter(|_| draft.errors.is_empty())?;
        let instances = furnish(&self.catalog, &layout);
        Some(Drawn { layout, instances })
    }

    fn is_sound(&self, text: &str) -> bool {
        let draft = self.draft(text);
        draft.errors.is_empty() && draft.faults.is_empty()
    }

    /// One without goals, in which people look around.
    fn mission(&self, text: &str) -> String {
        let start = self.draft(text).layout.and_then(|layout| layout.rooms.first().map(|room| room.id));
        blank(&format!("Look around in {}", self.id), &self.id, start).to_string()
    }
}

impl Work<'_> {
    fn remove(&mut self, item: Item) -> Result<(), String> {
        match item {
            Item::Room { room } => self.remove_room(room),
            Item::Opening { index } => self.remove_opening(index),
            Item::Thing { instance } => self.remove_thing(&instance),
            Item::View { room, number } => self.remove_view(room, number),
            Item::Note { index } => self.remove_note(index),
        }
    }
}

#[cfg(test)]
mod tests;
