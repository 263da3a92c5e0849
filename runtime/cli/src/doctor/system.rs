//! Folders, limits, and the sessions that run.

use std::{
    fs,
    os::unix::fs::{MetadataExt as _, PermissionsExt as _},
    path::Path,
};

use rustix::process::{Resource, getrlimit};

use super::{
    finding::{Finding, size},
    machine::{Machine, existing, free_bytes, try_writing},
};

/// What a log grows by in an hour of the default session: some 40 MiB while nothing much happens, measured; three times that.
const LOG_BYTES_PER_HOUR: u64 = 128 << 20;
/// Files that the busiest process of a session holds open: 61, measured with one body and one page; four times that.
const OPEN_FILES: u64 = 256;

/// Whether sessions can have their small files.
pub fn runtime_folder(machine: &Machine) -> Finding {
    let folder = &machine.runtime_folder;
    let remedy = "set XDG_RUNTIME_DIR to a folder of your own";
    let broken = |found: String| Finding::broken(found, "no session can be made or joined", remedy);
    let Ok(data) = fs::symlink_metadata(folder) else {
        let above = existing(folder);
        return match writable(above) {
            Ok(()) => Finding::good(format!("{} will be made", folder.display())),
            Err(error) => broken(format!("{} cannot be made in {}: {error}", folder.display(), above.display())),
        };
    };
    if !data.is_dir() {
        return broken(format!("{} is not a folder", folder.display()));
    }
    if data.uid() != machine.user {
        return broken(format!("{} belongs to another user ({})", folder.display(), data.uid()));
    }
    if data.permissions().mode() & 0o077 != 0 {
        let found = format!("{} can be reached by other users", folder.display());
        return Finding::broken(found, "no session can be made or joined", format!("chmod 700 {}", folder.display()));
    }
    match writable(folder) {
        Ok(()) => Finding::good(format!("{}, for this user alone", folder.display())),
        Err(error) => broken(format!("{}: {error}", folder.display())),
    }
}

/// Whether sessions can be recorded, and for how long.
pub fn log_folder(machine: &Machine) -> Finding {
    let (folder, above) = (&machine.log_folder, existing(&machine.log_folder));
    let remedy = "set XDG_DATA_HOME to another folder, or give `--log FILE`";
    let checked = writable(above).and_then(|()| free_bytes(above));
    let free = match checked {
        Ok(free) => free,
        Err(error) => {
            return Finding::broken(format!("{}: {error}", above.display()), "no session can be recorded", remedy);
        }
    };
    let found = format!("{} free for {}", size(free), folder.display());
    let hours = free / LOG_BYTES_PER_HOUR;
    match hours {
        0 => Finding::broken(found, format!("an hour takes up to {}", size(LOG_BYTES_PER_HOUR)), remedy),
        1..24 => Finding::costs(found, format!("that is some {hours} hours"), remedy),
        _ => Finding::good(found),
    }
}

/// Tries to write there.
fn writable(folder: &Path) -> std::io::Result<()> {
    try_writing(&folder.join(format!(".cohabit-doctor-{}", std::process::id())), b"probe")
}

/// Whether processes may open as many files as they need.
pub fn open_files(_: &Machine) -> Finding {
    judge_open_files(getrlimit(Resource::Nofile).current)
}

fn judge_open_files(limit: Option<u64>) -> Finding {
    match limit {
        Some(limit) if limit < OPEN_FILES => Finding::costs(
            format!("{limit} at most"),
            format!("a session with several bodies, cameras and pages opens up to {OPEN_FILES}"),
            format!("ulimit -n {}", 2 * OPEN_FILES),
        ),
        Some(limit) => Finding::good(format!("{limit} at most")),
        None => Finding::good("no limit"),
    }
}

/// Whether frames may be swapped out.
pub fn swap(machine: &Machine) -> Finding {
    let limit = getrlimit(Resource::Memlock).current.map_or_else(|| "any amount of memory".to_owned(), size);
    let swaps = machine.read("proc/swaps").lines().count() > 1;
    let swapped = if swaps { "there is swap, which a session that runs short of memory waits for" } else { "no swap" };
    Finding::good(format!("{swapped}; {limit} may be locked, a session locks none"))
}

