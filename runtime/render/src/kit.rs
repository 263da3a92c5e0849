//! The kit: every shape of a model becomes a solid of triangles.
//!
//! A solid is in the shape's own frame, with outward normals and counter-clockwise triangles. It knows nothing of
//! colours, states or instances.

mod block;
mod extrude;
mod glyphs;
mod lathe;
mod line;
mod mesh;
mod path;
mod text;
mod tube;

use cohabit_cdf::model::{MeshError, Shape, check_mesh};
use glam::Vec3;

/// How closely a mesh is looked at.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub(crate) enum Detail {
    /// For looking at closely.
    Fine,
    /// For the middle distance.
    Medium,
    /// For what covers a few pixels.
    Coarse,
}

impl Detail {
    /// All, the finest first.
    pub(crate) const ALL: [Self; 3] = [Self::Fine, Self::Medium, Self::Coarse];
}

/// How finely shapes are divided.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Precision {
    /// For which distance.
    pub detail: Detail,
    /// By how much a surface may differ from the true one, m: a pixel or two at that distance.
    pub tolerance_m: f32,
    /// Radii that lie near each other, as their least and their greatest, m: see [`Self::with_radii`].
    alike: Vec<[f32; 2]>,
}

impl Precision {
    /// For a model that lies in a ball of this radius.
    pub(crate) fn of(detail: Detail, radius_m: f32) -> Self {
        let radius_m = radius_m.clamp(0.01, 10.0);
        // From 130 pixels on the fine level is drawn, from 36 on the medium one: see `cpu::draw`.
        let medium_m = radius_m / 108.0;
        let tolerance_m = match detail {
            // Small things are held before the eyes; large ones are walked up to: 720 rows at 40 cm and at 1 m, in
            // pixels a metre.
            Detail::Fine => (1.9 / (400.0 / radius_m).clamp(620.0, 1560.0)).min(0.8 * medium_m),
            Detail::Medium => medium_m,
            Detail::Coarse => radius_m / 19.0,
        };
        Self { detail, tolerance_m, alike: Vec::new() }
    }

    /// For what nobody sees as sharply.
    pub(crate) fn coarser(&self) -> Self {
        let next = (self.detail as usize + 1).min(Detail::ALL.len() - 1);
        Self { detail: Detail::ALL[next], tolerance_m: self.tolerance_m * 2.5, alike: self.alike.clone() }
    }

    /// Gives circles of radii that lie near each other the same number of sides, so that a label keeps outside of the
    /// bottle around which it lies.
    pub(crate) fn with_radii(mut self, mut radii: Vec<f32>) -> Self {
        radii.sort_by(|a, b| b.total_cmp(a));
        for radius in radii {
            match self.alike.last_mut() {
                Some([least, greatest]) if radius * 1.15 > *least && radius * 1.6 > *greatest => *least = radius,
                _ => self.alike.push([radius, radius]),
            }
        }
        self
    }

    /// Sides of a full circle of this radius: even, so that it is as wide as it is long.
    fn sides(&self, radius: f32) -> u32 {
        let around = self.alike.iter().find(|[least, greatest]| *least <= radius && radius <= *greatest);
        let radius = around.map_or(radius, |[_, greatest]| *greatest);
        let (least, most) = match self.detail {
            Detail::Fine => (6, 32),
            Detail::Medium => (6, 20),
            Detail::Coarse => (4, 10),
        };
        let halves = core::f32::consts::PI * 0.5 * (radius / (2.0 * self.tolerance_m)).sqrt();
        (2 * (halves + 0.4) as u32).clamp(least, most)
    }

    /// Whether an edge that is cut off by this much, m, looks unlike a sharp one.
    fn rounds(&self, cut: f32) -> bool {
        let least = match self.detail {
            Detail::Fine => 1.2,
            Detail::Medium => 2.0,
            Detail::Coarse => 4.0,
        };
        cut > 1e-4 && cut >= least * self.tolerance_m
    }

    /// What stands out less, m, looks as if drawn upon what it stands on.
    pub(crate) fn flat_m(&self) -> f32 {
        self.tolerance_m * if self.detail == Detail::Fine { 1.0 } else { 0.6 }
    }

    /// Whether anything of a shape of this size can be seen at its distance.
    pub(crate) fn shows(&self, size: Vec3) -> bool {
        let least = match self.detail {
            Detail::Fine => return true,
            Detail::Medium => 1.2,
            Detail::Coarse => 1.8,
        };
        let longest = size.max_element();
        let thinnest = size.min_element();
        let across = size.x + size.y + size.z - longest - thinnest;
        longest > least * self.tolerance_m && across > 0.3 * self.tolerance_m
    }
}

/// A surface of triangles.
#[derive(Clone, Debug, Default)]
pub(crate) struct Solid {
    /// Corners.
    pub positions: Vec<Vec3>,
    /// The unit normal at each corner.
    pub normals: Vec<Vec3>,
    /// Three indices each, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl Solid {
    /// Adds a corner and says which it is.
    fn corner(&mut self, position: Vec3, normal: Vec3) -> u32 {
        self.positions.push(position);
        self.normals.push(normal.normalize_or(Vec3::Z));
        self.positions.len() as u32 - 1
    }

    /// Adds a triangle, unless it has no area.
    fn triangle(&mut self, corners: [u32; 3]) {
        let [a, b, c] = corners.map(|corner| self.positions[corner as usize]);
        if (b - a).cross(c - a).length_squared() > 1e-18 {
            self.triangles.push(corners);
        }
    }

