//! Where a page is run: a folder of its own, in which commands find nothing of the user's.

use std::{
    env,
    ffi::{OsStr, OsString},
    fs, io,
    os::unix::fs::{DirBuilderExt as _, symlink},
    path::{Component, Path, PathBuf},
    process::{Command, Stdio},
    thread,
    time::{Duration, Instant},
};

use rustix::process::{Pid, Signal, kill_process};

use crate::Scratch;

/// How long processes and sessions that were ended may take to go.
const GRACE: Duration = Duration::from_secs(5);
/// The folders of the repository that commands may read. Others may be of who works in it, and not be written to.
const REPOSITORY: [&str; 5] = ["agents", "cdf", "dialog", "runtime", "tests"];
/// What is not taken over from who runs this: it would have commands behave otherwise than on a bare machine.
const REMOVED: [&str; 3] = ["DISPLAY", "WAYLAND_DISPLAY", "XDG_DATA_HOME"];
/// The variables of this program.
const OWN_VARIABLES: &str = "COHABIT_";

/// A folder for one page. All that runs in it is killed, and it is removed, when this is dropped.
pub struct Place {
    root: PathBuf,
    /// Where programs are looked for.
    path: OsString,
    _scratch: Scratch,
}

impl Place {
    /// A folder for the page of that name, in which the folders of the repository are found, and `binary` as `cohabit`;
    /// programs in the folders `first` come before those of the machine.
    pub fn new(name: &str, binary: &Path, repository: &Path, first: &[PathBuf]) -> io::Result<Self> {
        let scratch = Scratch::new(&format!("guide-{name}"));
        let root = fs::canonicalize(scratch.path(""))?;
        let machine = env::var_os("PATH").unwrap_or_default();
        let folders = [root.join("bin")].into_iter().chain(first.iter().cloned()).chain(env::split_paths(&machine));
        let path = env::join_paths(folders).map_err(io::Error::other)?;
        let place = Self { root, path, _scratch: scratch };
        for folder in ["page", "bin", "home", "said"] {
            fs::create_dir(place.root.join(folder))?;
        }
        fs::DirBuilder::new().mode(0o700).create(place.root.join("run"))?;
        symlink(binary, place.program())?;
        for folder in REPOSITORY {
            symlink(repository.join(folder), place.folder().join(folder))?;
        }
        Ok(place)
    }

    /// The folder in which commands are typed.
    pub fn folder(&self) -> PathBuf {
        self.root.join("page")
    }

    /// The program under test.
    pub fn program(&self) -> PathBuf {
        self.root.join("bin/cohabit")
    }

    /// Where it is written down what the command of that number says.
    pub fn said(&self, number: usize) -> PathBuf {
        self.root.join(format!("said/{number}.txt"))
    }

    /// A program that is to be started there.
    pub fn command(&self, program: impl AsRef<OsStr>) -> Command {
        let mut command = Command::new(program);
        for (name, _) in env::vars_os().filter(|(name, _)| name.to_string_lossy().starts_with(OWN_VARIABLES)) {
            command.env_remove(name);
        }
        for name in REMOVED {
            command.env_remove(name);
        }
        command.env("PATH", &self.path).env("HOME", self.root.join("home"));
        command.env("XDG_RUNTIME_DIR", self.root.join("run"));
        command.current_dir(self.folder()).stdin(Stdio::null());
        command
    }

    /// Where a file of the page is written, whose folder is made.
    pub fn file(&self, name: &str) -> Result<PathBuf, String> {
        let is_plain = Path::new(name).components().all(|part| matches!(part, Component::Normal(_)));
        let first = name.split('/').next().unwrap_or_default();
        if !is_plain || self.folder().join(first).is_symlink() {
            return Err(format!("`{name}` lies outside the page's folder, or in the repository: name another file"));
        }
        let path = self.folder().join(name);
        let parent = path.parent().unwrap_or(&path);
        fs::create_dir_all(parent).map_err(|error| format!("{}: {error}", parent.display()))?;
        Ok(path)
    }

    /// What is left of commands that have ended: processes, and sessions.
    pub fn left_behind(&self) -> Vec<String> {
        let deadline = Instant::now() + GRACE;
        loop {
            let processes = self.processes().into_iter().map(|(pid, line)| format!("process {pid}: {line}"));
            let left: Vec<String> = processes.chain(self.sessions()).collect();
            if left.is_empty() || Instant::now() > deadline {
                return left;
            }
            thread::park_timeout(Duration::from_millis(5));
        }
    }

    /// The processes that run there, with their command lines.
    fn processes(&self) -> Vec<(i32, String)> {
        let mut found = Vec::new();
        for entry in fs::read_dir("/proc").into_iter().flatten().flatten() {
            let Some(pid) = entry.file_name().to_str().and_then(|name| name.parse().ok()) else { continue };
            if fs::read_link(entry.path().join("cwd")).is_ok_and(|folder| folder.starts_with(&self.root)) {
                let line = fs::read(entry.path().join("cmdline")).unwrap_or_default();
                found.push((pid, String::from_utf8_lossy(&line).replace('\0', " ")));
            }
        }
        found
    }

    /// The locks of sessions that were started there.
    fn sessions(&self) -> Vec<String> {
        let folders = fs::read_dir(self.root.join("run")).into_iter().flatten().flatten();
        let files = folders.flat_map(|folder| fs::read_dir(folder.path()).into_iter().flatten().flatten());
        let names = files.map(|file| file.file_name().to_string_lossy().into_owned());
        names.filter(|name| name.ends_with(".lock")).map(|name| format!("session {name}")).collect()
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        for pid in self.processes().into_iter().filter_map(|(pid, _)| Pid::from_raw(pid)) {
            // It may be gone by itself.
            let _ = kill_process(pid, Signal::KILL);
        }
    }
}
