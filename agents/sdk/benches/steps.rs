//! How fast a world goes in lock-step that waits for agents in processes of their own, and how long a command takes to
//! its outcome.
//!
//! ```text
//! cargo bench -p cohabit-agent --bench steps              # measures: about a minute
//! cargo bench -p cohabit-agent --bench steps -- quick     # measures less, in some seconds
//! ```
//!
//! The simulator and each agent are processes of their own, over shared memory. A step is a turn of every agent and a
//! tick of the world, with its physics, its state (where somebody looks at it), its digest, and frames of 300x300 in
//! four planes for every agent that has eyes. A command is one that ends at once: the time until its outcome is heard
//! is that of a tick and two wake-ups.

use std::{
    error::Error,
    fs,
    io::Read as _,
    process::{Child, Command, Stdio},
    sync::{Arc, atomic::AtomicBool},
    time::{Duration, Instant},
};

use cohabit_agent::{Client, Eyes};
use cohabit_bus::{Session, Shm};
use cohabit_cdf::{Action, BodyKind, BodyRequest, Catalog, mission};
use cohabit_engine::{SessionPlan, Simulator};
use cohabit_render::{CpuRenderer, MeshLibrary};

type Failure = Box<dyn Error>;

/// How much is measured.
struct Extent {
    warm_up: u64,
    lasts: Duration,
    commands: usize,
}

const FULL: Extent = Extent { warm_up: 500, lasts: Duration::from_secs(5), commands: 2000 };
const QUICK: Extent = Extent { warm_up: 100, lasts: Duration::from_millis(700), commands: 200 };
const AGENTS: [usize; 3] = [1, 2, 4];
/// Nothing takes longer but a session that is stuck.
const PATIENCE: Duration = Duration::from_secs(60);

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["sim", session, agents] => simulate(session, agents.parse()?),
        ["agent", session, body, eyes, extent] => act(session, body.parse()?, eyes == "eyes", extent_of(extent)),
        _ => measure_all(if words.contains(&"quick") { "quick" } else { "full" }),
    }
}

fn extent_of(name: &str) -> &'static Extent {
    if name == "quick" { &QUICK } else { &FULL }
}

fn measure_all(extent: &str) -> Result<(), Failure> {
    let version = env!("CARGO_PKG_VERSION");
    println!("machine: {}; load before: {}; cohabit {version}; {}", machine(), load(), kernel());
    println!("{:>6}  {:>7}  {:>9}  {:>22}", "agents", "frames", "steps/s", "command p50, p99 [µs]");
    for eyes in ["blind", "eyes"] {
        for agents in AGENTS {
            let result = measure(agents, eyes, extent)?;
            let figures: Vec<f64> = result.split_whitespace().map(str::parse).collect::<Result<_, _>>()?;
            let [steps, p50, p99] = figures[..] else { return Err(format!("no figures: {result:?}").into()) };
            let frames = if eyes == "eyes" { "300x300" } else { "none" };
            println!("{agents:>6}  {frames:>7}  {steps:>9.0}  {p50:>10.0} {p99:>11.0}");
        }
    }
    println!("load after: {}", load());
    Ok(())
}

/// Processes that end with this one's interest in them.
struct Started(Vec<Child>);

