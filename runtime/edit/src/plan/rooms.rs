//! Rooms: drawn, moved, with other surfaces, gone.

use cohabit_cdf::{RoomId, model::Material};
use toml::{Table, Value};

use super::{Surface, Work, geometry};
use crate::entries::{List, numbers, string};

/// The shortest side of a room, m.
const LEAST_SIDE_M: f32 = 0.5;
/// What a new room looks like.
const FLOOR: (&str, &str) = ("wood", "#b08a5e");
const WALL: (&str, &str) = ("plain", "#ece5d8");

/// Whether an entry is of a room, which it names by `key`.
pub(super) fn is_of(key: &'static str, room: RoomId) -> impl Fn(&Table) -> bool {
    move |entry| entry.get(key).and_then(Value::as_str).and_then(RoomId::new) == Some(room)
}

fn finish((material, color): (&str, &str)) -> Value {
    let pairs = [("material", string(material)), ("color", string(color))];
    Value::Table(pairs.into_iter().map(|(key, value)| (key.to_owned(), value)).collect())
}

fn rects(rects_m: &[[f32; 4]]) -> Value {
    Value::Array(rects_m.iter().map(|rect| numbers(rect)).collect())
}

impl Work<'_> {
    pub(super) fn add_room(&mut self, room: RoomId, rect_m: [f32; 4]) -> Result<(), String> {
        if self.catalog.rooms().get(room).is_none() {
            let known = self.catalog.rooms().listed();
            return Err(format!(
                "this world has no room `{room}`: declare it as a `[[room]]` of `world.toml`, or take one of {known}"
            ));
        }
        if self.layout.room(room).is_some() {
            return Err(format!("the plan has a room `{room}` already: choose another one"));
        }
        let rect_m = geometry::rect_at(self.layout, room, rect_m);
        self.check_rect(room, rect_m)?;
        let circuit = self.layout.rooms.first().map_or(1, |first| first.circuit);
        let pairs = [
            ("id", string(room.id())),
            ("rects_m", rects(&[rect_m])),
            ("floor", finish(FLOOR)),
            ("wall", finish(WALL)),
            ("circuit", Value::Integer(i64::from(circuit))),
        ];
        let entry: Table = pairs.into_iter().map(|(key, value)| (key.to_owned(), value)).collect();
        self.text.add(List::Room, &Value::Table(entry))
    }

    pub(super) fn set_room(&mut self, room: RoomId, rects_m: &[[f32; 4]]) -> Result<(), String> {
        let rects_m: Vec<[f32; 4]> = rects_m.iter().map(|rect| geometry::rect_at(self.layout, room, *rect)).collect();
        rects_m.iter().try_for_each(|rect| self.check_rect(room, *rect))?;
        self.change_room(room, |entry| {
            entry.insert("rects_m".to_owned(), rects(&rects_m));
        })
    }

    fn check_rect(&self, room: RoomId, rect_m: [f32; 4]) -> Result<(), String> {
        let [west, south, east, north] = rect_m;
        if east - west < LEAST_SIDE_M || north - south < LEAST_SIDE_M {
            return Err(format!("each side of a room has at least {LEAST_SIDE_M} m"));
        }
        match geometry::overlapped(self.layout, room, rect_m) {
            Some(other) => Err(format!("`{room}` would lie on `{other}`: rooms share walls, and no floor")),
            None => Ok(()),
        }
    }

    pub(super) fn move_room(&mut self, room: RoomId, by_m: [f32; 2]) -> Result<(), String> {
        let own = self.layout.room(room).ok_or_else(|| format!("the plan has no room `{room}`"))?;
        let first = own.rects_m.first().ok_or("the room has no rectangle")?;
        let [x, y] = by_m;
        // All of it goes as far as its first rectangle does.
        let to = geometry::rect_at(self.layout, room, [first[0] + x, first[1] + y, first[2] + x, first[3] + y]);
        let [x, y] = [to[0] - first[0], to[1] - first[1]];
        let rects_m: Vec<[f32; 4]> =
            own.rects_m.iter().map(|rect| [rect[0] + x, rect[1] + y, rect[2] + x, rect[3] + y]).collect();
        rects_m.iter().try_for_each(|rect| self.check_rect(room, *rect))?;
        self.change_room(room, |entry| {
            entry.insert("rects_m".to_owned(), rects(&rects_m));
        })?;
        let layout = self.layout;
        for thing in
            layout.placements.iter().filter(|thing| thing.room == room && thing.on.is_none() && !layout.is_door(thing))
        {
            let mut moved = thing.clone();
            moved.at_m = [thing.at_m[0] + x, thing.at_m[1] + y, thing.at_m[2]];
            self.put(&moved)?;
        }
        for opening in layout.openings.iter().filter(|opening| opening.between == [room; 2]) {
            let mut moved = opening.clone();
            moved.at_m = [opening.at_m[0] + x, opening.at_m[1] + y];
            self.put_opening(opening, &moved)?;
        }
        self.move_places(room, [x, y])
    }

    pub(super) fn finish(
        &mut self,
        room: RoomId,
        surface: Surface,
        material: Material,
        color: &str,
    ) -> Result<(), String> {
        let key = match surface {
            Surface::Floor => "floor",
            Surface::Wall => "wall",
        };
        let material = serde_json::to_value(material).map_err(|error| error.to_string())?;
        let value = finish((material.as_str().unwrap_or("plain"), color));
        self.change_room(room, |entry| {
            entry.insert(key.to_owned(), value);
        })
    }

    pub(super) fn remove_room(&mut self, room: RoomId) -> Result<(), String> {
        self.room_entry(room)?;
        let layout = self.layout;
        for thing in
            layout.placements.iter().filter(|thing| thing.room == room && thing.on.is_none() && !layout.is_door(thing))
        {
            self.remove_thing(&thing.instance)?;
        }
        for opening in layout.openings.iter().filter(|opening| opening.between.contains(&room)) {
            self.remove_opening_entry(opening)?;
        }
        self.text.remove_all(List::Viewpoint, is_of("room", room))?;
        self.text.remove_all(List::NotePlace, is_of("room", room))?;
        self.text.remove_all(List::Room, is_of("id", room))
    }

    /// The place of a room's entry in this file.
    fn room_entry(&self, room: RoomId) -> Result<usize, String> {
        let index = self.text.find(List::Room, is_of("id", room))?;
        index.ok_or_else(|| {
            format!("`{room}` is no room of this file: one of its base is changed there, or by the text")
        })
    }

    fn change_room(&mut self, room: RoomId, change: impl FnOnce(&mut Table)) -> Result<(), String> {
        let index = self.room_entry(room)?;
        let mut entry = self.text.tables(List::Room)?.swap_remove(index);
        change(&mut entry);
        self.text.set(List::Room, index, entry)
    }
}
