//! A house as a file of ProcTHOR describes it, in the axes of this project: x east, y north, z up, metres; yaws counter-clockwise from
//! east, degrees. Fields that are not looked at are ignored.

use serde_json::Value;

use crate::{MOST_BYTES, error::HouseError, json::Node};

/// The most rooms of a house.
const MOST_ROOMS: usize = 32;
/// The most corners of a room.
const MOST_CORNERS: usize = 128;
/// The most walls.
const MOST_WALLS: usize = 2000;
/// The most doors, and windows.
const MOST_OPENINGS: usize = 200;
/// The most objects, those on others with them.
const MOST_OBJECTS: usize = 1500;
/// The most objects that lie on each other.
const DEEPEST: usize = 8;
/// The longest side of a house, m: that of a floor plan.
const LONGEST_M: f64 = 100.0;
/// The width of an opening that tells none, m.
const WIDTH_M: f64 = 1.0;

/// A house.
#[derive(Clone, Debug)]
pub struct House {
    pub rooms: Vec<HouseRoom>,
    /// Walls that are not built: both rooms are one open space.
    pub open_walls: Vec<OpenWall>,
    pub openings: Vec<HouseOpening>,
    /// What stands on the floor or hangs on walls, with what is on it.
    pub objects: Vec<HouseObject>,
    /// Where the agent begins, if the house says so.
    pub agent_m: Option<[f64; 2]>,
    /// The ids of rooms that the floor plan does without.
    pub left_out: Vec<String>,
}

/// A room.
#[derive(Clone, Debug)]
pub struct HouseRoom {
    /// JSON pointer.
    pub at: String,
    pub id: String,
    /// `roomType`.
    pub kind: String,
    pub corners_m: Vec<[f64; 2]>,
    /// The name of the floor's material; empty, if there is none.
    pub floor: String,
}

/// A wall that is not built.
#[derive(Clone, Debug)]
pub struct OpenWall {
    pub room: String,
    pub ends_m: [[f64; 2]; 2],
}

/// What an opening is.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum HouseOpeningKind {
    Door,
    /// A frame without a door.
    Frame,
    Window,
}

/// A door, a frame or a window.
#[derive(Clone, Debug)]
pub struct HouseOpening {
    /// JSON pointer.
    pub at: String,
    pub kind: HouseOpeningKind,
    /// The ids of the rooms on both sides.
    pub rooms: [String; 2],
    pub middle_m: [f64; 2],
    pub width_m: f64,
}

/// An object, with what is on it.
#[derive(Clone, Debug)]
pub struct HouseObject {
    /// Its type in AI2-THOR.
    pub kind: String,
    /// The middle of the box around it.
    pub middle_m: [f64; 3],
    pub yaw_deg: f64,
    pub children: Vec<HouseObject>,
}

/// A wall, of which openings are told.
struct Wall {
    id: String,
    room: String,
    ends_m: [[f64; 2]; 2],
    is_open: bool,
}

impl House {
    /// Reads a house from the text of its JSON.
    ///
    /// # Errors
    /// [`HouseError`] says what is wrong, and where.
    pub fn parse(text: &str) -> Result<Self, HouseError> {
        if text.len() > MOST_BYTES {
            return Err(HouseError::TooLarge { bytes: text.len() });
        }
        let value: Value = serde_json::from_str(text).map_err(|source| HouseError::Json { source })?;
        let root = Node::root(&value);
        let rooms = root.needed("rooms")?.items(MOST_ROOMS)?.iter().map(room).collect::<Result<Vec<_>, _>>()?;
        check_rooms(&rooms)?;
        let walls = root.items_of("walls", MOST_WALLS)?.iter().map(wall).collect::<Result<Vec<_>, _>>()?;
        let mut openings = Vec::new();
        for (list, is_window) in [("doors", false), ("windows", true)] {
            for node in root.items_of(list, MOST_OPENINGS)? {
                openings.push(opening(&node, is_window, &walls)?);
            }
        }
        let mut left = MOST_OBJECTS;
        let objects = objects(&root, "objects", 0, &mut left)?;
        let open = walls.into_iter().filter(|wall| wall.is_open);
        let open_walls = open.map(|wall| OpenWall { room: wall.room, ends_m: wall.ends_m }).collect();
        Ok(Self { rooms, open_walls, openings, objects, agent_m: agent(&root)?, left_out: Vec::new() })
    }
}

/// A point of the floor: x stays, z becomes y.
fn floor_point(node: &Node<'_>) -> Result<[f64; 2], HouseError> {
    Ok([node.needed("x")?.number()?, node.needed("z")?.number()?])
}

fn room(node: &Node<'_>) -> Result<HouseRoom, HouseError> {
    let corners = node.needed("floorPolygon")?.items(MOST_CORNERS)?;
    let floor = match node.member("floorMaterial")? {
        Some(name) if name.is_text() => name.text()?.to_owned(),
        Some(material) => material.member("name")?.map_or(Ok(""), |name| name.text())?.to_owned(),
        None => String::new(),
    };
    Ok(HouseRoom {
        at: node.at.clone(),
        id: node.needed("id")?.text()?.to_owned(),
        kind: node.needed("roomType")?.text()?.to_owned(),
        corners_m: corners.iter().map(floor_point).collect::<Result<_, _>>()?,
        floor,
    })
}

