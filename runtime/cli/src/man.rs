//! `cohabit man`: a manual page of each command.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use anyhow::Context as _;
use clap::CommandFactory as _;

use crate::{Cohabit, failure::environment, terminal::shown};

/// Writes a manual page of this program and of each of its commands into a folder
#[derive(clap::Args)]
pub struct Man {
    /// The folder, such as `~/.local/share/man/man1`; made if it is not there
    folder: PathBuf,
}

/// The name of a manual page's file, and what is in it (roff).
type Page = (String, Vec<u8>);

impl Man {
    /// Writes the pages.
    pub fn run(&self) -> anyhow::Result<()> {
        let pages = pages().context("write a manual page")?;
        let failed = |path: &Path, error: io::Error| environment(format!("{}: {error}", path.display()));
        fs::create_dir_all(&self.folder).map_err(|error| failed(&self.folder, error))?;
        for (name, text) in &pages {
            let path = self.folder.join(name);
            fs::write(&path, text).map_err(|error| failed(&path, error))?;
        }
        println!("{} manual pages in {}", pages.len(), shown(self.folder.display()));
        Ok(())
    }
}

/// A page of the program, and one of each command at any depth.
fn pages() -> io::Result<Vec<Page>> {
    // `help` has no options of its own, and no page.
    let mut program = Cohabit::command().disable_help_subcommand(true);
    program.build();
    let mut pages = Vec::new();
    add(&program, &mut pages)?;
    Ok(pages)
}

fn add(command: &clap::Command, pages: &mut Vec<Page>) -> io::Result<()> {
    let name = command.get_display_name().unwrap_or_else(|| command.get_name());
    let mut text = Vec::new();
    clap_mangen::Man::new(command.clone()).title(name).render(&mut text)?;
    pages.push((format!("{name}.1"), text));
    command.get_subcommands().try_for_each(|own| add(own, pages))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// The files of the pages of a command and of those below it.
    fn files(command: &clap::Command, name: &str) -> Vec<String> {
        let own = command.get_subcommands();
        let below = own.flat_map(|one| files(one, &format!("{name}-{}", one.get_name())));
        std::iter::once(format!("{name}.1")).chain(below).collect()
    }

    #[test]
    fn every_command_has_a_page() {
        let pages = pages().unwrap();
        let names: Vec<&String> = pages.iter().map(|(name, _)| name).collect();
        let expected = files(&Cohabit::command(), "cohabit");
        assert_eq!(names, expected.iter().collect::<Vec<_>>());
        assert!(expected.contains(&"cohabit-study-run.1".to_owned()), "{expected:?}");
        for (name, text) in &pages {
            let text = String::from_utf8_lossy(text);
            assert!(text.contains(".TH ") && text.contains(".SH NAME"), "{name}: {text}");
        }
    }
}
