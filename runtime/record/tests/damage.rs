//! A log that was damaged at any one place opens and says what is lost, and what it then says is what was written; one that
//! was cut opens up to there.
#![allow(clippy::unwrap_used, missing_docs)]

use std::{
    io::{self, Write},
    path::Path,
    sync::{Arc, Mutex},
};

use bytemuck::Zeroable as _;
use cohabit_bus::{
    Envelope, Text,
    message::{DialogKind, DialogMessage, DialogView, EventKind, EventMessage, MissionHeader, MissionMessage},
};
use cohabit_cdf::Action;
use cohabit_record::{
    DialogEntry, EventEntry, GapEntry, InputEntry, Log, LogError, LogWriter, SessionEntry, SessionFacts, Snapshot,
    TickEntry,
};

const TICKS: u64 = 60;
const CASES: u64 = 1000;

/// Memory that a log is written to.
#[derive(Clone, Default)]
struct Memory(Arc<Mutex<Vec<u8>>>);

impl Write for Memory {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap().extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn session() -> SessionEntry {
    let header = MissionHeader { seed: u64::MAX, file: Text::new("m.json"), ..MissionHeader::zeroed() };
    let bodies = vec!["person@Lab1".parse().unwrap()];
    let mission = MissionMessage { header, bodies, cameras: Vec::new(), text: "{}".to_owned() };
    let facts = SessionFacts {
        participant: Some("P07".to_owned()),
        settings: [("ask".to_owned(), "unsure".to_owned())].into(),
        ..SessionFacts::named("s")
    };
    SessionEntry { run: u64::MAX, ..SessionEntry::new(&facts, &mission) }
}

fn tick(tick: u64) -> TickEntry {
    let inputs = if tick.is_multiple_of(7) {
        vec![InputEntry { command: 1 << 50, turn: 1, body: 0, action: Action::LookAround }]
    } else {
        Vec::new()
    };
    TickEntry { tick, digest: format!("{tick:064x}"), wall_nanos: 1_000 + tick, inputs }
}

fn event(sequence: u64) -> EventEntry {
    let envelope = Envelope { tick: sequence, run: 1 << 61, sequence, ..Envelope::default() };
    EventEntry::new(&envelope, &EventMessage::new(EventKind::Message).saying("hello")).unwrap()
}

fn reply(tick: u64) -> DialogEntry {
    let message = DialogMessage::new(DialogKind::Reply, 0, tick, "Here you are.");
    let envelope = Envelope { run: 1 << 62, sequence: tick / 5, ..Envelope::default() };
    DialogEntry::new(tick, &envelope, DialogView { header: &message.header, steps: &message.steps }).unwrap()
}

/// What is written at a tick, and sealed.
fn write(log: &mut LogWriter, number: u64) {
    log.tick(&tick(number)).unwrap();
    log.event(&event(number), number).unwrap();
    if number.is_multiple_of(5) {
        log.dialog(&reply(number), number).unwrap();
    }
    if number.is_multiple_of(20) {
        log.snapshot(&Snapshot::pack(number, &[number as u8; 500]), number).unwrap();
        log.gap(&GapEntry { tick: number, events: 3, ..GapEntry::default() }, number).unwrap();
    }
    log.flush().unwrap();
}

/// A log, and where each of its parts ends: the first holds the session, each further one a tick and perhaps a copy of the
/// session entry.
fn sample() -> (Vec<u8>, Vec<usize>) {
    let memory = Memory::default();
    let length = || memory.0.lock().unwrap().len();
    let mut log = LogWriter::begin(Path::new("a log"), Box::new(memory.clone()), &session(), 1).unwrap();
    let mut ends = vec![length()];
    for number in 1..=TICKS {
        write(&mut log, number);
        ends.push(length());
    }
    log.finish().unwrap();
    let bytes = memory.0.lock().unwrap().clone();
    (bytes, ends)
}

fn parse(bytes: &[u8]) -> Result<Log, LogError> {
    Log::parse(Path::new("a log"), bytes)
}

/// The numbers of a seed, one after the other (SplitMix64).
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, limit: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) % limit as u64) as usize
    }
}

/// Nothing that a damaged log says is otherwise than what was written: it says all of it, but for these ticks.
fn check_says_what_was_written(log: &Log, missing: &[u64], what: &str) {
    let is_there = |tick: u64| !missing.contains(&tick);
    let ticks: Vec<_> = (1..=TICKS).filter(|number| is_there(*number)).map(tick).collect();
    let events: Vec<_> = (1..=TICKS).filter(|number| is_there(*number)).map(event).collect();
    let dialog: Vec<_> = (5..=TICKS).step_by(5).filter(|number| is_there(*number)).map(reply).collect();
    let snapshots: Vec<_> = (20..=TICKS)
        .step_by(20)
        .filter(|number| is_there(*number))
        .map(|number| Snapshot::pack(number, &[number as u8; 500]))
        .collect();
    assert_eq!(log.session, session(), "{what}");
    assert_eq!(log.ticks, ticks, "{what}");
    assert_eq!(log.events, events, "{what}");
    assert_eq!(log.dialog, dialog, "{what}");
    assert_eq!(log.snapshots, snapshots, "{what}");
}

