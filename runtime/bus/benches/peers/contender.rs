//! Who is measured, and how those that are not of this project come to be built.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The package of the peers that are not of this project.
const FOREIGN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/peers/foreign");
/// What the workspace is built from.
const LOCK: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../Cargo.lock");

/// A way to carry messages.
pub struct Contender {
    /// As its program knows it.
    pub carrier: &'static str,
    /// As people read it, with its version.
    pub title: String,
    /// Whether it copies what is sent.
    pub copies: bool,
    /// The program that does its sending and receiving.
    pub program: PathBuf,
}

/// A package of another project.
struct Foreign {
    package: &'static str,
    /// The program, and the feature that it needs.
    program: &'static str,
    /// Carrier, title, and whether it copies.
    carriers: &'static [(&'static str, &'static str, bool)],
}

const FOREIGNERS: [Foreign; 1] = [Foreign {
    package: "zenoh",
    program: "zenoh-peer",
    carriers: &[("zenoh-shm", "zenoh, shared memory", false), ("zenoh-tcp", "zenoh, TCP", true)],
}];

/// What is not measured, and why.
const LEFT_OUT: [&str; 1] =
    ["dora is not measured: its nodes run under a daemon of its own alone, which this bench does not start"];

/// This bus, and what needs nothing that is not here.
pub fn own() -> std::io::Result<Vec<Contender>> {
    let own = std::env::current_exe()?;
    let of = |carrier, title: String, copies| Contender { carrier, title, copies, program: own.clone() };
    Ok(vec![
        of("own", format!("cohabit-bus {}", env!("CARGO_PKG_VERSION")), false),
        of("iceoryx2", format!("iceoryx2 {}, its own events", version(Path::new(LOCK), "iceoryx2")), false),
        of("unix", "Unix stream socket".to_owned(), true),
        of("tcp", "TCP loopback".to_owned(), true),
    ])
}

/// Those that can be built; says of which it cannot.
pub fn foreign(folder: &Path) -> Vec<Contender> {
    let mut all = Vec::new();
    for foreign in FOREIGNERS {
        match build(foreign.program, folder) {
            Ok(program) => {
                let version = version(&Path::new(FOREIGN).join("Cargo.lock"), foreign.package);
                all.extend(foreign.carriers.iter().map(|(carrier, title, copies)| Contender {
                    carrier,
                    title: format!("{title} {version}"),
                    copies: *copies,
                    program: program.clone(),
                }));
            }
            Err(why) => println!("{} is not measured: {why}", foreign.package),
        }
    }
    LEFT_OUT.iter().for_each(|line| println!("{line}"));
    all
}

/// Builds a program of the foreign package, as its lock file says.
fn build(program: &str, folder: &Path) -> Result<PathBuf, String> {
    let target = folder.join("foreign");
    println!("building {program} (a few minutes, the first time)");
    let output = Command::new(env!("CARGO"))
        .args(["build", "--release", "--locked", "--quiet", "--bin", program, "--features", program])
        .arg("--manifest-path")
        .arg(Path::new(FOREIGN).join("Cargo.toml"))
        .arg("--target-dir")
        .arg(&target)
        .output()
        .map_err(|error| error.to_string())?;
    if output.status.success() {
        return Ok(target.join("release").join(program));
    }
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    let why = text.lines().find(|line| line.starts_with("error")).unwrap_or("cargo has failed");
    Err(format!("{why} (all of it: cargo build --release --features {program} --manifest-path {FOREIGN}/Cargo.toml)"))
}

/// The version of a package in a lock file.
fn version(lock: &Path, package: &str) -> String {
    let text = fs::read_to_string(lock).unwrap_or_default();
    let entry = text.split("[[package]]").find(|entry| entry.contains(&format!("\nname = \"{package}\"\n")));
    let line = entry.and_then(|entry| entry.lines().find_map(|line| line.strip_prefix("version = ")));
    line.map_or_else(|| "of unknown version".to_owned(), |version| version.trim_matches('"').to_owned())
}
