//! Existing clients: the wire of Alexa Arena, spoken to worlds of this project.
//!
//! A client connects by TCP. Each message, both ways, is four bytes of length, little-endian, and so many bytes of JSON
//! ([`Inbox`], [`framed`]). A JSON object with a `scene` is a mission (CDF): it starts the game anew and has no answer. A
//! JSON array is a batch of commands: they are carried out in order, each until its outcome, up to the first that fails,
//! and answered by one object with what came of the last, the pictures, all objects and the goals. `lastAction`, a text of
//! JSON, is the command that `lastActionSuccess` is of, with its place in the batch (`commandNum`, from 0; -1 if none was
//! carried out).
//!
//! Simulated time goes by only while a batch is carried out, as fast as the machine can, and a moment after each act of
//! the hand. A game outlives its connection: who reconnects goes on with it. Each game is recorded in a log of its own,
//! and can be replayed.
//!
//! Frames of a client: metres, `x` east, `y` up, `z` north, left-handed; a robot that is not rotated faces north. Angles
//! are in degrees, to the right positive. A `raycast` is a pixel of the robot's own view, from the upper left.
//!
//! Images are PNG of 300x300 pixels with alpha, in base64:
//! - colour and instances: the colour of an instance is its `instanceSegmentationColor`, and nobody else's;
//! - depth: `1000 m * (red / 255 + green / 255² + blue / 255³)` along the camera's axis;
//! - normals: in the camera's frame, x right, y up, z towards the camera, from -1 to 1 as 0 to 255.
//!
//! This crate never knows dialog, and nothing of a wall clock but stamps in logs.

mod arena;
mod axes;
mod clients;
mod command;
mod game;
mod limits;
mod object;
mod pictures;
mod renderer;
mod reply;
mod server;
mod wire;

pub use arena::{Arena, Settings};
pub use limits::ClientLimits;
pub use server::{serve, serve_within};
pub use wire::{Inbox, LONGEST, TooLong, framed};
