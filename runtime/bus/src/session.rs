//! A session's name, where its shared memory lies, and how it is cleaned away.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs::{self, File},
    io,
    os::unix::fs::{DirBuilderExt as _, MetadataExt as _},
    path::{Path, PathBuf},
};

use rustix::fs::{FlockOperation, flock};

use crate::envelope::Envelope;

/// A session's name and the places that belong to it alone.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Session {
    name: String,
}

/// Why a session could not be had.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// The name cannot be part of a file name.
    #[error("session name `{0}`: use 1 to 24 letters, digits or `-`")]
    Name(String),
    /// A live supervisor holds the session.
    #[error("session `{0}` runs already: choose another `--session` name, or end that one")]
    Busy(String),
    /// The folder for the session's files is not usable.
    #[error("{path}: {source}")]
    Folder {
        /// Which.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// There is no shared memory, or none left.
    #[error(
        "/dev/shm cannot be used: {0}; free it, or mount a writable tmpfs there (`mount -t tmpfs tmpfs /dev/shm`); \
         `cohabit doctor` tells more"
    )]
    NoSharedMemory(io::Error),
}

/// Held by the process that supervises a session, for as long as it lives; the kernel lets go of it when that
/// process dies in any way.
#[derive(Debug)]
pub struct SessionLock {
    _file: File,
}

/// What lies in shared memory under the name of one session.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Remains {
    /// The user whose it is, by number.
    pub user: u32,
    /// The session's name.
    pub session: String,
    /// Memory that it takes now, bytes.
    pub bytes: u64,
}

const SHARED_MEMORY: &str = "/dev/shm";
/// What the names of all sessions' shared memory begin with.
const PREFIX: &str = "cohabit_";

impl Session {
    /// A session of that name.
    ///
    /// # Errors
    /// [`SessionError::Name`].
    pub fn new(name: &str) -> Result<Self, SessionError> {
        let fits = (1..=24).contains(&name.len()) && name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'-');
        if fits { Ok(Self { name: name.to_owned() }) } else { Err(SessionError::Name(name.to_owned())) }
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its name as a number (FNV-1a), equal in all processes.
    #[must_use]
    pub fn number(&self) -> u64 {
        self.name
            .bytes()
            .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
    }

    /// What the names of its shared memory begin with.
    #[must_use]
    pub fn prefix(&self) -> String {
        format!("{PREFIX}{}_{}_", rustix::process::getuid().as_raw(), self.name)
    }

    /// A file of its shared memory, beside those that the transport makes.
    pub(crate) fn shared_file(&self, name: &str) -> PathBuf {
        Path::new(SHARED_MEMORY).join(format!("{}{}", self.prefix(), name.replace('/', ".")))
    }

    /// The folder of its small files.
    #[must_use]
    pub fn folder(&self) -> PathBuf {
        sessions_folder().join(&self.name)
    }

    /// The folder that holds those of all of this user's sessions.
    #[must_use]
    pub fn folder_of_all() -> PathBuf {
        sessions_folder()
    }

    /// Whether a process supervises it now.
    #[must_use]
    pub fn is_supervised(&self) -> bool {
        let file = File::options().write(true).open(self.lock_path());
        file.is_ok_and(|file| flock(&file, FlockOperation::NonBlockingLockExclusive).is_err())
    }

    /// All of this user's sessions that are supervised now, by name.
    #[must_use]
    pub fn all_supervised() -> Vec<Self> {
        let mut all: Vec<Self> = locked_names().filter_map(|name| Self::new(&name).ok()).collect();
        all.retain(Self::is_supervised);
        all.sort_by(|one, other| one.name.cmp(&other.name));
        all
    }

    /// What lies in a folder of shared memory of any session of any user, in the order of users and names.
    ///
    /// # Errors
    /// When the folder cannot be read.
    pub fn in_shared_memory(folder: &Path) -> io::Result<Vec<Remains>> {
        let mut all = BTreeMap::new();
        for entry in fs::read_dir(folder)?.flatten() {
            let (file, name) = (entry.metadata(), entry.file_name());
            if let (Ok(file), Some(owner)) = (file, name.to_str().and_then(owner)) {
                *all.entry(owner).or_default() += file.blocks() * 512;
            }
        }
        let remains = |((user, session), bytes)| Remains { user, session, bytes };
        Ok(all.into_iter().map(remains).collect())
    }

    /// Takes the session for this process to supervise, and wipes what an earlier one of that name left behind.
    ///
    /// # Errors
    /// [`SessionError::Busy`], [`SessionError::Folder`], [`SessionError::NoSharedMemory`].
    pub fn supervise(&self) -> Result<SessionLock, SessionError> {
        self.try_shared_memory().map_err(SessionError::NoSharedMemory)?;
        let folder = sessions_folder();
        create_private(&folder)?;
        let lock = self.lock()?.ok_or_else(|| SessionError::Busy(self.name.clone()))?;
        self.wipe();
        create_private(&self.folder())?;
        let path = self.version_path();
        fs::write(&path, Envelope::VERSION.to_string()).map_err(|source| SessionError::Folder { path, source })?;
        Ok(lock)
    }

    /// The version of the messages that its processes speak; `None` if nobody has written it down.
    pub(crate) fn version(&self) -> Option<u32> {
        fs::read_to_string(self.version_path()).ok()?.trim().parse().ok()
    }

