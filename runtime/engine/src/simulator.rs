//! The simulator of one session: its world, its cameras, its clock.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::Duration,
};

use cohabit_bus::{
    Listener, Transport, Wake, give_way, go_first,
    message::{Control, Stage},
    monotonic_nanos, wall_nanos,
};
use cohabit_render::{CpuRenderer, MeshLibrary, Renderer};
use cohabit_world::{DT_NANOS, World};

use crate::{
    appearance::Appearance,
    build::SessionPlan,
    engine::{Engine, EngineError},
    pace::Pace,
    scene::Moment,
    studio::{Desk, Studio},
};

/// Ticks between two greetings of peers that joined late.
const GREET_EVERY: u64 = 15;
/// The tick at which the shading of models that were not seen yet begins to be baked, so that none makes a frame late:
/// the first frames come first.
const BAKE_AT: u64 = 90;
/// How often those who joined are looked after while the world stands still or waits.
const LOOK_EVERY: Duration = Duration::from_millis(20);

/// A world with its cameras and its clock.
pub struct Simulator {
    engine: Engine,
    /// The cameras that deliver as well as they can; in lock-step, those for people alone.
    studio: Studio,
    meshes: Arc<MeshLibrary>,
    bell: Box<dyn Listener>,
    pace: Pace,
    lock_step: Option<LockStep>,
}

/// What a world in lock-step needs besides.
struct LockStep {
    /// The world begins when so many attend.
    agents: usize,
    /// The cameras whose frames belong to an agent's turn.
    studio: Studio,
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
        let cameras = plan.all_cameras(world.bodies().len());
        let engine = Engine::new(plan, world, &cameras, bus)?;
        let studio = |renderer, cameras: &[_]| {
            let (layout, catalog) = (Arc::clone(&plan.layout), Arc::clone(&plan.catalog));
            Studio::new(Arc::clone(&meshes), layout, catalog, renderer, cameras, bus)
        };
        let (studio, lock_step) = match plan.lock_step {
            None => (studio(renderer, &cameras)?, None),
            Some(agents) => {
                let (people, minds): (Vec<_>, Vec<_>) = cameras.into_iter().partition(|camera| camera.for_people);
                let lock_step = LockStep { agents, studio: studio(renderer, &minds)? };
                (studio(Box::new(CpuRenderer::new(1)), &people)?, Some(lock_step))
            }
        };
        let bell = bus.listener(Wake::Commands)?;
        Ok(Self { engine, studio, meshes, bell, pace: Pace::new(1.0, false), lock_step })
    }

    /// The same, beginning so many times as fast as real time, and perhaps standing still at first.
    #[must_use]
    pub fn starting(self, speed: f32, paused: bool) -> Self {
        Self { pace: Pace::new(speed, paused), ..self }
    }

    /// The same, going on from a moment at which that was seen of its world besides.
    #[must_use]
    pub fn appearing(self, appearance: Appearance) -> Self {
        Self { engine: self.engine.appearing(appearance), ..self }
    }

    /// Goes on until `stop`.
    ///
    /// # Errors
    /// [`EngineError`].
    pub fn run(self, stop: &AtomicBool) -> Result<(), EngineError> {
        let Self { engine, studio, meshes, bell, pace, lock_step } = self;
        let desk = Desk::default();
        let over = AtomicBool::new(false);
        thread::scope(|scope| {
            let cameras = scope.spawn(|| {
                give_way();
                studio.run(&desk)
            });
            let goes_on = |tick| {
                if tick == BAKE_AT {
                    scope.spawn(|| {
                        give_way();
                        meshes.bake_all(&over);
                    });
                }
                !stop.load(Ordering::Relaxed) && !cameras.is_finished()
            };
            let closing = Closing { desk: &desk, over: &over };
            let in_lock_step = lock_step.is_some();
            let mut clock = Clock { engine, desk: &desk, bell, pace, in_lock_step, goes_on, shown_nanos: 0 };
            let ran = match lock_step {
                None => clock.run_in_real_time(),
                Some(lock_step) => clock.run_in_lock_step(lock_step),
            };
            drop(closing);
            let shot = cameras.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            ran.and(shot.map_err(EngineError::from))
        })
    }
}

/// Ends the other threads of a simulator when it is dropped: also by a panic of the one that ticks, for which they would
/// otherwise be waited for in vain.
struct Closing<'a> {
    desk: &'a Desk,
    over: &'a AtomicBool,
}

impl Drop for Closing<'_> {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Relaxed);
        self.desk.close();
    }
}

