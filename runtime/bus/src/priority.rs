//! Who goes first where threads compete for the machine.

use std::ptr::from_ref;

use rustix::process::{getpriority_process, setpriority_process};

/// How much less urgent than the tick all that only shows it is, in steps of niceness.
const LESS_URGENT: i32 = 10;
/// The shortest turn at a core that can be asked for, ns. Who asks for short ones is served before those with long ones
/// as soon as it wakes: see sched_setattr(2).
const SHORT_TURN_NANOS: u64 = 100_000;
/// The lowest priority of real time: before all that has none, and behind whatever else has one.
const REAL_TIME_PRIORITY: i32 = 1;

/// How soon a thread that has a deadline is served when it wakes.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Urgency {
    /// At once: whatever else runs gives way.
    RealTime,
    /// Before those that have had longer turns.
    ShortTurns,
    /// In its turn.
    Usual,
}

/// Has this thread served as soon as this machine grants when it wakes: for one that has a deadline, and does little.
/// Threads that it starts are like any others.
pub fn go_first() -> Urgency {
    let real_time = || schedule(libc::SCHED_FIFO, 0, REAL_TIME_PRIORITY, 0);
    let short_turns = || schedule(libc::SCHED_OTHER, getpriority_process(None).ok()?, 0, SHORT_TURN_NANOS);
    if real_time().is_some() {
        Urgency::RealTime
    } else if short_turns().is_some() {
        Urgency::ShortTurns
    } else {
        Urgency::Usual
    }
}

/// Schedules this thread so; `None` where that is not granted.
fn schedule(policy: i32, nice: i32, priority: i32, runtime_nanos: u64) -> Option<()> {
    let asked = libc::sched_attr {
        size: size_of::<libc::sched_attr>() as u32,
        sched_policy: policy as u32,
        sched_flags: libc::SCHED_FLAG_RESET_ON_FORK as u64,
        sched_nice: nice,
        sched_priority: priority as u32,
        sched_runtime: runtime_nanos,
        sched_deadline: 0,
        sched_period: 0,
    };
    // SAFETY: the kernel reads `size` bytes of `asked`, of which there are as many, and keeps none of them.
    let refused = unsafe { libc::syscall(libc::SYS_sched_setattr, 0, from_ref(&asked), 0) };
    (refused == 0).then_some(())
}

/// Has this thread, and those that it starts, give way to the tick and whatever else has a deadline. Where the machine
/// does not grant even that, nothing changes.
pub fn give_way() {
    // Of this thread alone: on Linux each has a priority of its own.
    let _ = setpriority_process(None, LESS_URGENT);
}
