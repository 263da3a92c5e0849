//! Pictures of a floor plan by the project's own renderer.

use std::sync::{Arc, Mutex, PoisonError};

use cohabit_cdf::{Layout, RoomId};
use cohabit_dialog::encode_jpeg;
use cohabit_render::{Camera, Lens, MeshLibrary, Planes, Renderer, Scene};

use crate::document::Drawn;

/// Size of a picture.
const SIZE: [u32; 2] = [640, 480];
/// Height at which what is seen from above is to scale, m.
const TABLE_M: f32 = 0.8;
/// What is seen from within takes in from its upper to its lower edge, how high the eye is, and how far it looks down.
const FOV_DEG: f32 = 63.0;
const EYE_M: f32 = 1.6;
const PITCH_RAD: f32 = -0.2;

/// Where a plan is seen from.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Eye {
    /// Above, without ceilings.
    Above,
    /// A viewpoint; the middle of the room, where it has none of that number.
    Within(RoomId, u8),
}

impl Eye {
    /// The one that is called so: `above`, or a room and the number of a viewpoint, `Lab1.3`.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        if name == "above" {
            return Some(Self::Above);
        }
        let (room, number) = name.rsplit_once('.')?;
        Some(Self::Within(RoomId::new(room)?, number.parse().ok()?))
    }

    fn camera(self, layout: &Layout) -> Option<Camera> {
        let Self::Within(room, number) = self else {
            return Some(Camera::top_down_on(SIZE, layout.bounds_m(), TABLE_M));
        };
        let view = layout.viewpoints.iter().find(|view| view.room == room && view.number == number);
        let ([x, y], yaw_deg) = match view {
            Some(view) => (view.at_m, view.yaw_deg),
            None => {
                let rect = layout.room(room)?.rects_m.first()?;
                ([f32::midpoint(rect[0], rect[2]), f32::midpoint(rect[1], rect[3])], 0.0)
            }
        };
        let lens = Lens::new(SIZE[0], SIZE[1], FOV_DEG).ok()?;
        Some(Camera::fixed(lens, [x, y, EYE_M], yaw_deg.to_radians(), PITCH_RAD))
    }
}

/// What draws, with all that is drawn.
pub struct Studio {
    meshes: Arc<MeshLibrary>,
    renderer: Mutex<Box<dyn Renderer>>,
}

impl Studio {
    /// One that draws what these meshes are of.
    #[must_use]
    pub fn new(meshes: MeshLibrary, renderer: Box<dyn Renderer>) -> Self {
        Self { meshes: Arc::new(meshes), renderer: Mutex::new(renderer) }
    }

    /// A picture, JPEG; none where there is nothing to see.
    #[must_use]
    pub fn picture(&self, drawn: &Drawn, eye: Eye) -> Option<Vec<u8>> {
        let camera = eye.camera(&drawn.layout)?;
        let mut scene = Scene::new(Arc::clone(&self.meshes), &drawn.layout);
        scene.set_instances(&drawn.instances);
        let mut rgba = vec![255; camera.pixels() * 4];
        let mut planes = Planes { color: Some(&mut rgba), ..Planes::default() };
        self.renderer.lock().unwrap_or_else(PoisonError::into_inner).render(&scene, &camera, &mut planes);
        let mut bytes = Vec::new();
        encode_jpeg(&mut bytes, SIZE, &rgba).ok()?;
        Some(bytes)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use cohabit_cdf::Catalog;
    use cohabit_render::{CpuRenderer, furnish};

    use super::*;

    #[test]
    fn a_plan_is_seen_from_above_and_from_within() {
        let catalog = Catalog::builtin();
        let meshes = MeshLibrary::build(&catalog).unwrap();
        let studio = Studio::new(meshes, Box::new(CpuRenderer::new(1)));
        let layout = Layout::builtin("OfficeLayout1").unwrap();
        let instances = furnish(&catalog, &layout);
        let drawn = Drawn { layout, instances };
        let picture = |name: &str| studio.picture(&drawn, Eye::named(name).unwrap());
        let (above, within) = (picture("above").unwrap(), picture("Lab1.1").unwrap());
        assert!(above.starts_with(&[0xff, 0xd8]) && within.starts_with(&[0xff, 0xd8]) && above != within);
        assert!(picture("Lab1.99").is_some() && picture("Attic.1").is_none());
        for name in ["below", "Lab1", "Lab1.x", "a b.1"] {
            assert_eq!(Eye::named(name), None, "{name}");
        }
    }
}
