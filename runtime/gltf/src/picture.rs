//! Pictures of textures: decoded, made small, and averaged over triangles.

use std::io::Cursor;

use gltf_json::{
    texture::{Sampler, WrappingMode},
    validation::Checked,
};
use png::{Decoder, Transformations};
use zune_jpeg::{
    JpegDecoder,
    zune_core::{bytestream::ZCursor, colorspace::ColorSpace, options::DecoderOptions},
};

use crate::error::GltfError;

/// The most pixels of a picture: 8192 by 4096.
const MOST_PIXELS: u64 = 1 << 25;
/// No side is longer once a picture was made small: triangles show means of many pixels anyway.
const LONGEST_SIDE: usize = 512;
/// Along each side of a triangle, so many places of the picture are looked at, at most.
const MOST_STEPS: u16 = 12;

/// What the numbers of a picture mean.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub(crate) enum Meaning {
    /// Colours, which become linear light.
    Color,
    /// Shares, which stay as they are.
    Shares,
}

/// How a picture is written.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Kind {
    Png,
    Jpeg,
}

/// A picture, small, with what it hides.
#[derive(Debug)]
pub(crate) struct Picture {
    size: [usize; 2],
    texels: Vec<[f32; 4]>,
}

/// How a picture goes on beyond its edges, along both directions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wrap([WrappingMode; 2]);

impl Wrap {
    pub(crate) fn of(sampler: Option<&Sampler>) -> Self {
        let mode = |mode: &Checked<WrappingMode>| match mode {
            Checked::Valid(mode) => *mode,
            Checked::Invalid => WrappingMode::Repeat,
        };
        Self(sampler.map_or([WrappingMode::Repeat; 2], |sampler| [mode(&sampler.wrap_s), mode(&sampler.wrap_t)]))
    }
}

impl Picture {
    /// Decodes PNG or JPEG; `at` is where it stands.
    pub(crate) fn read(bytes: &[u8], meaning: Meaning, at: &str) -> Result<Self, GltfError> {
        let (kind, size) = measure(bytes).ok_or_else(|| {
            GltfError::at(at, "neither PNG nor JPEG, or cut off: save the texture as PNG and export the model anew")
        })?;
        let pixels = size.iter().map(|side| u64::from(*side)).product::<u64>();
        if pixels == 0 || pixels > MOST_PIXELS {
            let reason = format!("a picture of {} by {} pixels: at most {MOST_PIXELS} pixels", size[0], size[1]);
            return Err(GltfError::at(at, format!("{reason}: make the texture smaller")));
        }
        let size = size.map(|side| side as usize);
        let pixels = match kind {
            Kind::Png => of_png(bytes).map_err(|error| error.to_string()),
            Kind::Jpeg => of_jpeg(bytes).map_err(|error| error.to_string()),
        };
        let pixels = pixels.and_then(|(pixels, channels)| {
            let picture = Self::small(&pixels, channels, size, meaning);
            picture.ok_or_else(|| format!("of {} by {} pixels some are missing", size[0], size[1]))
        });
        pixels.map_err(|error| GltfError::at(at, format!("the picture is broken: {error}")))
    }

    /// Means of squares of pixels; nothing where some are missing.
    fn small(pixels: &[u8], channels: usize, full: [usize; 2], meaning: Meaning) -> Option<Self> {
        if pixels.len() < full[0] * full[1] * channels {
            return None;
        }
        let step = full[0].max(full[1]).div_ceil(LONGEST_SIDE);
        let size = full.map(|side| side.div_ceil(step));
        let light: Vec<f32> = match meaning {
            Meaning::Color => (0..=255).map(linear).collect(),
            Meaning::Shares => (0..=255_u8).map(|value| f32::from(value) / 255.0).collect(),
        };
        let texel = |x: usize, y: usize| -> [f32; 4] {
            let at = (y * full[0] + x) * channels;
            let channel = |channel: usize| usize::from(pixels[at + channel]);
            let gray = light[channel(0)];
            match channels {
                1 => [gray, gray, gray, 1.0],
                2 => [gray, gray, gray, channel(1) as f32 / 255.0],
                3 => [gray, light[channel(1)], light[channel(2)], 1.0],
                _ => [gray, light[channel(1)], light[channel(2)], channel(3) as f32 / 255.0],
            }
        };
        let mean = |column: usize, row: usize| {
            let (left, top) = (column * step, row * step);
            let (right, bottom) = ((left + step).min(full[0]), (top + step).min(full[1]));
            let all = (top..bottom).flat_map(|y| (left..right).map(move |x| texel(x, y)));
            mean(all)
        };
        let texels = (0..size[1]).flat_map(|row| (0..size[0]).map(move |column| mean(column, row))).collect();
        Some(Self { size, texels })
    }

