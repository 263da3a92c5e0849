//! `cohabit study`: a study from plan to data.

mod activities;
mod data;
mod health;
mod pausing;
mod plan;
mod ports;
mod program;
mod report;
mod results;
mod sessions;
mod simulate;
mod solving;
mod speakers;
mod synthetic_log;
mod wishes;

use std::{
    path::{Path, PathBuf},
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::{SystemTime, UNIX_EPOCH},
};

use anyhow::Context as _;
use cohabit_cdf::WorldData;
use cohabit_dialog::{Consulting, Endpoint};
use cohabit_study::{
    Cycle, Folder, FolderError, Records, Registry, StudyFile, StudyService, day, export, keep,
    settings::{Setting, Settings},
};
use cohabit_tables::tables;

use crate::{
    capacity::SessionCount,
    doctor::ensure_room,
    failure::{bad_input, environment},
    readable_logs::ReadLogs,
    site::{Ending, SiteOptions},
    stop,
    terminal::{print, shown},
    world::WorldPacks,
};
pub use data::{is_left_out, is_of_practice, participants_of};
use plan::Plan;
pub use ports::{PortRange, Ports, Taken};
use program::ThisProgram;
use report::Report;
use sessions::{Served, Sessions};
use simulate::Simulate;
use solving::solve_all;

/// The setting that says when a language model is asked.
const MODEL: &str = "model";

/// Runs a study: participants, their conditions, their consent, their sessions, and their data
#[derive(clap::Args)]
pub struct Study {
    #[command(subcommand)]
    command: StudyCommand,
}

#[derive(clap::Subcommand)]
enum StudyCommand {
    /// Say what is wrong in a study's file, and where
    Check(Check),
    /// Say how many participants an effect needs to be found, by simulation
    Plan(Plan),
    /// Serve the pages of participants and of the experimenter, and play their sessions
    Run(Run),
    /// Play the whole study with simulated people, before anybody comes
    Simulate(Simulate),
    /// Remove all data of a participant, and note that it was done
    Withdraw(Withdraw),
    /// Write all data as tables (CSV and Parquet) with a codebook
    Export(Export),
    /// Write the methods sheet: what a paper has to say of how the study was run
    Report(Report),
}

#[derive(clap::Args)]
struct Check {
    /// The study's file (TOML)
    #[arg(required_unless_present = "schema")]
    file: Option<PathBuf>,
    /// Print the JSON Schema of studies' files, and nothing else
    #[arg(long, exclusive = true)]
    schema: bool,
    /// Have the planner play each mission to its goals, too, and name those that it does not solve: some seconds for each
    #[arg(long)]
    solve: bool,
}

#[derive(clap::Args)]
struct Run {
    /// The study's file (TOML)
    file: PathBuf,
    /// The folder of all of its data; made, if it is not there
    #[arg(long, value_name = "DATA")]
    folder: PathBuf,
    /// The port of the pages; 0 takes any that is free
    #[arg(long, default_value_t = 8700)]
    port: u16,
    #[command(flatten)]
    site: SiteOptions,
    /// The ports of the pages of sessions, which other machines have to reach, too, such as 8701-8708: one for each session
    /// at a time; any that are free, if absent
    #[arg(long, value_name = "FIRST-LAST")]
    session_ports: Option<PortRange>,
    /// How many sessions are played at a time, while other participants wait: a number, `quick` for as many as the machine carries by
    /// what one takes, or `full` for as many as it was seen to carry, which takes minutes where it was not measured yet
    #[arg(long, value_name = "COUNT|quick|full", default_value_t = SessionCount::Quick)]
    sessions: SessionCount,
}

#[derive(clap::Args)]
struct Withdraw {
    /// Who, such as P07
    participant: String,
    /// The folder that was given to `cohabit study run`
    #[arg(long, value_name = "DATA")]
    folder: PathBuf,
}

#[derive(clap::Args)]
struct Export {
    /// The folder that was given to `cohabit study run` or `cohabit study simulate`
    #[arg(long, value_name = "DATA")]
    folder: PathBuf,
    /// The folder to write tables into
    #[arg(long, value_name = "FOLDER")]
    out: PathBuf,
    /// Have sessions and missions for practice in the tables, too, marked as such
    #[arg(long)]
    practice: bool,
    /// Write a summary by the study's conditions, plots (SVG), a script for pandas and the methods sheet beside the tables, too
    #[arg(long)]
    summary: bool,
}

