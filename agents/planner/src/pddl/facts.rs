//! The names of a problem's facts: variables with values as predicates of things.

use std::{
    collections::{BTreeSet, HashSet},
    fmt::Write as _,
};

use cohabit_cdf::{Color, Fluid};

use crate::{
    cnf::{Cnf, Literal},
    ground::Grounder,
    problem::{Assign, Deed, Index, Problem, Var, place},
};

/// A problem with names for all that is in it.
pub(super) struct Facts<'a> {
    pub problem: &'a Problem,
    /// The name of each thing that matters.
    pub things: Vec<String>,
    /// The values that each variable may have.
    values: Vec<BTreeSet<u16>>,
}

/// A text as a name in PDDL. It has no hyphens: those part the parts of an action's name.
pub(super) fn name(text: &str) -> String {
    let fits = |letter: char| if letter.is_ascii_alphanumeric() { letter.to_ascii_lowercase() } else { '_' };
    let name: String = text.chars().map(fits).collect();
    if name.starts_with(|letter: char| letter.is_ascii_alphabetic()) { name } else { format!("x_{name}") }
}

impl<'a> Facts<'a> {
    pub fn new(grounder: &'a Grounder<'_>) -> Self {
        let problem = &grounder.problem;
        let mut taken = HashSet::new();
        let things = grounder.things.iter().map(|thing| {
            let plain = name(thing.names.first().map_or("thing", String::as_str));
            let mut own = plain.clone();
            let mut number = 2;
            while !taken.insert(own.clone()) {
                own = format!("{plain}__{number}");
                number += 1;
            }
            own
        });
        Self { things: things.collect(), values: values(problem), problem }
    }

    /// The name of a thing.
    pub fn thing(&self, thing: Index) -> &str {
        &self.things[usize::from(thing)]
    }

    /// The name of an operator that is an action; that of one that is not is never asked for.
    pub fn action(&self, operator: usize) -> String {
        match self.problem.operators[operator].deed {
            Deed::Act(kind, thing) => format!("{}-{}-{operator}", kind.name(), self.thing(thing)),
            Deed::Nothing => format!("nothing-{operator}"),
        }
    }

    /// That a variable has a value; of one that is true or false, that it is true.
    pub fn atom(&self, var: u32, value: u16) -> String {
        match self.problem.vars[var as usize] {
            Var::Place(thing) => format!("(at {} {})", self.thing(thing), self.place(value)),
            Var::Flag(thing, flag) => format!("({} {})", flag_name(flag), self.thing(thing)),
            Var::Fluid(thing) => format!("(holds {} {})", self.thing(thing), fluid_name(value)),
            Var::Color(thing) => format!("(colored {} {})", self.thing(thing), color_name(value)),
            Var::Hand => "(hand-full)".to_owned(),
            Var::Near => format!("(near {})", value.checked_sub(1).map_or("elsewhere", |thing| self.thing(thing))),
            Var::Fed(thing) => format!("(is-fed {})", self.thing(thing)),
            Var::Met(goal) if self.can_reset(goal) => format!("(holding-{goal})"),
            Var::Met(goal) => format!("(met-{goal})"),
            Var::Derived(number) => format!("(derived-{number})"),
        }
    }

    fn place(&self, value: u16) -> &str {
        match value {
            place::HELD => "in-hand",
            place::GONE => "nowhere",
            place::ELSEWHERE => "elsewhere",
            place::SLOT => "behind-glass",
            other => place::parent(other).map_or("elsewhere", |parent| self.thing(parent)),
        }
    }

    /// Whether a goal opens again when it no longer holds.
    pub fn can_reset(&self, goal: u16) -> bool {
        self.problem.can_reset.get(usize::from(goal)).copied().unwrap_or(false)
    }

    /// Whether a variable is true or false.
    pub fn is_switch(var: Var) -> bool {
        !matches!(var, Var::Place(_) | Var::Fluid(_) | Var::Color(_) | Var::Near)
    }

    /// Whether a variable follows from others.
    pub fn follows(&self, var: Var) -> bool {
        match var {
            Var::Derived(_) => true,
            Var::Met(goal) => self.can_reset(goal),
            _ => false,
        }
    }

    fn literal(&self, literal: Literal) -> String {
        let atom = self.atom(literal.var, literal.value);
        let is_positive = if Self::is_switch(self.problem.vars[literal.var as usize]) {
            (literal.value == 1) != literal.negated
        } else {
            !literal.negated
        };
        if is_positive { atom } else { format!("(not {atom})") }
    }

