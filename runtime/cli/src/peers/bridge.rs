//! The process of a bridge: a peer of a session whose other side speaks another protocol.

use std::io::{self, BufReader};

use clap::Subcommand;
use cohabit_mcp::{BodyChoice, BridgeConfig, BridgeError, serve};

use super::Joining;
use crate::{
    failure::{bad_input, environment},
    world::WorldPacks,
};

/// Gives a body of a running session to a program that speaks another protocol.
#[derive(clap::Args)]
pub struct Bridge {
    #[command(subcommand)]
    protocol: Protocol,
}

#[derive(Subcommand)]
enum Protocol {
    /// Give a body as tools to a client of the Model Context Protocol, which starts this command and speaks with it on its stdin
    /// and stdout
    Mcp(Mcp),
}

/// A body as tools for language models.
#[derive(clap::Args)]
struct Mcp {
    #[command(flatten)]
    joining: Joining,
    /// The body: its number, or `robot` or `person` for the first of these. It is taken over from who commands it by the first
    /// tool that has it do something, and handed back at the end
    #[arg(long, default_value = "0")]
    body: BodyChoice,
    /// Give the client one more tool, `goals`, which tells the goals of the mission and which of them are met. Without it, the client
    /// does not learn the goals
    #[arg(long)]
    goals: bool,
    #[command(flatten)]
    packs: WorldPacks,
}

impl Bridge {
    /// Runs the bridge until its client leaves.
    pub fn run(&self) -> anyhow::Result<()> {
        match &self.protocol {
            Protocol::Mcp(mcp) => mcp.run(),
        }
    }
}

impl Mcp {
    fn run(&self) -> anyhow::Result<()> {
        let world = self.packs.read()?;
        let (bus, stop) = self.joining.join()?;
        let config = BridgeConfig { body: self.body, tells_goals: self.goals };
        let input = BufReader::new(io::stdin());
        serve(&bus, world.catalog(), config, input, io::stdout(), &stop).map_err(classified)
    }
}

/// What an error is to whoever started the bridge.
fn classified(error: BridgeError) -> anyhow::Error {
    match error {
        BridgeError::LockStep | BridgeError::NoBody { .. } | BridgeError::OtherWorld => bad_input(error),
        BridgeError::NoWorld => environment(error),
        other => other.into(),
    }
}
