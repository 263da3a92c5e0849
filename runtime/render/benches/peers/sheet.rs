//! The contenders' pictures side by side, and how far they show the same.

use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::Path;

use crate::contender::raw_name;

/// One contender's picture.
struct Picture {
    color: Vec<[u8; 3]>,
    depth_m: Vec<f32>,
    objects: Vec<i32>,
}

impl Picture {
    fn read(path: &Path, pixels: usize) -> io::Result<Self> {
        let raw = fs::read(path)?;
        if raw.len() != pixels * 11 {
            return Err(io::Error::other(format!("{} is not {pixels} pixels long", path.display())));
        }
        let (color, rest) = raw.split_at(pixels * 3);
        let (depth, objects) = rest.as_chunks().0.split_at(pixels);
        Ok(Self {
            color: color.as_chunks().0.to_vec(),
            depth_m: depth.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect(),
            objects: objects.iter().map(|bytes| i32::from_le_bytes(*bytes)).collect(),
        })
    }

    /// Colour, depth and objects as they are shown.
    fn shown(&self, pixel: usize) -> [[u8; 3]; 3] {
        let grey = 255 - (self.depth_m[pixel] * 25.0).clamp(0.0, 255.0) as u8;
        let [red, green, blue, _] = (self.objects[pixel] as u32 + 1).wrapping_mul(0x9E37_79B1).to_be_bytes();
        [self.color[pixel], [grey; 3], [red, green, blue]]
    }
}

/// Writes a sheet a camera, a column a contender, and says where others show what the first one shows.
pub fn write(folder: &Path, names: &[String], cameras: usize, [width, height]: [u32; 2]) -> io::Result<()> {
    let (columns, rows) = (width as usize, height as usize);
    let pixels = columns * rows;
    let mut alike = vec![[0; 2]; names.len()];
    for camera in 0..cameras {
        let read = |name: &String| Picture::read(&folder.join(raw_name(name, camera)), pixels);
        let pictures = names.iter().map(read).collect::<io::Result<Vec<_>>>()?;
        for (other, alike) in pictures.iter().zip(&mut alike) {
            let first = &pictures[0];
            alike[0] += first.objects.iter().zip(&other.objects).filter(|(a, b)| a == b).count();
            let near = |(a, b): &(&f32, &f32)| (*a - *b).abs() < 0.02 * *a;
            alike[1] += first.depth_m.iter().zip(&other.depth_m).filter(near).count();
        }
        let mut sheet = Vec::with_capacity(pixels * names.len() * 9);
        for row in 0..rows * 3 {
            for picture in &pictures {
                let first = row % rows * columns;
                (first..first + columns).for_each(|pixel| sheet.extend(picture.shown(pixel)[row / rows]));
            }
        }
        let file = BufWriter::new(File::create(folder.join(format!("{camera}.png")))?);
        let mut encoder = png::Encoder::new(file, width * names.len() as u32, height * 3);
        encoder.set_color(png::ColorType::Rgb);
        encoder.write_header()?.write_image_data(&sheet)?;
    }
    for (name, alike) in names.iter().zip(alike) {
        let [objects, depths] = alike.map(|count| 100.0 * count as f64 / (pixels * cameras) as f64);
        println!("{name}: same object on {objects:.1} % of the pixels, same depth within 2 % on {depths:.1} %");
    }
    Ok(())
}
