//! Receives what makes sense. Who sends nonsense is cut off, and everybody else is heard.
//!
//! Whoever was cut off is heard again after a pause, which doubles each time that it sends nonsense once more: a memory
//! that was spoilt for a moment costs no more than that, and one that is spoilt for good costs next to nothing.

use std::time::{Duration, Instant};

use crate::{
    error::BusError,
    message::Malformed,
    topic::Topic,
    transport::{Sample, Subscriber, Transport, process_of},
};

/// A subscriber that survives whatever its publishers send.
pub struct Inbox {
    topic: Topic,
    samples: Box<dyn Subscriber>,
    cut_off: Vec<CutOff>,
    pauses: Pauses,
    news: Vec<Nonsense>,
    /// Whether it was said that some cannot even be told apart.
    warned: bool,
}

/// Somebody who was cut off, and why.
#[derive(Clone, Debug, Eq, PartialEq, thiserror::Error)]
#[error("process {process} sent nonsense on topic `{topic}` ({reason}); it is not heard there for {} s", .pause.as_secs_f32())]
pub struct Nonsense {
    /// Where.
    pub topic: Topic,
    /// Who.
    pub process: u32,
    /// What is wrong with it.
    pub reason: String,
    /// For how long it is not heard.
    pub pause: Duration,
}

/// A publisher that was cut off.
struct CutOff {
    run: u64,
    pause: Duration,
    until: Instant,
}

/// For how long a publisher is not heard that sent nonsense.
#[derive(Clone, Copy, Debug)]
pub struct Pauses {
    /// The first time: long enough for whoever writes over a memory by mistake to have done so.
    pub first: Duration,
    /// The longest: so often a minute somebody who only sends nonsense costs the reading of one message, and a warning.
    pub longest: Duration,
}

impl Default for Pauses {
    fn default() -> Self {
        Self { first: Duration::from_secs(1), longest: Duration::from_secs(60) }
    }
}

/// More than so many were never met; a peer that reopens its publisher for each message must not fill the memory.
const MOST_CUT_OFF: usize = 256;

impl Inbox {
    /// Subscribes to a topic.
    ///
    /// # Errors
    /// [`BusError::Open`].
    pub fn new(bus: &dyn Transport, topic: Topic) -> Result<Self, BusError> {
        Self::with_pauses(bus, topic, Pauses::default())
    }

    /// The same, with other pauses for those who send nonsense.
    ///
    /// # Errors
    /// [`BusError::Open`].
    pub fn with_pauses(bus: &dyn Transport, topic: Topic, pauses: Pauses) -> Result<Self, BusError> {
        let samples = bus.subscriber(topic)?;
        Ok(Self { topic, samples, cut_off: Vec::new(), pauses, news: Vec::new(), warned: false })
    }

    /// The next sample that `read` makes sense of, and what it makes of it, if one is there.
    ///
    /// # Errors
    /// [`BusError::Receive`].
    pub fn next<T>(&mut self, read: impl Fn(&Sample) -> Result<T, Malformed>) -> Result<Option<(Sample, T)>, BusError> {
        loop {
            let sample = match self.samples.receive() {
                Ok(Some(sample)) => sample,
                Ok(None) => return Ok(None),
                // Its envelope cannot be trusted to say who sent it.
                Err(error @ (BusError::Version { .. } | BusError::Malformed { .. })) => {
                    if !std::mem::replace(&mut self.warned, true) {
                        tracing::warn!("{error}; such messages are not heard");
                    }
                    continue;
                }
                Err(error) => return Err(error),
            };
            let run = sample.envelope().run;
            if self.is_cut_off(run) {
                continue;
            }
            match read(&sample) {
                Ok(message) => return Ok(Some((sample, message))),
                Err(Malformed(reason)) => self.cut_off(run, reason),
            }
        }
    }

    /// The newest sample that `read` makes sense of, and what it makes of it, if one is there; older ones are dropped.
    ///
    /// # Errors
    /// [`BusError::Receive`].
    pub fn latest<T>(
        &mut self,
        read: impl Fn(&Sample) -> Result<T, Malformed>,
    ) -> Result<Option<(Sample, T)>, BusError> {
        let mut newest = None;
        while let Some(found) = self.next(&read)? {
            newest = Some(found);
        }
        Ok(newest)
    }

