//! The ports of sessions' pages, where other machines have to know them beforehand.

use std::{
    collections::BTreeSet,
    fmt,
    net::{IpAddr, TcpListener},
    ops::RangeInclusive,
    str::FromStr,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

/// Ports one after the other, such as `8701-8708`.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct PortRange(RangeInclusive<u16>);

impl FromStr for PortRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let read = || {
            let (first, last) = text.split_once('-')?;
            let range: RangeInclusive<u16> = first.trim().parse().ok()?..=last.trim().parse().ok()?;
            (*range.start() > 0 && !range.is_empty()).then_some(Self(range))
        };
        read().ok_or_else(|| format!("`{text}` are no ports: write the first and the last, such as `8701-8708`"))
    }
}

impl fmt::Display for PortRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}-{}", self.0.start(), self.0.end())
    }
}

impl PortRange {
    /// How many they are.
    pub fn count(&self) -> usize {
        self.0.len()
    }
}

/// Ports of which each is one session's at a time.
pub struct Ports {
    all: PortRange,
    taken: Arc<Mutex<BTreeSet<u16>>>,
}

/// A port that is a session's own until this is dropped.
pub struct Taken {
    number: u16,
    taken: Arc<Mutex<BTreeSet<u16>>>,
}

impl Ports {
    /// All of these, and none taken.
    pub fn new(all: PortRange) -> Self {
        Self { all, taken: Arc::default() }
    }

    /// The first that is free at an address, where no other program may listen either.
    ///
    /// # Errors
    /// When none is free, in words.
    pub fn take(&self, listen: IpAddr) -> Result<Taken, String> {
        let mut taken = lock(&self.taken);
        let is_free = |port: &u16| !taken.contains(port) && TcpListener::bind((listen, *port)).is_ok();
        let number =
            self.all.0.clone().find(is_free).ok_or_else(|| format!("none of the ports {} is free", self.all))?;
        taken.insert(number);
        Ok(Taken { number, taken: Arc::clone(&self.taken) })
    }
}

impl Taken {
    /// Which.
    pub const fn number(&self) -> u16 {
        self.number
    }
}

impl Drop for Taken {
    fn drop(&mut self) {
        lock(&self.taken).remove(&self.number);
    }
}

/// A set that is whole whatever a panic left of it.
fn lock(taken: &Mutex<BTreeSet<u16>>) -> MutexGuard<'_, BTreeSet<u16>> {
    taken.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ports_read_as_they_are_written() {
        let read = |text: &str| text.parse::<PortRange>().map(|range| (range.to_string(), range.count())).ok();
        assert_eq!(read("8701-8708"), Some(("8701-8708".to_owned(), 8)));
        assert_eq!(read("80-80"), Some(("80-80".to_owned(), 1)));
        for wrong in ["", "8701", "8708-8701", "0-5", "1-70000", "a-b"] {
            assert_eq!(read(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn a_port_is_one_sessions_until_it_ends() {
        let here = IpAddr::from([127, 0, 0, 1]);
        // Two that are free now, as the system finds them.
        let other = TcpListener::bind((here, 0)).expect("a port");
        let number = other.local_addr().expect("its address").port();
        let ports = Ports::new(PortRange(number..=number));
        assert!(ports.take(here).is_err_and(|problem| problem.contains("is free")), "another program has it");
        drop(other);
        let taken = ports.take(here).expect("a free port");
        assert_eq!(taken.number(), number);
        assert!(ports.take(here).is_err());
        drop(taken);
        assert!(ports.take(here).is_ok());
    }
}
