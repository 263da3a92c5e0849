//! What is said, and what is understood of it. One program for all: each would link the weights of the rewriter, which are large, again.

#![allow(clippy::unwrap_used)]

mod answers;
mod asking;
mod beyond_grammar;
mod commands;
mod conversation;
mod corpus;
mod follow_up;
mod homes;
mod later;
mod memory;
mod missions;
mod oracle;
mod proposals;
mod questions;
mod replies;
mod rewritten;
mod robustness;
mod stop;
mod support;
mod surroundings;
mod truth;
mod utterances;
