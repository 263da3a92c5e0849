//! The score: 1000 points at the start, one less each second down to 100, and 100 more for each goal met.

/// Points at the start.
const START: u64 = 1000;
/// Points that time does not take.
const FLOOR: u64 = 100;
/// Points for a goal.
const GOAL: u64 = 100;
const TICKS_A_SECOND: u64 = 60;

/// The score after so many ticks with so many goals met.
pub(crate) fn score(ticks: u64, goals_met: usize) -> u32 {
    let time = START.saturating_sub(ticks / TICKS_A_SECOND).max(FLOOR);
    let total = time.saturating_add(GOAL.saturating_mul(goals_met as u64));
    u32::try_from(total).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests {
    use super::score;

    #[test]
    fn time_takes_points_and_goals_give_them() {
        for (ticks, met, expected) in [(0, 0, 1000), (59, 0, 1000), (60, 0, 999), (60 * 10_000, 0, 100), (120, 3, 1298)]
        {
            assert_eq!(score(ticks, met), expected, "{ticks} ticks, {met} goals");
        }
    }
}