/// Ids are told apart, and all of it is no larger than a floor plan.
fn check_rooms(rooms: &[HouseRoom]) -> Result<(), HouseError> {
    if rooms.is_empty() {
        return Err(HouseError::at("/rooms", "there is none", "a house has one room at least"));
    }
    for (index, room) in rooms.iter().enumerate() {
        if rooms[..index].iter().any(|other| other.id == room.id) {
            let reason = format!("`{}` is the id of an earlier room", room.id);
            return Err(HouseError::at(&format!("{}/id", room.at), reason, "give each room an id of its own"));
        }
    }
    for axis in 0..2 {
        let along = rooms.iter().flat_map(|room| &room.corners_m).map(|corner| corner[axis]);
        let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)));
        if high - low > LONGEST_M {
            let remedy = format!("at most {LONGEST_M} m along each side");
            return Err(HouseError::at("/rooms", format!("the house is {:.1} m long", high - low), remedy));
        }
    }
    Ok(())
}

fn wall(node: &Node<'_>) -> Result<Wall, HouseError> {
    let corners = node.needed("polygon")?.items(MOST_CORNERS)?;
    let [from, to, ..] = corners.as_slice() else {
        let reason = format!("{} corners", corners.len());
        return Err(HouseError::at(&format!("{}/polygon", node.at), reason, "write its two lower ones first"));
    };
    Ok(Wall {
        id: node.needed("id")?.text()?.to_owned(),
        room: node.member("roomId")?.map_or(Ok(""), |id| id.text())?.to_owned(),
        ends_m: [floor_point(from)?, floor_point(to)?],
        is_open: node.flag_of("empty")?.unwrap_or(false),
    })
}

/// A hole lies in its wall: x along the wall, from its first corner.
fn opening(node: &Node<'_>, is_window: bool, walls: &[Wall]) -> Result<HouseOpening, HouseError> {
    let room = |name: &str| node.member(name)?.map_or(Ok(""), |id| id.text()).map(str::to_owned);
    let wall_node = node.needed("wall0")?;
    let id = wall_node.text()?;
    let no_wall = || HouseError::at(&wall_node.at, format!("there is no wall `{id}`"), "name one of `walls`");
    let wall = walls.iter().find(|wall| wall.id == id).ok_or_else(no_wall)?;
    let (along_m, width_m) = hole(node)?;
    let [from, to] = wall.ends_m;
    let way = [to[0] - from[0], to[1] - from[1]];
    let length_m = libm::hypot(way[0], way[1]);
    if length_m < 0.1 {
        let reason = format!("the wall `{id}` has no length");
        return Err(HouseError::at(&wall_node.at, reason, "write its two lower corners first"));
    }
    let share = along_m / length_m;
    Ok(HouseOpening {
        at: node.at.clone(),
        kind: if is_window { HouseOpeningKind::Window } else { door_kind(node)? },
        rooms: [room("room0")?, room("room1")?],
        middle_m: [from[0] + way[0] * share, from[1] + way[1] * share],
        width_m,
    })
}

/// Where the middle of a hole is along its wall, and its width, m.
fn hole(node: &Node<'_>) -> Result<(f64, f64), HouseError> {
    let corners = node.items_of("holePolygon", MOST_CORNERS)?;
    if corners.is_empty() {
        return Ok((node.needed("assetPosition")?.needed("x")?.number()?, WIDTH_M));
    }
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for corner in &corners {
        let x = corner.needed("x")?.number()?;
        (low, high) = (low.min(x), high.max(x));
    }
    Ok(((low + high) / 2.0, high - low))
}

fn door_kind(node: &Node<'_>) -> Result<HouseOpeningKind, HouseError> {
    let asset = node.member("assetId")?.map_or(Ok(""), |asset| asset.text())?;
    let is_frame = asset.to_ascii_lowercase().starts_with("doorframe");
    let is_shut_for_ever = asset.is_empty() && node.flag_of("openable")? == Some(false);
    Ok(if is_frame || is_shut_for_ever { HouseOpeningKind::Frame } else { HouseOpeningKind::Door })
}

fn objects(node: &Node<'_>, name: &str, depth: usize, left: &mut usize) -> Result<Vec<HouseObject>, HouseError> {
    let Some(list) = node.member(name)? else { return Ok(Vec::new()) };
    let items = list.items(MOST_OBJECTS)?;
    if depth > DEEPEST && !items.is_empty() {
        let reason = format!("more than {DEEPEST} objects lie on each other");
        return Err(HouseError::at(&list.at, reason, "put it on what stands on the floor"));
    }
    if items.len() > *left {
        return Err(HouseError::at(
            &list.at,
            "there are too many objects",
            format!("at most {MOST_OBJECTS} in a house"),
        ));
    }
    *left -= items.len();
    items.iter().map(|item| object(item, depth, left)).collect()
}

fn object(node: &Node<'_>, depth: usize, left: &mut usize) -> Result<HouseObject, HouseError> {
    let id = node.needed("id")?.text()?;
    let position = node.needed("position")?;
    let [x, y] = floor_point(&position)?;
    let turn_deg = node.member("rotation")?.map_or(Ok(0.0), |rotation| rotation.number_of("y"))?;
    Ok(HouseObject {
        kind: id.split('|').next().unwrap_or_default().to_owned(),
        middle_m: [x, y, position.number_of("y")?],
        // Clockwise from north, where the front of an object is (z), to counter-clockwise from east.
        yaw_deg: 90.0 - turn_deg,
        children: objects(node, "children", depth + 1, left)?,
    })
}

fn agent(root: &Node<'_>) -> Result<Option<[f64; 2]>, HouseError> {
    let Some(metadata) = root.member("metadata")? else { return Ok(None) };
    let Some(agent) = metadata.member("agent")? else { return Ok(None) };
    agent.member("position")?.map(|position| floor_point(&position)).transpose()
}
