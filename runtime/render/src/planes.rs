//! What a camera delivers.

/// The pictures of one camera, each row-major `[height, width]`, written where somebody wants them.
#[derive(Debug, Default)]
pub struct Planes<'a> {
    /// Red, green, blue, 255: four bytes a pixel.
    pub color: Option<&'a mut [u8]>,
    /// Along the camera's z, m; [`crate::FAR_M`] where there is nothing.
    pub depth_m: Option<&'a mut [f32]>,
    /// The surface's normal in the world, x, y, z times 127, and 0: four bytes a pixel; all 0 where there is nothing.
    pub normals: Option<&'a mut [i8]>,
    /// The instance seen, or a [`crate::room_surface_id`]; 0 where there is nothing.
    pub ids: Option<&'a mut [u32]>,
}

impl Planes<'_> {
    /// Makes sure that every plane that is wanted has so many pixels.
    ///
    /// # Panics
    /// When one has not.
    pub fn check_lengths(&self, pixels: usize) {
        let lengths = [
            self.color.as_ref().map(|plane| plane.len() / 4),
            self.depth_m.as_ref().map(|plane| plane.len()),
            self.normals.as_ref().map(|plane| plane.len() / 4),
            self.ids.as_ref().map(|plane| plane.len()),
        ];
        assert!(lengths.into_iter().flatten().all(|length| length == pixels), "a plane is not {pixels} pixels long");
    }
}
