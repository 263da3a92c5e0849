//! A disk that takes its time: nobody waits for it, and the log says what it misses.
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
use cohabit_record::{Log, Recorder, SessionFacts};

/// More than the bus keeps of any of them.
const TICKS: u64 = 5000;

#[derive(Default)]
struct Disk {
    bytes: Vec<u8>,
    is_stuck: bool,
    /// Whether somebody waits for it.
    is_awaited: bool,
}

/// A disk that is stuck until it is let go.
#[derive(Clone, Default)]
struct SlowDisk(Arc<(Mutex<Disk>, Condvar)>);

impl SlowDisk {
    fn change(&self, change: impl FnOnce(&mut Disk)) {
        change(&mut self.0.0.lock().unwrap());
        self.0.1.notify_all();
    }

    fn wait_until(&self, holds: impl Fn(&Disk) -> bool) {
        drop(self.0.1.wait_while(self.0.0.lock().unwrap(), |disk| !holds(disk)).unwrap());
    }
}

impl Write for SlowDisk {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.change(|disk| disk.is_awaited = disk.is_stuck);
        self.wait_until(|disk| !disk.is_stuck);
        self.change(|disk| disk.bytes.extend_from_slice(bytes));
        Ok(bytes.len())
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
    let disk = SlowDisk::default();
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
