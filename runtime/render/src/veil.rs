//! See-through surfaces, and the rule by which every renderer draws them.
//!
//! There are two kinds. A **clear** one (a pane, a glass) is a thing to point at: id, depth and normal are its own, its
//! colour is laid over what is behind. An **airy** one (steam, a beam) is nothing but colour: id, depth and normal stay
//! those of what is behind.
//!
//! They are drawn after everything else, those first whose instance begins farthest from the eye, then in the order of
//! the scene, of pieces and of triangles; fronts alone; where nothing drawn so far is nearer. Display bytes are mixed,
//! `source * opacity + behind * (1 - opacity)`; then a clear one writes id, depth and normal.

use glam::Vec3;

use crate::color::from_srgb;
use crate::pattern::Pattern;
use crate::weather::Weather;

/// How a surface is seen through.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Veil {
    /// Colour is laid over; everything else is the surface's own.
    Clear,
    /// Colour is laid over; everything else is that of what is behind.
    Airy,
}

/// How a see-through pattern looks.
#[derive(Clone, Copy, Debug)]
pub struct VeilLook {
    /// How it is seen through.
    pub veil: Veil,
    /// How much of what is behind it hides where it is looked at squarely; a surface may have its own.
    pub squarely: f32,
    /// The same where it is looked at along the surface.
    pub glancing: f32,
    /// Strength of the lamps' highlight.
    pub shine: f32,
    /// Whether it shines by itself, with a bright core; otherwise the room lights it.
    pub shines: bool,
}

/// How a pattern looks that is seen through; nothing for others.
pub(crate) const fn look(pattern: Pattern) -> Option<VeilLook> {
    let (veil, squarely, glancing, shine, shines) = match pattern {
        Pattern::Clear => (Veil::Clear, 0.2, 0.8, 0.9, false),
        Pattern::Liquid => (Veil::Clear, 0.72, 0.92, 0.7, false),
        Pattern::Mist => (Veil::Airy, 0.34, 0.0, 0.0, false),
        Pattern::Beam => (Veil::Airy, 0.8, 0.0, 0.0, true),
        _ => return None,
    };
    Some(VeilLook { veil, squarely, glancing, shine, shines })
}

/// How a pattern is seen through, if it is.
pub(crate) const fn of(pattern: Pattern) -> Option<Veil> {
    match look(pattern) {
        Some(look) => Some(look.veil),
        None => None,
    }
}

/// How much of what is behind a surface hides whose normal is at an angle of that cosine, 0 to 1, to the line of sight:
/// from glancing to squarely a clear surface goes as `1 - (1 - cosine)^3`, an airy one as `cosine^2`.
pub(crate) fn opacity(look: &VeilLook, squarely: f32, cosine: f32) -> f32 {
    let share = match look.veil {
        Veil::Clear => {
            let aside = 1.0 - cosine;
            1.0 - aside * aside * aside
        }
        Veil::Airy => cosine * cosine,
    };
    look.glancing + (squarely - look.glancing) * share
}

/// Paint and opacity under frost, dirt and slime.
pub(crate) fn weathered(weather: Weather, paint: Vec3, opacity: f32) -> (Vec3, f32) {
    let covers = [
        (weather.dirty, [110, 90, 62], 0.35),
        (weather.infected, [96, 200, 70], 0.3),
        (weather.cold, [214, 233, 246], 0.45),
    ];
    let worn = covers.into_iter().filter(|(worn, ..)| *worn);
    worn.fold((paint, opacity), |(paint, opacity), (_, color, share)| {
        (paint.lerp(from_srgb(color), 0.6), opacity + (1.0 - opacity) * share)
    })
}
