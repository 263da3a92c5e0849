//! A recorded session is gone through again: from its beginning, from any point of it, and on from there.

#![allow(clippy::unwrap_used)]

use std::{
    io::{self, Write},
    path::Path,
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::Duration,
};

use cohabit_bus::{
    Local, Publisher, Topic, Transport, Wake,
    message::{CommandMessage, FrameView, Plane},
};
use cohabit_cdf::{Action, BodyKind, Catalog, GoToTarget, mission};
use cohabit_engine::{
    CameraPlan, Engine, Replayer, SessionPlan, Simulator, Stills,
    replay::{Difference, movement, replay},
};
use cohabit_record::{Branch, Log, Recorder, SessionFacts, Stop, entry::hex};
use cohabit_render::{CpuRenderer, MeshLibrary};

const TICKS: u64 = 1500;
/// The first command that does something.
const FIRST: u64 = 20;

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

impl Memory {
    fn log(&self) -> Log {
        Log::parse(Path::new("a log"), &self.0.lock().unwrap()).unwrap()
    }
}

fn catalog() -> Arc<Catalog> {
    Arc::new(Catalog::builtin())
}

/// A session of a robot that takes the bowl and points it out, and a person who walks about.
fn recorded() -> Log {
    played().log()
}

fn played() -> Memory {
    let (file, text) = mission::builtin().iter().find(|(file, _)| file.contains("cereal")).unwrap();
    let plan = SessionPlan::new(file, text, catalog(), 3).unwrap();
    let plan = plan.with_bodies(vec!["person@BreakRoom".parse().unwrap()]);
    let world = plan.build().unwrap();
    let bowl = world.find("Bowl_01_1").or_else(|| world.find("Bowl_01_10000")).unwrap();
    let (bus, memory) = (Local::new(1), Memory::default());
    let recorder = Recorder::new(&bus).unwrap();
    let mut commands = bus.publisher(Topic::Commands).unwrap();
    let mut engine = Engine::new(&plan, world, &[], &bus).unwrap();
    let mut recording = recorder.begin_in(&SessionFacts::named("first"), Box::new(memory.clone())).unwrap();
    claim(&mut *commands);
    let target = GoToTarget::Object(bowl);
    for tick in 1..=TICKS {
        let deeds: &[(u32, Action)] = match tick {
            FIRST => &[(0, Action::GoTo { target })],
            400 => &[(0, Action::PickUp { object: bowl })],
            580 => &[(0, Action::Highlight { object: bowl })],
            700 => &[(0, Action::Rotate { yaw_rad: 2.0 })],
            _ if tick.is_multiple_of(15) => {
                &[(1, Action::Drive { forward_m_s: 0.8, turn_rad_s: 0.7, pitch_rad_s: 0.0 })]
            }
            _ => &[],
        };
        for (body, action) in deeds {
            commands.send_record(0, &CommandMessage::act(10 * tick, 0, *body, *action)).unwrap();
        }
        engine.tick(tick).unwrap();
        recording.take_down().unwrap();
        recording.flush().unwrap();
    }
    recording.finish().unwrap();
    memory
}

fn claim(commands: &mut dyn Publisher) {
    for body in 0..2 {
        commands.send_record(0, &CommandMessage::claim(1 + u64::from(body), body, "test", false)).unwrap();
    }
}

#[test]
fn a_session_comes_out_the_same_and_any_point_of_it_is_reached() {
    let log = recorded();
    assert_eq!((log.ticks.len() as u64, log.gaps.len(), log.missing()), (TICKS, 0, 0));
    assert_eq!(log.snapshots.iter().map(|snapshot| snapshot.tick).collect::<Vec<_>>(), [600, 1200]);
    let whole = replay(&log, catalog()).unwrap();
    assert_eq!((whole.difference, whole.ticks), (None, TICKS));

    // What is seen from there is the same, too, however one came there.
    let camera: CameraPlan = "a=third-person,size=96x54,planes=color+ids".parse().unwrap();
    let mut replayer = Replayer::new(&log, catalog()).unwrap();
    let bus = Local::new(1);
    let meshes = Arc::new(MeshLibrary::build(&replayer.plan().catalog).unwrap());
    let mut frames = bus.subscriber(Topic::Frames(camera.id)).unwrap();
    let mut stills =
        Stills::new(replayer.plan(), meshes, Box::new(CpuRenderer::new(1)), std::slice::from_ref(&camera), &bus)
            .unwrap();
    let mut picture = |replayer: &Replayer<'_>| {
        stills.shoot(replayer.visible(), camera.id, None).unwrap();
        let sample = frames.receive().unwrap().unwrap();
        let frame = FrameView::new(sample.payload()).unwrap();
        [Plane::Color, Plane::Ids].map(|plane| frame.plane(plane).unwrap().to_vec())
    };
    let points = [0, 1, 450, 599, 600, 601, 640, 1200, 1350, TICKS];
    let mut seen = vec![(replayer.world().digest(), picture(&replayer))];
    while let Some(replayed) = replayer.step() {
        if points.contains(&replayed.entry.tick) {
            seen.push((replayer.world().digest(), picture(&replayer)));
        }
    }
    for index in [9, 3, 4, 0, 6, 8, 2, 7, 5, 1, 9, 0] {
        replayer.go_to(points[index]).unwrap();
        let what = format!("tick {}", points[index]);
        assert_eq!(replayer.world().tick(), points[index]);
        assert_eq!(hex(&replayer.world().digest()), hex(&seen[index].0), "{what}");
        assert!(picture(&replayer) == seen[index].1, "{what} looks otherwise");
        assert_eq!(replayer.difference_here(), None, "{what}");
    }
    assert!(seen[6].1 != seen[5].1, "the bowl is outlined");
}

