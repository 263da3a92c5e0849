//! The successor of a state: what an action leads to, by the table.

use super::{Access, Place, SymbolicState, Thing};
use crate::{
    action::{ObjectId, Status},
    catalog::{
        ClassId, Property,
        table::{ActionKind, Change, Device, GROWTH, Judgement, Over, Scope, Site, Term, UNDONE, View},
    },
    mission::Era,
    state::{Fluid, StateFlag},
};

/// What comes of an action.
#[derive(Clone, Debug)]
pub struct Successor {
    /// How the world answers.
    pub status: Status,
    /// The name of the rule that says so.
    pub rule: String,
    /// What was lacking, in the words of the table; empty, if nothing was.
    pub lack: String,
    /// The state while a machine is on that was set going, if one was: its work is done.
    pub running: Option<SymbolicState>,
    /// The state once everything is over.
    pub state: SymbolicState,
}

/// A machine that was set going.
struct Run {
    device: ObjectId,
    also: Option<ObjectId>,
}

impl SymbolicState {
    /// What an action on a thing leads to; none, if the table has no rule for it.
    #[must_use]
    pub fn successor(&self, action: ActionKind, it: ObjectId) -> Option<Successor> {
        let catalog = std::sync::Arc::clone(&self.catalog);
        let judgement = catalog.table().judge(self, action, it)?;
        let rule = judgement.rule;
        let done = |status, lack: String, running, state| {
            Some(Successor { status, rule: rule.name.clone(), lack, running, state })
        };
        if let Some(need) = judgement.lack {
            let mut state = self.clone();
            if need.status == Status::KilledByHazard {
                state.alive = false;
                state.let_go();
            }
            return done(need.status, need.words.clone(), None, state);
        }
        let but = Scope::of(it).lacks(self, &rule.but);
        let status = but.map_or(Status::ActionSuccessful, |need| need.status);
        let touches = but.is_none() && action != ActionKind::GoTo;
        let (running, state) = self.after(&judgement, it, touches);
        done(status, but.map(|need| need.words.clone()).unwrap_or_default(), running, state)
    }

    /// The state that an action is meant to lead to, once everything is over: as if it lacked nothing. For who cannot tell
    /// whether it does; none, if the table has no rule for it.
    #[must_use]
    pub fn expected(&self, action: ActionKind, it: ObjectId) -> Option<Self> {
        let catalog = std::sync::Arc::clone(&self.catalog);
        let judgement = catalog.table().judge(self, action, it)?;
        Some(self.after(&judgement, it, action != ActionKind::GoTo).1)
    }

    /// The state while a machine is on that an action set going, if one was, and the state once everything is over.
    fn after(&self, judgement: &Judgement<'_>, it: ObjectId, touches: bool) -> (Option<Self>, Self) {
        let scope = Scope::of(it);
        let mut state = self.clone();
        let press = judgement.device.map_or(&[][..], |device| &device.press);
        let mut run = None;
        for change in scope.changes(self, &judgement.rule.effects).into_iter().chain(scope.changes(self, press)) {
            state.apply(self, &scope, change, &mut run);
        }
        state.at(it).touched |= touches;
        let mut running = None;
        if let (Some(run), Some(device)) = (run, judgement.device) {
            let on = state.clone();
            state.work(&on, device, &run);
            running = Some(state.clone());
            for id in std::iter::once(run.device).chain(run.also) {
                state.set(id, StateFlag::Toggled, false);
            }
        }
        (running, state)
    }

    /// Does the work of a device that runs.
    fn work(&mut self, on: &Self, device: &Device, run: &Run) {
        let site = match device.at {
            Site::It => Some(run.device),
            Site::Machine => on.thing(run.device).works,
            Site::Target => on.target(run.device),
        };
        if let (Some(site), Some(work)) = (site, &device.work) {
            self.work_at(on, work, site, run.device);
        }
    }

