//! Cameras: where they stand, what they see, and how a point in the world becomes a point in the picture.

use glam::Vec3;

use crate::lens::Lens;

/// Nothing nearer is drawn, m.
pub const NEAR_M: f32 = 0.03;
/// What the depth plane holds where there is nothing, m; nothing farther is drawn.
pub const FAR_M: f32 = 100.0;

/// How high cameras are that look down: high enough that walls lean little, m.
const ABOVE_M: f32 = 60.0;
/// What they see around what they look at, m in all.
const MARGIN_M: f32 = 1.5;

/// A pinhole camera with square pixels. Its frame: x right, y down, z forward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Its eye in the world, m.
    pub position_m: [f32; 3],
    /// The way it looks, counter-clockwise from `+x`.
    pub yaw_rad: f32,
    /// How far it looks up.
    pub pitch_rad: f32,
    /// The angle between the upper and the lower edge of the picture.
    pub fov_y_rad: f32,
    /// Pixels a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// An instance that is not drawn: the robot itself in its own eyes.
    pub hide: Option<u32>,
    /// Whether people look at the picture: highlights are outlined and edges smoothed, in the colour plane alone.
    pub for_people: bool,
    /// Whether there are ceilings; without them a camera outside of a room looks in.
    pub ceiling: bool,
}

impl Camera {
    /// Looks down on `[west, south, east, north]`, north up and without ceilings, so that what is `level_m` above the floor
    /// is to scale.
    #[must_use]
    pub fn above([west, south, east, north]: [f32; 4], level_m: f32, pixels_per_m: f32) -> Self {
        let [width_m, depth_m] = [east - west + MARGIN_M, north - south + MARGIN_M];
        let [width, height] = [width_m, depth_m].map(|length_m| (length_m * pixels_per_m) as u32);
        Self::top_down([width, height], [f32::midpoint(west, east), f32::midpoint(south, north)], level_m, depth_m)
    }

    /// In one place, for people.
    #[must_use]
    pub fn fixed(lens: Lens, position_m: [f32; 3], yaw_rad: f32, pitch_rad: f32) -> Self {
        let [width, height] = lens.size();
        let fov_y_rad = lens.fov_y_rad();
        Self { position_m, yaw_rad, pitch_rad, fov_y_rad, width, height, hide: None, for_people: true, ceiling: true }
    }

    /// In the head of a body, which is instance `own` and does not see itself: exactly what is there, no outlines.
    #[must_use]
    pub fn egocentric(lens: Lens, eye_m: [f32; 3], yaw_rad: f32, head_pitch_rad: f32, own: u32) -> Self {
        let camera = Self::fixed(lens, eye_m, yaw_rad, head_pitch_rad);
        Self { hide: Some(own), for_people: false, ..camera }
    }

    /// The same four times: ahead, to the right, back and to the left. With a field of view of 90 degrees both ways the
    /// pictures meet at their edges.
    #[must_use]
    pub fn panorama(lens: Lens, eye_m: [f32; 3], yaw_rad: f32, head_pitch_rad: f32, own: u32) -> [Self; 4] {
        [0.0, 1.0, 2.0, 3.0].map(|quarters| {
            let yaw_rad = yaw_rad - quarters * std::f32::consts::FRAC_PI_2;
            Self::egocentric(lens, eye_m, yaw_rad, head_pitch_rad, own)
        })
    }

    /// Behind and above a body at `standing_m` on the floor: `back_m` behind it, `up_m` above the floor, looking the way
    /// it does and `pitch_rad` up.
    #[must_use]
    pub fn third_person(
        lens: Lens,
        standing_m: [f32; 2],
        yaw_rad: f32,
        [back_m, up_m]: [f32; 2],
        pitch_rad: f32,
    ) -> Self {
        let (sin, cos) = libm::sincosf(yaw_rad);
        let [x, y] = standing_m;
        Self::fixed(lens, [x - cos * back_m, y - sin * back_m, up_m], yaw_rad, pitch_rad)
    }

