//! Starts the processes of a session, watches them, and ends all of them.

use std::{
    ffi::OsString,
    io::{BufRead as _, BufReader},
    os::unix::process::CommandExt as _,
    path::Path,
    process::{Child, ChildStdout, Command, ExitStatus, Stdio},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use anyhow::Context as _;
use rustix::process::{Pid, Signal, kill_process, setpriority_process};

use crate::{
    doctor::shared_memory_fault,
    failure::{BAD_INPUT, BadInput, ENVIRONMENT, Environment},
    minds::MindRequest,
    peers::{Listening, Noted, Timing, Watching},
    rendering::Rendering,
};

/// How long a process may take to end when asked.
const GRACE: Duration = Duration::from_secs(3);
/// How often the processes are looked after.
const LOOK_EVERY: Duration = Duration::from_millis(20);
/// A process that ends by itself more often than this within a while is not started again, unless all that it lacks is
/// what the machine may give later, such as its port.
const MOST_RESTARTS: usize = 8;
/// The while.
const RESTARTS_COUNT_FOR: Duration = Duration::from_secs(60);
/// How long the second restart within the while waits; the first one does not wait, each further one twice as long.
const FIRST_DELAY: Duration = Duration::from_millis(250);
/// The longest that a restart waits.
const LONGEST_DELAY: Duration = Duration::from_secs(4);
/// How much less urgent than the world its agents are, in steps of niceness.
const AGENTS_GIVE_WAY: i32 = 5;
/// This very program, also when its file was replaced or taken away since it was started: all processes of a session
/// are of one build.
const THIS_PROGRAM: &str = "/proc/self/exe";

/// Has the C library give back at once what the engines of voice take for a sentence: otherwise its pieces are kept, and the dialog
/// service holds a third more than it needs.
const GIVES_BACK: [(&str, &str); 2] = [("MALLOC_ARENA_MAX", "2"), ("MALLOC_MMAP_THRESHOLD_", "4194304")];

/// One process of a session.
pub struct Role {
    name: &'static str,
    arguments: Vec<OsString>,
}

impl Role {
    /// The simulator, without which there is no session; `world` are the arguments that say what is simulated.
    pub fn sim(world: Vec<OsString>, rendering: Rendering, timing: Timing) -> Self {
        let mut arguments: Vec<OsString> = rendering.arguments().into();
        arguments.extend(timing.arguments());
        arguments.extend(world);
        Self { name: "sim", arguments }
    }

    /// The recorder.
    pub fn record(log: &Path, noted: &Noted, watching: Watching) -> Self {
        let mut arguments = vec!["--log".into(), log.into()];
        arguments.extend(noted.arguments());
        arguments.extend(watching.arguments());
        Self { name: "record", arguments }
    }

    /// A mind.
    pub fn agent(request: &MindRequest, seed: u64) -> Self {
        Self { name: "agent", arguments: request.arguments(seed) }
    }

    /// The dialog service: of the bodies of these robots that people speak to, and of those that act on their own.
    pub fn dialog(listening: &Listening, robots: &[u32], on_their_own: &[u32]) -> Self {
        let (listen, port) = (listening.listen.to_string(), listening.port.to_string());
        let (drive, knows) = (listening.drive.to_string(), listening.knows.to_string());
        let (ask, model, effort) = (listening.ask.name(), listening.model.name(), listening.understanding.name());
        let played = ["--drive", &drive, "--knows", &knows, "--ask", ask, "--model", model, "--understanding", effort];
        let arguments = ["--listen", &listen, "--port", &port].into_iter().chain(played);
        let names = listening.names.iter().flat_map(|name| ["--name".to_owned(), name.to_string()]);
        let robots = robots.iter().flat_map(|body| ["--robot".to_owned(), body.to_string()]);
        let robots = robots.chain(on_their_own.iter().map(|body| format!("--on-its-own={body}")));
        let manner = [format!("--politeness={}", listening.politeness), format!("--verbosity={}", listening.verbosity)];
        let questionnaires = listening.questionnaires.iter().map(|name| format!("--questionnaire={name}"));
        let hosts = listening.hosts.iter().map(|host| format!("--host={host}"));
        let arguments = arguments.map(str::to_owned).chain(names).chain(robots).chain(questionnaires);
        let framed_by = listening.framed_by.map(|port| format!("--framed-by={port}"));
        let hidden = listening.hide.iter().map(|part| format!("--hide={part}"));
        let seats = (listening.seats > 0).then(|| format!("--seats={}", listening.seats));
        let arguments = arguments.chain(hosts).chain(framed_by).chain(hidden).chain(seats);
        let arguments = arguments.chain(listening.voice.arguments()).chain(listening.wizard.arguments()).chain(manner);
        let (tls, language) = (listening.tls.arguments(), listening.language.arguments());
        Self { name: "dialog", arguments: arguments.map(OsString::from).chain(tls).chain(language).collect() }
    }

    /// The same with more arguments.
    pub fn with(mut self, arguments: &[OsString]) -> Self {
        self.arguments.extend_from_slice(arguments);
        self
    }

    /// The order in which roles are ended: who speaks first, who writes down last.
    fn ends(&self) -> u8 {
        match self.name {
            "dialog" => 0,
            "agent" => 1,
            "sim" => 2,
            _ => 3,
        }
    }
}

struct Running {
    role: Role,
    child: Child,
    /// When it has ended by itself within [`RESTARTS_COUNT_FOR`].
    ends: Vec<Instant>,
    /// Whether it is another one than the first.
    is_again: bool,
    /// When it is to be started again, if it has ended.
    again_at: Option<Instant>,
    /// Whether it has said that it does what it is for: serves the page, or records.
    works: Arc<AtomicBool>,
}

/// What follows from the end of a process.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Then {
    /// It is started again after so long.
    Restart(Duration),
    /// The session ends. The process has said itself what is wrong: with its arguments, or with the machine.
    EndAsSaid(u8),
    /// The session ends, since it cannot go on without it.
    End,
}

