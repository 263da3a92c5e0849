//! A picture in all modalities: its hashes, and what a person sees of it.

use std::fs::{self, File};
use std::io::{BufReader, BufWriter};
use std::path::Path;

use cohabit_render::{Camera, CpuRenderer, Planes, Renderer, Scene};

use crate::hashes::fnv;

/// All planes of a camera.
pub struct Picture {
    pub size: [usize; 2],
    color: Vec<u8>,
    depth_m: Vec<f32>,
    normals: Vec<i8>,
    ids: Vec<u32>,
}

impl Picture {
    pub fn draw(renderer: &mut CpuRenderer, scene: &Scene, camera: &Camera) -> Self {
        let pixels = camera.pixels();
        let mut all = Self {
            size: [camera.width as usize, camera.height as usize],
            color: vec![0; pixels * 4],
            depth_m: vec![0.0; pixels],
            normals: vec![0; pixels * 4],
            ids: vec![0; pixels],
        };
        let mut planes = Planes {
            color: Some(&mut all.color),
            depth_m: Some(&mut all.depth_m),
            normals: Some(&mut all.normals),
            ids: Some(&mut all.ids),
        };
        renderer.render(scene, camera, &mut planes);
        all
    }

    /// In the order of [`crate::hashes::MODALITIES`].
    pub fn hashes(&self) -> [u64; 4] {
        [
            fnv(self.color.iter().copied()),
            fnv(self.depth_m.iter().flat_map(|depth| depth.to_le_bytes())),
            fnv(self.normals.iter().map(|value| *value as u8)),
            fnv(self.ids.iter().flat_map(|id| id.to_le_bytes())),
        ]
    }

    /// The colour alone.
    pub fn color(&self) -> Image {
        let rgb = self.color.as_chunks::<4>().0.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]);
        Image { size: self.size, rgb: rgb.collect() }
    }

    /// All modalities in one: colour and depth above, normals and ids below.
    pub fn all(&self) -> Image {
        let depth = |depth_m: &f32| {
            // A metre is 25 shades, and every shade has 16 tints for what lies between.
            let steps = (depth_m * 400.0).clamp(0.0, 4095.0) as u16;
            let (shade, tint) = (255 - (steps >> 4) as u8, (steps & 0xF) as u8);
            [shade, shade.saturating_sub(tint), shade]
        };
        let normal = |[x, y, z, _]: &[i8; 4]| [x, y, z].map(|c| (i16::from(*c) + 128) as u8);
        let id = |id: &u32| {
            let hash = id.wrapping_mul(0x9E37_79B1).rotate_left(11).wrapping_mul(0x85EB_CA77);
            let [r, g, b, _] = hash.to_be_bytes();
            [r, g, b]
        };
        let size = self.size;
        let of = |rgb: Vec<[u8; 3]>| Image { size, rgb: rgb.into_flattened() };
        let above = Image::beside(&[&self.color(), &of(self.depth_m.iter().map(depth).collect())]);
        let normals = of(self.normals.as_chunks().0.iter().map(normal).collect());
        let below = Image::beside(&[&normals, &of(self.ids.iter().map(id).collect())]);
        Image { size: [size[0] * 2, size[1] * 2], rgb: [above.rgb, below.rgb].concat() }
    }
}

/// Red, green, blue, row by row.
#[derive(Clone, PartialEq)]
pub struct Image {
    pub size: [usize; 2],
    pub rgb: Vec<u8>,
}

/// How far two images of one size are apart.
pub struct Distance {
    /// Of all pixels, those that differ, %.
    pub share: f64,
    /// Over all channels, of 255.
    pub mean: f64,
    pub most: u8,
}

impl Image {
    /// Images of the same height, side by side.
    pub fn beside(images: &[&Self]) -> Self {
        let (width, height) = (images.iter().map(|image| image.size[0]).sum(), images[0].size[1]);
        let mut rgb = Vec::with_capacity(width * height * 3);
        for row in 0..height {
            for image in images {
                let long = image.size[0] * 3;
                rgb.extend_from_slice(&image.rgb[row * long..(row + 1) * long]);
            }
        }
        Self { size: [width, height], rgb }
    }

    /// Every `times` by `times` pixels made one.
    pub fn smaller(&self, times: usize) -> Self {
        let size = self.size.map(|long| long / times);
        let mut rgb = Vec::with_capacity(size[0] * size[1] * 3);
        for (y, x) in (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (y, x))) {
            for channel in 0..3 {
                let at = |i: usize, j: usize| ((y * times + j) * self.size[0] + x * times + i) * 3 + channel;
                let sum: usize = (0..times * times).map(|k| usize::from(self.rgb[at(k % times, k / times)])).sum();
                rgb.push((sum / (times * times)) as u8);
            }
        }
        Self { size, rgb }
    }

    /// How they differ, eight times as strong.
    pub fn difference(&self, other: &Self) -> Self {
        let rgb = self.rgb.iter().zip(&other.rgb).map(|(a, b)| a.abs_diff(*b).saturating_mul(8)).collect();
        Self { size: self.size, rgb }
    }

    pub fn distance(&self, other: &Self) -> Distance {
        let pairs = || self.rgb.iter().zip(&other.rgb).map(|(a, b)| a.abs_diff(*b));
        let pixels = self.rgb.chunks(3).zip(other.rgb.chunks(3)).filter(|(a, b)| a != b).count();
        Distance {
            share: pixels as f64 * 300.0 / self.rgb.len() as f64,
            mean: pairs().map(f64::from).sum::<f64>() / self.rgb.len() as f64,
            most: pairs().max().unwrap_or(0),
        }
    }

    pub fn write(&self, path: &Path, compression: png::Compression) {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        let out = BufWriter::new(File::create(path).unwrap());
        let mut encoder = png::Encoder::new(out, self.size[0] as u32, self.size[1] as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(compression);
        encoder.write_header().unwrap().write_image_data(&self.rgb).unwrap();
    }

    /// Nothing where there is no such file, or none like those that [`Self::write`] writes.
    pub fn read(path: &Path) -> Option<Self> {
        let mut reader = png::Decoder::new(BufReader::new(File::open(path).ok()?)).read_info().ok()?;
        let mut rgb = vec![0; reader.output_buffer_size()?];
        let info = reader.next_frame(&mut rgb).ok()?;
        let size = [info.width as usize, info.height as usize];
        (rgb.len() == size[0] * size[1] * 3).then_some(Self { size, rgb })
    }
}
