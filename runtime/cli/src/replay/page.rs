//! A recorded session on the page, as it was played.

use std::{
    collections::BTreeMap,
    net::{IpAddr, SocketAddr},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
};

use anyhow::Context as _;
use cohabit_bus::Local;
use cohabit_dialog::{HostName, ScreeningConfig, screen};
use cohabit_engine::{CameraPlan, Projector, Replayer, replay::TICK_S};
use cohabit_record::SessionEntry;
use cohabit_render::MeshLibrary;

use crate::{failure::bad_input, peers::NAME_OF, rendering::Rendering, stop};

/// Whether, and where, a session is played on the page.
#[derive(clap::Args)]
pub struct PageOptions {
    /// Play it on the page, with a time bar, until Ctrl-C
    #[arg(long, conflicts_with_all = ["frames", "video", "until"])]
    pub page: bool,
    /// The port of the page; 0 takes any that is free
    #[arg(long, default_value_t = 8765, requires = "page")]
    port: u16,
    /// The address the page listens on, such as 0.0.0.0 for other machines
    #[arg(long, default_value = "127.0.0.1", requires = "page")]
    listen: IpAddr,
    /// A name by which browsers may ask for the page besides those of this machine, such as that of a proxy, with its port
    /// if it is another one; as often as needed
    #[arg(long = "host", value_name = "NAME[:PORT]", requires = "page")]
    hosts: Vec<HostName>,
}

impl PageOptions {
    /// Shows what `replayer` goes through, from where it is, until the user ends it.
    pub fn show(&self, replayer: Replayer<'_>, rendering: Rendering) -> anyhow::Result<()> {
        let stop = stop::on_request()?;
        let plan = replayer.plan().clone();
        let meshes = Arc::new(MeshLibrary::build(&plan.catalog).context("build the models")?);
        let cameras = plan.all_cameras(replayer.world().bodies().len());
        let session = &replayer.log().session;
        let config = ScreeningConfig {
            log: replayer.log(),
            mission: &plan.mission,
            layout: &plan.layout,
            catalog: Arc::clone(&plan.catalog),
            listen: SocketAddr::new(self.listen, self.port),
            hosts: self.hosts.clone(),
            robots: robots(session),
            names: names(session),
            cameras: cameras.iter().map(CameraPlan::record).collect(),
            span: replayer.span(),
            tick_s: TICK_S,
        };
        let bus = Local::new(1);
        let projector = Projector::new(replayer, meshes, rendering.start()?, &bus)?;
        let over = AtomicBool::new(false);
        thread::scope(|scope| {
            let projected = scope.spawn(|| {
                let projected = projector.run(&over);
                // Without it there is nothing to serve.
                stop.store(true, Ordering::Relaxed);
                projected
            });
            let served = screen(&bus, &config, &stop, |address| println!("Open {address}  (Ctrl-C ends it)"));
            over.store(true, Ordering::Relaxed);
            let projected = projected.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            served.map_err(bad_input)?;
            Ok(projected?)
        })
    }
}

/// The bodies that people spoke to; the first, where that was not noted.
fn robots(session: &SessionEntry) -> Vec<u32> {
    let noted = session.settings.get("robots").map_or("0", String::as_str);
    noted.split(',').filter_map(|body| body.parse().ok()).collect()
}

/// What bodies were called.
fn names(session: &SessionEntry) -> BTreeMap<u32, String> {
    let named = session.settings.iter().filter_map(|(setting, name)| Some((setting.strip_prefix(NAME_OF)?, name)));
    named.filter_map(|(body, name)| Some((body.parse().ok()?, name.clone()))).collect()
}