impl Running {
    /// What is to follow from its end; `is_simulator` if there is no session without it.
    fn ended(&mut self, code: Option<i32>, is_simulator: bool) -> Then {
        let class =
            code.and_then(|code| u8::try_from(code).ok()).filter(|code| [BAD_INPUT, ENVIRONMENT].contains(code));
        // The arguments of one that has worked were right, and so are those of one that takes its place.
        let is_new = !self.is_again && !self.works.load(Ordering::Relaxed);
        if let Some(class) = class.filter(|_| is_new) {
            return Then::EndAsSaid(class);
        }
        self.ends.retain(|at| at.elapsed() < RESTARTS_COUNT_FOR);
        self.ends.push(Instant::now());
        let may_end = class == Some(ENVIRONMENT) || self.ends.len() <= MOST_RESTARTS;
        if is_simulator || !may_end { Then::End } else { Then::Restart(delay(self.ends.len())) }
    }

    fn is_running(&mut self) -> bool {
        matches!(self.child.try_wait(), Ok(None))
    }
}

/// How long one that has ended so many times within the while is waited with.
fn delay(ends: usize) -> Duration {
    match u32::try_from(ends).unwrap_or(u32::MAX) {
        0 | 1 => Duration::ZERO,
        ends => FIRST_DELAY.saturating_mul(1 << (ends - 2).min(16)).min(LONGEST_DELAY),
    }
}

/// The processes of one session.
pub struct Supervisor {
    session: String,
    running: Vec<Running>,
    told: Arc<Told>,
}

/// When the session was started, and what its user was told since.
struct Told {
    began: Instant,
    page: AtomicBool,
    frame: AtomicBool,
}

impl Supervisor {
    /// Starts all roles.
    pub fn start(session: &str, roles: impl IntoIterator<Item = Role>, began: Instant) -> anyhow::Result<Self> {
        let told = Told { began, page: AtomicBool::new(false), frame: AtomicBool::new(false) };
        let mut supervisor = Self { session: session.to_owned(), running: Vec::new(), told: Arc::new(told) };
        for role in roles {
            let works = Arc::default();
            let child = supervisor.spawn(&role, &works)?;
            let running = Running { role, child, ends: Vec::new(), is_again: false, again_at: None, works };
            supervisor.running.push(running);
        }
        Ok(supervisor)
    }

