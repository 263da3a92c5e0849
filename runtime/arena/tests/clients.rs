//! Clients on a socket, one of them in Python.

#![allow(clippy::unwrap_used)]

mod support;

use std::{
    io::{Read as _, Write as _},
    net::{SocketAddr, TcpListener, TcpStream},
    process::Command,
    sync::atomic::{AtomicBool, Ordering},
    thread,
    time::{Duration, Instant},
};

use cohabit_arena::{ClientLimits, LONGEST, framed, serve_within};
use serde_json::Value;
use support::{Folder, arena, builtin, command};

/// Ends the server also when a check fails.
struct Stop<'a>(&'a AtomicBool);

impl Drop for Stop<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Has clients talk to a server; gives what they found.
fn served<T>(folder: &Folder, clients: impl FnOnce(SocketAddr) -> T) -> T {
    served_within(ClientLimits::default(), folder, clients)
}

/// The same, with these bounds for clients.
fn served_within<T>(limits: ClientLimits, folder: &Folder, clients: impl FnOnce(SocketAddr) -> T) -> T {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let (address, stop, arena) = (listener.local_addr().unwrap(), AtomicBool::new(false), arena(&folder.0));
    thread::scope(|scope| {
        let server = scope.spawn(|| serve_within(limits, &listener, arena, &stop));
        let ending = Stop(&stop);
        let found = clients(address);
        drop(ending);
        server.join().unwrap().unwrap();
        found
    })
}

fn connect(address: SocketAddr) -> TcpStream {
    let stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
    stream
}

fn receive(stream: &mut TcpStream) -> Value {
    let mut length = [0; 4];
    stream.read_exact(&mut length).unwrap();
    let mut bytes = vec![0; u32::from_le_bytes(length) as usize];
    stream.read_exact(&mut bytes).unwrap();
    serde_json::from_slice(&bytes).unwrap()
}

fn ask(stream: &mut TcpStream, commands: &[Value]) -> Value {
    stream.write_all(&framed(Value::from(commands).to_string().as_bytes())).unwrap();
    receive(stream)
}

#[test]
fn a_game_outlives_its_connection() {
    let folder = Folder::new();
    served(&folder, |address| {
        let mut first = connect(address);
        let mut bytes = vec![0; 8];
        bytes.extend(framed(builtin("laser_lab").as_bytes()));
        // In pieces, after two empty messages.
        for piece in bytes.chunks(1000) {
            first.write_all(piece).unwrap();
        }
        let here = ask(&mut first, &[command("room Lab2")])["objects"][0]["position"].clone();
        drop(first);
        let (mut second, mut third) = (connect(address), connect(address));
        assert_eq!(ask(&mut second, &[])["objects"][0]["position"], here);
        // Whoever only looks whether the port is open does not disturb.
        drop(connect(address));
        assert_eq!(ask(&mut third, &[])["objects"][0]["position"], here);
        third.write_all(&framed(builtin("warm_coffee").as_bytes())).unwrap();
        assert_eq!(ask(&mut third, &[])["challengeProgress"]["ChallengeGoals"].as_array().unwrap().len(), 3);
        assert_eq!(ask(&mut second, &[])["challengeProgress"]["ChallengeGoals"].as_array().unwrap().len(), 3);
    });
    assert_eq!(folder.logs().len(), 2);
}

#[test]
fn too_long_a_message_is_refused_and_ends_the_connection() {
    let folder = Folder::new();
    served(&folder, |address| {
        let mut client = connect(address);
        client.write_all(&u32::try_from(LONGEST + 1).unwrap().to_le_bytes()).unwrap();
        client.write_all(&[b' '; 5000]).unwrap();
        let reply = receive(&mut client);
        assert_eq!(reply["lastActionSuccess"], "IncorrectActionFormat");
        assert!(reply["message"].as_str().unwrap().contains("67108865 bytes"), "{reply}");
        assert_eq!(client.read(&mut [0]).unwrap(), 0);
        assert_eq!(ask(&mut connect(address), &[])["lastActionSuccess"], "ArenaUnavailable");
    });
}

#[test]
fn clients_beyond_the_most_are_sent_away() {
    let folder = Folder::new();
    served(&folder, |address| {
        let mut clients: Vec<TcpStream> = (0..16).map(|_| connect(address)).collect();
        for client in &mut clients {
            assert_eq!(ask(client, &[])["lastActionSuccess"], "ArenaUnavailable");
        }
        assert_eq!(connect(address).read(&mut [0]).unwrap_or(0), 0);
        assert_eq!(ask(&mut clients[7], &[])["lastActionSuccess"], "ArenaUnavailable");
    });
}

const AT_ONCE: Duration = Duration::from_millis(50);

/// Waits until the server has closed a connection.
fn wait_for_end(stream: &mut TcpStream) {
    match stream.read(&mut [0; 4096]) {
        Ok(0) => {}
        Ok(_) => wait_for_end(stream),
        Err(error) => assert_ne!(error.kind(), std::io::ErrorKind::WouldBlock, "the connection stays open"),
    }
}

#[test]
fn clients_that_say_nothing_lock_nobody_out() {
    let folder = Folder::new();
    served(&folder, |address| {
        let mut thinking = connect(address);
        assert_eq!(ask(&mut thinking, &[])["lastActionSuccess"], "ArenaUnavailable");
        let mut silent: Vec<TcpStream> = (0..40).map(|_| connect(address)).collect();
        for stream in &mut silent {
            // Those that were sent away take nothing.
            let _ = stream.write_all(&[9, 0, 0]);
        }
        let mut newcomer = connect(address);
        assert_eq!(ask(&mut newcomer, &[])["lastActionSuccess"], "ArenaUnavailable");
        wait_for_end(&mut silent[0]);
        // Who has spoken keeps its place.
        assert_eq!(ask(&mut thinking, &[])["lastActionSuccess"], "ArenaUnavailable");
    });
}

