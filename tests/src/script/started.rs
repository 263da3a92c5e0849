//! A command that was started, and what it has said.

use std::{
    fs::{self, File},
    io,
    path::PathBuf,
    process::{Child, Command, ExitStatus},
    thread,
    time::{Duration, Instant},
};

use rustix::process::{Pid, Signal, kill_process};

/// How often it is looked after.
const LOOK_EVERY: Duration = Duration::from_millis(5);
/// The last lines of what it says that are told.
const MOST_LINES: usize = 60;

/// A started command. Dropping it kills it.
pub struct Started {
    child: Child,
    said: PathBuf,
}

impl Started {
    /// Starts a command that writes into a file what it says.
    pub fn new(command: &mut Command, said: PathBuf) -> io::Result<Self> {
        let file = File::create(&said)?;
        let child = command.stdout(file.try_clone()?).stderr(file).spawn()?;
        Ok(Self { child, said })
    }

    /// Its process id.
    pub fn pid(&self) -> u32 {
        self.child.id()
    }

    /// All that it has said.
    pub fn said(&self) -> String {
        String::from_utf8_lossy(&fs::read(&self.said).unwrap_or_default()).into_owned()
    }

    /// What went wrong, and the end of what it has said.
    pub fn told(&self, problem: &str) -> String {
        let said = self.said();
        let lines: Vec<&str> = said.lines().collect();
        format!("{problem}\n{}", lines[lines.len().saturating_sub(MOST_LINES)..].join("\n"))
    }

    /// Waits until it is `ready`.
    pub fn wait_until(&mut self, ready: impl Fn(&Self) -> bool, limit: Duration) -> Result<(), String> {
        let deadline = Instant::now() + limit;
        while !ready(self) {
            if let Some(status) = self.ended()? {
                return Err(self.told(&format!("it ended with {status} before it was ready")));
            }
            if Instant::now() > deadline {
                return Err(self.told(&format!("it is not ready after {} s", limit.as_secs())));
            }
            thread::park_timeout(LOOK_EVERY);
        }
        Ok(())
    }

    /// Waits until it has done its work.
    pub fn finish(mut self, limit: Duration) -> Result<(), String> {
        let deadline = Instant::now() + limit;
        loop {
            match self.ended()? {
                Some(status) if status.success() => return Ok(()),
                Some(status) => return Err(self.told(&format!("it ended with {status}"))),
                None if Instant::now() > deadline => {
                    return Err(self.told(&format!("it does not end within {} s", limit.as_secs())));
                }
                None => thread::park_timeout(LOOK_EVERY),
            }
        }
    }

    /// Presses Ctrl-C, and waits until it has ended.
    pub fn interrupt(self, limit: Duration) -> Result<(), String> {
        let pid = i32::try_from(self.child.id()).ok().and_then(Pid::from_raw);
        let sent = pid.map_or(Ok(()), |pid| kill_process(pid, Signal::INT));
        sent.map_err(|error| self.told(&format!("it cannot be ended: {error}")))?;
        self.finish(limit)
    }

    fn ended(&mut self) -> Result<Option<ExitStatus>, String> {
        self.child.try_wait().map_err(|error| format!("it cannot be waited for: {error}"))
    }
}

impl Drop for Started {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
