//! Where a machine tells of itself: the files that the checks look at.

use std::{
    env,
    ffi::OsString,
    fs,
    io::Write as _,
    net::SocketAddr,
    path::{Path, PathBuf},
};

use cohabit_bus::Urgency;
use cohabit_speech::VoiceSettings;

use crate::sessions;

/// A machine to look at; tests make up their own.
#[derive(Clone, Debug)]
pub struct Machine {
    /// What the paths of the system's files begin with.
    pub root: PathBuf,
    /// Where sessions have their small files.
    pub runtime_folder: PathBuf,
    /// Where sessions are recorded.
    pub log_folder: PathBuf,
    /// Where programs are.
    pub path: OsString,
    /// Where the page is to be served.
    pub page: SocketAddr,
    /// This program.
    pub program: PathBuf,
    /// Who asks.
    pub user: u32,
    /// How soon its ticks are served.
    pub urgency: Urgency,
    /// What sessions hear and speak with; why that cannot be told.
    pub voice: Result<VoiceSettings, String>,
}

impl Machine {
    /// This one, with the page to be served there.
    pub fn this(page: SocketAddr) -> std::io::Result<Self> {
        Ok(Self {
            root: PathBuf::from("/"),
            runtime_folder: cohabit_bus::Session::folder_of_all(),
            log_folder: sessions::usual_folder(),
            path: env::var_os("PATH").unwrap_or_default(),
            page,
            program: env::current_exe()?,
            user: rustix::process::getuid().as_raw(),
            urgency: super::processor::granted(),
            voice: VoiceSettings::from_env().map_err(|error| error.to_string()),
        })
    }

    /// A file of the system.
    pub fn at(&self, path: &str) -> PathBuf {
        self.root.join(path)
    }

    /// What a file of the system says; nothing where it cannot be read.
    pub fn read(&self, path: &str) -> String {
        fs::read_to_string(self.at(path)).unwrap_or_default().trim().to_owned()
    }

    /// The first program of these names.
    pub fn program(&self, names: &[&str]) -> Option<PathBuf> {
        let folders: Vec<_> = env::split_paths(&self.path).collect();
        let all = names.iter().flat_map(|name| folders.iter().map(move |folder| folder.join(name)));
        all.into_iter().find(|path| path.is_file())
    }
}

/// Bytes that a file system has free for this user.
pub fn free_bytes(folder: &Path) -> std::io::Result<u64> {
    let system = rustix::fs::statvfs(folder)?;
    Ok(system.f_bavail * system.f_frsize)
}

/// Tries to write a file, which must not be there yet, and removes it.
pub fn try_writing(probe: &Path, bytes: &[u8]) -> std::io::Result<()> {
    // Never through a symbolic link: the folder may be one that everybody can write to.
    let written = fs::File::create_new(probe)?.write_all(bytes);
    let _ = fs::remove_file(probe);
    written
}

/// The nearest folder above that there is.
pub fn existing(path: &Path) -> &Path {
    path.ancestors().find(|path| path.is_dir()).unwrap_or(path)
}
