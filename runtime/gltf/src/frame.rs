//! From a file's axes and units to an object's own frame: front along x, up along z, the origin in the middle of the base.

use std::str::FromStr;

use glam::{Mat3, Vec3};

use crate::error::GltfError;

/// The longest side of an object, m: what world packs allow.
const LONGEST_M: f32 = 10.0;
/// What is smaller is no object, m.
const SHORTEST_M: f32 = 0.003;

/// The axis of a file that points up.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum Up {
    /// As glTF has it.
    #[default]
    Y,
    /// As in files whose exporter did not turn the model.
    Z,
}

/// Where the front looks, on the floor, once the object stands upright: x is its right seen from the front of a glTF file, and y
/// leads away from who looks at it, as Blender shows it.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum Front {
    /// Along x.
    PlusX,
    /// Against x.
    MinusX,
    /// Along y.
    PlusY,
    /// Against y, as glTF has it.
    #[default]
    MinusY,
}

/// How large an object is to be.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Size {
    /// As its file says, in metres.
    #[default]
    OfFile,
    /// Along its own x, y and z, m.
    Sides([f32; 3]),
    /// So high, m, and as wide as follows from that.
    Height(f32),
}

impl FromStr for Up {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "y" => Ok(Self::Y),
            "z" => Ok(Self::Z),
            _ => Err("write `y` or `z`".to_owned()),
        }
    }
}

impl FromStr for Front {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "+x" | "x" => Ok(Self::PlusX),
            "-x" => Ok(Self::MinusX),
            "+y" | "y" => Ok(Self::PlusY),
            "-y" => Ok(Self::MinusY),
            _ => Err("write `+x`, `-x`, `+y` or `-y`".to_owned()),
        }
    }
}

/// The rotation that puts a file's axes where an object's are.
pub(crate) fn rotation(up: Up, front: Front) -> Mat3 {
    let upright = match up {
        Up::Y => Mat3::from_cols(Vec3::X, Vec3::Z, Vec3::NEG_Y),
        Up::Z => Mat3::IDENTITY,
    };
    let turned = match front {
        Front::PlusX => Mat3::IDENTITY,
        Front::MinusX => Mat3::from_cols(Vec3::NEG_X, Vec3::NEG_Y, Vec3::Z),
        Front::PlusY => Mat3::from_cols(Vec3::NEG_Y, Vec3::X, Vec3::Z),
        Front::MinusY => Mat3::from_cols(Vec3::Y, Vec3::NEG_X, Vec3::Z),
    };
    turned * upright
}

/// Least and greatest coordinates.
pub(crate) fn bounds(points: impl Iterator<Item = Vec3>) -> Option<[Vec3; 2]> {
    points.map(|point| [point, point]).reduce(|[low, high], [point, _]| [low.min(point), high.max(point)])
}

/// How to scale points that lie within these bounds, and what to add then.
pub(crate) fn placement([low, high]: [Vec3; 2], size: Size) -> Result<(Vec3, Vec3), GltfError> {
    let extent = high - low;
    let ratio = |wanted: f32, have: f32| if have > 0.0 { wanted / have } else { 1.0 };
    let scale = match size {
        Size::OfFile => Vec3::ONE,
        Size::Height(height) => Vec3::splat(ratio(height, extent.z)),
        Size::Sides(sides) => {
            Vec3::new(ratio(sides[0], extent.x), ratio(sides[1], extent.y), ratio(sides[2], extent.z))
        }
    };
    let scaled = extent * scale;
    let remedy = match scaled.max_element() {
        longest if !longest.is_finite() || longest > LONGEST_M => {
            "at most 10 m: if the file is in centimetres or millimetres, give the true size by --height-m or --size-m"
        }
        longest if longest < SHORTEST_M => "at least 3 mm: give the true size by --height-m or --size-m",
        _ => return Ok((scale, -Vec3::new((low.x + high.x) / 2.0, (low.y + high.y) / 2.0, low.z) * scale)),
    };
    Err(GltfError::Size { size: format!("{} × {} × {} m", scaled.x, scaled.y, scaled.z), remedy })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axes_of_a_file_become_those_of_an_object() {
        // In glTF the front is +z, up is +y and the left is +x.
        let usual = rotation(Up::Y, Front::default());
        assert_eq!([usual * Vec3::Z, usual * Vec3::Y, usual * Vec3::X], [Vec3::X, Vec3::Z, Vec3::Y]);
        for (front, toward) in [
            (Front::PlusX, Vec3::X),
            (Front::MinusX, Vec3::NEG_X),
            (Front::PlusY, Vec3::Y),
            (Front::MinusY, Vec3::NEG_Y),
        ] {
            let turned = rotation(Up::Z, front);
            assert_eq!([turned * toward, turned * Vec3::Z], [Vec3::X, Vec3::Z], "{front:?}");
            assert_eq!(turned.determinant(), 1.0);
        }
    }

    #[test]
    fn the_origin_is_the_middle_of_the_base() {
        let bounds = [Vec3::new(1.0, 2.0, 3.0), Vec3::new(2.0, 4.0, 7.0)];
        let placed = |size| {
            let (scale, offset) = placement(bounds, size).unwrap();
            bounds.map(|corner| corner * scale + offset)
        };
        assert_eq!(placed(Size::OfFile), [Vec3::new(-0.5, -1.0, 0.0), Vec3::new(0.5, 1.0, 4.0)]);
        assert_eq!(placed(Size::Height(1.0)), [Vec3::new(-0.125, -0.25, 0.0), Vec3::new(0.125, 0.25, 1.0)]);
        assert_eq!(placed(Size::Sides([3.0, 2.0, 1.0])), [Vec3::new(-1.5, -1.0, 0.0), Vec3::new(1.5, 1.0, 1.0)]);
        let error = placement([Vec3::ZERO, Vec3::splat(90.0)], Size::OfFile).unwrap_err().to_string();
        assert!(error.contains("90 × 90 × 90 m") && error.contains("--height-m"), "{error}");
        assert!(placement([Vec3::ZERO, Vec3::splat(1e-5)], Size::OfFile).is_err());
    }
}
