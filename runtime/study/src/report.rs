//! The methods sheet: what a paper has to say of how a study was run, in Markdown, from the study's file and its data. What only the
//! experimenter knows is named as missing.

mod design;
mod latencies;
mod pairs;
mod participants;
mod questionnaires;
mod riek;
mod wizard;

pub use participants::day;

use std::{
    collections::{BTreeMap, BTreeSet},
    fmt::Write as _,
};

use cohabit_tables::Table;

use crate::records::Records;

/// What the logs of a study's sessions say of what they were played with.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Apparatus {
    /// Versions of the program, with their builds.
    pub programs: BTreeSet<String>,
    /// Missions by their files' names, each with the fingerprints of the texts that were played.
    pub missions: BTreeMap<String, BTreeSet<String>>,
    /// Fingerprints of the object catalogue.
    pub catalogs: BTreeSet<String>,
    /// Settings that logs note, each with all of its values; of practice left out.
    pub settings: BTreeMap<String, BTreeSet<String>>,
}

/// What a methods sheet is written from.
struct Known<'a> {
    records: &'a Records,
    apparatus: &'a Apparatus,
    tables: &'a [Table],
}

/// The methods sheet of a study: `tables` are all of it, as they are exported, without practice.
#[must_use]
pub fn report(records: &Records, apparatus: &Apparatus, tables: &[Table]) -> String {
    let known = Known { records, apparatus, tables };
    let mut text = String::new();
    if records.is_synthetic {
        let warning = "> **Synthetic data.** Programs played all participants in a dry run; nothing here was measured with people.";
        let _ = writeln!(text, "{warning}\n");
    }
    let _ = writeln!(text, "# Methods: {}\n", records.study.title);
    for (title, section) in [
        ("Participants", participants::section(&known)),
        ("Design and assignment", design::assignment(&known)),
        ("Procedure", design::procedure(&known)),
        ("Apparatus", design::apparatus(&known)),
        ("Latencies", latencies::section(&known)),
        ("Wizard", wizard::section(&known)),
        ("Questionnaires", questionnaires::section(&known)),
        ("Reporting guidelines for Wizard of Oz studies", riek::section(&known)),
    ] {
        let _ = writeln!(text, "## {title}\n\n{}\n", section.trim_end());
    }
    format!("{}\n", text.trim_end())
}

impl Known<'_> {
    fn table(&self, name: &str) -> Option<&Table> {
        self.tables.iter().find(|table| table.name == name)
    }
}

/// Such as `3 missions`.
fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// Such as `one, two and three`.
fn listed(all: &[String]) -> String {
    match all {
        [] => "none".to_owned(),
        [one] => one.clone(),
        [before @ .., last] => format!("{} and {last}", before.join(", ")),
    }
}

/// A table in Markdown.
fn rows(head: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    // A bar would end the cell.
    let line = |cells: Vec<String>| format!("| {} |", cells.join(" | "));
    let cells =
        |cells: Vec<String>| cells.into_iter().map(|cell| cell.replace('|', "\\|").replace('\n', " ")).collect();
    let head_line = line(head.iter().map(|cell| (*cell).to_owned()).collect());
    let rule = line(vec!["---".to_owned(); head.len()]);
    let body = rows.into_iter().map(|row| line(cells(row)));
    [head_line, rule].into_iter().chain(body).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests;
