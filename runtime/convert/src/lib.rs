//! Data sets of demonstrations in the formats that others read.
//!
//! [`convert`] reads what `cohabit demonstrate` has written, once and without simulating again, and writes it as a [`Format`]. What it
//! writes is there once it is whole: it is written under another name beside it, and an interrupted call is made again. The same
//! data set gives the same bytes. Pictures are copied, not encoded anew.
//!
//! What each format has stands in `data/`, and goes into each set as its `README.md`.

mod arena;
mod card;
mod error;
mod lerobot;
pub mod native;
mod output;
mod picture;
mod shards;
mod tar;

use std::path::Path;

use cohabit_cdf::{Catalog, PackId};

pub use error::ConvertError;

use crate::{native::Dataset, output::Output};

/// A format that others read.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Format {
    /// `LeRobot` data sets, version 3: Parquet with pictures, and their description.
    LeRobot,
    /// Tar shards, as `WebDataset` reads them.
    Shards,
    /// The trajectory files of Alexa Arena.
    Arena,
}

impl Format {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::LeRobot, Self::Shards, Self::Arena];

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::LeRobot => "lerobot",
            Self::Shards => "shards",
            Self::Arena => "arena",
        }
    }
}

/// What was written.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Counts {
    /// Episodes.
    pub episodes: usize,
    /// Frames, samples or actions.
    pub samples: usize,
    /// Files that samples are in.
    pub files: usize,
}

/// Converts the data set in a folder into another folder, which must not be there. Files have `limit_bytes` at most, where a format
/// has many, unless one episode (or sample of shards) is larger. The catalogue is that of the world in which it was made: it numbers the
/// classes. `done` is told of each episode: how many are done, of how many.
///
/// # Errors
/// [`ConvertError`]. Nothing is in the folder then; the same call begins anew.
pub fn convert(
    dataset: &Path,
    out: &Path,
    format: Format,
    limit_bytes: usize,
    catalog: &Catalog,
    done: &dyn Fn(usize, usize),
) -> Result<Counts, ConvertError> {
    let dataset = Dataset::open(dataset)?;
    if dataset.recipe.world != catalog.packs() {
        let reason = format!(
            "it was made with {}, and `--world` gives {}: give the same packs in the same order",
            named(&dataset.recipe.world),
            named(catalog.packs())
        );
        return Err(ConvertError::Unfit { path: dataset.folder, reason });
    }
    if dataset.episodes.is_empty() {
        let reason = "it has no episodes: all missions were left out; its manifest.json says why".to_owned();
        return Err(ConvertError::Unfit { path: dataset.folder, reason });
    }
    let output = Output::begin(out)?;
    let written = match format {
        Format::LeRobot => lerobot::write(&dataset, &output, limit_bytes, catalog, done),
        Format::Shards => shards::write(&dataset, &output, limit_bytes, done),
        Format::Arena => arena::write(&dataset, &output, done),
    };
    match written {
        Ok(counts) => output.finish().map(|()| counts),
        Err(error) => {
            output.discard();
            Err(error)
        }
    }
}

/// World packs in a message.
fn named(packs: &[PackId]) -> String {
    let names: Vec<String> = packs.iter().map(|pack| format!("the world pack {pack}")).collect();
    if names.is_empty() { "no world packs".to_owned() } else { names.join(" and ") }
}
