//! `cohabit export`: session logs as tables, and what they say about conditions.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};

use anyhow::Context as _;
use cohabit_tables::{Played, Summary, codebook, tables, write_csv};

use crate::{
    failure::bad_input,
    readable_logs::ReadLogs,
    rerun,
    study::{is_left_out, is_of_practice, participants_of},
    summing::write_plots,
    terminal::{shown, shown_json, shown_lines},
    world::WorldPacks,
};

/// Writes turns, actions, goals and sessions as tables with a codebook, or sums them up by condition. Of sessions with people, a
/// table tells how robots moved around them.
#[derive(clap::Args)]
pub struct Export {
    /// Session logs, or folders of them; of a study's folder of logs, those of participants whom the experimenter excluded are left out
    #[arg(required = true, value_name = "LOG")]
    logs: Vec<PathBuf>,
    /// The folder to write tables into
    #[arg(long, value_name = "FOLDER", required_unless_present = "summary")]
    out: Option<PathBuf>,
    /// How tables are written
    #[arg(long, value_enum, default_value = "csv")]
    format: Format,
    /// Print success, actions and latencies by condition, with 95 % intervals, a fit of each and effect sizes. The fit is a linear
    /// mixed model where participants have several sessions, else least squares. With --out, plots (SVG) and a script for
    /// pandas are written too
    #[arg(long)]
    summary: bool,
    /// The conditions: settings of the sessions, `mission` or `participant`, with commas between; `a:b` adds the
    /// interaction of two; all settings in which the sessions differ, if absent
    #[arg(long, value_name = "CONDITIONS", value_delimiter = ',', requires = "summary")]
    by: Vec<String>,
    /// Keep sessions for practice, too, which are left out of a study's folder of logs
    #[arg(long)]
    practice: bool,
    /// Print the summary as JSON
    #[arg(long, requires = "summary")]
    json: bool,
    #[command(flatten)]
    packs: WorldPacks,
}

/// How tables are written.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum Format {
    /// Text, for anything
    Csv,
    /// Columns with their types, units and meanings
    Parquet,
}

impl Export {
    /// Writes and prints what is asked for.
    pub fn run(&self) -> anyhow::Result<()> {
        let logs = logs(&self.logs, self.practice)?;
        let world = self.packs.read()?;
        if matches!(self.format, Format::Parquet) && !self.packs.is_empty() {
            let remedy = "leave `--format` out, and write CSV";
            return Err(bad_input(format!("`--format parquet` writes no sessions of world packs yet: {remedy}")));
        }
        if let (Some(folder), Format::Parquet, false) = (&self.out, self.format, self.summary) {
            return rerun::tables(&logs, folder, self.json);
        }
        let read = ReadLogs::new(&logs, world.catalog())?;
        let played = &read.played;
        match (&self.out, self.format) {
            (Some(folder), Format::Csv) => write(played, folder, self.json)?,
            (Some(folder), Format::Parquet) => rerun::tables(&read.readable(&logs), folder, self.json)?,
            (None, _) => {}
        }
        if self.summary {
            let summary = Summary::new(played, &self.by).map_err(bad_input)?;
            if let Some(folder) = &self.out {
                write_plots(played, &self.by, folder, self.json)?;
            }
            if self.json {
                println!("{}", shown_json(serde_json::to_string_pretty(&summary).context("a summary")?));
            } else {
                print!("{}", shown_lines(summary));
            }
        }
        read.check()
    }
}

/// Writes CSV files; says so, unless what is printed is for programs.
fn write(played: &[Played], folder: &Path, quietly: bool) -> anyhow::Result<()> {
    fs::create_dir_all(folder).map_err(|error| bad_input(format!("{}: {error}", folder.display())))?;
    let tables = tables(played);
    for table in tables.iter().chain([&codebook(&tables)]) {
        let path = write_csv(table, folder)?;
        if !quietly {
            println!("{} rows written to {}", table.rows.len(), shown(path.display()));
        }
    }
    Ok(())
}

/// The logs themselves, and those in folders, in the order of their names; of folders of studies without those of practice and of
/// those who were excluded.
fn logs(paths: &[PathBuf], with_practice: bool) -> anyhow::Result<Vec<PathBuf>> {
    let mut all = Vec::new();
    for path in paths {
        if !path.is_dir() {
            all.push(path.clone());
            continue;
        }
        let failed = |error| bad_input(format!("{}: {error}", path.display()));
        let entries = fs::read_dir(path).map_err(failed)?.collect::<Result<Vec<_>, _>>().map_err(failed)?;
        let is_log = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "mcap");
        let mut own: Vec<PathBuf> = entries.iter().map(fs::DirEntry::path).filter(is_log).collect();
        if own.is_empty() {
            return Err(bad_input(format!("{}: there are no session logs (*.mcap) in it", path.display())));
        }
        own.sort();
        let progress = participants_of(path)?;
        if !with_practice {
            let why = "are for practice, and left out; --practice keeps them";
            leave_out(path, &mut own, why, |log| is_of_practice(log, &progress));
        }
        let why = "are of participants who were excluded, and left out; name the logs themselves to keep them";
        leave_out(path, &mut own, why, |log| is_left_out(log, &progress));
        all.append(&mut own);
    }
    // Who names a log and the folder that it is in means one session.
    let mut known = BTreeSet::new();
    all.retain(|path| known.insert(path.canonicalize().unwrap_or_else(|_| path.clone())));
    Ok(all)
}

/// Takes some of a folder's logs out, and says how many, if there are any.
fn leave_out(folder: &Path, logs: &mut Vec<PathBuf>, why: &str, is_it: impl Fn(&Path) -> bool) {
    let count = logs.len();
    logs.retain(|log| !is_it(log));
    let left_out = count - logs.len();
    if left_out > 0 {
        eprintln!("cohabit: {left_out} of {count} sessions in {} {why}", shown(folder.display()));
    }
}
