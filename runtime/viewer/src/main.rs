//! `cohabit-rerun`: sessions as rerun recordings, live or from their logs, and tables as Parquet files.
//!
//! `cohabit` starts this program when it is asked for what needs rerun; it is a program of its own because building it
//! takes longer than all else together. Whatever a session comes from, its log or its bus, it goes through
//! [`showing::Showing`], which never knows which.

mod blueprint;
mod deeds;
mod live;
mod looks;
mod office;
mod panes;
mod parquet;
mod pictures;
mod recording;
mod replay;
mod showing;
mod sink;
mod talk;

use std::{
    net::{IpAddr, Ipv4Addr, SocketAddr},
    path::PathBuf,
    process::ExitCode,
    sync::{Arc, atomic::AtomicBool},
};

use anyhow::Context as _;
use clap::{Parser, Subcommand};
use cohabit_bus::{Session, Shm};
use cohabit_cdf::Catalog;
use cohabit_engine::replay::movement;
use cohabit_record::Log;
use cohabit_render::MeshLibrary;
use cohabit_tables::Played;
use panes::Contents;
use recording::Side;
use replay::{CAMERA, Seen};
use sink::Sink;
use tracing_subscriber::EnvFilter;

/// Sessions in rerun: from logs, live, and two beside each other. `cohabit` starts this when it is needed.
#[derive(Parser)]
#[command(version, arg_required_else_help = true)]
struct CohabitRerun {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Make a recording of a session's log, or show it in a viewer
    Replay(Replay),
    /// Make a recording of two sessions beside each other
    Compare(Compare),
    /// Show a running session in a viewer, or record it as it is seen
    Live(Live),
    /// Write logs as Parquet tables
    Tables(Tables),
}

#[derive(clap::Args)]
struct Replay {
    /// The session log
    log: PathBuf,
    #[command(flatten)]
    target: Target,
    #[command(flatten)]
    seen: Seen,
}

#[derive(clap::Args)]
struct Compare {
    /// The one session's log
    left: PathBuf,
    /// The other's
    right: PathBuf,
    #[command(flatten)]
    target: Target,
    #[command(flatten)]
    seen: Seen,
}

/// Where viewers listen, if nothing else is said.
const VIEWER: SocketAddr = SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), 9876);

/// Where a recording goes.
#[derive(clap::Args)]
#[group(required = true, multiple = false)]
struct Target {
    /// The recording to write
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// The address of a viewer; where none listens, one is started
    #[arg(long, value_name = "ADDRESS")]
    viewer: Option<SocketAddr>,
}

#[derive(clap::Args)]
struct Live {
    /// The session's name
    #[arg(long)]
    session: String,
    /// The process that supervises this one
    #[arg(long, hide = true)]
    supervisor: Option<i32>,
    #[command(flatten)]
    target: Target,
}

#[derive(clap::Args)]
struct Tables {
    /// The session logs
    #[arg(required = true)]
    logs: Vec<PathBuf>,
    /// The folder to write into
    #[arg(long)]
    out: PathBuf,
}

impl Target {
    fn sink(&self) -> Sink {
        match (&self.out, self.viewer) {
            (Some(path), _) => Sink::File(path.clone()),
            (None, viewer) => Sink::Viewer(viewer.unwrap_or(VIEWER)),
        }
    }

    /// Says where it is.
    fn tell(&self, ticks: u64) {
        if let Some(path) = &self.out {
            let megabytes = path.metadata().map_or(0.0, |data| data.len() as f64 / 1e6);
            println!("{ticks} ticks written to {} ({megabytes:.1} MB)", path.display());
        }
    }
}

/// The built-in catalogue and its meshes.
fn models() -> anyhow::Result<(Arc<Catalog>, Arc<MeshLibrary>)> {
    let catalog = Arc::new(Catalog::builtin());
    let meshes = Arc::new(MeshLibrary::build(&catalog).context("build the models")?);
    Ok((catalog, meshes))
}

impl Replay {
    fn run(&self) -> anyhow::Result<()> {
        let (catalog, meshes) = models()?;
        let session = replay::Session::open(&self.log, &catalog, &meshes)?;
        let stream = self.target.sink().open(&session.name())?;
        blueprint::send(&stream, &session.contents(Side::Only, &self.seen)?.pane())?;
        let ticks = session.show(&stream, Side::Only, &self.seen)?;
        sink::finish(stream)?;
        self.target.tell(ticks);
        Ok(())
    }
}

