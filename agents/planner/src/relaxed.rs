//! How far a goal is if nothing that is done is ever undone: the heuristic of FF, on costs that add up.

use std::collections::HashMap;

use crate::{
    cnf::{Clause, Cnf, Literal},
    problem::{Deed, Problem, Var},
};

const NEVER: u32 = u32::MAX / 4;

/// One effect of an operator, alone.
struct Part {
    operator: usize,
    when: Vec<Clause>,
    var: usize,
    value: usize,
}

/// A problem without what is undone.
pub(crate) struct Relaxed {
    /// Where the values of each variable begin among all facts.
    first: Vec<usize>,
    facts: usize,
    needs: Vec<Vec<Clause>>,
    costs: Vec<u32>,
    parts: Vec<Part>,
    parts_of: Vec<Vec<usize>>,
    goals: Vec<usize>,
    /// Operators whose needs or effects ask for a variable.
    watchers: Vec<Vec<usize>>,
}

/// What comes of looking ahead from a state.
pub(crate) struct Outlook {
    /// Actions of a plan that ignores what is undone; none if there is none.
    pub distance: Option<u32>,
    /// The operators of it.
    pub helpful: Vec<usize>,
    pub fact_costs: Vec<u32>,
}

impl Relaxed {
    pub fn new(problem: &Problem) -> Self {
        let mut domain: Vec<usize> = problem.initial.iter().map(|value| usize::from(*value) + 1).collect();
        let mut widen = |var: u32, value: u16| {
            let known = &mut domain[var as usize];
            *known = (*known).max(usize::from(value) + 1);
        };
        for operator in &problem.operators {
            operator.effects.iter().for_each(|effect| widen(effect.var, effect.value));
        }
        let all = problem.operators.iter().map(|operator| &operator.needs).chain(&problem.goals);
        let conditions = problem.operators.iter().flat_map(|operator| &operator.effects).map(|effect| &effect.when);
        let conditions = conditions.chain(problem.derived.iter().flat_map(|(_, formulas)| formulas));
        for literal in all.chain(conditions).flat_map(|cnf| &cnf.0).flatten() {
            widen(literal.var, literal.value);
        }
        for (index, var) in problem.vars.iter().enumerate() {
            if matches!(var, Var::Met(_) | Var::Flag(..) | Var::Hand | Var::Derived(_)) {
                domain[index] = domain[index].max(2);
            }
        }
        let mut first = Vec::with_capacity(domain.len());
        let mut facts = 0;
        for size in &domain {
            first.push(facts);
            facts += size;
        }
        let mut relaxed = Self {
            first,
            facts,
            needs: Vec::new(),
            costs: Vec::new(),
            parts: Vec::new(),
            parts_of: Vec::new(),
            goals: Vec::new(),
            watchers: vec![Vec::new(); domain.len()],
        };
        for operator in &problem.operators {
            let mut needs = operator.needs.0.clone();
            if let Some(full) = full_now(problem, operator.room) {
                needs.push(full);
            }
            let effects = operator.effects.iter().map(|effect| (effect.when.0.clone(), effect.var, effect.value));
            relaxed.push(needs, u32::from(operator.deed != Deed::Nothing), effects);
            for var in &operator.runs {
                // What runs for a moment goes off by itself.
                relaxed.push(vec![vec![Literal::is(*var, 1)]], 0, std::iter::once((Vec::new(), *var, 0)));
            }
        }
        for (var, formulas) in &problem.derived {
            for formula in formulas {
                relaxed.push(formula.0.clone(), 0, std::iter::once((Vec::new(), *var, 1)));
            }
            relaxed.push(Vec::new(), 0, std::iter::once((Vec::new(), *var, 0)));
        }
        for (number, goal) in problem.goals.iter().enumerate() {
            let met = problem.find(Var::Met(u16::try_from(number).unwrap_or(0)));
            let Some(met) = met else { continue };
            relaxed.push(goal.0.clone(), 0, std::iter::once((Vec::new(), met, 1)));
            relaxed.goals.push(relaxed.first[met as usize] + 1);
        }
        relaxed
    }

    fn push(&mut self, needs: Vec<Clause>, cost: u32, effects: impl Iterator<Item = (Vec<Clause>, u32, u16)>) {
        let operator = self.needs.len();
        let mut parts = Vec::new();
        let mut watched: Vec<u32> = needs.iter().flatten().map(|literal| literal.var).collect();
        for (when, var, value) in effects {
            watched.extend(when.iter().flatten().map(|literal| literal.var));
            parts.push(self.parts.len());
            self.parts.push(Part { operator, when, var: var as usize, value: usize::from(value) });
        }
        watched.sort_unstable();
        watched.dedup();
        for var in watched {
            self.watchers[var as usize].push(operator);
        }
        self.needs.push(needs);
        self.costs.push(cost);
        self.parts_of.push(parts);
    }

