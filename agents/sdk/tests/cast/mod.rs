//! A session in lock-step with agents, played for so many ticks.

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::{
        Arc, OnceLock,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use cohabit_agent::Agent;
use cohabit_bus::{
    Topic, Transport, Wake,
    message::{self, DialogView, EventKind, EventMessage, StateView, TickView},
};
use cohabit_cdf::{BodyRequest, Catalog, Status, mission};
use cohabit_engine::{SessionPlan, Simulator};
use cohabit_render::{CpuRenderer, MeshLibrary};

/// What a session is watched for.
#[derive(Default)]
pub struct Played {
    /// Of each tick, from 1.
    pub digests: BTreeMap<u64, [u8; 32]>,
    pub outcomes: Vec<Ended>,
    /// What was said, and by whom.
    pub said: Vec<(u32, String)>,
    /// The rooms that each body was seen in.
    pub rooms: BTreeMap<u32, BTreeSet<u32>>,
    /// Turns that ran out of time.
    pub timeouts: usize,
}

/// A command that came to its end.
#[derive(Clone, Debug)]
pub struct Ended {
    pub tick: u64,
    pub body: u32,
    pub status: Status,
    pub detail: String,
}

/// A mission with bodies beside its own.
pub fn plan(mission: usize, seed: u64, bodies: &[&str]) -> SessionPlan {
    let (file, text) = mission::builtin()[mission];
    let bodies: Vec<BodyRequest> = bodies.iter().map(|text| text.parse().unwrap()).collect();
    SessionPlan::new(file, text, catalog(), seed).unwrap().with_bodies(bodies)
}

pub fn catalog() -> Arc<Catalog> {
    static CATALOG: OnceLock<Arc<Catalog>> = OnceLock::new();
    Arc::clone(CATALOG.get_or_init(|| Arc::new(Catalog::builtin())))
}

fn meshes() -> Arc<MeshLibrary> {
    static MESHES: OnceLock<Arc<MeshLibrary>> = OnceLock::new();
    Arc::clone(MESHES.get_or_init(|| Arc::new(MeshLibrary::build(&catalog()).unwrap())))
}

/// The simulator of a plan.
pub fn simulator(plan: &SessionPlan, bus: &dyn Transport) -> Simulator {
    let renderer = Box::new(CpuRenderer::new(1));
    Simulator::new(plan, plan.build().unwrap(), meshes(), renderer, bus).unwrap()
}

/// Plays until a tick with these agents in threads of their own, and `others` elsewhere.
pub fn play(
    plan: SessionPlan,
    bus: &dyn Transport,
    agents: Vec<(u32, Box<dyn Agent + Send>)>,
    others: usize,
    until: u64,
) -> Played {
    let simulator = simulator(&plan.in_lock_step(agents.len() + others), bus);
    let stop = AtomicBool::new(false);
    thread::scope(|scope| {
        let mut watcher = Watcher::new(bus);
        let running = scope.spawn(|| simulator.run(&stop));
        for (body, mut agent) in agents {
            let stop = &stop;
            scope.spawn(move || cohabit_agent::run(&mut *agent, body, bus, stop).unwrap());
        }
        let played = watcher.watch(until, &|| running.is_finished());
        stop.store(true, Ordering::Relaxed);
        running.join().unwrap().unwrap();
        played
    })
}

struct Watcher {
    ticks: Box<dyn cohabit_bus::Subscriber>,
    events: Box<dyn cohabit_bus::Subscriber>,
    dialog: Box<dyn cohabit_bus::Subscriber>,
    states: Box<dyn cohabit_bus::Subscriber>,
    bell: Box<dyn cohabit_bus::Listener>,
}

impl Watcher {
    fn new(bus: &dyn Transport) -> Self {
        Self {
            ticks: bus.subscriber(Topic::Ticks).unwrap(),
            events: bus.subscriber(Topic::Events).unwrap(),
            dialog: bus.subscriber(Topic::Dialog).unwrap(),
            states: bus.subscriber(Topic::State).unwrap(),
            bell: bus.listener(Wake::State).unwrap(),
        }
    }

    fn watch(&mut self, until: u64, is_over: &dyn Fn() -> bool) -> Played {
        let mut played = Played::default();
        let began = Instant::now();
        while played.digests.last_key_value().is_none_or(|(tick, _)| *tick < until) {
            assert!(began.elapsed() < Duration::from_secs(900), "at tick {:?}", played.digests.keys().last());
            assert!(!is_over(), "the simulator has ended");
            self.bell.wait(Duration::from_millis(20)).unwrap();
            self.take_in(&mut played);
        }
        played.digests.retain(|tick, _| *tick <= until);
        assert_eq!(played.digests.len() as u64, until, "ticks were lost");
        played
    }

    fn take_in(&mut self, played: &mut Played) {
        if let Some(sample) = self.states.latest().unwrap() {
            for body in StateView::new(sample.payload()).unwrap().bodies {
                played.rooms.entry(body.body).or_default().insert(body.room);
            }
        }
        while let Some(sample) = self.events.receive().unwrap() {
            let event: EventMessage = message::read(sample.payload()).unwrap();
            let (tick, body, detail) = (sample.envelope().tick, event.body, event.text.as_str().to_owned());
            match (event.kind(), event.status()) {
                (Some(EventKind::Outcome), Some(status)) if !detail.contains("commands body") => {
                    played.outcomes.push(Ended { tick, body, status, detail });
                }
                (Some(EventKind::TimedOut), _) => played.timeouts += 1,
                _ => {}
            }
        }
        while let Some(sample) = self.dialog.receive().unwrap() {
            let view = DialogView::new(sample.payload()).unwrap();
            played.said.push((view.header.body, view.header.text.as_str().to_owned()));
        }
        while let Some(sample) = self.ticks.receive().unwrap() {
            let view = TickView::new(sample.payload()).unwrap();
            played.digests.insert(sample.envelope().tick, view.header.digest);
        }
    }
}