impl Study {
    /// Does what is asked for.
    pub fn run(&self) -> anyhow::Result<()> {
        match &self.command {
            StudyCommand::Check(check) => check.run(),
            StudyCommand::Plan(plan) => plan.run(),
            StudyCommand::Run(run) => run.run(),
            StudyCommand::Simulate(simulate) => simulate.run(),
            StudyCommand::Withdraw(withdraw) => withdraw.run(),
            StudyCommand::Export(export) => export.run(),
            StudyCommand::Report(report) => report.run(),
        }
    }
}

/// A study's file, and the study in it.
fn read(path: &Path) -> anyhow::Result<(StudyFile, cohabit_study::Study)> {
    let file = StudyFile::read(path).map_err(bad_input)?;
    let study = file.check(&ThisProgram::default()).map_err(bad_input)?;
    Ok((file, study))
}

/// The study that is kept in a folder of data.
fn kept(folder: &Path) -> anyhow::Result<(StudyFile, cohabit_study::Study)> {
    let file = Folder::study_file(folder);
    if !file.is_file() {
        return Err(bad_input(FolderError::NoStudy { path: folder.to_owned() }));
    }
    let (file, study) = read(&file)?;
    tell_kept_too_long(&study, folder);
    Ok((file, study))
}

/// What is to be said of the data in a folder on a day after the last one on which they were to be kept.
fn kept_too_long(study: &cohabit_study::Study, folder: &Path, today: &str) -> Option<String> {
    let until = study.keep_until.as_deref().filter(|until| *until < today)?;
    Some(format!(
        "the data in {} were to be kept until {until}: delete that folder, and tables that were exported from it",
        shown(folder.display())
    ))
}

fn tell_kept_too_long(study: &cohabit_study::Study, folder: &Path) {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    let today = day(u64::try_from(since.as_millis()).unwrap_or_default());
    if let Some(note) = kept_too_long(study, folder, &today) {
        eprintln!("cohabit: {note}");
    }
}

/// What the sessions of a study were played in whose files lie in a folder.
fn world_of(study: &cohabit_study::Study, folder: &Path) -> anyhow::Result<WorldData> {
    let packs = study.worlds.iter().map(|world| (world.folder.as_str(), &world.id));
    WorldPacks::beside(folder, packs).read()
}

/// What is to be said of a study some of whose settings have a language model asked, where there is none.
fn no_model(study: &cohabit_study::Study, has_model: bool) -> Option<&'static str> {
    let is_never = |setting: &Setting| *setting == Setting::Value(Consulting::Never.name().to_owned());
    let asks = |settings: &Settings| settings.get(MODEL).is_some_and(|setting| !is_never(setting));
    let asked = !has_model && study.all_settings().iter().any(asks);
    asked.then_some("`model` is set, and no language model is: name one by COHABIT_MODEL_URL and COHABIT_MODEL")
}

impl Check {
    fn run(&self) -> anyhow::Result<()> {
        let Some(file) = self.file.as_ref().filter(|_| !self.schema) else {
            return print(&format!("{:#}\n", cohabit_study::schema()));
        };
        let (read, study) = read(file)?;
        Self::tell(file, &study);
        if self.solve { solve_all(&study, read.folder(), &world_of(&study, read.folder())?) } else { Ok(()) }
    }

