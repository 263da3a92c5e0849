//! The table's conditions over the things that matter, as formulas.

use std::collections::HashMap;

use cohabit_cdf::{
    Catalog, ClassId, Fluid, ObjectClass, ObjectId, Property, StateFlag,
    catalog::table::{Condition, Content, Test, View as _},
    symbolic::{Place, SymbolicState},
};

use crate::{
    cnf::{Cnf, Literal},
    matter::{Matter, may_hold, moves},
    problem::{Cast, Index, Problem, Var, place},
};

/// A state, the things of it that matter, and the problem that is made of them.
pub(crate) struct Grounder<'a> {
    pub state: &'a SymbolicState,
    pub catalog: &'a Catalog,
    pub things: Vec<Matter>,
    pub index: HashMap<ObjectId, Index>,
    pub problem: Problem,
    /// For each thing, those that it may come to be in or on.
    pub parents: Vec<Vec<Index>>,
    /// For each thing, those that may come to be in or on it.
    pub children: Vec<Vec<Index>>,
    pub moves: Vec<bool>,
    pub tables: Vec<Index>,
}

impl<'a> Grounder<'a> {
    pub fn new(state: &'a SymbolicState, things: Vec<Matter>) -> Self {
        let number = |index: usize| Index::try_from(index).expect("invariant: fewer than 2^16 things matter");
        let index = (0..).zip(&things).filter_map(|(index, thing)| Some((thing.id?, number(index)))).collect();
        let moves = things.iter().map(|thing| thing.id.is_none_or(|id| moves(state, id))).collect();
        let mut grounder = Self {
            state,
            catalog: &state.catalog,
            parents: vec![Vec::new(); things.len()],
            children: vec![Vec::new(); things.len()],
            things,
            index,
            problem: Problem::default(),
            moves,
            tables: Vec::new(),
        };
        let tables = crate::matter::tables(state);
        grounder.tables = tables.into_iter().filter_map(|id| grounder.index.get(&id).copied()).collect();
        grounder.find_places();
        grounder
    }

    pub fn indices(&self) -> impl Iterator<Item = Index> + use<> {
        0..Index::try_from(self.things.len()).expect("invariant: fewer than 2^16 things matter")
    }