    fn is_cut_off(&self, run: u64) -> bool {
        self.cut_off.iter().any(|one| one.run == run && Instant::now() < one.until)
    }

    /// Hears nothing of a publisher for a while.
    fn cut_off(&mut self, run: u64, reason: &str) {
        let known = self.cut_off.iter().position(|one| one.run == run).map(|at| self.cut_off.remove(at));
        // Who made sense for long begins anew.
        let known = known.filter(|one| one.until.elapsed() < self.pauses.longest);
        let pause = known.map_or(self.pauses.first, |one| (one.pause * 2).min(self.pauses.longest));
        let nonsense = Nonsense { topic: self.topic, process: process_of(run), reason: reason.to_owned(), pause };
        tracing::warn!("{nonsense}");
        if self.cut_off.len() >= MOST_CUT_OFF {
            self.cut_off.remove(0);
        }
        self.cut_off.push(CutOff { run, pause, until: Instant::now() + pause });
        if self.news.len() < MOST_CUT_OFF {
            self.news.push(nonsense);
        }
    }

    /// Who was cut off since this was last asked.
    pub fn newly_cut_off(&mut self) -> impl Iterator<Item = Nonsense> + '_ {
        self.news.drain(..)
    }

    /// As [`Subscriber::lost`].
    #[must_use]
    pub fn lost(&self) -> u64 {
        self.samples.lost()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::{Local, Publisher};

    const NEVER: Duration = Duration::from_secs(3600);

    /// An inbox, and two publishers of its topic.
    fn at(first: Duration) -> (Inbox, [Box<dyn Publisher>; 2]) {
        let bus = Local::new(1);
        let pauses = Pauses { first, longest: first.saturating_mul(4) };
        let inbox = Inbox::with_pauses(&bus, Topic::Events, pauses).unwrap();
        (inbox, [(); 2].map(|()| bus.publisher(Topic::Events).unwrap()))
    }

    fn send(publisher: &mut dyn Publisher, byte: u8) {
        publisher.send(0, 1, &mut |bytes| bytes.fill(byte)).unwrap();
    }

    /// All that is heard; 0 is nonsense.
    fn heard(inbox: &mut Inbox) -> Vec<u8> {
        let read = |sample: &Sample| {
            let byte = sample.payload()[0];
            if byte == 0 { Err(Malformed("zero")) } else { Ok(byte) }
        };
        std::iter::from_fn(|| Some(inbox.next(read).unwrap()?.1)).collect()
    }

    #[test]
    fn who_sends_nonsense_is_cut_off_alone() {
        let (mut inbox, [mut one, mut two]) = at(NEVER);
        for byte in [1, 0, 2] {
            send(&mut *one, byte);
            send(&mut *two, byte + 10);
        }
        assert_eq!(heard(&mut inbox), [1, 11, 10, 12]);
        assert_eq!(inbox.newly_cut_off().count(), 1);
    }

    #[test]
    fn who_was_cut_off_is_heard_again() {
        let (mut inbox, [mut one, _]) = at(Duration::ZERO);
        for byte in [1, 0, 0, 2, 0, 3] {
            send(&mut *one, byte);
        }
        assert_eq!(heard(&mut inbox), [1, 2, 3]);
    }

    #[test]
    fn each_pause_is_twice_the_one_before_up_to_the_longest() {
        let (mut inbox, _) = at(Duration::from_secs(1));
        (0..5).for_each(|_| inbox.cut_off(7, "zero"));
        let pauses: Vec<_> = inbox.newly_cut_off().map(|nonsense| nonsense.pause.as_secs()).collect();
        assert_eq!(pauses, [1, 2, 4, 4, 4]);
        assert_eq!(inbox.cut_off.len(), 1);
        (0..2 * MOST_CUT_OFF as u64).for_each(|run| inbox.cut_off(run, "zero"));
        assert_eq!(inbox.cut_off.len(), MOST_CUT_OFF);
    }
}