    /// Does a work to what is at `site`, as it is in `on`; `by` is what was pressed for it.
    fn work_at(&mut self, on: &Self, work: &str, site: ObjectId, by: ObjectId) {
        let catalog = std::sync::Arc::clone(&self.catalog);
        let Some(work) = catalog.table().work(work) else { return };
        let things = match work.over {
            Over::Contents => on.contents(site),
            Over::Inside => on.inside(site),
            Over::Machine => vec![site],
        };
        let each = things.into_iter().map(|thing| (Some(thing), &work.effects));
        for (thing, effects) in each.chain([(None, &work.then)]) {
            let scope = Scope { it: Some(by), thing, machine: Some(site) };
            for change in scope.changes(on, effects) {
                self.apply(on, &scope, change, &mut None);
            }
        }
    }

    /// Makes one change that follows from the state `before`.
    fn apply(&mut self, before: &Self, scope: &Scope, change: &Change, run: &mut Option<Run>) {
        let id = |term: Term| scope.get(before, term);
        let _: Option<()> = (|| {
            match change {
                Change::Set(of, flag, value) => self.set(id(*of)?, *flag, *value),
                Change::Copy(flag, from, to) => self.set(id(*to)?, *flag, before.is(id(*from)?, *flag)),
                Change::Fill(of, fluid) => self.at(id(*of)?).fluid = *fluid,
                Change::Pour(from, to) => {
                    let (from, to) = (id(*from)?, id(*to)?);
                    if before.fluid(to) == Fluid::None {
                        self.at(to).fluid = before.fluid(from);
                        self.at(from).fluid = Fluid::None;
                    }
                }
                Change::Drain(of, fluid) => {
                    let of = id(*of)?;
                    for inner in std::iter::once(of).chain(before.contents(of)) {
                        if before.fluid(inner) == *fluid {
                            self.at(inner).fluid = Fluid::None;
                        }
                    }
                }
                Change::Paint(of, color) => self.at(id(*of)?).color = *color,
                Change::Approach(of) => self.at(id(*of)?).access = Access::AT_HAND,
                Change::Take(of) => self.take(id(*of)?),
                Change::Put(of, to) => self.put(id(*of)?, id(*to)?),
                Change::Throw(_) => self.let_go(),
                Change::Send(of, by) => self.send(before, id(*of)?, id(*by)?),
                Change::Flip(of, other) => {
                    let on = !before.is(id(*of)?, StateFlag::Toggled);
                    for id in std::iter::once(id(*of)?).chain(other.and_then(id)) {
                        self.set(id, StateFlag::Toggled, on);
                    }
                }
                Change::Run(of, other) => {
                    let started = Run { device: id(*of)?, also: other.and_then(id) };
                    for id in std::iter::once(started.device).chain(started.also) {
                        self.set(id, StateFlag::Toggled, true);
                    }
                    *run = Some(started);
                }
                Change::Feed(of, by) => {
                    let fed = !before.is(id(*by)?, StateFlag::Toggled);
                    self.feed(before.thing(id(*of)?).feeds?, fed);
                }
                Change::SwingDoors => {
                    let open = before.doors.iter().any(|door| !before.is(*door, StateFlag::Opened));
                    before.doors.iter().for_each(|door| self.set(*door, StateFlag::Opened, open));
                }
                Change::Turn(of) => {
                    let gate = self.gates.get_mut(&id(*of)?)?;
                    gate.current = (gate.current + 1) % gate.ways.len();
                }
                Change::Settle(of) => self.settle(before, id(*of)?),
                Change::Slice(of) => self.slice(before, id(*of)?),
                Change::Restore(of) => self.restore(before, id(*of)?, true),
                Change::Become(of, class) => self.become_one(before, id(*of)?, class),
                Change::Print(of) => self.print(before, id(*of)?),
                Change::Spawn(of, class) => {
                    let (of, class) = (id(*of)?, self.catalog.find(class)?);
                    let anchor = before.free_anchors(of).first()?.index;
                    self.spawn(class, before.on(of, anchor), of, Some(of), None);
                }
                Change::Remove(of) => self.remove(id(*of)?),
                Change::Resize(of) => {
                    let large = before.is(id(*of)?, StateFlag::Embiggenated);
                    self.set(id(*of)?, StateFlag::Embiggenated, !large);
                    let factor = if large { 1.0 / GROWTH } else { GROWTH };
                    self.at(id(*of)?).scale = before.thing(id(*of)?).scale.map(|side| side * factor);
                }
                Change::Vend(of, slot) => {
                    let (of, thing) = (id(*of)?, before.in_slot(id(*of)?, *slot)?);
                    let tray = before.free_anchors(of).into_iter().find(|anchor| !before.is_slot(of, anchor.index))?;
                    self.at(thing).place = before.on(of, tray.index);
                }
                Change::Scan(_) | Change::Read(_) | Change::Sound(..) => {}
            }
            Some(())
        })();
    }

