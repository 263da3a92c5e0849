//! An agent that does whatever comes to its mind, among what makes sense for the things that it sees.

use std::sync::Arc;

use cohabit_bus::message::NONE;
use cohabit_cdf::{Action, ActionKind, Catalog, ClassId, GoToTarget, ObjectId, RoomId};
use rand_chacha::{
    ChaCha8Rng,
    rand_core::{Rng, SeedableRng},
};

use crate::{
    affordance::Known,
    agent::{Agent, Deed, Heard, Now, Senses, TICKS_PER_SECOND},
    errand::{Errand, Progress},
    memory::Memory,
};

/// It looks so often while it waits or walks, in ticks.
const LOOK_EVERY: u64 = 15;
/// What it saw longer ago, in ticks, it does nothing to.
const RECENT: u64 = 20 * TICKS_PER_SECOND;
/// It pauses up to so long after what it did, and so long after what failed, in ticks.
const PAUSE: u64 = TICKS_PER_SECOND;
const PAUSE_AFTER_FAILURE: u64 = 2 * TICKS_PER_SECOND;
/// Viewpoints of a room.
const VIEWPOINTS: u64 = 8;

/// What comes to its mind.
#[derive(Clone, Copy)]
enum Habit {
    Stroll,
    Approach,
    Handle,
    Turn,
    LookUpOrDown,
    LookAround,
}

/// How often what comes to its mind, as shares of their sum.
const HABITS: &[(u64, Habit)] = &[
    (3, Habit::Stroll),
    (2, Habit::Approach),
    (6, Habit::Handle),
    (1, Habit::Turn),
    (1, Habit::LookUpOrDown),
    (1, Habit::LookAround),
];

/// Acts at random, the same for the same seed and the same world: walks to viewpoints and to things, looks, and tries
/// what the things that it saw lately afford. It never waits for anything but outcomes.
pub struct Random {
    rng: ChaCha8Rng,
    catalog: Arc<Catalog>,
    memory: Memory,
    errand: Errand,
    commands: bool,
    pauses_until: u64,
    tick: u64,
}

impl Random {
    /// An agent whose choices follow from `seed`.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self::with_catalog(Arc::new(Catalog::builtin()), seed)
    }

    /// The same in a world with this catalogue.
    #[must_use]
    pub fn with_catalog(catalog: Arc<Catalog>, seed: u64) -> Self {
        Self {
            rng: ChaCha8Rng::seed_from_u64(seed),
            catalog,
            memory: Memory::default(),
            errand: Errand::default(),
            commands: true,
            pauses_until: 0,
            tick: 0,
        }
    }

    /// A number below `count`.
    fn below(&mut self, count: u64) -> u64 {
        self.rng.next_u64() % count.max(1)
    }

    fn one_of<T: Copy>(&mut self, choices: &[T]) -> Option<T> {
        let index = usize::try_from(self.below(choices.len() as u64)).unwrap_or(0);
        choices.get(index).copied()
    }

    fn habit(&mut self) -> Habit {
        let mut left = self.below(HABITS.iter().map(|(share, _)| share).sum());
        for (share, habit) in HABITS {
            if left < *share {
                return *habit;
            }
            left -= share;
        }
        Habit::LookAround
    }

    /// What to do next; nothing, if what came to its mind cannot be done here.
    fn choose(&mut self, now: &Now<'_>) -> Option<Action> {
        let tenths = |of: u64| of as f32 / 10.0;
        match self.habit() {
            Habit::Stroll => {
                let rooms: Vec<RoomId> = self.catalog.rooms().ids().collect();
                let room = self.one_of(&rooms)?;
                let viewpoint = u8::try_from(1 + self.below(VIEWPOINTS)).unwrap_or(1);
                Some(Action::GoTo { target: GoToTarget::Viewpoint(room, viewpoint) })
            }
            Habit::Approach => {
                let known: Vec<ObjectId> = self.recent().map(|(id, _)| id).collect();
                Some(Action::GoTo { target: GoToTarget::Object(self.one_of(&known)?) })
            }
            Habit::Handle => {
                let held = now.own.map(|own| own.held).filter(|held| *held != NONE);
                let ways = self.ways(held.map(ObjectId));
                let (object, kind) = self.one_of(&ways)?;
                Some(kind.on(object))
            }
            Habit::Turn => Some(Action::Rotate { yaw_rad: tenths(self.below(50)) - 2.5 }),
            Habit::LookUpOrDown => Some(Action::Look { pitch_rad: tenths(self.below(11)) - 0.5 }),
            Habit::LookAround => Some(Action::LookAround),
        }
    }

    /// The things that it saw lately, with their classes.
    fn recent(&self) -> impl Iterator<Item = (ObjectId, ClassId)> {
        let since = self.tick.saturating_sub(RECENT);
        let known = self.memory.things().filter(move |(_, thing)| thing.seen >= since && thing.record.held_by == NONE);
        let known = known.map(|(id, thing)| (id, ClassId(thing.record.class)));
        known.filter(|(_, class)| usize::from(class.0) < self.catalog.classes().len())
    }

    /// All that can be done to them.
    fn ways(&self, held: Option<ObjectId>) -> Vec<(ObjectId, ActionKind)> {
        let known = Known { memory: &self.memory, catalog: &self.catalog, held };
        let afforded = |id| known.afforded(id).into_iter().map(move |kind| (id, kind));
        self.recent().flat_map(|(id, _)| afforded(id)).collect()
    }

    fn live(&mut self, now: &Now<'_>, deeds: &mut Vec<Deed>) {
        self.tick = now.tick;
        if let Some(sight) = now.sight {
            self.memory.take_in(sight, now.tick);
        }
        deeds.push(Deed::Rest(LOOK_EVERY));
        if !self.commands || self.errand.is_under_way() || now.tick < self.pauses_until {
            return;
        }
        if let Some(action) = self.choose(now) {
            deeds.push(Deed::Act { turn: 0, action: self.errand.begin(action) });
        }
    }
}

impl Agent for Random {
    fn senses(&self) -> Senses {
        Senses { sight: true, state: false }
    }

    fn hear(&mut self, heard: &Heard<'_>, deeds: &mut Vec<Deed>) {
        match *heard {
            Heard::Now(now) => self.live(now, deeds),
            Heard::Outcome { status, .. } => match self.errand.hear(status) {
                Some(Progress::Then(action)) => deeds.push(Deed::Act { turn: 0, action }),
                Some(Progress::Over) => {
                    let pause = if status.is_failure() { PAUSE_AFTER_FAILURE } else { self.below(PAUSE) };
                    self.pauses_until = self.tick + pause;
                }
                None => {}
            },
            Heard::Commands(commands) => {
                self.commands = commands;
                self.errand.give_up();
            }
            // It does what it likes.
            Heard::Plan { .. } => {}
        }
    }
}
