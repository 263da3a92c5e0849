//! The small sheet of a floor plan that stands in the repository: its views in colour, for whoever has no picture of
//! before at hand.

use std::path::PathBuf;

use crate::picture::Image;
use crate::{Drawn, kept, pictures};

/// Side of the views that are shown, and how many of their pixels become one.
const SIDE: usize = 300;
const SMALLER: usize = 3;
/// Views in a row.
const COLUMNS: usize = 5;
/// Colours are rounded to so many steps: a sheet is for the eye, and small.
const STEP: u8 = 8;
/// A sheet that differs by less is left as it is, so that the repository does not grow by what nobody sees.
const NOTICED: u8 = 2 * STEP;

/// Mirrored plans have none: it would show the same again.
pub fn is_kept(layout: &str) -> bool {
    !layout.ends_with("_mirror")
}

fn path(layout: &str) -> PathBuf {
    kept().join(format!("{layout}.png"))
}

fn draw(views: &[Drawn]) -> Image {
    let side = SIDE / SMALLER;
    let shown: Vec<Image> = views
        .iter()
        .filter(|view| view.picture.size == [SIDE; 2])
        .map(|view| view.picture.color().smaller(SMALLER))
        .collect();
    let blank = Image { size: [side; 2], rgb: vec![255; side * side * 3] };
    let rows = shown.chunks(COLUMNS).map(|row| {
        let all: Vec<&Image> = row.iter().chain(std::iter::repeat(&blank)).take(COLUMNS).collect();
        Image::beside(&all).rgb
    });
    let rgb: Vec<u8> = rows.flatten().map(|byte| byte / STEP * STEP + STEP / 2).collect();
    Image { size: [side * COLUMNS, rgb.len() / 3 / (side * COLUMNS)], rgb }
}

/// The sheet of before, of now, and the difference; where they are written, if the two differ.
pub fn compare(layout: &str, views: &[Drawn]) -> Option<PathBuf> {
    let (before, now) = (Image::read(&path(layout))?, draw(views));
    if before == now || before.size != now.size {
        return None;
    }
    let out = pictures().join("changed").join(format!("{layout}.png"));
    Image::beside(&[&before, &now, &now.difference(&before)]).write(&out, png::Compression::Fast);
    Some(out)
}

/// Takes the views over, if one would notice.
pub fn bless(layout: &str, views: &[Drawn]) {
    let now = draw(views);
    let before = Image::read(&path(layout)).filter(|before| before.size == now.size);
    if before.is_none_or(|before| before.distance(&now).most > NOTICED) {
        now.write(&path(layout), png::Compression::High);
    }
}
