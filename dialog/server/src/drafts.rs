//! What visitors may say next, as far as they have typed or spoken it. The language model takes some tenths of a second for some utterances, and what it
//! made of one is kept: who pauses before sending what was typed is answered sooner.

use std::{
    collections::BTreeMap,
    iter,
    sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel},
    time::Duration,
};

use crate::robots::Visitor;

/// The most drafts that wait; what comes then is left out.
const MOST_WAITING: usize = 16;

/// How often it is seen whether more is to be waited for.
const LOOKS_EVERY: Duration = Duration::from_millis(100);

/// What a visitor may say next. It is told to nobody, and not written down.
pub struct Draft {
    pub visitor: Visitor,
    pub text: String,
}

/// Where drafts are left.
pub struct Drafts(SyncSender<Draft>);

/// Where they are found.
pub struct Drafted(Receiver<Draft>);

/// Where drafts are left, and where they are found.
pub fn drafts() -> (Drafts, Drafted) {
    let (sender, receiver) = sync_channel(MOST_WAITING);
    (Drafts(sender), Drafted(receiver))
}

impl Drafts {
    /// Leaves a draft, if it can be looked at soon.
    pub fn leave(&self, visitor: Visitor, text: &str) {
        let _ = self.0.try_send(Draft { visitor, text: text.to_owned() });
    }
}

impl Drafted {
    /// What comes, until `over`.
    pub fn until(self, over: impl Fn() -> bool) -> impl Iterator<Item = Draft> {
        iter::from_fn(move || (!over()).then(|| self.next(LOOKS_EVERY).unwrap_or_default())).flatten()
    }

    /// The newest draft of each visitor who left one; waits at most so long for the first.
    fn next(&self, most: Duration) -> Result<Vec<Draft>, RecvTimeoutError> {
        let first = self.0.recv_timeout(most)?;
        let drafts = iter::once(first).chain(self.0.try_iter());
        let newest: BTreeMap<u32, Draft> = drafts.map(|draft| (draft.visitor.number, draft)).collect();
        Ok(newest.into_values().collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_what_a_visitor_types_the_newest_counts() {
        let (drafts, drafted) = drafts();
        let [one, other] = [1, 2].map(|number| Visitor { number, body: None });
        drafts.leave(one, "go to");
        drafts.leave(other, "stop");
        drafts.leave(one, "go to the lab");
        let next = |most| drafted.next(most).map(|next| next.into_iter().map(|draft| draft.text).collect::<Vec<_>>());
        assert_eq!(next(Duration::from_secs(60)), Ok(vec!["go to the lab".to_owned(), "stop".to_owned()]));
        assert_eq!(next(Duration::ZERO), Err(RecvTimeoutError::Timeout));
        (0..100).for_each(|_| drafts.leave(one, "too many are left out"));
        assert_eq!(drafted.0.try_iter().count(), MOST_WAITING);
    }
}
