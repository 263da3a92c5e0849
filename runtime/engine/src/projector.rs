//! Plays a recorded session on a bus, as its simulator played it live, and goes where it is asked to go.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::Duration,
};

use cohabit_bus::{
    BusError, Inbox, Listener, Publisher, Topic, Transport, Wake, give_way,
    message::{self, Control, ControlMessage, StateParts},
    monotonic_nanos,
};
use cohabit_render::{MeshLibrary, Renderer};
use cohabit_world::DT_NANOS;

use crate::{
    pace::Pace,
    replay::{ReplayError, Replayer},
    scene::Moment,
    studio::{Desk, Studio},
};

/// How often those who joined are looked after while nothing moves.
const LOOK_EVERY: Duration = Duration::from_millis(20);

/// Why a recorded session can be shown no longer.
#[derive(Debug, thiserror::Error)]
pub enum ProjectorError {
    /// The bus failed.
    #[error(transparent)]
    Bus(#[from] BusError),
    /// It cannot go back to where it was asked to.
    #[error(transparent)]
    Replay(#[from] ReplayError),
}

/// A recorded session with its cameras and its clock.
pub struct Projector<'a> {
    replayer: Replayer<'a>,
    studio: Studio,
    state: Box<dyn Publisher>,
    controls: Inbox,
    bell: Box<dyn Listener>,
    pace: Pace,
    shown_nanos: u64,
}

impl<'a> Projector<'a> {
    /// Connects what `replayer` goes through to `bus`, standing still at first; `renderer` draws for its cameras.
    ///
    /// # Errors
    /// [`BusError`].
    pub fn new(
        replayer: Replayer<'a>,
        meshes: Arc<MeshLibrary>,
        renderer: Box<dyn Renderer>,
        bus: &dyn Transport,
    ) -> Result<Self, BusError> {
        let plan = replayer.plan();
        let cameras = plan.all_cameras(replayer.world().bodies().len());
        let (layout, catalog) = (Arc::clone(&plan.layout), Arc::clone(&plan.catalog));
        Ok(Self {
            studio: Studio::new(meshes, layout, catalog, renderer, &cameras, bus)?,
            state: bus.publisher(Topic::State)?,
            controls: Inbox::new(bus, Topic::Control)?,
            bell: bus.listener(Wake::Commands)?,
            pace: Pace::new(1.0, true),
            replayer,
            shown_nanos: 0,
        })
    }

    /// Shows it until `stop`.
    ///
    /// # Errors
    /// [`ProjectorError`].
    pub fn run(self, stop: &AtomicBool) -> Result<(), ProjectorError> {
        let Self { replayer, studio, state, controls, bell, pace, shown_nanos } = self;
        let desk = Desk::default();
        thread::scope(|scope| {
            let cameras = scope.spawn(|| {
                give_way();
                studio.run(&desk)
            });
            let mut reel = Reel { replayer, state, controls, bell, pace, desk: &desk, shown_nanos, leaps: 0 };
            let ran = reel.run(&|| stop.load(Ordering::Relaxed) || cameras.is_finished());
            desk.close();
            let shot = cameras.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            ran.and(shot.map_err(ProjectorError::from))
        })
    }
}

/// What goes by.
struct Reel<'a, 'd> {
    replayer: Replayer<'a>,
    state: Box<dyn Publisher>,
    controls: Inbox,
    bell: Box<dyn Listener>,
    pace: Pace,
    desk: &'d Desk,
    shown_nanos: u64,
    leaps: u64,
}

impl Reel<'_, '_> {
    fn run(&mut self, over: &dyn Fn() -> bool) -> Result<(), ProjectorError> {
        self.show()?;
        while !over() {
            if self.pace.is_paused() {
                self.bell.wait(LOOK_EVERY)?;
                self.state.update()?;
                self.show_at_times()?;
            } else {
                self.step()?;
                self.pace.wait();
            }
            self.obey()?;
        }
        Ok(())
    }

    /// One tick; where there is none any more, it stands still.
    fn step(&mut self) -> Result<(), ProjectorError> {
        let went_on = self.replayer.advance().is_some() || (self.replayer.gap().is_some() && self.replayer.skip_gap());
        if self.pace.count() || !went_on {
            self.pace.obey(Control::Pause);
            return self.show();
        }
        self.show_at_times()
    }

    fn obey(&mut self) -> Result<(), ProjectorError> {
        let mut asked = false;
        while let Some((_, control)) =
            self.controls.next(|sample| Control::try_from(message::read::<ControlMessage>(sample.payload())?))?
        {
            asked = true;
            match control {
                Control::Seek(tick) => {
                    let [first, last] = self.replayer.span();
                    self.replayer.go_to(u64::from(tick).clamp(first, last))?;
                    self.leaps += 1;
                }
                control => drop(self.pace.obey(control)),
            }
        }
        if asked { self.show() } else { Ok(()) }
    }

    /// Tells where it is, and leaves the scene to those who render.
    fn show(&mut self) -> Result<(), ProjectorError> {
        self.shown_nanos = monotonic_nanos();
        let mut parts: StateParts = self.replayer.state();
        parts.header.paused = u32::from(self.pace.is_paused());
        let tick = self.replayer.world().tick();
        self.state.send(tick, parts.bytes(), &mut |bytes| parts.write(bytes))?;
        let moment = Moment::capture(self.replayer.visible(), self.shown_nanos);
        self.desk.leave(Moment { leaps: self.leaps, ..moment });
        Ok(())
    }

    /// The same, no more often than live.
    fn show_at_times(&mut self) -> Result<(), ProjectorError> {
        if monotonic_nanos() - self.shown_nanos >= DT_NANOS { self.show() } else { Ok(()) }
    }
}