    fn domain(&self, var: usize) -> std::ops::Range<usize> {
        self.first[var]..self.first.get(var + 1).copied().unwrap_or(self.facts)
    }

    /// The cheapest fact that makes a clause hold, with its cost.
    fn cheapest(&self, clause: &Clause, costs: &[u32]) -> (u32, usize) {
        let mut best = (NEVER, usize::MAX);
        for literal in clause {
            let var = literal.var as usize;
            let fact = self.first[var] + usize::from(literal.value);
            if literal.negated {
                for other in self.domain(var).filter(|other| *other != fact) {
                    if costs[other] < best.0 {
                        best = (costs[other], other);
                    }
                }
            } else if costs[fact] < best.0 {
                best = (costs[fact], fact);
            }
        }
        best
    }

    fn sum(&self, clauses: &[Clause], costs: &[u32]) -> u32 {
        let mut sum = 0_u32;
        for clause in clauses {
            sum = sum.saturating_add(self.cheapest(clause, costs).0);
            if sum >= NEVER {
                return NEVER;
            }
        }
        sum
    }

    pub fn look(&self, state: &[u16]) -> Outlook {
        let mut costs = vec![NEVER; self.facts];
        let mut supporter = vec![usize::MAX; self.facts];
        for (var, value) in state.iter().enumerate().take(self.first.len()) {
            costs[self.first[var] + usize::from(*value)] = 0;
        }
        let mut todo: Vec<usize> = (0..self.needs.len()).collect();
        let mut queued = vec![true; self.needs.len()];
        while !todo.is_empty() {
            let mut next = Vec::new();
            for operator in todo.drain(..) {
                queued[operator] = false;
                let base = self.sum(&self.needs[operator], &costs);
                if base >= NEVER {
                    continue;
                }
                for part_index in &self.parts_of[operator] {
                    let part = &self.parts[*part_index];
                    let cost = base + self.sum(&part.when, &costs) + self.costs[operator];
                    let fact = self.first[part.var] + part.value;
                    if cost < costs[fact] {
                        costs[fact] = cost;
                        supporter[fact] = *part_index;
                        for watcher in &self.watchers[part.var] {
                            if !queued[*watcher] {
                                queued[*watcher] = true;
                                next.push(*watcher);
                            }
                        }
                    }
                }
            }
            todo = next;
        }
        let reachable = self.goals.iter().all(|fact| costs[*fact] < NEVER);
        let (distance, helpful) = if reachable { self.extract(&costs, &supporter) } else { (None, Vec::new()) };
        Outlook { distance, helpful, fact_costs: costs }
    }

    /// The plan that the costs stand for.
    fn extract(&self, costs: &[u32], supporter: &[usize]) -> (Option<u32>, Vec<usize>) {
        let mut todo = self.goals.clone();
        let mut seen = vec![false; self.facts];
        let mut used: HashMap<usize, ()> = HashMap::new();
        let mut distance = 0;
        let mut order = Vec::new();
        while let Some(fact) = todo.pop() {
            if seen[fact] || costs[fact] == 0 && supporter[fact] == usize::MAX {
                continue;
            }
            seen[fact] = true;
            let Some(part) = self.parts.get(supporter[fact]) else { continue };
            todo.extend(part.when.iter().map(|clause| self.cheapest(clause, costs).1));
            if used.insert(part.operator, ()).is_none() {
                distance += self.costs[part.operator];
                order.push(part.operator);
                todo.extend(self.needs[part.operator].iter().map(|clause| self.cheapest(clause, costs).1));
            }
        }
        (Some(distance), order)
    }

    /// Whether a formula can ever hold, by the costs of facts.
    pub fn can_hold(&self, formula: &Cnf, costs: &[u32]) -> bool {
        self.sum(&formula.0, costs) < NEVER
    }

    /// The first clause of a formula that can never hold.
    pub fn never<'c>(&self, formula: &'c Cnf, costs: &[u32]) -> Option<(usize, &'c Clause)> {
        formula.0.iter().enumerate().find(|(_, clause)| self.cheapest(clause, costs).0 >= NEVER)
    }
}

/// Where a receptacle is full now: something of it has to be taken away first.
fn full_now(problem: &Problem, room: Option<u16>) -> Option<Clause> {
    let receptacle = room?;
    if problem.has_room(&problem.initial, receptacle) {
        return None;
    }
    let here = crate::problem::place::on(receptacle);
    let inside = problem.places.iter().filter(|var| problem.initial[**var as usize] == here);
    Some(inside.map(|var| Literal::is_not(*var, here)).collect())
}
