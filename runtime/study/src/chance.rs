//! What is drawn in a study, each with draws of its own.

use cohabit_tables::Chance;

/// What is drawn. Each purpose has streams of its own, so that one draw more of one changes nothing of another.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Purpose {
    /// Which between-participants condition.
    Between = 1,
    /// The order of within-participant conditions.
    Conditions = 2,
    /// The order of missions.
    Missions = 3,
    /// Which between-participants condition, by minimisation.
    Minimisation = 4,
    /// What a simulated person is like.
    Person = 5,
    /// What a simulated person answers.
    Answers = 6,
    /// Which condition each participant of a pair has by themselves.
    Own = 7,
}

/// The draws of a seed for the `number`-th of a purpose.
pub(crate) fn chance(seed: u64, purpose: Purpose, number: u64) -> Chance {
    Chance::new(seed, (purpose as u64) << 56 ^ number)
}
