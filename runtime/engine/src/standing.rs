//! How a body is placed, for the cameras that are its eyes or follow it.

/// Where a body stands and looks.
#[derive(Clone, Copy, Debug)]
pub struct Standing {
    /// On the floor, m.
    pub position_m: [f32; 3],
    /// Its eye, m.
    pub eye_m: [f32; 3],
    /// Heading, rad.
    pub yaw_rad: f32,
    /// Pitch of the head, rad.
    pub head_pitch_rad: f32,
}
