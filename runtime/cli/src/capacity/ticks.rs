//! Whether the ticks of a session begin in time, as its bus tells.

use std::collections::VecDeque;

use cohabit_bus::{BusError, Inbox, Sample, Session, Shm, Topic, message::TickView, monotonic_nanos};
use cohabit_world::DT_NANOS;

/// How far back ticks are kept, ns: further than anybody measures in one go.
const REACH_NANOS: u64 = 660_000_000_000;

/// Ticks that began, and those of them that began a whole tick too late.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Ticked {
    /// All.
    pub ticks: u64,
    /// Those that began too late.
    pub late: u64,
}

/// Watches the ticks of a session.
pub struct TickWatch {
    inbox: Inbox,
    /// When each was told, and whether it began too late.
    began: VecDeque<(u64, bool)>,
}

impl TickWatch {
    /// Joins a session that runs; nothing, if it cannot be joined yet.
    pub fn join(session: &str) -> Option<Self> {
        let session = Session::new(session).ok()?;
        let bus = Shm::join(&session).ok()?;
        Some(Self { inbox: Inbox::new(&bus, Topic::Ticks).ok()?, began: VecDeque::new() })
    }

    /// Takes in what was told since it was last asked: topics keep ticks for half a minute.
    pub fn take_in(&mut self) -> Result<(), BusError> {
        let late = |sample: &Sample| Ok(TickView::new(sample.payload())?.header.late_nanos >= DT_NANOS);
        while let Some((sample, is_late)) = self.inbox.next(late)? {
            self.began.push_back((sample.envelope().sent_nanos, is_late));
        }
        let now = monotonic_nanos();
        while self.began.front().is_some_and(|(sent, _)| now.saturating_sub(*sent) >= REACH_NANOS) {
            self.began.pop_front();
        }
        Ok(())
    }

    /// What was told since a moment.
    pub fn since(&self, nanos: u64) -> Ticked {
        count(self.began.iter().rev().copied(), nanos)
    }
}

/// What was told since a moment, of what was told, the newest first.
fn count(told: impl Iterator<Item = (u64, bool)>, since: u64) -> Ticked {
    told.take_while(|(sent, _)| *sent >= since).fold(Ticked::default(), |sum, (_, is_late)| Ticked {
        ticks: sum.ticks + 1,
        late: sum.late + u64::from(is_late),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_count_from_a_moment_on() {
        let told = [(9, false), (6, true), (5, false), (1, true)];
        assert_eq!(count(told.into_iter(), 5), Ticked { ticks: 3, late: 1 });
        assert_eq!(count(told.into_iter(), 10), Ticked::default());
    }
}
