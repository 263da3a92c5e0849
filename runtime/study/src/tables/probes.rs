//! The table of questions that were asked while missions were played.

use cohabit_bus::message::AnswerKind;
use cohabit_tables::{
    Cell,
    Kind::{Text, Whole},
    Table,
};

use super::{ALL_KINDS, factor_cells, factor_fields, field, step_cells, step_fields, text, whole};
use crate::{
    design::Study,
    plan::Step,
    probe::Probed,
    progress::{Done, Progress},
};

/// What participants answered during missions.
pub(crate) fn table(study: &Study, all: &[Progress], with_practice: bool) -> Table {
    let more = [
        field("mission", Text, "", "the mission that was played"),
        field("questionnaire", Text, "", "the questionnaire"),
        field("at", Text, "", "when it is asked: goal_met, action_failed, question_asked, or after some minutes"),
        field("question", Text, "", "what was asked"),
        field("value", Whole, "", "the number on the scale, or that of the choice, from 1"),
        field("text", Text, "", "the words, or what was chosen says"),
        field("asked_ms", Whole, "ms", "wall time at which it was asked, since 1970"),
        field("answered_ms", Whole, "ms", "wall time at which it was answered, since 1970; nothing, if it was not"),
    ];
    let of_done = |progress: &Progress, done: &Done| -> Vec<Vec<Cell>> {
        let plan = progress.plan();
        let Some(Step::Mission(mission)) = plan.steps.get(done.step) else { return Vec::new() };
        if mission.is_practice && !with_practice {
            return Vec::new();
        }
        let factors = factor_cells(study, &ALL_KINDS, &plan.choices(done.step));
        let first = step_cells(study, plan, done);
        let row = |probed: &Probed| {
            let more = probe_cells(study, &mission.mission, plan.place, probed)?;
            Some(first.iter().chain(&factors).cloned().chain(more).collect())
        };
        done.probed.iter().filter_map(row).collect()
    };
    let rows = all.iter().flat_map(|progress| progress.done().iter().flat_map(move |done| of_done(progress, done)));
    let rows = rows.collect();
    let fields = step_fields(study).into_iter().chain(factor_fields(study, &ALL_KINDS)).chain(more).collect();
    Table {
        name: "probes",
        meaning: "a question that a participant was asked while a mission was played",
        fields,
        rows,
    }
}

fn probe_cells(study: &Study, mission: &str, place: u32, probed: &Probed) -> Option<[Cell; 8]> {
    let probe = study.probes.get(probed.probe)?;
    let asked = study.questionnaire(&probe.questionnaire)?;
    let (answered_ms, given) = probed.answer.clone().unzip();
    let message = asked.answered(place, &[given.flatten()]).ok().and_then(|messages| messages.into_iter().next());
    let kind = message.as_ref().and_then(cohabit_bus::message::AnswerMessage::kind);
    Some([
        text(mission),
        text(&asked.name),
        text(probe.at.name()),
        asked.items.first().map_or(Cell::Nothing, |item| text(&item.ask)),
        message
            .as_ref()
            .filter(|_| kind != Some(AnswerKind::Words))
            .map_or(Cell::Nothing, |message| whole(message.value)),
        message.as_ref().map_or(Cell::Nothing, |message| text(message.text.as_str())),
        whole(probed.asked_ms),
        answered_ms.map_or(Cell::Nothing, whole),
    ])
}
