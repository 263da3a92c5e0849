//! Planes of frames as PNG files.

use std::{
    fs,
    path::{Path, PathBuf},
};

use cohabit_bus::message::{FrameView, Plane};
use cohabit_render::instance_color;
use png::{BitDepth, ColorType, Compression, Encoder};

use crate::error::{DemonstrateError, at};

/// Millimetres a metre.
const MM: f32 = 1000.0;

/// Writes a plane of a frame as [`write_plane`] does; says whether the frame has it.
pub(crate) fn write(path: &Path, frame: &FrameView<'_>, plane: Plane) -> Result<bool, DemonstrateError> {
    let Some(bytes) = frame.plane(plane) else { return Ok(false) };
    write_plane(path, [frame.header.width, frame.header.height], plane, bytes).map(|()| true)
}

/// Writes a picture as a PNG file; `bytes` are those of the plane, `[height, width]`, row-major.
///
/// - color: red, green, blue, 8 bits each.
/// - depth: millimetres along the camera's axis, 16 bits; 65535 is all that is further away.
/// - normals: x, y, z of the surface's normal in the world as red, green, blue: -1 to 1 as 1 to 255, and 128 each where there is
///   none.
/// - ids: the `instance_color` of each id; nothing is black.
///
/// # Errors
/// [`DemonstrateError::File`], and [`DemonstrateError::Picture`] where `bytes` are not as many as the picture has.
pub fn write_plane(path: &Path, size: [u32; 2], plane: Plane, bytes: &[u8]) -> Result<(), DemonstrateError> {
    let pixels = bytes.as_chunks::<{ Plane::BYTES }>().0;
    match plane {
        Plane::Color => rgb(path, size, pixels.iter().map(|[red, green, blue, _]| [*red, *green, *blue])),
        Plane::Depth => depth(path, size, pixels),
        Plane::Normals => rgb(path, size, pixels.iter().map(|[x, y, z, _]| [*x, *y, *z].map(|side| side ^ 0x80))),
        Plane::Ids => rgb(path, size, pixels.iter().map(|id| instance_color(u32::from_le_bytes(*id)))),
    }
}

fn rgb(path: &Path, size: [u32; 2], pixels: impl Iterator<Item = [u8; 3]>) -> Result<(), DemonstrateError> {
    let bytes: Vec<u8> = pixels.flatten().collect();
    encode(path, size, (ColorType::Rgb, BitDepth::Eight), &bytes)
}

fn depth(path: &Path, size: [u32; 2], pixels: &[[u8; Plane::BYTES]]) -> Result<(), DemonstrateError> {
    let depths = pixels.iter().map(|pixel| millimetres(f32::from_le_bytes(*pixel)));
    let bytes: Vec<u8> = depths.flat_map(u16::to_be_bytes).collect();
    encode(path, size, (ColorType::Grayscale, BitDepth::Sixteen), &bytes)
}

/// A depth in whole millimetres; what is no number is far away.
fn millimetres(depth_m: f32) -> u16 {
    if depth_m.is_nan() { u16::MAX } else { (depth_m * MM).round().clamp(0.0, f32::from(u16::MAX)) as u16 }
}

fn encode(
    path: &Path,
    [width, height]: [u32; 2],
    form: (ColorType, BitDepth),
    bytes: &[u8],
) -> Result<(), DemonstrateError> {
    let failed = |source| DemonstrateError::Picture { path: PathBuf::from(path), source };
    // In memory first: what the disk refuses is then told, and told as an error of the file.
    let mut file = Vec::new();
    let mut encoder = Encoder::new(&mut file, width, height);
    encoder.set_color(form.0);
    encoder.set_depth(form.1);
    encoder.set_compression(Compression::Fast);
    let mut writer = encoder.write_header().map_err(failed)?;
    writer.write_image_data(bytes).map_err(failed)?;
    writer.finish().map_err(failed)?;
    fs::write(path, file).map_err(at(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depths_are_whole_millimetres() {
        for (depth_m, expected) in
            [(0.0, 0), (1.2344, 1234), (-1.0, 0), (65.535, 65_535), (80.0, u16::MAX), (f32::NAN, u16::MAX)]
        {
            assert_eq!(millimetres(depth_m), expected, "{depth_m}");
        }
    }

    #[test]
    fn normals_are_shifted_by_half_the_range() {
        for (side, expected) in [(0_i8, 128), (127, 255), (-127, 1)] {
            assert_eq!(side as u8 ^ 0x80, expected);
        }
    }
}
