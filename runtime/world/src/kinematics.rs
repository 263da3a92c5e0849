//! What all motion of bodies has in common: the tick, limits of acceleration and of the head, and how a step ends.

/// Length of a tick, s.
pub(crate) const DT_S: f32 = 1.0 / 60.0;
pub(crate) const WALK_M_S2: f32 = 2.5;
pub(crate) const TURN_RAD_S2: f32 = 14.0;
pub(crate) const PITCH_RAD_S: f32 = 2.0;
/// How far the head pitches up and down: 60 degrees each.
pub(crate) const PITCH_LIMIT_RAD: f32 = std::f32::consts::FRAC_PI_3;

/// How a step stands after a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Progress {
    /// It goes on.
    Going,
    /// It is done.
    Done,
    /// Something is in the way.
    Blocked,
}

/// How a step stands that is done, or goes on.
pub(crate) fn done_if(done: bool) -> Progress {
    if done { Progress::Done } else { Progress::Going }
}

/// The value, brought nearer to the one wanted by so much, and no further than that.
pub(crate) fn approach(value: f32, wanted: f32, by: f32) -> f32 {
    if (wanted - value).abs() <= by { wanted } else { value + by * (wanted - value).signum() }
}
