//! What a mission shows to the people who watch: a camera of its own for a while.

use cohabit_cdf::{Layout, RoomId};
use cohabit_render::{Camera, Lens};
use cohabit_world::{CameraTarget, World};
use libm::{atan2f, cosf, sinf, sqrtf};

use crate::camera_rig::free_length_m;

/// How far from what it shows the camera is, if the room lets it.
const AWAY_M: f32 = 2.4;
const NEAREST_M: f32 = 0.8;
/// How high above what it shows, and above the floor where that is a place to stand at.
const ABOVE_M: f32 = 0.9;
const EYE_M: f32 = 1.7;

/// Where one looks at something from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outlook {
    /// The eye, m.
    pub position_m: [f32; 3],
    /// The way it looks.
    pub yaw_rad: f32,
    /// How far it looks up.
    pub pitch_rad: f32,
}

impl Outlook {
    /// A camera there.
    pub fn camera(self, lens: Lens) -> Camera {
        Camera::fixed(lens, self.position_m, self.yaw_rad, self.pitch_rad)
    }
}

/// Where `target` is shown from; `None` if it is not there (any more).
pub fn outlook(target: CameraTarget, world: &World) -> Option<Outlook> {
    let layout = world.layout();
    match target {
        CameraTarget::Object(object) => Some(near(world.object(object)?.position_m.to_array(), layout)),
        CameraTarget::Point(point_m) => Some(near(point_m, layout)),
        CameraTarget::Room(room) => from_viewpoint(room, None, layout),
        CameraTarget::Viewpoint(room, number) => from_viewpoint(room, Some(number), layout),
    }
}

/// Looks at a point from the middle of its room.
fn near(point_m: [f32; 3], layout: &Layout) -> Outlook {
    let [x, y, z] = point_m;
    let mut rects = layout.rooms.iter().flat_map(|room| &room.rects_m);
    let around = rects.find(|[west, south, east, north]| x >= *west && x <= *east && y >= *south && y <= *north);
    let (dx, dy) = around.map_or((1.0, 0.0), |[west, south, east, north]| {
        (f32::midpoint(*west, *east) - x, f32::midpoint(*south, *north) - y)
    });
    let length = sqrtf(dx * dx + dy * dy);
    let back = if length > 0.01 { [dx / length, dy / length] } else { [1.0, 0.0] };
    let away_m = free_length_m(layout, &[], [x, y], back, AWAY_M).max(NEAREST_M);
    let position_m = [x + back[0] * away_m, y + back[1] * away_m, (z + ABOVE_M).max(EYE_M)];
    let pitch_rad = atan2f(z - position_m[2], away_m);
    Outlook { position_m, yaw_rad: atan2f(-back[1], -back[0]), pitch_rad }
}

fn from_viewpoint(room: RoomId, number: Option<u8>, layout: &Layout) -> Option<Outlook> {
    let mut viewpoints = layout.viewpoints.iter().filter(|viewpoint| viewpoint.room == room);
    let viewpoint = viewpoints.find(|viewpoint| number.is_none_or(|number| viewpoint.number == number))?;
    let [x, y] = viewpoint.at_m;
    let yaw_rad = viewpoint.yaw_deg.to_radians();
    let back = [-cosf(yaw_rad), -sinf(yaw_rad)];
    let away_m = free_length_m(layout, &[], [x, y], back, AWAY_M / 2.0);
    let position_m = [x + back[0] * away_m, y + back[1] * away_m, EYE_M];
    Some(Outlook { position_m, yaw_rad, pitch_rad: -0.15 })
}
