//! Frames as clients get them: PNG in base64, 8 bits each of red, green, blue and alpha.
//!
//! - Colour: as rendered, alpha 255.
//! - Instances: the [`instance_color`] of what is seen, alpha 255.
//! - Depth: metres along the camera's axis, as a share of [`FAR_M`] in three digits to the base 255, the first in red, the
//!   last in blue: `depth_m = 1000 * (red / 255 + green / 255² + blue / 255³)`. Alpha is 0.
//! - Normals: in the camera's frame, x right, y up, z towards the camera, each from -1 to 1 as 0 to 255; alpha 255.

use base64::{Engine as _, engine::general_purpose::STANDARD};
use cohabit_bus::message::{FrameView, Plane};
use cohabit_render::instance_color;
use cohabit_world::Vec3;

/// What the depth of 1 stands for: how far clients' cameras see, m.
const FAR_M: f64 = 1000.0;
/// The base of the digits of a depth.
const BASE: u32 = 255;

/// The pictures of one frame: of each kind one a view.
#[derive(Debug, Default)]
pub struct Pictures {
    pub color: Vec<String>,
    pub depth: Vec<String>,
    pub normals: Vec<String>,
    pub instances: Vec<String>,
}

/// Why there are no pictures.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// It cannot be encoded.
    #[error("a picture could not be encoded: {0}")]
    Encode(#[from] png::EncodingError),
    /// The camera has delivered less than it should.
    #[error("the frame has no plane `{}`", .0.name())]
    Plane(Plane),
}

impl Pictures {
    /// Those of a frame that has all planes.
    ///
    /// # Errors
    /// [`PictureError`].
    pub fn of(frame: &FrameView<'_>) -> Result<Self, PictureError> {
        let plane = |plane| frame.plane(plane).ok_or(PictureError::Plane(plane));
        let bytes = frame.header.width as usize * frame.header.height as usize * Plane::BYTES;
        let paper = &mut Paper { size: [frame.header.width, frame.header.height], bytes: vec![0; bytes] };
        let mut pictures = Self::default();
        for view in plane(Plane::Color)?.chunks(bytes) {
            pictures.color.push(encode(paper.size, view)?);
        }
        for view in plane(Plane::Depth)?.chunks(bytes) {
            pictures.depth.push(paper.paint(view, |pixel| depth_digits(f32::from_le_bytes(pixel)))?);
        }
        for (view, index) in plane(Plane::Normals)?.chunks(bytes).zip(0_u8..) {
            let axes = Axes::of(frame, index);
            pictures.normals.push(paper.paint(view, |pixel| axes.paint(pixel.map(|side| side as i8)))?);
        }
        for view in plane(Plane::Ids)?.chunks(bytes) {
            pictures.instances.push(paper.paint(view, |pixel| opaque(instance_color(u32::from_le_bytes(pixel))))?);
        }
        Ok(pictures)
    }
}

/// Where a picture is painted before it is encoded.
struct Paper {
    size: [u32; 2],
    bytes: Vec<u8>,
}

impl Paper {
    /// A picture whose pixels follow from those of a plane.
    fn paint(&mut self, plane: &[u8], color: impl Fn([u8; 4]) -> [u8; 4]) -> Result<String, PictureError> {
        // Neighbours are often alike.
        let (mut last, mut painted) = ([0; 4], color([0; 4]));
        for (from, to) in plane.as_chunks().0.iter().zip(self.bytes.as_chunks_mut().0) {
            if *from != last {
                (last, painted) = (*from, color(*from));
            }
            *to = painted;
        }
        encode(self.size, &self.bytes)
    }
}

const fn opaque([red, green, blue]: [u8; 3]) -> [u8; 4] {
    [red, green, blue, 255]
}

/// A depth as three digits.
fn depth_digits(depth_m: f32) -> [u8; 4] {
    let most = BASE.pow(3) - 1;
    let all = ((f64::from(depth_m) / FAR_M * f64::from(BASE.pow(3))).round().max(0.0) as u32).min(most);
    let digit = |place: u32| (all / BASE.pow(place) % BASE) as u8;
    [digit(2), digit(1), digit(0), 0]
}

/// A camera's frame.
struct Axes {
    right: Vec3,
    up: Vec3,
    back: Vec3,
}