#[test]
fn a_client_may_think_as_long_as_it_likes_until_its_place_is_wanted() {
    let folder = Folder::new();
    let limits = ClientLimits {
        most_clients: 2,
        first_message: AT_ONCE,
        message: AT_ONCE,
        gives_way_after: Duration::ZERO,
        ..ClientLimits::default()
    };
    served_within(limits, &folder, |address| {
        let mut thinking = connect(address);
        ask(&mut thinking, &[]);
        // By the time that a silent one was sent away, the thinking one is late by any time-out of a message.
        wait_for_end(&mut connect(address));
        wait_for_end(&mut connect(address));
        assert_eq!(ask(&mut thinking, &[])["lastActionSuccess"], "ArenaUnavailable");
        let (mut second, mut third) = (connect(address), None);
        ask(&mut second, &[]);
        ask(third.insert(connect(address)), &[]);
        wait_for_end(&mut thinking);
        ask(&mut second, &[]);
    });
}

#[test]
fn a_message_that_does_not_come_whole_ends_its_connection() {
    let folder = Folder::new();
    served_within(ClientLimits { message: AT_ONCE, ..ClientLimits::default() }, &folder, |address| {
        let mut half = connect(address);
        ask(&mut half, &[]);
        half.write_all(&[100, 0, 0, 0, b'[']).unwrap();
        wait_for_end(&mut half);
    });
}

#[test]
fn unfinished_messages_share_a_bounded_memory() {
    let folder = Folder::new();
    let limits = ClientLimits { own_bytes: 1 << 20, shared_bytes: 8 << 20, ..ClientLimits::default() };
    served_within(limits, &folder, |address| {
        let mut long = u32::try_from(LONGEST).unwrap().to_le_bytes().to_vec();
        long.resize(6 << 20, b' ');
        let mut held = connect(address);
        held.write_all(&long).unwrap();
        let mut refused = connect(address);
        long.resize(16 << 20, b' ');
        let _ = refused.write_all(&long);
        let reply = receive(&mut refused);
        assert!(reply["message"].as_str().unwrap().contains("8388608 bytes: try again later"), "{reply}");
        // There is room for what is short.
        let mut short = connect(address);
        assert_eq!(ask(&mut short, &[])["lastActionSuccess"], "ArenaUnavailable");
        drop(held);
    });
}

#[test]
fn a_client_that_takes_no_answer_is_lost() {
    let folder = Folder::new();
    served_within(ClientLimits { answer: AT_ONCE, ..ClientLimits::default() }, &folder, |address| {
        let mut deaf = connect(address);
        let batch = framed(b"[]");
        // Answers are not read: at last it is found out, and what is sent then fails.
        while deaf.write_all(&batch).is_ok() {}
        assert_eq!(ask(&mut connect(address), &[])["lastActionSuccess"], "ArenaUnavailable");
    });
}

#[test]
fn no_client_keeps_the_arena_from_ending() {
    const SOON: Duration = Duration::from_secs(5);
    let folder = Folder::new();
    let (deaf, talkative, asked) = served(&folder, |address| {
        let mut deaf = connect(address);
        deaf.set_write_timeout(Some(Duration::from_secs(1))).unwrap();
        // Answers are not read: at last neither side can write any more.
        while deaf.write_all(&framed(b"[]")).is_ok() {}
        let mut talkative = connect(address);
        talkative.write_all(&u32::MAX.to_le_bytes()).unwrap();
        receive(&mut talkative);
        let talks = talkative.try_clone().unwrap();
        let talking = thread::spawn(move || talk_on(talks, 2 * SOON));
        (deaf, talking, Instant::now())
    });
    let took = asked.elapsed();
    drop(deaf);
    talkative.join().unwrap();
    assert!(took < SOON, "{took:?}");
}

/// Goes on to send, though it was sent away.
fn talk_on(mut stream: TcpStream, time: Duration) {
    let until = Instant::now() + time;
    while Instant::now() < until && stream.write_all(b" ").is_ok() {
        thread::sleep(Duration::from_millis(100));
    }
}

#[test]
#[cfg_attr(not(python), ignore = "needs Python 3.10 or later with venv")]
fn a_mask_agent_in_python_plays_a_mission() {
    let folder = Folder::new();
    let missions = Folder::new();
    let file = |name: &str| {
        let path = missions.0.join(name);
        std::fs::write(&path, builtin(name)).unwrap();
        path
    };
    let output = served(&folder, |address| {
        Command::new("python3")
            .arg(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/mask_agent.py"))
            .arg(address.port().to_string())
            .args([file("warm_coffee.json"), file("laser_lab.json")])
            .env("PYTHONDONTWRITEBYTECODE", "1")
            .output()
            .unwrap()
    });
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let result: Value = serde_json::from_slice(&output.stdout).unwrap();
    println!("{result}");
    assert_eq!(result["goals"], Value::from(vec![true; 3]));
    assert!(result["masks"].as_u64().unwrap() >= 10);
    assert_eq!(result["nothing"], "InvalidObjectClass");
    assert_eq!(result["third"], serde_json::json!([false, "two"]));
    assert!(result["relaunched"].as_array().unwrap().contains(&Value::from(false)));
    assert_eq!((&result["carried_on"], &result["again"][0]), (&Value::from(true), &Value::from(false)));
    assert_eq!(result["second"], "ActionSuccessful");
    assert_eq!(folder.logs().len(), 4);
}