    fn version_path(&self) -> PathBuf {
        self.folder().join("version")
    }

    /// Writes a page of shared memory and takes it away again.
    fn try_shared_memory(&self) -> io::Result<()> {
        let path = Path::new(SHARED_MEMORY).join(format!("{}probe", self.prefix()));
        let written = fs::write(&path, [0; 4096]);
        let _ = fs::remove_file(&path);
        written
    }

    fn lock_path(&self) -> PathBuf {
        sessions_folder().join(format!("{}.lock", self.name))
    }

    fn lock(&self) -> Result<Option<SessionLock>, SessionError> {
        let path = self.lock_path();
        let file = File::options()
            .create(true)
            .truncate(false)
            .write(true)
            .open(&path)
            .map_err(|source| SessionError::Folder { path, source })?;
        match flock(&file, FlockOperation::NonBlockingLockExclusive) {
            Ok(()) => Ok(Some(SessionLock { _file: file })),
            Err(_) => Ok(None),
        }
    }

    /// Removes its shared memory and files; what is already gone is no error.
    pub fn wipe(&self) {
        let prefix = self.prefix();
        for entry in fs::read_dir(SHARED_MEMORY).into_iter().flatten().flatten() {
            if entry.file_name().to_string_lossy().starts_with(&prefix) {
                let _ = fs::remove_file(entry.path());
            }
        }
        let _ = fs::remove_dir_all(self.folder());
    }

    /// Ends the session: wipes it, and its lock.
    pub fn end(&self, lock: SessionLock) {
        self.wipe();
        let _ = fs::remove_file(self.lock_path());
        drop(lock);
    }

    /// Wipes every session of this user whose supervisor is dead; gives their names. A process that was only starting when
    /// its supervisor died may leave shared memory behind after its session was wiped: that is wiped, too.
    pub fn wipe_dead() -> Vec<String> {
        let user = rustix::process::getuid().as_raw();
        // Sessions are locked before they have shared memory.
        let remains = Self::in_shared_memory(Path::new(SHARED_MEMORY)).unwrap_or_default();
        let mut names: BTreeSet<String> =
            remains.into_iter().filter(|remains| remains.user == user).map(|remains| remains.session).collect();
        names.extend(locked_names());
        let mut wiped = Vec::new();
        for name in names {
            if let Ok(session) = Self::new(&name)
                && let Ok(Some(lock)) = session.lock()
            {
                session.end(lock);
                wiped.push(session.name);
            }
        }
        wiped
    }
}

/// The user and the session that shared memory of this name belongs to.
fn owner(file: &str) -> Option<(u32, String)> {
    let (user, rest) = file.strip_prefix(PREFIX)?.split_once('_')?;
    let (session, _) = rest.split_once('_')?;
    Some((user.parse().ok()?, session.to_owned()))
}

/// The names of all sessions of this user that have a lock, held or not.
fn locked_names() -> impl Iterator<Item = String> {
    let paths = fs::read_dir(sessions_folder()).into_iter().flatten().flatten().map(|entry| entry.path());
    let locks = paths.filter(|path| path.extension().is_some_and(|ending| ending == "lock"));
    locks.filter_map(|path| Some(path.file_stem()?.to_str()?.to_owned()))
}

fn sessions_folder() -> PathBuf {
    let base = std::env::var_os("XDG_RUNTIME_DIR").map(PathBuf::from).filter(|path| path.is_dir());
    let base = base.unwrap_or_else(std::env::temp_dir);
    base.join(format!("cohabit-{}", rustix::process::getuid().as_raw()))
}

fn create_private(path: &Path) -> Result<(), SessionError> {
    fs::DirBuilder::new()
        .recursive(true)
        .mode(0o700)
        .create(path)
        .map_err(|source| SessionError::Folder { path: path.to_owned(), source })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_file_names() {
        for (name, good) in [("a", true), ("study-1", true), ("", false), ("../x", false), ("a b", false)] {
            assert_eq!(Session::new(name).is_ok(), good, "{name}");
        }
    }

    #[test]
    fn a_session_has_one_supervisor_and_leaves_nothing() {
        let session = Session::new(&format!("test-{}", std::process::id())).unwrap();
        let lock = session.supervise().unwrap();
        assert!(matches!(session.supervise(), Err(SessionError::Busy(_))));
        assert!(session.folder().is_dir());
        assert!(session.is_supervised());
        assert!(Session::all_supervised().contains(&session));
        session.end(lock);
        assert!(!session.is_supervised());
        assert!(!session.folder().exists());
        let lock = session.supervise().unwrap();
        session.end(lock);
    }

    #[test]
    fn shared_memory_is_told_by_user_and_session() {
        let folder = std::env::temp_dir().join(format!("cohabit-remains-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        for name in ["cohabit_7_a-1_x", "cohabit_7_a-1_y", "cohabit_8_b_z", "cohabit_x_c_z", "cohabit_9", "other"] {
            fs::write(folder.join(name), [1; 5000]).unwrap();
        }
        let found = Session::in_shared_memory(&folder).unwrap();
        let named: Vec<_> = found.iter().map(|remains| (remains.user, remains.session.as_str())).collect();
        assert_eq!(named, [(7, "a-1"), (8, "b")]);
        assert_eq!(found[0].bytes, 2 * found[1].bytes);
        assert!(found[1].bytes >= 5000);
        fs::remove_dir_all(&folder).unwrap();
    }
}
