//! The table of goals: what missions asked for, and whether it came about.

use crate::{
    played::{Played, Reached, seconds},
    table::{
        Cell, Field,
        Kind::{Flag, Real, Text, Whole},
        Table,
    },
};

const FIELDS: [Field; 7] = [
    Field::new("session", Text, "", "the session, as in the table of sessions"),
    Field::new("goal", Whole, "", "the goal's number in the mission"),
    Field::new("description", Text, "", "what people read of it"),
    Field::new("met", Flag, "", "whether it was met in the end"),
    Field::new("first_met_tick", Whole, "", "the tick at which it was first met"),
    Field::new("first_met_s", Real, "s", "simulated time of that tick"),
    Field::new("resets", Whole, "", "how many times it opened again"),
];

/// All goals of these sessions.
pub fn table(played: &[Played]) -> Table {
    let rows = played.iter().flat_map(|played| played.goals.iter().map(|goal| row(played, goal)));
    Table { name: "goals", meaning: "a goal of a session's mission", fields: FIELDS.into(), rows: rows.collect() }
}

fn row(played: &Played, goal: &Reached) -> Vec<Cell> {
    vec![
        Cell::text(&played.name),
        Cell::Whole(goal.number),
        Cell::text(&goal.description),
        Cell::Flag(goal.met),
        Cell::maybe(goal.first_met, Cell::whole),
        Cell::maybe(goal.first_met, |tick| Cell::Real(seconds(tick))),
        Cell::whole(goal.resets),
    ]
}
