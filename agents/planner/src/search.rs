//! Greedy best-first search: the state that looks nearest to the goals comes first, and helpful actions before others. What a plan does in vain is
//! then left out.

use std::{
    cmp::Reverse,
    collections::{BinaryHeap, HashSet},
    time::Instant,
};

use crate::{
    limits::Limits,
    problem::{Deed, Problem, Var},
    relaxed::Relaxed,
};

/// A value that no operator has: nothing runs.
const NOTHING_RUNS: u16 = u16::MAX;

/// What came of a search.
pub(crate) enum Found {
    /// The operators of a plan.
    Plan(Vec<usize>),
    /// All that can be reached was seen.
    Exhausted,
    /// A limit was reached.
    OutOf(&'static str),
}

struct Node {
    state: Vec<u16>,
    parent: Option<(usize, usize)>,
}

/// Figures of a search.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Effort {
    pub expanded: usize,
}

struct Space<'p> {
    problem: &'p Problem,
    met: Vec<u32>,
    /// Indices, in the relaxed problem, of operators.
    real: Vec<usize>,
}

impl Space<'_> {
    /// Meets goals, as a world does at every tick.
    fn judge(&self, state: &mut [u16]) {
        for (number, goal) in self.problem.goals.iter().enumerate() {
            let met = self.met[number] as usize;
            if state[met] == 0 || self.problem.can_reset[number] {
                state[met] = u16::from(goal.holds(state));
            }
        }
    }

    /// Lets the machine that runs go off.
    fn settle(&self, state: &mut [u16]) {
        let last = state.len() - 1;
        let running = std::mem::replace(&mut state[last], NOTHING_RUNS);
        if let Some(operator) = self.problem.operators.get(usize::from(running)) {
            operator.runs.iter().for_each(|var| state[*var as usize] = 0);
            self.problem.derive(state);
            self.judge(state);
        }
    }

    fn is_applicable(&self, operator: usize, state: &[u16]) -> bool {
        let operator = &self.problem.operators[operator];
        operator.needs.holds(state) && operator.room.is_none_or(|receptacle| self.problem.has_room(state, receptacle))
    }

    /// The state after an operator; the machine that it sets going is still on.
    fn apply(&self, index: usize, before: &[u16]) -> Vec<u16> {
        let mut after = before.to_vec();
        let operator = &self.problem.operators[index];
        let follow = || operator.effects.iter().filter(|effect| effect.when.holds(before));
        for effect in follow().filter(|effect| !effect.is_work) {
            after[effect.var as usize] = effect.value;
        }
        if operator.effects.iter().any(|effect| effect.is_work) {
            // A machine is on before it has done its work.
            self.problem.derive(&mut after);
            self.judge(&mut after);
            for effect in follow().filter(|effect| effect.is_work) {
                after[effect.var as usize] = effect.value;
            }
        }
        if operator.runs.iter().any(|var| after[*var as usize] == 1) {
            let last = after.len() - 1;
            after[last] = u16::try_from(index).unwrap_or(NOTHING_RUNS);
        }
        self.problem.derive(&mut after);
        self.judge(&mut after);
        after
    }

    fn is_done(&self, state: &[u16]) -> bool {
        self.met.iter().all(|var| state[*var as usize] == 1)
    }

    /// A plan without what it does in vain: each operator is left out in turn, with those that cannot be done without it (action elimination).
    fn needed(&self, initial: &[u16], plan: Vec<usize>) -> Vec<usize> {
        let (mut plan, mut state, mut at) = (plan, initial.to_vec(), 0);
        while at < plan.len() {
            self.settle(&mut state);
            if let Some(rest) = self.without_first(&state, &plan[at..]) {
                plan.truncate(at);
                plan.extend(rest);
            } else {
                state = self.apply(plan[at], &state);
                at += 1;
            }
        }
        plan
    }

    /// What is left of the rest of a plan without its first operator, if that reaches the goals.
    fn without_first(&self, state: &[u16], rest: &[usize]) -> Option<Vec<usize>> {
        let (mut state, mut kept) = (state.to_vec(), Vec::new());
        for operator in &rest[1..] {
            self.settle(&mut state);
            if self.is_applicable(*operator, &state) {
                state = self.apply(*operator, &state);
                kept.push(*operator);
            }
        }
        let is_done = self.is_done(&state) || {
            self.settle(&mut state);
            self.is_done(&state)
        };
        is_done.then_some(kept)
    }
}

/// Looks for a plan.
pub(crate) fn search(problem: &Problem, relaxed: &Relaxed, limits: &Limits) -> (Found, Effort) {
    let started = Instant::now();
    let met = (0..problem.goals.len()).filter_map(|number| problem.find(Var::Met(u16::try_from(number).unwrap_or(0))));
    let mut real = Vec::new();
    for (index, operator) in problem.operators.iter().enumerate() {
        real.push(index);
        real.extend(operator.runs.iter().map(|_| usize::MAX));
    }
    let space = Space { problem, met: met.collect(), real };
    let mut effort = Effort::default();
    let mut initial = problem.initial.clone();
    initial.push(NOTHING_RUNS);
    problem.derive(&mut initial);
    space.judge(&mut initial);
    if space.is_done(&initial) {
        return (Found::Plan(Vec::new()), effort);
    }
    let found = |nodes: &[Node], at: usize| Found::Plan(space.needed(&nodes[0].state, path(nodes, at)));
    let mut nodes = vec![Node { state: initial.clone(), parent: None }];
    let mut seen: HashSet<Vec<u16>> = HashSet::from([initial]);
    let mut open: BinaryHeap<Reverse<(u32, u32, usize)>> = BinaryHeap::from([Reverse((0, 0, 0))]);
    while let Some(Reverse((_, _, index))) = open.pop() {
        effort.expanded += 1;
        if effort.expanded > limits.states {
            return (Found::OutOf("states"), effort);
        }
        if started.elapsed() > limits.time {
            return (Found::OutOf("time"), effort);
        }
        let mut state = nodes[index].state.clone();
        space.settle(&mut state);
        if space.is_done(&state) {
            return (found(&nodes, index), effort);
        }
        let outlook = relaxed.look(&state);
        let Some(distance) = outlook.distance else { continue };
        let helpful: HashSet<usize> =
            outlook.helpful.iter().filter_map(|index| space.real.get(*index).copied()).collect();
        for operator in 0..problem.operators.len() {
            if problem.operators[operator].deed == Deed::Nothing || !space.is_applicable(operator, &state) {
                continue;
            }
            let next = space.apply(operator, &state);
            if !seen.insert(next.clone()) {
                continue;
            }
            let done = space.is_done(&next);
            let at = nodes.len();
            nodes.push(Node { state: next, parent: Some((index, operator)) });
            if done {
                return (found(&nodes, at), effort);
            }
            let newest = u32::try_from(at).unwrap_or(u32::MAX);
            let rank = if helpful.contains(&operator) { distance } else { distance + OTHERS };
            open.push(Reverse((rank, u32::MAX - newest, at)));
        }
    }
    (Found::Exhausted, effort)
}

/// How much further away what is not helpful is taken to be.
const OTHERS: u32 = 6;

fn path(nodes: &[Node], mut index: usize) -> Vec<usize> {
    let mut operators = Vec::new();
    while let Some((parent, operator)) = nodes[index].parent {
        operators.push(operator);
        index = parent;
    }
    operators.reverse();
    operators
}
