//! `cohabit check`: what is wrong in mission files.

use cohabit_cdf::{Catalog, mission};

use crate::{failure::bad_input, mission_file::MissionFile};

/// Prints every problem with its file, its place and what would be right.
#[derive(clap::Args)]
pub struct Check {
    /// Mission files (CDF), or names of built-in missions
    #[arg(required = true)]
    files: Vec<String>,
}

impl Check {
    /// Checks all files; fails if any has an error.
    pub fn run(&self) -> anyhow::Result<()> {
        let catalog = Catalog::builtin();
        let mut bad = 0;
        for name in &self.files {
            let file = MissionFile::find(Some(name))?;
            match mission::read_mission(&file.name, &file.text, &catalog) {
                Ok(checked) => {
                    for warning in &checked.warnings {
                        println!("{warning}");
                    }
                    println!("{name}: good ({} warnings)", checked.warnings.len());
                }
                Err(problems) => {
                    println!("{problems}");
                    println!("{name}: not playable");
                    bad += 1;
                }
            }
        }
        if bad > 0 { Err(bad_input(format!("{bad} of {} files are not playable", self.files.len()))) } else { Ok(()) }
    }
}
