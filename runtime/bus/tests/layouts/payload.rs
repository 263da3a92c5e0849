//! What each topic's payload is made of, and messages that show it.

use cohabit_bus::{
    Block, CameraId, Topic,
    message::{
        AnswerKind, AnswerMessage, AudioHeader, AudioView, BodyRecord, CameraKind, CameraRecord, CommandMessage,
        Control, ControlMessage, DialogKind, DialogMessage, EventKind, EventMessage, FrameLayout, GoalRecord,
        MissionMessage, NoteRecord, ObjectRecord, PlanStep, Plane, PulseMessage, SnapshotView, StateParts, StepView,
        TickMessage,
    },
};
use cohabit_cdf::{BodyKind, BodyRequest};

/// A topic's payload: a record, then lists of records.
pub struct Payload {
    pub topic: &'static str,
    pub header: &'static str,
    /// Each list's record, and the header's field that counts it.
    pub lists: &'static [(&'static str, &'static str)],
    pub note: &'static str,
}

/// All topics, a camera's among them.
pub fn topics() -> Vec<Topic> {
    // A topic that is new is to be told of here.
    let next = |topic: Topic| match topic {
        Topic::Mission => Some(Topic::State),
        Topic::State => Some(Topic::Ticks),
        Topic::Ticks => Some(Topic::Snapshots),
        Topic::Snapshots => Some(Topic::Events),
        Topic::Events => Some(Topic::Commands),
        Topic::Commands => Some(Topic::Control),
        Topic::Control => Some(Topic::Steps),
        Topic::Steps => Some(Topic::Pulses),
        Topic::Pulses => Some(Topic::Dialog),
        Topic::Dialog => Some(Topic::Answers),
        Topic::Answers => Some(Topic::Microphone),
        Topic::Microphone => Some(Topic::Speech),
        Topic::Speech => Some(Topic::Frames(CameraId::Egocentric(0))),
        Topic::Frames(_) => None,
    };
    let topics: Vec<_> = std::iter::successors(Some(Topic::Mission), |topic| next(*topic)).collect();
    assert_eq!(topics[..topics.len() - 1], Topic::OF_ALL_SESSIONS);
    topics
}

impl Payload {
    /// That of a topic.
    pub const fn of(topic: Topic) -> Self {
        let (topic, header, lists, note): (_, _, &[_], _) = match topic {
            Topic::Mission => (
                "mission",
                "MissionHeader",
                &[("BodyRequestRecord", "bodies"), ("CameraRecord", "cameras"), ("u8", "text_bytes")],
                ", the mission file's text",
            ),
            Topic::State => (
                "state",
                "StateHeader",
                &[
                    ("BodyRecord", "bodies"),
                    ("ObjectRecord", "objects"),
                    ("GoalRecord", "goals"),
                    ("NoteRecord", "notes"),
                ],
                "",
            ),
            Topic::Ticks => ("ticks", "TickHeader", &[("CommandMessage", "inputs")], ""),
            Topic::Snapshots => ("snapshots", "SnapshotHeader", &[("u8", "bytes")], ", the state"),
            Topic::Events => ("events", "EventMessage", &[], ""),
            Topic::Commands => ("commands", "CommandMessage", &[], ""),
            Topic::Control => ("control", "ControlMessage", &[], ""),
            Topic::Steps => ("steps", "StepHeader", &[("u64", "due")], ", the runs of those whose turn it is"),
            Topic::Pulses => ("pulses", "PulseMessage", &[], ""),
            Topic::Dialog => ("dialog", "DialogHeader", &[("PlanStep", "steps")], ""),
            Topic::Answers => ("answers", "AnswerMessage", &[], ""),
            Topic::Microphone => ("microphone", "AudioHeader", &[("i16", "samples")], ""),
            Topic::Speech => ("speech", "AudioHeader", &[("i16", "samples")], ""),
            Topic::Frames(_) => (
                "frames/<camera>",
                "FrameHeader",
                &[],
                ", then each plane at its `plane_at` on a 64-byte boundary (row-major, the pictures of a panorama one \
                 after the other: color `[views, height, width, 4]` u8, depth `[views, height, width]` f32 in m along \
                 the camera's z, normals `[views, height, width, 4]` i8, ids `[views, height, width]` u32: 0 nothing, below 2^20 an \
                 object's index + 1, below 2^24 a body's index + 2^20, else 2^24 + 256 × the index of a surface's room), then SeenRecord × `seen_room` \
                 at `seen_at`, of which `seen` count",
            ),
        };
        Self { topic, header, lists, note }
    }
}

