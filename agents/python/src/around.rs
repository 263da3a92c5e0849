//! What bodies sense of a world: taken from the world itself, or from the records that its simulator published.

use cohabit_bus::message::{BodyRecord, NONE, ObjectRecord};
use cohabit_cdf::{BodyId, Catalog, ObjectId, RoomId};
use cohabit_world::{BodyView, ObjectView, World};

use crate::library::Library;

/// An object, as far as bodies sense it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight {
    /// Its number.
    pub object: u32,
    /// The index of its class.
    pub class: u16,
    /// The index of its room.
    pub room: u32,
    /// Whether it cannot be seen.
    pub hidden: bool,
    /// Its states, a bit each.
    pub flags: u32,
    /// Its origin, m.
    pub position_m: [f32; 3],
}

/// A body, as it senses itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Posture {
    /// On the floor, m.
    pub position_m: [f32; 3],
    /// Its heading, rad.
    pub yaw_rad: f32,
    /// The pitch of its head, rad.
    pub head_pitch_rad: f32,
    /// The index of its room.
    pub room: u32,
    /// The number of the object that it holds.
    pub held: Option<u32>,
    /// Whether it carries out a command.
    pub busy: bool,
}

/// Something that bodies are in.
pub trait Around {
    /// A body; none if it is not there.
    fn posture(&self, body: u32) -> Option<Posture>;

    /// An object; none if it is not there any more.
    fn sight(&self, object: u32) -> Option<Sight>;

    /// All objects that are there, by their numbers.
    fn sights(&self) -> impl Iterator<Item = Sight>;

    /// Those of a room that are not hidden, by their numbers.
    fn sights_in(&self, room: u32) -> impl Iterator<Item = Sight>;

    /// Whether there is such a room, as far as is known.
    fn has_room(&self, room: RoomId) -> bool;

    /// What is known of the classes of objects.
    fn library(&self) -> &Library;
}

/// Records of bodies and of objects; those of objects by their numbers.
#[derive(Clone, Copy)]
pub struct Records<'a> {
    pub bodies: &'a [BodyRecord],
    pub objects: &'a [ObjectRecord],
    pub library: &'a Library,
}

/// A world of this process.
#[derive(Clone, Copy)]
pub struct Simulated<'a> {
    pub world: &'a World,
    pub library: &'a Library,
}

impl Around for Records<'_> {
    fn posture(&self, body: u32) -> Option<Posture> {
        self.bodies.iter().find(|record| record.body == body).map(Posture::from)
    }

    fn sight(&self, object: u32) -> Option<Sight> {
        let place = self.objects.binary_search_by_key(&object, |record| record.object).ok()?;
        self.objects.get(place).map(Sight::from)
    }

    fn sights(&self) -> impl Iterator<Item = Sight> {
        self.objects.iter().map(Sight::from)
    }

    fn sights_in(&self, room: u32) -> impl Iterator<Item = Sight> {
        self.sights().filter(move |object| object.room == room && !object.hidden)
    }

    /// Records do not tell of the floor plan.
    fn has_room(&self, _: RoomId) -> bool {
        true
    }

    fn library(&self) -> &Library {
        self.library
    }
}

impl Around for Simulated<'_> {
    fn posture(&self, body: u32) -> Option<Posture> {
        self.world.body(BodyId(body)).map(|view| posture_of(&view, self.world.catalog()))
    }

    fn sight(&self, object: u32) -> Option<Sight> {
        let id = ObjectId(object);
        let world = self.world;
        world.object(id).filter(|_| world.exists(id)).map(|view| sight_of(&view, world.catalog()))
    }

    fn sights(&self) -> impl Iterator<Item = Sight> {
        let world = self.world;
        world.objects().filter(move |view| world.exists(view.id)).map(|view| sight_of(&view, world.catalog()))
    }

    fn sights_in(&self, room: u32) -> impl Iterator<Item = Sight> {
        let world = self.world;
        let objects = world.catalog().room_at(room).into_iter().flat_map(move |room| world.objects_in(room));
        objects.filter(|view| !view.hidden).map(|view| sight_of(&view, world.catalog()))
    }

    fn has_room(&self, room: RoomId) -> bool {
        self.world.layout().room(room).is_some()
    }

    fn library(&self) -> &Library {
        self.library
    }
}

impl From<&ObjectRecord> for Sight {
    fn from(record: &ObjectRecord) -> Self {
        Self {
            object: record.object,
            class: record.class,
            room: u32::from(record.room),
            hidden: record.hidden != 0,
            flags: record.flags,
            position_m: record.position_m,
        }
    }
}

fn sight_of(view: &ObjectView<'_>, catalog: &Catalog) -> Sight {
    Sight {
        object: view.id.0,
        class: view.class.0,
        // As its record has it.
        room: catalog.room_index(view.room).unwrap_or(u8::MAX).into(),
        hidden: view.hidden,
        flags: view.flags.0,
        position_m: view.position_m.to_array(),
    }
}

impl From<&BodyRecord> for Posture {
    fn from(record: &BodyRecord) -> Self {
        Self {
            position_m: record.position_m,
            yaw_rad: record.yaw_rad,
            head_pitch_rad: record.head_pitch_rad,
            room: record.room,
            held: (record.held != NONE).then_some(record.held),
            busy: record.busy != 0,
        }
    }
}

fn posture_of(view: &BodyView, catalog: &Catalog) -> Posture {
    Posture {
        position_m: view.position_m.to_array(),
        yaw_rad: view.yaw_rad,
        head_pitch_rad: view.head_pitch_rad,
        room: catalog.room_index(view.room).map_or(NONE, u32::from),
        held: view.held.map(|object| object.0),
        busy: view.busy,
    }
}
