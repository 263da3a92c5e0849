//! What other users of the machine put in a session's places is refused, and what a session makes is closed to them.
#![allow(clippy::unwrap_used, missing_docs)]

use std::{
    fs::{self, Permissions},
    os::unix::fs::{DirBuilderExt as _, MetadataExt as _, PermissionsExt as _, chown, symlink},
    path::{Path, PathBuf},
    process::{Command, Output},
    sync::atomic::{AtomicU32, Ordering},
};

use cohabit_bus::{CameraId, Session, Shm, Topic, Transport as _, Wake};

/// Somebody else, whom every machine has: `nobody`.
const OTHER_USER: u32 = 65534;
/// Tells a process of this test which session it is to start.
const SESSION: &str = "COHABIT_BUS_TEST_SESSION";

fn unlike_others() -> String {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    format!("o-{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed))
}

/// A runtime folder of a test's own, which goes when this is dropped.
struct Runtime(PathBuf);

impl Runtime {
    fn new() -> Self {
        let path = std::env::temp_dir().join(format!("cohabit-{}", unlike_others()));
        fs::DirBuilder::new().mode(0o700).create(&path).unwrap();
        Self(path)
    }

    /// Where sessions have their folders in it.
    fn sessions(&self) -> PathBuf {
        self.0.join(format!("cohabit-{}", rustix::process::geteuid().as_raw()))
    }

    /// Starts a session in it, in a process of its own, and ends it; what that process said.
    fn try_session(&self, name: &str) -> Output {
        Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "session", "--ignored", "--nocapture"])
            .env(SESSION, name)
            .env("XDG_RUNTIME_DIR", &self.0)
            .output()
            .unwrap()
    }

    fn check_refused(&self, part: &str) {
        let output = self.try_session(&unlike_others());
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success() && said.contains(part), "no `{part}` in {said}");
    }
}

impl Drop for Runtime {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// What such a process does.
#[test]
#[ignore = "a process that other tests start"]
fn session() {
    let Ok(name) = std::env::var(SESSION) else { return };
    let session = Session::new(&name).unwrap();
    let lock = session.supervise().unwrap_or_else(|error| panic!("{error}"));
    let joined = Shm::join(&session).map(drop);
    session.end(lock);
    joined.unwrap_or_else(|error| panic!("{error}"));
}

fn memory(session: &Session) -> Vec<PathBuf> {
    let prefix = session.prefix();
    let all = fs::read_dir("/dev/shm").unwrap().flatten();
    all.filter(|file| file.file_name().to_string_lossy().starts_with(&prefix)).map(|file| file.path()).collect()
}

fn give_away(path: &Path) {
    chown(path, Some(OTHER_USER), Some(OTHER_USER)).unwrap();
}

#[test]
fn all_shared_memory_is_closed_to_other_users() {
    let session = Session::new(&unlike_others()).unwrap();
    let lock = session.supervise().unwrap();
    let bus = Shm::join(&session).unwrap();
    let again = Shm::join(&session).unwrap();
    let topics = [Topic::State, Topic::Commands, Topic::Frames(CameraId::Eyes(0))];
    let ports = topics.map(|topic| (bus.publisher(topic).unwrap(), again.subscriber(topic).unwrap()));
    let files = memory(&session);
    assert!(files.iter().any(|path| path.to_string_lossy().ends_with("global_mgmt")), "{files:?}");
    for path in files {
        let mode = fs::metadata(&path).unwrap().mode();
        assert_eq!(mode & 0o077, 0, "{}: {mode:o}", path.display());
    }
    drop((ports, again, bus));
    session.end(lock);
    assert_eq!(memory(&session), [] as [PathBuf; 0]);
}

#[test]
fn a_runtime_folder_that_others_can_reach_is_refused() {
    let runtime = Runtime::new();
    assert!(runtime.try_session(&unlike_others()).status.success());
    fs::set_permissions(runtime.sessions(), Permissions::from_mode(0o777)).unwrap();
    runtime.check_refused("chmod 700");
    fs::remove_dir_all(runtime.sessions()).unwrap();
    let elsewhere = Runtime::new();
    symlink(&elsewhere.0, runtime.sessions()).unwrap();
    runtime.check_refused("a symbolic link");
    fs::remove_file(runtime.sessions()).unwrap();
    fs::set_permissions(&runtime.0, Permissions::from_mode(0o777)).unwrap();
    runtime.check_refused("can be reached by other users");
    assert_eq!(fs::read_dir(&elsewhere.0).unwrap().count(), 0);
}

#[test]
#[cfg_attr(not(root), ignore = "optional: only root can make folders of other users")]
fn another_users_runtime_folder_is_refused() {
    let runtime = Runtime::new();
    fs::DirBuilder::new().mode(0o700).create(runtime.sessions()).unwrap();
    give_away(&runtime.sessions());
    runtime.check_refused("belongs to user 65534");
    fs::remove_dir(runtime.sessions()).unwrap();
    give_away(&runtime.0);
    runtime.check_refused("belongs to user 65534");
}

#[test]
fn what_is_planted_in_shared_memory_is_not_written_to() {
    let session = Session::new(&unlike_others()).unwrap();
    let runtime = Runtime::new();
    let victim = runtime.0.join("victim");
    fs::write(&victim, "mine").unwrap();
    // Where the lock, what earlier versions probed memory with, and what wakes peers were or are.
    for name in ["lock", "probe", "wake.state"] {
        let planted = PathBuf::from(format!("/dev/shm/{}{name}", session.prefix()));
        symlink(&victim, &planted).unwrap();
        if let Ok(lock) = session.supervise() {
            let bus = Shm::join(&session).unwrap();
            drop(bus.publisher(Topic::State).unwrap());
            drop(bus);
            session.end(lock);
        }
        let _ = fs::remove_file(&planted);
        assert_eq!(fs::read_to_string(&victim).unwrap(), "mine", "{name}");
    }
}

#[test]
#[cfg_attr(not(root), ignore = "optional: only root can make files of other users")]
fn another_users_lock_and_wake_ups_are_refused() {
    let session = Session::new(&unlike_others()).unwrap();
    let at = |name: &str| PathBuf::from(format!("/dev/shm/{}{name}", session.prefix()));
    fs::write(at("lock"), "").unwrap();
    give_away(&at("lock"));
    let error = session.supervise().map(drop).unwrap_err().to_string();
    assert!(error.contains("belongs to user 65534") && error.contains("another `--session` name"), "{error}");
    fs::remove_file(at("lock")).unwrap();
    let lock = session.supervise().unwrap();
    let bus = Shm::join(&session).unwrap();
    let planted = at("wake.audio");
    fs::write(&planted, [0; 8]).unwrap();
    fs::set_permissions(&planted, Permissions::from_mode(0o666)).unwrap();
    give_away(&planted);
    let error = bus.listener(Wake::Audio).map(drop).unwrap_err().to_string();
    assert!(error.contains("belongs to user 65534"), "{error}");
    // Nobody joins a session in which somebody else has put something.
    let error = Shm::join(&session).map(drop).unwrap_err().to_string();
    assert!(error.contains("wake.audio belongs to user 65534"), "{error}");
    drop(bus);
    session.end(lock);
}
