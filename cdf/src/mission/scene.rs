//! Reads where a mission takes place: layout, seed, start room and notes.

use std::{collections::BTreeMap, sync::LazyLock};

use super::{
    NoteRequest,
    problem::Pointer,
    raw::{Loose, Scalar, Scene, StickyNote},
    reader::Reader,
};
use crate::{layout::Layout, nearest::did_you_mean, room::RoomId};

/// The layout of a mission that names none.
pub(super) const DEFAULT_LAYOUT: &str = "OfficeLayout1";

/// The start room of a mission that names none, if its layout has it; the layout's first room otherwise.
pub(super) const DEFAULT_ROOM: RoomId = RoomId::BREAK_ROOM;

/// The layouts of the format; each has a `_mirror` too. There may be no floor plan for some of them.
pub(super) const LAYOUTS: [&str; 5] =
    ["OfficeLayout1", "OfficeLayout1B", "OfficeLayout1C", "OfficeLayout2", "OfficeLayout3"];

/// The end of the ids of mirrored layouts.
pub(super) const MIRRORED: &str = "_mirror";

/// The project's own floor plans by their ids; reading one takes longer than checking a mission against it.
fn plans() -> &'static BTreeMap<String, Layout> {
    static PLANS: LazyLock<BTreeMap<String, Layout>> = LazyLock::new(|| {
        let plans = Layout::builtin_ids().into_iter().map(|id| (Layout::builtin(&id), id));
        plans.filter_map(|(plan, id)| Some((id, plan.ok()?))).collect()
    });
    &PLANS
}

/// The class of notes.
const NOTE: &str = "StickyNote";

/// The parts of a scene that are no objects.
pub(super) struct SceneParts {
    pub name: String,
    pub layout: String,
    pub seed: Option<u64>,
    pub start_room: RoomId,
    pub blacklisted_layouts: Vec<String>,
    pub random_looks: bool,
}

