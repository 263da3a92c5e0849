//! The process of a mind.

use std::path::PathBuf;

use cohabit_agent::PeerError;

use super::Joining;
use crate::{
    failure::bad_input,
    minds::{MindKind, expert},
    pedestrians::crowd,
    world::WorldPacks,
};

/// Runs a mind for one body.
#[derive(clap::Args)]
pub struct Agent {
    /// What kind of mind
    #[arg(value_enum, default_value = "dialog")]
    kind: MindKind,
    #[command(flatten)]
    joining: Joining,
    /// The body it commands
    #[arg(long, default_value_t = 0)]
    body: u32,
    /// The seed of all that is random in it
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// What a scripted one does: a file with an action a line; or what pedestrians do: a schedule (TOML), which names their bodies
    #[arg(long, value_name = "FILE", required_if_eq_any([("kind", "scripted"), ("kind", "pedestrian")]))]
    script: Option<PathBuf>,
    #[command(flatten)]
    packs: WorldPacks,
}

impl Agent {
    /// Runs the agent.
    pub fn run(&self) -> anyhow::Result<()> {
        let world = self.packs.read()?;
        let catalog = world.catalog();
        let mind = self.kind.mind(catalog, self.body, self.seed, self.script.as_deref())?;
        let (bus, stop) = self.joining.join()?;
        if self.kind == MindKind::Pedestrian {
            if let Some(mut crowd) = crowd(catalog, self.script.as_deref(), self.seed, &bus, &stop)? {
                crowd.run(&bus, &stop)?;
            }
            return Ok(());
        }
        let mind = mind.map_or_else(|| expert(catalog, self.body, &bus, &stop), |mind| Ok(Some(mind)))?;
        if let Some(mut mind) = mind {
            cohabit_agent::run_in(catalog, &mut *mind, self.body, &bus, &stop).map_err(classified)?;
        }
        Ok(())
    }
}

/// What an error is to whoever started the agent.
fn classified(error: PeerError) -> anyhow::Error {
    match error {
        PeerError::NoBody { .. } => bad_input(error),
        other => other.into(),
    }
}
