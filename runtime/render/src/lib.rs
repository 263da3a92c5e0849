//! World snapshot in; colour, depth, normals and instance ids out.
//!
//! A [`Scene`] holds a floor plan and the instances in it; a [`Renderer`] draws what a [`Camera`] sees of it. Nothing
//! here knows rules, ticks or transports, and nothing depends on a clock, on a random source, or on how many threads
//! draw: the same scene and camera give the same bits.
//!
//! ```
//! use std::sync::Arc;
//! use cohabit_cdf::Catalog;
//! use cohabit_render::{CpuRenderer, MeshLibrary, Planes, Renderer, Scene};
//! # let layout = cohabit_cdf::Layout { id: String::new(), wall_height_m: 2.8, rooms: vec![], openings: vec![],
//! #     placements: vec![], viewpoints: vec![], note_places: vec![] };
//! # let camera = cohabit_render::Camera { position_m: [0.0; 3], yaw_rad: 0.0, pitch_rad: 0.0, fov_y_rad: 1.0,
//! #     width: 4, height: 3, hide: None, for_people: false, ceiling: true };
//! let catalog = Catalog::parse(&[], &[])?;
//! let scene = Scene::new(Arc::new(MeshLibrary::build(&catalog)?), &layout);
//! let mut ids = vec![0; camera.pixels()];
//! let mut planes = Planes { ids: Some(&mut ids), ..Planes::default() };
//! CpuRenderer::new(1).render(&scene, &camera, &mut planes);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod backend;
mod camera;
mod color;
#[cfg(test)]
mod coplanar;
mod cpu;
mod figure;
mod furnish;
pub mod gallery;
mod hidden;
mod ink;
mod instance;
mod instance_color;
mod kit;
mod lens;
mod library;
mod mesh;
mod minimap;
mod model_error;
mod model_mesh;
mod noise;
mod occlusion;
mod pattern;
mod people;
mod placed;
mod plan;
mod planes;
mod portals;
mod pose;
mod rig;
mod scene;
mod seen;
mod shadow;
mod signs;
mod soup;
mod veil;
mod visibility;
mod weather;

pub use camera::{Camera, FAR_M};
pub use cpu::{CpuRenderer, has_wide_vectors};
pub use figure::{Figure, Shape};
pub use furnish::furnish;
pub use instance::{Highlight, Instance, Look};
pub use instance_color::{instance_color, instance_of_color};
pub use kit::ShapeError;
pub use lens::{Lens, LensError};
pub use library::MeshLibrary;
pub use mesh::Aabb;
pub use minimap::{Minimap, minimap};
pub use model_error::ModelError;
pub use plan::{RoomSurface, room_surface_id};
pub use planes::Planes;
pub use scene::Scene;
pub use soup::Soup;
pub use visibility::{Classes, Seen, SeenTable, room_surface_of_id};

/// One picture that is wanted.
#[derive(Debug)]
pub struct Shot<'a> {
    /// Who looks.
    pub camera: Camera,
    /// What is filled.
    pub planes: Planes<'a>,
}

/// Draws what cameras see of a scene.
pub trait Renderer: Send {
    /// Fills the planes that are wanted.
    ///
    /// # Panics
    /// When a plane's length is not that of the camera's picture.
    fn render(&mut self, scene: &Scene, camera: &Camera, planes: &mut Planes<'_>);

    /// Draws many pictures of the same moment, which may cost less than one after another.
    ///
    /// # Panics
    /// As [`Self::render`].
    fn render_all(&mut self, scene: &Scene, shots: &mut [Shot<'_>]) {
        for shot in shots {
            self.render(scene, &shot.camera, &mut shot.planes);
        }
    }
}
