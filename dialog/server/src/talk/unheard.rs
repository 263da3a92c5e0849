//! What people said and no robot has heard yet. The language model thinks of the first of it ahead, on a snapshot, so that there is
//! less to do in its turn; the others wait, in their order.

use std::{
    collections::VecDeque,
    sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel},
    time::Duration,
};

use super::{Talk, Utterance, mailbox::Message};
use crate::{DialogError, conversation::Thought};

/// The most that waits.
const MOST_WAITING: usize = 32;
/// How often the thread that thinks sees whether it is to end.
const LOOKS_EVERY: Duration = Duration::from_millis(100);

/// What was not heard yet, the oldest first.
pub(super) struct Unheard {
    utterances: VecDeque<(u64, Utterance)>,
    count: u64,
    /// Whether something is thought of.
    is_thinking: bool,
    to: SyncSender<Considered>,
}

/// The thoughts of an utterance, with its number.
type Considered = (u64, Vec<Thought>);

/// What is to be thought of.
pub struct Thoughts(pub(super) Receiver<Considered>);

/// Nothing yet, and where is found what is to be thought of.
pub(super) fn unheard() -> (Unheard, Thoughts) {
    // One at a time.
    let (to, thoughts) = sync_channel(1);
    (Unheard { utterances: VecDeque::new(), count: 0, is_thinking: false, to }, Thoughts(thoughts))
}

impl Unheard {
    /// Takes one more; gives the oldest, if they are too many.
    pub fn push(&mut self, utterance: Utterance) -> Option<Utterance> {
        self.count += 1;
        self.utterances.push_back((self.count, utterance));
        if self.utterances.len() > MOST_WAITING { self.pop() } else { None }
    }

    /// The first, if it is its turn: if nothing is thought of.
    pub fn first(&self) -> Option<&Utterance> {
        let (_, first) = self.utterances.front().filter(|_| !self.is_thinking)?;
        Some(first)
    }

    /// Takes out the first.
    pub fn pop(&mut self) -> Option<Utterance> {
        self.utterances.pop_front().map(|(_, utterance)| utterance)
    }

    /// Has the first be thought of; `false`, if there is nothing to think of.
    pub fn consider(&mut self, thoughts: Vec<Thought>) -> bool {
        let Some((number, _)) = self.utterances.front().filter(|_| !thoughts.is_empty()) else { return false };
        self.is_thinking = self.to.try_send((*number, thoughts)).is_ok();
        self.is_thinking
    }

    /// The utterance of that number was thought of: it is given, unless it is over.
    pub fn considered(&mut self, number: u64) -> Option<Utterance> {
        self.is_thinking = false;
        let is_first = self.utterances.front().is_some_and(|(first, _)| *first == number);
        if is_first { self.pop() } else { None }
    }

    /// Takes out those that are over, in their order.
    pub fn take(&mut self, is_over: impl Fn(&Utterance) -> bool) -> Vec<Utterance> {
        let all = std::mem::take(&mut self.utterances);
        let (over, rest): (VecDeque<_>, VecDeque<_>) = all.into_iter().partition(|(_, utterance)| is_over(utterance));
        self.utterances = rest;
        over.into_iter().map(|(_, utterance)| utterance).collect()
    }
}

impl Talk {
    /// Thinks of what was said before it is heard, until `over`.
    pub fn think(&self, thoughts: Thoughts, over: &dyn Fn() -> bool) -> Result<(), DialogError> {
        while !over() {
            match thoughts.0.recv_timeout(LOOKS_EVERY) {
                Ok((number, thoughts)) => {
                    thoughts.into_iter().for_each(Thought::think);
                    self.mailbox.leave_in_time(Message::Considered(number));
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
        Ok(())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::{robots::Visitor, talk::Said};

    fn utterance(text: &str) -> Utterance {
        let said = Said::Text { text: text.to_owned(), received_nanos: 0 };
        Utterance { visitor: Visitor::default(), said, page: None }
    }

    fn words(utterances: &[Utterance]) -> Vec<&str> {
        utterances.iter().filter_map(|one| one.said.words()).collect()
    }

    #[test]
    fn what_is_over_while_it_is_thought_of_is_not_given() {
        let (mut unheard, _thoughts) = unheard();
        assert!(unheard.push(utterance("one")).is_none() && !unheard.consider(Vec::new()));
        assert!(unheard.first().is_some(), "there is nothing to think of");
        unheard.is_thinking = true;
        assert!(unheard.push(utterance("two")).is_none() && unheard.first().is_none(), "one at a time");
        assert_eq!(words(&unheard.take(|one| one.said.words() == Some("one"))), ["one"]);
        assert!(unheard.considered(1).is_none(), "it is over");
        assert_eq!(unheard.first().and_then(|first| first.said.words()), Some("two"));
        unheard.is_thinking = true;
        assert!(unheard.considered(2).is_some() && unheard.first().is_none());
    }

    #[test]
    fn of_too_much_the_oldest_is_over() {
        let (mut unheard, _thoughts) = unheard();
        for number in 0..MOST_WAITING {
            assert!(unheard.push(utterance(&number.to_string())).is_none());
        }
        let oldest = unheard.push(utterance("more")).unwrap();
        assert_eq!((oldest.said.words(), unheard.utterances.len()), (Some("0"), MOST_WAITING));
    }
}
