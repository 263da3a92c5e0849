//! A study's own tables: participants, missions, answers and notes; and the columns that tell of the tables of logs under which
//! conditions their sessions were played.

use std::{borrow::Cow, collections::BTreeMap, path::PathBuf};

use cohabit_bus::message::AnswerKind;
use cohabit_tables::{
    Cell, CsvError, Field,
    Kind::{Flag, Real, Text, Whole},
    Table, codebook, write_csv,
};

use crate::{
    design::{Choice, FactorKind, Study},
    folder::{Folder, FolderError, Note},
    plan::{Plan, Step, place_of, pseudonym},
    probe::Probed,
    progress::{Doing, Done, Phase, Progress},
    session::{session_name, step_of},
};

/// Why a study's tables could not be written.
#[derive(Debug, thiserror::Error)]
pub enum TablesError {
    /// A table cannot be written.
    #[error(transparent)]
    Csv(#[from] CsvError),
    /// The folder cannot be read.
    #[error(transparent)]
    Folder(#[from] FolderError),
}

/// Writes the tables of participants and answers into the study's folder.
///
/// # Errors
/// [`TablesError`].
pub fn write(study: &Study, all: &[Progress], folder: &Folder) -> Result<(), TablesError> {
    let withdrawn: Vec<String> = folder.withdrawals()?.into_iter().map(|one| one.participant).collect();
    for table in [participants(study, all, &withdrawn), answers(study, all)] {
        write_csv(&table, folder.path())?;
    }
    Ok(())
}

/// Whether a session of that name was for practice.
#[must_use]
pub fn is_practice(all: &[Progress], session: &str) -> bool {
    let Some((place, step)) = step_of(session) else { return false };
    all.iter().any(|progress| progress.plan().place == place && progress.plan().is_practice(step))
}

/// Writes all tables of a study into another folder, with those of its logs and a codebook; gives their paths. Missions for
/// practice are in none, but `with_practice`.
///
/// # Errors
/// [`TablesError`].
pub fn export(
    study: &Study,
    all: &[Progress],
    withdrawn: &[String],
    noted: &[Note],
    mut of_logs: Vec<Table>,
    with_practice: bool,
    out: &std::path::Path,
) -> Result<Vec<PathBuf>, TablesError> {
    add_conditions(study, all, &mut of_logs);
    let missions = missions(study, all, with_practice);
    let probes = probes(study, all, with_practice);
    let own = [participants(study, all, withdrawn), missions, answers(study, all), probes, notes(noted)];
    let tables: Vec<Table> = own.into_iter().chain(of_logs).collect();
    let codebook = codebook(&tables);
    let written = tables.iter().chain([&codebook]).map(|table| write_csv(table, out));
    Ok(written.collect::<Result<_, _>>()?)
}

fn field(name: impl Into<Cow<'static, str>>, kind: cohabit_tables::Kind, unit: &'static str, meaning: &str) -> Field {
    Field { name: name.into(), kind, unit, meaning: meaning.to_owned().into() }
}

fn text(text: impl Into<String>) -> Cell {
    let text = text.into();
    if text.is_empty() { Cell::Nothing } else { Cell::Text(text) }
}

fn whole(number: impl TryInto<i64>) -> Cell {
    number.try_into().map_or(Cell::Nothing, Cell::Whole)
}

/// A column for each factor of these kinds.
fn factor_fields(study: &Study, kinds: &[FactorKind]) -> Vec<Field> {
    let of_kind = study.factors.iter().filter(|factor| kinds.contains(&factor.kind));
    of_kind.map(|factor| field(format!("factor_{}", factor.name), Text, "", "the level of this factor")).collect()
}

fn factor_cells(study: &Study, kinds: &[FactorKind], choices: &[Choice]) -> Vec<Cell> {
    let of_kind = study.factors.iter().filter(|factor| kinds.contains(&factor.kind));
    let level = |name: &str| choices.iter().find(|choice| choice.factor == name);
    of_kind.map(|factor| level(&factor.name).map_or(Cell::Nothing, |choice| text(&choice.level))).collect()
}

const BOTH: [FactorKind; 2] = [FactorKind::Between, FactorKind::Within];

fn participants(study: &Study, all: &[Progress], withdrawn: &[String]) -> Table {
    let fields = [
        field("participant", Text, "", "what the participant is called"),
        field("place", Whole, "", "their place in the order of all, from 1"),
    ];
    let more = [
        field(
            "missions",
            Text,
            "",
            "their missions in order, each with the levels of within-participant factors, or that it is for practice",
        ),
        field("progress", Text, "", "where they are: the kind of step, or finished, excluded, withdrawn"),
        field("steps_done", Whole, "", "steps of their plan that they have done"),
        field("steps", Whole, "", "steps of their plan"),
        field("consented_ms", Whole, "ms", "wall time at which they agreed to take part, since 1970"),
        field("last_ms", Whole, "ms", "wall time at which their last step ended, since 1970"),
    ];
    let between = factor_fields(study, &[FactorKind::Between]);
    let count = fields.len() + between.len() + more.len();
    let gone = |name: &String| {
        let mut row = vec![Cell::Nothing; count];
        row[0] = text(name);
        row[count - more.len() + 1] = text("withdrawn");
        row
    };
    let rows = all.iter().map(|progress| participant(study, progress));
    let rows = rows.chain(withdrawn.iter().map(gone)).collect();
    let fields = fields.into_iter().chain(between).chain(more.clone()).collect();
    Table { name: "participants", meaning: "a participant of the study", fields, rows }
}

fn participant(study: &Study, progress: &Progress) -> Vec<Cell> {
    let (plan, done) = (progress.plan(), progress.done());
    let first = [text(pseudonym(plan.place)), whole(plan.place)];
    let more = [
        text(missions_of(plan)),
        text(progress_name(progress)),
        whole(done.len()),
        whole(plan.steps.len()),
        done.first().map_or_else(|| whole(progress.since_ms()), |done| whole(done.began_ms)),
        done.last().map_or(Cell::Nothing, |done| whole(done.ended_ms)),
    ];
    let between = factor_cells(study, &[FactorKind::Between], &plan.between);
    first.into_iter().chain(between).chain(more).collect()
}

/// Such as `laser_lab (practice), make_cereal (ask=never), cold_soda (ask=always)`.
fn missions_of(plan: &Plan) -> String {
    let of_step = |step: &Step| match step {
        Step::Mission(mission) if mission.is_practice => Some(format!("{} (practice)", mission.mission)),
        Step::Mission(mission) if mission.within.is_empty() => Some(mission.mission.clone()),
        Step::Mission(mission) => Some(format!("{} ({})", mission.mission, levels(&mission.within))),
        _ => None,
    };
    plan.steps.iter().filter_map(of_step).collect::<Vec<_>>().join(", ")
}

/// Such as `ask=never voice=off`.
#[must_use]
pub(crate) fn levels(choices: &[Choice]) -> String {
    choices.iter().map(|choice| format!("{}={}", choice.factor, choice.level)).collect::<Vec<_>>().join(" ")
}

/// Where somebody is, in a word.
pub(crate) fn progress_name(progress: &Progress) -> &'static str {
    match (progress.phase(), progress.step_now()) {
        (Phase::Information, _) => "information",
        (Phase::Consent, _) => "consent",
        (Phase::Finished, _) => "finished",
        (Phase::Withdrawn, _) => "withdrawn",
        (Phase::Excluded, _) => "excluded",
        (_, Some((_, Step::Questionnaire { .. }, _))) => "questionnaire",
        (_, Some((_, Step::Break { .. }, _))) => "break",
        (_, Some((_, _, Doing::Queued { .. }))) => "waiting",
        (_, Some((_, _, Doing::Playing))) => "mission",
        _ => "ready",
    }
}

/// Which step of a participant's plan a row is about.
fn step_fields() -> [Field; 2] {
    [
        field("participant", Text, "", "what the participant is called"),
        field("step", Whole, "", "which step of their plan, from 1"),
    ]
}

fn step_cells(plan: &Plan, done: &Done) -> [Cell; 2] {
    [text(pseudonym(plan.place)), whole(done.step + 1)]
}

/// What practice is called in tables.
fn practice_field() -> Field {
    field("practice", Flag, "", "whether it was for practice: under no condition")
}

fn missions(study: &Study, all: &[Progress], with_practice: bool) -> Table {
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
            (1..=done.attempts).map(|attempt| session_name(plan.place, done.step, attempt)).collect();
        let first = step_cells(plan, done);
        let more = [
            Cell::Flag(mission.is_practice),
            text(&mission.mission),
            done.ending.map_or(Cell::Nothing, |ending| text(ending.name())),
            Cell::Real(done.played_s),
            text(sessions.join(" ")),
            whole(done.began_ms),
            whole(done.ended_ms),
        ];
        let factors = factor_cells(study, &BOTH, &plan.choices(done.step));
        Some(first.into_iter().chain(factors).chain(more).collect())
    };
    let rows = all.iter().flat_map(|progress| progress.done().iter().filter_map(move |done| row(progress, done)));
    let fields = step_fields().into_iter().chain(factor_fields(study, &BOTH)).chain(more).collect();
    Table { name: "missions", meaning: "a mission that a participant played", fields, rows: rows.collect() }
}