impl Drop for Started {
    fn drop(&mut self) {
        for child in &mut self.0 {
            // One that has ended already needs no killing.
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// One case; gives what its first agent has measured.
fn measure(agents: usize, eyes: &str, extent: &str) -> Result<String, Failure> {
    let session = Session::new(&format!("steps-{}", std::process::id()))?;
    let lock = session.supervise()?;
    let mut started = Started(Vec::new());
    let mut result = String::new();
    started.0.push(start(&["sim", session.name(), &agents.to_string()], false)?);
    for body in (0..agents).rev() {
        started.0.push(start(&["agent", session.name(), &body.to_string(), eyes, extent], body == 0)?);
    }
    let out = started.0.last_mut().and_then(|first| first.stdout.take());
    out.ok_or("no first agent")?.read_to_string(&mut result)?;
    drop(started);
    session.end(lock);
    Ok(result)
}

fn start(arguments: &[&str], is_heard: bool) -> Result<Child, Failure> {
    let out = if is_heard { Stdio::piped() } else { Stdio::null() };
    Ok(Command::new(std::env::current_exe()?).args(arguments).stdin(Stdio::null()).stdout(out).spawn()?)
}

/// The simulator's process.
fn simulate(session: &str, agents: usize) -> Result<(), Failure> {
    let (file, text) = mission::builtin()[0];
    let catalog = Arc::new(Catalog::builtin());
    let more = vec![BodyRequest { kind: BodyKind::Robot, room: None }; agents - 1];
    let plan = SessionPlan::new(file, text, Arc::clone(&catalog), 1)?.with_bodies(more).in_lock_step(agents);
    let bus = Shm::join(&Session::new(session)?)?;
    let meshes = Arc::new(MeshLibrary::build(&catalog)?);
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let simulator = Simulator::new(&plan, plan.build()?, meshes, Box::new(CpuRenderer::new(threads)), &bus)?;
    Ok(simulator.run(&AtomicBool::new(false))?)
}

/// An agent's process: the first one measures, the others go along until they are ended.
fn act(session: &str, body: u32, has_eyes: bool, extent: &Extent) -> Result<(), Failure> {
    let bus = Shm::join(&Session::new(session)?)?;
    let never = AtomicBool::new(false);
    cohabit_agent::wait_for_mission(&bus, &never)?;
    let catalog = Arc::new(Catalog::builtin());
    let mut going = Going {
        client: Client::join(&bus, body, "bench")?,
        eyes: has_eyes.then(|| Eyes::of_body(&bus, body, catalog)).transpose()?,
    };
    going.client.claim(false)?;
    going.client.attend(None)?;
    for _ in 0..extent.warm_up {
        going.step()?;
    }
    if body > 0 {
        loop {
            going.step()?;
        }
    }
    let (began, mut steps) = (Instant::now(), 0.0);
    while began.elapsed() < extent.lasts {
        going.step()?;
        steps += 1.0;
    }
    let steps_s = steps / began.elapsed().as_secs_f64();
    let mut micros: Vec<f64> = (0..extent.commands).map(|_| going.command()).collect::<Result<_, _>>()?;
    micros.sort_by(f64::total_cmp);
    let at = |share: f64| micros[((micros.len() - 1) as f64 * share) as usize];
    println!("{steps_s} {} {}", at(0.5), at(0.99));
    Ok(())
}

/// An agent in its turns.
struct Going {
    client: Client,
    eyes: Option<Eyes>,
}

impl Going {
    /// Waits for its turn, looks, and lets the world go on.
    fn step(&mut self) -> Result<(), Failure> {
        self.turn()?;
        Ok(self.client.ready(1)?)
    }

    fn turn(&mut self) -> Result<(), Failure> {
        let tick = self.client.wait_for_turn(PATIENCE)?.ok_or("its turn never comes")?;
        while self.client.event()?.is_some() {}
        if let Some(eyes) = &mut self.eyes {
            let glance = eyes.look()?.ok_or("a turn without a frame")?;
            if glance.tick() != tick {
                return Err(format!("a frame of tick {} at tick {tick}", glance.tick()).into());
            }
        }
        Ok(())
    }

    /// Commands something that ends at once; gives how long its outcome takes, µs.
    fn command(&mut self) -> Result<f64, Failure> {
        self.turn()?;
        let began = Instant::now();
        let command = self.client.act(0, Action::Stop)?;
        self.client.ready(1)?;
        self.client.outcome(command, PATIENCE)?.ok_or("no outcome")?;
        Ok(began.elapsed().as_secs_f64() * 1e6)
    }
}

/// The processor, and how many cores of it may be used.
fn machine() -> String {
    let processor = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = processor.lines().find_map(|line| line.strip_prefix("model name")).unwrap_or(": unknown");
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    format!("{}, {cores} cores", model.trim_start_matches([' ', '\t', ':']))
}

fn kernel() -> String {
    let text = fs::read_to_string("/proc/sys/kernel/osrelease").unwrap_or_default();
    format!("Linux {}", text.trim())
}

/// How many processes wanted a core over the last minute.
fn load() -> String {
    let text = fs::read_to_string("/proc/loadavg").unwrap_or_default();
    text.split(' ').next().unwrap_or("unknown").to_owned()
}
