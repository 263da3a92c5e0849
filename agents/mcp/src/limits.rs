//! How large messages may be, how many there may be at once, and how long calls may take.

use std::time::Duration;

/// The longest message that is read, bytes: a call has some hundreds.
pub(crate) const LONGEST_LINE: usize = 1 << 20;
/// The most lines that wait to be taken in; more wait in the pipe.
pub(crate) const MOST_LINES: usize = 64;
/// The most messages that a client has not read yet. One with a picture has some tens of kilobytes.
pub(crate) const MOST_UNREAD: usize = 64;
/// The most calls that are under way at once.
pub(crate) const MOST_CALLS: usize = 16;

/// The longest name or description of a thing, in characters.
pub(crate) const LONGEST_NAME_CHARS: usize = 200;
/// The most that is kept of what was said until somebody listens.
pub(crate) const MOST_HEARD: usize = 256;
/// The most things in sight that are listed, the nearest ones.
pub(crate) const MOST_SEEN: usize = 60;
/// The most things that are named where a description fits several.
pub(crate) const MOST_FITTING: usize = 12;

/// How long the simulator may take to tell of its world.
pub(crate) const WORLD_PATIENCE: Duration = Duration::from_secs(10);
/// How long a claim may take to be answered.
pub(crate) const CLAIM_PATIENCE: Duration = Duration::from_secs(5);
/// How long a picture may take. Cameras of bodies deliver ten a second.
pub(crate) const PICTURE_PATIENCE: Duration = Duration::from_secs(10);
/// How long the outcome of an action is waited for. Clients give up a call after a minute as a rule.
pub(crate) const ACTION_PATIENCE: Duration = Duration::from_secs(45);
/// The longest that a client may have a call wait, s; for the same reason.
pub(crate) const LONGEST_WAIT_S: f64 = 50.0;
/// How long the client may take to read the last answers, once all is over.
pub(crate) const CLOSE_PATIENCE: Duration = Duration::from_secs(1);
