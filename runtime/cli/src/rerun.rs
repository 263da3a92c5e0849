//! What needs rerun: a program of its own does it, which this one finds and starts.

use std::{
    env,
    ffi::OsStr,
    net::SocketAddr,
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    time::{Duration, Instant},
};

use anyhow::Context as _;
use cohabit_record::Log;
use rustix::process::{Pid, Signal, kill_process};

use crate::{failure::bad_input, terminal::shown};

/// The program.
const PROGRAM: &str = "cohabit-rerun";
/// How long it may take to end when asked.
const GRACE: Duration = Duration::from_secs(2);

/// Lays two sessions beside each other in rerun.
#[derive(clap::Args)]
pub struct Compare {
    /// The log of the one session
    left: PathBuf,
    /// The log of the other
    right: PathBuf,
    /// The recording to write; one named after both, in this folder, if absent
    #[arg(long, value_name = "FILE.rrd")]
    out: Option<PathBuf>,
}

impl Compare {
    /// Writes the recording.
    pub fn run(&self) -> anyhow::Result<()> {
        let name = |log: &Path| log.file_stem().unwrap_or(log.as_os_str()).to_string_lossy().into_owned();
        let beside = || PathBuf::from(format!("{}+{}.rrd", name(&self.left), name(&self.right)));
        let out = self.out.clone().unwrap_or_else(beside);
        ensure_no_log(&out)?;
        let arguments = [OsStr::new("compare"), self.left.as_os_str(), self.right.as_os_str()];
        let mut program = command()?;
        [&self.left, &self.right].into_iter().try_for_each(|log| ensure_built_in(log))?;
        run(program.args(arguments).arg("--out").arg(&out))?;
        tell_how_to_see(&out);
        Ok(())
    }
}

/// What is written anew is no session log: nobody can record that again, and whoever names one there has mixed up two arguments.
pub fn ensure_no_log(out: &Path) -> anyhow::Result<()> {
    if !Log::is_at(out) {
        return Ok(());
    }
    let out = out.display();
    let remedy = "name another file for what is made, and the log to be read first, before the options";
    Err(bad_input(format!("{out}: this is a session log, and would be overwritten: {remedy}")))
}

/// Makes a recording of a session's log, of so many pictures a second that show these planes.
pub fn replay(log: &Path, out: &Path, rate: f32, planes: &str) -> anyhow::Result<()> {
    let arguments = [format!("--rate={rate}"), format!("--planes={planes}")];
    let mut program = command()?;
    ensure_built_in(log)?;
    run(program.arg("replay").arg(log).arg("--out").arg(out).args(arguments))?;
    tell_how_to_see(out);
    Ok(())
}

/// The program knows what is built in alone, and would ask for the pack of a session that has one.
fn ensure_built_in(log: &Path) -> anyhow::Result<()> {
    let packs = Log::open(log).map_err(bad_input)?.session.packs;
    let Some(pack) = packs.first() else { return Ok(()) };
    let (log, name) = (log.display(), &pack.name);
    Err(bad_input(format!(
        "{log}: rerun cannot show a session of a world pack yet, and this is one of `{name}`: `cohabit replay --page`, with its `--world`, \
         plays it"
    )))
}

/// Writes logs as Parquet tables; says so, unless what is printed is for programs.
pub fn tables(logs: &[PathBuf], out: &Path, quietly: bool) -> anyhow::Result<()> {
    let mut program = command()?;
    if quietly {
        program.stdout(Stdio::null());
    }
    run(program.arg("tables").args(logs).arg("--out").arg(out))
}

/// Whether what needs rerun can be started at all.
pub fn check() -> anyhow::Result<()> {
    find().map(drop)
}

/// A viewer's link to a running session; ends when dropped.
pub struct Live(Child);

impl Live {
    /// Shows a session in the viewer at an address.
    pub fn start(session: &str, viewer: SocketAddr) -> anyhow::Result<Self> {
        let supervisor = std::process::id().to_string();
        let arguments = ["live", "--session", session, "--supervisor", &supervisor, "--viewer", &viewer.to_string()];
        let child = command()?.args(arguments).spawn().with_context(|| format!("start {PROGRAM}"))?;
        Ok(Self(child))
    }
}

impl Drop for Live {
    fn drop(&mut self) {
        let asked = i32::try_from(self.0.id()).ok().and_then(Pid::from_raw);
        let _ = asked.map(|pid| kill_process(pid, Signal::TERM));
        let began = Instant::now();
        while began.elapsed() < GRACE && matches!(self.0.try_wait(), Ok(None)) {
            std::thread::sleep(Duration::from_millis(20));
        }
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn command() -> anyhow::Result<Command> {
    Ok(Command::new(find()?))
}

/// The program, beside this one or on the path.
fn find() -> anyhow::Result<PathBuf> {
    let beside = env::current_exe().ok().and_then(|own| Some(own.parent()?.to_owned()));
    let on_path = env::var_os("PATH").map(|path| env::split_paths(&path).collect::<Vec<_>>()).unwrap_or_default();
    let found = beside.into_iter().chain(on_path).map(|folder| folder.join(PROGRAM)).find(|path| path.is_file());
    found.ok_or_else(|| {
        bad_input(format!(
            "this needs the program `{PROGRAM}`, which is neither beside this one nor on the path: build it with `cargo \
             build --release -p {PROGRAM}` (some minutes, once)"
        ))
    })
}

fn run(command: &mut Command) -> anyhow::Result<()> {
    let status = command.status().with_context(|| format!("start {PROGRAM}"))?;
    // It has said what is wrong.
    if status.success() { Ok(()) } else { Err(anyhow::anyhow!("")) }
}

fn tell_how_to_see(recording: &Path) {
    println!("See it with: rerun {}", shown(recording.display()));
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use cohabit_record::LogWriter;
    use cohabit_tests::Scratch;
    use serde_json::json;

    use super::*;

    #[test]
    fn of_a_session_of_a_world_pack_it_is_said_that_it_cannot_be_shown() {
        let scratch = Scratch::new("rerun-pack");
        for (name, packs) in [("own", json!([])), ("tea", json!([{"name": "homes", "version": "1", "digest": "ab"}]))] {
            let path = PathBuf::from(scratch.path(&format!("{name}.mcap")));
            let entry = json!({"format": 3, "program": "0", "session": "s", "mission_file": "m", "mission_text": "",
                "seed": 1, "packs": packs});
            LogWriter::create(&path, &serde_json::from_value(entry).unwrap(), 1).unwrap().finish().unwrap();
            let said = ensure_built_in(&path).map_err(|error| error.to_string());
            assert_eq!(said.is_ok(), name == "own", "{said:?}");
            assert!(said.err().is_none_or(|text| text.contains("tea.mcap") && text.contains("--page")));
        }
    }
}
