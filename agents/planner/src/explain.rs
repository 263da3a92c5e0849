//! Why a goal cannot be reached: what is lacking for what is lacking, down to what nothing can bring about.

use cohabit_cdf::catalog::table::Term;

use crate::{
    cnf::{Clause, Cnf, Literal},
    ground::Grounder,
    problem::{Assign, Cast, Index, Operator, Reason, Var, place},
    relaxed::Relaxed,
};

/// How far reasons are followed.
const DEEPEST: u32 = 6;

impl Grounder<'_> {
    /// The first goal that can never be met, by its number, with a reason in one sentence.
    pub fn unreachable(&self, relaxed: &Relaxed, costs: &[u32]) -> Option<(usize, String)> {
        let goals = self.problem.goals.iter().enumerate();
        let (number, goal) = goals.into_iter().find(|(_, goal)| !relaxed.can_hold(goal, costs))?;
        let reason = match relaxed.never(goal, costs) {
            Some((_, clause)) if !clause.is_empty() => self.reason(relaxed, costs, clause, DEEPEST),
            _ => None,
        };
        Some((number, reason.unwrap_or_else(|| "nothing that it names is there".to_owned())))
    }

    fn reason(&self, relaxed: &Relaxed, costs: &[u32], clause: &Clause, depth: u32) -> Option<String> {
        let literal = *clause.first()?;
        let what = self.describe(literal);
        let fails = |clause: &Clause| !relaxed.can_hold(&Cnf(vec![clause.clone()]), costs);
        let count = |formula: &Cnf| formula.0.iter().filter(|clause| fails(clause)).count();
        let brings = self.problem.operators.iter().flat_map(|operator| {
            let does =
                |effect: &&Assign| effect.var == literal.var && (effect.value == literal.value) != literal.negated;
            operator.effects.iter().filter(does).map(move |effect| (operator, effect))
        });
        // The way that lacks least is the one to speak of; one that lacks something itself, before its effect does.
        let best = brings
            .map(|(operator, effect)| (operator, effect, count(&operator.needs), count(&effect.when)))
            .filter(|(.., needs, when)| needs + when > 0)
            .min_by_key(|(.., needs, when)| (*needs == 0, needs + when));
        let Some((operator, effect, ..)) = best else { return Some(format!("nothing here makes {what}")) };
        let (words, lack) = match relaxed.never(&operator.needs, costs) {
            Some((index, lack)) => (operator.reasons.get(index).map(|reason| self.words(operator, *reason)), lack),
            None => (None, relaxed.never(&effect.when, costs)?.1),
        };
        let deeper = if depth == 0 || lack.is_empty() { None } else { self.reason(relaxed, costs, lack, depth - 1) };
        match (deeper, words) {
            (Some(deeper), Some(words)) if deeper.starts_with("nothing here makes") => Some(words),
            (Some(deeper), _) => Some(deeper),
            (None, words) => words,
        }
    }

    /// What is said of a need that is not met.
    fn words(&self, operator: &Operator, reason: Reason) -> String {
        let cast = &operator.cast;
        let name = |thing: Option<Index>| thing.map_or_else(|| "something".to_owned(), |thing| self.name(thing));
        match reason {
            Reason::Way => "there is no way to do it".to_owned(),
            Reason::EmptyHand => "the hand is never empty".to_owned(),
            Reason::Held => format!("{} cannot be picked up", name(cast.held)),
            Reason::Holder => format!("{} does not get into {}", name(cast.it), name(cast.holder)),
            Reason::Need(rule, number) => {
                let rule = &self.catalog.table().rules()[rule];
                let of_device = cast.it.map(|it| &self.catalog.table().device(&self.class(it).id).needs);
                let need = rule.needs.get(number).or_else(|| of_device?.get(number - rule.needs.len()));
                need.map(|need| self.told(cast, &need.words)).unwrap_or_default()
            }
        }
    }

    /// Words of the table with names.
    fn told(&self, cast: &Cast, words: &str) -> String {
        Term::ALL.into_iter().fold(words.replace("{cover}", "what it is in"), |words, term| match cast.get(term) {
            Some(thing) => words.replace(&format!("{{{}}}", term.name()), &self.name(thing)),
            None => words,
        })
    }

    fn describe(&self, literal: Literal) -> String {
        let not = if literal.negated { "not " } else { "" };
        match self.problem.vars[literal.var as usize] {
            Var::Place(thing) => match place::parent(literal.value) {
                Some(parent) => format!("{} be {not}in {}", self.name(thing), self.name(parent)),
                None if literal.value == place::HELD => format!("{} be {not}held", self.name(thing)),
                None => format!("{} be {not}there", self.name(thing)),
            },
            Var::Flag(thing, flag) => {
                let value = (literal.value == 1) != literal.negated;
                let word = format!("{flag:?}").to_lowercase();
                format!("{} be {}{word}", self.name(thing), if value { "" } else { "not " })
            }
            Var::Fluid(thing) => format!("{} be {not}filled so", self.name(thing)),
            Var::Color(thing) => format!("{} be {not}of that colour", self.name(thing)),
            Var::Hand => "the hand be free".to_owned(),
            Var::Near => "it be near".to_owned(),
            Var::Fed(thing) => format!("{} be {not}fed", self.name(thing)),
            Var::Derived(_) => "that be so".to_owned(),
            Var::Met(number) => format!("goal {number} be {not}met"),
        }
    }
}
