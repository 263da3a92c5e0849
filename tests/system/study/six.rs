//! The whole of it: six people in browsers, two at a time. One reloads, one loses the network, one withdraws; the dialog service of a session is
//! killed, and later the study's server. All others end in the conditions that they were assigned, with all of their data.

use std::{
    collections::BTreeMap,
    fs,
    path::Path,
    thread,
    time::{Duration, Instant},
};

use cohabit_tests::{Browser, Tab, files, run};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::json;

use super::{
    Server, WATCHDOG,
    pages::{go_on, heading},
    processes, study,
};
use crate::COHABIT;

/// Somebody who signs up and agrees, up to where their first mission can begin.
fn enter(browser: &Browser, server: &Server) -> Tab {
    let mut tab = browser.open(&format!("http://{}{}", server.host, server.sign_up), 1280, 800).unwrap();
    go_on(&mut tab, "I have read this");
    tab.wait_until("document.querySelectorAll('.check input').length === 3").unwrap();
    tab.evaluate("document.querySelectorAll('.check input:required').forEach((box) => box.click())").unwrap();
    go_on(&mut tab, "I agree to take part");
    tab.wait_until(&heading("Your next mission")).unwrap();
    tab
}

/// Begins the mission that is next, and waits until it could be skipped.
fn begin(tab: &mut Tab) {
    go_on(tab, "Begin");
    may_skip(tab);
}

fn may_skip(tab: &mut Tab) {
    let is_there = "document.querySelector('iframe.session') !== null && !document.querySelector('.offer').hidden";
    tab.wait_until(is_there).unwrap();
}

/// Skips the mission that is played, and answers what is asked about it.
fn skip(tab: &mut Tab) {
    tab.evaluate("document.querySelector('#skip').click()").unwrap();
    tab.wait_until("document.querySelector('#skip-card').open").unwrap();
    tab.evaluate("document.querySelector('#skip-now').click()").unwrap();
    tab.wait_until("document.querySelectorAll('.item').length === 2").unwrap();
    tab.evaluate("document.querySelectorAll('.places input')[3].click()").unwrap();
    go_on(tab, "Send and go on");
    tab.wait_until("document.querySelectorAll('.item').length === 0").unwrap();
}

/// The second mission, and all that follows it.
fn finish(tab: &mut Tab) {
    tab.wait_until(&heading("Your next mission")).unwrap();
    begin(tab);
    skip(tab);
    tab.wait_until(&heading("A break")).unwrap();
    go_on(tab, "Go on now");
    tab.wait_until(&heading("Thank you")).unwrap();
    tab.wait_until("document.querySelector('.code')?.textContent === 'DONE-42'").unwrap();
}

/// What everybody was assigned: between participants, and the order within.
fn assigned(server: &Server) -> BTreeMap<String, [String; 2]> {
    let overview = server.get(&format!("{}/state", server.experimenter));
    let rows = overview["participants"].as_array().unwrap().clone();
    let of = |row: serde_json::Value| {
        (row["participant"].as_str().unwrap().to_owned(), ["between", "order"].map(|part| row[part].to_string()))
    };
    rows.into_iter().map(of).collect()
}

fn wait_for(what: &str, mut is_so: impl FnMut() -> bool) {
    let deadline = Instant::now() + WATCHDOG;
    while !is_so() {
        assert!(Instant::now() < deadline, "waited in vain: {what}");
        thread::park_timeout(Duration::from_millis(50));
    }
}

/// Kills the dialog service of a participant's session, and waits until there is another one.
fn kill_dialog(server: &Server, participant: &str) {
    let session = format!("\0--session\0s{}-{participant}-", server.child.id());
    let services = || processes("\0dialog\0", &session);
    wait_for("a dialog service", || !services().is_empty());
    let before = services();
    for pid in &before {
        kill_process(Pid::from_raw(*pid).unwrap(), Signal::KILL).unwrap();
    }
    wait_for("another dialog service", || services().iter().any(|pid| !before.contains(pid)));
}

