//! Receives what makes sense. Who sends nonsense is cut off: nothing of it is heard any more, and everybody else is.

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
    cut_off: Vec<u64>,
    news: Vec<Nonsense>,
    /// Whether it was said that some cannot even be told apart.
    warned: bool,
}

/// Somebody who was cut off, and why.
#[derive(Clone, Debug, Eq, PartialEq, thiserror::Error)]
#[error("process {process} sent nonsense on topic `{topic}` ({reason}); it is not heard there any more")]
pub struct Nonsense {
    /// Where.
    pub topic: Topic,
    /// Who.
    pub process: u32,
    /// What is wrong with it.
    pub reason: String,
}

/// More than so many were never met; a peer that reopens its publisher for each message must not fill the memory.
const MOST_CUT_OFF: usize = 256;

impl Inbox {
    /// Subscribes to a topic.
    ///
    /// # Errors
    /// [`BusError::Open`].
    pub fn new(bus: &dyn Transport, topic: Topic) -> Result<Self, BusError> {
        Ok(Self { topic, samples: bus.subscriber(topic)?, cut_off: Vec::new(), news: Vec::new(), warned: false })
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
            if self.cut_off.contains(&run) {
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

    /// Hears nothing more of a publisher.
    pub fn cut_off(&mut self, run: u64, reason: &str) {
        let nonsense = Nonsense { topic: self.topic, process: process_of(run), reason: reason.to_owned() };
        tracing::warn!("{nonsense}");
        if self.cut_off.len() < MOST_CUT_OFF {
            self.cut_off.push(run);
        }
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
