//! `cohabit export`: session logs as tables, and what they say about conditions.

use std::{
    fs,
    path::{Path, PathBuf},
};

use anyhow::Context as _;
use cohabit_cdf::Catalog;
use cohabit_tables::{Played, Summary, codebook, tables, write_csv};

use crate::{
    failure::bad_input,
    rerun,
    terminal::{shown, shown_json, shown_lines},
};

/// Writes turns, actions, goals and sessions as tables with a codebook, or sums them up by condition.
#[derive(clap::Args)]
pub struct Export {
    /// Session logs, or folders of them
    #[arg(required = true, value_name = "LOG")]
    logs: Vec<PathBuf>,
    /// The folder to write tables into
    #[arg(long, value_name = "FOLDER", required_unless_present = "summary")]
    out: Option<PathBuf>,
    /// How tables are written
    #[arg(long, value_enum, default_value = "csv")]
    format: Format,
    /// Print success, actions and latencies by condition, with 95 % intervals, and a least-squares fit of each
    #[arg(long)]
    summary: bool,
    /// The conditions: settings of the sessions, `mission` or `participant`, with commas between; all settings in which
    /// the sessions differ, if absent
    #[arg(long, value_name = "CONDITIONS", value_delimiter = ',', requires = "summary")]
    by: Vec<String>,
    /// Print the summary as JSON
    #[arg(long, requires = "summary")]
    json: bool,
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
        let logs = logs(&self.logs)?;
        if let (Some(folder), Format::Parquet) = (&self.out, self.format) {
            rerun::tables(&logs, folder)?;
            if !self.summary {
                return Ok(());
            }
        }
        let catalog = Catalog::builtin();
        let played = Played::open_all(&logs, &catalog).map_err(bad_input)?;
        if let (Some(folder), Format::Csv) = (&self.out, self.format) {
            write(&played, folder, self.json)?;
        }
        if self.summary {
            let summary = Summary::new(&played, &self.by).map_err(bad_input)?;
            if self.json {
                println!("{}", shown_json(serde_json::to_string_pretty(&summary).context("a summary")?));
            } else {
                print!("{}", shown_lines(summary));
            }
        }
        Ok(())
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

/// The logs themselves, and those in folders, in the order of their names.
fn logs(paths: &[PathBuf]) -> anyhow::Result<Vec<PathBuf>> {
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
        all.append(&mut own);
    }
    Ok(all)
}
