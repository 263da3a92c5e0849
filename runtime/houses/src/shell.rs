//! The bare floor plan of a house: its rooms on the lattice, with doors, passages and windows. Knows no objects.

use cohabit_cdf::model::Axis;
use cohabit_floorplans::parts::{Floor, Rect, Site};

use crate::{
    error::HouseError,
    house::{House, HouseRoom},
    lattice::Lattice,
    names::{NamedRoom, RoomTable},
    openings::{Openings, is_cut},
    polygon::{Outline, PolygonFault},
};

/// The rooms of a house and what joins them.
#[derive(Clone, Debug)]
pub struct Shell {
    pub lattice: Lattice,
    pub rooms: Vec<NamedRoom>,
    pub floors: Vec<Floor>,
    pub openings: Openings,
}

impl Shell {
    /// That of a house. Rooms that no door or passage leads to are taken out of the house.
    ///
    /// # Errors
    /// [`HouseError::Content`] says what cannot be, and where.
    pub fn of(house: &mut House, table: &RoomTable) -> Result<Self, HouseError> {
        let shell = Self::of_all(house, table)?;
        let joined = joined(shell.floors.len(), &shell.openings);
        if joined.iter().all(|is_joined| *is_joined) {
            return Ok(shell);
        }
        let mut notes = Vec::new();
        let mut is_kept = joined.into_iter();
        house.rooms.retain(|room| {
            let is_kept = is_kept.next().unwrap_or(false);
            if !is_kept {
                notes.push(format!("{}: no door leads into the {}: it is left out", room.at, room.kind));
                house.left_out.push(room.id.clone());
            }
            is_kept
        });
        let mut shell = Self::of_all(house, table)?;
        notes.append(&mut shell.openings.notes);
        shell.openings.notes = notes;
        Ok(shell)
    }

    fn of_all(house: &House, table: &RoomTable) -> Result<Self, HouseError> {
        let rooms = table.named(&house.rooms)?;
        let lattice = Lattice::of(&house.rooms);
        let floors = house.rooms.iter().map(|room| floor(room, house, &lattice)).collect::<Result<Vec<_>, _>>()?;
        check_apart(&house.rooms, &floors)?;
        let openings = Openings::of(house, &lattice, &floors)?;
        Ok(Self { lattice, rooms, floors, openings })
    }

    /// The room that has a point, if one has.
    pub fn room_at(&self, point_m: [f32; 2]) -> Option<usize> {
        let has = |rect: &Rect| {
            let [x, y] = point_m.map(|m| m * 10.0);
            x >= rect.west as f32 && x <= rect.east as f32 && y >= rect.south as f32 && y <= rect.north as f32
        };
        self.floors.iter().position(|floor| floor.rects.iter().any(has))
    }
}

/// The floor of a room: cut so that as few openings as possible lie where two rectangles meet.
fn floor(room: &HouseRoom, house: &House, lattice: &Lattice) -> Result<Floor, HouseError> {
    let corners: Vec<[i32; 2]> = room.corners_m.iter().map(|corner| lattice.corner(*corner)).collect();
    let outline = Outline::of(&corners).map_err(|fault| refused(room, fault))?;
    let cut = |axis: Axis| Floor { rects: outline.rects(axis), through: true, openness: 0.0 };
    let rank = |floor: &Floor| {
        let own = house.openings.iter().filter(|opening| opening.rooms.contains(&room.id));
        (own.filter(|opening| is_cut(opening, lattice, floor)).count(), floor.rects.len())
    };
    let [along_x, along_y] = [Axis::X, Axis::Y].map(cut);
    Ok(if rank(&along_y) < rank(&along_x) { along_y } else { along_x })
}

fn refused(room: &HouseRoom, fault: PolygonFault) -> HouseError {
    let at = |corner: usize| format!("{}/floorPolygon/{corner}", room.at);
    let id = &room.id;
    match fault {
        PolygonFault::Slanted(corner) => HouseError::at(
            &at(corner),
            format!("the side of `{id}` that begins here runs aslant"),
            "rooms have sides along x and z alone",
        ),
        PolygonFault::Crossing(corner) => HouseError::at(
            &at(corner),
            format!("the outline of `{id}` meets itself here"),
            "write the corners in their order round the room, which has no hole",
        ),
        PolygonFault::Empty => HouseError::at(
            &format!("{}/floorPolygon", room.at),
            format!("`{id}` has no floor"),
            "write four corners or more, 0.1 m or more apart",
        ),
    }
}

/// No two rooms share floor.
fn check_apart(rooms: &[HouseRoom], floors: &[Floor]) -> Result<(), HouseError> {
    for (index, floor) in floors.iter().enumerate() {
        for (other, earlier) in floors[..index].iter().enumerate() {
            let share = |one: &Rect, two: &Rect| {
                one.west < two.east && two.west < one.east && one.south < two.north && two.south < one.north
            };
            if floor.rects.iter().any(|one| earlier.rects.iter().any(|two| share(one, two))) {
                let reason = format!("`{}` shares floor with `{}`", rooms[index].id, rooms[other].id);
                let at = format!("{}/floorPolygon", rooms[index].at);
                return Err(HouseError::at(&at, reason, "leave each part of the floor to one room"));
            }
        }
    }
    Ok(())
}

/// Whether each room is among the most that are joined by doors and passages.
fn joined(count: usize, openings: &Openings) -> Vec<bool> {
    let mut groups: Vec<usize> = (0..count).collect();
    // Each pass carries a number over one more door.
    for _ in 0..count {
        for gap in openings.gaps.iter().filter(|gap| gap.is_way()) {
            let least = groups[gap.between[0]].min(groups[gap.between[1]]);
            gap.between.into_iter().for_each(|room| groups[room] = least);
        }
    }
    let size = |group: usize| groups.iter().filter(|other| **other == group).count();
    let largest = (0..count).max_by_key(|group| (size(*group), count - group)).unwrap_or(0);
    groups.iter().map(|group| *group == largest).collect()
}

/// What is said of a room in which nobody can walk.
pub fn too_small(room: &HouseRoom, site: &Site<'_>) -> HouseError {
    let reason = format!("`{}`, of {:.1} m², has no room to walk from door to door", room.id, site.area_m2());
    HouseError::at(&format!("{}/floorPolygon", room.at), reason, "rooms are 1.3 m wide or more, and have free walls")
}
