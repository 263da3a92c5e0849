//! Pictures when somebody asks for them: for those who step a world themselves, as fast as they like, or replay one.

use std::{sync::Arc, time::Duration};

use cohabit_bus::{BusError, CameraId, Transport, monotonic_nanos};
use cohabit_render::{Lens, MeshLibrary, Renderer};

use crate::{appearance::Visible, build::SessionPlan, camera_plan::CameraPlan, scene::Moment, studio::Studio};

/// Cameras of one session that look only when they are told to.
pub struct Stills {
    studio: Studio,
}

impl Stills {
    /// These cameras in the floor plan of `plan`, each with its topic on `bus`.
    ///
    /// # Errors
    /// [`BusError`].
    pub fn new(
        plan: &SessionPlan,
        meshes: Arc<MeshLibrary>,
        renderer: Box<dyn Renderer>,
        cameras: &[CameraPlan],
        bus: &dyn Transport,
    ) -> Result<Self, BusError> {
        let (layout, catalog) = (Arc::clone(&plan.layout), Arc::clone(&plan.catalog));
        Ok(Self { studio: Studio::new(meshes, layout, catalog, renderer, cameras, bus)? })
    }

    /// Renders what a camera sees of the world as it is now, and sends it on the camera's topic; with another lens than
    /// its own, if one is given. A camera that is not there, or whose body is not, sends nothing.
    ///
    /// # Errors
    /// [`BusError::Send`].
    pub fn shoot(&mut self, visible: Visible<'_>, camera: CameraId, lens: Option<Lens>) -> Result<(), BusError> {
        self.studio.shoot_now(&Moment::capture(visible, monotonic_nanos()), camera, lens)
    }

    /// The same with a camera that goes on from its last picture, so many seconds of the session ago.
    ///
    /// # Errors
    /// [`BusError::Send`].
    pub fn follow(&mut self, visible: Visible<'_>, camera: CameraId, since_s: f64) -> Result<(), BusError> {
        let since = Duration::from_secs_f64(since_s);
        self.studio.shoot_after(&Moment::capture(visible, monotonic_nanos()), camera, since)
    }

    /// The same with many cameras of one moment, each with its own lens, which may cost less than one after another.
    ///
    /// # Errors
    /// [`BusError::Send`].
    pub fn shoot_all(&mut self, visible: Visible<'_>, cameras: &[CameraId]) -> Result<(), BusError> {
        self.studio.shoot_all_now(&Moment::capture(visible, monotonic_nanos()), cameras)
    }
}
