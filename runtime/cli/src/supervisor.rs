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
    failure::BadInput,
    minds::MindRequest,
    peers::{Listening, Noted, Timing, Watching},
    rendering::Rendering,
};

/// How long a process may take to end when asked.
const GRACE: Duration = Duration::from_secs(3);
/// How often the processes are looked after.
const LOOK_EVERY: Duration = Duration::from_millis(20);
/// A process that ends by itself more often than this within a while is not started again.
const MOST_RESTARTS: usize = 5;
/// The while.
const RESTARTS_COUNT_FOR: Duration = Duration::from_secs(60);
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

    /// The dialog service.
    pub fn dialog(listening: &Listening, robots: &[u32]) -> Self {
        let (listen, port) = (listening.listen.to_string(), listening.port.to_string());
        let (drive, knows) = (listening.drive.to_string(), listening.knows.to_string());
        let ask = listening.ask.name();
        let arguments = ["--listen", &listen, "--port", &port, "--drive", &drive, "--knows", &knows, "--ask", ask];
        let names = listening.names.iter().flat_map(|name| ["--name".to_owned(), name.to_string()]);
        let robots = robots.iter().flat_map(|body| ["--robot".to_owned(), body.to_string()]);
        let questionnaires = listening.questionnaires.iter().map(|name| format!("--questionnaire={name}"));
        let hosts = listening.hosts.iter().map(|host| format!("--host={host}"));
        let arguments = arguments.map(str::to_owned).into_iter().chain(names).chain(robots).chain(questionnaires);
        let arguments = arguments.chain(hosts);
        let arguments = arguments.chain(listening.voice.arguments());
        let tls = listening.tls_arguments();
        Self { name: "dialog", arguments: arguments.map(OsString::from).chain(tls).collect() }
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
    /// When it was started again.
    restarts: Vec<Instant>,
    /// Whether it has said that it records.
    records: Arc<AtomicBool>,
}

impl Running {
    /// Whether it ends again and again.
    fn is_hopeless(&mut self) -> bool {
        self.restarts.retain(|at| at.elapsed() < RESTARTS_COUNT_FOR);
        self.restarts.len() >= MOST_RESTARTS
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
            let records = Arc::default();
            let child = supervisor.spawn(&role, &records)?;
            supervisor.running.push(Running { role, child, restarts: Vec::new(), records });
        }
        Ok(supervisor)
    }

    fn spawn(&self, role: &Role, records: &Arc<AtomicBool>) -> anyhow::Result<Child> {
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
            let (told, records) = (Arc::clone(&self.told), Arc::clone(records));
            thread::spawn(move || relay(out, &told, &records));
        }
        Ok(child)
    }

    /// Watches over the processes until `stop`, or until the session cannot go on.
    pub fn run(mut self, stop: &Arc<AtomicBool>) -> anyhow::Result<()> {
        while !stop.load(Ordering::Relaxed) {
            self.look_after()?;
            thread::sleep(LOOK_EVERY);
        }
        println!("Ending the session");
        Ok(())
    }

    fn look_after(&mut self) -> anyhow::Result<()> {
        for index in 0..self.running.len() {
            let running = &mut self.running[index];
            let Some(status) = running.child.try_wait().context("look after a process")? else { continue };
            let name = running.role.name;
            if status.code() == Some(2) {
                // It has said itself what is wrong with what it was given.
                return Err(BadInput(String::new()).into());
            }
            if name == "sim" || running.is_hopeless() {
                anyhow::bail!("the {name} process ended ({}); the session cannot go on without it", describe(status));
            }
            eprintln!("cohabit: the {name} process ended ({}); starting it again", describe(status));
            let records = Arc::default();
            let child = self.spawn(&self.running[index].role, &records)?;
            let running = &mut self.running[index];
            (running.child, running.records) = (child, records);
            running.restarts.push(Instant::now());
        }
        Ok(())
    }
}

impl Supervisor {
    /// Waits for a recorder that was just started again: what it has missed can be had only while the others live.
    fn let_recorder_catch_up(&mut self) {
        let deadline = Instant::now() + GRACE;
        let is_late = |running: &mut Running| {
            let is_new = running.role.name == "record" && !running.restarts.is_empty();
            is_new && !running.records.load(Ordering::Relaxed) && matches!(running.child.try_wait(), Ok(None))
        };
        let simulates =
            |running: &mut Running| running.role.name == "sim" && matches!(running.child.try_wait(), Ok(None));
        while self.running.iter_mut().any(simulates)
            && self.running.iter_mut().any(is_late)
            && Instant::now() < deadline
        {
            thread::sleep(LOOK_EVERY);
        }
    }
}

impl Drop for Supervisor {
    fn drop(&mut self) {
        self.let_recorder_catch_up();
        self.running.sort_by_key(|running| running.role.ends());
        for running in &mut self.running {
            end(&mut running.child);
        }
    }
}

fn end(child: &mut Child) {
    let pid = i32::try_from(child.id()).ok().and_then(Pid::from_raw);
    if let (Ok(None), Some(pid)) = (child.try_wait(), pid) {
        let _ = kill_process(pid, Signal::TERM);
    }
    let deadline = Instant::now() + GRACE;
    while matches!(child.try_wait(), Ok(None)) {
        if Instant::now() > deadline {
            let _ = child.kill();
            let _ = child.wait();
            return;
        }
        thread::sleep(Duration::from_millis(5));
    }
}

fn describe(status: ExitStatus) -> String {
    use std::os::unix::process::ExitStatusExt as _;
    match (status.code(), status.signal()) {
        (Some(code), _) => format!("exit code {code}"),
        (None, Some(signal)) if signal == Signal::BUS.as_raw() => {
            format!("signal {signal}: /dev/shm is full; free some, or give it more: mount -o remount,size=1g /dev/shm")
        }
        (None, Some(signal)) => format!("signal {signal}"),
        (None, None) => "for an unknown reason".to_owned(),
    }
}

/// Tells the user what a process tells its supervisor. Notes whether it records.
fn relay(out: ChildStdout, told: &Told, records: &AtomicBool) {
    for line in BufReader::new(out).lines().map_while(Result::ok) {
        let seconds = told.began.elapsed().as_secs_f64();
        match line.split_once(' ') {
            Some(("page", address)) if told.page.swap(true, Ordering::Relaxed) => {
                println!("The page is back at {address}");
            }
            Some(("page", address)) => {
                println!("Open {address}  (ready after {seconds:.2} s; Ctrl-C ends the session)");
            }
            Some(("recording", _)) => records.store(true, Ordering::Relaxed),
            None if line == "shown" => {
                if !told.frame.swap(true, Ordering::Relaxed) {
                    println!("First frame on the page {seconds:.2} s after the start");
                }
            }
            _ => println!("{line}"),
        }
    }
}