#[test]
#[cfg_attr(not(browser), ignore = "needs a browser")]
fn six_people_end_in_the_conditions_they_were_assigned_whatever_happens() {
    let scratch = study("study-six");
    let text = fs::read_to_string(scratch.path("study.toml")).unwrap();
    let _ = scratch.write("study.toml", &text.replacen("participants = 4", "participants = 6", 1));
    let server = Server::start(&scratch, "0");
    let browser = Browser::start().unwrap();
    let mut known = BTreeMap::new();

    // One reloads, and the dialog service of the other one is killed.
    let (mut first, mut second) = (enter(&browser, &server), enter(&browser, &server));
    known.extend(assigned(&server));
    begin(&mut first);
    begin(&mut second);
    first.call("Page.reload", &json!({})).unwrap();
    may_skip(&mut first);
    kill_dialog(&server, "P02");
    may_skip(&mut second);
    for tab in [&mut first, &mut second] {
        skip(tab);
        finish(tab);
    }
    drop((first, second));

    // One loses the network, and the other one withdraws.
    let (mut third, mut fourth) = (enter(&browser, &server), enter(&browser, &server));
    known.extend(assigned(&server));
    begin(&mut third);
    begin(&mut fourth);
    third.call("Network.enable", &json!({})).unwrap();
    let network = |tab: &mut Tab, is_lost: bool| {
        let conditions = json!({ "offline": is_lost, "latency": 0, "downloadThroughput": -1, "uploadThroughput": -1 });
        tab.call("Network.emulateNetworkConditions", &conditions).unwrap();
        tab.wait_until(&format!("document.querySelector('#offline').hidden === {}", !is_lost)).unwrap();
    };
    network(&mut third, true);
    fourth.evaluate("document.querySelector('#leave').click()").unwrap();
    fourth.wait_until("document.querySelector('#leave-card').open").unwrap();
    fourth.evaluate("document.querySelector('#leave-now').click()").unwrap();
    fourth.wait_until(&heading("You have left the study")).unwrap();
    network(&mut third, false);
    may_skip(&mut third);
    skip(&mut third);
    finish(&mut third);
    drop((third, fourth));

    // The study's server is killed while two play, and goes on.
    let (mut fifth, mut sixth) = (enter(&browser, &server), enter(&browser, &server));
    known.extend(assigned(&server));
    begin(&mut fifth);
    begin(&mut sixth);
    let port = server.port().to_owned();
    server.signal(Signal::KILL);
    drop(server);
    fifth.wait_until("!document.querySelector('#offline').hidden").unwrap();
    let server = Server::start(&scratch, &port);
    for tab in [&mut fifth, &mut sixth] {
        tab.wait_until("document.querySelector('#offline').hidden").unwrap();
        may_skip(tab);
        skip(tab);
        finish(tab);
    }
    drop((fifth, sixth, browser));

    // Everybody is where they were assigned to be, but for the one who withdrew.
    let gone = known.remove("P04");
    assert!(gone.is_some() && known.len() == 5, "{known:?}");
    let now = assigned(&server);
    for (participant, conditions) in &known {
        assert_eq!(now.get(participant), Some(conditions), "{participant}");
    }
    wait_for("P04 to be gone", || !fs::exists(scratch.path("data/journals/P04.jsonl")).unwrap());
    server.end();

    // All data are there, and none of who withdrew but that they did.
    let [data, out] = ["data", "tables"].map(|name| scratch.path(name));
    let left = files(Path::new(&data));
    let of_fourth: Vec<_> = left.keys().filter(|path| path.to_string_lossy().contains("P04")).collect();
    assert!(of_fourth.is_empty(), "{of_fourth:?}");
    let done = run(COHABIT, &["study", "export", "--folder", &data, "--out", &out]).unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let table = |name: &str| fs::read_to_string(format!("{out}/{name}.csv")).unwrap();
    assert_eq!((table("missions").lines().count(), table("answers").lines().count()), (1 + 5 * 2, 1 + 5 * 2));
    let participants = table("participants");
    assert_eq!(participants.matches(",finished,").count(), 5, "{participants}");
    assert!(participants.contains("P04,,,,withdrawn"), "{participants}");
    for name in ["missions", "answers", "sessions", "turns", "actions"] {
        assert!(!table(name).contains("P04"), "{name}: {}", table(name));
    }
    for participant in known.keys() {
        assert!(Path::new(&format!("{data}/consent/{participant}.json")).is_file(), "{participant}");
        let sessions = table("sessions").lines().filter(|line| line.starts_with(&format!("{participant}-"))).count();
        assert!(sessions >= 2, "{participant}: {}", table("sessions"));
    }
}
