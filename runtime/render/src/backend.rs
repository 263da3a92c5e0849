//! What a renderer needs that lives in a crate of its own: what there is to draw, what a camera sees of it, and what its
//! light is made of. Nothing here draws, and nothing here is needed to use a renderer.
//!
//! A [`Stage`] is a scene as a back end reads it. Its meshes ([`Stage::model_mesh`], [`Stage::plan_mesh`]) never change
//! and are worth keeping; its things and pieces ([`Stage::things`]) hold for one moment; what of them a camera sees
//! ([`Stage::seen`]) is culled by rooms, by the picture's edges and by size. The reference for all that happens to a
//! pixel is [`crate::CpuRenderer`].

mod mesh;
mod pattern;
mod people;
mod shadow;
mod stage;

pub use mesh::{Light, MeshData, MeshPiece, Surface, Vertex};
pub use pattern::{PICTURES, PictureData, picture, spots};
pub use people::ForPeople;
pub use shadow::Shadows;
pub use stage::{Piece, PlanKey, Seen, Sight, Stage, Thing};

pub use crate::camera::NEAR_M;
pub use crate::color::{WHITE, from_srgb as linear_light, srgb_table as display_bytes};
pub use crate::cpu::{ABOVE, BELOW, DIRT, FROST, GUARD_PX, KEY, LIFT_M, SLIME, SUB};
pub use crate::mesh::Paint;
pub use crate::pattern::Gloss;
pub use crate::shadow::{FADE, SLANT, towards_light};
pub use crate::veil::{Veil, VeilLook};