    /// Looks down on a place, north up and without ceilings, so that `span_m` of what is `level_m` above the floor are
    /// seen from south to north.
    #[must_use]
    pub fn top_down([width, height]: [u32; 2], [x, y]: [f32; 2], level_m: f32, span_m: f32) -> Self {
        Self {
            position_m: [x, y, ABOVE_M],
            yaw_rad: std::f32::consts::FRAC_PI_2,
            pitch_rad: -std::f32::consts::FRAC_PI_2,
            fov_y_rad: 2.0 * libm::atanf(span_m / 2.0 / (ABOVE_M - level_m)),
            width,
            height,
            hide: None,
            for_people: true,
            ceiling: false,
        }
    }

    /// Looks down on all of `[west, south, east, north]`, however long the picture's sides are.
    #[must_use]
    pub fn top_down_on(size: [u32; 2], [west, south, east, north]: [f32; 4], level_m: f32) -> Self {
        let [width, height] = size.map(|pixels| pixels as f32);
        let span_m = (north - south + MARGIN_M).max((east - west + MARGIN_M) * height / width);
        Self::top_down(size, [f32::midpoint(west, east), f32::midpoint(south, north)], level_m, span_m)
    }

    /// Pixels of the picture.
    #[must_use]
    pub fn pixels(&self) -> usize {
        self.width as usize * self.height as usize
    }
}

/// A camera, worked out.
#[derive(Clone, Copy, Debug)]
pub(crate) struct View {
    pub eye: Vec3,
    pub right: Vec3,
    pub down: Vec3,
    pub forward: Vec3,
    /// Pixels a unit of slope.
    pub focal: f32,
    pub center: [f32; 2],
    pub size: [u32; 2],
}

impl View {
    pub(crate) fn new(camera: &Camera) -> Self {
        let (sin_yaw, cos_yaw) = libm::sincosf(camera.yaw_rad);
        let (sin_pitch, cos_pitch) = libm::sincosf(camera.pitch_rad);
        let forward = Vec3::new(cos_pitch * cos_yaw, cos_pitch * sin_yaw, sin_pitch);
        let right = Vec3::new(sin_yaw, -cos_yaw, 0.0);
        let half = libm::tanf(camera.fov_y_rad.clamp(0.01, 3.0) * 0.5);
        Self {
            eye: Vec3::from_array(camera.position_m),
            right,
            down: forward.cross(right),
            forward,
            focal: camera.height as f32 * 0.5 / half,
            center: [camera.width as f32 * 0.5, camera.height as f32 * 0.5],
            size: [camera.width, camera.height],
        }
    }

    /// A point of the world in the camera's frame.
    #[inline]
    pub(crate) fn in_camera(&self, point: Vec3) -> Vec3 {
        self.turned(point - self.eye)
    }

    /// A direction of the world in the camera's frame.
    #[inline]
    pub(crate) fn turned(&self, direction: Vec3) -> Vec3 {
        Vec3::new(direction.dot(self.right), direction.dot(self.down), direction.dot(self.forward))
    }

    /// The world direction through a place of the picture, one metre forward.
    #[inline]
    pub(crate) fn ray(&self, x: f32, y: f32) -> Vec3 {
        self.forward
            + self.right * ((x - self.center[0]) / self.focal)
            + self.down * ((y - self.center[1]) / self.focal)
    }

    /// The whole picture.
    pub(crate) fn screen(&self) -> Rect {
        Rect { min: [0.0, 0.0], max: [self.size[0] as f32, self.size[1] as f32] }
    }

    /// The part of the picture that a sphere may cover; all of it, if it surrounds the eye; nothing, if it is behind.
    pub(crate) fn sphere_rect(&self, center: Vec3, radius: f32) -> Option<Rect> {
        let at = self.in_camera(center);
        if at.z + radius < NEAR_M {
            return None;
        }
        if at.z - radius <= NEAR_M {
            return Some(Rect { min: [-1e6; 2], max: [1e6; 2] });
        }
        // The nearest depth makes the bound larger than the exact ellipse, never smaller.
        let (near, far) = (at.z - radius, at.z + radius);
        let bound = |low: f32, high: f32| {
            let low = if low < 0.0 { low / near } else { low / far };
            let high = if high > 0.0 { high / near } else { high / far };
            (low * self.focal, high * self.focal)
        };
        let (left, right) = bound(at.x - radius, at.x + radius);
        let (top, bottom) = bound(at.y - radius, at.y + radius);
        Some(Rect {
            min: [left + self.center[0], top + self.center[1]],
            max: [right + self.center[0], bottom + self.center[1]],
        })
    }
}

