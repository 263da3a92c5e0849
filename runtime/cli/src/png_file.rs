//! Pictures as PNG files.

use std::{fs::File, io::BufWriter, path::Path};

/// Writes a picture as a PNG file.
pub fn write_png(
    path: &Path,
    bytes: &[u8],
    [width, height]: [u32; 2],
    color: png::ColorType,
    depth: png::BitDepth,
) -> anyhow::Result<()> {
    let mut encoder = png::Encoder::new(BufWriter::new(File::create(path)?), width, height);
    encoder.set_color(color);
    encoder.set_depth(depth);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(bytes)?;
    // One that is dropped instead says nothing of a disk that is full.
    Ok(writer.finish()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_for_which_there_is_no_room_is_said() {
        let write = |path: &str| write_png(Path::new(path), &[0; 3], [1, 1], png::ColorType::Rgb, png::BitDepth::Eight);
        assert!(write("/dev/null").is_ok() && write("/dev/full").is_err());
    }
}
