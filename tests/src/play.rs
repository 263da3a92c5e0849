//! A session, played by the real binary.

use std::{
    fs,
    io::{BufRead as _, BufReader, Read},
    path::{Path, PathBuf},
    process::{Child, Command, ExitStatus, Output, Stdio},
    sync::{
        atomic::{AtomicU32, Ordering},
        mpsc::{self, Receiver, Sender},
    },
    thread,
    time::{Duration, Instant},
};

use anyhow::{Context as _, ensure};
use rustix::process::{Pid, Signal, kill_process};

/// The longest that anything in a session is waited for.
const WATCHDOG: Duration = Duration::from_secs(60);

/// A running `cohabit play`, in a folder of its own. Dropping it kills it.
pub struct Play {
    child: Child,
    lines: Receiver<String>,
    /// The session's name.
    pub session: String,
    /// The page's address.
    pub address: String,
    /// Where the session is recorded.
    pub log: PathBuf,
    /// The session's temporary folder.
    pub folder: PathBuf,
}

impl Play {
    /// Starts `binary play` with these arguments, and waits for its page.
    ///
    /// # Errors
    /// When it ends, or says nothing for too long.
    pub fn start(binary: &str, arguments: &[&str]) -> anyhow::Result<Self> {
        Self::start_in(binary, arguments, &[])
    }

    /// The same, with these variables set. With `XDG_DATA_HOME` among them it is recorded in there, where sessions usually are,
    /// and not in [`Self::log`]. A `--port` among the arguments is the page's.
    ///
    /// # Errors
    /// When it ends, or says nothing for too long.
    pub fn start_in(binary: &str, arguments: &[&str], environment: &[(&str, &str)]) -> anyhow::Result<Self> {
        let mut play = Self::spawn_in(binary, arguments, environment)?;
        play.wait_until_ready()?;
        Ok(play)
    }

    /// Starts `binary play` with these arguments.
    ///
    /// # Errors
    /// When it cannot be started.
    pub fn spawn(binary: &str, arguments: &[&str]) -> anyhow::Result<Self> {
        Self::spawn_in(binary, arguments, &[])
    }

