//! The process of the dialog service.

use std::{net::SocketAddr, path::PathBuf, sync::Arc};

use anyhow::Context as _;
use cohabit_bus::{Session, message::CameraRecord};
use cohabit_dialog::{Addresses, DialogConfig, DialogError, Endpoint};
use cohabit_engine::SessionPlan;

use super::{Joining, Listening, tell_supervisor};
use crate::{
    failure::{bad_input, environment},
    mission_file::MissionFile,
    world::WorldPacks,
};

/// Serves the page, and turns what people say into plans.
#[derive(clap::Args)]
pub struct Dialog {
    #[command(flatten)]
    joining: Joining,
    #[command(flatten)]
    listening: Listening,
    #[command(flatten)]
    packs: WorldPacks,
    /// A body whose robot people speak to; as often as there are
    #[arg(long = "robot", value_name = "BODY", default_value = "0")]
    robots: Vec<u32>,
    /// A body whose robot acts on its own, whatever people tell it, and says so; as often as there are
    #[arg(long = "on-its-own", value_name = "BODY")]
    on_their_own: Vec<u32>,
}

impl Dialog {
    /// Runs the dialog service. Prints its address, and later the time of the first frame shown, for its supervisor.
    pub fn run(&self) -> anyhow::Result<()> {
        let world = self.packs.read()?;
        let (bus, stop) = self.joining.join()?;
        let Some(message) = cohabit_agent::wait_for_mission(&bus, &stop)? else { return Ok(()) };
        let file = MissionFile { name: message.header.file.as_str().to_owned(), text: message.text };
        let plan = file.plan(world.catalog(), message.header.seed, &message.bodies);
        let SessionPlan { catalog, layout, mission, .. } = plan.context("the mission that the simulator published")?;
        let config = self.config(message.header.seed, message.cameras)?;
        let served = cohabit_dialog::serve(Arc::new(bus), mission, layout, catalog, config, &stop, tell_addresses);
        served.map_err(|error| match error {
            DialogError::Listen { .. } => environment(error),
            other => other.into(),
        })
    }

    /// How the service is set up for a session with this seed and these cameras.
    fn config(&self, seed: u64, cameras: Vec<CameraRecord>) -> anyhow::Result<DialogConfig> {
        let Self { joining, listening, robots, on_their_own, .. } = self;
        Ok(DialogConfig {
            session: joining.session.clone(),
            journal: Some(journal(&Session::new(&joining.session).map_err(bad_input)?)),
            cameras,
            identity: listening.tls.identity(listening.listen)?,
            framed_by: listening.framed_by,
            listen: SocketAddr::new(listening.listen, listening.port),
            hosts: listening.hosts.clone(),
            knows: listening.knows,
            asking: listening.ask,
            manner: listening.manner(),
            effort: listening.understanding,
            consulting: listening.model,
            interpreter: Endpoint::from_environment().map_err(bad_input)?.map(|model| Box::new(model) as _),
            robots: robots.clone(),
            on_their_own: on_their_own.clone(),
            names: listening.names.iter().map(|one| (one.body, one.name.clone())).collect(),
            drivable: listening.drive,
            seats: usize::from(listening.seats),
            questionnaires: listening.questionnaires()?,
            voice: listening.voice.config(seed),
            hidden: listening.hide.clone(),
            texts: listening.language.texts()?,
            holding: listening.wizard.holding(),
            on_first_frame: Box::new(|| tell_supervisor("shown")),
        })
    }
}

fn tell_addresses(addresses: &Addresses) {
    // Whoever reads what the supervisor says knows all seats when they know the page.
    if let Some(address) = &addresses.wizard {
        tell_supervisor(&format!("wizard {address}"));
    }
    for (number, seat) in (1..).zip(&addresses.seats) {
        let avatar = seat.body.map(|body| format!(" (body {body})")).unwrap_or_default();
        tell_supervisor(&format!("seat {number}{avatar}: {}", seat.page));
    }
    tell_supervisor(&format!("page {}", addresses.page));
}

/// Where the dialog service of a session writes down what was said.
pub fn journal(session: &Session) -> PathBuf {
    session.folder().join("dialog.journal")
}
