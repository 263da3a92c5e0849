//! Outlines around highlighted instances.

use crate::instance::Highlight;

/// Pixels of the outline for every so many rows of the picture.
const ROWS_A_PIXEL: usize = 220;

/// Paints a coloured rim around each highlighted instance, and a breath of colour over it.
pub(crate) fn run(color: &mut [u8], mask: &mut Vec<u8>, ids: &[u32], highlights: &[Highlight], width: usize) {
    let height = ids.len() / width;
    let reach = (height / ROWS_A_PIXEL).clamp(1, 6) as isize + 1;
    let pixels = color.as_chunks_mut::<4>().0;
    for highlight in highlights {
        mask.clear();
        mask.extend(ids.iter().map(|id| u8::from(*id == highlight.id)));
        for y in 0..height as isize {
            for x in 0..width as isize {
                let at = y as usize * width + x as usize;
                if mask[at] == 1 {
                    blend(&mut pixels[at], highlight.color, 0.10);
                    continue;
                }
                let strength = rim(mask, x, y, reach, width as isize, height as isize);
                if strength > 0.0 {
                    blend(&mut pixels[at], highlight.color, strength);
                }
            }
        }
    }
}

/// How strongly the rim covers a pixel outside of the mask: fully next to it, fading at the rim's outer edge.
fn rim(mask: &[u8], x: isize, y: isize, reach: isize, width: isize, height: isize) -> f32 {
    let mut nearest = f32::MAX;
    for dy in -reach..=reach {
        let row = y + dy;
        if row < 0 || row >= height {
            continue;
        }
        let (from, to) = ((x - reach).max(0), (x + reach).min(width - 1));
        for column in from..=to {
            if mask[(row * width + column) as usize] == 1 {
                let dx = column - x;
                nearest = nearest.min((dx * dx + dy * dy) as f32);
            }
        }
    }
    if nearest == f32::MAX { 0.0 } else { (reach as f32 + 0.5 - nearest.sqrt()).clamp(0.0, 1.0) }
}

fn blend(pixel: &mut [u8; 4], color: [u8; 3], amount: f32) {
    for (channel, target) in pixel.iter_mut().zip(color) {
        let (a, b) = (f32::from(*channel), f32::from(target));
        *channel = (a + (b - a) * amount + 0.5) as u8;
    }
}
