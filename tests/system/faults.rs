//! Processes killed at any moment: nothing is lost but they, and nothing is left of them.
//!
//! Two hundred rounds with counts, two sessions at a time:
//! `cargo test -p cohabit --test system -- --ignored --nocapture faults::many_rounds`
//! (`COHABIT_ROUNDS` and `COHABIT_SEED` say how many others, and which).

mod garbage;
mod memory;
mod person;
mod round;
mod witness;

use std::{
    env,
    sync::atomic::{AtomicUsize, Ordering},
    thread,
    time::{SystemTime, UNIX_EPOCH},
};

use cohabit_bus::{CameraId, Session, Shm, Topic, Transport as _};
use cohabit_tests::{Page, Play, run};
use person::Person;
use round::{Counts, Dice, Plan};
use rustix::process::Signal;
use witness::Witness;

use crate::COHABIT;

/// The seed that was asked for, or the clock's; printed, so that what failed can be tried again.
fn seed() -> u64 {
    let asked = env::var("COHABIT_SEED").ok().and_then(|text| text.parse().ok());
    let seed = asked.unwrap_or_else(|| SystemTime::now().duration_since(UNIX_EPOCH).unwrap().subsec_nanos().into());
    eprintln!("COHABIT_SEED={seed}");
    seed
}

/// Plays so many rounds, so many sessions at a time.
fn play(seed: u64, rounds: usize, at_once: usize) -> Counts {
    let next = AtomicUsize::new(0);
    thread::scope(|scope| {
        let worker = || {
            let mut counts = Counts::default();
            loop {
                let number = next.fetch_add(1, Ordering::Relaxed);
                if number >= rounds {
                    return counts;
                }
                let plan = Plan::draw(number, &mut Dice::new(seed, number));
                counts.note(number, &plan, plan.play());
            }
        };
        let workers: Vec<_> = (0..at_once).map(|_| scope.spawn(worker)).collect();
        workers.into_iter().map(|worker| worker.join().unwrap()).fold(Counts::default(), Counts::and)
    })
}

#[test]
fn a_process_that_hangs_slows_nobody_and_carries_on_when_it_wakes() {
    for role in ["agent", "dialog", "record"] {
        let play = Play::start(COHABIT, &["cold_soda", "--seed", "5"]).unwrap();
        let witness = Witness::new(&play.session).unwrap();
        let mut person = Person::at(play.authority()).unwrap();
        person.ask_for_work().unwrap();
        play.send(role, Signal::STOP).unwrap();
        // The world goes on: it is not asked how fast.
        witness.wait_for(witness.newest() + 120).unwrap();
        play.send(role, Signal::CONT).unwrap();
        person.have_done().unwrap();
        person.ask("what are you holding?", 1).unwrap();
        let seen = witness.end().unwrap();
        let play = play.end().unwrap();
        let log = round::check_log(&play.log).unwrap();
        assert!(log.ticks.last().unwrap().tick >= seen, "{role}");
        assert!(log.events.iter().filter(|entry| entry.kind == "Started").count() >= 4, "{role}");
    }
}

#[test]
fn a_question_outlives_who_asked_it() {
    let play = Play::start(COHABIT, &[]).unwrap();
    let mut person = Person::at(play.authority()).unwrap();
    person.page.do_and_wait("go to the lab").unwrap();
    let asked = person.page.chat.last().cloned().unwrap();
    assert!(asked.1.contains('?'), "{asked:?}");
    play.send("dialog", Signal::KILL).unwrap();
    while person.page.next_message().is_ok() {}
    person.page = person.open().unwrap();
    person.ask("the robotics lab", 1).unwrap();
    assert!(person.page.chat.contains(&asked), "{:?}", person.page.chat);
    let arrived = |page: &Page| page.state["robot"]["room"] == "Lab1";
    person.page.wait("the robot in the lab", |page, _| arrived(page)).unwrap();
    play.end().unwrap();
}

