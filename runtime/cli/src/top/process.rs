//! What a process uses of the machine.

use std::fs;

/// Of a processor core and of memory.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Usage {
    /// Share of one core since the last look; none at the first.
    pub core: Option<f64>,
    /// Memory that is its own or shared and touched, bytes.
    pub resident_bytes: u64,
    last: Option<(u64, f64)>,
}

impl Usage {
    /// Looks at a process now; one that is gone uses nothing.
    pub fn look(&mut self, process: u32, now_nanos: u64) {
        let stat = fs::read_to_string(format!("/proc/{process}/stat")).unwrap_or_default();
        let used_s = used_s(&stat);
        self.core = self.last.zip(used_s).map(|((then, before), used)| {
            let elapsed_s = now_nanos.saturating_sub(then) as f64 * 1e-9;
            (used - before) / elapsed_s.max(1e-3)
        });
        self.last = used_s.map(|used| (now_nanos, used));
        let statm = fs::read_to_string(format!("/proc/{process}/statm")).unwrap_or_default();
        let pages: Option<u64> = statm.split(' ').nth(1).and_then(|pages| pages.parse().ok());
        self.resident_bytes = pages.unwrap_or(0) * rustix::param::page_size() as u64;
    }
}

/// Processor time of a process, s, by its line in `/proc`: the 14th and 15th field, after a name that may hold anything.
fn used_s(stat: &str) -> Option<f64> {
    let (_, fields) = stat.rsplit_once(") ")?;
    let mut fields = fields.split(' ').skip(11);
    let mut ticks = || fields.next()?.parse::<f64>().ok();
    Some((ticks()? + ticks()?) / rustix::param::clock_ticks_per_second() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_process_has_used_time_and_memory() {
        let mut usage = Usage::default();
        usage.look(std::process::id(), 1);
        assert!(usage.core.is_none() && usage.resident_bytes > 1 << 20);
        usage.look(std::process::id(), 1_000_000_000);
        assert!(usage.core.is_some_and(|core| core >= 0.0));
        assert_eq!(used_s("7 (a) b) S 1 1 1 0 -1 4 5 0 0 0 100 50 0 0"), Some(1.5));
        usage.look(u32::MAX, 2_000_000_000);
        assert_eq!((usage.core, usage.resident_bytes), (None, 0));
    }
}
