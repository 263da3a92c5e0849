//! The goals of a mission as formulas over the things that matter.

use cohabit_cdf::{
    Expression, Fluid, Goal, GoalState, InstancePattern, Mission, Predicate, Property, Relation, StateFlag,
    catalog::table::View as _,
};

use crate::{
    cnf::{Cnf, Literal},
    ground::Grounder,
    matter::is_meant,
    problem::{Index, Var, place},
};

impl Grounder<'_> {
    /// Adds all goals of a mission; some may be met already.
    pub fn goals(&mut self, mission: &Mission, met: &[bool]) {
        for number in 0..mission.goals.len() {
            let var = Var::Met(u16::try_from(number).expect("invariant: few goals"));
            self.problem.var(var, u16::from(met.get(number).copied().unwrap_or(false)));
        }
        for goal in &mission.goals {
            let before = goal.preconditions.iter().filter_map(|id| mission.goals.iter().position(|one| one.id == *id));
            let before: Vec<usize> = before.collect();
            let mut formula = self.goal(mission, goal);
            for number in before {
                let var = self.problem.var(Var::Met(u16::try_from(number).unwrap_or(0)), 0);
                formula = formula.and(Cnf::literal(Literal::is(var, 1)));
            }
            self.problem.goals.push(formula);
            self.problem.can_reset.push(goal.can_reset);
        }
    }

    fn goal(&mut self, mission: &Mission, goal: &Goal) -> Cnf {
        let states: Vec<Cnf> = goal.states.iter().map(|state| self.goal_state(mission, state)).collect();
        match goal.relation {
            Relation::And if states.is_empty() => Cnf::constant(false),
            Relation::And => Cnf::all(states),
            Relation::Or => self.problem.any_of(states),
        }
    }

    fn meant(&self, pattern: &InstancePattern) -> Vec<Index> {
        let class = pattern.class_in(self.catalog);
        let is_one = |index: &Index| {
            let thing = &self.things[usize::from(*index)];
            class.map_or_else(|| is_meant(pattern, &thing.names, &self.class(*index).id), |class| thing.class == class)
        };
        self.indices().filter(is_one).collect()
    }

    /// Whether something holds of any thing that is meant and there.
    fn any(&mut self, pattern: &InstancePattern, mut holds: impl FnMut(&mut Self, Index) -> Cnf) -> Cnf {
        let mut all = Vec::new();
        for thing in self.meant(pattern) {
            // What is there from the beginning, and never made, can only be taken away on purpose.
            let there =
                if self.id(thing).is_some() { Cnf::constant(true) } else { self.is_at(thing, place::GONE).not() };
            all.push(holds(self, thing).and(there));
        }
        self.problem.any_of(all)
    }

    fn goal_state(&mut self, mission: &Mission, state: &GoalState) -> Cnf {
        let of = &state.instance;
        match &state.predicate {
            Predicate::Flag(flag, value) => self.any(of, |own, thing| own.has_flag(thing, *flag, *value)),
            Predicate::Filled(fluid) => self.any(of, |own, thing| own.holds(thing, *fluid)),
            Predicate::FilledWithAny => self.any(of, |own, thing| own.holds(thing, Fluid::None).not()),
            Predicate::Color(color) => self.any(of, |own, thing| own.is_colored(thing, *color as u16)),
            Predicate::Contains(what) => self.any(of, |own, thing| own.contains(thing, what)),
            Predicate::ContainsCereal(value) => {
                self.any(of, |own, thing| own.has_flag(thing, StateFlag::Cereal, *value))
            }
            Predicate::Empty(value) => self.any(of, |own, thing| {
                let empty = own.is_empty(thing);
                if *value { empty } else { empty.not() }
            }),
            Predicate::Condition(name, value) => match mission.condition(name, &of.0) {
                Some(condition) => {
                    let holds = self.expression(&condition.expression);
                    if *value { holds } else { holds.not() }
                }
                None => Cnf::constant(false),
            },
        }
    }

    fn expression(&mut self, expression: &Expression) -> Cnf {
        match expression {
            Expression::And(all) => Cnf::all(all.iter().map(|part| self.expression(part)).collect::<Vec<_>>()),
            Expression::Or(any) => {
                let parts: Vec<Cnf> = any.iter().map(|part| self.expression(part)).collect();
                self.problem.any_of(parts)
            }
            Expression::Not(inner) => self.expression(inner).not(),
            Expression::Flag { target, flag, value } => {
                self.any(target, |own, thing| own.has_flag(thing, *flag, *value))
            }
            Expression::Contains { target, contains } => self.any(target, |own, thing| own.contains(thing, contains)),
            Expression::FilledWith { target, fluid } => self.any(target, |own, thing| own.holds(thing, *fluid)),
            Expression::FilledWithAny { target } => self.any(target, |own, thing| own.holds(thing, Fluid::None).not()),
            // Who goes to a thing stands before it, and faces it.
            Expression::CanBeSeen { target, .. } | Expression::InRange { target, .. } => {
                self.any(target, Self::is_near)
            }
            Expression::HasColor { target, color } => {
                self.any(target, |own, thing| own.is_colored(thing, *color as u16))
            }
            Expression::DinoFed { target, value } => {
                let fed = self.dino_fed(target);
                if *value { fed } else { fed.not() }
            }
            Expression::IsReceptacle { target, value } => {
                self.any(target, |own, thing| Cnf::constant(own.class(thing).has(Property::Receptacle) == *value))
            }
            Expression::IsFull { target, value } => self.any(target, |own, thing| {
                let full = own.is_full(thing);
                if *value { full } else { full.not() }
            }),
        }
    }

    fn has_flag(&mut self, thing: Index, flag: StateFlag, value: bool) -> Cnf {
        self.flag(thing, flag, value)
    }

    fn holds(&mut self, thing: Index, fluid: Fluid) -> Cnf {
        Cnf::literal(Literal::is(self.fluid_var(thing), fluid as u16))
    }

    fn is_colored(&mut self, thing: Index, color: u16) -> Cnf {
        Cnf::literal(Literal::is(self.color_var(thing), color))
    }

    fn is_near(&mut self, thing: Index) -> Cnf {
        Cnf::literal(Literal::is(self.problem.var(Var::Near, 0), thing + 1))
    }

    fn contains(&mut self, receptacle: Index, what: &InstancePattern) -> Cnf {
        let meant = self.meant(what);
        let inside = self.contents(receptacle, true);
        let fit = inside.into_iter().filter(|(thing, _)| meant.contains(thing)).map(|(_, is_in)| is_in);
        let fit = fit.collect();
        self.problem.any_of(fit)
    }

    fn is_empty(&mut self, thing: Index) -> Cnf {
        let others = self.id(thing).map_or_else(Vec::new, |id| self.state.inside(id));
        if others.iter().any(|other| !self.index.contains_key(other)) {
            return Cnf::constant(false);
        }
        let out = self.contents(thing, false).into_iter().map(|(_, is_in)| is_in.not());
        let out = Cnf::all(out.collect::<Vec<_>>());
        let dry = self.holds(thing, Fluid::None);
        out.and(dry).and(self.flag(thing, StateFlag::Cereal, false))
    }

    /// Whether no place is free: of what takes one thing alone that is whether it is taken; of all else, whether it is so now.
    fn is_full(&mut self, thing: Index) -> Cnf {
        let capacity = self.problem.capacity.get(&thing).copied();
        match (capacity, self.id(thing)) {
            (Some(1), _) => {
                let inside = self.contents(thing, false).into_iter().map(|(_, is_in)| is_in);
                Cnf::any(inside.collect::<Vec<_>>())
            }
            (Some(_), Some(id)) => Cnf::constant(!self.state.has_free_place(id)),
            _ => Cnf::constant(false),
        }
    }

    fn dino_fed(&mut self, target: &InstancePattern) -> Cnf {
        let eaters: Vec<_> = self.state.eaters.keys().copied().collect();
        let known: Vec<Index> = eaters.iter().filter_map(|eater| self.index.get(eater).copied()).collect();
        let meant = self.meant(target);
        let named: Vec<Index> = known.iter().copied().filter(|eater| meant.contains(eater)).collect();
        let counted = if named.is_empty() { known } else { named };
        let fed = counted.into_iter().map(|eater| {
            let now = self.id(eater).is_some_and(|id| self.state.fed.contains(&id));
            Cnf::literal(Literal::is(self.problem.var(Var::Fed(eater), u16::from(now)), 1))
        });
        Cnf::any(fed.collect::<Vec<_>>())
    }
}
