//! `cohabit generate`: missions by the thousand, each solved before it is written.

use std::{
    fs,
    io::{self, Write as _},
    path::PathBuf,
    sync::Arc,
    time::Instant,
};

use cohabit_cdf::Catalog;
use cohabit_generate::{Order, Spec};
use indicatif::{ProgressBar, ProgressStyle};

use crate::{
    failure::{bad_input, check_folder_of, environment},
    splits::{self, Asked},
    terminal::{shown, shown_lines},
    world::WorldPacks,
};

/// Makes missions from a specification. Each is checked, solved by the planner and played once; a line has the mission, its plan,
/// how difficult it is, and a certificate: the digest of the world in which the plan met all goals.
#[derive(clap::Args)]
pub struct Generate {
    /// A specification (TOML), or `builtin`: the twelve types of Alexa Arena's data set, and twelve more
    #[arg(default_value = "builtin")]
    spec: String,
    /// How many missions to make
    #[arg(long, value_name = "N", default_value_t = 240)]
    count: usize,
    /// The seed: the same one makes the same missions
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Write the missions to this file, a line each
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// The share of missions in which something stands in the way: a thing is behind a door that is shut, what would be used is
    /// locked, or a machine has no power; that of the specification, if not given
    #[arg(long, value_name = "SHARE", value_parser = share)]
    blockers: Option<f64>,
    /// Write the missions parted into this folder, too: for training, and for tests of what training does not have, by object,
    /// room, floor plan and composition, with a manifest
    #[arg(long, value_name = "DIR")]
    splits: Option<PathBuf>,
    /// The share of missions that each part gets but that for training, from 0.01 to 0.2
    #[arg(long, value_name = "SHARE", default_value_t = 0.1, value_parser = split_share, requires = "splits")]
    split_share: f64,
    /// Threads; one for each core if not given. They do not change what is made
    #[arg(long, value_name = "N")]
    workers: Option<usize>,
    #[command(flatten)]
    packs: WorldPacks,
}

fn share(text: &str) -> Result<f64, String> {
    let share = text.parse().ok().filter(|share| (0.0..=1.0).contains(share));
    share.ok_or_else(|| "a number from 0 to 1".to_owned())
}

fn split_share(text: &str) -> Result<f64, String> {
    let share = text.parse().ok().filter(|share| (0.01..=0.2).contains(share));
    share.ok_or_else(|| "a number from 0.01 to 0.2".to_owned())
}

impl Generate {
    /// Makes them all. The file appears once it is whole.
    pub fn run(&self) -> anyhow::Result<()> {
        self.check()?;
        let catalog = Arc::clone(self.packs.read()?.catalog());
        let spec = self.spec(&catalog)?;
        let workers = self.workers.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from));
        let order = Order { count: self.count, seed: self.seed, workers: workers.max(1) };
        let part = self.out.with_extension("part");
        let failed = |error: io::Error| environment(format!("{}: {error}", part.display()));
        let mut out = io::BufWriter::new(fs::File::create(&part).map_err(failed)?);
        let bar = ProgressBar::new(self.count as u64).with_style(
            ProgressStyle::with_template("{bar:30} {pos}/{len} made, {elapsed} ({eta} left)")
                .unwrap_or_else(|_| ProgressStyle::default_bar()),
        );
        let (began, mut written, mut facets) = (Instant::now(), Ok(()), Vec::new());
        let made = cohabit_generate::generate(&spec, &catalog, order, &mut |mission| {
            if written.is_ok() {
                written = writeln!(out, "{}", mission.as_line());
            }
            facets.push(mission.facets());
            bar.inc(1);
        });
        bar.finish_and_clear();
        let whole = made.map_err(bad_input).and_then(|given_up| {
            written.and_then(|()| out.flush()).map_err(failed)?;
            Ok(given_up)
        });
        let given_up = match whole {
            Ok(given_up) => given_up,
            Err(error) => {
                // Nobody takes a part for the whole.
                let _ = fs::remove_file(&part);
                return Err(error);
            }
        };
        fs::rename(&part, &self.out).map_err(failed)?;
        for (kind, missed) in given_up {
            println!("{}: {} given up, the last because {}", shown(kind), missed.count, shown_lines(missed.reason));
        }
        let seconds = began.elapsed().as_secs_f64();
        println!("{} missions in {seconds:.1} s: {}", self.count, self.out.display());
        match &self.splits {
            Some(folder) => {
                let asked = Asked { spec: &self.spec, seed: self.seed, share: self.split_share };
                splits::write(&self.out, &facets, folder, asked)
            }
            None => Ok(()),
        }
    }

    /// What is wrong with what was asked for is said before missions are made.
    fn check(&self) -> anyhow::Result<()> {
        if self.count == 0 {
            return Err(bad_input("--count 0: at least one"));
        }
        check_folder_of(&self.out)
    }

    fn spec(&self, catalog: &Catalog) -> anyhow::Result<Spec> {
        let spec = if self.spec == "builtin" {
            Spec::builtin(catalog)
        } else {
            let unread = |error| bad_input(format!("{}: {error}; name a file (TOML), or `builtin`", self.spec));
            let text = fs::read_to_string(&self.spec).map_err(unread)?;
            Spec::parse(&self.spec, &text, catalog).map_err(bad_input)?
        };
        Ok(match self.blockers {
            Some(share) => spec.with_blockers(share),
            None => spec,
        })
    }
}
