//! The table of missions that participants played.

use cohabit_tables::{
    Cell,
    Kind::{Real, Text, Whole},
    Table,
};

use super::{ALL_KINDS, factor_cells, factor_fields, field, practice_field, step_cells, step_fields, text, whole};
use crate::{
    design::Study,
    plan::Step,
    progress::{Done, Progress},
    session::name_of_try,
};

pub(super) fn table(study: &Study, all: &[Progress], with_practice: bool) -> Table {
    let more = [
        practice_field(),
        field("mission", Text, "", "the mission, as the study names it"),
        field("ending", Text, "", "how it ended: complete, failed, time_up, skipped, or stopped by the experimenter"),
        field("played_s", Real, "s", "how long its page was there with the participant"),
        field("sessions", Text, "", "its sessions in order, as in the table of sessions: more than one, if one died"),
        field("began_ms", Whole, "ms", "wall time at which the step began, since 1970"),
        field("ended_ms", Whole, "ms", "wall time at which it ended, since 1970"),
    ];
    let row = |progress: &Progress, done: &Done| {
        let plan = progress.plan();
        let Some(Step::Mission(mission)) = plan.steps.get(done.step) else { return None };
        if mission.is_practice && !with_practice {
            return None;
        }
        let sessions: Vec<_> =
            (1..=done.attempts).map(|attempt| name_of_try(plan.place, done.step, attempt, done.together)).collect();
        let first = step_cells(study, plan, done);
        let more = [
            Cell::Flag(mission.is_practice),
            text(&mission.mission),
            done.ending.map_or(Cell::Nothing, |ending| text(ending.name())),
            Cell::Real(done.played_s),
            text(sessions.join(" ")),
            whole(done.began_ms),
            whole(done.ended_ms),
        ];
        let factors = factor_cells(study, &ALL_KINDS, &plan.choices(done.step));
        Some(first.into_iter().chain(factors).chain(more).collect())
    };
    let rows = all.iter().flat_map(|progress| progress.done().iter().filter_map(move |done| row(progress, done)));
    let fields = step_fields(study).into_iter().chain(factor_fields(study, &ALL_KINDS)).chain(more).collect();
    Table { name: "missions", meaning: "a mission that a participant played", fields, rows: rows.collect() }
}
