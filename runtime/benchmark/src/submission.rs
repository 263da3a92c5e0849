//! A submission: a file of JSON lines, a header and an episode a line.

use std::{
    collections::BTreeMap,
    fs, io,
    path::{Path, PathBuf},
};

use cohabit_cdf::PackId;
use serde::{Deserialize, Serialize};

use crate::{benchmark::Benchmark, episode::Episode, mission::Split, totals::Totals};

/// Why a submission cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum SubmissionError {
    /// The file cannot be read.
    #[error("{path}: {source}")]
    File {
        /// Which.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// Its first line is no header.
    #[error("{path}:1: not the header of a submission: {reason}; `cohabit benchmark run` writes submissions")]
    Header {
        /// Which.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
}

/// Who played.
#[derive(Clone, Debug, Default, Deserialize, Eq, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct AgentCard {
    /// Its name.
    pub name: String,
    /// Its version; empty, if it has none.
    pub version: String,
    /// What it is, in a sentence.
    pub description: String,
    /// Whether its questions were answered.
    pub questions: bool,
    /// How it was set, by the names of settings.
    pub settings: BTreeMap<String, String>,
}

/// The first line of a submission.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Header {
    /// Counts changes of this format.
    pub format: u32,
    /// The version of the benchmark.
    pub benchmark: u32,
    /// The digest of its missions.
    pub missions: String,
    /// The world packs that it is played with, in their order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub world: Vec<PackId>,
    /// The splits that were played.
    pub splits: Vec<Split>,
    /// Who played.
    pub agent: AgentCard,
    /// The version of the program.
    pub program: String,
    /// Where it was played.
    pub machine: String,
    /// The figures, once all is played.
    pub totals: Option<Totals>,
}

impl Header {
    /// The format of this build.
    pub const FORMAT: u32 = 1;

    /// That of an agent that plays these splits of a benchmark on a machine.
    #[must_use]
    pub fn new(benchmark: &Benchmark, splits: &[Split], agent: AgentCard, machine: &str) -> Self {
        Self {
            format: Self::FORMAT,
            benchmark: benchmark.version,
            missions: benchmark.digest.clone(),
            world: benchmark.catalog.packs().to_vec(),
            splits: splits.to_vec(),
            agent,
            program: env!("CARGO_PKG_VERSION").to_owned(),
            machine: machine.to_owned(),
            totals: None,
        }
    }

    /// Whether it is of the same run, which may go on on another machine.
    #[must_use]
    pub fn is_same_run(&self, other: &Self) -> bool {
        let bare = |header: &Self| Self { machine: String::new(), totals: None, ..header.clone() };
        bare(self) == bare(other)
    }

    /// Reads a first line; what is wrong with it, in words.
    pub(crate) fn parse(line: &str) -> Result<Self, String> {
        let header: Self = serde_json::from_str(line).map_err(|error| error.to_string())?;
        if header.format != Self::FORMAT {
            return Err(format!("it has format {}, this program reads {}", header.format, Self::FORMAT));
        }
        Ok(header)
    }
}

/// A line of a submission behind the first.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Its number, from 1.
    pub number: usize,
    /// Its episode; or what is wrong with it, in words.
    pub episode: Result<Episode, String>,
}

/// A submission.
#[derive(Clone, Debug, PartialEq)]
pub struct Submission {
    /// Its header.
    pub header: Header,
    /// All that follows.
    pub lines: Vec<Line>,
}

impl Submission {
    /// Reads one. A line that is no episode is kept as what is wrong with it.
    ///
    /// # Errors
    /// [`SubmissionError`].
    pub fn read(path: &Path) -> Result<Self, SubmissionError> {
        let text =
            fs::read_to_string(path).map_err(|source| SubmissionError::File { path: path.to_owned(), source })?;
        Self::parse(&text).map_err(|reason| SubmissionError::Header { path: path.to_owned(), reason })
    }

    /// The same of its text; what is wrong with its header, in words.
    ///
    /// # Errors
    /// In words.
    pub fn parse(text: &str) -> Result<Self, String> {
        let mut lines = text.lines();
        let header = Header::parse(lines.next().unwrap_or_default())?;
        let lines = (2..).zip(lines).map(|(number, line)| {
            let episode = serde_json::from_str(line).map_err(|error| error.to_string());
            Line { number, episode }
        });
        Ok(Self { header, lines: lines.collect() })
    }
}