/// Whether sessions run whose messages this program may not understand.
pub fn running(machine: &Machine) -> Finding {
    let running = simulators(machine);
    let (same, other): (Vec<_>, Vec<_>) = running.iter().partition(|(_, program)| *program == machine.program);
    let names = |sessions: &[&(String, std::path::PathBuf)]| {
        sessions.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>().join(", ")
    };
    match (same.is_empty(), other.is_empty()) {
        (true, true) => Finding::good("none"),
        (false, true) => Finding::good(names(&same)),
        _ => Finding::costs(
            format!("{} by another build of this program", names(&other)),
            "what is started by hand from this one may speak another version of the messages",
            "use one build for all of a session",
        ),
    }
}

/// Sessions that run, and the programs of their simulators.
fn simulators(machine: &Machine) -> Vec<(String, std::path::PathBuf)> {
    let mut found = Vec::new();
    for entry in fs::read_dir(machine.at("proc")).into_iter().flatten().flatten() {
        let line = fs::read(entry.path().join("cmdline")).unwrap_or_default();
        let words: Vec<_> = line.split(|byte| *byte == 0).map(String::from_utf8_lossy).collect();
        let session = words.iter().position(|word| word == "--session").and_then(|at| words.get(at + 1));
        if let ([_, role, ..], Some(session)) = (&words[..], session)
            && role == "sim"
            && let Ok(program) = fs::read_link(entry.path().join("exe"))
        {
            found.push((session.clone().into_owned(), program));
        }
    }
    found.sort();
    found
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::doctor::{finding::State, tests::Fake};

    #[test]
    fn limits_are_judged_by_what_a_session_opens() {
        assert_eq!(judge_open_files(Some(64)).state, State::Costs);
        assert_eq!(judge_open_files(Some(1024)).state, State::Good);
        assert_eq!(judge_open_files(None).state, State::Good);
    }

    #[test]
    fn folders_are_private_or_said_not_to_be() {
        let fake = Fake::new("folders");
        let folder = &fake.machine.runtime_folder;
        assert!(runtime_folder(&fake.machine).found.contains("will be made"));
        fs::create_dir_all(folder).unwrap();
        fs::set_permissions(folder, fs::Permissions::from_mode(0o755)).unwrap();
        assert_eq!(runtime_folder(&fake.machine).state, State::Broken);
        fs::set_permissions(folder, fs::Permissions::from_mode(0o700)).unwrap();
        assert_eq!(runtime_folder(&fake.machine).state, State::Good);
        let other = Machine { user: fake.machine.user + 1, ..fake.machine.clone() };
        assert_eq!(runtime_folder(&other).state, State::Broken);
        let nowhere = Machine { runtime_folder: PathBuf::from("/proc/nowhere/cohabit"), ..fake.machine.clone() };
        assert_eq!(runtime_folder(&nowhere).state, State::Broken);
        let nowhere = Machine { log_folder: PathBuf::from("/proc/nowhere/sessions"), ..fake.machine.clone() };
        assert_eq!(log_folder(&nowhere).state, State::Broken);
    }

    #[test]
    fn sessions_of_another_build_are_named() {
        let fake = Fake::new("running");
        assert_eq!(running(&fake.machine), Finding::good("none"));
        let process = |pid: &str, line: &str, program: &Path| {
            let folder = fake.machine.at("proc").join(pid);
            fs::create_dir_all(&folder).unwrap();
            fs::write(folder.join("cmdline"), line.replace(' ', "\0")).unwrap();
            std::os::unix::fs::symlink(program, folder.join("exe")).unwrap();
        };
        process("10", "/x/cohabit sim --session one --seed 1", &fake.machine.program);
        process("11", "/x/cohabit agent --session three", Path::new("/elsewhere/cohabit"));
        assert_eq!(running(&fake.machine), Finding::good("one"));
        process("12", "/x/cohabit sim --session two", Path::new("/elsewhere/cohabit"));
        let found = running(&fake.machine);
        assert_eq!((found.state, found.found.contains("two")), (State::Costs, true));
    }
}
