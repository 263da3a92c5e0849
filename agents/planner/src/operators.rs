//! The table's rules, devices and works as operators on the things that matter.

use cohabit_cdf::{
    ActionKind,
    catalog::table::{Change, Condition, Device, Need, Rule, Term, Test, View as _},
};

use crate::{
    cnf::{Cnf, Literal},
    effects::Outcome,
    ground::Grounder,
    problem::{Assign, Cast, Deed, Index, Operator, Reason, Var, place},
};

/// What is in the hand in one grounding of a rule.
#[derive(Clone, Copy, Debug)]
enum Hand {
    /// The rule does not ask.
    Any,
    Empty,
    Holds(Index),
}

impl Grounder<'_> {
    /// Grounds all rules.
    pub fn ground(&mut self) {
        let catalog = self.catalog;
        let rules: Vec<&Rule> = catalog.table().rules().iter().collect();
        for (number, rule) in rules.iter().enumerate() {
            // Throwing makes no state that placing does not; going there is left to who carries the plan out.
            if matches!(rule.action, ActionKind::Throw | ActionKind::GoTo) {
                continue;
            }
            let earlier: Vec<&Rule> = rules[..number].iter().copied().filter(|one| one.action == rule.action).collect();
            for it in self.indices() {
                self.ground_rule(number, &earlier, it);
            }
        }
        for thing in self.indices() {
            self.ground_approach(thing);
        }
    }

    /// Going somewhere is an operator of its own only where a goal asks for being there.
    fn ground_approach(&mut self, thing: Index) {
        let Some(near) = self.problem.find(Var::Near) else { return };
        let needs = self.is_at(thing, place::GONE).not();
        let effects = vec![Assign { when: Cnf::constant(true), var: near, value: thing + 1, is_work: false }];
        let reasons = vec![Reason::Way; needs.0.len()];
        let cast = Cast { it: Some(thing), ..Cast::default() };
        let deed = Deed::Act(ActionKind::GoTo, thing);
        self.problem.operators.push(Operator { deed, needs, reasons, cast, room: None, effects, runs: Vec::new() });
    }

    fn ground_rule(&mut self, number: usize, earlier: &[&Rule], it: Index) {
        let catalog = self.catalog;
        let rule = &catalog.table().rules()[number];
        if self.is_hopeless(rule, it) {
            return;
        }
        let device = (rule.action == ActionKind::Toggle).then(|| self.catalog.table().device(&self.class(it).id));
        let spoken = |term: Term| mentions(rule, term) || device.is_some_and(|device| device_mentions(device, term));
        let holders: Vec<Option<Index>> = if spoken(Term::Holder) {
            self.parents[usize::from(it)].iter().copied().map(Some).collect()
        } else {
            vec![None]
        };
        let basins: Vec<Option<Index>> = if spoken(Term::Basin) { self.basins() } else { vec![None] };
        let hands: Vec<Hand> = if asks_for_hand(rule) {
            let moving = self.indices().filter(|held| self.moves(*held) && !self.is_hopeless_to_hold(rule, *held));
            std::iter::once(Hand::Empty).chain(moving.map(Hand::Holds)).collect()
        } else {
            vec![Hand::Any]
        };
        for holder in holders {
            for basin in &basins {
                for hand in &hands {
                    let cast = Cast { it: Some(it), holder, basin: *basin, ..Cast::default() };
                    self.ground_one(number, earlier, device, cast, *hand);
                }
            }
        }
    }

    /// Whether a need that only asks for the class of `it` is not met.
    fn is_hopeless(&self, rule: &Rule, it: Index) -> bool {
        let class = self.class(it);
        let fails = |condition: &Condition| {
            condition.term == Term::It
                && match &condition.test {
                    Test::Affords(property) => class.has(*property) == condition.negated,
                    Test::IsA(pattern) => pattern.matches(&class.id) == condition.negated,
                    _ => false,
                }
        };
        rule.when.iter().any(fails) || rule.needs.iter().any(|need| need.any.iter().all(fails))
    }

    fn is_hopeless_to_hold(&self, rule: &Rule, held: Index) -> bool {
        let class = self.class(held);
        let fails = |condition: &Condition| {
            condition.term == Term::Held
                && match &condition.test {
                    Test::Affords(property) => class.has(*property) == condition.negated,
                    Test::IsA(pattern) => pattern.matches(&class.id) == condition.negated,
                    _ => false,
                }
        };
        rule.when.iter().any(fails) || rule.needs.iter().any(|need| need.any.iter().all(fails))
    }

    fn basins(&self) -> Vec<Option<Index>> {
        let table = self.catalog.table();
        self.indices().filter(|thing| table.is_basin(&self.class(*thing).id)).map(Some).collect()
    }

    fn ground_one(&mut self, number: usize, earlier: &[&Rule], device: Option<&Device>, mut cast: Cast, hand: Hand) {
        let catalog = self.catalog;
        let rule = &catalog.table().rules()[number];
        let Some(it) = cast.it else { return };
        if let Hand::Holds(held) = hand {
            cast.held = Some(held);
        }
        cast.machine = self.id(it).and_then(|id| self.state.machine(id)).and_then(|id| self.index.get(&id).copied());
        let (mut needs, mut reasons) = (Vec::new(), Vec::new());
        let mut must = |formula: Cnf, reason: Reason| {
            for clause in formula.0 {
                needs.push(clause);
                reasons.push(reason);
            }
        };
        let hand_var = self.problem.var(Var::Hand, 0);
        match hand {
            Hand::Any => {}
            Hand::Empty => must(Cnf::literal(Literal::is(hand_var, 0)), Reason::EmptyHand),
            Hand::Holds(held) => {
                let held_it = self.is_at(held, place::HELD);
                must(held_it, Reason::Held);
            }
        }
        if let Some(holder) = cast.holder {
            let there = self.is_on(it, holder);
            must(there, Reason::Holder);
        }
        let when = self.all(&cast, &rule.when);
        if when.is_false() {
            return;
        }
        must(when, Reason::Way);
        for other in earlier.iter().filter(|other| !mentions_in(&other.when, Term::Holder)) {
            let otherwise = self.all(&cast, &other.when).not();
            if otherwise.is_false() {
                return;
            }
            must(otherwise, Reason::Way);
        }
        let device_needs = device.map_or(&[][..], |device| &device.needs);
        for (place, need) in rule.needs.iter().chain(device_needs).enumerate() {
            let formula = self.need(&cast, need);
            let is_false = formula.is_false();
            must(formula, Reason::Need(number, place));
            if is_false {
                // Kept, so that it can be said why nothing comes of it.
                break;
            }
        }
        let room = rule
            .needs
            .iter()
            .chain(device_needs)
            .flat_map(|need| &need.any)
            .find(|condition| {
                !condition.negated
                    && matches!(condition.test, Test::HasRoom | Test::HasRoomForHeld | Test::HasFreePlace)
            })
            .and_then(|condition| cast.get(condition.term));
        let mut outcome = Outcome::default();
        self.effects(&cast, &rule.effects, &Cnf::constant(true), device, &mut outcome);
        if let Some(device) = device {
            self.effects(&cast, &device.press, &Cnf::constant(true), Some(device), &mut outcome);
        }
        if let Some(near) = self.problem.find(Var::Near) {
            outcome.assign(near, it + 1, Cnf::constant(true));
        }
        let deed = Deed::Act(rule.action, it);
        let Outcome { effects, runs, .. } = outcome;
        self.problem.operators.push(Operator { deed, needs: Cnf(needs), reasons, cast, room, effects, runs });
    }

    fn need(&mut self, cast: &Cast, need: &Need) -> Cnf {
        let mut any = Cnf::constant(false);
        for condition in &need.any {
            any = any.or(self.condition(cast, condition));
            if any.is_true() {
                break;
            }
        }
        any
    }
}