impl Compare {
    fn run(&self) -> anyhow::Result<()> {
        let (catalog, meshes) = models()?;
        let [left, right] = [&self.left, &self.right].map(|log| replay::Session::open(log, &catalog, &meshes));
        let (left, right) = (left?, right?);
        let stream = self.target.sink().open(&format!("{} beside {}", left.name(), right.name()))?;
        let (one, other) = (left.contents(Side::A, &self.seen)?, right.contents(Side::B, &self.seen)?);
        blueprint::send(&stream, &one.beside(&other))?;
        let ticks = left.show(&stream, Side::A, &self.seen)?.max(right.show(&stream, Side::B, &self.seen)?);
        sink::finish(stream)?;
        self.target.tell(ticks);
        Ok(())
    }
}

impl Live {
    fn run(&self) -> anyhow::Result<()> {
        let stop = stop_on_request(self.supervisor)?;
        let bus = Shm::join(&Session::new(&self.session)?)?;
        let mut watch = live::Watch::new(&bus)?;
        let (catalog, meshes) = models()?;
        let Some(plan) = watch.plan(&catalog, &stop)? else { return Ok(()) };
        let stream = self.target.sink().open(&format!("{} ({})", self.session, plan.file))?;
        let planes = cohabit_bus::message::Plane::ALL;
        let contents = Contents { side: Side::Only, bounds_m: plan.layout.bounds_m(), camera: CAMERA, planes: &planes };
        blueprint::send(&stream, &contents.pane())?;
        let about = [("session".to_owned(), self.session.clone())];
        watch.show(&stream, plan, meshes, &about, &stop)?;
        sink::finish(stream)
    }
}

impl Tables {
    fn run(&self) -> anyhow::Result<()> {
        let catalog = Arc::new(Catalog::builtin());
        let (played, unread) = Played::open_readable(&self.logs, &catalog);
        let moved = |log: &Log| movement(log, Arc::clone(&catalog));
        let played: Vec<Played> = played.into_iter().map(|one| one.with_movement(moved)).collect();
        let reasons: Vec<String> = unread.iter().map(|(_, error)| error.to_string()).collect();
        let reasons = reasons.join("\n  ");
        anyhow::ensure!(!played.is_empty() || unread.is_empty(), "{reasons}");
        std::fs::create_dir_all(&self.out).with_context(|| self.out.display().to_string())?;
        let tables = cohabit_tables::tables(&played);
        for table in tables.iter().chain([&cohabit_tables::codebook(&tables)]) {
            let path = parquet::write(table, &self.out)?;
            println!("{} rows written to {}", table.rows.len(), path.display());
        }
        let (left_out, all) = (unread.len(), self.logs.len());
        anyhow::ensure!(unread.is_empty(), "{left_out} of {all} logs cannot be read, and are left out:\n  {reasons}");
        Ok(())
    }
}

/// Becomes true when this process is asked to end; it ends with its supervisor, however that one ends.
fn stop_on_request(supervisor: Option<i32>) -> anyhow::Result<Arc<AtomicBool>> {
    use rustix::process::{Pid, Signal, getppid, set_parent_process_death_signal};
    let stop = Arc::new(AtomicBool::new(false));
    for signal in [signal_hook::consts::SIGINT, signal_hook::consts::SIGTERM] {
        signal_hook::flag::register(signal, Arc::clone(&stop)).context("signals")?;
    }
    if let Some(supervisor) = supervisor.and_then(Pid::from_raw) {
        set_parent_process_death_signal(Some(Signal::TERM)).context("ask to end with the supervisor")?;
        // It may have ended before that was asked.
        anyhow::ensure!(getppid() == Some(supervisor), "the supervisor is gone already");
    }
    Ok(stop)
}

fn main() -> ExitCode {
    tracing_subscriber::fmt()
        .with_env_filter(EnvFilter::try_from_env("COHABIT_LOG").unwrap_or_else(|_| EnvFilter::new("warn")))
        .with_writer(std::io::stderr)
        .with_target(false)
        .compact()
        .init();
    let done = match CohabitRerun::parse().command {
        Command::Replay(replay) => replay.run(),
        Command::Compare(compare) => compare.run(),
        Command::Live(live) => live.run(),
        Command::Tables(tables) => tables.run(),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("cohabit-rerun: {error:#}");
            ExitCode::FAILURE
        }
    }
}
