//! A session that is a `cohabit play` of this program's, which ends with it.

use std::{
    ffi::OsString,
    io::{BufRead as _, BufReader, Read},
    os::unix::process::CommandExt as _,
    process::{Child, Command, Stdio},
    sync::mpsc::{self, Receiver},
    thread,
    time::{Duration, Instant},
};

use cohabit_host::{Door, Look};
use rustix::process::{Pid, Signal, kill_process};

use super::ticks::{TickWatch, Ticked};
use crate::terminal::shown;

/// This very program, also when its file was replaced since it was started.
const THIS_PROGRAM: &str = "/proc/self/exe";
/// How long a session may take to end when asked; then its supervisor is killed, with which all of it ends.
const GRACE: Duration = Duration::from_secs(12);

/// What a session says.
enum Line {
    /// What it tells its user.
    Said(String),
    /// What is wrong.
    Wrong(String),
}

/// A session that is played. Dropping it ends it at once.
pub struct ChildSession {
    child: Child,
    session: String,
    lines: Receiver<Line>,
    /// What it said was wrong, the last of it.
    wrong: String,
    door: Option<Door>,
    ticks: Option<TickWatch>,
    /// When it is killed, if it was asked to end.
    ends_by: Option<Instant>,
}

impl ChildSession {
    /// Starts one of that name by these arguments of `play`; where it is `told`, what is wrong with it is printed under that name.
    /// It ends with the thread that starts it.
    ///
    /// # Errors
    /// Why it cannot be started.
    pub fn start(session: &str, arguments: &[OsString], told: Option<String>) -> Result<Self, String> {
        let spawned = Command::new(THIS_PROGRAM)
            .arg0("cohabit")
            .args(["play", "--session", session, "--supervisor", &std::process::id().to_string()])
            .args(arguments)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            // Ctrl-C reaches this program alone, which then ends its sessions.
            .process_group(0)
            .spawn();
        let mut child = spawned.map_err(|error| format!("start a session: {error}"))?;
        let (sender, lines) = mpsc::channel();
        if let Some(out) = child.stdout.take() {
            let sender = sender.clone();
            relay(out, move |line| drop(sender.send(Line::Said(line))));
        }
        if let Some(errors) = child.stderr.take() {
            relay(errors, move |line| {
                if let Some(name) = &told {
                    eprintln!("{name}: {}", shown(&line));
                }
                drop(sender.send(Line::Wrong(line)));
            });
        }
        let (session, wrong) = (session.to_owned(), String::new());
        Ok(Self { child, session, lines, wrong, door: None, ticks: None, ends_by: None })
    }

    /// The process that supervises it.
    pub fn process(&self) -> u32 {
        self.child.id()
    }

    /// How it is.
    pub fn look(&mut self) -> Look {
        self.hear();
        match self.child.try_wait() {
            Ok(None) => {}
            Ok(Some(status)) if self.wrong.is_empty() => return Look::Gone(status.to_string()),
            Ok(Some(_)) => return Look::Gone(self.wrong.clone()),
            Err(error) => return Look::Gone(error.to_string()),
        }
        if self.ends_by.is_some_and(|at| at <= Instant::now()) {
            self.signal(Signal::KILL);
        }
        self.door.clone().map_or(Look::Starting, Look::Open)
    }

    fn hear(&mut self) {
        while let Ok(line) = self.lines.try_recv() {
            match line {
                Line::Said(line) => self.door = door(&line).or_else(|| self.door.take()),
                Line::Wrong(line) => self.wrong = line,
            }
        }
    }

    /// Takes in the ticks that it told since this was last called; as often as every ten seconds.
    pub fn note_ticks(&mut self) {
        if self.door.is_none() || self.ends_by.is_some() {
            return;
        }
        if self.ticks.is_none() {
            self.ticks = TickWatch::join(&self.session);
        }
        // What could not be read once is joined anew.
        if self.ticks.as_mut().is_some_and(|watch| watch.take_in().is_err()) {
            self.ticks = None;
        }
    }

    /// Its ticks since a moment, ns, of those that were taken in.
    pub fn ticked_since(&self, nanos: u64) -> Ticked {
        self.ticks.as_ref().map(|watch| watch.since(nanos)).unwrap_or_default()
    }

    /// Asks it to end.
    pub fn end(&mut self) {
        // What is left on its bus keeps it from being wiped.
        self.ticks = None;
        self.signal(Signal::TERM);
        self.ends_by.get_or_insert_with(|| Instant::now() + GRACE);
    }

    fn signal(&self, signal: Signal) {
        if let Some(pid) = i32::try_from(self.child.id()).ok().and_then(Pid::from_raw) {
            let _ = kill_process(pid, signal);
        }
    }
}

impl Drop for ChildSession {
    fn drop(&mut self) {
        if matches!(self.child.try_wait(), Ok(None)) {
            let _ = self.child.kill();
            let _ = self.child.wait();
        }
    }
}

/// Hands on what a process says, line by line.
fn relay(out: impl Read + Send + 'static, tell: impl Fn(String) + Send + 'static) {
    thread::spawn(move || BufReader::new(out).lines().map_while(Result::ok).for_each(tell));
}

/// The page that a line of `play` tells of. A wizard's seat, and seats of people, have lines of their own.
fn door(line: &str) -> Option<Door> {
    let is_of_page = ["Open http", "The page is back at http"].iter().any(|start| line.starts_with(start));
    let address = line.split_whitespace().find(|word| word.starts_with("http")).filter(|_| is_of_page)?;
    let (site, token) = address.split_once("/?token=")?;
    Some(Door { port: site.rsplit_once(':')?.1.parse().ok()?, token: token.to_owned() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages_are_read_from_what_play_says() {
        for (line, expected) in [
            (
                "Open http://127.0.0.1:40123/?token=ab12  (ready after 0.50 s; Ctrl-C ends the session)",
                Some((40123, "ab12")),
            ),
            ("Open https://[::1]:9/?token=x", Some((9, "x"))),
            ("The page is back at http://127.0.0.1:9/?token=x", Some((9, "x"))),
            ("Seat 1 (body 2): http://127.0.0.1:9/?token=ef56", None),
            ("Wizard's seat: http://127.0.0.1:40123/wizard?token=cd34", None),
            ("Playing \"Make cereal\" (make_cereal.json)", None),
            ("Open http://127.0.0.1", None),
        ] {
            let expected = expected.map(|(port, token)| Door { port, token: token.to_owned() });
            assert_eq!(door(line), expected, "{line}");
        }
    }
}
