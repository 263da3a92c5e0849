//! What the points and triangles of a mesh may be.

/// The most points of a mesh.
pub const MOST_POINTS: usize = 4096;
/// The most triangles of a mesh.
pub const MOST_TRIANGLES: usize = 4096;
/// Points lie nearer to the origin than this along each axis, m, as those of other shapes do.
pub const FARTHEST_M: f32 = 100.0;

/// Why points and triangles are no mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// A list is too short or too long.
    #[error("`{what}` has {have} items")]
    Count {
        /// Which.
        what: &'static str,
        /// How many there are.
        have: usize,
        /// How many there are at least.
        least: usize,
        /// How many there are at most.
        most: usize,
    },
    /// A coordinate is no number, or too large.
    #[error("`points[{point}]` has the coordinate {value}")]
    Coordinate {
        /// The point, from 0.
        point: usize,
        /// The coordinate.
        value: f32,
    },
    /// A triangle has a point that there is not.
    #[error("`triangles[{triangle}]` names point {index} of {points}")]
    Index {
        /// The triangle, from 0.
        triangle: usize,
        /// What it names.
        index: u32,
        /// How many points there are.
        points: usize,
    },
    /// An angle is none.
    #[error("`smooth_deg` is {value}")]
    Angle {
        /// Its value.
        value: f32,
    },
}

impl MeshError {
    /// What would be right.
    #[must_use]
    pub fn remedy(&self) -> String {
        match self {
            Self::Count { least, most, .. } => format!("write from {least} to {most}"),
            Self::Coordinate { .. } => format!("write metres between -{FARTHEST_M} and {FARTHEST_M}"),
            Self::Index { .. } => "points are counted from 0".to_owned(),
            Self::Angle { .. } => "write degrees from 0 to 180".to_owned(),
        }
    }
}

/// Whether these are a mesh.
///
/// # Errors
/// [`MeshError`] names the first list, point, triangle or angle that is wrong.
pub fn check_mesh(points: &[[f32; 3]], triangles: &[[u32; 3]], smooth_deg: Option<f32>) -> Result<(), MeshError> {
    count("points", points.len(), 3, MOST_POINTS)?;
    count("triangles", triangles.len(), 1, MOST_TRIANGLES)?;
    for (point, coordinates) in points.iter().enumerate() {
        if let Some(value) = coordinates.iter().find(|value| !value.is_finite() || value.abs() >= FARTHEST_M) {
            return Err(MeshError::Coordinate { point, value: *value });
        }
    }
    for (triangle, corners) in triangles.iter().enumerate() {
        if let Some(index) = corners.iter().find(|index| usize::try_from(**index).is_ok_and(|at| at >= points.len())) {
            return Err(MeshError::Index { triangle, index: *index, points: points.len() });
        }
    }
    match smooth_deg {
        Some(value) if !(0.0..=180.0).contains(&value) => Err(MeshError::Angle { value }),
        _ => Ok(()),
    }
}

fn count(what: &'static str, have: usize, least: usize, most: usize) -> Result<(), MeshError> {
    if (least..=most).contains(&have) { Ok(()) } else { Err(MeshError::Count { what, have, least, most }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNER: [[f32; 3]; 3] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

    #[test]
    fn what_is_no_mesh_is_refused_with_its_place() {
        let check = |points: &[[f32; 3]], triangles: &[[u32; 3]], smooth_deg: Option<f32>, expected: &str| {
            let found = check_mesh(points, triangles, smooth_deg).err();
            let found = found.map(|error| format!("{error}; {}", error.remedy())).unwrap_or_default();
            assert_eq!(found, expected);
        };
        check(&CORNER, &[[0, 1, 2]], None, "");
        check(&CORNER, &[[0, 1, 2]; 4096], Some(180.0), "");
        check(&CORNER[1..], &[[0, 1, 1]], None, "`points` has 2 items; write from 3 to 4096");
        check(&[[0.0; 3]; 4097], &[[0, 1, 2]], None, "`points` has 4097 items; write from 3 to 4096");
        check(&CORNER, &[], None, "`triangles` has 0 items; write from 1 to 4096");
        check(&CORNER, &[[0, 1, 2]; 4097], None, "`triangles` has 4097 items; write from 1 to 4096");
        check(&CORNER, &[[0, 1, 2], [0, 3, 1]], None, "`triangles[1]` names point 3 of 3; points are counted from 0");
        let far = |value: f32| [CORNER[0], CORNER[1], [0.0, value, 0.0]];
        for (value, text) in [(f32::NAN, "NaN"), (f32::INFINITY, "inf"), (-100.0, "-100")] {
            let expected = format!("`points[2]` has the coordinate {text}; write metres between -100 and 100");
            check(&far(value), &[[0, 1, 2]], None, &expected);
        }
        for (value, text) in [(f32::NAN, "NaN"), (-1.0, "-1"), (181.0, "181")] {
            let expected = format!("`smooth_deg` is {text}; write degrees from 0 to 180");
            check(&CORNER, &[[0, 1, 2]], Some(value), &expected);
        }
    }
}
