//! Sessions that play what was edited: one at a time, each a `cohabit play` of its own, which ends with the editor.

use std::{
    env,
    fs::{self, DirBuilder},
    io::{BufRead as _, BufReader, Read},
    os::unix::{fs::DirBuilderExt as _, process::CommandExt as _},
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    sync::mpsc::{self, Receiver, RecvTimeoutError, Sender},
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use anyhow::Context as _;
use cohabit_edit::Player;
use rustix::process::{Pid, Signal, kill_process};

use crate::{rendering::Rendering, sessions, site::SiteOptions, terminal::shown, world::WorldPacks};

/// This very program, also when its file was replaced since it was started.
const THIS_PROGRAM: &str = "/proc/self/exe";
/// How long a session may take to begin.
const BEGINNING: Duration = Duration::from_secs(60);
/// How long a session may take to end when asked; then it is killed.
const GRACE: Duration = Duration::from_secs(12);

/// A mission to be played, and who hears what came of it.
type Order = (String, Sender<Result<String, String>>);

/// Plays missions on this machine.
pub struct Sessions {
    orders: Option<Sender<Order>>,
    /// The kernel ends sessions with the thread that started them, so one thread starts all of them.
    starter: Option<JoinHandle<()>>,
}

impl Sessions {
    /// Sessions in the world of these packs, whose pages are served as the editor's is.
    pub fn new(packs: WorldPacks, site: SiteOptions, rendering: Rendering) -> anyhow::Result<Self> {
        let folder = env::temp_dir().join(format!("cohabit-edit-{}", std::process::id()));
        let made = DirBuilder::new().mode(0o700).create(&folder);
        made.with_context(|| folder.display().to_string())?;
        let (orders, ordered) = mpsc::channel();
        let starter = Starter { packs, site, rendering, folder };
        let starter = thread::Builder::new().name("sessions".to_owned()).spawn(move || starter.run(&ordered))?;
        Ok(Self { orders: Some(orders), starter: Some(starter) })
    }
}

impl Player for Sessions {
    fn play(&self, mission: &str) -> Result<String, String> {
        let over = || "no session is started any more: the editor ends".to_owned();
        let (tell, told) = mpsc::channel();
        let orders = self.orders.as_ref().ok_or_else(over)?;
        orders.send((mission.to_owned(), tell)).map_err(|_| over())?;
        told.recv().map_err(|_| over())?
    }
}

impl Drop for Sessions {
    fn drop(&mut self) {
        self.orders = None;
        if let Some(starter) = self.starter.take() {
            let _ = starter.join();
        }
    }
}

/// Starts sessions, and ends them.
struct Starter {
    packs: WorldPacks,
    site: SiteOptions,
    rendering: Rendering,
    /// Where missions and logs of sessions are; this user's alone.
    folder: PathBuf,
}

impl Starter {
    fn run(self, orders: &Receiver<Order>) {
        let mut running: Option<Child> = None;
        for (mission, tell) in orders {
            if let Some(before) = running.take() {
                end(before);
            }
            let played = self.start(&mission).map(|(child, address)| {
                running = Some(child);
                println!("Playing it at {}", shown(&address));
                address
            });
            drop(tell.send(played));
        }
        if let Some(last) = running {
            end(last);
        }
        let _ = fs::remove_dir_all(&self.folder);
    }

    /// Starts a session; gives the address of its page.
    fn start(&self, mission: &str) -> Result<(Child, String), String> {
        let path = self.folder.join("mission.json");
        fs::write(&path, mission).map_err(|error| format!("{}: {error}", path.display()))?;
        let mut child = self.command(&path).spawn().map_err(|error| format!("start a session: {error}"))?;
        let (sender, lines) = mpsc::channel();
        if let Some(out) = child.stdout.take() {
            relay(out, sender.clone());
        }
        if let Some(errors) = child.stderr.take() {
            relay(errors, sender);
        }
        let until = Instant::now() + BEGINNING;
        let mut last = String::new();
        let why = loop {
            match lines.recv_timeout(until.saturating_duration_since(Instant::now())) {
                Ok(line) => match address(&line) {
                    Some(address) => return Ok((child, address)),
                    None => last = line,
                },
                Err(RecvTimeoutError::Disconnected) => break last,
                Err(RecvTimeoutError::Timeout) => break format!("it takes too long to begin; it said last: {last}"),
            }
        };
        end(child);
        Err(format!("the session did not begin: {why}"))
    }

    fn command(&self, mission: &Path) -> Command {
        let mut command = Command::new(THIS_PROGRAM);
        command
            .arg0("cohabit")
            .arg("play")
            .arg(mission)
            .args(["--port", "0", "--supervisor", &std::process::id().to_string()])
            .args(self.site.arguments())
            .args(self.packs.folders())
            .args(self.rendering.arguments())
            .arg("--log")
            .arg(self.folder.join(format!("{}.mcap", sessions::clock_seed())))
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            // Ctrl-C reaches the editor alone, which then ends its session.
            .process_group(0);
        command
    }
}

/// Hands on what a session says, line by line. When nobody reads it any more it is read all the same, so that the session does not wait.
fn relay(out: impl Read + Send + 'static, tell: Sender<String>) {
    thread::spawn(move || {
        for line in BufReader::new(out).lines().map_while(Result::ok) {
            drop(tell.send(line));
        }
    });
}

/// Has a session end, which it does in order when it is asked.
fn end(mut child: Child) {
    if let Some(pid) = i32::try_from(child.id()).ok().and_then(Pid::from_raw) {
        let _ = kill_process(pid, Signal::TERM);
    }
    let until = Instant::now() + GRACE;
    while Instant::now() < until {
        if !matches!(child.try_wait(), Ok(None)) {
            return;
        }
        thread::sleep(Duration::from_millis(20));
    }
    let _ = child.kill();
    let _ = child.wait();
}

/// The address of a session's page, if a line of `play` tells of it.
fn address(line: &str) -> Option<String> {
    line.split_whitespace().find(|word| word.starts_with("http") && word.contains("/?token=")).map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_is_the_one_that_play_tells_of() {
        let page = "http://127.0.0.1:40123/?token=ab12";
        let told = format!("Open {page}  (ready after 0.50 s; Ctrl-C ends the session)");
        assert_eq!(address(&told).as_deref(), Some(page));
        for other in ["see http://example.org", "Wizard's seat: http://127.0.0.1:9/wizard?token=x", "Playing \"x\""] {
            assert_eq!(address(other), None, "{other}");
        }
    }
}
