//! A study's own tables: participants, missions, answers and notes; and the columns that tell of the tables of logs under which
//! conditions their sessions were played.

mod answers;
mod datapackage;
pub(crate) mod exercises;
mod missions;
pub(crate) mod probes;
mod scores;

use std::{borrow::Cow, path::PathBuf};

use cohabit_tables::{
    Cell, CsvError, Field,
    Kind::{Flag, Text, Whole},
    ParquetFileError, Table, codebook, write_csv, write_parquet,
};

pub use datapackage::DataPackageError;

use crate::{
    design::{Block, Choice, FactorKind, Study},
    folder::{Folder, FolderError, Note},
    pair::{PAIR_SIZE, pair_label, pair_of, seat_of},
    plan::{Plan, Step, place_of, pseudonym},
    progress::{Doing, Done, Phase, Progress},
    records::Records,
    session::{Whose, step_of},
};

/// Why a study's tables could not be written.
#[derive(Debug, thiserror::Error)]
pub enum TablesError {
    /// A table cannot be written.
    #[error(transparent)]
    Csv(#[from] CsvError),
    /// A table cannot be written as Parquet.
    #[error(transparent)]
    Parquet(#[from] ParquetFileError),
    /// What they are cannot be written beside them.
    #[error(transparent)]
    DataPackage(#[from] DataPackageError),
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
    let tables = vec![participants(study, all, &withdrawn), answers::table(study, all)];
    for table in marked(tables, folder.is_synthetic()) {
        write_csv(&table, folder.path())?;
    }
    Ok(())
}

/// Whether a session of that name was for practice.
#[must_use]
pub fn is_practice(all: &[Progress], session: &str) -> bool {
    let Some((whose, step)) = step_of(session) else { return false };
    all.iter().any(|progress| whose.includes(progress.plan().place) && progress.plan().is_practice(step))
}

/// Whether a session of that name is of somebody whom the experimenter excluded; of a pair's: of either.
#[must_use]
pub fn is_of_excluded(all: &[Progress], session: &str) -> bool {
    let Some((whose, _)) = step_of(session) else { return false };
    all.iter().any(|progress| progress.exclusion().is_some() && whose.includes(progress.plan().place))
}

/// All tables of a study, with those of its logs, which get columns for whose they are and under which conditions, and a
/// codebook at the end. Missions for practice are in none, but `with_practice`.
#[must_use]
pub fn all(records: &Records, mut of_logs: Vec<Table>, with_practice: bool) -> Vec<Table> {
    let Records { study, progress, withdrawn, notes: noted, is_synthetic } = records;
    add_conditions(study, progress, &mut of_logs);
    let own = [
        participants(study, progress, withdrawn),
        missions::table(study, progress, with_practice),
        answers::table(study, progress),
        scores::table(study, progress),
        probes::table(study, progress, with_practice),
        notes(noted),
    ];
    let exercises = has_tutorial(study).then(|| exercises::table(study, progress));
    let mut tables = marked(own.into_iter().chain(exercises).chain(of_logs).collect(), *is_synthetic);
    tables.push(codebook(&tables));
    tables
}

fn has_tutorial(study: &Study) -> bool {
    study.blocks.iter().any(|block| matches!(block, Block::Mission { exercises, .. } if !exercises.is_empty()))
}

/// Writes [`all`] tables into a folder, each as CSV and as Parquet, with what they are for programs (`datapackage.json`); gives their paths.
///
/// # Errors
/// [`TablesError`].
pub fn export(
    records: &Records,
    of_logs: Vec<Table>,
    with_practice: bool,
    out: &std::path::Path,
) -> Result<Vec<PathBuf>, TablesError> {
    let tables = all(records, of_logs, with_practice);
    let mut paths = tables.iter().map(|table| write_csv(table, out)).collect::<Result<Vec<_>, _>>()?;
    for table in &tables {
        paths.push(write_parquet(table, out)?);
    }
    paths.push(datapackage::write(records, &tables, out)?);
    Ok(paths)
}

/// These tables, each row of which says whether simulated people made it.
fn marked(mut tables: Vec<Table>, is_synthetic: bool) -> Vec<Table> {
    for table in &mut tables {
        table.fields.push(field("synthetic", Flag, "", "whether a program played the participant: no data of people"));
        table.rows.iter_mut().for_each(|row| row.push(Cell::Flag(is_synthetic)));
    }
    tables
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

/// The names of what conditions are assigned by.
fn covariates(study: &Study) -> impl Iterator<Item = &str> {
    study.minimisation.iter().flat_map(|all| &all.covariates).map(|covariate| covariate.name.as_str())
}

const ALL_KINDS: [FactorKind; 3] = [FactorKind::Between, FactorKind::Own, FactorKind::Within];
/// The kinds of which each participant meets one level.
const BETWEEN: [FactorKind; 2] = [FactorKind::Between, FactorKind::Own];

/// Columns of participants before those of their pairs.
const PLACE_CELLS: usize = 2;

fn participants(study: &Study, all: &[Progress], withdrawn: &[String]) -> Table {
    let fields: [Field; PLACE_CELLS] = [
        field("participant", Text, "", "what the participant is called"),
        field("place", Whole, "", "their place in the order of all, from 1"),
    ];
    let fields: Vec<Field> = fields.into_iter().chain(pair_fields(study)).collect();
    let more = [
        field(
            "missions",
            Text,
            "",
            "their missions in order, each with the levels of within-participant factors, or that it is for practice",
        ),
        field(
            "progress",
            Text,
            "",
            "where they are: the kind of step, or finished, excluded, withdrawn; or parted, whose partner takes no part any more",
        ),
        field("steps_done", Whole, "", "steps of their plan that they have done"),
        field("steps", Whole, "", "steps of their plan"),
        field("consented_ms", Whole, "ms", "wall time at which they agreed to take part, since 1970"),
        field("last_ms", Whole, "ms", "wall time at which their last step ended, since 1970"),
        field("excluded_because", Text, "", "why the experimenter excluded them; nothing, if they did not"),
    ];
    let covariates = covariates(study)
        .map(|name| field(format!("covariate_{name}"), Text, "", "its level, by which their condition was assigned"));
    let between: Vec<Field> = factor_fields(study, &BETWEEN).into_iter().chain(covariates).collect();
    let count = fields.len() + between.len() + more.len();
    let gone = |name: &String| {
        let mut row = vec![Cell::Nothing; count];
        row[0] = text(name);
        let pair = place_of(name).map(|place| pair_cells(study, place)).unwrap_or_default();
        pair.into_iter().enumerate().for_each(|(at, cell)| row[PLACE_CELLS + at] = cell);
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
    let first = [text(pseudonym(plan.place)), whole(plan.place)].into_iter().chain(pair_cells(study, plan.place));
    let more = [
        text(missions_of(plan)),
        text(progress_name(progress)),
        whole(done.len()),
        whole(plan.steps.len()),
        done.first().map_or_else(|| whole(progress.since_ms()), |done| whole(done.began_ms)),
        done.last().map_or(Cell::Nothing, |done| whole(done.ended_ms)),
        progress.exclusion().map_or(Cell::Nothing, text),
    ];
    let covariate = |name: &str| plan.covariates.get(name).map_or(Cell::Nothing, text);
    let between = factor_cells(study, &BETWEEN, &plan.between);
    let between = between.into_iter().chain(covariates(study).map(covariate));
    first.chain(between).chain(more).collect()
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
        (Phase::Assigning, _) => "assigning",
        (Phase::Finished, _) => "finished",
        (Phase::Withdrawn, _) => "withdrawn",
        (Phase::Excluded, _) => "excluded",
        (Phase::Parted, _) => "parted",
        (_, Some((_, Step::Questionnaire { .. }, _))) => "questionnaire",
        (_, Some((_, Step::Break { .. }, _))) => "break",
        (_, Some((_, _, Doing::Queued { .. }))) => "waiting",
        (_, Some((_, _, Doing::Playing))) => "mission",
        _ => "ready",
    }
}

/// Which step of a participant's plan a row is about.
fn step_fields(study: &Study) -> Vec<Field> {
    let participant = field("participant", Text, "", "what the participant is called");
    let step = field("step", Whole, "", "which step of their plan, from 1");
    std::iter::once(participant).chain(pair_fields(study)).chain([step]).collect()
}

/// In a study of pairs: which pair a participant belongs to.
fn pair_fields(study: &Study) -> Vec<Field> {
    if study.pairing.is_none() {
        return Vec::new();
    }
    vec![
        field("pair", Text, "", "what their pair is called, which is in the names of the sessions that it played"),
        field("seat", Whole, "", "their seat in it, 1 or 2: the number of their page in sessions"),
    ]
}

fn pair_cells(study: &Study, place: u32) -> Vec<Cell> {
    if study.pairing.is_none() {
        return Vec::new();
    }
    vec![text(pair_label(pair_of(place))), whole(seat_of(place) + 1)]
}

/// A table of what came of steps that were done, with the conditions under which they were.
fn of_steps(
    study: &Study,
    all: &[Progress],
    name: &'static str,
    meaning: &'static str,
    more: impl IntoIterator<Item = Field>,
    rows: fn(&Study, &Plan, &Done) -> Vec<Vec<Cell>>,
) -> Table {
    let fields = step_fields(study).into_iter().chain(factor_fields(study, &ALL_KINDS)).chain(more).collect();
    let of_one = |progress: &Progress| -> Vec<Vec<Cell>> {
        progress.done().iter().flat_map(|done| rows(study, progress.plan(), done)).collect()
    };
    Table { name, meaning, fields, rows: all.iter().flat_map(of_one).collect() }
}

/// The mission that a questionnaire is about, if it is about one.
fn mission_about(plan: &Plan, about: Option<usize>) -> Cell {
    match about.and_then(|about| plan.steps.get(about)) {
        Some(Step::Mission(mission)) => text(&mission.mission),
        _ => Cell::Nothing,
    }
}

fn step_cells(study: &Study, plan: &Plan, done: &Done) -> Vec<Cell> {
    let participant = text(pseudonym(plan.place));
    std::iter::once(participant).chain(pair_cells(study, plan.place)).chain([whole(done.step + 1)]).collect()
}

/// What practice is called in tables.
fn practice_field() -> Field {
    field("practice", Flag, "", "whether it was for practice: under no condition")
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

/// Adds to tables of logs, by the name of the session, which step it was, whether for practice, and the levels of all factors; in a
/// study of pairs also whose it was. A session of a pair has the levels that both met.
fn add_conditions(study: &Study, all: &[Progress], tables: &mut [Table]) {
    for table in tables {
        let Some(column) = table.fields.iter().position(|field| field.name == "session") else { continue };
        let person = table.fields.iter().position(|field| field.name == "person");
        let is_of_pairs = study.pairing.is_some();
        table
            .fields
            .extend(is_of_pairs.then(|| field("pair", Text, "", "what the pair is called whose session it is")));
        let seat = person.filter(|_| is_of_pairs);
        table.fields.extend(seat.map(|_| field("seat", Whole, "", "whose page it was: the seat in the pair, 1 or 2")));
        table.fields.push(field("step", Whole, "", "which step of the participant's plan it belongs to, from 1"));
        table.fields.push(practice_field());
        table.fields.extend(factor_fields(study, &ALL_KINDS));
        for row in &mut table.rows {
            let of = match &row[column] {
                Cell::Text(session) => step_of(session),
                _ => None,
            };
            if is_of_pairs {
                row.push(of.map_or(Cell::Nothing, |(whose, _)| text(pair_label(whose.pair()))));
            }
            if let Some(person) = seat {
                let seat = of.map_or(Cell::Nothing, |(whose, _)| seat_at(whose, &row[person]));
                row.push(seat);
            }
            let plans: Vec<&Plan> = of.map_or_else(Vec::new, |(whose, _)| {
                all.iter().map(Progress::plan).filter(|plan| whose.includes(plan.place)).collect()
            });
            let step = of.map(|(_, step)| step).filter(|_| !plans.is_empty());
            row.push(step.map_or(Cell::Nothing, |step| whole(step + 1)));
            row.push(step.map_or(Cell::Nothing, |step| Cell::Flag(plans[0].is_practice(step))));
            row.extend(factor_cells(study, &ALL_KINDS, &step.map(|step| choices_of(&plans, step)).unwrap_or_default()));
        }
    }
}

/// The levels of all factors under which a step was done by all of these.
fn choices_of(plans: &[&Plan], step: usize) -> Vec<Choice> {
    let mut met = plans.first().map(|plan| plan.choices(step)).unwrap_or_default();
    met.retain(|choice| plans.iter().all(|plan| plan.choices(step).contains(choice)));
    met
}

/// The seat of whoever's page has that number in a session.
fn seat_at(whose: Whose, person: &Cell) -> Cell {
    match (whose, person) {
        (Whose::Participant(place), _) => whole(seat_of(place) + 1),
        // Pages of seats have the first numbers; what nobody said at a page has none.
        (Whose::Pair(_), Cell::Whole(number)) if (1..=i64::from(PAIR_SIZE)).contains(number) => Cell::Whole(*number),
        (Whose::Pair(_), _) => Cell::Nothing,
    }
}

#[cfg(test)]
mod tests;
