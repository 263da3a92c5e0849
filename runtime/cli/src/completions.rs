//! `cohabit completions`: a script by which a shell completes commands and options.

use anyhow::Context as _;
use clap::{CommandFactory as _, ValueEnum};

use crate::{Cohabit, terminal::print};

/// Prints a script by which a shell completes the commands and options of this program
#[derive(clap::Args)]
pub struct Completions {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

/// Shells that there is a script for.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Shell {
    /// `bash`.
    Bash,
    /// `zsh`.
    Zsh,
    /// `fish`.
    Fish,
}

impl Completions {
    /// Prints the script.
    pub fn run(&self) -> anyhow::Result<()> {
        let script = String::from_utf8(self.shell.script()).context("a script that is no text")?;
        print(&script)
    }
}

impl Shell {
    fn script(self) -> Vec<u8> {
        let shell = match self {
            Self::Bash => clap_complete::Shell::Bash,
            Self::Zsh => clap_complete::Shell::Zsh,
            Self::Fish => clap_complete::Shell::Fish,
        };
        let mut script = Vec::new();
        clap_complete::generate(shell, &mut Cohabit::command(), "cohabit", &mut script);
        script
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// The names of the subcommands of a command, at any depth.
    fn names(command: &clap::Command) -> Vec<String> {
        let own = command.get_subcommands();
        own.flat_map(|one| std::iter::once(one.get_name().to_owned()).chain(names(one))).collect()
    }

    #[test]
    fn the_script_of_each_shell_names_every_subcommand() {
        let names = names(&Cohabit::command());
        assert!(["play", "study", "withdraw"].iter().all(|name| names.contains(&(*name).to_owned())), "{names:?}");
        for shell in Shell::value_variants() {
            let script = String::from_utf8(shell.script()).unwrap();
            let missing: Vec<_> = names.iter().filter(|name| !script.contains(name.as_str())).collect();
            assert!(missing.is_empty(), "{shell:?}: {missing:?}");
        }
    }
}