#[test]
fn what_was_seen_outlives_who_remembers_it() {
    let play = Play::start(COHABIT, &["make_cereal"]).unwrap();
    let mut person = Person::at(play.authority()).unwrap();
    for sentence in ["look around", "go to the hallway", "where is the time machine?"] {
        person.page.do_and_wait(sentence).unwrap();
    }
    let answered = |page: &Page| page.chat.iter().filter(|(_, text)| text.contains("is in the break room")).count();
    assert_eq!(answered(&person.page), 1, "{:?}", person.page.chat);
    play.send("dialog", Signal::KILL).unwrap();
    while person.page.next_message().is_ok() {}
    person.page = person.open().unwrap();
    person.page.wait("the past", |page, _| page.state.is_object()).unwrap();
    person.page.say("where is the time machine?").unwrap();
    person.page.wait("the same answer", |page, _| answered(page) == 2).unwrap();
    play.end().unwrap();
}

#[test]
fn who_hangs_for_ever_keeps_no_session_from_ending() {
    let play = Play::start(COHABIT, &[]).unwrap();
    // Pages that are never read.
    let deaf: Vec<_> = (0..3).map(|_| Page::open(play.authority()).unwrap()).collect();
    let mut page = Page::open(play.authority()).unwrap();
    page.do_and_wait("turn left 90 degrees").unwrap();
    ["agent", "dialog"].iter().for_each(|role| play.send(role, Signal::STOP).unwrap());
    play.end().unwrap();
    drop(deaf);
}

#[test]
fn who_sends_nonsense_is_cut_off_and_nobody_else_is_harmed() {
    let mut play = Play::start(COHABIT, &["cold_soda", "--seed", "5"]).unwrap();
    let witness = Witness::new(&play.session).unwrap();
    let bus = Shm::join(&Session::new(&play.session).unwrap()).unwrap();
    let camera = CameraId::Spectator(0);
    let topics = [Topic::Commands, Topic::Control, Topic::Dialog, Topic::Events, Topic::Ticks, Topic::State];
    let mut dice = Dice::new(seed(), 0);
    // What a publisher has sent may go with it.
    let mut publishers = Vec::new();
    for topic in topics.into_iter().chain([Topic::Pulses, Topic::Steps, Topic::Mission, Topic::Frames(camera)]) {
        let mut publisher = bus.publisher(topic).unwrap();
        for _ in 0..20 {
            let length = usize::try_from(dice.below(120)).unwrap();
            publisher.send(dice.below(u64::MAX), length, &mut |bytes| bytes.fill_with(|| dice.byte())).unwrap();
        }
        publishers.push(publisher);
    }
    let mut person = Person::at(play.authority()).unwrap();
    person.ask_for_work().unwrap();
    person.have_done().unwrap();
    play.wait_for_line("sent nonsense on topic `commands`").unwrap();
    let seen = witness.end().unwrap();
    drop((publishers, bus));
    let play = play.end().unwrap();
    assert!(round::check_log(&play.log).unwrap().ticks.last().unwrap().tick >= seen);
    let said = play.said();
    assert!(!said.contains("starting it again"), "{said}");
}

#[test]
fn a_peer_of_another_version_says_so_and_nobody_notices() {
    let play = Play::start(COHABIT, &[]).unwrap();
    let version = Session::new(&play.session).unwrap().folder().join("version");
    let spoken = std::fs::read_to_string(&version).unwrap();
    std::fs::write(&version, "4000000000").unwrap();
    for role in ["agent", "dialog", "sim"] {
        let joined = run(COHABIT, &[role, "--session", &play.session]).unwrap();
        let said = String::from_utf8_lossy(&joined.stderr).into_owned();
        assert_eq!(joined.status.code(), Some(4), "{role}: {said}");
        assert!(said.contains("version 4000000000") && said.contains("use the build"), "{role}: {said}");
    }
    std::fs::write(&version, spoken).unwrap();
    let mut page = Page::open(play.authority()).unwrap();
    page.do_and_wait("turn left").unwrap();
    play.end().unwrap();
}

#[test]
fn a_process_killed_at_any_moment_costs_nothing_but_itself() {
    let counts = play(seed(), 10, 1);
    assert!(counts.failures.is_empty(), "{counts}");
    eprintln!("{counts}");
}

#[test]
#[ignore = "takes a quarter of an hour"]
fn many_rounds() {
    let rounds = env::var("COHABIT_ROUNDS").ok().and_then(|text| text.parse().ok()).unwrap_or(200);
    let counts = play(seed(), rounds, 2);
    eprintln!("{counts}");
    assert!(counts.failures.is_empty());
}
