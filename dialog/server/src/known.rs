//! What the robot knows, from the states that the simulator publishes.

use std::{
    collections::BTreeSet,
    hash::{DefaultHasher, Hash as _, Hasher as _},
    sync::Arc,
};

use cohabit_bus::message::{NONE, ObjectRecord, StateView};
use cohabit_cdf::{Action, BodyId, Catalog, ClassId, Color, Fluid, Layout, ObjectId, RoomId, state::StateFlags};
use cohabit_language::{
    FloorPlan, Gaze, Known, KnownGoal, KnownObject, KnownPerson, KnownRobot, Knows, Lessons, Memory, within_half_turn,
};

/// Half the angle in which the robot sees what is in its room, rad.
const HALF_VIEW_RAD: f32 = 0.9;
/// A body that moves looks so often, in ticks, and one that stands still more seldom: other things may move.
const LOOKS_EVERY: u64 = 6;
const GLANCES_EVERY: u64 = 30;

/// The knowledge of one body.
pub struct Knowledge {
    knows: Knows,
    catalog: Arc<Catalog>,
    body: BodyId,
    mission: String,
    memory: Memory,
    /// The world as it was when it was last looked at; nobody but the eyes and the hand may know more of it.
    world: Option<Known>,
    gaze: Option<Gaze>,
    looked_at: u64,
    /// The body of who spoke last, and where that is.
    speaker: Option<BodyId>,
    person: Option<KnownPerson>,
    /// The rooms of the floor plan.
    rooms: Vec<RoomId>,
}

impl Knowledge {
    /// What a body knows that has seen nothing yet but the floor plan.
    #[must_use]
    pub fn new(knows: Knows, catalog: Arc<Catalog>, layout: &Layout, body: BodyId) -> Self {
        let memory = Memory::new(Arc::new(FloorPlan::new(layout)));
        let (mission, world, gaze, speaker, person) = (String::new(), None, None, None, None);
        let rooms = layout.rooms.iter().map(|room| room.id).collect();
        Self { knows, catalog, body, mission, memory, world, gaze, looked_at: 0, speaker, person, rooms }
    }

    /// The same, told what people are asked to get done.
    #[must_use]
    pub fn with_mission(mut self, mission: &str) -> Self {
        self.be_told_mission(mission);
        self
    }

    pub(crate) fn be_told_mission(&mut self, mission: &str) {
        mission.clone_into(&mut self.mission);
    }

    /// Whether it is time to look again, for a body that looks so now.
    #[must_use]
    pub fn is_due(&self, tick: u64, position_m: [f32; 3], yaw_rad: f32) -> bool {
        let Some((world, gaze)) = self.world.as_ref().zip(self.gaze) else { return true };
        let is_still = world.robot.position_m == position_m && gaze.yaw_rad == yaw_rad;
        let every = if is_still { GLANCES_EVERY } else { LOOKS_EVERY };
        self.knows == Knows::Seen && tick >= self.looked_at.saturating_add(every)
    }

    /// Notes who speaks to it: whoever walks about in this body, if in any.
    pub fn note_speaker(&mut self, body: Option<BodyId>, state: StateView<'_>) {
        self.speaker = body.filter(|body| *body != self.body);
        self.person = self.speaker.and_then(|body| person(state, body, &self.catalog));
    }

    /// Looks at the world as it is at a tick.
    pub fn look(&mut self, state: StateView<'_>, tick: u64) {
        self.person = self.speaker.and_then(|body| person(state, body, &self.catalog));
        if self.world.is_some() && self.looked_at == tick {
            return;
        }
        let Some(record) = state.bodies.iter().find(|record| record.body == self.body.0) else { return };
        let Some(world) = everything(state, self.body, &self.catalog) else { return };
        let gaze = Gaze {
            eye_m: record.eye_m,
            room: world.robot.room,
            yaw_rad: record.yaw_rad,
            pitch_rad: record.head_pitch_rad,
            // It has stood here for a while when somebody first speaks to it.
            is_around: self.memory.is_blank(),
        };
        if self.knows == Knows::Seen {
            self.memory.take_in(&self.catalog, &world, gaze);
        }
        (self.world, self.gaze, self.looked_at) = (Some(world), Some(gaze), tick);
    }

    /// Takes note of a deed of its own that succeeded, once its outcome was looked at.
    pub fn note_deed(&mut self, action: &Action) {
        let Some((world, gaze)) = self.world.as_ref().zip(self.gaze) else { return };
        if self.knows == Knows::Everything {
            return;
        }
        if matches!(action, Action::LookAround) {
            self.memory.take_in(&self.catalog, world, Gaze { is_around: true, ..gaze });
        }
        self.memory.take_in_deed(action, world);
    }

    /// All that it knows; nothing before it looked.
    #[must_use]
    pub fn known(&self) -> Option<Known> {
        let known = match self.knows {
            Knows::Everything => self.world.clone(),
            Knows::Seen => self.memory.known(),
        };
        known.map(|known| {
            let (mission, rooms) = (self.mission.clone(), self.rooms.clone());
            Known { mission, rooms, person: self.person, ..known }
        })
    }

    /// Where the robot believes what it would act on to be, m, if it is wrong: others moved it while it did not look.
    pub(crate) fn mistaken_place(&self, action: &Action) -> Option<(ObjectId, [f32; 2])> {
        let world = self.world.as_ref().filter(|_| self.knows == Knows::Seen)?;
        self.memory.mistaken_place(action, world)
    }