#[test]
fn behind_a_gap_it_goes_on_from_the_next_snapshot() {
    let mut log = recorded();
    log.ticks.retain(|entry| !(200..300).contains(&entry.tick));
    let gap = Difference::Missing { tick: 200, found: 300 };
    assert_eq!(gap.to_string(), "the log has no ticks 200 to 299");
    let found = replay(&log, catalog()).unwrap();
    assert_eq!((found.difference, found.gaps.as_slice()), (None, [gap.clone()].as_slice()));
    assert_eq!(found.ticks, 199 + TICKS - 600, "what is between the gap and the snapshot cannot be compared");
    // Without a snapshot there is nothing to go on from.
    log.snapshots.clear();
    assert_eq!(replay(&log, catalog()).unwrap().difference, Some(gap));
    // And a log that begins in the middle begins with the first snapshot.
    let mut late = recorded();
    late.ticks.retain(|entry| entry.tick > 100);
    assert_eq!(replay(&late, catalog()).unwrap().ticks, TICKS - 600);
    late.snapshots.clear();
    let error = replay(&late, catalog()).unwrap_err().to_string();
    assert!(error.contains("begins after tick 100 without a snapshot"), "{error}");
}

/// A log whose beginning is lost, session entry and all, is replayed by a copy of that entry, from a snapshot on.
#[test]
fn a_log_without_its_beginning_is_replayed() {
    let memory = played();
    let whole = memory.log();
    let bytes = memory.0.lock().unwrap().clone();
    let check = |bytes: &[u8], first: u64| {
        let log = Log::parse(Path::new("a log"), bytes).unwrap();
        assert_eq!(log.session, whole.session);
        assert_eq!(log.lost.len(), 1, "{:?}", log.problems());
        let found = replay(&log, catalog()).unwrap();
        assert_eq!((found.difference, found.span), (None, Some([first, TICKS])), "{:?}", log.problems());
    };
    // Its session entry alone: nothing of the session is missing.
    let mut changed = bytes.clone();
    changed[200] ^= 0x40;
    check(&changed, 1);
    // All of its first 10 %, zeroed or cut off: it goes on from the first snapshot.
    let gone = bytes.len() / 10;
    changed[..gone].fill(0);
    check(&changed, 601);
    check(&bytes[gone..], 601);
}

#[test]
fn nothing_is_said_of_ticks_that_are_not_compared() {
    let mut log = recorded();
    log.ticks.clear();
    let found = replay(&log, catalog()).unwrap();
    assert_eq!((found.ticks, found.span), (0, None));
    let mut log = recorded();
    log.ticks.swap(700, 900);
    let error = replay(&log, catalog()).unwrap_err().to_string();
    assert!(error.contains("not in their order: tick 702 follows tick 901"), "{error}");
    assert!(log.problems().iter().any(|problem| problem.contains("tick 702 follows tick 901")), "{:?}", log.problems());
    let mut twice = recorded();
    twice.ticks.insert(5, twice.ticks[5].clone());
    assert!(replay(&twice, catalog()).is_err());
}

#[test]
fn what_differs_is_named() {
    let log = recorded();
    // A command that was never given.
    let mut changed = log.clone();
    changed.ticks[FIRST as usize - 1].inputs.clear();
    let found = replay(&changed, catalog()).unwrap();
    let Some(Difference::Digest { tick, parts, things: Some((at, things)) }) = &found.difference else {
        panic!("{:?}", found.difference)
    };
    assert_eq!((*tick, *at), (FIRST, 600));
    assert!(parts.contains(&"bodies"), "{parts:?}");
    assert!(things.iter().any(|thing| thing.starts_with("body 0: place")), "{things:?}");
    assert!(things.iter().any(|thing| thing.starts_with("Bowl_01")), "{things:?}");
    let text = found.difference.unwrap().to_string();
    assert!(text.starts_with(&format!("tick {FIRST} differs in ")) && text.contains("snapshot of tick 600"), "{text}");
    // A digest that was never had, in one of its four parts.
    for (index, part) in ["objects", "bodies", "mission", "physics"].into_iter().enumerate() {
        let mut changed = log.clone();
        changed.ticks[799].digest.replace_range(16 * index..16 * index + 4, "zzzz");
        let found = replay(&changed, catalog()).unwrap().difference.unwrap();
        let nothing = Some((1200, Vec::new()));
        assert_eq!(found, Difference::Digest { tick: 800, parts: vec![part], things: nothing });
    }
}

