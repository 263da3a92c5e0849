//! What sessions say about conditions, as files beside their tables: plots, a script that reads the tables, and the summary as text.

use std::{fs, path::Path};

use cohabit_tables::{NOTEBOOK, Played, Summary, plots};

use crate::{failure::bad_input, terminal::shown};

/// The script that reads the tables.
const SCRIPT: &str = "analysis.py";
/// The summary as text.
const SUMMARY: &str = "summary.txt";

/// Writes a plot of each outcome by these conditions beside the tables, and a script that reads these, unless there is one,
/// which may have been edited.
pub fn write_plots(played: &[Played], by: &[String], folder: &Path, quietly: bool) -> anyhow::Result<()> {
    let plots = plots(played, by).map_err(bad_input)?;
    let script = folder.join(SCRIPT);
    let script = (!script.exists()).then_some((script, NOTEBOOK));
    let files = plots.iter().map(|plot| (folder.join(&plot.file), plot.svg.as_str()));
    for (path, text) in files.chain(script) {
        fs::write(&path, text).map_err(|error| bad_input(format!("{}: {error}", path.display())))?;
    }
    if !quietly {
        let folder = shown(folder.display());
        println!("{} plots (plot_*.svg) written to {folder}, beside a script for pandas ({SCRIPT})", plots.len());
    }
    Ok(())
}

/// Writes the summary, plots and the script beside tables. Conditions that no session notes count as all in which sessions differ.
pub fn write_summary(played: &[Played], by: &[String], folder: &Path) -> anyhow::Result<()> {
    let is_noted = Summary::new(played, by).is_ok();
    let by: &[String] = if is_noted { by } else { &[] };
    let summary = Summary::new(played, by).map_err(bad_input)?;
    let path = folder.join(SUMMARY);
    fs::write(&path, summary.to_string()).map_err(|error| bad_input(format!("{}: {error}", path.display())))?;
    println!("{}", shown(path.display()));
    write_plots(played, by, folder, false)
}