    fn spawn(&self, role: &Role, works: &Arc<AtomicBool>) -> anyhow::Result<Child> {
        let own = GIVES_BACK.into_iter().filter(|(name, _)| std::env::var_os(name).is_none());
        let mut child = Command::new(THIS_PROGRAM)
            .envs(own.filter(|_| role.name == "dialog"))
            .arg0(std::env::args_os().next().unwrap_or_else(|| "cohabit".into()))
            .arg(role.name)
            .args(["--session", &self.session, "--supervisor", &std::process::id().to_string()])
            .args(&role.arguments)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            // Ctrl-C reaches this process alone, which then ends the others in order.
            .process_group(0)
            .spawn()
            .with_context(|| format!("start {}", role.name))?;
        if role.name == "agent"
            && let Some(pid) = i32::try_from(child.id()).ok().and_then(Pid::from_raw)
        {
            // However hard it thinks, the world goes on.
            let _ = setpriority_process(Some(pid), AGENTS_GIVE_WAY);
        }
        if let Some(out) = child.stdout.take() {
            let (told, works) = (Arc::clone(&self.told), Arc::clone(works));
            thread::spawn(move || relay(out, &told, &works));
        }
        Ok(child)
    }

    /// Watches over the processes until `stop`, or until the session cannot go on; then ends them.
    pub fn run(mut self, stop: &Arc<AtomicBool>) -> anyhow::Result<Ended> {
        while !stop.load(Ordering::Relaxed) {
            self.look_after()?;
            thread::sleep(LOOK_EVERY);
        }
        println!("Ending the session");
        Ok(Ended { log_is_whole: self.end_all() })
    }

    fn look_after(&mut self) -> anyhow::Result<()> {
        for index in 0..self.running.len() {
            let running = &mut self.running[index];
            let Some(status) = running.child.try_wait().context("look after a process")? else { continue };
            match running.again_at {
                Some(at) if at <= Instant::now() => self.start_again(index)?,
                Some(_) => {}
                None => self.ended(index, status)?,
            }
        }
        Ok(())
    }

    /// One has ended by itself.
    fn ended(&mut self, index: usize, status: ExitStatus) -> anyhow::Result<()> {
        let running = &mut self.running[index];
        let name = running.role.name;
        let delay = match running.ended(status.code(), name == "sim") {
            Then::EndAsSaid(BAD_INPUT) => return Err(BadInput(String::new()).into()),
            Then::EndAsSaid(_) => return Err(Environment(String::new()).into()),
            Then::End => {
                let how = describe(status, &self.session);
                anyhow::bail!("the {name} process ended ({how}); the session cannot go on without it")
            }
            Then::Restart(delay) => delay,
        };
        running.again_at = Some(Instant::now() + delay);
        let when = if delay.is_zero() { String::new() } else { format!(" in {} s", delay.as_secs_f32()) };
        eprintln!("cohabit: the {name} process ended ({}); starting it again{when}", describe(status, &self.session));
        Ok(())
    }

    fn start_again(&mut self, index: usize) -> anyhow::Result<()> {
        let works = Arc::default();
        let child = self.spawn(&self.running[index].role, &works)?;
        let running = &mut self.running[index];
        (running.child, running.works, running.is_again, running.again_at) = (child, works, true, None);
        Ok(())
    }
}

/// How a session has ended, as its user asked.
#[derive(Clone, Copy, Debug)]
pub struct Ended {
    /// Whether the recorder says that it has written down all.
    pub log_is_whole: bool,
}

impl Supervisor {
    /// Waits for a recorder that was just started again: what it has missed can be had only while the others live.
    fn let_recorder_catch_up(&mut self) {
        let is_recorder = |running: &Running| running.role.name == "record";
        let waiting = self.running.iter().position(|running| is_recorder(running) && running.again_at.is_some());
        if let Some(index) = waiting
            && self.is_simulating()
        {
            // That it cannot be started is told by its status.
            let _ = self.start_again(index);
        }
        let deadline = Instant::now() + GRACE;
        let is_late = |running: &mut Running| {
            let is_behind = running.is_again && !running.works.load(Ordering::Relaxed);
            is_recorder(running) && is_behind && running.is_running()
        };
        while self.is_simulating() && self.running.iter_mut().any(is_late) && Instant::now() < deadline {
            thread::sleep(LOOK_EVERY);
        }
    }

    fn is_simulating(&mut self) -> bool {
        self.running.iter_mut().any(|running| running.role.name == "sim" && running.is_running())
    }

    /// Ends all in order; whether the recorder, which is the last, has ended well.
    fn end_all(&mut self) -> bool {
        self.let_recorder_catch_up();
        self.running.sort_by_key(|running| running.role.ends());
        let mut is_whole = true;
        for mut running in self.running.drain(..) {
            let status = end(&mut running.child);
            if running.role.name == "record" {
                // One that was ended before it began has nothing to lose.
                let began = running.is_again || running.works.load(Ordering::Relaxed);
                is_whole = status.is_some_and(|status| status.success() || !began && status.code().is_none());
            }
        }
        is_whole
    }
}