fn answers(study: &Study, all: &[Progress]) -> Table {
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
        field("at_ms", Whole, "ms", "wall time at which it was answered, since 1970"),
    ];
    let rows = all
        .iter()
        .flat_map(|progress| progress.done().iter().flat_map(move |done| answer_rows(study, progress.plan(), done)));
    let fields = step_fields().into_iter().chain(factor_fields(study, &BOTH)).chain(more).collect();
    let meaning = "a participant's answer to a question that the study asked between missions";
    Table { name: "answers", meaning, fields, rows: rows.collect() }
}

fn answer_rows(study: &Study, plan: &Plan, done: &Done) -> Vec<Vec<Cell>> {
    let Some(Step::Questionnaire { name, about }) = plan.steps.get(done.step) else { return Vec::new() };
    let asked = study.questionnaire(name);
    // What was taken was checked; it is the questionnaire that may be another one by now.
    let messages = asked.and_then(|asked| asked.answered(plan.place, &done.answers).ok()).unwrap_or_default();
    let mission = match about.and_then(|about| plan.steps.get(about)) {
        Some(Step::Mission(mission)) => text(&mission.mission),
        _ => Cell::Nothing,
    };
    let factors = factor_cells(study, &BOTH, &plan.choices(done.step));
    let row = |message: &cohabit_bus::message::AnswerMessage| {
        let kind = message.kind();
        let of_scale = |cell: Cell| if kind == Some(AnswerKind::Scale) { cell } else { Cell::Nothing };
        let first = step_cells(plan, done);
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
            whole(done.ended_ms),
        ];
        first.into_iter().chain(factors.clone()).chain(more).collect()
    };
    messages.iter().map(row).collect()
}

