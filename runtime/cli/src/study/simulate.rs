//! `cohabit study simulate`: a dry run of a study with simulated people.

use std::{path::PathBuf, thread};

use anyhow::Context as _;
use cohabit_study::{DryRun, Folder, People, SimulateError, Simulated, simulate};
use indicatif::{ProgressBar, ProgressStyle};

use super::{
    Export, read, refused,
    speakers::{Speakers, unheeded},
    world_of,
};
use crate::{failure::bad_input, terminal::shown};

/// The seed of a dry run that names none.
const SEED: u64 = 1;

#[derive(clap::Args)]
pub struct Simulate {
    /// The study's file (TOML)
    file: PathBuf,
    /// The folder of all synthetic data, which must not exist yet, or be empty
    #[arg(long, value_name = "DATA")]
    folder: PathBuf,
    /// How many simulated people come; as many as are planned, if absent
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u32).range(1..))]
    participants: Option<u32>,
    /// The seed of all that they are, say and answer: the same one gives the same tables
    #[arg(long, default_value_t = SEED)]
    seed: u64,
    /// How they are (TOML): who leaves, how they speak, what they answer under which condition
    #[arg(long, value_name = "FILE")]
    people: Option<PathBuf>,
    /// How many missions are played at a time; one for each core, if absent
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u16).range(1..))]
    workers: Option<u16>,
    /// Write what comes of it into this folder, too: tables, a summary, plots and the methods sheet, as `cohabit study export --summary`
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
}

impl Simulate {
    /// Plays the study.
    pub fn run(&self) -> anyhow::Result<()> {
        let (file, study) = read(&self.file)?;
        let people = self.people.as_ref().map(|path| People::read(path, &study)).transpose().map_err(bad_input)?;
        let run = DryRun {
            participants: self.participants.unwrap_or(study.participants),
            seed: self.seed,
            people: people.unwrap_or_default(),
            program: env!("CARGO_PKG_VERSION").to_owned(),
        };
        let (has_wizard, world) = (study.has_wizard(), world_of(&study, file.folder())?);
        let passed_over = unheeded(&study.all_settings());
        let mut files = study.files.clone();
        files.insert("study.toml".to_owned(), file.text.clone());
        let folder = Folder::begin_synthetic(&self.folder, &files, &run).map_err(refused)?;
        let speakers = Speakers::new(file.folder(), world).context("a folder for logs")?;
        let cores = thread::available_parallelism().map_or(1, usize::from);
        let workers = self.workers.map_or(cores, usize::from);
        let bar = ProgressBar::new(u64::from(run.participants)).with_style(
            ProgressStyle::with_template("{bar:30} {pos}/{len} participants, {elapsed} ({eta} left)")
                .unwrap_or_else(|_| ProgressStyle::default_bar()),
        );
        let simulated = simulate(study, folder, &run, &speakers, workers, &|| bar.inc(1)).map_err(classed)?;
        bar.finish_and_clear();
        self.tell(&run, &simulated, &passed_over);
        if has_wizard {
            println!("note: where a wizard takes part, each proposal of the robot counts as accepted");
        }
        match &self.out {
            Some(out) => Export { folder: self.folder.clone(), out: out.clone(), practice: false, summary: true }.run(),
            None => Ok(()),
        }
    }

    fn tell(&self, run: &DryRun, simulated: &Simulated, passed_over: &[String]) {
        let Simulated { consented, finished, withdrawn, excluded, stopped, missions } = simulated;
        println!(
            "Synthetic data of {} simulated participants in {}: {consented} consented, {finished} finished, {withdrawn} withdrew, \
             {excluded} were excluded, {stopped} stopped in the middle; {missions} missions were played",
            run.participants,
            shown(self.folder.display())
        );
        if !passed_over.is_empty() {
            println!(
                "note: the dry run could not act out these settings of the study, which take a page, a sound, a picture or \
                 another mind: {}",
                shown(passed_over.join(", "))
            );
        }
    }
}

fn classed(error: SimulateError) -> anyhow::Error {
    match error {
        SimulateError::Folder(error) => refused(error),
        SimulateError::Session { .. } => bad_input(error),
        other => other.into(),
    }
}

#[cfg(test)]
mod tests {
    use std::{fs, path::Path};

    use super::*;

