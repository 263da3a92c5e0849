//! What a peer hears and says in a session, and the commands that it gave.

use std::{
    collections::{BTreeMap, VecDeque},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    thread,
    time::Duration,
};

use cohabit_agent::Client;
use cohabit_bus::{
    Inbox, Publisher, Topic, Transport,
    message::{DialogView, EventKind, EventMessage},
    monotonic_nanos,
};
use cohabit_cdf::Status;
use pyo3::prelude::*;

use super::heard::Heard;
use crate::error::failed;

/// How often what came is taken in while Python is busy.
const BEAT_EVERY: Duration = Duration::from_millis(400);
/// What the others call a peer of this kind.
const PEER: &str = "python";
/// What was heard and not asked for: the oldest is forgotten beyond it.
const MOST_HEARD: usize = 1024;

/// What is told and said.
pub(super) struct Talk {
    joined_nanos: u64,
    pub(super) client: Client,
    dialog: Inbox,
    pub(super) mouth: Box<dyn Publisher>,
    pub(super) heard: VecDeque<Heard>,
    /// In lock-step, whether the world waits for this peer.
    pub(super) attends: bool,
    /// Of commands that were given here and have no outcome yet, nothing; else what came of them.
    pub(super) outcomes: BTreeMap<u64, Option<(Status, String)>>,
}

pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Talk {
    /// Listens from now on, and takes part for that body.
    pub(super) fn join(bus: &dyn Transport, body: u32) -> PyResult<Self> {
        Ok(Self {
            joined_nanos: monotonic_nanos(),
            client: Client::join(bus, body, PEER).map_err(failed)?,
            dialog: Inbox::new(bus, Topic::Dialog).map_err(failed)?,
            mouth: bus.publisher(Topic::Dialog).map_err(failed)?,
            heard: VecDeque::new(),
            attends: false,
            outcomes: BTreeMap::new(),
        })
    }

    /// Takes in all that came, and shows that this peer lives.
    pub(super) fn pump(&mut self) -> PyResult<()> {
        self.client.beat().map_err(failed)?;
        while let Some((envelope, event)) = self.client.event().map_err(failed)? {
            let Some(kind) = event.kind().filter(|_| envelope.sent_nanos >= self.joined_nanos) else { continue };
            if kind == EventKind::Outcome {
                self.note(&event);
            }
            self.hear(Heard::event(&event, kind, envelope.tick));
        }
        while let Some((sample, ())) =
            self.dialog.next(|sample| DialogView::new(sample.payload()).map(drop)).map_err(failed)?
        {
            let view = DialogView::new(sample.payload()).map_err(failed)?;
            if let Some(kind) = view.header.kind().filter(|_| sample.envelope().sent_nanos >= self.joined_nanos) {
                self.hear(Heard::dialog(&view, kind));
            }
        }
        Ok(())
    }

    /// The number of a command that was just given, whose outcome is to be kept.
    pub(super) fn expect(&mut self, number: u64) -> u64 {
        self.outcomes.insert(number, None);
        number
    }

    /// Notes the outcome of a command that was given here.
    fn note(&mut self, event: &EventMessage) {
        if let (Some(status), Some(outcome)) = (event.status(), self.outcomes.get_mut(&event.command)) {
            *outcome = Some((status, event.text.as_str().to_owned()));
        }
    }

    fn hear(&mut self, heard: Heard) {
        if self.heard.len() == MOST_HEARD {
            self.heard.pop_front();
        }
        self.heard.push_back(heard);
    }
}

/// Takes in what comes while Python is busy, and shows that this peer lives, for as long as the session is joined.
pub(super) fn keep_beating(talk: &Arc<Mutex<Talk>>) {
    let talk = Arc::downgrade(talk);
    thread::spawn(move || {
        while let Some(talk) = talk.upgrade() {
            // What fails here fails for whoever calls next, too, and is told then.
            let _ = lock(&talk).pump();
            drop(talk);
            thread::sleep(BEAT_EVERY);
        }
    });
}
