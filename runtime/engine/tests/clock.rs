//! How time goes by: the world stands still, steps, goes on; in lock-step it waits for those who attend.

#![allow(clippy::unwrap_used)]

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use cohabit_agent::Client;
use cohabit_bus::{
    CameraId, Inbox, Local, Sample, Topic, Transport,
    message::{self, Control, ControlMessage, EventKind, EventMessage, FrameView, StateView},
};
use cohabit_cdf::{Action, BodyRequest, Catalog, Status, mission};
use cohabit_engine::{SessionPlan, Simulator};
use cohabit_render::{CpuRenderer, MeshLibrary};

/// Nothing takes that long.
const WATCHDOG: Duration = Duration::from_secs(60);
/// What a world would do by itself, it would have done by then.
const A_WHILE: Duration = Duration::from_millis(60);

fn plan(bodies: &[&str]) -> SessionPlan {
    let (file, text) = mission::builtin()[0];
    let bodies: Vec<BodyRequest> = bodies.iter().map(|text| text.parse().unwrap()).collect();
    SessionPlan::new(file, text, Arc::new(Catalog::builtin()), 3).unwrap().with_bodies(bodies)
}

/// Runs a simulator, which begins standing still if `paused`, while `play` does something with it.
fn with_simulator(plan: &SessionPlan, paused: bool, play: impl FnOnce(&Local)) {
    let bus = Local::new(1);
    let meshes = Arc::new(MeshLibrary::build(&plan.catalog).unwrap());
    let renderer = Box::new(CpuRenderer::new(1));
    let simulator = Simulator::new(plan, plan.build().unwrap(), meshes, renderer, &bus).unwrap();
    let stop = AtomicBool::new(false);
    thread::scope(|scope| {
        let running = scope.spawn(|| simulator.starting(1.0, paused).run(&stop));
        let played = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| play(&bus)));
        stop.store(true, Ordering::Relaxed);
        running.join().unwrap().unwrap();
        if let Err(panic) = played {
            std::panic::resume_unwind(panic);
        }
    });
}

/// Waits for what `find` makes of one of the messages.
fn wait<T>(inbox: &mut Inbox, find: impl Fn(&Sample) -> Option<T>) -> T {
    let began = Instant::now();
    while began.elapsed() < WATCHDOG {
        while let Some((_, found)) = inbox.next(|sample| Ok(find(sample))).unwrap() {
            if let Some(found) = found {
                return found;
            }
        }
        thread::sleep(Duration::from_millis(1));
    }
    panic!("nothing came");
}

fn event(sample: &Sample, kind: EventKind) -> Option<EventMessage> {
    message::read::<EventMessage>(sample.payload()).ok().filter(|event| event.kind() == Some(kind))
}

fn ask(bus: &Local, control: Control) {
    bus.publisher(Topic::Control).unwrap().send_record(0, &ControlMessage::from(control)).unwrap();
}

/// The tick of a state, if the world is `paused` in it as asked.
fn tick_if(sample: &Sample, paused: bool) -> Option<u64> {
    let state = StateView::new(sample.payload()).unwrap();
    (state.header.paused == u32::from(paused)).then_some(sample.envelope().tick)
}

#[test]
fn the_world_stands_still_steps_and_goes_on() {
    with_simulator(&plan(&[]), true, |bus| {
        thread::sleep(A_WHILE);
        // Who joins late sees the world as it stands.
        let mut states = Inbox::new(bus, Topic::State).unwrap();
        assert_eq!(wait(&mut states, |sample| tick_if(sample, true)), 0);
        let mut frames = Inbox::new(bus, Topic::Frames(CameraId::Egocentric(0))).unwrap();
        wait(&mut frames, |sample| FrameView::new(sample.payload()).ok().map(drop));
        ask(bus, Control::Step(5));
        assert_eq!(wait(&mut states, |sample| tick_if(sample, true).filter(|tick| *tick > 0)), 5);
        thread::sleep(A_WHILE);
        assert!(states.next(|sample| Ok(tick_if(sample, true))).unwrap().is_none_or(|(_, tick)| tick == Some(5)));
        ask(bus, Control::Speed(4.0));
        ask(bus, Control::Resume);
        assert!(wait(&mut states, |sample| tick_if(sample, false).filter(|tick| *tick > 20)) > 20);
        ask(bus, Control::Pause);
        let stands = wait(&mut states, |sample| tick_if(sample, true).filter(|tick| *tick > 20));
        thread::sleep(A_WHILE);
        assert!(states.next(|sample| Ok(sample.envelope().tick)).unwrap().is_none_or(|(_, tick)| tick == stands));
        let mut events = Inbox::new(bus, Topic::Events).unwrap();
        let said = wait(&mut events, |sample| {
            event(sample, EventKind::Clock).filter(|event| event.text.as_str().contains("real time"))
        });
        assert_eq!(said.text.as_str(), "4 times real time");
    });
}

