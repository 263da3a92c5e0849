//! Colours: hexadecimal text to linear light, linear light to display bytes.

use std::sync::OnceLock;

use cohabit_cdf::{Color, Fluid};
use glam::Vec3;

/// Steps of the table from linear light to display bytes.
pub(crate) const STEPS: usize = 4096;
/// Linear light that is shown as white.
pub const WHITE: f32 = 2.0;
/// Linear light up to which nothing is changed.
const KNEE: f32 = 0.6;

/// The linear light of `#rrggbb`, or nothing if it is not of that form.
pub(crate) fn parse_hex(text: &str) -> Option<Vec3> {
    srgb_of_hex(text).map(from_srgb)
}

/// The display bytes of `#rrggbb`, or nothing if it is not of that form.
pub(crate) fn srgb_of_hex(text: &str) -> Option<[u8; 3]> {
    let digits = text.strip_prefix('#').filter(|rest| rest.len() == 6 && rest.is_ascii())?;
    let value = u32::from_str_radix(digits, 16).ok()?;
    Some([(value >> 16) as u8, (value >> 8) as u8, value as u8])
}

/// The linear light of display bytes.
#[must_use]
pub fn from_srgb(bytes: [u8; 3]) -> Vec3 {
    let channel = |byte: u8| {
        let c = f32::from(byte) / 255.0;
        if c <= 0.04045 { c / 12.92 } else { libm::powf((c + 0.055) / 1.055, 2.4) }
    };
    Vec3::new(channel(bytes[0]), channel(bytes[1]), channel(bytes[2]))
}

/// The table behind `to_srgb`, made once.
#[must_use]
pub fn srgb_table() -> &'static [u8; STEPS] {
    static TABLE: OnceLock<Box<[u8; STEPS]>> = OnceLock::new();
    TABLE.get_or_init(|| {
        let mut table = Box::new([0; STEPS]);
        for (step, entry) in table.iter_mut().enumerate() {
            let c = roll_off(step as f32 / (STEPS - 1) as f32 * WHITE);
            let s = if c <= 0.003_130_8 { c * 12.92 } else { 1.055 * libm::powf(c, 1.0 / 2.4) - 0.055 };
            *entry = (s * 255.0 + 0.5) as u8;
        }
        table
    })
}

/// Bright light approaches white slowly, so that lit surfaces keep their pattern.
fn roll_off(c: f32) -> f32 {
    if c <= KNEE {
        return c;
    }
    let (room, over) = (1.0 - KNEE, c - KNEE);
    // Meets the line at the knee with the same slope, and reaches 1 at white.
    let t = over / (WHITE - KNEE);
    let bend = (WHITE - KNEE) / room;
    KNEE + room * (1.0 - libm::powf(1.0 - t, bend))
}

/// Where in the table a channel's display byte stands; its lower twelve bits count.
#[inline(always)]
pub(crate) fn step(c: f32) -> u32 {
    // Beside this large number the last bits of a float are its whole part: much cheaper than a conversion.
    const LARGE: f32 = 8_388_608.0;
    let c = if c > 0.0 { c } else { 0.0 };
    let c = if c < WHITE { c } else { WHITE };
    (c * ((STEPS - 1) as f32 / WHITE) + LARGE).to_bits()
}

/// Display bytes of linear light.
#[inline(always)]
pub(crate) fn to_srgb(table: &[u8; STEPS], light: Vec3) -> [u8; 3] {
    let channel = |c: f32| table[step(c) as usize & (STEPS - 1)];
    [channel(light.x), channel(light.y), channel(light.z)]
}

/// What replaces the tint of an object that was coloured.
pub(crate) fn of_color(color: Color) -> Option<Vec3> {
    match color {
        Color::Original => None,
        Color::Red => Some(from_srgb([190, 48, 42])),
        Color::Green => Some(from_srgb([62, 142, 70])),
        Color::Blue => Some(from_srgb([48, 92, 178])),
    }
}

/// What a fluid looks like.
pub(crate) fn of_fluid(fluid: Fluid) -> Vec3 {
    match fluid {
        Fluid::None | Fluid::Water => from_srgb([120, 178, 214]),
        Fluid::Milk => from_srgb([240, 236, 226]),
        Fluid::Coffee => from_srgb([72, 42, 24]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn display_bytes_come_back() {
        // Up to the knee, and but for the table's steps, which are coarser than the bytes near black.
        for byte in 0..=200 {
            let back = to_srgb(srgb_table(), from_srgb([byte; 3]))[0];
            assert!(back.abs_diff(byte) <= if byte < 24 { 3 } else { 1 }, "{byte} came back as {back}");
        }
        assert_eq!(to_srgb(srgb_table(), Vec3::splat(9.0)), [255; 3]);
        assert_eq!(to_srgb(srgb_table(), Vec3::splat(-1.0)), [0; 3]);
    }

    #[test]
    fn only_six_digits_are_a_color() {
        assert_eq!(parse_hex("#000000"), Some(Vec3::ZERO));
        for bad in ["", "#12345", "123456", "#12345g", "#éabcd"] {
            assert_eq!(parse_hex(bad), None, "{bad}");
        }
    }
}
