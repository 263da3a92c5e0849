//! A recorder that was killed anywhere, and the one that takes its place.
#![allow(clippy::unwrap_used, missing_docs)]

use std::{
    fs,
    path::{Path, PathBuf},
    sync::atomic::AtomicBool,
};

use bytemuck::Zeroable as _;
use cohabit_bus::{
    Envelope, Local, Publisher, Text, Topic, Transport,
    message::{
        DialogKind, DialogMessage, EventKind, EventMessage, MissionHeader, MissionMessage, TickHeader, TickMessage,
    },
};
use cohabit_record::{
    EventEntry, Log, LogError, LogWriter, RecordError, Recorder, SessionEntry, SessionFacts, Snapshot, TickEntry,
};
use proptest::prelude::*;

/// A file that goes when this is dropped.
struct Scratch(PathBuf);

impl Scratch {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("cohabit-carry-on-{name}-{}.mcap", std::process::id()));
        let _ = fs::remove_file(&path);
        Self(path)
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
    }
}

fn mission() -> MissionMessage {
    let header = MissionHeader { seed: 7, file: Text::new("m.json"), ..MissionHeader::zeroed() };
    MissionMessage { header, bodies: Vec::new(), cameras: Vec::new(), text: "{}".to_owned() }
}

fn session(name: &str) -> SessionEntry {
    SessionEntry { run: 1 << 60, ..SessionEntry::new(&SessionFacts::named(name), &mission()) }
}

fn tick(tick: u64) -> TickEntry {
    TickEntry { tick, digest: format!("{tick:064x}"), wall_nanos: tick, inputs: Vec::new() }
}

fn event(sequence: u64) -> EventEntry {
    let envelope = Envelope { tick: sequence, run: 1 << 61, sequence, ..Envelope::default() };
    EventEntry::new(&envelope, &EventMessage::new(EventKind::Message).saying("hello")).unwrap()
}

const TICKS: u64 = 40;

/// Writes what is not written yet.
fn write_rest(log: &mut LogWriter, after: u64) {
    for number in after + 1..=TICKS {
        log.tick(&tick(number)).unwrap();
        log.event(&event(number), number).unwrap();
        if number.is_multiple_of(10) {
            log.snapshot(&Snapshot::pack(number, &[number as u8; 5000]), number).unwrap();
        }
        log.flush().unwrap();
    }
}

fn whole(path: &Path) -> Vec<u8> {
    let mut log = LogWriter::create(path, &session("s"), 1).unwrap();
    write_rest(&mut log, 0);
    log.finish().unwrap();
    fs::read(path).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_log_cut_anywhere_is_carried_on_with(cut in any::<proptest::sample::Index>()) {
        let file = Scratch::new("cut");
        let bytes = whole(&file.0);
        let cut = cut.index(bytes.len() + 1);
        fs::write(&file.0, &bytes[..cut]).unwrap();
        let (mut log, written) = LogWriter::carry_on(&file.0, &session("s"), 1).unwrap();
        write_rest(&mut log, written.tick);
        log.finish().unwrap();
        prop_assert!(fs::read(&file.0).unwrap() == bytes, "cut at {cut}");
    }
}

#[test]
fn what_is_no_log_of_this_session_is_left_alone() {
    let file = Scratch::new("other");
    let mut bytes = whole(&file.0);
    let attempt = |name| LogWriter::carry_on(&file.0, &session(name), 1).map(|(_, written)| written);
    assert!(matches!(attempt("t"), Err(LogError::OtherSession { .. })));
    assert_eq!(fs::read(&file.0).unwrap(), bytes);
    assert_eq!(attempt("s").unwrap().tick, TICKS);
    // The index at the end went, and nothing else.
    bytes.truncate(fs::read(&file.0).unwrap().len());
    for text in ["my notes", "\u{89}MCAP0\r", ""] {
        fs::write(&file.0, text).unwrap();
        assert_eq!(attempt("s").is_ok(), text.is_empty(), "{text}");
    }
    let middle = bytes.len() / 2;
    bytes[middle..middle + 30].fill(0);
    fs::write(&file.0, &bytes).unwrap();
    let error = attempt("s").unwrap_err();
    assert!(matches!(error, LogError::NotALog { .. }), "{error}");
    assert_eq!(fs::read(&file.0).unwrap(), bytes);
}

