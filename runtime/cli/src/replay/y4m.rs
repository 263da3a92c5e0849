//! Video without compression, which every player and encoder reads: YUV4MPEG2 with 4:2:0 colours.

use std::{
    fs::File,
    io::{self, BufWriter, Write},
    path::Path,
};

use super::picture::Picture;

/// A video that is being written.
pub struct Video {
    out: BufWriter<File>,
    rate_hz: f32,
    size: Option<[u32; 2]>,
}

impl Video {
    /// Begins a video file, so many pictures a second; one that is there is replaced.
    pub fn create(path: &Path, rate_hz: f32) -> io::Result<Self> {
        Ok(Self { out: BufWriter::with_capacity(1 << 20, File::create(path)?), rate_hz, size: None })
    }

    /// Appends a picture; all are of the size of the first.
    pub fn push(&mut self, picture: &Picture) -> io::Result<()> {
        let [width, height] = picture.size;
        if self.size.is_none() {
            let thousandths = (self.rate_hz * 1e3).round() as u32;
            writeln!(self.out, "YUV4MPEG2 W{width} H{height} F{thousandths}:1000 Ip A1:1 C420jpeg")?;
        }
        if *self.size.get_or_insert(picture.size) != picture.size {
            return Err(io::Error::other("pictures of one video are of one size"));
        }
        self.out.write_all(b"FRAME\n")?;
        self.out.write_all(&planes(&picture.rgb, [width as usize, height as usize]))
    }

    /// Ends the file.
    pub fn finish(mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// Full-range BT.601: brightness of every pixel, then the two colours of every square of four.
fn planes(rgb: &[u8], [width, height]: [usize; 2]) -> Vec<u8> {
    let pixel = |x: usize, y: usize| {
        let at = 3 * (y.min(height - 1) * width + x.min(width - 1));
        [rgb[at], rgb[at + 1], rgb[at + 2]].map(f32::from)
    };
    let byte = |value: f32| value.round().clamp(0.0, 255.0) as u8;
    let mut bytes = Vec::with_capacity(width * height * 3 / 2 + width + height + 1);
    bytes.extend(rgb.chunks_exact(3).map(|pixel| {
        let [red, green, blue] = [pixel[0], pixel[1], pixel[2]].map(f32::from);
        byte(0.299 * red + 0.587 * green + 0.114 * blue)
    }));
    let squares: Vec<[f32; 3]> = (0..height.div_ceil(2))
        .flat_map(|y| (0..width.div_ceil(2)).map(move |x| (2 * x, 2 * y)))
        .map(|(x, y)| {
            let four = [pixel(x, y), pixel(x + 1, y), pixel(x, y + 1), pixel(x + 1, y + 1)];
            std::array::from_fn(|color| four.iter().map(|pixel| pixel[color]).sum::<f32>() / 4.0)
        })
        .collect();
    bytes.extend(
        squares.iter().map(|[red, green, blue]| byte(128.0 - 0.168_736 * red - 0.331_264 * green + 0.5 * blue)),
    );
    bytes.extend(
        squares.iter().map(|[red, green, blue]| byte(128.0 + 0.5 * red - 0.418_688 * green - 0.081_312 * blue)),
    );
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_told_apart() {
        let grey = planes(&[90; 3 * 3 * 3], [3, 3]);
        assert_eq!(grey.len(), 9 + 4 + 4);
        assert!(grey[..9].iter().all(|byte| *byte == 90) && grey[9..].iter().all(|byte| *byte == 128));
        let red = planes(&[255, 0, 0], [1, 1]);
        assert_eq!(red, [76, 85, 255]);
    }
}