fn mentions_in(conditions: &[Condition], term: Term) -> bool {
    conditions.iter().any(|condition| condition.term == term)
}

fn needs_mention(needs: &[Need], term: Term) -> bool {
    needs.iter().any(|need| mentions_in(&need.any, term))
}

fn mentions(rule: &Rule, term: Term) -> bool {
    let touch = |need: &&Need| !need.is_of_access();
    mentions_in(&rule.when, term) || rule.needs.iter().filter(touch).any(|need| mentions_in(&need.any, term))
}

fn device_mentions(device: &Device, term: Term) -> bool {
    let changed = device.press.iter().flat_map(|effect| &effect.changes).any(|change| match change {
        Change::Flip(of, other) | Change::Run(of, other) => *of == term || *other == Some(term),
        Change::Feed(of, by) => *of == term || *by == term,
        _ => false,
    });
    changed || needs_mention(&device.needs, term)
}

/// Whether what is in the hand matters to a rule.
fn asks_for_hand(rule: &Rule) -> bool {
    let of_hand = |test: &Test| {
        matches!(test, Test::Held | Test::InHeld | Test::TakesHeld | Test::HasRoomForHeld | Test::LetsHeldPass)
    };
    let asks = |condition: &Condition| condition.term == Term::Held || of_hand(&condition.test);
    rule.when.iter().any(asks) || rule.needs.iter().flat_map(|need| &need.any).any(asks)
}
