//! Room for the planes of one picture.

use cohabit_render::Planes;

/// All planes of a picture, of which some are filled.
pub struct Buffers {
    /// Red, green, blue, 255.
    pub color: Vec<u8>,
    /// Depths, m.
    pub depth_m: Vec<f32>,
    normals: Vec<i8>,
    /// Ids.
    pub ids: Vec<u32>,
}

impl Buffers {
    /// For so many pixels.
    pub fn new(pixels: usize) -> Self {
        Self {
            color: vec![0; pixels * 4],
            depth_m: vec![0.0; pixels],
            normals: vec![0; pixels * 4],
            ids: vec![0; pixels],
        }
    }

    /// All planes, or colour alone.
    pub fn planes(&mut self, all: bool) -> Planes<'_> {
        Planes {
            color: Some(&mut self.color),
            depth_m: all.then_some(&mut self.depth_m),
            normals: all.then_some(&mut self.normals),
            ids: all.then_some(&mut self.ids),
        }
    }
}
