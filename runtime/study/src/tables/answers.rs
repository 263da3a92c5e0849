//! The table of answers to questionnaires between missions.

use cohabit_bus::message::AnswerKind;
use cohabit_tables::{
    Cell,
    Kind::{Flag, Text, Whole},
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
        field("item", Whole, "", "which of its questions, from 1"),
        field("question", Text, "", "what was asked"),
        field("kind", Text, "", "how it was answered: on a Scale, by a Choice, or in Words"),
        field("value", Whole, "", "the number on the scale, or that of the choice, from 1"),
        field("least", Whole, "", "the scale's lowest number"),
        field("most", Whole, "", "the scale's highest number"),
        field("reversed", Flag, "", "whether a high number means little of what the questionnaire measures"),
        field("text", Text, "", "the words, or what was chosen says"),
        field("attentive", Flag, "", "whether an attention check was answered rightly; nothing of other questions"),
        field("at_ms", Whole, "ms", "wall time at which it was answered, since 1970"),
    ];
    let meaning = "a participant's answer to a question that the study asked between missions";
    of_steps(study, all, "answers", meaning, more, answer_rows)
}

fn answer_rows(study: &Study, plan: &Plan, done: &Done) -> Vec<Vec<Cell>> {
    let Some(Step::Questionnaire { name, about }) = plan.steps.get(done.step) else { return Vec::new() };
    let asked = study.questionnaire(name);
    // What was taken was checked; it is the questionnaire that may be another one by now.
    let messages = asked.and_then(|asked| asked.answered(plan.place, &done.answers).ok()).unwrap_or_default();
    let mission = mission_about(plan, *about);
    let factors = factor_cells(study, &ALL_KINDS, &plan.choices(done.step));
    let attentive = |item: u32| {
        let number = (item as usize).checked_sub(1)?;
        study.instrument(name)?.is_attentive(number, done.answers.get(number)?.as_ref())
    };
    let attentive = |item: u32| attentive(item).map_or(Cell::Nothing, Cell::Flag);
    let row = |message: &cohabit_bus::message::AnswerMessage| {
        let kind = message.kind();
        let of_scale = |cell: Cell| if kind == Some(AnswerKind::Scale) { cell } else { Cell::Nothing };
        let first = step_cells(study, plan, done);
        let more = [
            mission.clone(),
            text(name),
            whole(message.item),
            text(message.question.as_str()),
            kind.map_or(Cell::Nothing, |kind| text(format!("{kind:?}"))),
            if kind == Some(AnswerKind::Words) { Cell::Nothing } else { whole(message.value) },
            of_scale(whole(message.least)),
            of_scale(whole(message.most)),
            of_scale(Cell::Flag(message.reversed != 0)),
            text(message.text.as_str()),
            attentive(message.item),
            whole(done.ended_ms),
        ];
        first.into_iter().chain(factors.clone()).chain(more).collect()
    };
    messages.iter().map(row).collect()
}