    fn at(&mut self, id: ObjectId) -> &mut Thing {
        &mut self.things[id.0 as usize]
    }

    fn set(&mut self, id: ObjectId, flag: StateFlag, value: bool) {
        self.at(id).flags.set(flag, value);
    }

    /// A place at an anchor of a receptacle: all anchors of what has a door are behind it.
    fn on(&self, parent: ObjectId, anchor: u16) -> Place {
        let _ = self;
        Place::On { parent, anchors: vec![anchor], within: true }
    }

    fn take(&mut self, id: ObjectId) {
        if self.held != Some(id) {
            self.let_go();
        }
        self.at(id).place = Place::Held;
        self.set(id, StateFlag::PickedUp, true);
        self.held = Some(id);
    }

    /// Takes what is held out of the hand.
    fn let_go(&mut self) {
        if let Some(held) = self.held.take() {
            self.set(held, StateFlag::PickedUp, false);
            self.at(held).place = Place::Loose;
        }
    }

    fn put(&mut self, id: ObjectId, receptacle: ObjectId) {
        let anchors = self.place_for(receptacle, id).into_iter().collect();
        self.let_go();
        self.at(id).place = Place::On { parent: receptacle, anchors, within: true };
        self.at(id).room = self.thing(receptacle).room;
        self.at(id).access = self.thing(receptacle).access;
    }

    /// Takes a thing out of the world; what stood on it takes its place.
    fn remove(&mut self, id: ObjectId) {
        let place = self.thing(id).place.clone();
        for child in self.children(id) {
            self.at(child).place = match &place {
                Place::On { .. } => place.clone(),
                _ => Place::Own,
            };
        }
        self.at(id).place = Place::Gone;
        self.set(id, StateFlag::PickedUp, false);
    }

    /// Adds a thing at a place, beside or in `near`; what a machine makes is named after it, by every name that it has.
    fn spawn(&mut self, class: ClassId, place: Place, near: ObjectId, by: Option<ObjectId>, was: Option<ObjectId>) {
        let beside = self.thing(near);
        let class_id = &self.catalog.class(class).id;
        let maker = by.map(|by| self.thing(by));
        let stem = maker.map_or_else(|| class_id.clone(), |maker| format!("{}_Spawned_{class_id}", maker.instance));
        let instance = self.free_instance(&stem);
        let aliases = maker.map_or_else(Vec::new, |maker| {
            maker.aliases.iter().map(|alias| instance.replacen(&maker.instance, alias, 1)).collect()
        });
        let thing = Thing { aliases, was, access: beside.access, ..Thing::new(instance, class, beside.room, place) };
        self.things.push(thing);
    }

    /// `stem_1`, or the next number that nothing ever had.
    fn free_instance(&self, stem: &str) -> String {
        let free =
            |name: &String| !self.things.iter().any(|thing| thing.instance == *name || thing.aliases.contains(name));
        (1_u32..).map(|number| format!("{stem}_{number}")).find(free).unwrap_or_default()
    }

    fn slice(&mut self, before: &Self, id: ObjectId) {
        let Some(class) = self.catalog.table().slice(&before.class(id).id).and_then(|class| self.catalog.find(class))
        else {
            return;
        };
        let Some(parent) = before.parent(id) else { return };
        if let Some(anchor) = before.any_place_for(parent, self.catalog.class(class).size_m) {
            self.spawn(class, before.on(parent, anchor), parent, None, None);
        }
    }

    /// Makes a thing what it was yesterday, where it is in `self`.
    fn restore(&mut self, before: &Self, id: ObjectId, uneaten: bool) {
        let thing = before.thing(id);
        let place = self.thing(id).place.clone();
        if let Some(was) = thing.was {
            self.remove(id);
            self.at(was).place = place;
            return;
        }
        let of_class = self.catalog.table().yesterday(&before.class(id).id);
        let class = thing.yesterday.or_else(|| of_class.and_then(|class| self.catalog.find(class)));
        match class.filter(|class| *class != thing.class) {
            Some(class) => {
                self.remove(id);
                self.spawn(class, place, id, None, None);
            }
            None => {
                let undone = UNDONE.into_iter().filter(|flag| uneaten || *flag != StateFlag::Eaten);
                undone.for_each(|flag| self.set(id, flag, false));
            }
        }
    }