/// A payload in memory like a sample's.
pub struct Example {
    blocks: Vec<Block>,
    length: usize,
}

impl Example {
    pub fn bytes(&mut self) -> &mut [u8] {
        &mut bytemuck::cast_slice_mut(&mut self.blocks)[..self.length]
    }
}

fn filled(length: usize, write: impl FnOnce(&mut [u8])) -> Example {
    let mut example = Example { blocks: vec![Block::default(); Block::count_for(length)], length };
    write(example.bytes());
    example
}

/// The payload of a message with a header and `1, 2, 3, …` records in its lists.
pub fn example(topic: Topic) -> Example {
    match topic {
        Topic::Mission => {
            let camera = CameraRecord::new(CameraId::Eyes(0), CameraKind::Egocentric);
            let message = MissionMessage {
                bodies: vec![BodyRequest { kind: BodyKind::Person, room: None }],
                cameras: vec![camera; 2],
                text: "{ }".to_owned(),
                ..MissionMessage::default()
            };
            filled(message.bytes(), |bytes| message.write(bytes))
        }
        Topic::State => {
            let parts = StateParts {
                bodies: vec![BodyRecord::default()],
                objects: vec![ObjectRecord::default(); 2],
                goals: vec![GoalRecord::default(); 3],
                notes: vec![NoteRecord::default(); 4],
                ..StateParts::default()
            };
            filled(parts.bytes(), |bytes| parts.write(bytes))
        }
        Topic::Ticks => {
            let message = TickMessage { inputs: vec![CommandMessage::default()], ..TickMessage::default() };
            filled(message.bytes(), |bytes| message.write(bytes))
        }
        Topic::Snapshots => filled(SnapshotView::bytes(3), |bytes| SnapshotView::write(b"abc", bytes)),
        Topic::Events => filled(size_of::<EventMessage>(), |bytes| {
            bytes.copy_from_slice(bytemuck::bytes_of(&EventMessage::new(EventKind::Sound)));
        }),
        Topic::Commands => filled(size_of::<CommandMessage>(), |_| ()),
        Topic::Control => filled(size_of::<ControlMessage>(), |bytes| {
            bytes.copy_from_slice(bytemuck::bytes_of(&ControlMessage::from(Control::Step(1))));
        }),
        Topic::Steps => filled(StepView::bytes(1), |bytes| StepView::write(&[7], bytes)),
        Topic::Pulses => filled(size_of::<PulseMessage>(), |_| ()),
        Topic::Dialog => {
            let mut message = DialogMessage::new(DialogKind::Plan, 0, 1, "a plan");
            message.steps = vec![PlanStep::default()];
            filled(message.bytes(), |bytes| message.write(bytes))
        }
        Topic::Answers => filled(size_of::<AnswerMessage>(), |bytes| {
            bytes.copy_from_slice(bytemuck::bytes_of(&AnswerMessage::new(AnswerKind::Scale)));
        }),
        Topic::Microphone => {
            let header = AudioHeader::of_visitor(16_000, 1, 1);
            filled(AudioView::bytes(3), |bytes| AudioView::write(header, &[1; 3], bytes))
        }
        Topic::Speech => {
            let header = AudioHeader::of_body(22_050, 0, 1, 1);
            filled(AudioView::bytes(3), |bytes| AudioView::write(header.last(), &[1; 3], bytes))
        }
        Topic::Frames(_) => {
            let layout = FrameLayout::new(5, 3, 1, &Plane::ALL, 2);
            filled(layout.bytes(), |bytes| layout.split_mut(bytes).header.seen = 1)
        }
    }
}
