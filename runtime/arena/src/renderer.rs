//! One renderer for all games, one after the other: what it has on a GPU stays there.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use cohabit_render::{Camera, Planes, Renderer, Scene, Shot};

/// A renderer that has several owners.
#[derive(Clone)]
pub struct SharedRenderer(Arc<Mutex<Box<dyn Renderer>>>);

impl SharedRenderer {
    pub fn new(renderer: Box<dyn Renderer>) -> Self {
        Self(Arc::new(Mutex::new(renderer)))
    }

    fn lock(&self) -> MutexGuard<'_, Box<dyn Renderer>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Renderer for SharedRenderer {
    fn render(&mut self, scene: &Scene, camera: &Camera, planes: &mut Planes<'_>) {
        self.lock().render(scene, camera, planes);
    }

    fn render_all(&mut self, scene: &Scene, shots: &mut [Shot<'_>]) {
        self.lock().render_all(scene, shots);
    }
}