#[test]
fn a_log_of_format_1_is_compared_by_its_own_digests() {
    let mut log = recorded();
    let mut replayer = Replayer::new(&log, catalog()).unwrap();
    let mut digests = Vec::new();
    while replayer.step().is_some() {
        digests.push(hex(&replayer.world().digest_as_one()));
    }
    log.session.format = 1;
    log.snapshots.clear();
    for (entry, digest) in log.ticks.iter_mut().zip(digests) {
        entry.digest = digest;
    }
    assert_eq!(replay(&log, catalog()).unwrap().difference, None);
    log.ticks[9].digest = "0".repeat(64);
    assert!(matches!(replay(&log, catalog()).unwrap().difference, Some(Difference::Digest { tick: 10, .. })));
}

#[test]
fn a_session_goes_on_live_from_any_point_of_another_one() {
    const AT: u64 = 650;
    let first = recorded();
    let mut replayer = Replayer::new(&first, catalog()).unwrap();
    replayer.go_to(AT).unwrap();
    let (plan, there) = (replayer.plan().clone(), replayer.world().digest());
    let (world, appearance) = replayer.into_parts();
    let (bus, stop) = (Local::new(1), AtomicBool::new(false));
    let path = std::env::temp_dir().join(format!("cohabit-branch-{}.mcap", std::process::id()));
    let _ = std::fs::remove_file(&path);
    let branched = Some(Branch { session: "first".to_owned(), run: first.session.run, tick: AT });
    let facts = SessionFacts { branched: branched.clone(), ..SessionFacts::named("second") };
    let recorder = Recorder::new(&bus).unwrap();
    let meshes = Arc::new(MeshLibrary::build(&plan.catalog).unwrap());
    let simulator = Simulator::new(&plan, world, meshes, Box::new(CpuRenderer::new(1)), &bus).unwrap();
    let simulator = simulator.appearing(appearance).starting(20.0, false);
    let ended = AtomicBool::new(false);
    thread::scope(|scope| {
        let recording = scope.spawn(|| recorder.run(&facts, &path, &stop, || {}).unwrap());
        let mut states = bus.subscriber(Topic::State).unwrap();
        let mut commands = bus.publisher(Topic::Commands).unwrap();
        let mut bell = bus.listener(Wake::State).unwrap();
        let running = scope.spawn(|| simulator.run(&ended).unwrap());
        claim(&mut *commands);
        let turn = CommandMessage::act(50, 0, 0, Action::Rotate { yaw_rad: -1.0 });
        commands.send_record(0, &turn).unwrap();
        let mut newest = 0;
        while newest < AT + 200 && !running.is_finished() {
            bell.wait(Duration::from_millis(100)).unwrap();
            while let Some(sample) = states.receive().unwrap() {
                newest = sample.envelope().tick;
            }
        }
        ended.store(true, Ordering::Relaxed);
        running.join().unwrap();
        stop.store(true, Ordering::Relaxed);
        recording.join().unwrap();
    });
    let second = Log::open(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    assert_eq!((&second.session.branched, second.ticks[0].tick), (&branched, AT + 1));
    let replayer = Replayer::new(&second, catalog()).unwrap();
    assert_eq!((replayer.world().tick(), replayer.world().digest()), (AT, there));
    let again = replay(&second, catalog()).unwrap();
    assert_eq!((again.difference, again.ticks), (None, second.ticks.len() as u64));
    assert!(again.ticks >= 200 && again.inputs >= 1, "{} ticks, {} inputs", again.ticks, again.inputs);
}

#[test]
fn a_session_tells_how_its_bodies_moved() {
    let log = recorded();
    let movement = movement(&log, catalog()).unwrap();
    assert_eq!(movement.problem, None);
    let kinds: Vec<BodyKind> = movement.trails.iter().map(|trail| trail.kind).collect();
    assert_eq!(kinds, [BodyKind::Robot, BodyKind::Person]);
    for trail in &movement.trails {
        let ticks: Vec<u64> = trail.stops.iter().map(|stop| stop.tick).collect();
        assert_eq!(ticks, (0..=TICKS).collect::<Vec<_>>());
    }
    // The robot was sent to the bowl, once.
    let travel = movement.travels.iter().find(|travel| travel.body == 0).unwrap();
    assert!(travel.success && travel.from == FIRST - 1 && travel.to > FIRST, "{travel:?}");
    let stops = &movement.trails[0].stops;
    let gone = |pair: &[Stop]| (pair[1].at_m[0] - pair[0].at_m[0]).hypot(pair[1].at_m[1] - pair[0].at_m[1]);
    let gone_m: f64 = stops[travel.from as usize..=travel.to as usize].windows(2).map(gone).sum();
    let shortest_m = travel.shortest_m.unwrap();
    assert!(shortest_m < gone_m + 0.1, "{shortest_m} m of {gone_m} m");
}
