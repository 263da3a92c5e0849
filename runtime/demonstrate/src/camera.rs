//! What the robot sees: a camera in its head that looks when it is told to.

use std::sync::Arc;

use cohabit_bus::{
    CameraId, Local, Subscriber, Topic, Transport as _,
    message::{FrameView, Plane},
};
use cohabit_engine::{Appearance, CameraPlan, Mount, SessionPlan, Stills, Visible};
use cohabit_render::{CpuRenderer, Lens, MeshLibrary};
use cohabit_world::World;

use crate::error::DemonstrateError;

/// The body whose eyes they are.
const BODY: u8 = 0;

/// The robot's eyes in one mission.
pub(crate) struct Camera {
    stills: Stills,
    frames: Box<dyn Subscriber>,
    id: CameraId,
}

impl Camera {
    /// A camera with this lens and these planes, and ids besides: they say what is seen.
    pub fn new(
        plan: &SessionPlan,
        meshes: Arc<MeshLibrary>,
        lens: Lens,
        planes: &[Plane],
    ) -> Result<Self, DemonstrateError> {
        let id = CameraId::Egocentric(BODY);
        let planes = Plane::ALL.into_iter().filter(|plane| *plane == Plane::Ids || planes.contains(plane)).collect();
        let camera = CameraPlan { lens, planes, ..CameraPlan::usual(id, Mount::Head { body: BODY }) };
        let bus = Local::new(1);
        let frames = bus.subscriber(Topic::Frames(id))?;
        // One thread: missions are played side by side.
        let renderer = Box::new(CpuRenderer::new(1));
        let stills = Stills::new(plan, meshes, renderer, &[camera], &bus)?;
        Ok(Self { stills, frames, id })
    }

    /// Looks at the world as it is now.
    pub fn look<T>(
        &mut self,
        world: &World,
        appearance: &Appearance,
        read: impl FnOnce(&FrameView<'_>) -> Result<T, DemonstrateError>,
    ) -> Result<T, DemonstrateError> {
        self.stills.shoot(Visible { world, appearance }, self.id, None)?;
        let sample = self.frames.latest()?.ok_or(DemonstrateError::NoFrame)?;
        read(&FrameView::new(sample.payload())?)
    }

    /// The lens that robots usually have, with pictures of that size.
    pub fn lens(width: u32, height: u32) -> Result<Lens, cohabit_render::LensError> {
        let usual = CameraPlan::usual(CameraId::Egocentric(BODY), Mount::Head { body: BODY });
        Lens::new(width, height, usual.lens.fov_y_deg())
    }
}
