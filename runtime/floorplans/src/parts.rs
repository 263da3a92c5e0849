//! What floor plans are built from, for who builds them from something else than chance: the geometry of rooms, fixtures, furniture
//! that can be walked up to, things on it, where to stand, and the text of a file.

pub use crate::{
    chance::Chance,
    draft::{CIRCUIT, Draft, Room},
    fixtures::{add_entry, add_fuse_box, add_switch, kept_free},
    furniture::{Arrangement, Placed, Site, WALL_HEIGHT_M, against},
    geometry::{Block, HALF_WALL_M, Rect, Turn, Wall, is_clear, metres, rounded, shared, walls},
    openings::{Border, Entry, Floor, Gap, borders, outer},
    places::{Note, View, notes, views},
    text::text,
    things::{Places, Thing},
};