    /// Says what is to be known of a study that can be run.
    fn tell(file: &Path, study: &cohabit_study::Study) {
        let count = |kind| study.conditions(kind).len();
        let (between, within) =
            (count(cohabit_study::design::FactorKind::Between), count(cohabit_study::design::FactorKind::Within));
        println!(
            "{}: can be run: {} between-participants and {} within-participant conditions, {} participants planned{}",
            shown(file.display()),
            between,
            within,
            study.participants,
            if study.pairing.is_some() { ", in pairs" } else { "" }
        );
        for world in &study.worlds {
            println!("World pack in {}: {}", shown(&world.folder), shown(&world.id));
        }
        if let Some(note) = study.wizard_note() {
            println!("note: {note}");
        }
        if study.keep_until.is_none() {
            println!("note: `keep_until` does not say until when data of participants are kept");
        }
        if let Some(note) = no_model(study, Endpoint::from_environment().is_ok_and(|model| model.is_some())) {
            println!("note: {note}");
        }
        if let Some(minimisation) = &study.minimisation {
            let names: Vec<&str> = minimisation.covariates.iter().map(|covariate| covariate.name.as_str()).collect();
            println!("Between-participants conditions are assigned by minimisation over {}", shown(names.join(", ")));
            return;
        }
        let cycle = Cycle::of(study);
        println!("One full cycle of the assignment takes {cycle}");
        if let Some(note) = cycle.note(study.participants) {
            println!("note: {note}");
        }
    }
}

impl Run {
    fn run(&self) -> anyhow::Result<()> {
        let stop = stop::on_request()?;
        let (file, study) = read(&self.file)?;
        if let Some(problem) = no_model(&study, Endpoint::from_environment().map_err(bad_input)?.is_some()) {
            return Err(environment(problem));
        }
        self.check_ports()?;
        let identity = self.site.identity()?;
        ensure_room()?;
        tell_kept_too_long(&study, &self.folder);
        let mut files = study.files.clone();
        files.insert("study.toml".to_owned(), file.text);
        let folder = Folder::begin(&self.folder, &files).map_err(refused)?;
        let study_file = Folder::study_file(folder.path());
        let (listener, listening) = self.site.listen("the study", self.port, identity.as_ref())?;
        let most_sessions = self.most_sessions(&stop);
        let title = study.title.clone();
        let page = match &study.page_texts_file {
            Some(file) => format!("--page-texts={file}"),
            None => format!("--page-language={}", study.page_texts.language()),
        };
        let registry = Arc::new(Mutex::new(Registry::new(study, folder).map_err(refused)?));
        let service = StudyService { registry: Arc::clone(&registry), most_sessions };
        let served = Served {
            listening,
            hosts: self.site.hosts.clone(),
            tls: self.site.tls.clone(),
            ports: self.session_ports.clone().map(Ports::new),
            page,
        };
        let (doors, site) = (service.doors(), served.site(identity.is_some()));
        let mut sessions = Sessions::new(study_file.parent().unwrap_or(Path::new(".")), served)?;
        println!("Running \"{}\" with data in {}", shown(title), shown(self.folder.display()));
        println!("Experimenter's page: {site}{}", doors.experimenter);
        println!("Sign-up link:        {site}{}", doors.sign_up);
        println!("Observers' page:     {site}{}", doors.observer);
        if let Some(wizard) = &doors.wizard {
            println!("Wizard's seat:       {site}{wizard}");
        }
        println!("{most_sessions} at a time play; Ctrl-C ends the study, and the same command goes on with it");
        thread::scope(|scope| {
            let (hosts, stop) = (self.site.hosts.clone(), &stop);
            let server = scope.spawn(move || {
                let ending = Ending(stop);
                let served = service.serve(listener, hosts, identity, &|| stop.load(Ordering::Relaxed));
                drop(ending);
                served
            });
            // Sessions end with the thread that starts them, so it is the one that lives longest.
            keep(&registry, &mut sessions, most_sessions, stop);
            server.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        })
        .context("serve the study")?;
        println!("The study has ended; everybody's place is kept in {}", shown(self.folder.display()));
        Ok(())
    }

    /// Says whether each session has a port, where it is known how many there are.
    fn check_ports(&self) -> anyhow::Result<()> {
        match (self.sessions, &self.session_ports) {
            (SessionCount::Count(most), Some(ports)) if ports.count() < usize::from(most) => Err(bad_input(format!(
                "`--session-ports {ports}` are {} for {most} sessions at a time: give more, or fewer `--sessions`",
                ports.count()
            ))),
            _ => Ok(()),
        }
    }

    /// How many sessions are played at a time: no more than have ports.
    fn most_sessions(&self, stop: &AtomicBool) -> usize {
        self.sessions.find(stop).min(self.session_ports.as_ref().map_or(usize::MAX, PortRange::count))
    }
}