    fn spawn_in(binary: &str, arguments: &[&str], environment: &[(&str, &str)]) -> anyhow::Result<Self> {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let session = format!("t{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
        let folder = std::env::temp_dir().join(format!("cohabit-test-{session}"));
        fs::create_dir_all(&folder)?;
        let log = folder.join("session.mcap");
        let mut command = Command::new(binary);
        command.arg("play").args(arguments).args(["--session", &session]);
        if !arguments.contains(&"--port") {
            command.args(["--port", "0"]);
        }
        if !environment.iter().any(|(name, _)| *name == "XDG_DATA_HOME") {
            command.arg("--log").arg(&log);
        }
        let mut child = command
            .envs(environment.iter().copied())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .stdin(Stdio::null())
            .spawn()
            .context("start cohabit play")?;
        let (sender, lines) = mpsc::channel();
        forward(child.stdout.take().context("its output")?, sender.clone());
        forward(child.stderr.take().context("its errors")?, sender);
        Ok(Self { child, lines, session, address: String::new(), log, folder })
    }

    /// Waits for its page.
    ///
    /// # Errors
    /// When it ends, or says nothing for too long.
    pub fn wait_until_ready(&mut self) -> anyhow::Result<()> {
        let line = self.wait_for_line("Open http")?;
        let start = line.find("http").context("an address")?;
        line[start..].split_whitespace().next().context("an address")?.clone_into(&mut self.address);
        Ok(())
    }

    /// The page's address without its scheme: `host:port/?token=…`.
    #[must_use]
    pub fn authority(&self) -> &str {
        self.address.split_once("://").unwrap_or_default().1
    }

    /// Waits for a line of its output that contains `part`.
    ///
    /// # Errors
    /// When it ends first, or no such line comes.
    pub fn wait_for_line(&mut self, part: &str) -> anyhow::Result<String> {
        let deadline = Instant::now() + WATCHDOG;
        let mut heard = String::new();
        loop {
            let left = deadline.saturating_duration_since(Instant::now());
            let line = self.lines.recv_timeout(left);
            let line = line.with_context(|| format!("no line with `{part}` from {}; but: {heard}", self.session))?;
            if line.contains(part) {
                return Ok(line);
            }
            heard += &line;
            heard.push('\n');
        }
    }

    /// Presses Ctrl-C, and waits for its end; checks that nothing but its folder is left behind, which goes when the
    /// value given back is dropped.
    ///
    /// # Errors
    /// When it does not end well, or leaves a process, shared memory or files.
    pub fn end(mut self) -> anyhow::Result<Self> {
        self.signal_supervisor(Signal::INT)?;
        let status = self.wait_for_end()?;
        ensure!(status.success(), "it ended with {status}");
        let left = self.left_behind();
        ensure!(left.is_empty(), "left behind: {left:?}");
        Ok(self)
    }

    /// Waits for its end.
    ///
    /// # Errors
    /// When it does not come.
    pub fn wait_for_end(&mut self) -> anyhow::Result<ExitStatus> {
        let deadline = Instant::now() + WATCHDOG;
        loop {
            if let Some(status) = self.child.try_wait()? {
                return Ok(status);
            }
            ensure!(Instant::now() < deadline, "{} does not end", self.session);
            thread::park_timeout(Duration::from_millis(5));
        }
    }

    /// Sends a signal to the first process of the session that runs as `role`.
    ///
    /// # Errors
    /// When there is none, or it is gone.
    pub fn send(&self, role: &str, signal: Signal) -> anyhow::Result<()> {
        let pid = self.processes(role).first().copied().and_then(Pid::from_raw).context("no such process")?;
        Ok(kill_process(pid, signal)?)
    }

    /// Sends a signal to the supervisor.
    ///
    /// # Errors
    /// When it is gone.
    pub fn signal_supervisor(&self, signal: Signal) -> anyhow::Result<()> {
        let pid = Pid::from_raw(i32::try_from(self.child.id())?).context("a process id")?;
        Ok(kill_process(pid, signal)?)
    }

    /// Kills the supervisor, and waits until all processes of the session are gone.
    ///
    /// # Errors
    /// When they do not go.
    pub fn kill(&self) -> anyhow::Result<()> {
        self.signal_supervisor(Signal::KILL)?;
        let deadline = Instant::now() + WATCHDOG;
        while !processes_with(&format!("\0--session\0{}\0", self.session)).is_empty() {
            ensure!(Instant::now() < deadline, "processes of {} do not end", self.session);
            thread::park_timeout(Duration::from_millis(5));
        }
        Ok(())
    }

    /// What it has said since it was last waited for a line.
    #[must_use]
    pub fn said(&self) -> String {
        self.lines.try_iter().collect::<Vec<_>>().join("\n")
    }

    /// The supervisor's process id.
    #[must_use]
    pub fn pid(&self) -> u32 {
        self.child.id()
    }

    /// What of the session is on the machine now: processes, shared memory.
    #[must_use]
    pub fn left_behind(&self) -> Vec<String> {
        let memory = fs::read_dir("/dev/shm").into_iter().flatten().flatten();
        let memory = memory
            .map(|entry| entry.file_name().to_string_lossy().into_owned())
            .filter(|name| name.contains(&self.session));
        processes_with(&self.session).into_iter().map(|(_, line)| line).chain(memory).collect()
    }

    /// The process ids of the session's processes that run as `role` (`sim`, `agent`, `dialog`, `record`).
    #[must_use]
    pub fn processes(&self, role: &str) -> Vec<i32> {
        let part = format!("\0{role}\0--session\0{}\0", self.session);
        processes_with(&part).into_iter().map(|(pid, _)| pid).collect()
    }
}

impl Drop for Play {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
        let _ = fs::remove_dir_all(&self.folder);
    }
}

/// Hands on what a process says, and prints it too.
fn forward(out: impl Read + Send + 'static, lines: Sender<String>) {
    thread::spawn(move || {
        for line in BufReader::new(out).lines().map_while(Result::ok) {
            eprintln!("{line}");
            // Nobody listens any more, and the process may still speak.
            let _ = lines.send(line);
        }
    });
}

/// Process ids and command lines (parts separated by zero bytes) that contain `part`; zombies have none.
fn processes_with(part: &str) -> Vec<(i32, String)> {
    let mut found = Vec::new();
    for entry in fs::read_dir("/proc").into_iter().flatten().flatten() {
        let Some(pid) = entry.file_name().to_str().and_then(|name| name.parse().ok()) else { continue };
        let line = fs::read(entry.path().join("cmdline")).unwrap_or_default();
        let line = String::from_utf8_lossy(&line).into_owned();
        if line.contains(part) {
            found.push((pid, line));
        }
    }
    found
}

/// Runs `binary` with these arguments to its end.
///
/// # Errors
/// When it cannot be started.
pub fn run(binary: &str, arguments: &[&str]) -> anyhow::Result<Output> {
    Command::new(binary).args(arguments).stdin(Stdio::null()).output().context("run cohabit")
}

/// The reference data's folder, for tests that need it.
#[must_use]
pub fn reference_data() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/arena")
}
