//! What processes use of the machine, and how busy it is, as the kernel tells.

use std::{collections::BTreeSet, fs, thread};

use cohabit_host::{Gauge, Load};

/// What a process and all below it have used.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Used {
    /// Processor time since they began, s; that of those among them that have ended, too.
    pub processor_s: f64,
    /// Memory that they take now, bytes, if it was asked for: what several share counts by parts.
    pub memory_bytes: u64,
}

/// What a process and all below it have used; memory only if it is asked for, as it takes the kernel some milliseconds to sum up.
pub fn used_by(root: u32, with_memory: bool) -> Used {
    let own = family(root);
    let ticks: u64 = own.iter().filter_map(|process| used_ticks(&read(*process, "stat"))).sum();
    let memory_bytes = if with_memory { own.iter().map(|process| memory(*process)).sum() } else { 0 };
    Used { processor_s: ticks as f64 / rustix::param::clock_ticks_per_second() as f64, memory_bytes }
}

/// A process, and all below it.
fn family(root: u32) -> Vec<u32> {
    let mut all = vec![root];
    let mut at = 0;
    while let Some(process) = all.get(at).copied() {
        let new: Vec<u32> = children(process).into_iter().filter(|child| !all.contains(child)).collect();
        all.extend(new);
        at += 1;
    }
    all
}

/// The processes that a process has started.
fn children(process: u32) -> Vec<u32> {
    let threads = fs::read_dir(format!("/proc/{process}/task")).into_iter().flatten().flatten();
    let told: Vec<String> =
        threads.filter_map(|thread| fs::read_to_string(thread.path().join("children")).ok()).collect();
    told.iter().flat_map(|line| line.split_whitespace()).filter_map(|child| child.parse().ok()).collect()
}

/// A file of the kernel's about a process; nothing, if it is gone.
fn read(process: u32, file: &str) -> String {
    fs::read_to_string(format!("/proc/{process}/{file}")).unwrap_or_default()
}

/// Processor time of a process and of its children that have ended, in ticks of the kernel: the 14th to 17th field of its line, after a
/// name that may hold anything.
fn used_ticks(stat: &str) -> Option<u64> {
    let (_, fields) = stat.rsplit_once(") ")?;
    let fields: Vec<u64> = fields.split(' ').skip(11).take(4).map_while(|field| field.parse().ok()).collect();
    (fields.len() == 4).then(|| fields.iter().sum())
}

/// Memory of a process, bytes: its part of what it shares, where the kernel tells that, or else all that it can reach.
fn memory(process: u32) -> u64 {
    let parts = kilobytes(&read(process, "smaps_rollup"), "Pss:");
    parts.or_else(|| kilobytes(&read(process, "status"), "VmRSS:")).map_or(0, |kilobytes| kilobytes << 10)
}

/// The number of a line such as `Pss:   1234 kB`.
fn kilobytes(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    line.split_whitespace().next()?.parse().ok()
}

/// How many cores this program may use.
pub fn cores() -> usize {
    thread::available_parallelism().map_or(1, usize::from)
}

/// Memory that is free for new processes, bytes: of the machine, and of the control group that this program is limited to, if it is.
pub fn free_bytes() -> u64 {
    let machine = fs::read_to_string("/proc/meminfo").unwrap_or_default();
    let machine = kilobytes(&machine, "MemAvailable:").map_or(u64::MAX, |kilobytes| kilobytes << 10);
    let group =
        |file: &str| fs::read_to_string(format!("/sys/fs/cgroup/memory.{file}")).ok()?.trim().parse::<u64>().ok();
    let group = group("max").zip(group("current")).map_or(u64::MAX, |(most, used)| most.saturating_sub(used));
    machine.min(group)
}

/// How busy the cores are that this program may use.
pub struct ThisMachine {
    allowed: BTreeSet<usize>,
    /// Time that they were busy, and all time, when it was last looked.
    last: Option<(u64, u64)>,
}

impl ThisMachine {
    /// Looks for the first time.
    pub fn new() -> Self {
        let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
        let mut machine = Self { allowed: allowed(&status), last: None };
        machine.busy_share();
        machine
    }