    /// Adds two triangles, counter-clockwise.
    fn quad(&mut self, corners: [u32; 4]) {
        let [a, b, c, d] = corners;
        self.triangle([a, b, c]);
        self.triangle([a, c, d]);
    }

    /// Adds a flat four-sided face with its own corners.
    pub(crate) fn face(&mut self, corners: [Vec3; 4]) {
        let normal = (corners[2] - corners[0]).cross(corners[3] - corners[1]);
        let indices = corners.map(|position| self.corner(position, normal));
        self.quad(indices);
    }

    /// Moves every corner; normals go along with a rotation.
    pub(crate) fn transform(&mut self, rotation: glam::Mat3, offset: Vec3) {
        for position in &mut self.positions {
            *position = rotation * *position + offset;
        }
        for normal in &mut self.normals {
            *normal = rotation * *normal;
        }
    }

    /// Mirrors it through the plane where coordinate `axis` is zero.
    pub(crate) fn mirror(&mut self, axis: usize) {
        for vector in self.positions.iter_mut().chain(&mut self.normals) {
            vector[axis] = -vector[axis];
        }
        for triangle in &mut self.triangles {
            triangle.swap(1, 2);
        }
    }
}

/// Why a shape has no surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ShapeError {
    /// A length is not a positive, finite number.
    #[error("`{what}` is {value}; write a length above zero and below 100 m")]
    Length {
        /// Which.
        what: &'static str,
        /// Its value.
        value: f32,
    },
    /// A profile, path or outline has too few points.
    #[error("`{what}` has {have} points; write at least {want}")]
    FewPoints {
        /// Which.
        what: &'static str,
        /// How many there are.
        have: usize,
        /// How many it takes.
        want: usize,
    },
    /// An outline crosses itself.
    #[error("`outline` crosses itself, or has no area")]
    Crossed,
    /// Points and triangles are no mesh.
    #[error("{error}; {}", .error.remedy())]
    Mesh {
        /// What is wrong.
        #[from]
        error: MeshError,
    },
}

/// The surface of `shape` at this precision.
pub(crate) fn build(shape: &Shape, precision: &Precision) -> Result<Solid, ShapeError> {
    match shape {
        Shape::Box { size, bevel } => {
            for value in size {
                length("size", *value)?;
            }
            Ok(block::build(Vec3::from_array(*size), *bevel, precision))
        }
        Shape::Cylinder { radius, top_radius, height, bevel } => {
            length("radius", *radius)?;
            length("height", *height)?;
            let top = top_radius.unwrap_or(*radius);
            if !(0.0..100.0).contains(&top) {
                return Err(ShapeError::Length { what: "top_radius", value: top });
            }
            Ok(lathe::cylinder([*radius, top], *height, *bevel, precision))
        }
        Shape::Sphere { radii } => {
            for value in radii {
                length("radii", *value)?;
            }
            Ok(lathe::ellipsoid(Vec3::from_array(*radii), precision))
        }
        Shape::Lathe { profile } => {
            points("profile", profile.len(), 2, profile.as_flattened())?;
            Ok(lathe::turn(profile, precision))
        }
        Shape::Tube { path, radius, closed } => {
            length("radius", *radius)?;
            points("path", path.len(), 2, path.as_flattened())?;
            Ok(tube::build(path, *radius, *closed, precision))
        }
        Shape::Extrude { outline, height, bevel } => {
            length("height", *height)?;
            points("outline", outline.len(), 3, outline.as_flattened())?;
            extrude::build(outline, *height, *bevel, precision)
        }
        Shape::Text { text, height, around } => {
            length("height", *height)?;
            let mut solid = text::build(text, *height, precision);
            if let Some(radius) = around {
                length("around", *radius)?;
                text::wrap(&mut solid, *radius);
            }
            Ok(solid)
        }
        Shape::Line { path, width, closed } => {
            length("width", *width)?;
            points("path", path.len(), 2, path.as_flattened())?;
            Ok(line::build(path, *width, *closed, precision))
        }
        Shape::Mesh { points, triangles, smooth_deg } => {
            check_mesh(points, triangles, *smooth_deg)?;
            Ok(mesh::build(points, triangles, *smooth_deg, precision))
        }
    }
}

/// The strokes of a line of text in a plane, from its left end on the baseline; capitals are 1 high.
pub(crate) fn line_of_text(line: &str) -> Vec<[[f32; 2]; 2]> {
    text::line(line)
}

/// The radius of a shape that is round about its own z axis, m.
pub(crate) fn radius_of(shape: &Shape) -> Option<f32> {
    match shape {
        Shape::Cylinder { radius, top_radius, .. } => Some(radius.max(top_radius.unwrap_or(*radius))),
        Shape::Lathe { profile } => profile.iter().map(|point| point[0]).reduce(f32::max),
        _ => None,
    }
}

fn length(what: &'static str, value: f32) -> Result<(), ShapeError> {
    if value > 0.0 && value < 100.0 { Ok(()) } else { Err(ShapeError::Length { what, value }) }
}

fn points(what: &'static str, have: usize, want: usize, coordinates: &[f32]) -> Result<(), ShapeError> {
    if have < want {
        return Err(ShapeError::FewPoints { what, have, want });
    }
    match coordinates.iter().find(|value| !value.is_finite() || value.abs() >= 100.0) {
        Some(value) => Err(ShapeError::Length { what, value: *value }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests;
