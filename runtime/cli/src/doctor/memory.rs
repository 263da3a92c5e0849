//! Shared memory, and memory.

use std::path::Path;

use cohabit_bus::{Remains, Session};

use crate::failure::environment;

use super::{
    finding::{Finding, size},
    machine::{Machine, free_bytes, try_writing},
};

/// What the kernel calls a tmpfs.
const TMPFS: rustix::fs::FsWord = 0x0102_1994;
/// What the default session with one page takes of it: 17 MiB, measured, and as much to spare.
const SESSION_BYTES: u64 = 32 << 20;
/// Room for many bodies and large cameras.
const LARGE_SESSION_BYTES: u64 = 512 << 20;
/// What all processes of a session take beside it: 230 MiB, measured, and something to spare.
const SESSION_MEMORY: u64 = 384 << 20;

const FOLDER: &str = "dev/shm";

/// Whether there is shared memory, and enough of it.
pub fn shared_memory(machine: &Machine) -> Finding {
    const NOTHING: &str = "the processes of a session cannot reach each other";
    let folder = machine.at(FOLDER);
    if !folder.is_dir() {
        return Finding::broken(
            format!("there is no {}", folder.display()),
            NOTHING,
            "mount it: mount -t tmpfs -o size=1g tmpfs /dev/shm",
        );
    }
    let probe = folder.join(format!("cohabit_{}_doctor-{}", machine.user, std::process::id()));
    let written = try_writing(&probe, &[0; 4096]);
    let (system, free) = match (written, rustix::fs::statfs(&folder), free_bytes(&folder)) {
        (Ok(()), Ok(system), Ok(free)) => (system, free),
        (Err(error), ..) => {
            let found = format!("{} cannot be written: {error}", folder.display());
            return Finding::broken(found, NOTHING, "free it, or mount a writable tmpfs there");
        }
        (_, Err(error), _) => return Finding::broken(format!("{}: {error}", folder.display()), NOTHING, ""),
        (.., Err(error)) => return Finding::broken(format!("{}: {error}", folder.display()), NOTHING, ""),
    };
    let all = system.f_blocks * u64::try_from(system.f_bsize).unwrap_or(0);
    let found = format!("{} of {} free in {}", size(free), size(all), folder.display());
    judge(found, free, system.f_type == TMPFS)
}

/// Makes sure that a session has room before any of its processes starts: where shared memory is full, the kernel ends
/// whoever writes to it.
pub fn ensure_room() -> anyhow::Result<()> {
    let folder = Path::new("/").join(FOLDER);
    // Where it cannot be told, taking the session tells more.
    let free = free_bytes(&folder).unwrap_or(SESSION_BYTES);
    if free >= SESSION_BYTES {
        return Ok(());
    }
    let (free, needed) = (size(free), size(SESSION_BYTES));
    Err(environment(format!(
        "{} has {free} free, a session takes up to {needed}: free some, or {MORE}",
        folder.display()
    )))
}

/// Why the kernel has ended a process of a session that touched its shared memory (SIGBUS).
pub fn shared_memory_fault(session: &str) -> String {
    let empty = Session::new(session).map(|session| session.truncated_memory()).unwrap_or_default();
    match empty.first() {
        _ if Session::shared_memory_is_full() => format!("/dev/shm is full; free some, or {MORE}"),
        Some(file) => format!("{} was truncated by another program", file.display()),
        None => "a file of the session in /dev/shm was truncated by another program".to_owned(),
    }
}

/// What gives it more room.
const MORE: &str = "give it more: mount -o remount,size=1g /dev/shm (of a container: --shm-size=1g)";

fn judge(found: String, free: u64, is_tmpfs: bool) -> Finding {
    if free < SESSION_BYTES {
        let costs = format!("a session takes {}: its simulator would be ended by the kernel", size(SESSION_BYTES));
        Finding::broken(found, costs, MORE)
    } else if !is_tmpfs {
        Finding::costs(found + ", which is no tmpfs", "frames go to a disk", "mount -t tmpfs -o size=1g tmpfs /dev/shm")
    } else if free < LARGE_SESSION_BYTES {
        let costs = format!("one session of {} fits, but not many bodies or large cameras", size(SESSION_BYTES));
        Finding::costs(found, costs, MORE)
    } else {
        Finding::good(found)
    }
}

/// What sessions that are over have left in it, and what belongs to others.
pub fn leftovers(machine: &Machine) -> Finding {
    let all = Session::in_shared_memory(&machine.at(FOLDER)).unwrap_or_default();
    let sum = |remains: &[&Remains]| size(remains.iter().map(|remains| remains.bytes).sum());
    let (own, others): (Vec<_>, Vec<_>) = all.iter().partition(|remains| remains.user == machine.user);
    let (alive, dead): (Vec<_>, Vec<_>) = own.into_iter().partition(|remains| is_supervised(&remains.session));
    let mut found = Vec::new();
    if !alive.is_empty() {
        found.push(format!("{} running with {}", alive.len(), sum(&alive)));
    }
    if !dead.is_empty() {
        found.push(format!("{} that were not ended, with {}", dead.len(), sum(&dead)));
    }
    if !others.is_empty() {
        found.push(format!("{} of other users with {}", others.len(), sum(&others)));
    }
    let found = if found.is_empty() { "none".to_owned() } else { found.join(", ") };
    if dead.is_empty() {
        return Finding::good(found);
    }
    Finding::costs(found, "the memory is not free for others", "the next `cohabit play` cleans up; it needs no help")
}

fn is_supervised(name: &str) -> bool {
    Session::new(name).is_ok_and(|session| session.is_supervised())
}

/// Whether there is memory for a session's processes.
pub fn memory(machine: &Machine) -> Finding {
    let info = machine.read("proc/meminfo");
    let bytes = |key: &str| -> Option<u64> {
        let line = info.lines().find_map(|line| line.strip_prefix(key))?;
        Some(line.trim_start_matches(':').split_whitespace().next()?.parse::<u64>().ok()? << 10)
    };
    let (Some(all), Some(free)) = (bytes("MemTotal"), bytes("MemAvailable")) else {
        return Finding::good("the kernel does not say");
    };
    let found = format!("{} of {} available", size(free), size(all));
    if free >= SESSION_MEMORY {
        return Finding::good(found);
    }
    let costs = format!("a session takes {}: others are swapped out, or processes are ended", size(SESSION_MEMORY));
    Finding::costs(found, costs, "end what is not needed")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::doctor::finding::State;

    #[test]
    fn free_memory_is_judged_by_what_sessions_take() {
        for (free, is_tmpfs, state) in [
            (0, true, State::Broken),
            (SESSION_BYTES - 1, true, State::Broken),
            (SESSION_BYTES, true, State::Costs),
            (LARGE_SESSION_BYTES, true, State::Good),
            (LARGE_SESSION_BYTES, false, State::Costs),
        ] {
            assert_eq!(judge(String::new(), free, is_tmpfs).state, state, "{free} {is_tmpfs}");
        }
    }
}