#[test]
fn a_whole_log_says_all_and_lacks_nothing() {
    let (bytes, _) = sample();
    let log = parse(&bytes).unwrap();
    check_says_what_was_written(&log, &[], "whole");
    assert_eq!((log.lost.len(), log.cut.as_deref(), log.missing()), (0, None, 0));
    assert_eq!(log.problems().len(), 3, "its recorder noted three gaps: {:?}", log.problems());
}

/// Where the session entry stands.
fn copies(bytes: &[u8]) -> Vec<usize> {
    let entry = serde_json::to_vec(&session()).unwrap();
    bytes.windows(entry.len()).enumerate().filter(|(_, part)| *part == entry).map(|(at, _)| at).collect()
}

/// The ticks that a log does not have.
fn missing(log: &Log) -> Vec<u64> {
    (1..=TICKS).filter(|number| log.ticks.iter().all(|entry| entry.tick != *number)).collect()
}

#[test]
fn the_session_entry_is_repeated() {
    let (bytes, ends) = sample();
    let copies = copies(&bytes);
    assert!(copies.len() >= 4, "at the beginning, soon after, with a snapshot, at the end: {copies:?}");
    assert!(copies[0] < ends[0] && copies[1] > ends[0] + 4096, "no one block holds both: {copies:?}, {ends:?}");
    assert!(copies[copies.len() - 1] > ends[TICKS as usize - 1], "{copies:?}, {ends:?}");
}

#[test]
fn a_log_cut_anywhere_opens_up_to_there_or_is_refused() {
    let (bytes, ends) = sample();
    let mut numbers = Numbers(1);
    for _ in 0..CASES {
        let length = numbers.below(bytes.len());
        let what = format!("cut at {length}");
        match parse(&bytes[..length]) {
            Ok(log) => {
                let whole = ends.iter().filter(|end| **end <= length).count() as u64;
                // Where a copy of the session entry was cut, the tick before it is whole.
                let missing = missing(&log);
                assert!(
                    missing == (whole..=TICKS).collect::<Vec<_>>()
                        || missing == (whole + 1..=TICKS).collect::<Vec<_>>()
                );
                check_says_what_was_written(&log, &missing, &what);
                assert!(log.cut.is_some(), "{what}: unnoticed");
            }
            Err(error) => {
                assert!(length < ends[0], "{what}: {error}");
                assert!(matches!(error, LogError::NotALog { .. }), "{what}: {error}");
            }
        }
    }
}

/// A log of which only these bytes were changed opens, says so, and holds all that stands elsewhere.
fn check_damaged(changed: &[u8], place: std::ops::Range<usize>, ends: &[usize], what: &str) {
    let log = parse(changed).unwrap_or_else(|error| panic!("{what}: {error}"));
    let [first, last] = [place.start, place.end - 1].map(|byte| ends.partition_point(|end| *end <= byte) as u64);
    let missing = missing(&log);
    // Where a seal is damaged, what follows it cannot be told to follow.
    assert!(missing.iter().all(|tick| (first..=last + 1).contains(tick)), "{what}: {missing:?}");
    check_says_what_was_written(&log, &missing, what);
    let said = log.problems().join("; ");
    assert!(log.lost.len() == 1 || log.cut.is_some(), "{what}: {said}");
    assert!(said.contains("damaged") || said.contains("torn"), "{what}: {said}");
}

#[test]
fn a_log_with_a_changed_byte_says_what_is_lost() {
    let (bytes, ends) = sample();
    let mut numbers = Numbers(2);
    let anywhere: Vec<_> = (0..CASES).map(|_| numbers.below(bytes.len())).collect();
    // All of the beginning: the magic, the header, schemas, channels, and the session entry.
    for place in (0..ends[0] + 64).chain(anywhere) {
        let mut changed = bytes.clone();
        changed[place] ^= 1 + numbers.below(255) as u8;
        let what = format!("byte {place} is {:#04x} instead of {:#04x}", changed[place], bytes[place]);
        check_damaged(&changed, place..place + 1, &ends, &what);
    }
}

#[test]
fn a_log_with_a_block_of_zeros_says_what_is_lost() {
    let (bytes, ends) = sample();
    let mut numbers = Numbers(3);
    let anywhere: Vec<_> = (0..CASES).map(|_| (numbers.below(bytes.len()), 1 + numbers.below(4096))).collect();
    let sectors = (0..bytes.len()).step_by(512).flat_map(|start| [(start, 512), (start, 4096)]);
    for (start, length) in sectors.chain(anywhere) {
        let mut changed = bytes.clone();
        let place = start..(start + length).min(bytes.len());
        changed[place.clone()].fill(0);
        if changed != bytes {
            check_damaged(&changed, place, &ends, &format!("{length} zeros from byte {start}"));
        }
    }
}

