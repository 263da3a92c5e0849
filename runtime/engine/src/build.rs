//! From a mission file's text to a world ready to step.

use std::sync::Arc;

use cohabit_bus::{
    CameraId, Text,
    message::{MissionHeader, MissionMessage},
};
use cohabit_cdf::{BodyRequest, Catalog, Layout, LayoutError, Mission, mission};
use cohabit_world::World;

use crate::camera_plan::CameraPlan;

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
    /// Cameras beside those of the bodies.
    pub cameras: Vec<CameraPlan>,
    /// How many agents the world waits for, tick by tick, if it goes in lock-step; else it goes in real time.
    pub lock_step: Option<usize>,
}

/// The most cameras that can be asked for.
const MOST_CAMERAS: usize = 64;

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
    /// Two cameras have one name.
    #[error("two cameras are called `{0}`: give each a name of its own")]
    CameraTwice(CameraId),
    /// There are too many cameras.
    #[error("{0} cameras are asked for: at most {MOST_CAMERAS}")]
    Cameras(usize),
    /// A camera belongs to a body that is not there.
    #[error("camera `{camera}` is to be with body {body}: the session has bodies 0 to {last}; `--body robot` adds one")]
    CameraBody {
        /// The camera.
        camera: CameraId,
        /// Its body.
        body: u8,
        /// The last body there is.
        last: usize,
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
        let layout = Arc::new(Layout::find(&mission.layout, &catalog)?);
        let seed = mission.seed.unwrap_or(seed);
        Ok(Self {
            file: file.to_owned(),
            text: text.to_owned(),
            catalog,
            layout,
            mission,
            seed,
            bodies: Vec::new(),
            cameras: Vec::new(),
            lock_step: None,
        })
    }

    /// The same with these bodies beside those of the mission.
    #[must_use]
    pub fn with_bodies(self, bodies: Vec<BodyRequest>) -> Self {
        Self { bodies, ..self }
    }

    /// The same with these cameras beside those of the bodies.
    ///
    /// # Errors
    /// [`BuildError::Cameras`], [`BuildError::CameraTwice`].
    pub fn with_cameras(self, cameras: Vec<CameraPlan>) -> Result<Self, BuildError> {
        if cameras.len() > MOST_CAMERAS {
            return Err(BuildError::Cameras(cameras.len()));
        }
        let twice = (1..cameras.len()).find(|later| cameras[..*later].iter().any(|one| one.id == cameras[*later].id));
        match twice {
            Some(later) => Err(BuildError::CameraTwice(cameras[later].id)),
            None => Ok(Self { cameras, ..self }),
        }
    }

    /// The same in lock-step: the world begins when so many agents attend, and waits for each that does.
    #[must_use]
    pub fn in_lock_step(self, agents: usize) -> Self {
        Self { lock_step: Some(agents), ..self }
    }

    /// All cameras of a session with so many bodies.
    #[must_use]
    pub fn all_cameras(&self, bodies: usize) -> Vec<CameraPlan> {
        CameraPlan::of_bodies(bodies).chain(self.cameras.iter().cloned()).collect()
    }

    /// What others are told of it, but for the cameras.
    #[must_use]
    pub fn message(&self) -> MissionMessage {
        let lock_step = u32::from(self.lock_step.is_some());
        let header =
            MissionHeader { seed: self.seed, file: Text::new(&self.file), lock_step, ..MissionHeader::default() };
        MissionMessage { header, bodies: self.bodies.clone(), cameras: Vec::new(), text: self.text.clone() }
    }

    /// The world at its first tick.
    ///
    /// # Errors
    /// [`BuildError::World`], [`BuildError::CameraBody`].
    pub fn build(&self) -> Result<World, BuildError> {
        let failed = |source| BuildError::World { file: self.file.clone(), source };
        let (catalog, layout, mission) =
            (Arc::clone(&self.catalog), Arc::clone(&self.layout), Arc::clone(&self.mission));
        let mut world = World::new(catalog, layout, mission, self.seed).map_err(failed)?;
        for request in &self.bodies {
            world.add_body(request.kind, request.room.unwrap_or(self.mission.start_room)).map_err(failed)?;
        }
        let bodies = world.bodies().len();
        for camera in &self.cameras {
            if let Some(body) = camera.body().filter(|body| usize::from(*body) >= bodies) {
                return Err(BuildError::CameraBody { camera: camera.id, body, last: bodies - 1 });
            }
        }
        Ok(world)
    }
}
