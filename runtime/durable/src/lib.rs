//! Files that outlast a crash: lines that are on the disk once they are appended, and files that are whole or not there.
//!
//! This crate never knows what is in them.

mod lines;
mod whole;

pub use lines::{LineFile, whole_lines};
pub use whole::{Readers, sync_folder, write_whole};