/// What participants answered during missions.
pub(crate) fn probes(study: &Study, all: &[Progress], with_practice: bool) -> Table {
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
        let factors = factor_cells(study, &BOTH, &plan.choices(done.step));
        let first = step_cells(plan, done);
        let row = |probed: &Probed| {
            let more = probe_cells(study, &mission.mission, plan.place, probed)?;
            Some(first.iter().chain(&factors).cloned().chain(more).collect())
        };
        done.probed.iter().filter_map(row).collect()
    };
    let rows = all.iter().flat_map(|progress| progress.done().iter().flat_map(move |done| of_done(progress, done)));
    let rows = rows.collect();
    let fields = step_fields().into_iter().chain(factor_fields(study, &BOTH)).chain(more).collect();
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

fn notes(all: &[Note]) -> Table {
    let fields = vec![
        field("at_ms", Whole, "ms", "wall time at which it was written, since 1970"),
        field(
            "participant",
            Text,
            "",
            "what the participant that it is about is called; nothing if it is about the study",
        ),
        field("place", Whole, "", "that participant's place in the order of all, from 1"),
        field("text", Text, "", "the note"),
    ];
    let row = |note: &Note| {
        let about = note.participant.as_deref();
        let place = about.and_then(place_of);
        vec![whole(note.at_ms), about.map_or(Cell::Nothing, text), place.map_or(Cell::Nothing, whole), text(&note.text)]
    };
    Table { name: "notes", meaning: "a note of the experimenter's", fields, rows: all.iter().map(row).collect() }
}

