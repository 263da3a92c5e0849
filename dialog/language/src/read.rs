//! From words to clauses, questions and phrases. Knows words, and what was said before it in the same utterance; no scene.

pub(crate) mod asked_about;
pub(crate) mod chatter;
pub(crate) mod clause;
mod color;
pub(crate) mod hearing;
pub(crate) mod hint;
mod noun;
pub(crate) mod parts;
pub(crate) mod phrase;
pub(crate) mod question;
pub(crate) mod reader;
pub(crate) mod reading;
pub(crate) mod remark;
pub(crate) mod saying;
pub(crate) mod segments;
pub(crate) mod slot;
pub(crate) mod tail;
pub(crate) mod tidy;
pub(crate) mod whether;
pub(crate) mod wish;