/// An engine that is ticking.
struct Clock<'a, G> {
    engine: Engine,
    desk: &'a Desk,
    bell: Box<dyn Listener>,
    pace: Pace,
    /// Whether it goes as fast as those who attend, and no speed counts.
    in_lock_step: bool,
    /// Whether it goes on at that tick.
    goes_on: G,
    /// When the scene was last shown to those who render.
    shown_nanos: u64,
}

impl<G: Fn(u64) -> bool> Clock<'_, G> {
    /// The world never waits.
    fn run_in_real_time(&mut self) -> Result<(), EngineError> {
        go_first();
        self.begin()?;
        while self.goes_on() {
            if self.pace.is_paused() {
                self.stand_still()?;
            } else {
                let late_nanos = u64::try_from(self.pace.late().as_nanos()).unwrap_or(u64::MAX);
                self.tick(late_nanos)?;
                self.engine.record()?;
                self.show();
                self.engine.note_stage(Stage::Show);
                self.pace.wait();
            }
            self.obey()?;
        }
        self.engine.keep_state()
    }

    /// The world waits for all who attend, and goes as fast as they do.
    fn run_in_lock_step(&mut self, LockStep { agents, mut studio }: LockStep) -> Result<(), EngineError> {
        self.begin()?;
        let mut begun = false;
        while self.goes_on() {
            let due = self.engine.ask();
            if !due.runs.is_empty() {
                self.engine.restart_stopwatch();
                studio.shoot_watched(&due.bodies, &|nanos| Moment::capture(self.engine.visible(), nanos))?;
                self.engine.publish_step(&due.runs)?;
                self.engine.note_stage(Stage::Show);
            }
            // Meanwhile they think.
            self.engine.record()?;
            begun |= self.engine.attending() >= agents;
            let waits = self.engine.is_awaited() || self.engine.attending() == 0 || !begun;
            if self.pace.is_paused() || waits {
                self.stand_still()?;
                self.engine.give_up_waiting()?;
            } else {
                self.engine.note_stage(Stage::Wait);
                self.tick(0)?;
                self.show_at_times();
            }
            self.obey()?;
        }
        self.engine.record()?;
        self.engine.keep_state()
    }

    fn goes_on(&self) -> bool {
        (self.goes_on)(self.engine.world().tick())
    }

    /// Who joins before the first tick sees the world as well.
    fn begin(&mut self) -> Result<(), EngineError> {
        if self.pace.is_paused() {
            self.engine.set_clock(true, "paused")?;
        }
        // Of the beginning, too: it may not be that of the mission.
        self.engine.keep_state()?;
        self.engine.show_state()?;
        self.engine.restart_stopwatch();
        Ok(())
    }

    fn tick(&mut self, late_nanos: u64) -> Result<(), EngineError> {
        self.engine.advance(wall_nanos(), late_nanos)?;
        if self.engine.world().tick().is_multiple_of(GREET_EVERY) {
            self.engine.greet()?;
        }
        if self.pace.count() {
            self.engine.set_clock(true, "paused")?;
        }
        Ok(())
    }

    /// Looks after those who join, look or command while no time goes by, until something comes or a moment is over.
    fn stand_still(&mut self) -> Result<(), EngineError> {
        if !self.bell.wait(LOOK_EVERY)? {
            self.engine.greet()?;
        }
        self.engine.listen()?;
        self.engine.beat()?;
        self.show_at_times();
        Ok(())
    }

    /// Does what the clock is asked to do.
    fn obey(&mut self) -> Result<(), EngineError> {
        for control in self.engine.take_controls() {
            let obeyed = self.pace.obey(control);
            let sentence = match control {
                Control::Speed(_) if self.in_lock_step => "in lock-step the world goes as fast as its agents",
                _ => &obeyed,
            };
            self.engine.set_clock(self.pace.is_paused(), sentence)?;
        }
        Ok(())
    }

    /// Leaves the scene to those who render.
    fn show(&mut self) {
        self.shown_nanos = monotonic_nanos();
        self.desk.leave(Moment::capture(self.engine.visible(), self.shown_nanos));
    }

    /// The same, no more often than in real time.
    fn show_at_times(&mut self) {
        if monotonic_nanos() - self.shown_nanos >= DT_NANOS {
            self.show();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

    use super::*;

    #[test]
    fn a_panic_of_the_thread_that_ticks_ends_the_others() {
        let (desk, over) = (Desk::default(), AtomicBool::new(false));
        let panicked = catch_unwind(AssertUnwindSafe(|| {
            thread::scope(|scope| {
                scope.spawn(|| {
                    while !over.load(Ordering::Relaxed) {
                        thread::yield_now();
                    }
                });
                let _closing = Closing { desk: &desk, over: &over };
                resume_unwind(Box::new("as a panic does"));
            });
        }));
        assert!(panicked.is_err());
    }
}