    /// The share of time that they were busy since it was last looked; none, if the kernel does not say.
    fn busy_share(&mut self) -> Option<f64> {
        let stat = fs::read_to_string("/proc/stat").unwrap_or_default();
        let now = times(&stat, &self.allowed);
        let before = self.last.replace(now)?;
        let (busy, all) = (now.0.saturating_sub(before.0), now.1.saturating_sub(before.1));
        (all > 0).then(|| busy as f64 / all as f64)
    }
}

impl Gauge for ThisMachine {
    fn load(&mut self) -> Load {
        let cores = cores() as f64;
        let busy_cores = self.busy_share().map_or(0.0, |share| share * cores);
        Load { cores, busy_cores, free_bytes: free_bytes() }
    }
}

/// The cores that a process may use, by their numbers, such as `0-3,8` in its status.
fn allowed(status: &str) -> BTreeSet<usize> {
    let line = status.lines().find_map(|line| line.strip_prefix("Cpus_allowed_list:")).unwrap_or_default();
    let range = |part: &str| {
        let (first, last) = part.split_once('-').unwrap_or((part, part));
        Some(first.parse::<usize>().ok()?..=last.parse::<usize>().ok()?)
    };
    line.trim().split(',').filter_map(range).flatten().collect()
}

/// Time that these cores were busy, and all time, in ticks of the kernel: idle is the fourth number of a core's line, waiting for a disk the
/// fifth, and what guests take counts already.
fn times(stat: &str, allowed: &BTreeSet<usize>) -> (u64, u64) {
    const COUNTED: usize = 8;
    let core = |line: &str| {
        let (name, times) = line.strip_prefix("cpu")?.split_once(' ')?;
        let is_meant = name.parse().is_ok_and(|number: usize| allowed.contains(&number));
        let times: Vec<u64> = times.split_whitespace().take(COUNTED).map_while(|time| time.parse().ok()).collect();
        let idle = times.get(3)? + times.get(4)?;
        let all: u64 = times.iter().sum();
        is_meant.then_some((all.saturating_sub(idle), all))
    };
    stat.lines().filter_map(core).fold((0, 0), |sum, (busy, all)| (sum.0 + busy, sum.1 + all))
}

#[cfg(test)]
mod tests {
    use std::process::{Command, Stdio};

    use super::*;

    #[test]
    fn a_family_uses_what_its_members_do() {
        let own = std::process::id();
        let mut child = Command::new("cat").stdin(Stdio::piped()).spawn().expect("a child");
        assert!(family(own).contains(&child.id()));
        let used = used_by(own, true);
        assert!(used.processor_s >= 0.0 && used.memory_bytes > 1 << 20, "{used:?}");
        assert_eq!(used_by(own, false).memory_bytes, 0);
        child.kill().expect("a child that lives");
        child.wait().expect("a child");
        assert_eq!(used_by(u32::MAX, true), Used::default());
    }

    #[test]
    fn time_of_children_that_have_ended_counts() {
        assert_eq!(used_ticks("7 (a) b) S 1 1 1 0 -1 4 5 0 0 0 100 50 30 20 0"), Some(200));
        assert_eq!(used_ticks(""), None);
    }

    #[test]
    fn only_cores_that_this_program_may_use_count() {
        assert_eq!(allowed("Cpus_allowed:\tf\nCpus_allowed_list:\t0-1,3\n"), BTreeSet::from([0, 1, 3]));
        let stat = "cpu  60 0 20 50 10 0 0 5 0 0\ncpu0 40 0 10 40 5 0 0 5 0 0\ncpu1 20 0 10 10 5 0 0 0 0 0\nctxt 99\n";
        assert_eq!(times(stat, &BTreeSet::from([0])), (55, 100));
        assert_eq!(times(stat, &BTreeSet::from([0, 1])), (85, 145));
        assert_eq!(times("", &BTreeSet::from([0])), (0, 0));
    }

    #[test]
    fn this_machine_has_cores_and_memory() {
        let load = ThisMachine::new().load();
        assert!(load.cores >= 1.0 && load.free_bytes > 0, "{load:?}");
        assert!((0.0..=load.cores).contains(&load.busy_cores), "{load:?}");
    }
}
