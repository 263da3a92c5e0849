//! Places and rotations as clients have them: metres, `x` east, `y` up, `z` north, left-handed; what faces north is not
//! rotated, and rotations about `y` go clockwise seen from above.

use std::f32::consts::FRAC_1_SQRT_2;

use cohabit_world::{Quat, Vec3};
use serde::Serialize;

/// A place, m.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Place {
    /// East.
    pub x: f32,
    /// Up.
    pub y: f32,
    /// North.
    pub z: f32,
}

impl Place {
    /// A place of the world, as clients have it.
    pub fn of(point: Vec3) -> Self {
        Self { x: point.x, y: point.z, z: point.y }
    }

    /// The point of the world's floor that is below it.
    pub const fn on_floor(self) -> [f32; 2] {
        [self.x, self.z]
    }
}

/// A rotation, as a quaternion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Rotation {
    x: f32,
    y: f32,
    z: f32,
    w: f32,
}

impl Rotation {
    /// A rotation of the world, as clients have it: there the front of a thing is `+z`, not `+x`.
    pub fn of(rotation: Quat) -> Self {
        // Exchanging two axes mirrors: angles change their sign, axes are exchanged.
        let mirrored = Quat::from_xyzw(-rotation.x, -rotation.z, -rotation.y, rotation.w);
        let front = Quat::from_xyzw(0.0, FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2);
        let Quat { x, y, z, w } = (mirrored * front).normalize();
        Self { x, y, z, w }
    }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::FRAC_PI_2;

    use super::*;

    /// Where the front and the left of a thing are, in the client's frame.
    fn sides(rotation: Quat) -> [Vec3; 2] {
        let Rotation { x, y, z, w } = Rotation::of(rotation);
        let turned = Quat::from_xyzw(x, y, z, w);
        [turned * Vec3::Z, turned * -Vec3::X]
    }

    #[test]
    fn fronts_and_sides_point_where_they_do() {
        let swapped = |v: Vec3| Vec3::new(v.x, v.z, v.y);
        for rotation in [
            Quat::IDENTITY,
            Quat::from_rotation_z(FRAC_PI_2),
            Quat::from_rotation_z(-1.1),
            Quat::from_rotation_x(0.4) * Quat::from_rotation_z(2.0) * Quat::from_rotation_y(-0.7),
        ] {
            let [front, left] = sides(rotation);
            assert!((front - swapped(rotation * Vec3::X)).length() < 1e-5, "{rotation}: {front}");
            assert!((left - swapped(rotation * Vec3::Y)).length() < 1e-5, "{rotation}: {left}");
        }
        let north = Rotation::of(Quat::from_rotation_z(FRAC_PI_2));
        assert!((north.w.abs() - 1.0).abs() < 1e-5, "{north:?}");
    }

    #[test]
    fn places_lie_on_the_same_floor() {
        let place = Place::of(Vec3::new(1.0, 2.0, 3.0));
        assert_eq!(place, Place { x: 1.0, y: 3.0, z: 2.0 });
        assert_eq!(place.on_floor(), [1.0, 2.0]);
    }
}
