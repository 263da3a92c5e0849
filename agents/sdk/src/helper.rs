//! A robot that keeps the office in order, by rules.

mod roam;
mod rules;

use std::{collections::BTreeMap, sync::Arc};

use cohabit_bus::message::{BodyRecord, DialogKind, DialogMessage, NONE};
use cohabit_cdf::{
    Action, ActionTable, BodyKind, Catalog, ObjectClass, ObjectId, Property, SemanticClass, Status, catalog::Stands,
};

use crate::{
    agent::{Agent, Deed, Heard, Now, Senses, TICKS_PER_SECOND},
    errand::{Errand, Progress},
    memory::{Memory, Remembered, flags, level_m},
};
use roam::Rounds;
use rules::{Lies, RULES, Rule, Then, Wanted, When, is_table};

/// It looks so often, in ticks.
const LOOK_EVERY: u64 = 12;
/// What has been as it is for less than this, in ticks, somebody may still be at.
const LEFT_ALONE: u64 = 3 * TICKS_PER_SECOND;
/// Somebody who was seen not longer ago than this, in ticks, is still about.
const ABOUT: u64 = 2 * TICKS_PER_SECOND;
/// It leaves a thing to somebody who is as near to it, m.
const AT_IT_M: f32 = 1.5;
/// It comes no nearer to a person than this, m, and stops before one who is ahead of it by less than that.
const NEAR_M: f32 = 1.2;
const AHEAD_M: f32 = 2.0;
/// What is ahead: the cosine of 26 degrees, so much to either side.
const AHEAD_COS: f32 = 0.9;
/// It waits so long for a person to go by, and then minds its own way for so long, in ticks.
const PATIENCE: u64 = 6 * TICKS_PER_SECOND;
const IMPATIENCE: u64 = 8 * TICKS_PER_SECOND;
/// It does not try again what failed before so many ticks are over, twice as many each time.
const FIRST_BAN: u64 = 20 * TICKS_PER_SECOND;
const MOST_BANS: u32 = 5;
/// It says something at most so often, in ticks.
const SAYS_EVERY: u64 = 10 * TICKS_PER_SECOND;
/// What lies lower than this lies on the floor, m.
const FLOOR_M: f32 = 0.15;

/// Closes what stands open, switches off what was left on, puts on tables what lies on the floor, and keeps clear of
/// people. It knows what its own camera has shown it, and nothing else: it goes from room to room to see how things are.
pub struct Helper {
    body: u32,
    catalog: Arc<Catalog>,
    memory: Memory,
    errand: Errand,
    rounds: Rounds,
    chore: Chore,
    bans: BTreeMap<ObjectId, Ban>,
    commands: bool,
    /// It has stood still since that tick because of a person.
    waits_since: Option<u64>,
    minds_nobody_until: u64,
    said_at: Option<u64>,
    tick: u64,
}

/// What it is at.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Chore {
    Nothing,
    /// Standing still for somebody.
    Wait,
    /// Doing something to a thing.
    With(ObjectId),
    /// Putting what it holds on a thing.
    PutOn(ObjectId),
    /// On its way to a viewpoint.
    Walk,
    /// Looking around there.
    Look,
}

/// Until when a thing is left alone.
#[derive(Clone, Copy, Debug, Default)]
struct Ban {
    until: u64,
    count: u32,
}

impl Helper {
    /// A helper with that body; its rounds follow from `seed`.
    #[must_use]
    pub fn new(body: u32, seed: u64) -> Self {
        Self::with_catalog(Arc::new(Catalog::builtin()), body, seed)
    }

    /// The same in a world with this catalogue.
    #[must_use]
    pub fn with_catalog(catalog: Arc<Catalog>, body: u32, seed: u64) -> Self {
        let rounds = Rounds::new(seed, catalog.rooms().ids());
        Self {
            body,
            catalog,
            memory: Memory::default(),
            errand: Errand::default(),
            rounds,
            chore: Chore::Nothing,
            bans: BTreeMap::new(),
            commands: true,
            waits_since: None,
            minds_nobody_until: 0,
            said_at: None,
            tick: 0,
        }
    }

