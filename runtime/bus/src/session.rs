//! A session's name, where its shared memory lies, and how it is cleaned away.
//!
//! A session is locked at both of its places: its shared memory in `/dev/shm`, which every process of the machine shares,
//! and its folder, which depends on the environment. Whoever wants to remove something must hold both locks, so a live
//! session is safe from processes with another runtime folder and from those with another `/dev/shm`.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs::{self, File},
    io::{self, Write as _},
    os::unix::fs::MetadataExt as _,
    path::{Path, PathBuf},
    thread,
    time::Duration,
};

use rustix::{
    fs::{FallocateFlags, FlockOperation, fallocate, flock, statvfs},
    io::Errno,
};

use crate::{
    envelope::Envelope,
    private::{self, AccessError},
};

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
    /// Its folder or one of its files cannot be used, or is not this user's alone.
    #[error(transparent)]
    Access(#[from] AccessError),
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
    memory: File,
    _folder: File,
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
/// The lock of a session's shared memory, behind its prefix.
const LOCK: &str = "lock";
/// What the lock takes of shared memory: the least that a file takes, to find out whether there is any.
const LOCK_BYTES: u64 = 4096;
/// Where less is free, shared memory counts as full: a frame of a large camera, bytes.
const LEAST_FREE: u64 = 4 << 20;
/// Others hold a dead session's lock while they wipe it, for a moment: so often it is tried, this far apart.
const LOCK_TRIES: usize = 20;
const LOCK_EVERY: Duration = Duration::from_millis(10);

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
        format!("{PREFIX}{}_{}_", private::user(), self.name)
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
        is_locked(&self.memory_lock_path()) || is_locked(&self.folder_lock_path())
    }

    /// This user's sessions that are supervised now and have their folders where this process looks for them, by name.
    #[must_use]
    pub fn all_supervised() -> Vec<Self> {
        let mut all: Vec<Self> = locked_names().filter_map(|name| Self::new(&name).ok()).collect();
        all.retain(|session| is_locked(&session.folder_lock_path()));
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
    /// [`SessionError::Busy`], [`SessionError::Access`], [`SessionError::NoSharedMemory`].
    pub fn supervise(&self) -> Result<SessionLock, SessionError> {
        private::check_parent(Path::new(SHARED_MEMORY)).map_err(no_shared_memory)?;
        make_sessions_folder()?;
        let lock = self.lock_patiently()?;
        self.wipe();
        let prepared = self.prepare(&lock);
        if prepared.is_err() {
            self.remove_locks();
        }
        prepared.map(|()| lock)
    }

    /// Makes its folder and says in it which version of the messages is spoken.
    fn prepare(&self, lock: &SessionLock) -> Result<(), SessionError> {
        self.check_memory()?;
        fallocate(&lock.memory, FallocateFlags::empty(), 0, LOCK_BYTES)
            .map_err(|error| SessionError::NoSharedMemory(error.into()))?;
        private::make_folder(&self.folder())?;
        let path = self.version_path();
        let mut file = private::create_new(&path)?;
        let written = file.write_all(Envelope::VERSION.to_string().as_bytes());
        written.map_err(|source| AccessError::System { path, source }.into())
    }

    /// Checks that its folder and its shared memory belong to this user alone.
    pub(crate) fn check(&self) -> Result<(), AccessError> {
        let all = sessions_folder();
        all.parent().map_or(Ok(()), private::check_parent)?;
        private::check_folder(&all)?;
        private::check_folder(&self.folder())?;
        self.check_memory()
    }

    /// Checks that nobody else has put something under the names of its shared memory.
    fn check_memory(&self) -> Result<(), AccessError> {
        for path in self.memory() {
            // What is gone meanwhile harms nobody.
            if let Ok(found) = fs::symlink_metadata(&path) {
                private::check_owner(&path, &found)?;
            }
        }
        Ok(())
    }

    /// The files of its shared memory, its lock among them.
    pub(crate) fn memory(&self) -> impl Iterator<Item = PathBuf> + use<> {
        let prefix = self.prefix();
        let files = fs::read_dir(SHARED_MEMORY).into_iter().flatten().flatten();
        files.filter(move |file| file.file_name().to_string_lossy().starts_with(&prefix)).map(|file| file.path())
    }

    /// Whether so little shared memory is left that the next frame may find no room.
    #[must_use]
    pub fn shared_memory_is_full() -> bool {
        // One without a limit has no blocks at all.
        let is_full = |bytes: u64, blocks: u64| blocks > 0 && bytes < LEAST_FREE;
        statvfs(SHARED_MEMORY).is_ok_and(|all| is_full(all.f_bavail.saturating_mul(all.f_frsize), all.f_blocks))
    }

    /// The files of its shared memory that somebody has truncated to nothing: none of them is ever empty.
    #[must_use]
    pub fn truncated_memory(&self) -> Vec<PathBuf> {
        let is_empty = |path: &PathBuf| fs::symlink_metadata(path).is_ok_and(|file| file.len() == 0);
        self.memory().filter(is_empty).collect()
    }

    /// The version of the messages that its processes speak; `None` if nobody has written it down.
    pub(crate) fn version(&self) -> Option<u32> {
        fs::read_to_string(self.version_path()).ok()?.trim().parse().ok()
    }

    fn version_path(&self) -> PathBuf {
        self.folder().join("version")
    }

    fn memory_lock_path(&self) -> PathBuf {
        self.shared_file(LOCK)
    }

    fn folder_lock_path(&self) -> PathBuf {
        sessions_folder().join(format!("{}.lock", self.name))
    }

    fn lock_patiently(&self) -> Result<SessionLock, SessionError> {
        for _ in 0..LOCK_TRIES {
            if let Some(lock) = self.lock()? {
                return Ok(lock);
            }
            thread::sleep(LOCK_EVERY);
        }
        Err(SessionError::Busy(self.name.clone()))
    }

    /// Takes both locks; `None` if somebody holds one of them.
    fn lock(&self) -> Result<Option<SessionLock>, SessionError> {
        let path = self.memory_lock_path();
        let Some(memory) = lock_file(&path).map_err(no_shared_memory)? else { return Ok(None) };
        let folder = lock_file(&self.folder_lock_path());
        if !matches!(folder, Ok(Some(_))) {
            // Its folder is locked by somebody with another `/dev/shm`: nothing here needs a lock.
            let _ = fs::remove_file(&path);
        }
        Ok(folder?.map(|folder| SessionLock { memory, _folder: folder }))
    }

    /// Removes its shared memory and files, but not its locks; what is already gone is no error.
    fn wipe(&self) {
        let lock = self.memory_lock_path();
        for path in self.memory().filter(|path| *path != lock) {
            let _ = fs::remove_file(path);
        }
        let _ = fs::remove_dir_all(self.folder());
    }

    /// Removes its locks, which this process holds.
    fn remove_locks(&self) {
        for path in [self.folder_lock_path(), self.memory_lock_path()] {
            let _ = fs::remove_file(path);
        }
    }

    /// Ends the session: wipes it, and its locks.
    pub fn end(&self, lock: SessionLock) {
        self.wipe();
        self.remove_locks();
        drop(lock);
    }

    /// Wipes every session of this user whose supervisor is dead; gives their names. A process that was only starting when
    /// its supervisor died may leave shared memory behind after its session was wiped: that is wiped, too.
    pub fn wipe_dead() -> Vec<String> {
        if make_sessions_folder().is_err() {
            // Whoever starts a session is told why.
            return Vec::new();
        }
        // Sessions are locked before they have shared memory.
        let remains = Self::in_shared_memory(Path::new(SHARED_MEMORY)).unwrap_or_default();
        let own = remains.into_iter().filter(|remains| remains.user == private::user());
        let mut names: BTreeSet<String> = own.map(|remains| remains.session).collect();
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

/// Locks a file for this process, which makes it if it is not there; `None` if another process holds it.
fn lock_file(path: &Path) -> Result<Option<File>, AccessError> {
    loop {
        let file = private::open_or_create(path)?;
        match flock(&file, FlockOperation::NonBlockingLockExclusive) {
            // Whoever held it before may have removed it meanwhile: then another process makes a new one.
            Ok(()) if private::is_at(&file, path) => return Ok(Some(file)),
            Ok(()) => {}
            Err(Errno::WOULDBLOCK) => return Ok(None),
            Err(error) => return Err(AccessError::System { path: path.to_owned(), source: error.into() }),
        }
    }
}

fn is_locked(path: &Path) -> bool {
    private::open(path).is_ok_and(|file| flock(&file, FlockOperation::NonBlockingLockShared).is_err())
}

/// That there is no memory is another matter than that somebody else's file is in the way.
fn no_shared_memory(error: AccessError) -> SessionError {
    match error {
        AccessError::System { source, .. } => SessionError::NoSharedMemory(source),
        other => other.into(),
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
    base.join(format!("cohabit-{}", private::user()))
}

/// Makes the folder of all sessions, where nobody else can reach or replace it.
fn make_sessions_folder() -> Result<(), AccessError> {
    let folder = sessions_folder();
    folder.parent().map_or(Ok(()), private::check_parent)?;
    private::make_folder(&folder)
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