    const STUDY: &str = r#"
title = "A short study"
contact = "the lab"
seed = 11
participants = 2
assignment = "latin_square"
missions = ["cold_soda", "laser_lab"]
settings = { understanding = "fast" }
information = { file = "sheet.md", version = "1" }
consent = { file = "sheet.md", version = "3", required = ["I agree."] }
factor = [{ name = "ask", kind = "within", level = [
    { name = "never", settings = { ask = "never" } }, { name = "always", settings = { ask = "always", wizard = "yes" } },
] }]
probe = [{ questionnaire = "probe.toml", at = "goal_met" }]
block = [
    { kind = "practice", mission = "cold_soda", minutes = 0.5 },
    { kind = "missions", minutes = 10, skip_after_minutes = 4, after_mission = ["tlx"] },
    { kind = "debriefing", file = "sheet.md" },
]
"#;
    const PROBE: &str = "title = \"T\"\nscale = { least = 1, most = 5 }\n[[item]]\nask = \"How?\"\n";

    /// All tables of a dry run, by name, and its methods sheet.
    fn dry_run(folder: &Path, name: &str) -> Vec<(String, String)> {
        let [data, out] = ["", "-tables"].map(|part| folder.join(format!("{name}{part}")));
        let run = Simulate {
            file: folder.join("study.toml"),
            folder: data,
            participants: Some(3),
            seed: 7,
            people: Some(folder.join("people.toml")),
            workers: Some(2),
            out: Some(out.clone()),
        };
        run.run().expect("a dry run");
        let entries = fs::read_dir(out).expect("tables").map(|entry| entry.expect("a table").path());
        let read = |path: PathBuf| {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            // Parquet files are no text, but are compared, too.
            (name, String::from_utf8_lossy(&fs::read(path).expect("a table")).into_owned())
        };
        let mut tables: Vec<_> = entries.map(read).collect();
        tables.sort();
        tables
    }

    #[test]
    fn a_dry_run_has_all_tables_twice_the_same_and_marked() {
        let folder = std::env::temp_dir().join(format!("cohabit-dry-run-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).expect("a folder");
        let files = [
            ("study.toml", STUDY),
            ("sheet.md", "Read."),
            ("probe.toml", PROBE),
            ("people.toml", "[leaving]\nstops = 0\nwithdraws = 0\n"),
        ];
        files.iter().for_each(|(name, text)| fs::write(folder.join(name), text).expect("a file"));
        let tables = dry_run(&folder, "one");
        assert_eq!(tables, dry_run(&folder, "two"));
        let table = |name: &str| tables.iter().find(|(own, _)| own == name).map(|(_, text)| text.as_str()).expect(name);
        assert!(table("methods.md").starts_with("> **Synthetic data.**"));
        // By one command: what the conditions did, as text and as plots.
        assert!(table("summary.txt").contains("ask"), "{}", table("summary.txt"));
        assert!(tables.iter().any(|(name, text)| name.starts_with("plot_") && text.contains("<svg")));
        for name in [
            "sessions.csv",
            "turns.csv",
            "actions.csv",
            "goals.csv",
            "missions.csv",
            "probes.csv",
            "scores.csv",
            "decisions.csv",
        ] {
            let mut lines = table(name).lines();
            assert!(lines.next().is_some_and(|head| head.ends_with(",synthetic")), "{name}");
            assert!(lines.clone().count() > 3 && lines.any(|line| line.ends_with(",true")), "{name}: {}", table(name));
        }
        // Nobody decided: where a wizard takes part, what the robot proposed counts as accepted, turn by turn.
        let rows = |name: &str, condition: &str| table(name).lines().filter(|line| line.contains(condition)).count();
        assert_eq!(rows("decisions.csv", ",accepted,false,"), rows("decisions.csv", "P0"));
        assert_eq!(rows("decisions.csv", "P0"), rows("turns.csv", ",always,"), "{}", table("decisions.csv"));
        assert!(table("methods.md").contains("the dry run took each proposal for accepted"), "{}", table("methods.md"));
        assert_eq!(table("sessions.csv").lines().count(), 1 + 3 * 2, "practice is left out: {}", table("sessions.csv"));
        assert!(table("missions.csv").contains("complete"), "{}", table("missions.csv"));
        let log = cohabit_record::Log::open(&folder.join("one/logs/P02-02-1.mcap")).expect("a log");
        assert_eq!(log.problems(), Vec::<String>::new());
        let noted = (log.session.participant.as_deref(), log.session.settings["synthetic"].as_str());
        assert_eq!(noted, (Some("P02"), "true"));
        let practice = cohabit_record::Log::open(&folder.join("one/logs/P02-01-1.mcap")).expect("a log");
        let (first, last) = (&practice.ticks[0], &practice.ticks[practice.ticks.len() - 1]);
        assert!(last.wall_nanos - first.wall_nanos <= 30_000_000_000, "it is cut off at its limit");
        let _ = fs::remove_dir_all(&folder);
    }
}
