//! Formulas over the variables of a problem, as clauses of which all must hold, each of literals of which one must.

/// One variable has a value, or has not.
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub(crate) struct Literal {
    pub var: u32,
    pub value: u16,
    pub negated: bool,
}

impl Literal {
    pub const fn is(var: u32, value: u16) -> Self {
        Self { var, value, negated: false }
    }

    pub const fn is_not(var: u32, value: u16) -> Self {
        Self { var, value, negated: true }
    }

    pub fn holds(self, state: &[u16]) -> bool {
        (state[self.var as usize] == self.value) != self.negated
    }
}

/// Literals of which one must hold.
pub(crate) type Clause = Vec<Literal>;

/// Clauses of which all must hold: none is true, an empty one false.
#[derive(Clone, Debug, Default, Eq, PartialEq)]
pub(crate) struct Cnf(pub Vec<Clause>);

impl Cnf {
    pub fn constant(value: bool) -> Self {
        Self(if value { Vec::new() } else { vec![Vec::new()] })
    }

    pub fn literal(literal: Literal) -> Self {
        Self(vec![vec![literal]])
    }

    pub fn is_true(&self) -> bool {
        self.0.is_empty()
    }

    pub fn is_false(&self) -> bool {
        self.0.iter().any(Vec::is_empty)
    }

    pub fn and(mut self, other: Self) -> Self {
        for clause in other.0 {
            if !self.0.contains(&clause) {
                self.0.push(clause);
            }
        }
        if self.is_false() { Self::constant(false) } else { self }
    }

    pub fn or(self, other: Self) -> Self {
        if self.is_false() || other.is_true() {
            return other;
        }
        if other.is_false() || self.is_true() {
            return self;
        }
        let mut clauses = Vec::with_capacity(self.0.len() * other.0.len());
        for one in &self.0 {
            for two in &other.0 {
                let mut clause = one.clone();
                clause.extend(two.iter().filter(|literal| !one.contains(literal)));
                clauses.push(clause);
            }
        }
        Self(clauses)
    }

    pub fn not(&self) -> Self {
        let clauses = self.0.iter().map(|clause| {
            let negated = clause.iter().map(|literal| vec![Literal { negated: !literal.negated, ..*literal }]);
            Self(negated.collect())
        });
        clauses.fold(Self::constant(false), Self::or)
    }

    pub fn all(formulas: impl IntoIterator<Item = Self>) -> Self {
        formulas.into_iter().fold(Self::constant(true), Self::and)
    }

    pub fn any(formulas: impl IntoIterator<Item = Self>) -> Self {
        formulas.into_iter().fold(Self::constant(false), Self::or)
    }

    pub fn holds(&self, state: &[u16]) -> bool {
        self.0.iter().all(|clause| clause.iter().any(|literal| literal.holds(state)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_combine_as_logic_has_it() {
        let of = |var| Cnf::literal(Literal::is(var, 1));
        let either = of(0).or(of(1).and(of(2)));
        for bits in 0..8_u16 {
            let state = [bits & 1, bits >> 1 & 1, bits >> 2 & 1];
            let expected = state[0] == 1 || (state[1] == 1 && state[2] == 1);
            assert_eq!(either.holds(&state), expected, "{state:?}");
            assert_eq!(either.not().holds(&state), !expected, "{state:?}");
        }
        assert!(Cnf::constant(false).or(of(0)).holds(&[1]));
        assert!(of(0).and(Cnf::constant(false)).is_false());
    }
}