    /// The mean of what a triangle shows of it, by the places of its corners.
    pub(crate) fn over(&self, corners: [[f32; 2]; 3], wrap: Wrap) -> [f32; 4] {
        let [a, b, c] = corners;
        let texels = |from: [f32; 2], to: [f32; 2]| {
            let along = |axis: usize| (to[axis] - from[axis]).abs() * self.size[axis] as f32;
            along(0).max(along(1))
        };
        let longest = texels(a, b).max(texels(b, c)).max(texels(c, a));
        let steps = if longest < f32::from(MOST_STEPS) { (longest as u16).max(1) } else { MOST_STEPS };
        // The middles of small triangles into which it is divided, those that stand on their tips too.
        let upright = (0..steps).flat_map(|i| (0..steps - i).map(move |j| (i, j, 1.0)));
        let turned = (1..steps).flat_map(|i| (1..=steps - i).map(move |j| (i, j, -1.0)));
        let places = upright.chain(turned).map(|(i, j, way)| {
            let at = |step: u16| (f32::from(step) + way / 3.0) / f32::from(steps);
            let (u, v) = (at(i), at(j));
            [0, 1].map(|axis| a[axis] + (b[axis] - a[axis]) * u + (c[axis] - a[axis]) * v)
        });
        mean(places.map(|place| self.texel(place, wrap)))
    }

    fn texel(&self, place: [f32; 2], wrap: Wrap) -> [f32; 4] {
        let [column, row] = [0, 1].map(|axis| {
            let inside = match wrap.0[axis] {
                _ if !place[axis].is_finite() => 0.0,
                WrappingMode::ClampToEdge => place[axis].clamp(0.0, 1.0),
                WrappingMode::Repeat => place[axis].rem_euclid(1.0),
                WrappingMode::MirroredRepeat => 1.0 - (place[axis].rem_euclid(2.0) - 1.0).abs(),
            };
            ((inside * self.size[axis] as f32) as usize).min(self.size[axis] - 1)
        });
        self.texels[row * self.size[0] + column]
    }
}

/// The mean of at least one.
fn mean(all: impl Iterator<Item = [f32; 4]>) -> [f32; 4] {
    let add = |(sum, count): ([f32; 4], f32), one: [f32; 4]| ([0, 1, 2, 3].map(|at| sum[at] + one[at]), count + 1.0);
    let (sum, count) = all.fold(([0.0; 4], 0.0), add);
    sum.map(|channel| channel / f32::max(count, 1.0))
}

/// Linear light of a channel as pictures have it.
pub(crate) fn linear(value: u8) -> f32 {
    let value = f32::from(value) / 255.0;
    if value <= 0.040_45 { value / 12.92 } else { libm::powf((value + 0.055) / 1.055, 2.4) }
}

