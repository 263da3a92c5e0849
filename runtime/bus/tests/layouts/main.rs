//! Every record lies in memory as `LAYOUTS.md` says, which is what programs in other languages read by.
#![allow(clippy::unwrap_used, missing_docs)]

mod document;
mod payload;
mod source;

use std::{fs, path::Path};

use cohabit_bus::{
    Envelope, Topic,
    message::{
        ActionRecord, AnswerMessage, AudioHeader, BodyRecord, CameraRecord, CommandMessage, ControlMessage,
        DialogHeader, EventMessage, FrameHeader, GoalRecord, MissionHeader, NoteRecord, ObjectRecord, PlanStep,
        PulseMessage, SeenRecord, SnapshotHeader, StateHeader, StepHeader, TickHeader,
    },
};

use payload::{Payload, example, topics};
use source::Source;

const FOLDER: &str = env!("CARGO_MANIFEST_DIR");

macro_rules! sizes {
    ($($record:ident),* $(,)?) => { [$((stringify!($record), size_of::<$record>())),*] };
}

/// What the compiler makes of each record that can be named from outside.
const SIZES: &[(&str, usize)] = &sizes![
    ActionRecord,
    AnswerMessage,
    AudioHeader,
    BodyRecord,
    CameraRecord,
    CommandMessage,
    ControlMessage,
    DialogHeader,
    Envelope,
    EventMessage,
    FrameHeader,
    GoalRecord,
    MissionHeader,
    NoteRecord,
    ObjectRecord,
    PlanStep,
    PulseMessage,
    SeenRecord,
    SnapshotHeader,
    StateHeader,
    StepHeader,
    TickHeader,
];

/// Records that cannot be: the sizes of those that messages hold show in payloads.
const PRIVATE: &[&str] = &["BodyRequestRecord", "NamedRoomRecord", "Strokes"];

fn source() -> Source {
    Source::read(&Path::new(FOLDER).join("src"))
}

/// The number in a field of a record that begins a payload.
fn field(source: &Source, payload: &Payload, bytes: &[u8], name: &str) -> usize {
    let record = source.record(payload.header);
    let field = record.fields.iter().find(|field| field.name == name);
    let field = field.unwrap_or_else(|| panic!("`{}` has no field `{name}`", record.name));
    bytes[field.offset..field.offset + field.bytes].iter().rfold(0, |sum, byte| sum << 8 | usize::from(*byte))
}

#[test]
fn the_source_and_the_compiler_agree() {
    let source = source();
    for record in &source.records {
        let size = SIZES.iter().find(|(name, _)| *name == record.name);
        match size {
            Some((name, bytes)) => assert_eq!(record.bytes(), *bytes, "{name}"),
            None => assert!(PRIVATE.contains(&record.name.as_str()), "`{}` belongs into `SIZES`", record.name),
        }
    }
    assert_eq!(source.records.len(), SIZES.len() + PRIVATE.len());
}

#[test]
fn payloads_are_made_of_what_the_document_says() {
    let source = source();
    for topic in topics().into_iter().filter(|topic| !matches!(topic, Topic::Frames(_))) {
        let payload = Payload::of(topic);
        let mut example = example(topic);
        let bytes = example.bytes();
        let mut length = source.record(payload.header).bytes().next_multiple_of(8);
        for (place, (record, count)) in payload.lists.iter().enumerate() {
            let found = field(&source, &payload, bytes, count);
            let (each, most) = if *record == "u8" {
                (1, 3)
            } else if *record == "u64" {
                (8, 1)
            } else if *record == "i16" {
                (2, 3)
            } else {
                (source.record(record).bytes(), place + 1)
            };
            assert_eq!(found, most, "{topic}: `{count}`");
            length += (each * found).next_multiple_of(8);
        }
        assert_eq!(bytes.len(), length, "{topic}");
    }
}

#[test]
fn a_frames_header_says_where_its_parts_are() {
    let source = source();
    let topic = topics().pop().unwrap();
    let payload = Payload::of(topic);
    let mut example = example(topic);
    let bytes = example.bytes();
    let number = |name| field(&source, &payload, bytes, name);
    let plane = (number("width") * number("height") * number("views") * 4).next_multiple_of(64);
    let seen_at = source.record("FrameHeader").bytes() + 4 * plane;
    assert_eq!((number("planes"), number("seen"), number("seen_room")), (0b1111, 1, 2));
    assert_eq!(number("seen_at"), seen_at);
    assert_eq!(bytes.len(), seen_at + 2 * source.record("SeenRecord").bytes());
}

#[test]
fn the_document_is_that_of_the_code() {
    let path = Path::new(FOLDER).join("LAYOUTS.md");
    let payloads: Vec<_> = topics().into_iter().map(Payload::of).collect();
    let now = document::write(&source(), &payloads);
    let before = fs::read_to_string(&path).unwrap_or_default();
    let layouts = document::layouts(&now);
    let moved: Vec<_> = document::layouts(&before)
        .into_iter()
        .filter(|(record, fields)| layouts.get(record) != Some(fields))
        .map(|(record, _)| record)
        .collect();
    assert!(
        moved.is_empty() || document::version(&before) != Some(Envelope::VERSION),
        "{moved:?} lie otherwise than LAYOUTS.md says, and version {} of the messages is what peers go by: raise \
         `Envelope::VERSION`\n{}",
        Envelope::VERSION,
        document::difference(&before, &now)
    );
    if std::env::var_os("BLESS").is_some() {
        fs::write(&path, &now).unwrap();
        return;
    }
    assert!(
        before == now,
        "LAYOUTS.md is not what the code says; `BLESS=1 cargo test -p cohabit-bus --test layouts` writes it anew:\n{}",
        document::difference(&before, &now)
    );
}
