//! What tests need that a machine may lack. The build scripts of crates with such tests set a `cfg` for each thing that is
//! there; where it is absent, the tests are reported as ignored: `#[cfg_attr(not(browser), ignore = "needs a browser")]`.
//!
//! Reasons that begin with `needs` are of what [`NEEDED`] lists: `.ci/run` fails where that is absent. Those that begin with
//! `optional` are of other things. Other reasons are those of tests that run on demand only.
//!
//! A build script looks again when what it found is gone. What is installed later is noticed after `touch tests/needs.rs`;
//! until then a test of `cohabit-tests` fails, and says so.

#![allow(dead_code, reason = "each build script asks for what the tests of its crate need")]

use std::{
    env,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

/// Something that tests need.
#[derive(Clone, Copy)]
pub struct Need {
    /// The `cfg` that is set where it is there.
    pub name: &'static str,
    /// The files that show that it is there; none if it is not.
    pub find: fn() -> Vec<PathBuf>,
    /// The variables that say where it is.
    pub variables: &'static [&'static str],
}

/// The reference data of Alexa Arena, beside the checkout.
pub const REFERENCE_DATA: Need = Need { name: "reference_data", find: reference_data, variables: &[] };
/// A browser that can be driven.
pub const BROWSER: Need = Need { name: "browser", find: browser, variables: &[] };
/// Python 3.10 or later with `venv`; packages are fetched by the tests themselves.
pub const PYTHON: Need = Need { name: "python", find: python, variables: &[] };
/// pip, for whatever Python.
pub const PIP: Need = Need { name: "pip", find: pip, variables: &[] };
/// A Vulkan driver, in hardware or software.
pub const VULKAN: Need = Need { name: "vulkan", find: vulkan, variables: &["VK_DRIVER_FILES", "VK_ICD_FILENAMES"] };
/// The engines of `cohabit voice install`.
pub const VOICE: Need = Need { name: "voice", find: voice, variables: &["COHABIT_VOICE", "XDG_DATA_HOME"] };
/// A folder with a Whisper model.
pub const WHISPER: Need = Need { name: "whisper", find: whisper, variables: &["COHABIT_WHISPER"] };
/// The right to mount a file system in a name space of one's own.
pub const MOUNTS: Need = Need { name: "mounts", find: mounts, variables: &[] };
/// Fast Downward, a planner for PDDL.
pub const FAST_DOWNWARD: Need = Need { name: "fast_downward", find: fast_downward, variables: &[] };
/// A `python3` with `pycocotools`, which reads COCO's annotations.
pub const PYCOCOTOOLS: Need = Need { name: "pycocotools", find: pycocotools, variables: &[] };
/// The `lerobot` package, in whatever `python3` is.
pub const LEROBOT: Need = Need { name: "lerobot", find: lerobot, variables: &[] };

/// All of them.
pub const ALL: [Need; 11] =
    [REFERENCE_DATA, BROWSER, PYTHON, PIP, VULKAN, VOICE, WHISPER, MOUNTS, FAST_DOWNWARD, PYCOCOTOOLS, LEROBOT];

/// Those that have to be there where `COHABIT_TESTS` is `all`.
pub const NEEDED: [Need; 5] = [REFERENCE_DATA, BROWSER, PYTHON, PIP, VULKAN];

/// Tells cargo which of these are there, and when to look again. Called by build scripts.
pub fn tell(needs: &[Need]) {
    println!("cargo::rerun-if-changed=build.rs");
    let found: Vec<&str> = needs.iter().filter(|need| tell_of(need)).map(|need| need.name).collect();
    println!("cargo::rustc-env=NEEDS_FOUND={}", found.join(","));
}

fn tell_of(need: &Need) -> bool {
    let files = (need.find)();
    println!("cargo::rustc-check-cfg=cfg({})", need.name);
    // A file that is not there would have cargo build the crate each time anew: only what is there is watched.
    files.iter().for_each(|file| println!("cargo::rerun-if-changed={}", file.display()));
    need.variables.iter().for_each(|name| println!("cargo::rerun-if-env-changed={name}"));
    if !files.is_empty() {
        println!("cargo::rustc-cfg={}", need.name);
    }
    !files.is_empty()
}

