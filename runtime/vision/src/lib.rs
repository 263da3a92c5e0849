//! Vision data: views of the floor plans with things, states, lights and cameras drawn at random, annotated as COCO has it.
//!
//! [`make`] turns a [`Recipe`] into a data set in a folder. Each image is a folder of its own with four pictures, the state of what
//! is to be seen, and its annotations: boxes, areas and masks ([`masks`], [`Rle`]), all worked out from the picture of ids alone.
//! An image appears once it is whole, `annotations.json` and `manifest.json` once all are, so whoever is interrupted goes on where
//! they were. An image follows from the recipe's seed and its own number, and from the images before it, which it must not look
//! like: the same recipe gives the same bytes with any number of workers, and more images of it begin with the same ones.
//!
//! What each file has stands in `data/card.md`, which goes into the data set as its `README.md`. This crate never knows dialog,
//! agents or sessions.

mod arrange;
mod categories;
mod coco;
mod dataset;
mod dropped;
mod error;
mod image;
mod look;
mod maker;
mod mask;
mod recipe;
mod rle;
mod states;
mod studio;
mod view;

pub use dataset::{Summary, make};
pub use dropped::Dropped;
pub use error::VisionError;
pub use mask::{Mask, masks};
pub use recipe::{Filters, Recipe};
pub use rle::Rle;
