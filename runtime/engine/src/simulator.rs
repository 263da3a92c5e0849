//! The simulator of one session in real time.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::{Duration, Instant, SystemTime, UNIX_EPOCH},
};

use cohabit_bus::{Transport, monotonic_nanos};
use cohabit_render::MeshLibrary;
use cohabit_world::{DT_NANOS, World};

use crate::{
    build::SessionPlan,
    engine::{Engine, EngineError},
    scene::Moment,
    studio::{Desk, Studio},
};

/// Ticks between two greetings of peers that joined late.
const GREET_EVERY: u64 = 15;

/// A world in real time, with its cameras.
pub struct Simulator {
    engine: Engine,
    studio: Studio,
}

impl Simulator {
    /// Connects a plan's world to `bus`; `threads` render.
    ///
    /// # Errors
    /// [`EngineError`].
    pub fn new(
        plan: &SessionPlan,
        world: World,
        meshes: Arc<MeshLibrary>,
        threads: usize,
        bus: &dyn Transport,
    ) -> Result<Self, EngineError> {
        let studio = Studio::new(meshes, Arc::clone(&plan.layout), threads, bus)?;
        Ok(Self { engine: Engine::new(plan, world, bus)?, studio })
    }

    /// Ticks 60 times a second until `stop`.
    ///
    /// # Errors
    /// [`EngineError`].
    pub fn run(self, stop: &AtomicBool) -> Result<(), EngineError> {
        let Self { mut engine, studio } = self;
        let desk = Desk::default();
        thread::scope(|scope| {
            let cameras = scope.spawn(|| studio.run(&desk));
            let ticked = tick_until(&mut engine, &desk, stop, || cameras.is_finished());
            desk.close();
            let shot = cameras.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            ticked.and(shot.map_err(EngineError::from))
        })
    }
}

fn tick_until(
    engine: &mut Engine,
    desk: &Desk,
    stop: &AtomicBool,
    cameras_gone: impl Fn() -> bool,
) -> Result<(), EngineError> {
    let mut pace = Pace::new();
    while !stop.load(Ordering::Relaxed) && !cameras_gone() {
        engine.tick(wall_nanos())?;
        if engine.world().tick().is_multiple_of(GREET_EVERY) {
            engine.greet()?;
        }
        desk.leave(Moment::capture(engine, monotonic_nanos()));
        pace.wait();
    }
    Ok(())
}

/// Keeps ticks at their times. A tick that comes late is made up for, up to a limit; beyond it time is lost, and said.
struct Pace {
    next: Instant,
}

const TICK: Duration = Duration::from_nanos(DT_NANOS);
const MOST_MADE_UP: Duration = Duration::from_millis(250);

impl Pace {
    fn new() -> Self {
        Self { next: Instant::now() }
    }

    fn wait(&mut self) {
        self.next += TICK;
        let now = Instant::now();
        if let Some(early) = self.next.checked_duration_since(now) {
            thread::sleep(early);
        } else if now - self.next > MOST_MADE_UP {
            tracing::warn!(
                "the machine is too slow: {} ms of simulated time were dropped",
                (now - self.next).as_millis()
            );
            self.next = now;
        }
    }
}

fn wall_nanos() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    u64::try_from(since.as_nanos()).unwrap_or(u64::MAX)
}
