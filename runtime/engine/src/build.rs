//! From a mission file's text to a world ready to step.

use std::sync::Arc;

use cohabit_bus::{
    Text,
    message::{MissionHeader, MissionMessage},
};
use cohabit_cdf::{BodyRequest, Catalog, Layout, LayoutError, Mission, mission};
use cohabit_world::World;

/// All that does not change while a session runs, and the seed of what is random in it.
#[derive(Clone, Debug)]
pub struct SessionPlan {
    /// The name of the mission's file.
    pub file: String,
    /// Its text.
    pub text: String,
    /// The objects there can be.
    pub catalog: Arc<Catalog>,
    /// The floor plan.
    pub layout: Arc<Layout>,
    /// The mission, checked.
    pub mission: Arc<Mission>,
    /// The seed.
    pub seed: u64,
    /// Bodies beside those of the mission.
    pub bodies: Vec<BodyRequest>,
}

/// Why a session cannot be built.
#[derive(Debug, thiserror::Error)]
pub enum BuildError {
    /// The mission has problems.
    #[error("{0}")]
    Mission(mission::Problems),
    /// There is no such floor plan.
    #[error(transparent)]
    Layout(#[from] LayoutError),
    /// The world cannot be laid out as the mission asks.
    #[error("{file}: {source}")]
    World {
        /// The mission's file.
        file: String,
        /// What is wrong.
        source: cohabit_world::BuildError,
    },
}

impl SessionPlan {
    /// Checks a mission; `seed` is taken where the mission leaves it to chance.
    ///
    /// # Errors
    /// [`BuildError::Mission`], [`BuildError::Layout`].
    pub fn new(file: &str, text: &str, catalog: Arc<Catalog>, seed: u64) -> Result<Self, BuildError> {
        let checked = mission::read_mission(file, text, &catalog).map_err(BuildError::Mission)?;
        for warning in &checked.warnings {
            tracing::warn!("{warning}");
        }
        let mission = Arc::new(checked.mission);
        let layout = Arc::new(Layout::builtin(&mission.layout)?);
        let seed = mission.seed.unwrap_or(seed);
        Ok(Self { file: file.to_owned(), text: text.to_owned(), catalog, layout, mission, seed, bodies: Vec::new() })
    }

    /// The same with these bodies beside those of the mission.
    #[must_use]
    pub fn with_bodies(self, bodies: Vec<BodyRequest>) -> Self {
        Self { bodies, ..self }
    }

    /// What others are told of it.
    #[must_use]
    pub fn message(&self) -> MissionMessage {
        let header = MissionHeader { seed: self.seed, file: Text::new(&self.file), ..MissionHeader::default() };
        MissionMessage { header, bodies: self.bodies.clone(), text: self.text.clone() }
    }

    /// The world at its first tick.
    ///
    /// # Errors
    /// [`BuildError::World`].
    pub fn build(&self) -> Result<World, BuildError> {
        let failed = |source| BuildError::World { file: self.file.clone(), source };
        let (catalog, layout, mission) =
            (Arc::clone(&self.catalog), Arc::clone(&self.layout), Arc::clone(&self.mission));
        let mut world = World::new(catalog, layout, mission, self.seed).map_err(failed)?;
        for request in &self.bodies {
            world.add_body(request.kind, request.room.unwrap_or(self.mission.start_room)).map_err(failed)?;
        }
        Ok(world)
    }
}
