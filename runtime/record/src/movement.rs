//! Where the bodies of a session were, tick by tick, and which ways they were sent: worked out from a log, which itself
//! holds what they were told alone.

use cohabit_cdf::BodyKind;

/// How the bodies of a session moved.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Movement {
    /// All bodies, in the order of their numbers.
    pub trails: Vec<Trail>,
    /// The ways that they were sent, in the order in which they ended.
    pub travels: Vec<Travel>,
    /// Why it is not that of the whole session, if it is not.
    pub problem: Option<String>,
}

/// Where a body was.
#[derive(Clone, Debug, PartialEq)]
pub struct Trail {
    /// Its number.
    pub body: u32,
    /// Robot or person.
    pub kind: BodyKind,
    /// Radius of the cylinder that it keeps free, m.
    pub radius_m: f64,
    /// Where it was, a tick each, in order. All trails of a session have the same ticks; those that a log lacks are left
    /// out.
    pub stops: Vec<Stop>,
}

/// Where a body was after a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// The tick.
    pub tick: u64,
    /// Its middle on the floor, `[east, north]`, m.
    pub at_m: [f64; 2],
    /// Its heading, rad: counter-clockwise, 0 is east.
    pub yaw_rad: f64,
}

/// A way that a body was sent: a command to go somewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Travel {
    /// Who was sent.
    pub body: u32,
    /// The tick after which it stood where the way began.
    pub from: u64,
    /// The tick at which the command ended.
    pub to: u64,
    /// Whether it arrived.
    pub success: bool,
    /// Length of the shortest way over the walkable floor from where it was to where it ended, m; `None` if there is none
    /// now.
    pub shortest_m: Option<f64>,
    /// Length of the shortest way, other bodies left out, from where it was to where it was sent, as the floor was then, m;
    /// `None` if there was none.
    pub possible_m: Option<f64>,
}