#[test]
fn a_log_has_one_writer() {
    let file = Scratch::new("busy");
    let log = LogWriter::create(&file.0, &session("s"), 1).unwrap();
    assert!(matches!(LogWriter::carry_on(&file.0, &session("s"), 1), Err(LogError::Busy { .. })));
    drop(log);
    assert!(LogWriter::carry_on(&file.0, &session("s"), 1).is_ok());
}

struct World {
    mission: Box<dyn Publisher>,
    ticks: Box<dyn Publisher>,
    events: Box<dyn Publisher>,
    dialog: Box<dyn Publisher>,
}

impl World {
    fn new(bus: &Local) -> Self {
        let [mission, ticks, events, dialog] =
            [Topic::Mission, Topic::Ticks, Topic::Events, Topic::Dialog].map(|topic| bus.publisher(topic).unwrap());
        let mut world = Self { mission, ticks, events, dialog };
        let message = self::mission();
        world.mission.send(0, message.bytes(), &mut |bytes| message.write(bytes)).unwrap();
        world
    }

    fn tick(&mut self, number: u64) {
        let message = TickMessage { header: TickHeader::default(), inputs: Vec::new() };
        self.ticks.send(number, message.bytes(), &mut |bytes| message.write(bytes)).unwrap();
        let event = EventMessage::new(EventKind::Message).saying(&number.to_string());
        self.events
            .send(number, size_of::<EventMessage>(), &mut |bytes| bytes.copy_from_slice(bytemuck::bytes_of(&event)))
            .unwrap();
        let said = DialogMessage::new(DialogKind::Reply, 0, number, &number.to_string());
        self.dialog.send(0, said.bytes(), &mut |bytes| said.write(bytes)).unwrap();
    }
}

#[test]
fn recorders_one_after_the_other_write_one_log() {
    let file = Scratch::new("relay");
    let bus = Local::new(1);
    let mut world = World::new(&bus);
    for round in 0..5 {
        for number in 1..=20 {
            world.tick(20 * round + number);
        }
        // Each finds all that was published, of which it must write what is new.
        Recorder::new(&bus).unwrap().run(&SessionFacts::named("s"), &file.0, &AtomicBool::new(true), || {}).unwrap();
    }
    let log = Log::open(&file.0).unwrap();
    let all: Vec<u64> = (1..=100).collect();
    assert_eq!(log.ticks.iter().map(|entry| entry.tick).collect::<Vec<_>>(), all);
    assert_eq!(log.events.iter().map(|entry| entry.tick).collect::<Vec<_>>(), all);
    assert_eq!(log.dialog.iter().map(|entry| entry.turn).collect::<Vec<_>>(), all);
    assert_eq!((log.cut.as_deref(), log.missing()), (None, 0));
}

/// A recorder says at its end when its log lacks something, also when an earlier one missed it.
#[test]
fn an_incomplete_log_is_no_success() {
    let file = Scratch::new("incomplete");
    let bus = Local::new(1);
    let mut world = World::new(&bus);
    let run = || {
        let recorder = Recorder::new(&bus).unwrap();
        recorder.run(&SessionFacts::named("s"), &file.0, &AtomicBool::new(true), || {})
    };
    (1..=20).for_each(|number| world.tick(number));
    run().unwrap();
    // More than the bus keeps.
    (21..=5000).for_each(|number| world.tick(number));
    for _ in 0..2 {
        let error = run().unwrap_err();
        let log = Log::open(&file.0).unwrap();
        assert!(log.missing() > 0);
        assert!(matches!(error, RecordError::Incomplete { missing, .. } if missing == log.missing()), "{error}");
        assert!(error.to_string().contains("is incomplete"), "{error}");
    }
}