    /// The clauses of a formula, each in one line.
    pub fn clauses(&self, formula: &Cnf) -> Vec<String> {
        let clause = |clause: &Vec<Literal>| {
            let literals: Vec<String> = clause.iter().map(|literal| self.literal(*literal)).collect();
            if literals.len() == 1 { literals.concat() } else { format!("(or {})", literals.join(" ")) }
        };
        formula.0.iter().map(clause).collect()
    }

    /// A formula as one condition.
    pub fn formula(&self, formula: &Cnf) -> String {
        all(&self.clauses(formula))
    }

    /// What assignments that are made at once do, the later ones first where they are about the same variable.
    pub fn effects(&self, assigns: &[&Assign]) -> Vec<String> {
        let mut effects = Vec::new();
        for (index, assign) in assigns.iter().enumerate() {
            let against = |later: &&&Assign| later.var == assign.var && later.value != assign.value;
            let later: Vec<&Assign> = assigns[index + 1..].iter().filter(against).copied().collect();
            if assign.when.is_false() || later.iter().any(|later| later.when.is_true()) {
                continue;
            }
            let mut when = self.clauses(&assign.when);
            let overruled = later.iter().filter(|later| !later.when.is_false());
            when.extend(overruled.map(|later| format!("(not {})", self.formula(&later.when))));
            let change = self.change(assign.var, assign.value);
            effects.push(if when.is_empty() { change } else { format!("(when {} {change})", all(&when)) });
        }
        effects
    }

    /// A variable takes a value, and has no other.
    fn change(&self, var: u32, value: u16) -> String {
        let atom = self.atom(var, value);
        if Self::is_switch(self.problem.vars[var as usize]) {
            return if value == 1 { atom } else { format!("(not {atom})") };
        }
        let mut change = format!("(and {atom}");
        for other in self.values[var as usize].iter().filter(|other| **other != value) {
            let _ = write!(change, " (not {})", self.atom(var, *other));
        }
        change.push(')');
        change
    }

    /// The things that may come to be in or on another, by their place variables.
    pub fn may_be_on(&self, receptacle: Index) -> Vec<u32> {
        let here = place::on(receptacle);
        let places = self.problem.places.iter().copied();
        places.filter(|var| self.values[*var as usize].contains(&here)).collect()
    }

    /// That the thing of a place variable is in or on another.
    pub fn is_on(&self, var: u32, receptacle: Index) -> String {
        self.atom(var, place::on(receptacle))
    }
}

/// All conditions in one.
pub(super) fn all(conditions: &[String]) -> String {
    match conditions {
        [one] => one.clone(),
        several => format!("(and {})", several.join(" ")),
    }
}

/// `Toggled`: `is-toggled`.
pub(super) fn flag_name(flag: cohabit_cdf::StateFlag) -> String {
    let mut name = "is".to_owned();
    for letter in format!("{flag:?}").chars() {
        if letter.is_ascii_uppercase() {
            name.push('-');
        }
        name.push(letter.to_ascii_lowercase());
    }
    name
}

fn fluid_name(value: u16) -> String {
    let fluid = Fluid::ALL.get(usize::from(value)).copied().unwrap_or_default();
    format!("fluid-{}", fluid.name().to_lowercase())
}

fn color_name(value: u16) -> String {
    let color = Color::ALL.get(usize::from(value)).copied().unwrap_or_default();
    format!("color-{}", color.name().to_lowercase())
}

/// The values of each variable that are spoken of.
fn values(problem: &Problem) -> Vec<BTreeSet<u16>> {
    let mut values: Vec<BTreeSet<u16>> = problem.initial.iter().map(|value| BTreeSet::from([*value])).collect();
    let assigns = || problem.operators.iter().flat_map(|operator| &operator.effects);
    for assign in assigns() {
        values[assign.var as usize].insert(assign.value);
    }
    let needs = problem.operators.iter().map(|operator| &operator.needs).chain(&problem.goals);
    let conditions = assigns().map(|assign| &assign.when);
    let derived = problem.derived.iter().flat_map(|(_, formulas)| formulas);
    for literal in needs.chain(conditions).chain(derived).flat_map(|formula| &formula.0).flatten() {
        values[literal.var as usize].insert(literal.value);
    }
    values
}
