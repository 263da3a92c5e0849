//! Peers from the Python Package Index, in a virtual environment of their own.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::contender::Peer;
use crate::stage::Stage;

/// Where the scripts are.
const SCRIPTS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/peers");

/// One way to start a peer.
struct Way {
    package: &'static str,
    script: &'static str,
    settings: &'static [(&'static str, &'static str)],
    /// What is missing where it cannot start.
    needs: &'static str,
}

/// All of them; of one package, the first that can be started counts.
const WAYS: [Way; 3] = [
    Way {
        package: "pybullet",
        script: "peer_pybullet.py",
        settings: &[],
        needs: "what pip could not install, in requirements.txt",
    },
    Way {
        package: "mujoco",
        script: "peer_mujoco.py",
        settings: &[("MUJOCO_GL", "egl"), ("LIBGL_ALWAYS_SOFTWARE", "1")],
        needs: "Debian's packages libegl1 and libgl1-mesa-dri",
    },
    Way {
        package: "mujoco",
        script: "peer_mujoco.py",
        settings: &[("MUJOCO_GL", "osmesa"), ("PYOPENGL_PLATFORM", "osmesa")],
        needs: "Debian's package libosmesa6",
    },
];

/// Starts all that can be started on a stage; says what cannot be, and why.
pub fn start(python: &Path, stage: &Stage) -> Vec<Peer> {
    let mut peers = Vec::new();
    let mut started = "";
    for way in WAYS {
        if started == way.package {
            continue;
        }
        let log = stage.folder.join(format!("{}.log", way.package));
        match start_one(python, &way, stage, &log) {
            Ok(peer) => {
                started = way.package;
                peers.push(peer);
            }
            Err(error) => {
                let text = fs::read_to_string(&log).unwrap_or_default();
                let why = text.lines().rfind(|line| !line.trim().is_empty()).unwrap_or_default();
                let settings: String = way.settings.iter().map(|(key, value)| format!("{key}={value} ")).collect();
                println!("{settings}{}: {error} ({why}); it needs {}", way.script, way.needs);
            }
        }
    }
    peers
}

fn start_one(python: &Path, way: &Way, stage: &Stage, log: &Path) -> io::Result<Peer> {
    let child = Command::new(python)
        .arg(Path::new(SCRIPTS).join(way.script))
        .arg(&stage.folder)
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .envs(way.settings.iter().copied())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(File::create(log)?)
        .spawn()?;
    Peer::new(child, stage.triangles)
}

/// Runs one of the scripts to its end.
pub fn run_script(python: &Path, script: &str, arguments: &[String]) -> io::Result<()> {
    run(Command::new(python).arg(Path::new(SCRIPTS).join(script)).args(arguments), "numpy")
}

/// The environment's interpreter; makes the environment if it is not there, or of other versions.
pub fn environment(venv: &Path) -> io::Result<PathBuf> {
    let python = venv.join("bin/python");
    let wanted = fs::read_to_string(Path::new(SCRIPTS).join("requirements.txt"))?;
    let stamp = venv.join("installed.txt");
    if fs::read_to_string(&stamp).is_ok_and(|installed| installed == wanted) {
        return Ok(python);
    }
    println!("installing {} into {}", wanted.split_whitespace().collect::<Vec<_>>().join(", "), venv.display());
    run(Command::new("python3").args(["-m", "venv"]).arg(venv), "Debian's package python3-venv")?;
    // One by one, so that one that cannot be had does not keep others away; numpy comes with each.
    let mut failed = Ok(());
    for package in wanted.lines() {
        let install = run(Command::new(&python).args(["-m", "pip", "install", "--quiet", package]), "network and pip");
        failed = failed.and(install);
    }
    match failed {
        Ok(()) => fs::write(stamp, wanted)?,
        Err(error) => println!("{error}"),
    }
    Ok(python)
}

fn run(command: &mut Command, needs: &str) -> io::Result<()> {
    let status = command.status();
    let failed = |why: String| io::Error::other(format!("{command:?} {why}; it needs {needs}"));
    match status {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(failed(format!("ended with {status}"))),
        Err(error) => Err(failed(format!("cannot be run: {error}"))),
    }
}
