//! The kit: every shape of a model becomes a solid of triangles.
//!
//! A solid is in the shape's own frame, with outward normals and counter-clockwise triangles. It knows nothing of
//! colours, states or instances.

mod block;
mod extrude;
mod glyphs;
mod lathe;
mod text;
mod tube;

use cohabit_cdf::model::Shape;
use glam::Vec3;

/// How finely curved surfaces are divided.
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

    /// Sides of a full circle of this radius.
    fn sides(self, radius: f32) -> u32 {
        let fine = if radius < 0.012 {
            8
        } else if radius < 0.05 {
            16
        } else if radius < 0.25 {
            24
        } else {
            36
        };
        match self {
            Self::Fine => fine,
            // Cups and cans are looked at from the middle distance.
            Self::Medium if fine == 16 => 12,
            Self::Medium => (fine / 2).max(6),
            Self::Coarse => (fine / 4).max(5),
        }
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
}

/// The surface of `shape` at this level of detail.
pub(crate) fn build(shape: &Shape, detail: Detail) -> Result<Solid, ShapeError> {
    match shape {
        Shape::Box { size, bevel } => {
            for value in size {
                length("size", *value)?;
            }
            Ok(block::build(Vec3::from_array(*size), *bevel, detail))
        }
        Shape::Cylinder { radius, top_radius, height, bevel } => {
            length("radius", *radius)?;
            length("height", *height)?;
            let top = top_radius.unwrap_or(*radius);
            if !(0.0..100.0).contains(&top) {
                return Err(ShapeError::Length { what: "top_radius", value: top });
            }
            Ok(lathe::cylinder([*radius, top], *height, *bevel, detail))
        }
        Shape::Sphere { radii } => {
            for value in radii {
                length("radii", *value)?;
            }
            Ok(lathe::ellipsoid(Vec3::from_array(*radii), detail))
        }
        Shape::Lathe { profile } => {
            points("profile", profile.len(), 2, profile.as_flattened())?;
            Ok(lathe::turn(profile, detail))
        }
        Shape::Tube { path, radius, closed } => {
            length("radius", *radius)?;
            points("path", path.len(), 2, path.as_flattened())?;
            Ok(tube::build(path, *radius, *closed, detail))
        }
        Shape::Extrude { outline, height, bevel } => {
            length("height", *height)?;
            points("outline", outline.len(), 3, outline.as_flattened())?;
            extrude::build(outline, *height, *bevel, detail)
        }
        Shape::Text { text, height } => {
            length("height", *height)?;
            Ok(text::build(text, *height, detail))
        }
    }
}

/// The strokes of a line of text in a plane, from its left end on the baseline; capitals are 1 high.
pub(crate) fn line_of_text(line: &str) -> Vec<[[f32; 2]; 2]> {
    text::line(line)
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
