//! Where a recording goes: into a file, or to a viewer.

use std::{
    net::{SocketAddr, TcpStream},
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use anyhow::{Context as _, bail};
use re_sdk::{RecordingStream, RecordingStreamBuilder, SpawnOptions, log::ChunkBatcherConfig};

/// What viewers call the program that recordings are of.
const APPLICATION: &str = "cohabit";
/// The version of rerun that recordings are made for.
const VERSION: &str = "0.36.3";
/// A viewer that is started answers within this time.
const STARTED_WITHIN: Duration = Duration::from_secs(20);

/// Where a recording goes.
#[derive(Clone, Debug)]
pub enum Sink {
    /// A file, which is written anew.
    File(PathBuf),
    /// The viewer that listens at this address; where none does, one is started, if there is one on this machine.
    Viewer(SocketAddr),
}

impl Sink {
    /// Opens it for a recording of that name.
    pub fn open(&self, name: &str) -> anyhow::Result<RecordingStream> {
        let builder = RecordingStreamBuilder::new(APPLICATION).recording_name(name);
        match self {
            Self::File(path) => save(builder, path),
            Self::Viewer(address) => connect(builder, *address),
        }
    }
}

/// Rows wait for others of their kind for so long, or until they are so large: each chunk of them costs a kilobyte.
const CHUNKS_EVERY: Duration = Duration::from_secs(10);
const CHUNK_BYTES: u64 = 4 << 20;

fn save(builder: RecordingStreamBuilder, path: &Path) -> anyhow::Result<RecordingStream> {
    let chunks =
        ChunkBatcherConfig { flush_tick: CHUNKS_EVERY, flush_num_bytes: CHUNK_BYTES, ..ChunkBatcherConfig::DEFAULT };
    builder.batcher_config(chunks).save(path).with_context(|| format!("write {}", path.display()))
}

fn connect(builder: RecordingStreamBuilder, address: SocketAddr) -> anyhow::Result<RecordingStream> {
    if !listens(address) {
        start_viewer(address)?;
    }
    let url = format!("rerun+http://{address}/proxy");
    builder.connect_grpc_opts(url.as_str()).with_context(|| format!("connect to a viewer at {url}"))
}

fn listens(address: SocketAddr) -> bool {
    TcpStream::connect_timeout(&address, Duration::from_millis(500)).is_ok()
}

/// Starts the viewer that is on this machine.
fn start_viewer(address: SocketAddr) -> anyhow::Result<()> {
    if !address.ip().is_loopback() {
        bail!("no viewer listens at {address}");
    }
    let options = SpawnOptions {
        port: address.port(),
        // It would listen to all machines otherwise.
        extra_args: vec!["--bind".to_owned(), address.ip().to_string()],
        hide_welcome_screen: true,
        ..SpawnOptions::default()
    };
    re_sdk::spawn(&options).map_err(|error| {
        let hint = format!("install one with `pip install rerun-sdk=={VERSION}`, and start it with `rerun`");
        anyhow::anyhow!("no viewer listens at {address}, and none could be started ({error}): {hint}")
    })?;
    let began = Instant::now();
    while !listens(address) {
        if began.elapsed() > STARTED_WITHIN {
            bail!("the viewer that was started does not listen at {address}");
        }
        std::thread::sleep(Duration::from_millis(100));
    }
    Ok(())
}

/// Waits until all that was logged is where it goes, and ends the recording.
pub fn finish(stream: RecordingStream) -> anyhow::Result<()> {
    stream.flush_blocking().context("write the recording")
}
