//! Viewpoints and places for notes: those that rooms lack are found in them.

use cohabit_cdf::{
    RoomId,
    layout::{FreeFloor, NotePlace, Room, Viewpoint},
};
use toml::{Table, Value};

use super::{
    Work,
    geometry::{self, Wall},
    rooms::is_of,
};
use crate::entries::{List, number, numbers, string};

/// Viewpoints of a room.
const VIEWPOINTS: u8 = 8;
/// Places for notes of a room.
const NOTES: usize = 4;
/// Radius of a robot, m.
const ROBOT_RADIUS_M: f32 = 0.25;
/// Who looks around stands so far from the middle of walls, m.
const FROM_WALL_M: f32 = 0.4;
/// Where notes hang: their height, and how far from the middle of the wall, m.
const NOTE_M: f32 = 1.4;
const NOTE_FROM_WALL_M: f32 = 0.072;
/// Between places for notes that are looked at, and from the ends of a wall, m.
const NOTE_STEP_M: f32 = 0.3;
/// What is kept free around a note, m.
const AROUND_NOTE_M: f32 = 0.2;

fn view_entry(view: &Viewpoint) -> Table {
    let pairs = [
        ("room", string(view.room.id())),
        ("number", Value::Integer(i64::from(view.number))),
        ("at_m", numbers(&view.at_m)),
        ("yaw_deg", number(view.yaw_deg)),
    ];
    pairs.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
}

fn note_entry(note: &NotePlace) -> Table {
    let pairs = [("room", string(note.room.id())), ("at_m", numbers(&note.at_m)), ("yaw_deg", number(note.yaw_deg))];
    pairs.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
}

fn is_view(room: RoomId, number: u8) -> impl Fn(&Table) -> bool {
    let is_of_room = is_of("room", room);
    move |entry| is_of_room(entry) && entry.get("number").and_then(Value::as_integer) == Some(i64::from(number))
}

