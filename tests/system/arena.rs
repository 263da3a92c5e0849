//! The simulator for existing clients, as a process of its own.

use std::{
    fs,
    io::{BufRead as _, BufReader, Read as _, Write as _},
    net::TcpStream,
    process::{Child, Command, Stdio},
};

use cohabit_tests::run;
use rustix::process::{Pid, Signal, kill_process};
use serde_json::{Value, json};

use crate::COHABIT;

/// Killed when dropped.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn send(client: &mut TcpStream, message: &str) {
    client.write_all(&u32::try_from(message.len()).unwrap().to_le_bytes()).unwrap();
    client.write_all(message.as_bytes()).unwrap();
}

fn receive(client: &mut TcpStream) -> Value {
    let mut length = [0; 4];
    client.read_exact(&mut length).unwrap();
    let mut bytes = vec![0; u32::from_le_bytes(length) as usize];
    client.read_exact(&mut bytes).unwrap();
    serde_json::from_slice(&bytes).unwrap()
}

#[test]
fn one_command_serves_existing_clients_and_leaves_a_log_that_replays() {
    let logs = std::env::temp_dir().join(format!("cohabit-arena-{}", std::process::id()));
    let mut child = Command::new(COHABIT)
        .args(["sim", "--arena-port", "0", "--renderer", "cpu", "--logs"])
        .arg(&logs)
        .stdout(Stdio::piped())
        .stdin(Stdio::null())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let mut running = Running(child);
    let line = lines.next().unwrap().unwrap();
    assert!(line.contains("ready"), "{line}");
    let address = line.split(['\u{20}', ';']).find(|word| word.starts_with("127.0.0.1:")).unwrap();
    let mut client = TcpStream::connect(address).unwrap();
    send(&mut client, include_str!("../../cdf/missions/warm_coffee.json"));
    send(&mut client, &json!([{"commandType": "GoTo", "goToCommand": {"officeRoom": "Lab1"}}]).to_string());
    let reply = receive(&mut client);
    assert_eq!(reply["lastActionSuccess"], "ActionSuccessful", "{}", reply["message"]);
    assert_eq!(reply["objects"][0]["currentRoom"], "Lab1");
    kill_process(Pid::from_raw(i32::try_from(running.0.id()).unwrap()).unwrap(), Signal::INT).unwrap();
    assert!(running.0.wait().unwrap().success());
    let log = fs::read_dir(&logs).unwrap().next().unwrap().unwrap().path();
    let replayed = run(COHABIT, &["replay", log.to_str().unwrap()]).unwrap();
    assert!(replayed.status.success(), "{replayed:?}");
    let _ = fs::remove_dir_all(logs);
}

#[test]
fn what_does_not_go_together_is_named() {
    let check = |code: i32, arguments: &[&str], part: &str| {
        let output = run(COHABIT, arguments).unwrap();
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(code), "{text}");
        assert!(text.contains(part), "{text}");
    };
    check(2, &["sim"], "--session");
    check(2, &["sim", "--arena-port", "0", "--session", "x"], "--session");
    check(2, &["sim", "--session", "x", "--logs", "y"], "cannot be used with '--logs");
    check(2, &["sim", "--logs", "y"], "--arena-port");
    check(2, &["sim", "/nowhere.json", "--arena-port", "0"], "/nowhere.json");
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    // That is the machine's matter.
    check(4, &["sim", "--arena-port", &port], "--arena-port");
}
