//! Building a world: a floor plan furnished, and then changed as a mission asks.

mod mentions;
mod plan;
mod power;
mod request;
mod robots;
mod spot;
mod times;

use std::collections::BTreeMap;

use cohabit_cdf::{Catalog, Layout, Mission, ObjectId, RoomId, StateFlag};
use glam::{Vec2, Vec3};
use rand_chacha::{
    ChaCha8Rng,
    rand_core::{Rng, SeedableRng},
};

use crate::{
    apply::Changes,
    facts::Facts,
    floor::Floor,
    geometry::wrap,
    mission_state::GoalProgress,
    navigation::Navigation,
    report::Event,
    solver::Physics,
    state::{State, ids},
};

/// Why a world could not be built.
#[derive(Clone, Debug, Eq, PartialEq, thiserror::Error)]
pub enum BuildError {
    /// The catalogue has no class for an instance.
    #[error("build the world: `{object}` is of no class in the catalogue")]
    UnknownClass {
        /// The instance id.
        object: String,
    },
    /// The floor plan lacks a room.
    #[error(
        "build the world: `{object}` must be in the {room}, which the floor plan `{layout}` does not have; it has {rooms}"
    )]
    NoSuchRoom {
        /// The instance id, or `the robot`.
        object: String,
        /// The room, as people call it.
        room: String,
        /// The floor plan.
        layout: String,
        /// The rooms that it has, by their ids.
        rooms: String,
    },
    /// An object must be in or on something that is not there.
    #[error("build the world: `{object}` must be in `{receptacle}`, which neither the mission nor the floor plan has")]
    NoSuchReceptacle {
        /// The instance id.
        object: String,
        /// The instance id of the receptacle.
        receptacle: String,
    },
    /// An object must be in or on something that takes nothing, or that has no free place left.
    #[error(
        "build the world: `{object}` must be in `{receptacle}`, where no place is free; put something else elsewhere"
    )]
    NoFreePlace {
        /// The instance id.
        object: String,
        /// The instance id of the receptacle.
        receptacle: String,
    },
    /// Objects are said to be in each other.
    #[error("build the world: `{object}` is said to be in itself, by way of `{receptacle}`")]
    Circular {
        /// The instance id.
        object: String,
        /// The instance id of the receptacle.
        receptacle: String,
    },
    /// There is no room left on the floor or the walls.
    #[error("build the world: no free place was found for `{object}` in the {room}")]
    NoFreeSpot {
        /// The instance id.
        object: String,
        /// The room, as people call it.
        room: String,
    },
    /// The floor plan names something that stands on what comes later, or is not there.
    #[error(
        "build the world: `{object}` stands on `{parent}`, which the floor plan `{layout}` does not have before it"
    )]
    NoSuchParent {
        /// The instance id.
        object: String,
        /// The instance id of what it stands on.
        parent: String,
        /// The floor plan.
        layout: String,
    },
}

impl BuildError {
    /// What could not be made or placed: an instance id, or `the robot`.
    #[must_use]
    pub fn object(&self) -> &str {
        match self {
            Self::UnknownClass { object }
            | Self::NoSuchRoom { object, .. }
            | Self::NoSuchReceptacle { object, .. }
            | Self::NoFreePlace { object, .. }
            | Self::Circular { object, .. }
            | Self::NoFreeSpot { object, .. }
            | Self::NoSuchParent { object, .. } => object,
        }
    }
}

/// A world under construction.
struct Builder<'a> {
    catalog: &'a Catalog,
    layout: &'a Layout,
    mission: &'a Mission,
    floor: Floor,
    state: State,
    rng: ChaCha8Rng,
    /// The object of each request, by its index, once there is one.
    requested: BTreeMap<usize, ObjectId>,
    events: Vec<Event>,
}

/// Builds the changing part of a world, its bare floor plan, and the floor that can be walked on.
///
/// What is left to chance follows from the mission's own seed, or from `seed` if it has none.
pub(crate) fn build(
    catalog: &Catalog,
    layout: &Layout,
    mission: &Mission,
    seed: u64,
) -> Result<(Floor, State, Navigation), BuildError> {
    let state = State {
        tick: 0,
        objects: Vec::new(),
        bodies: Vec::new(),
        circuits: BTreeMap::new(),
        goals: vec![GoalProgress::default(); mission.goals.len()],
        occasions: Vec::new(),
        portals: BTreeMap::new(),
        passes: BTreeMap::new(),
        dinosaurs: BTreeMap::new(),
        away: BTreeMap::new(),
        ended: None,
        physics: Physics::empty(),
        floor_version: 0,
    };
    let mut builder = Builder {
        catalog,
        layout,
        mission,
        floor: Floor::new(layout, catalog),
        state,
        rng: ChaCha8Rng::seed_from_u64(mission.seed.unwrap_or(seed)),
        requested: BTreeMap::new(),
        events: Vec::new(),
    };
    builder.furnish()?;
    builder.find_doors();
    builder.fulfil()?;
    builder.find_doors();
    builder.open_times();
    let navigation = builder.add_robots()?;
    builder.finish();
    Ok((builder.floor, builder.state, navigation))
}

