//! Several bodies in one session: each has its own cameras, hand and outcomes, and a log replays them all.

#![allow(clippy::unwrap_used)]

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use cohabit_bus::{
    CameraId, Local, Subscriber, Topic, Transport,
    message::{self, CommandMessage, EventKind, EventMessage, FrameView, MissionMessage, StateView},
};
use cohabit_cdf::{Action, BodyKind, BodyRequest, Catalog, Status, mission};
use cohabit_engine::{SessionPlan, Simulator};
use cohabit_render::{CpuRenderer, MeshLibrary};

fn plan(bodies: &[&str]) -> SessionPlan {
    let (file, text) = mission::builtin()[0];
    let bodies: Vec<BodyRequest> = bodies.iter().map(|text| text.parse().unwrap()).collect();
    SessionPlan::new(file, text, Arc::new(Catalog::builtin()), 3).unwrap().with_bodies(bodies)
}

/// Waits for what `find` makes of one of the messages.
fn wait<T>(subscriber: &mut dyn Subscriber, find: impl Fn(&[u8]) -> Option<T>) -> T {
    let began = Instant::now();
    loop {
        while let Some(sample) = subscriber.receive().unwrap() {
            if let Some(found) = find(sample.payload()) {
                return found;
            }
        }
        assert!(began.elapsed() < Duration::from_secs(60), "nothing came");
        thread::sleep(Duration::from_millis(2));
    }
}

#[test]
fn each_body_has_its_own_cameras_and_outcomes() {
    let plan = plan(&["person@Lab1", "robot"]);
    let bus = Local::new(1);
    let meshes = Arc::new(MeshLibrary::build(&plan.catalog).unwrap());
    let simulator = Simulator::new(&plan, plan.build().unwrap(), meshes, Box::new(CpuRenderer::new(1)), &bus).unwrap();
    let mut mission = bus.subscriber(Topic::Mission).unwrap();
    let mut states = bus.subscriber(Topic::State).unwrap();
    let mut events = bus.subscriber(Topic::Events).unwrap();
    let mut eyes: Vec<_> =
        (0..3).map(|body| bus.subscriber(Topic::Frames(CameraId::Egocentric(body))).unwrap()).collect();
    let mut commands = bus.publisher(Topic::Commands).unwrap();
    let stop = AtomicBool::new(false);
    thread::scope(|scope| {
        let running = scope.spawn(|| simulator.run(&stop));
        let sent = wait(&mut *mission, |payload| MissionMessage::read(payload).ok());
        assert_eq!(sent.bodies, plan.bodies);
        let kinds = wait(&mut *states, |payload| {
            Some(StateView::new(payload).unwrap().bodies.iter().map(|body| body.kind).collect::<Vec<_>>())
        });
        assert_eq!(kinds, [BodyKind::Robot, BodyKind::Person, BodyKind::Robot].map(|kind| kind as u32));
        // Each eye sees from another place.
        let mut places: Vec<[u32; 3]> = eyes
            .iter_mut()
            .enumerate()
            .map(|(index, eye)| {
                wait(&mut **eye, |payload| {
                    let frame = FrameView::new(payload).unwrap();
                    assert_eq!(frame.header.body as usize, index);
                    Some(frame.header.position_m.map(f32::to_bits))
                })
            })
            .collect();
        places.sort_unstable();
        places.dedup();
        assert_eq!(places.len(), 3);
        for body in 0..3 {
            let action = Action::Rotate { yaw_rad: 0.3 };
            let command = u64::from(body) + 1;
            let claim = CommandMessage::claim(100 + command, body, "test", false);
            for message in [claim, CommandMessage::act(command, 0, body, action)] {
                commands.send_record(0, &message).unwrap();
            }
        }
        let mut done: Vec<_> = (0..3)
            .map(|_| {
                wait(&mut *events, |payload| {
                    let event: EventMessage = message::read(payload).unwrap();
                    let is_of_act = event.kind() == Some(EventKind::Outcome) && event.command < 100;
                    is_of_act.then_some((event.command, event.body, event.status()))
                })
            })
            .collect();
        done.sort_unstable_by_key(|(command, ..)| *command);
        let ok = Some(Status::ActionSuccessful);
        assert_eq!(done, [(1, 0, ok), (2, 1, ok), (3, 2, ok)]);
        stop.store(true, Ordering::Relaxed);
        running.join().unwrap().unwrap();
    });
}

#[test]
fn there_can_be_many() {
    let crowd = vec!["person"; 6].into_iter().chain(vec!["robot@Hallway"; 6]).collect::<Vec<_>>();
    let world = plan(&crowd).build().unwrap();
    assert_eq!(world.bodies().len(), 13);
    let full = plan(&["robot@SmallOffice"; 200]).build().err().unwrap().to_string();
    assert!(full.contains("no free place") && full.contains("small office"), "{full}");
}