impl Work<'_> {
    /// Adds the viewpoints and the places for notes that rooms lack.
    pub(super) fn complete(&mut self) -> Result<(), String> {
        let (layout, catalog) = (self.layout, self.catalog);
        let floor = FreeFloor::new(layout, catalog, ROBOT_RADIUS_M);
        for room in &layout.rooms {
            for view in self.views(room, &floor) {
                self.text.add(List::Viewpoint, &Value::Table(view_entry(&view)))?;
            }
            self.add_notes(room)?;
        }
        Ok(())
    }

    /// Those that a room lacks, far from each other.
    fn views(&self, room: &Room, floor: &FreeFloor) -> Vec<Viewpoint> {
        let own: Vec<&Viewpoint> = self.layout.viewpoints.iter().filter(|view| view.room == room.id).collect();
        let numbers = (1..=VIEWPOINTS).filter(|number| own.iter().all(|view| view.number != *number));
        let numbers: Vec<u8> = numbers.collect();
        let is_inside = |[x, y]: [f32; 2]| {
            let is_in = |rect: &[f32; 4]| {
                x >= rect[0] + FROM_WALL_M
                    && x <= rect[2] - FROM_WALL_M
                    && y >= rect[1] + FROM_WALL_M
                    && y <= rect[3] - FROM_WALL_M
            };
            room.rects_m.iter().any(is_in)
        };
        let free: Vec<[f32; 2]> = floor
            .points_m()
            .filter(|(id, point)| *id == room.id && is_inside(*point))
            .map(|(_, point)| point)
            .collect();
        let before: Vec<[f32; 2]> = own.iter().map(|view| view.at_m).collect();
        let middle = middle(room);
        let chosen = spread(&free, &before, numbers.len());
        let view = |(number, at_m): (u8, [f32; 2])| {
            let yaw = libm::atan2f(middle[1] - at_m[1], middle[0] - at_m[0]).to_degrees().round();
            Viewpoint { room: room.id, number, at_m, yaw_deg: geometry::heading_deg(yaw) }
        };
        numbers.into_iter().zip(chosen).map(view).collect()
    }

    /// Adds places for notes, if a room has too few. A file that names one of a room takes those of its base away, so they are written,
    /// too.
    fn add_notes(&mut self, room: &Room) -> Result<(), String> {
        let own: Vec<&NotePlace> = self.layout.note_places.iter().filter(|note| note.room == room.id).collect();
        if own.len() >= NOTES {
            return Ok(());
        }
        let walls: Vec<Wall> = geometry::walls(self.layout).into_iter().filter(|wall| wall.room == room.id).collect();
        let spots: Vec<(Wall, f32)> = walls.iter().flat_map(|wall| along(wall).map(move |at| (*wall, at))).collect();
        let free: Vec<(Wall, f32)> = spots.into_iter().filter(|(wall, at)| self.is_free_wall(wall, *at)).collect();
        let points: Vec<[f32; 2]> = free.iter().map(|(wall, at)| wall.point(*at, NOTE_FROM_WALL_M)).collect();
        let before: Vec<[f32; 2]> = own.iter().map(|note| [note.at_m[0], note.at_m[1]]).collect();
        let chosen = spread(&points, &before, NOTES - own.len());
        let new = free.iter().zip(&points).filter(|(_, point)| chosen.contains(point));
        let new: Vec<NotePlace> = new
            .map(|((wall, _), [x, y])| NotePlace { room: room.id, at_m: [*x, *y, NOTE_M], yaw_deg: wall.yaw_deg() })
            .collect();
        if self.text.find(List::NotePlace, is_of("room", room.id))?.is_none() {
            for note in own {
                self.text.add(List::NotePlace, &Value::Table(note_entry(note)))?;
            }
        }
        new.iter().try_for_each(|note| self.text.add(List::NotePlace, &Value::Table(note_entry(note))))
    }

    /// Whether a note has room at a place of a wall.
    fn is_free_wall(&self, wall: &Wall, along_m: f32) -> bool {
        let (layout, catalog) = (self.layout, self.catalog);
        let is_in_gap = layout.openings.iter().any(|opening| {
            let [along, across] = wall.local(opening.at_m);
            let is_on_it = opening.wall_runs == wall.runs && (across - wall.at_m).abs() < geometry::HALF_WALL_M;
            is_on_it && (along - along_m).abs() < opening.width_m / 2.0 + AROUND_NOTE_M
        });
        let point = wall.point(along_m, NOTE_FROM_WALL_M);
        let is_behind = layout.placements.iter().any(|thing| {
            let Some(class) = catalog.class_of_instance(&thing.instance) else { return false };
            let class = catalog.class(class);
            let [x, y, z] = layout.origin_in_world_m(thing);
            let is_as_high =
                z < NOTE_M + AROUND_NOTE_M && z + class.size_m[2] * thing.scale[2] > NOTE_M - AROUND_NOTE_M;
            let [ahead, left] = geometry::local_m([x, y], thing.yaw_deg, point);
            let is_near =
                |at: f32, axis: usize| at.abs() < class.size_m[axis] * thing.scale[axis] / 2.0 + AROUND_NOTE_M;
            is_as_high && is_near(ahead, 0) && is_near(left, 1)
        });
        !is_in_gap && !is_behind
    }

    /// Moves the viewpoints and places for notes of a room along.
    pub(super) fn move_places(&mut self, room: RoomId, [x, y]: [f32; 2]) -> Result<(), String> {
        for view in self.layout.viewpoints.iter().filter(|view| view.room == room) {
            let moved = Viewpoint { at_m: [view.at_m[0] + x, view.at_m[1] + y], ..*view };
            self.put_view(&moved)?;
        }
        let notes = self.layout.note_places.iter().filter(|note| note.room == room);
        let moved: Vec<NotePlace> =
            notes.map(|note| NotePlace { at_m: [note.at_m[0] + x, note.at_m[1] + y, note.at_m[2]], ..*note }).collect();
        self.text.remove_all(List::NotePlace, is_of("room", room))?;
        moved.iter().try_for_each(|note| self.text.add(List::NotePlace, &Value::Table(note_entry(note))))
    }

    pub(super) fn set_view(&mut self, room: RoomId, number: u8, at_m: [f32; 2], yaw_deg: f32) -> Result<(), String> {
        if self.layout.room(room).is_none() || !(1..=VIEWPOINTS).contains(&number) {
            return Err(format!("there is no viewpoint {number} of `{room}`"));
        }
        self.put_view(&Viewpoint { room, number, at_m, yaw_deg: geometry::heading_deg(yaw_deg) })
    }

    fn put_view(&mut self, view: &Viewpoint) -> Result<(), String> {
        match self.text.find(List::Viewpoint, is_view(view.room, view.number))? {
            Some(index) => self.text.set(List::Viewpoint, index, view_entry(view)),
            None => self.text.add(List::Viewpoint, &Value::Table(view_entry(view))),
        }
    }

    pub(super) fn remove_view(&mut self, room: RoomId, number: u8) -> Result<(), String> {
        match self.text.find(List::Viewpoint, is_view(room, number))? {
            Some(index) => self.text.remove(List::Viewpoint, index),
            None => Err("this viewpoint is one of the base plan: move it instead".to_owned()),
        }
    }

    pub(super) fn remove_note(&mut self, index: usize) -> Result<(), String> {
        let note = self.layout.note_places.get(index).ok_or("there is no such place for notes")?;
        // Those of a room are in the same order in the file, which has all of them or none.
        let place = self.layout.note_places[..index].iter().filter(|before| before.room == note.room).count();
        let of_room = is_of("room", note.room);
        let entries = self.text.tables(List::NotePlace)?;
        let own = entries.iter().enumerate().filter(|(_, entry)| of_room(entry)).map(|(at, _)| at).nth(place);
        match own {
            Some(at) => self.text.remove(List::NotePlace, at),
            None => Err("this place is one of the base plan, and can be changed there alone".to_owned()),
        }
    }
}

/// Places along a wall, m.
fn along(wall: &Wall) -> impl Iterator<Item = f32> + use<> {
    let [from, to] = wall.span_m;
    let place = move |step: u16| from + NOTE_STEP_M * f32::from(step);
    (1..1000).map(place).take_while(move |at| *at <= to - NOTE_STEP_M)
}

/// The middle of a room's first rectangle, m.
fn middle(room: &Room) -> [f32; 2] {
    room.rects_m.first().map_or([0.0; 2], |r| [f32::midpoint(r[0], r[2]), f32::midpoint(r[1], r[3])])
}

/// So many points far from each other and from those before: always the one that is farthest from all so far.
fn spread(all: &[[f32; 2]], before: &[[f32; 2]], count: usize) -> Vec<[f32; 2]> {
    let apart = |one: [f32; 2], other: [f32; 2]| libm::hypotf(one[0] - other[0], one[1] - other[1]);
    let mut chosen: Vec<[f32; 2]> = Vec::new();
    while chosen.len() < count {
        let nearest = |point: &[f32; 2]| {
            let others = before.iter().chain(&chosen);
            others.map(|other| apart(*point, *other)).fold(f32::INFINITY, f32::min)
        };
        let farthest = all.iter().max_by(|one, other| nearest(one).total_cmp(&nearest(other)));
        match farthest.filter(|point| nearest(point) > 0.0) {
            Some(point) => chosen.push(*point),
            None => break,
        }
    }
    chosen
}
