//! The world's own words as messages.

use cohabit_bus::{
    Text,
    message::{
        BodyRecord, EventKind, EventMessage, GoalRecord, NONE, NoteRecord, ObjectRecord, StateHeader, StateParts,
    },
};
use cohabit_cdf::{Catalog, StateFlag};
use cohabit_world::{BodyView, CameraTarget, Ending, Event, GoalStatus, Input, ObjectView, World};

/// A command was taken up.
#[must_use]
pub fn started(input: &Input, turn: u64) -> EventMessage {
    let mut message = EventMessage::new(EventKind::Started);
    (message.command, message.turn, message.body) = (input.command, turn, input.body.0);
    message
}

/// An event as others hear of it.
#[must_use]
pub fn event(world: &World, event: &Event) -> EventMessage {
    let of = EventMessage::new;
    match event {
        Event::ObjectChanged { object } | Event::Removed { object } | Event::Scanned { object } => {
            of(EventKind::ObjectChanged).about(object.0)
        }
        Event::Spawned { object, .. } => of(EventKind::Spawned).about(object.0),
        Event::Highlighted { object, .. } => of(EventKind::Highlighted).about(object.0),
        Event::NoteRead { object, text } => of(EventKind::NoteRead).about(object.0).saying(text),
        Event::Sound { kind, object } => of(EventKind::Sound).about(object.0).saying(&format!("{kind:?}")),
        Event::GoalMet { id } => goal(world, EventKind::GoalMet, *id),
        Event::GoalReset { id } => goal(world, EventKind::GoalReset, *id),
        Event::GoalShown { id } => goal(world, EventKind::GoalShown, *id),
        Event::CameraMovement { target, duration_s, text } => {
            let mut message = of(EventKind::CameraMovement).saying(text);
            message.number = (duration_s * 1e3) as i64;
            match target {
                CameraTarget::Object(object) => message.about(object.0),
                _ => message,
            }
        }
        Event::Message { text } => of(EventKind::Message).saying(text),
        Event::MissionEnded { ending: Ending::AllGoalsMet } => of(EventKind::MissionComplete),
        Event::MissionEnded { ending: Ending::KilledByHazard } => {
            of(EventKind::MissionFailed).saying("A hazard destroyed the robot.")
        }
    }
}

fn goal(world: &World, kind: EventKind, number: i64) -> EventMessage {
    let goal = world.goals().into_iter().find(|goal| goal.id == number);
    let mut message = EventMessage::new(kind).saying(&goal.map_or_else(String::new, |goal| goal.description));
    message.number = number;
    message
}

/// The present state.
#[must_use]
pub fn state(world: &World) -> StateParts {
    let ending = match world.finished() {
        None => 0,
        Some(Ending::AllGoalsMet) => 1,
        Some(Ending::KilledByHazard) => 2,
    };
    let catalog = world.catalog();
    let lit = world.lights().filter(|(_, is_lit)| *is_lit);
    let lit_rooms = lit.filter_map(|(room, _)| catalog.room_index(room)).fold(0, |bits, index| bits | 1_u64 << index);
    let goals = world.goals();
    let mut parts = StateParts {
        header: StateHeader { score: world.score(), ending, lit_rooms, ..StateHeader::default() },
        bodies: world.bodies().map(|body| body_record(&body, catalog)).collect(),
        objects: Vec::with_capacity(world.objects().len()),
        goals: goals.iter().map(goal_record).collect(),
        notes: Vec::new(),
    };
    for object in present(world) {
        parts.objects.push(object_record(&object, catalog));
        if !object.text.is_empty() {
            parts.notes.push(note_record(&object));
        }
    }
    parts
}

/// The objects that are in the world now: what was removed is nobody's business.
fn present(world: &World) -> impl Iterator<Item = ObjectView<'_>> {
    world.objects().filter(|object| world.exists(object.id))
}

fn goal_record(goal: &GoalStatus) -> GoalRecord {
    GoalRecord {
        number: goal.id,
        met: u32::from(goal.met),
        hidden: u32::from(goal.hidden),
        description: Text::new(&goal.description),
    }
}

fn note_record(object: &ObjectView<'_>) -> NoteRecord {
    NoteRecord {
        object: object.id.0,
        read: u32::from(object.flags.has(StateFlag::Examined)),
        text: Text::new(object.text),
    }
}

fn body_record(body: &BodyView, catalog: &Catalog) -> BodyRecord {
    BodyRecord {
        body: body.id.0,
        room: catalog.room_index(body.room).map_or(NONE, u32::from),
        held: body.held.map_or(NONE, |object| object.0),
        busy: u32::from(body.busy),
        kind: body.kind as u32,
        flags: body.flags.0,
        command: body.command.unwrap_or(0),
        commander: 0,
        position_m: body.position_m.to_array(),
        yaw_rad: body.yaw_rad,
        head_pitch_rad: body.head_pitch_rad,
        eye_m: body.eye.to_array(),
    }
}

fn object_record(object: &ObjectView<'_>, catalog: &Catalog) -> ObjectRecord {
    ObjectRecord {
        object: object.id.0,
        flags: object.flags.0,
        class: object.class.0,
        room: catalog.room_index(object.room).unwrap_or(u8::MAX),
        color: object.color as u8,
        fluid: object.fluid as u8,
        hidden: u8::from(object.hidden),
        in_mission: u8::from(object.in_mission),
        reserved: 0,
        parent: object.parent.map_or(NONE, |parent| parent.0),
        held_by: object.held_by.map_or(NONE, |body| body.0),
        works: object.works.map_or(NONE, |works| works.0),
        position_m: object.position_m.to_array(),
        rotation: object.rotation.to_array(),
        instance: Text::new(object.instance),
    }
}
