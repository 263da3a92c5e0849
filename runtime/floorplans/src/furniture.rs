//! Furniture in a room: on its floor and on its walls, where it is in nobody's way and all of it can be walked up to.

mod arrange;
mod furnish;
mod site;
mod table;

pub use arrange::{Arrangement, Placed};
pub use furnish::{against, furnish};
pub use site::{Site, WALL_HEIGHT_M};
pub use table::{FurnitureTable, Part, Set};