fn reference_data() -> Vec<PathBuf> {
    let package = variable("CARGO_MANIFEST_DIR").map(PathBuf::from).unwrap_or_default();
    let root = package.ancestors().find(|folder| folder.join("tests/needs.rs").is_file());
    let file = root.and_then(Path::parent).map(|beside| beside.join("shared/arena/README.md"));
    file.into_iter().filter(|file| file.is_file()).collect()
}

fn browser() -> Vec<PathBuf> {
    first_program(&["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"])
}

fn python() -> Vec<PathBuf> {
    let able = "import ensurepip, sys, venv; assert sys.version_info >= (3, 10)";
    if runs("python3", &["-c", able]) { first_program(&["python3"]) } else { Vec::new() }
}

fn pip() -> Vec<PathBuf> {
    for (program, arguments) in
        [("pip3", &["--version"][..]), ("pip", &["--version"]), ("python3", &["-m", "pip", "--version"])]
    {
        if runs(program, arguments) {
            return first_program(&[program]);
        }
    }
    Vec::new()
}

fn vulkan() -> Vec<PathBuf> {
    let named = VULKAN.variables.iter().filter_map(|name| variable(name));
    let named = named.flat_map(|list| env::split_paths(&list).collect::<Vec<_>>());
    let folders = ["/usr/share/vulkan/icd.d", "/usr/local/share/vulkan/icd.d", "/etc/vulkan/icd.d"];
    let entries = folders.into_iter().filter_map(|folder| std::fs::read_dir(folder).ok()).flatten().flatten();
    let listed =
        entries.map(|entry| entry.path()).filter(|path| path.extension().is_some_and(|ending| ending == "json"));
    named.chain(listed).filter(|path| path.is_file()).collect()
}

fn voice() -> Vec<PathBuf> {
    let data = || variable("XDG_DATA_HOME").or_else(|| variable("HOME").map(|home| format!("{home}/.local/share")));
    let folder = variable("COHABIT_VOICE").or_else(|| data().map(|data| format!("{data}/cohabit/voice")));
    let folder = folder.map(PathBuf::from).filter(|folder| folder.is_dir());
    let speller = first_program(&["espeak-ng"]);
    match folder {
        Some(folder) if !speller.is_empty() => [vec![folder], speller].concat(),
        _ => Vec::new(),
    }
}

fn whisper() -> Vec<PathBuf> {
    variable("COHABIT_WHISPER").map(PathBuf::from).filter(|folder| folder.is_dir()).into_iter().collect()
}

fn mounts() -> Vec<PathBuf> {
    let mount = "mount -t tmpfs -o size=64k tmpfs /dev/shm && test -w /dev/shm";
    if runs("unshare", &["-rm", "sh", "-c", mount]) { first_program(&["unshare"]) } else { Vec::new() }
}

fn fast_downward() -> Vec<PathBuf> {
    first_program(&["fast-downward", "fast-downward.py"])
}

fn pycocotools() -> Vec<PathBuf> {
    if runs("python3", &["-c", "import pycocotools.coco"]) { first_program(&["python3"]) } else { Vec::new() }
}

fn lerobot() -> Vec<PathBuf> {
    // Without importing it, which takes seconds.
    let there = "import importlib.util, sys; sys.exit(importlib.util.find_spec('lerobot') is None)";
    if runs("python3", &["-c", there]) { first_program(&["python3"]) } else { Vec::new() }
}

/// The first of these programs that is on the path.
fn first_program(names: &[&str]) -> Vec<PathBuf> {
    let path = env::var_os("PATH").unwrap_or_default();
    let mut found = env::split_paths(&path).flat_map(|folder| names.iter().map(move |name| folder.join(name)));
    found.find(|path| path.is_file()).into_iter().collect()
}

fn runs(program: &str, arguments: &[&str]) -> bool {
    let mut command = Command::new(program);
    command.args(arguments).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}

fn variable(name: &str) -> Option<String> {
    env::var(name).ok().filter(|value| !value.is_empty())
}
