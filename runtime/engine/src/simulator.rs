//! The simulator of one session in real time.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use cohabit_bus::{Transport, monotonic_nanos, wall_nanos};
use cohabit_render::{MeshLibrary, Renderer};
use cohabit_world::{DT_NANOS, World};

use crate::{
    build::SessionPlan,
    engine::{Engine, EngineError},
    scene::Moment,
    studio::{Desk, Studio},
};

/// Ticks between two greetings of peers that joined late.
const GREET_EVERY: u64 = 15;

/// The tick at which the shading of models that were not seen yet begins to be baked, so that none makes a frame late:
/// the first frames come first.
const BAKE_AT: u64 = 90;

/// A world in real time, with its cameras.
pub struct Simulator {
    engine: Engine,
    studio: Studio,
    meshes: Arc<MeshLibrary>,
}

impl Simulator {
    /// Connects a plan's world to `bus`; `renderer` draws for its cameras.
    ///
    /// # Errors
    /// [`EngineError`].
    pub fn new(
        plan: &SessionPlan,
        world: World,
        meshes: Arc<MeshLibrary>,
        renderer: Box<dyn Renderer>,
        bus: &dyn Transport,
    ) -> Result<Self, EngineError> {
        let cameras = plan.cameras(world.bodies().len());
        let studio = Studio::new(
            Arc::clone(&meshes),
            Arc::clone(&plan.layout),
            Arc::clone(&plan.catalog),
            renderer,
            &cameras,
            bus,
        )?;
        Ok(Self { engine: Engine::new(plan, world, &cameras, bus)?, studio, meshes })
    }

    /// Ticks 60 times a second until `stop`.
    ///
    /// # Errors
    /// [`EngineError`].
    pub fn run(self, stop: &AtomicBool) -> Result<(), EngineError> {
        let Self { mut engine, studio, meshes } = self;
        let desk = Desk::default();
        let over = AtomicBool::new(false);
        thread::scope(|scope| {
            let cameras = scope.spawn(|| studio.run(&desk));
            let each = |tick| {
                if tick == BAKE_AT {
                    scope.spawn(|| meshes.bake_all(&over));
                }
                !stop.load(Ordering::Relaxed) && !cameras.is_finished()
            };
            let ticked = tick_while(&mut engine, &desk, each);
            over.store(true, Ordering::Relaxed);
            desk.close();
            let shot = cameras.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            ticked.and(shot.map_err(EngineError::from))
        })
    }
}

/// Ticks until `each`, which is told the tick's number, says no.
fn tick_while(engine: &mut Engine, desk: &Desk, each: impl Fn(u64) -> bool) -> Result<(), EngineError> {
    let mut pace = Pace::new();
    while each(engine.world().tick()) {
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
