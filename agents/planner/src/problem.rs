//! A planning problem: variables with few values each, operators with conditional effects, goals that stay met.

use std::collections::HashMap;

use cohabit_cdf::{ActionKind, StateFlag, catalog::table::Term};

use crate::cnf::{Cnf, Literal};

/// A thing that matters, by its place in the list of those.
pub(crate) type Index = u16;

/// What a variable says.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub(crate) enum Var {
    /// Where a thing is: one of the places below.
    Place(Index),
    /// Whether a flag of it is set.
    Flag(Index, StateFlag),
    /// What fills it.
    Fluid(Index),
    /// Its colour.
    Color(Index),
    /// Whether the hand is full.
    Hand,
    /// What the body stands at: a thing, by its index and one.
    Near,
    /// Whether what eats was fed.
    Fed(Index),
    /// Whether the goal of that number is met.
    Met(u16),
    /// Whether one of several formulas holds: the one of that number among those that follow from the others.
    Derived(u16),
}

/// Places: in the hand, out of the world, elsewhere; in a slot; then in or on each thing.
pub(crate) mod place {
    use super::Index;

    pub const HELD: u16 = 0;
    pub const GONE: u16 = 1;
    pub const ELSEWHERE: u16 = 2;
    pub const SLOT: u16 = 3;
    const FIRST: u16 = 4;

    pub const fn on(thing: Index) -> u16 {
        FIRST + thing
    }

    pub fn parent(value: u16) -> Option<Index> {
        value.checked_sub(FIRST)
    }
}

/// A variable takes a value where a condition held before.
#[derive(Clone, Debug)]
pub(crate) struct Assign {
    pub when: Cnf,
    pub var: u32,
    pub value: u16,
    /// Whether it comes of the work of a machine: goals are judged before that, too.
    pub is_work: bool,
}

/// What an operator does in the world.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Deed {
    /// An action on a thing.
    Act(ActionKind, Index),
    /// Nothing: a goal is met, or a machine goes off.
    Nothing,
}

/// Who is meant by the terms of a rule.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Cast {
    pub it: Option<Index>,
    pub held: Option<Index>,
    pub holder: Option<Index>,
    pub machine: Option<Index>,
    pub basin: Option<Index>,
    pub thing: Option<Index>,
}

impl Cast {
    pub fn get(&self, term: Term) -> Option<Index> {
        match term {
            Term::It => self.it,
            Term::Held => self.held,
            Term::Holder => self.holder,
            Term::Machine => self.machine,
            Term::Basin => self.basin,
            Term::Thing => self.thing,
        }
    }
}

/// Where a clause that an operator needs comes from.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Reason {
    /// It is that way of the action.
    Way,
    /// The hand must be empty.
    EmptyHand,
    /// What is held must be.
    Held,
    /// The thing must be where it is taken to be.
    Holder,
    /// A need of a rule, and then of the device, by number.
    Need(usize, usize),
}

/// One grounded action.
#[derive(Clone, Debug)]
pub(crate) struct Operator {
    pub deed: Deed,
    /// What must hold, and for each clause where it comes from.
    pub needs: Cnf,
    pub reasons: Vec<Reason>,
    /// Who is meant by the terms of its rule.
    pub cast: Cast,
    /// The receptacle in which a place must be free.
    pub room: Option<Index>,
    pub effects: Vec<Assign>,
    /// What goes off again once it is over.
    pub runs: Vec<u32>,
}

/// All of it.
#[derive(Debug, Default)]
pub(crate) struct Problem {
    pub vars: Vec<Var>,
    by_var: HashMap<Var, u32>,
    pub initial: Vec<u16>,
    pub operators: Vec<Operator>,
    pub goals: Vec<Cnf>,
    /// Whether a goal opens again when it no longer holds.
    pub can_reset: Vec<bool>,
    /// How many things each thing that matters takes, and the places of those that may be there.
    pub capacity: HashMap<Index, usize>,
    /// The place variables of all things that move.
    pub places: Vec<u32>,
    /// Variables that follow from others: 1 where one of the formulas holds.
    pub derived: Vec<(u32, Vec<Cnf>)>,
}

impl Problem {
    /// The variable, made with this value at the beginning if there is none yet.
    pub fn var(&mut self, var: Var, initial: u16) -> u32 {
        if let Some(known) = self.by_var.get(&var) {
            return *known;
        }
        let id = u32::try_from(self.vars.len()).expect("invariant: fewer than 2^32 variables");
        self.vars.push(var);
        self.initial.push(initial);
        self.by_var.insert(var, id);
        if matches!(var, Var::Place(_)) {
            self.places.push(id);
        }
        id
    }

