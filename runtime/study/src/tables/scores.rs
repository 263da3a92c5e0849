//! The table of what answers to questionnaires amount to.

use cohabit_tables::{
    Cell,
    Kind::{Real, Text, Whole},
    Table,
};

use super::{ALL_KINDS, factor_cells, field, mission_about, of_steps, step_cells, text, whole};
use crate::{
    design::Study,
    plan::{Plan, Step},
    progress::{Done, Progress},
};

pub(super) fn table(study: &Study, all: &[Progress]) -> Table {
    let more = [
        field("mission", Text, "", "the mission that was played before, if it is about one"),
        field("questionnaire", Text, "", "the questionnaire"),
        field("score", Text, "", "what the number is called"),
        field("value", Real, "", "the number; nothing if no question of it was answered"),
        field("meaning", Text, "", "what it means, with its range"),
        field("checks_failed", Whole, "", "attention checks of the questionnaire that were not answered rightly"),
    ];
    let meaning = "what a participant's answers to a questionnaire between missions amount to";
    of_steps(study, all, "scores", meaning, more, rows)
}

fn rows(study: &Study, plan: &Plan, done: &Done) -> Vec<Vec<Cell>> {
    let Some(Step::Questionnaire { name, about }) = plan.steps.get(done.step) else { return Vec::new() };
    let (Some(asked), Some(instrument)) = (study.questionnaire(name), study.instrument(name)) else {
        return Vec::new();
    };
    let mission = mission_about(plan, *about);
    let failed = |(item, given): (usize, &Option<_>)| instrument.is_attentive(item, given.as_ref()) == Some(false);
    let failed = done.answers.iter().enumerate().filter(|one| failed(*one)).count();
    let factors = factor_cells(study, &ALL_KINDS, &plan.choices(done.step));
    let row = |score: &crate::instrument::Score| {
        let more = [
            mission.clone(),
            text(name),
            text(&score.name),
            instrument.score(score, asked, &done.answers).map_or(Cell::Nothing, Cell::Real),
            text(&score.meaning),
            whole(failed),
        ];
        step_cells(study, plan, done).into_iter().chain(factors.clone()).chain(more).collect()
    };
    instrument.scores.iter().map(row).collect()
}
