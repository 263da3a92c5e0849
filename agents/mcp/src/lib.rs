//! A body of a session as tools for language models: a peer of the session that speaks the Model Context Protocol (MCP) with any
//! client of it.
//!
//! In: a client's messages (JSON-RPC 2.0, one a line), and what the session's bus tells. Out: commands of one body, what it says, and
//! the answers to the client. Each call of a tool is answered with a sentence, also where the world refuses it.
//!
//! Invariants:
//! - Nothing but messages of the protocol is written to the output, and a client that does not read holds up nothing but itself.
//! - Lines, calls under way, what was heard and all waits are bounded (`limits`). What is no message is answered as the protocol says,
//!   and the next line is read.
//! - The body is claimed by the first call that has it do something, from whoever commands it, and goes back to them when the input
//!   ends, when the process is asked to end, and when it is killed.
//! - Names are looked for in the whole world, as the robot's own mind does under `--knows everything`; what is in sight is what the
//!   body's camera shows.
//!
//! The protocol is written here with `serde_json` alone, from its specification: a server of tools needs four of its methods and two of
//! its notifications. The usual crate for it, `rmcp`, would run it on an asynchronous runtime.
//!
//! It never knows the world's insides, and no other transport than that it is given.

mod body_choice;
mod bridge;
mod error;
mod hearing;
mod limits;
mod lines;
mod outlet;
mod peer;
mod protocol;
mod said;
#[cfg(test)]
mod scene;
mod sight;
mod things;
mod tools;

use std::{
    io::{BufRead, Write},
    sync::{Arc, atomic::AtomicBool},
};

use cohabit_bus::Transport;
use cohabit_cdf::Catalog;

pub use body_choice::BodyChoice;
pub use error::BridgeError;

use crate::{bridge::Bridge, outlet::Outlet, peer::Peer};

/// What a client may have.
#[derive(Clone, Copy, Debug)]
pub struct BridgeConfig {
    /// The body that it plays.
    pub body: BodyChoice,
    /// Whether it may know the goals of the mission.
    pub tells_goals: bool,
}

/// Serves a client that writes to `input` and reads from `output`, until its input ends, it reads no more, or `stop`.
///
/// # Errors
/// [`BridgeError`]: the session has no such body, plays in another world than that of `catalog` or in lock-step, or cannot be reached;
/// or the client does not read its answers.
pub fn serve(
    bus: &dyn Transport,
    catalog: &Arc<Catalog>,
    config: BridgeConfig,
    input: impl BufRead + Send + 'static,
    output: impl Write + Send + 'static,
    stop: &AtomicBool,
) -> Result<(), BridgeError> {
    let BridgeConfig { body, tells_goals } = config;
    let Some(peer) = Peer::join(bus, catalog, body, tells_goals, stop)? else { return Ok(()) };
    tracing::info!("a client plays body {} by tools", peer.body());
    let mut bridge = Bridge::new(peer, tells_goals, Outlet::new(output));
    let served = bridge.run(&lines::lines(input), stop);
    bridge.close();
    served
}