/// Whatever its beginning was, what stands behind is read by a copy of the session entry.
#[test]
fn a_log_without_its_beginning_opens() {
    let (bytes, ends) = sample();
    let copies = copies(&bytes);
    let last = copies[copies.len() - 2];
    let mut numbers = Numbers(4);
    for gone in (1..CASES / 5).map(|_| 1 + numbers.below(last - 64)).chain([1, 8, ends[0]]) {
        let whole = ends.iter().filter(|end| **end <= gone).count() as u64;
        let mut zeros = bytes.clone();
        zeros[..gone].fill(0);
        for rest in [&bytes[gone..], &zeros[..]] {
            let log = parse(rest).unwrap_or_else(|error| panic!("without {gone} bytes: {error}"));
            let missing = missing(&log);
            assert!(missing.iter().all(|tick| *tick <= whole + 1), "without {gone} bytes: {missing:?}");
            check_says_what_was_written(&log, &missing, "without its beginning");
            assert_eq!(log.lost[0].bytes[0], 0);
        }
    }
}

#[test]
fn segments_that_go_come_or_change_places_are_found_out() {
    let (bytes, ends) = sample();
    let segment = |number: usize| &bytes[ends[number - 1]..ends[number]];
    let [before, after] = [&bytes[..ends[9]], &bytes[ends[12]..]];
    let gone = [before, segment(11), segment(12), after].concat();
    let doubled = [before, segment(10), segment(10), segment(11), segment(12), after].concat();
    let swapped = [before, segment(11), segment(10), segment(12), after].concat();
    for (what, changed) in [("gone", gone), ("doubled", doubled), ("swapped", swapped)] {
        let log = parse(&changed).unwrap();
        assert!(!log.lost.is_empty(), "{what}");
        let expected: Vec<_> = log.ticks.iter().map(|entry| tick(entry.tick)).collect();
        assert_eq!(log.ticks, expected, "{what}");
        assert!(log.ticks.windows(2).all(|pair| pair[0].tick < pair[1].tick), "{what}");
    }
}

/// A log as format 1 had it: no seals, and fewer fields.
fn old(format: u32, end: bool) -> Vec<u8> {
    let mut writer = mcap::WriteOptions::new()
        .profile("cohabit")
        .library("cohabit 0.1.0")
        .compression(None)
        .use_chunks(false)
        .create(io::Cursor::new(Vec::new()))
        .unwrap();
    let mut write = |topic: &str, text: &str| {
        let schema = writer.add_schema(&topic[1..], "jsonschema", b"{}").unwrap();
        let channel_id = writer.add_channel(schema, topic, "json", &Default::default()).unwrap();
        let header = mcap::records::MessageHeader { channel_id, sequence: 0, log_time: 1, publish_time: 1 };
        writer.write_to_known_channel(&header, text.as_bytes()).unwrap();
    };
    let session = format!(
        r#"{{"format":{format},"program":"0.9.9","session":"s","mission_file":"m","mission_text":"{{}}","seed":7,"run":"ff"}}"#
    );
    write("/session", &session);
    write("/ticks", r#"{"tick":1,"digest":"00","wall_nanos":5}"#);
    write("/dialog", r#"{"kind":"Reply","turn":1,"body":0,"step":0,"sent_nanos":9,"stamps":[1,2,3,4],"text":"Hello"}"#);
    if end {
        writer.finish().unwrap();
    }
    writer.into_inner().into_inner()
}

#[test]
fn a_log_of_an_older_format_opens() {
    for end in [true, false] {
        let log = parse(&old(1, end)).unwrap();
        assert_eq!((log.session.seed, log.session.run, log.ticks[0].wall_nanos), (7, 0xff, 1));
        assert_eq!((log.dialog[0].tick, log.dialog[0].stamps), (1, [1, 2, 3, 4, 0]));
        assert_eq!(log.cut.is_none(), end);
    }
    // Format 2 had the session entry once, in a log that is otherwise as it is now.
    let (memory, entry) = (Memory::default(), SessionEntry { format: 2, ..session() });
    let mut log = LogWriter::begin(Path::new("a log"), Box::new(memory.clone()), &entry, 1).unwrap();
    write(&mut log, 1);
    drop(log);
    let mut bytes = memory.0.lock().unwrap().clone();
    let log = parse(&bytes).unwrap();
    assert_eq!((log.session, log.ticks), (entry, vec![tick(1)]));
    bytes[100] ^= 1;
    let error = parse(&bytes).unwrap_err().to_string();
    assert!(error.contains("its beginning is damaged, and no copy"), "{error}");
}

#[test]
fn a_log_of_a_newer_format_says_which_program_reads_it() {
    let error = parse(&old(99, true)).unwrap_err();
    assert!(matches!(error, LogError::TooNew { found: 99, .. }), "{error}");
    assert!(error.to_string().contains("0.9.9"), "{error}");
}