/// The kind of a picture, and its width and height, from its first bytes.
fn measure(bytes: &[u8]) -> Option<(Kind, [u32; 2])> {
    if bytes.starts_with(b"\x89PNG\r\n\x1a\n") && bytes.get(12..16)? == b"IHDR" {
        let side = |at: usize| Some(u32::from_be_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
        return Some((Kind::Png, [side(16)?, side(20)?]));
    }
    // Segments of JPEG up to the one that begins a frame.
    let mut rest = bytes.strip_prefix(b"\xff\xd8")?;
    loop {
        let [0xff, kind, high, low, ..] = *rest else { return None };
        match kind {
            0xff => rest = &rest[1..],
            0xc0..=0xcf if !matches!(kind, 0xc4 | 0xc8 | 0xcc) => {
                let side = |at: usize| Some(u32::from(u16::from_be_bytes(rest.get(at..at + 2)?.try_into().ok()?)));
                return Some((Kind::Jpeg, [side(7)?, side(5)?]));
            }
            _ => rest = rest.get(2 + usize::from(u16::from_be_bytes([high, low]))..)?,
        }
    }
}

/// The channels of all pixels, of 8 bits each, and how many of a pixel.
type Pixels = (Vec<u8>, usize);

fn of_png(bytes: &[u8]) -> Result<Pixels, png::DecodingError> {
    let mut decoder = Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(Transformations::normalize_to_color8());
    let mut reader = decoder.read_info()?;
    let mut pixels = vec![0; reader.output_buffer_size().unwrap_or_default()];
    let frame = reader.next_frame(&mut pixels)?;
    Ok((pixels, frame.color_type.samples()))
}

fn of_jpeg(bytes: &[u8]) -> Result<Pixels, zune_jpeg::errors::DecodeErrors> {
    let options = DecoderOptions::default().jpeg_set_out_colorspace(ColorSpace::RGB);
    Ok((JpegDecoder::new_with_options(ZCursor::new(bytes), options).decode()?, 3))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn png(size: [u32; 2], kind: png::ColorType, bytes: &[u8]) -> Vec<u8> {
        let mut all = Vec::new();
        let mut encoder = png::Encoder::new(&mut all, size[0], size[1]);
        encoder.set_color(kind);
        encoder.write_header().unwrap().write_image_data(bytes).unwrap();
        all
    }

    const LEFT: [[f32; 2]; 3] = [[0.0, 0.0], [0.499, 0.0], [0.0, 1.0]];
    const REPEAT: Wrap = Wrap([WrappingMode::Repeat; 2]);

    #[test]
    fn a_triangle_shows_the_mean_of_what_lies_under_it() {
        // The left half is red, the right half is blue.
        let row: Vec<u8> = [[255, 0, 0]; 8].into_iter().chain([[0, 0, 255]; 8]).flatten().collect();
        let picture =
            Picture::read(&png([16, 16], png::ColorType::Rgb, &row.repeat(16)), Meaning::Color, "images[0]").unwrap();
        assert_eq!(picture.over(LEFT, REPEAT), [1.0, 0.0, 0.0, 1.0]);
        let right = LEFT.map(|[u, v]| [u + 0.5, v]);
        assert_eq!(picture.over(right, REPEAT), [0.0, 0.0, 1.0, 1.0]);
        assert_eq!(picture.over(right.map(|[u, v]| [u - 7.0, v + 3.0]), REPEAT), [0.0, 0.0, 1.0, 1.0]);
        assert_eq!(
            picture.over(right.map(|[u, v]| [u + 1.0, v]), Wrap([WrappingMode::MirroredRepeat; 2])),
            [1.0, 0.0, 0.0, 1.0]
        );
        assert_eq!(
            picture.over(LEFT.map(|[u, v]| [u - 7.0, v]), Wrap([WrappingMode::ClampToEdge; 2])),
            [1.0, 0.0, 0.0, 1.0]
        );
        let whole = picture.over([[0.0, 0.0], [1.0, 0.0], [0.5, 1.0]], REPEAT);
        assert!((whole[0] - 0.5).abs() < 0.05 && (whole[2] - 0.5).abs() < 0.05, "{whole:?}");
        assert_eq!(picture.over([[f32::NAN, 0.0]; 3], REPEAT), [1.0, 0.0, 0.0, 1.0]);
    }

    #[test]
    fn large_pictures_are_made_small_and_gray_ones_have_one_channel() {
        let picture = Picture::read(
            &png([4000, 2], png::ColorType::GrayscaleAlpha, &[255, 51].repeat(8000)),
            Meaning::Color,
            "x",
        )
        .unwrap();
        assert_eq!(picture.size, [500, 1]);
        let last = picture.texels[499];
        assert!(last[0] > 0.999 && (last[3] - 0.2).abs() < 1e-5, "{last:?}");
    }

    #[test]
    fn jpeg_is_read_too() {
        let mut bytes = Vec::new();
        let encoder = jpeg_encoder::Encoder::new(&mut bytes, 95);
        encoder.encode(&[20, 160, 60].repeat(32 * 16), 32, 16, jpeg_encoder::ColorType::Rgb).unwrap();
        assert_eq!(measure(&bytes), Some((Kind::Jpeg, [32, 16])));
        let picture = Picture::read(&bytes, Meaning::Color, "images[0]").unwrap();
        let [red, green, blue, alpha] = picture.over(LEFT, REPEAT);
        for (channel, expected) in [(red, 20), (green, 160), (blue, 60)] {
            assert!((channel - linear(expected)).abs() < 0.03, "{red} {green} {blue}");
        }
        assert_eq!(alpha, 1.0);
        for length in 0..bytes.len() {
            // Some of a picture that is cut off may be shown.
            let _ = Picture::read(&bytes[..length], Meaning::Color, "images[0]");
        }
    }

    #[test]
    fn what_is_no_picture_or_too_large_is_refused_before_it_is_decoded() {
        let said = |bytes: &[u8]| Picture::read(bytes, Meaning::Shares, "images[3]").unwrap_err().to_string();
        assert!(said(b"GIF89a").starts_with("images[3]: neither PNG nor JPEG"));
        let mut large = png([1, 1], png::ColorType::Rgb, &[0; 3]);
        large[16..24].copy_from_slice(&[0, 1, 0, 0, 0, 1, 0, 0]);
        assert!(said(&large).contains("65536 by 65536 pixels"), "{}", said(&large));
        let jpeg = b"\xff\xd8\xff\xe0\0\x04ab\xff\xc0\0\x11\x08\xff\xff\xff\xff\x03";
        assert!(said(jpeg).contains("65535 by 65535 pixels"), "{}", said(jpeg));
        let cut = png([64, 64], png::ColorType::Rgb, &[7; 3 * 64 * 64]);
        assert!(said(&cut[..40]).contains("the picture is broken"), "{}", said(&cut[..40]));
        assert!(said(b"\xff\xd8\xff\xe0\xff\xff").contains("neither"));
    }
}
