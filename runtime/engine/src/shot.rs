//! What a mission shows to the people who watch: a camera of its own for a while.

use cohabit_cdf::{Layout, RoomId};
use cohabit_render::Camera;
use cohabit_world::{CameraTarget, World};
use libm::{atan2f, cosf, sinf, sqrtf};

use crate::camera_rig::free_length_m;

/// How far from what it shows the camera is, if the room lets it.
const AWAY_M: f32 = 2.4;
const NEAREST_M: f32 = 0.8;
/// How high above what it shows, and above the floor where that is a place to stand at.
const ABOVE_M: f32 = 0.9;
const EYE_M: f32 = 1.7;
const FOV_Y_RAD: f32 = 0.96;

/// The camera that shows `target`; `None` if it is not there (any more).
pub fn camera(target: CameraTarget, world: &World, size: [u32; 2]) -> Option<Camera> {
    let layout = world.layout();
    match target {
        CameraTarget::Object(object) => Some(near(world.object(object)?.position_m.to_array(), layout, size)),
        CameraTarget::Point(point_m) => Some(near(point_m, layout, size)),
        CameraTarget::Room(room) => from_viewpoint(room, None, layout, size),
        CameraTarget::Viewpoint(room, number) => from_viewpoint(room, Some(number), layout, size),
    }
}

/// Looks at a point from the middle of its room.
fn near(point_m: [f32; 3], layout: &Layout, size: [u32; 2]) -> Camera {
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
    view(position_m, atan2f(-back[1], -back[0]), pitch_rad, size)
}

fn from_viewpoint(room: RoomId, number: Option<u8>, layout: &Layout, size: [u32; 2]) -> Option<Camera> {
    let mut viewpoints = layout.viewpoints.iter().filter(|viewpoint| viewpoint.room == room);
    let viewpoint = viewpoints.find(|viewpoint| number.is_none_or(|number| viewpoint.number == number))?;
    let [x, y] = viewpoint.at_m;
    let yaw_rad = viewpoint.yaw_deg.to_radians();
    let back = [-cosf(yaw_rad), -sinf(yaw_rad)];
    let away_m = free_length_m(layout, &[], [x, y], back, AWAY_M / 2.0);
    Some(view([x + back[0] * away_m, y + back[1] * away_m, EYE_M], yaw_rad, -0.15, size))
}

const fn view(position_m: [f32; 3], yaw_rad: f32, pitch_rad: f32, [width, height]: [u32; 2]) -> Camera {
    Camera {
        position_m,
        yaw_rad,
        pitch_rad,
        fov_y_rad: FOV_Y_RAD,
        width,
        height,
        hide: None,
        for_people: true,
        ceiling: true,
    }
}
