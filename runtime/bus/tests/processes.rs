//! Peers in processes of their own, and what becomes of their samples when they are killed.
#![allow(clippy::unwrap_used, missing_docs)]

use std::{
    fs,
    io::{BufRead as _, BufReader, Read as _},
    process::{Child, ChildStdout, Command, Stdio},
    sync::atomic::{AtomicU32, Ordering},
    thread,
    time::{Duration, Instant},
};

use cohabit_bus::{CameraId, Session, Shm, Topic, Transport, Wake};

/// Tells a process of this test what it is to do: a role and a session.
const ROLE: &str = "COHABIT_BUS_TEST_ROLE";
const WATCHDOG: Duration = Duration::from_secs(30);
const TOPIC: Topic = Topic::Frames(CameraId::Eyes(0));

fn on_session(what: impl FnOnce(&Shm, &str)) {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let name = format!("p-{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
    let session = Session::new(&name).unwrap();
    let lock = session.supervise().unwrap();
    what(&Shm::join(&session).unwrap(), &name);
    session.end(lock);
}

/// A process of its own; killed at the latest when this is dropped.
struct Peer {
    child: Child,
    out: BufReader<ChildStdout>,
}

impl Peer {
    /// Starts one and waits until it has done what it is for.
    fn start(role: &str, session: &str) -> Self {
        let mut child = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "peer", "--ignored", "--nocapture"])
            .env(ROLE, format!("{role} {session}"))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let out = BufReader::new(child.stdout.take().unwrap());
        let mut peer = Self { child, out };
        peer.wait_for("ready");
        peer
    }

    fn wait_for(&mut self, word: &str) {
        let mut line = String::new();
        while !line.trim_end().ends_with(word) {
            line.clear();
            assert!(self.out.read_line(&mut line).unwrap() > 0, "the process has ended before `{word}`");
        }
    }

    fn kill(mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// What such a process does.
#[test]
#[ignore = "a process that other tests start"]
fn peer() {
    let Ok(role) = std::env::var(ROLE) else { return };
    let (role, session) = role.split_once(' ').unwrap();
    let bus = Shm::join(&Session::new(session).unwrap()).unwrap();
    let mut writer = bus.publisher(TOPIC).unwrap();
    let mut reader = bus.subscriber(TOPIC).unwrap();
    let mut listener = bus.listener(TOPIC.wake()).unwrap();
    match role {
        "send" => (1..=2u8).for_each(|value| {
            writer.send(value.into(), 100_000, &mut |bytes| bytes.fill(value)).unwrap();
        }),
        "echo" => println!("ready"),
        "listen" => {}
        _ => panic!("no such role"),
    }
    if role == "echo" {
        // Its own answer wakes it too, and is not answered.
        let mut answered = false;
        while !answered {
            assert!(listener.wait(WATCHDOG).unwrap());
            while let Some(sample) = reader.receive().unwrap() {
                if sample.envelope().tick == 1 && !answered {
                    let payload = sample.payload().to_vec();
                    writer.send(2, payload.len(), &mut |bytes| bytes.copy_from_slice(&payload)).unwrap();
                    answered = true;
                }
            }
        }
    } else {
        println!("ready");
    }
    // Until it is killed, or whoever started it is gone.
    let _ = std::io::stdin().read(&mut [0]);
}

fn wait_until(what: &str, mut holds: impl FnMut() -> bool) {
    let deadline = Instant::now() + WATCHDOG;
    while !holds() {
        assert!(Instant::now() < deadline, "{what}");
        thread::park_timeout(Duration::from_millis(5));
    }
}

fn files_of(session: &str) -> usize {
    let part = format!("_{session}_");
    fs::read_dir("/dev/shm")
        .unwrap()
        .flatten()
        .filter(|file| file.file_name().to_string_lossy().contains(&part))
        .count()
}

#[test]
fn a_message_goes_to_another_process_and_back() {
    on_session(|bus, session| {
        let mut reader = bus.subscriber(TOPIC).unwrap();
        let mut listener = bus.listener(TOPIC.wake()).unwrap();
        let mut writer = bus.publisher(TOPIC).unwrap();
        let _peer = Peer::start("echo", session);
        writer.send(1, 5, &mut |bytes| bytes.copy_from_slice(b"hello")).unwrap();
        let mut answer = None;
        while answer.is_none() {
            assert!(listener.wait(WATCHDOG).unwrap(), "no answer");
            answer = reader.latest().unwrap().filter(|sample| sample.envelope().tick == 2);
        }
        assert_eq!(answer.unwrap().payload(), b"hello");
    });
}

#[test]
fn what_a_killed_publisher_has_sent_is_still_received() {
    on_session(|bus, session| {
        let mut reader = bus.subscriber(TOPIC).unwrap();
        let peer = Peer::start("send", session);
        let held = reader.receive().unwrap().unwrap();
        peer.kill();
        let next = reader.receive().unwrap().unwrap();
        bus.clean_up_dead_peers();
        for (value, sample) in [(1, held), (2, next)] {
            assert_eq!(sample.payload(), vec![value; 100_000]);
        }
        let mut writer = bus.publisher(TOPIC).unwrap();
        writer.send(3, 0, &mut |_| ()).unwrap();
        assert_eq!(reader.receive().unwrap().unwrap().envelope().tick, 3);
        assert_eq!(reader.lost(), 0);
    });
}

#[test]
fn a_killed_reader_holds_nobody_up_and_is_forgotten() {
    on_session(|bus, session| {
        let mut writer = bus.publisher(TOPIC).unwrap();
        let mut reader = bus.subscriber(TOPIC).unwrap();
        let peer = Peer::start("listen", session);
        assert_eq!(writer.subscribers(), 2);
        writer.send(1, 100_000, &mut |bytes| bytes.fill(1)).unwrap();
        peer.kill();
        for tick in 2..100 {
            writer.send(tick, 100_000, &mut |bytes| bytes.fill(2)).unwrap();
            assert_eq!(reader.latest().unwrap().unwrap().envelope().tick, tick);
        }
        wait_until("the dead reader is still counted", || {
            bus.clean_up_dead_peers();
            writer.subscribers() == 1
        });
    });
}

#[test]
fn killed_peers_leave_nothing_that_is_not_cleaned_up() {
    on_session(|bus, session| {
        let mut reader = bus.subscriber(TOPIC).unwrap();
        let mut listener = bus.listener(Wake::Talk).unwrap();
        let mut before = files_of(session);
        for round in 0..3 {
            ["send", "listen"].map(|role| Peer::start(role, session)).into_iter().for_each(Peer::kill);
            drop(reader.latest().unwrap());
            if round == 0 {
                // What the first peers made for all that come later stays.
                bus.clean_up_dead_peers();
                before = before.max(files_of(session));
            }
            wait_until("shared memory of dead peers is left", || {
                bus.clean_up_dead_peers();
                let _ = reader.receive();
                files_of(session) <= before
            });
        }
        bus.publisher(Topic::Dialog).unwrap().send(0, 0, &mut |_| ()).unwrap();
        assert!(listener.wait(WATCHDOG).unwrap());
    });
}
