//! Pictures of a data set, decoded.

use std::io::Cursor;

use png::{BitDepth, ColorType, Decoder};

/// The numbers of a picture, row by row from the top.
#[derive(Debug, PartialEq)]
pub(crate) enum Pixels {
    /// Red, green, blue.
    Rgb(Vec<[u8; 3]>),
    /// 16 bits each.
    Gray(Vec<u16>),
}

/// Decodes a PNG file; says what is wrong with it.
pub(crate) fn decode(file: &[u8], size: [u32; 2]) -> Result<Pixels, String> {
    let mut reader = Decoder::new(Cursor::new(file)).read_info().map_err(|error| error.to_string())?;
    let mut bytes = vec![0; reader.output_buffer_size().ok_or("the picture is too large")?];
    let info = reader.next_frame(&mut bytes).map_err(|error| error.to_string())?;
    if [info.width, info.height] != size {
        return Err(format!(
            "the picture has {}x{} pixels instead of {}x{}",
            info.width, info.height, size[0], size[1]
        ));
    }
    match (info.color_type, info.bit_depth) {
        (ColorType::Rgb, BitDepth::Eight) => Ok(Pixels::Rgb(bytes.as_chunks::<3>().0.to_vec())),
        (ColorType::Grayscale, BitDepth::Sixteen) => {
            Ok(Pixels::Gray(bytes.as_chunks::<2>().0.iter().map(|pair| u16::from_be_bytes(*pair)).collect()))
        }
        (color, depth) => {
            Err(format!("the picture is {color:?} with {depth:?} bits, neither RGB with 8 nor gray with 16"))
        }
    }
}
