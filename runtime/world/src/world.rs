//! The world: one state, stepped by a fixed tick.
//!
//! What a step is made of lies in a file each: machines and moving parts ([`machines`]), what flies and comes to rest
//! ([`rest`]), goals and the story ([`judging`]). What may be seen from outside is in [`view`], copies of the whole state
//! are in [`copies`].

mod copies;
mod judging;
mod machines;
mod rest;
mod view;

use std::sync::{Arc, OnceLock};

use cohabit_cdf::{BodyId, BodyKind, Catalog, Layout, Mission, ObjectId, RoomId, mission::MessageTime};

use crate::{
    apply::{Changes, settle},
    body::Body,
    build::{self, BuildError},
    facts::Facts,
    floor::Floor,
    navigation::Navigation,
    report::{Event, Input, Report},
    state::State,
};

/// Length of a tick, ns: 60 ticks a second.
pub const DT_NANOS: u64 = 16_666_667;

/// What a step is made of, in order.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Phase {
    /// Commands are taken up.
    Rule,
    /// Bodies go on with what they do.
    Move,
    /// Machines work, doors and drawers move.
    Work,
    /// What flies and slides does so.
    Physics,
    /// Goals are judged, the story goes on.
    Judge,
}

/// A simulated office.
pub struct World {
    catalog: Arc<Catalog>,
    pub(crate) layout: Arc<Layout>,
    mission: Arc<Mission>,
    pub(crate) floor: Floor,
    pub(crate) state: State,
    pub(crate) navigation: Navigation,
    /// Whether the state is still the one that goals and occasions were last judged on.
    is_judged: bool,
    /// What a snapshot is of; worked out when the first one is wanted.
    identity: OnceLock<[u8; 32]>,
}

impl World {
    /// Furnishes the floor plan and changes it as the mission asks; one robot stands in the mission's start room.
    ///
    /// All that is left to chance follows from the mission's own seed, or from `seed` if it has none.
    ///
    /// # Errors
    /// [`BuildError`] names the object that cannot be had or has no place.
    pub fn new(
        catalog: Arc<Catalog>,
        layout: Arc<Layout>,
        mission: Arc<Mission>,
        seed: u64,
    ) -> Result<Self, BuildError> {
        let (floor, state, mut navigation) = build::build(&catalog, &layout, &mission, seed)?;
        navigation.renew(&Facts { catalog: &catalog, floor: &floor, state: &state });
        Ok(Self { catalog, layout, mission, floor, state, navigation, is_judged: false, identity: OnceLock::new() })
    }

    /// Adds a body of a kind at a free viewpoint of a room.
    ///
    /// # Errors
    /// [`BuildError::NoSuchRoom`], and [`BuildError::NoFreeSpot`] if the room has no place left to stand.
    pub fn add_body(&mut self, kind: BodyKind, room: RoomId) -> Result<BodyId, BuildError> {
        if self.layout.room(room).is_none() {
            return Err(build::no_such_room(&self.catalog, &self.layout, &format!("the {}", kind.name()), room));
        }
        self.refresh_navigation();
        let full =
            || BuildError::NoFreeSpot { object: "the robot".to_owned(), room: room.name_in(&self.catalog).to_owned() };
        let (position, yaw_rad) = build::start(&self.facts(), &self.navigation, &self.layout, room).ok_or_else(full)?;
        let id = BodyId(u32::try_from(self.state.bodies.len()).expect("invariant: few bodies"));
        self.state.bodies.push(Body::new(kind, position, yaw_rad, room));
        self.is_judged = false;
        Ok(id)
    }

    /// Goes on by one tick: takes the commands up, moves everything, works the machines, judges the goals.
    pub fn step(&mut self, inputs: &[Input]) -> Report {
        self.step_telling(inputs, &mut |_| ())
    }

    /// The same, and tells when each phase of it is over: the world has no clock to time them by.
    pub fn step_telling(&mut self, inputs: &[Input], over: &mut dyn FnMut(Phase)) -> Report {
        let mut report = Report::default();
        if self.state.tick == 0 {
            self.say(&MessageTime::Beginning, &mut report.events);
        }
        self.refresh_navigation();
        for input in inputs {
            self.begin(input, &mut report.outcomes, &mut report.events);
        }
        over(Phase::Rule);
        for index in 0..self.state.bodies.len() {
            let id = BodyId(u32::try_from(index).expect("invariant: few bodies"));
            report.outcomes.extend(self.advance_task(id, &mut report.events));
            self.carry_held(id);
        }
        over(Phase::Move);
        self.strike_from_below(&mut report.events);
        self.run_machines(&mut report.events);
        let animated = self.animate();
        over(Phase::Work);
        self.step_physics(&mut report.events);
        over(Phase::Physics);
        // What is judged follows from the state alone: where nothing changed, nothing new comes of it.
        let acted = !inputs.is_empty()
            || self.state.bodies.iter().any(|body| body.busy() || body.arm > 0.0)
            || !report.outcomes.is_empty();
        let changed = animated || acted || self.state.physics.is_active() || !report.events.is_empty();
        if changed || !self.is_judged {
            self.cross_times(&mut report.events);
            self.judge(&mut report.events);
            self.is_judged = !changed && report.events.is_empty();
        }
        over(Phase::Judge);
        self.state.tick += 1;
        report
    }

    pub(crate) fn facts(&self) -> Facts<'_> {
        Facts { catalog: &self.catalog, floor: &self.floor, state: &self.state }
    }

    pub(crate) fn changes<'a>(&'a mut self, events: &'a mut Vec<Event>) -> Changes<'a> {
        Changes { catalog: &self.catalog, floor: &self.floor, state: &mut self.state, events }
    }

    fn refresh_navigation(&mut self) {
        if self.navigation.version != self.state.floor_version {
            self.renew_navigation();
        }
    }

    fn renew_navigation(&mut self) {
        self.navigation.renew(&Facts { catalog: &self.catalog, floor: &self.floor, state: &self.state });
    }

    /// Has a thing, and all that goes with it, be where what it belongs to is.
    fn settle(&mut self, id: ObjectId) {
        settle(&self.catalog, &self.floor, &mut self.state, id);
    }
}
