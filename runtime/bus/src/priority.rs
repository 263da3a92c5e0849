//! Who goes first where threads compete for the machine.

use std::ptr::from_ref;

use rustix::process::{getpriority_process, setpriority_process};

/// How much less urgent than the tick all that only shows it is, in steps of niceness.
const LESS_URGENT: i32 = 10;
/// The shortest turn at a core that can be asked for, ns. Who asks for short ones is served before those with long ones
/// as soon as it wakes: see sched_setattr(2).
const SHORT_TURN_NANOS: u64 = 100_000;

/// Has this thread served at once when it wakes: for one that has a deadline, and does little. Where the machine cannot
/// do that, nothing changes. Threads that it starts are like any others.
pub fn go_first() {
    let Ok(nice) = getpriority_process(None) else { return };
    let asked = libc::sched_attr {
        size: size_of::<libc::sched_attr>() as u32,
        sched_policy: libc::SCHED_OTHER as u32,
        sched_flags: libc::SCHED_FLAG_RESET_ON_FORK as u64,
        sched_nice: nice,
        sched_priority: 0,
        sched_runtime: SHORT_TURN_NANOS,
        sched_deadline: 0,
        sched_period: 0,
    };
    // SAFETY: the kernel reads `size` bytes of `asked`, of which there are as many, and keeps none of them.
    let _ = unsafe { libc::syscall(libc::SYS_sched_setattr, 0, from_ref(&asked), 0) };
}

/// Has this thread, and those that it starts, give way to the tick and whatever else has a deadline. Where the machine
/// does not grant even that, nothing changes.
pub fn give_way() {
    // Of this thread alone: on Linux each has a priority of its own.
    let _ = setpriority_process(None, LESS_URGENT);
}
