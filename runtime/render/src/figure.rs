//! What there is to see as figures: shapes that stay as they are, and where they are; for viewers that keep shapes.

use glam::Mat3;
use glam::Vec3;

use crate::color;
use crate::placed::Placed;
use crate::scene::Scene;
use crate::soup::{Soup, flat};
use crate::veil::{Veil, weathered};
use crate::weather::Weather;

/// A part of an instance that moves as a whole: its body, a door, an arm.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// The instance.
    pub id: u32,
    /// Which of the instance's figures: stays the same while the instance lives. The first is the lowest.
    pub part: u32,
    /// Its shape.
    pub shape: Shape,
    /// From the shape's frame to the world: turns and scales.
    pub rotation: Mat3,
    /// Where the shape's origin lies in the world, m.
    pub offset: Vec3,
}

/// Stands for a shape and its colours: two that are equal look the same.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    model: usize,
    pieces: Vec<u16>,
    tint: Vec3,
    fluid: Vec3,
    weather: Weather,
}

/// The most joints of a model, and its body.
const PARTS: u32 = 65;

impl Scene {
    /// All figures of the instances that are visible, in their order. What is nothing but light in the air is none.
    #[must_use]
    pub fn figures(&self) -> Vec<Figure> {
        let (mut figures, mut of_instance) = (Vec::new(), (0, 0));
        for placed in self.placed() {
            of_instance = if of_instance.0 == placed.id { (placed.id, of_instance.1 + 1) } else { (placed.id, 0) };
            self.push_figures(placed, of_instance.1 * PARTS, &mut figures);
        }
        figures
    }

    fn push_figures(&self, placed: &Placed, first: u32, figures: &mut Vec<Figure>) {
        let mesh = &self.meshes.model(placed.model).levels[0];
        let own = figures.len();
        for (piece, transform) in &placed.pieces {
            if mesh.pieces[usize::from(*piece)].veil == Some(Veil::Airy) {
                continue;
            }
            let part = first + u32::from(*transform);
            match figures[own..].iter_mut().find(|figure| figure.part == part) {
                Some(figure) => figure.shape.pieces.push(*piece),
                None => {
                    let Placed { id, model, tint, fluid, weather, .. } = *placed;
                    let shape = Shape { model, pieces: vec![*piece], tint, fluid, weather };
                    let moved = &placed.transforms[usize::from(*transform)];
                    figures.push(Figure { id, part, shape, rotation: moved.rotation, offset: moved.offset });
                }
            }
        }
    }

    /// The triangles of a figure of this scene, in its own frame. The finest level of detail is 0; the coarsest there is
    /// stands for all coarser ones.
    #[must_use]
    pub fn soup(&self, figure: &Figure, level: usize) -> Soup {
        let Shape { model, pieces, tint, fluid, weather } = &figure.shape;
        let levels = &self.meshes.model(*model).levels;
        let mesh = &levels[level.min(levels.len() - 1)];
        let mut soup = Soup { id: figure.id, ..Soup::default() };
        for piece in pieces {
            soup.push_plain(mesh, &mesh.pieces[usize::from(*piece)], |paint| {
                let (light, _) = weathered(*weather, flat(paint, *tint, *fluid), 1.0);
                color::to_srgb(color::srgb_table(), light)
            });
        }
        soup
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use std::sync::Arc;

    use cohabit_cdf::{Catalog, Layout, StateFlag};

    use super::*;
    use crate::{MeshLibrary, furnish};

    #[test]
    fn figures_in_their_places_are_what_is_drawn() {
        let (catalog, layout) = (Catalog::builtin(), Layout::builtin("OfficeLayout1").unwrap());
        let mut scene = Scene::new(Arc::new(MeshLibrary::build(&catalog).unwrap()), &layout);
        let rooms = scene.soups(1).len();
        let mut instances = furnish(&catalog, &layout);
        for (index, instance) in instances.iter_mut().enumerate() {
            instance.opened = (index % 3) as f32 * 0.5;
            instance.flags.set(StateFlag::Dirty, index % 2 == 0);
        }
        scene.set_instances(&instances);
        let figures = scene.figures();
        for soup in &scene.soups(1)[rooms..] {
            let own: Vec<&Figure> = figures.iter().filter(|figure| figure.id == soup.id).collect();
            let mut found: Vec<[f32; 3]> = own
                .iter()
                .flat_map(|figure| {
                    let points = scene.soup(figure, 1).positions.into_iter();
                    points.map(|at| (figure.rotation * Vec3::from_array(at) + figure.offset).to_array())
                })
                .collect();
            let mut wanted = soup.positions.clone();
            for all in [&mut found, &mut wanted] {
                all.sort_by(|a, b| a.partial_cmp(b).unwrap());
            }
            assert_eq!(found, wanted);
            let mut parts: Vec<u32> = own.iter().map(|figure| figure.part).collect();
            parts.dedup();
            assert_eq!(parts.len(), own.len(), "each part once");
        }
        let opened = instances.iter().position(|instance| instance.opened == 0.0).unwrap();
        instances[opened].opened = 1.0;
        scene.set_instances(&instances);
        let changed = scene.figures();
        assert!(
            changed.iter().zip(&figures).all(|(now, before)| now.shape == before.shape),
            "doors move, no shape changes"
        );
    }
}
