//! Ambient occlusion, baked once for every corner of a model: how much of the sky it sees past the model itself.

use glam::Vec3;

use crate::mesh::{Aabb, Mesh};

/// Cells along the longest side.
const CELLS: f32 = 40.0;
/// Steps of a ray, each a little more than a cell.
const STEPS: u32 = 11;
/// A moving part is never darker: it does not stay where it was baked.
const MOVING_LEAST: f32 = 0.7;
/// No part is darker.
const LEAST: f32 = 0.28;

/// Which cells of a model's box its unmoving surfaces pass through.
pub(crate) struct Occluder {
    origin: Vec3,
    cell_m: f32,
    size: [usize; 3],
    filled: Vec<bool>,
}

impl Occluder {
    /// Of the pieces that are drawn while nothing has happened, and never move.
    pub(crate) fn new(mesh: &Mesh, bounds: Aabb) -> Self {
        let cell_m = (bounds.size().max_element() / CELLS).max(1e-3);
        let size = (bounds.size() / cell_m).to_array().map(|cells| cells.ceil() as usize + 3);
        let mut filled = vec![false; size.iter().product()];
        let origin = bounds.min - Vec3::splat(cell_m);
        let mut occluder = Self { origin, cell_m, size, filled: Vec::new() };
        for piece in
            mesh.pieces.iter().filter(|piece| piece.is_usual() && piece.joint.is_none() && piece.veil.is_none())
        {
            for triangle in &mesh.triangles[piece.triangles.start as usize..piece.triangles.end as usize] {
                let corners = triangle.map(|corner| mesh.positions[corner as usize]);
                occluder.sample(corners, |index| filled[index] = true);
            }
        }
        occluder.filled = filled;
        occluder
    }

    /// Walks over a triangle closely enough to meet each cell it passes through.
    fn sample(&self, [a, b, c]: [Vec3; 3], mut meet: impl FnMut(usize)) {
        let longest = (b - a).length().max((c - a).length()).max((c - b).length());
        let steps = ((longest / self.cell_m * 1.5) as u32).clamp(1, 120);
        for i in 0..=steps {
            for j in 0..=steps - i {
                let point = a + (b - a) * (i as f32 / steps as f32) + (c - a) * (j as f32 / steps as f32);
                if let Some(index) = self.index(point) {
                    meet(index);
                }
            }
        }
    }

    fn index(&self, point: Vec3) -> Option<usize> {
        let at = (point - self.origin) / self.cell_m;
        if at.min_element() < 0.0 {
            return None;
        }
        let [x, y, z] = at.to_array().map(|cell| cell as usize);
        let inside = x < self.size[0] && y < self.size[1] && z < self.size[2];
        inside.then(|| (z * self.size[1] + y) * self.size[0] + x)
    }

    /// How much of the surrounding light reaches each corner of `mesh`; `standing` says that a floor lies at z = 0.
    pub(crate) fn bake(&self, mesh: &Mesh, standing: bool) -> Vec<f32> {
        let rays = directions();
        let mut ambient = vec![1.0; mesh.positions.len()];
        for piece in &mesh.pieces {
            let corners = piece.corners.start as usize..piece.corners.end as usize;
            let least = if piece.joint.is_some() || !piece.is_usual() { MOVING_LEAST } else { LEAST };
            let placed = mesh.positions[corners.clone()].iter().zip(&mesh.normals[corners.clone()]);
            for (ambient, (position, normal)) in ambient[corners].iter_mut().zip(placed) {
                *ambient = self.openness(*position, *normal, &rays, standing).max(least);
            }
        }
        ambient
    }

    fn openness(&self, position: Vec3, normal: Vec3, rays: &[Vec3], standing: bool) -> f32 {
        let start = position + normal * (self.cell_m * 1.6);
        let (mut seen, mut total) = (0.0, 0.0);
        for ray in rays {
            let weight = ray.dot(normal);
            if weight <= 0.05 {
                continue;
            }
            total += weight;
            seen += weight * self.reach(start, *ray, standing);
        }
        if total > 0.0 { seen / total } else { 1.0 }
    }

    /// 1 for a ray that gets away, less the sooner it meets something.
    fn reach(&self, start: Vec3, ray: Vec3, standing: bool) -> f32 {
        for step in 1..=STEPS {
            let point = start + ray * (step as f32 * 1.3 * self.cell_m);
            let far = step as f32 / STEPS as f32;
            if standing && point.z < 0.0 {
                return 0.45 + 0.3 * far;
            }
            match self.index(point) {
                Some(index) if self.filled[index] => return far * 0.6,
                Some(_) => {}
                None if point.z > self.origin.z => return 1.0,
                None => {}
            }
        }
        1.0
    }
}

/// Directions spread evenly over the sphere (a Fibonacci lattice).
fn directions() -> Vec<Vec3> {
    const COUNT: usize = 36;
    (0..COUNT)
        .map(|i| {
            let z = 1.0 - (2.0 * i as f32 + 1.0) / COUNT as f32;
            let (sin, cos) = libm::sincosf(2.399_963_1 * i as f32);
            let across = (1.0 - z * z).sqrt();
            Vec3::new(across * cos, across * sin, z)
        })
        .collect()
}
