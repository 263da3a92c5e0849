//! `cohabit new`: files to begin with.

use std::{
    fs,
    io::ErrorKind,
    path::{Path, PathBuf},
};

use clap::Subcommand;
use cohabit_cdf::world_pack::{self, NAME_RULE, builtin_names, is_name};

use crate::{
    failure::{bad_input, environment},
    terminal::shown,
};

/// Writes files to begin with.
#[derive(clap::Args)]
pub struct New {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand)]
enum What {
    /// A world pack: a floor plan with a room of its own, a wrench, a degreaser, and a mission that needs all of them
    World(NewWorld),
}

/// A new world pack.
#[derive(clap::Args)]
struct NewWorld {
    /// Its name, which is also that of its folder
    name: String,
    /// The folder that its folder is written into
    #[arg(long, value_name = "DIR", default_value = ".")]
    into: PathBuf,
}

impl New {
    /// Writes them.
    pub fn run(&self) -> anyhow::Result<()> {
        match &self.what {
            What::World(world) => world.run(),
        }
    }
}

impl NewWorld {
    fn run(&self) -> anyhow::Result<()> {
        if !is_name(&self.name) {
            return Err(bad_input(format!("`{}` is no name of a world pack: {NAME_RULE}", self.name)));
        }
        // A folder of that name would be taken for the pack wherever `--world` names that.
        if builtin_names().any(|other| other == self.name) {
            let reason = "is the name of a world pack that comes with the program: take another name";
            return Err(bad_input(format!("`{}` {reason}", self.name)));
        }
        let folder = self.into.join(&self.name);
        fs::create_dir(&folder).map_err(|error| match error.kind() {
            ErrorKind::AlreadyExists => bad_input(format!("{}: exists already: take another name", folder.display())),
            ErrorKind::NotFound => bad_input(format!("{}: there is no such folder", self.into.display())),
            _ => failed(&folder, &error),
        })?;
        for (path, text) in world_pack::template(&self.name) {
            let path = folder.join(path);
            let parent = path.parent().unwrap_or(&folder);
            fs::create_dir_all(parent).map_err(|error| failed(parent, &error))?;
            fs::write(&path, text).map_err(|error| failed(&path, &error))?;
        }
        let name = shown(folder.display());
        println!("A world pack is in {name}\nCheck it with: cohabit check --world {name}");
        println!("Play it with: cohabit play clean_wrench --world {name}");
        Ok(())
    }
}

fn failed(path: &Path, error: &std::io::Error) -> anyhow::Error {
    environment(format!("{}: {error}", path.display()))
}
