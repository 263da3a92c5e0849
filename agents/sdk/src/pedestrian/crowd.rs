//! All pedestrians of a session as one peer: what they see, and what their bodies are told.

use std::{
    collections::BTreeMap,
    sync::atomic::{AtomicBool, Ordering},
    time::Duration,
};

use cohabit_bus::{
    Inbox, Topic, Transport,
    message::{BodyRecord, StateView},
};
use cohabit_cdf::{BodyKind, StateFlag, StateFlags};
use glam::Vec2;

use super::{
    Floor, Schedule,
    forces::Walker,
    person::{Around, LOOK_TICKS, Person},
};
use crate::{agent::TICKS_PER_SECOND, client::Client, error::PeerError, peer::wait_for_mission};

/// Radii of bodies, m, as the world has them.
const ROBOT_M: f32 = 0.25;
const PERSON_M: f32 = 0.22;
/// How long it sleeps at most.
const NAP: Duration = Duration::from_millis(10);
/// In lock-step the world waits so long for it, should it hang.
const PATIENCE: Duration = Duration::from_secs(5);
/// It claims a body that nobody commands so often.
const CLAIM_TICKS: u64 = TICKS_PER_SECOND;
/// What was seen longer ago says nothing of how fast somebody is.
const RECENT_TICKS: u64 = 30;

/// All pedestrians of a session. They command their bodies unless others do, who may take one over and hand it back.
pub struct Crowd {
    people: Vec<Person>,
    floor: Floor,
    /// Where each body was when it was last looked at.
    seen: BTreeMap<u32, (u64, Vec2)>,
    /// The newest command to each body, and the tick of the newest claim of it.
    sent: BTreeMap<u32, u64>,
    claimed: BTreeMap<u32, u64>,
}

impl Crowd {
    /// Those who have something to do in a schedule, on that floor; what is left to chance follows from `seed`.
    #[must_use]
    pub fn new(schedule: &Schedule, floor: Floor, seed: u64) -> Self {
        let person = |body: u32| Person::new(body, schedule.entries(body), seed);
        Self {
            people: schedule.people().map(person).collect(),
            floor,
            seen: BTreeMap::new(),
            sent: BTreeMap::new(),
            claimed: BTreeMap::new(),
        }
    }

    /// Has them walk in the session on `bus` until `stop`. In lock-step they attend as one agent, and the same seed gives the
    /// same paths.
    ///
    /// # Errors
    /// [`PeerError`].
    pub fn run(&mut self, bus: &dyn Transport, stop: &AtomicBool) -> Result<(), PeerError> {
        let Some(first) = self.people.first().map(Person::body) else { return Ok(()) };
        let Some(mission) = wait_for_mission(bus, stop)? else { return Ok(()) };
        let lock_step = mission.header.lock_step == 1;
        let mut states = Inbox::new(bus, Topic::State)?;
        let mut client = Client::join(bus, first, "pedestrians")?;
        if lock_step {
            client.attend(Some(PATIENCE))?;
        }
        let (mut newest, mut due) = (None, 0);
        while !stop.load(Ordering::Relaxed) {
            client.sleep(NAP)?;
            // What comes of commands shows in the state.
            while client.event()?.is_some() {}
            let turn = client.turn()?;
            if lock_step && turn.is_none() {
                continue;
            }
            newest = states.latest(|sample| StateView::new(sample.payload()).map(drop))?.or(newest);
            let Some((sample, ())) = &newest else {
                if lock_step {
                    client.ready(1)?;
                }
                continue;
            };
            let tick = turn.unwrap_or(sample.envelope().tick);
            client.note_sensed(tick);
            // An outcome may bring a turn before its time.
            if tick >= due {
                due = tick + LOOK_TICKS;
                self.look(tick, StateView::new(sample.payload())?, &mut client)?;
            }
            if lock_step {
                client.ready(due - tick)?;
            }
        }
        Ok(())
    }

    /// Everybody decides, and their bodies are told.
    fn look(&mut self, tick: u64, state: StateView<'_>, client: &mut Client) -> Result<(), PeerError> {
        let bodies = self.walkers(tick, state.bodies);
        let shut = self.shut_doors(state);
        for person in &mut self.people {
            let body = person.body();
            let record = state.bodies.iter().find(|record| record.body == body);
            let Some((record, own)) = record.zip(bodies.get(&body)) else { continue };
            if record.commander != client.run() {
                person.forget();
                let is_due = self.claimed.get(&body).is_none_or(|claimed| tick >= claimed + CLAIM_TICKS);
                if record.commander == 0 && is_due {
                    self.claimed.insert(body, tick);
                    client.claim_of(body, false)?;
                }
                continue;
            }
            let is_busy = record.busy == 1 && self.sent.get(&body) == Some(&record.command);
            let (own, yaw_rad) = (*own, record.yaw_rad);
            let floor = &self.floor;
            let around =
                Around { tick, own, yaw_rad, is_busy, bodies: &bodies, records: state.bodies, shut: &shut, floor };
            if let Some(action) = person.act(&around) {
                self.sent.insert(body, client.act_in(body, 0, action)?);
            }
        }
        Ok(())
    }

    /// All bodies, and how they move: by where they were when they were last looked at.
    fn walkers(&mut self, tick: u64, records: &[BodyRecord]) -> BTreeMap<u32, Walker> {
        let walker = |record: &BodyRecord| {
            let at_m = Vec2::new(record.position_m[0], record.position_m[1]);
            let before = self.seen.insert(record.body, (tick, at_m));
            let velocity_m_s = before.map_or(Vec2::ZERO, |before| speed(before, (tick, at_m)));
            let radius_m = if record.kind == BodyKind::Person as u32 { PERSON_M } else { ROBOT_M };
            (record.body, Walker { at_m, velocity_m_s, radius_m })
        };
        records.iter().map(walker).collect()
    }

    /// Where doors between rooms are shut.
    fn shut_doors(&self, state: StateView<'_>) -> Vec<Vec2> {
        let is_shut = |name: &str| {
            let mut named = state.objects.iter().filter(|object| object.instance.as_str() == name);
            named.next().is_some_and(|door| !StateFlags(door.flags).has(StateFlag::Opened))
        };
        self.floor.doors.iter().filter(|(name, _)| is_shut(name)).map(|(_, at_m)| *at_m).collect()
    }
}

/// How somebody moved between two looks, m/s.
fn speed(before: (u64, Vec2), now: (u64, Vec2)) -> Vec2 {
    let ticks = now.0.saturating_sub(before.0);
    if !(1..=RECENT_TICKS).contains(&ticks) {
        return Vec2::ZERO;
    }
    (now.1 - before.1) * (TICKS_PER_SECOND as f32 / ticks as f32)
}
