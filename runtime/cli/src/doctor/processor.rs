//! Cores, the processor's abilities, clocks and timers.

use std::{
    thread,
    time::{Duration, Instant},
};

use cohabit_bus::{Urgency, go_first, monotonic_nanos};

use super::{finding::Finding, machine::Machine};

/// Processes of a session that are busy at once: the simulator with its renderer, and the page's server.
const BUSY: usize = 2;
/// Clocks that are read without a call to the kernel.
const QUICK_CLOCKS: [&str; 6] =
    ["tsc", "kvm-clock", "hyperv_clocksource_tsc_page", "pvclock", "arch_sys_counter", "riscv_clocksource"];
/// How often a timer is tried.
const TRIES: usize = 60;
const NAP: Duration = Duration::from_millis(2);
/// Ticks that begin later than this are seen: it is an eighth of one.
const LATE: Duration = Duration::from_millis(2);

/// How many cores a session may use.
pub fn cores(machine: &Machine) -> Finding {
    let info = machine.read("proc/cpuinfo");
    let model = info.lines().find_map(|line| line.strip_prefix("model name")).unwrap_or(": of unknown kind");
    let model = model.trim_start_matches(['\t', ' ', ':']).to_owned();
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let found = format!("{cores} of {model}");
    if cores >= BUSY {
        return Finding::good(found);
    }
    Finding::costs(found, "simulator, renderer and page take turns: fewer frames, later answers", "")
}

/// Whether the renderer's quick paths can be taken.
pub fn vectors(_: &Machine) -> Finding {
    if cohabit_render::has_wide_vectors() {
        return Finding::good("AVX2");
    }
    Finding::costs("no AVX2", "the renderer on the CPU is slower; the pictures are the same", "")
}

/// Whether time can be read quickly.
pub fn clock(machine: &Machine) -> Finding {
    let name = machine.read("sys/devices/system/clocksource/clocksource0/current_clocksource");
    const READS: u32 = 1000;
    let began = Instant::now();
    let last = (0..READS).fold(0, |last, _| monotonic_nanos().max(last));
    let each = began.elapsed() / READS;
    let found = format!("{}, read in {} ns", if name.is_empty() { "unknown" } else { &name }, each.as_nanos());
    debug_assert!(last > 0);
    if name.is_empty() || QUICK_CLOCKS.contains(&name.as_str()) {
        return Finding::good(found);
    }
    Finding::costs(
        found,
        "each stamp is a call to the kernel, and latencies come out longer",
        "boot with clocksource=tsc",
    )
}

/// How late this process is woken.
pub fn timers(machine: &Machine) -> Finding {
    let slack: u64 = machine.read("proc/self/timerslack_ns").parse().unwrap_or(0);
    let mut late: Vec<Duration> = (0..TRIES)
        .map(|_| {
            let due = Instant::now() + NAP;
            thread::sleep(NAP);
            due.elapsed()
        })
        .collect();
    late.sort_unstable();
    let ms = |duration: Duration| duration.as_secs_f64() * 1e3;
    let (half, most) = (late[TRIES / 2], late[TRIES - 2]);
    let found = format!(
        "woken {:.2} ms late, {:.2} ms at worst of {TRIES} times; slack {} µs",
        ms(half),
        ms(most),
        slack / 1000
    );
    if most < LATE {
        return Finding::good(found);
    }
    let remedy = "end what else keeps the cores busy; on a laptop, choose the power profile `performance`";
    Finding::costs(found, "ticks begin late now and then: motion looks uneven, latencies scatter", remedy)
}

/// How soon a tick begins that is due while others keep the cores busy.
pub fn urgency(machine: &Machine) -> Finding {
    match machine.urgency {
        Urgency::RealTime => Finding::good("real time: ticks begin before whatever else runs"),
        Urgency::ShortTurns => no_real_time("none of real time; short turns at a core are granted"),
        Urgency::Usual => no_real_time("none"),
    }
}

fn no_real_time(found: &str) -> Finding {
    Finding::costs(
        found,
        "while the cores are busy, one tick of a hundred begins some ms late",
        "add `YOU - rtprio 1` (YOU is your user's name) to /etc/security/limits.d/cohabit.conf and log in again",
    )
}

/// What is granted to a thread of this program that asks for it.
pub fn granted() -> Urgency {
    thread::spawn(go_first).join().unwrap_or(Urgency::Usual)
}
