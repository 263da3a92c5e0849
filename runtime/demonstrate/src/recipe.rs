//! How a data set is made, and of which missions.

use std::sync::Arc;

use cohabit_bus::message::Plane;
use cohabit_cdf::Catalog;
use cohabit_render::{Lens, LensError};
use serde_json::json;

use crate::camera::Camera;

/// What this format is called, with its version.
pub(crate) const FORMAT: &str = "cohabit demonstrations 3";

/// A mission that is to be demonstrated.
#[derive(Clone, Debug)]
pub struct MissionText {
    /// Its name.
    pub id: String,
    /// Its file's text.
    pub cdf: String,
}

/// How a data set is made: with the missions, all that it follows from.
#[derive(Clone, Debug)]
pub struct Recipe {
    seed: u64,
    lens: Lens,
    planes: Vec<Plane>,
    has_questions: bool,
    catalog: Arc<Catalog>,
}

impl Recipe {
    /// A seed for what missions leave to chance and for questions, the size of pictures in pixels, and what they show; nothing is drawn where
    /// that is empty.
    ///
    /// # Errors
    /// [`LensError`], where pictures of that size cannot be drawn.
    pub fn new(seed: u64, size: [u32; 2], planes: &[Plane]) -> Result<Self, LensError> {
        let planes = Plane::ALL.into_iter().filter(|plane| planes.contains(plane)).collect();
        let (lens, catalog) = (Camera::lens(size[0], size[1])?, Arc::new(Catalog::builtin()));
        Ok(Self { seed, lens, planes, has_questions: true, catalog })
    }

    /// The same without questions about instructions.
    #[must_use]
    pub const fn without_questions(mut self) -> Self {
        self.has_questions = false;
        self
    }

    /// The same in a world with this catalogue.
    #[must_use]
    pub fn in_world(self, catalog: Arc<Catalog>) -> Self {
        Self { catalog, ..self }
    }

    pub(crate) const fn has_questions(&self) -> bool {
        self.has_questions
    }

    pub(crate) fn planes(&self) -> &[Plane] {
        &self.planes
    }

    pub(crate) const fn lens(&self) -> Lens {
        self.lens
    }

    pub(crate) const fn seed(&self) -> u64 {
        self.seed
    }

    pub(crate) const fn catalog(&self) -> &Arc<Catalog> {
        &self.catalog
    }

    /// What must be the same for two data sets to be the same.
    pub(crate) fn text(&self, missions: &[MissionText]) -> String {
        let mut hasher = blake3::Hasher::new();
        for mission in missions {
            for part in [&mission.id, &mission.cdf] {
                hasher.update(&(part.len() as u64).to_le_bytes());
                hasher.update(part.as_bytes());
            }
        }
        let mut recipe = json!({
            "format": FORMAT,
            "program": env!("CARGO_PKG_VERSION"),
            "seed": self.seed,
            "size": self.lens.size(),
            "questions": self.has_questions,
            "modalities": self.planes.iter().map(|plane| plane.name()).collect::<Vec<_>>(),
            "missions": missions.len(),
            "missions_blake3": hasher.finalize().to_hex().as_str(),
        });
        if !self.catalog.packs().is_empty() {
            recipe["world"] = json!(self.catalog.packs());
        }
        format!("{recipe:#}\n")
    }
}
