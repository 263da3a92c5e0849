//! Runs the processes of a case and gathers what they have measured.

use std::collections::HashMap;
use std::fs;
use std::io::{self, Read as _};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::thread::sleep;
use std::time::{Duration, Instant};

use cohabit_bus::Session;

use crate::board::Board;
use crate::case::Case;
use crate::contender::Contender;
use crate::work::Failure;

/// What a case must be over in, beyond what it is to take.
const WATCHDOG: Duration = Duration::from_secs(60);

/// What came of a case.
#[derive(Clone, Copy, Debug, Default)]
pub struct Figures {
    /// From the stamp of the sender to the subscriber's having it (and having read it, where it is touched), µs.
    pub p50_us: f64,
    /// The same, of 99 in 100.
    pub p99_us: f64,
    /// The same, at worst.
    pub most_us: f64,
    /// Processor time of all processes for one message at the pace, µs.
    pub cpu_us: f64,
    /// Messages a second that all subscribers took, two under way at once.
    pub messages_s: f64,
    /// Messages at the pace that a subscriber did not get.
    pub lost: u64,
    /// Beats of the pace left out because a message was under way.
    pub left_out: u64,
}

/// Measures one contender.
pub fn measure(contender: &Contender, case: &Case) -> Result<Figures, Failure> {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let name = format!("bench-{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
    let case = Case { folder: std::env::temp_dir().join(&name), ..case.clone() };
    fs::create_dir_all(&case.folder)?;
    Board::create(&case.file("board"))?;
    let session = Session::new(&name)?;
    let lock = session.supervise()?;
    let figures = run(contender, &case);
    session.end(lock);
    let _ = fs::remove_dir_all(&case.folder);
    figures
}

/// The processes of a case; none outlives this.
struct Processes(Vec<Child>);

impl Drop for Processes {
    fn drop(&mut self) {
        for child in &mut self.0 {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

fn run(contender: &Contender, case: &Case) -> Result<Figures, Failure> {
    let mut processes = Processes(Vec::new());
    for index in 0..case.subscribers {
        processes.0.push(start(contender, case, &format!("receive-{index}"))?);
    }
    processes.0.push(start(contender, case, "send")?);
    let beats = u32::try_from(case.count)? * 2;
    let deadline = Instant::now() + case.beat * beats + case.rush + WATCHDOG;
    let mut results = Vec::new();
    // The sender last but first to end: subscribers that wait for it in vain are ended with it.
    for child in processes.0.iter_mut().rev() {
        results.push(result(child, deadline)?);
    }
    figures(case, &results[0], &results[1..])
}

fn start(contender: &Contender, case: &Case, role: &str) -> io::Result<Child> {
    Command::new(&contender.program)
        .args(["work", role, contender.carrier])
        .args(case.arguments())
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .spawn()
}

/// What a process says before it ends.
fn result(child: &mut Child, deadline: Instant) -> Result<HashMap<String, String>, Failure> {
    let mut out = child.stdout.take().ok_or("no output")?;
    let reader = std::thread::spawn(move || {
        let mut text = String::new();
        out.read_to_string(&mut text).map(|_| text)
    });
    let status = loop {
        match child.try_wait()? {
            Some(status) => break status,
            None if Instant::now() > deadline => return Err("one of its processes does not end".into()),
            None => sleep(Duration::from_millis(20)),
        }
    };
    let text = reader.join().map_err(|_| "its output was not read")??;
    let line = text.lines().find_map(|line| line.strip_prefix("result "));
    let line = line.ok_or_else(|| format!("it ended ({status}) without a result"))?;
    let pairs = line.split(' ').filter_map(|pair| pair.split_once('='));
    Ok(pairs.map(|(key, value)| (key.to_owned(), value.to_owned())).collect())
}

fn figures(
    case: &Case,
    sender: &HashMap<String, String>,
    receivers: &[HashMap<String, String>],
) -> Result<Figures, Failure> {
    let number = |result: &HashMap<String, String>, key: &str| -> Result<u64, Failure> {
        Ok(result.get(key).ok_or_else(|| format!("no `{key}`"))?.parse()?)
    };
    let mut latencies: Vec<u64> = Vec::new();
    let mut cpu_ns = number(sender, "cpu")?;
    for receiver in receivers {
        cpu_ns += number(receiver, "cpu")?;
        let texts = receiver.get("latencies").map(String::as_str).unwrap_or_default();
        latencies.extend(texts.split(',').filter_map(|text| text.parse::<u64>().ok()));
    }
    latencies.sort_unstable();
    let at = |share: f64| {
        let index = (latencies.len() as f64 * share) as usize;
        latencies.get(index.min(latencies.len().saturating_sub(1))).map_or(f64::NAN, |ns| *ns as f64 / 1e3)
    };
    let wanted = case.count * case.subscribers as u64;
    Ok(Figures {
        p50_us: at(0.5),
        p99_us: at(0.99),
        most_us: at(1.0),
        cpu_us: cpu_ns as f64 / 1e3 / case.count as f64,
        messages_s: number(sender, "rushed")? as f64 / (number(sender, "rush")? as f64 / 1e9),
        lost: wanted.saturating_sub(latencies.len() as u64),
        left_out: number(sender, "left-out")?,
    })
}
