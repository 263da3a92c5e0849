//! Whether one more session may begin, by how busy the machine is and by how those go that are played.

use std::fmt;

use crate::capacity::MOST_MISSED;

/// The share of cores that may be busy with one session more: what is left is for moments that take more.
const MOST_BUSY: f64 = 0.9;

/// How busy a machine is, as it was measured lately.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Load {
    /// Cores that sessions may use.
    pub cores: f64,
    /// How many of them are busy, with sessions or with anything else.
    pub busy_cores: f64,
    /// Memory that is free, bytes.
    pub free_bytes: u64,
}

/// What a session takes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Needs {
    /// Cores that it keeps busy.
    pub cores: f64,
    /// Memory, bytes.
    pub memory_bytes: u64,
}

/// A session that is played, or about to be.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Running {
    /// Whether it has been played long enough that it is known what it takes.
    pub is_settled: bool,
    /// The share of its ticks that it missed lately.
    pub missed: f64,
    /// Cores that it kept busy lately, if that was measured.
    pub cores: Option<f64>,
}

/// Why no session is admitted now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Wait {
    /// Others have waited longer.
    Turn,
    /// One has just begun, and what it takes is not known yet.
    Settling,
    /// One misses more ticks than may be: this share of them.
    Missed(f64),
    /// So many cores are busy, of which there are so many; a session takes so many more.
    Busy {
        /// Busy ones.
        busy: f64,
        /// All.
        cores: f64,
        /// What it takes.
        needed: f64,
    },
    /// So much memory is free, and a session takes so much.
    Memory {
        /// Free, bytes.
        free: u64,
        /// What it takes, bytes.
        needed: u64,
    },
}

/// Admits one session more, which takes what is expected of one, or as much as any that is played.
///
/// The first one is admitted however busy the machine is: what it takes then shows.
///
/// # Errors
/// What has to change first.
pub fn admit(load: &Load, expected: Needs, running: &[Running]) -> Result<(), Wait> {
    if running.iter().any(|one| !one.is_settled) {
        return Err(Wait::Settling);
    }
    if load.free_bytes < expected.memory_bytes {
        return Err(Wait::Memory { free: load.free_bytes, needed: expected.memory_bytes });
    }
    if running.is_empty() {
        return Ok(());
    }
    let missed = running.iter().map(|one| one.missed).fold(0.0, f64::max);
    if missed > MOST_MISSED {
        return Err(Wait::Missed(missed));
    }
    let needed = running.iter().filter_map(|one| one.cores).fold(expected.cores, f64::max);
    // One whose page nobody has opened yet takes little, and will take as much as others.
    let taken: f64 = running.iter().map(|one| one.cores.unwrap_or_default().max(expected.cores)).sum();
    let busy = load.busy_cores.max(taken);
    if busy + needed > MOST_BUSY * load.cores {
        return Err(Wait::Busy { busy, cores: load.cores, needed });
    }
    Ok(())
}

impl fmt::Display for Wait {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Turn => write!(f, "others have waited longer"),
            Self::Settling => write!(f, "another one has just begun"),
            Self::Missed(share) => {
                write!(f, "a session misses {:.1} % of its ticks; {:.1} % may be", 100.0 * share, 100.0 * MOST_MISSED)
            }
            Self::Busy { busy, cores, needed } => {
                write!(f, "{busy:.1} of {cores:.0} cores are busy, and a session takes {needed:.1}")
            }
            Self::Memory { free, needed } => {
                write!(f, "{} MB of memory are free, and a session takes {}", free >> 20, needed >> 20)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NEEDS: Needs = Needs { cores: 0.5, memory_bytes: 256 << 20 };

    fn load(busy_cores: f64) -> Load {
        Load { cores: 2.0, busy_cores, free_bytes: 1 << 30 }
    }

    fn running(cores: f64, missed: f64) -> Running {
        Running { is_settled: true, missed, cores: Some(cores) }
    }

    #[test]
    fn sessions_are_admitted_until_the_cores_are_busy() {
        for (busy, expected) in [(0.4, true), (1.29, true), (1.31, false), (2.0, false)] {
            assert_eq!(admit(&load(busy), NEEDS, &[running(0.3, 0.0)]).is_ok(), expected, "{busy}");
        }
        let busy = admit(&load(1.0), NEEDS, &[running(0.75, 0.0), running(0.25, 0.0)]);
        let expected = Err(Wait::Busy { busy: 1.25, cores: 2.0, needed: 0.75 });
        assert_eq!(busy, expected, "the next may take as much, and who takes little now may take more");
    }

    #[test]
    fn the_first_is_admitted_however_busy_others_keep_the_machine() {
        assert_eq!(admit(&load(2.0), NEEDS, &[]), Ok(()));
        let full = Load { free_bytes: 1 << 20, ..load(0.0) };
        assert_eq!(admit(&full, NEEDS, &[]), Err(Wait::Memory { free: 1 << 20, needed: 256 << 20 }));
    }

    #[test]
    fn nobody_comes_before_it_is_known_how_the_others_go() {
        let new = Running::default();
        assert_eq!(admit(&load(0.1), NEEDS, &[running(0.1, 0.0), new]), Err(Wait::Settling));
        for (missed, expected) in [(MOST_MISSED, Ok(())), (0.02, Err(Wait::Missed(0.02)))] {
            assert_eq!(admit(&load(0.1), NEEDS, &[running(0.1, 0.0), running(0.1, missed)]), expected);
        }
    }

    #[test]
    fn who_waits_reads_why() {
        for (wait, text) in [
            (Wait::Missed(0.021), "a session misses 2.1 % of its ticks; 0.5 % may be"),
            (Wait::Busy { busy: 1.72, cores: 2.0, needed: 0.4 }, "1.7 of 2 cores are busy, and a session takes 0.4"),
            (Wait::Memory { free: 9 << 20, needed: 256 << 20 }, "9 MB of memory are free, and a session takes 256"),
        ] {
            assert_eq!(wait.to_string(), text);
        }
    }
}