    fn live(&mut self, now: &Now<'_>, deeds: &mut Vec<Deed>) {
        self.tick = now.tick;
        if let Some(sight) = now.sight {
            self.memory.take_in(sight, now.tick);
        }
        deeds.push(Deed::Rest(LOOK_EVERY));
        let Some(own) = now.own.filter(|_| self.commands) else { return };
        for rule in RULES {
            let may_interrupt = match rule.when {
                When::PersonInTheWay => true,
                // On its way to see how things are it has seen enough.
                When::HandFull | When::Knows(_) => self.chore == Chore::Walk,
                When::Always => false,
            };
            if self.errand.is_under_way() && !may_interrupt {
                continue;
            }
            if self.apply(rule, own, deeds) {
                return;
            }
        }
    }

    /// Does what a rule says, if it applies.
    fn apply(&mut self, rule: &Rule, own: &BodyRecord, deeds: &mut Vec<Deed>) -> bool {
        match &rule.when {
            When::PersonInTheWay => self.make_way(rule, own, deeds),
            When::HandFull if own.held == NONE => false,
            When::HandFull => {
                let table = self.nearest(own, |_, class| is_table(class));
                table.is_some_and(|table| self.handle(rule, table, deeds))
            }
            When::Knows(wanted) => {
                let before = self.tick.saturating_sub(LEFT_ALONE);
                let thing = self.nearest(own, |thing, class| {
                    thing.since <= before && is_wanted(wanted, thing, class, self.catalog.table())
                });
                // Its hand may be full because it knows of no table yet.
                let can = own.held == NONE || wanted.lies != Lies::OnTheFloor;
                thing.filter(|_| can).is_some_and(|thing| self.handle(rule, thing, deeds))
            }
            When::Always => {
                self.go_on_rounds(own, deeds);
                true
            }
        }
    }

    /// Stands still while a person is in the way, but not for ever: one who sits at a desk is passed by.
    fn make_way(&mut self, rule: &Rule, own: &BodyRecord, deeds: &mut Vec<Deed>) -> bool {
        let in_the_way = self
            .memory
            .bodies_since(self.tick.saturating_sub(LOOK_EVERY))
            .any(|other| other.kind == BodyKind::Person as u32 && other.body != self.body && is_in_the_way(own, other));
        if !in_the_way || self.tick < self.minds_nobody_until {
            self.waits_since = None;
            return false;
        }
        let since = *self.waits_since.get_or_insert(self.tick);
        if self.tick - since > PATIENCE {
            self.waits_since = None;
            self.minds_nobody_until = self.tick + IMPATIENCE;
            return false;
        }
        if self.chore != Chore::Wait && self.errand.is_under_way() {
            self.errand.give_up();
            self.chore = Chore::Wait;
            deeds.push(Deed::Act { turn: 0, action: self.errand.begin(Action::Stop) });
            self.say(rule.says.to_owned(), deeds);
        }
        true
    }

    /// The nearest thing that it knows of, may touch, and that nobody is at.
    fn nearest(&self, own: &BodyRecord, fits: impl Fn(&Remembered, &ObjectClass) -> bool) -> Option<ObjectId> {
        let is_free = |id: ObjectId, thing: &Remembered| {
            let banned = self.bans.get(&id).is_some_and(|ban| ban.until > self.tick);
            let mut about = self.memory.bodies_since(self.tick.saturating_sub(ABOUT));
            let at = thing.record.position_m;
            !banned && !about.any(|other| other.body != self.body && level_m(other.position_m, at) < AT_IT_M)
        };
        let known = self.memory.things().filter(|(id, thing)| {
            let class = self.catalog.classes().get(usize::from(thing.record.class));
            let in_reach = thing.record.held_by == NONE && thing.record.hidden == 0;
            in_reach && class.is_some_and(|class| fits(thing, class)) && is_free(*id, thing)
        });
        let far = |thing: &Remembered| level_m(thing.record.position_m, own.position_m);
        known.min_by(|(_, one), (_, other)| far(one).total_cmp(&far(other))).map(|(id, _)| id)
    }

