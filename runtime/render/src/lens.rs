//! The size of a camera's picture and how much it takes in, within bounds that every renderer can draw.

/// The size and the field of view of a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    width: u32,
    height: u32,
    fov_y_deg: f32,
}

/// Why there is no such lens.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum LensError {
    /// A side is too short or too long.
    #[error("a picture of {width}x{height} pixels: each side has {least} to {most}", least = Lens::SIDE.0, most = Lens::SIDE.1)]
    Side {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// There are too many pixels.
    #[error("a picture of {width}x{height} is {} pixels: at most {most}, such as 3840x2160", u64::from(*width) * u64::from(*height), most = Lens::MOST_PIXELS)]
    Pixels {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// It takes in too little or too much.
    #[error("a field of view of {degrees} degrees: {least} to {most}, from the upper to the lower edge", least = Lens::FOV_DEG.0, most = Lens::FOV_DEG.1)]
    FieldOfView {
        /// From the upper to the lower edge.
        degrees: f32,
    },
}

impl Lens {
    /// The least and the most pixels of a side.
    pub const SIDE: (u32, u32) = (16, 4096);
    /// The most pixels of a picture.
    pub const MOST_PIXELS: u32 = 1 << 23;
    /// The least and the greatest angle between the upper and the lower edge.
    pub const FOV_DEG: (f32, f32) = (1.0, 150.0);

    /// A lens of `width` x `height` pixels that takes in `fov_y_deg` degrees between the upper and the lower edge.
    ///
    /// # Errors
    /// [`LensError`].
    pub fn new(width: u32, height: u32, fov_y_deg: f32) -> Result<Self, LensError> {
        let (least, most) = Self::SIDE;
        if !(least..=most).contains(&width) || !(least..=most).contains(&height) {
            return Err(LensError::Side { width, height });
        }
        if width * height > Self::MOST_PIXELS {
            return Err(LensError::Pixels { width, height });
        }
        let (least, most) = Self::FOV_DEG;
        if !(least..=most).contains(&fov_y_deg) {
            return Err(LensError::FieldOfView { degrees: fov_y_deg });
        }
        Ok(Self { width, height, fov_y_deg })
    }

    /// Pixels across and down.
    #[must_use]
    pub const fn size(self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// The angle between the upper and the lower edge.
    #[must_use]
    pub const fn fov_y_deg(self) -> f32 {
        self.fov_y_deg
    }

    /// The same.
    #[must_use]
    pub const fn fov_y_rad(self) -> f32 {
        self.fov_y_deg.to_radians()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_kept() {
        let check = |width, height, fov, expected: Option<LensError>| {
            assert_eq!(Lens::new(width, height, fov).err(), expected, "{width}x{height} {fov}");
        };
        check(16, 16, 1.0, None);
        check(3840, 2160, 150.0, None);
        check(15, 300, 60.0, Some(LensError::Side { width: 15, height: 300 }));
        check(300, 4097, 60.0, Some(LensError::Side { width: 300, height: 4097 }));
        check(4096, 4096, 60.0, Some(LensError::Pixels { width: 4096, height: 4096 }));
        check(300, 300, 0.5, Some(LensError::FieldOfView { degrees: 0.5 }));
        assert!(Lens::new(300, 300, f32::NAN).is_err());
    }
}
