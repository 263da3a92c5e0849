//! What the robot says of what it knows and plans: questions, replies, reports. Knows no conversation.

pub(crate) mod ask;
pub(crate) mod examples;
pub(crate) mod oracle;
pub(crate) mod reply;
pub(crate) mod report;
pub(crate) mod worded;