/// A rectangle of the picture, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rect {
    pub min: [f32; 2],
    pub max: [f32; 2],
}

impl Rect {
    pub(crate) fn intersection(self, other: Self) -> Option<Self> {
        let min = [self.min[0].max(other.min[0]), self.min[1].max(other.min[1])];
        let max = [self.max[0].min(other.max[0]), self.max[1].min(other.max[1])];
        (min[0] < max[0] && min[1] < max[1]).then_some(Self { min, max })
    }

    pub(crate) fn union(self, other: Self) -> Self {
        Self {
            min: [self.min[0].min(other.min[0]), self.min[1].min(other.min[1])],
            max: [self.max[0].max(other.max[0]), self.max[1].max(other.max[1])],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(yaw_rad: f32, pitch_rad: f32) -> Camera {
        Camera {
            position_m: [1.0, 2.0, 1.5],
            yaw_rad,
            pitch_rad,
            fov_y_rad: 1.0,
            width: 100,
            height: 80,
            hide: None,
            for_people: false,
            ceiling: true,
        }
    }

    #[test]
    fn right_is_right_and_up_is_up() {
        let view = View::new(&camera(0.0, 0.0));
        let at = view.in_camera(Vec3::new(3.0, 1.0, 2.0));
        assert!((at - Vec3::new(1.0, -0.5, 2.0)).length() < 1e-5, "{at}");
        assert!(View::new(&camera(0.0, 0.3)).forward.z > 0.0);
    }

    #[test]
    fn a_ray_goes_back_to_its_pixel() {
        let view = View::new(&camera(0.7, -0.4));
        let at = view.turned(view.ray(13.0, 57.0));
        assert!((at.z - 1.0).abs() < 1e-5);
        assert!((at.x * view.focal + 50.0 - 13.0).abs() < 1e-3 && (at.y * view.focal + 40.0 - 57.0).abs() < 1e-3);
    }

    #[test]
    fn pictures_of_a_panorama_meet_at_their_edges() {
        let lens = Lens::new(64, 64, 90.0).expect("a lens");
        let views = Camera::panorama(lens, [1.0, 2.0, 1.5], 0.4, 0.0, 7).map(|camera| View::new(&camera));
        for (index, view) in views.iter().enumerate() {
            let next = &views[(index + 1) % 4];
            for row in [0.0, 20.0, 64.0] {
                let (right, left) = (view.ray(64.0, row), next.ray(0.0, row));
                assert!((right - left).length() < 1e-4, "{index}: {right} {left}");
            }
        }
    }

    #[test]
    fn cameras_above_see_what_they_should() {
        let place = |camera: &Camera, point: Vec3| {
            let view = View::new(camera);
            let at = view.in_camera(point);
            [at.x / at.z * view.focal + view.center[0], at.y / at.z * view.focal + view.center[1]]
        };
        let bounds = [-3.0, 2.0, 17.0, 30.0];
        for size in [[854, 480], [300, 900], [64, 64]] {
            let camera = Camera::top_down_on(size, bounds, 0.8);
            for corner in [Vec3::new(-3.0, 2.0, 0.8), Vec3::new(17.0, 30.0, 0.8)] {
                let [x, y] = place(&camera, corner);
                assert!(x > 0.0 && y > 0.0 && x < size[0] as f32 && y < size[1] as f32, "{size:?}: {x} {y}");
            }
        }
        let camera = Camera::top_down([200, 100], [5.0, 6.0], 0.8, 4.0);
        let [x, y] = place(&camera, Vec3::new(9.0, 8.0, 0.8));
        assert!((x - 200.0).abs() < 0.1 && y.abs() < 0.1, "east is right, north is up: {x} {y}");
    }

    #[test]
    fn a_third_person_stands_behind() {
        let lens = Lens::new(64, 64, 60.0).expect("a lens");
        let camera = Camera::third_person(lens, [1.0, 2.0], std::f32::consts::FRAC_PI_2, [2.0, 1.9], -0.3);
        let off = Vec3::from_array(camera.position_m) - Vec3::new(1.0, 0.0, 1.9);
        assert!(off.length() < 1e-5 && camera.for_people && camera.pitch_rad == -0.3);
    }
}
