//! What there is to see as bare triangles in the world: for other renderers, and for programs that model.

use std::collections::BTreeMap;

use glam::Vec3;

use crate::color;
use crate::mesh::{Mesh, Paint, Piece};
use crate::placed::{Placed, Transform};
use crate::scene::Scene;
use crate::veil::Veil;

/// The triangles of one instance, or of one surface of a room.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Soup {
    /// What stands in the id plane where it is seen.
    pub id: u32,
    /// Corners in the world, m.
    pub positions: Vec<[f32; 3]>,
    /// Unit normals at the corners.
    pub normals: Vec<[f32; 3]>,
    /// Three corners each, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Red, green and blue of each triangle, without pattern and light.
    pub colors: Vec<[u8; 3]>,
}

impl Scene {
    /// Everything that is drawn at this moment: the rooms' surfaces, then the instances that are visible, in their order.
    /// The finest level of detail is 0; the coarsest there is stands for all coarser ones. What is nothing but light in the
    /// air is not among them.
    #[must_use]
    pub fn soups(&self, level: usize) -> Vec<Soup> {
        let mut soups = Soups::default();
        let mesh = &self.plan.mesh;
        for part in &self.plan.parts {
            let surface = |paint| shown(flat(paint, Vec3::ONE, Vec3::ONE));
            soups.of(part.id).push(mesh, &mesh.pieces[part.piece as usize], &Transform::IDENTITY, surface);
        }
        for placed in self.placed() {
            let Placed { id, model, tint, fluid, .. } = *placed;
            let levels = &self.meshes.model(model).levels;
            let mesh = &levels[level.min(levels.len() - 1)];
            let solid = |(piece, _): &&(u16, u16)| mesh.pieces[usize::from(*piece)].veil != Some(Veil::Airy);
            for (piece, transform) in placed.pieces.iter().filter(solid) {
                let transform = &placed.transforms[usize::from(*transform)];
                let surface = |paint| shown(flat(paint, tint, fluid));
                soups.of(id).push(mesh, &mesh.pieces[usize::from(*piece)], transform, surface);
            }
        }
        soups.all
    }
}

/// Soups, and where the one of each id is.
#[derive(Default)]
struct Soups {
    all: Vec<Soup>,
    places: BTreeMap<u32, usize>,
}

impl Soups {
    /// The soup with this id; a new one, if there is none yet.
    fn of(&mut self, id: u32) -> &mut Soup {
        let place = *self.places.entry(id).or_insert(self.all.len());
        if place == self.all.len() {
            self.all.push(Soup { id, ..Soup::default() });
        }
        &mut self.all[place]
    }
}

/// The colour of a surface, in linear light.
pub(crate) fn flat(paint: Paint, tint: Vec3, fluid: Vec3) -> Vec3 {
    match paint {
        Paint::Fixed(light) => light,
        Paint::Tint => tint,
        Paint::Fluid => fluid,
    }
}

fn shown(light: Vec3) -> [u8; 3] {
    color::to_srgb(color::srgb_table(), light)
}

impl Soup {
    /// Adds a piece in its mesh's frame.
    pub(crate) fn push_plain(&mut self, mesh: &Mesh, piece: &Piece, color_of: impl Fn(Paint) -> [u8; 3]) {
        self.push(mesh, piece, &Transform::IDENTITY, color_of);
    }

    fn push(&mut self, mesh: &Mesh, piece: &Piece, transform: &Transform, color_of: impl Fn(Paint) -> [u8; 3]) {
        let corners = piece.corners.start as usize..piece.corners.end as usize;
        let triangles = piece.triangles.start as usize..piece.triangles.end as usize;
        let first = self.positions.len() as u32;
        let place = |at: &Vec3| (transform.rotation * *at + transform.offset).to_array();
        // Normals turn as planes do: by the transposed inverse.
        let turned = transform.inverse.transpose();
        let turn = |normal: &Vec3| (turned * *normal).normalize_or_zero().to_array();
        self.positions.extend(mesh.positions[corners.clone()].iter().map(place));
        self.normals.extend(mesh.normals[corners].iter().map(turn));
        let moved = |corner: u32| corner - piece.corners.start + first;
        self.triangles.extend(mesh.triangles[triangles.clone()].iter().map(|triangle| triangle.map(moved)));
        let paint = |surface: &u16| color_of(mesh.surfaces[usize::from(*surface)].paint);
        self.colors.extend(mesh.surface_of[triangles].iter().map(paint));
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use std::sync::Arc;

    use cohabit_cdf::Catalog;
    use cohabit_cdf::layout::Layout;

    use super::*;
    use crate::{MeshLibrary, furnish};

    #[test]
    fn soups_hold_all_that_stands_in_the_rooms() {
        let (catalog, layout) = (Catalog::builtin(), Layout::builtin("OfficeLayout1").unwrap());
        let meshes = Arc::new(MeshLibrary::build(&catalog).unwrap());
        let mut scene = Scene::new(meshes, &layout);
        let rooms = scene.soups(0).len();
        let instances = furnish(&catalog, &layout);
        scene.set_instances(&instances);
        let soups = scene.soups(0);
        assert!(soups[rooms..].iter().map(|soup| soup.id).eq(instances.iter().map(|instance| instance.id)));
        for soup in &soups[rooms..] {
            let bounds = scene.placed().find(|placed| placed.id == soup.id).unwrap().bounds;
            for at in soup.positions.iter().map(|at| Vec3::from_array(*at)) {
                assert!((at.clamp(bounds.min, bounds.max) - at).length() < 1e-4, "{} lies outside at {at}", soup.id);
            }
        }
        let count = |soups: &[Soup]| soups.iter().map(|soup| soup.triangles.len()).sum::<usize>();
        assert!(count(&soups) > count(&scene.soups(1)) && count(&scene.soups(2)) == count(&scene.soups(99)));
        for soup in &soups {
            assert_eq!((soup.positions.len(), soup.triangles.len()), (soup.normals.len(), soup.colors.len()));
            assert!(soup.normals.iter().all(|normal| (Vec3::from_array(*normal).length() - 1.0).abs() < 1e-3));
            let corners = soup.positions.len() as u32;
            assert!(!soup.triangles.is_empty() && soup.triangles.iter().flatten().all(|corner| *corner < corners));
        }
    }
}
