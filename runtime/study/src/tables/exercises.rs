//! The table of what participants tried in tutorials. These are for practice, and yet the table is always exported: it tells who
//! knew how it works.

use cohabit_tables::{
    Cell,
    Kind::{Text, Whole},
    Table,
};

use super::{ALL_KINDS, factor_cells, field, of_steps, step_cells, text, whole};
use crate::{
    design::Study,
    plan::{Plan, Step},
    progress::{Done, Progress},
    tutorial::Exercise,
};

/// What participants tried in the tutorials that they have done.
pub(crate) fn table(study: &Study, all: &[Progress]) -> Table {
    let more = [
        field("mission", Text, "", "the mission of the tutorial"),
        field("exercise", Whole, "", "which of its exercises, from 1"),
        field("what", Text, "", "what counts as tried: say, point, answer, stop, goal, move or look"),
        field("text", Text, "", "what the participant read"),
        field("tried_ms", Whole, "ms", "wall time at which it was first tried, since 1970; nothing, if it was not"),
    ];
    of_steps(study, all, "exercises", "an exercise of a tutorial that a participant has done", more, rows)
}

fn rows(study: &Study, plan: &Plan, done: &Done) -> Vec<Vec<Cell>> {
    let Some(Step::Mission(mission)) = plan.steps.get(done.step) else { return Vec::new() };
    let tried_ms = |number: usize| done.tried.iter().find(|one| one.exercise == number).map(|one| one.at_ms);
    let factors = factor_cells(study, &ALL_KINDS, &plan.choices(done.step));
    let row = |(number, exercise): (usize, &Exercise)| {
        let more = [
            text(&mission.mission),
            whole(number + 1),
            text(exercise.what.name()),
            text(&exercise.text),
            tried_ms(number).map_or(Cell::Nothing, whole),
        ];
        step_cells(study, plan, done).into_iter().chain(factors.clone()).chain(more).collect()
    };
    mission.exercises.iter().enumerate().map(row).collect()
}