impl Builder<'_> {
    fn facts(&self) -> Facts<'_> {
        Facts { catalog: self.catalog, floor: &self.floor, state: &self.state }
    }

    fn changes(&mut self) -> Changes<'_> {
        self.events.clear();
        Changes { catalog: self.catalog, floor: &self.floor, state: &mut self.state, events: &mut self.events }
    }

    /// A number below `count`, which is not 0.
    fn pick(&mut self, count: usize) -> usize {
        (self.rng.next_u64() % count as u64) as usize
    }

    /// A number from 0 to 1.
    fn fraction(&mut self) -> f32 {
        (self.rng.next_u64() >> 40) as f32 / (1_u64 << 24) as f32
    }

    fn check_room(&self, object: &str, room: RoomId) -> Result<RoomId, BuildError> {
        if self.floor.rects(room).next().is_some() {
            return Ok(room);
        }
        Err(no_such_room(self.catalog, self.layout, object, room))
    }

    /// Gives each gap its door.
    fn find_doors(&mut self) {
        for index in 0..self.floor.gaps.len() {
            let door = self.floor.gaps[index].door.clone();
            self.floor.gaps[index].door_object = door.and_then(|door| self.state.find(&door));
        }
    }

    fn finish(&mut self) {
        for id in ids(self.state.objects.len()) {
            let object = self.state.at_mut(id);
            object.opened = f32::from(u8::from(object.flags.has(StateFlag::Opened)));
            object.running = f32::from(u8::from(object.flags.has(StateFlag::Toggled)));
        }
        for id in ids(self.state.objects.len()) {
            if self.state.at(id).parent().is_none() {
                self.changes().settle(id);
            }
        }
    }
}

/// A floor plan lacks a room.
pub(crate) fn no_such_room(catalog: &Catalog, layout: &Layout, object: &str, room: RoomId) -> BuildError {
    // One that the world lacks has no name.
    let name = catalog.rooms().get(room).map_or_else(|| room.to_string(), |entry| entry.name.clone());
    let rooms: Vec<&str> = layout.rooms.iter().map(|room| room.id.id()).collect();
    BuildError::NoSuchRoom { object: object.to_owned(), room: name, layout: layout.id.clone(), rooms: rooms.join(", ") }
}

/// Where a new body can stand in a room, and its heading.
pub(crate) fn start(facts: &Facts<'_>, floor: &Navigation, layout: &Layout, room: RoomId) -> Option<(Vec2, f32)> {
    let viewpoints = layout
        .viewpoints
        .iter()
        .filter(|viewpoint| viewpoint.room == room)
        .map(|viewpoint| (Vec2::from(viewpoint.at_m), wrap(viewpoint.yaw_deg.to_radians())));
    let middles = facts
        .floor
        .rects(room)
        .map(|[west, south, east, north]| (Vec2::new((west + east) / 2.0, (south + north) / 2.0), 0.0));
    // More bodies than viewpoints stand wherever there is room, from the south-west on.
    const APART_M: f32 = 0.7;
    let anywhere = facts.floor.rects(room).flat_map(|[west, south, east, north]| {
        let steps = |from: f32, to: f32| {
            (0_u8..=u8::MAX).map(move |step| from + f32::from(step) * APART_M).take_while(move |at| *at < to)
        };
        steps(south, north).flat_map(move |y| steps(west, east).map(move |x| (Vec2::new(x, y), 0.0)))
    });
    viewpoints.chain(middles).chain(anywhere).find_map(|(point, yaw)| {
        let free = floor.snap(point, 1.5).filter(|point| facts.floor.room_at(*point) == Some(room))?;
        let crowded = facts.state.bodies.iter().any(|body| body.position.distance(free) < 2.5 * crate::body::RADIUS_M);
        (!crowded).then_some((free, yaw))
    })
}

/// A point on the floor, as a place for an object.
fn on_floor(point: Vec2) -> Vec3 {
    point.extend(0.0)
}