    fn become_one(&mut self, before: &Self, id: ObjectId, class: &str) {
        let Some(class) = self.catalog.find(class) else { return };
        let place = before.thing(id).place.clone();
        for gone in before.contents(id).into_iter().rev().chain([id]) {
            self.remove(gone);
        }
        let maker = before.parent(id);
        self.spawn(class, place, id, maker, Some(id));
    }

    fn print(&mut self, before: &Self, printer: ObjectId) {
        let table = self.catalog.table();
        let loaded = before.children(printer).into_iter().filter_map(|child| {
            let by_class = self.catalog.find(table.prints(&before.class(child).id)?)?;
            let thing = before.thing(child);
            Some((thing.touched, thing.prints.unwrap_or(by_class)))
        });
        let Some((_, class)) = loaded.max_by_key(|(touched, _)| *touched) else { return };
        if let Some(anchor) = before.free_anchors(printer).last() {
            self.spawn(class, before.on(printer, anchor.index), printer, Some(printer), None);
        }
    }

    /// What follows as something is shut, or gets power while it is.
    fn settle(&mut self, before: &Self, id: ObjectId) {
        let catalog = std::sync::Arc::clone(&self.catalog);
        let work = &catalog.table().device(&before.class(id).id).shut_work;
        if let Some(work) = work.as_ref().filter(|_| before.is_powered(id)) {
            self.work_at(before, work, id, id);
        }
    }

    /// Feeds or cuts a circuit: what hangs on it gets power or goes off; what is overloaded or sparks calms down.
    fn feed(&mut self, circuit: i32, fed: bool) {
        let catalog = std::sync::Arc::clone(&self.catalog);
        self.circuits.insert(circuit, fed);
        let on_it: Vec<ObjectId> = self.existing().filter(|id| self.thing(*id).circuit == Some(circuit)).collect();
        for id in &on_it {
            let class = catalog.class(self.thing(*id).class);
            if class.has(Property::Powerable) {
                self.set(*id, StateFlag::Powered, fed);
                if fed {
                    self.set(*id, StateFlag::Overloaded, false);
                } else if !catalog.table().device(&class.id).stays_without_power {
                    self.set(*id, StateFlag::Toggled, false);
                }
            }
            if !fed {
                self.set(*id, StateFlag::Sparking, false);
            }
        }
        if fed {
            let powered = self.clone();
            for id in on_it {
                if powered.is_shut(id) {
                    self.settle(&powered, id);
                }
                if let Some(work) = catalog.table().power_work() {
                    self.work_at(&powered, work, id, id);
                }
            }
        }
    }

    /// Sends a thing through an open portal: it comes back at its foot.
    fn send(&mut self, before: &Self, id: ObjectId, gate: ObjectId) {
        let Some((_, era)) = before.gates.get(&gate).map(|gate| gate.ways[gate.current].clone()) else { return };
        self.let_go();
        self.at(id).place = Place::Own;
        let all: Vec<ObjectId> = std::iter::once(id).chain(before.contents(id)).collect();
        let eats = before.eaters.get(&gate).is_some_and(|liked| liked.contains(&id));
        match era {
            Era::Past if eats && !before.is(id, StateFlag::Eaten) => {
                self.fed.insert(gate);
                if before.class(id).has(Property::Eatable) {
                    self.set(id, StateFlag::Eaten, true);
                } else {
                    self.remove(id);
                }
            }
            Era::Past => {
                all.iter().for_each(|id| self.set(*id, StateFlag::Dirty, false));
                self.restore(before, id, false);
            }
            Era::Future => {
                for id in all {
                    for flag in [StateFlag::Hot, StateFlag::Cold, StateFlag::Cereal] {
                        self.set(id, flag, false);
                    }
                    self.at(id).fluid = Fluid::None;
                    if before.class(id).has(Property::Dirtyable) {
                        self.set(id, StateFlag::Dirty, true);
                    }
                }
            }
        }
    }
}
