//! What can go wrong on a bus.

use crate::{private::AccessError, topic::Topic};

/// Why an operation on the bus failed.
#[derive(Debug, thiserror::Error)]
pub enum BusError {
    /// There is no such session.
    #[error("join session `{session}`: there is no such session here; start it with `cohabit play --session NAME`")]
    NoSession {
        /// The name that was asked for.
        session: String,
    },
    /// The session was started by a program with another version of the messages.
    #[error(
        "join session `{session}`: it speaks version {spoken} of the messages, this program version {own}: use the build \
         that started the session (`cohabit doctor` tells which sessions run another)"
    )]
    OtherVersion {
        /// The session's name.
        session: String,
        /// The session's version.
        spoken: u32,
        /// This build's version.
        own: u32,
    },
    /// The session's files are not this user's alone.
    #[error("join session `{session}`: {source}")]
    Access {
        /// The session's name.
        session: String,
        /// Which file, and why.
        source: AccessError,
    },
    /// The process could not join the session's shared memory.
    #[error("join session `{session}`: {reason}")]
    Join {
        /// The session's name.
        session: String,
        /// What the transport said.
        reason: String,
    },
    /// A topic could not be opened.
    #[error("open topic `{topic}`: {reason}")]
    Open {
        /// Which.
        topic: Topic,
        /// What the transport said.
        reason: String,
    },
    /// A sample could not be sent: shared memory is full, say.
    #[error("send on topic `{topic}`: {reason}")]
    Send {
        /// Which.
        topic: Topic,
        /// What the transport said.
        reason: String,
    },
    /// A payload is longer than its topic takes.
    #[error("a message of {bytes} bytes on topic `{topic}`, which takes at most {most}: send it in parts")]
    TooLong {
        /// Which.
        topic: Topic,
        /// The payload's length.
        bytes: usize,
        /// The longest that is taken.
        most: usize,
    },
    /// A sample could not be received.
    #[error("receive on topic `{topic}`: {reason}")]
    Receive {
        /// Which.
        topic: Topic,
        /// What the transport said.
        reason: String,
    },
    /// A sample is not of this version of the messages.
    #[error(
        "a peer on topic `{topic}` speaks version {found} of the messages, this program version {expected}: use one \
         build for all (`cohabit doctor` tells which sessions run another)"
    )]
    Version {
        /// Which.
        topic: Topic,
        /// The peer's version.
        found: u32,
        /// This build's version.
        expected: u32,
    },
    /// A message's bytes are not what its header says.
    #[error("malformed message on topic `{topic}`: {reason}")]
    Malformed {
        /// Which.
        topic: Topic,
        /// What is wrong.
        reason: &'static str,
    },
}
