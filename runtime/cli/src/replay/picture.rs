//! A plane of a frame as a picture for people, or for programs that read PNG files.

use std::{collections::BTreeMap, fs::File, io::BufWriter, path::Path};

use cohabit_bus::message::{FrameView, Plane};

/// Where a picture of distances is black, m: farther than any view in an office.
const FARTHEST_M: f32 = 20.0;

/// What of a frame is shown.
#[derive(Clone, Copy, Debug, Eq, PartialEq, clap::ValueEnum)]
pub enum Modality {
    /// What a camera sees
    Color,
    /// How far away things are: millimetres in 16 bits, 0 is nothing; in a video, the nearer the brighter
    Depth,
    /// Which way surfaces look in the world: x, y and z as red, green and blue
    Normals,
    /// Which thing is where, a colour each; `ids.csv` beside the pictures tells whose
    Ids,
}

impl Modality {
    /// The plane that it is.
    pub const fn plane(self) -> Plane {
        match self {
            Self::Color => Plane::Color,
            Self::Depth => Plane::Depth,
            Self::Normals => Plane::Normals,
            Self::Ids => Plane::Ids,
        }
    }
}

/// Red, green and blue, row by row; the pictures of a panorama one above the other.
pub struct Picture {
    /// Pixels across and down.
    pub size: [u32; 2],
    /// Three bytes a pixel.
    pub rgb: Vec<u8>,
}

impl Picture {
    /// That of a frame; none if the frame lacks the plane.
    pub fn of(frame: &FrameView<'_>, modality: Modality) -> Option<Self> {
        let size = size(frame);
        let rgb = match modality {
            Modality::Color => {
                frame.plane(Plane::Color)?.chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect()
            }
            Modality::Depth => frame.depth_m()?.iter().flat_map(|depth_m| [brightness(*depth_m); 3]).collect(),
            Modality::Normals => {
                let signed = |byte: u8| byte.wrapping_add(128);
                let pixels = frame.plane(Plane::Normals)?.chunks_exact(4);
                pixels.flat_map(|pixel| [signed(pixel[0]), signed(pixel[1]), signed(pixel[2])]).collect()
            }
            Modality::Ids => frame.ids()?.iter().flat_map(|id| color_of(*id)).collect(),
        };
        Some(Self { size, rgb })
    }

    /// Writes a PNG file.
    pub fn write(&self, path: &Path) -> anyhow::Result<()> {
        write_png(path, &self.rgb, self.size, png::ColorType::Rgb, png::BitDepth::Eight)
    }
}

/// Writes the distances of a frame as a PNG file.
pub fn write_depth(path: &Path, frame: &FrameView<'_>) -> anyhow::Result<()> {
    let millimetres = frame.depth_m().unwrap_or_default().iter().map(|depth_m| {
        if depth_m.is_finite() { (depth_m * 1e3).round().clamp(0.0, f32::from(u16::MAX)) as u16 } else { 0 }
    });
    let bytes: Vec<u8> = millimetres.flat_map(u16::to_be_bytes).collect();
    write_png(path, &bytes, size(frame), png::ColorType::Grayscale, png::BitDepth::Sixteen)
}

fn size(frame: &FrameView<'_>) -> [u32; 2] {
    [frame.header.width, frame.header.height * frame.header.views]
}

fn write_png(
    path: &Path,
    bytes: &[u8],
    [width, height]: [u32; 2],
    color: png::ColorType,
    depth: png::BitDepth,
) -> anyhow::Result<()> {
    let mut encoder = png::Encoder::new(BufWriter::new(File::create(path)?), width, height);
    encoder.set_color(color);
    encoder.set_depth(depth);
    encoder.write_header()?.write_image_data(bytes)?;
    Ok(())
}

fn brightness(depth_m: f32) -> u8 {
    let near = if depth_m > 0.0 && depth_m.is_finite() { 1.0 - (depth_m / FARTHEST_M).min(1.0) } else { 0.0 };
    (near * near * 255.0).round() as u8
}

/// A colour of its own for each id below 2^24, and for each kind of surface; nothing is black.
pub fn color_of(id: u32) -> [u8; 3] {
    // Surfaces are numbered by 256 from 2^24 on: fewer than 2^20 objects leave room for them below.
    let number = if id >> 24 == 0 { id } else { 0x00f0_0000 | ((id >> 8) & 0xffff) };
    // Odd factors and folded halves: no two numbers of 24 bits meet.
    let mixed = number.wrapping_mul(0x009e_3779) & 0x00ff_ffff;
    let folded = (mixed ^ (mixed >> 12)).wrapping_mul(0x005b_d1e5) & 0x00ff_ffff;
    let [red, green, blue, _] = folded.to_le_bytes();
    [red, green, blue]
}

/// The colours of a film of ids, with what each stands for.
pub fn write_ids(path: &Path, names: &BTreeMap<u32, String>) -> anyhow::Result<()> {
    let mut text = "color,id,name\n".to_owned();
    for (id, name) in names {
        let [red, green, blue] = color_of(*id);
        text += &format!("#{red:02x}{green:02x}{blue:02x},{id},{name}\n");
    }
    std::fs::write(path, text)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn each_thing_has_a_colour_of_its_own() {
        let objects = 0..5_000;
        let bodies = (1 << 20)..(1 << 20) + 64;
        let surfaces = (0..32).map(|room| (1 << 24) + 256 * room);
        let ids: Vec<u32> = objects.chain(bodies).chain(surfaces).collect();
        let colors: BTreeSet<_> = ids.iter().map(|id| color_of(*id)).collect();
        assert_eq!(colors.len(), ids.len());
        assert_eq!(color_of(0), [0, 0, 0]);
    }

    #[test]
    fn what_is_near_is_bright() {
        assert_eq!([0.0, f32::INFINITY, FARTHEST_M].map(brightness), [0; 3]);
        assert!(brightness(0.5) > brightness(3.0) && brightness(3.0) > brightness(9.0));
    }
}
