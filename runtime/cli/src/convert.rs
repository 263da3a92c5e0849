//! `cohabit convert`: data sets of demonstrations in the formats that others read.

use std::{path::PathBuf, str::FromStr};

use cohabit_convert::{Format, convert};
use indicatif::{ProgressBar, ProgressStyle};

use crate::{
    failure::{bad_input, environment},
    terminal::shown,
    world::WorldPacks,
};

/// Writes a data set of `demonstrate` in another format, without simulating again. The folder is there once it is whole; a call that was
/// interrupted is made again.
#[derive(clap::Args)]
pub struct Convert {
    /// The folder of a finished data set
    dataset: PathBuf,
    /// lerobot (Parquet), shards (tar, for WebDataset) or arena (the trajectory files of Alexa Arena)
    #[arg(long, value_name = "FORMAT")]
    to: Wanted,
    /// A folder that is not there yet
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// How large a file gets at most, in MiB
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..=65536))]
    file_size: u32,
    #[command(flatten)]
    packs: WorldPacks,
}

/// `lerobot`.
#[derive(Clone, Copy)]
struct Wanted(Format);

impl FromStr for Wanted {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let known = || Format::ALL.map(Format::name).join(", ");
        let named = Format::ALL.into_iter().find(|format| format.name() == text);
        named.map(Self).ok_or_else(|| format!("there is no such format: {}", known()))
    }
}

impl Convert {
    /// Converts it.
    pub fn run(&self) -> anyhow::Result<()> {
        let bar = ProgressBar::no_length().with_style(
            ProgressStyle::with_template("{bar:30} {pos}/{len} episodes, {elapsed} ({eta} left)")
                .unwrap_or_else(|_| ProgressStyle::default_bar()),
        );
        let limit = (self.file_size as usize) << 20;
        let world = self.packs.read()?;
        let converted = convert(&self.dataset, &self.out, self.to.0, limit, world.catalog(), &|done, all| {
            bar.set_length(all as u64);
            bar.set_position(done as u64);
        });
        bar.finish_and_clear();
        let counts =
            converted.map_err(|error| if error.is_bad_input() { bad_input(error) } else { environment(error) })?;
        println!(
            "{} episodes with {} samples in {} files: {}",
            counts.episodes,
            counts.samples,
            counts.files,
            shown(self.out.display())
        );
        Ok(())
    }
}