impl Drop for Supervisor {
    fn drop(&mut self) {
        self.end_all();
    }
}

/// Asks a process to end, and kills it if it does not; how it has ended.
fn end(child: &mut Child) -> Option<ExitStatus> {
    let pid = i32::try_from(child.id()).ok().and_then(Pid::from_raw);
    if let (Ok(None), Some(pid)) = (child.try_wait(), pid) {
        let _ = kill_process(pid, Signal::TERM);
    }
    let deadline = Instant::now() + GRACE;
    while matches!(child.try_wait(), Ok(None)) {
        if Instant::now() > deadline {
            let _ = child.kill();
            break;
        }
        thread::sleep(Duration::from_millis(5));
    }
    child.wait().ok()
}

fn describe(status: ExitStatus, session: &str) -> String {
    use std::os::unix::process::ExitStatusExt as _;
    match (status.code(), status.signal()) {
        (Some(code), _) => format!("exit code {code}"),
        (None, Some(signal)) if signal == Signal::BUS.as_raw() => {
            format!("signal {signal}: {}", shared_memory_fault(session))
        }
        (None, Some(signal)) => format!("signal {signal}"),
        (None, None) => "for an unknown reason".to_owned(),
    }
}

/// Tells the user what a process tells its supervisor. Notes whether it does what it is for.
fn relay(out: ChildStdout, told: &Told, works: &AtomicBool) {
    for line in BufReader::new(out).lines().map_while(Result::ok) {
        let seconds = told.began.elapsed().as_secs_f64();
        match line.split_once(' ') {
            Some(("page", address)) => {
                works.store(true, Ordering::Relaxed);
                if told.page.swap(true, Ordering::Relaxed) {
                    println!("The page is back at {address}");
                } else {
                    println!("Open {address}  (ready after {seconds:.2} s; Ctrl-C ends the session)");
                }
            }
            Some(("wizard", address)) => println!("Wizard's seat: {address}"),
            Some(("seat", seat)) => println!("Seat {seat}"),
            Some(("recording", _)) => works.store(true, Ordering::Relaxed),
            None if line == "shown" => {
                if !told.frame.swap(true, Ordering::Relaxed) {
                    println!("First frame on the page {seconds:.2} s after the start");
                }
            }
            _ => println!("{line}"),
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn running(is_again: bool, works: bool) -> Running {
        let child = Command::new("true").spawn().unwrap();
        let role = Role { name: "dialog", arguments: Vec::new() };
        Running { role, child, ends: Vec::new(), is_again, again_at: None, works: Arc::new(works.into()) }
    }

    #[test]
    fn only_one_that_never_worked_ends_the_session_by_what_it_says() {
        for (is_again, works, code, then) in [
            (false, false, Some(2), Then::EndAsSaid(2)),
            (false, false, Some(4), Then::EndAsSaid(4)),
            (false, true, Some(2), Then::Restart(Duration::ZERO)),
            (true, false, Some(2), Then::Restart(Duration::ZERO)),
            (true, false, Some(4), Then::Restart(Duration::ZERO)),
            (false, false, Some(1), Then::Restart(Duration::ZERO)),
            (false, false, None, Then::Restart(Duration::ZERO)),
        ] {
            let mut running = running(is_again, works);
            assert_eq!(running.ended(code, false), then, "{is_again} {works} {code:?}");
            running.child.wait().unwrap();
        }
    }

    #[test]
    fn one_that_crashes_again_and_again_is_given_up_and_one_that_lacks_something_is_not() {
        let mut crashing = running(true, false);
        let delays: Vec<_> = (0..MOST_RESTARTS).map(|_| crashing.ended(Some(101), false)).collect();
        assert_eq!(delays[1], Then::Restart(FIRST_DELAY));
        assert_eq!(delays.last(), Some(&Then::Restart(LONGEST_DELAY)));
        assert_eq!(crashing.ended(Some(101), false), Then::End);
        assert_eq!(crashing.ended(Some(4), false), Then::Restart(LONGEST_DELAY));
        assert_eq!(running(false, false).ended(None, true), Then::End);
        crashing.child.wait().unwrap();
    }
}