#[test]
fn a_body_obeys_one_at_a_time() {
    with_simulator(&plan(&[]), false, |bus| {
        let turn = Action::Rotate { yaw_rad: 0.2 };
        let (mut one, mut other) = (Client::join(bus, 0, "one").unwrap(), Client::join(bus, 0, "other").unwrap());
        let end = |client: &mut Client, command| client.outcome(command, WATCHDOG).unwrap().unwrap();
        let unclaimed = one.act(0, turn).unwrap();
        let refused = end(&mut one, unclaimed);
        assert!(refused.status == Status::InvalidCommand && refused.detail.contains("claimed first"), "{refused:?}");
        let claim = one.claim(false).unwrap();
        assert_eq!(end(&mut one, claim).status, Status::ActionSuccessful);
        let act = one.act(0, turn).unwrap();
        assert_eq!(end(&mut one, act).status, Status::ActionSuccessful);
        assert!(one.commands_body());
        let claim = other.claim(false).unwrap();
        let refused = end(&mut other, claim);
        assert!(refused.status == Status::InvalidCommand && refused.detail.contains("the one"), "{refused:?}");
        let take_over = other.claim(true).unwrap();
        assert!(end(&mut other, take_over).detail.contains("took body 0 over from the one"));
        let act = one.act(0, turn).unwrap();
        assert!(end(&mut one, act).detail.contains("the other commands body 0"));
        assert!(!one.commands_body());
        // Whoever goes hands back what it took.
        drop(other);
        let began = Instant::now();
        while !one.commands_body() && began.elapsed() < WATCHDOG {
            one.sleep(Duration::from_millis(10)).unwrap();
            while one.event().unwrap().is_some() {}
        }
        let act = one.act(0, turn).unwrap();
        assert_eq!(end(&mut one, act).status, Status::ActionSuccessful);
    });
}

#[test]
fn in_lock_step_the_world_waits() {
    with_simulator(&plan(&["robot"]).in_lock_step(2), false, |bus| {
        let mut clients = [0, 1].map(|body| Client::join(bus, body, "test").unwrap());
        let turn = |client: &mut Client| client.wait_for_turn(WATCHDOG).unwrap().unwrap();
        clients[0].attend(None).unwrap();
        assert_eq!(turn(&mut clients[0]), 0);
        clients[0].ready(1).unwrap();
        // It does not begin before all are there.
        assert_eq!(clients[0].wait_for_turn(A_WHILE).unwrap(), None);
        clients[1].attend(None).unwrap();
        assert_eq!(turn(&mut clients[1]), 0);
        assert_eq!(clients[0].wait_for_turn(A_WHILE).unwrap(), None);
        clients[1].ready(1).unwrap();
        assert_eq!(clients.each_mut().map(turn), [1, 1]);
        // One rests for long, the other goes on tick by tick.
        clients[0].ready(1000).unwrap();
        for tick in 2..10 {
            clients[1].ready(1).unwrap();
            assert_eq!(turn(&mut clients[1]), tick);
        }
        // Its turn comes with what comes of its command, before that.
        clients[0].claim(false).unwrap();
        let command = clients[0].act(0, Action::Rotate { yaw_rad: 0.3 }).unwrap();
        clients[1].leave().unwrap();
        let ended = turn(&mut clients[0]);
        assert!((10..200).contains(&ended), "{ended}");
        assert_eq!(clients[0].outcome(command, WATCHDOG).unwrap().unwrap().tick, ended);
    });
}

#[test]
fn in_lock_step_no_speed_counts_and_that_is_said() {
    with_simulator(&plan(&[]).in_lock_step(1), false, |bus| {
        let mut events = Inbox::new(bus, Topic::Events).unwrap();
        ask(bus, Control::Speed(2.0));
        let said = wait(&mut events, |sample| event(sample, EventKind::Clock));
        assert!(said.text.as_str().contains("in lock-step"), "{}", said.text.as_str());
    });
}

#[test]
fn in_lock_step_frames_belong_to_the_turn() {
    with_simulator(&plan(&[]).in_lock_step(1), false, |bus| {
        let mut client = Client::join(bus, 0, "test").unwrap();
        let mut frames = bus.subscriber(Topic::Frames(CameraId::Egocentric(0))).unwrap();
        client.attend(None).unwrap();
        for turn in 0..5 {
            assert_eq!(client.wait_for_turn(WATCHDOG).unwrap(), Some(3 * turn));
            assert_eq!(frames.latest().unwrap().unwrap().envelope().tick, 3 * turn);
            client.ready(3).unwrap();
        }
    });
}

#[test]
fn in_lock_step_who_hangs_does_nothing_and_is_counted() {
    with_simulator(&plan(&["robot"]).in_lock_step(2), false, |bus| {
        let mut events = Inbox::new(bus, Topic::Events).unwrap();
        let (mut lives, mut hangs) = (Client::join(bus, 0, "test").unwrap(), Client::join(bus, 1, "test").unwrap());
        lives.attend(None).unwrap();
        hangs.attend(Some(Duration::from_millis(1))).unwrap();
        for tick in 0..20 {
            assert_eq!(lives.wait_for_turn(WATCHDOG).unwrap(), Some(tick));
            lives.ready(1).unwrap();
        }
        let counts: Vec<i64> =
            (0..10).map(|_| wait(&mut events, |sample| event(sample, EventKind::TimedOut)).number).collect();
        assert_eq!(counts, (1..=10).collect::<Vec<_>>());
        // It was forgotten then, and is waited for again as soon as it attends again.
        assert!(events.next(|sample| Ok(event(sample, EventKind::TimedOut))).unwrap().is_none_or(|(_, e)| e.is_none()));
        while hangs.turn().unwrap().is_some() {}
        hangs.attend(None).unwrap();
        let tick = hangs.wait_for_turn(WATCHDOG).unwrap().unwrap();
        hangs.ready(1).unwrap();
        assert!(tick >= 19, "{tick}");
    });
}