impl Axes {
    /// Of the picture at that place of a frame: each looks 90 degrees more to the right.
    fn of(frame: &FrameView<'_>, index: u8) -> Self {
        let yaw_rad = frame.header.yaw_rad - f32::from(index) * std::f32::consts::FRAC_PI_2;
        let (sin_yaw, cos_yaw) = libm::sincosf(yaw_rad);
        let (sin_pitch, cos_pitch) = libm::sincosf(frame.header.pitch_rad);
        let right = Vec3::new(sin_yaw, -cos_yaw, 0.0);
        let back = -Vec3::new(cos_pitch * cos_yaw, cos_pitch * sin_yaw, sin_pitch);
        Self { right, up: back.cross(right), back }
    }

    /// The colour of a normal in the world, whose sides are times 127; of none, the middle.
    fn paint(&self, [x, y, z, _]: [i8; 4]) -> [u8; 4] {
        let normal = Vec3::new(f32::from(x), f32::from(y), f32::from(z)) / 127.0;
        let side = |axis: Vec3| ((normal.dot(axis) * 0.5 + 0.5) * 255.0).round().clamp(0.0, 255.0) as u8;
        [side(self.right), side(self.up), side(self.back), 255]
    }
}

/// A PNG in base64.
fn encode([width, height]: [u32; 2], rgba: &[u8]) -> Result<String, PictureError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fastest);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(rgba)?;
    writer.finish()?;
    Ok(STANDARD.encode(bytes))
}

#[cfg(test)]
mod tests {
    use cohabit_bus::{Block, message::FrameLayout};

    use super::*;

    /// The depth that a client reads.
    fn depth_of([red, green, blue, _]: [u8; 4]) -> f64 {
        let [red, green, blue] = [red, green, blue].map(f64::from);
        1000.0 * (red / 255.0 + green / 255_f64.powi(2) + blue / 255_f64.powi(3))
    }

    #[test]
    fn depths_are_read_as_they_were_written() {
        for depth_m in [0.0, 0.03, 0.5, 1.4616, 3.92, 3.93, 28.4, 100.0] {
            let read = depth_of(depth_digits(depth_m));
            assert!((read - f64::from(depth_m)).abs() < 1e-4, "{depth_m} m is read as {read}");
        }
        assert_eq!(depth_digits(-1.0), [0; 4]);
        assert_eq!(depth_digits(f32::NAN), [0; 4]);
        assert_eq!(depth_digits(f32::INFINITY), [254, 254, 254, 0]);
        assert!(depth_digits(4.0)[0] == 1 && depth_digits(3.9)[0] == 0);
    }

    /// The colour of a normal, seen by a camera that looks there.
    fn painted(yaw_rad: f32, pitch_rad: f32, view: u8, normal: [i8; 4]) -> [u8; 4] {
        let layout = FrameLayout::new(16, 16, 4, &[], 0);
        let mut blocks = vec![Block::default(); Block::count_for(layout.bytes())];
        let payload = &mut bytemuck::cast_slice_mut(&mut blocks)[..layout.bytes()];
        let header = layout.split_mut(payload).header;
        (header.yaw_rad, header.pitch_rad) = (yaw_rad, pitch_rad);
        Axes::of(&FrameView::new(payload).expect("a frame"), view).paint(normal)
    }

    #[test]
    fn normals_are_those_that_the_camera_sees() {
        let (east, north, up) = ([127, 0, 0, 0], [0, 127, 0, 0], [0, 0, 127, 0]);
        let quarter = std::f32::consts::FRAC_PI_2;
        let check = |yaw, pitch, view, normal, expected| {
            let color = painted(yaw, pitch, view, normal);
            let near = color.iter().zip(expected).all(|(one, other): (&u8, u8)| one.abs_diff(other) <= 1);
            assert!(near, "{yaw} {pitch} {view} {normal:?}: {color:?}");
        };
        // A floor; a wall that faces the camera, which looks west; one on its left, which faces north.
        check(0.3, 0.0, 0, up, [128, 255, 128, 255]);
        check(2.0 * quarter, 0.0, 0, east, [128, 128, 255, 255]);
        check(2.0 * quarter, 0.0, 0, north, [255, 128, 128, 255]);
        // The same wall in the picture to the right of one that looks south.
        check(-quarter, 0.0, 1, east, [128, 128, 255, 255]);
        // Looking straight down, the floor faces the camera; nothing faces nowhere.
        check(0.0, -quarter, 0, up, [128, 128, 255, 255]);
        check(0.0, 0.0, 0, [0; 4], [128, 128, 128, 255]);
    }
}
