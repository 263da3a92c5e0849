//! A plane of a frame as a picture for people, or for programs that read PNG files.

use std::{collections::BTreeMap, path::Path};

use cohabit_bus::message::{FrameView, Plane};

use crate::png_file::write_png;

/// Where a picture of distances is black, m: farther than any view in an office.
const FARTHEST_M: f32 = 20.0;

/// What of a frame is shown.
#[derive(Clone, Copy, Debug, Eq, PartialEq, clap::ValueEnum)]
pub enum Modality {
    /// What a camera sees
    Color,
    /// How far away things are along the camera's axis: millimetres in 16 bits, 65535 is that far or farther, 0 is nothing; in
    /// a video, the nearer the brighter
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
    // Where nothing is seen, a frame has the distance up to which things are drawn.
    let millimetres = frame.depth_m().unwrap_or_default().iter().map(|depth_m| {
        if *depth_m < cohabit_render::FAR_M {
            (depth_m * 1e3).round().clamp(0.0, f32::from(u16::MAX)) as u16
        } else {
            0
        }
    });
    let bytes: Vec<u8> = millimetres.flat_map(u16::to_be_bytes).collect();
    write_png(path, &bytes, size(frame), png::ColorType::Grayscale, png::BitDepth::Sixteen)
}

fn size(frame: &FrameView<'_>) -> [u32; 2] {
    [frame.header.width, frame.header.height * frame.header.views]
}

fn brightness(depth_m: f32) -> u8 {
    let near = if depth_m > 0.0 && depth_m.is_finite() { 1.0 - (depth_m / FARTHEST_M).min(1.0) } else { 0.0 };
    (near * near * 255.0).round() as u8
}

/// A colour of its own for each thing and for each surface of a room, as in data sets; nothing is black.
pub fn color_of(id: u32) -> [u8; 3] {
    cohabit_render::instance_color(id)
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

    use cohabit_bus::{Block, message::FrameLayout};

    use super::*;

    #[test]
    fn each_thing_has_a_colour_of_its_own() {
        let objects = 0..5_000;
        let bodies = (1 << 20)..(1 << 20) + 64;
        let surfaces = (0..32).flat_map(|room| (0..8).map(move |surface| (1 << 24) + 256 * room + surface));
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

    #[test]
    fn where_nothing_is_seen_the_distance_is_0() {
        let layout = FrameLayout::new(3, 1, 1, &[Plane::Depth], 0);
        let mut blocks = vec![Block::default(); Block::count_for(layout.bytes())];
        let payload = &mut bytemuck::cast_slice_mut(&mut blocks)[..layout.bytes()];
        let [_, depth_m, ..] = layout.split_mut(payload).planes;
        let seen = [1.25, 80.0, cohabit_render::FAR_M];
        bytemuck::cast_slice_mut::<u8, f32>(depth_m.unwrap()).copy_from_slice(&seen);
        let path = std::env::temp_dir().join(format!("cohabit-distances-{}.png", std::process::id()));
        write_depth(&path, &FrameView::new(payload).unwrap()).unwrap();
        let decoder = png::Decoder::new(std::io::BufReader::new(std::fs::File::open(&path).unwrap()));
        let mut bytes = [0; 6];
        decoder.read_info().unwrap().next_frame(&mut bytes).unwrap();
        std::fs::remove_file(path).unwrap();
        let millimetres: Vec<u16> = bytes.as_chunks().0.iter().copied().map(u16::from_be_bytes).collect();
        assert_eq!(millimetres, [1250, u16::MAX, 0]);
    }
}
