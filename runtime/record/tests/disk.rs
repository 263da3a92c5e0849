//! A disk that takes its time: nobody waits for it, and the log says what it misses. One that is full: with room again,
//! nothing is missing.
#![allow(clippy::unwrap_used, missing_docs)]

use std::{
    io::{self, Write},
    path::Path,
    sync::{Arc, Condvar, Mutex},
    thread,
};

use bytemuck::Zeroable as _;
use cohabit_bus::{
    Local, Publisher, Text, Topic, Transport,
    message::{EventKind, EventMessage, MissionHeader, MissionMessage, TickHeader, TickMessage},
};
use cohabit_record::{Log, Recorder, Recording, SessionFacts};

/// More than the bus keeps of any of them.
const TICKS: u64 = 5000;

#[derive(Default)]
struct Disk {
    bytes: Vec<u8>,
    is_stuck: bool,
    /// Whether somebody waits for it.
    is_awaited: bool,
    /// How many bytes it has, where it has an end.
    size: Option<usize>,
}

/// A disk that can be stuck until it is let go, and full until it is made larger.
#[derive(Clone, Default)]
struct BadDisk(Arc<(Mutex<Disk>, Condvar)>);

impl BadDisk {
    fn change(&self, change: impl FnOnce(&mut Disk)) {
        change(&mut self.0.0.lock().unwrap());
        self.0.1.notify_all();
    }

    fn wait_until(&self, holds: impl Fn(&Disk) -> bool) {
        drop(self.0.1.wait_while(self.0.0.lock().unwrap(), |disk| !holds(disk)).unwrap());
    }
}

impl Write for BadDisk {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.change(|disk| disk.is_awaited = disk.is_stuck);
        self.wait_until(|disk| !disk.is_stuck);
        let mut disk = self.0.0.lock().unwrap();
        let room = disk.size.map_or(usize::MAX, |size| size - disk.bytes.len());
        if room == 0 {
            return Err(io::ErrorKind::StorageFull.into());
        }
        let taken = bytes.len().min(room);
        disk.bytes.extend_from_slice(&bytes[..taken]);
        Ok(taken)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

struct World {
    ticks: Box<dyn Publisher>,
    events: Box<dyn Publisher>,
}

impl World {
    fn new(bus: &Local) -> Self {
        let header = MissionHeader { seed: 7, file: Text::new("m.json"), ..MissionHeader::zeroed() };
        let message = MissionMessage { header, bodies: Vec::new(), cameras: Vec::new(), text: "{}".to_owned() };
        let mut mission = bus.publisher(Topic::Mission).unwrap();
        mission.send(0, message.bytes(), &mut |bytes| message.write(bytes)).unwrap();
        let [ticks, events] = [Topic::Ticks, Topic::Events].map(|topic| bus.publisher(topic).unwrap());
        Self { ticks, events }
    }

    fn tick(&mut self, number: u64) {
        let message = TickMessage { header: TickHeader::default(), inputs: Vec::new() };
        self.ticks.send(number, message.bytes(), &mut |bytes| message.write(bytes)).unwrap();
        self.events.send_record(number, &EventMessage::new(EventKind::Message).saying("x")).unwrap();
    }
}

#[test]
fn the_world_goes_on_and_the_log_states_the_gap() {
    let bus = Local::new(1);
    let recorder = Recorder::new(&bus).unwrap();
    let mut world = World::new(&bus);
    let disk = BadDisk::default();
    let mut recording = recorder.begin_in(&SessionFacts::named("s"), Box::new(disk.clone())).unwrap();
    disk.change(|disk| disk.is_stuck = true);
    world.tick(1);
    thread::scope(|scope| {
        let stuck = scope.spawn(|| {
            recording.take_down().unwrap();
            recording.flush().unwrap();
        });
        disk.wait_until(|disk| disk.is_awaited);
        // None of this waits for the disk, which is let go only after.
        (2..=TICKS).for_each(|number| world.tick(number));
        disk.change(|disk| disk.is_stuck = false);
        stuck.join().unwrap();
    });
    recording.take_down().unwrap();
    recording.finish().unwrap();
    let bytes = disk.0.0.lock().unwrap().bytes.clone();
    let log = Log::parse(Path::new("the log"), &bytes).unwrap();
    let [gap] = log.gaps[..] else { panic!("{:?}", log.gaps) };
    assert_eq!((gap.tick, gap.ticks), (TICKS, TICKS - log.ticks.len() as u64));
    assert_eq!(gap.events, TICKS - log.events.len() as u64);
    assert!(gap.ticks > 0 && gap.events > 0);
    assert_eq!(log.missing(), gap.messages());
    assert!(log.problems()[0].contains("its disk slow"), "{:?}", log.problems());
    assert_eq!(log.lost, []);
}

/// A recording on a disk that is full behind some of its first hundred ticks, after two hundred of them.
fn on_a_full_disk(bus: &Local) -> (BadDisk, World, Recording) {
    let recorder = Recorder::new(bus).unwrap();
    let mut world = World::new(bus);
    let disk = BadDisk::default();
    let mut recording = recorder.begin_in(&SessionFacts::named("s"), Box::new(disk.clone())).unwrap();
    disk.change(|disk| disk.size = Some(disk.bytes.len() + 10_001));
    for number in 1..=200 {
        world.tick(number);
        recording.take_down().unwrap();
        recording.flush().unwrap();
    }
    disk.change(|disk| assert_eq!(Some(disk.bytes.len()), disk.size));
    (disk, world, recording)
}

#[test]
fn what_a_full_disk_had_no_room_for_is_written_when_there_is_some() {
    let (disk, mut world, mut recording) = on_a_full_disk(&Local::new(1));
    let bytes = disk.0.0.lock().unwrap().bytes.clone();
    let before = Log::parse(Path::new("the log"), &bytes).unwrap();
    assert!((1..200).contains(&before.ticks.len()), "{}", before.ticks.len());
    disk.change(|disk| disk.size = None);
    world.tick(201);
    recording.take_down().unwrap();
    recording.finish().unwrap();
    let bytes = disk.0.0.lock().unwrap().bytes.clone();
    let log = Log::parse(Path::new("the log"), &bytes).unwrap();
    assert_eq!(log.problems(), [] as [&str; 0]);
    assert_eq!((log.ticks.len(), log.events.len()), (201, 201));
}

#[test]
fn a_log_that_ends_on_a_full_disk_says_so() {
    let (disk, _world, recording) = on_a_full_disk(&Local::new(1));
    let error = recording.finish().unwrap_err().to_string();
    assert!(error.contains("write the log: no storage space") && error.contains("KiB are missing"), "{error}");
    let bytes = disk.0.0.lock().unwrap().bytes.clone();
    assert!(Log::parse(Path::new("the log"), &bytes).unwrap().cut.is_some());
}