impl Reader<'_> {
    /// Reads all of a scene but its objects and notes, and loads its layout.
    pub fn scene(&mut self, at: &Pointer, scene: &Scene) -> SceneParts {
        self.extras(at, scene);
        let blacklisted_layouts = self.blacklist(&at.key("blacklisted_layouts"), &scene.blacklisted_layouts);
        let layout = self.layout_id(&at.key("layoutOverride"), &scene.layout_override, &blacklisted_layouts);
        SceneParts {
            name: self.text(&at.key("scene_id"), &scene.scene_id).unwrap_or_else(|| self.file.to_owned()),
            seed: self.seed(&at.key("floor_plan"), &scene.floor_plan),
            start_room: self.start_room(&at.key("roomLocation"), &scene.room_location),
            layout,
            blacklisted_layouts,
            random_looks: self.truth(&at.key("completelyRandomVisual"), &scene.completely_random_visual, false),
        }
    }

    /// The layout asked for; without a wish the first one that is not blacklisted.
    fn layout_id(&mut self, at: &Pointer, field: &Loose<Scalar>, blacklisted: &[String]) -> String {
        let plans = plans();
        let Some(id) = self.text(at, field) else {
            let mut free = plans.keys().map(String::as_str).filter(|id| !blacklisted.iter().any(|listed| listed == id));
            let id = match free.clone().find(|id| *id == DEFAULT_LAYOUT).or_else(|| free.next()) {
                Some(id) => id,
                None => {
                    self.error(at, "every layout is blacklisted", None);
                    DEFAULT_LAYOUT
                }
            };
            self.layout = plans.get(id);
            return id.to_owned();
        };
        if blacklisted.contains(&id) {
            self.error(at, format!("layout `{id}` is both asked for and blacklisted"), None);
        }
        if let Some(plan) = plans.get(&id) {
            self.layout = Some(plan);
        } else if self.has_own_plan(&id) {
            self.load_own_plan(at, &id);
        } else if LAYOUTS.contains(&id.strip_suffix(MIRRORED).unwrap_or(&id)) {
            let remedy = Some(format!("take `{DEFAULT_LAYOUT}`"));
            self.warn(at, format!("there is no floor plan for layout `{id}` yet"), remedy);
        } else {
            let known = Layout::ids(self.catalog);
            self.unknown(at, "layout", &id, known.iter().map(String::as_str));
        }
        id
    }

    /// Whether a world pack has this floor plan.
    fn has_own_plan(&self, id: &str) -> bool {
        !self.catalog.packs().is_empty() && Layout::ids(self.catalog).iter().any(|known| known == id)
    }

    /// Takes a floor plan of a world pack for the mission's.
    fn load_own_plan(&mut self, at: &Pointer, id: &str) {
        match Layout::find(id, self.catalog) {
            Ok(plan) => {
                let kept = self.kept;
                self.layout = Some(kept.get_or_init(|| plan));
            }
            Err(error) => self.error(at, format!("the floor plan `{id}` cannot be read: {error}"), None),
        }
    }

    /// The layouts in which the mission must not be played.
    fn blacklist(&mut self, at: &Pointer, field: &Loose<Vec<Scalar>>) -> Vec<String> {
        let entries = self.field(at, field, "a list of layouts").map_or(&[][..], Vec::as_slice);
        let mut blacklisted = Vec::with_capacity(entries.len());
        for (index, entry) in entries.iter().enumerate() {
            let id = entry.text();
            let known = LAYOUTS.contains(&id.strip_suffix(MIRRORED).unwrap_or(&id))
                || plans().contains_key(&id)
                || self.has_own_plan(&id);
            if !known {
                let remedy = did_you_mean(&id, plans().keys().map(String::as_str));
                self.warn(&at.item(index), format!("unknown layout `{id}` is blacklisted"), remedy);
            }
            blacklisted.push(id);
        }
        blacklisted
    }

    fn seed(&mut self, at: &Pointer, field: &Loose<Scalar>) -> Option<u64> {
        let number = self.integer(at, field)?;
        if number < -1 {
            self.warn(at, format!("`{number}` is no seed, taken as random"), Some("`-1` is random".to_owned()));
        }
        u64::try_from(number).ok()
    }

    fn start_room(&mut self, at: &Pointer, field: &Loose<Vec<Scalar>>) -> RoomId {
        let misfit = field.misfit().is_some();
        match self.first_text(at, field) {
            Some((at, id)) => {
                let room = self.room(&at, &id);
                room.inspect(|room| self.room_in_layout(&at, *room)).unwrap_or_else(|| self.default_room())
            }
            None => {
                let room = self.default_room();
                if !misfit {
                    let remedy = format!("taken as `{room}`");
                    self.warn(at, "the mission does not say where the robot starts", Some(remedy));
                }
                room
            }
        }
    }

    fn default_room(&self) -> RoomId {
        let first = |layout: &Layout| layout.rooms.first().map(|room| room.id);
        let missing = self.layout.filter(|layout| layout.room(DEFAULT_ROOM).is_none());
        missing.and_then(first).unwrap_or(DEFAULT_ROOM)
    }

    /// The room of that id, or of that name in this world; none and a problem if there is none.
    pub fn room(&mut self, at: &Pointer, text: &str) -> Option<RoomId> {
        let room = self.catalog.rooms().find(text);
        if room.is_none() {
            let (rooms, layout) = (self.catalog.rooms(), self.layout);
            let (ids, names) =
                (rooms.all().iter().map(|room| room.id.id()), rooms.all().iter().map(|room| &*room.name));
            let there = || layout.map_or_else(|| rooms.listed(), listed);
            let remedy = did_you_mean(text, ids.chain(names)).unwrap_or_else(|| format!("there are {}", there()));
            self.error(at, format!("unknown room `{text}`"), Some(remedy));
        }
        room
    }

    /// The room of a list's first item, if any is said.
    pub fn first_room(&mut self, at: &Pointer, list: &Loose<Vec<Scalar>>) -> Option<RoomId> {
        let (at, id) = self.first_text(at, list)?;
        self.room(&at, &id)
    }

    /// Reads the notes stuck to places of rooms.
    pub fn notes(&mut self, at: &Pointer, list: &Loose<Vec<Loose<StickyNote>>>) -> Vec<NoteRequest> {
        let notes = self.items(at, list, "a sticky note");
        notes.into_iter().filter_map(|(at, note)| self.note(&at, note)).collect()
    }

    fn note(&mut self, at: &Pointer, note: &StickyNote) -> Option<NoteRequest> {
        self.extras(at, note);
        let text = self.text(&at.key("text"), &note.text).unwrap_or_default();
        let instance = self.new_instance(&at.key("name"), &note.name);
        if let Some(instance) = instance.as_deref()
            && !instance.starts_with(NOTE)
        {
            self.error(&at.key("name"), format!("`{instance}` is no `{NOTE}`"), None);
        }
        let room_at = at.key("room");
        let room = match self.text(&room_at, &note.room) {
            Some(id) => {
                let room = self.room(&room_at, &id);
                room.inspect(|room| self.room_in_layout(&room_at, *room))
            }
            None => {
                self.error(&room_at, "the note has no room", None);
                None
            }
        };
        let place = self.place(&at.key("location"), &note.location, room);
        Some(NoteRequest { instance: instance?, text, room: room?, place })
    }

    fn place(&mut self, at: &Pointer, field: &Loose<Scalar>, room: Option<RoomId>) -> usize {
        let number = self.integer(at, field).unwrap_or(0);
        let Ok(place) = usize::try_from(number) else {
            self.error(at, format!("`{number}` is no place; places are counted from 0"), None);
            return 0;
        };
        let places = |layout: &Layout| layout.note_places.iter().filter(|place| Some(place.room) == room).count();
        if let (Some(layout), Some(room)) = (self.layout, room) {
            let places = places(layout);
            if place >= places {
                let name = room.name_in(self.catalog);
                let message = format!("the {name} has {places} places for notes; the last one is taken");
                self.warn(at, message, None);
            }
        }
        place
    }
}

/// The rooms of a floor plan.
fn listed(layout: &Layout) -> String {
    layout.rooms.iter().map(|room| room.id.id()).collect::<Vec<_>>().join(", ")
}