/// Of what class a folder's error is.
fn refused(error: FolderError) -> anyhow::Error {
    match error {
        FolderError::File { .. } | FolderError::Busy { .. } => environment(error),
        _ => bad_input(error),
    }
}

impl Withdraw {
    fn run(&self) -> anyhow::Result<()> {
        let folder = Folder::open(&self.folder).map_err(not_now)?;
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        folder.withdraw(&self.participant, u64::try_from(since.as_millis())?).map_err(refused)?;
        println!(
            "All data of {} are removed from {}; that it was done is kept. Tables that were exported elsewhere still have them",
            shown(&self.participant),
            shown(self.folder.display())
        );
        Ok(())
    }
}

/// Why nobody's data can be removed by this command; of a study that runs, with what removes them meanwhile.
fn not_now(error: FolderError) -> anyhow::Error {
    match error {
        FolderError::Busy { .. } => {
            environment(format!("{error}, or use the Withdraw button on the experimenter's page while the study runs"))
        }
        other => refused(other),
    }
}

impl Export {
    fn run(&self) -> anyhow::Result<()> {
        let (file, study) = kept(&self.folder)?;
        let world = world_of(&study, file.folder())?;
        let records = Records::read(study, &self.folder).map_err(refused)?;
        let logs = data::logs(&self.folder, &records.progress, self.practice)?;
        let read = ReadLogs::new(&logs, world.catalog())?;
        std::fs::create_dir_all(&self.out).map_err(|error| bad_input(format!("{}: {error}", self.out.display())))?;
        for path in export(&records, tables(&read.played), self.practice, &self.out)? {
            println!("{}", shown(path.display()));
        }
        // What is wrong with some logs is told at the end: all that can be made is made of the others.
        let checked = read.check();
        if self.summary {
            results::write(&records.study, &records.progress, read.played, &self.folder, &self.out)?;
        }
        checked
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn studies_that_ship_can_be_run() {
        let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../study/studies"));
        let entries = std::fs::read_dir(folder).expect("studies ship").map(|entry| entry.expect("a file").path());
        let studies: Vec<PathBuf> = entries.filter(|path| path.extension().is_some_and(|own| own == "toml")).collect();
        assert_eq!(studies.len(), 5, "{studies:?}");
        for path in studies {
            let checked = read(&path);
            if let Err(error) = checked {
                panic!("{}: {error:#}", path.display());
            }
        }
    }

    #[test]
    fn a_language_model_that_is_not_there_is_missed() {
        let ships = concat!(env!("CARGO_MANIFEST_DIR"), "/../study/studies/search.toml");
        let (_, mut study) = read(Path::new(ships)).expect("a study that ships");
        assert_eq!(no_model(&study, false), None);
        for (value, is_missed) in [("never", false), ("unsure", true), ("always", true)] {
            study.settings.insert(MODEL.to_owned(), Setting::Value(value.to_owned()));
            assert_eq!((no_model(&study, false).is_some(), no_model(&study, true)), (is_missed, None), "{value}");
        }
    }

    #[test]
    fn data_that_were_to_be_deleted_are_named() {
        let study = cohabit_study::Study { keep_until: Some("2031-12-31".to_owned()), ..Default::default() };
        let said = |today: &str| kept_too_long(&study, Path::new("data"), today);
        assert_eq!((said("2030-01-01"), said("2031-12-31")), (None, None));
        assert!(said("2032-01-01").is_some_and(|said| said.contains("data were to be kept until 2031-12-31: delete")));
    }

    #[test]
    fn a_folder_without_a_study_is_named() {
        let folder = PathBuf::from("/nowhere/data");
        let export = Export { folder: folder.clone(), out: folder.clone(), practice: false, summary: false };
        for said in [export.run(), Report { folder, out: None }.run()] {
            let said = said.expect_err("no study").to_string();
            assert!(said.contains("/nowhere/data holds no study: name the folder that was given to"), "{said}");
        }
    }

    #[test]
    fn who_withdraws_while_the_study_runs_has_a_button() {
        let said = not_now(FolderError::Busy { path: PathBuf::from("data") }).to_string();
        assert!(
            said.contains("data is in use") && said.contains("Withdraw button on the experimenter's page"),
            "{said}"
        );
    }
}