/// Adds to tables of logs, by the name of the session, which step it was, whether for practice, and the levels of all factors.
fn add_conditions(study: &Study, all: &[Progress], tables: &mut [Table]) {
    let plans: BTreeMap<u32, &Plan> = all.iter().map(|progress| (progress.plan().place, progress.plan())).collect();
    for table in tables {
        let Some(column) = table.fields.iter().position(|field| field.name == "session") else { continue };
        table.fields.push(field("step", Whole, "", "which step of the participant's plan it belongs to, from 1"));
        table.fields.push(practice_field());
        table.fields.extend(factor_fields(study, &BOTH));
        for row in &mut table.rows {
            let of = match &row[column] {
                Cell::Text(session) => step_of(session),
                _ => None,
            };
            let of = of.and_then(|(place, step)| Some((*plans.get(&place)?, step)));
            row.push(of.map_or(Cell::Nothing, |(_, step)| whole(step + 1)));
            row.push(of.map_or(Cell::Nothing, |(plan, step)| Cell::Flag(plan.is_practice(step))));
            row.extend(factor_cells(study, &BOTH, &of.map(|(plan, step)| plan.choices(step)).unwrap_or_default()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        design::Limits,
        plan::PlannedMission,
        progress::{Ending, Event},
        settings::Settings,
    };

    #[test]
    fn notes_are_about_somebody_or_about_the_study() {
        let note = |participant: Option<&str>, text: &str| Note {
            at_ms: 5,
            participant: participant.map(str::to_owned),
            text: text.to_owned(),
        };
        let table = notes(&[note(Some("P12"), "looks bored"), note(None, "the lab is cold")]);
        let words = |text: &str| Cell::Text(text.to_owned());
        assert_eq!(
            table.rows,
            [
                vec![Cell::Whole(5), words("P12"), Cell::Whole(12), words("looks bored")],
                vec![Cell::Whole(5), Cell::Nothing, Cell::Nothing, words("the lab is cold")],
            ]
        );
        assert!(table.rows.iter().all(|row| row.len() == table.fields.len()));
    }

    #[test]
    fn practice_is_marked_and_left_out() {
        let mission = |name: &str, is_practice: bool| {
            Step::Mission(PlannedMission {
                block: 0,
                mission: name.to_owned(),
                is_practice,
                within: Vec::new(),
                settings: Settings::new(),
                limits: Limits::default(),
            })
        };
        let steps = vec![mission("laser_lab", true), mission("cold_soda", false)];
        let mut progress = Progress::new(Plan { place: 7, between: Vec::new(), steps });
        let agreed = Event::Consented { version: "1".to_owned(), ticked: Vec::new(), audio: false };
        let over = Event::Over { ending: Ending::Complete };
        let played = [Event::GoesOn, Event::Started, over];
        let events = [Event::Read, agreed].into_iter().chain(played.clone()).chain(played);
        events.for_each(|event| drop(progress.step(&event, 0).expect("a possible event")));
        let all = [progress];
        assert!(is_practice(&all, "P07-01-2") && !is_practice(&all, "P07-02-1"));
        assert!(!is_practice(&all, "P08-01-1") && !is_practice(&all, "play-3"));
        assert_eq!(missions_of(all[0].plan()), "laser_lab (practice), cold_soda");
        let of = |with_practice| {
            let table = missions(&Study::default(), &all, with_practice);
            let column = table.fields.iter().position(|field| field.name == "practice").expect("a column");
            table.rows.iter().map(|row| row[column].clone()).collect::<Vec<_>>()
        };
        assert_eq!(of(false), [Cell::Flag(false)]);
        assert_eq!(of(true), [Cell::Flag(true), Cell::Flag(false)]);
    }
}
