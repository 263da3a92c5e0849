//! After how many participants the assignment of a study is balanced.

use std::fmt;

use crate::{
    design::{Assignment, FactorKind, MissionOrder, Study},
    square,
};

/// One full cycle of an assignment: after so many participants, or a multiple of them, all that it balances is balanced.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Cycle {
    /// Orders of the within-participant conditions: rows of their square. 1 if they are drawn for each participant.
    pub orders: usize,
    /// Positions that each mission moves through. 1 if missions are not balanced.
    pub positions: usize,
    /// Between-participants conditions.
    pub between: usize,
    /// Participants of a block, or pairs of one, in which each between-participants condition is as frequent.
    pub block_size: usize,
    /// Participants of a session, to all of whom the same is assigned: 2 in a study of pairs.
    pub session_size: usize,
}

impl Cycle {
    /// That of a study.
    #[must_use]
    pub fn of(study: &Study) -> Self {
        let conditions = study.conditions(FactorKind::Within).len();
        let is_balanced = study.missions_block().is_some_and(|missions| missions.order == MissionOrder::Balanced);
        Self {
            orders: match study.assignment {
                Assignment::LatinSquare => square::latin(conditions).len(),
                Assignment::BalancedLatinSquare => square::balanced(conditions).len(),
                Assignment::BlockRandom => 1,
            },
            positions: if is_balanced { study.missions.len().max(1) } else { 1 },
            between: study.conditions(FactorKind::Between).len(),
            block_size: study.block_size.max(1),
            session_size: study.session_size() as usize,
        }
    }

    /// How many participants it takes: whole squares in each between-participants condition, and whole blocks.
    #[must_use]
    pub fn participants(&self) -> usize {
        self.units() * self.session_size
    }

    /// The same in what conditions are assigned to: participants, or pairs.
    fn units(&self) -> usize {
        let squares = self.orders * self.positions * self.between;
        (1..=self.block_size)
            .map(|count| count * squares)
            .find(|all| all.is_multiple_of(self.block_size))
            .unwrap_or(squares)
    }

    /// What to know of so many participants, if they are no whole number of cycles.
    #[must_use]
    pub fn note(&self, planned: u32) -> Option<String> {
        let (planned, cycle) = (planned as usize, self.participants());
        if planned.is_multiple_of(cycle) {
            return None;
        }
        let below = planned / cycle * cycle;
        let above = below + cycle;
        let instead = if below == 0 { format!("{above} are") } else { format!("{below} or {above} are") };
        Some(format!(
            "{planned} participants are no multiple of {cycle}, so the assignment is not fully balanced; {instead}"
        ))
    }
}

/// Such as `36 participants: 6 orders of conditions x 3 positions of missions x 2 between-participants conditions`.
impl fmt::Display for Cycle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let factors = [
            counted(self.orders, "order", " of conditions"),
            counted(self.positions, "position", " of missions"),
            counted(self.between, "between-participants condition", ""),
        ];
        let is_of_pairs = self.session_size > 1;
        let pairs = if is_of_pairs { format!(" in {}", counted(self.units(), "pair", "")) } else { String::new() };
        write!(f, "{}{pairs}: {}", counted(self.participants(), "participant", ""), factors.join(" x "))?;
        let of = if is_of_pairs { " pairs" } else { "" };
        if self.block_size == self.between { Ok(()) } else { write!(f, ", in whole blocks of {}{of}", self.block_size) }
    }
}

fn counted(count: usize, one: &str, of: &str) -> String {
    format!("{count} {one}{}{of}", if count == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cycle_is_told_with_its_factors() {
        let told = |[orders, positions, between, block_size]: [usize; 4], session_size: usize| {
            Cycle { orders, positions, between, block_size, session_size }.to_string()
        };
        let check = |counts: [usize; 4], expected: &str| assert_eq!(told(counts, 1), expected);
        assert_eq!(
            told([2, 1, 2, 4], 2),
            "8 participants in 4 pairs: 2 orders of conditions x 1 position of missions x 2 between-participants conditions, in whole \
             blocks of 4 pairs"
        );
        check(
            [1, 1, 1, 1],
            "1 participant: 1 order of conditions x 1 position of missions x 1 between-participants condition",
        );
        check(
            [6, 3, 2, 2],
            "36 participants: 6 orders of conditions x 3 positions of missions x 2 between-participants conditions",
        );
        check(
            [2, 1, 2, 6],
            "12 participants: 2 orders of conditions x 1 position of missions x 2 between-participants conditions, in whole blocks of 6",
        );
    }

    #[test]
    fn participants_that_are_no_whole_cycles_are_noted() {
        let cycle = Cycle { orders: 6, positions: 3, between: 1, block_size: 1, session_size: 1 };
        assert_eq!((cycle.note(18), cycle.note(36)), (None, None));
        for (planned, instead) in [(4, "; 18 are"), (24, "; 18 or 36 are")] {
            let note = cycle.note(planned).unwrap_or_default();
            assert!(note.starts_with(&format!("{planned} participants are no multiple of 18")), "{note}");
            assert!(note.ends_with(instead), "{note}");
        }
    }
}
