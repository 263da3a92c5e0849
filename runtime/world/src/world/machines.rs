//! What works by itself: machines, doors and drawers, what is live on the floor.

use cohabit_cdf::{BodyId, ObjectId, StateFlag};

use super::World;
use crate::{
    effect::Effect,
    kinematics::DT_S,
    power,
    report::{Event, SoundKind},
    rules::effects_of_work,
    run::{Run, Work, ticks},
    state::ids,
};

/// Doors, lids and drawers take 0.8 s; machines as long to come up to speed.
const OPEN_PER_S: f32 = 1.0 / 0.8;

impl World {
    /// Who walks onto something live on the floor is killed by it.
    pub(super) fn strike_from_below(&mut self, events: &mut Vec<Event>) {
        /// A foot's breadth, m.
        const FOOT_M: f32 = 0.1;
        let facts = self.facts();
        let struck: Vec<(BodyId, ObjectId)> = power::live_on_floor(&facts)
            .into_iter()
            .flat_map(|id| {
                let print = facts.footprint(id);
                let bodies = (0_u32..).map(BodyId).zip(&facts.state.bodies);
                bodies
                    .filter(move |(_, body)| body.alive && print.distance(body.position) < FOOT_M)
                    .map(move |(body, _)| (body, id))
            })
            .collect();
        for (body, object) in struck {
            self.changes(events).apply(vec![Effect::sound(SoundKind::Spark, object), Effect::Kill(body)]);
        }
    }

    /// Machines that are on for a moment do their work, and go off again.
    pub(super) fn run_machines(&mut self, events: &mut Vec<Event>) {
        let tick = self.state.tick;
        let running: Vec<ObjectId> =
            self.state.existing().filter(|(_, object)| object.run.is_some()).map(|(id, _)| id).collect();
        for id in running {
            let Some(run) = self.state.at(id).run else { continue };
            let facts = self.facts();
            let dead = power::lacks_power(&facts, id)
                || run.drives.is_some_and(|driven| power::lacks_power(&facts, driven))
                || !facts.is(id, StateFlag::Toggled);
            let [effect, end] = ticks(self.catalog.table().device(&facts.class(id).id));
            if !dead && tick == run.since + effect {
                let effects = effects_of_work(&facts, id, run.work, run.site);
                self.changes(events).apply(effects);
            }
            if dead || tick >= run.since + end {
                self.state.at_mut(id).run = None;
                let off = std::iter::once(id).chain(run.drives);
                let effects = off.map(|id| Effect::Set(id, StateFlag::Toggled, false)).collect();
                self.changes(events).apply(effects);
            }
        }
    }

    /// Whether a machine has yet to do its work on what is in or on this thing.
    pub(crate) fn is_at_work_in(&self, site: ObjectId) -> bool {
        let facts = self.facts();
        let is_to_come = |id: ObjectId, run: Run| {
            let [effect, _] = ticks(self.catalog.table().device(&facts.class(id).id));
            run.work != Work::Nothing && self.state.tick <= run.since + effect
        };
        let mut running = self.state.existing().filter_map(|(id, object)| Some((id, object.run?)));
        running.any(|(id, run)| (run.site == site || id == site) && is_to_come(id, run))
    }

    /// Moving parts follow their states; what the gravity pad lifts goes with it. Whether anything moved.
    pub(super) fn animate(&mut self) -> bool {
        let by = OPEN_PER_S * DT_S;
        let (mut lifting, mut swinging) = (Vec::new(), Vec::new());
        for id in ids(self.state.objects.len()) {
            let object = self.state.at_mut(id);
            let target = |flag| f32::from(u8::from(object.flags.has(flag)));
            let (opened, running) = (target(StateFlag::Opened), target(StateFlag::Toggled));
            if opened != object.opened {
                swinging.push((id, (object.opened + (opened - object.opened).clamp(-by, by)).clamp(0.0, 1.0)));
            }
            let was = object.running;
            object.running = (was + (running - was).clamp(-by, by)).clamp(0.0, 1.0);
            if was != object.running {
                lifting.push(id);
            }
        }
        let moved = !swinging.is_empty() || !lifting.is_empty();
        for (id, opened) in swinging {
            // A door or drawer stops at a body, and goes on once that is gone.
            if !self.hits_body(id, opened) {
                self.state.at_mut(id).opened = opened;
            }
        }
        for id in lifting {
            for child in self.state.children(id).collect::<Vec<_>>() {
                self.settle(child);
            }
        }
        moved
    }
}