    /// Forgets a thing that was not where it was believed to be.
    pub(crate) fn forget(&mut self, id: ObjectId) {
        self.memory.forget(id);
    }

    /// All that there is, whether or not the body has seen it: what people may speak of.
    pub(crate) const fn world(&self) -> Option<&Known> {
        self.world.as_ref()
    }

    /// A number that changes with what there is to speak of: the classes of things.
    pub(crate) fn number(&self) -> u64 {
        let things: BTreeSet<_> = self.world.iter().flat_map(|world| &world.objects).map(|thing| thing.class).collect();
        let mut hasher = DefaultHasher::new();
        things.hash(&mut hasher);
        hasher.finish().max(1)
    }

    /// What was learnt since this was last asked.
    pub fn take_lessons(&mut self) -> Option<Lessons> {
        self.memory.take_lessons()
    }

    /// Learns again what one before it learnt.
    pub fn study(&mut self, lessons: &Lessons) {
        self.memory.study(lessons);
    }
}

/// All there is, of which `body` is the robot; nothing, if there is no such body.
#[must_use]
pub fn everything(state: StateView<'_>, body: BodyId, catalog: &Catalog) -> Option<Known> {
    let record = state.bodies.iter().find(|record| record.body == body.0)?;
    let robot = KnownRobot {
        position_m: record.position_m,
        yaw_rad: record.yaw_rad,
        room: catalog.room_at(record.room)?,
        held: object_id(record.held),
    };
    let objects = state.objects.iter().filter_map(|object| known_object(state, &robot, object, catalog)).collect();
    let goals = state
        .goals
        .iter()
        .filter(|goal| goal.hidden == 0)
        .map(|goal| KnownGoal { text: goal.description.as_str().to_owned(), met: goal.met == 1 })
        .collect();
    Some(Known { goals, ..Known::new(robot, objects) })
}

fn person(state: StateView<'_>, body: BodyId, catalog: &Catalog) -> Option<KnownPerson> {
    let record = state.bodies.iter().find(|record| record.body == body.0)?;
    let room = catalog.room_at(record.room)?;
    Some(KnownPerson { position_m: record.position_m, yaw_rad: record.yaw_rad, room })
}

fn object_id(index: u32) -> Option<ObjectId> {
    (index != NONE).then_some(ObjectId(index))
}

fn known_object(
    state: StateView<'_>,
    robot: &KnownRobot,
    object: &ObjectRecord,
    catalog: &Catalog,
) -> Option<KnownObject> {
    // What a peer wrote may be no class.
    catalog.classes().get(usize::from(object.class))?;
    let room = catalog.room_at(u32::from(object.room))?;
    let note = state.notes.iter().find(|note| note.object == object.object);
    let [x, y, z, w] = object.rotation;
    Some(KnownObject {
        id: ObjectId(object.object),
        instance: object.instance.as_str().to_owned(),
        class: ClassId(object.class),
        room,
        position_m: object.position_m,
        yaw_rad: (2.0 * (w * z + x * y)).atan2(1.0 - 2.0 * (y * y + z * z)),
        flags: StateFlags(object.flags),
        fluid: Fluid::ALL.get(usize::from(object.fluid)).copied().unwrap_or_default(),
        color: Color::ALL.get(usize::from(object.color)).copied().unwrap_or_default(),
        parent: object_id(object.parent),
        text: note.map_or_else(String::new, |note| note.text.as_str().to_owned()),
        visible: object.hidden == 0 && room == robot.room && in_view(robot, object.position_m),
        is_hidden: object.hidden != 0,
        works: object_id(object.works),
        in_mission: object.in_mission != 0,
    })
}

fn in_view(robot: &KnownRobot, position_m: [f32; 3]) -> bool {
    let [dx, dy] = [position_m[0] - robot.position_m[0], position_m[1] - robot.position_m[1]];
    within_half_turn(dy.atan2(dx) - robot.yaw_rad).abs() < HALF_VIEW_RAD
}

#[cfg(test)]
mod tests {
    use cohabit_bus::message::{BodyRecord, StateParts};

    use super::*;

    #[test]
    fn what_is_of_no_class_is_not_known() {
        let catalog = Catalog::builtin();
        let thing = ObjectRecord { parent: NONE, held_by: NONE, works: NONE, ..ObjectRecord::default() };
        let past_the_last = u16::try_from(catalog.classes().len()).unwrap();
        let objects = (0..).zip([0, past_the_last, u16::MAX, 1]);
        let objects = objects.map(|(object, class)| ObjectRecord { object, class, ..thing }).collect();
        let body = BodyRecord { held: NONE, ..BodyRecord::default() };
        let parts = StateParts { bodies: vec![body], objects, ..StateParts::default() };
        let mut bytes = vec![0_u64; parts.bytes().div_ceil(8)];
        let bytes = &mut bytemuck::cast_slice_mut(&mut bytes)[..parts.bytes()];
        parts.write(bytes);
        let known = everything(StateView::new(bytes).unwrap(), BodyId(0), &catalog).unwrap();
        let ids: Vec<ObjectId> = known.objects.iter().map(|object| object.id).collect();
        assert_eq!(ids, [ObjectId(0), ObjectId(3)]);
    }
}