    /// A formula that holds where one of these does; as a variable of its own, where clauses would be too many.
    pub fn any_of(&mut self, formulas: Vec<Cnf>) -> Cnf {
        /// Clauses that are still fewer than a variable is worth.
        const MOST_CLAUSES: usize = 6;
        let formulas: Vec<Cnf> = formulas.into_iter().filter(|formula| !formula.is_false()).collect();
        let clauses = formulas.iter().fold(1_usize, |product, formula| product.saturating_mul(formula.0.len()));
        if clauses <= MOST_CLAUSES {
            return Cnf::any(formulas);
        }
        let known = self.derived.iter().find(|(_, known)| *known == formulas).map(|(var, _)| *var);
        let var = known.unwrap_or_else(|| {
            let number = u16::try_from(self.derived.len()).expect("invariant: few formulas");
            let now = formulas.iter().any(|formula| formula.holds(&self.initial));
            let var = self.var(Var::Derived(number), u16::from(now));
            self.derived.push((var, formulas));
            var
        });
        Cnf::literal(Literal::is(var, 1))
    }

    /// Works out what follows from other variables.
    pub fn derive(&self, state: &mut [u16]) {
        for (var, formulas) in &self.derived {
            state[*var as usize] = u16::from(formulas.iter().any(|formula| formula.holds(state)));
        }
    }

    pub fn find(&self, var: Var) -> Option<u32> {
        self.by_var.get(&var).copied()
    }

    /// Whether a place is free in a thing.
    pub fn has_room(&self, state: &[u16], receptacle: Index) -> bool {
        let here = place::on(receptacle);
        let taken = self.places.iter().filter(|var| state[**var as usize] == here).count();
        self.capacity.get(&receptacle).is_none_or(|capacity| taken < *capacity)
    }
}

impl Problem {
    /// Leaves out operators that bring about nothing that a goal, or another operator, asks for. To free the hand, things
    /// are put where a goal wants them, or on one of the tables.
    pub fn keep_relevant(&mut self, tables: &[Index]) {
        let hand = self.find(Var::Hand);
        let mut wanted = Wanted::new(self.vars.len());
        let mut cleared = std::collections::HashSet::new();
        self.goals.iter().for_each(|goal| wanted.ask(goal, &self.derived));
        let mut kept = vec![false; self.operators.len()];
        loop {
            let mut changed = false;
            for (index, operator) in self.operators.iter().enumerate() {
                if kept[index] {
                    continue;
                }
                let is_table =
                    matches!(operator.deed, Deed::Act(ActionKind::Place, receptacle) if tables.contains(&receptacle));
                let helps = operator.effects.iter().any(|effect| {
                    let frees = Some(effect.var) == hand && effect.value == 0;
                    if frees {
                        is_table && wanted.is_wanted(effect.var, 0)
                    } else {
                        wanted.is_wanted(effect.var, effect.value)
                    }
                });
                if helps {
                    kept[index] = true;
                    changed = true;
                    wanted.ask(&operator.needs, &self.derived);
                    operator.effects.iter().for_each(|effect| wanted.ask(&effect.when, &self.derived));
                    // Only of what is full now something has to be taken away first.
                    let full = operator.room.filter(|receptacle| !self.has_room(&self.initial, *receptacle));
                    if let Some(receptacle) = full.filter(|receptacle| cleared.insert(*receptacle)) {
                        wanted.clear(receptacle, self.places.as_slice());
                    }
                }
            }
            if !changed {
                break;
            }
        }
        let mut index = 0;
        self.operators.retain(|_| {
            index += 1;
            kept[index - 1]
        });
    }
}

/// A formula with each literal turned round, for who asks for them one by one: its negation in clauses may be huge.
fn opposite(formula: &Cnf) -> Cnf {
    let turned = |literal: &Literal| Literal { negated: !literal.negated, ..*literal };
    Cnf(formula.0.iter().map(|clause| clause.iter().map(turned).collect()).collect())
}

/// Values of variables that are asked for, by variable.
struct Wanted {
    values: Vec<Vec<u16>>,
    /// Values of which any other is wanted.
    others: Vec<Vec<u16>>,
}

impl Wanted {
    fn new(vars: usize) -> Self {
        Self { values: vec![Vec::new(); vars], others: vec![Vec::new(); vars] }
    }

    fn ask(&mut self, formula: &Cnf, derived: &[(u32, Vec<Cnf>)]) {
        for literal in formula.0.iter().flatten() {
            let asked = if literal.negated { &mut self.others } else { &mut self.values };
            let asked = &mut asked[literal.var as usize];
            if asked.contains(&literal.value) {
                continue;
            }
            asked.push(literal.value);
            if let Some((_, formulas)) = derived.iter().find(|(var, _)| *var == literal.var) {
                // What is not to follow asks for the opposite of what it follows from.
                for formula in formulas {
                    if literal.negated {
                        self.ask(&opposite(formula), derived);
                    } else {
                        self.ask(formula, derived);
                    }
                }
            }
        }
    }

    /// Whatever is in a receptacle may have to go.
    fn clear(&mut self, receptacle: Index, places: &[u32]) {
        for var in places {
            self.others[*var as usize].push(place::on(receptacle));
        }
    }

    fn is_wanted(&self, var: u32, value: u16) -> bool {
        let var = var as usize;
        self.values[var].contains(&value) || self.others[var].iter().any(|unwanted| *unwanted != value)
    }
}