    fn handle(&mut self, rule: &Rule, thing: ObjectId, deeds: &mut Vec<Deed>) -> bool {
        let action = match rule.then {
            Then::PutDown => {
                self.chore = Chore::PutOn(thing);
                Action::Place { receptacle: thing }
            }
            Then::Handle(handling) => {
                self.chore = Chore::With(thing);
                handling.on(thing)
            }
            Then::Wait | Then::Roam => return false,
        };
        deeds.push(Deed::Act { turn: 0, action: self.errand.begin(action) });
        let class = self.memory.thing(thing).map(|thing| SemanticClass::from_index(thing.record.class));
        let name = class.map_or_else(|| "thing".to_owned(), |class| class.name(&self.catalog).to_lowercase());
        self.say(rule.says.replace("{}", &name), deeds);
        true
    }

    fn go_on_rounds(&mut self, own: &BodyRecord, deeds: &mut Vec<Deed>) {
        let action = if self.chore == Chore::Walk {
            self.chore = Chore::Look;
            Action::LookAround
        } else {
            self.chore = Chore::Walk;
            let next = self.rounds.next(self.catalog.room_at(own.room));
            next.map_or(Action::LookAround, |target| Action::GoTo { target })
        };
        deeds.push(Deed::Act { turn: 0, action: self.errand.begin(action) });
    }

    /// An errand is over.
    fn conclude(&mut self, status: Status) {
        if let Chore::With(thing) | Chore::PutOn(thing) = self.chore {
            let ban = self.bans.entry(thing).or_default();
            if status.is_success() {
                *ban = Ban { until: self.tick + LEFT_ALONE, count: 0 };
            } else {
                ban.until = self.tick + (FIRST_BAN << ban.count);
                ban.count = (ban.count + 1).min(MOST_BANS);
            }
        }
        if let Chore::With(thing) = self.chore {
            // It will see how it is now.
            self.memory.forget(thing);
        }
        // Where it did not arrive there is nothing to look at.
        if self.chore != Chore::Walk || !status.is_success() {
            self.chore = Chore::Nothing;
        }
    }

    fn say(&mut self, words: String, deeds: &mut Vec<Deed>) {
        if words.is_empty() || self.said_at.is_some_and(|said| self.tick < said + SAYS_EVERY) {
            return;
        }
        self.said_at = Some(self.tick);
        deeds.push(Deed::Tell(Box::new(DialogMessage::new(DialogKind::Reply, self.body, 0, &words))));
    }
}

fn is_wanted(wanted: &Wanted, thing: &Remembered, class: &ObjectClass, table: &ActionTable) -> bool {
    let lies_so = match wanted.lies {
        Lies::Anywhere => !class.has(Property::Pickupable),
        Lies::OnTheFloor => {
            let stands_there = class.stands != Stands::OnSurface;
            thing.record.parent == NONE && thing.record.position_m[2] < FLOOR_M && !stands_there
        }
    };
    lies_so && wanted.classes.hold(&class.id, table) && wanted.condition.holds(class, flags(&thing.record))
}

/// Whether a person is so near, or so near ahead, that a body must not move on.
fn is_in_the_way(own: &BodyRecord, person: &BodyRecord) -> bool {
    let [dx, dy] = [0, 1].map(|axis| person.position_m[axis] - own.position_m[axis]);
    let far_m = level_m(person.position_m, own.position_m);
    let ahead_m = dx * libm::cosf(own.yaw_rad) + dy * libm::sinf(own.yaw_rad);
    far_m < NEAR_M || (far_m < AHEAD_M && ahead_m > far_m * AHEAD_COS)
}

impl Agent for Helper {
    fn senses(&self) -> Senses {
        Senses { sight: true, state: false }
    }

    fn hear(&mut self, heard: &Heard<'_>, deeds: &mut Vec<Deed>) {
        match *heard {
            Heard::Now(now) => self.live(now, deeds),
            Heard::Outcome { status, .. } => match self.errand.hear(status) {
                Some(Progress::Then(action)) => deeds.push(Deed::Act { turn: 0, action }),
                Some(Progress::Over) => self.conclude(status),
                None => {}
            },
            Heard::Commands(commands) => {
                self.commands = commands;
                self.errand.give_up();
                self.chore = Chore::Nothing;
            }
            // It has its rules.
            Heard::Plan { .. } => {}
        }
    }
}