    pub fn class(&self, thing: Index) -> &'a ObjectClass {
        self.catalog.class(self.things[usize::from(thing)].class)
    }

    pub fn id(&self, thing: Index) -> Option<ObjectId> {
        self.things[usize::from(thing)].id
    }

    pub fn name(&self, thing: Index) -> String {
        let class = self.class(thing);
        let word =
            if class.name.is_empty() { class.words.first().map_or("thing", String::as_str) } else { &class.name };
        format!("the {}", word.to_lowercase())
    }

    pub fn moves(&self, thing: Index) -> bool {
        self.moves[usize::from(thing)]
    }

    /// Which things may come to be where.
    fn find_places(&mut self) {
        for parent in self.indices() {
            let Some(id) = self.id(parent) else { continue };
            if self.class(parent).receptacle.is_none() {
                continue;
            }
            let places = self.state.capacity(id);
            self.problem.capacity.insert(parent, places);
            for child in self.indices().filter(|child| *child != parent) {
                let made_here = self.id(child).is_none() && self.is_device(parent);
                let fits = || {
                    may_hold(self.class(parent), self.class(child))
                        && self.id(child).is_none_or(|thing| self.state.fits_anywhere(id, thing))
                };
                if self.moves(child) && places > 0 && (made_here || fits()) {
                    self.link(parent, child);
                }
            }
        }
        // Where they are now, and what they hold that does not matter.
        for child in self.indices() {
            let parent = self.id(child).and_then(|id| self.state.parent(id));
            if let Some(parent) = parent.and_then(|parent| self.index.get(&parent).copied()) {
                self.link(parent, child);
            }
        }
        for parent in self.indices() {
            let Some(id) = self.id(parent) else { continue };
            let others = self.state.children(id);
            let fixed = others.iter().filter(|child| {
                self.index.get(child).is_none_or(|child| !self.moves(*child)) || self.is_on_top(**child)
            });
            let fixed = fixed.count();
            if let Some(capacity) = self.problem.capacity.get_mut(&parent) {
                *capacity = capacity.saturating_sub(fixed);
            }
        }
        let moving: Vec<Index> = self.indices().filter(|thing| self.moves(*thing)).collect();
        for thing in moving {
            let initial = self.initial_place(thing);
            self.problem.var(Var::Place(thing), initial);
        }
        self.problem.var(Var::Hand, u16::from(self.state.held.is_some()));
    }

    fn link(&mut self, parent: Index, child: Index) {
        if !self.parents[usize::from(child)].contains(&parent) {
            self.parents[usize::from(child)].push(parent);
            self.children[usize::from(parent)].push(child);
        }
    }

    fn is_device(&self, thing: Index) -> bool {
        self.catalog.table().is_device(&self.class(thing).id) || self.class(thing).has(Property::Receptacle)
    }

    fn is_on_top(&self, id: ObjectId) -> bool {
        matches!(self.state.thing(id).place, Place::On { within: false, .. })
    }

    fn initial_place(&self, thing: Index) -> u16 {
        let Some(id) = self.id(thing) else { return place::GONE };
        match &self.state.thing(id).place {
            Place::Held => place::HELD,
            Place::Gone => place::GONE,
            Place::On { .. } if self.state.is_behind_glass(id) => place::SLOT,
            Place::On { parent, within: true, .. } => {
                self.index.get(parent).map_or(place::ELSEWHERE, |parent| place::on(*parent))
            }
            _ => place::ELSEWHERE,
        }
    }

    /// The place variable of what moves.
    pub fn place(&mut self, thing: Index) -> Option<u32> {
        self.problem.find(Var::Place(thing))
    }

    pub fn is_at(&mut self, thing: Index, value: u16) -> Cnf {
        match self.place(thing) {
            Some(var) => Cnf::literal(Literal::is(var, value)),
            None => Cnf::constant(self.initial_place(thing) == value),
        }
    }

    pub fn is_on(&mut self, thing: Index, parent: Index) -> Cnf {
        self.is_at(thing, place::on(parent))
    }

    pub fn flag_var(&mut self, thing: Index, flag: StateFlag) -> u32 {
        let now = self.id(thing).is_some_and(|id| self.state.is(id, flag));
        self.problem.var(Var::Flag(thing, flag), u16::from(now))
    }

    pub fn flag(&mut self, thing: Index, flag: StateFlag, value: bool) -> Cnf {
        Cnf::literal(Literal::is(self.flag_var(thing, flag), u16::from(value)))
    }

    pub fn fluid_var(&mut self, thing: Index) -> u32 {
        let now = self.id(thing).map_or(Fluid::None, |id| self.state.fluid(id));
        self.problem.var(Var::Fluid(thing), now as u16)
    }

    pub fn color_var(&mut self, thing: Index) -> u32 {
        let now = self.id(thing).map_or(0, |id| self.state.thing(id).color as u16);
        self.problem.var(Var::Color(thing), now)
    }

    fn is_filled(&mut self, thing: Index) -> Cnf {
        if !self.class(thing).has(Property::Fillable)
            && self.id(thing).is_none_or(|id| self.state.fluid(id) == Fluid::None)
        {
            return Cnf::constant(false);
        }
        Cnf::literal(Literal::is_not(self.fluid_var(thing), Fluid::None as u16))
    }

    fn has_door(&self, thing: Index) -> bool {
        let class = self.class(thing);
        class.receptacle.as_ref().is_some_and(|kind| kind.enclosed) && class.has(Property::Openable)
    }

    /// Whether nothing shut is around a thing.
    fn uncovered(&mut self, thing: Index, depth: u32) -> Cnf {
        let mut all = Cnf::constant(true);
        for parent in self.parents[usize::from(thing)].clone() {
            let outer = if depth == 0 || self.parents[usize::from(parent)].is_empty() {
                Cnf::constant(true)
            } else {
                self.uncovered(parent, depth - 1)
            };
            let open =
                if self.has_door(parent) { self.flag(parent, StateFlag::Opened, true) } else { Cnf::constant(true) };
            let free = open.and(outer);
            if !free.is_true() {
                let away = self.is_on(thing, parent).not();
                all = all.and(away.or(free));
            }
        }
        all
    }

    /// Things that are in another, directly or in something that is: the formula for each.
    pub fn contents(&mut self, of: Index, any_depth: bool) -> Vec<(Index, Cnf)> {
        let mut all = Vec::new();
        for child in self.children[usize::from(of)].clone() {
            let here = self.is_on(child, of);
            if here.is_false() {
                continue;
            }
            if any_depth {
                for inner in self.children[usize::from(child)].clone() {
                    let deep = self.is_on(inner, child).and(here.clone());
                    // What is carried in a dish is so from the beginning: nobody plans to stack.
                    let stacked = self.initial_place(inner) == place::on(child);
                    if stacked && inner != of {
                        all.push((inner, deep));
                    }
                }
            }
            all.push((child, here));
        }
        all
    }

    pub fn condition(&mut self, cast: &Cast, condition: &Condition) -> Cnf {
        let found = match condition.test {
            Test::Never => Cnf::constant(false),
            Test::DoorsClear => Cnf::constant(true),
            _ => match cast.get(condition.term) {
                Some(thing) => self.test(cast, thing, &condition.test),
                None => Cnf::constant(false),
            },
        };
        if condition.negated { found.not() } else { found }
    }

    pub fn all(&mut self, cast: &Cast, conditions: &[Condition]) -> Cnf {
        let mut all = Cnf::constant(true);
        for condition in conditions {
            all = all.and(self.condition(cast, condition));
            if all.is_false() {
                break;
            }
        }
        all
    }

    fn test(&mut self, cast: &Cast, thing: Index, test: &Test) -> Cnf {
        let class = self.class(thing);
        let known = Cnf::constant;
        match test {
            Test::Exists => self.is_at(thing, place::GONE).not(),
            Test::Free => known(self.id(thing).is_none_or(|id| !self.state.is_in_another_hand(id))),
            Test::PutDown | Test::Held => {
                let held = if cast.held == Some(thing) { known(true) } else { self.is_at(thing, place::HELD) };
                if *test == Test::Held { held } else { held.not() }
            }
            Test::Uncovered => self.uncovered(thing, 1),
            // A plan goes to each thing before it acts on it.
            Test::Within(_) | Test::Accessible | Test::OnTheWay | Test::Clear => known(true),
            Test::BehindGlass => self.is_at(thing, place::SLOT),
            Test::Affords(property) => known(class.has(*property)),
            Test::Is(flag) => self.flag(thing, *flag, true),
            Test::IsA(pattern) => known(pattern.matches(&class.id)),
            Test::InHeld => match cast.held {
                Some(held) if held == thing => known(true),
                Some(held) => self.is_on(thing, held),
                None => known(false),
            },
            Test::Filled => self.is_filled(thing),
            Test::Holds(fluid) => Cnf::literal(Literal::is(self.fluid_var(thing), *fluid as u16)),
            Test::HoldsA(pattern) => {
                let inside = self.contents(thing, false);
                let fit = inside.into_iter().filter(|(child, _)| pattern.matches(&self.class(*child).id));
                Cnf::any(fit.map(|(_, is_in)| is_in).collect::<Vec<_>>())
            }
            Test::HoldsWhole(pattern) => {
                let mut all = Vec::new();
                for (child, is_in) in self.contents(thing, false) {
                    if pattern.matches(&self.class(child).id) {
                        all.push(is_in.and(self.flag(child, StateFlag::Broken, false)));
                    }
                }
                self.problem.any_of(all)
            }
            Test::Contains(content) => {
                let mut all = Vec::new();
                for (inner, is_in) in self.contents(thing, true) {
                    let fits = match content {
                        Content::Filled => self.is_filled(inner),
                        Content::Fluid(fluid) => Cnf::literal(Literal::is(self.fluid_var(inner), *fluid as u16)),
                        Content::Class(pattern) => known(pattern.matches(&self.class(inner).id)),
                    };
                    all.push(is_in.and(fits));
                }
                self.problem.any_of(all)
            }
            Test::Shut => {
                if self.has_door(thing) {
                    self.flag(thing, StateFlag::Opened, false)
                } else {
                    known(false)
                }
            }
            Test::Powered => {
                if class.has(Property::Powerable) {
                    self.flag(thing, StateFlag::Powered, true)
                } else {
                    known(true)
                }
            }
            Test::Occupied => {
                let others = self.id(thing).map_or_else(Vec::new, |id| self.state.inside(id));
                if others.iter().any(|other| !self.index.contains_key(other)) {
                    return known(true);
                }
                Cnf::any(self.contents(thing, false).into_iter().map(|(_, is_in)| is_in).collect::<Vec<_>>())
            }
            Test::TakesHeld => known(cast.held.is_some_and(|held| may_hold(class, self.class(held)))),
            Test::Keyed => known(class.receptacle.as_ref().is_some_and(|kind| !kind.keys.is_empty())),
            Test::HasRoomForHeld => {
                known(cast.held.is_some_and(|held| self.parents[usize::from(held)].contains(&thing)))
            }
            Test::HasRoom | Test::HasFreePlace => known(class.receptacle.is_some()),
            Test::HasCartridge => {
                let table = self.catalog.table();
                let inside = self.contents(thing, false);
                let fit = inside.into_iter().filter(|(child, _)| table.prints(&self.class(*child).id).is_some());
                Cnf::any(fit.map(|(_, is_in)| is_in).collect::<Vec<_>>())
            }
            Test::Sells(slot) => match self.sold(thing, *slot) {
                Some(sold) => self.is_at(sold, place::SLOT),
                None => known(false),
            },
            Test::Feeds => known(self.id(thing).is_some_and(|id| self.state.feeds(id))),
            Test::Gate => known(self.id(thing).is_some_and(|id| self.state.gate(id).is_some())),
            Test::OpenGate => {
                let open = self.flag(thing, StateFlag::Toggled, true);
                open.and(self.test(cast, thing, &Test::Powered))
            }
            Test::LetsHeldPass => {
                let both = self.id(thing).zip(cast.held.and_then(|held| self.id(held)));
                known(both.is_none_or(|(gate, held)| self.state.lets_pass(gate, held)))
            }
            Test::AnswersAlways => known(self.catalog.table().device(&class.id).answers_always),
            Test::DoorsClear | Test::Never => known(false),
        }
    }

    /// What is in a slot of a machine now.
    pub fn sold(&self, machine: Index, slot: u16) -> Option<Index> {
        self.state.in_slot(self.id(machine)?, slot).and_then(|id| self.index.get(&id).copied())
    }

    /// A product of a class that is not there yet; one that this machine makes, if there are several.
    pub fn product(&self, class: ClassId, maker: Option<Index>) -> Option<Index> {
        let of_class = |index: &Index| {
            let thing = &self.things[usize::from(*index)];
            thing.id.is_none() && thing.class == class
        };
        let name = maker.and_then(|maker| self.things[usize::from(maker)].names.first().cloned());
        let is_named = |index: &Index| {
            let own = &self.things[usize::from(*index)].names[0];
            match &name {
                Some(name) => own.starts_with(&format!("{name}_Spawned_")),
                None => !own.contains("_Spawned_"),
            }
        };
        self.indices().filter(of_class).find(is_named)
    }
}
