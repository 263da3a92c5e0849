//! What the conversations hear, one message after the other, and where it is left.

use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};

use cohabit_bus::{Envelope, message::DialogHeader};
use cohabit_cdf::{BodyId, ObjectId};
use cohabit_speech::Scene;
use serde_json::Value;
use tokio::sync::{mpsc::UnboundedSender, oneshot};

use crate::{
    conversation::Thought, interpreter::Interpretation, limits::A_LOT, robots::Visitor, spoken::Spoken, voice::FromEar,
    wizard::Decision,
};

/// The most messages that wait: pages send ten a second each, an agent a few.
const MOST_WAITING: usize = 1024;

/// What a page is told whose message cannot be taken.
pub const UNREACHABLE: &str = "The robot cannot be reached.";

/// Something that somebody tells the robots.
pub struct Utterance {
    /// Who.
    pub visitor: Visitor,
    /// What.
    pub said: Said,
    /// Their page, where it is to learn what comes of that.
    pub page: Option<UnboundedSender<FromEar>>,
}

impl Utterance {
    /// Tells the page, which may be gone.
    pub(super) fn tell(&self, message: FromEar) {
        if let Some(page) = &self.page {
            let _ = page.send(message);
        }
    }
}

/// How somebody tells the robots something.
pub enum Said {
    /// In writing.
    Text {
        /// What.
        text: String,
        /// When it was received, ns of the monotonic clock.
        received_nanos: u64,
    },
    /// Aloud.
    Aloud {
        /// As it was heard; its page is told whether it was anything, unless it was shown that already.
        spoken: Box<Spoken>,
        /// When it was meant, perhaps in other words, ns of the monotonic clock.
        meant_nanos: u64,
    },
    /// Aloud, too, but robots hear it only once the page has shown the reading that is meant.
    Shown(Box<Spoken>),
    /// By choosing an object.
    Choice {
        /// Which.
        object: ObjectId,
        /// When it was received, ns of the monotonic clock.
        received_nanos: u64,
        /// Whether it counts only where a robot asks something that it answers.
        is_answer: bool,
    },
}

impl Said {
    /// Its words, if it has any; of what was said aloud the likeliest.
    pub(super) fn words(&self) -> Option<&str> {
        match self {
            Self::Text { text, .. } => Some(text.as_str()),
            Self::Aloud { spoken, .. } | Self::Shown(spoken) => spoken.first(),
            Self::Choice { .. } => None,
        }
    }
}

/// What the conversations hear.
pub(super) enum Message {
    /// Somebody tells the robots something.
    Utterance(Utterance),
    /// The language model has thought of the utterance of that number.
    Considered(u64),
    /// Somebody may say this next: how would it be understood now?
    Draft(Visitor, String, oneshot::Sender<Vec<Thought>>),
    /// An agent tells something.
    FromAgent(Envelope, Box<DialogHeader>),
    /// An interpreter answers.
    Interpreted(Interpretation),
    /// A wizard decides what is answered: the robot of a body, or else the one that holds something back. Why that cannot be.
    Decision(Option<BodyId>, Decision, oneshot::Sender<Result<(), String>>),
    /// What do the robots hold back, for a wizard's page?
    Proposals(oneshot::Sender<Vec<Value>>),
    /// Is what was said so far a whole sentence?
    IsWhole(String, oneshot::Sender<bool>),
    /// What is there to speak of, if that is other than what had this number before?
    Likely(u64, oneshot::Sender<Option<(u64, Scene)>>),
}

/// Where messages to the conversations are left.
pub struct Mailbox(SyncSender<Message>);

/// Where they are found.
pub struct Mail(pub(super) Receiver<Message>);

/// Where messages to the conversations are left, and where they are found.
pub fn mailbox() -> (Mailbox, Mail) {
    let (sender, receiver) = sync_channel(MOST_WAITING);
    (Mailbox(sender), Mail(receiver))
}

impl Mailbox {
    /// Leaves a message at once.
    ///
    /// # Errors
    /// In a sentence for people, if too many wait, or nobody takes them any more.
    pub(super) fn leave(&self, message: Message) -> Result<(), String> {
        self.0.try_send(message).map_err(|error| match error {
            TrySendError::Full(_) => A_LOT.to_owned(),
            TrySendError::Disconnected(_) => UNREACHABLE.to_owned(),
        })
    }

    /// Leaves a message, once there is room for it; `false` if nobody takes any more. For threads of which nobody waits for more than that.
    pub(super) fn leave_in_time(&self, message: Message) -> bool {
        self.0.send(message).is_ok()
    }

    /// Asks the conversations something, and waits for the answer; nothing, if there is none.
    pub(super) fn ask<T>(&self, question: impl FnOnce(oneshot::Sender<T>) -> Message) -> Option<T> {
        let (to, answer) = oneshot::channel();
        if self.leave_in_time(question(to)) { answer.blocking_recv().ok() } else { None }
    }
}
