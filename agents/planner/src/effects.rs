//! The changes of rules, devices and works as assignments to the variables of a problem.

use cohabit_cdf::{
    Color, Fluid, Property, StateFlag,
    catalog::table::{Change, Condition, Device, Effect, Over, Site, Term, Test, UNDONE, View as _},
    mission::Era,
};

use crate::{
    cnf::{Cnf, Literal},
    ground::Grounder,
    problem::{Assign, Cast, Index, Var, place},
};

/// What comes of an operator in the making.
#[derive(Default)]
pub(crate) struct Outcome {
    pub effects: Vec<Assign>,
    /// What goes off again once it is over.
    pub runs: Vec<u32>,
    /// Whether what is added now comes of the work of a machine.
    is_work: bool,
}

impl Outcome {
    pub fn assign(&mut self, var: u32, value: u16, when: Cnf) {
        self.effects.push(Assign { when, var, value, is_work: self.is_work });
    }
}

impl Grounder<'_> {
    /// Adds what follows from effects.
    pub fn effects(&mut self, cast: &Cast, effects: &[Effect], when: &Cnf, device: Option<&Device>, out: &mut Outcome) {
        for effect in effects {
            let condition = self.all(cast, &effect.when).and(when.clone());
            if condition.is_false() {
                continue;
            }
            for change in &effect.changes {
                let _: Option<()> = self.change(cast, change, &condition, device, out);
            }
        }
    }

    fn work(&mut self, work: &str, site: Index, by: Option<Index>, when: &Cnf, out: &mut Outcome) {
        let catalog = self.catalog;
        let Some(work) = catalog.table().work(work) else { return };
        let things = match work.over {
            Over::Machine => vec![(site, Cnf::constant(true))],
            Over::Contents => self.contents(site, true),
            Over::Inside => self.contents(site, false),
        };
        for (thing, is_there) in things {
            let cast = Cast { it: by, thing: Some(thing), machine: Some(site), ..Cast::default() };
            self.effects(&cast, &work.effects, &is_there.and(when.clone()), None, out);
        }
        let cast = Cast { it: by, machine: Some(site), ..Cast::default() };
        self.effects(&cast, &work.then, when, None, out);
    }

    fn set(&mut self, thing: Index, flag: StateFlag, value: bool, when: &Cnf, out: &mut Outcome) {
        let var = self.flag_var(thing, flag);
        out.assign(var, u16::from(value), when.clone());
    }

    fn put(&mut self, thing: Index, value: u16, when: &Cnf, out: &mut Outcome) {
        if let Some(var) = self.place(thing) {
            out.assign(var, value, when.clone());
        }
    }

    fn fill(&mut self, thing: Index, fluid: Fluid, when: &Cnf, out: &mut Outcome) {
        let var = self.fluid_var(thing);
        out.assign(var, fluid as u16, when.clone());
    }

    fn free_hand(&mut self, held: Index, when: &Cnf, out: &mut Outcome) {
        let hand = self.problem.var(Var::Hand, 0);
        out.assign(hand, 0, when.clone());
        self.set(held, StateFlag::PickedUp, false, when, out);
    }

    #[allow(clippy::too_many_lines)]
    fn change(
        &mut self,
        cast: &Cast,
        change: &Change,
        when: &Cnf,
        device: Option<&Device>,
        out: &mut Outcome,
    ) -> Option<()> {
        let of = |term: &Term| cast.get(*term);
        match change {
            Change::Set(term, flag, value) => self.set(of(term)?, *flag, *value, when, out),
            Change::Copy(flag, from, to) => {
                for value in [false, true] {
                    let same = self.flag(of(from)?, *flag, value).and(when.clone());
                    self.set(of(to)?, *flag, value, &same, out);
                }
            }
            Change::Fill(term, fluid) => self.fill(of(term)?, *fluid, when, out),
            Change::Pour(from, to) => {
                for fluid in Fluid::ALL {
                    let var = self.fluid_var(of(from)?);
                    let same = Cnf::literal(Literal::is(var, fluid as u16)).and(when.clone());
                    self.fill(of(to)?, fluid, &same, out);
                }
                self.fill(of(from)?, Fluid::None, when, out);
            }
            Change::Drain(term, fluid) => {
                let machine = of(term)?;
                let mut all = self.contents(machine, true);
                all.push((machine, Cnf::constant(true)));
                for (thing, is_there) in all {
                    let var = self.fluid_var(thing);
                    let full = Cnf::literal(Literal::is(var, *fluid as u16));
                    self.fill(thing, Fluid::None, &full.and(is_there).and(when.clone()), out);
                }
            }
            Change::Paint(term, color) => self.paint(of(term)?, *color, when, out),
            Change::Take(term) => {
                let thing = of(term)?;
                let hand = self.problem.var(Var::Hand, 0);
                out.assign(hand, 1, when.clone());
                self.set(thing, StateFlag::PickedUp, true, when, out);
                self.put(thing, place::HELD, when, out);
            }
            Change::Put(term, to) => {
                self.free_hand(of(term)?, when, out);
                self.put(of(term)?, place::on(of(to)?), when, out);
            }
            Change::Throw(term) => {
                self.free_hand(of(term)?, when, out);
                self.put(of(term)?, place::ELSEWHERE, when, out);
            }
            Change::Send(term, gate) => self.send(of(term)?, of(gate)?, when, out),
            Change::Flip(term, other) => {
                for on in [false, true] {
                    let before = self.flag(of(term)?, StateFlag::Toggled, !on).and(when.clone());
                    for thing in std::iter::once(of(term)?).chain(other.as_ref().and_then(of)) {
                        self.set(thing, StateFlag::Toggled, on, &before, out);
                    }
                }
            }
            Change::Run(term, other) => {
                for thing in std::iter::once(of(term)?).chain(other.as_ref().and_then(of)) {
                    self.set(thing, StateFlag::Toggled, true, when, out);
                    out.runs.push(self.flag_var(thing, StateFlag::Toggled));
                }
                let device = device?;
                let target = |machine: Index| {
                    let works = self.id(machine).and_then(|id| self.state.machine(id))?;
                    self.index.get(&works).copied()
                };
                let site = match device.at {
                    Site::It => of(term),
                    Site::Machine => cast.machine,
                    Site::Target => cast.machine.and_then(target),
                };
                let (work, site) = (device.work.as_deref()?, site?);
                out.is_work = true;
                self.work(work, site, of(term), when, out);
                out.is_work = false;
            }
            Change::Feed(term, by) => {
                let circuit = self.id(of(term)?).and_then(|id| self.state.thing(id).feeds)?;
                for fed in [false, true] {
                    let before = self.flag(of(by)?, StateFlag::Toggled, !fed).and(when.clone());
                    self.feed(circuit, fed, &before, out);
                }
            }
            Change::SwingDoors => self.swing_doors(when, out),
            Change::Settle(term) => {
                let catalog = self.catalog;
                let work = catalog.table().device(&self.class(of(term)?).id).shut_work.as_deref()?;
                let cast = Cast { it: of(term), ..Cast::default() };
                let powered = Condition { negated: false, term: Term::It, test: Test::Powered };
                let powered = self.condition(&cast, &powered).and(when.clone());
                self.work(work, of(term)?, of(term), &powered, out);
            }
            Change::Slice(term) => {
                let whole = of(term)?;
                let slice = self.catalog.table().slice(&self.class(whole).id)?;
                let product = self.product(self.catalog.find(slice)?, None)?;
                for parent in self.parents[usize::from(whole)].clone() {
                    let there = self.is_on(whole, parent).and(when.clone());
                    self.put(product, place::on(parent), &there, out);
                }
            }
            Change::Restore(term) => self.restore(of(term)?, cast.machine, true, when, out),
            Change::Become(term, class) => {
                let (thing, machine) = (of(term)?, cast.machine?);
                let product = self.product(self.catalog.find(class)?, Some(machine));
                for (inner, is_in) in self.contents(thing, false) {
                    self.put(inner, place::GONE, &is_in.and(when.clone()), out);
                }
                self.put(thing, place::GONE, when, out);
                self.put(product?, place::on(machine), when, out);
            }
            Change::Print(term) => self.print(of(term)?, when, out),
            Change::Spawn(term, class) => {
                let product = self.product(self.catalog.find(class)?, Some(of(term)?))?;
                self.put(product, place::on(of(term)?), when, out);
            }
            Change::Remove(term) => self.put(of(term)?, place::GONE, when, out),
            Change::Resize(term) => {
                for large in [false, true] {
                    let before = self.flag(of(term)?, StateFlag::Embiggenated, !large).and(when.clone());
                    self.set(of(term)?, StateFlag::Embiggenated, large, &before, out);
                }
            }
            Change::Vend(term, slot) => {
                let sold = self.sold(of(term)?, *slot)?;
                let there = self.is_at(sold, place::SLOT).and(when.clone());
                self.put(sold, place::on(of(term)?), &there, out);
            }
            Change::Approach(_) | Change::Turn(_) | Change::Scan(_) | Change::Read(_) | Change::Sound(..) => {}
        }
        Some(())
    }

    fn paint(&mut self, thing: Index, color: Color, when: &Cnf, out: &mut Outcome) {
        let var = self.color_var(thing);
        out.assign(var, color as u16, when.clone());
    }

    fn print(&mut self, printer: Index, when: &Cnf, out: &mut Outcome) {
        let table = self.catalog.table();
        for (cartridge, is_in) in self.contents(printer, false) {
            let Some(by_class) = table.prints(&self.class(cartridge).id).and_then(|class| self.catalog.find(class))
            else {
                continue;
            };
            let said = self.id(cartridge).and_then(|id| self.state.thing(id).prints);
            if let Some(product) = self.product(said.unwrap_or(by_class), Some(printer)) {
                self.put(product, place::on(printer), &is_in.and(when.clone()), out);
            }
        }
    }

    fn restore(&mut self, thing: Index, machine: Option<Index>, uneaten: bool, when: &Cnf, out: &mut Outcome) {
        let known = self.id(thing).map(|id| self.state.thing(id).clone());
        let to = machine.map_or(place::ELSEWHERE, place::on);
        if let Some(was) = known.as_ref().and_then(|thing| thing.was).and_then(|was| self.index.get(&was).copied()) {
            self.put(thing, place::GONE, when, out);
            self.put(was, to, when, out);
            return;
        }
        let own = self.things[usize::from(thing)].class;
        let by_class = self.catalog.table().yesterday(&self.class(thing).id).and_then(|class| self.catalog.find(class));
        let class = known.and_then(|thing| thing.yesterday).or(by_class).filter(|class| *class != own);
        match class {
            Some(class) => {
                self.put(thing, place::GONE, when, out);
                if let Some(product) = self.product(class, None) {
                    self.put(product, to, when, out);
                }
            }
            None => {
                for flag in UNDONE.into_iter().filter(|flag| uneaten || *flag != StateFlag::Eaten) {
                    self.set(thing, flag, false, when, out);
                }
            }
        }
    }

    fn feed(&mut self, circuit: i32, fed: bool, when: &Cnf, out: &mut Outcome) {
        let table = self.catalog.table();
        for thing in self.indices() {
            if self.id(thing).and_then(|id| self.state.thing(id).circuit) != Some(circuit) {
                continue;
            }
            let class = self.class(thing);
            if class.has(Property::Powerable) {
                self.set(thing, StateFlag::Powered, fed, when, out);
                if fed {
                    self.set(thing, StateFlag::Overloaded, false, when, out);
                } else if !table.device(&class.id).stays_without_power {
                    self.set(thing, StateFlag::Toggled, false, when, out);
                }
            }
            if !fed {
                self.set(thing, StateFlag::Sparking, false, when, out);
            }
        }
    }

    fn swing_doors(&mut self, when: &Cnf, out: &mut Outcome) {
        let doors: Vec<Index> = self.state.doors.iter().filter_map(|door| self.index.get(door).copied()).collect();
        let mut all_open = Cnf::constant(true);
        for door in &doors {
            all_open = all_open.and(self.flag(*door, StateFlag::Opened, true));
        }
        for (open, before) in [(true, all_open.not()), (false, all_open)] {
            for door in &doors {
                self.set(*door, StateFlag::Opened, open, &before.clone().and(when.clone()), out);
            }
        }
    }

    /// Sends what is held through a portal, to the time that it leads to now.
    fn send(&mut self, thing: Index, gate: Index, when: &Cnf, out: &mut Outcome) {
        self.free_hand(thing, when, out);
        let Some(gate_id) = self.id(gate) else { return };
        let Some(known) = self.state.gates.get(&gate_id) else { return };
        let era = known.ways[known.current].1;
        let eats =
            self.id(thing).is_some_and(|id| self.state.eaters.get(&gate_id).is_some_and(|liked| liked.contains(&id)));
        match era {
            Era::Past if eats => {
                let fed = self.problem.var(Var::Fed(gate), u16::from(self.state.fed.contains(&gate_id)));
                out.assign(fed, 1, when.clone());
                let eatable = self.class(thing).has(Property::Eatable);
                if eatable {
                    self.set(thing, StateFlag::Eaten, true, when, out);
                }
                self.put(thing, if eatable { place::ELSEWHERE } else { place::GONE }, when, out);
            }
            Era::Past => {
                self.put(thing, place::ELSEWHERE, when, out);
                self.set(thing, StateFlag::Dirty, false, when, out);
                self.restore(thing, None, false, when, out);
            }
            Era::Future => {
                self.put(thing, place::ELSEWHERE, when, out);
                for flag in [StateFlag::Hot, StateFlag::Cold, StateFlag::Cereal] {
                    self.set(thing, flag, false, when, out);
                }
                self.fill(thing, Fluid::None, when, out);
                if self.class(thing).has(Property::Dirtyable) {
                    self.set(thing, StateFlag::Dirty, true, when, out);
                }
            }
        }
    }
}
