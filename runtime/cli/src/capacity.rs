//! How many sessions this machine carries: measured by playing one, two and more of them at a time, each with one page.

mod child;
mod noted;
mod processes;
mod ticks;
mod trial;

use std::{
    fmt,
    str::FromStr,
    sync::atomic::{AtomicBool, Ordering},
};

use cohabit_host::Capacity;

pub use child::ChildSession;
pub use noted::{known, note};
pub use processes::{ThisMachine, cores, used_by};
pub use trial::{Trial, measure};

/// How long sessions are watched for an estimate by one of them, s: as long as a robot takes to turn and to say so.
const QUICK_S: f64 = 4.0;
/// The same for each number of sessions of a whole measure, s.
pub const WHOLE_S: f64 = 10.0;
/// More sessions at a time are not tried: the ports of a study are named one by one.
pub const MOST_TRIED: u16 = 64;
/// Where it cannot be measured, so many cores are taken for a session.
const CORES_EACH: usize = 2;

/// How many sessions are played at a time.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum SessionCount {
    /// So many.
    Count(u16),
    /// As many as the machine carries by what one takes.
    Quick,
    /// As many as it was seen to carry.
    Full,
}

impl FromStr for SessionCount {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "quick" => Ok(Self::Quick),
            "full" => Ok(Self::Full),
            text => match text.parse() {
                Ok(count) if count > 0 => Ok(Self::Count(count)),
                _ => Err("write a number from 1 on, `quick` or `full`".to_owned()),
            },
        }
    }
}

impl fmt::Display for SessionCount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Count(count) => write!(f, "{count}"),
            Self::Quick => f.write_str("quick"),
            Self::Full => f.write_str("full"),
        }
    }
}

impl SessionCount {
    /// How many that are, at least one. What was measured before by this program counts; otherwise it is measured now, and noted.
    pub fn find(self, stop: &AtomicBool) -> usize {
        let is_quick = match self {
            Self::Count(count) => return usize::from(count),
            Self::Quick => true,
            Self::Full => false,
        };
        let noted = known().filter(|known| is_quick || !known.is_estimate);
        let found = noted.map_or_else(|| measured_now(is_quick, stop), Ok);
        match found {
            Ok(capacity) => {
                println!("{capacity}; `cohabit host --measure` measures it anew");
                capacity.fits().max(1)
            }
            Err(_) if stop.load(Ordering::Relaxed) => 1,
            Err(error) => {
                let count = (cores() / CORES_EACH).max(1);
                eprintln!(
                    "cohabit: how many sessions fit cannot be measured ({error:#}); taking {count}, one for two cores"
                );
                count
            }
        }
    }
}

fn measured_now(is_quick: bool, stop: &AtomicBool) -> anyhow::Result<Capacity> {
    let trial = if is_quick {
        println!("Measuring what a session takes on this machine: some seconds");
        Trial { most: 1, seconds: QUICK_S, ..Trial::default() }
    } else {
        println!("Measuring how many sessions this machine carries: a quarter of a minute for each");
        Trial { most: usize::from(MOST_TRIED), seconds: WHOLE_S, ..Trial::default() }
    };
    let capacity = measure(&trial, stop, &mut |_| {})?;
    note(&capacity);
    Ok(capacity)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_read_as_they_are_written() {
        for (text, count) in
            [("4", SessionCount::Count(4)), ("quick", SessionCount::Quick), ("full", SessionCount::Full)]
        {
            assert_eq!((text.parse::<SessionCount>(), count.to_string().as_str()), (Ok(count), text));
        }
        for wrong in ["0", "-1", "", "many", "70000"] {
            assert!(wrong.parse::<SessionCount>().is_err(), "{wrong}");
        }
        assert_eq!(SessionCount::Count(7).find(&AtomicBool::new(false)), 7, "nothing is measured");
    }
}
